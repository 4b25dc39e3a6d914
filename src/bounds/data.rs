//! The right-hand side as the bounds see it: its moments over the cells, and where it jumps.

use super::moments::Moments;
use crate::discrete::cells::Cells;
use crate::discrete::grid::Grid;
use crate::discrete::load::radon;
use crate::problem::source::Source;
use std::borrow::Cow;

/// What is known of f on a run of neighbouring cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Data {
    /// Constant, with this integral over each cell.
    Constant(f64),
    /// A single cell with the moments at this place in [`CellRow::cut`].
    Cut(usize),
}

/// f on one row of cells, as runs from left to right.
#[derive(Clone, Debug, Default)]
pub(super) struct CellRow {
    /// The cell after the last one of each run, and what f is there.
    runs: Vec<(usize, Data)>,
    cut: Vec<Moments>,
}

impl CellRow {
    /// Adds cells where f is constant, up to `end`.
    fn add_constant(&mut self, end: usize, mass: f64) {
        match self.runs.last_mut() {
            Some((last, Data::Constant(before))) if *before == mass => *last = end,
            _ => self.runs.push((end, Data::Constant(mass))),
        }
    }

    /// Adds a cell that jumps cut.
    fn add_cut(&mut self, i: usize, moments: Moments) {
        self.runs.push((i + 1, Data::Cut(self.cut.len())));
        self.cut.push(moments);
    }

    fn integral(&self) -> f64 {
        let mut start = 0;
        let of_run = |&(end, data): &(usize, Data)| {
            let cells = end - std::mem::replace(&mut start, end);
            match data {
                Data::Constant(mass) => mass * cells as f64,
                Data::Cut(cut) => self.cut[cut].one,
            }
        };
        self.runs.iter().map(of_run).sum()
    }

    /// The end of the run with cell `i`, where f is constant, and its integral over each cell.
    pub(super) fn constant(&self, i: usize) -> (usize, f64) {
        match self.runs[self.runs.partition_point(|&(end, _)| end <= i)] {
            (end, Data::Constant(mass)) => (end, mass),
            (_, Data::Cut(_)) => unreachable!("f is not constant there"),
        }
    }

    /// Moments over cell `i`.
    pub(super) fn at(&self, i: usize) -> Moments {
        match self.runs[self.runs.partition_point(|&(end, _)| end <= i)].1 {
            Data::Constant(mass) => Moments::constant(mass),
            Data::Cut(cut) => self.cut[cut],
        }
    }

    /// The integral of f times the bilinear hat function of a corner over cell `i`.
    pub(super) fn mass(&self, i: usize, corner: usize) -> f64 {
        match self.runs[self.runs.partition_point(|&(end, _)| end <= i)].1 {
            Data::Constant(mass) => 0.25 * mass,
            Data::Cut(cut) => self.cut[cut].masses()[corner],
        }
    }
}

/// f on all cells: held for constant pieces, which take little room, and integrated anew each time for
/// smooth f.
pub(super) struct AllCells<'a> {
    grid: Grid,
    f: &'a Source,
    rows: Vec<CellRow>,
    /// The integral of f.
    pub integral: f64,
}

impl<'a> AllCells<'a> {
    pub(super) fn new(grid: Grid, f: &'a Source) -> Self {
        let n = grid.cells();
        let mut all = Self { grid, f, rows: Vec::new(), integral: 0.0 };
        if let Source::Pieces { background, pieces } = f {
            let mut cells = Cells::new(grid, *background, pieces);
            let h2 = grid.h() * grid.h();
            for j in 0..n {
                let mut row = CellRow::default();
                cells.runs(j, |run, shown| match shown {
                    Ok(value) => row.add_constant(run.end, value * h2),
                    Err(cell) => row.add_cut(run.start, Moments::of_cut(grid, cell)),
                });
                all.rows.push(row);
            }
        }
        all.integral = (0..n).map(|j| all.row(j).integral()).sum();
        all
    }

    /// Row `j` from below.
    pub(super) fn row(&self, j: usize) -> Cow<'_, CellRow> {
        if let Some(row) = self.rows.get(j) {
            return Cow::Borrowed(row);
        }
        let mut row = CellRow::default();
        (0..self.grid.cells()).for_each(|i| row.add_cut(i, self.integrated(i, j)));
        Cow::Owned(row)
    }

    /// The integral of f times the bilinear hat function of a corner over cell (i, j).
    pub(super) fn mass(&self, [i, j]: [usize; 2], corner: usize) -> f64 {
        match self.rows.get(j) {
            Some(row) => row.mass(i, corner),
            None => self.integrated(i, j).masses()[corner],
        }
    }

    /// Moments of a smooth f over cell (i, j), by quadrature.
    fn integrated(&self, i: usize, j: usize) -> Moments {
        let h = self.grid.h();
        let [x, y] = [i, j].map(|k| self.grid.coordinate(k));
        let mut sum = Moments::default();
        for triangle in
            [[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5]], [[-0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]]
        {
            for ([p, q], weight) in quadrature(triangle) {
                let value = self.f.at([x + (p + 0.5) * h, y + (q + 0.5) * h]);
                sum.add([p, q], weight * value * h * h, value * h * h);
            }
        }
        sum
    }
}

/// Radon's points on a triangle, with weights.
fn quadrature([p, q, r]: [[f64; 2]; 3]) -> [([f64; 2], f64); 7] {
    let area = 0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]));
    radon()
        .map(|([a, b, c], weight)| ([0, 1].map(|d| a * p[d] + b * q[d] + c * r[d]), area * weight))
}

/// Finds the nodes around which f is not one constant, between a row of cells and the one above: inclusive
/// ranges of columns, from left to right.
pub(super) fn seams(below: Option<&CellRow>, above: Option<&CellRow>, seams: &mut Vec<[usize; 2]>) {
    seams.clear();
    let [mut below, mut above] = [below, above].map(|row| row.map_or(&[][..], |row| &row.runs));
    let mut add = |from: usize, to: usize| match seams.last_mut() {
        Some(last) if from <= last[1] + 1 => last[1] = last[1].max(to),
        _ => seams.push([from, to]),
    };
    let (mut start, mut before) = (0, None);
    loop {
        let (lower, upper) = (below.first(), above.first());
        let Some(end) = [lower, upper].into_iter().flatten().map(|run| run.0).min() else {
            return;
        };
        let uniform = match (lower.map(|run| run.1), upper.map(|run| run.1)) {
            (Some(Data::Constant(p)), Some(Data::Constant(q))) if p == q => Some(p),
            (Some(Data::Constant(p)), None) | (None, Some(Data::Constant(p))) => Some(p),
            _ => None,
        };
        match uniform {
            None => add(start, end),
            Some(mass) if start > 0 && before != Some(mass) => add(start, start),
            Some(_) => {}
        }
        before = uniform;
        start = end;
        below = &below[usize::from(lower.is_some_and(|run| run.0 == end))..];
        above = &above[usize::from(upper.is_some_and(|run| run.0 == end))..];
    }
}
