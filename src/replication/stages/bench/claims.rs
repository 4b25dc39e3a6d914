//! Pictures of the experiments on the paper's claims and on friction.

use crate::figures::Stroke::{Line, Marked, Reference};
use crate::figures::{Chart, Curve, Picture, Scale, charts};
use crate::replication::paper::Paper;
use signorini_mathematics::experiments::claims::{
    ClaimMeasure, Claims, Count, KktTarget, UzawaCell, VARIANTS,
};
use signorini_mathematics::experiments::sticking::StickingFindings;
use signorini_mathematics::saddle::StopRule;

/// Draws iterations against r: a row of panels per measure, a column per problem, a curve per grid.
pub(super) fn sweep(claims: &Claims) -> Picture {
    let target = claims.targets[0].kkt;
    let shown = [
        (ClaimMeasure::Rule(StopRule::Signed), "signed rule".to_owned()),
        (ClaimMeasure::Rule(StopRule::Printed), "printed rule".to_owned()),
        (ClaimMeasure::Kkt(target), format!("KKT residual {target:e}")),
    ];
    let mut panels = Vec::new();
    for (measure, name) in &shown {
        for problem in &claims.problems {
            let mut curves = Vec::new();
            for row in problem.rows.iter().filter(|row| row.measure == *measure) {
                let points = reached(claims.r.iter().zip(&row.counts));
                curves.push(Curve::new(Line, format!("1/{}", row.cells), points));
            }
            let title = format!("Problem {}, {name}", problem.number);
            panels.push(Chart::new(title, ["duality parameter r", "iterations"], curves));
        }
    }
    charts(true, &panels)
}

/// Draws the counts on the finest grid against r, a panel per problem: under the printed rule, under the signed rule,
/// and in rings of their own the published ones.
pub(super) fn rules(claims: &Claims, paper: &Paper) -> Picture {
    let mut panels = Vec::new();
    for problem in &claims.problems {
        let mut curves = Vec::new();
        for (rule, name) in [(StopRule::Printed, "printed rule"), (StopRule::Signed, "signed rule")]
        {
            for table in problem.tables.iter().filter(|table| table.rule == rule) {
                let finest =
                    table.lines.iter().filter_map(|line| Some((&line.r, line.counts.last()?)));
                curves.push(Curve::new(Marked, name, reached(finest)));
            }
        }
        for table in paper.table.iter().filter(|table| table.number == problem.number) {
            for (r, counts) in paper.r.iter().zip(&table.counts) {
                let point = counts.last().map(|&count| (*r, count as f64));
                curves.push(Curve::new(Marked, "published", point));
            }
        }
        let title = format!("Problem {}", problem.number);
        panels.push(Chart::new(title, ["duality parameter r", "iterations"], curves));
    }
    charts(true, &panels)
}

/// Draws sweeps against r to equal KKT residual: a row per residual, on the finest grid for which it was asked.
pub(super) fn uzawa(claims: &Claims) -> Picture {
    let mut panels = Vec::new();
    for &KktTarget { kkt: target, cells } in &claims.targets {
        for problem in &claims.problems {
            let shown: Vec<&UzawaCell> = problem
                .cells
                .iter()
                .filter(|cell| cell.target == target && cell.cells == cells)
                .collect();
            let points = reached(shown.iter().map(|cell| (&cell.r, &cell.arrow_hurwicz)));
            let mut curves = vec![Curve::new(Marked, "Arrow-Hurwicz", points)];
            for (k, variant) in VARIANTS.iter().enumerate() {
                let points = reached(shown.iter().map(|cell| (&cell.r, &cell.uzawa[k])));
                curves.push(Curve::new(Marked, variant.name, points));
            }
            let title = format!("Problem {}, h = 1/{cells}, KKT {target:e}", problem.number);
            panels.push(Chart::new(title, ["duality parameter r", "sweeps"], curves));
        }
    }
    charts(true, &panels)
}

/// Draws the lengths of the arcs that stick against one over the bound of the friction, beside the width of a fine
/// grid.
pub(super) fn sticking(found: &StickingFindings) -> Picture {
    /// Cells per side of the grid.
    const FINE: f64 = 1024.0;
    let lines = &found.lines;
    let points = lines.iter().map(|line| (1.0 / line.g, line.length));
    let ends = [lines.first(), lines.last()].into_iter().flatten().map(|line| 1.0 / line.g);
    let curves = vec![
        Curve::new(Marked, "arc that sticks, true solution", points),
        Curve::new(Reference, format!("h = 1/{FINE}"), ends.map(|x| (x, 1.0 / FINE))),
    ];
    let chart = Chart::new(format!("f = {}", found.f), ["1/g", "length"], curves);
    charts(false, &[chart.scaled([Scale::Linear, Scale::Logarithmic])])
}

/// Returns points (r, count) of the runs that reached their end.
fn reached<'a>(counts: impl Iterator<Item = (&'a f64, &'a Count)>) -> Vec<(f64, f64)> {
    counts.filter_map(|(r, count)| Some((*r, count.reached()? as f64))).collect()
}
