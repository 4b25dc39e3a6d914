//! Direct solution on the coarsest grid, of at most a few hundred nodes.

use super::active_set::next_contact;
use super::direct::{BandOrder, Direct};
use super::layout::{Dimension, boundary_number};
use super::level::{Location, MultigridLevel};
use super::stencil::{diagonal, inverse, multiplications_per_visit};
use crate::discrete::network::Network;

/// Limit on the number of active-set steps. There are at most a few dozen boundary nodes.
const MAX_STEPS: usize = 60;

/// The matrix of the coarsest grid and its factors for one set of springs.
pub(super) struct Coarsest {
    network: Network,
    /// Connected component of each node: all are in the first.
    components: Vec<u32>,
    nodes: Vec<CoarsestNode>,
    /// One over the diagonal inside.
    inverse: f64,
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

/// Indices of node `k` in natural order, x first; the square uses the first two only.
fn indices(n: usize, k: usize) -> [usize; 3] {
    let row = k / (n + 1);
    [k % (n + 1), row % (n + 1), row / (n + 1)]
}

impl Coarsest {
    pub(super) fn new<D: Dimension>(n: usize) -> Self {
        let network = Network::of_stencil(D::AXES, n);
        let full = diagonal::<D>();
        let direct = Direct::new(&network, BandOrder::Natural);
        let mut nodes = Vec::with_capacity(network.nodes());
        for (k, &entry) in network.diagonal().iter().enumerate() {
            let on_boundary = entry < full;
            nodes.push(CoarsestNode {
                location: Location::of_node(n, k),
                boundary: on_boundary.then(|| boundary_number::<D>(n, &indices(n, k)[..D::AXES])),
                share: entry / full,
            });
        }
        Self {
            nodes,
            inverse: inverse::<D>(),
            factor_work: direct.factor_work() / multiplications_per_visit::<D>(),
            solve_work: direct.solve_work() / multiplications_per_visit::<D>(),
            x: vec![0.0; network.nodes()],
            components: vec![0; network.nodes()],
            direct,
            network,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.direct.bytes() + size_of::<f64>() * self.x.len()
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
        self.direct.solve(x);
        for (&x, node) in x.iter().zip(&*nodes) {
            *node.value(level) = x;
        }
        self.solve_work
    }

    /// Solves the Signorini problem by the primal-dual active set method. Returns the work in visits of unknowns.
    ///
    /// See [`active_set`](super::active_set) on convergence.
    pub(super) fn solve_obstacle(&mut self, level: &mut MultigridLevel) -> f64 {
        let load: Vec<_> = self.nodes.iter().map(|node| node.load(level)).collect();
        let mut active: Vec<_> = self.nodes.iter().map(|node| node.boundary.is_some()).collect();
        let mut work = 0.0;
        for _ in 0..MAX_STEPS {
            self.put_contact(&active, level);
            work += self.factor(level) + self.solve_linear(level);
            let next = next_contact(&self.network, &self.components, &active, &self.x, &load);
            if next == active {
                break;
            }
            active = next;
        }
        self.put_contact(&active, level);
        for (x, node) in self.x.iter().zip(&self.nodes) {
            if node.boundary.is_some() {
                *node.value(level) = x.max(0.0);
            }
        }
        work
    }

    /// Puts the `active` nodes in contact, and removes all springs from the other boundary nodes.
    fn put_contact(&self, active: &[bool], level: &mut MultigridLevel) {
        for (node, active) in self.nodes.iter().zip(active) {
            if let Some(edge) = node.boundary {
                level.inverse_diagonal[edge] = if *active { 0.0 } else { self.inverse };
            }
        }
    }
}
