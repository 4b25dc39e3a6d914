//! Pictures of the experiment on the paper's claims.

use super::{Drawn, result};
use crate::experiments::claims::{Cell, Claims, Count, Measure, Measured, VARIANTS};
use crate::figures::{Axis, Caption, Chart, Curve, Scale, Stroke, charts};
use crate::pipeline::Inputs;
use crate::saddle::StopRule;

type Points = Vec<(f64, f64)>;

/// A panel that owns its data.
struct Panel {
    title: String,
    counted: &'static str,
    curves: Vec<(String, Points)>,
}

/// Iterations against r: a row of panels per measure, a column per problem, a curve per grid.
pub(super) fn sweep(inputs: &Inputs, caption: Caption) -> Drawn {
    let claims: Claims = result(inputs, "claims")?;
    let (target, _) = *claims.targets.first().ok_or("no KKT residual was asked for")?;
    let shown = [
        (Measure::Rule(StopRule::Signed), "signed rule".to_owned()),
        (Measure::Rule(StopRule::Printed), "printed rule".to_owned()),
        (Measure::Kkt(target), format!("KKT residual {target:e}")),
    ];
    let mut panels = Vec::new();
    for (measure, name) in &shown {
        for problem in &claims.problems {
            let rows = problem.rows.iter().filter(|row| row.measure == *measure);
            let curves = rows.map(|row| {
                (format!("1/{}", row.cells), reached(claims.r.iter().zip(row.counts.iter())))
            });
            panels.push(Panel {
                title: format!("Problem {}, {name}", problem.number),
                counted: "iterations",
                curves: curves.collect(),
            });
        }
    }
    draw(caption, claims.problems.len(), Stroke::Line, &panels)
}

/// Sweeps against r to equal KKT residual: a row per residual, on the finest grid for which it was asked.
pub(super) fn uzawa(inputs: &Inputs, caption: Caption) -> Drawn {
    let claims: Claims = result(inputs, "claims")?;
    let mut panels = Vec::new();
    for &(target, cells) in &claims.targets {
        for problem in &claims.problems {
            let mut curves = vec![("Arrow-Hurwicz".into(), against(problem, target, cells, None))];
            for (k, variant) in VARIANTS.iter().enumerate() {
                curves.push((variant.name.into(), against(problem, target, cells, Some(k))));
            }
            panels.push(Panel {
                title: format!("Problem {}, h = 1/{cells}, KKT {target:e}", problem.number),
                counted: "sweeps",
                curves,
            });
        }
    }
    draw(caption, claims.problems.len(), Stroke::Marked, &panels)
}

/// A method over r on one grid; `variant` is a place in [`VARIANTS`], `None` stands for Arrow-Hurwicz.
fn against<'a>(problem: &'a Measured, target: f64, cells: usize, variant: Option<usize>) -> Points {
    let shown = problem.cells.iter().filter(|cell| cell.target == target && cell.cells == cells);
    let count = |cell: &'a Cell| variant.map_or(&cell.arrow_hurwicz, |k| &cell.uzawa[k]);
    reached(shown.map(|cell| (&cell.r, count(cell))))
}

/// The counts of runs that reached their end.
fn reached<'a>(counts: impl Iterator<Item = (&'a f64, &'a Count)>) -> Points {
    counts.filter_map(|(r, count)| Some((*r, count.reached()? as f64))).collect()
}

fn draw(caption: Caption, columns: usize, stroke: Stroke, panels: &[Panel]) -> Drawn {
    // One range for all panels, so that they can be compared.
    let counts = panels.iter().flat_map(|panel| &panel.curves).flat_map(|(_, points)| points);
    let range = counts.map(|point| point.1).fold(None, |range, count| {
        let (low, high) = range.unwrap_or((count, count));
        Some((count.min(low), count.max(high)))
    });
    let curves: Vec<Vec<Curve>> = panels
        .iter()
        .map(|panel| {
            let drawn = panel.curves.iter().filter(|(_, points)| !points.is_empty());
            drawn.map(|(label, points)| Curve { label, points, stroke }).collect()
        })
        .collect();
    let charted: Vec<Chart> = panels
        .iter()
        .zip(&curves)
        .map(|(panel, curves)| Chart {
            title: &panel.title,
            x: Axis { name: "duality parameter r", scale: Scale::Log, range: None },
            y: Axis { name: panel.counted, scale: Scale::Log, range },
            curves,
        })
        .collect();
    charts(caption, columns, &charted).map_err(|e| e.to_string())
}
