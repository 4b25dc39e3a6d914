//! Pictures of the experiment on stability.

use crate::experiments::stress::{Case, Stress};
use crate::experiments::trial::Trial;
use crate::figures::Stroke::{Marked, Reference};
use crate::figures::{Chart, Curve, Picture, charts};

/// A curve with a ring at each case in which the method ran and the value is positive.
fn marked(
    label: impl Into<String>,
    cases: &[Case<f64>],
    method: &str,
    value: impl Fn(&Trial) -> Option<f64>,
) -> Curve {
    let of = |case: &Case<f64>| {
        let value = value(case.trials.get(method)?).filter(|value| *value > 0.0)?;
        Some((case.x, value))
    };
    Curve::new(Marked, label, cases.iter().filter_map(of))
}

/// The paper's method over the duality parameter.
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

pub(super) fn tolerances(found: &Stress) -> Picture {
    let named = found.plan.names().into_iter().zip(&found.tolerances);
    let parts: Vec<_> = named
        .map(|(name, cases)| {
            let named =
                [("signed rule", "signed"), ("strict rule", "strict"), ("multigrid", "multigrid")];
            let mut curves: Vec<_> =
                named.map(|(label, name)| marked(label, cases, name, |trial| trial.kkt)).into();
            let asked = cases.iter().map(|case| (case.x, case.x));
            curves.push(Curve::new(Reference, "as asked", asked));
            let axes = ["tolerance over the load", "KKT residual"];
            Chart::new(name, axes, curves)
        })
        .collect();
    charts(false, &parts)
}
