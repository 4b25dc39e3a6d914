//! Moments of the right-hand side over a cell.

use crate::discrete::cells::{SweepCut, bilinear};
use crate::discrete::grid::Grid;

/// Integrals over one cell of f times polynomials in X and Y, coordinates from -1/2 to 1/2 in the cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellMoments {
    pub one: f64,
    pub x: f64,
    pub y: f64,
    pub xy: f64,
    pub xx: f64,
    pub yy: f64,
    pub xxy: f64,
    pub xyy: f64,
    /// Integral of f times the ridge `min(x, y) (1 - max(x, y))`, `x = X + 1/2`, `y = Y + 1/2`: the piecewise linear
    /// function on triangles less the bilinear one, where the mixed second difference over the cell is 1.
    pub ridge: f64,
    /// Integral of the square of f, times `h^2`.
    pub square: f64,
}

impl CellMoments {
    /// Moments of a constant f with the integral `mass`.
    #[inline(always)]
    pub(super) fn constant(mass: f64) -> Self {
        let twelfth = mass / 12.0;
        let square = mass * mass;
        Self { one: mass, xx: twelfth, yy: twelfth, ridge: twelfth, square, ..Self::default() }
    }

    /// Integrals of f times the bilinear hat functions of the corners ll, lr, ul, ur.
    pub(super) fn masses(&self) -> [f64; 4] {
        bilinear([self.one, self.x, self.y, self.xy])
    }

    /// Integrals of f times the bubbles on the edges along x, and along y, blended over the cell.
    #[inline(always)]
    pub(super) fn blended(&self) -> [BubbleLoad; 2] {
        [
            BubbleLoad {
                sum: 0.25 * self.one - self.xx,
                half_difference: 0.25 * self.y - self.xxy,
            },
            BubbleLoad {
                sum: 0.25 * self.one - self.yy,
                half_difference: 0.25 * self.x - self.xyy,
            },
        ]
    }

    /// Integral of f times the sum of the bubbles with these coefficients on the edges along x and along y.
    #[inline(always)]
    pub(super) fn bubbles(&self, [x, y]: [[f64; 2]; 2]) -> f64 {
        let [along_x, along_y] = self.blended();
        (mean(x) * along_x.sum + difference(x) * along_x.half_difference)
            + (mean(y) * along_y.sum + difference(y) * along_y.half_difference)
    }

    /// `h^2` times the square of the L2 norm of f less its best bilinear approximation.
    #[inline(always)]
    pub(super) fn oscillation(&self) -> f64 {
        let bilinear = self.one * self.one
            + 12.0 * (self.x * self.x + self.y * self.y)
            + 144.0 * self.xy * self.xy;
        (self.square - bilinear).max(0.0)
    }

    /// Moments over a cell that jumps of f cut.
    pub(super) fn from_cut(grid: Grid, cell: &mut SweepCut) -> Self {
        let [below, above] = cell.triangles(true);
        let h2 = grid.h() * grid.h();
        let [one, x, y, xy, xx, yy, xxy, xyy] =
            std::array::from_fn(|k| h2 * (below.f[k] + above.f[k]));
        let [above_one, above_x, above_y, above_xy, ..] = above.f;
        let flipped = ridge_below([above_one, above_y, above_x, above_xy]);
        let [one_below, x_below, y_below, xy_below, ..] = below.f;
        let ridge = h2 * (ridge_below([one_below, x_below, y_below, xy_below]) + flipped);
        let square = h2 * h2 * (below.square + above.square);
        Self { one, x, y, xy, xx, yy, xxy, xyy, ridge, square }
    }

    /// Adds `mass` concentrated at (X, Y), where f times `h^2` is `value`.
    pub(super) fn add(&mut self, [x, y]: [f64; 2], mass: f64, value: f64) {
        let (right, up) = (x + 0.5, y + 0.5);
        self.one += mass;
        self.x += mass * x;
        self.y += mass * y;
        self.xy += mass * x * y;
        self.xx += mass * x * x;
        self.yy += mass * y * y;
        self.xxy += mass * x * x * y;
        self.xyy += mass * x * y * y;
        self.ridge += mass * right.min(up) * (1.0 - right.max(up));
        self.square += mass * value;
    }
}

/// Integrals of f times the bubbles on two opposite edges, blended over the cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct BubbleLoad {
    /// Sum over both bubbles.
    pub sum: f64,
    /// Half the difference, upper or right bubble less lower or left one.
    pub half_difference: f64,
}

/// Integral of f times the ridge over the triangle below the rising diagonal, `(Y + 1/2) (1/2 - X)` there, from the
/// moments of 1, X, Y and XY. Above the diagonal X and Y are exchanged.
fn ridge_below([one, x, y, xy]: [f64; 4]) -> f64 {
    0.25 * one + 0.5 * (y - x) - xy
}

#[inline(always)]
pub(super) fn mean(pair: [f64; 2]) -> f64 {
    0.5 * (pair[0] + pair[1])
}

#[inline(always)]
pub(super) fn difference(pair: [f64; 2]) -> f64 {
    pair[1] - pair[0]
}
