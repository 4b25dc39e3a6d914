//! Finite elements against a true solution: errors, ends of contact, and what the guaranteed bounds say.

use crate::bounds::bounds;
use crate::discrete::contact::{ContactArc, arcs};
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::load::{self, LoadRule};
use crate::experiments::exponent;
use crate::experiments::known::KnownSolution;
use crate::multigrid::{self, MultigridParams};
use serde::{Deserialize, Serialize};

/// One problem on all grids, solved by multigrid to the rounding floor.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Elements {
    /// Name of the problem.
    pub name: String,
    /// f in the notation of scenes.
    pub f: String,
    /// Grid by grid.
    pub levels: Vec<Level>,
    /// Exponents of h: of the error in the energy norm and of the energy, fitted to the three finest grids, and
    /// of the ends of contact, which jump from grid to grid, to all of them.
    pub orders: [Option<f64>; 3],
}

/// One problem on one grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Level {
    /// Cells per side.
    pub cells: usize,
    /// True error: L2 norm of `grad (v - v_h)`.
    pub error: f64,
    /// The guaranteed bounds of it, over it: at most 1, and at least 1.
    pub effectivity: [f64; 2],
    /// The same for the solution with the load against bilinear hats.
    pub bilinear: [f64; 2],
    /// The energy of `v_h` less the true one, if that is known.
    pub energy: Option<f64>,
    /// Width of the guaranteed bracket of the true energy.
    pub bracket: f64,
    /// Whether the true energy lies in it, if that is known.
    pub holds: Option<bool>,
    /// The largest distance between a true end of contact and the computed one, along the boundary, if there
    /// are as many arcs.
    pub ends: Option<f64>,
}

impl Elements {
    pub(super) fn against(known: &KnownSolution, cells: &[usize]) -> Result<Self, String> {
        let level = |&cells: &usize| Level::of(known, cells);
        let levels = cells.iter().map(level).collect::<Result<Vec<_>, String>>()?;
        let order = |finest: usize, of: &dyn Fn(&Level) -> Option<f64>| {
            let points: Vec<_> = levels
                .iter()
                .rev()
                .take(finest)
                .filter_map(|level| Some((1.0 / level.cells as f64, of(level)?)))
                .collect();
            Some(exponent(&points)).filter(|order| order.is_finite())
        };
        let orders = [
            order(3, &|level| Some(level.error)),
            order(3, &|level| level.energy),
            order(levels.len(), &|level| level.ends),
        ];
        Ok(Self { name: known.name().into(), f: known.f().to_string(), levels, orders })
    }
}

impl Level {
    fn of(known: &KnownSolution, cells: usize) -> Result<Self, String> {
        let failed = |e: &dyn std::fmt::Display| format!("{}, h = 1/{cells}: {e}", known.name());
        let grid = Grid::new(cells).map_err(|e| failed(&e))?;
        let (f, load) = (known.f(), known.load(grid));
        // A solution, its error in the energy norm, and what is guaranteed of it.
        let bounded = |its_load: &[f64]| {
            let params = MultigridParams::default();
            let (y, _) =
                multigrid::solve_square(cells, its_load, None, &params).map_err(|e| failed(&e))?;
            let bounds = bounds(grid, &f, &y).map_err(|e| failed(&e))?;
            Ok::<_, String>((known.h1_error(grid, &y, &load), y, bounds))
        };
        let (error, y, bounds) = bounded(&load)?;
        let (bilinear_error, _, closer) = bounded(&load::load(grid, &f, LoadRule::Bilinear {}))?;
        let [low, high] = bounds.energy;
        let truth = known.solution();
        let Judgement { energy, flux, .. } = judge(grid, &y, &load);
        let contact = arcs(grid, &y, &flux);
        Ok(Self {
            cells,
            error,
            effectivity: bounds.error.map(|bound| bound / error),
            bilinear: closer.error.map(|bound| bound / bilinear_error),
            energy: truth.map(|truth| energy - truth.energy),
            bracket: high - low,
            holds: truth.map(|truth| low <= truth.energy && truth.energy <= high),
            ends: truth.and_then(|truth| distance(&truth.contact, &contact)),
        })
    }
}

/// The arc length along the boundary from the lower left corner to a point, anticlockwise, in sides.
pub(in crate::experiments) fn arc_length([x, y]: [f64; 2]) -> f64 {
    let (right, up) = (x + 0.5, y + 0.5);
    match () {
        () if y == -0.5 => right,
        () if x == 0.5 => 1.0 + up,
        () if y == 0.5 => 3.0 - right,
        () => 4.0 - up,
    }
}

/// The largest distance between ends of arcs, each found arc taken for the true one that begins next to it;
/// none without ends, or if their numbers differ.
fn distance(truth: &[ContactArc], found: &[ContactArc]) -> Option<f64> {
    if truth.len() != found.len() || truth.iter().chain(found).any(|arc| arc.from == arc.to) {
        return None;
    }
    let apart = |p: [f64; 2], q: [f64; 2]| {
        let d = (arc_length(p) - arc_length(q)).rem_euclid(4.0);
        d.min(4.0 - d)
    };
    let nearest = |arc: &ContactArc| {
        let distances =
            found.iter().map(|other| apart(arc.from, other.from).max(apart(arc.to, other.to)));
        distances.fold(f64::INFINITY, f64::min)
    };
    truth.iter().map(nearest).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_compared_along_the_boundary() {
        let arc = |from, to| ContactArc { from, to, force: 1.0 };
        let truth = [arc([0.5, 0.2], [0.2, 0.5]), arc([-0.5, -0.1], [-0.1, -0.5])];
        let found = [arc([-0.5, -0.2], [-0.1, -0.5]), arc([0.5, 0.2], [0.25, 0.5])];
        assert!((distance(&truth, &found).unwrap() - 0.1).abs() < 1e-15);
        // Across the lower left corner.
        let [one, other] = [arc([-0.5, -0.49], [0.0, -0.5]), arc([-0.48, -0.5], [0.0, -0.5])];
        assert!((distance(&[one], &[other]).unwrap() - 0.03).abs() < 1e-15);
        assert_eq!(distance(&truth, &found[..1]), None);
    }
}
