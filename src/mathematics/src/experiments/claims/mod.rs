//! Measurement of the paper's claims about the cost of its method: counts of sweeps, and a verdict on each claim.

mod measure;
mod ratios;
mod runs;
mod tally;
mod verdict;

pub use ratios::Ratios;
pub use tally::{ClaimTally, ClaimVerdict};
pub use verdict::{DualFactors, GainsAt, Spread, Verdicts};

use crate::discrete::end::End;
use crate::discrete::load::LoadRule;
use crate::discrete::stop::Stop;
use crate::experiments::power_of_ten;
use crate::experiments::problems::{FRICTION, FrictionProblem, TableProblem};
use crate::problem::law::LawParameter;
use crate::saddle::{Method, StopRule};
use crate::statement::{Domain, SaddleSettings, Statement};
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClaimsPlan {
    /// Problems of the paper.
    pub problems: Vec<TableProblem>,
    /// Least and greatest r of the sweep over r, as powers of ten.
    pub decades: (i32, i32),
    /// Values of r in each decade.
    pub per_decade: i32,
    /// KKT residuals to reach, over the largest component of F, each with the finest grid for which
    /// there is time, in cells per side.
    pub targets: Vec<KktTarget>,
    /// Sweeps on a grid after which a run towards a KKT residual has failed.
    pub cap: usize,
    /// Values of r at which methods are compared; all belong to the sweep over r.
    pub compared_r: Vec<f64>,
    /// Coarsest grid on which methods are compared, in cells per side.
    pub compared_from: usize,
    /// Weight of the proximal term.
    pub weight: f64,
    /// Other weights, whose costs are compared for one r.
    pub weights: Vec<f64>,
}

/// KKT residual to reach.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KktTarget {
    /// Residual over the largest component of F.
    pub kkt: f64,
    /// Cells per side of the finest grid for which there is time.
    pub cells: usize,
}

impl KktTarget {
    /// Residuals, each with its finest grid.
    pub fn all<const N: usize>(targets: [(f64, usize); N]) -> Vec<Self> {
        targets.map(|(kkt, cells)| Self { kkt, cells }).into()
    }
}

impl ClaimsPlan {
    /// Plan of the book for these problems.
    pub fn new(mut problems: Vec<TableProblem>) -> Self {
        problems.sort_by_key(|problem| problem.number);
        Self {
            problems,
            decades: (-1, 6),
            per_decade: 4,
            targets: KktTarget::all([(1e-3, 64), (1e-6, 32)]),
            cap: 50_000,
            compared_r: vec![1.0, 10.0, 100.0, 1e4, 1e6],
            compared_from: 16,
            weight: 1.0,
            weights: vec![0.0, 0.1, 1.0, 10.0, 100.0, 1000.0],
        }
    }

    /// Plan of the book for problems with friction: fewer values of r, and coarser grids.
    pub fn friction() -> Self {
        let mut problems = Vec::new();
        for (number, FrictionProblem { f, g }) in (1..).zip(FRICTION) {
            let statement = Statement {
                law: Some(LawParameter::Friction(g)),
                load: Some(LoadRule::LumpedAverage {}),
                saddle: Some(SaddleSettings {
                    max_iterations: 100_000,
                    ..SaddleSettings::default()
                }),
                ..Statement::usual(Domain::square(), f)
            };
            let r = vec![1e6, 10.0, 5.0, 1.0, 0.5];
            problems.push(TableProblem { number, r, statement });
        }
        Self {
            per_decade: 1,
            targets: KktTarget::all([(1e-3, 32), (1e-6, 16)]),
            compared_r: vec![1.0, 10.0, 100.0, 1e6],
            ..Self::new(problems)
        }
    }

    /// Values of r of the sweep over r, ascending.
    pub fn r(&self) -> Vec<f64> {
        let (low, high) = self.decades;
        let mut all = Vec::new();
        for k in low * self.per_decade..=high * self.per_decade {
            // Powers of ten as the paper writes them, to the last bit.
            let power = power_of_ten(k.div_euclid(self.per_decade));
            all.push(match k.rem_euclid(self.per_decade) {
                0 => power,
                rest => power * libm::exp10(f64::from(rest) / f64::from(self.per_decade)),
            });
        }
        all
    }
}

/// Result of the experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claims {
    /// Values of r of the sweep over r, ascending.
    pub r: Vec<f64>,
    /// KKT residuals to reach, each with the finest grid on which it was asked for.
    pub targets: Vec<KktTarget>,
    /// Sweeps on a grid after which a run towards a KKT residual has failed.
    pub cap: usize,
    /// Counts of each problem.
    pub problems: Vec<Measured>,
    /// Weights of the proximal term that are compared.
    pub weights: Vec<f64>,
    /// Counts for each of these weights, a row per problem.
    pub weight_rows: Vec<WeightRow>,
    /// Verdicts on the claims.
    pub verdicts: Verdicts,
}

/// Sweeps of the proximal method to a KKT residual on one grid, one count per weight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WeightRow {
    /// Name of the problem.
    pub name: String,
    /// Cells per side.
    pub cells: usize,
    /// One count per weight.
    pub counts: Vec<Count>,
    /// Sweeps of Arrow-Hurwicz.
    pub arrow_hurwicz: Count,
    /// Largest relative change of the count by a weight of at most 1, against the weight 0.
    pub change: f64,
    /// True if the method takes no more sweeps than Arrow-Hurwicz with some weight.
    pub ahead: bool,
}

/// Counts of a problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Number of the problem.
    pub number: u8,
    /// f in the notation of scenes.
    pub f: String,
    /// Law on the boundary; none for the paper's.
    pub law: Option<LawParameter>,
    /// Sum of the load on the finest grid, under the paper's stopping rules and towards a KKT residual.
    pub sums: [f64; 2],
    /// Sweep over r: a row per measure and grid.
    pub rows: Vec<CountRow>,
    /// Tables 1 and 2 in full under each stopping rule.
    pub tables: Vec<ClaimTable>,
    /// Arrow-Hurwicz against Uzawa.
    pub cells: Vec<UzawaCell>,
}

/// Measure of convergence by which a run over r ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimMeasure {
    /// A stopping rule on nested grids, with the paper's tolerances and load.
    Rule(StopRule),
    /// A KKT residual, from the coarser grid's solution, with the load averaged around nodes.
    Kkt(f64),
}

/// Iterations on a grid for each r of the sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CountRow {
    /// Measure by which the runs end.
    pub measure: ClaimMeasure,
    /// Cells per side.
    pub cells: usize,
    /// One count per r.
    pub counts: Vec<Count>,
    /// Best r, if a run reached its end.
    pub best: Option<BestParameter>,
}

/// Iterations, and the reason for which they ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Count {
    /// Iterations, or sweeps.
    pub iterations: usize,
    /// `converged` or `iteration-limit`.
    pub stop: Stop,
}

impl Count {
    /// Count of a run that has ended.
    fn of(end: &End) -> Self {
        Self { iterations: end.sweeps(), stop: end.stop }
    }

    /// Number of iterations, if the run reached its end.
    pub fn reached(self) -> Option<usize> {
        (self.stop == Stop::Converged).then_some(self.iterations)
    }
}

/// Least of the counts in a row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BestParameter {
    /// Smallest r with this count.
    pub r: f64,
    /// Least count.
    pub iterations: usize,
    /// Interval of r around the best one in which no count is more than a tenth above the least.
    pub flat: (f64, f64),
}

/// Table as the paper prints it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClaimTable {
    /// Stopping rule.
    pub rule: StopRule,
    /// Lines, one per r, in the paper's order.
    pub lines: Vec<ClaimLine>,
}

/// Line of a [`ClaimTable`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClaimLine {
    /// Duality parameter.
    pub r: f64,
    /// One count per grid.
    pub counts: Vec<Count>,
    /// Iterations on the finest grid over those without the dual criterion.
    pub factor: f64,
    /// Last change of the multiplier on the finest grid.
    pub delta_a: f64,
    /// Last change of the multiplier on the finest grid, in units of the tolerance.
    pub excess: f64,
    /// KKT residual on the finest grid over the largest component of F.
    pub kkt: f64,
}

/// Sweeps of all methods to equal KKT residual, on one grid with one r.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UzawaCell {
    /// Cells per side.
    pub cells: usize,
    /// KKT residual over the largest component of F.
    pub target: f64,
    /// Duality parameter.
    pub r: f64,
    /// Sweeps of Arrow-Hurwicz.
    pub arrow_hurwicz: Count,
    /// Sweeps of the [`VARIANTS`] of Uzawa's algorithm.
    pub uzawa: [Count; 4],
}

/// Variant of Uzawa's algorithm.
#[derive(Clone, Copy, Debug)]
pub struct UzawaVariant {
    /// Name in the book.
    pub name: &'static str,
    /// True with the proximal term.
    proximal: bool,
    /// True if each inner minimisation only goes to a tenth of the gradient before it.
    loose: bool,
}

impl UzawaVariant {
    /// Method, with the weight of the proximal term and the bound on the inner gradient.
    fn method(self, weight: f64, inner: f64) -> Method {
        let weight = if self.proximal { weight } else { 0.0 };
        Method::Uzawa { weight, inner, loose: self.loose }
    }
}

/// Variants that Arrow-Hurwicz is compared with: plain or with the proximal term, each inner minimisation to the
/// end or only to a tenth of the gradient before it.
pub const VARIANTS: [UzawaVariant; 4] = [
    UzawaVariant { name: "Uzawa, exact inside", proximal: false, loose: false },
    UzawaVariant { name: "Uzawa, loose inside", proximal: false, loose: true },
    UzawaVariant { name: "proximal, exact inside", proximal: true, loose: false },
    UzawaVariant { name: "proximal, loose inside", proximal: true, loose: true },
];

/// Runs the experiment.
///
/// 1. Lists the runs, in batches that share a grid or a stopping rule.
/// 2. Makes the batches in parallel, each in vector lanes.
/// 3. Gathers the counts of each problem.
/// 4. Judges each claim by the counts.
///
/// Easily broken: step 3 finds a run by its problem, end and r, so r must have the same bits wherever it is listed.
///
/// # Errors
/// If f or grids do not parse, or a problem has no solution on some grid under the averaged load.
pub fn claims(plan: &ClaimsPlan) -> Result<Claims, String> {
    let (problems, weight_rows) = measure::measure(plan)?;
    let r = plan.r();
    let verdicts = Verdicts::of(&r, &problems);
    let (targets, weights, cap) = (plan.targets.clone(), plan.weights.clone(), plan.cap);
    Ok(Claims { r, targets, cap, problems, weights, weight_rows, verdicts })
}
