//! The iterates of several runs on one grid, node by node with a number per run.

use super::LANES;
use super::arithmetic::{LaneLaws, V};
use crate::discrete::grid::Grid;
use crate::discrete::network::Network;
use crate::discrete::transfer::{Prolongation, prolong, prolong_boundary};
use crate::problem::law::Law;
use crate::saddle::RunStart;
use std::array::from_fn;
use std::sync::Arc;

/// Order in which a sweep visits the nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// Row by row, x fastest; y fastest gives the same iterates, only the transposed f.
    #[default]
    Lexicographic,
    /// All boundary nodes row by row, then all interior ones.
    BoundaryFirst,
    /// All interior nodes row by row, then all boundary ones.
    InteriorFirst,
}

/// A boundary node and the neighbours its row of the stiffness matrix refers to.
#[derive(Clone, Copy)]
pub(super) struct LaneEdge {
    pub(super) node: u32,
    /// Place in a boundary vector.
    pub(super) place: u32,
    /// Neighbours in the order of [`Network`], with the weights of their couplings; a corner has two, and itself with
    /// the weight zero.
    pub(super) around: [u32; 3],
    pub(super) weights: [f64; 3],
    pub(super) is_corner: bool,
}

impl LaneEdge {
    /// Values of the neighbours times their weights.
    #[inline(always)]
    pub(super) fn terms(&self, y: &[V]) -> [V; 3] {
        from_fn(|k| y[self.around[k] as usize] * self.weights[k])
    }
}

/// The iterates of all lanes.
#[derive(Clone)]
pub(crate) struct Lanes {
    pub(super) grid: Grid,
    pub(super) laws: LaneLaws,
    order: Order,
    /// Weight of the multiplier in (7), h, and its weight at the corners.
    pub(super) weights: [f64; 2],
    pub(super) r: V,
    /// The proximal term's share of an interior node.
    pub(super) shift: V,
    /// Diagonals of edge and corner rows, each with its inverse, and the inverse inside.
    edge: [V; 2],
    corner: [V; 2],
    centre: V,
    pub(super) y: Vec<V>,
    pub(super) a: Vec<V>,
    /// F, and with the proximal term.
    pub(super) load: Vec<V>,
    pub(super) target: Vec<V>,
    /// In the order of rows.
    pub(super) edges: Arc<[LaneEdge]>,
    /// Place in `edges` of the boundary node in column `i` and row `j`, by `j * side + i`.
    pub(super) edge_at: Arc<[u32]>,
    pub(super) regularised: bool,
    /// In each lane, the node that last broke a bound, the likeliest to break the next: on a measure of the outer
    /// problem, and on that of the inner one.
    pub(super) witnesses: [[usize; LANES]; 2],
}

/// No boundary node.
const INSIDE: u32 = u32::MAX;

/// (9) at an interior node: `centre` times the sum of the terms.
#[inline(always)]
fn relaxed(centre: V, terms: [V; 5]) -> V {
    let [load, east, north, south, west] = terms;
    centre * ((((load + east) + north) + south) + west)
}

impl Lanes {
    /// All lanes at zero, under one law, swept in this order, with the multiplier's weight at corners in units of h.
    pub(crate) fn new(grid: Grid, law: Law, order: Order, corner_weight: f64) -> Self {
        let n = grid.cells();
        let network = Network::of_square(grid);
        let edge = |(b, node): (usize, usize)| {
            let row = network.row(node);
            let (mut around, mut weights) = ([node as u32; 3], [0.0; 3]);
            around[..row.others.len()].copy_from_slice(row.others);
            weights[..row.others.len()].copy_from_slice(row.weights);
            let is_corner = grid.is_corner(b);
            LaneEdge { node: node as u32, place: b as u32, around, weights, is_corner }
        };
        let mut edges: Vec<LaneEdge> = grid.boundary().enumerate().map(edge).collect();
        edges.sort_by_key(|edge| edge.node);
        let mut edge_at = vec![INSIDE; grid.nodes()];
        edges.iter().enumerate().for_each(|(k, edge)| edge_at[edge.node as usize] = k as u32);
        let nodes = || vec![V::all(0.0); grid.nodes()];
        Self {
            grid,
            laws: LaneLaws::all(law),
            order,
            weights: [1.0, corner_weight].map(|weight| grid.h() * weight),
            r: V::all(1.0),
            shift: V::all(0.0),
            edge: [V::all(2.0), V::all(0.5)],
            corner: [V::all(1.0); 2],
            centre: V::all(0.25),
            y: nodes(),
            a: vec![V::all(0.0); 4 * n],
            load: nodes(),
            target: Vec::new(),
            edges: edges.into(),
            edge_at: edge_at.into(),
            regularised: false,
            witnesses: [[0; LANES]; 2],
        }
    }

    /// Puts a run into a lane, under this law.
    ///
    /// # Panics
    /// If a vector has the wrong length for the grid, or r is not positive.
    pub(crate) fn enter(&mut self, lane: usize, law: Law, run: &RunStart<'_>) {
        let &RunStart { r, load, method, pair: start } = run;
        self.laws.set(lane, law);
        let weight = method.weight();
        assert!(load.len() == self.grid.nodes() && start.y.len() == self.grid.nodes());
        assert!(start.a.len() == self.a.len() && r > 0.0);
        self.y.iter_mut().zip(&start.y).for_each(|(y, start)| y.0[lane] = *start);
        self.a.iter_mut().zip(&start.a).for_each(|(a, start)| a.0[lane] = *start);
        self.load.iter_mut().zip(load).for_each(|(load, f)| load.0[lane] = *f);
        self.r.0[lane] = r;
        let shift = weight * self.grid.h() * self.grid.h();
        self.shift.0[lane] = shift;
        self.centre.0[lane] = 1.0 / (4.0 + shift);
        for (k, value) in [2.0 + 0.5 * shift, 1.0 + 0.25 * shift].into_iter().enumerate() {
            let [diagonal, inverse] = if k == 0 { &mut self.edge } else { &mut self.corner };
            (diagonal.0[lane], inverse.0[lane]) = (value, 1.0 / value);
        }
        if weight > 0.0 && !self.regularised {
            self.regularised = true;
            self.target = self.load.clone();
        }
        self.target.iter_mut().zip(load).for_each(|(target, f)| target.0[lane] = *f);
        self.regularise(lane);
    }

    /// Puts a run of Arrow-Hurwicz into every lane, all with the same r, from zero and under the lanes' laws; returns
    /// the load vectors, which the caller sets.
    ///
    /// # Panics
    /// If r is not positive, or a run before had a proximal term.
    pub(crate) fn enter_all(&mut self, r: f64) -> &mut [V] {
        assert!(r > 0.0 && !self.regularised);
        self.y.fill(V::all(0.0));
        self.a.fill(V::all(0.0));
        self.r = V::all(r);
        &mut self.load
    }

    /// Sets y, and the multiplier if it is to be, to those of the grid of twice the width, prolonged.
    ///
    /// # Panics
    /// If the lanes are not of that grid.
    pub(crate) fn prolong(&mut self, coarse: &Self, rule: Prolongation, multiplier: bool) {
        self.y.copy_from_slice(&prolong(coarse.grid, &coarse.y, rule));
        if multiplier {
            self.a.copy_from_slice(&prolong_boundary(&coarse.a));
        }
    }

    /// Sets the proximal term, if there is one, to pull towards y as it is now.
    pub(super) fn regularise(&mut self, lane: usize) {
        let (n, side, shift) = (self.grid.cells(), self.grid.side(), self.shift.0[lane]);
        if shift > 0.0 {
            let half = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 };
            for j in 0..side {
                for i in 0..side {
                    let k = j * side + i;
                    let pull = half(i) * half(j) * shift * self.y[k].0[lane];
                    self.target[k].0[lane] = self.load[k].0[lane] + pull;
                }
            }
        }
    }

    #[inline(always)]
    pub(super) fn sweep_inline(&mut self) {
        let (n, all) = (self.grid.cells(), self.edges.len());
        match self.order {
            Order::Lexicographic => {
                self.relax_boundary(0, n + 1);
                // Two boundary nodes in each row between the first and the last.
                let ends = |j: usize| n + 1 + 2 * (j - 1);
                let mut j = 1;
                while j + 1 < n {
                    self.relax_boundary(ends(j), 1);
                    self.relax_boundary(ends(j + 1), 1);
                    self.relax_two_rows(j);
                    self.relax_boundary(ends(j) + 1, 1);
                    self.relax_boundary(ends(j + 1) + 1, 1);
                    j += 2;
                }
                if j < n {
                    self.relax_boundary(ends(j), 1);
                    self.relax_row(j);
                    self.relax_boundary(ends(j) + 1, 1);
                }
                self.relax_boundary(all - n - 1, n + 1);
            }
            Order::BoundaryFirst => {
                self.relax_boundary(0, all);
                (1..n).for_each(|j| self.relax_row(j));
            }
            Order::InteriorFirst => {
                (1..n).for_each(|j| self.relax_row(j));
                self.relax_boundary(0, all);
            }
        }
    }

    /// (9) at the interior nodes of row `j`.
    #[inline(always)]
    fn relax_row(&mut self, j: usize) {
        let side = self.grid.side();
        let load = if self.regularised { &self.target } else { &self.load };
        let (below, rest) = self.y.split_at_mut(j * side);
        let (row, above) = rest.split_at_mut(side);
        let (south, north) = (&below[(j - 1) * side..][..side], &above[..side]);
        let (row, load) = (&mut row[..side], &load[j * side..][..side]);
        let mut west = row[0];
        for i in 1..side - 1 {
            west = relaxed(self.centre, [load[i], row[i + 1], north[i], south[i], west]);
            row[i] = west;
        }
    }

    /// (9) at the interior nodes of rows `j` and `j + 1`, the upper one column behind the lower: neither waits for
    /// the other, and each node finds the values that it finds row by row.
    #[inline(always)]
    fn relax_two_rows(&mut self, j: usize) {
        let side = self.grid.side();
        let load = if self.regularised { &self.target } else { &self.load };
        let (below, rest) = self.y.split_at_mut(j * side);
        let (lower, rest) = rest.split_at_mut(side);
        let (upper, above) = rest.split_at_mut(side);
        let (south, north) = (&below[(j - 1) * side..][..side], &above[..side]);
        let [lower_load, upper_load] = [j, j + 1].map(|j| &load[j * side..][..side]);
        let centre = self.centre;
        lower[1] = relaxed(centre, [lower_load[1], lower[2], upper[1], south[1], lower[0]]);
        let [mut west, mut west_above] = [lower[1], upper[0]];
        for i in 2..side - 1 {
            let (before, beside) = (west, upper[i]);
            west = relaxed(centre, [lower_load[i], lower[i + 1], beside, south[i], west]);
            west_above =
                relaxed(centre, [upper_load[i - 1], beside, north[i - 1], before, west_above]);
            (lower[i], upper[i - 1]) = (west, west_above);
        }
        let i = side - 2;
        upper[i] = relaxed(centre, [upper_load[i], upper[i + 1], north[i], west, west_above]);
    }

    /// (10) and (11) at `count` boundary nodes from the `first` on in the order of rows.
    #[inline(always)]
    fn relax_boundary(&mut self, first: usize, count: usize) {
        let load = if self.regularised { &self.target } else { &self.load };
        for edge in &self.edges[first..first + count] {
            let node = edge.node as usize;
            let [first, second, third] = edge.terms(&self.y);
            let sum = ((load[node] + first) + second) + third;
            let ([diagonal, inverse], h) = match edge.is_corner {
                false => (&self.edge, self.weights[0]),
                true => (&self.corner, self.weights[1]),
            };
            let row = [sum, self.a[edge.place as usize], self.r];
            self.y[node] = self.laws.relax(row, *diagonal, h, |sum| *inverse * sum);
        }
    }

    #[inline(always)]
    pub(super) fn step_inline(&mut self, steps: [bool; LANES]) -> [f64; LANES] {
        let steps = V(steps.map(|steps| f64::from(u8::from(steps))));
        let (mut changes, mut not_finite) = (V::all(0.0), V::all(0.0));
        for edge in &*self.edges {
            let (y, a) = (self.y[edge.node as usize], &mut self.a[edge.place as usize]);
            let next = *a - self.r * y;
            let next = V(from_fn(|l| if steps.0[l] == 1.0 { next.0[l] } else { a.0[l] }));
            // Zero, unless a value is no finite number.
            not_finite = not_finite + next * V::all(0.0);
            let next = self.laws.project(next);
            changes = (next - *a).abs().greatest(changes);
            *a = next;
        }
        (changes + not_finite).0
    }
}
