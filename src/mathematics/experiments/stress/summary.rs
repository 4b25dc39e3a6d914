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

impl Summary {
    pub(super) fn of(stress: &Stress) -> Self {
        let duality = || stress.duality.iter().flatten();
        let deficits = || stress.deficits.iter().flatten();
        let loads = || stress.jumps.iter().chain(&stress.spikes);
        let solved = |trial: &Trial| trial.converged() || trial.stop == "rounding-floor";
        let stalled = |case: &Case<f64>| !solved(&case["multigrid"]);
        let fails = |r: f64| duality().any(|case| case.x == r && !case["strict"].converged());
        let scaled = stress.scaling.iter();
        let unscaled = scaled.clone().find(|case| case.x == 0).map(|case| case["scaled"].steps);
        let same =
            |case: &Case<i32>| case["scaled"].converged() && Some(case["scaled"].steps) == unscaled;
        let scaled_solved = scaled.clone().filter(|case| solved(&case["multigrid"]));
        let scaled_same = scaled.filter(|case| same(case)).map(|case| f64::from(case.x));
        let signed = duality().map(|case| &case["signed"]).filter(|trial| trial.converged());
        let tolerances = stress.tolerances.iter().flatten();
        let reached = tolerances.filter(|case| case["multigrid"].converged()).map(|case| case.x);
        let gave_up = || deficits().filter(|case| stalled(case));
        let done = deficits().filter(|case| !stalled(case));
        let floors = || stress.floors.iter();
        Self {
            converging_r: Range::of(duality().map(|case| case.x).filter(|r| !fails(*r))),
            failing_r: Range::of(duality().map(|case| case.x).filter(|r| fails(*r))),
            signed_kkt: Range::of(signed.filter_map(|trial| trial.kkt)),
            plateau: Plateau::of(stress),
            multigrid_tolerance: Range::of(reached).map(|range| range.least),
            scaled_same: Range::of(scaled_same)
                .map(|range| [range.least as i32, range.greatest as i32]),
            scaled_cycles: Range::of(scaled_solved.map(|case| case["multigrid"].steps as f64)),
            stalled: Range::of(gave_up().map(|case| case.x)),
            stalled_runs: gave_up().count(),
            stalled_kkt: Range::of(gave_up().filter_map(|case| case["multigrid"].kkt)),
            deficit_work: Range::of(done.map(|case| case["multigrid"].work)),
            deficit_steps: Range::of(deficits().map(|case| case["strict"].steps as f64)),
            multigrid_floor: Range::of(floors().filter_map(|case| case["multigrid"].floor)),
            strict_floor: Range::of(floors().filter_map(|case| case.trials.get("strict")?.floor)),
            load_work: Range::of(loads().map(|case| case["multigrid"].work)),
            load_kkt: Range::of(loads().filter_map(|case| case["multigrid"].kkt)),
            single_changed: stress.single.iter().map(|table| table.changed.len()).sum(),
        }
    }
}
