//! Cases of the claims: a claim holds in a case if a value is above a bound, which is stated here.

use super::runs::{ARROW_HURWICZ, ClaimRun};
use super::{ClaimsPlan, VARIANTS};
use crate::discrete::stop::Stop;
use crate::experiments::problems::TableProblem;
use crate::saddle::tolerance;
use serde::Serialize;

/// Counts that differ by less than this factor count as equal.
const EQUAL: f64 = 1.1;
/// Number of tolerances above which a change of the multiplier is considerable.
const CONSIDERABLE: f64 = 10.0;
/// Factor above which there are many more iterations.
const MANY: f64 = 2.0;
/// Least of the large values of r.
const LARGE: f64 = 10.0;
/// Variant of Uzawa's algorithm that takes fewest sweeps in a case.
const BEST: &str = "the best of these";
/// Claim on the last change of the multiplier under the signed rule.
const STILL_MOVES: &str = "still-moves";

/// Case of a claim.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ClaimCase {
    /// Claim: `depends-on-r`, `depends-on-large-r`, `depends-on-problem`, `still-moves`, `still-moves-printed`,
    /// `more-in-last`, `dual-costs`, `dual-costs-printed`, `cheaper than` a variant, `gain-depends-on-r`.
    claim: String,
    /// Number of the problem.
    problem: u8,
    /// End of the runs, as of [`ClaimRun`].
    end: String,
    /// KKT residual at which the runs end; none under a stopping rule.
    target: Option<f64>,
    /// Cells per side.
    cells: usize,
    /// Duality parameter; none if the case has several.
    r: Option<f64>,
    /// Value; none without runs that reached their ends.
    value: Option<f64>,
    /// Bound of the value.
    bound: f64,
    /// True if the value would be greater without the limit of sweeps.
    is_least: bool,
    /// True if the value is above the bound.
    holds: bool,
}

impl ClaimCase {
    /// Case of a claim about a run.
    fn new(claim: impl Into<String>, run: &ClaimRun, value: Option<f64>, bound: f64) -> Self {
        Self {
            claim: claim.into(),
            problem: run.problem,
            end: run.end.clone(),
            target: run.target,
            cells: run.cells,
            r: Some(run.r),
            value,
            bound,
            is_least: false,
            holds: value > Some(bound),
        }
    }

    /// Case of a claim about the greatest over the least of some values, for runs like this one with any r.
    fn spread(claim: &str, run: &ClaimRun, values: impl Iterator<Item = f64> + Clone) -> Self {
        let greatest = values.clone().reduce(f64::max);
        let value = greatest.zip(values.reduce(f64::min)).map(|(greatest, least)| greatest / least);
        Self { r: None, ..Self::new(claim, run, value, EQUAL) }
    }
}

/// Lists the cases of all claims for the sorted runs of a plan.
pub(super) fn cases(plan: &ClaimsPlan, runs: &[ClaimRun]) -> Vec<ClaimCase> {
    let mut cases = Vec::new();
    for problem in &plan.problems {
        let runs = of_problem(runs, problem.number);
        let finest = finest(&runs);
        cases.extend(over_r(problem, &finest));
        cases.extend(at_stops(problem, &finest));
        cases.extend(against_uzawa(&runs));
    }
    if let [first, .., last] = &plan.problems[..] {
        let [first, last] = [first, last].map(|problem| problem.number);
        cases.extend(more_in_last(&cases, [first, last]));
        cases.extend(of_both([first, last].map(|number| finest(&of_problem(runs, number)))));
    }
    cases
}

/// Runs of the problem with this number.
fn of_problem(runs: &[ClaimRun], number: u8) -> Vec<&ClaimRun> {
    runs.iter().filter(|run| run.problem == number).collect()
}

/// Runs of Arrow-Hurwicz on the finest grid of each end.
fn finest<'a>(runs: &[&'a ClaimRun]) -> Vec<&'a ClaimRun> {
    let mut finest = Vec::new();
    for &run in runs.iter().filter(|run| run.method == ARROW_HURWICZ) {
        if runs.iter().all(|other| other.end != run.end || other.cells <= run.cells) {
            finest.push(run);
        }
    }
    finest
}

/// Claims "the speed depends on r": in the paper's range of r, and for large r.
fn over_r(problem: &TableProblem, finest: &[&ClaimRun]) -> Vec<ClaimCase> {
    let least = problem.r.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = problem.r.iter().copied().fold(0.0, f64::max);
    let swept: Vec<_> = finest.iter().copied().filter(|run| run.is_swept).collect();
    let mut cases = Vec::new();
    for sweep in swept.chunk_by(|a, b| a.end == b.end) {
        let papers = sweep.iter().filter(|run| least <= run.r && run.r <= greatest);
        let papers = papers.map(|run| run.count());
        cases.push(ClaimCase::spread("depends-on-r", sweep[0], papers));
        let large = sweep.iter().filter(|run| run.r >= LARGE).map(|run| run.count());
        cases.push(ClaimCase::spread("depends-on-large-r", sweep[0], large));
    }
    cases
}

/// Claims "at the stop the multiplier still moves by more than ten tolerances" and "the dual criterion at least doubles
/// the iterations", for the paper's values of r.
fn at_stops(problem: &TableProblem, finest: &[&ClaimRun]) -> Vec<ClaimCase> {
    let tolerance = tolerance(problem.statement.fineness.cells().len());
    let mut cases = Vec::new();
    for run in finest.iter().filter(|run| problem.r.contains(&run.r)) {
        let (excess, end) = (run.delta_a / tolerance, run.end.trim_end_matches("-dual"));
        let without = finest.iter().find(|other| other.end == end && other.r == run.r);
        let factor = without.map(|without| run.count() / without.count());
        cases.extend(match &run.end[..] {
            "signed" => Some(ClaimCase::new(STILL_MOVES, run, Some(excess), CONSIDERABLE)),
            "printed" => {
                Some(ClaimCase::new("still-moves-printed", run, Some(excess), CONSIDERABLE))
            }
            "signed-dual" => Some(ClaimCase::new("dual-costs", run, factor, MANY)),
            "printed-dual" => Some(ClaimCase::new("dual-costs-printed", run, factor, MANY)),
            _ => None,
        });
    }
    cases
}

/// Claims "Arrow-Hurwicz takes fewer sweeps than Uzawa's algorithm", of each variant and of the best, where the former
/// reaches its end; and "the gain over exact inner minimisation depends on r".
fn against_uzawa(runs: &[&ClaimRun]) -> Vec<ClaimCase> {
    let compared = runs.iter().filter(|run| run.method == ARROW_HURWICZ);
    let compared: Vec<_> = compared.filter(|run| !rivals(run, runs).is_empty()).collect();
    let mut cases: Vec<ClaimCase> = Vec::new();
    for group in compared.chunk_by(|a, b| a.end == b.end && a.cells == b.cells) {
        let mut gains = Vec::new();
        for run in group.iter().filter(|run| run.stop == Stop::Converged) {
            let rivals = rivals(run, runs);
            let best = rivals.iter().min_by_key(|run| (run.stop != Stop::Converged, run.sweeps));
            let named = rivals.iter().map(|rival| (rival.method, rival));
            for (name, rival) in named.chain(best.map(|best| (BEST, best))) {
                let gain = rival.count() / run.count();
                if name == VARIANTS[0].name {
                    gains.push(gain);
                }
                cases.push(ClaimCase {
                    is_least: rival.stop != Stop::Converged,
                    ..ClaimCase::new(format!("cheaper than {name}"), run, Some(gain), 1.0)
                });
            }
        }
        cases.push(ClaimCase::spread("gain-depends-on-r", group[0], gains.iter().copied()));
    }
    cases
}

/// Runs of the variants of Uzawa's algorithm that differ from a run in nothing else.
fn rivals<'a>(run: &ClaimRun, runs: &[&'a ClaimRun]) -> Vec<&'a ClaimRun> {
    let rivals = runs.iter().copied().filter(|other| {
        let is_alike = other.end == run.end && other.cells == run.cells && other.r == run.r;
        is_alike && other.method != ARROW_HURWICZ
    });
    rivals.collect()
}

/// Claim "at the signed stop the multiplier moves more in the last problem than in the first", per r: the bound is the
/// value of the first problem.
fn more_in_last(cases: &[ClaimCase], [first, last]: [u8; 2]) -> Vec<ClaimCase> {
    let moves = cases.iter().filter(|case| case.claim == STILL_MOVES);
    let mut more = Vec::new();
    for case in moves.clone().filter(|case| case.problem == last) {
        for bound in moves.clone().filter(|other| other.problem == first && other.r == case.r) {
            let (claim, bound) = ("more-in-last".into(), bound.value.unwrap_or(f64::NAN));
            more.push(ClaimCase { claim, bound, holds: case.value > Some(bound), ..case.clone() });
        }
    }
    more
}

/// Claim "the speed depends on the problem": the counts of two problems on their finest grids differ, per end and r.
/// Runs that did not reach their end are left out.
fn of_both([first, last]: [Vec<&ClaimRun>; 2]) -> Vec<ClaimCase> {
    let mut cases = Vec::new();
    for one in first.iter().filter(|run| run.is_swept && run.stop == Stop::Converged) {
        let others = last.iter().filter(|run| run.end == one.end && run.r == one.r);
        for other in others.filter(|run| run.stop == Stop::Converged) {
            let counts = [one.count(), other.count()].into_iter();
            let case = ClaimCase::spread("depends-on-problem", other, counts);
            cases.push(ClaimCase { r: Some(one.r), ..case });
        }
    }
    cases
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statement::{Domain, Statement};

    /// Run to a KKT residual on one grid; it reaches the limit where there is no count.
    fn run(problem: u8, method: &'static str, r: f64, count: Option<usize>) -> ClaimRun {
        ClaimRun {
            problem,
            method,
            end: "1e-3".into(),
            target: Some(1e-3),
            cells: 16,
            r,
            is_swept: false,
            sweeps: count.unwrap_or(50),
            stop: if count.is_some() { Stop::Converged } else { Stop::IterationLimit },
            kkt: 0.0,
            delta_a: 0.0,
        }
    }

    /// Runs of two problems for two values of r; in one of them Arrow-Hurwicz does not converge.
    fn made_up() -> Vec<ClaimRun> {
        let counts = [
            (1, 1.0, Some(10), [Some(30), Some(20), None, Some(15)]),
            (1, 10.0, Some(20), [Some(20), Some(10), Some(40), None]),
            (2, 1.0, None, [Some(60), None, None, Some(45)]),
            (2, 10.0, Some(10), [Some(80), None, None, None]),
        ];
        let mut runs = Vec::new();
        for (problem, r, arrow_hurwicz, uzawa) in counts {
            runs.push(run(problem, ARROW_HURWICZ, r, arrow_hurwicz));
            let uzawa = VARIANTS.iter().zip(uzawa);
            runs.extend(uzawa.map(|(variant, count)| run(problem, variant.name, r, count)));
        }
        runs
    }

    /// Values of a claim in all problems; negative where they are bounds.
    fn values(claim: &str) -> Vec<f64> {
        let runs = made_up();
        let mut values = Vec::new();
        for number in [1, 2] {
            let runs: Vec<_> = runs.iter().filter(|run| run.problem == number).collect();
            for case in against_uzawa(&runs).iter().filter(|case| case.claim == claim) {
                let sign = if case.is_least { -1.0 } else { 1.0 };
                values.push(sign * case.value.unwrap());
                assert_eq!(case.holds, case.value.unwrap() > case.bound);
            }
        }
        values
    }

    #[test]
    fn gains_are_of_the_cases_where_arrow_hurwicz_converged() {
        assert_eq!(values("cheaper than Uzawa, exact inside"), [3.0, 1.0, 8.0]);
        assert_eq!(values("cheaper than proximal, exact inside"), [-5.0, 2.0, -5.0]);
        // Of two variants the best is the one that converged, though it took more sweeps than the limit of the other.
        assert_eq!(values("cheaper than the best of these"), [1.5, 0.5, 8.0]);
        assert_eq!(values("gain-depends-on-r"), [3.0, 1.0]);
    }

    #[test]
    fn of_runs_on_several_grids_the_finest_counts_and_the_dual_criterion_is_compared_with_its_own_rule()
     {
        let mut runs = Vec::new();
        for (end, cells, sweeps) in
            [("signed", 8, 9), ("signed", 16, 4), ("printed", 16, 8), ("printed-dual", 16, 20)]
        {
            let run = run(1, ARROW_HURWICZ, 10.0, Some(sweeps));
            runs.push(ClaimRun { end: end.into(), cells, delta_a: 1.0, ..run });
        }
        let runs: Vec<_> = runs.iter().collect();
        let statement = Statement::usual(Domain::square(), "else=-1");
        let problem = TableProblem { number: 1, r: vec![10.0], statement };
        let cases = at_stops(&problem, &finest(&runs));
        let found: Vec<_> = cases.iter().map(|case| (&case.claim[..], case.holds)).collect();
        let expected =
            [(STILL_MOVES, true), ("still-moves-printed", true), ("dual-costs-printed", true)];
        assert_eq!(found, expected);
        assert_eq!(cases[2].value, Some(2.5));
        assert_eq!(cases[0].cells, 16);
    }
}
