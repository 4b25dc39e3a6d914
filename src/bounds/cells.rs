//! Sums over cells: energies of the vector and of its recovery, and the distance of the latter to the flux.

use super::data::Moments;
use super::recovery::{EdgeRow, NodeRow};
use std::f64::consts::PI;
use std::ops::Range;

/// Sums over cells. Gradients are in units of differences: in two dimensions h drops out.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// `|grad w - sigma|^2` with the oscillation of f.
    pub distance: f64,
    /// `|grad w|^2`, w the recovery.
    pub recovered: f64,
    /// `(f, w)`.
    pub recovered_load: f64,
    /// `|grad v|^2`, v the piecewise linear function.
    pub linear: f64,
    /// `(f, v)`.
    pub linear_load: f64,
    /// What the energy of w gains when its bubbles on the boundary are left out.
    pub trace: f64,
    /// Sum of the squares of the residual at the corners of regular cells.
    pub residual: f64,
}

impl Sums {
    pub(super) fn add(&mut self, other: &Self) {
        self.distance += other.distance;
        self.recovered += other.recovered;
        self.recovered_load += other.recovered_load;
        self.linear += other.linear;
        self.linear_load += other.linear_load;
        self.trace += other.trace;
        self.residual += other.residual;
    }
}

/// Two rows of nodes, and what is between them.
pub(super) struct Strip<'a> {
    pub lower: &'a NodeRow,
    pub upper: &'a NodeRow,
    pub edges: &'a EdgeRow,
}

/// Cells whose sums are kept apart, so that they can be added to at once.
const LANES: usize = 128;

impl Strip<'_> {
    /// Sums over cells in which, and around which, f has one value; `mass` is its integral over a cell.
    #[inline(always)]
    pub(super) fn regular(&self, cells: Range<usize>, mass: f64) -> Sums {
        let (lower, upper, edges) = (self.lower, self.upper, self.edges);
        let mut parts = [[0.0; LANES]; 6];
        for start in cells.clone().step_by(LANES) {
            self.add_block(start..cells.end.min(start + LANES), mass, &mut parts);
        }
        let [distance, recovered, linear, values, bubbles, residual] = parts.each_mut().map(fold);
        let Range { start, end } = cells;
        // Values of the corners summed over the cells: those of each inner column twice.
        let column = |i: usize| lower.v[i] + upper.v[i];
        let mean = 0.25 * (2.0 * values + (column(end) - column(start)));
        let turn = edges.along[end] - edges.along[start];
        let last = [lower, upper].map(|row| (row.laplacian[end] + mass).powi(2));
        Sums {
            distance: distance * (10.5 / 1440.0),
            recovered: linear / 12.0 + recovered / 6.0,
            recovered_load: mass * (mean - bubbles / 12.0),
            linear: 0.25 * linear,
            linear_load: mass * (mean + turn / 12.0),
            trace: 0.0,
            residual: residual + last[0] + last[1],
        }
    }

    /// Adds at most [`LANES`] regular cells, each to sums of its own.
    ///
    /// The formulas are those of [`Axis`] with `theta = 0`, in sums and differences of opposite edges.
    #[inline(always)]
    fn add_block(&self, cells: Range<usize>, mass: f64, parts: &mut [[f64; LANES]; 6]) {
        const BEND: f64 = 40.0 / 21.0;
        const BENT: f64 = (48.0 - 1600.0 / 42.0) / 10.5;
        const TWIST: f64 = 1.0 / 3.0;
        let count = cells.len().min(LANES);
        let (lower, upper, edges) = (self.lower, self.upper, self.edges);
        let from = |shift: usize| cells.start + shift..cells.start + shift + count;
        let (v0, v1) = (&lower.v[from(0)], &upper.v[from(0)]);
        let (x0, x1) = (&lower.along[from(1)], &upper.along[from(1)]);
        let (p0, p1) = (&lower.third[from(0)], &upper.third[from(0)]);
        let (b0, b1) = (&lower.bubble[from(0)], &upper.bubble[from(0)]);
        let (y0, y1) = (&edges.along[from(0)], &edges.along[from(1)]);
        let (q0, q1) = (&edges.third[from(0)], &edges.third[from(1)]);
        let (c0, c1) = (&edges.bubble[from(0)], &edges.bubble[from(1)]);
        let (l0, l1) = (&lower.laplacian[from(0)], &upper.laplacian[from(0)]);
        let [distance, recovered, linear, values, bubbles, residual] = parts;
        for i in 0..count {
            let (x, y) = (x0[i] + x1[i], y0[i] + y1[i]);
            let (dx, dy) = (x1[i] - x0[i], y1[i] - y0[i]);
            let (b, c) = (b0[i] + b1[i], c0[i] + c1[i]);
            // The bubbles of each direction bend the slope along the other by this much.
            let (e, g) = (b1[i] - b0[i], c1[i] - c0[i]);
            let (p, q) = (p0[i] + p1[i] + BEND * g, q0[i] + q1[i] + BEND * e);
            let (dp, dq) = (p1[i] - p0[i], q1[i] - q0[i]);
            let bent = e * e + g * g;
            distance[i] += (p * p + q * q) + BENT * bent + TWIST * (dp * dp + dq * dq);
            let steep = x * x + y * y;
            linear[i] += steep + (dx * dx + dy * dy);
            recovered[i] +=
                (steep - (g * x + e * y)) + (0.5 * (b * b + c * c) + (11.0 / 30.0) * bent);
            values[i] += v0[i] + v1[i];
            bubbles[i] += b + c;
            let (below, above) = (l0[i] + mass, l1[i] + mass);
            residual[i] += below * below + above * above;
        }
    }

    /// The residual times `h^2` in regular cells: its mean over the corners.
    #[inline(always)]
    pub(super) fn residuals(&self, cells: Range<usize>, mass: f64, out: &mut [f64]) {
        let Range { start, end } = cells;
        let out = &mut out[start..end];
        let (lower, upper) = (&self.lower.laplacian[start..], &self.upper.laplacian[start..]);
        let (lower, upper) = (&lower[..out.len() + 1], &upper[..out.len() + 1]);
        for (i, out) in out.iter_mut().enumerate() {
            *out = mass + 0.25 * ((lower[i] + lower[i + 1]) + (upper[i] + upper[i + 1]));
        }
    }

    /// What cell `i` shows along x and along y.
    fn axes(&self, i: usize) -> [Axis; 2] {
        let (lower, upper, edges) = (self.lower, self.upper, self.edges);
        let natural = |row: &NodeRow| 0.5 * (row.along[i + 2] - row.along[i]);
        let x = Axis {
            along: [lower.along[i + 1], upper.along[i + 1]],
            third: [lower.third[i], upper.third[i]],
            bubble: [lower.bubble[i], upper.bubble[i]],
            second: [natural(lower), natural(upper)],
        };
        let y = Axis {
            along: [edges.along[i], edges.along[i + 1]],
            third: [edges.third[i], edges.third[i + 1]],
            bubble: [edges.bubble[i], edges.bubble[i + 1]],
            second: [i, i + 1].map(|i| 0.5 * (lower.across[i] + upper.across[i])),
        };
        [x, y]
    }

    /// Sums over cell `i` with moments `f`, with fluxes through its edges left, right, bottom, top that f
    /// needs, and the residual there times `h^2`. `outer` says which of the edges are on the boundary.
    pub(super) fn special(
        &self,
        i: usize,
        f: &Moments,
        flux: [f64; 4],
        outer: [bool; 4],
    ) -> (Sums, f64) {
        let (lower, upper) = (self.lower, self.upper);
        let [ll, lr, ul, ur] = [
            lower.laplacian[i],
            lower.laplacian[i + 1],
            upper.laplacian[i],
            upper.laplacian[i + 1],
        ];
        let slope = [
            12.0 * f.x + 0.5 * ((lr + ur) - (ll + ul)),
            12.0 * f.y + 0.5 * ((ul + ur) - (ll + lr)),
        ];
        let twist = 144.0 * f.xy + ((ll + ur) - (lr + ul));
        let [x, y] = self.axes(i);
        let distance = x.distance(y.bend(), [flux[0], flux[1]], slope[0], twist)
            + y.distance(x.bend(), [flux[2], flux[3]], slope[1], twist);
        // h / (2 pi) times the norm of f less its bilinear approximation.
        let oscillation = f.oscillation().sqrt() / (2.0 * PI);
        let corners = [lower.v[i], lower.v[i + 1], upper.v[i], upper.v[i + 1]];
        let recovered = x.recovered(y.bend()) + y.recovered(x.bend());
        let recovered_load = load(corners, x.bubble, y.bubble, f);
        let trace = match outer.contains(&true) {
            true => {
                let (cut_x, cut_y) = (x.cut([outer[2], outer[3]]), y.cut([outer[0], outer[1]]));
                let energy = 0.5 * (cut_x.recovered(cut_y.bend()) + cut_y.recovered(cut_x.bend()));
                energy - 0.5 * recovered - load(corners, cut_x.bubble, cut_y.bubble, f)
                    + recovered_load
            }
            false => 0.0,
        };
        let square = |d: [f64; 2]| d[0] * d[0] + d[1] * d[1];
        let turn = (corners[0] + corners[3]) - (corners[1] + corners[2]);
        let sums = Sums {
            distance: (distance.sqrt() + oscillation).powi(2),
            recovered,
            recovered_load,
            linear: 0.5 * (square(x.along) + square(y.along)),
            linear_load: load(corners, [0.0; 2], [0.0; 2], f) + turn * f.ridge,
            trace,
            residual: 0.0,
        };
        let residual =
            f.one + 0.25 * ((ll + lr) + (ul + ur)) + (flux[1] - flux[0]) + (flux[3] - flux[2]);
        (sums, residual)
    }
}

/// The sum, in pairs.
#[inline(always)]
fn fold(lanes: &mut [f64; LANES]) -> f64 {
    let mut half = LANES;
    while half > 1 {
        half /= 2;
        let (low, high) = lanes.split_at_mut(half);
        low.iter_mut().zip(high).for_each(|(low, high)| *low += *high);
    }
    lanes[0]
}

/// What a cell shows along one axis, on its two edges in that direction.
#[derive(Clone, Copy)]
struct Axis {
    along: [f64; 2],
    third: [f64; 2],
    bubble: [f64; 2],
    /// Half the sum of the second differences at both ends: twice the bubble but where that is cut.
    second: [f64; 2],
}

fn mean(pair: [f64; 2]) -> f64 {
    0.5 * (pair[0] + pair[1])
}

fn difference(pair: [f64; 2]) -> f64 {
    pair[1] - pair[0]
}

impl Axis {
    /// The same without the bubbles of the edges on the boundary.
    fn cut(self, outer: [bool; 2]) -> Self {
        Self { bubble: [0, 1].map(|k| if outer[k] { 0.0 } else { self.bubble[k] }), ..self }
    }

    /// How the bubbles of this axis bend the slope along the other.
    fn bend(&self) -> f64 {
        difference(self.bubble)
    }

    /// Mean square of this component of `grad w`.
    fn recovered(&self, bend: f64) -> f64 {
        (mean(self.along) - bend / 6.0).powi(2)
            + (difference(self.along).powi(2) + 4.0 * mean(self.bubble).powi(2)) / 12.0
            + difference(self.bubble).powi(2) / 36.0
            + bend * bend / 180.0
    }

    /// Mean square of this component of `grad w - sigma`.
    fn distance(&self, bend: f64, flux: [f64; 2], slope: f64, twist: f64) -> f64 {
        let constant = (mean(self.third) + bend) / 6.0 + mean(flux) + slope / 12.0;
        let across = difference(self.third) / 6.0 + twist / 24.0;
        let along = mean(self.second) + difference(flux) - 2.0 * mean(self.bubble);
        let both = difference(self.second) - 2.0 * difference(self.bubble);
        let quadratic = 0.5 * (mean(self.third) - slope);
        let mixed = 0.5 * difference(self.third) - 0.75 * twist;
        constant * constant
            + (across * across + along * along) / 12.0
            + both * both / 144.0
            + quadratic * quadratic / 180.0
            + mixed * mixed / 2160.0
            + bend * bend / 180.0
    }
}

/// The integral of f times the bilinear function with these values at ll, lr, ul, ur, less its bubbles.
fn load([ll, lr, ul, ur]: [f64; 4], x: [f64; 2], y: [f64; 2], f: &Moments) -> f64 {
    let bilinear = 0.25 * ((ll + lr) + (ul + ur)) * f.one
        + 0.5 * ((lr + ur) - (ll + ul)) * f.x
        + 0.5 * ((ul + ur) - (ll + lr)) * f.y
        + ((ll + ur) - (lr + ul)) * f.xy;
    let along_x = mean(x) * (0.25 * f.one - f.xx) + difference(x) * (0.25 * f.y - f.xxy);
    let along_y = mean(y) * (0.25 * f.one - f.yy) + difference(y) * (0.25 * f.x - f.xyy);
    bilinear - along_x - along_y
}
