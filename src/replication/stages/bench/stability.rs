//! The experiments on stability and their pictures.

use super::{Drawn, drawn, problem, result, task};
use crate::experiments::rounding::{self, Rounding, rounding};
use crate::experiments::stress::{self, Deficit, Duality, Floor, Stress, Tolerance, stress};
use crate::experiments::trial::Trial;
use crate::figures::{Caption, Chart, Curve, FragilityPanel, fragility};
use crate::pipeline::{Inputs, Task};
use crate::replication::project::Project;

/// The tasks of both experiments: they start from the paper's problems.
pub(super) fn tasks(project: &Project) -> Vec<Task> {
    let mut tables: Vec<_> = project.problems().into_iter().filter_map(problem).collect();
    tables.sort_by_key(|table| table.number);
    vec![
        task("stress", stress::Plan::new(tables.clone()), stress),
        task("rounding", rounding::Plan::new(tables), rounding),
    ]
}

/// The least disturbance that changes each count.
pub(super) fn draw_rounding(inputs: &Inputs, caption: Caption) -> Drawn {
    let found: Rounding = result(inputs, "rounding")?;
    let panels: Vec<_> = found
        .tables
        .iter()
        .map(|table| FragilityPanel {
            title: format!("Table {}", table.number),
            columns: table.grids.iter().map(|cells| format!("h = 1/{cells}")).collect(),
            rows: table.rows.iter().map(|row| format!("r = {}", row.r)).collect(),
            cells: table
                .rows
                .iter()
                .map(|row| row.cells.iter().map(|cell| (cell.count, cell.flips_at)).collect())
                .collect(),
        })
        .collect();
    fragility(caption, &found.sizes, &panels).map_err(|e| e.to_string())
}

fn panel(title: impl Into<String>, axes: [&'static str; 2], curves: Vec<Curve>) -> Chart {
    Chart { title: title.into(), axes, curves }
}

/// A curve with a ring at each point where the value is positive.
fn marked<T>(
    label: impl Into<String>,
    cases: &[T],
    x: impl Fn(&T) -> f64,
    y: impl Fn(&T) -> Option<f64>,
) -> Curve {
    let points = cases.iter().filter_map(|case| Some((x(case), y(case).filter(|y| *y > 0.0)?)));
    Curve::marked(label, points.collect())
}

fn steps(trial: &Trial) -> Option<f64> {
    Some(trial.steps as f64)
}

/// The paper's method over the duality parameter.
pub(super) fn draw_duality(inputs: &Inputs, caption: Caption) -> Drawn {
    let found: Stress = result(inputs, "stress")?;
    let curves = |value: fn(&Trial) -> Option<f64>| {
        let of_problem = |(k, cases): (usize, &Vec<Duality>)| {
            let label = |rule: &str| format!("{rule} rule, problem {}", k + 1);
            let r = |case: &Duality| case.r;
            [
                marked(label("signed"), cases, r, |case| value(&case.signed)),
                marked(label("strict"), cases, r, |case| value(&case.strict)),
            ]
        };
        found.duality.iter().enumerate().flat_map(of_problem).collect::<Vec<_>>()
    };
    let mut residual = curves(|trial| trial.kkt);
    let ends = found.duality.first().and_then(|cases| Some((cases.first()?.r, cases.last()?.r)));
    if let Some((low, high)) = ends {
        let line = vec![(low, 1.0), (high, 1.0)];
        residual.push(Curve::reference("as large as the load", line));
    }
    let parts = [
        panel("Where it stops", ["r", "KKT residual"], residual),
        panel("How long it takes", ["r", "iterations"], curves(steps)),
    ];
    drawn(caption, 2, &parts)
}

/// What is reached for each tolerance.
pub(super) fn draw_tolerances(inputs: &Inputs, caption: Caption) -> Drawn {
    let found: Stress = result(inputs, "stress")?;
    let parts: Vec<_> = found
        .tolerances
        .iter()
        .enumerate()
        .map(|(k, cases)| {
            let tolerance = |case: &Tolerance| case.tolerance;
            let mut curves = vec![
                marked("signed rule", cases, tolerance, |case| case.signed.kkt),
                marked("strict rule", cases, tolerance, |case| case.strict.kkt),
                marked("multigrid", cases, tolerance, |case| case.multigrid.kkt),
            ];
            let asked = cases.iter().map(|case| (case.tolerance, case.tolerance)).collect();
            curves.push(Curve::reference("as asked", asked));
            let axes = ["tolerance over the load", "KKT residual"];
            panel(format!("Problem {}", k + 1), axes, curves)
        })
        .collect();
    drawn(caption, 2, &parts)
}

/// Work and contact as the integral of f tends to zero.
pub(super) fn draw_deficits(inputs: &Inputs, caption: Caption) -> Drawn {
    let found: Stress = result(inputs, "stress")?;
    let deficit = |case: &Deficit| case.deficit;
    let (mut work, mut contact) = (Vec::new(), Vec::new());
    for (cases, way) in found.deficits.iter().zip(["up", "down"]) {
        let label = |method: &str| format!("{method}, {way}");
        work.push(marked(label("Arrow-Hurwicz"), cases, deficit, |case| steps(&case.saddle)));
        work.push(marked(label("multigrid"), cases, deficit, |case| Some(case.multigrid.work)));
        contact.push(marked(label("multigrid"), cases, deficit, |case| {
            Some(case.multigrid.contact as f64)
        }));
    }
    let parts = [
        panel("Work", ["deficit", "sweeps of the finest grid"], work),
        panel("Contact", ["deficit", "boundary nodes in contact"], contact),
    ];
    drawn(caption, 2, &parts)
}

/// What rounding leaves of the residual, over the grids.
pub(super) fn draw_precision(inputs: &Inputs, caption: Caption) -> Drawn {
    let found: Stress = result(inputs, "stress")?;
    let cells = |case: &Floor| case.cells as f64;
    let floors = &found.floors;
    let residual = vec![
        marked("multigrid, double", floors, cells, |case| case.multigrid.kkt),
        marked("Arrow-Hurwicz, double", floors, cells, |case| case.saddle.as_ref()?.kkt),
        marked("Arrow-Hurwicz, single", floors, cells, |case| Some(case.single?.kkt)),
    ];
    let units = vec![
        marked("multigrid, double", floors, cells, |case| case.multigrid.floor),
        marked("Arrow-Hurwicz, double", floors, cells, |case| case.saddle.as_ref()?.floor),
        marked("Arrow-Hurwicz, single", floors, cells, |case| Some(case.single?.floor)),
    ];
    let parts = [
        panel("Over the load", ["1/h", "KKT residual"], residual),
        panel("In roundings of y", ["1/h", "KKT residual over eps max |y|"], units),
    ];
    drawn(caption, 2, &parts)
}
