//! Pictures of the experiment on the paper's claims.

use crate::experiments::claims::{Cell, Claims, Count, Measure, Measured, VARIANTS};
use crate::figures::Stroke::{Line, Marked};
use crate::figures::{Chart, Curve, Picture, charts};
use crate::saddle::StopRule;

type Points = Vec<(f64, f64)>;

/// Iterations against r: a row of panels per measure, a column per problem, a curve per grid.
pub(super) fn sweep(claims: &Claims) -> Picture {
    let (target, _) = claims.targets[0];
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
                Curve::new(
                    Line,
                    format!("1/{}", row.cells),
                    reached(claims.r.iter().zip(&row.counts)),
                )
            });
            let title = format!("Problem {}, {name}", problem.number);
            let axes = ["duality parameter r", "iterations"];
            panels.push(Chart::new(title, axes, curves.collect()));
        }
    }
    charts(true, &panels)
}

/// Sweeps against r to equal KKT residual: a row per residual, on the finest grid for which it was asked.
pub(super) fn uzawa(claims: &Claims) -> Picture {
    let mut panels = Vec::new();
    for &(target, cells) in &claims.targets {
        for problem in &claims.problems {
            let of = |variant| against(problem, target, cells, variant);
            let mut curves = vec![Curve::new(Marked, "Arrow-Hurwicz", of(None))];
            for (k, variant) in VARIANTS.iter().enumerate() {
                curves.push(Curve::new(Marked, variant.name, of(Some(k))));
            }
            let title = format!("Problem {}, h = 1/{cells}, KKT {target:e}", problem.number);
            panels.push(Chart::new(title, ["duality parameter r", "sweeps"], curves));
        }
    }
    charts(true, &panels)
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
