//! One lexicographic Gauss-Seidel sweep (9)-(11), `x` fastest, from the lower left corner.
//!
//! Each node needs the new value of its western neighbour, so a plain loop runs at the latency of one addition and
//! one multiplication. A band of consecutive rows, each one column behind the row below, updates independent nodes at
//! each step: this hides the latency and gives the same bits.

use super::plain::Duality;
use crate::discrete::grid::Grid;
use crate::problem::law::Law;
use std::array::from_fn;

/// Sweep with given data: the discrete problem, the multiplier, and the diagonals of its rows.
pub(super) struct GaussSeidel<'a> {
    grid: Grid,
    load: &'a [f64],
    a: &'a [f64],
    law: Law,
    r: f64,
    h: f64,
    /// Ends of the law's interval times h.
    ends: [f64; 2],
    /// Diagonal of the rows of edge nodes.
    edge: SweepDiagonal,
    /// Diagonal of the rows of corner nodes.
    corner: SweepDiagonal,
    /// Inverse of the diagonal of interior rows.
    inside: f64,
}

/// Diagonal entry of a row, and its inverse.
#[derive(Clone, Copy)]
struct SweepDiagonal {
    value: f64,
    inverse: f64,
}

impl SweepDiagonal {
    /// The inverse is exact for the powers of two that occur without a shift.
    fn new(value: f64) -> Self {
        Self { value, inverse: 1.0 / value }
    }
}

/// Returns `1/A_ii` times the sum of the load and the neighbours: (9) for an interior node.
///
/// The order of summation is part of the definition: results are compared bit by bit.
#[inline(always)]
fn interior(inverse: f64, load: f64, [east, north, south, west]: [f64; 4]) -> f64 {
    inverse * ((((load + east) + north) + south) + west)
}

impl<'a> GaussSeidel<'a> {
    /// Sweep for the load vector, the boundary vector `a` of multipliers, the law, and r > 0.
    ///
    /// `shift` is added to the diagonal of interior rows, half of it on edges and a quarter at corners: the lumped mass
    /// of a proximal term, whose other half belongs in `load`. The paper's sweep has none.
    pub(super) fn new(
        grid: Grid,
        load: &'a [f64],
        shift: f64,
        Duality { law, r }: Duality,
        a: &'a [f64],
    ) -> Self {
        let edge = SweepDiagonal::new(2.0 + 0.5 * shift);
        let corner = SweepDiagonal::new(1.0 + 0.25 * shift);
        let (h, inside) = (grid.h(), 1.0 / (4.0 + shift));
        let ends = [h * law.lo(), h * law.hi()];
        Self { grid, load, a, law, r, h, ends, edge, corner, inside }
    }

    /// Replaces `y` by the result of one sweep.
    pub(super) fn sweep(&self, y: &mut [f64]) {
        let n = self.grid.cells();
        self.relax_side_row(y, 0);
        let mut j = 1;
        while j < n {
            j += match n - j {
                1 => self.relax_band::<1>(y, j),
                2 => self.relax_band::<2>(y, j),
                3 => self.relax_band::<3>(y, j),
                _ => self.relax_band::<4>(y, j),
            };
        }
        self.relax_side_row(y, n);
    }

    /// Relaxes the first row, `j = 0`, or the last one, `j = n`.
    fn relax_side_row(&self, y: &mut [f64], j: usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let first = j * side;
        // Position of the first node of the adjacent row inside.
        let inside = if j == 0 { side } else { first - side };
        y[first] = self.at_corner(0, j, [y[first + 1], y[inside]]);
        for i in 1..n {
            let (node, b) = (first + i, self.grid.boundary_index(i, j));
            y[node] = self.on_edge(b, node, [0.5 * y[node + 1], y[inside + i], 0.5 * y[node - 1]]);
        }
        y[first + n] = self.at_corner(n, j, [y[inside + n], y[first + n - 1]]);
    }

    /// Returns the new value of the corner in column `i` and row `j`, from its two neighbours.
    fn at_corner(&self, i: usize, j: usize, [first, second]: [f64; 2]) -> f64 {
        let sum = (self.load[self.grid.index(i, j)] + 0.5 * first) + 0.5 * second;
        self.boundary(self.grid.boundary_index(i, j), self.corner, sum)
    }

    /// Relaxes the ends in column `i`, 0 or n, of `rows` rows from the `first` on.
    fn relax_ends(&self, y: &mut [f64], i: usize, first: usize, rows: usize) {
        let side = self.grid.side();
        for j in first..first + rows {
            let node = j * side + i;
            let b = self.grid.boundary_index(i, j);
            let [north, south] = [0.5 * y[node + side], 0.5 * y[node - side]];
            let terms =
                if i == 0 { [y[node + 1], north, south] } else { [north, south, y[node - 1]] };
            y[node] = self.on_edge(b, node, terms);
        }
    }

    /// Returns the new value of edge node `b`, from its neighbours times their weights.
    #[inline(always)]
    fn on_edge(&self, b: usize, node: usize, [first, second, third]: [f64; 3]) -> f64 {
        self.boundary(b, self.edge, ((self.load[node] + first) + second) + third)
    }

    /// Returns the minimiser (10), (11) at boundary node `b`: `sum` is `F_i - sum_j A_ij y_j` without the diagonal.
    #[inline(always)]
    fn boundary(&self, b: usize, diagonal: SweepDiagonal, sum: f64) -> f64 {
        let Self { law, r, h, ends: [least, most], .. } = *self;
        let a = self.a[b];
        let up = diagonal.inverse * (sum + least);
        if up >= (a - law.lo()) / r {
            return up;
        }
        // Without an upper end nothing slips down, and a division for each node that sticks is saved.
        if most.is_finite() {
            let down = diagonal.inverse * (sum + most);
            if down <= (a - law.hi()) / r {
                return down;
            }
        }
        (sum + h * a) / (diagonal.value + h * r)
    }

    /// Relaxes the interior node in column `i` and row `j`.
    #[inline(always)]
    fn relax_inside(&self, y: &mut [f64], i: usize, j: usize) {
        let side = self.grid.side();
        let node = j * side + i;
        let around = [y[node + 1], y[node + side], y[node - side], y[node - 1]];
        y[node] = interior(self.inside, self.load[node], around);
    }

    /// Relaxes `K` interior rows from the `first` on, each one column behind the row below, and returns `K`.
    ///
    /// Nodes of the left side come first: they use no new value of this band but those of the row below in the same
    /// column. Nodes of the right side come last: no node of the band uses their new values.
    fn relax_band<const K: usize>(&self, y: &mut [f64], first: usize) -> usize {
        let n = self.grid.cells();
        self.relax_ends(y, 0, first, K);
        // The first and last columns of a band have fewer than K rows at work: one node at a time.
        for t in 1..K {
            (0..t).for_each(|k| self.relax_inside(y, t - k, first + k));
        }
        self.relax_steadily::<K>(y, first, n - K);
        for t in n..n + K - 1 {
            (t + 1 - n..K).for_each(|k| self.relax_inside(y, t - k, first + k));
        }
        self.relax_ends(y, n, first, K);
        K
    }

    /// Relaxes `steps` nodes of each row of a band, in row k from column `K - k` on.
    fn relax_steadily<const K: usize>(&self, y: &mut [f64], first: usize, steps: usize) {
        let side = self.grid.side();
        let (below, rest) = y[(first - 1) * side..].split_at_mut(side);
        let (rows, above) = rest.split_at_mut(K * side);
        let (below, above) = (&below[K..][..steps], &above[1..][..steps]);
        let mut rows = rows.chunks_exact_mut(side);
        // The window of row k begins one column to the west.
        let rows: [_; K] =
            from_fn(|k| &mut rows.next().expect("a row for each k")[K - k - 1..][..steps + 2]);
        let loads: [_; K] = from_fn(|k| &self.load[(first + k) * side + K - k..][..steps]);
        let mut west: [f64; K] = from_fn(|k| rows[k][0]);
        for t in 0..steps {
            // The node north of row k is the one east of row k + 1, and the node south of row k + 1 is
            // the one that row k has just left.
            let (mut south, mut east) = (below[t], rows[0][t + 2]);
            for k in 0..K {
                let north = if k + 1 < K { rows[k + 1][t + 2] } else { above[t] };
                let next = interior(self.inside, loads[k][t], [east, north, south, west[k]]);
                (south, east, west[k]) = (west[k], north, next);
                rows[k][t + 1] = next;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::network::Network;
    use crate::saddle::{Pair, Plain};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bands_give_the_definition_to_the_last_bit(
            n in 2usize..40, seed in any::<u64>(), r in 1e-3..1e6f64, shift in 0.0..2.0f64,
            friction in proptest::option::of(0.01..1.0f64),
        ) {
            let grid = Grid::new(n).unwrap();
            let mut state = seed;
            let mut random = move || {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
            };
            let load: Vec<f64> = (0..grid.nodes()).map(|_| random()).collect();
            let law = friction.map_or(Law::SIGNORINI, |g| Law::friction(g).unwrap());
            let duality = Duality { law, r };
            let a: Vec<f64> =
                (0..grid.boundary_nodes()).map(|_| law.project(random())).collect();
            let start: Vec<f64> = (0..grid.nodes()).map(|_| random()).collect();
            let mut defined = Pair { y: start.clone(), a: a.clone() };
            let mut banded = start.clone();
            let network = Network::of_square(grid);
            let definition = Plain { network: &network, law, load: &load, r };
            for _ in 0..3 {
                definition.sweep(&mut defined);
                GaussSeidel::new(grid, &load, 0.0, duality, &a).sweep(&mut banded);
            }
            prop_assert_eq!(defined.y, banded);
            // With a proximal term, which the paper has not, row by row.
            let (mut plain, mut banded) = (start.clone(), start);
            let data = GaussSeidel::new(grid, &load, shift, duality, &a);
            for _ in 0..3 {
                data.relax_side_row(&mut plain, 0);
                for j in 1..n {
                    data.relax_band::<1>(&mut plain, j);
                }
                data.relax_side_row(&mut plain, n);
                data.sweep(&mut banded);
            }
            prop_assert_eq!(plain, banded);
        }
    }

    #[test]
    fn boundary_formula_is_continuous_where_it_switches() {
        let grid = Grid::new(4).unwrap();
        let duality = Duality { law: Law::SIGNORINI, r: 2.0 };
        let data = GaussSeidel::new(grid, &[0.0; 25], 0.0, duality, &[0.3; 16]);
        // psi = a / r exactly, and a hair below.
        let at = data.boundary(1, data.edge, 0.3);
        let below = data.boundary(1, data.edge, 0.3 - 1e-12);
        assert_eq!(at, 0.15);
        assert!((at - below).abs() < 1e-11);
    }
}
