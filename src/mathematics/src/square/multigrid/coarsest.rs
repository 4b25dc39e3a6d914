//! Direct solution on the coarsest grid, of at most a few hundred nodes.

use super::level::{Location, MultigridLevel};
use super::rows::boundary_number;
use super::stencil::{DIAGONAL, INVERSE, MULTIPLICATIONS_PER_VISIT};
use crate::discrete::network::Network;
use crate::multigrid::active_set::StateProblem;
use crate::multigrid::direct::{Direct, FactorOrder};
use crate::problem::law::{BoundaryState, Law};
use std::sync::Arc;

/// Limit on the number of active-set steps. There are at most a few dozen boundary nodes.
const MAX_STEPS: usize = 60;

/// The matrix of the coarsest grid and its factors for one set of springs.
pub(super) struct Coarsest {
    network: Arc<Network>,
    nodes: Vec<CoarsestNode>,
    /// Work of one factorisation, in visits of unknowns.
    factor_work: f64,
    /// Work of one solution with the factors, in visits of unknowns.
    solve_work: f64,
    /// Matrix without springs, and factors with them.
    direct: Direct,
    /// Solution in natural order.
    x: Vec<f64>,
}

/// A node of the coarsest grid.
struct CoarsestNode {
    location: Location,
    /// Number among the boundary nodes; `None` inside.
    boundary: Option<usize>,
    /// Part of the cell around the node that lies inside.
    share: f64,
}

impl CoarsestNode {
    /// Load of the level at the node, times the share.
    fn load(&self, level: &MultigridLevel) -> f64 {
        let Location { colour, place } = self.location;
        self.share * level.load[colour as usize][place]
    }

    /// Value of the level at the node.
    fn value<'a>(&self, level: &'a mut MultigridLevel) -> &'a mut f64 {
        let Location { colour, place } = self.location;
        &mut level.values[colour as usize][place]
    }
}

impl Coarsest {
    pub(super) fn new(n: usize) -> Self {
        let network = Network::of_stencil(n);
        let direct = Direct::new(&network, FactorOrder::Natural);
        let mut nodes = Vec::with_capacity(network.nodes());
        for (k, &entry) in network.diagonal().iter().enumerate() {
            let on_boundary = entry < DIAGONAL;
            nodes.push(CoarsestNode {
                location: Location::of_node(n, k),
                boundary: on_boundary.then(|| boundary_number(n, [k % (n + 1), k / (n + 1)])),
                share: entry / DIAGONAL,
            });
        }
        Self {
            nodes,
            factor_work: direct.factor_work() / MULTIPLICATIONS_PER_VISIT,
            solve_work: direct.solve_work() / MULTIPLICATIONS_PER_VISIT,
            x: vec![0.0; network.nodes()],
            direct,
            network: Arc::new(network),
        }
    }

    /// Factors the matrix with the springs of the level, made symmetric by the shares of the nodes. Returns the work in
    /// visits of unknowns.
    pub(super) fn factor(&mut self, level: &MultigridLevel) -> f64 {
        let entries = self.nodes.iter().zip(self.network.diagonal()).map(|(node, diagonal)| {
            match node.boundary {
                Some(edge) => node.share / level.inverse_diagonal[edge],
                None => *diagonal,
            }
        });
        self.direct.factor(entries);
        self.factor_work
    }

    /// Solves `(A + springs) y = F` with `y = 0` at the nodes in contact. Returns the work in visits of unknowns.
    pub(super) fn solve_linear(&mut self, level: &mut MultigridLevel) -> f64 {
        let Self { nodes, x, .. } = self;
        for (x, node) in x.iter_mut().zip(&*nodes) {
            let fixed = node.boundary.is_some_and(|edge| level.inverse_diagonal[edge] == 0.0);
            *x = if fixed { 0.0 } else { node.load(level) };
        }
        self.solve_into(level)
    }

    /// Solves for the right-hand side in `x`, and sets the values of the level.
    fn solve_into(&mut self, level: &mut MultigridLevel) -> f64 {
        self.direct.solve(&mut self.x);
        for (&x, node) in self.x.iter().zip(&self.nodes) {
            *node.value(level) = x;
        }
        self.solve_work
    }

    /// Solves the problem under the law by the primal-dual active set method. Returns the work in visits of unknowns.
    ///
    /// See [`active_set`](super::active_set) on convergence.
    pub(super) fn solve_under_law(&mut self, level: &mut MultigridLevel) -> f64 {
        let network = Arc::clone(&self.network);
        let components = vec![0; network.nodes()];
        let load: Vec<_> = self.nodes.iter().map(|node| node.load(level)).collect();
        // The measures of the network are twice as many as the sides of a node times its share.
        let law = Law::up_to(0.5 * level.limit);
        let laws = vec![law; network.contact().len()];
        let problem =
            StateProblem { network: &network, components: &components, load: &load, laws: &laws };
        let mut states = problem.all_stick();
        let mut work = 0.0;
        for _ in 0..MAX_STEPS {
            work += self.solve_with(&problem, &states, level);
            let next = problem.next_states(&states, &self.x);
            if next == states {
                break;
            }
            states = next;
        }
        self.put_contact(&states, level);
        for ((x, node), state) in self.x.iter().zip(&self.nodes).zip(&states) {
            if node.boundary.is_some() {
                *node.value(level) = match state {
                    BoundaryState::SlipsDown => x.min(0.0),
                    _ => x.max(0.0),
                };
            }
        }
        work
    }

    /// Solves with these states. Returns the work in visits of unknowns.
    fn solve_with(
        &mut self,
        problem: &StateProblem<'_>,
        states: &[BoundaryState],
        level: &mut MultigridLevel,
    ) -> f64 {
        self.put_contact(states, level);
        let work = self.factor(level);
        let load = problem.load_with(states);
        for ((x, load), state) in self.x.iter_mut().zip(load).zip(states) {
            *x = if *state == BoundaryState::Sticks { 0.0 } else { load };
        }
        work + self.solve_into(level)
    }

    /// Puts the nodes that stick in contact, and removes all springs from the other boundary nodes.
    fn put_contact(&self, states: &[BoundaryState], level: &mut MultigridLevel) {
        for (node, state) in self.nodes.iter().zip(states) {
            if let Some(edge) = node.boundary {
                let sticks = *state == BoundaryState::Sticks;
                level.inverse_diagonal[edge] = if sticks { 0.0 } else { INVERSE };
            }
        }
    }
}
