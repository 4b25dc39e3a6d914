//! Sums over regular cells, that is cells in and around which f has one value.

use super::cells::{CellLanes, LANES, Sums};
use std::ops::Range;

/// Sums over regular cells, in units that [`take`](Self::take) converts.
#[derive(Default)]
pub(super) struct Regular(Sums<CellLanes>);

impl Regular {
    /// Adds cells of one row over each of which the integral of f is `mass`. Writes the means of the residual times
    /// `h^2` to `means`, and returns the sum of their squares.
    ///
    /// `rows` are the rows of nodes below the cells, at their lower and upper edges, and above, each of at least
    /// `LANES + 3` nodes.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        rows: [&[f64]; 4],
        cells: Range<usize>,
        mass: f64,
        means: &mut [f64],
    ) -> f64 {
        let (mut squares, mut start) = ([0.0; LANES], cells.start);
        while start + LANES <= cells.end {
            let found = add_block(rows, start, mass, &mut self.0);
            means[start..start + LANES].copy_from_slice(&found);
            for k in 0..LANES {
                squares[k] += found[k] * found[k];
            }
            start += LANES;
        }
        if start < cells.end {
            // A block that also contains other cells, with weight zero.
            let first = start.min(rows[0].len() - 2 - LANES);
            let counted = start - first..cells.end - first;
            let mut block = Sums::default();
            let found = add_block(rows, first, mass, &mut block);
            means[start..cells.end].copy_from_slice(&found[counted.clone()]);
            let mut share = [0.0; LANES];
            share[counted].fill(1.0);
            self.0.each(&block, |lanes, block| {
                for k in 0..LANES {
                    lanes[k] += share[k] * block[k];
                }
            });
            for k in 0..LANES {
                squares[k] += share[k] * found[k] * found[k];
            }
        }
        squares.iter().sum()
    }

    /// Returns the sums, and resets them to zero.
    pub(super) fn take(&mut self) -> Sums {
        let sums = std::mem::take(&mut self.0).total();
        let linear = 0.25 * sums.linear;
        Sums {
            distance: sums.distance / 2880.0,
            recovered: linear + sums.recovered / 2880.0,
            recovered_load: sums.recovered_load / 48.0,
            linear,
            linear_load: sums.linear_load / 12.0,
            variance: sums.variance / 144.0,
        }
    }
}

/// Adds [`LANES`] regular cells from `start` on to the sums, and returns the means of the residual.
///
/// The formulas are those of [`SpecialCell`](super::cells::SpecialCell) with f constant around the cell, in sums and
/// differences of opposite edges.
#[inline(always)]
fn add_block(
    [below, lower, upper, above]: [&[f64]; 4],
    start: usize,
    mass: f64,
    sums: &mut Sums<CellLanes>,
) -> CellLanes {
    // Columns of nodes, from the one left of the cells on.
    let (d1, d2) = (column(below, start), column(below, start + 1));
    let (a0, a1) = (column(lower, start - 1), column(lower, start));
    let (a2, a3) = (column(lower, start + 1), column(lower, start + 2));
    let (b0, b1) = (column(upper, start - 1), column(upper, start));
    let (b2, b3) = (column(upper, start + 1), column(upper, start + 2));
    let (u1, u2) = (column(above, start), column(above, start + 1));
    let mut means = [0.0; LANES];
    for i in 0..LANES {
        // Sums and differences of the two inner rows, and in the two outer rows.
        let (s0, s1, s2, s3) = (b0[i] + a0[i], b1[i] + a1[i], b2[i] + a2[i], b3[i] + a3[i]);
        let (t0, t1, t2, t3) = (b0[i] - a0[i], b1[i] - a1[i], b2[i] - a2[i], b3[i] - a3[i]);
        let (us, ut, ds, dt) = (u2[i] + u1[i], u2[i] - u1[i], d2[i] + d1[i], d2[i] - d1[i]);
        let (x, y, turn, corners) = (s2 - s1, t2 + t1, t2 - t1, s2 + s1);
        // Four times the contribution of the bubbles of each axis to the slope along the other.
        let (g, e) = ((ut + dt) - x, (t3 + t0) - y);
        // Third differences, summed over opposite edges, and their differences.
        let (p, q) = ((s3 - s0) - 3.0 * x, (us - ds) - 3.0 * y);
        let (dp, dq) = ((t3 - t0) - 3.0 * turn, (ut - dt) - 3.0 * turn);
        // Four times the bubbles, summed over opposite edges.
        let (along, across) = ((s3 + s0) - corners, (us + ds) - corners);
        let laplacian = along + across;
        // Twice the slopes of the residual, its twist and its mean.
        let (r, o, twist, mean) = (p + g, q + e, dp + dq, 0.25 * laplacian + mass);
        let (third, slope) = (p * p + q * q, r * r + o * o);
        let (steep, turned) = (x * x + y * y, turn * turn);
        let (bubbles, bent) = (along * along + across * across, g * x + e * y);
        // In units that `take` converts.
        let cell = Sums {
            distance: 7.0 * (third + (dp * dp + dq * dq)) + 8.0 * (p * r + q * o) + 6.0 * slope,
            recovered: 11.0 * (g * g + e * e) + 15.0 * bubbles - 120.0 * bent - 960.0 * turned,
            recovered_load: mass * (12.0 * corners - laplacian),
            linear: steep + (turned + turned),
            linear_load: mass * (3.0 * corners + turn),
            variance: 3.0 * slope + twist * twist,
        };
        means[i] = mean;
        sums.each(&cell, |lanes, part| lanes[i] += part);
    }
    means
}

#[inline(always)]
fn column(row: &[f64], start: usize) -> &[f64; LANES] {
    row[start..start + LANES].try_into().expect("as long as that")
}
