//! The scalar Signorini problem on the cube (-1/2, 1/2)^3: grid, seven-point stencil, load, conditions.
//!
//! Everything here is a plain loop over nodes, written apart from the solvers in
//! [`multigrid::cube`](crate::multigrid::cube), so that it can judge them.

mod load;
mod norms;

pub use load::{exact_load, integral, integrals};
pub use norms::errors;

use crate::discrete::grid::{GridError, MIN_CELLS};
use crate::discrete::kkt::{Judge, JudgedValues, Judgement};
use crate::problem::law::{ContactNode, Law};

/// The uniform grid with `n` cells of width `h = 1/n` along each side.
///
/// A *nodal vector* has `(n + 1)^3` entries, x fastest, z slowest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    n: usize,
}

impl Grid {
    /// The grid with `n` cells per side.
    ///
    /// # Errors
    /// [`GridError::TooCoarse`] if `n` is below [`MIN_CELLS`].
    pub fn new(n: usize) -> Result<Self, GridError> {
        if n < MIN_CELLS { Err(GridError::TooCoarse(n)) } else { Ok(Self { n }) }
    }

    /// Cells per side.
    pub fn cells(self) -> usize {
        self.n
    }

    /// Length of a nodal vector.
    pub fn nodes(self) -> usize {
        (self.n + 1).pow(3)
    }

    /// Area of the boundary.
    pub const PERIMETER: f64 = 6.0;

    /// Mesh width.
    pub fn h(self) -> f64 {
        1.0 / self.n as f64
    }

    /// Coordinate of the `i`-th grid plane, in [-1/2, 1/2].
    pub fn coordinate(self, i: usize) -> f64 {
        i as f64 / self.n as f64 - 0.5
    }

    /// Indices along x, y and z of each node, in the order of a nodal vector.
    pub fn indices(self) -> impl Iterator<Item = [usize; 3]> + Clone {
        let range = 0..=self.n;
        let planes = range.clone().flat_map(move |k| range.clone().map(move |j| (j, k)));
        planes.flat_map(move |(j, k)| (0..=self.n).map(move |i| [i, j, k]))
    }

    /// Positions of the boundary nodes in a nodal vector.
    pub fn boundary(self) -> Vec<usize> {
        self.contact_nodes().iter().map(|contact| contact.node).collect()
    }

    /// Boundary nodes in the order of a nodal vector. Their measures are h^2 on faces, half of it on each of the two that
    /// meet in edges, a quarter on each of the three in corners.
    pub fn contact_nodes(self) -> Vec<ContactNode> {
        let (n, side) = (self.n, self.n + 1);
        let mut nodes = Vec::with_capacity(6 * n * n + 2);
        for row in 0..side * side {
            let [j, k] = [row % side, row / side];
            let step = if j % n > 0 && k % n > 0 { n } else { 1 };
            for i in (0..side).step_by(step) {
                let faces = [i, j, k].iter().filter(|&&index| index % n == 0).count();
                // Of the cell around the node, each face halves the part inside, and the part of the other faces.
                let measure = 2.0 * faces as f64 * self.share([i, j, k]) * self.h().powi(2);
                nodes.push(ContactNode { node: row * side + i, measure });
            }
        }
        nodes
    }

    /// Part of the cell around a node that lies inside the cube: 1, on faces 1/2, edges 1/4, corners 1/8.
    pub fn share(self, indices: [usize; 3]) -> f64 {
        indices.iter().map(|&i| self.share_along(i)).product()
    }

    fn share_along(self, i: usize) -> f64 {
        if i == 0 || i == self.n { 0.5 } else { 1.0 }
    }
}

/// The load vector `F_i = f(M_i) h^3`, on faces, edges and corners times 1/2, 1/4, 1/8.
pub fn load(grid: Grid, f: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let volume = grid.h().powi(3);
    let at =
        |indices: [usize; 3]| f(indices.map(|i| grid.coordinate(i))) * grid.share(indices) * volume;
    grid.indices().map(at).collect()
}

/// Writes the row of `A y - load` at these indices along y and z to `out`, of length `n + 1`: the gradient of the
/// energy, for the trapezoidal (lumped) seven-point stencil.
///
/// Neighbours are coupled by `h`, within faces by `h / 2`, along edges by `h / 4`.
///
/// # Panics
/// If `y` or `load` is not a nodal vector, or `out` not one row of one.
fn residual_row(grid: Grid, [j, k]: [usize; 2], y: &[f64], load: &[f64], out: &mut [f64]) {
    let (n, side) = (grid.n, grid.n + 1);
    let row = |j: usize, k: usize| &y[(k * side + j) * side..][..side];
    let (here, load) = (row(j, k), &load[(k * side + j) * side..][..side]);
    // Where there is no neighbour, the node itself takes its place: nothing flows.
    let [south, north] = [row(j.saturating_sub(1), k), row((j + 1).min(n), k)];
    let [below, above] = [row(j, k.saturating_sub(1)), row(j, (k + 1).min(n))];
    let [of_y, of_z] = [j, k].map(|index| grid.share_along(index));
    let out = &mut out[..side];
    let at = |i: usize, west: usize, east: usize, of_x: f64| {
        let value = here[i];
        let mut flow = of_y * of_z * (value - here[west]) + of_y * of_z * (value - here[east]);
        flow = flow + of_x * of_z * (value - south[i]) + of_x * of_z * (value - north[i]);
        flow = flow + of_x * of_y * (value - below[i]) + of_x * of_y * (value - above[i]);
        grid.h() * flow - load[i]
    };
    out[0] = at(0, 0, 1, 0.5);
    for (i, out) in out.iter_mut().enumerate().take(n).skip(1) {
        *out = at(i, i - 1, i + 1, 1.0);
    }
    out[n] = at(n, n - 1, n, 0.5);
}

/// Judges the nodal vector `y`, as [`kkt::judge`](crate::discrete::kkt::judge) does on the square; the multiplier of
/// a node is `A y - F` over its [part of the boundary](Grid::contact_nodes).
///
/// # Panics
/// If a slice is not of length `grid.nodes()`.
pub fn judge(grid: Grid, law: Law, y: &[f64], load: &[f64]) -> Judgement {
    assert!(y.len() == grid.nodes() && load.len() == grid.nodes());
    let (n, side) = (grid.n, grid.n + 1);
    let (mut judge, mut gradient, mut flux) = (Judge::default(), vec![0.0; side], Vec::new());
    let rows = y.chunks_exact(side).zip(load.chunks_exact(side));
    for (row, (y_row, load_row)) in rows.enumerate() {
        let at = [row % side, row / side];
        residual_row(grid, at, y, load, &mut gradient);
        let inner = at.iter().all(|index| index % n > 0);
        judge.see(y_row, &gradient, load_row, inner);
        match inner {
            true => flux.extend([gradient[0], gradient[n]]),
            false => flux.extend_from_slice(&gradient),
        }
    }
    judge.judgement(JudgedValues { law, cells: n, y, contact: grid.contact_nodes(), flux })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stencil_is_exact_for_quadratics_and_their_fluxes() {
        // -Laplacian of x^2 + 2 y^2 - 4 z^2 is 2; on a face, h^2 times the outward slope remains.
        let grid = Grid::new(4).unwrap();
        let at = |p: [f64; 3]| p[0] * p[0] + 2.0 * p[1] * p[1] - 4.0 * p[2] * p[2] + p[0];
        let y: Vec<_> =
            grid.indices().map(|indices| at(indices.map(|i| grid.coordinate(i)))).collect();
        let load = load(grid, |_| 2.0);
        let mut flux = vec![0.0; grid.nodes()];
        for (row, out) in flux.chunks_exact_mut(5).enumerate() {
            residual_row(grid, [row % 5, row / 5], &y, &load, out);
        }
        for (node, [i, j, k]) in grid.indices().enumerate() {
            let slope = match (i, j, k) {
                (4, 1..4, 1..4) | (1..4, 0 | 4, 1..4) => 2.0,
                (1..4, 1..4, 0 | 4) => -4.0,
                (0..4, 1..4, 1..4) => 0.0,
                _ => continue,
            };
            assert!((flux[node] - slope / 16.0).abs() < 1e-15, "{i} {j} {k} {}", flux[node]);
        }
        assert!((load.iter().sum::<f64>() - 2.0).abs() < 1e-15);
    }

    #[test]
    fn each_violation_is_seen() {
        let grid = Grid::new(2).unwrap();
        let load = load(grid, |_| -1.0);
        let mut y = vec![0.0; 27];
        y[13] = -0.125 / 3.0;
        assert!(judge(grid, Law::SIGNORINI, &y, &load).kkt.natural < 1e-16);
        y[13] = 0.0;
        assert_eq!(judge(grid, Law::SIGNORINI, &y, &load).kkt.stationarity, 0.125);
        y[4] = -1.0;
        assert_eq!(judge(grid, Law::SIGNORINI, &y, &load).kkt.min_y, -1.0);
        y[4] = f64::NAN;
        assert!(judge(grid, Law::SIGNORINI, &y, &load).kkt.natural.is_nan());
    }
}
