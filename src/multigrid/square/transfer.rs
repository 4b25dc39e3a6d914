//! Bilinear prolongation and its transpose, full weighting, row by row.
//!
//! Both act between red and black rows. Only black values are prolongated, since the half-sweep that
//! follows replaces all red ones; only red residuals are restricted, since black ones vanish after a
//! half-sweep over the black nodes.

use super::level::Level;
use super::stencil::{Boundary, Row, perimeter};
use crate::multigrid::rows::{
    Colour, Rows, deinterleave, interleave, long_and_short, stride, worse,
};

/// The two coarse rows in row-major order that prolongation to one fine row needs.
pub(super) struct CoarseRows<'a> {
    coarse: &'a [Rows; 2],
    rows: [Vec<f64>; 2],
    /// Which coarse row each buffer holds.
    held: [usize; 2],
}

impl<'a> CoarseRows<'a> {
    /// `coarse_n` is the number of cells in a coarse row.
    pub(super) fn new(coarse_n: usize, coarse: &'a [Rows; 2]) -> Self {
        let rows = [vec![0.0; coarse_n + 1], vec![0.0; coarse_n + 1]];
        Self { coarse, rows, held: [usize::MAX; 2] }
    }

    #[inline(always)]
    fn fetch(&mut self, coarse_j: usize) {
        let buffer = coarse_j % 2;
        if self.held[buffer] == coarse_j {
            return;
        }
        let stride = stride(self.rows[buffer].len() - 1);
        let row = coarse_j * stride..(coarse_j + 1) * stride;
        let [red, black] = [&self.coarse[0][row.clone()], &self.coarse[1][row]];
        let [long, short] = long_and_short(coarse_j, [red, black]);
        interleave(long, short, &mut self.rows[buffer]);
        self.held[buffer] = coarse_j;
    }

    /// The two summands whose mean is the prolongation at each black node of fine row `j`.
    #[inline(always)]
    fn summands(&mut self, j: usize) -> (&[f64], &[f64]) {
        let lower = j / 2;
        self.fetch(lower);
        if j.is_multiple_of(2) {
            let row = &self.rows[lower % 2];
            (&row[..row.len() - 1], &row[1..])
        } else {
            self.fetch(lower + 1);
            (&self.rows[0], &self.rows[1])
        }
    }

    /// Sets the black row `j` to the prolongation.
    ///
    /// Coarse values are nonnegative on the boundary, hence so are their means.
    #[inline(always)]
    pub(super) fn interpolate(&mut self, j: usize, black: &mut [f64]) {
        let (one, two) = self.summands(j);
        for ((value, one), two) in black.iter_mut().zip(one).zip(two) {
            *value = 0.5 * (one + two);
        }
    }

    /// Adds `factor` times the prolongation to the black row `j`, except at nodes in contact; projects.
    #[inline(always)]
    pub(super) fn correct(
        &mut self,
        (n, j): (usize, usize),
        boundary: Boundary,
        factor: f64,
        black: &mut [f64],
    ) {
        let (half, weight) = (n / 2, 0.5 * factor);
        let (one, two) = self.summands(j);
        if j == 0 || j == n {
            for k in 0..half {
                let p = perimeter(n, 2 * k + 1, j);
                correct_edge(p, weight * (one[k] + two[k]), boundary, &mut black[k]);
            }
            return;
        }
        let mut inner = 0..half;
        if Colour::Black.first_column(j) == 0 {
            for (k, i) in [(0, 0), (half, n)] {
                let p = perimeter(n, i, j);
                correct_edge(p, weight * (one[k] + two[k]), boundary, &mut black[k]);
            }
            inner.start = 1;
        }
        let (one, two) = (&one[inner.clone()], &two[inner.clone()]);
        for ((value, one), two) in black[inner].iter_mut().zip(one).zip(two) {
            *value += weight * (one + two);
        }
    }
}

#[inline(always)]
fn correct_edge(node: usize, correction: f64, boundary: Boundary, value: &mut f64) {
    if boundary.is_free(node, *value) {
        *value = boundary.project(*value + correction);
    }
}

/// Collects residual rows and, from every three of them, makes one row of the coarse load.
pub(super) struct Restriction {
    /// Residuals of the last three red rows, row `j` in place `j % 3`.
    residuals: [Vec<f64>; 3],
    /// Zeros, in place of rows beyond the boundary.
    beyond: Vec<f64>,
    coarse: Vec<f64>,
    /// Largest natural residual met so far.
    pub(super) natural_residual: f64,
}

impl Restriction {
    /// `n` is the number of cells in a fine row.
    pub(super) fn new(n: usize) -> Self {
        let row = || vec![0.0; n / 2 + 1];
        Self {
            residuals: [row(), row(), row()],
            beyond: row(),
            coarse: row(),
            natural_residual: 0.0,
        }
    }

    /// Adds the residual of the red row; emits a coarse row when its three fine rows are complete.
    ///
    /// Rows must come in increasing order from `first` on. `coarse_load` returns the red and the
    /// black part of a row of the coarse load.
    #[inline(always)]
    pub(super) fn add_row<'b>(
        &mut self,
        row: Row,
        boundary: Boundary,
        red: &[f64],
        first: usize,
        coarse_load: impl FnOnce(usize) -> [&'b mut [f64]; 2],
    ) {
        let (n, j) = (row.n, row.j);
        let half = n / 2;
        let residual = &mut self.residuals[j % 3];
        residual.copy_from_slice(&red[..half + 1]);
        let natural = row.replace_by_residual(boundary, residual);
        self.natural_residual = worse(self.natural_residual, natural);

        let emitted = if j == n {
            n / 2
        } else if j % 2 == 1 && (j == 1 || j >= first + 2) {
            j / 2
        } else {
            return;
        };
        self.weigh(emitted, half);
        let [red, black] = coarse_load(emitted);
        let [long, short] = long_and_short(emitted, [red, black]);
        deinterleave(&self.coarse, long, short);
    }

    /// Full weighting into row `coarse_j`; the black neighbours have no residual.
    #[inline(always)]
    fn weigh(&mut self, coarse_j: usize, half: usize) {
        let j = 2 * coarse_j;
        let lower = if coarse_j > 0 { &self.residuals[(j + 2) % 3] } else { &self.beyond };
        let upper = if coarse_j < half { &self.residuals[(j + 1) % 3] } else { &self.beyond };
        weigh_red(&mut self.coarse, &self.residuals[j % 3], lower, upper);
    }
}

/// The red part of full weighting: the node itself and a quarter of its four diagonal neighbours.
#[inline(always)]
fn weigh_red(coarse: &mut [f64], middle: &[f64], lower: &[f64], upper: &[f64]) {
    let half = coarse.len() - 1;
    coarse[0] = middle[0] + 0.25 * (lower[0] + upper[0]);
    coarse[half] = middle[half] + 0.25 * (lower[half - 1] + upper[half - 1]);
    let (coarse, middle) = (&mut coarse[1..half], &middle[1..half]);
    let (lower_west, lower_east) = (&lower[..half - 1], &lower[1..half]);
    let (upper_west, upper_east) = (&upper[..half - 1], &upper[1..half]);
    for k in 0..half - 1 {
        let diagonals = (lower_west[k] + lower_east[k]) + (upper_west[k] + upper_east[k]);
        coarse[k] = middle[k] + 0.25 * diagonals;
    }
}

/// The black part of full weighting: half of the four nearest neighbours.
fn weigh_black(coarse: &mut [f64], along: &[f64], below: &[f64], above: &[f64]) {
    let half = coarse.len() - 1;
    coarse[0] += 0.5 * (along[0] + (below[0] + above[0]));
    coarse[half] += 0.5 * (along[half - 1] + (below[half] + above[half]));
    let (coarse, below, above) = (&mut coarse[1..half], &below[1..half], &above[1..half]);
    let (west, east) = (&along[..half - 1], &along[1..half]);
    for k in 0..half - 1 {
        coarse[k] += 0.5 * ((west[k] + east[k]) + (below[k] + above[k]));
    }
}

/// Writes row `coarse_j` of the load of the coarser grid, row-major: full weighting of all nodes.
pub(super) fn weigh_load(fine: &Level, coarse_j: usize, coarse: &mut [f64]) {
    let (n, stride) = (fine.n, fine.stride());
    let beyond = vec![0.0; stride];
    let row = |colour: Colour, j: usize| match j <= n {
        true => &fine.load[colour as usize][j * stride..(j + 1) * stride],
        false => &beyond[..],
    };
    let j = 2 * coarse_j;
    let (below, above) = (j.wrapping_sub(1), j + 1);
    let red = |j| row(Colour::Red, j);
    let black = |j| row(Colour::Black, j);
    weigh_red(coarse, red(j), red(below), red(above));
    weigh_black(coarse, black(j), black(below), black(above));
}
