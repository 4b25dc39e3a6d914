//! The fit for one contact set: `v = psi + Re g`, with both conditions bounded.
//!
//! With the outer normal n to the right of the walk, `d/dn Re g = d/ds Im g`, so that
//! ```text
//! where v = at:         Re g = at - psi,
//! where dv/dn = q:      Im g - C = -int (psi_n - q) ds     from the start of a run, C one unknown each.
//! ```

pub(super) mod field;
pub(super) mod least_squares;

use super::functions::{Family, Functions, Values};
use super::setup::{Level, Setup};
use crate::problem::complex::Complex;
use crate::spectral::fit::least_squares::Columns;
use crate::spectral::functions::lanes::TOGETHER;
use crate::spectral::geometry::boundary::{State, Walk};
use crate::spectral::geometry::panels::{GaussNode, PlanePanel, Spot, gauss};
use crate::spectral::geometry::ring::RingContact;
use std::f64::consts::TAU;

/// A contact set with the functions fitted to it.
#[cfg_attr(test, derive(Clone))]
pub(crate) struct Fit {
    pub walk: Walk,
    pub functions: Functions,
    /// Coefficients of the complex functions.
    pub coefficients: Vec<Complex>,
    /// Coefficients of the logarithms of holes.
    pub logs: Vec<f64>,
    pub unknowns: usize,
    pub rows: usize,
}

/// Right-hand sides at spots in walking order: the value of the law less psi where v has it, and the integral of the
/// flux elsewhere.
pub(crate) fn conditions(setup: &Setup, walk: &Walk, spots: &[Spot]) -> Vec<f64> {
    let rule = gauss(5);
    let mut points = Vec::new();
    // Spots between neighbours of a run.
    let mut between: Vec<Vec<Spot>> = vec![Vec::new(); spots.len()];
    for k in 1..spots.len() {
        let (a, b) = (&spots[k - 1], &spots[k]);
        let [before, after] = [a, b].map(|spot| walk.intervals[spot.interval]);
        if before.run != after.run || after.state == State::Held {
            continue;
        }
        if a.interval == b.interval {
            add_between(walk, a.interval, [a, b], rule, &mut between[k]);
        } else {
            for (interval, side, to) in [(a.interval, 1, a.offset), (b.interval, 0, b.offset)] {
                let nodes = rule
                    .iter()
                    .map(|node| walk.spot(interval, side, to * node.x, to * node.weight));
                between[k].extend(nodes);
            }
        }
        points.extend(between[k].iter().map(|spot| spot.z));
    }
    let gradients = setup.jumps.psi.gradients(&points);
    let is_held = |spot: &Spot| walk.intervals[spot.interval].state == State::Held;
    let held: Vec<Complex> = spots.iter().filter(|spot| is_held(spot)).map(|spot| spot.z).collect();
    let mut held = setup.jumps.psi.values(&held).into_iter();
    let (mut at, mut sum) = (0, 0.0);
    let mut values = Vec::with_capacity(spots.len());
    for (k, spot) in spots.iter().enumerate() {
        if is_held(spot) {
            let psi = held.next().expect("a value for each such spot");
            let side = setup.domain.side(&walk.intervals[spot.interval]);
            values.push(-(psi - setup.domain.value(side, spot.z).0));
            continue;
        }
        if between[k].is_empty() {
            sum = 0.0;
        }
        for own in &between[k] {
            let State::Flux(q) = walk.intervals[own.interval].state else { continue };
            let normal = -own.tangent.turned();
            sum += own.weight * (gradients[at].dot(normal) - q);
            at += 1;
        }
        values.push(-sum);
    }
    values
}

/// Adds spots of a rule between two spots of an interval.
fn add_between(
    walk: &Walk,
    interval: usize,
    [a, b]: [&Spot; 2],
    rule: &[GaussNode],
    into: &mut Vec<Spot>,
) {
    let splits = walk.intervals[interval].splits;
    let length = walk.intervals[interval].length;
    // Both seen from the same end, the start unless both are nearer to the other.
    let late = a.s > 0.5 * length;
    let [from, to] = match late {
        true => [length - a.s, length - b.s],
        false => [a.s, b.s],
    };
    let side = usize::from(late);
    // The offset, which has all digits, where it is from that end.
    let [from, to] = [(a, from), (b, to)].map(|(spot, other)| {
        if spot.split == splits[side] && splits[0] != splits[1] { spot.offset } else { other }
    });
    for node in rule {
        let offset = from + (to - from) * node.x;
        into.push(walk.spot(interval, side, offset, (to - from).abs() * node.weight));
    }
}

/// Spots of panels with a rule.
pub(crate) fn spots_on(walk: &Walk, panels: &[PlanePanel], rule: &[GaussNode]) -> Vec<Spot> {
    let mut spots = Vec::with_capacity(panels.len() * rule.len());
    for &panel in panels {
        walk.spots(panel, rule, &mut spots);
    }
    spots
}

/// Continues the imaginary parts of the logarithms of holes along each run.
pub(crate) fn continue_logs(walk: &Walk, spots: &[Spot], logs: &mut [Complex]) {
    for k in 1..spots.len() {
        let [before, after] = [k - 1, k].map(|k| walk.intervals[spots[k].interval].run);
        if before == after && after != usize::MAX {
            let turns = ((logs[k].im - logs[k - 1].im) / TAU).round();
            logs[k].im -= TAU * turns;
        }
    }
}

/// Fits of searches so far.
#[derive(Default)]
pub(crate) struct Effort {
    /// Number of fits, which are steps of Newton's method.
    pub steps: usize,
    /// Number of operations of their least squares, `2 M N^2` each with M rows and N unknowns.
    operations: f64,
    /// Number of those of the first fit.
    first: f64,
}

impl Effort {
    /// Adds a fit.
    pub(crate) fn add(&mut self, fit: &Fit) {
        self.steps += 1;
        let own = 2.0 * fit.rows as f64 * (fit.unknowns as f64).powi(2);
        if self.steps == 1 {
            self.first = own;
        }
        self.operations += own;
    }

    /// True if a search is to be given up, in about the time of ten solutions: one takes three fits on a fine level,
    /// each as much as eight on the coarse one.
    pub(crate) fn is_spent(&self) -> bool {
        /// Most operations, a quarter of a minute's at most, and over those of the first fit.
        const MOST: [f64; 2] = [4e11, 400.0];
        self.operations > MOST[0].min(MOST[1] * self.first)
    }
}

/// Length of the shortest panel, in halves of an interval.
const SHORTEST: f64 = 1e-4;
/// Least number of rows per column.
const ROWS: f64 = 2.5;

impl Fit {
    pub(crate) fn new(setup: &Setup, contact: &[RingContact], level: &Level) -> Self {
        let mut walk = Walk::new(&setup.domain.rings, contact, &setup.jumps.crossings);
        setup.set_f(&mut walk);
        let mut functions = Functions::chosen(setup, &walk, level);
        let (rule, mut fineness) = (gauss(level.nodes), 1.0);
        let mut panels = panels(setup, &walk, &functions, level, [fineness, SHORTEST]);
        while ((panels.len() * rule.len()) as f64) < ROWS * functions.unknowns() as f64 {
            fineness *= 1.4;
            panels = self::panels(setup, &walk, &functions, level, [fineness, SHORTEST]);
        }
        let spots = spots_on(&walk, &panels, rule);
        functions.orthogonalise(&spots, level.degree);
        let mut matrix = Columns::new(spots.len(), functions.unknowns() + walk.runs);
        fill(&walk, &spots, &functions, &mut matrix);
        let last = matrix.unknowns;
        matrix.column(last).copy_from_slice(&conditions(setup, &walk, &spots));
        let (unknowns, rows) = (matrix.unknowns, matrix.rows);
        let x = matrix.solve();
        let many = functions.complex();
        let mut coefficients = vec![Complex::new(x[0], 0.0)];
        coefficients
            .extend(x[1..2 * many - 1].chunks_exact(2).map(|pair| Complex::new(pair[0], pair[1])));
        // The constant, which comes first here, is the first polynomial.
        let polynomials = functions.arnoldi.len() + 1;
        coefficients[..=many - polynomials].rotate_left(1);
        let logs = x[2 * many - 1..][..functions.holes.len()].to_vec();
        Self { walk, functions, coefficients, logs, unknowns, rows }
    }

    /// Families with the coefficients of their functions, cut by cut.
    pub(crate) fn families(&self) -> impl Iterator<Item = (&Family, &[Complex])> {
        let mut rest = &self.coefficients[..];
        self.functions.families.iter().map(move |family| {
            let (own, others) = rest.split_at(family.many());
            rest = others;
            (family, own)
        })
    }

    /// Coefficients of all functions.
    pub(crate) fn all_coefficients(&self) -> Vec<Complex> {
        let logs = self.logs.iter().map(|&c| Complex::new(c, 0.0));
        self.coefficients.iter().copied().chain(logs).collect()
    }

    /// g and, if wanted, its derivative at spots, with the principal logarithms of holes.
    pub(crate) fn at(&self, spots: &[Spot], slopes: bool) -> [Vec<Complex>; 2] {
        self.functions.sums(&self.all_coefficients(), spots, slopes)
    }
}

/// Panels for functions, `fineness` times shorter than needed for the fit, but no shorter than a part of an interval.
pub(crate) fn panels(
    setup: &Setup,
    walk: &Walk,
    functions: &Functions,
    level: &Level,
    [fineness, shortest]: [f64; 2],
) -> Vec<PlanePanel> {
    let longest = 4.0 * setup.diameter / level.degree as f64;
    // Points with the length of panels, in distances from them.
    let mut near: Vec<(Complex, f64)> = setup.jumps.singular.iter().map(|&z| (z, 1.0)).collect();
    for family in &functions.families {
        // Simple poles alone.
        let poles = family.powers.len() == 1;
        let part = if poles { 0.75 } else { 1.0 };
        near.extend(
            family.lengths.iter().map(|&d| (family.point - family.inwards.scaled(d), part)),
        );
        if family.split.is_none() && !poles {
            near.push((family.point, 1.0));
        }
    }
    walk.panels(shortest, |middle, length| {
        fineness * length > longest
            || near.iter().any(|&(z, part)| length > part * (z - middle).norm())
    })
}

/// Writes the rows of spots.
fn fill(walk: &Walk, spots: &[Spot], functions: &Functions, matrix: &mut Columns) {
    let held: Vec<bool> =
        spots.iter().map(|spot| walk.intervals[spot.interval].state == State::Held).collect();
    let many = functions.complex();
    let constant = many - functions.arnoldi.len() - 1;
    let mut values = Values::default();
    let mut logs = vec![Vec::with_capacity(spots.len()); functions.holes.len()];
    for (block, first) in spots.chunks(TOGETHER).zip((0..).step_by(TOGETHER)) {
        let (held, rows) = (&held[first..], first..first + block.len());
        functions.at(block, &mut values);
        for (x, &held) in matrix.column(0)[rows.clone()].iter_mut().zip(held) {
            *x = if held { 1.0 } else { 0.0 };
        }
        let mut next = 1;
        for own in values.all[..constant].iter().chain(&values.all[constant + 1..many]) {
            let column = matrix.column(next)[rows.clone()].iter_mut().zip(held);
            for ((x, &held), l) in column.zip(0..) {
                *x = if held { own.re[l] } else { own.im[l] };
            }
            let column = matrix.column(next + 1)[rows.clone()].iter_mut().zip(held);
            for ((x, &held), l) in column.zip(0..) {
                *x = if held { -own.im[l] } else { own.re[l] };
            }
            next += 2;
        }
        for (logs, own) in logs.iter_mut().zip(&values.all[many..]) {
            logs.extend(own.first(block.len()));
        }
    }
    let mut next = 2 * many - 1;
    for logs in &mut logs {
        continue_logs(walk, spots, logs);
        for ((x, value), &held) in matrix.column(next).iter_mut().zip(logs.iter()).zip(&held) {
            *x = if held { value.re } else { value.im };
        }
        next += 1;
    }
    for (i, spot) in spots.iter().enumerate() {
        let run = walk.intervals[spot.interval].run;
        if run != usize::MAX {
            matrix.column(next + run)[i] = -1.0;
        }
    }
}
