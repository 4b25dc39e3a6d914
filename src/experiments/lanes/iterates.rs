//! The iterates of several runs, node by node with a number per run, and what is measured of them.

use super::{Job, LANES};
use crate::discrete::grid::Grid;
use crate::discrete::stiffness::residual;
use crate::saddle::Pair;
use std::array::from_fn;
use std::ops::{Add, Mul};

/// What is measured at a node.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Measure {
    /// The gradient (8).
    Signed,
    /// Its absolute value.
    Printed,
    /// The same, with the proximal term.
    Inner,
    /// `|A y - F|` inside, `|min(y, A y - F)|` on the boundary.
    Kkt,
}

/// A number per lane.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct V([f64; LANES]);

impl Add for V {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] + other.0[l]))
    }
}

impl Mul for V {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] * other.0[l]))
    }
}

impl V {
    fn all(value: f64) -> Self {
        Self([value; LANES])
    }
}

/// The iterates of all lanes, node by node, and room for one of them apart.
pub(super) struct Lanes {
    grid: Grid,
    r: V,
    /// The proximal term's share of an interior node.
    shift: V,
    /// Diagonals of edge and corner rows, each with its inverse, and the inverse inside.
    edge: [V; 2],
    corner: [V; 2],
    inside: V,
    y: Vec<V>,
    a: Vec<V>,
    /// F, with the proximal term.
    load: Vec<V>,
    boundary: Vec<usize>,
    y_apart: Vec<f64>,
    load_apart: Vec<f64>,
    values: Vec<f64>,
}

impl Lanes {
    pub(super) fn new(grid: Grid) -> Self {
        let nodes = || vec![V::all(0.0); grid.nodes()];
        let apart = || vec![0.0; grid.nodes()];
        Self {
            grid,
            r: V::all(1.0),
            shift: V::all(0.0),
            edge: [V::all(2.0), V::all(0.5)],
            corner: [V::all(1.0); 2],
            inside: V::all(0.25),
            y: nodes(),
            a: vec![V::all(0.0); grid.boundary_nodes()],
            load: nodes(),
            boundary: grid.boundary().collect(),
            y_apart: apart(),
            load_apart: apart(),
            values: apart(),
        }
    }

    /// Puts a job into a lane, with the proximal term of this weight.
    pub(super) fn enter(&mut self, lane: usize, job: &Job, weight: f64) {
        assert!(job.load.len() == self.grid.nodes() && job.start.y.len() == self.grid.nodes());
        assert!(job.start.a.len() == self.grid.boundary_nodes() && job.r > 0.0);
        self.r.0[lane] = job.r;
        self.y.iter_mut().zip(&job.start.y).for_each(|(y, start)| y.0[lane] = *start);
        self.a.iter_mut().zip(&job.start.a).for_each(|(a, start)| a.0[lane] = *start);
        self.load.iter_mut().zip(job.load).for_each(|(load, f)| load.0[lane] = *f);
        let shift = weight * self.grid.h() * self.grid.h();
        self.shift.0[lane] = shift;
        self.inside.0[lane] = 1.0 / (4.0 + shift);
        for (k, value) in [2.0 + 0.5 * shift, 1.0 + 0.25 * shift].into_iter().enumerate() {
            let [diagonal, inverse] = if k == 0 { &mut self.edge } else { &mut self.corner };
            (diagonal.0[lane], inverse.0[lane]) = (value, 1.0 / value);
        }
        self.regularise(lane, job.load);
    }

    /// Sets the proximal term to pull towards y as it is now.
    pub(super) fn regularise(&mut self, lane: usize, load: &[f64]) {
        let shift = self.shift.0[lane];
        if shift > 0.0 {
            let (n, side) = (self.grid.cells(), self.grid.side());
            let half = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 };
            for (k, target) in self.load.iter_mut().enumerate() {
                target.0[lane] =
                    load[k] + half(k % side) * half(k / side) * shift * self.y[k].0[lane];
            }
        }
    }

    /// (9)-(11) in every lane.
    pub(super) fn sweep(&mut self) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let inside = self.inside;
        for i in 0..=n {
            self.relax_boundary(i, i, 0);
        }
        for j in 1..n {
            self.relax_boundary(4 * n - j, 0, j);
            let (below, rest) = self.y.split_at_mut(j * side);
            let (row, above) = rest.split_at_mut(side);
            let south = &below[(j - 1) * side..][..side];
            let (north, load) = (&above[..side], &self.load[j * side..][..side]);
            let mut west = row[0];
            for i in 1..n {
                west = inside * (((south[i] + north[i]) + (row[i + 1] + load[i])) + west);
                row[i] = west;
            }
            self.relax_boundary(n + j, n, j);
        }
        for i in 0..=n {
            self.relax_boundary(3 * n - i, i, n);
        }
    }

    /// (10) and (11) at boundary node `b` (`4 n` is node 0 again), in column `i` and row `j`.
    fn relax_boundary(&mut self, b: usize, i: usize, j: usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let node = j * side + i;
        let (y, half) = (&self.y, V::all(0.5));
        let x = if i == 0 { y[node + 1] } else { y[node - 1] };
        let z = if j == 0 { y[node + side] } else { y[node - side] };
        let (neighbours, [diagonal, inverse]) = match (i == 0 || i == n, j == 0 || j == n) {
            (true, true) => (half * (x + z), self.corner),
            (_, true) => (half * (y[node - 1] + y[node + 1]) + z, self.edge),
            _ => (half * (y[node - side] + y[node + side]) + x, self.edge),
        };
        let (sum, a, h) = (neighbours + self.load[node], self.a[b], self.grid.h());
        self.y[node] = V(from_fn(|l| {
            let (psi, r) = (inverse.0[l] * sum.0[l], self.r.0[l]);
            let pulled = (sum.0[l] + h * a.0[l]) / (diagonal.0[l] + h * r);
            if psi >= a.0[l] / r { psi } else { pulled }
        }));
    }

    /// (12) in the lanes that step, and the largest change in each.
    pub(super) fn step(&mut self, steps: [bool; LANES]) -> [f64; LANES] {
        let mut changes = [0.0f64; LANES];
        for (a, &node) in self.a.iter_mut().zip(&self.boundary) {
            let y = self.y[node];
            for l in 0..LANES {
                let next = a.0[l] - self.r.0[l] * y.0[l];
                let next = if next > 0.0 { next } else { 0.0 };
                let next = if steps[l] { next } else { a.0[l] };
                let change = (next - a.0[l]).abs();
                changes[l] = if change > changes[l] { change } else { changes[l] };
                a.0[l] = next;
            }
        }
        changes
    }

    /// Whether a measure is at most `bound` everywhere; NaN never is.
    pub(super) fn within(
        &mut self,
        lane: usize,
        measure: Measure,
        bound: f64,
        witness: &mut usize,
        job: &Job,
    ) -> bool {
        let load = match measure {
            Measure::Inner => self.load[*witness].0[lane],
            _ => job.load[*witness],
        };
        let flux = self.flux(lane, *witness, load);
        let (i, j) = (*witness % self.grid.side(), *witness / self.grid.side());
        let y = self.y[*witness].0[lane];
        let a = self.boundary_index(i, j).map(|b| self.a[b].0[lane]);
        let value = self.value(lane, measure, (i, j), y, flux, a);
        if value > bound || value.is_nan() {
            return false;
        }
        let (value, node) = self.worst(lane, measure, job);
        *witness = node;
        value <= bound
    }

    /// The largest value of a measure over all nodes, and where it is.
    pub(super) fn worst(&mut self, lane: usize, measure: Measure, job: &Job) -> (f64, usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let take = |from: &[V], to: &mut [f64]| {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = from.0[lane]);
        };
        take(&self.y, &mut self.y_apart);
        let mut load = job.load;
        if measure == Measure::Inner {
            take(&self.load, &mut self.load_apart);
            load = &self.load_apart;
        }
        residual(self.grid, &self.y_apart, load, &mut self.values);
        let mut values = std::mem::take(&mut self.values);
        for (b, &node) in self.boundary.iter().enumerate() {
            let (i, j) = (node % side, node / side);
            let a = Some(self.a[b].0[lane]);
            values[node] = self.value(lane, measure, (i, j), self.y_apart[node], values[node], a);
        }
        for j in 1..n {
            for i in 1..n {
                let k = j * side + i;
                values[k] = self.value(lane, measure, (i, j), self.y_apart[k], values[k], None);
            }
        }
        self.values = values;
        let mut worst = (f64::NEG_INFINITY, 0);
        for (node, &value) in self.values.iter().enumerate() {
            if value.is_nan() {
                return (value, node);
            }
            if value > worst.0 {
                worst = (value, node);
            }
        }
        worst
    }

    /// The measure at a node, from y, `A y - F` and, on the boundary, the multiplier there.
    #[inline(always)]
    fn value(
        &self,
        lane: usize,
        measure: Measure,
        (i, j): (usize, usize),
        y: f64,
        flux: f64,
        a: Option<f64>,
    ) -> f64 {
        let mut flux = flux;
        if measure == Measure::Kkt {
            return if a.is_some() && y < flux { y.abs() } else { flux.abs() };
        }
        let n = self.grid.cells();
        if measure == Measure::Inner && self.shift.0[lane] > 0.0 {
            let shift = self.shift.0[lane];
            let mass = if j == 0 || j == n { 0.5 * shift } else { shift };
            flux += mass * y;
            if i == 0 || i == n {
                flux -= 0.5 * mass * y;
            }
        }
        if let Some(a) = a {
            flux -= self.grid.h() * (a - self.r.0[lane] * y).max(0.0);
        }
        if measure == Measure::Signed { flux } else { flux.abs() }
    }

    /// `A y - load` at a node of a lane, rounded as in [`residual`].
    fn flux(&self, lane: usize, node: usize, load: f64) -> f64 {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let (i, j) = (node % side, node / side);
        let y = |k: usize| self.y[k].0[lane];
        let x = || if i == 0 { y(node + 1) } else { y(node - 1) };
        let z = || if j == 0 { y(node + side) } else { y(node - side) };
        let along_x = || y(node - 1) + y(node + 1);
        let along_y = || y(node - side) + y(node + side);
        match (i == 0 || i == n, j == 0 || j == n) {
            (true, true) => y(node) - 0.5 * (x() + z()) - load,
            (_, true) => 2.0 * y(node) - 0.5 * along_x() - z() - load,
            (true, _) => 2.0 * y(node) - 0.5 * along_y() - x() - load,
            _ => 4.0 * y(node) - along_y() - along_x() - load,
        }
    }

    /// Position in a boundary vector of the node in column `i` and row `j`.
    fn boundary_index(&self, i: usize, j: usize) -> Option<usize> {
        let n = self.grid.cells();
        match (i, j) {
            (_, 0) => Some(i),
            _ if i == n => Some(n + j),
            _ if j == n => Some(3 * n - i),
            (0, _) => Some(4 * n - j),
            _ => None,
        }
    }

    pub(super) fn pair(&self, lane: usize) -> Pair {
        let take = |from: &[V]| from.iter().map(|v| v.0[lane]).collect();
        Pair { y: take(&self.y), a: take(&self.a) }
    }
}
