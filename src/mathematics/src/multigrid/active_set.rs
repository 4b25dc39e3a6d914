//! Primal-dual active set method with a direct solver, which checks multigrid.
//!
//! # Idea
//! This is the semismooth Newton method for `l = P(l - c y)`, with the multiplier `l` and the projection P onto the
//! interval of the law; for the paper's law P is `max(0, )`. For a nonsingular M-matrix, that law
//! and a bound at every node it converges from every start in finitely many steps (Hintermüller, Ito and Kunisch 2002,
//! theorem 3.2). Here the matrix is singular, and only boundary values are bounded: convergence is observed, not
//! proved. Hence the limit on the number of steps, and the list of all contact sets so far.
//!
//! # Algorithm
//! 1. See the problem as one under the law `[0, limit]`, and take all boundary nodes to stick.
//! 2. Solve the linear problem with `y = 0` at the nodes that stick, and the flux `limit` at those that slip down.
//! 3. Let nodes that stick with a multiplier below zero slip up, those above the limit slip down, and nodes whose value
//!    has the other sign stick. If the nodes could then not balance the load, shift the solution by the constant
//!    of least energy: otherwise the next system is singular.
//! 4. Stop if no state has changed. If all have returned to earlier ones, stop if the residual is one of
//!    rounding errors. Otherwise the steps go round in a circle, as the matrix of stretched cells is no M-matrix, and
//!    no step may raise the energy from then on: go from the vector of least energy so far towards the solution as far
//!    as the energy falls, sweep, and take the states from there. Go to step 2.
//!
//! # Cost
//! One factorisation per step, in the order of minimum degree.

use super::direct::{Direct, FactorOrder};
use super::input::{InputError, check_length, check_load};
use crate::discrete::components::components;
use crate::discrete::end::End;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::judge;
use crate::discrete::network::{ContactRow, Network, count_components};
use crate::discrete::norms::largest;
use crate::discrete::stop::Stop;
use crate::problem::balance::{Balance, ContactValue, place_at_zero};
use crate::problem::descent::{Bend, Slope};
use crate::problem::law::{BoundaryState, ContactNode, Law};
use std::cmp::Ordering;

/// Cells per side of the finest grid of the square whose matrix and factors are worth their memory: 270 MB.
pub const MOST_CELLS: usize = 256;

/// Most nodes of a mesh in the plane whose matrix and factors are worth their time: as many as on the square.
pub const MOST_NODES_IN_PLANE: usize = (MOST_CELLS + 1) * (MOST_CELLS + 1);
/// Most nodes of a mesh in space whose matrix and factors are worth their time: those of the cube with 24 cells per
/// side.
pub const MOST_NODES_IN_SPACE: usize = 25 * 25 * 25;

/// Natural residual over the largest load up to which a circle of states is one of rounding errors.
const ROUNDING: f64 = 1e-11;
/// Halvings of a step that is to lower the energy at most.
const MOST_HALVINGS: usize = 6;
/// Sweeps after such a step.
const SWEEPS: usize = 4;

/// Limit on the number of linear systems.
const MAX_STEPS: usize = 200;

/// Minimises the energy `1/2 y'Ay - F'y` with the law's term on the boundary; see [`solve_square`](super::solve_square)
/// for `A` and the layout of `load` and the solution. Starts with all boundary nodes at zero. Ends as
/// [`active_set_on`].
///
/// # Errors
/// If `n` is below 2, a length is wrong, a number is not finite, or the flux cannot balance the load.
pub fn active_set(n: usize, law: Law, load: &[f64]) -> Result<(Vec<f64>, End), InputError> {
    if n < 2 {
        return Err(InputError::GridSize { cells: n, rule: "at least 2", nearest: vec![2] });
    }
    let grid = Grid::new(n).expect("the number of cells is at least 2");
    active_set_on(&Network::of_square(grid), law, load)
}

/// Minimises the energy `1/2 y'Ay - F'y` with the law's term at the contact nodes of any network, and `y = 0` at its
/// fixed nodes. Starts with all contact nodes at zero.
///
/// Ends `Converged` if a step left all states as they were, and at the `RoundingFloor` if a step led to earlier states
/// with a vector that solves the problem but for rounding errors.
///
/// # Errors
/// If the length is wrong, a number is not finite, or in a component without fixed nodes the flux cannot balance the
/// load.
pub fn active_set_on(
    network: &Network,
    law: Law,
    load: &[f64],
) -> Result<(Vec<f64>, End), InputError> {
    active_set_from(network, law, load, None)
}

/// As [`active_set_on`], from the states of a vector near the solution, if there is one.
///
/// # Errors
/// As [`active_set_on`].
pub(crate) fn active_set_from(
    network: &Network,
    law: Law,
    load: &[f64],
    start: Option<&[f64]>,
) -> Result<(Vec<f64>, End), InputError> {
    check_length(network.nodes(), load)?;
    let of_nodes = network.components();
    check_load(&components(network, &of_nodes, load), law)?;
    let one_sided = law.one_sided(load);
    let load = one_sided.load(load, network.contact());
    let problem =
        StateProblem { network, components: &of_nodes, load: &load, limit: one_sided.limit };
    let mut direct = Direct::new(network, FactorOrder::MinimumDegree);
    let signed = |y: &[f64]| y.iter().map(|value| one_sided.signed(*value)).collect::<Vec<_>>();
    let mut states = match start {
        Some(y) => problem.states_of(&signed(y)),
        None => problem.all_stick(),
    };
    let mut seen = Vec::new();
    let mut y = vec![0.0; load.len()];
    let mut steps = 0;
    // Vector of least energy so far, once steps have gone round in a circle.
    let mut lowest: Option<Vec<f64>> = None;
    let stop = loop {
        if steps == MAX_STEPS {
            break Stop::IterationLimit;
        }
        solve(&problem, &mut direct, &states, &mut y);
        steps += 1;
        if !y.iter().all(|value| value.is_finite()) {
            break Stop::Diverged;
        }
        let next = problem.next_states(&states, &y);
        if next == states {
            break Stop::Converged;
        }
        let is_circle = lowest.is_some() || seen.contains(&next);
        if is_circle && problem.has_rounding_errors_alone(&states, &y) {
            break Stop::RoundingFloor;
        }
        if let Some(lowest) = &mut lowest {
            problem.descend(lowest, &y);
            states = problem.states_of(lowest);
        } else if is_circle {
            let mut start = y.clone();
            problem.put_into_law(&mut start);
            states = problem.states_of(&start);
            lowest = Some(start);
        } else {
            seen.push(std::mem::replace(&mut states, next));
        }
    };
    if let (Stop::IterationLimit, Some(lowest)) = (stop, lowest) {
        y = lowest;
        states = problem.states_of(&y);
    }
    problem.put_into_states(&states, &mut y);
    let y = signed(&y);
    let multiplications = steps as f64 * direct.step_work();
    let work_units = multiplications / (network.row_length() * y.len() as f64);
    Ok((y, End { iterations: steps, work_units, stop, delta_a: None }))
}

/// Replaces `y` by the solution with these states, with one step of iterative refinement.
fn solve(problem: &StateProblem<'_>, direct: &mut Direct, states: &[BoundaryState], y: &mut [f64]) {
    let network = problem.network;
    let diagonal = network.diagonal().iter().zip(states);
    direct.factor(diagonal.map(|(entry, state)| match state {
        BoundaryState::Sticks => f64::INFINITY,
        _ => *entry,
    }));
    let load = problem.load_with(states);
    y.fill(0.0);
    let mut correction = vec![0.0; y.len()];
    for _ in 0..2 {
        network.gradient(y, &load, &mut correction);
        for (value, state) in correction.iter_mut().zip(states) {
            *value = if *state == BoundaryState::Sticks { 0.0 } else { -*value };
        }
        direct.solve(&mut correction);
        y.iter_mut().zip(&correction).for_each(|(value, correction)| *value += correction);
    }
}

/// Problem under the law `[0, limit]`, whose solution is known from the states of its nodes. Inner nodes count as
/// slipping up, fixed nodes as sticking.
pub(crate) struct StateProblem<'a> {
    pub network: &'a Network,
    /// Connected component of each node.
    pub components: &'a [u32],
    pub load: &'a [f64],
    /// Largest flux.
    pub limit: f64,
}

impl StateProblem<'_> {
    /// States with all contact nodes at zero.
    pub(crate) fn all_stick(&self) -> Vec<BoundaryState> {
        let mut states = vec![BoundaryState::SlipsUp; self.load.len()];
        let contact = self.network.contact().iter().map(|contact| contact.node);
        let zero = contact.chain(self.network.fixed().iter().map(|&node| node as usize));
        zero.for_each(|node| states[node] = BoundaryState::Sticks);
        states
    }

    /// Gives values of contact nodes that have the other sign than their states, by rounding errors, the value zero.
    fn put_into_states(&self, states: &[BoundaryState], y: &mut [f64]) {
        for contact in self.network.contact() {
            let value = &mut y[contact.node];
            *value = match states[contact.node] {
                BoundaryState::SlipsDown => value.min(0.0),
                _ => value.max(0.0),
            };
        }
    }

    /// Gives values of contact nodes of which the energy is infinite the value zero.
    fn put_into_law(&self, y: &mut [f64]) {
        if !self.limit.is_finite() {
            self.network.contact().iter().for_each(|of| y[of.node] = y[of.node].max(0.0));
        }
    }

    fn law(&self) -> Law {
        Law::new(0.0, self.limit).expect("a positive limit")
    }

    /// True if the solution with these states solves the problem but for rounding errors.
    fn has_rounding_errors_alone(&self, states: &[BoundaryState], y: &[f64]) -> bool {
        let mut y = y.to_vec();
        self.put_into_states(states, &mut y);
        let natural = judge(self.network, self.law(), &y, self.load).kkt.natural;
        natural <= ROUNDING * largest(self.load)
    }

    /// Goes from a vector towards another one as far as the energy falls, and minimises the energy over one value after
    /// the other.
    fn descend(&self, y: &mut [f64], towards: &[f64]) {
        if self.limit.is_finite() {
            self.go_to_least(y, towards);
        } else {
            self.go_within(y, towards);
        }
        let law = self.law();
        for _ in 0..SWEEPS {
            self.network.sweep(self.load, y, |_, ContactRow { sum, diagonal, measure }| {
                law.settle(sum, diagonal, measure)
            });
        }
    }

    /// Goes towards another vector, with no value of a contact node below zero, if a part of the way lowers the energy.
    fn go_within(&self, y: &mut [f64], towards: &[f64]) {
        let energy = |y: &[f64]| judge(self.network, self.law(), y, self.load).energy;
        let (before, mut part) = (energy(y), 1.0);
        for _ in 0..MOST_HALVINGS {
            let way = y.iter().zip(towards);
            let mut there: Vec<f64> = way.map(|(from, to)| from + part * (to - from)).collect();
            self.put_into_law(&mut there);
            if energy(&there) < before {
                y.copy_from_slice(&there);
                return;
            }
            part *= 0.5;
        }
    }

    /// Goes to the least energy between a vector and another one or beyond.
    fn go_to_least(&self, y: &mut [f64], towards: &[f64]) {
        let direction: Vec<f64> = towards.iter().zip(&*y).map(|(to, from)| to - from).collect();
        let (mut first, mut second) = (0.0, 0.0);
        for (node, &along) in direction.iter().enumerate() {
            first += along * self.network.gradient_at(node, y, self.load);
            second += along
                * (self.network.diagonal()[node] * along
                    - self.network.row(node).add_to(0.0, &direction));
        }
        let mut bends: Vec<Bend> = Vec::new();
        for contact in self.network.contact() {
            let (value, along) = (y[contact.node], direction[contact.node]);
            let flux = contact.measure * self.limit;
            if value < 0.0 || (value == 0.0 && along < 0.0) {
                first -= flux * along;
            }
            if value * along < 0.0 {
                bends.push(Bend { at: -value / along, slope: flux * along.abs() });
            }
        }
        if first < 0.0 && second > 0.0 {
            let length = Slope { first, second }.least(bends);
            y.iter_mut().zip(&direction).for_each(|(value, along)| *value += length * along);
        }
    }

    /// States that belong to a vector: by the signs of the values and, where a value is zero, by the multiplier.
    fn states_of(&self, y: &[f64]) -> Vec<BoundaryState> {
        let mut states = self.all_stick();
        for contact in self.network.contact() {
            let value = y[contact.node];
            if value != 0.0 {
                states[contact.node] =
                    if value > 0.0 { BoundaryState::SlipsUp } else { BoundaryState::SlipsDown };
            }
        }
        self.next_states(&states, y)
    }

    /// Load with the flux of the nodes that slip down.
    pub(crate) fn load_with(&self, states: &[BoundaryState]) -> Vec<f64> {
        let mut load = self.load.to_vec();
        for contact in self.network.contact() {
            if states[contact.node] == BoundaryState::SlipsDown {
                load[contact.node] += contact.measure * self.limit;
            }
        }
        load
    }

    /// Returns the states of the next step of the primal-dual active set method, where `y` is the solution with the
    /// present ones.
    ///
    /// A solution whose nodes could then not balance the load of a connected component, or of which none would stick,
    /// is shifted by the constant of least energy: the node that it [sets to zero](place_at_zero) sticks, and the
    /// others slip.
    pub(crate) fn next_states(&self, states: &[BoundaryState], y: &[f64]) -> Vec<BoundaryState> {
        let mut next = vec![BoundaryState::SlipsUp; states.len()];
        let count = count_components(self.components);
        let (mut balances, mut has_fixed) = (vec![Balance::default(); count], vec![false; count]);
        for &node in self.network.fixed() {
            next[node as usize] = BoundaryState::Sticks;
            has_fixed[self.components[node as usize] as usize] = true;
        }
        for contact in self.network.contact() {
            let node = contact.node;
            let gradient = self.network.gradient_at(node, y, self.load);
            next[node] = match states[node] {
                BoundaryState::Sticks if gradient < 0.0 => BoundaryState::SlipsUp,
                BoundaryState::Sticks if gradient > contact.measure * self.limit => {
                    BoundaryState::SlipsDown
                }
                BoundaryState::SlipsUp if y[node] >= 0.0 => BoundaryState::SlipsUp,
                BoundaryState::SlipsDown if y[node] <= 0.0 => BoundaryState::SlipsDown,
                _ => BoundaryState::Sticks,
            };
            balances[self.components[node] as usize].see(next[node], contact.measure);
        }
        let mut needed = vec![0.0; balances.len()];
        for (&component, load) in self.components.iter().zip(self.load) {
            needed[component as usize] -= load / self.limit;
        }
        for (component, (balance, needed)) in balances.iter().zip(needed).enumerate() {
            if !has_fixed[component] && !balance.holds(needed) {
                self.shift(component, needed, y, &mut next);
            }
        }
        next
    }

    /// Sets the states of a component after the shift by the constant of least energy, where nodes with the measure
    /// `needed` balance the load if they slip down.
    fn shift(&self, component: usize, needed: f64, y: &[f64], next: &mut [BoundaryState]) {
        let mut nodes: Vec<ContactValue> = Vec::new();
        for &ContactNode { node, measure } in self.network.contact() {
            if self.components[node] as usize == component {
                let multiplier = self.network.gradient_at(node, y, self.load);
                nodes.push(ContactValue { number: node, measure, value: y[node], multiplier });
            }
        }
        let at = place_at_zero(&mut nodes, needed);
        for (place, node) in nodes.iter().enumerate() {
            next[node.number] = match place.cmp(&at) {
                Ordering::Less => BoundaryState::SlipsDown,
                Ordering::Equal => BoundaryState::Sticks,
                Ordering::Greater => BoundaryState::SlipsUp,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::kkt::Judgement;
    use crate::mesh::{AnyMesh, assemble, gmsh, mesh_load, on_regions};

    #[test]
    fn states_that_go_round_in_a_circle_on_flat_cells_end_at_the_solution() {
        let file = include_bytes!("../../../../tests/meshes/flat22.msh");
        let AnyMesh::Space(mesh) = gmsh::read(file).unwrap() else { panic!("a mesh in space") };
        let f = "region(a)=0.343176; region(b)=-0.432909";
        let f = on_regions::<3>(f, mesh.region_names(), mesh.extent()).unwrap();
        let (network, load) = (assemble(&mesh), mesh_load(&mesh, &f[..]).unwrap().load);
        let (y, end) = active_set_on(&network, Law::SIGNORINI, &load).unwrap();
        let Judgement { energy, kkt, .. } = judge(&network, Law::SIGNORINI, &y, &load);
        assert!(
            matches!(end.stop, Stop::Converged | Stop::RoundingFloor),
            "{end:?} {energy} {kkt:?}"
        );
        assert!((energy / -1.131441804e-7 - 1.0).abs() < 1e-6, "{energy} {kkt:?}");
    }
}
