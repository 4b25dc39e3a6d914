//! Direct solution on the coarsest grid, of at most a few hundred nodes.

use super::banded::Banded;
use super::layout::{Dimension, boundary_number};
use super::level::{Level, locate};
use super::network::Network;
use super::stencil::{diagonal, inverse, multiplications_per_visit};

/// Active-set steps at most; there are at most a few dozen boundary nodes.
const MAX_STEPS: usize = 60;

/// The matrix of the coarsest grid and its factors for one set of springs.
pub(super) struct Coarsest {
    network: Network,
    nodes: Vec<Node>,
    /// One over the diagonal inside.
    inverse: f64,
    /// Work of factoring and of solving, in visits of unknowns.
    work: [f64; 2],
    /// Without springs.
    matrix: Banded,
    factor: Banded,
    x: Vec<f64>,
}

struct Node {
    /// Colour and place in the rows of the level.
    place: (usize, usize),
    /// Its number on the boundary, if it lies there.
    boundary: Option<usize>,
    /// Part of its cell that lies inside.
    share: f64,
}

impl Coarsest {
    pub(super) fn new<D: Dimension>(n: usize) -> Self {
        let network = Network::new(D::AXES, n, 1.0);
        let (diagonal, full) = (network.diagonal(), diagonal::<D>());
        let band = (n + 1).pow(D::AXES as u32 - 1);
        let zeros = || Banded::zeros(network.nodes(), band);
        let mut matrix = zeros();
        let node = |k: usize| {
            let (mut node, mut rest) = ([0; 3], k);
            let node = &mut node[..D::AXES];
            for i in node.iter_mut() {
                (*i, rest) = (rest % (n + 1), rest / (n + 1));
            }
            let boundary = network.is_constrained(k).then(|| boundary_number::<D>(n, node));
            *matrix.entry(k, k) = diagonal[k];
            for (other, weight) in network.couplings(k) {
                *matrix.entry(other, k) = -weight;
            }
            Node { place: locate(n, k), boundary, share: diagonal[k] / full }
        };
        Self {
            nodes: (0..network.nodes()).map(node).collect(),
            inverse: inverse::<D>(),
            work: [matrix.factor_work(), matrix.solve_work()]
                .map(|work| work / multiplications_per_visit::<D>()),
            factor: zeros(),
            x: vec![0.0; network.nodes()],
            matrix,
            network,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<f64>() * (2 * self.factor.entries() + self.x.len())
    }

    /// Factors the matrix for the springs of the level, made symmetric by the shares of the nodes; returns
    /// the work in visits of unknowns.
    pub(super) fn factor(&mut self, level: &Level) -> f64 {
        let Self { nodes, matrix, factor, .. } = self;
        factor.copy_from(matrix);
        for (k, node) in nodes.iter().enumerate() {
            let Some(edge) = node.boundary else { continue };
            match level.inverse_diagonal[edge] {
                0.0 => factor.fix(k),
                inverse => *factor.entry(k, k) = node.share / inverse,
            }
        }
        factor.factor();
        self.work[0]
    }

    /// Solves `(A + springs) y = F` with `y = 0` at the nodes in contact; returns the work in visits.
    pub(super) fn solve_linear(&mut self, level: &mut Level) -> f64 {
        let Self { nodes, x, .. } = self;
        for (x, Node { place: (colour, place), boundary, share }) in x.iter_mut().zip(&*nodes) {
            let fixed = boundary.is_some_and(|edge| level.inverse_diagonal[edge] == 0.0);
            *x = if fixed { 0.0 } else { share * level.load[*colour][*place] };
        }
        self.factor.solve(x);
        for (&x, Node { place: (colour, place), .. }) in x.iter().zip(&*nodes) {
            level.values[*colour][*place] = x;
        }
        self.work[1]
    }

    /// Solves the Signorini problem by the primal-dual active set method; returns the work in visits.
    ///
    /// Starting from full contact it never meets a singular system, because the node with the largest
    /// multiplier is kept when all others leave; see [`active_set`](super::active_set) on convergence.
    pub(super) fn solve_obstacle(&mut self, level: &mut Level) -> f64 {
        let load: Vec<_> = self
            .nodes
            .iter()
            .map(|node| node.share * level.load[node.place.0][node.place.1])
            .collect();
        level.inverse_diagonal.fill(0.0);
        let mut work = 0.0;
        for _ in 0..MAX_STEPS {
            work += self.factor(level) + self.solve_linear(level);
            let gradient = self.network.gradient(&self.x, &load);
            let mut changed = false;
            let (mut largest, mut keep) = (f64::NEG_INFINITY, 0);
            for (k, node) in self.nodes.iter().enumerate() {
                let Some(edge) = node.boundary else { continue };
                let was_active = level.inverse_diagonal[edge] == 0.0;
                let active = if was_active { gradient[k] >= 0.0 } else { self.x[k] < 0.0 };
                if was_active && gradient[k] > largest {
                    (largest, keep) = (gradient[k], edge);
                }
                changed |= active != was_active;
                level.inverse_diagonal[edge] = if active { 0.0 } else { self.inverse };
            }
            if !changed {
                break;
            }
            if level.inverse_diagonal.iter().all(|&inverse| inverse > 0.0) {
                level.inverse_diagonal[keep] = 0.0;
            }
        }
        for (x, Node { place: (colour, place), boundary, .. }) in self.x.iter().zip(&self.nodes) {
            if boundary.is_some() {
                level.values[*colour][*place] = x.max(0.0);
            }
        }
        work
    }
}
