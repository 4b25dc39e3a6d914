//! The surroundings of a row of cells: the nodal vector, and the fluxes that f and its load require.

use super::boundary::limit_bubble;
use super::cells::{CellSlot, second};
use super::data::{ColumnSpan, MomentRun};
use super::flux::{EdgeFluxes, NodeFluxes, through_edges};
use super::lanes::LANES;
use super::moments::{CellMoments, mean};
use super::recovery::Extended;

/// The nodal vector, and the fluxes around four rows of nodes: below row j of cells, at its lower and upper edges, and
/// above it.
pub(super) struct FluxStrip<'a> {
    pub v: Extended<'a>,
    fluxes: [NodeFluxes; 4],
    /// Ridge moments of f over rows j - 1 to j + 2 of cells, empty for rows that do not exist; `None` if the load of v
    /// is against bilinear hats.
    ///
    /// At the lower left corner of a cell the ridge moment is the integral of f times the linear hat function less
    /// that times the bilinear one.
    ridges: Option<[Vec<f64>; 4]>,
}

impl<'a> FluxStrip<'a> {
    /// Starts two rows below the first one, where all fluxes are zero.
    ///
    /// `linear_hats` is true if v solves for a load against linear hat functions.
    pub(super) fn new(v: Extended<'a>, linear_hats: bool) -> Self {
        let fluxes = [0; 4].map(|_| NodeFluxes::zero(v.grid.cells()));
        Self { v, fluxes, ridges: linear_hats.then(Default::default) }
    }

    /// Moves up one row. The new row of nodes lies between these rows of cells; a missing row of cells is empty.
    pub(super) fn advance(&mut self, below: &[MomentRun], above: &[MomentRun]) {
        self.fluxes.rotate_left(1);
        self.fluxes[3].set(below, above);
        if let Some(ridges) = &mut self.ridges {
            ridges.rotate_left(1);
            ridges[3].clear();
            above.iter().for_each(|run| ridges[3].resize(run.end, run.f.ridge));
        }
    }

    /// Finds the cells of row `j` that are at the boundary or within two cells of a seam of f. Writes them as spans
    /// from left to right.
    pub(super) fn find_special(&self, j: usize, special: &mut Vec<ColumnSpan>) {
        let n = self.v.grid.cells();
        special.clear();
        if j == 0 || j == n - 1 || n < LANES + 2 {
            special.push(ColumnSpan { first: 0, last: n - 1 });
            return;
        }
        special.extend([0, n - 1].map(|cell| ColumnSpan { first: cell, last: cell }));
        for seam in self.fluxes.iter().flat_map(|row| &row.seams) {
            let (first, last) = (seam.first.saturating_sub(2), (seam.last + 1).min(n - 1));
            special.push(ColumnSpan { first, last });
        }
        special.sort_unstable();
        special.dedup_by(|next, span| {
            let joined = next.first <= span.last + 1;
            if joined {
                span.last = span.last.max(next.last);
            }
            joined
        });
    }

    /// Flags for the two edges of cell (i, j) along x, and the two along y, that are true on the boundary.
    #[inline(always)]
    pub(super) fn on_boundary(&self, i: usize, j: usize) -> [[bool; 2]; 2] {
        let last = self.v.grid.cells() - 1;
        [[j == 0, j == last], [i == 0, i == last]]
    }

    /// Sets a lane to cell (i, j), over which f has the moments `f`. Returns the mean of the residual times `h^2`.
    #[inline(always)]
    pub(super) fn set(&self, slot: CellSlot, [i, j]: [usize; 2], f: CellMoments) -> f64 {
        let CellSlot { cells, lane } = slot;
        let (lines, on_boundary) = (self.v.around(i, j), self.on_boundary(i, j));
        let seconds = lines.map(|lines| lines.map(second));
        let (mut flux, bends) = match self.fluxes.iter().any(|row| !row.seams.is_empty()) {
            true => (through_edges(&self.fluxes[1], &self.fluxes[2], i), self.bends(i, j)),
            false => Default::default(),
        };
        if let Some(ridges) = &self.ridges {
            flux = flux.plus(fluxes_between_hats(ridges, i));
        }
        for axis in 0..2 {
            for k in 0..2 {
                let (line, bubble) = (lines[axis][k], 0.5 * seconds[axis][k] + bends[axis][k]);
                let ends = [line[1], line[2]];
                cells.bubbles[axis][k][lane] =
                    if on_boundary[axis][k] { limit_bubble(bubble, ends) } else { bubble };
                (0..4).for_each(|node| cells.lines[axis][k][node][lane] = line[node]);
            }
        }
        let EdgeFluxes { left, right, bottom, top } = flux;
        cells.flux.each(&flux, |lanes, flux| lanes[lane] = *flux);
        cells.f.each(&f, |lanes, moment| lanes[lane] = *moment);
        let [x, y] = seconds.map(mean);
        f.one + (x + y) + (right - left) + (top - bottom)
    }

    /// Contribution of the fluxes that f requires to the bubbles of cell (i, j) along both axes: half the change of
    /// the flux over a cell, averaged over the two cells at the edge.
    #[inline(always)]
    fn bends(&self, i: usize, j: usize) -> [[f64; 2]; 2] {
        let n = self.v.grid.cells();
        let [x, y] = self.flux_changes(i, 1);
        // Beyond the boundary the change is taken to be that of the cell itself.
        let below = if j > 0 { self.flux_changes(i, 0)[0] } else { x };
        let above = if j + 1 < n { self.flux_changes(i, 2)[0] } else { x };
        let left = if i > 0 { self.flux_changes(i - 1, 1)[1] } else { y };
        let right = if i + 1 < n { self.flux_changes(i + 1, 1)[1] } else { y };
        [[below, above].map(|near| 0.25 * (x + near)), [left, right].map(|near| 0.25 * (y + near))]
    }

    /// Changes along x and along y of the fluxes through cell `i`, between rows `row` and `row + 1` of the nodes.
    #[inline(always)]
    fn flux_changes(&self, i: usize, row: usize) -> [f64; 2] {
        through_edges(&self.fluxes[row], &self.fluxes[row + 1], i).changes()
    }
}

/// Fluxes through the edges of cell `i` in the second of four rows, whose divergence is the difference between the
/// residual of a load against linear hats and that against bilinear hats.
///
/// With R the ridge moment of a cell, the integrals of f times linear hats differ from those times bilinear hats by R,
/// -R, -R, R at ll, lr, ul, ur. Averaged over a cell, these differences are the mixed second difference of R over its
/// neighbours, divided by four. The divergence of these fluxes is the same. No flux crosses the boundary, and none
/// runs along it, where neighbours are missing.
#[inline(always)]
fn fluxes_between_hats([below, here, above, _]: &[Vec<f64>; 4], i: usize) -> EdgeFluxes {
    EdgeFluxes {
        left: flux_across(below, above, i),
        right: flux_across(below, above, i + 1),
        bottom: flux_up(below, here, i),
        top: flux_up(here, above, i),
    }
}

/// Flux to the right at the left edge of cell `i`, from the ridge moments of the rows below and above.
#[inline(always)]
fn flux_across(below: &[f64], above: &[f64], i: usize) -> f64 {
    if i == 0 || i >= below.len() || i >= above.len() {
        return 0.0;
    }
    0.125 * ((above[i - 1] + above[i]) - (below[i - 1] + below[i]))
}

/// Flux up between cell `i` of a lower row and the one above it, from the ridge moments of both rows.
#[inline(always)]
fn flux_up(lower: &[f64], upper: &[f64], i: usize) -> f64 {
    if i == 0 || i + 1 >= lower.len() || i + 1 >= upper.len() {
        return 0.0;
    }
    0.125 * ((lower[i + 1] + upper[i + 1]) - (lower[i - 1] + upper[i - 1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 7;

    fn ridge_row(j: usize) -> Vec<f64> {
        (0..N).map(|i| libm::sin((7 * j + i) as f64 * 12.9898)).collect()
    }

    #[test]
    fn fluxes_between_hats_have_the_mixed_differences_as_divergence() {
        let rows: [Vec<f64>; 5] = std::array::from_fn(ridge_row);
        let lower = [0, 1, 2, 3].map(|j| rows[j].clone());
        let upper = [1, 2, 3, 4].map(|j| rows[j].clone());
        for i in 1..N - 1 {
            let flux = fluxes_between_hats(&lower, i);
            let mixed = (rows[2][i + 1] - rows[2][i - 1]) - (rows[0][i + 1] - rows[0][i - 1]);
            let [x, y] = flux.changes();
            assert!((x + y - 0.25 * mixed).abs() < 1e-15);
            // The flux out of a cell is the flux into the next.
            assert_eq!(flux.right, fluxes_between_hats(&lower, i + 1).left);
            assert_eq!(flux.top, fluxes_between_hats(&upper, i).bottom);
        }
        // No flux through the boundary.
        assert_eq!(fluxes_between_hats(&lower, 0).left, 0.0);
        assert_eq!(fluxes_between_hats(&lower, N - 1).right, 0.0);
        let edge = [Vec::new(), rows[0].clone(), rows[1].clone(), rows[2].clone()];
        let EdgeFluxes { left, right, bottom, .. } = fluxes_between_hats(&edge, 3);
        assert_eq!([left, right, bottom], [0.0; 3]);
    }
}
