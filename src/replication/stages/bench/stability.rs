//! Pictures of the experiment on stability.

use crate::figures::Stroke::{Marked, Reference};
use crate::figures::{Chart, Curve, Picture, charts};
use signorini_mathematics::experiments::Rows;

/// Points with the residual of a method, where it is positive.
fn residuals(rows: &Rows, method: &str) -> Result<Vec<(f64, f64)>, String> {
    let mut points = rows.wherever("method", method)?.points("x", "kkt")?;
    points.retain(|point| point.1 > 0.0);
    Ok(points)
}

/// Draws the residual of the paper's method against the duality parameter.
pub(super) fn duality(runs: &Rows) -> Result<Picture, String> {
    let rows = runs.wherever("series", "duality")?;
    let mut curves = Vec::new();
    for name in rows.texts("problem")? {
        let rows = rows.wherever("problem", name)?;
        for rule in ["signed", "strict"] {
            let label = format!("{rule} rule, {name}");
            curves.push(Curve::new(Marked, label, residuals(&rows, rule)?));
        }
    }
    let r = rows.numbers("x")?;
    let ends = [r.first(), r.last()].into_iter().flatten().map(|&r| (r, 1.0));
    curves.push(Curve::new(Reference, "as large as the load", ends));
    Ok(charts(false, &[Chart::new("Where it stops", ["r", "KKT residual"], curves)]))
}

/// Draws the residual of three methods against the tolerance, a panel per problem.
pub(super) fn tolerances(runs: &Rows) -> Result<Picture, String> {
    let rows = runs.wherever("series", "tolerances")?;
    let mut panels = Vec::new();
    for name in rows.texts("problem")? {
        let rows = rows.wherever("problem", name)?;
        let mut curves = Vec::new();
        for (label, method) in
            [("signed rule", "signed"), ("strict rule", "strict"), ("multigrid", "multigrid")]
        {
            curves.push(Curve::new(Marked, label, residuals(&rows, method)?));
        }
        let asked = rows.wherever("method", "signed")?.points("x", "x")?;
        curves.push(Curve::new(Reference, "as asked", asked));
        panels.push(Chart::new(name, ["tolerance over the load", "KKT residual"], curves));
    }
    Ok(charts(false, &panels))
}
