//! The iterates of several runs on one grid, node by node with a number per run, and what is measured of them.

use super::LANES;
use super::arithmetic::{Arithmetic, Number, V};
use crate::discrete::grid::Grid;
use crate::discrete::simd::vectorised;
use crate::saddle::Pair;
use std::array::from_fn;

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

/// What is measured at a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// The gradient (8).
    Signed,
    /// Its absolute value.
    Printed,
    /// The same, with the proximal term.
    Inner,
    /// `|A y - F|` inside, `|min(y, A y - F)|` on the boundary.
    Kkt,
}

/// A boundary node and the neighbours its row of the stiffness matrix refers to.
#[derive(Clone, Copy)]
struct Edge {
    node: u32,
    /// Its place in a boundary vector.
    place: u32,
    /// The two neighbours along the boundary, each with the entry -1/2.
    along: [u32; 2],
    /// The neighbour inside with the entry -1, none at a corner.
    inward: Option<u32>,
}

/// The iterates of all lanes.
pub struct Lanes<N> {
    grid: Grid,
    order: Order,
    /// Weight of the multiplier in (7), h, and its weight at the corners.
    weights: [N; 2],
    r: V<N>,
    /// The proximal term's share of an interior node.
    shift: V<N>,
    /// Diagonals of edge and corner rows, each with its inverse, and the inverse inside.
    edge: [V<N>; 2],
    corner: [V<N>; 2],
    centre: V<N>,
    y: Vec<V<N>>,
    a: Vec<V<N>>,
    /// F, and with the proximal term.
    load: Vec<V<N>>,
    target: Vec<V<N>>,
    /// In the order of rows.
    edges: Vec<Edge>,
    /// Place in `edges` of the boundary node in column `i` and row `j`, by `j * side + i`.
    edge_at: Vec<u32>,
    regularised: bool,
}

/// No boundary node.
const INSIDE: u32 = u32::MAX;

impl<N: Number> Lanes<N> {
    /// All lanes at zero, swept in this order, with the multiplier's weight at corners in units of h.
    pub fn new(grid: Grid, order: Order, corner_weight: f64) -> Self {
        let n = grid.cells();
        let node = |b: usize| {
            let (i, j) = grid.boundary_node(b % (4 * n));
            grid.index(i, j) as u32
        };
        let edge = |b: usize| {
            let inward = match grid.boundary_node(b) {
                _ if grid.is_corner(b) => None,
                (i, 0) => Some(grid.index(i, 1)),
                (0, j) => Some(grid.index(1, j)),
                (i, j) if i == n => Some(grid.index(n - 1, j)),
                (i, _) => Some(grid.index(i, n - 1)),
            };
            let along = [node(b + 4 * n - 1), node(b + 1)];
            Edge { node: node(b), place: b as u32, along, inward: inward.map(|k| k as u32) }
        };
        let mut edges: Vec<Edge> = (0..4 * n).map(edge).collect();
        edges.sort_by_key(|edge| edge.node);
        let mut edge_at = vec![INSIDE; grid.nodes()];
        edges.iter().enumerate().for_each(|(k, edge)| edge_at[edge.node as usize] = k as u32);
        let nodes = || vec![V::all(0.0); grid.nodes()];
        Self {
            grid,
            order,
            weights: [1.0, corner_weight].map(|weight| N::of(grid.h() * weight)),
            r: V::all(1.0),
            shift: V::all(0.0),
            edge: [V::all(2.0), V::all(0.5)],
            corner: [V::all(1.0); 2],
            centre: V::all(0.25),
            y: nodes(),
            a: vec![V::all(0.0); 4 * n],
            load: nodes(),
            target: Vec::new(),
            edges,
            edge_at,
            regularised: false,
        }
    }

    /// Puts a run into a lane: its r, its load vector, its proximal weight and where it starts.
    ///
    /// # Panics
    /// If a vector has the wrong length for the grid, or r is not positive.
    pub fn enter(&mut self, lane: usize, r: f64, load: &[N], weight: f64, start: &Pair) {
        assert!(load.len() == self.grid.nodes() && start.y.len() == self.grid.nodes());
        assert!(start.a.len() == self.a.len() && r > 0.0);
        self.y.iter_mut().zip(&start.y).for_each(|(y, start)| y.0[lane] = N::of(*start));
        self.a.iter_mut().zip(&start.a).for_each(|(a, start)| a.0[lane] = N::of(*start));
        self.load.iter_mut().zip(load).for_each(|(load, f)| load.0[lane] = *f);
        self.r.0[lane] = N::of(r);
        let shift = weight * self.grid.h() * self.grid.h();
        self.shift.0[lane] = N::of(shift);
        self.centre.0[lane] = N::of(1.0 / (4.0 + shift));
        for (k, value) in [2.0 + 0.5 * shift, 1.0 + 0.25 * shift].into_iter().enumerate() {
            let [diagonal, inverse] = if k == 0 { &mut self.edge } else { &mut self.corner };
            (diagonal.0[lane], inverse.0[lane]) = (N::of(value), N::of(1.0 / value));
        }
        if weight > 0.0 && !self.regularised {
            self.regularised = true;
            self.target = self.load.clone();
        }
        self.regularise(lane);
    }

    /// Sets the proximal term to pull towards y as it is now.
    pub fn regularise(&mut self, lane: usize) {
        if !self.regularised {
            return;
        }
        let (n, side, shift) = (self.grid.cells(), self.grid.side(), self.shift.0[lane]);
        let half = |k: usize| N::of(if k == 0 || k == n { 0.5 } else { 1.0 });
        for (k, target) in self.target.iter_mut().enumerate() {
            let load = self.load[k].0[lane];
            target.0[lane] = match shift > N::of(0.0) {
                true => load + half(k % side) * half(k / side) * shift * self.y[k].0[lane],
                false => load,
            };
        }
    }

    /// (9)-(11) in every lane.
    pub fn sweep(&mut self, arithmetic: &mut impl Arithmetic<N>) {
        vectorised(
            #[inline(always)]
            || self.sweep_inline(arithmetic),
        );
    }

    #[inline(always)]
    fn sweep_inline(&mut self, arithmetic: &mut impl Arithmetic<N>) {
        let (n, all) = (self.grid.cells(), self.edges.len());
        match self.order {
            Order::Lexicographic => {
                self.relax_boundary(0, n + 1, arithmetic);
                // Two boundary nodes in each row between the first and the last.
                let ends = |j: usize| n + 1 + 2 * (j - 1);
                let mut j = 1;
                while j + 1 < n {
                    self.relax_boundary(ends(j), 1, arithmetic);
                    self.relax_boundary(ends(j + 1), 1, arithmetic);
                    self.relax_two_rows(j, arithmetic);
                    self.relax_boundary(ends(j) + 1, 1, arithmetic);
                    self.relax_boundary(ends(j + 1) + 1, 1, arithmetic);
                    j += 2;
                }
                if j < n {
                    self.relax_boundary(ends(j), 1, arithmetic);
                    self.relax_row(j, arithmetic);
                    self.relax_boundary(ends(j) + 1, 1, arithmetic);
                }
                self.relax_boundary(all - n - 1, n + 1, arithmetic);
            }
            Order::BoundaryFirst => {
                self.relax_boundary(0, all, arithmetic);
                (1..n).for_each(|j| self.relax_row(j, arithmetic));
            }
            Order::InteriorFirst => {
                (1..n).for_each(|j| self.relax_row(j, arithmetic));
                self.relax_boundary(0, all, arithmetic);
            }
        }
    }

    /// (9) at the interior nodes of row `j`.
    #[inline(always)]
    fn relax_row(&mut self, j: usize, arithmetic: &mut impl Arithmetic<N>) {
        let side = self.grid.side();
        let load = if self.regularised { &self.target } else { &self.load };
        let (below, rest) = self.y.split_at_mut(j * side);
        let (row, above) = rest.split_at_mut(side);
        let (south, north) = (&below[(j - 1) * side..][..side], &above[..side]);
        let (row, load) = (&mut row[..side], &load[j * side..][..side]);
        let mut west = row[0];
        for i in 1..side - 1 {
            let sum = arithmetic.star([south[i], north[i], row[i + 1], load[i], west]);
            west = arithmetic.node(self.centre * sum);
            row[i] = west;
        }
    }

    /// (9) at the interior nodes of rows `j` and `j + 1`, the upper one column behind the lower: neither waits for
    /// the other, and each node finds the values that it finds row by row.
    #[inline(always)]
    fn relax_two_rows(&mut self, j: usize, arithmetic: &mut impl Arithmetic<N>) {
        let side = self.grid.side();
        let load = if self.regularised { &self.target } else { &self.load };
        let (below, rest) = self.y.split_at_mut(j * side);
        let (lower, rest) = rest.split_at_mut(side);
        let (upper, above) = rest.split_at_mut(side);
        let (south, north) = (&below[(j - 1) * side..][..side], &above[..side]);
        let [lower_load, upper_load] = [j, j + 1].map(|j| &load[j * side..][..side]);
        let centre = self.centre;
        let mut relax = |terms| {
            let sum = arithmetic.star(terms);
            arithmetic.node(centre * sum)
        };
        lower[1] = relax([south[1], upper[1], lower[2], lower_load[1], lower[0]]);
        let [mut west, mut west_above] = [lower[1], upper[0]];
        for i in 2..side - 1 {
            let (before, beside) = (west, upper[i]);
            west = relax([south[i], beside, lower[i + 1], lower_load[i], west]);
            west_above = relax([before, north[i - 1], beside, upper_load[i - 1], west_above]);
            (lower[i], upper[i - 1]) = (west, west_above);
        }
        let i = side - 2;
        upper[i] = relax([west, north[i], upper[i + 1], upper_load[i], west_above]);
    }

    /// (10) and (11) at `count` boundary nodes from the `first` on in the order of rows.
    #[inline(always)]
    fn relax_boundary(&mut self, first: usize, count: usize, arithmetic: &mut impl Arithmetic<N>) {
        let load = if self.regularised { &self.target } else { &self.load };
        for edge in &self.edges[first..first + count] {
            let (node, y) = (edge.node as usize, &self.y);
            let along = V::all(0.5) * (y[edge.along[0] as usize] + y[edge.along[1] as usize]);
            let (sum, [diagonal, inverse], h) = match edge.inward {
                Some(inner) => {
                    let sum = arithmetic.edge([along, y[inner as usize], load[node]]);
                    (sum, &self.edge, self.weights[0])
                }
                None => (along + load[node], &self.corner, self.weights[1]),
            };
            let (a, r) = (&self.a[edge.place as usize], &self.r);
            let psi = *inverse * sum;
            let least = V(from_fn(|l| a.0[l] / r.0[l]));
            let free: [bool; LANES] = from_fn(|l| psi.0[l] >= least.0[l]);
            let next = match free.iter().all(|free| *free) {
                true => psi,
                false => V(from_fn(|l| {
                    let held = (sum.0[l] + h * a.0[l]) / (diagonal.0[l] + h * r.0[l]);
                    if free[l] { psi.0[l] } else { held }
                })),
            };
            self.y[node] = arithmetic.node(next);
        }
    }

    /// (12) in the lanes that step, and the largest change in each.
    pub fn step(
        &mut self,
        steps: [bool; LANES],
        arithmetic: &mut impl Arithmetic<N>,
    ) -> [f64; LANES] {
        vectorised(
            #[inline(always)]
            || self.step_inline(steps, arithmetic),
        )
    }

    #[inline(always)]
    fn step_inline(
        &mut self,
        steps: [bool; LANES],
        arithmetic: &mut impl Arithmetic<N>,
    ) -> [f64; LANES] {
        let zero = N::of(0.0);
        let mut changes = [zero; LANES];
        for edge in &self.edges {
            let (y, a) = (&self.y[edge.node as usize], &mut self.a[edge.place as usize]);
            let next: [N; LANES] = from_fn(|l| arithmetic.step(a.0[l], self.r.0[l], y.0[l]));
            let next = next.map(|next| if next > zero { next } else { zero });
            let next: [N; LANES] = from_fn(|l| if steps[l] { next[l] } else { a.0[l] });
            let change: [N; LANES] =
                from_fn(|l| if next[l] > a.0[l] { next[l] - a.0[l] } else { a.0[l] - next[l] });
            changes = from_fn(|l| if change[l] > changes[l] { change[l] } else { changes[l] });
            *a = V(next);
        }
        changes.map(N::wide)
    }

    /// Whether a measure is at most `bound` everywhere in a lane; NaN never is.
    ///
    /// The node `witness`, which broke the bound last, is tried first, then the rows from its own on.
    pub fn within(&self, lane: usize, measure: Measure, bound: f64, witness: &mut usize) -> bool {
        let above = |value: f64| value > bound || value.is_nan();
        if above(self.value(lane, measure, *witness)) {
            return false;
        }
        let side = self.grid.side();
        let first = *witness / side;
        for j in (first..side).chain(0..first) {
            let (value, node) = self.worst_in_row(lane, measure, j);
            if above(value) {
                *witness = node;
                return false;
            }
        }
        true
    }

    /// The largest value of a measure over all nodes of a lane; NaN if any is.
    pub fn worst(&self, lane: usize, measure: Measure) -> f64 {
        let mut worst = f64::NEG_INFINITY;
        for j in 0..self.grid.side() {
            let (value, _) = self.worst_in_row(lane, measure, j);
            if value.is_nan() {
                return value;
            }
            worst = worst.max(value);
        }
        worst
    }

    /// The same in row `j`, and where it is.
    fn worst_in_row(&self, lane: usize, measure: Measure, j: usize) -> (f64, usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let mut worst = (f64::NEG_INFINITY, 0);
        let mut note = |value: f64, node: usize| {
            if value > worst.0 || value.is_nan() && !worst.0.is_nan() {
                worst = (value, node);
            }
        };
        let edges = match j {
            0 => 0..n + 1,
            _ if j == n => self.edges.len() - n - 1..self.edges.len(),
            _ => n + 1 + 2 * (j - 1)..n + 1 + 2 * j,
        };
        for edge in &self.edges[edges] {
            note(self.on_boundary(lane, measure, edge), edge.node as usize);
        }
        if j != 0 && j != n {
            (j * side + 1..j * side + n).for_each(|k| note(self.inside(lane, measure, k), k));
        }
        worst
    }

    /// The measure at a node, rounded as in [`Plain::gradient`](crate::saddle::Plain::gradient).
    fn value(&self, lane: usize, measure: Measure, node: usize) -> f64 {
        match self.edges.get(self.edge_at[node] as usize) {
            Some(edge) => self.on_boundary(lane, measure, edge),
            None => self.inside(lane, measure, node),
        }
    }

    /// F, or F with the proximal term where the measure has it.
    #[inline(always)]
    fn load_of(&self, lane: usize, measure: Measure, node: usize) -> N {
        let with_term = measure == Measure::Inner && self.regularised;
        if with_term { self.target[node].0[lane] } else { self.load[node].0[lane] }
    }

    #[inline(always)]
    fn inside(&self, lane: usize, measure: Measure, node: usize) -> f64 {
        let (side, y) = (self.grid.side(), |k: usize| self.y[k].0[lane]);
        let (across, along) = (y(node - side) + y(node + side), y(node - 1) + y(node + 1));
        let mut flux = N::of(4.0) * y(node) - across - along - self.load_of(lane, measure, node);
        if measure == Measure::Inner {
            flux = flux + self.shift.0[lane] * y(node);
        }
        let flux = flux.wide();
        if measure == Measure::Signed { flux } else { flux.abs() }
    }

    #[inline(always)]
    fn on_boundary(&self, lane: usize, measure: Measure, edge: &Edge) -> f64 {
        let y = |k: usize| self.y[k].0[lane];
        let (node, half, zero) = (edge.node as usize, N::of(0.5), N::of(0.0));
        let (here, load) = (y(node), self.load_of(lane, measure, node));
        let along = half * (y(edge.along[0] as usize) + y(edge.along[1] as usize));
        let mut flux = match edge.inward {
            Some(inner) => N::of(2.0) * here - along - y(inner as usize) - load,
            None => here - along - load,
        };
        if measure == Measure::Kkt {
            return if here < flux { here.wide().abs() } else { flux.wide().abs() };
        }
        if measure == Measure::Inner && self.shift.0[lane] > zero {
            // As `Gradient` adds it: the mass of a row, less half of it at the row's ends.
            let (n, side) = (self.grid.cells(), self.grid.side());
            let outer = node / side == 0 || node / side == n;
            let mass = if outer { half * self.shift.0[lane] } else { self.shift.0[lane] };
            flux = flux + mass * here;
            if [0, n].contains(&(node % side)) {
                flux = flux - half * mass * here;
            }
        }
        let pull = self.a[edge.place as usize].0[lane] - self.r.0[lane] * here;
        let h = self.weights[usize::from(edge.inward.is_none())];
        let value = (flux - h * if pull > zero { pull } else { zero }).wide();
        if measure == Measure::Signed { value } else { value.abs() }
    }

    /// The iterates of a lane.
    pub fn pair(&self, lane: usize) -> Pair {
        let take = |from: &[V<N>]| from.iter().map(|v| v.0[lane].wide()).collect();
        Pair { y: take(&self.y), a: take(&self.a) }
    }
}
