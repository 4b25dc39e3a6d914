//! The right-hand side for the bounds: its moments over the cells, and the places where it jumps.

use super::moments::CellMoments;
use crate::discrete::cells::Cells;
use crate::discrete::grid::Grid;
use crate::discrete::quadrature::quadrature;
use crate::problem::source::Source;
use std::borrow::Cow;
use std::ops::Range;

/// Neighbouring cells of a row over which f has the same moments.
#[derive(Clone, Copy, Debug)]
pub(super) struct MomentRun {
    /// The cell after the last one.
    pub end: usize,
    /// True if f is constant over the run; otherwise the run is a single cell.
    uniform: bool,
    /// Moments of f over each cell.
    pub f: CellMoments,
}

impl MomentRun {
    fn constant(end: usize, mass: f64) -> Self {
        Self { end, uniform: true, f: CellMoments::constant(mass) }
    }

    fn cut(cell: usize, f: CellMoments) -> Self {
        Self { end: cell + 1, uniform: false, f }
    }

    /// Integral of f over each cell of the run, if f is constant over the run.
    pub(super) fn mass(&self) -> Option<f64> {
        self.uniform.then_some(self.f.one)
    }
}

/// Runs of a row from some cell on.
pub(super) struct Cursor<'a>(pub &'a [MomentRun]);

impl<'a> Cursor<'a> {
    /// Moves on to the run of cell `i`, which must not be left of the cell of the call before, and returns it.
    pub(super) fn at(&mut self, i: usize) -> &'a MomentRun {
        while self.0[0].end <= i {
            self.0 = &self.0[1..];
        }
        &self.0[0]
    }
}

/// An inclusive range of columns of nodes, or of cells of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ColumnSpan {
    pub first: usize,
    pub last: usize,
}

/// Moments of f over all cells. They are stored for piecewise constant f, where they take little memory, and computed
/// for each row on request for smooth f.
pub(super) struct AllCells<'a> {
    grid: Grid,
    f: &'a Source,
    /// Runs of all rows, one row after the other; empty for smooth f.
    runs: Vec<MomentRun>,
    /// End of each row in `runs`.
    ends: Vec<usize>,
    /// Integral of f.
    pub integral: f64,
    /// Integrals of f times the bilinear hat functions of the boundary nodes, in boundary order.
    pub boundary_masses: Vec<f64>,
}

impl<'a> AllCells<'a> {
    /// Grid of the cells.
    pub(super) fn grid(&self) -> Grid {
        self.grid
    }

    pub(super) fn new(grid: Grid, f: &'a Source) -> Self {
        let n = grid.cells();
        let mut all = Self {
            grid,
            f,
            runs: Vec::new(),
            ends: Vec::new(),
            integral: 0.0,
            boundary_masses: Vec::new(),
        };
        if let Source::Pieces { background, pieces } = f {
            let mut cells = Cells::new(grid, *background, pieces);
            let h2 = grid.h() * grid.h();
            for j in 0..n {
                let first = all.runs.len();
                cells.runs(j, |Range { end, .. }, shown| match shown {
                    Ok(value) => match all.runs[first..].last_mut() {
                        Some(last) if last.mass() == Some(value * h2) => last.end = end,
                        _ => all.runs.push(MomentRun::constant(end, value * h2)),
                    },
                    Err(cell) => {
                        all.runs.push(MomentRun::cut(end - 1, CellMoments::from_cut(grid, cell)));
                    }
                });
                all.ends.push(all.runs.len());
            }
        }
        let (mut total, mut masses) = (0.0, vec![0.0; grid.boundary_nodes()]);
        for j in 0..n {
            let row = all.row(j);
            add_boundary_masses(n, j, &row, &mut masses);
            total += integral(&row);
        }
        (all.integral, all.boundary_masses) = (total, masses);
        all
    }

    /// Row `j` from below, which must be stored.
    fn stored(&self, j: usize) -> &[MomentRun] {
        let start = if j > 0 { self.ends[j - 1] } else { 0 };
        &self.runs[start..self.ends[j]]
    }

    /// Row `j` from below.
    pub(super) fn row(&self, j: usize) -> Cow<'_, [MomentRun]> {
        if j < self.ends.len() {
            return Cow::Borrowed(self.stored(j));
        }
        let moments = self.integrated(j).into_iter().enumerate();
        Cow::Owned(moments.map(|(i, moments)| MomentRun::cut(i, moments)).collect())
    }

    /// Moments of a smooth f over the cells of row `j`, by quadrature.
    fn integrated(&self, j: usize) -> Vec<CellMoments> {
        let (n, h) = (self.grid.cells(), self.grid.h());
        let (mut sums, mut values) = (vec![CellMoments::default(); n], vec![0.0; n]);
        for triangle in
            [[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5]], [[-0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]]
        {
            for point in quadrature::<3>() {
                let ([p, q], weight) = (point.within(triangle), 0.5 * point.weight);
                let x: Vec<f64> = (0..n).map(|i| self.grid.coordinate(i) + (p + 0.5) * h).collect();
                self.f.in_row(&x, self.grid.coordinate(j) + (q + 0.5) * h, &mut values);
                for (sum, value) in sums.iter_mut().zip(&values) {
                    sum.add([p, q], weight * value * h * h, value * h * h);
                }
            }
        }
        sums
    }
}

/// Integral of f over a row of cells.
fn integral(row: &[MomentRun]) -> f64 {
    let (mut start, mut sum) = (0, 0.0);
    for run in row {
        sum += run.f.one * (run.end - start) as f64;
        start = run.end;
    }
    sum
}

/// Adds the contribution of row `j` to the integrals of f times the hat functions of the boundary nodes.
fn add_boundary_masses(n: usize, j: usize, row: &[MomentRun], masses: &mut [f64]) {
    let [ll, _, ul, _] = row[0].f.masses();
    masses[(4 * n - j) % (4 * n)] += ll;
    masses[4 * n - j - 1] += ul;
    let [_, lr, _, ur] = row[row.len() - 1].f.masses();
    masses[n + j] += lr;
    masses[n + j + 1] += ur;
    // The corners are complete.
    if j == 0 {
        add_masses_along(row, [0, 1], masses[1..n].iter_mut());
    }
    if j + 1 == n {
        add_masses_along(row, [2, 3], masses[2 * n + 1..3 * n].iter_mut().rev());
    }
}

/// Adds the contribution of a row of cells to the integrals at the nodes along it, from left to right without the ends.
///
/// `left` and `right` number the hat functions of the left and the right corner of a cell at the nodes.
fn add_masses_along<'a>(
    row: &[MomentRun],
    [left, right]: [usize; 2],
    masses: impl Iterator<Item = &'a mut f64>,
) {
    let mut cursor = Cursor(row);
    for (i, mass) in (1..).zip(masses) {
        *mass += cursor.at(i - 1).f.masses()[right] + cursor.at(i).f.masses()[left];
    }
}

/// Finds the nodes around which f is not one constant, between a row of cells and the row above. One of the rows may
/// be empty. Writes the spans of these nodes from left to right.
pub(super) fn find_seams(
    mut below: &[MomentRun],
    mut above: &[MomentRun],
    seams: &mut Vec<ColumnSpan>,
) {
    seams.clear();
    let (mut start, mut before) = (0, None);
    loop {
        let (lower, upper) = (below.first(), above.first());
        let Some(end) = [lower, upper].into_iter().flatten().map(|run| run.end).min() else {
            return;
        };
        let uniform = match [lower, upper].map(|run| run.map(MomentRun::mass)) {
            [Some(p), Some(q)] if p == q => p,
            [Some(p), None] | [None, Some(p)] => p,
            _ => None,
        };
        match uniform {
            None => extend_or_push(seams, ColumnSpan { first: start, last: end }),
            Some(mass) if start > 0 && before != Some(mass) => {
                extend_or_push(seams, ColumnSpan { first: start, last: start });
            }
            Some(_) => {}
        }
        before = uniform;
        start = end;
        below = &below[usize::from(lower.is_some_and(|run| run.end == end))..];
        above = &above[usize::from(upper.is_some_and(|run| run.end == end))..];
    }
}

/// Appends a span that begins after the others, joined to the last one if there is no gap.
fn extend_or_push(spans: &mut Vec<ColumnSpan>, next: ColumnSpan) {
    match spans.last_mut() {
        Some(span) if next.first <= span.last + 1 => span.last = span.last.max(next.last),
        _ => spans.push(next),
    }
}
