//! The `solve` stage: one cell is a problem, a stopping rule and an r, solved on all nested grids.
//!
//! Central is `solve`, which runs the paper's method for one cell.

use super::{artifact, from_json, to_json};
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, InputFiles, Inputs, Task, parameters};
use crate::replication::scene::{Output, Scene};
use crate::replication::stated::{OnSquare, StatedProblem};
use serde::{Deserialize, Serialize};
use signorini_mathematics::discrete::end::Outcome;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule, load};
use signorini_mathematics::discrete::network::Network;
use signorini_mathematics::discrete::norms::max_error;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::levels::{Problem, SaddleRun};
use signorini_mathematics::saddle::{Iteration, Monitor, Pair, Params, Plain, StopRule};
use signorini_mathematics::solvers::{self, Settings, Solver};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Parameters that determine the artifacts of a cell.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Cell {
    #[serde(flatten)]
    problem: StatedProblem,
    prolongation: Prolongation,
    r: f64,
    stop: StopRule,
    max_iterations: usize,
    /// True if the pair on the finest grid is drawn.
    keep_pair: bool,
    /// True if the history of residuals is drawn.
    keep_history: bool,
}

/// Contents of the artifact [`OUTCOMES`].
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
pub(crate) const OUTCOMES: &str = "outcomes.json";
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

/// The tasks that solve those cells of a scene under a rule for which a table or a figure asks.
pub(super) fn tasks(scene: &Scene, stop: StopRule) -> Vec<Task> {
    let mut tasks = Vec::new();
    for &r in &scene.r {
        let cell = cell(scene, stop, r);
        if scene.wants(Output::Table) || cell.keep_pair || cell.keep_history {
            tasks.push(task(scene, cell));
        }
    }
    tasks
}

/// Solves a scene on the square on its finest grid by multigrid, with f integrated exactly; a is the flux.
pub(super) fn solution(scene: &Scene) -> Result<Pair, Failure> {
    let square = OnSquare {
        load: LoadRule::Exact { diagonal: Diagonal::default() },
        grids: vec![scene.finest()],
        ..scene.on_grids().clone()
    };
    let stated = StatedProblem::on_square(square, scene.problem.law);
    let problem = stated.problem(&InputFiles::new())?;
    let run = solvers::solve(&problem, &Settings::of(Solver::Multigrid))
        .map_err(|e| format!("scene `{}`: {e}", scene.name))?;
    let a = run.judgement.multiplier(&run.y);
    Ok(Pair { y: run.y, a })
}

/// Runs the first rule with the drawn r on a scene on the square. Returns each grid with the pair where the rule stops
/// there.
pub(super) fn stops(scene: &Scene) -> Result<Vec<(Grid, Pair)>, Failure> {
    let cell = Cell { keep_history: false, ..drawn(scene) };
    let (_, Recorder { pairs, .. }) = run(&cell, &InputFiles::new())?;
    Ok(scene.on_grids().grids.iter().copied().zip(pairs).collect())
}

/// Returns the cell of a scene that is drawn: its first rule, with the drawn r.
pub(super) fn drawn(scene: &Scene) -> Cell {
    cell(scene, scene.stop[0], scene.drawn_r())
}

fn cell(scene: &Scene, stop: StopRule, r: f64) -> Cell {
    let drawn_rule = stop == scene.stop[0];
    Cell {
        problem: scene.problem.clone(),
        prolongation: scene.prolongation,
        r,
        stop,
        max_iterations: scene.max_iterations,
        keep_pair: r == scene.drawn_r()
            && ((scene.wants(Output::Surface) && drawn_rule) || scene.wants(Output::Contact)),
        keep_history: scene.wants(Output::History) && drawn_rule,
    }
}

fn task(scene: &Scene, cell: Cell) -> Task {
    let (id, files) = (id(scene, cell.stop, cell.r), cell.problem.files());
    let parameters = parameters(&cell);
    let task = Task::new(id, parameters, Vec::new(), move |inputs| solve(&cell, inputs.files));
    Task { files, ..task }
}

/// Runs the paper's method for a cell, its mesh read from these files. Returns the outcome on each level, and what was
/// recorded.
fn run(cell: &Cell, files: &InputFiles) -> Result<(Vec<Outcome>, Recorder), Failure> {
    let problem = cell.problem.problem(files)?;
    let loads: Vec<_> =
        problem.loads().map_err(|e| e.to_string())?.into_iter().map(Cow::into_owned).collect();
    let loaded = problem.law().with_loads(&loads);
    let params = Params {
        r: cell.r,
        rule: cell.stop,
        max_iterations: cell.max_iterations,
        ..Params::default()
    };
    let mut recorder = Recorder { keep_history: cell.keep_history, ..Recorder::default() };
    let prolongation = cell.prolongation;
    let run = SaddleRun { params: &params, prolongation, monitor: &mut recorder };
    let (outcomes, _) = problem.levels().saddle(loaded, run);
    Ok((outcomes, recorder))
}

fn solve(cell: &Cell, files: &InputFiles) -> Result<Artifacts, Failure> {
    let (levels, Recorder { history, pairs, .. }) = run(cell, files)?;
    let mut errors = Vec::new();
    if let Some((square, exact)) = cell.problem.square().and_then(|on| Some((on, on.f.exact()?))) {
        for (&grid, pair) in square.grids.iter().zip(&pairs) {
            errors.push(max_error(grid, &pair.y, |x, y| exact.at(x, y).value));
        }
    }
    let outcomes = Outcomes { schema: 1, r: cell.r, levels, errors };
    let mut artifacts = outcomes.artifacts(pairs.last().filter(|_| cell.keep_pair))?;
    if cell.keep_history {
        artifacts.insert(HISTORY.into(), to_json(&history));
    }
    Ok(artifacts)
}

impl Outcomes {
    /// Artifacts with these outcomes, and the last pair if it is drawn; fails if the iteration diverged.
    fn artifacts(&self, drawn: Option<&Pair>) -> Result<Artifacts, Failure> {
        if let Some(last) = self.levels.last().filter(|last| last.end.stop == Stop::Diverged) {
            let place = match last.cells {
                Some(cells) => format!("grid 1/{cells}"),
                None => format!("the mesh of {} nodes", last.nodes),
            };
            return Err(format!(
                "diverged on {place} after {} iterations at r = {}; choose a smaller r or scale f down",
                last.end.iterations, self.r
            )
            .into());
        }
        let mut artifacts = Artifacts::from([(OUTCOMES.to_owned(), to_json(self))]);
        if let Some(pair) = drawn {
            artifacts.insert(PAIR.into(), pair_bytes(pair));
        }
        Ok(artifacts)
    }
}

/// Monitor that records the last pair on each level and, if asked, all iterations.
#[derive(Default)]
struct Recorder {
    keep_history: bool,
    history: Vec<Vec<Iteration>>,
    pairs: Vec<Pair>,
}

impl Monitor for Recorder {
    fn wants_iterations(&self) -> bool {
        self.keep_history
    }

    fn iteration(&mut self, level: usize, iteration: &Iteration) {
        self.history.resize_with(level, Vec::new);
        self.history[level - 1].push(*iteration);
    }

    fn level(&mut self, _: usize, pair: &Pair) {
        self.pairs.push(pair.clone());
    }
}

/// Returns, in words, how the iteration on the finest grid with the r that is drawn ended, unless with a solution.
pub(super) fn no_solution(
    inputs: &Inputs,
    scene: &Scene,
    stop: StopRule,
) -> Result<Option<String>, String> {
    let outcomes: Outcomes = from_json(inputs, &id(scene, stop, scene.drawn_r()), OUTCOMES)?;
    let end = outcomes.levels.last().map_or(CONVERGED, Outcome::name);
    Ok((end != CONVERGED).then(|| end.replace('-', " ")))
}

/// Returns the name, in a picture, of the solve of a scene under a rule with the r that is drawn.
pub(super) fn label(inputs: &Inputs, scene: &Scene, stop: StopRule) -> Result<String, String> {
    let label = format!("stop: {stop}, r = {}", scene.drawn_r());
    Ok(match no_solution(inputs, scene, stop)? {
        Some(end) => format!("{label}, {end}"),
        None => label,
    })
}

/// [End](Outcome::name) of an iteration with a solution.
const CONVERGED: &str = "converged";

/// Number of solves that a line names.
const MOST_NAMED: usize = 3;

/// Returns a line on the solves of a scene that ended without a solution on the finest level, if there are any, with a
/// command that shows one of them; `outcomes` reads the [`OUTCOMES`] of a task, or returns `None` for a task that is
/// not concerned.
pub(crate) fn without_solution(
    scene: &Scene,
    outcomes: impl Fn(&str) -> Option<Vec<u8>>,
) -> Option<String> {
    let mut ends: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let mut command = None;
    for &stop in &scene.stop {
        for &r in &scene.r {
            let Some(bytes) = outcomes(&id(scene, stop, r)) else { continue };
            let Ok(Outcomes { levels, .. }) = serde_json::from_slice(&bytes) else { continue };
            let Some(end) = levels.last().map(Outcome::name) else { continue };
            if end == CONVERGED {
                continue;
            }
            let [mut place, mut options] = [format!("r = {r}"), format!("--r {r}")];
            if stop != scene.stop[0] {
                place += &format!(" under {stop}");
                options += &format!(" --stop {stop}");
            }
            ends.entry(end).or_default().push(place);
            command.get_or_insert(format!("signorini solve {} {options}", scene.name));
        }
    }
    let mut parts = Vec::new();
    for (end, mut places) in ends {
        let more = places.split_off(places.len().min(MOST_NAMED)).len();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        parts.push(format!("{end} with {}{more}", places.join(", ")));
    }
    Some(format!("{}: {}; `{}` says why", scene.name, parts.join("; "), command?))
}

/// Returns the pair of a scene where a rule stops on the finest level of its `problem`, with the r that is drawn.
pub(super) fn pair(
    inputs: &Inputs,
    scene: &Scene,
    stop: StopRule,
    problem: &Problem,
) -> Result<Pair, String> {
    pair_of(inputs, &id(scene, stop, scene.drawn_r()), problem.lengths())
}

/// Returns the pair of a scene on the square where a rule stops on the finest grid, with the r that is drawn.
pub(super) fn pair_on_grid(inputs: &Inputs, scene: &Scene, stop: StopRule) -> Result<Pair, String> {
    let grid = scene.finest();
    pair_of(inputs, &id(scene, stop, scene.drawn_r()), [grid.nodes(), grid.boundary_nodes()])
}

/// Returns the pair of a task, y and a of these lengths.
fn pair_of(inputs: &Inputs, task: &str, [nodes, on_boundary]: [usize; 2]) -> Result<Pair, String> {
    let (chunks, _) = artifact(inputs, task, PAIR)?.as_chunks();
    let values: Vec<f64> = chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
    if values.len() != nodes + on_boundary {
        return Err(format!("{PAIR} of {task} is for another grid"));
    }
    let (y, a) = values.split_at(nodes);
    Ok(Pair { y: y.to_vec(), a: a.to_vec() })
}

/// Returns the bytes of the artifact [`PAIR`].
fn pair_bytes(pair: &Pair) -> Vec<u8> {
    pair.y.iter().chain(&pair.a).flat_map(|v| v.to_le_bytes()).collect()
}

/// Returns the components of the gradient (8) at the nodes of the finest grid where the first rule stops, with the r
/// that is drawn.
pub(super) fn gradient(inputs: &Inputs, scene: &Scene) -> Result<Vec<f64>, String> {
    let (grid, pair) = (scene.finest(), pair_on_grid(inputs, scene, scene.stop[0])?);
    let square = scene.on_grids();
    let load = load(grid, &square.f, square.load);
    let network = Network::of_square(grid);
    let functional = Plain { network: &network, law: scene.law(), load: &load, r: scene.drawn_r() };
    Ok((0..grid.nodes()).map(|node| functional.gradient(node, &pair)).collect())
}
