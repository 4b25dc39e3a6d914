//! The explained score of a candidate, and the order in which candidates are preferred.

use super::evaluate::{Evaluator, Forced};
use super::space::{Candidate, Geometry};
use super::{Target, agrees};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// Weight of a unit of Delta a misfit (a factor e beyond rounding) against a unit of count misfit.
///
/// Delta a is the largest of many nearly equal changes: it jumps where the counts do not, and tells less.
const DELTA_A_WEIGHT: f64 = 0.3;
/// Weight of one distinct value or one decimal place of f: it decides only between equals.
const COMPLEXITY_WEIGHT: f64 = 0.005;

/// How well a candidate explains a table, part by part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Counts that come out exactly in a free run.
    pub exact: usize,
    /// Number of counts.
    pub cells: usize,
    /// Values of Delta a that agree to the two printed digits.
    pub delta_a_exact: usize,
    /// Sum of `|ln|` of our Delta a over the published one, less what rounding allows.
    pub delta_a_misfit: f64,
    /// Total misfit of the forced run.
    pub misfit: f64,
    /// Distinct values of f plus their decimal places.
    pub complexity: u32,
}

/// Largest factor by which a Delta a is charged to miss.
const MOST_OFF: f64 = 8.0;

impl Score {
    /// What the search makes small: count misfit, then Delta a, then simplicity.
    pub fn total(&self) -> f64 {
        objective(self.misfit, self.delta_a_misfit, self.complexity)
    }
}

/// [`Score::total`] from its parts.
pub(super) fn objective(misfit: f64, delta_a_misfit: f64, complexity: u32) -> f64 {
    misfit + DELTA_A_WEIGHT * delta_a_misfit + COMPLEXITY_WEIGHT * f64::from(complexity)
}

/// The largest count misfit of a run with this objective: it is attained with the right Delta a and one value.
pub(super) fn count_misfit_below(objective: f64) -> f64 {
    (objective - COMPLEXITY_WEIGHT).max(0.0)
}

/// A candidate with its score and its own table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// The right-hand side.
    pub candidate: Candidate,
    /// Its value as [`crate::problem::source::Source`] writes it.
    pub f: String,
    /// Its score.
    pub score: Score,
    /// Its counts, `None` where the iteration was given up.
    pub counts: Vec<Vec<Option<usize>>>,
    /// Its Delta a per row.
    pub delta_a: Vec<f64>,
    /// Integral of f over the square; (2) asks for less than zero.
    pub integral: f64,
}

/// A candidate as the search keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Ranked {
    pub(super) objective: f64,
    pub(super) candidate: Candidate,
}

impl Ranked {
    /// Smaller objective first; the candidate itself decides ties, so that the order is total.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let key = |c: &Candidate| (c.geometry, c.ticks.clone(), c.places);
        self.objective
            .total_cmp(&other.objective)
            .then_with(|| key(&self.candidate).cmp(&key(&other.candidate)))
    }
}

/// The best `most` candidates seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Best {
    most: usize,
    list: Vec<Ranked>,
    /// Objective above which nothing is wanted, whatever the list; `None` for no such limit.
    ceiling: Option<f64>,
}

impl Best {
    pub(super) fn new(most: usize) -> Self {
        Self { most: most.max(1), list: Vec::new(), ceiling: None }
    }

    /// An empty list that takes only what this one would.
    pub(super) fn successor(&self) -> Self {
        let bar = self.bar();
        Self { ceiling: bar.is_finite().then_some(bar), ..Self::new(self.most) }
    }

    pub(super) fn list(&self) -> &[Ranked] {
        &self.list
    }

    /// Objective above which a candidate has no place.
    pub(super) fn bar(&self) -> f64 {
        let worst = self.list.get(self.most - 1).map_or(f64::INFINITY, |last| last.objective);
        self.ceiling.map_or(worst, |ceiling| ceiling.min(worst))
    }

    pub(super) fn offer(&mut self, new: Ranked) {
        if new.objective > self.bar() {
            return;
        }
        if let Err(at) = self.list.binary_search_by(|old| old.order(&new)) {
            self.list.insert(at, new);
            self.list.truncate(self.most);
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        other.list.into_iter().for_each(|ranked| self.offer(ranked));
    }
}

/// Delta a of a forced run against the published values: misfit beyond rounding.
pub(super) fn delta_a_misfit(target: &Target, delta_a: &[f64]) -> f64 {
    let one = |(&ours, &published): (&f64, &f64)| {
        // Printed with two digits, a value stands for half a unit of the second one either way.
        let unit = libm::pow(10.0, libm::log10(published).floor() - 1.0);
        let allowed = libm::log(1.0 + 0.5 * unit / published);
        let off = (libm::log(ours / published).abs() - allowed).max(0.0);
        let most = libm::log(MOST_OFF);
        if off.is_nan() { most } else { off.min(most) }
    };
    delta_a.iter().zip(&target.delta_a).map(one).sum()
}

/// The objective of a candidate, or `None` if its count misfit alone passes `bar`.
pub(super) fn evaluate(
    evaluator: &mut Evaluator<'_>,
    candidate: &Candidate,
    bar: f64,
) -> Option<f64> {
    let limit = count_misfit_below(bar);
    let Forced { delta_a, total, .. } =
        evaluator.forced(candidate.geometry, &candidate.values(), limit);
    if delta_a.is_empty() || total > limit {
        return None;
    }
    let misfit = delta_a_misfit(evaluator.target(), &delta_a);
    Some(objective(total, misfit, candidate.complexity()))
}

/// The full score of a candidate, with a free run; `geometry` is its own.
pub(super) fn explain(
    evaluator: &mut Evaluator<'_>,
    geometry: &Geometry,
    candidate: &Candidate,
) -> Found {
    let (target, values) = (evaluator.target(), candidate.values());
    let forced = evaluator.forced(candidate.geometry, &values, f64::INFINITY);
    let table = evaluator.free(candidate.geometry, &values);
    let pairs = table.counts.iter().flatten().zip(target.counts.iter().flatten());
    let same = |(ours, published): &(&f64, &f64)| agrees(**ours, **published);
    Found {
        f: geometry.source(&values).to_string(),
        score: Score {
            exact: pairs.filter(|(ours, published)| **ours == Some(**published)).count(),
            cells: target.cells(),
            delta_a_exact: table.delta_a.iter().zip(&target.delta_a).filter(same).count(),
            delta_a_misfit: delta_a_misfit(target, &forced.delta_a),
            misfit: forced.total,
            complexity: candidate.complexity(),
        },
        candidate: candidate.clone(),
        counts: table.counts,
        delta_a: table.delta_a,
        integral: geometry.areas().iter().zip(&values).map(|(area, value)| area * value).sum(),
    }
}
