//! Solvers under stress, and the values at which they fail: extreme parameters, data, tolerances and starts.

mod noise;
mod pending;
mod random;
mod runs;
mod summary;

pub use noise::LoadNoise;
pub use random::RandomProblems;
pub use summary::{Plateau, StressSummary};

use super::Range;
use super::problems::{CONTACT, TableProblem};
use super::trial::Trial;
use pending::StressJobs;
use runs::StressLoads;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Index;

/// Input of the experiments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressPlan {
    /// Problems of the paper.
    ///
    /// If a solution is needed, f is averaged on its jumps: with the paper's choice of side on the jumps, the load
    /// of problem 1 has a positive sum, and there is nothing to converge to.
    pub problems: Vec<TableProblem>,
    /// Name and f of another problem, whose lift and multiplier are of order one.
    pub contact: (String, String),
    /// Cells per side on which the paper's iteration runs.
    pub coarse: usize,
    /// Cells per side on which multigrid runs.
    pub fine: usize,
    /// Bound of the paper's rules on `coarse`.
    pub tolerance: f64,
    /// Bound of the strict rule, relative to the largest load.
    pub strict: f64,
    /// Limit on the iterations of the paper's method.
    pub cap: usize,
    /// Deficit of the series that do not vary it: minus the sum of the load over the sum of its absolute
    /// values.
    pub deficit: f64,
    /// Number of random problems.
    pub random: usize,
}

impl StressPlan {
    /// Plan of the book.
    pub fn new(problems: Vec<TableProblem>) -> Self {
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

    /// Names of the problems, that of [`Self::contact`] last.
    pub fn names(&self) -> Vec<String> {
        let paper = self.problems.iter().map(|problem| format!("problem {}", problem.number));
        paper.chain([self.contact.0.clone()]).collect()
    }
}

/// Runs with one value of the varied quantity, or what each of them is to be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StressCase<X, T = Trial> {
    /// Value of the varied quantity.
    pub x: X,
    /// Runs by method or rule: `signed` and `strict` are the paper's method under the signed rule, and under the
    /// printed one together with the dual one; `multigrid` goes to the rounding floor unless a tolerance
    /// is varied.
    #[serde(flatten)]
    pub trials: BTreeMap<String, T>,
}

impl<X> Index<&str> for StressCase<X> {
    type Output = Trial;

    fn index(&self, name: &str) -> &Trial {
        &self.trials[name]
    }
}

/// Cases in the order of the varied quantity.
pub type Series<X> = Vec<StressCase<X>>;

/// Result of the experiments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stress {
    /// Input of the experiments.
    pub plan: StressPlan,
    /// Series over r, one per problem: `signed` with the paper's tolerance, `strict`.
    pub duality: Vec<Series<f64>>,
    /// Series over the exponent of a power of ten by which f of the last problem is multiplied: the signed rule with
    /// the tolerance multiplied as well (`scaled`) and as it is (`fixed`), `multigrid`.
    pub scaling: Series<i32>,
    /// Series over the deficit, f constant on quadrants, the odd one positive and then negative: `strict`, `multigrid`.
    pub deficits: [Series<f64>; 2],
    /// Series over the tolerance, relative to the largest load, down to and below the rounding floor, one per
    /// problem: `signed`, `strict`, `multigrid`.
    pub tolerances: Vec<Series<f64>>,
    /// Series over the cells per side, to the rounding floor: `multigrid`, and on coarse grids `strict` after many
    /// iterations.
    pub floors: Series<f64>,
    /// Series of starts far from the solution, by their names: `strict`, `multigrid`.
    pub starts: Series<String>,
    /// Series over the size of a jump of f beside 1: `multigrid`.
    pub jumps: Series<f64>,
    /// Series over the size of a spike of f in one node: `multigrid`.
    pub spikes: Series<f64>,
    /// Random problems.
    pub random: RandomProblems,
    /// Errors of the load that change a count of the tables.
    pub load_noise: LoadNoise,
    /// All runs together.
    pub tally: Tally,
    /// Numbers that the book mentions.
    pub summary: StressSummary,
}

/// All runs together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Number of runs.
    pub runs: usize,
    /// Runs whose solver claims a bound of the KKT residual.
    pub claims: usize,
    /// Runs whose claim is wrong.
    pub wrong: usize,
    /// Runs that returned NaN or infinity without reporting a failure.
    pub unreported: usize,
    /// Runs over r under the signed rule.
    pub signed: usize,
    /// Runs over r in which the signed rule was met with a KKT residual as large as the load.
    pub signed_unsolved: usize,
}

impl Stress {
    /// Every run but those of the random problems.
    pub fn trials(&self) -> impl Iterator<Item = &Trial> {
        let over_numbers = self.duality.iter().chain(&self.deficits).chain(&self.tolerances);
        trials_of(over_numbers.chain([&self.floors, &self.jumps, &self.spikes]))
            .chain(trials_of([&self.scaling]))
            .chain(trials_of([&self.starts]))
    }

    fn tally(&self) -> Tally {
        let mut tally = Tally::default();
        for trial in self.trials() {
            tally.runs += 1;
            tally.claims += usize::from(trial.holds.is_some());
            tally.wrong += usize::from(trial.holds == Some(false));
            tally.unreported += usize::from(trial.kkt.is_none() && !trial.says_that_it_failed());
        }
        let signed = self.duality.iter().flatten().map(|case| &case["signed"]);
        tally.signed = signed.clone().count();
        tally.signed_unsolved = signed.filter(|t| t.converged() && t.kkt >= Some(1.0)).count();
        tally
    }
}

fn trials_of<'a, X: 'a>(
    series: impl IntoIterator<Item = &'a Series<X>>,
) -> impl Iterator<Item = &'a Trial> {
    series.into_iter().flatten().flat_map(|case| case.trials.values())
}

/// Runs the experiments.
///
/// # Errors
/// If f cannot be read, a grid is too coarse, or a run of the tables does not meet its rule.
pub fn stress(plan: &StressPlan) -> Result<Stress, String> {
    let (runs, mut jobs) = (StressLoads::new(plan)?, StressJobs::default());
    let mut of_problems = [Vec::new(), Vec::new()];
    for loads in &runs.loads {
        of_problems[0].push(jobs.enlist(runs.duality(loads)));
        of_problems[1].push(jobs.enlist(runs.tolerances(loads)));
    }
    let scaling = jobs.enlist(runs.scaling());
    let deficits = [1.0, -1.0].map(|odd| jobs.enlist(runs.deficits(odd)));
    let starts = jobs.enlist(runs.starts());
    let [jumps, spikes] = [runs.jumps(), runs.spikes()].map(|pending| jobs.enlist(pending));
    let made = jobs.make(runs.coarse);
    let [duality, tolerances] =
        of_problems.map(|all| all.into_iter().map(|cases| made.series(cases)).collect());
    let mut stress = Stress {
        plan: plan.clone(),
        duality,
        scaling: made.series(scaling),
        deficits: deficits.map(|cases| made.series(cases)),
        tolerances,
        floors: runs.floors(),
        starts: made.series(starts),
        jumps: made.series(jumps),
        spikes: made.series(spikes),
        random: RandomProblems::of(plan.random),
        load_noise: LoadNoise::of(&plan.problems)?,
        tally: Tally::default(),
        summary: StressSummary::default(),
    };
    stress.tally = stress.tally();
    stress.summary = StressSummary::of(&stress);
    Ok(stress)
}
