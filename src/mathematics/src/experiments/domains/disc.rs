//! Convergence on the disc, whose boundary is smooth as the paper assumes, to closed forms.

use crate::discrete::kkt::judge;
use crate::machine::threads::try_map;
use crate::mesh::{
    BuiltIn, ConstantPieces, Mesh, MeshPlace, NestedMeshes, OnCells, arcs, boundary_curves,
    distance_squared, integrals, mesh_load, nested_meshes,
};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::disc::DiscProblem;
use crate::problem::law::{ContactNode, Law};
use serde::Serialize;
use std::f64::consts::PI;

/// Errors on one refinement of the disc, and orders against the mesh before, none of an error that is zero.
#[derive(Clone, Serialize)]
pub(super) struct DiscErrors {
    /// Coefficients c0, c1 and k of f.
    c0: f64,
    /// See [`DiscProblem`].
    c1: f64,
    /// See [`DiscProblem`].
    k: u32,
    /// Number of nodes.
    nodes: usize,
    /// Error of the energy.
    energy: f64,
    /// Order of this error.
    energy_order: Option<f64>,
    /// Norm of the error's gradient in L2 of the polygon.
    h1: f64,
    /// Error of v at the centre.
    centre: f64,
    /// Order of this error.
    centre_order: Option<f64>,
    /// Largest error of v on the rim.
    rim: f64,
    /// Order of this error.
    rim_order: Option<f64>,
    /// Error of the multiplier on the rim in L2.
    multiplier: f64,
    /// Order of this error.
    multiplier_order: Option<f64>,
    /// Largest distance of an end of contact from the true one over the longest edge; none if all is in contact.
    ends: Option<f64>,
}

impl OnCells<2> for DiscProblem {
    fn pieces(&self, _region: u16) -> Option<ConstantPieces<'_, 2>> {
        None
    }

    fn at(&self, _region: u16, point: [f64; 2]) -> f64 {
        self.f(point)
    }
}

/// Problems of the experiment.
const PROBLEMS: [DiscProblem; 4] = [
    DiscProblem { c0: 1.0, c1: 0.0, k: 1 },
    DiscProblem { c0: 1.0, c1: 4.0, k: 1 },
    DiscProblem { c0: 1.0, c1: 8.0, k: 1 },
    DiscProblem { c0: 1.0, c1: 12.0, k: 3 },
];

/// Measures the errors on all refinements from the third on.
pub(super) fn convergence(refinements: usize) -> Result<Vec<DiscErrors>, String> {
    let discs = discs(refinements)?;
    Ok(try_map(&PROBLEMS, |&problem| on_discs(problem, &discs))?.concat())
}

/// The disc and its refinements.
fn discs(refinements: usize) -> Result<NestedMeshes<2, 3>, String> {
    let coarsest = BuiltIn::Disc.plane().expect("the disc lies in the plane");
    nested_meshes(&coarsest, refinements).map_err(|e| e.to_string())
}

fn on_discs(problem: DiscProblem, discs: &NestedMeshes<2, 3>) -> Result<Vec<DiscErrors>, String> {
    let mut rows: Vec<DiscErrors> = Vec::new();
    for times in 3..discs.meshes.len() {
        let mut fine = errors(problem, discs, times)?;
        if let Some(coarse) = rows.last() {
            fine.energy_order = order(coarse.energy, fine.energy);
            fine.centre_order = order(coarse.centre, fine.centre);
            fine.rim_order = order(coarse.rim, fine.rim);
            fine.multiplier_order = order(coarse.multiplier, fine.multiplier);
        }
        rows.push(fine);
    }
    Ok(rows)
}

/// Order of an error from one mesh to the next; none if one is zero.
fn order(coarse: f64, fine: f64) -> Option<f64> {
    Some(libm::log2((coarse / fine).abs())).filter(|order| order.is_finite())
}

fn errors(
    problem: DiscProblem,
    discs: &NestedMeshes<2, 3>,
    times: usize,
) -> Result<DiscErrors, String> {
    let (levels, mesh) = (&discs.networks[..=times], &discs.meshes[times]);
    let load = mesh_load(mesh, &problem).map_err(|e| e.to_string())?.load;
    let loaded = Law::SIGNORINI.with_load(&load);
    let (y, _) = solve_nested_networks(levels, loaded, &MultigridParams::default())
        .map_err(|e| e.to_string())?;
    let network = &levels[times].network;
    let judged = judge(network, Law::SIGNORINI, &y, &load);
    let multiplier = judged.multiplier(&y);
    let (mut rim, mut square) = (0.0f64, 0.0);
    for (&ContactNode { node, measure }, l) in network.contact().iter().zip(&multiplier) {
        let [px, py] = mesh.points()[node];
        let t = libm::atan2(py, px);
        rim = rim.max((y[node] - problem.rim(t)).abs());
        square += measure * (l - problem.multiplier(t)) * (l - problem.multiplier(t));
    }
    let alpha = problem.free_angle();
    let ends = (alpha > 0.0).then(|| {
        let arcs = arcs(&boundary_curves(mesh), &y, &judged);
        let ends = arcs.iter().flat_map(|arc| [arc.from, arc.to]);
        let distances = ends.map(|[px, py]| {
            // The ends are at k t = alpha and -alpha, up to whole turns.
            let angle = f64::from(problem.k) * libm::atan2(py, px);
            let angle = angle - 2.0 * PI * (angle / (2.0 * PI)).round();
            (angle.abs() - alpha).abs() / f64::from(problem.k)
        });
        distances.fold(0.0, f64::max) / mesh.width()
    });
    let DiscProblem { c0, c1, k } = problem;
    Ok(DiscErrors {
        c0,
        c1,
        k,
        nodes: y.len(),
        energy: judged.energy - problem.energy(),
        energy_order: None,
        h1: gradient_error(&problem, mesh, &y),
        centre: y[0] - problem.centre(),
        centre_order: None,
        rim,
        rim_order: None,
        multiplier: square.sqrt(),
        multiplier_order: None,
        ends,
    })
}

/// Norm of the error's gradient, by quadrature.
fn gradient_error(problem: &DiscProblem, mesh: &Mesh<2, 3>, y: &[f64]) -> f64 {
    let free_cosine = problem.free_cosine();
    let [square] = integrals(mesh, y, |MeshPlace { point, gradient, .. }| {
        [distance_squared(problem.gradient(free_cosine, point), gradient)]
    });
    square.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_are_of_order_two_and_gradients_of_order_one() {
        let discs = discs(6).unwrap();
        for (c0, c1, k) in [(1.3, 7.0, 1), (1.3, 7.0, 2), (1.3, 7.0, 3), (0.8, 20.0, 2)] {
            let problem = DiscProblem { c0, c1, k };
            let levels: Vec<_> =
                (3..7).map(|times| errors(problem, &discs, times).unwrap()).collect();
            for pair in levels.windows(2) {
                let energy = libm::log2(pair[0].energy / pair[1].energy);
                let gradient = libm::log2(pair[0].h1 / pair[1].h1);
                assert!((energy - 2.0).abs() < 0.15, "{c0} {c1} {k}: {energy}");
                assert!((gradient - 1.0).abs() < 0.1, "{c0} {c1} {k}: {gradient}");
            }
        }
    }
}
