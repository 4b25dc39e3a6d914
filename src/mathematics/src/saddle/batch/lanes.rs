//! The iterates of several runs on one grid, node by node with a number per run.

use super::LANES;
use super::arithmetic::{LaneAlignment, LaneLaw, V, each};
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
    pub(super) fn terms<const K: usize, L: Copy>(&self, y: &[V<K, L>]) -> [V<K, L>; 3] {
        each(|k| y[self.around[k] as usize] * self.weights[k])
    }
}

/// The iterates of all lanes.
#[derive(Clone)]
pub(crate) struct Lanes<const K: usize = LANES, L = LaneAlignment> {
    pub(super) grid: Grid,
    pub(super) law: LaneLaw<K, L>,
    order: Order,
    /// Weight of the multiplier in (7), h, and its weight at the corners.
    pub(super) weights: [f64; 2],
    pub(super) r: V<K, L>,
    /// The proximal term's share of an interior node.
    pub(super) shift: V<K, L>,
    /// Diagonals of edge and corner rows, each with its inverse, and the inverse inside.
    edge: [V<K, L>; 2],
    corner: [V<K, L>; 2],
    centre: V<K, L>,
    pub(super) y: Vec<V<K, L>>,
    pub(super) a: Vec<V<K, L>>,
    /// F, and with the proximal term.
    pub(super) load: Vec<V<K, L>>,
    pub(super) target: Vec<V<K, L>>,
    /// In the order of rows.
    pub(super) edges: Arc<[LaneEdge]>,
    /// Place in `edges` of the boundary node in column `i` and row `j`, by `j * side + i`.
    pub(super) edge_at: Arc<[u32]>,
    pub(super) regularised: bool,
    /// In each lane, the node that last broke a bound, the likeliest to break the next: on a measure of the outer
    /// problem, and on that of the inner one.
    pub(super) witnesses: [[usize; K]; 2],
}

/// No boundary node.
const INSIDE: u32 = u32::MAX;

/// (9) at an interior node: `centre` times the sum of load and neighbours. The order of the terms is part of the
/// definition: results are compared bit by bit.
#[inline(always)]
fn relaxed<const K: usize, L: Copy>(
    centre: V<K, L>,
    load: V<K, L>,
    [east, north, south, west]: [V<K, L>; 4],
) -> V<K, L> {
    centre * ((((load + east) + north) + south) + west)
}

impl<const K: usize, L: Copy> Lanes<K, L> {
    /// All lanes at zero, under one law, swept in this order, with the multiplier's weight at corners in units of h.
    pub(crate) fn new(grid: Grid, law: Law, order: Order, corner_weight: f64) -> Self {
        let n = grid.cells();
        let network = Network::of_square(grid, law);
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
            law: LaneLaw::new(law),
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
            witnesses: [[0; K]; 2],
        }
    }

    /// Puts a run into a lane.
    ///
    /// # Panics
    /// If a vector has the wrong length for the grid, or r is not positive.
    pub(crate) fn enter(&mut self, lane: usize, run: &RunStart<'_>) {
        let &RunStart { r, load, method, pair: start } = run;
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

    /// Puts a run of Arrow-Hurwicz into every lane, all with the same r, from zero and under the law; returns
    /// the load vectors, which the caller sets.
    ///
    /// # Panics
    /// If r is not positive, or a run before had a proximal term.
    pub(crate) fn enter_all(&mut self, r: f64) -> &mut [V<K, L>] {
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
                self.relax_rows(true);
                self.relax_boundary(all - n - 1, n + 1);
            }
            Order::BoundaryFirst => {
                self.relax_boundary(0, all);
                self.relax_rows(false);
            }
            Order::InteriorFirst => {
                self.relax_rows(false);
                self.relax_boundary(0, all);
            }
        }
    }

    /// (9) at the interior nodes, in bands of as many rows as hide the latency of each; if the rows have their ends,
    /// (10) and (11) there.
    ///
    /// Ends on the left come first: they use no new value of the band but those of the row below in the same column.
    /// Ends on the right come last: no node of the band uses their new values.
    #[inline(always)]
    fn relax_rows(&mut self, with_ends: bool) {
        let (n, most) = (self.grid.cells(), if K == 1 { 4 } else { 2 });
        let mut first = 1;
        while first < n {
            let rows = first..n.min(first + most);
            // Two boundary nodes in each row.
            let ends = rows.clone().filter(|_| with_ends).map(|j| n + 1 + 2 * (j - 1));
            ends.clone().for_each(|end| self.relax_boundary(end, 1));
            match rows.len() {
                1 => self.relax_band::<1>(first),
                2 => self.relax_band::<2>(first),
                3 => self.relax_band::<3>(first),
                _ => self.relax_band::<4>(first),
            }
            ends.for_each(|end| self.relax_boundary(end + 1, 1));
            first = rows.end;
        }
    }

    /// (9) at the interior nodes of `ROWS` rows from the `first` on, each one column behind the row below: none waits
    /// for another, and each node finds the values that it finds row by row.
    #[inline(always)]
    fn relax_band<const ROWS: usize>(&mut self, first: usize) {
        let n = self.grid.cells();
        // The first and last columns of a band have fewer rows at work: one node at a time.
        for t in 1..ROWS {
            (0..t).for_each(|k| self.relax_inside(t - k, first + k));
        }
        self.relax_steadily::<ROWS>(first, n - ROWS);
        for t in n..n + ROWS - 1 {
            (t + 1 - n..ROWS).for_each(|k| self.relax_inside(t - k, first + k));
        }
    }

    /// (9) at the interior node in column `i` and row `j`.
    #[inline(always)]
    fn relax_inside(&mut self, i: usize, j: usize) {
        let (side, y) = (self.grid.side(), &self.y);
        let node = j * side + i;
        let load = if self.regularised { &self.target } else { &self.load };
        let around = [y[node + 1], y[node + side], y[node - side], y[node - 1]];
        self.y[node] = relaxed(self.centre, load[node], around);
    }

    /// (9) at `steps` nodes of each row of a band, in row k from column `ROWS - k` on.
    #[inline(always)]
    fn relax_steadily<const ROWS: usize>(&mut self, first: usize, steps: usize) {
        let (side, centre) = (self.grid.side(), self.centre);
        let load = if self.regularised { &self.target } else { &self.load };
        let (below, rest) = self.y[(first - 1) * side..].split_at_mut(side);
        let (rows, above) = rest.split_at_mut(ROWS * side);
        let (below, above) = (&below[ROWS..][..steps], &above[1..][..steps]);
        let mut rows = rows.chunks_exact_mut(side);
        // The window of row k begins one column to the west.
        let rows: [_; ROWS] =
            from_fn(|k| &mut rows.next().expect("a row for each k")[ROWS - k - 1..][..steps + 2]);
        let loads: [_; ROWS] = from_fn(|k| &load[(first + k) * side + ROWS - k..][..steps]);
        let mut west: [V<K, L>; ROWS] = from_fn(|k| rows[k][0]);
        for t in 0..steps {
            // The node north of row k is the one east of row k + 1, and the node south of row k + 1 is the one that
            // row k has just left.
            let (mut south, mut east) = (below[t], rows[0][t + 2]);
            for k in 0..ROWS {
                let north = if k + 1 < ROWS { rows[k + 1][t + 2] } else { above[t] };
                let next = relaxed(centre, loads[k][t], [east, north, south, west[k]]);
                (south, east, west[k]) = (west[k], north, next);
                rows[k][t + 1] = next;
            }
        }
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
            self.y[node] = self.law.relax(row, *diagonal, h, |sum| *inverse * sum);
        }
    }

    #[inline(always)]
    pub(super) fn step_inline(&mut self, steps: [bool; K]) -> [f64; K] {
        let steps: V<K, L> = V::of(steps.map(|steps| f64::from(u8::from(steps))));
        let (mut changes, mut not_finite) = (V::all(0.0), V::all(0.0));
        for edge in &*self.edges {
            let (y, a) = (self.y[edge.node as usize], &mut self.a[edge.place as usize]);
            let next = *a - self.r * y;
            let next = V::of(each(|l| if steps.0[l] == 1.0 { next.0[l] } else { a.0[l] }));
            // Zero, unless a value is no finite number.
            not_finite = not_finite + next * V::all(0.0);
            let next = self.law.project(next);
            changes = (next - *a).abs().greatest(changes);
            *a = next;
        }
        (changes + not_finite).0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::saddle::{Method, Pair, Plain};
    use proptest::prelude::*;

    /// Iterate after three sweeps in the last of `K` lanes, whose bands are wider for one lane.
    fn swept<const K: usize, L: Copy>(grid: Grid, law: Law, run: &RunStart<'_>) -> Vec<f64> {
        let mut lanes = Lanes::<K, L>::new(grid, law, Order::Lexicographic, 1.0);
        lanes.enter(K - 1, run);
        (0..3).for_each(|_| lanes.sweep_inline());
        lanes.y.iter().map(|y| y.0[K - 1]).collect()
    }

    /// Numbers from -0.5 to 0.5.
    fn random(mut state: u64, count: usize) -> Vec<f64> {
        let mut numbers = Vec::with_capacity(count);
        for _ in 0..count {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            numbers.push((state >> 33) as f64 / (1u64 << 31) as f64 - 0.5);
        }
        numbers
    }

    proptest! {
        #[test]
        fn bands_of_any_height_give_the_definition_to_the_last_bit(
            n in 2usize..40, seed in any::<u64>(), r in 1e-3..1e6f64, weight in 0.0..1e3f64,
            friction in proptest::option::of(0.01..1.0f64),
        ) {
            let grid = Grid::new(n).unwrap();
            let [load, y, a] = [0, 1, 2].map(|k| random(seed ^ k, grid.nodes()));
            let law = friction.map_or(Law::SIGNORINI, |g| Law::friction(g).unwrap());
            let a = a[..grid.boundary_nodes()].iter().map(|a| law.project(*a)).collect();
            let mut pair = Pair { y, a };
            let start = pair.clone();
            let run = RunStart { load: &load, method: Method::ArrowHurwicz, r, pair: &start };
            let network = Network::of_square(grid, law);
            let definition = Plain { network: &network, load: &load, r };
            (0..3).for_each(|_| definition.sweep(&mut pair));
            prop_assert_eq!(&pair.y, &swept::<1, f64>(grid, law, &run));
            prop_assert_eq!(&pair.y, &swept::<LANES, LaneAlignment>(grid, law, &run));
            // With a proximal term, which the paper has not.
            let method = Method::Uzawa { weight, inner: 0.0, loose: false };
            let run = RunStart { method, ..run };
            prop_assert_eq!(swept::<1, f64>(grid, law, &run), swept::<LANES, LaneAlignment>(grid, law, &run));
        }
    }
}
