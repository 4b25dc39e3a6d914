//! The engine on any network: the definition, with the proximal term of Uzawa's method.

use super::Pair;
use super::engine::{Engine, RunStart};
use super::plain::Plain;
use super::stopping::{GradientMeasure, GradientTerms, RoundingFloor, size};
use crate::discrete::network::Network;
use std::borrow::Cow;

/// One run on a network.
pub(super) struct OnNetwork<'a> {
    problem: Plain<'a>,
    /// Network of the inner problem: the proximal term adds to the diagonal.
    inner: Cow<'a, Network>,
    /// Load vector of the inner problem: the centre of the proximal term adds to the load.
    target: Cow<'a, [f64]>,
    /// Factor of the proximal term.
    weight: f64,
    terms: GradientTerms,
    /// Iterates.
    pair: Pair,
}

impl<'a> OnNetwork<'a> {
    /// Prepares a run.
    ///
    /// # Panics
    /// If a vector has the wrong length for `network`, or r is not positive.
    pub(super) fn new(
        network: &'a Network,
        &RunStart { load, method, r, pair }: &RunStart<'a>,
    ) -> Self {
        assert!(r > 0.0, "the duality parameter r must be positive");
        assert!(load.len() == network.nodes() && pair.y.len() == load.len());
        assert!(pair.a.len() == network.contact().len());
        let weight = method.weight();
        let inner = match weight > 0.0 {
            true => Cow::Owned(network.clone().with_reaction(weight)),
            false => Cow::Borrowed(network),
        };
        let terms = GradientTerms::on_network(&inner, r);
        let problem = Plain { network, load, r };
        let (target, pair) = (load.into(), pair.clone());
        let mut engine = Self { problem, inner, target, weight, terms, pair };
        engine.centre(0);
        engine
    }

    /// The problem that a sweep relaxes.
    fn inner(&self) -> Plain<'_> {
        Plain { network: &self.inner, load: &self.target, ..self.problem }
    }

    /// Measure at a node.
    fn measure(&self, measure: GradientMeasure, node: usize) -> f64 {
        match measure {
            GradientMeasure::Inner => measure.of(self.inner().gradient(node, &self.pair)),
            GradientMeasure::Kkt => self.problem.residual(node, &self.pair.y),
            _ => measure.of(self.problem.gradient(node, &self.pair)),
        }
    }
}

impl Engine<1> for OnNetwork<'_> {
    fn sweep(&mut self) {
        let Self { problem, inner, target, pair, .. } = self;
        Plain { network: inner, load: target, ..*problem }.sweep(pair);
    }

    fn dual_step(&mut self, _: [bool; 1]) -> [f64; 1] {
        [self.problem.dual_step(&mut self.pair)]
    }

    fn centre(&mut self, _: usize) {
        if self.weight > 0.0 {
            let masses = self.problem.network.masses();
            for (node, target) in self.target.to_mut().iter_mut().enumerate() {
                *target = self.problem.load[node] + self.weight * masses[node] * self.pair.y[node];
            }
        }
    }

    fn within(&mut self, measure: GradientMeasure, [bound]: [Option<f64>; 1]) -> [bool; 1] {
        let nodes = 0..self.pair.y.len();
        [bound.is_some_and(|bound| {
            nodes.into_iter().all(|node| self.measure(measure, node) <= bound)
        })]
    }

    fn worst(&mut self, measure: GradientMeasure) -> [f64; 1] {
        let mut worst = f64::NEG_INFINITY;
        for node in 0..self.pair.y.len() {
            let value = self.measure(measure, node);
            if value.is_nan() {
                return [value];
            }
            worst = value.max(worst);
        }
        [worst]
    }

    fn floor(&self, _: usize) -> RoundingFloor {
        self.terms.floor([&self.target[..], &self.pair.y, &self.pair.a].map(size))
    }

    fn pair(&self, _: usize) -> Cow<'_, Pair> {
        Cow::Borrowed(&self.pair)
    }
}
