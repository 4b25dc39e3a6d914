//! Direct solution on the coarsest grid, of at most a few hundred nodes.

use super::banded::Banded;
use super::layout::{Dimension, boundary_number};
use super::level::Level;
use super::network::Network;

/// Active-set steps at most; there are at most a few dozen boundary nodes.
const MAX_STEPS: usize = 60;

/// The matrix of the coarsest grid and its Cholesky factor for one set of springs.
pub(super) struct Coarsest {
    network: Network,
    /// Number of each node on the boundary, if it lies there, and the part of its cell that lies inside.
    boundary: Vec<Option<usize>>,
    share: Vec<f64>,
    band: usize,
    /// Multiplications per visit of an unknown.
    stencil: f64,
    factor: Banded,
    x: Vec<f64>,
}

impl Coarsest {
    pub(super) fn new<D: Dimension>(n: usize) -> Self {
        let network = Network::unit::<D>(n);
        let diagonal = network.diagonal();
        let full = 2.0 * D::AXES as f64;
        let boundary = |k: usize| {
            let (node, mut rest) = ([0; 3], k);
            let node = &mut { node }[..D::AXES];
            for i in node.iter_mut() {
                (*i, rest) = (rest % (n + 1), rest / (n + 1));
            }
            network.is_constrained(k).then(|| boundary_number::<D>(n, node))
        };
        Self {
            boundary: (0..network.nodes()).map(boundary).collect(),
            share: diagonal.iter().map(|diagonal| diagonal / full).collect(),
            band: (n + 1).pow(D::AXES as u32 - 1),
            stencil: full + 1.0,
            factor: Banded::default(),
            x: vec![0.0; network.nodes()],
            network,
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<f64>() * (self.factor.entries() + self.x.len())
    }

    /// Factors the matrix for the springs of the level, made symmetric by the shares of the nodes; returns
    /// the work in visits of unknowns.
    pub(super) fn factor(&mut self, level: &Level) -> f64 {
        let Self { network, boundary, share, .. } = self;
        let mut matrix = Banded::zeros(network.nodes(), self.band);
        let diagonal = network.diagonal();
        for k in 0..network.nodes() {
            *matrix.entry(k, k) = match boundary[k] {
                Some(edge) => share[k] / level.inverse_diagonal[edge],
                None => diagonal[k],
            };
            for (other, weight) in network.couplings(k) {
                *matrix.entry(other, k) = -weight;
            }
        }
        for (k, edge) in boundary.iter().enumerate() {
            if edge.is_some_and(|edge| level.inverse_diagonal[edge] == 0.0) {
                matrix.fix(k);
            }
        }
        matrix.factor();
        self.factor = matrix;
        self.factor.factor_work() / self.stencil
    }

    /// Solves `(A + springs) y = F` with `y = 0` at the nodes in contact; returns the work in visits.
    pub(super) fn solve_linear(&mut self, level: &mut Level) -> f64 {
        for (k, x) in self.x.iter_mut().enumerate() {
            let fixed = self.boundary[k].is_some_and(|edge| level.inverse_diagonal[edge] == 0.0);
            *x = if fixed { 0.0 } else { self.share[k] * level.load_at(k) };
        }
        self.factor.solve(&mut self.x);
        self.x.iter().enumerate().for_each(|(k, &x)| level.set_value(k, x));
        self.factor.solve_work() / self.stencil
    }

    /// Solves the Signorini problem by the primal-dual active set method; returns the work in visits.
    ///
    /// Starting from full contact it never meets a singular system, because the node with the largest
    /// multiplier is kept when all others leave; see [`active_set`](super::active_set) on convergence.
    pub(super) fn solve_obstacle(&mut self, level: &mut Level) -> f64 {
        let free = 1.0 / (self.stencil - 1.0);
        let load: Vec<_> =
            self.share.iter().enumerate().map(|(k, share)| share * level.load_at(k)).collect();
        level.inverse_diagonal.fill(0.0);
        let mut work = 0.0;
        for _ in 0..MAX_STEPS {
            work += self.factor(level) + self.solve_linear(level);
            let gradient = self.network.gradient(&self.x, &load);
            let mut changed = false;
            let (mut largest, mut keep) = (f64::NEG_INFINITY, 0);
            for (k, edge) in self.boundary.iter().enumerate() {
                let Some(edge) = *edge else { continue };
                let was_active = level.inverse_diagonal[edge] == 0.0;
                let active = if was_active { gradient[k] >= 0.0 } else { self.x[k] < 0.0 };
                if was_active && gradient[k] > largest {
                    (largest, keep) = (gradient[k], edge);
                }
                changed |= active != was_active;
                level.inverse_diagonal[edge] = if active { 0.0 } else { free };
            }
            if !changed {
                break;
            }
            if level.inverse_diagonal.iter().all(|&inverse| inverse > 0.0) {
                level.inverse_diagonal[keep] = 0.0;
            }
        }
        for (k, edge) in self.boundary.iter().enumerate() {
            if edge.is_some() {
                level.set_value(k, self.x[k].max(0.0));
            }
        }
        work
    }
}
