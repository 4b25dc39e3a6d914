//! Polynomial right-hand sides.

use super::domain::PlaneDomain;
use super::least_squares::Columns;
use crate::problem::complex::Complex;
use std::f64::consts::PI;

/// Polynomial in x and y that takes the place of a formula: the real part of a sum of `c z^j conj(z)^k`.
#[derive(Clone, Debug)]
pub(crate) struct Polynomial {
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
    /// It is fitted on the box round the domain, with the lowest degree of 2, 4, 8 and 12 that is right to rounding
    /// between the points of the fit.
    pub(crate) fn fitted(f: impl Fn([f64; 2]) -> f64, domain: &PlaneDomain) -> Self {
        let extent = domain.extent();
        let at = |x: [f64; 2]| -> [f64; 2] {
            std::array::from_fn(|axis| {
                let [low, high] = extent[axis];
                0.5 * (low + high + (high - low) * x[axis])
            })
        };
        let mut best = Self { terms: Vec::new(), error: f64::INFINITY };
        for degree in [2, 4, 8, 12] {
            let nodes: Vec<f64> =
                (0..=2 * degree).map(|k| libm::cos(PI * k as f64 / (2 * degree) as f64)).collect();
            let pairs = nodes.iter().flat_map(|&x| nodes.iter().map(move |&y| [x, y]));
            let points: Vec<[f64; 2]> = pairs.map(at).collect();
            let mut found = Self { terms: fit(&f, &points, degree), error: f64::INFINITY };
            let (mut worst, mut largest) = (0.0f64, 0.0f64);
            for k in 0..400 {
                let [x, y] = [0.618_034 * f64::from(k) + 0.31, 0.754_878 * f64::from(k) + 0.17];
                let point = at([x, y].map(|x| 2.0 * (x - x.floor()) - 1.0));
                let value = f(point);
                worst = worst.max((found.value(Complex::new(point[0], point[1])) - value).abs());
                largest = largest.max(value.abs());
            }
            found.error = if worst > 0.0 { worst / largest } else { 0.0 };
            if found.error < best.error {
                best = found;
            }
            if best.error < 1e-13 {
                break;
            }
        }
        best
    }

    /// Polynomial with another error.
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
        self.terms.iter().map(|term| term.raised(z, 0).re / (term.degree() + 2.0)).sum()
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

    /// Bounds of the moduli of f, of psi and of the gradient of psi for |z| up to a radius, also for complex
    /// coordinates with z and conj(z) up to that radius each.
    pub(super) fn moduli(&self, radius: f64) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for term in &self.terms {
            let (degree, quarter) = (term.degree(), 0.25 / term.product());
            let size = term.factor.norm() * libm::pow(radius, degree);
            sums[0] += size;
            sums[1] += quarter * size * radius * radius;
            sums[2] += quarter * size * radius * (degree + 2.0);
        }
        sums
    }

    /// Gradient of psi at a point.
    pub(super) fn psi_gradient(&self, z: Complex) -> Complex {
        let mut sum = Complex::default();
        for term in &self.terms {
            let [j, k] = term.powers.map(|power| power as f64 + 1.0);
            let [p, q] = term.powers;
            let [by_z, by_conjugate] =
                [[p, q + 1], [p + 1, q]].map(|powers| Term { powers, ..*term }.raised(z, 0));
            let slopes = by_z.scaled(j).conj() + by_conjugate.scaled(k);
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

/// Terms up to a degree whose sum is nearest to a function at points.
fn fit(f: impl Fn([f64; 2]) -> f64, points: &[[f64; 2]], degree: usize) -> Vec<Term> {
    // The term with both powers swapped is the same but for the sign of its imaginary part.
    let powers = (0..=degree).flat_map(|j| (0..=j.min(degree - j)).map(move |k| [j, k]));
    let powers: Vec<[usize; 2]> = powers.collect();
    let unknowns = powers.iter().map(|[j, k]| if j == k { 1 } else { 2 }).sum();
    let mut columns = Columns::new(points.len(), unknowns);
    let mut next = 0;
    for &[j, k] in &powers {
        let one = Term { powers: [j, k], factor: Complex::new(1.0, 0.0) };
        let values: Vec<Complex> =
            points.iter().map(|&[x, y]| one.raised(Complex::new(x, y), 0)).collect();
        columns.column(next).iter_mut().zip(&values).for_each(|(x, value)| *x = value.re);
        if j != k {
            columns.column(next + 1).iter_mut().zip(&values).for_each(|(x, value)| *x = -value.im);
        }
        next += if j == k { 1 } else { 2 };
    }
    columns.column(unknowns).iter_mut().zip(points).for_each(|(x, &point)| *x = f(point));
    let solution = columns.solve();
    let mut next = 0;
    let mut terms: Vec<Term> = Vec::with_capacity(powers.len());
    for [j, k] in powers {
        let im = if j == k { 0.0 } else { solution[next + 1] };
        terms.push(Term { powers: [j, k], factor: Complex::new(solution[next], im) });
        next += if j == k { 1 } else { 2 };
    }
    terms
}
