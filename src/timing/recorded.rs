//! `pipeline/timings.toml`: times that were measured on one machine and day, with their noise, for the book.

use crate::pipeline::error::{Error, Result, from_record};
use crate::table::rows::{Row, Rows, number};
use serde::{Deserialize, Serialize};

/// Path of the record in the project.
pub const PATH: &str = "pipeline/timings.toml";
/// Version of the format.
pub const SCHEMA: u8 = 1;

/// Measured times. Every time in `seconds` is a median, whose `spread` is the distance of the quartiles over it. Grids
/// have so many `cells` per side. All rows of a table have the same columns, but for a flag that only some have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timings {
    /// Version of the format, [`SCHEMA`].
    pub schema: u8,
    /// Day on which the times were measured, in words.
    pub date: String,
    /// Bandwidth of the memory in GB/s, one thread that updates in place; a store counts once, as in STREAM.
    pub bandwidth: f64,
    /// Machine on which the times were measured.
    pub machine: Machine,
    /// Multigrid on one problem, from grid to grid, to each of [`GOALS`]: work units are sweeps of the finest grid, the
    /// traffic is that in bytes per unknown, each pass reading and writing each row once. The time is without those for
    /// the workspace and the load vector.
    #[serde(default)]
    pub multigrid: Rows,
    /// All solvers that use a grid, on problems with known solutions, the paper's first, to goals in words. Errors, and
    /// those of the discrete solution, are in the discrete L2 norm; without a formula, relative ones of the energy.
    /// `kkt` is the natural residual over the largest component of the load. The time is without that for the load
    /// vectors.
    #[serde(default)]
    pub solver: Rows,
    /// The spectral solver on the paper's problems and those that test contact. The error is the guaranteed one of the
    /// energy, relative, at least one rounding; the time is that from f to the bracket, the start on a coarse grid
    /// included.
    #[serde(default)]
    pub spectral: Rows,
    /// Solvers of others beside ours, in the same run of a script of `benches/peers`, entered by hand: microseconds per
    /// unknown, one thread, and the relative natural residuals that were reached. The times of a `whole` run are those
    /// from f to the solution vector, with memory, load vector and matrix.
    #[serde(default)]
    pub peer: Rows,
    /// Solvers of others likewise on a user's mesh, without a coarser one, by `benches/peers/meshes.py own`, matrix and
    /// load vector given.
    #[serde(default)]
    pub own_mesh: Rows,
    /// Guaranteed error, over the norm of the solution, on adapted and on uniform meshes, and of the spectral solver,
    /// with its unknowns for nodes; the time is that from the coarsest mesh to the bounds.
    #[serde(default)]
    pub adapted: Rows,
}

/// Goals of multigrid that are timed: the discretisation error, and the rounding floor.
pub const GOALS: [&str; 2] = ["discretisation", "floor"];

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

/// Goal of a run under the stopping rule of the published tables.
pub const PUBLISHED: &str = "published stop";

impl Timings {
    /// Returns the times with columns that follow from the others: rows of `multigrid` with their `unknowns`, the time
    /// per unknown in nanoseconds, `ns`, and that in which the memory could have moved the bytes, `stream`.
    pub fn extended(&self) -> Self {
        let mut timings = self.clone();
        for row in &mut timings.multigrid.0 {
            let nodes = (number(row, "cells") + 1.0) * (number(row, "cells") + 1.0);
            let ns = 1e9 * number(row, "seconds") / nodes;
            let stream = number(row, "traffic") / self.bandwidth;
            row.insert("unknowns".into(), (nodes as usize).into());
            row.extend([("ns".into(), ns.into()), ("stream".into(), stream.into())]);
        }
        timings
    }

    /// Parses the record.
    ///
    /// # Errors
    /// [`Error::Input`] with the place of the mistake and the remedy.
    pub fn parse(text: impl AsRef<[u8]>) -> Result<Self> {
        const REMEDY: &str = "correct it, or restore the file";
        let timings: Self =
            from_record(PATH, text).map_err(|e| Error::input(format!("{e}; {REMEDY}")))?;
        if timings.schema != SCHEMA {
            let found = timings.schema;
            return Err(Error::input(format!(
                "{PATH}: schema {found}, where this version reads {SCHEMA}; restore the file"
            )));
        }
        match timings.mistake() {
            None => Ok(timings),
            Some(mistake) => Err(Error::input(format!("{PATH}: {mistake}; {REMEDY}"))),
        }
    }

    /// Returns the first row whose columns are not those of the first of its table, flags aside.
    fn mistake(&self) -> Option<String> {
        for (name, rows) in [
            ("multigrid", &self.multigrid),
            ("solver", &self.solver),
            ("spectral", &self.spectral),
            ("peer", &self.peer),
            ("own_mesh", &self.own_mesh),
            ("adapted", &self.adapted),
        ] {
            if let Some(k) = rows.iter().position(|row| !columns(row).eq(columns(&rows[0]))) {
                return Some(format!("[[{name}]] number {}: other columns than the first", k + 1));
            }
        }
        None
    }
}

/// Iterates over the names of the columns of a row in which there is no flag, each with true if it is that of a number.
fn columns(row: &Row) -> impl Iterator<Item = (&String, bool)> {
    let columns = row.iter().filter(|(_, value)| !value.is_boolean());
    columns.map(|(name, value)| (name, value.is_number()))
}
