//! The P1 stiffness matrix (5) as a five-point stencil, never stored, and as a network.
//!
//! On right triangles the diagonals drop out: an interior row reads 4 / -1, an edge row 2 on the
//! diagonal, -1/2 along the edge and -1 inward, a corner row 1 and -1/2. Rows do not depend on `h`.

use super::network::{Coupling, Network};
use crate::discrete::grid::Grid;
use crate::problem::law::{ContactNode, Law};

/// Writes row `j` of `A y - load` to `out`, of length `grid.side()`.
///
/// With `load = F` this is the gradient of the energy (1), and on the boundary the discrete flux.
///
/// # Panics
/// If `y` or `load` is not a nodal vector, or `out` not one row of one.
pub fn residual_row(grid: Grid, j: usize, y: &[f64], load: &[f64], out: &mut [f64]) {
    let (n, side) = (grid.cells(), grid.side());
    let row = |v: usize| v * side..(v + 1) * side;
    // Slices of one known length let the compiler drop the bounds checks and vectorise. Additions are in the order of
    // [`Network`](crate::discrete::network::Network).
    let (here, f, out) = (&y[row(j)], &load[row(j)], &mut out[..side]);
    if j == 0 || j == n {
        let inward = &y[row(if j == 0 { 1 } else { n - 1 })];
        out[0] = here[0] - ((f[0] + 0.5 * here[1]) + 0.5 * inward[0]);
        for i in 1..n {
            let sum = ((f[i] + 0.5 * here[i + 1]) + inward[i]) + 0.5 * here[i - 1];
            out[i] = 2.0 * here[i] - sum;
        }
        out[n] = here[n] - ((f[n] + 0.5 * inward[n]) + 0.5 * here[n - 1]);
    } else {
        let (below, above) = (&y[row(j - 1)], &y[row(j + 1)]);
        out[0] = 2.0 * here[0] - (((f[0] + here[1]) + 0.5 * above[0]) + 0.5 * below[0]);
        for i in 1..n {
            let sum = (((f[i] + here[i + 1]) + above[i]) + below[i]) + here[i - 1];
            out[i] = 4.0 * here[i] - sum;
        }
        out[n] = 2.0 * here[n] - (((f[n] + 0.5 * above[n]) + 0.5 * below[n]) + here[n - 1]);
    }
}

impl Network {
    /// Network of the five-point matrix of the square: the paper's triangulation, with nodes and boundary nodes in the
    /// order of [`Grid`].
    pub fn of_square(grid: Grid, law: Law) -> Self {
        Self::uniform(grid.cells(), grid.contact_nodes(law))
    }

    /// Network of the five-point matrix with `n` cells per side, with all boundary nodes in contact. Their measures are
    /// in cells, as many as the halves of sides around the node.
    pub(crate) fn of_stencil(n: usize) -> Self {
        let mut network = Self::uniform(n, Vec::new());
        let mut contact = Vec::with_capacity(4 * n);
        for (node, entry) in network.diagonal().iter().enumerate() {
            let share = entry / 4.0;
            if share < 1.0 {
                let measure = 2.0 * share * sides(share);
                contact.push(ContactNode { node, measure, law: Law::SIGNORINI });
            }
        }
        network.set_boundary(contact);
        network
    }

    /// Network of the five-point matrix with `n` cells per side, x fastest.
    ///
    /// Neighbours inside are coupled by 1, neighbours on the boundary by 1/2, the part of their cells inside.
    fn uniform(n: usize, contact: Vec<ContactNode>) -> Self {
        let share = |i: usize| if i == 0 || i == n { 0.5 } else { 1.0 };
        let area = 1.0 / n.pow(2) as f64;
        let (mut couplings, mut masses) = (Vec::new(), Vec::new());
        for j in 0..=n {
            for i in 0..=n {
                let node = (j * (n + 1) + i) as u32;
                masses.push(share(i) * share(j) * area);
                if i < n {
                    couplings.push(Coupling { nodes: [node, node + 1], weight: share(j) });
                }
                if j < n {
                    let above = node + n as u32 + 1;
                    couplings.push(Coupling { nodes: [node, above], weight: share(i) });
                }
            }
        }
        Self::new(&couplings, contact, masses)
    }
}

/// Number of sides of the square on which a node lies whose cell has this share inside: 1/2, or 1/4 in a corner.
#[inline(always)]
pub(crate) fn sides(share: f64) -> f64 {
    if share == 0.5 { 1.0 } else { 2.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::kkt::judge;
    use crate::discrete::network::Row;
    use crate::problem::law::Law;

    /// Element by element assembly of (5), the textbook way, for either diagonal of the squares.
    fn assembled_times(grid: Grid, y: &[f64], rising: bool) -> Vec<f64> {
        let mut out = vec![0.0; grid.nodes()];
        for j in 0..grid.cells() {
            for i in 0..grid.cells() {
                let [ll, lr, ul, ur] =
                    [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| grid.index(i, j));
                // (right-angle vertex, its neighbour along x, its neighbour along y)
                let triangles = if rising {
                    [(lr, ll, ur), (ul, ur, ll)]
                } else {
                    [(ll, lr, ul), (ur, ul, lr)]
                };
                for (p, qx, qy) in triangles {
                    for (q, d) in [(qx, y[p] - y[qx]), (qy, y[p] - y[qy])] {
                        out[p] += 0.5 * d;
                        out[q] -= 0.5 * d;
                    }
                }
            }
        }
        out
    }

    #[test]
    fn stencil_is_the_assembled_matrix_for_both_diagonals() {
        let grid = Grid::new(5).unwrap();
        let y: Vec<f64> = (0..grid.nodes()).map(|k| ((k * k) % 17) as f64).collect();
        let mut ours = vec![0.0; grid.nodes()];
        for (j, row) in ours.chunks_exact_mut(grid.side()).enumerate() {
            residual_row(grid, j, &y, &vec![0.0; grid.nodes()], row);
        }
        assert_eq!(ours, assembled_times(grid, &y, true));
        assert_eq!(ours, assembled_times(grid, &y, false));
    }

    #[test]
    fn energy_is_half_the_form_less_the_load() {
        let grid = Grid::new(3).unwrap();
        let y: Vec<f64> = (0..grid.nodes()).map(|k| k as f64).collect();
        let load = vec![2.0; grid.nodes()];
        let ay = assembled_times(grid, &y, true);
        let want: f64 = y.iter().zip(&ay).map(|(y, ay)| y * (0.5 * ay - 2.0)).sum();
        let energy = judge((grid, Law::SIGNORINI), &y, &load).energy;
        assert!((energy - want).abs() < 1e-12);
    }

    #[test]
    fn rows_of_the_square_are_those_of_the_paper() {
        let network = Network::of_square(Grid::new(4).unwrap(), Law::SIGNORINI);
        let row = |node: usize| {
            let Row { others, weights } = network.row(node);
            (network.diagonal()[node], others.to_vec(), weights.to_vec())
        };
        assert_eq!(row(12), (4.0, vec![13, 17, 7, 11], vec![1.0; 4]));
        assert_eq!(row(2), (2.0, vec![3, 7, 1], vec![0.5, 1.0, 0.5]));
        assert_eq!(row(24), (1.0, vec![19, 23], vec![0.5; 2]));
        assert_eq!(network.masses().iter().sum::<f64>(), 1.0);
    }
}
