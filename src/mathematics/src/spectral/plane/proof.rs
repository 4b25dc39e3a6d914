//! v, its slopes and bounds of their moduli on cells of all of the boundary.

use super::boundary::Walk;
use super::cells::{Cell, POINTS, Singular, Stretch, Surroundings, Track};
use super::extension::{Chord, share};
use super::field::node;
use super::fit::Fit;
use super::functions::{Family, Power, Values};
use super::moduli::{Disc, TURNS, of_functions, of_polynomial, of_psi};
use super::panels::Spot;
use super::samples::{CellModuli, Sampled};
use super::setup::Setup;
use crate::problem::complex::Complex;
use crate::spectral::rule::gauss;
use std::f64::consts::PI;

/// Cell of an interval, seen from one of its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProofCell {
    pub interval: usize,
    /// 0 if its points are seen from the start of the interval, 1 from the end.
    pub side: usize,
    pub cell: Cell,
}

impl ProofCell {
    /// Part of the interval, from its start.
    pub(super) fn along(&self, walk: &Walk) -> [f64; 2] {
        let [from, to] = self.cell.span;
        let length = walk.intervals[self.interval].length;
        if self.side == 0 { [from, to] } else { [length - to, length - from] }
    }

    /// Point in its middle.
    pub(super) fn middle(&self, walk: &Walk) -> Complex {
        let [from, to] = self.cell.span;
        walk.spot(self.interval, self.side, 0.5 * (from + to), 0.0).z
    }
}

/// What is needed to bound v on the boundary.
pub(super) struct Proof<'a> {
    pub setup: &'a Setup,
    pub fit: &'a Fit,
    singular: Singular<'a>,
    /// Surroundings of the ends of intervals, if they are splits towards which cells get short.
    pub near: Vec<[Option<Surroundings>; 2]>,
    pub chords: Vec<Chord>,
    /// What is added to the coefficients of the logarithms of holes.
    pub logs: Vec<f64>,
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
    /// What is not proved.
    pub(super) fn new(setup: &'a Setup, fit: &'a Fit) -> Result<Self, &'static str> {
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
    fn stretch(&'a self, interval: usize, side: usize) -> Stretch<'a> {
        let own = &self.fit.walk.intervals[interval];
        Stretch {
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
    /// What is not proved.
    pub(super) fn cells(&self) -> Result<Vec<ProofCell>, &'static str> {
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
    pub(super) fn halves(&self, own: ProofCell) -> Option<[ProofCell; 2]> {
        let halves = self.stretch(own.interval, own.side).halves(own.cell)?;
        Some(halves.map(|cell| ProofCell { cell, ..own }))
    }

    /// Bounds of moduli on the ellipses of cells.
    fn moduli(&self, cells: &[ProofCell]) -> Vec<CellModuli> {
        let mut discs: Vec<Disc> = Vec::new();
        let mut numbers = Vec::with_capacity(cells.len());
        for own in cells {
            let disc = Disc { inner: 0.0, ..own.cell.disc };
            let known = discs.iter().rposition(|other| *other == disc);
            numbers.push(known.unwrap_or(discs.len()));
            if known.is_none() {
                discs.push(disc);
            }
        }
        let polynomials = of_polynomial(self.fit, &discs);
        let of_cell = |(own, number): (&ProofCell, usize)| {
            let interval = &self.fit.walk.intervals[own.interval];
            let split = own.cell.is_log.then_some(interval.splits[own.side]);
            let mut rest = of_functions(self.fit, own.cell.disc, split);
            rest.add(polynomials[number]);
            let psi = of_psi(&self.setup.jumps.psi, own.cell.disc);
            rest.add(psi);
            // The normal of an arc, continued, is longer than 1.
            rest.slope *= if interval.curvature == 0.0 { 1.0 } else { 1.8 };
            let mut moduli = CellModuli {
                value: vec![[0.0, rest.value]],
                slope: vec![[1.0, rest.slope]],
                rest,
                psi,
            };
            if split.is_some() {
                self.add_own(own, split, &mut moduli);
            }
            moduli
        };
        cells.iter().zip(numbers).map(of_cell).collect()
    }

    /// Adds the bounds of the functions of a split on a cell in log r.
    fn add_own(&self, own: &ProofCell, split: Option<usize>, moduli: &mut CellModuli) {
        let mut next = 0;
        let Disc { radius, .. } = own.cell.disc;
        for family in &self.fit.functions.families {
            let many = family.powers.len() * family.lengths.len();
            let coefficients = &self.fit.coefficients[next..next + many];
            next += many;
            if family.split != split {
                continue;
            }
            for (k, &Power { power, log: is_log }) in family.powers.iter().enumerate() {
                let (mut value, mut slope) = (0.0, 0.0);
                for (&d, c) in family.lengths.iter().zip(coefficients.chunks_exact(many / family.lengths.len())) {
                    let least = d - radius;
                    let sizes = own.cell.distances.map(|r| (libm::log(r).abs(), r));
                    let log = sizes[0].0.max(sizes[1].0) + libm::log(least).abs() + TURNS[1] + 1.0;
                    let [own_log, factor] =
                        if is_log { [log, power * log + 1.0] } else { [1.0, power] };
                    let size = c[k].norm() * libm::pow(1.2 / least, power);
                    value += size * own_log;
                    // The distance along an arc over that in the plane, and the length of the normal.
                    slope += size * factor * d / least * 1.25 * 1.5;
                }
                moduli.value.push([power, value]);
                moduli.slope.push([power, slope]);
            }
        }
    }

    /// v on cells.
    pub(super) fn samples(&self, cells: &[ProofCell]) -> Vec<Sampled> {
        let rule = gauss(POINTS);
        let mut samples = Vec::with_capacity(cells.len());
        let mut moduli = self.moduli(cells).into_iter();
        for block in cells.chunks(64) {
            let mut spots: Vec<Spot> = Vec::with_capacity(block.len() * POINTS);
            for own in block {
                for [r, weight] in own.cell.nodes(&rule) {
                    let mut spot = self.fit.walk.spot(own.interval, own.side, r, weight);
                    if !own.cell.is_log {
                        // All functions see the same point.
                        spot.split = usize::MAX;
                    }
                    spots.push(spot);
                }
            }
            let values = self.fit.functions.at(&spots, true);
            let [g, slopes] = self.fit.sums(&values);
            let sizes = self.sizes(&values);
            let points: Vec<Complex> = spots.iter().map(|spot| spot.z).collect();
            let gradients = self.setup.jumps.psi.gradients(&points);
            for (k, own) in block.iter().enumerate() {
                let mut sampled = Sampled::new(*own, moduli.next().expect("one for each cell"));
                for i in k * POINTS..(k + 1) * POINTS {
                    let (spot, gradient) = (spots[i], gradients[i]);
                    let node = node(self.setup, self.fit, spot, [g[i], slopes[i]], gradient);
                    let slope = (slopes[i] * spot.tangent).re + gradient.dot(spot.tangent);
                    sampled.nodes.push(node);
                    sampled.slopes.push(slope);
                    sampled.rounding.push([sizes[0][i], sizes[1][i]]);
                }
                sampled.add_rounding();
                self.add_logs(&mut sampled);
                samples.push(sampled);
            }
        }
        samples
    }

    /// Rounding errors of the functions, in units in the last place. A power is an exponential of its logarithm, whose
    /// errors count as often as the power says.
    fn units(&self) -> Vec<f64> {
        let (functions, mut units) = (&self.fit.functions, Vec::new());
        for family in &functions.families {
            for _ in &family.lengths {
                units.extend(family.powers.iter().map(|power| 6.0 + 8.0 * power.power));
            }
        }
        units.extend(functions.holes.iter().flat_map(|hole| (0..hole.powers).map(|k| 6.0 + k as f64)));
        units.extend((0..=functions.arnoldi.len()).map(|k| 6.0 + k as f64));
        units.resize(self.fit.coefficients.len() + self.fit.logs.len(), 6.0);
        units
    }

    /// Rounding errors of g and of its derivative, point by point: those of its terms, and of each partial sum.
    fn sizes(&self, values: &Values) -> [Vec<f64>; 2] {
        let units = self.units();
        let none = || vec![0.0; values.points];
        let mut errors = [none(), none()];
        let zeros = || vec![Complex::default(); values.points];
        let mut sums = [zeros(), zeros()];
        let logs = self.fit.logs.iter().map(|&c| Complex::new(c, 0.0));
        for (k, c) in self.fit.coefficients.iter().copied().chain(logs).enumerate() {
            let range = k * values.points..(k + 1) * values.points;
            for which in [0, 1] {
                let own = &[&values.all, &values.slopes][which][range.clone()];
                let both = sums[which].iter_mut().zip(&mut errors[which]);
                for ((sum, error), value) in both.zip(own) {
                    let term = c * *value;
                    *sum = *sum + term;
                    *error += f64::EPSILON * (units[k] * term.norm() + sum.norm());
                }
            }
        }
        errors
    }

    /// Adds the logarithms of holes that are added to v.
    pub(super) fn add_logs(&self, sampled: &mut Sampled) {
        for (hole, &c) in self.fit.functions.holes.iter().zip(&self.logs) {
            for (node, slope) in sampled.nodes.iter_mut().zip(&mut sampled.slopes) {
                let away = node.spot.z - hole.middle;
                let size = 1.0 / away.norm2();
                node.value += 0.5 * c * libm::log(away.norm2());
                node.flux += c * size * away.dot(node.normal());
                *slope += c * size * away.dot(node.spot.tangent);
            }
        }
    }
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
    let is_clear = |z: Complex| setup.domain.distance(z) > 1e-9 && !setup.domain.holds(z);
    let ends = family.lengths.iter().map(|&d| family.point + outwards.scaled(d));
    if !ends.into_iter().all(is_clear) {
        return false;
    }
    if has_poles_alone(family) {
        return true;
    }
    let begins = match family.split {
        Some(split) => fit.walk.splits[split].angle < 2.0 * PI - 1e-3,
        None => is_clear(family.point),
    };
    begins && setup.domain.exit(family.point, outwards) > 1.1 * longest
}
