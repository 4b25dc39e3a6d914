//! Measurement of the paper's claims about the cost of its method: counts of sweeps, and the cases in which each claim
//! holds.

mod cases;
mod problem;
mod runs;

use super::{Findings, Rows, power_of_ten};
use crate::experiments::problems::TableProblem;
use crate::machine::threads::{map, try_map};
use crate::saddle::{Method, StopRule};
use problem::ClaimProblem;
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ClaimsPlan {
    /// Problems of the paper.
    problems: Vec<TableProblem>,
    /// Least and greatest r of the sweep over r, as powers of ten.
    decades: (i32, i32),
    /// Values of r in each decade.
    per_decade: i32,
    /// KKT residuals to reach, over the largest component of F, each with the finest grid for which
    /// there is time, in cells per side.
    targets: Vec<KktTarget>,
    /// Sweeps on a grid after which a run towards a KKT residual has failed.
    cap: usize,
    /// Values of r at which methods are compared; all belong to the sweep over r.
    compared_r: Vec<f64>,
    /// Coarsest grid on which methods are compared, in cells per side.
    compared_from: usize,
    /// Weight of the proximal term.
    weight: f64,
    /// Other weights, whose costs are compared for one r.
    weights: Vec<f64>,
}

/// KKT residual to reach.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct KktTarget {
    /// Residual over the largest component of F.
    kkt: f64,
    /// Cells per side of the finest grid for which there is time.
    cells: usize,
}

impl KktTarget {
    /// Residuals, each with its finest grid.
    fn all<const N: usize>(targets: [(f64, usize); N]) -> Vec<Self> {
        targets.map(|(kkt, cells)| Self { kkt, cells }).into()
    }
}

impl ClaimsPlan {
    /// Plan of the book for these problems.
    pub(super) fn new(mut problems: Vec<TableProblem>) -> Self {
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

    /// Values of r of the sweep over r, ascending.
    fn r(&self) -> Vec<f64> {
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

/// Measure of convergence by which a run over r ends.
#[derive(Clone, Copy, PartialEq)]
enum ClaimMeasure {
    /// A stopping rule on nested grids, with the paper's tolerances and load.
    Rule(StopRule),
    /// A KKT residual, from the coarser grid's solution, with the bilinear load.
    Kkt(f64),
}

/// Variant of Uzawa's algorithm.
#[derive(Clone, Copy)]
struct UzawaVariant {
    /// Name in the book.
    name: &'static str,
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
const VARIANTS: [UzawaVariant; 4] = [
    UzawaVariant { name: "Uzawa, exact inside", proximal: false, loose: false },
    UzawaVariant { name: "Uzawa, loose inside", proximal: false, loose: true },
    UzawaVariant { name: "proximal, exact inside", proximal: true, loose: false },
    UzawaVariant { name: "proximal, loose inside", proximal: true, loose: true },
];

/// Runs the experiment: tables `runs`, `cases` of the claims, and `weights` of the proximal term.
///
/// 1. Lists the runs, in batches that share a grid or a stopping rule.
/// 2. Makes the batches in parallel, each in vector lanes.
/// 3. Judges each claim by the counts.
///
/// Easily broken: step 3 finds a run by its problem, end and r, so r must have the same bits wherever it is listed.
///
/// # Errors
/// If f or grids do not parse, or a problem has no solution on some grid under the bilinear load.
pub(super) fn claims(plan: &ClaimsPlan) -> Result<Findings, String> {
    let problems = try_map(&plan.problems, ClaimProblem::new)?;
    let runs = runs::run_all(plan, &problems);
    let cases = cases::cases(plan, &runs);
    let weights = map(&problems, 1, |problem| problem.weights(plan));
    Ok(Findings::from([
        ("runs".into(), Rows::of(runs)),
        ("cases".into(), Rows::of(cases)),
        ("weights".into(), Rows::of(weights)),
    ]))
}
