//! What the cells of a row have around them: the nodal vector, and the fluxes that f and its load need.

use super::cells::{LANES, Lanes, Special, second};
use super::data::Run;
use super::flux::{NodeFluxes, through_edges};
use super::moments::{Moments, mean};
use super::recovery::{Extended, admissible};

/// The nodal vector, and fluxes around the nodes of four rows: those below row j of cells, at its lower and upper
/// edges, and above.
pub(super) struct Strip<'a> {
    pub v: Extended<'a>,
    fluxes: [NodeFluxes; 4],
    /// What the integrals of f times linear hat functions are at the lower left corner of a cell above those times
    /// bilinear ones, for the rows j - 1 to j + 2 of cells, empty if they do not exist; if the load of v is of
    /// linear ones.
    ridges: Option<[Vec<f64>; 4]>,
}

impl<'a> Strip<'a> {
    /// Two rows below the first one, where nothing flows. `linear` says that v solves for a load against linear hats.
    pub(super) fn new(v: Extended<'a>, linear: bool) -> Self {
        let fluxes = [0; 4].map(|_| NodeFluxes::zero(v.grid.cells()));
        Self { v, fluxes, ridges: linear.then(Default::default) }
    }

    /// Goes up one row. The nodes that come into sight lie between these rows of cells; one that is missing is empty.
    pub(super) fn advance(&mut self, below: &[Run], above: &[Run]) {
        self.fluxes.rotate_left(1);
        self.fluxes[3].set(below, above);
        if let Some(ridges) = &mut self.ridges {
            ridges.rotate_left(1);
            ridges[3].clear();
            above.iter().for_each(|run| ridges[3].resize(run.end, run.f.ridge));
        }
    }

    /// Finds the cells of row `j` at the boundary, and those within two cells of a seam of f: inclusive ranges, from
    /// left to right.
    pub(super) fn find_special(&self, j: usize, special: &mut Vec<[usize; 2]>) {
        let n = self.v.grid.cells();
        special.clear();
        if j == 0 || j == n - 1 || n < LANES + 2 {
            special.push([0, n - 1]);
            return;
        }
        special.extend([[0, 0], [n - 1, n - 1]]);
        let seams = self.fluxes.iter().flat_map(|row| &row.seams);
        special.extend(seams.map(|&[from, to]| [from.saturating_sub(2), (to + 1).min(n - 1)]));
        special.sort_unstable();
        special.dedup_by(|next, last| {
            let joined = next[0] <= last[1] + 1;
            if joined {
                last[1] = last[1].max(next[1]);
            }
            joined
        });
    }

    /// Which edges of cell (i, j) along x, and along y, are on the boundary.
    #[inline(always)]
    pub(super) fn outer(&self, i: usize, j: usize) -> [[bool; 2]; 2] {
        let last = self.v.grid.cells() - 1;
        [[j == 0, j == last], [i == 0, i == last]]
    }

    /// Sets a lane of `cells` to cell (i, j), over which f has these moments; returns the mean of the residual times
    /// `h^2`.
    #[inline(always)]
    pub(super) fn set(
        &self,
        (cells, lane): (&mut Special<Lanes>, usize),
        [i, j]: [usize; 2],
        f: Moments,
    ) -> f64 {
        let (lines, outer) = (self.v.around(i, j), self.outer(i, j));
        let seconds = lines.map(|lines| lines.map(second));
        let (mut flux, bends) = match self.fluxes.iter().any(|row| !row.seams.is_empty()) {
            true => (through_edges(&self.fluxes[1], &self.fluxes[2], i), self.bends(i, j)),
            false => Default::default(),
        };
        if let Some(ridges) = &self.ridges {
            flux.iter_mut().zip(between_hats(ridges, i)).for_each(|(flux, more)| *flux += more);
        }
        for axis in 0..2 {
            for k in 0..2 {
                let (line, bubble) = (lines[axis][k], 0.5 * seconds[axis][k] + bends[axis][k]);
                cells.bubbles[axis][k][lane] =
                    if outer[axis][k] { admissible(bubble, line) } else { bubble };
                (0..4).for_each(|node| cells.lines[axis][k][node][lane] = line[node]);
            }
        }
        (0..4).for_each(|edge| cells.flux[edge][lane] = flux[edge]);
        cells.f.each(&f, |lanes, moment| lanes[lane] = moment);
        let ([x, y], [left, right, bottom, top]) = (seconds.map(mean), flux);
        f.one + (x + y) + (right - left) + (top - bottom)
    }

    /// What the fluxes that f needs add to the bubbles of cell (i, j) along both axes: half their change over the
    /// cells at the edge, in the mean.
    #[inline(always)]
    fn bends(&self, i: usize, j: usize) -> [[f64; 2]; 2] {
        let n = self.v.grid.cells();
        let changes = |i: usize, strip: usize| {
            let [left, right, bottom, top] =
                through_edges(&self.fluxes[strip], &self.fluxes[strip + 1], i);
            [right - left, top - bottom]
        };
        let [x, y] = changes(i, 1);
        // Beyond the boundary as here.
        let below = if j > 0 { changes(i, 0)[0] } else { x };
        let above = if j + 1 < n { changes(i, 2)[0] } else { x };
        let left = if i > 0 { changes(i - 1, 1)[1] } else { y };
        let right = if i + 1 < n { changes(i + 1, 1)[1] } else { y };
        [[below, above].map(|near| 0.25 * (x + near)), [left, right].map(|near| 0.25 * (y + near))]
    }
}

/// The fluxes through the edges of cell `i` in the second of four rows, left, right, bottom and top, that move the
/// residual of a load against linear hats to where bilinear ones have it.
///
/// With R the ridge of a cell, the former integrals differ from the latter by R, -R, -R, R at ll, lr, ul, ur. In the
/// mean over a cell these differences are the mixed second difference of R over its neighbours, divided by four, and
/// that is the divergence of these fluxes: none through the boundary, and none along it, where neighbours are missing.
#[inline(always)]
fn between_hats([below, here, above, _]: &[Vec<f64>; 4], i: usize) -> [f64; 4] {
    let n = here.len();
    let across = |i: usize| match i > 0 && i < n && !below.is_empty() && !above.is_empty() {
        true => 0.125 * ((above[i - 1] + above[i]) - (below[i - 1] + below[i])),
        false => 0.0,
    };
    let inside = i > 0 && i + 1 < n;
    let up = |lower: &[f64], upper: &[f64]| match inside && !lower.is_empty() && !upper.is_empty() {
        true => 0.125 * ((lower[i + 1] + upper[i + 1]) - (lower[i - 1] + upper[i - 1])),
        false => 0.0,
    };
    [across(i), across(i + 1), up(below, here), up(here, above)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fluxes_between_hats_take_up_the_mixed_differences() {
        const N: usize = 7;
        let ridge = |j: usize| (0..N).map(|i| libm::sin((7 * j + i) as f64 * 12.9898)).collect();
        let rows: [Vec<f64>; 5] = std::array::from_fn(ridge);
        let four = |j: usize| std::array::from_fn(|k| rows[(j + k).min(4)].clone());
        let [lower, upper] = [four(0), four(1)];
        for i in 1..N - 1 {
            let [left, right, bottom, top] = between_hats(&lower, i);
            let mixed = (rows[2][i + 1] - rows[2][i - 1]) - (rows[0][i + 1] - rows[0][i - 1]);
            assert!(((right - left) + (top - bottom) - 0.25 * mixed).abs() < 1e-15);
            // What leaves a cell enters the next.
            assert_eq!(right, between_hats(&lower, i + 1)[0]);
            assert_eq!(top, between_hats(&upper, i)[2]);
        }
        // Nothing through the boundary.
        assert_eq!((between_hats(&lower, 0)[0], between_hats(&lower, N - 1)[1]), (0.0, 0.0));
        let edge = [Vec::new(), rows[0].clone(), rows[1].clone(), rows[2].clone()];
        assert_eq!(between_hats(&edge, 3)[..3], [0.0; 3]);
    }
}
