//! (9) at the interior nodes of a square, in bands of rows.
//!
//! Each node needs the new value of its western neighbour, so a plain loop runs at the latency of one addition and
//! one multiplication. A band of consecutive rows, each one column behind the row below, updates independent nodes at
//! each step: this hides the latency and gives the same bits.

use std::array::from_fn;
use std::ops::{Add, Mul};

/// Number, or a number for each of several runs.
pub(super) trait Entry: Copy + Add<Output = Self> + Mul<Output = Self> {}

impl<T: Copy + Add<Output = T> + Mul<Output = T>> Entry for T {}

/// Interior rows of the discrete problem on a square.
#[derive(Clone, Copy)]
pub(super) struct InteriorRows<'a, T> {
    /// Cells per side.
    pub n: usize,
    /// Load vector, node by node.
    pub load: &'a [T],
    /// Inverse of the diagonal.
    pub inverse: T,
}

/// Number of rows in the band that begins at row `first` of a grid with `n` cells per side.
#[inline(always)]
pub(super) fn rows_of_band(n: usize, first: usize) -> usize {
    (n - first).min(4)
}

impl<T: Entry> InteriorRows<'_, T> {
    /// Relaxes all interior nodes of the band that begins at row `first`.
    ///
    /// Nodes of the left side come before: they use no new value of the band but those of the row below in the same
    /// column. Nodes of the right side come after: no node of the band uses their new values.
    #[inline(always)]
    pub(super) fn relax_band(&self, y: &mut [T], first: usize) {
        match rows_of_band(self.n, first) {
            1 => self.relax::<1>(y, first),
            2 => self.relax::<2>(y, first),
            3 => self.relax::<3>(y, first),
            _ => self.relax::<4>(y, first),
        }
    }

    /// Relaxes `K` rows from the `first` on, each one column behind the row below.
    #[inline(always)]
    pub(super) fn relax<const K: usize>(&self, y: &mut [T], first: usize) {
        let n = self.n;
        // The first and last columns of a band have fewer than K rows at work: one node at a time.
        for t in 1..K {
            (0..t).for_each(|k| self.relax_node(y, t - k, first + k));
        }
        self.relax_steadily::<K>(y, first, n - K);
        for t in n..n + K - 1 {
            (t + 1 - n..K).for_each(|k| self.relax_node(y, t - k, first + k));
        }
    }

    /// Relaxes the node in column `i` and row `j`.
    #[inline(always)]
    fn relax_node(&self, y: &mut [T], i: usize, j: usize) {
        let side = self.n + 1;
        let node = j * side + i;
        let around = [y[node + 1], y[node + side], y[node - side], y[node - 1]];
        y[node] = relaxed(self.inverse, self.load[node], around);
    }

    /// Relaxes `steps` nodes of each row of a band, in row k from column `K - k` on.
    #[inline(always)]
    fn relax_steadily<const K: usize>(&self, y: &mut [T], first: usize, steps: usize) {
        let side = self.n + 1;
        let (below, rest) = y[(first - 1) * side..].split_at_mut(side);
        let (rows, above) = rest.split_at_mut(K * side);
        let (below, above) = (&below[K..][..steps], &above[1..][..steps]);
        let mut rows = rows.chunks_exact_mut(side);
        // The window of row k begins one column to the west.
        let rows: [_; K] =
            from_fn(|k| &mut rows.next().expect("a row for each k")[K - k - 1..][..steps + 2]);
        let loads: [_; K] = from_fn(|k| &self.load[(first + k) * side + K - k..][..steps]);
        let mut west: [T; K] = from_fn(|k| rows[k][0]);
        for t in 0..steps {
            // The node north of row k is the one east of row k + 1, and the node south of row k + 1 is
            // the one that row k has just left.
            let (mut south, mut east) = (below[t], rows[0][t + 2]);
            for k in 0..K {
                let north = if k + 1 < K { rows[k + 1][t + 2] } else { above[t] };
                let next = relaxed(self.inverse, loads[k][t], [east, north, south, west[k]]);
                (south, east, west[k]) = (west[k], north, next);
                rows[k][t + 1] = next;
            }
        }
    }
}

/// Returns `1/A_ii` times the sum of the load and the neighbours: (9) for an interior node.
///
/// The order of summation is part of the definition: results are compared bit by bit.
#[inline(always)]
fn relaxed<T: Entry>(inverse: T, load: T, [east, north, south, west]: [T; 4]) -> T {
    inverse * ((((load + east) + north) + south) + west)
}
