//! Primal-dual active set method with a direct solver, which checks multigrid.
//!
//! # Idea
//! This is the semismooth Newton method for `l = P(l - c y)`, with the multiplier `l` and the projection P onto the
//! interval of the law; for the paper's law P is `max(0, )`. For a nonsingular M-matrix, that law
//! and a bound at every node it converges from every start in finitely many steps (Hintermüller, Ito and Kunisch 2002,
//! theorem 3.2). Here the matrix is singular, only boundary values are bounded, and matrices of stretched cells are no
//! M-matrices: convergence is observed, not proved. Where it fails, steps that lower the energy take over, which end.
//!
//! # Algorithm
//! 1. See the problem as one under laws `[0, limit]` and `(-inf, 0]`, and take all boundary nodes to stick.
//! 2. Solve the linear problem with y as the laws say at the nodes that stick, and the largest flux at those that slip
//!    down.
//! 3. Let nodes that stick with a multiplier below zero slip up, those above the limit slip down, and nodes whose value
//!    is on the other side of the law's stick. If the nodes could then not balance the load, shift the solution by the
//!    constant of least energy: otherwise the next system is singular.
//! 4. Stop if no state has changed. If all have returned to earlier ones, stop if the residual is one of
//!    rounding errors. Otherwise, and after many steps, go on with steps that lower the energy (`falling`).
//!
//! # Cost
//! One factorisation per step, in the order of minimum degree.

mod falling;
mod states;

pub(crate) use states::StateProblem;

use super::direct::{Direct, FactorOrder};
use super::{InputError, check_length, check_load};
use crate::discrete::domain::components;
use crate::discrete::end::{End, Stop};
use crate::discrete::network::Network;
use crate::problem::law::{BoundaryState, Law, OneSided};
use falling::fall;

/// Cells per side of the finest grid of the square whose matrix and factors are worth their memory: 270 MB.
pub const MOST_CELLS: usize = 256;

/// Most nodes of a mesh in the plane whose matrix and factors are worth their time: as many as on the square.
pub const MOST_NODES_IN_PLANE: usize = (MOST_CELLS + 1) * (MOST_CELLS + 1);
/// Most nodes of a mesh in space whose matrix and factors are worth their time: those of the cube with 24 cells per
/// side.
pub const MOST_NODES_IN_SPACE: usize = 25 * 25 * 25;

/// Limit on the number of primal-dual steps. Usual are below 20; on strips each moves an end of contact by a node.
const MAX_STEPS: usize = 30;

/// Minimises the energy `1/2 y'Ay - F'y` with the law's term at the contact nodes of any network, where y is given at
/// its fixed nodes: from the states of a vector near the solution, if there is one, else from those where all stick.
///
/// Ends `Converged` if a step left all states as they were, and at the `RoundingFloor` if a step led to earlier states
/// with a vector that solves the problem but for rounding errors.
///
/// # Errors
/// If the length is wrong, a number is not finite, or in a component without fixed nodes the flux cannot balance the
/// load.
pub fn active_set(
    network: &Network,
    load: &[f64],
    start: Option<&[f64]>,
) -> Result<(Vec<f64>, End), InputError> {
    check_length(network.nodes(), load)?;
    let of_nodes = network.components();
    check_load(&components(network, &of_nodes, load))?;
    let one_sided = OneSided::new(&network.laws(), load);
    let load = one_sided.load(load, network.contact());
    let laws = network.boundary().iter().map(|contact| one_sided.law(contact.law));
    let laws: Vec<Law> = laws.collect();
    let problem = StateProblem { network, components: &of_nodes, load: &load, laws: &laws };
    let direct = Direct::new(network, FactorOrder::MinimumDegree);
    let mut system = StateSystem { problem: &problem, direct, steps: 0 };
    let signed = |y: &[f64]| y.iter().map(|value| one_sided.signed(*value)).collect::<Vec<_>>();
    let states = match start {
        Some(y) => {
            let y = signed(y);
            problem.next_states(&problem.states_by_sign(&y), &y)
        }
        None => problem.all_stick(),
    };
    let mut y = vec![0.0; load.len()];
    let (stop, states) = system.search(states, &mut y);
    problem.put_into_states(&states, &mut y);
    let stop = stop.unwrap_or_else(|| fall(&mut system, &mut y));
    let multiplications = system.steps as f64 * system.direct.step_work();
    let work_units = multiplications / (network.row_length() * y.len() as f64);
    let end = End { iterations: system.steps, work_units, stop, delta_a: None };
    Ok((signed(&y), end))
}

/// Linear systems of a problem.
struct StateSystem<'a> {
    problem: &'a StateProblem<'a>,
    direct: Direct,
    /// Number of systems solved.
    steps: usize,
}

impl StateSystem<'_> {
    /// Primal-dual steps from these states on. Returns how they ended, none if they go round in a circle, and the
    /// states of the vector.
    fn search(
        &mut self,
        mut states: Vec<BoundaryState>,
        y: &mut [f64],
    ) -> (Option<Stop>, Vec<BoundaryState>) {
        let mut seen = Vec::new();
        loop {
            y.fill(0.0);
            self.problem.put_at_values(&states, y);
            self.solve(&states, y);
            if !y.iter().all(|value| value.is_finite()) {
                return (Some(Stop::Diverged), states);
            }
            let next = self.problem.next_states(&states, y);
            if next == states {
                return (Some(Stop::Converged), states);
            }
            if seen.contains(&next) {
                let is_solved = self.problem.has_rounding_errors_alone(&states, y);
                return (is_solved.then_some(Stop::RoundingFloor), states);
            }
            if self.steps == MAX_STEPS {
                return (None, states);
            }
            seen.push(std::mem::replace(&mut states, next));
        }
    }

    /// Replaces `y`, which has the values of the laws at nodes that stick, by the solution with these states, with one
    /// step of iterative refinement.
    fn solve(&mut self, states: &[BoundaryState], y: &mut [f64]) {
        let network = self.problem.network;
        let diagonal = network.diagonal().iter().zip(states);
        self.direct.factor(diagonal.map(|(entry, state)| match state {
            BoundaryState::Sticks => f64::INFINITY,
            _ => *entry,
        }));
        let load = self.problem.load_with(states);
        let mut correction = vec![0.0; y.len()];
        for _ in 0..2 {
            network.gradient(y, &load, &mut correction);
            for (value, state) in correction.iter_mut().zip(states) {
                *value = if *state == BoundaryState::Sticks { 0.0 } else { -*value };
            }
            self.direct.solve(&mut correction);
            y.iter_mut().zip(&correction).for_each(|(value, correction)| *value += correction);
        }
        self.steps += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::kkt::{Judgement, judge};
    use crate::mesh::{AnyMesh, assemble, gmsh, mesh_load, on_regions};

    #[test]
    fn states_that_go_round_in_a_circle_on_flat_cells_end_at_the_solution() {
        let file = include_bytes!("../../../../tests/meshes/flat22.msh");
        let AnyMesh::Space(mesh) = gmsh::read(file).unwrap() else { panic!("a mesh in space") };
        let f = "region(a)=0.343176; region(b)=-0.432909";
        let f = on_regions::<3>(f, mesh.region_names(), mesh.extent()).unwrap();
        let (network, load) = (assemble(&mesh), mesh_load(&mesh, &f[..]).unwrap().load);
        let (y, end) = active_set(&network, &load, None).unwrap();
        let Judgement { energy, kkt, .. } = judge(&network, &y, &load);
        assert!(
            matches!(end.stop, Stop::Converged | Stop::RoundingFloor),
            "{end:?} {energy} {kkt:?}"
        );
        assert!((energy / -1.131441804e-7 - 1.0).abs() < 1e-6, "{energy} {kkt:?}");
    }
}
