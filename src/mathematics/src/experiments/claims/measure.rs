//! Counts of each problem, gathered from the results of all runs.

use super::runs::{ClaimCase, ClaimJob, SWEPT, run_all};
use super::{
    BestParameter, ClaimLine, ClaimMeasure, ClaimTable, ClaimsPlan, Count, CountRow, KktTarget,
    Measured, UzawaCell, WeightRow,
};
use crate::discrete::end::End;
use crate::machine::threads::map;
use crate::saddle::{StopRule, tolerance};
use std::ops::RangeInclusive;

/// Makes all runs, and gathers the counts of each problem, and those for each weight of the proximal term.
pub(super) fn measure(plan: &ClaimsPlan) -> Result<(Vec<Measured>, Vec<WeightRow>), String> {
    let problems: Result<Vec<_>, String> =
        map(&plan.problems, 1, ClaimCase::new).into_iter().collect();
    let problems = problems?;
    let results = run_all(plan, &problems);
    let mut all = Vec::new();
    for (index, problem) in problems.iter().enumerate() {
        all.push(Gathered { index, problem, plan, results: &results }.measured());
    }
    let weights = map(&problems, 1, |problem| problem.weights(plan));
    Ok((all, weights))
}

/// A problem with the results of all runs.
struct Gathered<'a> {
    /// Index of the problem in the plan.
    index: usize,
    problem: &'a ClaimCase<'a>,
    plan: &'a ClaimsPlan,
    /// Results of [`run_all`].
    results: &'a [(ClaimJob, Vec<(End, f64)>)],
}

impl Gathered<'_> {
    fn measured(&self) -> Measured {
        let ClaimCase { problem, published, solvable, .. } = self.problem;
        Measured {
            number: problem.number,
            f: problem.statement.f.clone(),
            law: problem.statement.law,
            sums: [published, solvable].map(|loads| loads[loads.len() - 1].iter().sum()),
            rows: self.rows(),
            tables: StopRule::ALL.map(|rule| self.table(rule)).into(),
            cells: self.cells(),
        }
    }

    /// Ends of a run, with the KKT residuals, on each grid visited.
    fn results(&self, wanted: ClaimJob) -> &[(End, f64)] {
        let found = self.results.iter().find(|(job, _)| *job == wanted);
        &found.expect("every r was run").1
    }

    /// Results under a stopping rule, grid by grid.
    fn nested(&self, rule: StopRule, r: f64) -> &[(End, f64)] {
        let (problem, measure) = (self.index, ClaimMeasure::Rule(rule));
        self.results(ClaimJob { problem, measure, level: 0, variant: None, r })
    }

    /// Count of sweeps to a KKT residual on one grid.
    fn on_grid(&self, level: usize, target: f64, variant: Option<usize>, r: f64) -> Count {
        let (problem, measure) = (self.index, ClaimMeasure::Kkt(target));
        Count::of(&self.results(ClaimJob { problem, measure, level, variant, r })[0].0)
    }

    /// Indices of the grids whose number of cells per side lies in `cells`, with this number.
    fn grids(&self, cells: RangeInclusive<usize>) -> impl Iterator<Item = (usize, usize)> {
        let all = self.problem.grids.iter().map(|grid| grid.cells()).enumerate();
        all.filter(move |(_, n)| cells.contains(n))
    }

    fn rows(&self) -> Vec<CountRow> {
        let swept = self.plan.r();
        let mut rows = Vec::new();
        for rule in SWEPT {
            for (level, cells) in self.grids(0..=usize::MAX) {
                let counts =
                    swept.iter().map(|&r| Count::of(&self.nested(rule, r)[level].0)).collect();
                rows.push(CountRow::new(ClaimMeasure::Rule(rule), cells, &swept, counts));
            }
        }
        for &KktTarget { kkt: target, cells: finest } in &self.plan.targets {
            for (level, cells) in self.grids(0..=finest) {
                let counts = swept.iter().map(|&r| self.on_grid(level, target, None, r)).collect();
                rows.push(CountRow::new(ClaimMeasure::Kkt(target), cells, &swept, counts));
            }
        }
        rows
    }

    fn table(&self, rule: StopRule) -> ClaimTable {
        ClaimTable {
            rule,
            lines: self.problem.problem.r.iter().map(|&r| self.line(rule, r)).collect(),
        }
    }

    fn line(&self, rule: StopRule, r: f64) -> ClaimLine {
        let without_dual = match rule {
            StopRule::Signed | StopRule::SignedDual => StopRule::Signed,
            StopRule::Printed | StopRule::PrintedDual => StopRule::Printed,
        };
        let results = self.nested(rule, r);
        let (last, kkt) = results[results.len() - 1];
        let (fewer, _) = self.nested(without_dual, r)[results.len() - 1];
        ClaimLine {
            r,
            counts: results.iter().map(|(end, _)| Count::of(end)).collect(),
            factor: last.sweeps() as f64 / fewer.sweeps() as f64,
            delta_a: last.change(),
            excess: last.change() / tolerance(results.len()),
            kkt,
        }
    }

    fn cells(&self) -> Vec<UzawaCell> {
        let mut all = Vec::new();
        for &KktTarget { kkt: target, cells: finest } in &self.plan.targets {
            for (level, cells) in self.grids(self.plan.compared_from..=finest) {
                for &r in &self.plan.compared_r {
                    all.push(UzawaCell {
                        cells,
                        target,
                        r,
                        arrow_hurwicz: self.on_grid(level, target, None, r),
                        uzawa: [0, 1, 2, 3].map(|k| self.on_grid(level, target, Some(k), r)),
                    });
                }
            }
        }
        all
    }
}

impl CountRow {
    fn new(measure: ClaimMeasure, cells: usize, r: &[f64], counts: Vec<Count>) -> Self {
        let best = BestParameter::of(r, &counts);
        Self { measure, cells, counts, best }
    }
}

impl BestParameter {
    /// Finds the least of the counts for the values of `r`, ascending; none if no run reached its end.
    fn of(r: &[f64], counts: &[Count]) -> Option<Self> {
        let iterations = counts.iter().filter_map(|count| count.reached()).min()?;
        let at = counts.iter().position(|count| count.reached() == Some(iterations))?;
        let below = counts[..at].iter().rev().take_while(|count| count.is_near(iterations)).count();
        let above = counts[at + 1..].iter().take_while(|count| count.is_near(iterations)).count();
        Some(Self { r: r[at], iterations, flat: (r[at - below], r[at + above]) })
    }
}

impl Count {
    /// True if the run reached its end, with at most a tenth more than `least` iterations.
    fn is_near(self, least: usize) -> bool {
        self.reached().is_some_and(|count| 10 * count <= 11 * least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::stop::Stop;

    /// The best of some counts for r = 1, 10, 100, ..; runs without a count reach the limit of 10.
    fn best<const N: usize>(counts: [Option<usize>; N]) -> Option<(f64, usize, (f64, f64))> {
        let r: Vec<f64> = (0..N).map(|k| 10f64.powi(k as i32)).collect();
        let count = |count: Option<usize>| match count {
            Some(iterations) => Count { iterations, stop: Stop::Converged },
            None => Count { iterations: 10, stop: Stop::IterationLimit },
        };
        let row = CountRow::new(ClaimMeasure::Kkt(1e-3), 16, &r, counts.map(count).into());
        row.best.map(|BestParameter { r, iterations, flat }| (r, iterations, flat))
    }

    #[test]
    fn the_best_r_is_the_least_with_the_fewest_iterations_and_its_interval_has_no_gap() {
        let counts = [None, Some(11), Some(10), Some(10), Some(12), Some(10)];
        assert_eq!(best(counts), Some((100.0, 10, (10.0, 1000.0))));
        assert_eq!(best([Some(10), None, Some(10)]), Some((1.0, 10, (1.0, 1.0))));
        assert_eq!(best([None, Some(20)]), Some((10.0, 20, (10.0, 10.0))));
        assert_eq!(best([None, None]), None);
    }
}
