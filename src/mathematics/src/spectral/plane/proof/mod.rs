//! Proof of the two bounds of the energy: v, its slopes and bounds of their moduli on cells of all of the boundary.

mod bounds;
mod cells;
mod exact_energy;
mod extension;
mod green;
mod moduli;
mod on_cells;
mod psi_errors;
mod residual;
mod samples;

use super::fit::Fit;
use super::functions::Family;
use super::setup::Setup;
use crate::problem::complex::Complex;
use crate::spectral::jumps::JumpEdge;
pub(super) use bounds::bracket;
use cells::{CellStretch, ProofCell, Singular, Surroundings, Track};
use extension::{Chord, share};
use std::f64::consts::PI;

/// All that is needed to bound v on the boundary.
struct Proof<'a> {
    setup: &'a Setup,
    fit: &'a Fit,
    singular: Singular<'a>,
    /// Surroundings of the ends of intervals, if they are splits towards which cells get short.
    near: Vec<[Option<Surroundings>; 2]>,
    chords: Vec<Chord>,
    /// Additions to the coefficients of the logarithms of holes.
    logs: Vec<f64>,
}

/// Largest share of the distance within which nothing else is singular, and of that from other sides.
const TOP: [f64; 2] = [0.2, 0.3];
/// Logarithm of the size of what is left closer to a split, over the coefficients.
const LEFT: f64 = 50.0;
/// Logarithm of the least distance over the largest: powers of smaller ones cannot be written.
const DEEPEST: f64 = 145.0;

impl<'a> Proof<'a> {
    /// Finds all that is singular, and proves that no cut meets the domain.
    ///
    /// # Errors
    /// Part that is not proved.
    fn new(setup: &'a Setup, fit: &'a Fit) -> Result<Self, &'static str> {
        let mut points = Vec::new();
        for (k, split) in fit.walk.splits.iter().enumerate() {
            if split.depth() < 1.0 {
                points.push((split.z, Some(k)));
            }
        }
        for family in &fit.functions.families {
            if !is_outside(setup, fit, family) {
                return Err("cuts beside the domain");
            }
            if !has_poles_alone(family) {
                points.push((family.point, family.split));
            }
            let ends = family.lengths.iter().map(|&d| family.point - family.inwards.scaled(d));
            points.extend(ends.map(|end| (end, None)));
        }
        if !setup.jumps.edges.iter().all(|edge| has_values(setup, edge)) {
            return Err("f");
        }
        for hole in &fit.functions.holes {
            if setup.domain.holds(hole.middle) || setup.domain.distance(hole.middle) < 1e-9 {
                return Err("middles of holes");
            }
            points.push((hole.middle, None));
        }
        let mut proof = Self {
            singular: Singular { psi: &setup.jumps.psi, points },
            near: Vec::new(),
            chords: Chord::all(&fit.walk),
            logs: vec![0.0; fit.logs.len()],
            setup,
            fit,
        };
        for k in 0..fit.walk.intervals.len() {
            let near = [proof.surroundings(k, 0)?, proof.surroundings(k, 1)?];
            proof.near.push(near);
        }
        Ok(proof)
    }

    /// Surroundings of an end of an interval.
    fn surroundings(&self, k: usize, side: usize) -> Result<Option<Surroundings>, &'static str> {
        let (walk, interval) = (&self.fit.walk, &self.fit.walk.intervals[k]);
        let number = interval.splits[side];
        let split = &walk.splits[number];
        if split.depth() >= 1.0 {
            return Ok(None);
        }
        let adjacent = walk.intervals.iter().filter(|own| own.splits.contains(&number));
        let bend = adjacent.fold(0.0f64, |most, own| most.max(own.curvature.abs()));
        let others = self.chords.iter();
        let others = others.filter(|o| !walk.intervals[o.interval].splits.contains(&number));
        let clear = others.map(|chord| chord.distance(split.z)).fold(f64::INFINITY, f64::min);
        let room = self.singular.room(split.z, Some(number));
        let reach = (room / 2.4).min(0.25 / bend).min(self.setup.diameter);
        let turned = 0.25 * share(split.angle) / bend;
        let top = (TOP[0] * reach).min(TOP[1] * clear).min(turned).min(0.5 * interval.length);
        if top < 1e-10 {
            return Err("v next to singular points that are beside each other");
        }
        let family = self.fit.functions.families.iter().find(|family| family.split == Some(number));
        let powers = family.map_or(&[][..], |family| &family.powers);
        let weakest = powers.iter().fold(1.0f64, |least, power| least.min(power.power));
        let least = top * libm::exp(-(LEFT / weakest).min(DEEPEST));
        Ok(Some(Surroundings { centre: split.z, top, least, reach }))
    }

    /// Half of an interval.
    fn stretch(&'a self, interval: usize, side: usize) -> CellStretch<'a> {
        let own = &self.fit.walk.intervals[interval];
        CellStretch {
            track: Track::Interval(&self.fit.walk, interval, side),
            singular: &self.singular,
            curvature: own.curvature,
            length: 0.5 * own.length,
            longest: self.setup.diameter / 10.0,
            near: self.near[interval][side],
        }
    }

    /// Cells of all of the boundary.
    ///
    /// # Errors
    /// Part that is not proved.
    fn cells(&self) -> Result<Vec<ProofCell>, &'static str> {
        let mut cells = Vec::new();
        for interval in 0..self.fit.walk.intervals.len() {
            for side in [0, 1] {
                let own = self.stretch(interval, side).cells();
                let own = own.ok_or("v next to singular points behind the boundary")?;
                cells.extend(own.into_iter().map(|cell| ProofCell { interval, side, cell }));
            }
        }
        Ok(cells)
    }

    /// The halves of a cell.
    fn halves(&self, own: ProofCell) -> Option<[ProofCell; 2]> {
        let halves = self.stretch(own.interval, own.side).halves(own.cell)?;
        Some(halves.map(|cell| ProofCell { cell, ..own }))
    }
}

/// True if `-Lap psi` is f on both sides of a jump, next to its middle.
fn has_values(setup: &Setup, edge: &JumpEdge) -> bool {
    let (curve, [from, to]) = (edge.arc.curve, edge.arc.span);
    let s = 0.5 * (from + to);
    let step = curve.direction(s).turned().scaled(1e-6 * (to - from).abs().min(1.0));
    let sides = [curve.at(s) + step, curve.at(s) - step].map(|z| setup.jumps.psi.source(z));
    let size = 1e-9 * (edge.values[0].abs() + edge.values[1].abs());
    (0..2).all(|k| (sides[k] - edge.values[k]).abs() <= size)
}

/// True if all its functions are rational, so that the point itself is not singular.
fn has_poles_alone(family: &Family) -> bool {
    family.split.is_none() && family.powers.iter().all(|p| !p.log && p.power == p.power.round())
}

/// True if the cuts of a family lie outside of the domain: from a corner the longest leads outwards, away from both
/// sides; from other points, which are outside, it does not meet the boundary; and there is more room by a tenth.
fn is_outside(setup: &Setup, fit: &Fit, family: &Family) -> bool {
    let longest = family.lengths.iter().fold(0.0f64, |most, &d| most.max(d));
    let outwards = -family.inwards;
    let mut ends = family.lengths.iter().map(|&d| family.point + outwards.scaled(d));
    if !ends.all(|end| is_clear(setup, end)) {
        return false;
    }
    if has_poles_alone(family) {
        return true;
    }
    let begins = match family.split {
        Some(split) => fit.walk.splits[split].angle < 2.0 * PI - 1e-3,
        None => is_clear(setup, family.point),
    };
    begins && setup.domain.exit(family.point, outwards) > 1.1 * longest
}

/// True if a point is outside of the closed domain.
fn is_clear(setup: &Setup, z: Complex) -> bool {
    setup.domain.distance(z) > 1e-9 && !setup.domain.holds(z)
}

#[cfg(test)]
mod tests;
