//! What the book says of the runs: least and greatest values, and where a solver gave up.

use super::{Case, Range, Stress};
use crate::experiments::trial::Trial;
use serde::{Deserialize, Serialize};

/// What the prose rests on; none where no run was of the kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Values of r with which the strict rule was met for every problem.
    pub converging_r: Option<Range>,
    /// Values of r with which it was not, for some problem.
    pub failing_r: Option<Range>,
    /// KKT residual where the signed rule was met, over all r.
    pub signed_kkt: Option<Range>,
    /// Where the signed rule is met at the same iteration whatever the tolerance.
    pub plateau: Option<Plateau>,
    /// The least tolerance that multigrid reached.
    pub multigrid_tolerance: Option<f64>,
    /// Least and greatest exponent of f at which the paper's method with its tolerance multiplied gave the
    /// same count and said that it was done.
    pub scaled_same: Option<[i32; 2]>,
    /// Cycles of multigrid over all factors of f with which it came to the rounding floor.
    pub scaled_cycles: Option<Range>,
    /// Deficits at which multigrid gave up.
    pub stalled: Option<Range>,
    /// Their number.
    pub stalled_runs: usize,
    /// KKT residual that it was left with.
    pub stalled_kkt: Option<Range>,
    /// Its work at the others.
    pub deficit_work: Option<Range>,
    /// Iterations of the paper's method over all deficits.
    pub deficit_steps: Option<Range>,
    /// What rounding leaves of the residual, in units of `EPSILON * max |y|`: multigrid.
    pub multigrid_floor: Option<Range>,
    /// The same for the paper's method.
    pub strict_floor: Option<Range>,
    /// Work of multigrid over all jumps and spikes.
    pub load_work: Option<Range>,
    /// Its relative KKT residual there.
    pub load_kkt: Option<Range>,
    /// Counts that are others in single precision.
    pub single_changed: usize,
}

/// Tolerances at which the signed rule is met at one and the same iteration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plateau {
    /// Name of the problem.
    pub problem: String,
    /// The iteration.
    pub steps: usize,
    /// The tolerances, over the largest load.
    pub tolerances: Range,
    /// The KKT residual there.
    pub kkt: f64,
}

impl Plateau {
    /// The one with most tolerances, if it has three.
    fn of(stress: &Stress) -> Option<Self> {
        let mut longest: (usize, Option<Self>) = (2, None);
        for (problem, cases) in stress.plan.names().into_iter().zip(&stress.tolerances) {
            let met: Vec<_> = cases.iter().filter(|case| case["signed"].converged()).collect();
            for same in met.chunk_by(|a, b| a["signed"].steps == b["signed"].steps) {
                let Trial { steps, kkt, .. } = same[0]["signed"];
                let tolerances = Range::of(same.iter().map(|case| case.x));
                let (Some(tolerances), Some(kkt)) = (tolerances, kkt) else { continue };
                if same.len() > longest.0 {
                    longest = (
                        same.len(),
                        Some(Self { problem: problem.clone(), steps, tolerances, kkt }),
                    );
                }
            }
        }
        longest.1
    }
}

/// What `value` is in the cases that `of` picks.
fn range<'a, X: 'a>(
    cases: impl IntoIterator<Item = &'a Case<X>>,
    of: impl Fn(&Case<X>) -> bool,
    value: impl Fn(&Case<X>) -> Option<f64>,
) -> Option<Range> {
    Range::of(cases.into_iter().filter(|case| of(case)).filter_map(value))
}

impl Summary {
    pub(super) fn of(stress: &Stress) -> Self {
        let duality = || stress.duality.iter().flatten();
        let deficits = || stress.deficits.iter().flatten();
        let loads = || stress.jumps.iter().chain(&stress.spikes);
        let solved = |trial: &Trial| trial.converged() || trial.stop == "rounding-floor";
        let stalled = |case: &Case<f64>| !solved(&case["multigrid"]);
        let fails = |r: f64| duality().any(|case| case.x == r && !case["strict"].converged());
        let plain = stress.scaling.iter().find(|case| case.x == 0);
        let same = |case: &Case<i32>| {
            let (ours, plain) = (&case["scaled"], plain.map(|case| case["scaled"].steps));
            ours.converged() && Some(ours.steps) == plain
        };
        let steps = |trial: &Trial| Some(trial.steps as f64);
        Self {
            converging_r: range(duality(), |case| !fails(case.x), |case| Some(case.x)),
            failing_r: range(duality(), |case| fails(case.x), |case| Some(case.x)),
            signed_kkt: range(duality(), |c| c["signed"].converged(), |c| c["signed"].kkt),
            plateau: Plateau::of(stress),
            multigrid_tolerance: range(
                stress.tolerances.iter().flatten(),
                |case| case["multigrid"].converged(),
                |case| Some(case.x),
            )
            .map(|range| range.least),
            scaled_same: range(&stress.scaling, same, |case| Some(f64::from(case.x)))
                .map(|range| [range.least as i32, range.greatest as i32]),
            scaled_cycles: range(
                &stress.scaling,
                |case| solved(&case["multigrid"]),
                |case| steps(&case["multigrid"]),
            ),
            stalled: range(deficits(), stalled, |case| Some(case.x)),
            stalled_runs: deficits().filter(|case| stalled(case)).count(),
            stalled_kkt: range(deficits(), stalled, |case| case["multigrid"].kkt),
            deficit_work: range(deficits(), |c| !stalled(c), |c| Some(c["multigrid"].work)),
            deficit_steps: range(deficits(), |_| true, |case| steps(&case["strict"])),
            multigrid_floor: range(&stress.floors, |_| true, |case| case["multigrid"].floor),
            strict_floor: range(&stress.floors, |_| true, |c| c.trials.get("strict")?.floor),
            load_work: range(loads(), |_| true, |case| Some(case["multigrid"].work)),
            load_kkt: range(loads(), |_| true, |case| case["multigrid"].kkt),
            single_changed: stress.single.iter().map(|table| table.changed.len()).sum(),
        }
    }
}
