//! The lanes as an engine: measures of the iterates, node by node in all lanes at once.

use super::arithmetic::{V, each};
use super::lanes::{LaneEdge, Lanes};
use crate::discrete::norms::worst;
use crate::machine::simd::vectorised;

use crate::saddle::stopping::{GradientTerms, RoundingFloor};
use crate::saddle::{Engine, GradientMeasure, Pair};
use std::array::from_fn;
use std::borrow::Cow;

impl<const K: usize, L: Copy> Engine<K> for Lanes<K, L> {
    fn sweep(&mut self) {
        vectorised(
            #[inline(always)]
            || self.sweep_inline(),
        );
    }

    fn dual_step(&mut self, lanes: [bool; K]) -> [f64; K] {
        vectorised(
            #[inline(always)]
            || self.step_inline(lanes),
        )
    }

    fn centre(&mut self, lane: usize) {
        self.regularise(lane);
    }

    /// The nodes that broke the bounds last are tried first.
    fn within(&mut self, measure: GradientMeasure, bounds: [Option<f64>; K]) -> [bool; K] {
        let kind = usize::from(measure == GradientMeasure::Inner);
        vectorised(
            #[inline(always)]
            || {
                let mut witnesses = self.witnesses[kind];
                let mut open = from_fn(|l| {
                    let here = |bound| self.at_node(measure, witnesses[l]).0[l] <= bound;
                    bounds[l].is_some_and(here)
                });
                let side = self.grid.side();
                let Some(lane) = open.iter().position(|open| *open) else { return open };
                let (first, bounds) =
                    (witnesses[lane] / side, bounds.map(Option::unwrap_or_default));
                for j in (first..side).chain(0..first) {
                    let mut above = V::<K, L>::all(0.0);
                    self.in_row(
                        measure,
                        j,
                        #[inline(always)]
                        |value, _| {
                            // One comparison, which NaN fails, so that all lanes are compared at once.
                            let next =
                                each(|l| if value.0[l] <= bounds[l] { above.0[l] } else { 1.0 });
                            above = V::of(next);
                        },
                    );
                    for lane in 0..K {
                        if open[lane] && above.0[lane] == 1.0 {
                            open[lane] = false;
                            witnesses[lane] = self.largest_in_row(lane, measure, j);
                        }
                    }
                    if open == [false; K] {
                        break;
                    }
                }
                self.witnesses[kind] = witnesses;
                open
            },
        )
    }

    fn worst(&mut self, measure: GradientMeasure) -> [f64; K] {
        vectorised(
            #[inline(always)]
            || {
                let (mut worst, mut nan) = (V::<K, L>::all(f64::NEG_INFINITY), V::<K, L>::all(0.0));
                for j in 0..self.grid.side() {
                    self.in_row(
                        measure,
                        j,
                        #[inline(always)]
                        |value: V<K, L>, _| {
                            worst = value.greatest(worst);
                            nan = V::of(each(|l| {
                                if value.0[l].is_nan() { value.0[l] } else { nan.0[l] }
                            }));
                        },
                    );
                }
                (worst + nan).0
            },
        )
    }

    fn floor(&self, lane: usize) -> RoundingFloor {
        let target = if self.regularised { &self.target } else { &self.load };
        let sizes = [target, &self.y, &self.a].map(|of| worst(of.iter().map(|v| v.0[lane])));
        GradientTerms::on_square(self.grid, self.shift.0[lane], self.r.0[lane]).floor(sizes)
    }

    fn pair(&self, lane: usize) -> Cow<'_, Pair> {
        let [y, a] = [&self.y, &self.a].map(|of| of.iter().map(|v| v.0[lane]).collect());
        Cow::Owned(Pair { y, a })
    }
}

impl<const K: usize, L: Copy> Lanes<K, L> {
    /// Place at which the largest value of a measure in row `j` of a lane is, or one that is NaN.
    fn largest_in_row(&self, lane: usize, measure: GradientMeasure, j: usize) -> usize {
        let mut largest = (f64::NEG_INFINITY, 0);
        self.in_row(
            measure,
            j,
            #[inline(always)]
            |value, node| {
                let value = value.0[lane];
                if value > largest.0 || value.is_nan() {
                    largest = (value, node);
                }
            },
        );
        largest.1
    }

    /// Notes a measure at all nodes of row `j`, those of the boundary first.
    #[inline(always)]
    fn in_row(&self, measure: GradientMeasure, j: usize, mut note: impl FnMut(V<K, L>, usize)) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let edges = match j {
            0 => 0..n + 1,
            _ if j == n => self.edges.len() - n - 1..self.edges.len(),
            _ => n + 1 + 2 * (j - 1)..n + 1 + 2 * j,
        };
        for edge in &self.edges[edges] {
            note(self.on_boundary(measure, edge), edge.node as usize);
        }
        if j != 0 && j != n {
            let from = |first: usize| &self.y[first..][..n - 1];
            let (first, load) = (j * side + 1, self.load_of(measure));
            let (south, north) = (from(first - side), from(first + side));
            let (west, here, east) = (from(first - 1), from(first), from(first + 1));
            let load = &load[first..][..n - 1];
            for i in 0..n - 1 {
                let around = [south[i], north[i], west[i], east[i]];
                note(self.inside(measure, here[i], around, load[i]), first + i);
            }
        }
    }

    /// The measure at a node, rounded as in [`Plain::gradient`](crate::saddle::Plain::gradient).
    #[inline(always)]
    fn at_node(&self, measure: GradientMeasure, node: usize) -> V<K, L> {
        let (side, y) = (self.grid.side(), &self.y);
        match self.edges.get(self.edge_at[node] as usize) {
            Some(edge) => self.on_boundary(measure, edge),
            None => {
                let around = [y[node - side], y[node + side], y[node - 1], y[node + 1]];
                self.inside(measure, y[node], around, self.load_of(measure)[node])
            }
        }
    }

    /// F, or F with the proximal term where the measure has it.
    #[inline(always)]
    fn load_of(&self, measure: GradientMeasure) -> &[V<K, L>] {
        let with_term = measure == GradientMeasure::Inner && self.regularised;
        if with_term { &self.target } else { &self.load }
    }

    #[inline(always)]
    fn inside(
        &self,
        measure: GradientMeasure,
        here: V<K, L>,
        [south, north, west, east]: [V<K, L>; 4],
        load: V<K, L>,
    ) -> V<K, L> {
        let sum = (((load + east) + north) + south) + west;
        let flux = V::all(4.0) * here - sum;
        let flux = if measure == GradientMeasure::Inner { flux + self.shift * here } else { flux };
        if measure == GradientMeasure::Signed { flux } else { flux.abs() }
    }

    #[inline(always)]
    fn on_boundary(&self, measure: GradientMeasure, edge: &LaneEdge) -> V<K, L> {
        let (node, half, y) = (edge.node as usize, V::all(0.5), &self.y);
        let (here, load) = (y[node], self.load_of(measure)[node]);
        let [first, second, third] = edge.terms(y);
        let diagonal = if edge.is_corner { 1.0 } else { 2.0 };
        let mut flux = here * diagonal - (((load + first) + second) + third);
        if measure == GradientMeasure::Kkt {
            let h = self.weights[usize::from(edge.is_corner)];
            return self.law.residual(here, flux, h);
        }
        if measure == GradientMeasure::Inner {
            // As `Gradient` adds it: the mass of a row, less half of it at the row's ends.
            let (n, side) = (self.grid.cells(), self.grid.side());
            let outer = node / side == 0 || node / side == n;
            let mass = if outer { half * self.shift } else { self.shift };
            flux = flux + mass * here;
            if [0, n].contains(&(node % side)) {
                flux = flux - half * mass * here;
            }
        }
        let pull = self.a[edge.place as usize] - self.r * here;
        let h = V::all(self.weights[usize::from(edge.is_corner)]);
        let value = flux - h * self.law.project(pull);
        if measure == GradientMeasure::Signed { value } else { value.abs() }
    }
}
