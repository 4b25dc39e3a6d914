//! Formulas that are polynomials in x and y.

use super::{Binary, Formula, FormulaStep, Unary};

/// Polynomial in x and y.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    /// Coefficient of `x^j y^k` in row j, column k; rows of different lengths.
    pub coefficients: Vec<Vec<f64>>,
}

/// Greatest degree in x or in y.
const MOST: usize = 24;

impl Formula {
    /// The polynomial that this formula of the plane is; none if it is not one, or of too high a degree.
    pub fn polynomial(&self) -> Option<Polynomial> {
        let mut stack: Vec<Polynomial> = Vec::new();
        for step in &self.steps {
            let next = match *step {
                FormulaStep::Number(value) => Polynomial::constant(value),
                FormulaStep::Coordinate(0) => Polynomial { coefficients: vec![vec![], vec![1.0]] },
                FormulaStep::Coordinate(_) => Polynomial { coefficients: vec![vec![0.0, 1.0]] },
                FormulaStep::Unary(function) => {
                    let of = stack.pop()?;
                    match (function, of.value()) {
                        (_, Some(value)) => Polynomial::constant(function.value(value)),
                        (Unary::Minus, None) => of.times(-1.0),
                        _ => return None,
                    }
                }
                FormulaStep::Binary(function) => {
                    let (b, a) = (stack.pop()?, stack.pop()?);
                    match (function, a.value(), b.value()) {
                        (_, Some(a), Some(b)) => Polynomial::constant(function.value(a, b)),
                        (Binary::Plus, ..) => a.plus(&b),
                        (Binary::Minus, ..) => a.plus(&b.times(-1.0)),
                        (Binary::Times, ..) => a.product(&b)?,
                        (Binary::Over, _, Some(b)) => a.times(1.0 / b),
                        (Binary::Power, _, Some(b)) => a.power(b)?,
                        _ => return None,
                    }
                }
            };
            stack.push(next);
        }
        stack.pop()
    }
}

impl Polynomial {
    /// Constant.
    pub fn constant(value: f64) -> Self {
        Self { coefficients: vec![vec![value]] }
    }

    /// Value of a constant; none of another polynomial.
    pub fn value(&self) -> Option<f64> {
        let mut higher = self.terms().filter(|([j, k], _)| j + k > 0);
        let first = self.coefficients.first().and_then(|row| row.first());
        higher.next().is_none().then(|| first.copied().unwrap_or_default())
    }

    /// Exponents of x and y with the coefficients that are not zero.
    pub fn terms(&self) -> impl Iterator<Item = ([usize; 2], f64)> {
        self.coefficients.iter().enumerate().flat_map(|(j, row)| {
            let of_row = row.iter().enumerate().map(move |(k, &value)| ([j, k], value));
            of_row.filter(|(_, value)| *value != 0.0)
        })
    }

    fn add(&mut self, [j, k]: [usize; 2], value: f64) {
        if self.coefficients.len() <= j {
            self.coefficients.resize(j + 1, Vec::new());
        }
        let row = &mut self.coefficients[j];
        if row.len() <= k {
            row.resize(k + 1, 0.0);
        }
        row[k] += value;
    }

    fn times(&self, factor: f64) -> Self {
        let rows = self.coefficients.iter();
        Self { coefficients: rows.map(|row| row.iter().map(|c| factor * c).collect()).collect() }
    }

    fn plus(mut self, other: &Self) -> Self {
        other.terms().for_each(|(exponents, value)| self.add(exponents, value));
        self
    }

    fn product(&self, other: &Self) -> Option<Self> {
        let mut product = Self { coefficients: Vec::new() };
        for ([j, k], a) in self.terms() {
            for ([l, m], b) in other.terms() {
                if (j + l).max(k + m) > MOST {
                    return None;
                }
                product.add([j + l, k + m], a * b);
            }
        }
        Some(product)
    }

    fn power(&self, exponent: f64) -> Option<Self> {
        if exponent.fract() != 0.0 || !(0.0..=MOST as f64).contains(&exponent) {
            return None;
        }
        let mut power = Self::constant(1.0);
        for _ in 0..exponent as usize {
            power = power.product(self)?;
        }
        Some(power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_found_with_their_values() {
        for text in ["7*(x^2-y^2)-1.5", "(x+2*y)^3/4 - sqrt(2)*x", "-x^2*y + 2^3", "pi", "x^0 - 1"] {
            let formula = Formula::read(text, 2).unwrap();
            let polynomial = formula.polynomial().unwrap();
            for point in [[0.3, -0.7], [1.2, 0.4]] {
                let [x, y] = point;
                let terms = polynomial.terms();
                let sum: f64 =
                    terms.map(|([j, k], c)| c * x.powi(j as i32) * y.powi(k as i32)).sum();
                assert!((sum - formula.at(&point)).abs() < 1e-13, "{text}");
            }
        }
        for text in ["sin(x)", "1/x", "x^0.5", "x^y", "abs(x)", "max(x,y)", "x^40"] {
            assert!(Formula::read(text, 2).unwrap().polynomial().is_none(), "{text}");
        }
    }
}
