//! Harmonic functions whose sum is fitted: fractional powers and logarithms at points of the boundary and behind it,
//! with cuts of finite length outside of the domain; functions of holes; polynomials.
//!
//! Gopal and Trefethen, *Solving Laplace problems with corner singularities via rational functions*, SIAM J. Numer.
//! Anal. 57 (2019), have poles alone; here the powers of the corner itself make the convergence exponential. The
//! polynomials are those of Brubeck, Nakatsukasa and Trefethen, *Vandermonde with Arnoldi*, SIAM Rev. 63 (2021).

use super::panels::Spot;
use crate::machine::simd::vectorised;
use crate::problem::complex::Complex;
use crate::spectral::complex::ln;
use crate::spectral::elementary::{exp, sincos_pi};
use std::f64::consts::PI;

/// u^power, or u^power log u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Power {
    pub power: f64,
    pub log: bool,
}

impl Power {
    pub(super) const fn plain(power: f64) -> Self {
        Self { power, log: false }
    }

    pub(super) const fn with_log(power: f64) -> Self {
        Self { power, log: true }
    }
}

/// Functions of `u = w / (w + d)` with `w = (z - point) / inwards`: cut from the point outwards, of length d.
#[derive(Clone, Debug)]
pub(super) struct Family {
    pub point: Complex,
    /// Number of the split that the point is.
    pub split: Option<usize>,
    /// Unit vector into the domain.
    pub inwards: Complex,
    pub lengths: Vec<f64>,
    pub powers: Vec<Power>,
}

/// Functions of a hole: the logarithm with a real coefficient, and negative powers of `(z - middle) / radius`.
#[derive(Clone, Debug)]
pub(super) struct Hole {
    pub middle: Complex,
    pub radius: f64,
    pub powers: usize,
}

/// All functions, in the order families, powers of holes, polynomials, logarithms of holes.
#[derive(Clone, Debug, Default)]
pub(super) struct Functions {
    pub families: Vec<Family>,
    pub holes: Vec<Hole>,
    /// Arnoldi's matrix, column by column, each with one entry more than the last.
    pub arnoldi: Vec<Vec<Complex>>,
}

/// Values of functions at points, function by function.
pub(super) struct Values {
    /// Number of points.
    pub points: usize,
    pub all: Vec<Complex>,
    /// Derivatives, if wanted.
    pub slopes: Vec<Complex>,
}

impl Values {
    pub(super) fn of(&self, function: usize) -> &[Complex] {
        &self.all[function * self.points..(function + 1) * self.points]
    }
}

impl Functions {
    /// Number of complex functions but logarithms of holes.
    pub(super) fn complex(&self) -> usize {
        self.own() + self.arnoldi.len() + 1
    }

    /// Number of functions but polynomials and logarithms of holes.
    fn own(&self) -> usize {
        let families =
            self.families.iter().map(|family| family.lengths.len() * family.powers.len());
        families.sum::<usize>() + self.holes.iter().map(|hole| hole.powers).sum::<usize>()
    }

    /// Real unknowns: the imaginary part of the constant is none, nor that of a coefficient of a logarithm of a hole.
    pub(super) fn unknowns(&self) -> usize {
        2 * self.complex() - 1 + self.holes.len()
    }

    /// Finds polynomials that are orthogonal on the spots, up to a degree.
    pub(super) fn orthogonalise(&mut self, spots: &[Spot], degree: usize) {
        let many = spots.len();
        let mut basis = vec![vec![Complex::new(1.0, 0.0); many]];
        self.arnoldi.clear();
        for k in 0..degree {
            let mut next: Vec<Complex> =
                basis[k].iter().zip(spots).map(|(q, spot)| *q * spot.z).collect();
            let mut column = Vec::with_capacity(k + 2);
            for known in &basis {
                let product = vectorised(
                    #[inline(always)]
                    || projected(known, &mut next),
                );
                column.push(product);
            }
            let size = (next.iter().map(|q| q.norm2()).sum::<f64>() / many as f64).sqrt();
            next.iter_mut().for_each(|q| *q = q.scaled(1.0 / size));
            column.push(Complex::new(size, 0.0));
            basis.push(next);
            self.arnoldi.push(column);
        }
    }

    /// Values of all functions at spots, with derivatives if wanted.
    pub(super) fn at(&self, spots: &[Spot], slopes: bool) -> Values {
        let many = spots.len();
        let total = (self.complex() + self.holes.len()) * many;
        let mut values = Vec::with_capacity(total);
        let mut derivatives = Vec::with_capacity(if slopes { total } else { 0 });
        for family in &self.families {
            vectorised(
                #[inline(always)]
                || family.add(spots, slopes, &mut values, &mut derivatives),
            );
        }
        for hole in &self.holes {
            hole.add_powers(spots, slopes, &mut values, &mut derivatives);
        }
        let first = values.len();
        values.resize(first + many, Complex::new(1.0, 0.0));
        if slopes {
            derivatives.resize(first + many, Complex::default());
        }
        for column in &self.arnoldi {
            vectorised(
                #[inline(always)]
                || {
                    recur(column, spots, first, &mut values, None);
                },
            );
            if slopes {
                vectorised(
                    #[inline(always)]
                    || recur(column, spots, first, &mut derivatives, Some(&values)),
                );
            }
        }
        for hole in &self.holes {
            values.extend(spots.iter().map(|spot| ln(spot.z - hole.middle)));
            if slopes {
                let one = Complex::new(1.0, 0.0);
                derivatives.extend(spots.iter().map(|spot| one / (spot.z - hole.middle)));
            }
        }
        Values { points: many, all: values, slopes: derivatives }
    }
}

/// Subtracts the part of a vector along another one of norm 1 per entry; returns its coefficient.
#[inline(always)]
fn projected(known: &[Complex], next: &mut [Complex]) -> Complex {
    let mut sum = Complex::default();
    for (q, w) in known.iter().zip(next.iter()) {
        sum = sum + q.conj() * *w;
    }
    let product = sum.scaled(1.0 / known.len() as f64);
    for (q, w) in known.iter().zip(next) {
        *w = *w - *q * product;
    }
    product
}

/// Adds the next polynomial, or its derivative from those before and the `polynomials`.
#[inline(always)]
fn recur(
    column: &[Complex],
    spots: &[Spot],
    first: usize,
    into: &mut Vec<Complex>,
    polynomials: Option<&[Complex]>,
) {
    let (many, k) = (spots.len(), column.len() - 2);
    let at = first + k * many;
    for i in 0..many {
        let own = into[at + i] * spots[i].z;
        into.push(polynomials.map_or(own, |polynomials| own + polynomials[at + i]));
    }
    let (known, next) = into.split_at_mut(at + many);
    for (j, factor) in column[..=k].iter().enumerate() {
        let other = &known[first + j * many..first + (j + 1) * many];
        for (w, q) in next.iter_mut().zip(other) {
            *w = *w - *q * *factor;
        }
    }
    let scale = 1.0 / column[k + 1].re;
    next.iter_mut().for_each(|w| *w = w.scaled(scale));
}

impl Family {
    /// Position of a spot seen from the point.
    #[inline(always)]
    fn seen(&self, spot: &Spot) -> Complex {
        let from = if self.split == Some(spot.split) { spot.delta } else { spot.z - self.point };
        let seen = from * self.inwards.conj();
        // Powers of zero have no derivative.
        if seen.norm2() == 0.0 { Complex::new(1e-100, 0.0) } else { seen }
    }

    #[inline(always)]
    fn add(
        &self,
        spots: &[Spot],
        slopes: bool,
        values: &mut Vec<Complex>,
        derivatives: &mut Vec<Complex>,
    ) {
        let seen: Vec<Complex> = spots.iter().map(|spot| self.seen(spot)).collect();
        let needs_logs = self.powers.iter().any(|power| power.log || power.power != 1.0);
        for &d in &self.lengths {
            let u: Vec<Complex> = seen.iter().map(|&w| w / w.shifted(d)).collect();
            let logs: Vec<Complex> =
                if needs_logs { u.iter().map(|&u| ln(u)).collect() } else { Vec::new() };
            // The derivative of log u.
            let mut rates = Vec::new();
            if slopes {
                let turn = self.inwards.conj().scaled(d);
                rates.extend(seen.iter().map(|&w| turn / (w * w.shifted(d))));
            }
            // Each power by a product from that before it, and the factor again where they are as far apart.
            let mut powers = vec![Complex::new(1.0, 0.0); spots.len()];
            let (mut reached, mut apart, mut factors) = (0.0, 0.0, powers.clone());
            for &Power { power, log } in &self.powers {
                let step = power - reached;
                if (step - apart).abs() > SAME_STEP && step != 0.0 {
                    if step == 1.0 {
                        factors.copy_from_slice(&u);
                    } else {
                        raise(&logs, step, &mut factors);
                    }
                    apart = step;
                }
                if step != 0.0 {
                    powers.iter_mut().zip(&factors).for_each(|(x, factor)| *x = *x * *factor);
                    reached = if apart == step { power } else { reached + apart };
                }
                if slopes && log {
                    let logs = logs.iter().zip(&powers).zip(&rates);
                    derivatives.extend(
                        logs.map(|((l, value), rate)| {
                            *value * l.scaled(reached).shifted(1.0) * *rate
                        }),
                    );
                } else if slopes {
                    let both = powers.iter().zip(&rates);
                    derivatives.extend(both.map(|(value, rate)| (*value * *rate).scaled(reached)));
                }
                if log {
                    values.extend(powers.iter().zip(&logs).map(|(value, l)| *value * *l));
                } else {
                    values.extend_from_slice(&powers);
                }
            }
        }
    }
}

/// Largest difference of steps between powers that are the same but for rounding.
const SAME_STEP: f64 = 2e-15;

/// Exponentials of a multiple of logarithms.
#[inline(always)]
fn raise(logs: &[Complex], power: f64, into: &mut [Complex]) {
    for (value, l) in into.iter_mut().zip(logs) {
        let size = exp(power * l.re);
        let [sin, cos] = sincos_pi(power / PI * l.im);
        *value = Complex::new(size * cos, size * sin);
    }
}

impl Hole {
    fn add_powers(
        &self,
        spots: &[Spot],
        slopes: bool,
        values: &mut Vec<Complex>,
        derivatives: &mut Vec<Complex>,
    ) {
        let inverses: Vec<Complex> = spots
            .iter()
            .map(|spot| Complex::new(self.radius, 0.0) / (spot.z - self.middle))
            .collect();
        let mut powers = vec![Complex::new(1.0, 0.0); spots.len()];
        for k in 1..=self.powers {
            powers
                .iter_mut()
                .zip(&inverses)
                .for_each(|(power, inverse)| *power = *power * *inverse);
            values.extend_from_slice(&powers);
            if slopes {
                let factor = -(k as f64) / self.radius;
                let slopes = powers
                    .iter()
                    .zip(&inverses)
                    .map(|(power, inverse)| (*power * *inverse).scaled(factor));
                derivatives.extend(slopes);
            }
        }
    }
}
