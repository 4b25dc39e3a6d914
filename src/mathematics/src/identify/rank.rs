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

/// Score of a candidate against a table, part by part.
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
    /// Objective of the search, to be made small: count misfit, then Delta a, then simplicity.
    pub fn total(&self) -> f64 {
        objective(self.misfit, self.delta_a_misfit, self.complexity)
    }
}

/// [`Score::total`] from its parts.
fn objective(misfit: f64, delta_a_misfit: f64, complexity: u32) -> f64 {
    misfit + DELTA_A_WEIGHT * delta_a_misfit + COMPLEXITY_WEIGHT * f64::from(complexity)
}

/// The largest count misfit of a run with this objective: it is attained with the right Delta a and one value.
fn count_misfit_below(objective: f64) -> f64 {
    (objective - COMPLEXITY_WEIGHT).max(0.0)
}

/// A candidate with its score and its own table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// The right-hand side.
    pub candidate: Candidate,
    /// Value as [`crate::problem::source::Source`] writes it.
    pub f: String,
    /// Score.
    pub score: Score,
    /// Counts, `None` where the iteration was given up.
    pub counts: Vec<Vec<Option<usize>>>,
    /// Delta a per row.
    pub delta_a: Vec<f64>,
    /// Integral of f over the square; (2) asks for less than zero.
    pub integral: f64,
}

/// True if a count is missed, and the objective: the smaller, the better.
type Rank = (bool, f64);

fn by_rank(a: &Rank, b: &Rank) -> Ordering {
    a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
}

/// A candidate as the search keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Ranked {
    pub(super) rank: Rank,
    pub(super) candidate: Candidate,
}

impl Ranked {
    /// Smaller rank first; the candidate itself decides ties, so that the order is total.
    fn order(&self, other: &Self) -> Ordering {
        let key = |c: &Candidate| (c.geometry, c.ticks.clone(), c.places);
        by_rank(&self.rank, &other.rank)
            .then_with(|| key(&self.candidate).cmp(&key(&other.candidate)))
    }
}

/// The best `most` candidates seen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Best {
    most: usize,
    list: Vec<Ranked>,
    /// Rank beyond which nothing is wanted, whatever the list; `None` for no such limit.
    ceiling: Option<Rank>,
}

impl Best {
    pub(super) fn new(most: usize) -> Self {
        Self { most: most.max(1), list: Vec::new(), ceiling: None }
    }

    /// An empty list that takes only what this one would.
    pub(super) fn successor(&self) -> Self {
        Self { ceiling: self.bar(), ..Self::new(self.most) }
    }

    pub(super) fn list(&self) -> &[Ranked] {
        &self.list
    }

    /// Smallest objective, if any candidate was kept.
    pub(super) fn objective(&self) -> Option<f64> {
        self.list.iter().map(|ranked| ranked.rank.1).reduce(f64::min)
    }

    /// Rank beyond which a candidate has no place, if there is one.
    fn bar(&self) -> Option<Rank> {
        let ranks = self.list.get(self.most - 1).map(|last| last.rank).into_iter();
        ranks.chain(self.ceiling).min_by(by_rank)
    }

    /// Count misfit above which a candidate has no place.
    pub(super) fn misfit_limit(&self) -> f64 {
        match self.bar() {
            None => f64::INFINITY,
            Some((true, objective)) => count_misfit_below(objective),
            Some((false, _)) => 0.0,
        }
    }

    pub(super) fn offer(&mut self, new: Ranked) {
        if self.bar().is_some_and(|bar| new.rank > bar) {
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

/// A candidate with its rank, or `None` if its count misfit passes `limit`.
pub(super) fn evaluate(
    evaluator: &mut Evaluator<'_>,
    candidate: Candidate,
    limit: f64,
) -> Option<Ranked> {
    let Forced { delta_a, total, .. } =
        evaluator.forced(candidate.geometry, &candidate.values(), limit);
    if delta_a.is_empty() || total > limit {
        return None;
    }
    let misfit = delta_a_misfit(evaluator.target(), &delta_a);
    let objective = objective(total, misfit, candidate.complexity());
    Some(Ranked { rank: (total > 0.0, objective), candidate })
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
