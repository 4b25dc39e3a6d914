//! Pictures of the experiment on stability.

use crate::figures::Stroke::{Marked, Reference};
use crate::figures::{Chart, Curve, Picture, charts};
use signorini_mathematics::experiments::stress::{Stress, StressCase};
use signorini_mathematics::experiments::trial::Trial;

/// Curve with a ring at each case in which the method ran and the value is positive.
fn marked(
    label: impl Into<String>,
    cases: &[StressCase<f64>],
    method: &str,
    value: impl Fn(&Trial) -> Option<f64>,
) -> Curve {
    let mut points = Vec::new();
    for case in cases {
        let value = case.trials.get(method).and_then(&value);
        if let Some(value) = value.filter(|value| *value > 0.0) {
            points.push((case.x, value));
        }
    }
    Curve::new(Marked, label, points)
}

/// Draws the residual of the paper's method against the duality parameter.
pub(super) fn duality(found: &Stress) -> Picture {
    let mut residual = Vec::new();
    for (name, cases) in found.plan.names().into_iter().zip(&found.duality) {
        for rule in ["signed", "strict"] {
            let label = format!("{rule} rule, {name}");
            residual.push(marked(label, cases, rule, |trial| trial.kkt));
        }
    }
    let ends = found.duality.first().and_then(|cases| Some((cases.first()?.x, cases.last()?.x)));
    if let Some((low, high)) = ends {
        residual.push(Curve::new(Reference, "as large as the load", [(low, 1.0), (high, 1.0)]));
    }
    charts(false, &[Chart::new("Where it stops", ["r", "KKT residual"], residual)])
}

/// Draws the residual of three methods against the tolerance, a panel per problem.
pub(super) fn tolerances(found: &Stress) -> Picture {
    let mut panels = Vec::new();
    for (name, cases) in found.plan.names().into_iter().zip(&found.tolerances) {
        let mut curves = Vec::new();
        for (label, method) in
            [("signed rule", "signed"), ("strict rule", "strict"), ("multigrid", "multigrid")]
        {
            curves.push(marked(label, cases, method, |trial| trial.kkt));
        }
        let asked = cases.iter().map(|case| (case.x, case.x));
        curves.push(Curve::new(Reference, "as asked", asked));
        panels.push(Chart::new(name, ["tolerance over the load", "KKT residual"], curves));
    }
    charts(false, &panels)
}
