//! Convergence on the cube to solutions with a formula.

use crate::discrete::norms::Errors;
use crate::machine::threads::{for_runs, map};
use crate::mesh::{
    ConstantPieces, NestedMeshes, OnCells, mesh_errors, mesh_load, nested_meshes, uniform_cube,
};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::exact::CubeExact;
use crate::problem::law::Law;
use serde::Serialize;

/// Errors of a known solution on one mesh, solved to the rounding floor, and orders against the mesh before.
#[derive(Clone, Serialize)]
pub(super) struct CubeErrors {
    /// Name of the solution, as in `exact(name)`.
    name: &'static str,
    /// Cells per side.
    cells: usize,
    /// Error in L2.
    l2: f64,
    /// Order of this error.
    l2_order: Option<f64>,
    /// Error in the H1 seminorm.
    h1: f64,
    /// Order of this error.
    h1_order: Option<f64>,
    /// Greatest error at a node.
    max: f64,
    /// Order of this error.
    max_order: Option<f64>,
}

/// Measures the errors of every known solution on the last two refinements: one order for each.
pub(super) fn convergence(refinements: usize) -> Result<Vec<CubeErrors>, String> {
    let cubes = nested_meshes(&uniform_cube(1), refinements).map_err(|e| e.to_string())?;
    let on_cube = |&exact: &CubeExact| on_cube(&LatticeSource::new(exact, refinements), &cubes);
    let all: Result<Vec<_>, _> = map(&CubeExact::ALL, 1, on_cube).into_iter().collect();
    Ok(all?.concat())
}

/// f of a known solution, with its values at hand on a lattice twice as fine as the last refinement. The vertices of
/// cells and the midpoints of their edges are on it, which belong to many cells.
struct LatticeSource {
    exact: CubeExact,
    /// Cells of the lattice per side, a power of two: its coordinates have no rounding errors.
    cells: usize,
    /// Values on the lattice, plane by plane and row by row, the last coordinate innermost.
    values: Vec<f64>,
}

impl LatticeSource {
    fn new(exact: CubeExact, refinements: usize) -> Self {
        let cells = 2 << refinements;
        let side = cells + 1;
        let mut values = vec![0.0; side * side * side];
        for_runs(&mut values, side, &|row, values: &mut [f64]| {
            for (k, value) in values.iter_mut().enumerate() {
                let point = [row / side, row % side, k].map(|place| coordinate(place, cells));
                *value = exact.source(point);
            }
        });
        Self { exact, cells, values }
    }

    /// Number of a point on the lattice; none elsewhere.
    fn number(&self, point: [f64; 3]) -> Option<usize> {
        let mut number = 0;
        for at in point {
            let place = ((at + 0.5) * self.cells as f64) as usize;
            if place > self.cells || coordinate(place, self.cells) != at {
                return None;
            }
            number = number * (self.cells + 1) + place;
        }
        Some(number)
    }
}

/// Coordinate of a place on a lattice with so many cells per side.
fn coordinate(place: usize, cells: usize) -> f64 {
    place as f64 / cells as f64 - 0.5
}

impl OnCells<3> for LatticeSource {
    fn pieces(&self, _region: u16) -> Option<ConstantPieces<'_, 3>> {
        None
    }

    fn at(&self, _region: u16, point: [f64; 3]) -> f64 {
        match self.number(point) {
            Some(number) => self.values[number],
            None => self.exact.source(point),
        }
    }
}

fn on_cube(source: &LatticeSource, cubes: &NestedMeshes<3, 4>) -> Result<Vec<CubeErrors>, String> {
    let finest = cubes.meshes.len() - 1;
    let (mut rows, mut coarser) = (Vec::new(), None);
    for times in finest.saturating_sub(1)..=finest {
        let fine = errors(source, cubes, times)?;
        let [l2_order, h1_order, max_order] = match &coarser {
            Some(coarser) => orders(coarser, &fine).map(Some),
            None => [None; 3],
        };
        rows.push(CubeErrors {
            name: source.exact.name(),
            cells: 1 << times,
            l2: fine.l2,
            l2_order,
            h1: fine.h1,
            h1_order,
            max: fine.max,
            max_order,
        });
        coarser = Some(fine);
    }
    Ok(rows)
}

/// Orders of the errors in L2, in the H1 seminorm, and at a node, from one mesh to the next.
fn orders(coarse: &Errors, fine: &Errors) -> [f64; 3] {
    [coarse.l2 / fine.l2, coarse.h1 / fine.h1, coarse.max / fine.max].map(libm::log2)
}

fn errors(
    source: &LatticeSource,
    cubes: &NestedMeshes<3, 4>,
    times: usize,
) -> Result<Errors, String> {
    let exact = source.exact;
    let (levels, mesh) = (&cubes.networks[..=times], &cubes.meshes[times]);
    let load = mesh_load(mesh, source).map_err(|e| e.to_string())?.load;
    let loaded = Law::SIGNORINI.with_load(&load);
    let (y, _) = solve_nested_networks(levels, loaded, &MultigridParams::default())
        .map_err(|e| format!("on the cube, {}: {e}", exact.name()))?;
    Ok(mesh_errors(mesh, |point| exact.at(point), &y))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_fall_at_the_optimal_rate() {
        let cubes = nested_meshes(&uniform_cube(1), 5).unwrap();
        for exact in CubeExact::ALL {
            let source = LatticeSource::new(exact, 5);
            let errors = [4, 5].map(|times| errors(&source, &cubes, times).unwrap());
            let [l2, h1, max] = orders(&errors[0], &errors[1]);
            assert!((l2 - 2.0).abs() < 0.1, "{exact:?} L2 {l2}");
            assert!((h1 - 1.0).abs() < 0.05, "{exact:?} H1 {h1}");
            assert!((max - 2.0).abs() < 0.2, "{exact:?} max {max}");
        }
    }
}
