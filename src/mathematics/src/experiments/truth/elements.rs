//! Finite elements against a true solution: errors, ends of contact, and guaranteed bounds.

use crate::bounds::{Bounds, bounds};
use crate::discrete::contact::ContactArc;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::judge;
use crate::discrete::load::{self, LoadRule};
use crate::experiments::known::KnownSolution;
use crate::mesh::{arcs, square_boundary};
use crate::multigrid::{self, MultigridParams};
use crate::problem::law::Law;
use serde::Serialize;

/// Table `elements`: a problem on one grid, solved by multigrid to the rounding floor.
#[derive(Serialize)]
pub(super) struct ElementsRow {
    problem: String,
    /// f in the notation of scenes.
    f: String,
    cells: usize,
    /// Width of the grid.
    h: f64,
    /// True error: L2 norm of `grad (v - v_h)`.
    error: f64,
    /// Guaranteed lower bound of the error over the error, at most 1.
    lower: f64,
    /// Guaranteed upper bound of the error over the error, at least 1.
    upper: f64,
    /// As `lower`, for the solution with the load against bilinear hats.
    bilinear_lower: f64,
    /// As `upper`, likewise.
    bilinear_upper: f64,
    /// Energy of `v_h` less the true energy, if the latter is known.
    energy: Option<f64>,
    /// Width of the guaranteed bracket of the true energy.
    bracket: f64,
    /// True if the true energy lies in the guaranteed bracket; none if it is not known.
    holds: Option<bool>,
    /// Largest distance along the boundary between a true end of contact and the computed one; none if the numbers of
    /// arcs differ.
    ends: Option<f64>,
}

/// Solves a problem with known solution on grids with these cells per side.
pub(super) fn against(known: &KnownSolution, cells: &[usize]) -> Result<Vec<ElementsRow>, String> {
    let mut rows = Vec::new();
    for &cells in cells {
        let row = ElementsRow::of(known, cells);
        rows.push(row.map_err(|e| format!("{}, h = 1/{cells}: {e}", known.name()))?);
    }
    Ok(rows)
}

/// Solution on one grid, its error in the energy norm, and the guaranteed bounds.
struct Bounded {
    y: Vec<f64>,
    error: f64,
    bounds: Bounds,
}

impl Bounded {
    /// Solves with the load vector `load`; the error is measured with the load vector `exact` of the known solution.
    fn solve(
        known: &KnownSolution,
        grid: Grid,
        load: &[f64],
        exact: &[f64],
    ) -> Result<Self, String> {
        let params = MultigridParams::default();
        let (y, _) = multigrid::solve_square(grid.cells(), Law::SIGNORINI.with_load(load), &params)
            .map_err(|e| e.to_string())?;
        let bounds = bounds(grid, &known.f(), Law::SIGNORINI, &y).map_err(|e| e.to_string())?;
        Ok(Self { error: known.h1_error(grid, &y, exact), y, bounds })
    }
}

impl ElementsRow {
    fn of(known: &KnownSolution, cells: usize) -> Result<Self, String> {
        let grid = Grid::new(cells).map_err(|e| e.clone())?;
        let load = known.load(grid);
        let against_hats = load::load(grid, &known.f(), LoadRule::Bilinear {});
        let Bounded { y, error, bounds } = Bounded::solve(known, grid, &load, &load)?;
        let bilinear = Bounded::solve(known, grid, &against_hats, &load)?;
        let [low, high] = bounds.energy;
        let truth = known.found().map(|found| &found.solution);
        let judgement = judge(grid, Law::SIGNORINI, &y, &load);
        let contact = arcs(&[square_boundary(grid)], &y, &judgement);
        let [lower, upper] = bounds.error.map(|bound| bound / error);
        let [bilinear_lower, bilinear_upper] =
            bilinear.bounds.error.map(|bound| bound / bilinear.error);
        Ok(Self {
            problem: known.name().into(),
            f: known.f().to_string(),
            cells,
            h: 1.0 / cells as f64,
            error,
            lower,
            upper,
            bilinear_lower,
            bilinear_upper,
            energy: truth.map(|truth| judgement.energy - truth.energy),
            bracket: high - low,
            holds: truth.map(|truth| low <= truth.energy && truth.energy <= high),
            ends: truth.and_then(|truth| distance(&truth.contact, &contact)),
        })
    }
}

/// Arc length along the boundary from the lower left corner to a point, anticlockwise, in sides.
fn arc_length([x, y]: [f64; 2]) -> f64 {
    let (right, up) = (x + 0.5, y + 0.5);
    if y == -0.5 {
        right
    } else if x == 0.5 {
        1.0 + up
    } else if y == 0.5 {
        3.0 - right
    } else {
        4.0 - up
    }
}

/// Distance of two points of the boundary along the boundary.
fn apart(p: [f64; 2], q: [f64; 2]) -> f64 {
    let d = (arc_length(p) - arc_length(q)).rem_euclid(4.0);
    d.min(4.0 - d)
}

/// Largest distance between ends of arcs, each true arc compared with the nearest found one; none without ends, or if
/// the numbers of arcs differ.
fn distance(truth: &[ContactArc], found: &[ContactArc]) -> Option<f64> {
    if truth.len() != found.len() || truth.iter().chain(found).any(|arc| arc.closed) {
        return None;
    }
    let mut largest: Option<f64> = None;
    for arc in truth {
        let mut nearest = f64::INFINITY;
        for other in found {
            nearest = nearest.min(apart(arc.from, other.from).max(apart(arc.to, other.to)));
        }
        largest = Some(largest.map_or(nearest, |largest| largest.max(nearest)));
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(from: [f64; 2], to: [f64; 2]) -> ContactArc {
        ContactArc::on_square([from, to], 1.0)
    }

    #[test]
    fn ends_are_compared_along_the_boundary() {
        let truth = [arc([0.5, 0.2], [0.2, 0.5]), arc([-0.5, -0.1], [-0.1, -0.5])];
        let found = [arc([-0.5, -0.2], [-0.1, -0.5]), arc([0.5, 0.2], [0.25, 0.5])];
        assert!((distance(&truth, &found).unwrap() - 0.1).abs() < 1e-15);
        // Across the lower left corner.
        let [one, other] = [arc([-0.5, -0.49], [0.0, -0.5]), arc([-0.48, -0.5], [0.0, -0.5])];
        assert!((distance(&[one], &[other]).unwrap() - 0.03).abs() < 1e-15);
        assert_eq!(distance(&truth, &found[..1]), None);
    }
}
