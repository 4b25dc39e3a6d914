//! Claims of the paper about its method's cost, as counts of sweeps and a verdict on each claim.

mod measure;
mod verdict;

pub use verdict::{ClaimTally, ClaimVerdict, Ratios, Spread, Verdicts};

use crate::experiments::power_of_ten;
use crate::experiments::problems::Problem;
use crate::saddle::{Method, StopReason, StopRule};
use serde::{Deserialize, Serialize};

/// Everything the experiment depends on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClaimsPlan {
    /// The paper's problems.
    pub problems: Vec<Problem>,
    /// Least and greatest r of the sweep over r, as powers of ten.
    pub decades: (i32, i32),
    /// Values of r in each decade.
    pub per_decade: i32,
    /// KKT residuals to reach, over the largest component of F, each with the finest grid for which
    /// there is time, in cells per side.
    pub targets: Vec<(f64, usize)>,
    /// Sweeps on a grid after which a run towards a KKT residual has failed.
    pub cap: usize,
    /// Values of r at which methods are compared; all belong to the sweep over r.
    pub compared_r: Vec<f64>,
    /// Coarsest grid on which methods are compared, in cells per side.
    pub compared_from: usize,
    /// Weight of the proximal term.
    pub weight: f64,
}

impl ClaimsPlan {
    /// The experiment on these problems.
    pub fn new(mut problems: Vec<Problem>) -> Self {
        problems.sort_by_key(|problem| problem.number);
        Self {
            problems,
            decades: (-2, 6),
            per_decade: 8,
            targets: vec![(1e-3, 64), (1e-6, 32)],
            cap: 50_000,
            compared_r: vec![0.1, 1.0, 10.0, 100.0, 1e4, 1e6],
            compared_from: 16,
            weight: 1.0,
        }
    }

    /// The values of the sweep over r.
    pub fn r(&self) -> Vec<f64> {
        let (low, high) = self.decades;
        let step = |k: i32| match k.rem_euclid(self.per_decade) {
            // Powers of ten as the paper writes them, to the last bit.
            0 => power_of_ten(k.div_euclid(self.per_decade)),
            rest => {
                let fraction = f64::from(rest) / f64::from(self.per_decade);
                power_of_ten(k.div_euclid(self.per_decade)) * libm::exp10(fraction)
            }
        };
        (low * self.per_decade..=high * self.per_decade).map(step).collect()
    }
}

/// Results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claims {
    /// The values of the sweep over r, ascending.
    pub r: Vec<f64>,
    /// KKT residuals to reach, each with the finest grid on which it was asked for.
    pub targets: Vec<(f64, usize)>,
    /// Sweeps after which a run towards one has failed.
    pub cap: usize,
    /// The counts.
    pub problems: Vec<Measured>,
    /// Verdicts on the claims.
    pub verdicts: Verdicts,
}

/// The counts of a problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Number.
    pub number: u8,
    /// Sum of the load on the finest grid, under the paper's stopping rules and towards a KKT residual.
    pub sums: [f64; 2],
    /// The sweep over r: a row per measure and grid.
    pub rows: Vec<CountRow>,
    /// Tables 1 and 2 in full under each stopping rule.
    pub tables: Vec<ClaimTable>,
    /// Arrow-Hurwicz against Uzawa.
    pub cells: Vec<UzawaCell>,
}

/// When a run over r ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClaimMeasure {
    /// The paper's stopping rule on nested grids, with its tolerances and its load.
    Rule(StopRule),
    /// A KKT residual, from the coarser grid's solution, with the load averaged around nodes.
    Kkt(f64),
}

/// Iterations on a grid for every r of the sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CountRow {
    /// When the runs end.
    pub measure: ClaimMeasure,
    /// Cells per side.
    pub cells: usize,
    /// One count per r.
    pub counts: Vec<Count>,
    /// The best r, if any reached the end.
    pub best: Option<BestParameter>,
}

/// Iterations, and why they ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Count {
    /// Iterations, or sweeps.
    pub iterations: usize,
    /// `converged` or `iteration-limit`.
    pub stop: StopReason,
}

impl Count {
    /// The count, if the run reached its end.
    pub fn reached(self) -> Option<usize> {
        (self.stop == StopReason::Converged).then_some(self.iterations)
    }
}

/// The least of the counts in a row.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BestParameter {
    /// The smallest r that attains it.
    pub r: f64,
    /// The count.
    pub iterations: usize,
    /// From where to where, around the best r, no count is more than a tenth above it.
    pub flat: (f64, f64),
}

/// A table as the paper prints it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClaimTable {
    /// Stopping rule.
    pub rule: StopRule,
    /// A line per r, in the paper's order.
    pub lines: Vec<ClaimLine>,
}

/// A line of a [`ClaimTable`].
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
    /// Change of the multiplier in units of the tolerance.
    pub excess: f64,
    /// KKT residual on the finest grid over the largest component of F.
    pub kkt: f64,
}

/// Sweeps of all methods to equal KKT residual.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UzawaCell {
    /// Cells per side.
    pub cells: usize,
    /// KKT residual over the largest component of F.
    pub target: f64,
    /// Duality parameter.
    pub r: f64,
    /// Arrow-Hurwicz.
    pub arrow_hurwicz: Count,
    /// In the order of [`VARIANTS`].
    pub uzawa: [Count; 4],
}

/// A variant of Uzawa's algorithm.
#[derive(Clone, Copy, Debug)]
pub struct UzawaVariant {
    /// Name in the book.
    pub name: &'static str,
    proximal: bool,
    loose: bool,
}

impl UzawaVariant {
    const fn new(name: &'static str, proximal: bool, loose: bool) -> Self {
        Self { name, proximal, loose }
    }

    /// The method, with the weight of the proximal term and the bound on the inner gradient.
    fn method(self, weight: f64, inner: f64) -> Method {
        let weight = if self.proximal { weight } else { 0.0 };
        Method::Uzawa { weight, inner, loose: self.loose }
    }
}

/// Methods with which Arrow-Hurwicz is compared: plain or with the proximal term, each inner minimisation to the
/// end or only to a tenth of the gradient before it.
pub const VARIANTS: [UzawaVariant; 4] = [
    UzawaVariant::new("Uzawa, exact inside", false, false),
    UzawaVariant::new("Uzawa, loose inside", false, true),
    UzawaVariant::new("proximal, exact inside", true, false),
    UzawaVariant::new("proximal, loose inside", true, true),
];

/// Measures, in parallel over runs, and judges.
///
/// # Errors
/// If f or grids do not parse, or a problem has no solution on some grid under the averaged load.
pub fn claims(plan: &ClaimsPlan) -> Result<Claims, String> {
    let problems = measure::measure(plan)?;
    let r = plan.r();
    let verdicts = Verdicts::of(&r, &problems);
    Ok(Claims { r, targets: plan.targets.clone(), cap: plan.cap, problems, verdicts })
}
