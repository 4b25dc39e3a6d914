//! Formulas multiplied out to polynomials, with a bound of the rounding of their coefficients.
//!
//! The size of a polynomial is the sum of the moduli of its terms on a disc. That of a product is at most the product
//! of both sizes, so that errors of factors go over to it.

use super::real_polynomial::RealPolynomial;
use crate::problem::complex::Complex;
use crate::problem::formula::{Binary, Formula, Unary};
use crate::spectral::geometry::frame::Frame;

/// Largest degree.
const DEGREE: usize = 32;
/// Units in the last place by which a function of a number is off.
const OFF: f64 = 2.0 * f64::EPSILON;

/// Coordinates of polynomials, on a disc round z = 0.
pub(in crate::spectral) struct Expansion {
    pub frame: Frame,
    pub radius: f64,
}

/// Polynomial that a part of a formula is.
pub(in crate::spectral) struct Expanded {
    degree: usize,
    /// None if the degree is too high.
    polynomial: Option<RealPolynomial>,
    /// Bound of the size of its error.
    error: f64,
}

/// Polynomial that a formula is, and a bound of its error on the disc.
///
/// # Errors
/// A sentence if it is none, or of too high a degree.
pub(in crate::spectral) fn expanded(
    formula: &Formula,
    expansion: &Expansion,
) -> Result<(RealPolynomial, f64), String> {
    let evaluated = formula.evaluated(
        |value| Expanded::constant(value, 0.0),
        |axis| expansion.coordinate(axis),
        |function, value| value.under(function),
        |function, a, b| expansion.binary(function, a, b),
    );
    let Expanded { degree, polynomial, error } =
        evaluated.map_err(|part| format!("f is no polynomial in x and y: {part} is in it"))?;
    let polynomial = polynomial.ok_or_else(|| {
        format!(
            "f is a polynomial of degree {degree} as it is written; the solver takes up to {DEGREE}"
        )
    })?;
    match (polynomial.size(expansion.radius) + error).is_finite() {
        true => Ok((polynomial, error)),
        false => Err("the coefficients of f exceed the range of double precision".into()),
    }
}

impl Expanded {
    fn constant(value: f64, error: f64) -> Self {
        let polynomial = RealPolynomial::harmonic(vec![Complex::new(value, 0.0)]);
        Self { degree: 0, polynomial: Some(polynomial), error }
    }

    /// Value of a constant; none of other polynomials.
    fn number(&self) -> Option<f64> {
        let polynomial = self.polynomial.as_ref().filter(|_| self.degree == 0)?;
        Some(polynomial.constant())
    }

    /// Value of a function of it.
    fn under(self, function: Unary) -> Result<Self, String> {
        if function == Unary::Minus {
            let polynomial = self.polynomial.map(|own| own.weighted(|_, _| -1.0));
            return Ok(Self { polynomial, ..self });
        }
        let name = function.name();
        let c = self.number().ok_or_else(|| format!("{name} of x or y"))?;
        let off = function.slope(c, self.error) * self.error;
        let of_c = function.value(c);
        Ok(Self::constant(of_c, off + OFF * of_c.abs()))
    }
}

impl Expansion {
    fn coordinate(&self, axis: usize) -> Expanded {
        let Frame { origin, unit, .. } = self.frame;
        let way = if axis == 0 { Complex::new(unit, 0.0) } else { Complex::new(0.0, -unit) };
        let polynomial = RealPolynomial::harmonic(vec![Complex::new(origin[axis], 0.0), way]);
        Expanded { degree: 1, polynomial: Some(polynomial), error: 0.0 }
    }

    fn binary(&self, function: Binary, a: Expanded, b: Expanded) -> Result<Expanded, String> {
        match function {
            Binary::Plus => Ok(self.sum(&a, &b, 1.0)),
            Binary::Minus => Ok(self.sum(&a, &b, -1.0)),
            Binary::Times => Ok(self.product(&a, &b)),
            Binary::Over => self.quotient(a, &b),
            Binary::Power => self.power(a, &b),
            Binary::Min | Binary::Max | Binary::Atan2 => {
                let name = function.name();
                let both = a.number().zip(b.number()).filter(|_| a.error + b.error == 0.0);
                let (x, y) = both.ok_or_else(|| format!("{name} of x, y or rounded numbers"))?;
                let value = function.value(x, y);
                let rounded = if function == Binary::Atan2 { OFF * value.abs() } else { 0.0 };
                Ok(Expanded::constant(value, rounded))
            }
        }
    }

    fn sum(&self, a: &Expanded, b: &Expanded, sign: f64) -> Expanded {
        let degree = a.degree.max(b.degree);
        let (mut polynomial, mut error) = (None, a.error + b.error);
        if let (Some(a), Some(b)) = (&a.polynomial, &b.polynomial) {
            let (sum, rounded) = a.plus(&b.weighted(|_, _| sign), self.radius);
            polynomial = Some(sum);
            error += f64::EPSILON * rounded;
        }
        Expanded { degree, polynomial, error }
    }

    fn product(&self, a: &Expanded, b: &Expanded) -> Expanded {
        let degree = a.degree + b.degree;
        let (mut polynomial, mut error) = (None, 0.0);
        if let (Some(p), Some(q)) = (&a.polynomial, &b.polynomial)
            && degree <= DEGREE
        {
            let sizes = [p, q].map(|own| own.size(self.radius));
            let (product, rounding) = p.times(q, self.radius);
            error = rounding + a.error * (sizes[1] + b.error) + b.error * sizes[0];
            polynomial = Some(product);
        }
        Expanded { degree, polynomial, error }
    }

    fn quotient(&self, a: Expanded, b: &Expanded) -> Result<Expanded, String> {
        let c = b.number().ok_or("a division by x or y")?;
        let least = c.abs() - b.error;
        if least <= 0.0 {
            return Err("a division by zero".into());
        }
        let Some(own) = a.polynomial else { return Ok(a) };
        let size = own.size(self.radius);
        let error = a.error / least + size * (b.error / (c.abs() * least) + OFF / c.abs());
        let polynomial = Some(own.weighted(|_, _| 1.0 / c));
        Ok(Expanded { polynomial, error, ..a })
    }

    fn power(&self, a: Expanded, b: &Expanded) -> Result<Expanded, String> {
        /// Degrees that are counted.
        const MOST: f64 = 1e9;
        let exponent = b.number().filter(|_| b.error == 0.0).ok_or("a power")?;
        if a.degree == 0 && a.error == 0.0 {
            let value = Binary::Power.value(a.number().unwrap_or(f64::NAN), exponent);
            return Ok(Expanded::constant(value, OFF * value.abs()));
        }
        if exponent != exponent.round() || !(0.0..MOST).contains(&exponent) {
            return Err("a power".into());
        }
        let degree = (a.degree as f64 * exponent).min(MOST) as usize;
        if degree > DEGREE || a.polynomial.is_none() || exponent > DEGREE as f64 {
            return Ok(Expanded { degree, polynomial: None, error: 0.0 });
        }
        let mut product = Expanded::constant(1.0, 0.0);
        for _ in 0..exponent as usize {
            product = self.product(&product, &a);
        }
        Ok(product)
    }
}
