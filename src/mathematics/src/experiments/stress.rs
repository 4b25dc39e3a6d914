//! Solvers under stress, and the values at which they fail: extreme parameters, data, tolerances and starts.

mod noise;
mod pending;
mod random;
mod runs;

use super::problems::{CONTACT, TableProblem};
use super::trial::Trial;
use super::{Findings, Rows};
use crate::discrete::stop::Stop;
use noise::LoadNoise;
use random::RandomProblems;
use runs::StressLoads;
use serde::{Deserialize, Serialize};

/// Input of the experiments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct StressPlan {
    /// Problems of the paper.
    ///
    /// If a solution is needed, the load is bilinear: with the paper's choice of side on the jumps, that
    /// of problem 1 has a positive sum, and there is nothing to converge to.
    problems: Vec<TableProblem>,
    /// Name and f of another problem, whose lift and multiplier are of order one.
    contact: (String, String),
    /// Cells per side on which the paper's iteration runs.
    coarse: usize,
    /// Cells per side on which multigrid runs.
    fine: usize,
    /// Bound of the paper's rules on `coarse`.
    tolerance: f64,
    /// Bound of the strict rule, relative to the largest load.
    strict: f64,
    /// Limit on the iterations of the paper's method.
    cap: usize,
    /// Deficit of the series that do not vary it: minus the sum of the load over the sum of its absolute
    /// values.
    deficit: f64,
    /// Number of random problems.
    random: usize,
}

impl StressPlan {
    /// Plan of the book.
    pub(super) fn new(problems: Vec<TableProblem>) -> Self {
        let (name, f) = CONTACT[0];
        Self {
            problems,
            contact: (name.into(), f.into()),
            coarse: 16,
            fine: 64,
            tolerance: 1e-3,
            strict: 1e-8,
            cap: 20_000,
            deficit: 0.3,
            random: 2000,
        }
    }
}

/// Run of a method under one kind of stress.
#[derive(Clone, Debug, Default, Serialize)]
struct StressRun {
    /// Series of runs that differ in one quantity x:
    ///
    /// - `duality`: r, one series per problem; `signed` with the paper's tolerance, `strict`;
    /// - `scaling`: the exponent of a power of ten by which f of the last problem is multiplied; the signed rule with
    ///   the tolerance multiplied as well (`scaled`) and as it is (`fixed`), `multigrid`;
    /// - `deficits`: the deficit, f constant on quadrants, the odd one positive and then negative; `strict`,
    ///   `multigrid`;
    /// - `tolerances`: the tolerance, relative to the largest load, down to and below the rounding floor, one series
    ///   per problem; `signed`, `strict`, `multigrid`;
    /// - `floors`: the cells per side, to the rounding floor; `multigrid`, and on coarse grids `strict` after many
    ///   iterations;
    /// - `starts`: a start far from the solution; `strict`;
    /// - `jumps`, `spikes`: the size of a jump of f beside 1, and of a spike in one node; `multigrid`.
    series: &'static str,
    /// Name of the problem; none if the series has one alone.
    problem: Option<String>,
    /// Name of the start in `starts`.
    start: Option<&'static str>,
    /// Quantity that the series varies; none in `starts`.
    x: Option<f64>,
    /// Method or rule: `signed` and `strict` are the paper's method under the signed rule, and under the printed one
    /// together with the dual one; `multigrid` goes to the rounding floor unless a tolerance is varied.
    method: &'static str,
    #[serde(flatten)]
    trial: Trial,
    /// True if the run returned NaN or infinity without reporting a failure.
    is_silent: bool,
}

impl StressRun {
    /// The run with its end.
    fn ended(self, trial: Trial) -> Self {
        let says_that_it_failed = matches!(trial.stop, None | Some(Stop::Diverged));
        let is_silent = trial.kkt.is_none() && !says_that_it_failed;
        Self { trial, is_silent, ..self }
    }
}

/// Tolerances with which the signed rule is met at one and the same iteration.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Plateau {
    /// Name of the problem.
    problem: Option<String>,
    /// Number of the iteration.
    steps: usize,
    /// Least of the tolerances, over the largest load.
    least: f64,
    /// Greatest of the tolerances, over the largest load.
    greatest: f64,
    /// KKT residual at this iteration.
    kkt: Option<f64>,
}

impl Plateau {
    /// Finds the plateau with most tolerances, which descend; none if there are fewer than three.
    fn of(runs: &[StressRun]) -> Option<Self> {
        let runs = runs.iter().filter(|run| run.series == "tolerances" && run.method == "signed");
        let met: Vec<_> = runs.filter(|run| run.trial.stop == Some(Stop::Converged)).collect();
        let same = met.chunk_by(|a, b| a.problem == b.problem && a.trial.steps == b.trial.steps);
        let longest = same.filter(|same| same.len() > 2).rev().max_by_key(|same| same.len())?;
        let (first, last) = (longest.first()?, longest.last()?);
        let Trial { steps, kkt, .. } = first.trial;
        Some(Self {
            problem: first.problem.clone(),
            steps,
            least: last.x?,
            greatest: first.x?,
            kkt,
        })
    }
}

/// Runs the experiments: tables `runs`, `plateau`, `random` of random problems, and `noise` of the load.
///
/// # Errors
/// If f cannot be read, a grid is too coarse, or a run of the tables does not meet its rule.
pub(super) fn stress(plan: &StressPlan) -> Result<Findings, String> {
    let loads = StressLoads::new(plan)?;
    let mut runs = pending::made(loads.coarse, loads.pending());
    runs.extend(loads.floors());
    let noise = LoadNoise::of(&plan.problems)?;
    Ok(Findings::from([
        ("plateau".into(), Rows::of(Plateau::of(&runs))),
        ("random".into(), Rows::of([RandomProblems::of(plan.random)])),
        ("noise".into(), Rows::of([noise])),
        ("runs".into(), Rows::of(runs)),
    ]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs under the signed rule that converged, with tolerances from 1e-2 on, each a hundredth of the one before.
    fn runs(problem: &str, steps: &[usize]) -> Vec<StressRun> {
        let mut runs = Vec::new();
        for (&steps, x) in steps.iter().zip([1e-2, 1e-4, 1e-6, 1e-8]) {
            runs.push(StressRun {
                series: "tolerances",
                problem: Some(problem.into()),
                method: "signed",
                x: Some(x),
                trial: Trial { stop: Some(Stop::Converged), steps, ..Trial::default() },
                ..StressRun::default()
            });
        }
        runs
    }

    #[test]
    fn a_plateau_has_three_tolerances_or_more() {
        assert_eq!(Plateau::of(&runs("one", &[3, 3, 5])), None);
        let both = [runs("one", &[3, 3, 3]), runs("two", &[3, 8, 8, 8]), runs("three", &[8, 8, 8])];
        let plateau = Plateau::of(&both.concat()).unwrap();
        assert_eq!((plateau.problem.as_deref(), plateau.steps), (Some("one"), 3));
        let plateau = Plateau::of(&both[1..].concat()).unwrap();
        assert_eq!((plateau.least, plateau.greatest, plateau.steps), (1e-8, 1e-4, 8));
    }

    #[test]
    fn a_run_is_silent_if_it_has_no_residual_and_does_not_say_why() {
        for (stop, kkt, is_silent) in [
            (None, None, false),
            (Some(Stop::Diverged), None, false),
            (Some(Stop::Converged), Some(1.0), false),
            (Some(Stop::Converged), None, true),
        ] {
            let trial = Trial { stop, kkt, ..Trial::default() };
            assert_eq!(StressRun::default().ended(trial).is_silent, is_silent);
        }
    }
}
