//! The pictures of the chapter on accuracy and cost, from results and recorded times to SVG.

use crate::figures::Stroke::Marked;
use crate::figures::{Chart, Curve, Picture, charts};
use crate::table::rows::Rows;
use crate::timing::recorded::{GOALS, PUBLISHED, Timings};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::solvers::Solver;

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
        runs.0.retain(|row| row.get("goal").is_none_or(|goal| goal != PUBLISHED));
        let points = front(runs.points("seconds", "error")?);
        curves.push(Curve::new(Marked, solver.entry().in_words, points));
    }
    curves.push(Curve::new(Marked, "Arrow-Hurwicz, published stop", published));
    let known = format!("exact({problem})").parse::<Source>().is_ok();
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

#[cfg(test)]
mod tests {
    use super::*;

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
        timings.solver.0.retain(|row| row["goal"] != PUBLISHED);
        let fewer = race(&timings).unwrap().table.unwrap();
        assert!(!fewer.contains("spectral") && !fewer.contains(stop), "{fewer}");
        assert!(fewer.contains(",Arrow-Hurwicz,"), "{fewer}");
    }
}
