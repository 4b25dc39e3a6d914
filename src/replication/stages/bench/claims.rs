//! Pictures of the experiments on the paper's claims and on friction.

use crate::figures::Stroke::{Line, Marked};
use crate::figures::{Chart, Curve, Picture, charts};
use crate::replication::paper::Paper;
use signorini_mathematics::experiments::Rows;

/// Names of the axes of the charts of iterations.
const AXES: [&str; 2] = ["duality parameter r", "iterations"];
/// Numbers of the paper's problems.
const PROBLEMS: [u8; 2] = [1, 2];

/// Draws iterations against r: a row of panels per end of the runs, a column per problem, a curve per grid.
pub(super) fn sweep(runs: &Rows) -> Result<Picture, String> {
    let swept = runs.wherever("is_swept", true)?.wherever("stop", "converged")?;
    let target = format!("{:e}", targets(runs)?[0]);
    let mut panels = Vec::new();
    for (end, name) in [
        ("signed", "signed rule".into()),
        ("printed", "printed rule".into()),
        (&target, format!("KKT residual {target}")),
    ] {
        for problem in PROBLEMS {
            let rows = swept.wherever("end", end)?.wherever("problem", problem)?;
            let mut cells = rows.numbers("cells")?;
            cells.dedup();
            let mut curves = Vec::new();
            for cells in cells {
                let points = rows.wherever("cells", cells as usize)?.points("r", "sweeps")?;
                curves.push(Curve::new(Line, format!("1/{cells}"), points));
            }
            panels.push(Chart::new(format!("Problem {problem}, {name}"), AXES, curves));
        }
    }
    Ok(charts(true, &panels))
}

/// Draws the counts on the finest grid against r, a panel per problem: under the printed rule, under the signed rule,
/// and in rings of their own the published ones.
pub(super) fn rules(runs: &Rows, paper: &Paper) -> Result<Picture, String> {
    let mut panels = Vec::new();
    for problem in PROBLEMS {
        let rows = finest(&runs.wherever("problem", problem)?)?.wherever("stop", "converged")?;
        let mut curves = Vec::new();
        for (end, name) in [("printed", "printed rule"), ("signed", "signed rule")] {
            let points = rows.wherever("end", end)?.points("r", "sweeps")?;
            let papers = paper.r.iter().filter_map(|r| points.iter().find(|point| point.0 == *r));
            curves.push(Curve::new(Marked, name, papers.copied()));
        }
        for table in paper.table.iter().filter(|table| table.number == problem) {
            for (r, counts) in paper.r.iter().zip(&table.counts) {
                let point = counts.last().map(|&count| (*r, count as f64));
                curves.push(Curve::new(Marked, "published", point));
            }
        }
        panels.push(Chart::new(format!("Problem {problem}"), AXES, curves));
    }
    Ok(charts(true, &panels))
}

/// KKT residuals at which runs end, from the largest on.
fn targets(runs: &Rows) -> Result<Vec<f64>, String> {
    let mut targets = runs.numbers("target")?;
    targets.sort_by(|one, other| other.total_cmp(one));
    targets.dedup();
    Ok(targets)
}

/// Rows on the finest of their grids.
fn finest(rows: &Rows) -> Result<Rows, String> {
    let cells = rows.numbers("cells")?.into_iter().fold(0.0, f64::max);
    rows.wherever("cells", cells as usize)
}

/// Draws sweeps against r to equal KKT residual: a row per residual, on the finest grid for which it was asked.
pub(super) fn uzawa(runs: &Rows) -> Result<Picture, String> {
    let mut panels = Vec::new();
    for target in targets(runs)? {
        let rows = finest(&runs.wherever("target", target)?)?;
        let cells = rows.numbers("cells")?;
        for problem in PROBLEMS {
            let rows = rows.wherever("problem", problem)?;
            let compared = rows.wherever("is_swept", false)?.numbers("r")?;
            let mut curves = Vec::new();
            for method in rows.texts("method")? {
                let points = rows.wherever("method", method)?.wherever("stop", "converged")?;
                let points = points.points("r", "sweeps")?;
                let points = points.into_iter().filter(|(r, _)| compared.contains(r));
                curves.push(Curve::new(Marked, method, points));
            }
            let title = format!("Problem {problem}, h = 1/{}, KKT {target:e}", cells[0]);
            panels.push(Chart::new(title, ["duality parameter r", "sweeps"], curves));
        }
    }
    Ok(charts(true, &panels))
}

/// Draws one minus the spectral radius of one iteration against r: a panel per problem, a curve per grid, and in
/// rings what the method itself does.
pub(super) fn radius(radii: &Rows, measured: &Rows) -> Result<Picture, String> {
    let mut panels = Vec::new();
    for problem in radii.texts("problem")? {
        let rows = radii.wherever("problem", problem)?;
        let mut cells = rows.numbers("cells")?;
        cells.dedup();
        let mut curves = Vec::new();
        for cells in cells {
            let rows = rows.wherever("cells", cells as usize)?;
            let points = rows.points("r", "gap")?;
            curves.push(Curve::new(Line, format!("h = 1/{cells}"), points));
        }
        let rings = measured.wherever("problem", problem)?.points("r", "gap")?;
        curves.extend(
            rings.into_iter().map(|point| Curve::new(Marked, "the method itself", [point])),
        );
        let title = problem.replacen("problem", "Problem", 1);
        panels.push(Chart::new(title, ["duality parameter r", "1 - spectral radius"], curves));
    }
    Ok(charts(true, &panels))
}
