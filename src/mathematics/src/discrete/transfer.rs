//! Prolongation of nodal and boundary vectors to the grid of half the width.

use crate::discrete::grid::Grid;
use crate::problem::choices::choices;
use serde::{Deserialize, Serialize};
use std::ops::{Add, Mul};

/// Rule by which a node at the centre of a coarse cell gets its value; elsewhere all rules agree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Prolongation {
    /// Mean of the four corners of the cell.
    #[default]
    Bilinear,
    /// P1 on triangles cut from lower left to upper right: mean of those two corners.
    RisingDiagonal,
    /// P1 on triangles cut from upper left to lower right.
    FallingDiagonal,
}

choices!(Prolongation, 3:
    Bilinear = "bilinear", RisingDiagonal = "rising-diagonal",
    FallingDiagonal = "falling-diagonal",
);

/// Prolongs the nodal vector `coarse`, of numbers or of one for each of several problems, to the grid with twice the
/// cells per side.
///
/// # Panics
/// If `coarse.len() != grid.nodes()`.
pub fn prolong<T>(grid: Grid, coarse: &[T], rule: Prolongation) -> Vec<T>
where
    T: Copy + Default + Add<Output = T> + Mul<f64, Output = T>,
{
    assert_eq!(coarse.len(), grid.nodes());
    let (n, side) = (grid.cells(), 2 * grid.cells() + 1);
    let mut fine = vec![T::default(); side * side];
    let at = |i: usize, j: usize| coarse[grid.index(i, j)];
    for j in 0..=n {
        for i in 0..=n {
            let k = 2 * j * side + 2 * i;
            fine[k] = at(i, j);
            if i < n {
                fine[k + 1] = (at(i, j) + at(i + 1, j)) * 0.5;
            }
            if j < n {
                fine[k + side] = (at(i, j) + at(i, j + 1)) * 0.5;
            }
            if i < n && j < n {
                let rising = at(i, j) + at(i + 1, j + 1);
                let falling = at(i + 1, j) + at(i, j + 1);
                fine[k + side + 1] = match rule {
                    Prolongation::Bilinear => (rising + falling) * 0.25,
                    Prolongation::RisingDiagonal => rising * 0.5,
                    Prolongation::FallingDiagonal => falling * 0.5,
                };
            }
        }
    }
    fine
}

/// Prolongs the boundary vector `coarse` linearly along the boundary, which is closed.
pub fn prolong_boundary<T>(coarse: &[T]) -> Vec<T>
where
    T: Copy + Default + Add<Output = T> + Mul<f64, Output = T>,
{
    let next = coarse.iter().cycle().skip(1);
    coarse.iter().zip(next).flat_map(|(&a, &b)| [a, (a + b) * 0.5]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_functions_are_prolonged_exactly_by_every_rule() {
        let linear = |g: Grid| -> Vec<f64> {
            let s = g.side();
            (0..g.nodes())
                .map(|k| 3.0 * g.coordinate(k % s) - 2.0 * g.coordinate(k / s) + 0.5)
                .collect()
        };
        let (coarse, fine) = (Grid::new(4).unwrap(), Grid::new(8).unwrap());
        for rule in
            [Prolongation::Bilinear, Prolongation::RisingDiagonal, Prolongation::FallingDiagonal]
        {
            assert_eq!(prolong(coarse, &linear(coarse), rule), linear(fine));
        }
    }

    #[test]
    fn rules_differ_at_cell_centres_only() {
        let grid = Grid::new(2).unwrap();
        let mut spike = vec![0.0; grid.nodes()];
        spike[0] = 1.0;
        let centre = |rule| prolong(grid, &spike, rule)[6];
        assert_eq!(centre(Prolongation::Bilinear), 0.25);
        assert_eq!(centre(Prolongation::RisingDiagonal), 0.5);
        assert_eq!(centre(Prolongation::FallingDiagonal), 0.0);
    }

    #[test]
    fn boundary_prolongation_closes_the_loop() {
        assert_eq!(prolong_boundary(&[0.0, 2.0, 4.0]), [0.0, 1.0, 2.0, 3.0, 4.0, 2.0]);
    }
}
