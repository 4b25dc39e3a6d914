//! Ends of contact: the expansion of v there, and how far from the true end that which was found is.
//!
//! The first coefficient K of the expansion vanishes at the true end ([`newton`](super::newton)). What the conditions
//! are missed by, rho(s) at a distance s from the end, changes it: next to a straight line, one half of which sticks,
//! by at most
//! ```text
//! 1/pi int |rho| s^(-3/2) ds,
//! ```
//! where a constant on either side does not count: on the free one that of the integral of the flux is unknown, on
//! the other g takes it. Beyond a corner at a distance e, where v looks like the power p of s, a conformal map to the
//! line has the kernel `s^(-3/2) (e/s)^(p - 1/2)`. Newton's method turns an error of K into one of the end.

use super::boundary::State;
use super::fit::Fit;
use super::search::PlaneFound;
use super::setup::Setup;
use crate::problem::complex::Complex;
use std::f64::consts::PI;

/// `v = K r^(1/2) + K1 r^(3/2)` at a distance r from an end, on the side that does not stick.
#[derive(Clone, Copy, Debug)]
pub(super) struct EndExpansion {
    /// Number of the split that the end is.
    pub split: usize,
    /// Arc of the contact set, and 0 for its beginning or 1 for its end.
    pub arc: usize,
    pub which: usize,
    /// K and K1.
    pub coefficients: [f64; 2],
    /// Rounding error of K.
    rounding: f64,
}

impl EndExpansion {
    /// Step of Newton's method towards the free side.
    pub(super) fn step(&self) -> f64 {
        let [k, k1] = self.coefficients;
        -k / (1.5 * k1)
    }
}

impl Fit {
    /// Expansions at all ends that may move.
    pub(super) fn ends(&self) -> Vec<EndExpansion> {
        let mut ends = Vec::new();
        let mut first = 0;
        for family in &self.functions.families {
            let many = family.powers.len();
            let own = &self.coefficients[first..first + many * family.lengths.len()];
            first += many * family.lengths.len();
            let Some(split) = family.split else { continue };
            let Some((arc, which)) = self.walk.splits[split].end else { continue };
            let (mut b0, mut b1, mut size) = (Complex::default(), Complex::default(), 0.0);
            for (c, d) in own.chunks_exact(many).zip(&family.lengths) {
                let root = 1.0 / d.sqrt();
                b0 = b0 + c[0].scaled(root);
                b1 = b1 + (c[2] - c[0].scaled(0.5)).scaled(root / d);
                size += root * c[0].norm();
            }
            // On the free side w = f r.
            let f = Complex::new(0.0, if which == 0 { 1.0 } else { -1.0 });
            let root = f.sqrt();
            let coefficients = [(root * b0).re, (root * f * b1).re];
            ends.push(EndExpansion {
                split,
                arc,
                which,
                coefficients,
                rounding: f64::EPSILON * size,
            });
        }
        ends
    }
}

impl PlaneFound {
    /// Errors of the ends of the arcs of each loop, as distances along the boundary; zero of those that cannot move.
    pub(super) fn end_errors(&self, setup: &Setup) -> Vec<Vec<[f64; 2]>> {
        let mut errors: Vec<Vec<[f64; 2]>> =
            self.contact.iter().map(|own| vec![[0.0; 2]; own.arcs.len()]).collect();
        for end in self.fit.ends() {
            let ring = self.fit.walk.splits[end.split].ring;
            errors[ring][end.arc][end.which] = self.end_error(setup, &end);
        }
        errors
    }

    /// Error of an end, which is one step of Newton's method beyond that of the fit.
    fn end_error(&self, setup: &Setup, end: &EndExpansion) -> f64 {
        /// Part of the distance to the next split within which the error of a step is that times the step.
        const PART: f64 = 0.1;
        let split = &self.fit.walk.splits[end.split];
        let near = split.lengths[0].min(split.lengths[1]);
        let step = end.step().abs();
        let after_step = step * (step / (PART * near)).min(1.0);
        let moved = (end.rounding + self.missed_beside(end.split, near))
            / (1.5 * end.coefficients[1].abs());
        (after_step + moved).min(setup.perimeter)
    }

    /// Bound of the change of K by what the conditions are missed by.
    fn missed_beside(&self, split: usize, near: f64) -> f64 {
        let power = self.fit.walk.power_beside(split);
        // On the side that sticks, and on the other.
        let mut constants = [0.0; 2];
        let mut nearest = [f64::INFINITY; 2];
        for node in self.nodes.iter().filter(|node| node.spot.split == split) {
            let side = usize::from(node.state != State::Held);
            if node.spot.offset < nearest[side] {
                (nearest[side], constants[side]) = (node.spot.offset, node.residual);
            }
        }
        let mut sum = 0.0;
        for node in &self.nodes {
            let missed = node.residual - constants[usize::from(node.state != State::Held)];
            let s = match node.spot.split == split {
                true => node.spot.offset,
                false => (node.spot.z - self.fit.walk.splits[split].z).norm(),
            };
            let beyond = if s > near { libm::pow(near / s, power - 0.5) } else { 1.0 };
            sum += node.spot.weight * missed.abs() * beyond / (s * s.sqrt());
        }
        sum / PI
    }
}

#[cfg(test)]
mod tests;
