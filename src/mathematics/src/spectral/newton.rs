//! Newton's method for the ends of contact.

use super::arcs::StickArcs;
use super::contact::{SHORTEST, without_short};
use super::map::Angle;
use super::panels::{Ends, LANES, Panel};
use super::place::{BoundaryPlace, tangent};
use super::problem::SpectralProblem;
use super::rule::Rules;
use super::sources::{Point, SourceField, Sources};
use crate::discrete::norms::largest;
use crate::machine::simd::vectorised;
use crate::problem::complex::Complex;

/// Ends of contact after some Newton steps.
pub(super) struct NewtonEnds {
    pub(super) arcs: StickArcs,
    pub(super) steps: usize,
}

impl SpectralProblem {
    /// Moves the ends until a step is shorter than `shortest`: convergence is quadratic, so the next would
    /// have the square of its length. Arcs and gaps that vanish on the way are left out. `None` if no arc is
    /// left, or if no step is so short.
    pub(super) fn newton(
        &self,
        mut arcs: StickArcs,
        rules: &Rules,
        shortest: f64,
    ) -> Option<NewtonEnds> {
        const STEPS: usize = 20;
        if arcs.places.is_empty() {
            return Some(NewtonEnds { arcs, steps: 0 });
        }
        for steps in 1..=STEPS {
            let ends = Ends::new(arcs);
            let changes = changes(&ends, &self.step(&ends, rules)?);
            let longest = longest(&ends.places, &changes);
            if !longest.is_finite() {
                return None;
            }
            // If arcs or gaps vanish the next step is another one.
            let factor = (1.0 / longest).min(1.0);
            let moved = ends.places.iter().zip(&changes).map(|(&p, c)| c.scaled(factor).apply(p));
            let moved = StickArcs { places: moved.collect(), flux: ends.flux };
            arcs = without_short(moved, SHORTEST)?;
            if longest < shortest || arcs.places.is_empty() {
                return Some(NewtonEnds { arcs, steps });
            }
        }
        None
    }

    /// Newton step, as relative changes of the distances from a corner for ends round which it is
    /// free, else as lengths. The central function of the solver:
    ///
    /// 1. puts quadrature nodes on all panels (`sources`), and on the gaps whose integrals are equations,
    /// 2. evaluates the `m + 1` moments and the `m - 1` integrals of `v_theta`,
    /// 3. differentiates them with respect to each end,
    /// 4. solves the linear system.
    ///
    /// Easily broken: an end that is exponentially near to a corner is known by its logarithm only ([`relative`]).
    fn step(&self, ends: &Ends, rules: &Rules) -> Option<Vec<f64>> {
        let (arcs, many) = (ends.arcs(), ends.places.len());
        let gaps = gaps(ends);
        let field = SourceField::new(self, ends, rules, |panel| is_in_gap(panel, &gaps));
        let sources = &field.plain;
        let trig = trigonometric(ends, sources);
        // One row for each equation; the last column is the right-hand side.
        let mut system = vec![vec![0.0; many + 1]; many];
        for (row, trig) in system.iter_mut().zip(&trig) {
            row[many] = -dot(&sources.moment, trig);
        }
        let points = points_by_gap(&field, &gaps);
        for (row, points) in system[arcs + 1..].iter_mut().zip(&points) {
            row[many] = -points.iter().map(|at| at.along * at.weight).sum::<f64>();
        }
        for (j, (place, angle)) in ends.places.iter().zip(&ends.angles).enumerate() {
            let (column, y) = self.derivatives(sources, ends, j, &trig);
            let scale = angle.slope * if relative(&ends.places, j) { place.t } else { 1.0 };
            for (row, d) in system.iter_mut().zip(&column) {
                row[j] = d * scale;
            }
            for (row, points) in system[arcs + 1..].iter_mut().zip(&points) {
                let sum: f64 = points.iter().map(|at| kernel(at, ends, j)).sum();
                row[j] = -0.25 * y * sum * scale;
            }
        }
        solution(system)
    }

    /// Derivatives of the moments with respect to the `j`-th end of contact, and Y there.
    fn derivatives(
        &self,
        sources: &Sources,
        ends: &Ends,
        j: usize,
        trig: &[Vec<f64>],
    ) -> (Vec<f64>, f64) {
        let (BoundaryPlace { corner, t }, angle) = (ends.places[j], ends.angles[j]);
        let [x, y] = self.boundary_psi.at(corner, &[t; LANES], [1, 2]).map(|s| s[0]);
        // As targets beside the end subtract it.
        let subtracted = Complex::new(x, y) + tangent(corner, t).turned().scaled(ends.flux_at(j));
        let (mut sum, mut cotangents) = (0.0, Vec::with_capacity(sources.tan.len()));
        for group in &sources.groups {
            let [es, ec] = angle.seen_from(corner - group.corner);
            let g = subtracted.dot(group.direction);
            for i in group.range.clone() {
                let t = sources.tan[i];
                let local = (sources.moment[i] - g * sources.weight[i]) / (t * ec - es);
                let cotangent = local * (ec + t * es);
                sum += if ends.arcs() % 2 == 1 { local } else { cotangent };
                cotangents.push(cotangent);
            }
        }
        let column = trig.iter().map(|row| 0.25 * dot(&cotangents, row)).collect();
        (column, sum / std::f64::consts::TAU)
    }
}

/// Part of a point in the derivative of the integral of `v_theta` over a gap, with respect to the `j`-th end of
/// contact.
fn kernel(at: &Point, ends: &Ends, j: usize) -> f64 {
    let angle = ends.angles[j];
    let [ts, tc] = at.angle.seen_from(at.place.corner - ends.places[j].corner);
    let (sine, cosine) = (ts * angle.cos - tc * angle.sin, tc * angle.cos + ts * angle.sin);
    at.root * at.weight * if ends.arcs() % 2 == 1 { 1.0 } else { cosine } / sine
}

/// All gaps but the longest, by the number of the arc before them.
fn gaps(ends: &Ends) -> Vec<usize> {
    let arcs = ends.arcs();
    let longest = (1..=arcs).max_by(|&a, &b| gap_length(ends, a).total_cmp(&gap_length(ends, b)));
    (1..=arcs).filter(|&gap| Some(gap) != longest).collect()
}

/// Length of the gap after an arc.
fn gap_length(ends: &Ends, arc: usize) -> f64 {
    let next = ends.places[2 * (arc % ends.arcs())];
    next.after(ends.places[2 * arc - 1]).rem_euclid(4.0)
}

/// True if a panel lies in one of the gaps.
fn is_in_gap(panel: &Panel, gaps: &[usize]) -> bool {
    !panel.contact && gaps.contains(&panel.arcs)
}

/// Points of the solution on each of the gaps.
fn points_by_gap(field: &SourceField, gaps: &[usize]) -> Vec<Vec<Point>> {
    let mut points = vec![Vec::new(); gaps.len()];
    for (p, panel) in field.panels.iter().enumerate() {
        let gap = gaps.iter().position(|&gap| gap == panel.arcs);
        if let Some(gap) = gap.filter(|_| !panel.contact) {
            points[gap].extend(field.on_panel(p));
        }
    }
    points
}

/// Real and imaginary parts of e^{i s theta} at the sources, s = m/2, m/2 - 1, .. down to 0 or 1/2; for odd m
/// times the cosine that their weights lack.
fn trigonometric(ends: &Ends, sources: &Sources) -> Vec<Vec<f64>> {
    let arcs = ends.arcs();
    let mut rows = vec![Vec::with_capacity(sources.tan.len()); arcs + 1];
    let first = ends.start().corner;
    for group in &sources.groups {
        for i in group.range.clone() {
            let (tan, cos) = (sources.tan[i], sources.cos[i]);
            let angle = Angle { sin: tan * cos, cos, slope: 0.0 };
            let [s, c] = angle.seen_from(group.corner - first);
            let half = Complex::new(c, s);
            let (whole, mut rows) = (half * half, rows.iter_mut());
            let mut power = half.scaled(cos);
            if arcs.is_multiple_of(2) {
                // For s = 0 there is a real part only.
                rows.next().expect("one row at least").push(1.0);
                power = whole;
            }
            while let (Some(re), Some(im)) = (rows.next(), rows.next()) {
                re.push(power.re);
                im.push(power.im);
                power = power * whole;
            }
        }
    }
    rows
}

/// Scalar product, in parts that are summed at once.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    vectorised(
        #[inline(always)]
        || {
            let mut sums = [0.0; LANES];
            let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
            for (a, b) in a.iter().zip(b) {
                for lane in 0..LANES {
                    sums[lane] += a[lane] * b[lane];
                }
            }
            let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
            sums.iter().sum::<f64>() + rest
        },
    )
}

/// Change of an end of contact in a step.
#[derive(Clone, Copy)]
enum Change {
    /// Change by a length along the boundary.
    Length(f64),
    /// Change of the logarithm of its distance from the corner.
    Logarithm(f64),
    /// Change of a short arc between gaps of opposite signs, by the length that its middle moves and by the logarithm
    /// of its length.
    Arc {
        middle: f64,
        logarithm: f64,
        /// Distance of the end from the middle.
        from_middle: f64,
    },
}

impl Change {
    /// Part of the change.
    fn scaled(self, factor: f64) -> Self {
        match self {
            Self::Length(d) => Self::Length(factor * d),
            Self::Logarithm(d) => Self::Logarithm(factor * d),
            Self::Arc { middle, logarithm, from_middle } => {
                Self::Arc { middle: factor * middle, logarithm: factor * logarithm, from_middle }
            }
        }
    }

    /// Changes an end.
    fn apply(self, BoundaryPlace { corner, t }: BoundaryPlace) -> BoundaryPlace {
        match self {
            Self::Length(d) => BoundaryPlace::new(corner, t + d),
            Self::Logarithm(d) => BoundaryPlace::new(corner, t * libm::exp(d)),
            Self::Arc { middle, logarithm, from_middle } => {
                BoundaryPlace::new(corner, t + middle + from_middle * libm::expm1(logarithm))
            }
        }
    }
}

/// Number of the other end of the gap beside an end.
fn across_gap(places: &[BoundaryPlace], j: usize) -> usize {
    let many = places.len();
    if j.is_multiple_of(2) { (j + many - 1) % many } else { (j + 1) % many }
}

/// True if an end is that of a short gap round a corner, which may be exponentially small. A long gap may
/// begin on either side of a corner.
fn relative(places: &[BoundaryPlace], j: usize) -> bool {
    let begins = j.is_multiple_of(2);
    let (place, other) = (places[j], places[across_gap(places, j)]);
    (place.corner - other.corner) % 4 == 0
        && place.t.abs().max(other.t.abs()) < 0.05
        && (place.t > 0.0) == begins
        && (other.t > 0.0) != begins
}

/// Changes of the ends by the unknowns of the linear system.
fn changes(ends: &Ends, unknowns: &[f64]) -> Vec<Change> {
    let places = &ends.places;
    let mut vanishing = Vec::with_capacity(places.len());
    for (place, d) in places.iter().zip(unknowns) {
        vanishing.push(place.t.abs() * libm::exp(*d) < SHORTEST);
    }
    let mut changes = Vec::with_capacity(places.len());
    for (j, &d) in unknowns.iter().enumerate() {
        // If the gap does not vanish, but this side of the corner is to have no part of it, its end is on the other
        // side, which no logarithm reaches.
        changes.push(if !relative(places, j) {
            arc_change(ends, unknowns, j).unwrap_or(Change::Length(d))
        } else if vanishing[j] && !vanishing[across_gap(places, j)] {
            Change::Length(-2.0 * places[j].t)
        } else {
            Change::Logarithm(d)
        });
    }
    changes
}

/// Change of the `j`-th end if its arc is short and lies between gaps of opposite signs: the conditions at such an arc
/// are almost linear in the logarithm of its length, which may be exponentially small.
fn arc_change(ends: &Ends, unknowns: &[f64], j: usize) -> Option<Change> {
    let (begin, end) = (j & !1, j | 1);
    let half = 0.5 * ends.places[end].after(ends.places[begin]).rem_euclid(4.0);
    if half > 0.05 || ends.flux_at(begin) == ends.flux_at(end) {
        return None;
    }
    let [before, after] = [begin, end].map(|j| unknowns[j]);
    let from_middle = if j == begin { -half } else { half };
    let logarithm = 0.5 * (after - before) / half;
    Some(Change::Arc { middle: 0.5 * (before + after), logarithm, from_middle })
}

/// Longest change, in units of the largest change of a single step.
fn longest(places: &[BoundaryPlace], changes: &[Change]) -> f64 {
    let many = places.len();
    let mut longest = 0.0_f64;
    for (j, &change) in changes.iter().enumerate() {
        longest = longest.max(match change {
            Change::Length(d) => {
                let next = places[(j + 1) % many].after(places[j]).rem_euclid(4.0);
                let last = places[j].after(places[(j + many - 1) % many]).rem_euclid(4.0);
                d.abs() / (0.4 * next.min(last))
            }
            Change::Logarithm(d) => d.abs(),
            Change::Arc { middle, logarithm, .. } => {
                /// Largest change of the logarithm in a step: the conditions are almost linear in it.
                const LOGARITHM: f64 = 4.0;
                let other = places[across_gap(places, j)];
                let [before, after] = [places[j].after(other), other.after(places[j])];
                let gap = if j.is_multiple_of(2) { before } else { after };
                (middle.abs() / (0.4 * gap.rem_euclid(4.0))).max(logarithm.abs() / LOGARITHM)
            }
        });
    }
    longest
}

/// Solution of a small linear system, the right-hand side being its last column, by Gauss and Jordan's
/// elimination with scaled rows; `None` if the matrix is singular.
fn solution(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    for row in &mut rows {
        let largest = largest(&row[..n]);
        for entry in row {
            *entry /= largest;
        }
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))?;
        rows.swap(k, pivot);
        let top = rows[k].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|&(i, _)| i != k) {
            let factor = row[k] / top[k];
            for (a, b) in row.iter_mut().zip(&top).skip(k) {
                *a -= factor * b;
            }
        }
    }
    let unknowns: Vec<f64> = rows.iter().enumerate().map(|(k, row)| row[n] / row[k]).collect();
    unknowns.iter().all(|x| x.is_finite()).then_some(unknowns)
}
