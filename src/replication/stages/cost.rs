//! The pictures of the chapter on accuracy and cost, from results and recorded times to SVG.

use crate::experiments::Range;
use crate::experiments::accuracy::{self, Findings};
use crate::experiments::truth::{Elements, ElementsLevel, Truth};
use crate::figures::Stroke::{Marked, Reference};
use crate::figures::{Chart, Curve, Picture, charts};
use crate::problem::exact::Exact;
use crate::timing::recorded::{Goal, PUBLISHED, Reached, Scaling, Timings};
use crate::timing::solver::Solver;
use std::collections::BTreeSet;

/// A line of slope `power` over the range of the others, all of which it passes by at this `factor`
/// of the one that comes nearest.
fn slope(label: &str, lines: &[Curve], power: f64, factor: f64) -> Curve {
    let points = || lines.iter().flat_map(|line| &line.points);
    let x = Range::of(points().map(|point| point.0)).unwrap_or_default();
    let scaled = Range::of(points().map(|(x, y)| y / libm::pow(*x, power))).unwrap_or_default();
    let constant = factor * if factor < 1.0 { scaled.least } else { scaled.greatest };
    let at = |x: f64| (x, constant * libm::pow(x, power));
    Curve::new(Reference, label, [at(x.least), at(x.greatest)])
}

/// Errors of the problems with known solutions, one panel per norm.
pub(super) fn accuracy(found: &Findings) -> Picture {
    type Error = fn(&accuracy::AccuracyLevel) -> Option<f64>;
    let panel = |title, y, error: Error, slopes: &[(&str, f64, f64)]| {
        let point =
            |level: &accuracy::AccuracyLevel| Some((level.cost.cells as f64, error(level)?));
        let known = found.problems.iter();
        let mut lines: Vec<_> = known
            .map(|known| Curve::new(Marked, &known.name, known.levels.iter().filter_map(point)))
            .collect();
        let slopes = slopes.iter().map(|&(label, power, at)| slope(label, &lines, power, at));
        let slopes: Vec<_> = slopes.collect();
        lines.extend(slopes);
        Chart::new(title, ["1/h", y], lines)
    };
    let two = &[("order 2", -2.0, 0.12)];
    let both = &[("order 2", -2.0, 0.3), ("order 1", -1.0, 2.0)];
    let panels = [
        panel("v in L2", "error in L2", |level| level.errors.l2, two),
        panel("v in H1", "error in H1", |level| Some(level.errors.h1), &[("order 1", -1.0, 0.25)]),
        panel("v at the nodes", "greatest error", |level| Some(level.errors.max), two),
        panel(
            "multiplier in L2",
            "error in L2 of the boundary",
            |level| Some(level.errors.multiplier_l2),
            both,
        ),
    ];
    charts(false, &panels)
}

/// Time per unknown of multigrid, for both goals.
pub(super) fn cost(timings: &Timings) -> Picture {
    let multigrid = |goal: Goal| {
        [("multigrid", 1), ("multigrid, two threads", 2)].map(|(label, threads)| {
            let wanted = |line: &&Scaling| line.goal == goal && line.threads == threads;
            let lines = timings.multigrid.iter().filter(wanted);
            let points = lines.map(|line| (line.unknowns() as f64, line.ns()));
            Curve::new(Marked, label, points)
        })
    };
    let axes = ["unknowns", "nanoseconds per unknown"];
    let panels = [
        Chart::new("To the discretisation error", axes, multigrid(Goal::Discretisation).into()),
        Chart::new("To the rounding floor", axes, multigrid(Goal::Floor).into()),
    ];
    charts(false, &panels)
}

/// Error against time, one panel per problem; of each solver the runs that no other of its own beats.
pub(super) fn race(timings: &Timings) -> Picture {
    let mut problems: Vec<&str> = timings.solver.iter().map(|line| &line.problem[..]).collect();
    problems.extend(timings.spectral.iter().map(|line| &line.problem[..]));
    let mut seen = BTreeSet::new();
    problems.retain(|problem| seen.insert(*problem));
    let panels: Vec<_> = problems
        .into_iter()
        .map(|problem| {
            let lines = || timings.solver.iter().filter(|line| line.problem == problem);
            let stop = |line: &&Reached| line.goal == PUBLISHED;
            let point = |line: &Reached| (line.seconds, line.error);
            let spectral = timings.spectral.iter().filter(|line| line.problem == problem);
            let spectral = front(spectral.map(|line| (line.seconds, line.error)));
            let mut curves = vec![Curve::new(Marked, Solver::Spectral.in_words(), spectral)];
            for solver in Solver::ON_GRIDS.into_iter().rev() {
                let mine = lines().filter(|line| line.solver == solver && !stop(line));
                curves.push(Curve::new(Marked, solver.in_words(), front(mine.map(point))));
            }
            let published = lines().filter(stop).map(point);
            curves.push(Curve::new(Marked, "Arrow-Hurwicz, published stop", published));
            let formula = Exact::ALL.iter().any(|exact| exact.name() == problem);
            let error =
                if formula { "L2 error at the nodes" } else { "error of the energy, relative" };
            Chart::new(problem, ["seconds", error], curves)
        })
        .collect();
    charts(false, &panels)
}

/// Points (time, error) by time, without those that an earlier one beats.
fn front(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut points: Vec<_> = points.collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = f64::INFINITY;
    points.retain(|(_, error)| {
        let better = *error < best;
        best = best.min(*error);
        better
    });
    points
}

/// Where contact ends, and the bracket of the energy, against the width of the grid.
pub(super) fn ends(found: &Truth) -> Picture {
    let with_energy =
        || found.elements.iter().filter(|e| e.levels.iter().all(|l| l.energy.is_some()));
    let curves = |of: fn(&ElementsLevel) -> Option<f64>| -> Vec<Curve> {
        let line = |elements: &Elements| {
            let points = elements.levels.iter().filter_map(|l| Some((l.cells as f64, of(l)?)));
            Curve::new(Marked, &elements.name, points)
        };
        with_energy().map(line).filter(|curve| !curve.points.is_empty()).collect()
    };
    let mut ends = curves(|level| level.ends);
    ends.push(slope("order 3/2", &ends, -1.5, 2.5));
    let mut brackets = curves(|level| Some(level.bracket));
    brackets.push(slope("order 3", &brackets, -3.0, 2.5));
    let panels = [
        Chart::new("Ends of contact", ["1/h", "largest error along the boundary"], ends),
        Chart::new("Guaranteed bracket of the energy", ["1/h", "width"], brackets),
    ];
    charts(false, &panels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_another_beats_is_left_out() {
        let points = [(2.0, 0.5), (1.0, 0.25), (3.0, 0.1), (4.0, 0.2)];
        assert_eq!(front(points.into_iter()), [(1.0, 0.25), (3.0, 0.1)]);
    }

    #[test]
    fn the_spectral_solver_and_the_published_stop_are_drawn_where_the_record_has_them() {
        let mut timings = Timings::parse(include_str!("../../../pipeline/timings.toml")).unwrap();
        let table = |timings: &Timings| race(timings).table.unwrap();
        let stop = "\"Arrow-Hurwicz, published stop\"";
        let all = table(&timings);
        assert!(all.contains(",spectral,") && all.contains(stop), "{all}");
        timings.spectral.clear();
        timings.solver.retain(|line| line.goal != PUBLISHED);
        let fewer = table(&timings);
        assert!(!fewer.contains("spectral") && !fewer.contains(stop), "{fewer}");
        assert!(fewer.contains(",Arrow-Hurwicz,"), "{fewer}");
    }
}
