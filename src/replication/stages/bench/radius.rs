//! Spectral radius of one iteration of the paper's method, and the picture of it.

use crate::figures::Stroke::{Line, Marked};
use crate::figures::{Chart, Curve, Picture, charts};
use crate::pipeline::{Artifacts, Inputs, Made, Task};
use crate::replication::project::Project;
use crate::replication::stages::to_json;
use crate::table::rows::Rows;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::json;
use signorini_mathematics::statement::{Domain, Fineness, Statement};

/// Problems, grids by cells per side, and values of r, the largest first.
#[derive(Serialize, Deserialize)]
pub(super) struct AskedRadius {
    /// Names and f.
    problems: Vec<(String, String)>,
    cells: Vec<usize>,
    r: Vec<f64>,
    /// Duality parameter with which the method itself runs, from zero.
    measured_r: f64,
}

impl AskedRadius {
    /// The task of the book: the paper's problems, and one that is in contact nearly everywhere.
    pub(super) fn task(project: &Project) -> Task {
        let mut problems = Vec::new();
        for (scene, number) in project.problems().into_iter().zip(1..) {
            problems.push((format!("problem {number}"), scene.statement.f.clone()));
        }
        problems.push(("free-corner".into(), "exact(free-corner)".into()));
        let r = vec![1e6, 1e4, 1e3, 100.0, 30.0, 10.0, 3.0, 1.0, 0.5, 0.2];
        let asked = Self { problems, cells: vec![8, 16, 32], r, measured_r: 10.0 };
        Task::new(super::id("radius"), &asked, Vec::new(), |asked, _: &Inputs| asked.made())
    }

    fn made(&self) -> Made {
        let mut cases = Vec::new();
        for (problem, f) in &self.problems {
            cases.extend(self.cells.iter().map(|&cells| (problem, f, cells)));
        }
        let found = cases.par_iter().map(|&(problem, f, cells)| {
            let fineness = Fineness::Width(cells);
            let statement = Statement { fineness, ..Statement::usual(Domain::square(), f) };
            let found = statement.exactly().problem(None, &|_| ()).map_err(|e| e.to_string());
            let found = found.and_then(|stated| stated.convergence(&self.r, self.measured_r));
            found.map_err(|reason| format!("{problem} on 1/{cells}: {reason}"))
        });
        let found: Vec<_> = found.collect::<Result<_, String>>()?;
        let (mut radii, mut measured) = (Vec::new(), Vec::new());
        for ((problem, _, cells), found) in cases.iter().zip(found) {
            for (r, gap) in self.r.iter().zip(found.gaps) {
                radii.push(json!({
                    "problem": problem, "cells": cells, "contact": found.contact, "r": r, "gap": gap,
                    "per_h2": gap * (cells * cells) as f64,
                }));
            }
            measured.push(json!({
                "problem": problem, "cells": cells, "r": self.measured_r, "gap": found.measured,
            }));
        }
        let found = json!({ "radii": radii, "measured": measured, "plan": self });
        Ok(Artifacts::from([(super::RESULT.into(), to_json(&found))]))
    }
}

/// Draws one minus the spectral radius of one iteration against r: a panel per problem, a curve per grid, and in
/// rings what the method itself does.
pub(super) fn radius(radii: &Rows, measured: &Rows) -> Result<Picture, String> {
    let mut panels = Vec::new();
    for problem in radii.texts("problem")? {
        let rows = radii.wherever("problem", problem)?;
        let mut cells = rows.numbers("cells")?;
        cells.dedup();
        let mut curves = Vec::new();
        for cells in cells {
            let rows = rows.wherever("cells", cells as usize)?;
            let points = rows.points("r", "gap")?;
            curves.push(Curve::new(Line, format!("h = 1/{cells}"), points));
        }
        let rings = measured.wherever("problem", problem)?.points("r", "gap")?;
        curves.extend(
            rings.into_iter().map(|point| Curve::new(Marked, "the method itself", [point])),
        );
        let title = problem.replacen("problem", "Problem", 1);
        panels.push(Chart::new(title, ["duality parameter r", "1 - spectral radius"], curves));
    }
    Ok(charts(true, &panels))
}
