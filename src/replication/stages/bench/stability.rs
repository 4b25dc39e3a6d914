//! Pictures of the experiment on stability.

use crate::experiments::stress::{Case, Series, Stress};
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

fn steps(trial: &Trial) -> Option<f64> {
    Some(trial.steps as f64)
}

/// The paper's method over the duality parameter.
pub(super) fn duality(found: &Stress) -> Picture {
    let curves = |value: fn(&Trial) -> Option<f64>| {
        let of_problem = |(name, cases): (String, &Series<f64>)| {
            let label = |rule: &str| format!("{rule} rule, {name}");
            ["signed", "strict"].map(|rule| marked(label(rule), cases, rule, value))
        };
        found.plan.names().into_iter().zip(&found.duality).flat_map(of_problem).collect::<Vec<_>>()
    };
    let mut residual = curves(|trial| trial.kkt);
    let ends = found.duality.first().and_then(|cases| Some((cases.first()?.x, cases.last()?.x)));
    if let Some((low, high)) = ends {
        residual.push(Curve::new(Reference, "as large as the load", [(low, 1.0), (high, 1.0)]));
    }
    let parts = [
        Chart::new("Where it stops", ["r", "KKT residual"], residual),
        Chart::new("How long it takes", ["r", "iterations"], curves(steps)),
    ];
    charts(false, &parts)
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

/// Work and contact as the integral of f tends to zero.
pub(super) fn deficits(found: &Stress) -> Picture {
    let (mut work, mut contact) = (Vec::new(), Vec::new());
    for (cases, way) in found.deficits.iter().zip(["up", "down"]) {
        let multigrid = format!("multigrid, {way}");
        work.push(marked(format!("Arrow-Hurwicz, {way}"), cases, "strict", steps));
        work.push(marked(&multigrid, cases, "multigrid", |trial| Some(trial.work)));
        contact.push(marked(multigrid, cases, "multigrid", |trial| Some(trial.contact as f64)));
    }
    let parts = [
        Chart::new("Work", ["deficit", "sweeps of the finest grid"], work),
        Chart::new("Contact", ["deficit", "boundary nodes in contact"], contact),
    ];
    charts(false, &parts)
}

/// What rounding leaves of the residual, over the grids.
pub(super) fn precision(found: &Stress) -> Picture {
    let curves = |value: fn(&Trial) -> Option<f64>| {
        vec![
            marked("multigrid, double", &found.floors, "multigrid", value),
            marked("Arrow-Hurwicz, double", &found.floors, "strict", value),
            marked("Arrow-Hurwicz, single", &found.single_floors, "single", value),
        ]
    };
    let residual = curves(|trial| trial.kkt);
    let units = curves(|trial| trial.floor);
    let parts = [
        Chart::new("Over the load", ["1/h", "KKT residual"], residual),
        Chart::new("In roundings of y", ["1/h", "KKT residual over eps max |y|"], units),
    ];
    charts(false, &parts)
}
