//! The right-hand side as the bounds see it: its moments over the cells, and where it jumps.

use super::moments::Moments;
use crate::discrete::cells::Cells;
use crate::discrete::grid::Grid;
use crate::discrete::load::radon;
use crate::problem::source::Source;
use std::borrow::Cow;
use std::ops::Range;

/// Neighbouring cells of a row on which f is alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// The cell after the last one.
    pub end: usize,
    /// Whether f is constant there; else it is a single cell.
    uniform: bool,
    /// Of f over each cell.
    pub f: Moments,
}

impl Run {
    fn constant(end: usize, mass: f64) -> Self {
        Self { end, uniform: true, f: Moments::constant(mass) }
    }

    fn cut(cell: usize, f: Moments) -> Self {
        Self { end: cell + 1, uniform: false, f }
    }

    /// The integral over each cell of the run where f is constant.
    pub(super) fn mass(&self) -> Option<f64> {
        self.uniform.then_some(self.f.one)
    }
}

/// The runs of a row from one place on.
pub(super) struct Cursor<'a>(pub &'a [Run]);

impl<'a> Cursor<'a> {
    /// The run of cell `i`, which is not left of the one asked for before.
    pub(super) fn at(&mut self, i: usize) -> &'a Run {
        while self.0[0].end <= i {
            self.0 = &self.0[1..];
        }
        &self.0[0]
    }
}

/// f on all cells: held for constant pieces, which take little room, and integrated anew each time for
/// smooth f.
pub(super) struct AllCells<'a> {
    grid: Grid,
    f: &'a Source,
    /// All rows one after the other; empty for smooth f.
    runs: Vec<Run>,
    /// Where each row ends there.
    ends: Vec<usize>,
    /// The integral of f.
    pub integral: f64,
    /// Integrals of f times the bilinear hat functions of the boundary nodes, in boundary order.
    pub outer: Vec<f64>,
}

impl<'a> AllCells<'a> {
    pub(super) fn new(grid: Grid, f: &'a Source) -> Self {
        let n = grid.cells();
        let (runs, ends, outer) = (Vec::new(), Vec::new(), vec![0.0; grid.boundary_nodes()]);
        let mut all = Self { grid, f, runs, ends, integral: 0.0, outer };
        if let Source::Pieces { background, pieces } = f {
            let mut cells = Cells::new(grid, *background, pieces);
            let h2 = grid.h() * grid.h();
            for j in 0..n {
                let first = all.runs.len();
                cells.runs(j, |Range { end, .. }, shown| match shown {
                    Ok(value) => match all.runs[first..].last_mut() {
                        Some(last) if last.mass() == Some(value * h2) => last.end = end,
                        _ => all.runs.push(Run::constant(end, value * h2)),
                    },
                    Err(cell) => all.runs.push(Run::cut(end - 1, Moments::of_cut(grid, cell))),
                });
                all.ends.push(all.runs.len());
            }
        }
        let mut outer = std::mem::take(&mut all.outer);
        for j in 0..n {
            let row = all.row(j);
            add_outer(n, j, &row, &mut outer);
            all.integral += integral(&row);
        }
        Self { outer, ..all }
    }

    /// Row `j` from below, which is held.
    fn held(&self, j: usize) -> &[Run] {
        let start = if j > 0 { self.ends[j - 1] } else { 0 };
        &self.runs[start..self.ends[j]]
    }

    /// Row `j` from below.
    pub(super) fn row(&self, j: usize) -> Cow<'_, [Run]> {
        if j < self.ends.len() {
            return Cow::Borrowed(self.held(j));
        }
        let cell = |i| Run::cut(i, self.integrated(i, j));
        Cow::Owned((0..self.grid.cells()).map(cell).collect())
    }

    /// Whether the nodal vector `v` solves for the integrals of f times linear hat functions rather than bilinear
    /// ones: told at some nodes beside cells that jumps cut, as elsewhere inside the two are the same.
    pub(super) fn is_linear(&self, v: &[f64]) -> bool {
        const NODES: usize = 16;
        // The lower left ones of such cells.
        let of_row = |j| {
            let cut = self.held(j).iter().filter(|run| !run.uniform && run.end > 1);
            cut.map(move |run| (run.end - 1, j))
        };
        let nodes: Vec<_> = (1..self.ends.len()).flat_map(of_row).collect();
        let (mut linear, mut bilinear) = (0.0, 0.0);
        for &(i, j) in nodes.iter().step_by(nodes.len().div_ceil(NODES).max(1)) {
            let [[sw, se], [nw, ne]] = [j - 1, j].map(|row| {
                let mut cursor = Cursor(self.held(row));
                [i - 1, i].map(|cell| cursor.at(cell).f)
            });
            let load = ne.masses()[0] + nw.masses()[1] + se.masses()[2] + sw.masses()[3];
            let ridges = (ne.ridge - nw.ridge) + (sw.ridge - se.ridge);
            let (node, side) = (self.grid.index(i, j), self.grid.side());
            let around = (v[node - 1] + v[node + 1]) + (v[node - side] + v[node + side]);
            let residual = (4.0 * v[node] - around) - load;
            linear += (residual - ridges).powi(2);
            bilinear += residual.powi(2);
        }
        linear < bilinear
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

/// The integral of f over a row of cells.
fn integral(row: &[Run]) -> f64 {
    let mut start = 0;
    let of_run = |run: &Run| {
        let cells = run.end - std::mem::replace(&mut start, run.end);
        run.f.one * cells as f64
    };
    row.iter().map(of_run).sum()
}

/// Adds the part of row `j` to the integrals of f times the hat functions of the boundary nodes.
fn add_outer(n: usize, j: usize, row: &[Run], outer: &mut [f64]) {
    let [ll, _, ul, _] = row[0].f.masses();
    outer[(4 * n - j) % (4 * n)] += ll;
    outer[4 * n - j - 1] += ul;
    let [_, lr, _, ur] = row[row.len() - 1].f.masses();
    outer[n + j] += lr;
    outer[n + j + 1] += ur;
    // Corners are done.
    let mut cursor = Cursor(row);
    for i in (1..n).take_while(|_| j == 0) {
        outer[i] += cursor.at(i - 1).f.masses()[1] + cursor.at(i).f.masses()[0];
    }
    let mut cursor = Cursor(row);
    for i in (1..n).take_while(|_| j + 1 == n) {
        outer[3 * n - i] += cursor.at(i - 1).f.masses()[3] + cursor.at(i).f.masses()[2];
    }
}

/// Finds the nodes around which f is not one constant, between a row of cells and the one above, of which one may
/// be empty: inclusive ranges of columns, from left to right.
pub(super) fn seams(mut below: &[Run], mut above: &[Run], seams: &mut Vec<[usize; 2]>) {
    seams.clear();
    let mut add = |from: usize, to: usize| match seams.last_mut() {
        Some(last) if from <= last[1] + 1 => last[1] = last[1].max(to),
        _ => seams.push([from, to]),
    };
    let (mut start, mut before) = (0, None);
    loop {
        let (lower, upper) = (below.first(), above.first());
        let Some(end) = [lower, upper].into_iter().flatten().map(|run| run.end).min() else {
            return;
        };
        let uniform = match [lower, upper].map(|run| run.map(Run::mass)) {
            [Some(p), Some(q)] if p == q => p,
            [Some(p), None] | [None, Some(p)] => p,
            _ => None,
        };
        match uniform {
            None => add(start, end),
            Some(mass) if start > 0 && before != Some(mass) => add(start, start),
            Some(_) => {}
        }
        before = uniform;
        start = end;
        below = &below[usize::from(lower.is_some_and(|run| run.end == end))..];
        above = &above[usize::from(upper.is_some_and(|run| run.end == end))..];
    }
}
