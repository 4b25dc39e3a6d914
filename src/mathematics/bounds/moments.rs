//! Moments of the right-hand side over a cell.

use crate::discrete::cells::{Cut, bilinear};
use crate::discrete::grid::Grid;

/// Integrals over one cell of f times polynomials in X and Y, the coordinates that run from -1/2 to 1/2
/// there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moments<T = f64> {
    pub one: T,
    pub x: T,
    pub y: T,
    pub xy: T,
    pub xx: T,
    pub yy: T,
    pub xxy: T,
    pub xyy: T,
    /// Of `min(x, y) (1 - max(x, y))`, `x = X + 1/2`: the piecewise linear function on triangles less the
    /// bilinear one, where the second difference over the cell is 1.
    pub ridge: T,
    /// Of f itself, times `h^2`.
    pub square: T,
}

impl<T> Moments<T> {
    /// Lets each moment take its part of `other` into account.
    #[inline(always)]
    pub(super) fn each<U: Copy>(&mut self, other: &Moments<U>, take: impl Fn(&mut T, U)) {
        take(&mut self.one, other.one);
        take(&mut self.x, other.x);
        take(&mut self.y, other.y);
        take(&mut self.xy, other.xy);
        take(&mut self.xx, other.xx);
        take(&mut self.yy, other.yy);
        take(&mut self.xxy, other.xxy);
        take(&mut self.xyy, other.xyy);
        take(&mut self.ridge, other.ridge);
        take(&mut self.square, other.square);
    }
}

impl<const N: usize> Moments<[f64; N]> {
    /// The moments in lane `k`.
    #[inline(always)]
    pub(super) fn lane(&self, k: usize) -> Moments {
        Moments {
            one: self.one[k],
            x: self.x[k],
            y: self.y[k],
            xy: self.xy[k],
            xx: self.xx[k],
            yy: self.yy[k],
            xxy: self.xxy[k],
            xyy: self.xyy[k],
            ridge: self.ridge[k],
            square: self.square[k],
        }
    }
}

impl Moments {
    /// Those of a constant f, from its integral.
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

    /// The integral of f times the bubbles on both edges along x, blended over the cell, and what the upper one has
    /// more than the lower one; the same along y.
    #[inline(always)]
    pub(super) fn blended(&self) -> [[f64; 2]; 2] {
        [
            [0.25 * self.one - self.xx, 0.25 * self.y - self.xxy],
            [0.25 * self.one - self.yy, 0.25 * self.x - self.xyy],
        ]
    }

    /// The integral of f times the bubbles on the edges along x and along y.
    #[inline(always)]
    pub(super) fn bubbles(&self, [x, y]: [[f64; 2]; 2]) -> f64 {
        let [along_x, along_y] = self.blended();
        (mean(x) * along_x[0] + difference(x) * along_x[1])
            + (mean(y) * along_y[0] + difference(y) * along_y[1])
    }

    /// `h^2` times the square of the L2 norm of f less its best bilinear approximation.
    #[inline(always)]
    pub(super) fn oscillation(&self) -> f64 {
        let bilinear = self.one * self.one
            + 12.0 * (self.x * self.x + self.y * self.y)
            + 144.0 * self.xy * self.xy;
        (self.square - bilinear).max(0.0)
    }

    /// Those over a cell that jumps of f cut.
    pub(super) fn of_cut(grid: Grid, cell: &mut Cut) -> Self {
        let triangles = cell.triangles(true).map(|moments| (moments.f, moments.square));
        let sum = |k: usize| triangles[0].0[k] + triangles[1].0[k];
        // Below the rising diagonal the ridge is (Y + 1/2) (1/2 - X), above it the other way round.
        let ridge = |[one, x, y, xy, ..]: [f64; 8]| 0.25 * one + 0.5 * (y - x) - xy;
        let [below, above] = triangles.map(|(f, _)| f);
        let flipped = [above[0], above[2], above[1], above[3], 0.0, 0.0, 0.0, 0.0];
        let h2 = grid.h() * grid.h();
        let [one, x, y, xy, xx, yy, xxy, xyy] = std::array::from_fn(|k| h2 * sum(k));
        let ridge = h2 * (ridge(below) + ridge(flipped));
        let square = h2 * h2 * (triangles[0].1 + triangles[1].1);
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

#[inline(always)]
pub(super) fn mean(pair: [f64; 2]) -> f64 {
    0.5 * (pair[0] + pair[1])
}

#[inline(always)]
pub(super) fn difference(pair: [f64; 2]) -> f64 {
    pair[1] - pair[0]
}
