//! v and its slopes at the Gauss points of a cell, and bounds of them on all of it.

use super::cells::{POINTS, ProofCell, legendre};
use super::moduli::Moduli;
use crate::machine::simd::vectorised;
use crate::spectral::fit::field::PlaneNode;
use crate::spectral::source::psi_sizes::PsiSizes;
use std::sync::LazyLock;

/// Weights of all cells.
static LEGENDRE: LazyLock<Vec<[f64; POINTS]>> = LazyLock::new(legendre);

/// Which function on the boundary is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Quantity {
    /// v.
    Value,
    /// v less the value of the law.
    Above,
    /// dv/dn.
    Flux,
    /// Derivative of that along the boundary.
    Slope,
}

impl Quantity {
    /// 0 for values, 1 for slopes.
    fn which(self) -> usize {
        usize::from(matches!(self, Self::Flux | Self::Slope))
    }
}

/// Bounds of moduli on the ellipse of a cell, as sums of `factor r^power`; for slopes of r times them.
#[derive(Clone, Debug, Default)]
pub(super) struct CellModuli {
    pub value: Vec<[f64; 2]>,
    pub slope: Vec<[f64; 2]>,
    /// All but the functions of the split.
    pub rest: Moduli,
    pub psi: Moduli,
    /// The value of the law, which is in all but psi too.
    pub at: Moduli,
}

/// Values on a cell.
pub(super) struct Sampled {
    pub own: ProofCell,
    pub nodes: Vec<PlaneNode>,
    /// Derivatives of v less the value of the law along the boundary.
    pub slopes: Vec<f64>,
    /// Bounds of the rounding errors of values and of slopes.
    pub rounding: Vec<[f64; 2]>,
    /// Those of psi and its gradient.
    pub psi: Vec<PsiSizes>,
    pub moduli: CellModuli,
    /// Distances from the end.
    distances: Vec<f64>,
}

/// A quantity less a constant, times a sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Test {
    pub quantity: Quantity,
    pub sign: f64,
    pub constant: f64,
}

impl Test {
    pub(super) const fn of(quantity: Quantity) -> Self {
        Self { quantity, sign: 1.0, constant: 0.0 }
    }
}

/// Bounds of the part of a function below zero, on a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deficit {
    /// The largest.
    pub most: f64,
    /// Integral.
    pub integral: f64,
    /// The largest, on a cell in log r times r.
    pub scaled: f64,
    /// Least value, if that is positive, else zero.
    pub room: f64,
}

impl Sampled {
    /// No values yet, at points with these distances from the end.
    pub(super) fn new(own: ProofCell, moduli: CellModuli, distances: Vec<f64>) -> Self {
        let (nodes, slopes, rounding, psi) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { own, nodes, slopes, rounding, psi, moduli, distances }
    }

    /// Adds the rounding errors of psi, and of coordinates that are off by two units in the last place, to those of g;
    /// `f` bounds f here, and `curvature` is that of the boundary.
    ///
    /// On a cell in log r the functions of the split do not see the error of coordinates, but all see one of log r,
    /// by a unit and one for each of its length. On another one all functions see the same point.
    pub(super) fn add_rounding(&mut self, f: f64, curvature: f64) {
        let cell = &self.own.cell;
        let bends = [Quantity::Flux, Quantity::Slope].map(|own| self.bend(Test::of(own)));
        let bend = bends[0] + bends[1];
        let sizes = self.nodes.iter().zip(&self.slopes);
        let sizes: Vec<f64> = sizes
            .map(|(node, slope)| node.flux.abs() + slope.abs() + self.moduli.at.slope)
            .collect();
        let most = sizes.iter().fold(0.0f64, |most, size| most.max(*size));
        // The normal is off too.
        let turned = most * (1.0 + 2.0 * curvature.abs());
        for (i, [value, derivative]) in self.rounding.iter_mut().enumerate() {
            let (r, rest) = (self.distances[i], self.moduli.rest.slope);
            let [slope, curvature] = match cell.is_log {
                true => {
                    let part = 0.5 * (1.0 + cell.length());
                    let along = part * (bend / r + sizes[i]);
                    [rest + part * r * sizes[i], rest / cell.disc.radius + along]
                }
                false => [2.0 * most, bend + turned + f],
            };
            *value += self.psi[i].value + 2.0 * f64::EPSILON * slope;
            *derivative += self.psi[i].slope + 2.0 * f64::EPSILON * curvature;
        }
    }

    /// Bound of the derivative of a slope, of r times it on a cell in log r, by the variable of the cell: by the
    /// derivatives of Legendre's polynomials, `k (k + 1) / 2` at most on (-1, 1).
    fn bend(&self, test: Test) -> f64 {
        let cell = &self.own.cell;
        let (power, scale) = if cell.is_log { (1.0, cell.span[1]) } else { (0.0, 1.0) };
        let mut sum = 0.0;
        for (k, c) in self.legendre(test, &self.weights(power)).into_iter().enumerate() {
            sum += 0.5 * (k * (k + 1)) as f64 * c.abs();
        }
        let tail = cell.tail(self.modulus(test, power)) * (POINTS * POINTS) as f64;
        2.0 * scale * (sum + tail) / cell.length()
    }

    fn tested(&self, test: Test, i: usize) -> f64 {
        let raw = match test.quantity {
            Quantity::Value => self.nodes[i].value,
            Quantity::Above => self.nodes[i].above(),
            Quantity::Flux => self.nodes[i].flux,
            Quantity::Slope => self.slopes[i],
        };
        test.sign * (raw - test.constant)
    }

    /// Lower bound, and upper bound of the modulus, of a tested function times `(r / to)^power`, to the longest
    /// distance of the cell.
    ///
    /// The polynomial through the values is at most the sum of the moduli of its coefficients in Legendre's
    /// polynomials.
    pub(super) fn bounds(&self, test: Test, power: f64) -> [f64; 2] {
        let which = test.quantity.which();
        let (mut error, weights) = (0.0f64, self.weights(power));
        for (weight, errors) in weights.iter().zip(&self.rounding) {
            error = error.max(weight * errors[which]);
        }
        let slack = self.own.cell.tail(self.modulus(test, power)) + POINTS as f64 * error;
        let mut sums = [0.0; 2];
        for (k, c) in self.legendre(test, &weights).into_iter().enumerate() {
            sums[0] += if k == 0 { c } else { -c.abs() };
            sums[1] += c.abs();
        }
        [sums[0] - slack, sums[1] + slack]
    }

    /// `(r / to)^power` at the points.
    fn weights(&self, power: f64) -> [f64; POINTS] {
        let mut weights = [1.0; POINTS];
        if power != 0.0 {
            for (weight, r) in weights.iter_mut().zip(&self.distances) {
                let ratio = r / self.own.cell.span[1];
                *weight = if power == 1.0 { ratio } else { libm::pow(ratio, power) };
            }
        }
        weights
    }

    /// Coefficients of Legendre polynomials of a tested function times weights.
    fn legendre(&self, test: Test, weights: &[f64; POINTS]) -> [f64; POINTS] {
        let values: [f64; POINTS] = std::array::from_fn(|i| weights[i] * self.tested(test, i));
        let mut coefficients = [0.0; POINTS];
        vectorised(
            #[inline(always)]
            || {
                for (value, weights) in values.iter().zip(LEGENDRE.iter()) {
                    for (c, weight) in coefficients.iter_mut().zip(weights) {
                        *c += weight * value;
                    }
                }
            },
        );
        coefficients
    }

    /// Bound of the modulus of a tested function times `(r / to)^power` on the ellipse.
    fn modulus(&self, test: Test, power: f64) -> f64 {
        let (cell, which) = (&self.own.cell, test.quantity.which());
        let terms = if which == 0 { &self.moduli.value } else { &self.moduli.slope };
        let constant = [[which as f64, test.constant.abs()]];
        let weights = cell.distances.map(|r| libm::pow(r / cell.span[1], power));
        let mut modulus = 0.0;
        for &[own, factor] in terms.iter().chain(&constant) {
            let [first, last] = cell.distances.map(|r| libm::pow(r, own - which as f64));
            modulus += factor * (first * weights[0]).max(last * weights[1]);
        }
        modulus
    }

    /// Largest modulus; of a slope on a cell in log r, times r.
    pub(super) fn most(&self, test: Test) -> f64 {
        let scaled = self.own.cell.is_log && test.quantity.which() == 1;
        match scaled {
            true => self.own.cell.span[1] * self.bounds(test, 1.0)[1],
            false => self.bounds(test, 0.0)[1],
        }
    }

    /// Bound of the deficit by rounding alone: of its integral.
    pub(super) fn noise(&self, quantity: Quantity) -> f64 {
        let cell = &self.own.cell;
        let which = quantity.which();
        let mut most = 0.0f64;
        for (r, error) in self.distances.iter().zip(&self.rounding) {
            most = most.max(error[which] * if cell.is_log && which == 1 { *r } else { 1.0 });
        }
        POINTS as f64 * most * if which == 1 { cell.length() } else { 1.0 }
    }

    /// Bounds of the part of a function below zero.
    pub(super) fn deficit(&self, test: Test) -> Deficit {
        let cell = &self.own.cell;
        let [from, to] = cell.span;
        let [first, last] = [0, POINTS - 1].map(|i| self.tested(test, i));
        let base = if cell.is_log && test.quantity.which() == 1 { 1.0 } else { 0.0 };
        let mut powers = vec![base];
        if first * last > 0.0 && cell.distances[0] > 0.0 {
            let ratio = libm::log(self.distances[POINTS - 1] / self.distances[0]);
            let power = -libm::log(last / first) / ratio;
            // Away from 1, where the integral below would lose digits.
            powers.push(if (power - 1.0).abs() < 0.01 { 0.99 } else { power.clamp(-4.0, 2.0) });
        }
        let infinite = f64::INFINITY;
        let mut best = Deficit { most: infinite, integral: infinite, scaled: infinite, room: 0.0 };
        for power in powers {
            let [least, _] = self.bounds(test, power);
            if !least.is_finite() {
                continue;
            }
            let ends = if from > 0.0 { libm::pow(from / to, -power) } else { 1.0 };
            if least >= 0.0 {
                let room = best.room.max(least * ends.min(1.0));
                best = Deficit { most: 0.0, integral: 0.0, scaled: 0.0, room };
                continue;
            }
            let (rest, ratio) = (1.0 - power, from / to);
            let integral = match rest == 0.0 {
                true => to * libm::log(to / from),
                false => to * (1.0 - libm::pow(ratio, rest)) / rest,
            };
            let scale = if cell.is_log { to * (ratio * ends).max(1.0) } else { ends.max(1.0) };
            best.most = best.most.min(-least * ends.max(1.0));
            best.integral = best.integral.min(-least * integral);
            best.scaled = best.scaled.min(-least * scale);
        }
        best
    }
}

#[cfg(test)]
mod tests;
