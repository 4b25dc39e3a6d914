//! Load vectors on the cube: the integrals of f times the trilinear hat functions.

use super::{Grid, load};
use crate::discrete::cells::{CutCube, Rows};
use crate::discrete::sampled::{sampled, tetrahedra};
use crate::problem::cube::{Body, Source};
use rayon::prelude::*;

/// The integral of f over the cube: exact for constant pieces, sampled for smooth f.
pub fn integral(f: &Source) -> f64 {
    match f {
        Source::Pieces { background, pieces } => {
            // Any grid will do, best one with few pieces in each cell.
            let n = pieces.len().clamp(2, 16).next_power_of_two();
            let cells = Planes { n, background: *background, pieces };
            // The parts are scaled before the sum, which huge values would overflow.
            let volume = 1.0 / n.pow(3) as f64;
            let plane = |k: usize| {
                let mut sum = 0.0;
                let mut rows = cells.rows();
                let (mut values, mut cell) = (vec![0.0; n], CutCube::default());
                for j in 0..n {
                    rows.row([j, k], &mut values, |_, background, pieces| {
                        cell.set(background, pieces);
                        sum += volume * cell.integral();
                    });
                    sum += values.iter().map(|value| volume * value).sum::<f64>();
                }
                sum
            };
            (0..n).into_par_iter().map(plane).collect::<Vec<_>>().iter().sum()
        }
        Source::Exact(_) | Source::Formula(_) => integrals(f)[0],
    }
}

/// The integrals over the cube of f and of |f|; no numbers if a smooth f is not finite at some point.
pub fn integrals(f: &Source) -> [f64; 2] {
    if !f.is_smooth() {
        return [integral(f), integral(&f.absolute())];
    }
    let found = sampled(&tetrahedra(), &|point| f.at(point));
    found.map_or([f64::NAN; 2], |of| [of.integral, of.size])
}

/// The load vector of f, a nodal vector, the same whatever the number of threads: for constant pieces the integrals
/// of f times the trilinear hats, for smooth f the values at the nodes times the integrals of the hats.
pub fn exact_load(grid: Grid, f: &Source) -> Vec<f64> {
    let Source::Pieces { background, pieces } = f else {
        return load(grid, |point| f.at(point));
    };
    let n = grid.cells();
    let cells = Planes { n, background: *background, pieces };
    let cut: Vec<_> = (0..n).into_par_iter().map(|k| cells.cut(k)).collect();
    let volume = grid.h().powi(3);
    let side = n + 1;
    let mut load = vec![0.0; grid.nodes()];
    load.par_chunks_mut(side * side).enumerate().for_each(|(k, plane)| {
        // Values of f on the cells below and above the plane; 0 where there are none.
        let sides = [(k > 0).then(|| cells.values(k - 1)), (k < n).then(|| cells.values(k))];
        let mut around = vec![0.0; n];
        for (j, row) in plane.chunks_exact_mut(side).enumerate() {
            around.fill(0.0);
            for values in sides.iter().flatten() {
                for j in j.saturating_sub(1)..(j + 1).min(n) {
                    let of_row = &values[j * n..][..n];
                    around.iter_mut().zip(of_row).for_each(|(sum, value)| *sum += value);
                }
            }
            for i in 1..n {
                row[i] = volume / 8.0 * (around[i - 1] + around[i]);
            }
            (row[0], row[n]) = (volume / 8.0 * around[0], volume / 8.0 * around[n - 1]);
        }
        for (above, cells) in [(4, k.checked_sub(1)), (0, Some(k).filter(|&k| k < n))] {
            for &([i, j], corners) in cells.iter().flat_map(|&k| &cut[k]) {
                for corner in 0..4 {
                    plane[(j + corner / 2) * side + i + corner % 2] +=
                        volume * corners[above + corner];
                }
            }
        }
    });
    load
}

/// The cells of the cube, n along each side.
struct Planes<'a> {
    n: usize,
    background: f64,
    pieces: &'a [(Body, f64)],
}

impl Planes<'_> {
    fn rows(&self) -> Rows<'_, Body, 2> {
        let lines = (0..=self.n).map(|i| i as f64 / self.n as f64 - 0.5).collect();
        Rows::new(lines, self.background, self.pieces)
    }

    /// f on the cells of a plane; 0 where it is not constant.
    fn values(&self, k: usize) -> Vec<f64> {
        let (mut rows, mut values) = (self.rows(), vec![0.0; self.n * self.n]);
        for (j, row) in values.chunks_exact_mut(self.n).enumerate() {
            rows.row([j, k], row, |_, _, _| ());
        }
        values
    }

    /// The cells of a plane on which f is not constant, and the integrals there of f times the hats.
    fn cut(&self, k: usize) -> Vec<([usize; 2], [f64; 8])> {
        let (mut rows, mut values) = (self.rows(), vec![0.0; self.n]);
        let (mut cell, mut cut) = (CutCube::default(), Vec::new());
        for j in 0..self.n {
            rows.row([j, k], &mut values, |i, background, pieces| {
                cell.set(background, pieces);
                cut.push(([i, j], cell.corners()));
            });
        }
        cut
    }
}
