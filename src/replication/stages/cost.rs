//! The pictures of the chapter on accuracy and cost, from results and recorded times to SVG.

use crate::figures::Stroke::{Marked, Reference};
use crate::figures::{Chart, Curve, Picture, charts};
use crate::timing::recorded::{GOALS, PUBLISHED, Timings, text};
use signorini_mathematics::experiments::Rows;
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::solvers::Solver;

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
        let ends = extremes(points.iter().map(|point| point.0));
        let [least, greatest] = extremes(points.iter().map(|(x, y)| y / libm::pow(*x, self.power)));
        let constant = self.factor * if self.factor < 1.0 { least } else { greatest };
        let ends = ends.map(|x| (x, constant * libm::pow(x, self.power)));
        Curve::new(Reference, self.label, ends)
    }
}

/// Returns the least and the greatest of some numbers; zeros of none.
fn extremes(numbers: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    [numbers.clone().reduce(f64::min), numbers.reduce(f64::max)].map(Option::unwrap_or_default)
}

/// Curves of a column over the cells per side, one for each problem.
fn over_grids(rows: &Rows, column: &str) -> Result<Vec<Curve>, String> {
    let mut curves = Vec::new();
    for problem in rows.texts("problem")? {
        let points = rows.wherever("problem", problem)?.points("cells", column)?;
        curves.push(Curve::new(Marked, problem, points));
    }
    Ok(curves)
}

/// Time per unknown of multigrid, for both goals.
pub(super) fn cost(timings: &Timings) -> Result<Picture, String> {
    let timed = timings.extended().multigrid;
    let mut panels = Vec::new();
    for (goal, title) in
        GOALS.into_iter().zip(["To the discretisation error", "To the rounding floor"])
    {
        let mut curves = Vec::new();
        for (label, threads) in [("multigrid", 1), ("multigrid, two threads", 2)] {
            let rows = timed.wherever("goal", goal)?.wherever("threads", threads)?;
            curves.push(Curve::new(Marked, label, rows.points("unknowns", "ns")?));
        }
        panels.push(Chart::new(title, ["unknowns", "nanoseconds per unknown"], curves));
    }
    Ok(charts(false, &panels))
}

/// Error against time, one panel per problem; of each solver, the runs that none of its other runs beats.
pub(super) fn race(timings: &Timings) -> Result<Picture, String> {
    let mut problems = timings.solver.texts("problem")?;
    for problem in timings.spectral.texts("problem")? {
        if !problems.contains(&problem) {
            problems.push(problem);
        }
    }
    let panels: Result<Vec<_>, String> =
        problems.into_iter().map(|problem| race_of(timings, problem)).collect();
    let mut panels = panels?;
    for problem in timings.adapted.texts("problem")? {
        let rows = timings.adapted.wherever("problem", problem)?;
        let mut curves = by_way(&rows, "seconds")?;
        for curve in &mut curves {
            // Elements are solved by multigrid.
            curve.label = match &curve.label[..] {
                "uniform" => Solver::Multigrid.entry().in_words.into(),
                "adaptive" => "multigrid, adapted meshes".into(),
                way => way.into(),
            };
        }
        panels.push(Chart::new(problem, ["seconds", "guaranteed error"], curves));
    }
    Ok(charts(false, &panels))
}

/// Errors over a column, a curve per way of refinement.
fn by_way(rows: &Rows, column: &str) -> Result<Vec<Curve>, String> {
    let mut curves = Vec::new();
    for way in rows.texts("way")? {
        curves.push(Curve::new(Marked, way, rows.wherever("way", way)?.points(column, "error")?));
    }
    Ok(curves)
}

/// Panel of error against time for one problem, a curve per solver.
fn race_of(timings: &Timings, problem: &str) -> Result<Chart, String> {
    let spectral = timings.spectral.wherever("problem", problem)?.points("seconds", "error")?;
    let mut curves = vec![Curve::new(Marked, Solver::Spectral.entry().in_words, front(spectral))];
    let rows = timings.solver.wherever("problem", problem)?;
    let published = rows.wherever("goal", PUBLISHED)?.points("seconds", "error")?;
    for solver in Solver::on_grids().into_iter().rev() {
        let mut runs = rows.wherever("solver", solver.to_string())?;
        runs.0.retain(|row| text(row, "goal") != PUBLISHED);
        let points = front(runs.points("seconds", "error")?);
        curves.push(Curve::new(Marked, solver.entry().in_words, points));
    }
    curves.push(Curve::new(Marked, "Arrow-Hurwicz, published stop", published));
    let known = Exact::ALL.iter().any(|exact| exact.name() == problem);
    let error = if known { "L2 error at the nodes" } else { "error of the energy, relative" };
    Ok(Chart::new(problem, ["seconds", error], curves))
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

/// Errors of the ends of contact, and widths of the bracket of the energy, against the cells per side, where the true
/// energy is known.
pub(super) fn ends(rows: &Rows) -> Result<Picture, String> {
    let mut known = rows.clone();
    known.0.retain(|row| row["energy"].is_number());
    let mut ends = over_grids(&known, "ends")?;
    ends.retain(|curve| !curve.points.is_empty());
    ends.push(Law { label: "order 3/2", power: -1.5, factor: 2.5 }.beside(&ends));
    let mut brackets = over_grids(&known, "bracket")?;
    brackets.push(Law { label: "order 3", power: -3.0, factor: 2.5 }.beside(&brackets));
    let panels = [
        Chart::new("Ends of contact", ["1/h", "largest error along the boundary"], ends),
        Chart::new("Guaranteed bracket of the energy", ["1/h", "width"], brackets),
    ];
    Ok(charts(false, &panels))
}

/// Error of the energy against the number of unknowns, one panel per domain, a curve per way.
pub(super) fn ways(rows: &Rows) -> Result<Picture, String> {
    let mut panels = Vec::new();
    for domain in rows.texts("domain")? {
        let of_domain = rows.wherever("domain", domain)?;
        // The last f of a domain has ends of contact.
        let Some(f) = of_domain.texts("f")?.last().copied().map(String::from) else { continue };
        let of_domain = of_domain.wherever("f", f)?;
        let mut curves = by_way(&of_domain, "unknowns")?;
        for curve in &mut curves {
            curve.points.retain(|(_, error)| *error > 0.0);
        }
        panels.push(Chart::new(domain, ["unknowns", "error of the energy, relative"], curves));
    }
    Ok(charts(false, &panels))
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
        let all = race(&timings).unwrap().table.unwrap();
        assert!(all.contains(",spectral,") && all.contains(stop), "{all}");
        (timings.spectral, timings.adapted) = (Rows::default(), Rows::default());
        timings.solver.0.retain(|row| text(row, "goal") != PUBLISHED);
        let fewer = race(&timings).unwrap().table.unwrap();
        assert!(!fewer.contains("spectral") && !fewer.contains(stop), "{fewer}");
        assert!(fewer.contains(",Arrow-Hurwicz,"), "{fewer}");
    }
}
