//! The `solve` stage: one cell is a problem with a solver, solved once; for a saddle-point method, a problem, a
//! stopping rule and an r, solved on all nested levels.
//!
//! Central is [`Cell::made`], which solves as the command `solve` does.

use super::members::id_of;
use super::{artifact, from_json, to_json};
use crate::pipeline::error::{Error, Failure, Result as Read};
use crate::pipeline::{Artifacts, Group, InputFiles, Inputs, Made, Task};
use crate::replication::fields::member::Member;
use crate::replication::fields::table::Voice;
use crate::replication::mesh_files;
use crate::replication::numbers::Numbers;
use crate::replication::record::Record;
use crate::replication::scene::{Output, Scene};
use crate::timing::machine;
use serde::{Deserialize, Serialize};
use serde_json::json;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::problem::text::percent;
use signorini_mathematics::saddle::{Iteration, Monitor, Pair, StopRule};
use signorini_mathematics::solvers::{Memory, ReachEnd, SaddleSettings, Solved, Tried, Watcher};
use signorini_mathematics::statement::{Fineness, Statement};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Statement of one cell, and the artifacts that it has, besides the file of a mesh.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Cell {
    #[serde(flatten)]
    statement: Statement,
    /// True if the pair on the finest grid is drawn.
    keep_pair: bool,
    /// True if the history of residuals is drawn.
    keep_history: bool,
    /// True for a member of a study, whose row says why there is no solution.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    is_row: bool,
}

/// Artifact with the [`Numbers`] of a solve.
pub(crate) const NUMBERS: &str = "numbers.json";
/// Artifact with the pair on the finest grid: y, then a, as little-endian doubles; none of a run that diverged.
pub(super) const PAIR: &str = "pair.f64";
/// Artifact with the cells that were marked for each bisection of adapted meshes: their number, then theirs, as
/// little-endian integers of 32 bits.
const MARKS: &str = "marks.u32";
/// Artifact with every [`Iteration`], per grid.
pub(super) const HISTORY: &str = "history.json";

/// The tasks that solve those members of a scene for which a table or a figure asks.
pub(super) fn tasks(scene: &Scene) -> Vec<Task> {
    let mut tasks = Vec::new();
    for member in &scene.study.members {
        let cell = cell(scene, member);
        if scene.wants(Output::Table) || cell.is_row || cell.keep_pair || cell.keep_history {
            let path = mesh_files::path_of(&member.statement.domain);
            let file = path.and_then(|path| scene.files.get_key_value(&path));
            let files = file.map(|(path, file)| (path.clone(), file.clone())).into_iter().collect();
            let task = Task::in_group(id_of(scene, member), &cell, cell.group(), Cell::made);
            tasks.push(task.with_files(files));
        }
    }
    tasks
}

/// Solves a scene on the square on its finest grid by multigrid, with f integrated exactly; a is the flux.
pub(super) fn solution(scene: &Scene) -> Result<Pair, Failure> {
    let statement = scene.statement.exactly();
    let solved = statement.solved(None).map_err(|e| format!("scene `{}`: {e}", scene.name))?;
    Ok(solved.pair())
}

/// Runs the first rule with the drawn r on a scene on the square. Returns each grid with the pair where the rule stops
/// there.
pub(super) fn stops(scene: &Scene) -> Result<Vec<(Grid, Pair)>, Failure> {
    let (drawn, never) = (cell(scene, scene.drawn(scene.first_rule())), AtomicBool::new(false));
    let mut recorder = drawn.recorder(&never);
    drawn.solved(&InputFiles::new(), &mut recorder)?;
    Ok(scene.grids().into_iter().zip(recorder.pairs).collect())
}

fn cell(scene: &Scene, member: &Member) -> Cell {
    let rule = member.rule();
    let is_first_rule = rule == scene.first_rule();
    Cell {
        statement: member.statement.clone(),
        keep_pair: !scene.is_study
            && member == scene.drawn(rule)
            && ((is_first_rule && (scene.wants(Output::Surface) || scene.wants(Output::Map)))
                || scene.wants(Output::Contact)),
        keep_history: scene.wants(Output::History) && is_first_rule,
        is_row: scene.is_study,
    }
}

/// Solves a statement; a mesh is read from these files, and refined for values at nodes if `has_nodes`. Between two
/// grids or meshes it ends if it is interrupted. A refusal is written in this voice.
pub(super) fn solved(
    (statement, voice): (&Statement, Voice),
    files: &InputFiles,
    has_nodes: bool,
    recorder: &mut Recorder<'_>,
) -> Read<Solved> {
    let problem = mesh_files::problem_in(voice, statement, files, has_nodes)?;
    let solved = statement.solve(problem, memory(), recorder, &|_| ());
    let solved = solved.map_err(|e| voice.refused(statement, &e))?;
    match solved.reached.as_ref().map(|way| way.end) {
        Some(ReachEnd::Interrupted { .. }) => Err(Error::Interrupted),
        _ => Ok(solved),
    }
}

/// Memory that solvers may take.
fn memory() -> Memory {
    Memory::new(machine::available_memory())
}

/// Returns the numbers of a statement, or the reason for which there is no solution, in this voice; a mesh is read from
/// these files.
///
/// # Errors
/// [`Error::Interrupted`].
pub(crate) fn numbers(
    (statement, voice): (&Statement, Voice),
    files: &InputFiles,
    interrupted: &AtomicBool,
) -> Read<Numbers> {
    match solved((statement, voice), files, false, &mut Recorder::new(interrupted)) {
        Ok(solved) => {
            let record = Record::of((statement, voice), &solved);
            Ok(Numbers::of(statement, &solved, &record))
        }
        Err(Error::Interrupted) => Err(Error::Interrupted),
        Err(reason) => Ok(Numbers::without(statement, reason.to_string())),
    }
}

impl Cell {
    /// Most cells that are solved side by side, so that not much is lost if the run is broken off.
    const MOST: usize = 32;

    /// Cells that take less time side by side: all with this statement but for settings of a saddle-point method.
    fn group(&self) -> Option<Group> {
        let shared = self.statement.without_settings()?;
        Some(Group { key: json!({ "solve": shared }).to_string(), most: Self::MOST })
    }

    /// Solves cells of one group, or one alone; meshes are read from the files of each.
    fn made(cells: &[(Self, &Inputs)]) -> Vec<Made> {
        let mut recorders: Vec<_> =
            cells.iter().map(|(cell, inputs)| cell.recorder(inputs.interrupted)).collect();
        let solved = match cells {
            [_] => None,
            _ => Self::together(cells, &mut recorders),
        };
        let mut solved = solved.into_iter().flatten();
        let mut made = Vec::new();
        for ((cell, inputs), mut recorder) in cells.iter().zip(recorders) {
            // A refusal is written for each.
            let solved = solved.next().map_or_else(|| cell.solved(inputs.files, &mut recorder), Ok);
            made.push(cell.artifacts(solved, recorder));
        }
        made
    }

    /// Solves cells of one group side by side; returns nothing if one is refused, as then all are.
    fn together(cells: &[(Self, &Inputs)], recorders: &mut [Recorder<'_>]) -> Option<Vec<Solved>> {
        let (first, inputs) = &cells[0];
        let problem = mesh_files::problem(&first.statement, inputs.files).ok()?;
        let statements: Vec<_> = cells.iter().map(|(cell, _)| &cell.statement).collect();
        let mut monitors: Vec<_> = recorders.iter_mut().map(|of| of as &mut dyn Monitor).collect();
        Statement::solve_together(&statements, &problem, &mut monitors).ok()
    }

    fn recorder<'a>(&self, interrupted: &'a AtomicBool) -> Recorder<'a> {
        Recorder { keep_history: self.keep_history, ..Recorder::new(interrupted) }
    }

    /// Solves; a mesh is read from these files.
    fn solved(&self, files: &InputFiles, recorder: &mut Recorder<'_>) -> Read<Solved> {
        solved((&self.statement, Voice::Keys), files, self.keep_pair, recorder)
    }

    /// Artifacts of what was solved; of a member of a study also where there is no solution.
    fn artifacts(&self, solved: Read<Solved>, recorder: Recorder<'_>) -> Made {
        let statement = &self.statement;
        let solved = match solved {
            Err(Error::Interrupted) => return Err(Error::Interrupted.into()),
            Err(reason) if self.is_row => {
                let numbers = Numbers::without(statement, reason.to_string());
                return Ok(Artifacts::from([(NUMBERS.to_owned(), to_json(&numbers))]));
            }
            solved => solved?,
        };
        let record = Record::of((statement, Voice::Keys), &solved);
        let shortfall = record.failure.as_ref().filter(|_| record.is_solution && !self.is_row);
        if let Some(shortfall) = shortfall {
            return Err(Error::input(shortfall.sentence()).into());
        }
        let numbers = Numbers::of(statement, &solved, &record);
        let mut artifacts = Artifacts::from([(NUMBERS.to_owned(), to_json(&numbers))]);
        let Recorder { mut pairs, history, .. } = recorder;
        // A saddle-point method has a multiplier of its own.
        if self.keep_pair && pairs.is_empty() {
            pairs.push(solved.pair());
        }
        if let Some(pair) = pairs.last().filter(|pair| self.keep_pair && is_finite(pair)) {
            artifacts.insert(PAIR.into(), pair_bytes(pair));
        }
        let marks = solved.reached.and_then(|reached| reached.marks);
        // Of a study nothing is drawn.
        if let Some(marks) = marks.filter(|_| !self.is_row) {
            artifacts.insert(MARKS.into(), marks_bytes(&marks));
        }
        if self.keep_history {
            artifacts.insert(HISTORY.into(), to_json(&history));
        }
        Ok(artifacts)
    }
}

/// Monitor that records the last pair of a saddle-point method on each level and, if asked, all iterations.
pub(super) struct Recorder<'a> {
    keep_history: bool,
    history: Vec<Vec<Iteration>>,
    pairs: Vec<Pair>,
    interrupted: &'a AtomicBool,
}

impl<'a> Recorder<'a> {
    /// Recorder that keeps no history.
    pub(super) fn new(interrupted: &'a AtomicBool) -> Self {
        Self { keep_history: false, history: Vec::new(), pairs: Vec::new(), interrupted }
    }
}

impl Watcher for Recorder<'_> {
    fn tried(&mut self, _: Tried<'_>) -> ControlFlow<()> {
        match self.interrupted.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

impl Monitor for Recorder<'_> {
    fn has_history(&self) -> bool {
        self.keep_history
    }

    fn level(&mut self, pair: &Pair, history: &[Iteration]) {
        // The last of a run that diverged are no numbers.
        let history = history.iter().copied();
        let numbers = history.filter(|it| it.gradient_abs.is_finite() && it.delta_a.is_finite());
        self.history.push(numbers.collect());
        self.pairs.push(pair.clone());
    }
}

/// Returns, in words, how a solver ended, unless with a solution.
pub(super) fn no_solution(numbers: &Numbers) -> Option<String> {
    numbers.reason.as_ref().and(numbers.last.stop.as_ref()).map(|end| end.replace('-', " "))
}

/// Returns the numbers of a scene under a rule, with the r that is drawn.
pub(super) fn drawn(
    inputs: &Inputs,
    scene: &Scene,
    rule: Option<StopRule>,
) -> Result<Numbers, String> {
    from_json(inputs, &id_of(scene, scene.drawn(rule)), NUMBERS)
}

/// Returns, in words, what the pair of a scene under a rule is that is drawn.
pub(super) fn state(
    inputs: &Inputs,
    scene: &Scene,
    rule: Option<StopRule>,
) -> Result<String, String> {
    if let Some(SaddleSettings { stop: rule, r, .. }) = scene.drawn(rule).statement.saddle {
        return Ok(format!("where the rule {rule} stops, r = {r}"));
    }
    Ok(match (no_solution(&drawn(inputs, scene, rule)?), scene.statement.accuracy()) {
        (Some(end), _) => end,
        // The solver stops where its error is that of the grid.
        (None, Some(Accuracy::Error(wanted))) => {
            format!("with an error of at most {}", percent(wanted, 3))
        }
        (None, _) => "the solution".into(),
    })
}

/// Returns the warnings of a scene with these numbers; those of a published table are in the book.
pub(super) fn warnings<'a>(scene: &Scene, numbers: &'a Numbers) -> &'a [String] {
    if scene.paper_table.is_some() { &[] } else { &numbers.warnings }
}

/// Returns these warnings in sentences with a space behind them.
pub(super) fn warnings_in_words(scene: &Scene, numbers: &Numbers) -> String {
    let warnings = warnings(scene, numbers);
    warnings.iter().flat_map(|text| ["Warning: ", text, ". "]).collect()
}

/// Returns the warnings and the guaranteed bounds of a scene in sentences with a space behind them; nothing if it has
/// none.
pub(super) fn bounds_in_words(scene: &Scene, numbers: &Numbers) -> String {
    let guarantee = numbers.guarantee().filter(|_| scene.statement.saddle.is_none());
    let sentence = guarantee.map(|of| format!("Guaranteed{}: {}. ", of.but, of.parts.join(", ")));
    warnings_in_words(scene, numbers) + &sentence.unwrap_or_default()
}

/// Guaranteed bound of the error over the solution that a picture of a scene has, if it is less than that; none under a
/// rule, which stops where it says.
pub(super) fn relative(scene: &Scene, numbers: &Numbers) -> Option<f64> {
    numbers.last.error_relative.filter(|&error| error < 1.0 && scene.statement.saddle.is_none())
}

/// Returns the name, in a picture, of the solve of a scene under a rule with the r that is drawn.
pub(super) fn label(scene: &Scene, rule: Option<StopRule>) -> String {
    match scene.drawn(rule).statement.saddle {
        Some(SaddleSettings { stop, r, .. }) => format!("stop: {stop}, r = {r}"),
        None => scene.statement.solver.entry().in_words.to_owned(),
    }
}

/// Returns the problem of a scene on the levels on which it was solved: those of the scene or, for an accuracy, the
/// grid or the adapted mesh that reached it.
pub(super) fn problem(inputs: &Inputs, scene: &Scene) -> Result<Problem, Failure> {
    let mut statement = scene.statement.clone();
    if statement.accuracy().is_some() {
        let mesh = mesh_files::mesh(&statement, inputs.files)?;
        let task = id_of(scene, scene.drawn(None));
        if let (Some(mesh), Ok(marks)) = (&mesh, artifact(inputs, &task, MARKS)) {
            let problem = statement.problem_on_bisected(mesh, &marks_of(marks)?);
            return Ok(problem.map_err(|e| e.to_string())?);
        }
        let cells = drawn(inputs, scene, None)?.levels().last().and_then(|level| level.cells);
        statement.fineness = Fineness::Grids(cells.into_iter().collect());
    }
    Ok(mesh_files::problem(&statement, inputs.files)?)
}

/// Returns the share of the boundary under the law that sticks.
pub(super) fn held(problem: &Problem, pair: &Pair) -> f64 {
    let (domain, mut held, mut all) = (problem.domain(problem.finest()), 0.0, 0.0);
    for (node, is_held) in domain.contact().iter().zip(problem.in_contact(pair)) {
        all += node.measure;
        held += if is_held { node.measure } else { 0.0 };
    }
    held / all
}

/// Returns the bytes of the artifact [`MARKS`].
fn marks_bytes(marks: &[Vec<u32>]) -> Vec<u8> {
    let lists = marks.iter().flat_map(|list| [&[list.len() as u32][..], list].concat());
    lists.flat_map(u32::to_le_bytes).collect()
}

/// Reads the artifact [`MARKS`].
fn marks_of(bytes: &[u8]) -> Result<Vec<Vec<u32>>, String> {
    let (chunks, _) = bytes.as_chunks();
    let numbers: Vec<u32> = chunks.iter().map(|chunk| u32::from_le_bytes(*chunk)).collect();
    let (mut rest, mut marks) = (&numbers[..], Vec::new());
    while let Some((&count, lists)) = rest.split_first() {
        let list = lists.split_at_checked(count as usize);
        let (list, more) = list.ok_or_else(|| format!("{MARKS} ends in a list"))?;
        marks.push(list.to_vec());
        rest = more;
    }
    Ok(marks)
}

/// Returns the pair of a scene on the finest level of its `problem`: the solution or, under a rule, where that stops
/// with the r that is drawn.
pub(super) fn pair(
    inputs: &Inputs,
    scene: &Scene,
    rule: Option<StopRule>,
    problem: &Problem,
) -> Result<Pair, String> {
    pair_of(inputs, &id_of(scene, scene.drawn(rule)), problem.lengths())
}

/// Returns the pair of a scene on the square where its first rule stops on the finest grid, with the r that is drawn.
pub(super) fn pair_on_grid(inputs: &Inputs, scene: &Scene) -> Result<Pair, String> {
    let grid = scene.finest();
    let drawn = id_of(scene, scene.drawn(scene.first_rule()));
    pair_of(inputs, &drawn, [grid.nodes(), grid.boundary_nodes()])
}

/// Returns the pair of a task, y and a of these lengths.
fn pair_of(inputs: &Inputs, task: &str, [nodes, on_boundary]: [usize; 2]) -> Result<Pair, String> {
    let Ok(bytes) = artifact(inputs, task, PAIR) else {
        let numbers: Numbers = from_json(inputs, task, NUMBERS)?;
        let reason = numbers.reason.unwrap_or_else(|| format!("{task} keeps no solution"));
        return Err(format!("nothing to draw: {reason}"));
    };
    let (chunks, _) = bytes.as_chunks();
    let values: Vec<f64> = chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect();
    if values.len() != nodes + on_boundary {
        return Err(format!("{PAIR} of {task} is for another grid"));
    }
    let (y, a) = values.split_at(nodes);
    Ok(Pair { y: y.to_vec(), a: a.to_vec() })
}

/// True unless the run of a pair diverged.
fn is_finite(pair: &Pair) -> bool {
    pair.y.iter().chain(&pair.a).all(|value| value.is_finite())
}

/// Returns the bytes of the artifact [`PAIR`].
fn pair_bytes(pair: &Pair) -> Vec<u8> {
    pair.y.iter().chain(&pair.a).flat_map(|v| v.to_le_bytes()).collect()
}

/// Returns the components of the gradient (8) at the nodes of the finest grid where the first rule stops, with the r
/// that is drawn.
pub(super) fn gradient(inputs: &Inputs, scene: &Scene) -> Result<Vec<f64>, Failure> {
    let problem = mesh_files::problem(&scene.statement, inputs.files)?;
    let gradient = problem.gradient(scene.saddle().r, &pair_on_grid(inputs, scene)?);
    Ok(gradient.ok_or("the gradient is drawn on the square")?)
}

#[cfg(test)]
pub(super) mod tests;
