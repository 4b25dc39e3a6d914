//! The pictures of the chapter on accuracy and cost, from results and recorded times to SVG.

use crate::figures::Stroke::{Marked, Reference};
use crate::figures::{Chart, Curve, Picture, charts};
use crate::timing::recorded::{Goal, PUBLISHED, SolverTime, Timings};
use signorini_mathematics::experiments::Range;
use signorini_mathematics::experiments::accuracy::{self, AccuracyFindings, KnownLevels};
use signorini_mathematics::experiments::adapted::{AdaptedFindings, ErrorCurves};
use signorini_mathematics::experiments::truth::{Elements, ElementsLevel, Truth};
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::solvers::Solver;
use std::collections::BTreeSet;

/// Law of an error over the cells per side n, drawn as a straight line beside curves: constant * n^`power`.
struct Law {
    label: &'static str,
    power: f64,
    /// Distance of the line from the nearest curve, as a factor: the line is above all curves if it exceeds 1, else
    /// below all curves.
    factor: f64,
}

impl Law {
    /// Returns the line over the range of the `curves`.
    fn beside(&self, curves: &[Curve]) -> Curve {
        let points: Vec<_> = curves.iter().flat_map(|curve| curve.points.iter().copied()).collect();
        let x = Range::of(points.iter().map(|point| point.0)).unwrap_or_default();
        let scaled = points.iter().map(|(x, y)| y / libm::pow(*x, self.power));
        let scaled = Range::of(scaled).unwrap_or_default();
        let nearest = if self.factor < 1.0 { scaled.least } else { scaled.greatest };
        let constant = self.factor * nearest;
        let ends = [x.least, x.greatest].map(|x| (x, constant * libm::pow(x, self.power)));
        Curve::new(Reference, self.label, ends)
    }
}

/// Errors of the problems with known solutions, one panel per norm.
pub(super) fn accuracy(found: &AccuracyFindings) -> Picture {
    let two = [Law { label: "order 2", power: -2.0, factor: 0.12 }];
    let one = [Law { label: "order 1", power: -1.0, factor: 0.25 }];
    let both = [
        Law { label: "order 2", power: -2.0, factor: 0.3 },
        Law { label: "order 1", power: -1.0, factor: 2.0 },
    ];
    let problems = &found.problems;
    let panels = [
        errors(problems, ["v in L2", "error in L2"], |level| level.errors.l2, &two),
        errors(problems, ["v in H1", "error in H1"], |level| Some(level.errors.h1), &one),
        errors(
            problems,
            ["v at the nodes", "greatest error"],
            |level| Some(level.errors.max),
            &two,
        ),
        errors(
            problems,
            ["multiplier in L2", "error in L2 of the boundary"],
            |level| Some(level.errors.multiplier_l2),
            &both,
        ),
    ];
    charts(false, &panels)
}

/// Panel of one error over the cells per side, a curve per problem, with `laws` to compare.
fn errors(
    problems: &[KnownLevels<accuracy::AccuracyLevel>],
    [title, axis]: [&'static str; 2],
    error: fn(&accuracy::AccuracyLevel) -> Option<f64>,
    laws: &[Law],
) -> Chart {
    let mut curves = Vec::new();
    for problem in problems {
        let levels = problem.levels.iter();
        let points = levels.filter_map(|level| Some((level.cost.cells as f64, error(level)?)));
        curves.push(Curve::new(Marked, &problem.name, points));
    }
    let lines: Vec<_> = laws.iter().map(|law| law.beside(&curves)).collect();
    curves.extend(lines);
    Chart::new(title, ["1/h", axis], curves)
}

/// Guaranteed errors over the number of nodes, one panel per problem, a curve per way of refinement.
pub(super) fn adapted(found: &AdaptedFindings) -> Picture {
    let mut panels = Vec::new();
    for ErrorCurves { name, ways, .. } in &found.problems {
        let mut curves = Vec::new();
        for way in ways {
            let points = way.meshes.iter().map(|mesh| (mesh.nodes as f64, mesh.error));
            curves.push(Curve::new(Marked, way.way.name(), points));
        }
        curves.push(Law { label: "order 1/2", power: -0.5, factor: 0.6 }.beside(&curves));
        panels.push(Chart::new(name, ["nodes", "guaranteed error"], curves));
    }
    charts(false, &panels)
}

/// Time per unknown of multigrid, for both goals.
pub(super) fn cost(timings: &Timings) -> Picture {
    charts(
        false,
        &[
            per_unknown(timings, "To the discretisation error", Goal::Discretisation),
            per_unknown(timings, "To the rounding floor", Goal::Floor),
        ],
    )
}

/// Panel of multigrid's time per unknown to one goal, a curve per number of threads.
fn per_unknown(timings: &Timings, title: &str, goal: Goal) -> Chart {
    let mut curves = Vec::new();
    for (label, threads) in [("multigrid", 1), ("multigrid, two threads", 2)] {
        let lines = timings.multigrid.iter();
        let lines = lines.filter(|line| line.goal == goal && line.threads == threads);
        let points = lines.map(|line| (line.unknowns() as f64, line.ns()));
        curves.push(Curve::new(Marked, label, points));
    }
    Chart::new(title, ["unknowns", "nanoseconds per unknown"], curves)
}

/// Error against time, one panel per problem; of each solver, the runs that none of its other runs beats.
pub(super) fn race(timings: &Timings) -> Picture {
    let mut problems: Vec<&str> = timings.solver.iter().map(|line| &line.problem[..]).collect();
    problems.extend(timings.spectral.iter().map(|line| &line.problem[..]));
    let mut seen = BTreeSet::new();
    problems.retain(|problem| seen.insert(*problem));
    let panels: Vec<_> = problems.into_iter().map(|problem| race_of(timings, problem)).collect();
    charts(false, &panels)
}

/// Panel of error against time for one problem, a curve per solver.
fn race_of(timings: &Timings, problem: &str) -> Chart {
    let spectral = timings.spectral.iter().filter(|line| line.problem == problem);
    let spectral = spectral.map(|line| (line.seconds, line.error)).collect();
    let mut curves = vec![Curve::new(Marked, Solver::Spectral.entry().in_words, front(spectral))];
    let lines = timings.solver.iter().filter(|line| line.problem == problem);
    let (published, others): (Vec<&SolverTime>, Vec<&SolverTime>) =
        lines.partition(|line| line.goal == PUBLISHED);
    for solver in Solver::on_grids().into_iter().rev() {
        let points = others.iter().filter(|line| line.solver == solver);
        let points = points.map(|line| (line.seconds, line.error)).collect();
        curves.push(Curve::new(Marked, solver.entry().in_words, front(points)));
    }
    let points = published.iter().map(|line| (line.seconds, line.error));
    curves.push(Curve::new(Marked, "Arrow-Hurwicz, published stop", points));
    let known = Exact::ALL.iter().any(|exact| exact.name() == problem);
    let error = if known { "L2 error at the nodes" } else { "error of the energy, relative" };
    Chart::new(problem, ["seconds", error], curves)
}

/// Sorts points (time, error) by time, and removes those that an earlier point beats.
fn front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = f64::INFINITY;
    points.retain(|(_, error)| {
        let better = *error < best;
        best = best.min(*error);
        better
    });
    points
}

/// Errors of the ends of contact, and widths of the bracket of the energy, against the cells per side.
pub(super) fn ends(found: &Truth) -> Picture {
    let mut ends = over_grids(found, |level| level.ends);
    ends.push(Law { label: "order 3/2", power: -1.5, factor: 2.5 }.beside(&ends));
    let mut brackets = over_grids(found, |level| Some(level.bracket));
    brackets.push(Law { label: "order 3", power: -3.0, factor: 2.5 }.beside(&brackets));
    let panels = [
        Chart::new("Ends of contact", ["1/h", "largest error along the boundary"], ends),
        Chart::new("Guaranteed bracket of the energy", ["1/h", "width"], brackets),
    ];
    charts(false, &panels)
}

/// Curves of a value over the cells per side, one for each problem whose energy is known on all grids.
fn over_grids(found: &Truth, value: fn(&ElementsLevel) -> Option<f64>) -> Vec<Curve> {
    let mut curves = Vec::new();
    for Elements { name, levels, .. } in &found.elements {
        let known = levels.iter().all(|level| level.energy.is_some());
        let points = levels.iter().filter_map(|level| Some((level.cells as f64, value(level)?)));
        let curve = Curve::new(Marked, name, points);
        if known && !curve.points.is_empty() {
            curves.push(curve);
        }
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_pass_the_lines_by_at_the_factor_of_the_nearest() {
        // Times x, the values are 4, 8 and 6: the lowest is on the first line, the highest too.
        let lines = [[(1.0, 4.0), (4.0, 2.0)], [(2.0, 3.0), (3.0, 2.0)]];
        let curves = lines.map(|points| Curve::new(Marked, "", points));
        let below = Law { label: "", power: -1.0, factor: 0.5 };
        assert_eq!(below.beside(&curves).points, [(1.0, 2.0), (4.0, 0.5)]);
        let above = Law { label: "", power: -1.0, factor: 2.0 };
        assert_eq!(above.beside(&curves).points, [(1.0, 16.0), (4.0, 4.0)]);
    }

    #[test]
    fn a_run_that_another_beats_is_left_out() {
        let points = vec![(2.0, 0.5), (1.0, 0.25), (3.0, 0.1), (4.0, 0.2)];
        assert_eq!(front(points), [(1.0, 0.25), (3.0, 0.1)]);
    }

    #[test]
    fn the_spectral_solver_and_the_published_stop_are_drawn_where_the_record_has_them() {
        let mut timings = Timings::parse(include_str!("../../../pipeline/timings.toml")).unwrap();
        let stop = "\"Arrow-Hurwicz, published stop\"";
        let all = race(&timings).table.unwrap();
        assert!(all.contains(",spectral,") && all.contains(stop), "{all}");
        timings.spectral.clear();
        timings.solver.retain(|line| line.goal != PUBLISHED);
        let fewer = race(&timings).table.unwrap();
        assert!(!fewer.contains("spectral") && !fewer.contains(stop), "{fewer}");
        assert!(fewer.contains(",Arrow-Hurwicz,"), "{fewer}");
    }
}
