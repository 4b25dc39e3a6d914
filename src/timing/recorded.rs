//! `pipeline/timings.toml`: times that were measured on one machine and day, with their noise, for the book.

use crate::pipeline::error::{Error, Result, from_record};
use crate::table::rows::{Row, Rows};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

/// Path of the record in the project.
pub const PATH: &str = "pipeline/timings.toml";
/// Version of the format.
pub const SCHEMA: u8 = 1;

/// Measured times. Every time in `seconds` is a median, whose `spread` is the distance of the quartiles over it. Grids
/// have so many `cells` per side. The columns of each table are in `TABLES`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timings {
    /// Version of the format, [`SCHEMA`].
    pub schema: u8,
    /// Day on which the times were measured, in words.
    pub date: String,
    /// Bandwidth of the memory in GB/s, one thread that updates in place; a store counts once, as in STREAM.
    #[serde(deserialize_with = "positive")]
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

/// Tables of the record, and their columns, in the order in which they are written.
pub(crate) const TABLES: [(&str, &str); 6] = [
    ("multigrid", "cells threads goal work_units traffic seconds spread"),
    ("solver", "solver problem cells goal error discretisation kkt seconds spread"),
    ("spectral", "problem unknowns error seconds spread"),
    ("peer", "solver f cells theirs their_kkt ours our_kkt whole"),
    ("own_mesh", "mesh nodes solver theirs their_kkt ours our_kkt"),
    ("adapted", "problem way nodes error seconds"),
];

/// Goals of multigrid that are timed: the discretisation error, and the rounding floor.
pub const GOALS: [&str; 2] = ["discretisation", "floor"];

/// Ways to a guaranteed error that are timed.
const WAYS: [&str; 3] = ["adaptive", "uniform", "spectral"];

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

/// Reads a positive number.
fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<f64, D::Error> {
    let x = f64::deserialize(deserializer)?;
    match x > 0.0 && x.is_finite() {
        true => Ok(x),
        false => Err(serde::de::Error::custom(format!("{x} is not a positive number"))),
    }
}

/// Returns what is wrong with a value in a column of a table.
fn mistake(table: &str, column: &str, value: &Value) -> Option<String> {
    let (is_right, wrong) = match (table, column) {
        ("multigrid", "goal") => (GOALS.iter().any(|goal| value == goal), "unknown variant"),
        ("adapted", "way") => (WAYS.iter().any(|way| value == way), "unknown variant"),
        (_, "f" | "goal" | "mesh" | "problem" | "solver") => (value.is_string(), "not a text"),
        (_, "cells" | "threads" | "nodes" | "unknowns") => (value.is_u64(), "not a natural number"),
        (_, "kkt" | "spread") => (value.is_number(), "not a number"),
        (_, "whole") => (value.is_boolean(), "neither true nor false"),
        _ => (value.as_f64() > Some(0.0), "not a positive number"),
    };
    (!is_right).then(|| format!("{column} = {value}: {wrong}"))
}

/// Returns what is wrong with a row of a table.
fn mistake_in_row(table: &str, columns: &str, row: &Row) -> Option<String> {
    for column in columns.split(' ') {
        match row.get(column) {
            None if column == "whole" => (),
            None => return Some(format!("missing field `{column}`")),
            Some(value) => {
                if let Some(why) = mistake(table, column, value) {
                    return Some(why);
                }
            }
        }
    }
    let unknown = row.keys().find(|name| !columns.split(' ').any(|column| column == *name))?;
    Some(format!("unknown field `{unknown}`"))
}

/// Goal of a run under the stopping rule of the published tables.
pub const PUBLISHED: &str = "published stop";

/// Number in a column of a row of the record.
///
/// # Panics
/// If there is none.
pub fn number(row: &Row, column: &str) -> f64 {
    row[column].as_f64().expect("the columns are checked")
}

/// Text in a column of a row of the record.
///
/// # Panics
/// If there is none.
pub fn text<'a>(row: &'a Row, column: &str) -> &'a str {
    row[column].as_str().expect("the columns are checked")
}

impl Timings {
    /// Returns all tables, in the order of [`TABLES`].
    pub(crate) fn tables(&self) -> [&Rows; 6] {
        [&self.multigrid, &self.solver, &self.spectral, &self.peer, &self.own_mesh, &self.adapted]
    }

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

    /// Returns what is wrong with the tables, and where.
    fn mistake(&self) -> Option<String> {
        for (rows, (table, columns)) in self.tables().into_iter().zip(TABLES) {
            for (row, k) in rows.iter().zip(1..) {
                if let Some(mistake) = mistake_in_row(table, columns, row) {
                    return Some(format!("[[{table}]] number {k}: {mistake}"));
                }
            }
        }
        None
    }
}
