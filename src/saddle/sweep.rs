//! One lexicographic Gauss-Seidel sweep (9)-(11), `x` fastest, from the lower left corner.
//!
//! Each node waits for its western neighbour, so a plain loop runs at the latency of one addition and
//! one multiplication. Rows that follow each other one column behind are independent of one another at
//! any moment; a band of them hides the latency and gives the same result to the last bit.

use crate::discrete::grid::Grid;

/// Rows swept together.
const BAND: usize = 4;

/// Replaces `y` by the result of one sweep; `a` is the boundary vector of multipliers, r > 0.
///
/// `shift` is added to the diagonal of interior rows, half of it on edges and a quarter at corners:
/// the lumped mass of a proximal term, whose other half belongs in `load`. The paper's sweep has none.
pub(super) fn sweep(grid: Grid, load: &[f64], shift: f64, r: f64, y: &mut [f64], a: &[f64]) {
    let n = grid.cells();
    let nodes = Nodes::new(grid, load, shift, r, a);
    for i in 0..=n {
        nodes.relax(y, i, 0);
    }
    let mut j = 1;
    while j + BAND <= n {
        nodes.relax_band(y, j);
        j += BAND;
    }
    for j in j..n {
        nodes.relax(y, 0, j);
        (1..n).for_each(|i| nodes.relax_inside(y, i, j));
        nodes.relax(y, n, j);
    }
    for i in 0..=n {
        nodes.relax(y, i, n);
    }
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

    /// Relaxes the node in column `i` and row `j`, wherever it lies.
    fn relax(&self, y: &mut [f64], i: usize, j: usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let node = j * side + i;
        let load = self.load[node];
        let along_x = |y: &[f64]| y[node - 1] + y[node + 1];
        let along_y = |y: &[f64]| y[node - side] + y[node + side];
        y[node] = match (i, j) {
            (0, 0) => self.boundary(0, self.corner, 0.5 * (y[node + 1] + y[node + side]) + load),
            (0, _) if j == n => {
                self.boundary(3 * n, self.corner, 0.5 * (y[node + 1] + y[node - side]) + load)
            }
            (_, 0) if i == n => {
                self.boundary(n, self.corner, 0.5 * (y[node - 1] + y[node + side]) + load)
            }
            _ if i == n && j == n => {
                self.boundary(2 * n, self.corner, 0.5 * (y[node - 1] + y[node - side]) + load)
            }
            (_, 0) => self.boundary(i, self.edge, 0.5 * along_x(y) + y[node + side] + load),
            _ if j == n => {
                self.boundary(3 * n - i, self.edge, 0.5 * along_x(y) + y[node - side] + load)
            }
            (0, _) => self.boundary(4 * n - j, self.edge, 0.5 * along_y(y) + y[node + 1] + load),
            _ if i == n => self.boundary(n + j, self.edge, 0.5 * along_y(y) + y[node - 1] + load),
            _ => return self.relax_inside(y, i, j),
        };
    }

    /// (10) and (11) for boundary node `b`: `sum` is `F_i - sum_j A_ij y_j` without the diagonal.
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

    /// Relaxes rows `first..first + BAND`, all interior, each one column behind the row below it; what is on the left
    /// border refers to nothing that changes before it, and what is on the right is referred to afterwards only.
    fn relax_band(&self, y: &mut [f64], first: usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        (first..first + BAND).for_each(|j| self.relax(y, 0, j));
        // Where the band enters and leaves, one node at a time.
        let steady = BAND..n;
        for t in 1..BAND {
            (0..t).for_each(|k| self.relax_inside(y, t - k, first + k));
        }
        if !steady.is_empty() {
            let len = steady.len();
            let (below, rest) = y[(first - 1) * side..].split_at_mut(side);
            let (rows, rest) = rest.split_at_mut(BAND * side);
            let below = &below[BAND..][..len];
            let above = &rest[1..][..len];
            let mut rows = rows.chunks_exact_mut(side);
            let mut loads = self.load[first * side..].chunks_exact(side);
            // Row k starts in column BAND - k; its window begins one column to the west.
            let mut window =
                |k: usize| &mut rows.next().expect("a band")[BAND - k - 1..][..len + 2];
            let [y0, y1, y2, y3] = [0, 1, 2, 3].map(&mut window);
            let mut window = |k: usize| &loads.next().expect("a band")[BAND - k..][..len];
            let [f0, f1, f2, f3] = [0, 1, 2, 3].map(&mut window);
            let inverse = self.inside;
            let [mut w0, mut w1, mut w2, mut w3] = [y0[0], y1[0], y2[0], y3[0]];
            for t in 0..len {
                // The node north of row k is the one east of row k + 1, and the node south of
                // row k + 1 is the one row k has just left.
                let (e0, e1, e2, e3) = (y0[t + 2], y1[t + 2], y2[t + 2], y3[t + 2]);
                let (s1, s2, s3) = (w0, w1, w2);
                w0 = interior(inverse, below[t], e1, e0, f0[t], w0);
                w1 = interior(inverse, s1, e2, e1, f1[t], w1);
                w2 = interior(inverse, s2, e3, e2, f2[t], w2);
                w3 = interior(inverse, s3, above[t], e3, f3[t], w3);
                (y0[t + 1], y1[t + 1], y2[t + 1], y3[t + 1]) = (w0, w1, w2, w3);
            }
        }
        for t in n..n + BAND - 1 {
            (t + 1 - n..BAND).for_each(|k| self.relax_inside(y, t - k, first + k));
        }
        (first..first + BAND).for_each(|j| self.relax(y, n, j));
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
            // With a proximal term, which the paper has not, node by node.
            let (mut plain, mut banded) = (start.clone(), start);
            let nodes = Nodes::new(grid, &load, shift, r, &a);
            for _ in 0..3 {
                for j in 0..=n {
                    for i in 0..=n {
                        nodes.relax(&mut plain, i, j);
                    }
                }
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
