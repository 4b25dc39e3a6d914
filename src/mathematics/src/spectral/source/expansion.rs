//! Formulas multiplied out to polynomials and waves, with a bound of the rounding of their coefficients.
//!
//! The size of a function is the sum of the moduli of its terms on a disc. That of a product is at most the product of
//! both sizes, so that errors of factors go over to it.

use crate::problem::complex::Complex;
use crate::problem::formula::{Binary, Formula, Unary};
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::frame::Frame;
use crate::spectral::smooth::real_polynomial::RealPolynomial;
use crate::spectral::smooth::{Smooth, Wave};

/// Largest degree, and number of waves.
const DEGREE: usize = 32;
const WAVES: usize = 64;
/// Units in the last place by which a function of a number is off.
const OFF: f64 = 2.0 * f64::EPSILON;

/// Coordinates of functions, on a disc round z = 0.
pub(crate) struct Expansion {
    frame: Frame,
    pub radius: f64,
}

/// Returns what a formula is in the frame of a domain, in a unit, and a bound of the error.
///
/// # Errors
/// The kind that the formula is not.
pub(crate) fn in_frame(
    formula: &Formula,
    domain: &PlaneDomain,
    unit: f64,
) -> Result<(Smooth, f64), String> {
    let (value, error) = expanded(formula, &Expansion::on(domain))?;
    Ok((value.scaled(1.0 / unit), error / unit))
}

/// Part of a formula, multiplied out.
struct Expanded {
    value: Smooth,
    /// Bound of the size of its error.
    error: f64,
}

/// Function that a formula is, and a bound of its error on the disc.
///
/// # Errors
/// The kind that the formula is not, or that its degree is too high.
pub(crate) fn expanded(formula: &Formula, expansion: &Expansion) -> Result<(Smooth, f64), String> {
    let Expanded { value, error } = formula.evaluated(
        |value| Expanded::constant(value, 0.0),
        |axis| expansion.coordinate(axis),
        |function, value| expansion.under(function, value),
        |function, a, b| expansion.binary(function, a, b),
    )?;
    match (value.size(expansion.radius) + error).is_finite() {
        true => Ok((value, error)),
        false => Err("has coefficients beyond the range of double precision".into()),
    }
}

/// Refusal of a formula with this part.
fn no_sum(part: &str) -> String {
    format!("is no sum of polynomials and of sin, cos and exp of linear functions: {part} is in it")
}

/// Checks the degree of a part of a formula.
fn check_degree(degree: usize) -> Result<(), String> {
    match degree <= DEGREE {
        true => Ok(()),
        false => Err(format!(
            "has a polynomial of degree {degree} as it is written; the solver takes up to {DEGREE}"
        )),
    }
}

impl Expanded {
    fn constant(value: f64, error: f64) -> Self {
        Self { value: Smooth::constant(value), error }
    }

    /// Degree of the polynomial; none with waves.
    fn degree(&self) -> Option<usize> {
        self.value.waves.is_empty().then(|| self.value.polynomial.degree())
    }

    /// Value of a constant; none of other functions.
    fn number(&self) -> Option<f64> {
        (self.degree() == Some(0)).then(|| self.value.polynomial.constant())
    }
}

impl Expansion {
    /// On a disc that holds a domain.
    pub(crate) fn on(domain: &PlaneDomain) -> Self {
        let [xs, ys] = domain.extent();
        let seen = xs.into_iter().flat_map(|x| ys.map(|y| Complex::new(x, y).norm()));
        // Arcs are seen in a hundred points.
        Self { frame: domain.frame, radius: 1.01 * seen.fold(0.0, f64::max) }
    }

    fn coordinate(&self, axis: usize) -> Expanded {
        let Frame { origin, unit, .. } = self.frame;
        let way = if axis == 0 { Complex::new(unit, 0.0) } else { Complex::new(0.0, -unit) };
        let polynomial = RealPolynomial::harmonic(vec![Complex::new(origin[axis], 0.0), way]);
        Expanded { value: Smooth { polynomial, waves: Vec::new() }, error: 0.0 }
    }

    /// Value of a function of it.
    fn under(&self, function: Unary, mut a: Expanded) -> Result<Expanded, String> {
        if function == Unary::Minus {
            return Ok(Expanded { value: a.value.scaled(-1.0), ..a });
        }
        if let Some(c) = a.number() {
            let off = function.slope(c, a.error) * a.error;
            let of_c = function.value(c);
            return Ok(Expanded::constant(of_c, off + OFF * of_c.abs()));
        }
        let (degree, c) = (a.degree(), a.value.polynomial.constant());
        let slope = *a.value.polynomial.at(0, 1);
        let wave = Wave::of(function, c, slope).filter(|_| degree == Some(1));
        let name = function.name();
        let wave = wave.ok_or_else(|| no_sum(&format!("{name} of a function of x or y")))?;
        let off = function.slope(c + slope.norm() * self.radius, a.error) * a.error;
        let value = Smooth { waves: vec![wave], ..Smooth::default() };
        Ok(Expanded { error: off + OFF * value.size(self.radius), value })
    }

    fn binary(&self, function: Binary, a: Expanded, b: Expanded) -> Result<Expanded, String> {
        match function {
            Binary::Plus => Ok(self.sum(a, b)),
            Binary::Minus => Ok(self.sum(a, Expanded { value: b.value.scaled(-1.0), ..b })),
            Binary::Times => self.product(&a, &b),
            Binary::Over => self.quotient(a, &b),
            Binary::Power => self.power(&a, &b),
            Binary::Min | Binary::Max | Binary::Atan2 => {
                let both = a.number().zip(b.number()).filter(|_| a.error + b.error == 0.0);
                let (x, y) = both.ok_or_else(|| {
                    no_sum(&format!("{} of x, y or rounded numbers", function.name()))
                })?;
                let value = function.value(x, y);
                let rounded = if function == Binary::Atan2 { OFF * value.abs() } else { 0.0 };
                Ok(Expanded::constant(value, rounded))
            }
        }
    }

    fn sum(&self, a: Expanded, b: Expanded) -> Expanded {
        let (polynomial, mut rounded) = a.value.polynomial.plus(&b.value.polynomial, self.radius);
        let mut value = Smooth { polynomial, waves: a.value.waves };
        for wave in b.value.waves {
            rounded += value.add(wave, self.radius);
        }
        Expanded { value, error: a.error + b.error + f64::EPSILON * rounded }
    }

    fn product(&self, a: &Expanded, b: &Expanded) -> Result<Expanded, String> {
        let (p, q) = (&a.value, &b.value);
        check_degree(p.polynomial.degree() + q.polynomial.degree())?;
        let (polynomial, mut rounding) = p.polynomial.times(&q.polynomial, self.radius);
        let sizes = [p, q].map(|own| own.size(self.radius));
        let mut value = Smooth { polynomial, waves: Vec::new() };
        for (own, other) in [(p, q), (q, p)] {
            if !other.waves.is_empty() && own.polynomial.degree() > 0 {
                return Err(no_sum("a product of x or y with sin, cos or exp"));
            }
            let factor = own.polynomial.constant();
            let waves = other.waves.iter().map(|wave| Wave { c: wave.c.scaled(factor), ..*wave });
            value.waves.extend(waves.filter(|_| factor != 0.0));
        }
        for one in &p.waves {
            for wave in q.waves.iter().flat_map(|other| one.times(*other)) {
                value.add(wave, self.radius);
            }
        }
        if value.waves.len() > WAVES {
            return Err(format!("has more than {WAVES} products of sin, cos and exp"));
        }
        if !value.waves.is_empty() {
            rounding += 1e1 * f64::EPSILON * sizes[0] * sizes[1];
        }
        let error = rounding + a.error * (sizes[1] + b.error) + b.error * sizes[0];
        Ok(Expanded { value, error })
    }

    fn quotient(&self, a: Expanded, b: &Expanded) -> Result<Expanded, String> {
        let c = b.number().ok_or_else(|| no_sum("a division by x or y"))?;
        let least = c.abs() - b.error;
        if least <= 0.0 {
            return Err(no_sum("a division by zero"));
        }
        let size = a.value.size(self.radius);
        let error = a.error / least + size * (b.error / (c.abs() * least) + OFF / c.abs());
        Ok(Expanded { value: a.value.scaled(1.0 / c), error })
    }

    fn power(&self, a: &Expanded, b: &Expanded) -> Result<Expanded, String> {
        /// Exponents whose degrees are counted.
        const MOST: f64 = 1e9;
        let exponent = b.number().filter(|_| b.error == 0.0).ok_or_else(|| no_sum("a power"))?;
        if let Some(c) = a.number().filter(|_| a.error == 0.0) {
            let value = Binary::Power.value(c, exponent);
            return Ok(Expanded::constant(value, OFF * value.abs()));
        }
        if exponent != exponent.round() || !(0.0..MOST).contains(&exponent) {
            return Err(no_sum("a power"));
        }
        check_degree(a.value.polynomial.degree().max(1) * exponent as usize)?;
        let mut product = Expanded::constant(1.0, 0.0);
        for _ in 0..exponent as usize {
            product = self.product(&product, a)?;
        }
        Ok(product)
    }
}
