//! `pipeline/timings.toml`: the times that `signorini bench --record` measured, with their noise, and the machine.

use crate::pipeline::error::{Error, Result, from_record};
use serde::{Deserialize, Deserializer, Serialize};
use signorini_mathematics::experiments::adapted::Way;
pub use signorini_mathematics::experiments::timed::MultigridGoal as Goal;
use signorini_mathematics::experiments::timed::TimedPlan;
use signorini_mathematics::solvers::Solver;
use std::collections::BTreeMap;

/// Path of the record in the project.
pub const PATH: &str = "pipeline/timings.toml";
/// Version of the format.
pub const SCHEMA: u8 = 1;

/// Measured times. Every time is a median; its `spread` is the distance of the quartiles over the median.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timings {
    /// Version of the format, [`SCHEMA`].
    pub schema: u8,
    /// Bandwidth of the memory in GB/s, one thread that updates in place; a store counts once, as in STREAM.
    #[serde(deserialize_with = "positive")]
    pub bandwidth: f64,
    /// Machine on which the times were measured.
    pub machine: Machine,
    /// Multigrid on one problem, from grid to grid.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub multigrid: Vec<Scaling>,
    /// All solvers that use a grid, on problems with known solutions, the paper's first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub solver: Vec<SolverTime>,
    /// The spectral solver on the problems with piecewise constant f, resolution by resolution.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spectral: Vec<Spectral>,
    /// Solvers of others beside ours; entered by hand, kept by `bench --record`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub peer: Vec<Peer>,
    /// Solvers of others beside ours on a user's mesh; entered by hand, kept by `bench --record`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub own_mesh: Vec<OwnMesh>,
    /// Guaranteed error against time, on adapted and on uniform meshes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub adapted: Vec<AdaptedTime>,
}

/// Machine and its state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Model of the processor, as it calls itself.
    pub cpu: String,
    /// Cores that the program may use.
    pub cores: usize,
    /// Caches, in the words of the system.
    pub caches: String,
    /// Operating system and release.
    pub os: String,
    /// Compiler that built the program.
    pub rustc: String,
    /// Load average of the minute before the measurement: well below one on an idle machine.
    pub load: f64,
    /// Number of short runs per median.
    pub repeats: usize,
}

/// Multigrid on one grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaling {
    /// Cells per side.
    pub cells: usize,
    /// Number of threads that multigrid could use.
    pub threads: usize,
    /// Goal of multigrid.
    pub goal: Goal,
    /// Cost in sweeps of the finest grid.
    #[serde(deserialize_with = "positive")]
    pub work_units: f64,
    /// Bytes moved per unknown, each pass reading and writing each row once.
    #[serde(deserialize_with = "positive")]
    pub traffic: f64,
    /// Median time, without that for the workspace and the load vector.
    #[serde(deserialize_with = "positive")]
    pub seconds: f64,
    /// Noise.
    pub spread: f64,
}

impl Scaling {
    /// Number of nodes of the grid.
    pub fn unknowns(&self) -> usize {
        nodes(self.cells)
    }

    /// Returns the nanoseconds per unknown.
    pub fn ns(&self) -> f64 {
        ns_per_node(self.cells, self.seconds)
    }
}

/// Number of nodes of the grid with this number of cells per side.
pub fn nodes(cells: usize) -> usize {
    (cells + 1) * (cells + 1)
}

/// Returns the nanoseconds per node of a run of `seconds` on the grid with this number of cells per side.
pub fn ns_per_node(cells: usize, seconds: f64) -> f64 {
    1e9 * seconds / nodes(cells) as f64
}

/// One solver on one problem, grid and goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolverTime {
    /// The solver.
    pub solver: Solver,
    /// Name of the problem, as in `exact(name)` where its solution has a formula.
    pub problem: String,
    /// Cells per side.
    pub cells: usize,
    /// Goal of the solver, in words.
    pub goal: String,
    /// Error against the known solution, in the discrete L2 norm; if it has no formula, relative error of the energy.
    #[serde(deserialize_with = "positive")]
    pub error: f64,
    /// Error of the discrete solution, measured likewise.
    #[serde(deserialize_with = "positive")]
    pub discretisation: f64,
    /// Natural residual over the largest component of the load.
    pub kkt: f64,
    /// Median time, without that for the load vectors.
    #[serde(deserialize_with = "positive")]
    pub seconds: f64,
    /// Noise.
    pub spread: f64,
}

/// The spectral solver at one resolution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spectral {
    /// Name of the problem, as in [`SolverTime`].
    pub problem: String,
    /// Gauss nodes of a panel.
    pub nodes: usize,
    /// Number of panels that get shorter towards corners and jumps of f.
    pub levels: u32,
    /// Error of the energy against a finer resolution, relative; at least one rounding.
    #[serde(deserialize_with = "positive")]
    pub error: f64,
    /// Median time from f to the energy, the start on a coarse grid included.
    #[serde(deserialize_with = "positive")]
    pub seconds: f64,
    /// Noise.
    pub spread: f64,
}

/// Solver of others on one grid, measured by a script of `benches/peers`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Peer {
    /// Name, version and configuration.
    pub solver: String,
    /// f in the notation of scenes.
    pub f: String,
    /// Cells per side.
    pub cells: usize,
    /// Time of the other solver in microseconds per unknown, one thread.
    #[serde(deserialize_with = "positive")]
    pub theirs: f64,
    /// Relative natural residual that the other solver reached.
    #[serde(deserialize_with = "positive")]
    pub their_kkt: f64,
    /// Time of multigrid in microseconds per unknown for the same problem, in the same run, one thread.
    #[serde(deserialize_with = "positive")]
    pub ours: f64,
    /// Relative natural residual that multigrid reached.
    #[serde(deserialize_with = "positive")]
    pub our_kkt: f64,
    /// True if both times are those from f to the solution vector, with memory, load vector and matrix.
    #[serde(default)]
    pub whole: bool,
}

/// Solver of others on a mesh without a coarser one, measured by `benches/peers/meshes.py own`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnMesh {
    /// Mesh in words.
    pub mesh: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Name, version and configuration of the other solver.
    pub solver: String,
    /// Time of the other solver in microseconds per node, one thread, matrix and load vector given.
    #[serde(deserialize_with = "positive")]
    pub theirs: f64,
    /// Relative natural residual that the other solver reached.
    #[serde(deserialize_with = "positive")]
    pub their_kkt: f64,
    /// Time of multigrid in microseconds per node, likewise.
    #[serde(deserialize_with = "positive")]
    pub ours: f64,
    /// Relative natural residual that multigrid reached.
    #[serde(deserialize_with = "positive")]
    pub our_kkt: f64,
}

/// Run on meshes that are refined in one way, from the coarsest mesh to the bounds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AdaptedTime {
    /// Name of the domain.
    pub problem: String,
    /// Way of refinement.
    pub way: Way,
    /// Number of nodes of the finest mesh.
    pub nodes: usize,
    /// Guaranteed error over the norm of the solution.
    #[serde(deserialize_with = "positive")]
    pub error: f64,
    /// Median time.
    #[serde(deserialize_with = "positive")]
    pub seconds: f64,
}

/// Goal of a run under the stopping rule of the published tables.
pub const PUBLISHED: &str = TimedPlan::PUBLISHED;

/// Returns, per grid, the fastest run whose error came down to that of the discretisation.
pub fn to_discretisation<'a>(
    lines: impl IntoIterator<Item = &'a SolverTime>,
) -> BTreeMap<usize, &'a SolverTime> {
    let mut fastest = BTreeMap::new();
    for line in
        lines.into_iter().filter(|line| line.error <= TimedPlan::REACHED * line.discretisation)
    {
        let known = fastest.entry(line.cells).or_insert(line);
        if line.seconds < known.seconds {
            *known = line;
        }
    }
    fastest
}

/// Reads a positive number, as medians and norms are.
fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<f64, D::Error> {
    let x = f64::deserialize(deserializer)?;
    match x > 0.0 && x.is_finite() {
        true => Ok(x),
        false => Err(serde::de::Error::custom(format!("{x} is not a positive number"))),
    }
}

const HEADER: &str = "# Written by `signorini bench --record`; do not edit what was measured.\n\
    # [[peer]] and [[own_mesh]] sections are entered by hand from benches/peers, and kept.\n\n";

impl Timings {
    /// Returns the names of the problems on which solvers were timed, in their order.
    pub fn problems(&self) -> Vec<&str> {
        let mut problems = Vec::new();
        for line in &self.solver {
            if !problems.contains(&&*line.problem) {
                problems.push(&*line.problem);
            }
        }
        problems
    }

    /// Parses the record.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake and the remedy.
    pub fn parse(text: impl AsRef<[u8]>) -> Result<Self> {
        const REMEDY: &str =
            "correct it, or move the file away; `signorini bench --record` writes a new one";
        let timings: Self =
            from_record(PATH, text).map_err(|e| Error::input(format!("{e}; {REMEDY}")))?;
        if timings.schema != SCHEMA {
            let found = timings.schema;
            return Err(Error::input(format!(
                "{PATH}: schema {found}, where this version writes {SCHEMA}; move the file away and measure again \
                 with `signorini bench --record`"
            )));
        }
        Ok(timings)
    }

    /// Returns the text of the record.
    pub fn to_toml(&self) -> String {
        HEADER.to_owned() + &toml::to_string(self).expect("plain data")
    }
}
