//! Polynomial right-hand sides.

use super::domain::PlaneDomain;
use crate::problem::complex::Complex;
use std::f64::consts::PI;

/// Polynomial in x and y that takes the place of a formula: the real part of a sum of `c z^j conj(z)^k`.
#[derive(Clone, Debug)]
pub struct Polynomial {
    terms: Vec<Term>,
    /// Largest difference from the formula seen, over the largest value; of rounding if the formula is a polynomial.
    pub error: f64,
}

/// Re c z^j conj(z)^k.
#[derive(Clone, Copy, Debug)]
struct Term {
    powers: [usize; 2],
    factor: Complex,
}

impl Polynomial {
    /// Polynomial that takes the place of a smooth function on a domain; look at its `error`.
    ///
    /// It interpolates at Chebyshev points of the box round the domain, with the lowest degree of 2, 4, 8 and 12 that
    /// is right to rounding between them.
    pub fn fitted(f: impl Fn([f64; 2]) -> f64, domain: &PlaneDomain) -> Self {
        let [[left, right], [low, high]] = domain.extent();
        let (middle, half) = (
            [0.5 * (left + right), 0.5 * (low + high)],
            [0.5 * (right - left), 0.5 * (high - low)],
        );
        let at = |x: [f64; 2]| f([0, 1].map(|axis| middle[axis] + half[axis] * x[axis]));
        let mut best: Option<Self> = None;
        for degree in [2, 4, 8, 12] {
            let coefficients = chebyshev(&at, degree);
            let mut found = Self { terms: terms(&coefficients, degree, middle, half), error: 0.0 };
            let (mut worst, mut largest) = (0.0f64, 0.0f64);
            for k in 0..400 {
                let x = [0.618_034 * f64::from(k) + 0.31, 0.754_878 * f64::from(k) + 0.17]
                    .map(|x| 2.0 * (x - x.floor()) - 1.0);
                let [x, y] = [0, 1].map(|axis| middle[axis] + half[axis] * x[axis]);
                let value = f([x, y]);
                worst = worst.max((found.value(Complex::new(x, y)) - value).abs());
                largest = largest.max(value.abs());
            }
            found.error = if worst > 0.0 { worst / largest } else { 0.0 };
            if best.as_ref().is_none_or(|best| !(best.error <= found.error)) {
                best = Some(found);
            }
            if best.as_ref().is_some_and(|best| best.error < 1e-13) {
                break;
            }
        }
        best.expect("a degree was tried")
    }

    /// The same with another error.
    pub(super) fn with_error(self, error: f64) -> Self {
        Self { error, ..self }
    }

    /// f at a point.
    pub(super) fn value(&self, z: Complex) -> f64 {
        self.terms.iter().map(|term| term.raised(z, 0).re).sum()
    }

    /// psi at a point.
    pub(super) fn psi(&self, z: Complex) -> f64 {
        self.terms.iter().map(|term| -0.25 / term.product() * term.raised(z, 1).re).sum()
    }

    /// The function r with `int f = oint (x.n) r`: each term over its degree plus 2.
    pub(super) fn radial(&self, z: Complex) -> f64 {
        let part = |term: &Term| term.raised(z, 0).re / (term.degree() + 2.0);
        self.terms.iter().map(part).sum()
    }

    /// The function r with `int f psi = oint (x.n) r`.
    pub(super) fn radial_with_psi(&self, z: Complex) -> f64 {
        let mut sum = 0.0;
        for f in &self.terms {
            for psi in &self.terms {
                let degree = f.degree() + psi.degree() + 2.0;
                sum -=
                    0.25 / psi.product() * f.raised(z, 0).re * psi.raised(z, 1).re / (degree + 2.0);
            }
        }
        sum
    }

    /// Gradient of psi at a point.
    pub(super) fn psi_gradient(&self, z: Complex) -> Complex {
        let mut sum = Complex::default();
        for term in &self.terms {
            let [j, k] = term.powers.map(|power| power as f64 + 1.0);
            let lowered = |powers: [usize; 2]| Term { powers, ..*term }.raised(z, 0);
            let [p, q] = term.powers;
            let slopes = lowered([p, q + 1]).scaled(j).conj() + lowered([p + 1, q]).scaled(k);
            sum = sum - slopes.scaled(0.25 / term.product());
        }
        sum
    }
}

impl Term {
    fn degree(&self) -> f64 {
        (self.powers[0] + self.powers[1]) as f64
    }

    fn product(&self) -> f64 {
        (self.powers[0] as f64 + 1.0) * (self.powers[1] as f64 + 1.0)
    }

    /// The term with both powers higher by `more`.
    fn raised(&self, z: Complex, more: usize) -> Complex {
        let mut value = self.factor;
        (0..self.powers[0] + more).for_each(|_| value = value * z);
        (0..self.powers[1] + more).for_each(|_| value = value * z.conj());
        value
    }
}

/// Coefficients of products of Chebyshev polynomials up to a degree each, on the square from -1 to 1, row by row in x.
fn chebyshev(f: &impl Fn([f64; 2]) -> f64, degree: usize) -> Vec<f64> {
    let many = degree + 1;
    let nodes: Vec<f64> =
        (0..many).map(|k| libm::cos(PI * (k as f64 + 0.5) / many as f64)).collect();
    let cosine = |j: usize, k: usize| libm::cos(PI * j as f64 * (k as f64 + 0.5) / many as f64);
    let mut values = Vec::with_capacity(many * many);
    for &x in &nodes {
        values.extend(nodes.iter().map(|&y| f([x, y])));
    }
    let mut coefficients = vec![0.0; many * many];
    for i in 0..many {
        for j in 0..many {
            let share = if i == 0 { 1.0 } else { 2.0 } * if j == 0 { 1.0 } else { 2.0 }
                / (many * many) as f64;
            for k in 0..many {
                for l in 0..many {
                    coefficients[i * many + j] +=
                        share * cosine(i, k) * cosine(j, l) * values[k * many + l];
                }
            }
        }
    }
    coefficients
}

/// Polynomial of one variable, the coefficient of degree zero first.
type Series = Vec<Complex>;

/// The sum of products of Chebyshev polynomials as terms in z and its conjugate.
fn terms(coefficients: &[f64], degree: usize, middle: [f64; 2], half: [f64; 2]) -> Vec<Term> {
    let many = degree + 1;
    let largest = coefficients.iter().fold(0.0f64, |most, c| most.max(c.abs()));
    // Powers of z (rows) and of its conjugate.
    let mut sums = vec![Complex::default(); (2 * many) * (2 * many)];
    // x = (z + conj z) / 2 and y = (z - conj z) / 2i, as polynomials in both, scaled to the square.
    let linear = |axis: usize| {
        let factor = if axis == 0 { Complex::new(0.5, 0.0) } else { Complex::new(0.0, -0.5) };
        let scale = 1.0 / half[axis];
        let constant = Complex::new(-middle[axis] * scale, 0.0);
        let other = if axis == 0 { factor } else { -factor };
        [constant, factor.scaled(scale), other.scaled(scale)]
    };
    let powers = [0, 1].map(|axis| {
        let line = linear(axis);
        let mut known = vec![Pairs::one(many), Pairs::one(many).times(line)];
        for k in 2..many {
            let next = known[k - 1].times(line).scaled_less(2.0, &known[k - 2]);
            known.push(next);
        }
        known
    });
    for i in 0..many {
        for j in 0..many {
            let c = coefficients[i * many + j];
            if c.abs() > 1e-15 * largest {
                powers[0][i].product_into(&powers[1][j], c, &mut sums, 2 * many);
            }
        }
    }
    let mut terms = Vec::new();
    for j in 0..2 * many {
        for k in 0..2 * many {
            let factor = sums[j * 2 * many + k];
            if factor.norm() > 0.0 {
                terms.push(Term { powers: [j, k], factor });
            }
        }
    }
    terms
}

/// Polynomial in z and its conjugate, of a degree below `many` in each.
struct Pairs {
    many: usize,
    factors: Series,
}

impl Pairs {
    fn one(many: usize) -> Self {
        let mut factors = vec![Complex::default(); many * many];
        factors[0] = Complex::new(1.0, 0.0);
        Self { many, factors }
    }

    /// Product with `constant + a z + b conj(z)`.
    fn times(&self, [constant, a, b]: [Complex; 3]) -> Self {
        let many = self.many;
        let mut factors = vec![Complex::default(); many * many];
        for j in 0..many {
            for k in 0..many {
                let own = self.factors[j * many + k];
                if own.norm2() == 0.0 {
                    continue;
                }
                factors[j * many + k] = factors[j * many + k] + own * constant;
                if j + 1 < many {
                    factors[(j + 1) * many + k] = factors[(j + 1) * many + k] + own * a;
                }
                if k + 1 < many {
                    factors[j * many + k + 1] = factors[j * many + k + 1] + own * b;
                }
            }
        }
        Self { many, factors }
    }

    /// A multiple of this less another one.
    fn scaled_less(self, factor: f64, other: &Self) -> Self {
        let factors = self.factors.iter().zip(&other.factors).map(|(a, b)| a.scaled(factor) - *b);
        Self { many: self.many, factors: factors.collect() }
    }

    /// Adds a multiple of the product with another one.
    fn product_into(&self, other: &Self, factor: f64, sums: &mut [Complex], width: usize) {
        let many = self.many;
        for (at, a) in self.factors.iter().enumerate().filter(|(_, a)| a.norm2() > 0.0) {
            for (to, b) in other.factors.iter().enumerate().filter(|(_, b)| b.norm2() > 0.0) {
                let place = (at / many + to / many) * width + at % many + to % many;
                sums[place] = sums[place] + (*a * *b).scaled(factor);
            }
        }
    }
}
