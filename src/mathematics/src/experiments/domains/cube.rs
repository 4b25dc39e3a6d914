//! Convergence on the cube to solutions with a formula.

use crate::discrete::norms::Errors;
use crate::experiments::accuracy::KnownLevels;
use crate::machine::threads::map;
use crate::mesh::{NestedMeshes, mesh_errors, mesh_load, nested_meshes, uniform_cube};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::exact::CubeExact;
use crate::problem::law::Law;
use crate::problem::source::Source;
use serde::{Deserialize, Serialize};

/// Errors on one mesh.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CubeLevel {
    /// Cells per side.
    pub cells: usize,
    /// Errors in L2, in the H1 seminorm, and the greatest at a node, solved to the rounding floor.
    pub errors: [f64; 3],
    /// Observed orders against the mesh before.
    pub orders: Option<[f64; 3]>,
}

/// Measures the errors of every known solution on the last two refinements: one order for each.
pub(super) fn convergence(refinements: usize) -> Result<Vec<KnownLevels<CubeLevel>>, String> {
    let cubes = nested_meshes(&uniform_cube(1), refinements).map_err(|e| e.to_string())?;
    map(&CubeExact::ALL, 1, |&exact| on_cube(exact, &cubes)).into_iter().collect()
}

fn on_cube(exact: CubeExact, cubes: &NestedMeshes<3, 4>) -> Result<KnownLevels<CubeLevel>, String> {
    let mut levels: Vec<CubeLevel> = Vec::new();
    let finest = cubes.meshes.len() - 1;
    for times in finest.saturating_sub(1)..=finest {
        let Errors { l2, h1, max } = errors(exact, cubes, times)?;
        let errors = [l2, h1, max];
        let orders = levels
            .last()
            .map(|coarser| [0, 1, 2].map(|norm| libm::log2(coarser.errors[norm] / errors[norm])));
        levels.push(CubeLevel { cells: 1 << times, errors, orders });
    }
    Ok(KnownLevels { name: exact.name().into(), levels })
}

fn errors(exact: CubeExact, cubes: &NestedMeshes<3, 4>, times: usize) -> Result<Errors, String> {
    let (levels, mesh) = (&cubes.networks[..=times], &cubes.meshes[times]);
    let load = mesh_load(mesh, &Source::from(exact)).map_err(|e| e.to_string())?.load;
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
            let errors = [4, 5].map(|times| errors(exact, &cubes, times).unwrap());
            let rate = |norm: fn(&Errors) -> f64| libm::log2(norm(&errors[0]) / norm(&errors[1]));
            assert!((rate(|e| e.l2) - 2.0).abs() < 0.1, "{exact:?} L2 {}", rate(|e| e.l2));
            assert!((rate(|e| e.h1) - 1.0).abs() < 0.05, "{exact:?} H1 {}", rate(|e| e.h1));
            assert!((rate(|e| e.max) - 2.0).abs() < 0.2, "{exact:?} max {}", rate(|e| e.max));
        }
    }
}
