//! Arcs of a solution that stick, and ends of contact: the expansion of v less the value of the law there, and
//! estimates of how far from the true ends those that were found are.
//!
//! The first coefficient K of the expansion vanishes at the true end ([`newton`](super::newton)). What the conditions
//! are missed by, rho(s) at a distance s from the end, changes it: on a half-plane, half of whose border sticks, by at
//! most
//! ```text
//! 1/pi int |rho| s^(-3/2) ds.
//! ```
//! A constant on either side does not count: on the free one that of the integral of the flux is unknown, on the other
//! g takes it. Beyond a corner of angle `pi/a` at a distance e, where v looks like the power p of s, the conformal map
//! `z^a` to the line makes the kernel `a^(3/2) s^(-3/2) (e/s)^(p - 1/2)`. Newton's method turns an error of K into one
//! of the end.

#[cfg(test)]
mod tests;

use super::search::PlaneFound;
use crate::discrete::contact::ContactArc;
use crate::mesh::Names;
use crate::problem::complex::Complex;
use crate::spectral::fit::Fit;
use crate::spectral::fit::field::PlaneNode;
use crate::spectral::geometry::boundary::State;
use crate::spectral::setup::Setup;
use std::f64::consts::PI;

/// `v - at = K r^(1/2) + K1 r^(3/2)` at a distance r from an end, on the side that does not stick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndExpansion {
    /// Number of the split that the end is.
    pub split: usize,
    /// Arc of the contact set, and 0 for its beginning or 1 for its end.
    pub arc: usize,
    pub which: usize,
    /// K and K1.
    pub coefficients: [f64; 2],
    /// Coefficient of r^(1/2) that violates the conditions, with the rounding error of K.
    missed: f64,
}

impl EndExpansion {
    /// Step of Newton's method towards the free side.
    pub(crate) fn step(&self) -> f64 {
        let [k, k1] = self.coefficients;
        -k / (1.5 * k1)
    }
}

impl Fit {
    /// Expansions at all ends that may move.
    pub(crate) fn ends(&self) -> Vec<EndExpansion> {
        let mut ends = Vec::new();
        for (family, own) in self.families() {
            let Some(split) = family.split else { continue };
            let Some((arc, which)) = self.walk.splits[split].end else { continue };
            let (mut b0, mut b1, mut size) = (Complex::default(), Complex::default(), 0.0);
            for (c, d) in own.chunks_exact(family.powers.len()).zip(&family.lengths) {
                let root = 1.0 / d.sqrt();
                b0 = b0 + c[0].scaled(root);
                b1 = b1 + (c[2] - c[0].scaled(0.5)).scaled(root / d);
                size += root * c[0].norm();
            }
            // On the free side w = f r.
            let f = Complex::new(0.0, if which == 0 { 1.0 } else { -1.0 });
            let root = f.sqrt();
            let first = root * b0;
            let coefficients = [first.re, (root * f * b1).re];
            ends.push(EndExpansion {
                split,
                arc,
                which,
                coefficients,
                missed: first.im.abs() + f64::EPSILON * size,
            });
        }
        ends
    }
}

impl PlaneFound {
    /// Errors of the ends of the arcs of each loop, as distances along the boundary; zero of those that cannot move.
    pub(crate) fn end_errors(&self, setup: &Setup) -> Vec<Vec<[f64; 2]>> {
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
        /// Part of the distance to the next split within which the expansion holds and steps become smaller as their
        /// squares.
        const PART: f64 = 0.1;
        /// Factor for what the estimate of the change of K leaves out: the boundary is no straight line.
        const SAFETY: f64 = 8.0;
        let split = &self.fit.walk.splits[end.split];
        let near = split.lengths[0].min(split.lengths[1]);
        let ([k, known], step) = (end.coefficients, end.step());
        let seen = self.seen_beside(end, near);
        // Next to a corner coefficients may cancel, so that their sum is not what v shows.
        let k1 = if (0.5..2.0).contains(&(seen / known)) { known } else { seen };
        let missed = SAFETY * (end.missed + self.missed_beside(end, near));
        let error =
            (k / (1.5 * k1) + step).abs() + step * step / (PART * near) + missed / (1.5 * k1.abs());
        // Next to a corner K vanishes twice, and the end may lie beyond it.
        let error = if error > PART * near { near + 2.0 * (near * error).sqrt() } else { error };
        error.min(setup.perimeter)
    }

    /// K1 as v shows it on the side that does not stick, by least squares.
    fn seen_beside(&self, end: &EndExpansion, near: f64) -> f64 {
        let (mut squares, mut products) = ([0.0; 3], [0.0; 2]);
        for node in self.nodes.iter().filter(|node| node.spot.split == end.split) {
            let (r, weight) = (node.spot.offset, node.spot.weight);
            if node.state == State::Held || r > 0.5 * near {
                continue;
            }
            for (power, square) in (1..).zip(&mut squares) {
                *square += weight * r.powi(power);
            }
            products[0] += weight * node.above() * r.sqrt();
            products[1] += weight * node.above() * r * r.sqrt();
        }
        let [first, mixed, last] = squares;
        (products[1] * first - products[0] * mixed) / (first * last - mixed * mixed)
    }

    /// Estimate of the change of K by what the conditions are missed by: what is missed no nearer than the next split
    /// counts by the largest of it, since rounding errors hide its course, and what is missed beyond by the integral.
    fn missed_beside(&self, end: &EndExpansion, near: f64) -> f64 {
        /// Integral of `s^(-3/2)` on both sides from a quarter of the distance to the next split, in roots of it.
        const BOTH_SIDES: f64 = 8.0;
        let corner = self.fit.walk.corner_beside(end.split);
        let a = corner.map_or(1.0, |corner| PI / corner.angle);
        let power = if corner.is_none_or(|corner| corner.is_mixed) { 0.5 * a } else { a };
        let factor = (a * a.sqrt()).max(1.0);
        // On the side that sticks, and on the other.
        let (mut constants, mut nearest) = ([0.0; 2], [f64::INFINITY; 2]);
        for node in self.nodes.iter().filter(|node| node.spot.split == end.split) {
            let side = usize::from(node.state != State::Held);
            if node.spot.offset < nearest[side] {
                (nearest[side], constants[side]) = (node.spot.offset, node.residual);
            }
        }
        let (mut largest, mut beyond) = (0.0f64, 0.0);
        for node in &self.nodes {
            let missed = (node.residual - constants[usize::from(node.state != State::Held)]).abs();
            let s = (node.spot.z - self.fit.walk.splits[end.split].z).norm();
            if node.spot.split == end.split {
                largest = largest.max(missed);
            } else {
                let kernel = factor * libm::pow((near / s).min(1.0), power - 0.5);
                beyond += node.spot.weight * missed * kernel / (s * s.sqrt());
            }
        }
        (BOTH_SIDES * largest / near.sqrt() + beyond) / PI
    }
}

/// Arcs that stick, each with its parts where v may slip: one that goes on over fixed and free sides ends at their
/// corner. All is in the plane.
pub(crate) fn arcs(setup: &Setup, found: &PlaneFound) -> Vec<ContactArc> {
    let (frame, mut arcs) = (setup.domain.frame, Vec::new());
    let loops = setup.domain.rings.iter().zip(&found.contact).zip(found.end_errors(setup));
    for (number, ((ring, own), errors)) in loops.enumerate() {
        let (turn, sides, many) = (ring.length(), &ring.sides, ring.sides.len());
        let lawful: Vec<&PlaneNode> =
            found.nodes.iter().filter(|own| own.ring == number && own.law.may_move()).collect();
        let closed = own.arcs.is_empty() && own.gaps.is_empty();
        let (all, none) = ([0.0, turn], [0.0; 2]);
        let whole_loop = closed.then_some((&all, &none));
        for (&[from, to], errors) in own.arcs.iter().zip(&errors).chain(whole_loop) {
            let inside = lawful.iter().filter(|node| (node.t - from).rem_euclid(turn) <= to - from);
            let force: f64 = inside.map(|node| node.spot.weight * node.flux).sum();
            let [first, last] = [ring.place_from(from), ring.place_to(to)];
            let count = match closed {
                true => many,
                // An arc that begins and ends on one side either stays on it or goes all the way round.
                false if first.side == last.side && first.s > last.s => many + 1,
                false => (last.side + many - first.side) % many + 1,
            };
            let along = (first.side..first.side + count).map(|side| side % many);
            let along: Vec<usize> = along.filter(|&side| sides[side].law.may_move()).collect();
            let (Some(&begin), Some(&end)) = (along.first(), along.last()) else { continue };
            let [mut start, mut stop] = [(0.0, 0.0), (sides[end].length(), 0.0)];
            if begin == first.side {
                start = (first.s, errors[0]);
            }
            if end == last.side && !closed {
                stop = (last.s, errors[1]);
            }
            let points = match along.len() == many && closed {
                true => [sides[begin].point(0.0); 2],
                false => [sides[begin].point(start.0), sides[end].point(stop.0)],
            };
            let points = points.map(|z| frame.outside(z));
            let rounding = points.map(|[x, y]| f64::EPSILON * (x.abs() + y.abs()));
            let whole: f64 = along.iter().map(|&side| sides[side].length()).sum();
            let length = whole - start.0 - (sides[end].length() - stop.0);
            let names = along.iter().filter_map(|&side| setup.domain.parts.get(sides[side].part));
            arcs.push(ContactArc {
                closed,
                part: (!setup.domain.parts.is_empty()).then(|| Names::all(names)),
                error: Some([
                    frame.unit * start.1 + rounding[0],
                    frame.unit * stop.1 + rounding[1],
                ]),
                ..ContactArc::new(points, frame.of_value() * force, frame.unit * length)
            });
        }
    }
    arcs
}
