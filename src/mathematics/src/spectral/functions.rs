//! Harmonic functions whose sum is fitted: fractional powers and logarithms at points of the boundary and behind it,
//! with cuts of finite length outside of the domain; functions of holes; polynomials.
//!
//! Gopal and Trefethen, *Solving Laplace problems with corner singularities via rational functions*, SIAM J. Numer.
//! Anal. 57 (2019), have poles alone; here the powers of the corner itself make the convergence exponential. The
//! polynomials are those of Brubeck, Nakatsukasa and Trefethen, *Vandermonde with Arnoldi*, SIAM Rev. 63 (2021).

pub(super) mod choice;
pub(super) mod lanes;

use crate::machine::simd::vectorised;
use crate::problem::complex::Complex;
use crate::spectral::complex::ln;
use crate::spectral::elementary::{exp, sincos_pi};
use crate::spectral::functions::lanes::{ComplexLanes, TOGETHER, bounded_sum, summed};
use crate::spectral::geometry::panels::Spot;
use std::f64::consts::PI;

/// u^power, or u^power log u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Power {
    pub power: f64,
    pub log: bool,
}

impl Power {
    pub(crate) const fn plain(power: f64) -> Self {
        Self { power, log: false }
    }

    pub(crate) const fn with_log(power: f64) -> Self {
        Self { power, log: true }
    }
}

/// Functions of `u = w / (w + d)` with `w = (z - point) / inwards`: cut from the point outwards, of length d.
#[derive(Clone, Debug)]
pub(crate) struct Family {
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
pub(crate) struct Hole {
    pub middle: Complex,
    pub radius: f64,
    pub powers: usize,
}

/// All functions, in the order families, powers of holes, polynomials, logarithms of holes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Functions {
    pub families: Vec<Family>,
    pub holes: Vec<Hole>,
    /// Arnoldi's matrix, column by column, each with one entry more than the last.
    pub arnoldi: Vec<Vec<Complex>>,
}

/// Values of functions at up to [`TOGETHER`] points, function by function.
#[derive(Default)]
pub(crate) struct Values {
    pub all: Vec<ComplexLanes>,
    /// Derivatives, if wanted.
    pub slopes: Vec<ComplexLanes>,
    wants_slopes: bool,
}

impl Values {
    pub(crate) fn with_slopes() -> Self {
        Self { wants_slopes: true, ..Self::default() }
    }
}

/// Sum of functions at a spot.
pub(crate) struct SpotSum {
    pub value: Complex,
    /// Derivative.
    pub slope: Complex,
    /// Bounds of the rounding errors of both.
    pub errors: [f64; 2],
}

/// Positions of spots side by side.
struct SpotLanes {
    z: ComplexLanes,
    /// Splits next to the spots, and positions from there.
    splits: [usize; TOGETHER],
    deltas: ComplexLanes,
}

impl SpotLanes {
    /// Of some spots, the last of which stands for those that are missing.
    fn new(spots: &[Spot]) -> Self {
        let mut lanes = Self {
            z: ComplexLanes::ZERO,
            splits: [usize::MAX; TOGETHER],
            deltas: ComplexLanes::ZERO,
        };
        for lane in 0..TOGETHER {
            let spot = &spots[lane.min(spots.len() - 1)];
            lanes.z.set(lane, spot.z);
            lanes.splits[lane] = spot.split;
            lanes.deltas.set(lane, spot.delta);
        }
        lanes
    }
}

impl Functions {
    /// Number of complex functions but logarithms of holes.
    pub(crate) fn complex(&self) -> usize {
        self.own() + self.arnoldi.len() + 1
    }

    /// Number of functions but polynomials and logarithms of holes.
    fn own(&self) -> usize {
        self.families.iter().map(Family::many).sum::<usize>()
            + self.holes.iter().map(|hole| hole.powers).sum::<usize>()
    }

    /// Real unknowns: the imaginary part of the constant is none, nor that of a coefficient of a logarithm of a hole.
    pub(crate) fn unknowns(&self) -> usize {
        2 * self.complex() - 1 + self.holes.len()
    }

    /// Finds polynomials that are orthogonal on the spots, up to a degree.
    pub(crate) fn orthogonalise(&mut self, spots: &[Spot], degree: usize) {
        let z: Vec<ComplexLanes> =
            spots.chunks(TOGETHER).map(|spots| SpotLanes::new(spots).z).collect();
        let mut one = vec![ComplexLanes::filled(Complex::new(1.0, 0.0)); z.len()];
        // No spots, which the last one stands for, do not count.
        for lane in spots.len() - (z.len() - 1) * TOGETHER..TOGETHER {
            one[z.len() - 1].set(lane, Complex::default());
        }
        let mut basis = vec![one];
        self.arnoldi.clear();
        for k in 0..degree {
            let mut next = z.clone();
            let mut column = Vec::with_capacity(k + 2);
            vectorised(
                #[inline(always)]
                || next_polynomial(&basis, spots.len(), &mut next, &mut column),
            );
            basis.push(next);
            self.arnoldi.push(column);
        }
    }

    /// Finds values of all functions at up to [`TOGETHER`] spots.
    pub(crate) fn at(&self, spots: &[Spot], values: &mut Values) {
        let places = SpotLanes::new(spots);
        let total = self.complex() + self.holes.len();
        values.all.clear();
        values.all.reserve(total);
        values.slopes.clear();
        if values.wants_slopes {
            values.slopes.reserve(total);
        }
        vectorised(
            #[inline(always)]
            || self.add(&places, values),
        );
    }

    #[inline(always)]
    fn add(&self, places: &SpotLanes, values: &mut Values) {
        // Closures of iterators would not be inlined.
        for family in &self.families {
            family.add(places, values);
        }
        for hole in &self.holes {
            hole.add_powers(&places.z, values);
        }
        let first = values.all.len();
        values.all.push(ComplexLanes::filled(Complex::new(1.0, 0.0)));
        if values.wants_slopes {
            values.slopes.push(ComplexLanes::ZERO);
        }
        for (k, column) in self.arnoldi.iter().enumerate() {
            let mut next = values.all[first + k].times(&places.z);
            recur(column, &values.all[first..], &mut next);
            values.all.push(next);
            if values.wants_slopes {
                let mut next = values.slopes[first + k].times(&places.z);
                next.add_scaled(Complex::new(1.0, 0.0), &values.all[first + k]);
                recur(column, &values.slopes[first..], &mut next);
                values.slopes.push(next);
            }
        }
        for hole in &self.holes {
            hole.add_log(&places.z, values);
        }
    }

    /// Sums of the functions times coefficients at spots, and of their derivatives if wanted.
    pub(crate) fn sums(
        &self,
        coefficients: &[Complex],
        spots: &[Spot],
        slopes: bool,
    ) -> [Vec<Complex>; 2] {
        let mut values = if slopes { Values::with_slopes() } else { Values::default() };
        let mut all = [0; 2].map(|_| Vec::with_capacity(spots.len()));
        for block in spots.chunks(TOGETHER) {
            self.at(block, &mut values);
            all[0].extend(summed(coefficients, &values.all).first(block.len()));
            if slopes {
                all[1].extend(summed(coefficients, &values.slopes).first(block.len()));
            }
        }
        all
    }

    /// Sums of the functions and of their derivatives times coefficients at spots, with bounds of rounding errors.
    pub(crate) fn bounded_sums(&self, coefficients: &[Complex], spots: &[Spot]) -> Vec<SpotSum> {
        let (units, mut values) = (self.units(), Values::with_slopes());
        let mut sums = Vec::with_capacity(spots.len());
        for block in spots.chunks(TOGETHER) {
            self.at(block, &mut values);
            let (own, errors) = bounded_sum(coefficients, &units, &values.all);
            let (slopes, rates) = bounded_sum(coefficients, &units, &values.slopes);
            sums.extend((0..block.len()).map(|lane| SpotSum {
                value: own.get(lane),
                slope: slopes.get(lane),
                errors: [errors[lane], rates[lane]],
            }));
        }
        sums
    }

    /// Rounding errors of the functions, in units in the last place. A power is an exponential of its logarithm, whose
    /// errors count as often as the power says.
    fn units(&self) -> Vec<f64> {
        let mut units = Vec::with_capacity(self.complex() + self.holes.len());
        for family in &self.families {
            for _ in &family.lengths {
                units.extend(family.powers.iter().map(|power| 16.0 + 8.0 * power.power));
            }
        }
        units.extend(self.holes.iter().flat_map(|hole| (0..hole.powers).map(|k| 6.0 + k as f64)));
        units.extend((0..=self.arnoldi.len()).map(|k| 6.0 + k as f64));
        units.extend(self.holes.iter().map(|_| 6.0));
        units
    }
}

/// Makes the polynomial after a basis, from the places of points; adds its column of Arnoldi's matrix.
#[inline(always)]
fn next_polynomial(
    basis: &[Vec<ComplexLanes>],
    points: usize,
    next: &mut [ComplexLanes],
    column: &mut Vec<Complex>,
) {
    for (w, q) in next.iter_mut().zip(&basis[basis.len() - 1]) {
        *w = w.times(q);
    }
    for known in basis {
        let product = mean_product(known, next, points);
        for (w, q) in next.iter_mut().zip(known) {
            w.add_scaled(-product, q);
        }
        column.push(product);
    }
    let size = mean_product(next, next, points).re.sqrt();
    for w in next {
        w.scale(1.0 / size);
    }
    column.push(Complex::new(size, 0.0));
}

/// Mean of the products of conjugates of numbers with others at points.
#[inline(always)]
fn mean_product(one: &[ComplexLanes], other: &[ComplexLanes], points: usize) -> Complex {
    let mut sums = ComplexLanes::ZERO;
    for (q, w) in one.iter().zip(other) {
        for l in 0..TOGETHER {
            sums.set(l, sums.get(l) + q.get(l).conj() * w.get(l));
        }
    }
    let sum = sums.first(TOGETHER).fold(Complex::default(), |sum, own| sum + own);
    sum.scaled(1.0 / points as f64)
}

/// Completes the next polynomial, or its derivative, by those before.
#[inline(always)]
fn recur(column: &[Complex], known: &[ComplexLanes], next: &mut ComplexLanes) {
    let (size, factors) = column.split_last().expect("an entry for each polynomial");
    let mut own = *next;
    for (factor, other) in factors.iter().zip(known) {
        own.add_scaled(-*factor, other);
    }
    own.scale(1.0 / size.re);
    *next = own;
}

impl Family {
    /// Number of its functions.
    pub(crate) fn many(&self) -> usize {
        self.lengths.len() * self.powers.len()
    }

    /// Position of a place seen from the point.
    #[inline(always)]
    fn seen(&self, places: &SpotLanes, lane: usize) -> Complex {
        let is_next = self.split == Some(places.splits[lane]);
        let from = if is_next { places.deltas.get(lane) } else { places.z.get(lane) - self.point };
        let seen = from * self.inwards.conj();
        // Powers of zero have no derivative.
        if seen.norm2() == 0.0 { Complex::new(1e-100, 0.0) } else { seen }
    }

    #[inline(always)]
    fn add(&self, places: &SpotLanes, values: &mut Values) {
        let mut seen = ComplexLanes::ZERO;
        for l in 0..TOGETHER {
            seen.set(l, self.seen(places, l));
        }
        let needs_logs = self.powers.iter().any(|power| power.log || power.power != 1.0);
        for &d in &self.lengths {
            let (mut u, mut logs) = (seen, ComplexLanes::ZERO);
            for l in 0..TOGETHER {
                u.set(l, seen.get(l) / seen.get(l).shifted(d));
            }
            if needs_logs {
                for l in 0..TOGETHER {
                    logs.set(l, ln(u.get(l)));
                }
            }
            // The derivative of log u.
            let mut rates = ComplexLanes::ZERO;
            if values.wants_slopes {
                let turn = self.inwards.conj().scaled(d);
                for l in 0..TOGETHER {
                    let w = seen.get(l);
                    rates.set(l, turn / (w * w.shifted(d)));
                }
            }
            // Each power by a product from that before it, and the factor again where they are as far apart.
            let mut powers = ComplexLanes::filled(Complex::new(1.0, 0.0));
            let (mut reached, mut apart, mut factors) = (0.0, 0.0, powers);
            for &Power { power, log } in &self.powers {
                let step = power - reached;
                if (step - apart).abs() > SAME_STEP && step != 0.0 {
                    if step == 1.0 {
                        factors = u;
                    } else {
                        raise(&logs, step, &mut factors);
                    }
                    apart = step;
                }
                if step != 0.0 {
                    powers = powers.times(&factors);
                    reached = if apart == step { power } else { reached + apart };
                }
                if values.wants_slopes {
                    let mut slopes = powers;
                    for l in 0..TOGETHER {
                        let (value, rate) = (powers.get(l), rates.get(l));
                        let slope = if log {
                            value * logs.get(l).scaled(reached).shifted(1.0) * rate
                        } else {
                            (value * rate).scaled(reached)
                        };
                        slopes.set(l, slope);
                    }
                    values.slopes.push(slopes);
                }
                values.all.push(if log { powers.times(&logs) } else { powers });
            }
        }
    }
}

/// Largest difference of steps between powers that are the same but for rounding.
const SAME_STEP: f64 = 2e-15;

/// Exponentials of a multiple of logarithms.
#[inline(always)]
fn raise(logs: &ComplexLanes, power: f64, into: &mut ComplexLanes) {
    for l in 0..TOGETHER {
        let size = exp(power * logs.re[l]);
        let [sin, cos] = sincos_pi(power / PI * logs.im[l]);
        into.set(l, Complex::new(size * cos, size * sin));
    }
}

impl Hole {
    /// One over positions seen from the middle.
    #[inline(always)]
    fn inverses(&self, z: &ComplexLanes, size: f64) -> ComplexLanes {
        let mut inverses = *z;
        for l in 0..TOGETHER {
            inverses.set(l, Complex::new(size, 0.0) / (z.get(l) - self.middle));
        }
        inverses
    }

    #[inline(always)]
    fn add_powers(&self, z: &ComplexLanes, values: &mut Values) {
        let inverses = self.inverses(z, self.radius);
        let mut power = ComplexLanes::filled(Complex::new(1.0, 0.0));
        for k in 1..=self.powers {
            power = power.times(&inverses);
            values.all.push(power);
            if values.wants_slopes {
                let (mut slopes, factor) = (power, -(k as f64) / self.radius);
                for l in 0..TOGETHER {
                    slopes.set(l, (power.get(l) * inverses.get(l)).scaled(factor));
                }
                values.slopes.push(slopes);
            }
        }
    }

    #[inline(always)]
    fn add_log(&self, z: &ComplexLanes, values: &mut Values) {
        let mut logs = *z;
        for l in 0..TOGETHER {
            logs.set(l, ln(z.get(l) - self.middle));
        }
        values.all.push(logs);
        if values.wants_slopes {
            values.slopes.push(self.inverses(z, 1.0));
        }
    }
}
