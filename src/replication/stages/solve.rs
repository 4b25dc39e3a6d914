//! The `solve` stage: one cell is a problem with a solver, solved once; for a saddle-point method, a problem, a
//! stopping rule and an r, solved on all nested levels.
//!
//! Central is [`Cell::run`], which solves as the command `solve` does.

use super::{artifact, from_json, to_json};
use crate::pipeline::error::{Error, Failure, Result as Read};
use crate::pipeline::names::in_shell;
use crate::pipeline::{Artifacts, InputFiles, Inputs, Task};
use crate::replication::fields::table::Voice;
use crate::replication::mesh_files;
pub(super) use crate::replication::numbers::CONVERGED;
use crate::replication::record::{Grouped, Judge, Record};
use crate::replication::scene::{Output, RuleAndR, Scene};
use crate::timing::machine;
use serde::{Deserialize, Serialize};
use signorini_mathematics::bounds::{Accuracy, Bounds};
use signorini_mathematics::discrete::end::Outcome;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::levels::{Problem, Reserve};
use signorini_mathematics::problem::text::{interval, known, plain};
use signorini_mathematics::saddle::{Iteration, Monitor, Pair, StopRule};
use signorini_mathematics::solvers::{Memory, ReachEnd, Solved, Tried, Watcher};
use signorini_mathematics::statement::{Fineness, Statement};
use std::collections::BTreeMap;
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
    /// True for a scene of a published table.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    is_papers: bool,
}

/// Contents of the artifact [`OUTCOMES`].
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Outcomes {
    schema: u8,
    /// Duality parameter of a saddle-point method.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) r: Option<f64>,
    /// Per grid on which the solver ended, coarsest first; empty for the spectral solver.
    pub(super) levels: Vec<Outcome>,
    /// Guaranteed bounds per grid, or none where there are none; empty for the saddle-point methods, which end where
    /// their rule says so, and one for the spectral solver.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) bounds: Vec<Option<Bounds>>,
    /// True if the accuracy of the energy was asked for.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    asks_energy: bool,
    /// Parts of the problem that the bounds leave out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) reserve: Vec<Reserve>,
    /// Iterations on the finest grid; of the spectral solver, Newton steps.
    pub(super) iterations: usize,
    /// Energy that answers: on the finest grid, as [`Outcomes::energy_on`] has it, or of the true solution.
    pub(super) energy: f64,
    /// Warnings that `solve` gives.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) warnings: Vec<String>,
    /// Remedy for them, and for a failure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) remedy: Option<String>,
}

/// Artifact with an [`Outcomes`].
pub(crate) const OUTCOMES: &str = "outcomes.json";
/// Artifact with the pair on the finest grid: y, then a, as little-endian doubles.
pub(super) const PAIR: &str = "pair.f64";
/// Artifact with the cells that were marked for each bisection of adapted meshes: their number, then theirs, as
/// little-endian integers of 32 bits.
const MARKS: &str = "marks.u32";
/// Artifact with every [`Iteration`], per grid.
pub(super) const HISTORY: &str = "history.json";

/// Id of the task of a run of a scene.
pub(super) fn id_of(scene: &Scene, run: Option<RuleAndR>) -> String {
    match run {
        Some(RuleAndR { rule, r }) => id(scene, rule, r),
        None => format!("solve/{}", scene.name),
    }
}

/// Id of the task of a saddle-point method under a rule with this r.
pub(super) fn id(scene: &Scene, rule: StopRule, r: f64) -> String {
    format!("solve/{}/{rule}/r={r}", scene.name)
}

/// Ids of the tasks that solve a scene under a rule, one per r.
pub(super) fn ids(scene: &Scene, rule: Option<StopRule>) -> impl Iterator<Item = String> {
    scene.runs(rule).into_iter().map(|run| id_of(scene, run))
}

/// The tasks that solve those cells of a scene under a rule for which a table or a figure asks.
pub(super) fn tasks(scene: &Scene, rule: Option<StopRule>) -> Vec<Task> {
    let mut tasks = Vec::new();
    for run in scene.runs(rule) {
        let cell = cell(scene, run);
        if scene.wants(Output::Table) || cell.keep_pair || cell.keep_history {
            tasks.push(task(id_of(scene, run), cell, scene.files.clone()));
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
    let drawn = cell(scene, scene.drawn(scene.first_rule()));
    let (_, Recorder { pairs, .. }, _) = drawn.run(&InputFiles::new(), &AtomicBool::new(false))?;
    Ok(scene.grids().into_iter().zip(pairs).collect())
}

fn cell(scene: &Scene, run: Option<RuleAndR>) -> Cell {
    let rule = run.map(|run| run.rule);
    let is_first_rule = rule == scene.first_rule();
    Cell {
        statement: scene.of_run(run),
        keep_pair: run == scene.drawn(rule)
            && ((is_first_rule && (scene.wants(Output::Surface) || scene.wants(Output::Map)))
                || scene.wants(Output::Contact)),
        keep_history: scene.wants(Output::History) && is_first_rule,
        is_papers: scene.paper_table.is_some(),
    }
}

fn task(id: String, cell: Cell, files: InputFiles) -> Task {
    Task::new(id, &cell, Vec::new(), |cell, inputs| {
        cell.artifacts(inputs.files, inputs.interrupted)
    })
    .with_files(files)
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
    let memory = Memory::new(machine::available_memory());
    let solved = statement.solve(problem, memory, recorder, &|_| ());
    let solved = solved.map_err(|e| voice.refused(statement, &e))?;
    match solved.reached.as_ref().map(|way| way.end) {
        Some(ReachEnd::Interrupted { .. }) => Err(Error::Interrupted),
        _ => Ok(solved),
    }
}

impl Cell {
    /// Solves; a mesh is read from these files.
    fn run<'a>(
        &self,
        files: &InputFiles,
        interrupted: &'a AtomicBool,
    ) -> Read<(Solved, Recorder<'a>, Record)> {
        let mut recorder =
            Recorder { keep_history: self.keep_history, ..Recorder::new(interrupted) };
        let (statement, voice) = (&self.statement, Voice::Keys);
        let solved = solved((statement, voice), files, self.keep_pair, &mut recorder)?;
        let judge = Judge { statement, voice, is_papers: self.is_papers };
        if let Some(diverged) = judge.diverged(&solved) {
            return Err(Error::Stage(vec![diverged.sentence()]));
        }
        let record = judge.record(&solved);
        match &record.shortfall {
            Some(shortfall) => Err(Error::input(shortfall.sentence())),
            None => Ok((solved, recorder, record)),
        }
    }

    fn artifacts(
        &self,
        files: &InputFiles,
        interrupted: &AtomicBool,
    ) -> Result<Artifacts, Failure> {
        let (solved, Recorder { mut pairs, history, .. }, record) = self.run(files, interrupted)?;
        // A saddle-point method has a multiplier of its own.
        if self.keep_pair && pairs.is_empty() {
            pairs.push(solved.pair());
        }
        let outcomes = Outcomes {
            warnings: record.facts(),
            remedy: record.remedy(),
            ..self.outcomes(&solved)
        };
        let mut artifacts = outcomes.artifacts(pairs.last().filter(|_| self.keep_pair));
        if let Some(marks) = solved.reached.and_then(|reached| reached.marks) {
            artifacts.insert(MARKS.into(), marks_bytes(&marks));
        }
        if self.keep_history {
            artifacts.insert(HISTORY.into(), to_json(&history));
        }
        Ok(artifacts)
    }

    /// Returns what is kept of a solution.
    fn outcomes(&self, solved: &Solved) -> Outcomes {
        let mut outcomes = Outcomes {
            schema: 1,
            r: self.statement.saddle.map(|settings| settings.r),
            levels: solved.ends().to_vec(),
            asks_energy: matches!(self.statement.accuracy(), Some(Accuracy::Energy(_))),
            energy: solved.energy(),
            ..Outcomes::default()
        };
        if let Some(found) = solved.truth() {
            outcomes.iterations = found.steps;
        }
        if outcomes.r.is_none() {
            outcomes.bounds = solved.bounds().iter().map(|bounds| bounds.clone().ok()).collect();
            outcomes.reserve = solved.reserves();
        }
        if let Some((last, coarser)) = outcomes.levels.split_last() {
            outcomes.iterations = last.end.iterations;
            outcomes.energy = outcomes.energy_on(coarser.len());
        }
        outcomes
    }
}

impl Outcomes {
    /// Artifacts with these outcomes, and the last pair if it is drawn.
    fn artifacts(&self, drawn: Option<&Pair>) -> Artifacts {
        let mut artifacts = Artifacts::from([(OUTCOMES.to_owned(), to_json(self))]);
        if let Some(pair) = drawn {
            artifacts.insert(PAIR.into(), pair_bytes(pair));
        }
        artifacts
    }

    /// Name of the end on the finest level, or of that of the spectral solver.
    pub(super) fn end(&self) -> &'static str {
        self.levels.last().map_or(CONVERGED, Outcome::name)
    }

    /// Energy on the level with this number: that of v or, where the accuracy of the energy was asked for, the number
    /// of the guaranteed bracket that is nearest to it.
    pub(super) fn energy_on(&self, level: usize) -> f64 {
        let of_v = self.levels[level].energy;
        match self.bounds.get(level) {
            Some(Some(bounds)) if self.asks_energy => bounds.nearest_energy(of_v),
            _ => of_v,
        }
    }

    /// True if the energy is that of the true solution, or the number of its bracket that is nearest to that of v.
    pub(super) fn has_true_energy(&self) -> bool {
        self.levels.is_empty() || self.asks_energy
    }

    /// The energy that answers, with so many digits, that of a true solution with those of them that are known.
    pub(super) fn shown_energy(&self, digits: usize) -> String {
        let bounds = self.last_bounds().filter(|_| self.has_true_energy());
        known(self.energy, bounds.map(|bounds| bounds.energy), digits)
    }

    /// Guaranteed bounds on the finest level, if there are any.
    pub(super) fn last_bounds(&self) -> Option<&Bounds> {
        self.bounds.last()?.as_ref()
    }

    /// Returns, in words, how the solver of a scene ended on the finest level, unless with a solution.
    fn no_solution(&self, scene: &Scene) -> Option<String> {
        let judged = self.levels.last()?.judged(scene.statement.accuracy().is_some());
        judged.is_failure().then(|| self.end().replace('-', " "))
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

/// Returns, in words, how the solver ended on the finest grid, with the r that is drawn, unless with a solution.
pub(super) fn no_solution(
    inputs: &Inputs,
    scene: &Scene,
    rule: Option<StopRule>,
) -> Result<Option<String>, String> {
    Ok(drawn_outcomes(inputs, scene, rule)?.no_solution(scene))
}

/// Returns the outcomes of a scene under a rule, with the r that is drawn.
pub(super) fn drawn_outcomes(
    inputs: &Inputs,
    scene: &Scene,
    rule: Option<StopRule>,
) -> Result<Outcomes, String> {
    from_json(inputs, &id_of(scene, scene.drawn(rule)), OUTCOMES)
}

/// Returns, in words, what the pair of a scene under a rule is that is drawn.
pub(super) fn state(
    inputs: &Inputs,
    scene: &Scene,
    rule: Option<StopRule>,
) -> Result<String, String> {
    if let Some(RuleAndR { rule, r }) = scene.drawn(rule) {
        return Ok(format!("where the rule {rule} stops, r = {r}"));
    }
    let outcomes = drawn_outcomes(inputs, scene, rule)?;
    Ok(match (outcomes.no_solution(scene), scene.statement.accuracy()) {
        (Some(end), _) => end,
        // The solver stops where its error is that of the grid.
        (None, Some(Accuracy::Error(wanted))) => {
            format!("with an error of at most {}", percent(wanted))
        }
        (None, _) => "the solution".into(),
    })
}

/// Returns the warnings of a scene under its first rule, with the r that is drawn; those of a published table are in
/// the book.
pub(super) fn warnings(inputs: &Inputs, scene: &Scene) -> Result<Vec<String>, String> {
    let outcomes = drawn_outcomes(inputs, scene, scene.first_rule())?;
    Ok(if scene.paper_table.is_some() { Vec::new() } else { outcomes.warnings })
}

/// Returns these warnings in sentences with a space behind them.
pub(super) fn warnings_in_words(inputs: &Inputs, scene: &Scene) -> Result<String, String> {
    let warnings = warnings(inputs, scene)?;
    let each: Vec<String> = warnings.iter().map(|text| format!("Warning: {text}. ")).collect();
    Ok(each.concat())
}

/// Returns the warnings and the guaranteed bounds of a scene in sentences with a space behind them; nothing if it has
/// none.
pub(super) fn bounds_in_words(inputs: &Inputs, scene: &Scene) -> Result<String, String> {
    let outcomes = drawn_outcomes(inputs, scene, scene.first_rule())?;
    let warnings = warnings_in_words(inputs, scene)?;
    let Some(bounds) = outcomes.last_bounds() else { return Ok(warnings) };
    let [_, most] = bounds.error;
    let mut reserves = String::from("Guaranteed");
    for reserve in &outcomes.reserve {
        reserves += match reserve {
            Reserve::Polygon => ", on the polygon or polyhedron of the mesh",
            Reserve::Quadrature => ", but for the quadrature of f",
        };
    }
    let relative = match bounds.relative() {
        part if part < 1.0 => format!(", {} of the solution", percent(part)),
        _ => String::new(),
    };
    Ok(format!(
        "{warnings}{reserves}: true energy in {}, error in the energy norm at most {}{relative}. ",
        interval(bounds.energy),
        plain(most, 4)
    ))
}

/// Returns a part of one as a percentage, as `solve` writes it.
pub(super) fn percent(part: f64) -> String {
    let text = plain(100.0 * part, 3);
    let text = text.strip_suffix(".00").unwrap_or(&text);
    format!("{text} %")
}

/// Returns the name, in a picture, of the solve of a scene under a rule with the r that is drawn.
pub(super) fn label(scene: &Scene, rule: Option<StopRule>) -> String {
    match scene.drawn(rule) {
        Some(RuleAndR { rule, r }) => format!("stop: {rule}, r = {r}"),
        None => scene.statement.solver.entry().in_words.to_owned(),
    }
}

/// Number of solves that a line names, and of lines of warnings.
const MOST_NAMED: usize = 3;

/// Returns lines on the solves of a scene that ended without a solution on the finest level, with a command that shows
/// one of them, and on the warnings of the others; `outcomes` reads the [`OUTCOMES`] of a task, or returns `None` for a
/// task that is not concerned.
pub(crate) fn remarks(scene: &Scene, outcomes: impl Fn(&str) -> Option<Vec<u8>>) -> Vec<String> {
    let (mut ends, mut warned) = (BTreeMap::new(), Grouped::default());
    let mut command = None;
    for run in scene.rules().into_iter().flat_map(|rule| scene.runs(rule)) {
        let Some(bytes) = outcomes(&id_of(scene, run)) else { continue };
        let Ok(outcomes) = serde_json::from_slice::<Outcomes>(&bytes) else { continue };
        let (place, of_run) = named(scene, run);
        if outcomes.no_solution(scene).is_some() {
            let places: &mut Vec<String> = ends.entry(outcomes.end()).or_default();
            places.extend(place);
            command.get_or_insert(of_run);
            continue;
        }
        let remedy = outcomes.remedy.iter().map(|remedy| format!("; {remedy}"));
        let remedy = remedy.collect::<String>();
        for (k, fact) in outcomes.warnings.iter().enumerate() {
            let is_last = k + 1 == outcomes.warnings.len();
            let text = format!("{fact}{}", if is_last { &remedy } else { "" });
            warned.add(text, place.clone().unwrap_or_default());
        }
    }
    let mut lines = Vec::new();
    if let Some(command) = command {
        let ends = ends.into_iter().map(|(end, places)| format!("{end}{}", with(&places)));
        let ends = ends.collect::<Vec<_>>().join("; ");
        lines.push(format!("{}: {ends}; `{command}` says why", scene.name));
    }
    for (warning, places) in warned.first(MOST_NAMED) {
        let places = if places[0].is_empty() { String::new() } else { with(places) };
        lines.push(format!("{}: warning{places}: {warning}", scene.name));
    }
    let more = warned.beyond(MOST_NAMED);
    if more > 0 {
        lines.push(format!("{}: {more} more warnings", scene.name));
    }
    lines
}

/// Returns the name of a run of a scene, if it has several, and the command that solves it.
fn named(scene: &Scene, run: Option<RuleAndR>) -> (Option<String>, String) {
    let mut command = format!("signorini solve {}", in_shell(&scene.name));
    let place = run.map(|RuleAndR { rule, r }| {
        let mut place = format!("r = {r}");
        command += &format!(" --r {r}");
        if Some(rule) != scene.first_rule() {
            place += &format!(" under {rule}");
            command += &format!(" --stop {rule}");
        }
        place
    });
    (place, command)
}

/// Returns the first places, and the number of the others; nothing of none.
fn with(places: &[String]) -> String {
    let named = &places[..places.len().min(MOST_NAMED)];
    let more = match places.len() - named.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    if named.is_empty() { String::new() } else { format!(" with {}{more}", named.join(", ")) }
}

/// Returns the problem of a scene on the levels on which it was solved: those of the scene or, for an accuracy, the
/// grid or the adapted mesh that reached it.
pub(super) fn problem(inputs: &Inputs, scene: &Scene) -> Result<Problem, Failure> {
    let mut statement = scene.statement.clone();
    if statement.accuracy().is_some() {
        let mesh = mesh_files::mesh(&statement, inputs.files)?;
        let task = id_of(scene, None);
        if let (Some(mesh), Ok(marks)) = (&mesh, artifact(inputs, &task, MARKS)) {
            let problem = statement.problem_on_bisected(mesh, &marks_of(marks)?);
            return Ok(problem.map_err(|e| e.to_string())?);
        }
        let outcomes = drawn_outcomes(inputs, scene, None)?;
        let cells = outcomes.levels.last().and_then(|level| level.cells);
        statement.fineness = Fineness::Grids(cells.into_iter().collect());
    }
    Ok(mesh_files::problem(&statement, inputs.files)?)
}

/// Returns the share of the boundary under the law on which v is held at zero.
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
pub(super) fn gradient(inputs: &Inputs, scene: &Scene) -> Result<Vec<f64>, Failure> {
    let problem = mesh_files::problem(&scene.statement, inputs.files)?;
    let gradient = problem.gradient(scene.saddle().r, &pair_on_grid(inputs, scene)?);
    Ok(gradient.ok_or("the gradient is drawn on the square")?)
}

#[cfg(test)]
pub(super) mod tests;
