//! What the book says of the runs: least and greatest values, and where a solver gave up.

use super::{Deficit, Stress};
use crate::experiments::trial::Trial;
use serde::{Deserialize, Serialize};

/// Least and greatest of some numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Span {
    /// Least.
    pub least: f64,
    /// Greatest.
    pub greatest: f64,
}

impl Span {
    /// `None` without numbers.
    fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        values.fold(None, |span: Option<Self>, x| {
            let (least, greatest) = span.map_or((x, x), |s| (s.least.min(x), s.greatest.max(x)));
            Some(Self { least, greatest })
        })
    }
}

/// Least and greatest of some decimal exponents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Exponents {
    /// Least.
    pub least: i32,
    /// Greatest.
    pub greatest: i32,
}

/// What the prose rests on; none where no run was of the kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// Values of r with which the strict rule was met for every problem.
    pub converging_r: Option<Span>,
    /// Values of r with which it was not, for some problem.
    pub failing_r: Option<Span>,
    /// KKT residual where the strict rule was met, over all r.
    pub strict_kkt: Option<Span>,
    /// Iterations of the strict rule for r from 1 up.
    pub strict_steps: Option<Span>,
    /// KKT residual where the signed rule was met, over all r.
    pub signed_kkt: Option<Span>,
    /// Where the signed rule is met at the same iteration whatever the tolerance.
    pub plateau: Option<Plateau>,
    /// The least tolerance at which the signed rule was met.
    pub signed_tolerance: Option<f64>,
    /// The least tolerance at which the strict rule was met.
    pub strict_tolerance: Option<f64>,
    /// The least tolerance that multigrid reached.
    pub multigrid_tolerance: Option<f64>,
    /// Exponents of f at which the paper's method with its tolerance multiplied gave the same count and
    /// said that it was done.
    pub scaled_same: Option<Exponents>,
    /// Cycles of multigrid over all factors of f with which it came to the rounding floor.
    pub scaled_cycles: Option<Span>,
    /// Exponents of f for which the paper's method said that it diverged.
    pub scaled_diverged: Option<Exponents>,
    /// Deficits at which multigrid gave up.
    pub stalled: Option<Span>,
    /// Their number.
    pub stalled_runs: usize,
    /// KKT residual that it was left with.
    pub stalled_kkt: Option<Span>,
    /// Its work at the others.
    pub deficit_work: Option<Span>,
    /// Iterations of the paper's method over all deficits.
    pub deficit_steps: Option<Span>,
    /// What rounding leaves of the residual, in units of `EPSILON * max |y|`: multigrid.
    pub multigrid_floor: Option<Span>,
    /// The same for the paper's method.
    pub saddle_floor: Option<Span>,
    /// Work of multigrid over all jumps and spikes.
    pub load_work: Option<Span>,
    /// Its relative KKT residual there.
    pub load_kkt: Option<Span>,
    /// Counts of the tables.
    pub counts: usize,
    /// Those that are others in single precision.
    pub single_changed: usize,
}

/// Tolerances at which the signed rule is met at one and the same iteration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plateau {
    /// Problem, from 1.
    pub problem: usize,
    /// The iteration.
    pub steps: usize,
    /// The tolerances, over the largest load.
    pub tolerances: Span,
    /// The KKT residual there.
    pub kkt: f64,
}

impl Plateau {
    /// The one with most tolerances, if it has three.
    fn of(stress: &Stress) -> Option<Self> {
        let mut longest: (usize, Option<Self>) = (2, None);
        for (k, cases) in stress.tolerances.iter().enumerate() {
            let met: Vec<_> = cases.iter().filter(|c| c.signed.stop == "converged").collect();
            for same in met.chunk_by(|a, b| a.signed.steps == b.signed.steps) {
                let tolerances = Span::of(same.iter().map(|case| case.tolerance));
                let (Some(tolerances), Some(kkt)) = (tolerances, same[0].signed.kkt) else {
                    continue;
                };
                if same.len() > longest.0 {
                    let steps = same[0].signed.steps;
                    longest = (same.len(), Some(Self { problem: k + 1, steps, tolerances, kkt }));
                }
            }
        }
        longest.1
    }
}

impl Facts {
    pub(super) fn of(stress: &Stress) -> Self {
        let met = |trial: &Trial| trial.stop == "converged";
        let floor = |trial: &Trial| met(trial) || trial.stop == "rounding-floor";
        let duality = || stress.duality.iter().flatten();
        let fails = |r: f64| duality().any(|case| case.r == r && !met(&case.strict));
        let tolerances = || stress.tolerances.iter().flatten();
        let least = |pick: &dyn Fn(&super::Tolerance) -> &Trial| {
            let met = tolerances().filter(|case| met(pick(case)));
            Span::of(met.map(|case| case.tolerance)).map(|span| span.least)
        };
        let scaling = || stress.scaling.iter();
        let plain = || scaling().find(|case| case.exponent == 0);
        let exponents = |holds: &dyn Fn(&super::Scaling, &super::Scaling) -> bool| {
            let plain = plain()?;
            let held = || scaling().filter(|c| holds(c, plain)).map(|c| c.exponent);
            Some(Exponents { least: held().min()?, greatest: held().max()? })
        };
        let deficits = || stress.deficits.iter().flatten();
        let stalled = || deficits().filter(|case| !floor(&case.multigrid));
        let solved = |case: &&Deficit| floor(&case.multigrid);
        let loads = || stress.jumps.iter().chain(&stress.spikes).map(|case| &case.multigrid);
        let steps = |trial: &Trial| trial.steps as f64;
        Self {
            converging_r: Span::of(duality().map(|case| case.r).filter(|r| !fails(*r))),
            failing_r: Span::of(duality().map(|case| case.r).filter(|r| fails(*r))),
            strict_kkt: Span::of(
                duality().filter(|case| met(&case.strict)).filter_map(|case| case.strict.kkt),
            ),
            strict_steps: Span::of(
                duality()
                    .filter(|case| case.r >= 1.0 && met(&case.strict))
                    .map(|case| steps(&case.strict)),
            ),
            signed_kkt: Span::of(
                duality().filter(|case| met(&case.signed)).filter_map(|case| case.signed.kkt),
            ),
            plateau: Plateau::of(stress),
            signed_tolerance: least(&|case| &case.signed),
            strict_tolerance: least(&|case| &case.strict),
            multigrid_tolerance: least(&|case| &case.multigrid),
            scaled_same: exponents(&|case, plain| {
                met(&case.scaled) && case.scaled.steps == plain.scaled.steps
            }),
            scaled_cycles: Span::of(
                scaling().filter(|case| floor(&case.multigrid)).map(|case| steps(&case.multigrid)),
            ),
            scaled_diverged: exponents(&|case, _| case.scaled.stop == "diverged"),
            stalled: Span::of(stalled().map(|case| case.deficit)),
            stalled_runs: stalled().count(),
            stalled_kkt: Span::of(stalled().filter_map(|case| case.multigrid.kkt)),
            deficit_work: Span::of(deficits().filter(solved).map(|case| case.multigrid.work)),
            deficit_steps: Span::of(deficits().map(|case| steps(&case.saddle))),
            multigrid_floor: Span::of(stress.floors.iter().filter_map(|c| c.multigrid.floor)),
            saddle_floor: Span::of(stress.floors.iter().filter_map(|c| c.saddle.as_ref()?.floor)),
            load_work: Span::of(loads().map(|trial| trial.work)),
            load_kkt: Span::of(loads().filter_map(|trial| trial.kkt)),
            counts: stress.single.iter().map(|table| table.cells).sum(),
            single_changed: stress.single.iter().map(|table| table.changed.len()).sum(),
        }
    }
}
