//! `pipeline/timings.toml`: the times that `signorini bench --record` measured, with their noise, and the machine.

use crate::pipeline::error::{Error, Result, from_record};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;
use signorini_mathematics::experiments::timed::TimedPlan;
use signorini_mathematics::experiments::{Row, Rows};

/// Path of the record in the project.
pub const PATH: &str = "pipeline/timings.toml";
/// Version of the format.
pub const SCHEMA: u8 = 1;

/// Measured times. Every time, `seconds`, is a median; its `spread` is the distance of the quartiles over the median.
/// [`COLUMNS`] says what the tables consist of.
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
    #[serde(default)]
    pub multigrid: Rows,
    /// All solvers that use a grid, on problems with known solutions, the paper's first.
    #[serde(default)]
    pub solver: Rows,
    /// The spectral solver on the problems with piecewise constant f, resolution by resolution.
    #[serde(default)]
    pub spectral: Rows,
    /// Solvers of others beside ours, measured by a script of `benches/peers`; entered by hand, kept by
    /// `bench --record`.
    #[serde(default)]
    pub peer: Rows,
    /// Solvers of others beside ours on a user's mesh, without a coarser one, measured by `benches/peers/meshes.py own`;
    /// entered by hand, kept by `bench --record`.
    #[serde(default)]
    pub own_mesh: Rows,
    /// Guaranteed error against time, on adapted and on uniform meshes.
    #[serde(default)]
    pub adapted: Rows,
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

/// Reads a positive number.
fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<f64, D::Error> {
    let x = f64::deserialize(deserializer)?;
    match x > 0.0 && x.is_finite() {
        true => Ok(x),
        false => Err(serde::de::Error::custom(format!("{x} is not a positive number"))),
    }
}

/// What the values of a column are.
#[derive(Clone, Copy)]
enum Kind {
    /// Any text.
    Text,
    /// One of these texts.
    OneOf(&'static [&'static str]),
    /// A natural number.
    Count,
    /// A number.
    Number,
    /// A positive number, as medians and norms are.
    Positive,
    /// True or false; false if it is not there.
    Flag,
}
use Kind::{Count, Flag, Number, OneOf, Positive, Text};

/// Names and values of some columns.
type Columns = &'static [(&'static str, Kind)];

/// Columns of the tables, by the names of the tables, as the record has them.
const COLUMNS: [(&str, Columns); 6] = [
    (
        "multigrid",
        &[
            // Per side.
            ("cells", Count),
            ("threads", Count),
            ("goal", OneOf(&GOALS)),
            // Sweeps of the finest grid.
            ("work_units", Positive),
            // Bytes moved per unknown, each pass reading and writing each row once.
            ("traffic", Positive),
            // Without those for the workspace and the load vector.
            ("seconds", Positive),
            ("spread", Number),
        ],
    ),
    (
        "solver",
        &[
            ("solver", Text),
            // As in `exact(name)` where the solution has a formula.
            ("problem", Text),
            ("cells", Count),
            // In words.
            ("goal", Text),
            // In the discrete L2 norm; where the solution has no formula, relative error of the energy.
            ("error", Positive),
            // Of the discrete solution.
            ("discretisation", Positive),
            // Natural residual over the largest component of the load.
            ("kkt", Number),
            // Without those for the load vectors.
            ("seconds", Positive),
            ("spread", Number),
        ],
    ),
    (
        "spectral",
        &[
            ("problem", Text),
            // Gauss nodes of a panel.
            ("nodes", Count),
            // Panels that get shorter towards corners and jumps of f.
            ("levels", Count),
            // Of the energy against a finer resolution, relative; at least one rounding.
            ("error", Positive),
            // From f to the energy, the start on a coarse grid included.
            ("seconds", Positive),
            ("spread", Number),
        ],
    ),
    (
        "peer",
        &[
            // Name, version and configuration of the other solver.
            ("solver", Text),
            ("f", Text),
            ("cells", Count),
            // Microseconds per unknown, one thread, in the same run; and relative natural residuals.
            ("theirs", Positive),
            ("their_kkt", Positive),
            ("ours", Positive),
            ("our_kkt", Positive),
            // True if both times are those from f to the solution vector, with memory, load vector and matrix.
            ("whole", Flag),
        ],
    ),
    (
        "own_mesh",
        &[
            // In words.
            ("mesh", Text),
            ("nodes", Count),
            ("solver", Text),
            // As those of `peer`, matrix and load vector given.
            ("theirs", Positive),
            ("their_kkt", Positive),
            ("ours", Positive),
            ("our_kkt", Positive),
        ],
    ),
    (
        "adapted",
        &[
            // Name of the domain.
            ("problem", Text),
            ("way", OneOf(&["adaptive", "uniform"])),
            // Of the finest mesh.
            ("nodes", Count),
            // Guaranteed error over the norm of the solution.
            ("error", Positive),
            // From the coarsest mesh to the bounds.
            ("seconds", Positive),
        ],
    ),
];

/// Goals of multigrid that are timed: the discretisation error, and the rounding floor.
pub const GOALS: [&str; 2] = ["discretisation", "floor"];

impl Kind {
    /// Returns what is wrong with a value.
    fn mistake(self, value: &Value) -> Option<String> {
        let number = value.as_f64().unwrap_or(f64::NAN);
        match self {
            Text => (!value.is_string()).then(|| "not a text".into()),
            OneOf(all) => {
                let is_one = value.as_str().is_some_and(|text| all.contains(&text));
                (!is_one).then(|| format!("unknown variant, expected {}", all.join(" or ")))
            }
            Count => (!value.is_u64()).then(|| "not a natural number".into()),
            Number => (!number.is_finite()).then(|| "not a number".into()),
            Positive => (!(number > 0.0)).then(|| "not a positive number".into()),
            Flag => (!value.is_boolean()).then(|| "neither true nor false".into()),
        }
    }
}

/// Returns what is wrong with a row.
fn mistake(row: &Row, columns: Columns) -> Option<String> {
    for (name, kind) in columns {
        match row.get(*name) {
            None if matches!(kind, Flag) => (),
            None => return Some(format!("missing field `{name}`")),
            Some(value) => {
                if let Some(why) = kind.mistake(value) {
                    return Some(format!("{name} = {value}: {why}"));
                }
            }
        }
    }
    let unknown = row.keys().find(|name| columns.iter().all(|(known, _)| known != name))?;
    Some(format!("unknown field `{unknown}`"))
}

/// Goal of a run under the stopping rule of the published tables.
pub const PUBLISHED: &str = TimedPlan::PUBLISHED;

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

const HEADER: &str = "# Written by `signorini bench --record`; do not edit what was measured.\n\
    # [[peer]] and [[own_mesh]] sections are entered by hand from benches/peers, and kept.\n\n";

impl Timings {
    /// Returns all tables, in the order of [`COLUMNS`].
    fn tables(&self) -> [&Rows; 6] {
        [&self.multigrid, &self.solver, &self.spectral, &self.peer, &self.own_mesh, &self.adapted]
    }

    /// Returns the times with columns that follow from the others: rows of `multigrid` with their `unknowns`, the time
    /// per unknown in nanoseconds, `ns`, and that in which the memory could have moved the bytes, `stream`; rows of
    /// `solver` with whether the error has `reached` that of the discretisation.
    pub fn extended(&self) -> Self {
        let mut timings = self.clone();
        for row in &mut timings.multigrid.0 {
            let nodes = (number(row, "cells") + 1.0) * (number(row, "cells") + 1.0);
            let ns = 1e9 * number(row, "seconds") / nodes;
            let stream = number(row, "traffic") / self.bandwidth;
            row.insert("unknowns".into(), (nodes as usize).into());
            row.extend([("ns".into(), ns.into()), ("stream".into(), stream.into())]);
        }
        for row in &mut timings.solver.0 {
            let reached =
                number(row, "error") <= TimedPlan::REACHED * number(row, "discretisation");
            row.insert("reached".into(), reached.into());
        }
        timings
    }

    /// Parses the record.
    ///
    /// # Errors
    /// [`Error::Input`] with the place of the mistake and the remedy.
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
        match timings.mistake() {
            None => Ok(timings),
            Some(mistake) => Err(Error::input(format!("{PATH}: {mistake}; {REMEDY}"))),
        }
    }

    /// Returns what is wrong with the tables, and where.
    pub fn mistake(&self) -> Option<String> {
        for (rows, (table, columns)) in self.tables().into_iter().zip(COLUMNS) {
            for (row, k) in rows.iter().zip(1..) {
                if let Some(mistake) = mistake(row, columns) {
                    return Some(format!("[[{table}]] number {k}: {mistake}"));
                }
            }
        }
        None
    }

    /// Returns the text of the record.
    pub fn to_toml(&self) -> String {
        let Self { schema, bandwidth, machine, .. } = self;
        let machine = toml::to_string(machine).expect("plain data");
        let mut text =
            format!("{HEADER}schema = {schema}\nbandwidth = {bandwidth:?}\n\n[machine]\n{machine}");
        for (rows, (table, columns)) in self.tables().into_iter().zip(COLUMNS) {
            for row in rows.iter() {
                text += &format!("\n[[{table}]]\n");
                for (name, _) in columns {
                    if let Some(value) = row.get(*name) {
                        let value = toml::Value::try_from(value).expect("plain data");
                        text += &format!("{name} = {value}\n");
                    }
                }
            }
        }
        text
    }
}
