//! The `solve` stage: one cell is a problem, a stopping rule and an r, solved on all nested grids.

use super::{artifact, to_json};
use crate::discrete::grid::{Grid, nested};
use crate::discrete::kkt::judge;
use crate::discrete::load::{Diagonal, LoadRule, load};
use crate::discrete::norms::max_error;
use crate::discrete::transfer::Prolongation;
use crate::multigrid::{self, MultigridParams};
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::problem::exact::Exact;
use crate::problem::source::Source;
use crate::replication::scene::{Output, Scene};
use crate::saddle::{
    Iteration, Monitor, Outcome, Pair, Params, StopReason, StopRule, solve_nested,
};
use serde::{Deserialize, Serialize};

/// Everything a cell depends on.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Cell {
    f: Source,
    load: LoadRule,
    prolongation: Prolongation,
    grids: Vec<usize>,
    r: f64,
    stop: StopRule,
    max_iterations: usize,
    /// Whether the pair on the finest grid is drawn.
    keep_pair: bool,
    /// Whether the history of residuals is drawn.
    keep_history: bool,
}

/// `outcomes.json`.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Outcomes {
    schema: u8,
    pub(super) r: f64,
    /// Per grid, coarsest first.
    pub(super) levels: Vec<Outcome>,
    /// Greatest nodal error per grid; empty if no exact solution is known.
    pub(super) errors: Vec<f64>,
}

/// Artifact with an [`Outcomes`].
pub(super) const OUTCOMES: &str = "outcomes.json";
/// Artifact with the pair on the finest grid: y, then a, as little-endian doubles.
pub(super) const PAIR: &str = "pair.f64";
/// Artifact with every [`Iteration`], per grid.
pub(super) const HISTORY: &str = "history.json";

pub(super) fn id(scene: &Scene, stop: StopRule, r: f64) -> String {
    format!("solve/{}/{stop}/r={r}", scene.name)
}

/// Ids of the tasks that solve a scene under a rule, one per r.
pub(super) fn ids(scene: &Scene, stop: StopRule) -> impl Iterator<Item = String> {
    scene.r.iter().map(move |&r| id(scene, stop, r))
}

/// The tasks that solve the cells of a scene under a rule, as far as a table or a figure asks for them.
pub(super) fn tasks(scene: &Scene, stop: StopRule) -> impl Iterator<Item = Task> {
    let cells = scene.r.iter().map(move |&r| cell(scene, stop, r));
    let asked = |cell: &Cell| scene.wants(Output::Table) || cell.keep_pair || cell.keep_history;
    cells.filter(asked).map(|cell| task(scene, cell))
}

/// The discrete solution of a scene on its finest grid, with f integrated exactly; a is the flux.
pub(super) fn solution(scene: &Scene) -> Result<Pair, String> {
    let grid = scene.finest();
    let load = load(grid, &scene.f, LoadRule::Exact { diagonal: Diagonal::default() });
    let (y, _) = multigrid::solve_square(grid.cells(), &load, None, &MultigridParams::default())
        .map_err(|e| format!("scene `{}`: {e}", scene.name))?;
    let a = judge(grid, &y, &load).multiplier(grid.boundary(), &y, grid.h());
    Ok(Pair { y, a })
}

fn cell(scene: &Scene, stop: StopRule, r: f64) -> Cell {
    let drawn_rule = stop == scene.stop[0];
    Cell {
        f: scene.f.clone(),
        load: scene.load,
        prolongation: scene.prolongation,
        grids: scene.grids.iter().map(|grid| grid.cells()).collect(),
        r,
        stop,
        max_iterations: scene.max_iterations,
        keep_pair: r == scene.draw_r
            && ((scene.wants(Output::Surface) && drawn_rule) || scene.wants(Output::Contact)),
        keep_history: scene.wants(Output::History) && drawn_rule,
    }
}

fn task(scene: &Scene, cell: Cell) -> Task {
    let id = id(scene, cell.stop, cell.r);
    Task::new(id, parameters(&cell), Vec::new(), move |_| solve(&cell))
}

fn solve(cell: &Cell) -> Result<Artifacts, Failure> {
    let grids = nested(&cell.grids)?;
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &cell.f, cell.load)).collect();
    let params = Params {
        r: cell.r,
        rule: cell.stop,
        max_iterations: cell.max_iterations,
        ..Params::default()
    };
    let mut record =
        Record { keep_history: cell.keep_history, exact: cell.f.exact(), ..Record::default() };
    let (levels, pair) = solve_nested(&grids, &loads, &params, cell.prolongation, &mut record);
    if let Some(last) = levels.last().filter(|last| last.stop == StopReason::Diverged) {
        return Err(format!(
            "diverged on grid 1/{} after {} iterations at r = {}; choose a smaller r or scale f down",
            last.cells, last.iterations, cell.r
        )
        .into());
    }
    let outcomes = Outcomes { schema: 1, r: cell.r, levels, errors: record.errors };
    let mut artifacts = Artifacts::from([(OUTCOMES.to_owned(), to_json(&outcomes))]);
    if cell.keep_pair {
        let bytes = pair.y.iter().chain(&pair.a).flat_map(|v| v.to_le_bytes()).collect();
        artifacts.insert(PAIR.into(), bytes);
    }
    if cell.keep_history {
        artifacts.insert(HISTORY.into(), to_json(&record.history));
    }
    Ok(artifacts)
}

/// Keeps what the cell is asked to keep.
#[derive(Default)]
struct Record {
    keep_history: bool,
    exact: Option<Exact>,
    history: Vec<Vec<Iteration>>,
    errors: Vec<f64>,
}

impl Monitor for Record {
    fn wants_iterations(&self) -> bool {
        self.keep_history
    }

    fn iteration(&mut self, level: usize, iteration: &Iteration) {
        self.history.resize_with(level, Vec::new);
        self.history[level - 1].push(*iteration);
    }

    fn level(&mut self, grid: Grid, pair: &Pair) {
        if let Some(exact) = self.exact {
            self.errors.push(max_error(grid, &pair.y, |x, y| exact.at(x, y).value));
        }
    }
}

/// The pair where a rule stops on the finest grid, with the r that is drawn.
pub(super) fn pair(inputs: &Inputs, scene: &Scene, stop: StopRule) -> Result<Pair, String> {
    let grid = scene.finest();
    let (chunks, _) = artifact(inputs, &id(scene, stop, scene.draw_r), PAIR)?.as_chunks();
    let values: Vec<f64> = chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
    if values.len() != grid.nodes() + grid.boundary_nodes() {
        return Err(format!("{PAIR} is not for grid 1/{}", grid.cells()));
    }
    let (y, a) = values.split_at(grid.nodes());
    Ok(Pair { y: y.to_vec(), a: a.to_vec() })
}
