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
pub(crate) struct Expansion {
    pub frame: Frame,
    pub radius: f64,
}

/// Polynomial that a part of a formula is.
pub(crate) struct Expanded {
    polynomial: RealPolynomial,
    /// Bound of the size of its error.
    error: f64,
}

/// Polynomial that a formula is, and a bound of its error on the disc.
///
/// # Errors
/// A sentence if it is none, or of too high a degree.
pub(crate) fn expanded(
    formula: &Formula,
    expansion: &Expansion,
) -> Result<(RealPolynomial, f64), String> {
    let Expanded { polynomial, error } = formula.evaluated(
        |value| Expanded::constant(value, 0.0),
        |axis| expansion.coordinate(axis),
        |function, value| value.under(function),
        |function, a, b| expansion.binary(function, a, b),
    )?;
    match (polynomial.size(expansion.radius) + error).is_finite() {
        true => Ok((polynomial, error)),
        false => Err("the coefficients of f exceed the range of double precision".into()),
    }
}

/// Refusal of a formula with this part.
fn no_polynomial(part: &str) -> String {
    format!("f is no polynomial in x and y: {part} is in it")
}

/// Checks the degree of a part of a formula.
fn check_degree(degree: usize) -> Result<(), String> {
    match degree <= DEGREE {
        true => Ok(()),
        false => Err(format!(
            "f has a polynomial of degree {degree} as it is written; the solver takes up to {DEGREE}"
        )),
    }
}

impl Expanded {
    fn constant(value: f64, error: f64) -> Self {
        Self { polynomial: RealPolynomial::harmonic(vec![Complex::new(value, 0.0)]), error }
    }

    /// Value of a constant; none of other polynomials.
    fn number(&self) -> Option<f64> {
        (self.polynomial.degree() == 0).then(|| self.polynomial.constant())
    }

    /// Value of a function of it.
    fn under(self, function: Unary) -> Result<Self, String> {
        if function == Unary::Minus {
            return Ok(Self { polynomial: self.polynomial.weighted(|_, _| -1.0), ..self });
        }
        let name = function.name();
        let c = self.number().ok_or_else(|| no_polynomial(&format!("{name} of x or y")))?;
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
        Expanded { polynomial, error: 0.0 }
    }

    fn binary(&self, function: Binary, a: Expanded, b: Expanded) -> Result<Expanded, String> {
        match function {
            Binary::Plus => Ok(self.sum(&a, &b, 1.0)),
            Binary::Minus => Ok(self.sum(&a, &b, -1.0)),
            Binary::Times => self.product(&a, &b),
            Binary::Over => self.quotient(&a, &b),
            Binary::Power => self.power(&a, &b),
            Binary::Min | Binary::Max | Binary::Atan2 => {
                let both = a.number().zip(b.number()).filter(|_| a.error + b.error == 0.0);
                let (x, y) = both.ok_or_else(|| {
                    no_polynomial(&format!("{} of x, y or rounded numbers", function.name()))
                })?;
                let value = function.value(x, y);
                let rounded = if function == Binary::Atan2 { OFF * value.abs() } else { 0.0 };
                Ok(Expanded::constant(value, rounded))
            }
        }
    }

    fn sum(&self, a: &Expanded, b: &Expanded, sign: f64) -> Expanded {
        let other = b.polynomial.weighted(|_, _| sign);
        let (polynomial, rounded) = a.polynomial.plus(&other, self.radius);
        Expanded { polynomial, error: a.error + b.error + f64::EPSILON * rounded }
    }

    fn product(&self, a: &Expanded, b: &Expanded) -> Result<Expanded, String> {
        let (p, q) = (&a.polynomial, &b.polynomial);
        check_degree(p.degree() + q.degree())?;
        let sizes = [p, q].map(|own| own.size(self.radius));
        let (polynomial, rounding) = p.times(q, self.radius);
        let error = rounding + a.error * (sizes[1] + b.error) + b.error * sizes[0];
        Ok(Expanded { polynomial, error })
    }

    fn quotient(&self, a: &Expanded, b: &Expanded) -> Result<Expanded, String> {
        let c = b.number().ok_or_else(|| no_polynomial("a division by x or y"))?;
        let least = c.abs() - b.error;
        if least <= 0.0 {
            return Err(no_polynomial("a division by zero"));
        }
        let size = a.polynomial.size(self.radius);
        let error = a.error / least + size * (b.error / (c.abs() * least) + OFF / c.abs());
        Ok(Expanded { polynomial: a.polynomial.weighted(|_, _| 1.0 / c), error })
    }

    fn power(&self, a: &Expanded, b: &Expanded) -> Result<Expanded, String> {
        /// Exponents whose degrees are counted.
        const MOST: f64 = 1e9;
        let exponent =
            b.number().filter(|_| b.error == 0.0).ok_or_else(|| no_polynomial("a power"))?;
        if let Some(c) = a.number().filter(|_| a.error == 0.0) {
            let value = Binary::Power.value(c, exponent);
            return Ok(Expanded::constant(value, OFF * value.abs()));
        }
        if exponent != exponent.round() || !(0.0..MOST).contains(&exponent) {
            return Err(no_polynomial("a power"));
        }
        check_degree(a.polynomial.degree().max(1) * exponent as usize)?;
        let mut product = Expanded::constant(1.0, 0.0);
        for _ in 0..exponent as usize {
            product = self.product(&product, a)?;
        }
        Ok(product)
    }
}
