//! The iterates of several runs on one network, node by node with a number per run: [`Plain`](crate::saddle::Plain), in
//! all lanes at once.

use super::arithmetic::{LaneLaws, V};
use super::{LANES, LaneEngine};
use crate::discrete::network::{Network, NodeCondition};
use crate::machine::simd::vectorised;
use crate::problem::law::{ContactNode, Law};
use crate::saddle::stopping::{GradientTerms, RoundingFloor, size};
use crate::saddle::{Engine, GradientMeasure, Pair, RunStart};
use std::array::from_fn;
use std::borrow::Cow;

/// The iterates of all lanes, without a proximal term.
pub(in crate::saddle) struct NetworkLanes<'a> {
    network: &'a Network,
    laws: LaneLaws,
    r: V,
    y: Vec<V>,
    a: Vec<V>,
    load: Vec<V>,
    /// In each lane, the node that last broke a bound, the likeliest to break the next.
    witnesses: [usize; LANES],
}

impl<'a> NetworkLanes<'a> {
    /// All lanes at zero.
    pub(in crate::saddle) fn new(network: &'a Network) -> Self {
        let zero = |length| vec![V::all(0.0); length];
        Self {
            network,
            laws: LaneLaws::all(Law::SIGNORINI),
            r: V::all(1.0),
            y: zero(network.nodes()),
            a: zero(network.contact().len()),
            load: zero(network.nodes()),
            witnesses: [0; LANES],
        }
    }

    /// `start` plus the sum of weight times y over the coupled nodes, added from left to right.
    #[inline(always)]
    fn add_row(&self, node: usize, start: V) -> V {
        let (row, mut sum) = (self.network.row(node), start);
        for (&other, &weight) in row.others.iter().zip(row.weights) {
            sum = sum + self.y[other as usize] * weight;
        }
        sum
    }

    #[inline(always)]
    fn sweep_inline(&mut self) {
        let network = self.network;
        for node in 0..network.nodes() {
            let sum = self.add_row(node, self.load[node]);
            let diagonal = network.diagonal()[node];
            let divided = |sum: V| V(sum.0.map(|sum| sum / diagonal));
            self.y[node] = match network.condition(node) {
                NodeCondition::Inner => divided(sum),
                NodeCondition::Fixed => V::all(0.0),
                NodeCondition::Contact(b) => {
                    let measure = network.contact()[b].measure;
                    let row = [sum, self.a[b], self.r];
                    self.laws.relax(row, V::all(diagonal), measure, divided)
                }
            };
        }
    }

    #[inline(always)]
    fn step_inline(&mut self, steps: [bool; LANES]) -> [f64; LANES] {
        let (mut changes, mut not_finite) = (V::all(0.0), V::all(0.0));
        for (a, &ContactNode { node, .. }) in self.a.iter_mut().zip(self.network.contact()) {
            let next = *a - self.r * self.y[node];
            let next = V(from_fn(|l| if steps[l] { next.0[l] } else { a.0[l] }));
            // Zero, unless a value is no finite number.
            not_finite = not_finite + next * V::all(0.0);
            let next = self.laws.project(next);
            changes = (next - *a).abs().greatest(changes);
            *a = next;
        }
        (changes + not_finite).0
    }

    /// The measure at a node, rounded as in [`Plain`](crate::saddle::Plain).
    #[inline(always)]
    fn at_node(&self, measure: GradientMeasure, node: usize) -> V {
        let y = self.y[node];
        let gradient = y * self.network.diagonal()[node] - self.add_row(node, self.load[node]);
        let value = match self.network.condition(node) {
            NodeCondition::Inner => gradient,
            NodeCondition::Fixed if measure == GradientMeasure::Kkt => y,
            NodeCondition::Fixed => V::all(0.0),
            NodeCondition::Contact(b) => {
                let h = self.network.contact()[b].measure;
                if measure == GradientMeasure::Kkt {
                    return self.laws.residual(y, gradient, h);
                }
                gradient - self.laws.project(self.a[b] - self.r * y) * h
            }
        };
        if measure == GradientMeasure::Signed { value } else { value.abs() }
    }
}

impl LaneEngine for NetworkLanes<'_> {
    fn enter(&mut self, lane: usize, law: Law, run: &RunStart<'_>) {
        let &RunStart { r, load, method, pair: start } = run;
        assert!(load.len() == self.y.len() && start.y.len() == self.y.len());
        assert!(start.a.len() == self.a.len() && r > 0.0);
        assert!(method.weight() == 0.0, "a proximal term has an engine of its own");
        self.laws.set(lane, law);
        self.r.0[lane] = r;
        self.y.iter_mut().zip(&start.y).for_each(|(y, start)| y.0[lane] = *start);
        self.a.iter_mut().zip(&start.a).for_each(|(a, start)| a.0[lane] = *start);
        self.load.iter_mut().zip(load).for_each(|(load, f)| load.0[lane] = *f);
    }
}

impl Engine<LANES> for NetworkLanes<'_> {
    fn sweep(&mut self) {
        vectorised(
            #[inline(always)]
            || self.sweep_inline(),
        );
    }

    fn dual_step(&mut self, lanes: [bool; LANES]) -> [f64; LANES] {
        vectorised(
            #[inline(always)]
            || self.step_inline(lanes),
        )
    }

    fn centre(&mut self, _: usize) {}

    /// The nodes that broke the bounds last are tried first.
    fn within(&mut self, measure: GradientMeasure, bounds: [Option<f64>; LANES]) -> [bool; LANES] {
        vectorised(
            #[inline(always)]
            || {
                let mut open = from_fn(|l| {
                    let here = |bound| self.at_node(measure, self.witnesses[l]).0[l] <= bound;
                    bounds[l].is_some_and(here)
                });
                let bounds = bounds.map(Option::unwrap_or_default);
                for node in 0..self.y.len() {
                    if open == [false; LANES] {
                        break;
                    }
                    let value = self.at_node(measure, node);
                    for l in 0..LANES {
                        // NaN is within no bound.
                        let is_within = value.0[l] <= bounds[l];
                        if open[l] && !is_within {
                            (open[l], self.witnesses[l]) = (false, node);
                        }
                    }
                }
                open
            },
        )
    }

    fn worst(&mut self, measure: GradientMeasure) -> [f64; LANES] {
        vectorised(
            #[inline(always)]
            || {
                let (mut worst, mut nan) = (V::all(f64::NEG_INFINITY), V::all(0.0));
                for node in 0..self.y.len() {
                    let value = self.at_node(measure, node);
                    worst = value.greatest(worst);
                    nan = V(from_fn(|l| if value.0[l].is_nan() { value.0[l] } else { nan.0[l] }));
                }
                (worst + nan).0
            },
        )
    }

    fn floor(&self, lane: usize) -> RoundingFloor {
        let sizes = [&self.load, &self.y, &self.a].map(|of| {
            let of_lane: Vec<f64> = of.iter().map(|v| v.0[lane]).collect();
            size(&of_lane)
        });
        GradientTerms::on_network(self.network, self.r.0[lane]).floor(sizes)
    }

    fn pair(&self, lane: usize) -> Cow<'_, Pair> {
        let [y, a] = [&self.y, &self.a].map(|of| of.iter().map(|v| v.0[lane]).collect());
        Cow::Owned(Pair { y, a })
    }
}
