//! What the templates are given: plain data, everything computed, nothing formatted.

use super::results::Results;
use crate::identify::Findings;
use crate::identify::record::Record;
use crate::pipeline::Graph;
use crate::saddle::Outcome;
use crate::timing::recorded::Timings;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// All that the book says and that was not written by hand.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Cells per side of the nested grids, coarsest first; the k-th is the paper's grid N = k + 1.
    pub grids: Vec<usize>,
    /// The duality parameters, in the order of the tables' rows.
    pub r: Vec<f64>,
    /// When a cell counts as within tolerance, as a clause that completes "a cell is within tolerance when".
    pub tolerance: String,
    /// The paper's problems, in its order.
    pub problems: Vec<Problem>,
    /// Scenes that are not the paper's.
    pub scenes: Vec<Scene>,
    /// What the search for the lost Figure 1 has found, as committed.
    pub record: Record,
    /// What the experiments of [`crate::experiments`] found, by name.
    pub bench: BTreeMap<String, serde_json::Value>,
    /// What was measured on one machine, as committed, if it was.
    pub timings: Option<Timings>,
    /// The figures of the chapters.
    pub figures: Figures,
    /// The solutions to take away.
    pub solutions: Vec<SolutionFile>,
    /// All results in one table.
    #[serde(skip)]
    pub results: Results,
    /// The commands of the program.
    pub commands: Vec<CommandHelp>,
    /// Where everything comes from.
    pub provenance: Provenance,
}

/// One of the paper's problems: its f, its solves under three stopping rules, its table.
#[derive(Clone, Debug, Serialize)]
pub struct Problem {
    /// Name of its scene.
    pub name: String,
    /// Number of the problem, and of its table.
    pub number: usize,
    /// Title of its scene.
    pub title: String,
    /// f in the notation of scenes.
    pub f: String,
    /// Integral of f over the square.
    pub integral_f: f64,
    /// f piece by piece.
    pub pieces: Vec<Piece>,
    /// The load rule, by its name in scenes.
    pub load: String,
    /// The tie rule on jumps of f, by its name in scenes.
    pub tie: String,
    /// The diagonal of the grid's squares, by its name in scenes, if the load rule uses one.
    pub diagonal: String,
    /// The interpolation to the next grid, by its name in scenes.
    pub prolongation: String,
    /// One column per r, stopped by the signed rule.
    pub signed: Vec<Column>,
    /// The same, stopped by (13) as printed.
    pub printed: Vec<Column>,
    /// The same, stopped by the signed rule and the dual one together.
    pub signed_dual: Vec<Column>,
    /// The signed columns against the paper's table, one row per r.
    pub table: Vec<Row>,
    /// The values of Delta a that miss the published digits, with those before them.
    pub misses: Vec<Miss>,
    /// The grid of the pictures, in cells per side.
    pub cells: usize,
    /// The duality parameter of the pictures.
    pub drawn_r: f64,
    /// Boundary nodes of that grid.
    pub boundary_nodes: usize,
    /// Where the signed rule stops there.
    pub stop: Shape,
    /// The discrete solution there, with f integrated exactly.
    pub solution: Shape,
    /// What this run found out about f.
    pub findings: Findings,
}

/// A region on which f is constant.
#[derive(Clone, Debug, Serialize)]
pub struct Piece {
    /// Where, in words: "lower left quadrant".
    pub region: String,
    /// Value of f there.
    pub value: f64,
}

/// The solves for one r over all nested grids.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// Duality parameter.
    pub r: f64,
    /// One outcome per grid, coarsest first.
    pub outcomes: Vec<Outcome>,
}

/// A row of a published table, cell by cell.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Duality parameter.
    pub r: f64,
    /// Iterations, one per grid.
    pub counts: Vec<Compared<usize>>,
    /// Last change of the multiplier on the finest grid.
    pub delta_a: Compared<f64>,
}

/// A number of ours beside the paper's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Compared<T> {
    /// Ours.
    pub ours: T,
    /// The paper's.
    pub paper: T,
    /// Whether they agree to all printed digits.
    pub exact: bool,
    /// Whether they agree within the declared tolerance.
    pub within: bool,
}

/// A surface in a few numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Shape {
    /// Least nodal value.
    pub least: f64,
    /// Greatest nodal value.
    pub greatest: f64,
    /// Boundary nodes whose multiplier is positive.
    pub contact: usize,
    /// Total inflow: the sum of h times the multiplier over the boundary.
    pub inflow: f64,
}

/// A published Delta a that ours rounds differently.
#[derive(Clone, Debug, Serialize)]
pub struct Miss {
    /// Duality parameter.
    pub r: f64,
    /// As published.
    pub paper: f64,
    /// Ours in the last iterations: number and Delta a; the last is the one compared.
    pub last: Vec<(usize, f64)>,
}

/// A scene that is not the paper's.
#[derive(Clone, Debug, Serialize)]
pub struct Scene {
    /// File name without ending.
    pub name: String,
    /// Title.
    pub title: String,
    /// Its file, as written.
    pub text: String,
    /// Its own figures in the book's folder `figures`, by the output of the scene that asks for each.
    pub figures: BTreeMap<String, String>,
    /// f in the notation of scenes.
    pub f: String,
    /// Integral of f over the square.
    pub integral_f: f64,
    /// The exact solution in LaTeX, if it is known.
    pub exact: Option<String>,
    /// Stopping rule, by its name in scenes.
    pub rule: String,
    /// Duality parameter.
    pub r: f64,
    /// One entry per grid, coarsest first.
    pub levels: Vec<Level>,
}

/// A scene on one grid.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// How the solve ended.
    pub outcome: Outcome,
    /// Greatest nodal error, if the exact solution is known.
    pub error: Option<f64>,
}

/// The figures that the templates ask for.
#[derive(Clone, Debug, Serialize)]
pub struct Figures {
    /// Maps of f, the paper's Figure 1.
    pub figure1: Figure,
    /// Surfaces where the signed rule stops, the paper's Figure 2.
    pub figure2: Figure,
    /// Where the paper stopped, where the solution is, and the difference.
    pub stops: Figure,
    /// Solution and multiplier along the unrolled boundary.
    pub contact: Figure,
    /// Residuals against iterations.
    pub histories: Figure,
    /// Counts that come out around each f.
    pub identifiability: Figure,
    /// Pictures of experiments, by name.
    pub bench: BTreeMap<String, Figure>,
}

/// A figure and what made it.
#[derive(Clone, Debug, Serialize)]
pub struct Figure {
    /// File name in the book's folder `figures`.
    pub file: String,
    /// Its data, by the path in the book.
    pub data: String,
    /// The command that draws it.
    pub command: String,
    /// First twelve hexadecimal digits of the blake3 hash of the file.
    pub hash: String,
}

/// A solution in the book's folder `data`, as .npz and as .vti.
#[derive(Clone, Debug, Serialize)]
pub struct SolutionFile {
    /// Its name, without ending.
    pub name: String,
    /// Title of the scene, and which state of it.
    pub what: String,
    /// Cells per side of its grid.
    pub cells: usize,
}

/// Where the book's numbers come from.
#[derive(Clone, Debug, Serialize)]
pub struct Provenance {
    /// The command that makes everything.
    pub command: String,
    /// Files that were read.
    pub inputs: Vec<Artifact>,
    /// Files that were made.
    pub artifacts: Vec<Artifact>,
    /// All pictures.
    pub figures: Vec<Figure>,
    /// The tool and the libraries whose output shows in the book.
    pub versions: Vec<Version>,
    /// What was run, task by task.
    pub graph: Graph,
    /// Licence of code and text, as an SPDX expression.
    pub license: String,
}

/// A file and its content hash.
#[derive(Clone, Debug, Serialize)]
pub struct Artifact {
    /// Path from the top of the repository.
    pub name: String,
    /// First twelve hexadecimal digits of its blake3 hash.
    pub hash: String,
}

/// A program or library and its version.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Version {
    /// Name.
    pub name: String,
    /// Version.
    pub version: String,
}

/// A command of the program.
#[derive(Clone, Debug, Serialize)]
pub struct CommandHelp {
    /// Its name; empty for the program without a command.
    pub name: String,
    /// What it says with `--help`.
    pub help: String,
}
