//! Multigrid from grid to grid.

use super::goal::MultigridGoal;
use super::{Prepared, TimedFacts, TimedPlan, TimedRun};
use crate::discrete::grid::Grid;
use crate::discrete::load::{LoadRule, load};
use crate::experiments::rows::row_of;
use crate::multigrid::{InputError, Multigrid};
use crate::problem::law::Law;
use crate::problem::source::Source;
use serde::Serialize;
use std::sync::{Arc, Mutex};

/// Runs on all grids from 1/32 on, to both goals.
pub(super) fn runs(plan: &TimedPlan) -> impl Iterator<Item = Prepared> {
    let grids = (5..).map(|level| 1 << level).take_while(|cells| *cells <= plan.finest);
    grids.map(|cells| on_grid(cells, &plan.threads))
}

/// Load vector and workspace of one grid.
struct Workspace {
    load: Vec<f64>,
    multigrid: Multigrid,
    y: Vec<f64>,
}

/// Table `multigrid`: multigrid on [`TimedPlan::SCALED`] in a workspace that is there.
#[derive(Serialize)]
struct ScalingRow {
    cells: usize,
    /// Number of threads that multigrid can use.
    threads: usize,
    goal: MultigridGoal,
    /// Cost in sweeps of the finest grid.
    work_units: f64,
    /// Bytes moved per unknown, each pass reading and writing each row once.
    traffic: f64,
}

impl Workspace {
    /// Solves; returns work units and traffic.
    fn solve(&mut self, goal: MultigridGoal) -> Result<[f64; 2], InputError> {
        let problem = Law::SIGNORINI.with_load(&self.load);
        let end = self.multigrid.solve(problem, &goal.params())?;
        // A caller waits for the solution in the order of the load.
        self.multigrid.write_solution(&mut self.y);
        Ok([end.work_units, self.multigrid.traffic()])
    }
}

fn on_grid(cells: usize, threads: &[usize]) -> Prepared {
    let grid = Grid::new(cells).map_err(|e| e.clone())?;
    let load = load(grid, &Source::from(TimedPlan::SCALED), LoadRule::default());
    let multigrid = Multigrid::square(cells).map_err(|e| e.to_string())?;
    let workspace = Workspace { y: vec![0.0; load.len()], multigrid, load };
    let workspace = Arc::new(Mutex::new(workspace));
    let mut runs = Vec::new();
    for &threads in threads {
        for goal in MultigridGoal::ALL {
            let workspace = Arc::clone(&workspace);
            let run = TimedRun::new(
                format!("multigrid, h = 1/{cells}"),
                move || workspace.lock().expect("no run has panicked").solve(goal),
                move |cost: Result<_, InputError>| {
                    let [work_units, traffic] = cost.map_err(|e| e.to_string())?;
                    let row = ScalingRow { cells, threads, goal, work_units, traffic };
                    Ok(Some(TimedFacts { table: "multigrid", row: row_of(row) }))
                },
            );
            runs.push(TimedRun { threads: Some(threads), ..run });
        }
    }
    Ok(runs)
}
