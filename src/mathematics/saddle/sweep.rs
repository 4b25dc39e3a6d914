//! One lexicographic Gauss-Seidel sweep (9)-(11), `x` fastest, from the lower left corner.
//!
//! Each node waits for its western neighbour, so a plain loop runs at the latency of one addition and
//! one multiplication. Rows that follow each other one column behind are independent of one another at
//! any moment; a band of them hides the latency and gives the same result to the last bit.

use crate::discrete::grid::Grid;
use std::array::from_fn;

/// Replaces `y` by the result of one sweep; `a` is the boundary vector of multipliers, r > 0.
///
/// `shift` is added to the diagonal of interior rows, half of it on edges and a quarter at corners:
/// the lumped mass of a proximal term, whose other half belongs in `load`. The paper's sweep has none.
pub(super) fn sweep(grid: Grid, load: &[f64], shift: f64, r: f64, y: &mut [f64], a: &[f64]) {
    let n = grid.cells();
    let nodes = Nodes::new(grid, load, shift, r, a);
    nodes.relax_side_row(y, 0);
    let mut j = 1;
    while j < n {
        j += match n - j {
            1 => nodes.relax_band::<1>(y, j),
            2 => nodes.relax_band::<2>(y, j),
            3 => nodes.relax_band::<3>(y, j),
            _ => nodes.relax_band::<4>(y, j),
        };
    }
    nodes.relax_side_row(y, n);
}

struct Nodes<'a> {
    grid: Grid,
    load: &'a [f64],
    a: &'a [f64],
    r: f64,
    h: f64,
    /// Diagonals of edge and corner rows, each with its inverse, and the inverse inside.
    edge: (f64, f64),
    corner: (f64, f64),
    inside: f64,
}

/// `1/A_ii` times the sum over the neighbours and the load: (9) for an interior node.
///
/// The order of summation is part of the definition: results are compared bit by bit.
#[inline(always)]
fn interior(inverse: f64, south: f64, north: f64, east: f64, load: f64, west: f64) -> f64 {
    inverse * (((south + north) + (east + load)) + west)
}

impl<'a> Nodes<'a> {
    fn new(grid: Grid, load: &'a [f64], shift: f64, r: f64, a: &'a [f64]) -> Self {
        // Powers of two, and so exact, if there is no shift.
        let with_inverse = |diagonal: f64| (diagonal, 1.0 / diagonal);
        let edge = with_inverse(2.0 + 0.5 * shift);
        let corner = with_inverse(1.0 + 0.25 * shift);
        Self { grid, load, a, r, h: grid.h(), edge, corner, inside: 1.0 / (4.0 + shift) }
    }

    /// Relaxes the first row, `j = 0`, or the last one, `j = n`.
    fn relax_side_row(&self, y: &mut [f64], j: usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let first = j * side;
        // Where the multiplier of column i is, and the node of that column in the row inside.
        let place = |i: usize| if j == 0 { i } else { 3 * n - i };
        let inside = |i: usize| if j == 0 { side + i } else { first - side + i };
        let at_corner = |y: &[f64], i: usize, beside: usize| {
            let sum = 0.5 * (y[first + beside] + y[inside(i)]) + self.load[first + i];
            self.boundary(place(i) % (4 * n), self.corner, sum)
        };
        y[first] = at_corner(y, 0, 1);
        for i in 1..n {
            let node = first + i;
            y[node] = self.on_edge(place(i), node, [y[node - 1], y[node + 1]], y[inside(i)]);
        }
        y[first + n] = at_corner(y, n, n - 1);
    }

    /// Relaxes the ends in column `i`, 0 or n, of `rows` rows from the `first` on.
    fn relax_ends(&self, y: &mut [f64], i: usize, first: usize, rows: usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        for j in first..first + rows {
            let node = j * side + i;
            let (place, inward) = if i == 0 { (4 * n - j, node + 1) } else { (n + j, node - 1) };
            y[node] = self.on_edge(place, node, [y[node - side], y[node + side]], y[inward]);
        }
    }

    /// The new value of a node on an edge, from its neighbours along it and inside.
    #[inline(always)]
    fn on_edge(&self, b: usize, node: usize, [before, after]: [f64; 2], inward: f64) -> f64 {
        self.boundary(b, self.edge, 0.5 * (before + after) + inward + self.load[node])
    }

    /// (10) and (11) for boundary node `b`: `sum` is `F_i - sum_j A_ij y_j` without the diagonal.
    #[inline(always)]
    fn boundary(&self, b: usize, (diagonal, inverse): (f64, f64), sum: f64) -> f64 {
        let a = self.a[b];
        let psi = inverse * sum;
        if psi >= a / self.r { psi } else { (sum + self.h * a) / (diagonal + self.h * self.r) }
    }

    /// Relaxes the interior node in column `i` and row `j`.
    #[inline(always)]
    fn relax_inside(&self, y: &mut [f64], i: usize, j: usize) {
        let side = self.grid.side();
        let node = j * side + i;
        let (south, north) = (y[node - side], y[node + side]);
        y[node] = interior(self.inside, south, north, y[node + 1], self.load[node], y[node - 1]);
    }

    /// Relaxes `K` rows from the `first` on, all interior, and so fewer than n, each one column behind the row below
    /// it, and returns `K`; what is on the left border refers to nothing that changes before it, and what is on the
    /// right is referred to afterwards only.
    fn relax_band<const K: usize>(&self, y: &mut [f64], first: usize) -> usize {
        let n = self.grid.cells();
        self.relax_ends(y, 0, first, K);
        // Where the band enters and leaves, one node at a time.
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

    /// The steps in which each row of a band has a node: `steps` of them, row k from column `K - k` on.
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
                let next = interior(self.inside, south, north, east, loads[k][t], west[k]);
                (south, east, west[k]) = (west[k], north, next);
                rows[k][t + 1] = next;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::saddle::Plain;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bands_give_the_definition_to_the_last_bit(
            n in 2usize..40, seed in any::<u64>(), r in 1e-3..1e6f64, shift in 0.0..2.0f64,
        ) {
            let grid = Grid::new(n).unwrap();
            let mut state = seed;
            let mut random = move || {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
            };
            let load: Vec<f64> = (0..grid.nodes()).map(|_| random()).collect();
            let a: Vec<f64> = (0..grid.boundary_nodes()).map(|_| random().max(0.0)).collect();
            let start: Vec<f64> = (0..grid.nodes()).map(|_| random()).collect();
            let (mut defined, mut banded) = (start.clone(), start.clone());
            let definition = Plain { grid, load: &load, r };
            for _ in 0..3 {
                definition.sweep(&mut defined, &a);
                sweep(grid, &load, 0.0, r, &mut banded, &a);
            }
            prop_assert_eq!(defined, banded);
            // With a proximal term, which the paper has not, row by row.
            let (mut plain, mut banded) = (start.clone(), start);
            let nodes = Nodes::new(grid, &load, shift, r, &a);
            for _ in 0..3 {
                nodes.relax_side_row(&mut plain, 0);
                for j in 1..n {
                    nodes.relax_band::<1>(&mut plain, j);
                }
                nodes.relax_side_row(&mut plain, n);
                sweep(grid, &load, shift, r, &mut banded, &a);
            }
            prop_assert_eq!(plain, banded);
        }
    }

    #[test]
    fn boundary_formula_is_continuous_where_it_switches() {
        let grid = Grid::new(4).unwrap();
        let nodes = Nodes::new(grid, &[0.0; 25], 0.0, 2.0, &[0.3; 16]);
        // psi = a / r exactly, and a hair below.
        let at = nodes.boundary(1, nodes.edge, 0.3);
        let below = nodes.boundary(1, nodes.edge, 0.3 - 1e-12);
        assert_eq!(at, 0.15);
        assert!((at - below).abs() < 1e-11);
    }
}
