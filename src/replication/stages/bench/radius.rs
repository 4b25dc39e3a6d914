//! Picture of the spectral radius of one iteration.

use crate::figures::Stroke::{Line, Marked};
use crate::figures::{Chart, Curve, Picture, charts};
use signorini_mathematics::experiments::Rows;

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
