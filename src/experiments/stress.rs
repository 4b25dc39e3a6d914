//! What breaks the solvers, and at which values: extreme parameters, data, tolerances, starts and precision.

mod crowd;
mod facts;
mod runs;

pub use crowd::Crowd;
pub use facts::{Exponents, Facts, Plateau, Span};

use super::problems::Problem;
use super::trial::Trial;
use runs::{Bench, single};
use serde::{Deserialize, Serialize};

/// What the experiments depend on.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// The paper's problems.
    ///
    /// Where a solution is needed f is averaged on its jumps: with the paper's side taken there, the load
    /// of problem 1 has a positive sum and nothing to converge to.
    pub problems: Vec<Problem>,
    /// Cells per side on which the paper's iteration runs.
    pub coarse: usize,
    /// Cells per side on which multigrid runs.
    pub fine: usize,
    /// Bound of the paper's rules on `coarse`.
    pub tolerance: f64,
    /// Bound of the strict rule, relative to the largest load.
    pub strict: f64,
    /// Cap on the iterations of the paper's method.
    pub cap: usize,
    /// The deficit where it is not what is varied.
    pub deficit: f64,
    /// Number of random problems.
    pub crowd: usize,
}

impl Plan {
    /// The sizes of the book.
    pub fn new(problems: Vec<Problem>) -> Self {
        Self {
            problems,
            coarse: 16,
            fine: 64,
            tolerance: 1e-3,
            strict: 1e-8,
            cap: 20_000,
            deficit: 0.3,
            crowd: 2000,
        }
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stress {
    /// As in the [`Plan`].
    pub coarse: usize,
    /// As in the [`Plan`].
    pub fine: usize,
    /// As in the [`Plan`].
    pub tolerance: f64,
    /// As in the [`Plan`].
    pub strict: f64,
    /// As in the [`Plan`].
    pub cap: usize,
    /// As in the [`Plan`].
    pub deficit: f64,
    /// The paper's method over r, one list per problem.
    pub duality: Vec<Vec<Duality>>,
    /// The last problem with f multiplied.
    pub scaling: Vec<Scaling>,
    /// f constant on quadrants with nearly zero mean, the odd quadrant positive and then negative.
    pub deficits: [Vec<Deficit>; 2],
    /// Tolerances down to and below the rounding floor, one list per problem.
    pub tolerances: Vec<Vec<Tolerance>>,
    /// What rounding leaves, on each grid.
    pub floors: Vec<Floor>,
    /// Starts that are not near anything.
    pub starts: Vec<Start>,
    /// Jumps of f.
    pub jumps: Vec<Load>,
    /// Spikes of f in one node.
    pub spikes: Vec<Load>,
    /// Random problems.
    pub crowd: Crowd,
    /// The tables' counts in single precision.
    pub single: Vec<Single>,
    /// All runs together.
    pub tally: Tally,
    /// What the prose of the book rests on.
    pub facts: Facts,
}

/// One r.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Duality {
    /// Duality parameter.
    pub r: f64,
    /// Stopped by the signed rule with the paper's tolerance.
    pub signed: Trial,
    /// Stopped by the printed rule and the dual one with the strict tolerance.
    pub strict: Trial,
}

/// One factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// Decimal logarithm of what f is multiplied by.
    pub exponent: i32,
    /// The paper's method, tolerance multiplied as well.
    pub scaled: Trial,
    /// The paper's method, tolerance as it is.
    pub fixed: Trial,
    /// Multigrid.
    pub multigrid: Trial,
}

/// One deficit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deficit {
    /// Minus the sum of the load over the sum of its absolute values.
    pub deficit: f64,
    /// The paper's method under the strict rule.
    pub saddle: Trial,
    /// Multigrid, to the rounding floor.
    pub multigrid: Trial,
}

/// One tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tolerance {
    /// Bound relative to the largest load.
    pub tolerance: f64,
    /// The paper's method under the signed rule with this bound.
    pub signed: Trial,
    /// The paper's method under the strict rule with this bound.
    pub strict: Trial,
    /// Multigrid asked for this natural residual.
    pub multigrid: Trial,
}

/// One grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Floor {
    /// Cells per side.
    pub cells: usize,
    /// Multigrid, to the rounding floor.
    pub multigrid: Trial,
    /// The paper's method after many iterations; only on coarse grids.
    pub saddle: Option<Trial>,
    /// The same in single precision.
    pub single: Option<Attained>,
}

/// What a run in single precision comes to, judged in double.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attained {
    /// Natural residual over `|F|_inf`.
    pub kkt: f64,
    /// Natural residual over `max |y|` and the epsilon of single precision.
    pub floor: f64,
}

/// One start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// In words.
    pub name: String,
    /// The paper's method under the strict rule.
    pub saddle: Trial,
    /// Multigrid, to the rounding floor.
    pub multigrid: Trial,
}

/// One load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Size of the jump or spike beside f of size 1.
    pub size: f64,
    /// Multigrid, to the rounding floor.
    pub multigrid: Trial,
}

/// A table in single precision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Single {
    /// Its number in the paper.
    pub number: u8,
    /// Counts.
    pub cells: usize,
    /// Those that are not as in double precision.
    pub changed: Vec<Changed>,
}

/// A count that the precision changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Changed {
    /// Duality parameter.
    pub r: f64,
    /// Cells per side.
    pub cells: usize,
    /// Iterations in double precision.
    pub double: usize,
    /// Iterations in single precision; none if the cap came first.
    pub single: Option<usize>,
}

/// All runs together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Runs.
    pub runs: usize,
    /// Runs whose solver says something of the KKT residual.
    pub claims: usize,
    /// Those of them that are wrong.
    pub denied: usize,
    /// Runs that returned something that is not a number and did not say so.
    pub silent: usize,
    /// Runs over r under the signed rule.
    pub signed: usize,
    /// Those of them in which it was met with a KKT residual as large as the load.
    pub met_far: usize,
}

impl Stress {
    /// Every run.
    pub fn trials(&self) -> Vec<&Trial> {
        let of_r = self.duality.iter().flatten().flat_map(|case| [&case.signed, &case.strict]);
        let of_f = self.scaling.iter().flat_map(|c| [&c.scaled, &c.fixed, &c.multigrid]);
        let deficits = self.deficits.iter().flatten().flat_map(|c| [&c.saddle, &c.multigrid]);
        let tolerances =
            self.tolerances.iter().flatten().flat_map(|c| [&c.signed, &c.strict, &c.multigrid]);
        let floors = self.floors.iter().flat_map(|c| [Some(&c.multigrid), c.saddle.as_ref()]);
        let starts = self.starts.iter().flat_map(|c| [&c.saddle, &c.multigrid]);
        let loads = self.jumps.iter().chain(&self.spikes).map(|case| &case.multigrid);
        of_r.chain(of_f)
            .chain(deficits)
            .chain(tolerances)
            .chain(floors.flatten())
            .chain(starts)
            .chain(loads)
            .collect()
    }

    fn tally(&self) -> Tally {
        let mut tally = Tally::default();
        for trial in self.trials() {
            tally.runs += 1;
            tally.claims += usize::from(trial.holds.is_some());
            tally.denied += usize::from(trial.holds == Some(false));
            let told = ["diverged", "refused"].contains(&trial.stop.as_str());
            tally.silent += usize::from(trial.kkt.is_none() && !told);
        }
        let signed = self.duality.iter().flatten().map(|case| &case.signed);
        tally.signed = signed.clone().count();
        tally.met_far = signed.filter(|t| t.stop == "converged" && t.kkt >= Some(1.0)).count();
        tally
    }
}

/// Runs the experiments.
///
/// # Errors
/// If f cannot be read, or grids do not nest.
pub fn stress(plan: &Plan) -> Result<Stress, String> {
    let bench = Bench::new(plan)?;
    let mut stress = Stress {
        coarse: plan.coarse,
        fine: plan.fine,
        tolerance: plan.tolerance,
        strict: plan.strict,
        cap: plan.cap,
        deficit: plan.deficit,
        duality: (0..bench.loads.len()).map(|problem| bench.duality(problem)).collect(),
        scaling: bench.scaling(),
        deficits: [1.0, -1.0].map(|odd| bench.deficits(odd)),
        tolerances: (0..bench.loads.len()).map(|problem| bench.tolerances(problem)).collect(),
        floors: bench.floors(),
        starts: bench.starts(),
        jumps: bench.jumps(),
        spikes: bench.spikes(),
        crowd: Crowd::of(plan.crowd),
        single: plan.problems.iter().map(single).collect::<Result<_, _>>()?,
        tally: Tally::default(),
        facts: Facts::default(),
    };
    stress.tally = stress.tally();
    stress.facts = Facts::of(&stress);
    Ok(stress)
}
