//! Scenes: a problem with its grids, duality parameters, stopping rules and wanted outputs, read from TOML.

use crate::discrete::grid::{Grid, nested};
use crate::discrete::load::{LoadRule, integral};
use crate::discrete::transfer::Prolongation;
use crate::experiments::problems::Problem;
use crate::identify::COARSEST;
use crate::pipeline::error::{Error, Failure, Result, from_toml};
use crate::problem::source::Source;
use crate::saddle::StopRule;
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// What a scene may ask for. What it does not ask for is not computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Output {
    /// Table of iteration counts and Delta a.
    Table,
    /// Map of f.
    Source,
    /// Surface of the solution on the finest grid.
    Surface,
    /// Residuals against iterations.
    History,
    /// Trace and multiplier along the unrolled boundary.
    Contact,
    /// How sharply the published table fixes f.
    Identify,
}

/// The name used in scenes and file names.
impl fmt::Display for Output {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(out)
    }
}

/// A validated scene: a file of `pipeline/scenes/`, in which unknown keys are errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// File name without its ending.
    #[serde(skip_deserializing)]
    pub name: String,
    /// A line for people.
    pub title: String,
    /// Number of the published table to compare with, if there is one.
    pub paper_table: Option<u8>,
    /// Right-hand side.
    pub f: Source,
    /// Quadrature of the load vector.
    #[serde(default)]
    pub load: LoadRule,
    /// Interpolation to the next grid.
    #[serde(default)]
    pub prolongation: Prolongation,
    /// Nested grids, coarsest first.
    #[serde(skip_serializing, default = "paper_grids", deserialize_with = "grids")]
    pub grids: Vec<Grid>,
    /// Duality parameters.
    #[serde(default = "paper_r")]
    pub r: Vec<f64>,
    /// Stopping rules; the first is the one compared with the paper.
    #[serde(default = "paper_stop")]
    pub stop: Vec<StopRule>,
    /// Cap on iterations per grid.
    #[serde(default = "default_cap")]
    pub max_iterations: usize,
    /// Wanted outputs, sorted.
    pub outputs: Vec<Output>,
    /// The r whose solution is drawn; not a number until it is known that none is named.
    #[serde(default = "unnamed")]
    pub draw_r: f64,
}

fn paper_grids() -> Vec<Grid> {
    nested(&[4, 8, 16, 32, 64]).expect("each halves the one before")
}

fn grids<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Vec<Grid>, D::Error> {
    nested(&Vec::<usize>::deserialize(deserializer)?).map_err(serde::de::Error::custom)
}

fn paper_r() -> Vec<f64> {
    vec![1e6, 10.0, 5.0, 1.0, 0.5]
}

fn paper_stop() -> Vec<StopRule> {
    vec![StopRule::Signed]
}

fn default_cap() -> usize {
    crate::saddle::Params::default().max_iterations
}

fn unnamed() -> f64 {
    f64::NAN
}

impl Scene {
    /// Parses and validates the text of a scene file; `name` names the scene in messages.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake, or what makes the scene unsolvable.
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        let what = format!("scene `{name}`");
        let mut scene: Self = from_toml(&what, text)?;
        scene.name = name.into();
        scene.complete().map_err(|e| Error::input(format!("{what}: {e}")))?;
        Ok(scene)
    }

    /// Fills in what follows from the rest, and checks what a parser cannot.
    fn complete(&mut self) -> std::result::Result<(), Failure> {
        // A known solution is proof enough, and its integral takes milliseconds on every command.
        if self.f.exact().is_none() {
            solvable(integral(&self.f), integral(&self.f.absolute()))?;
        }
        if self.r.is_empty() || self.stop.is_empty() {
            let example = "r = [10], stop = [\"signed\"]";
            return Err(format!("`r` and `stop` must not be empty; e.g. {example}").into());
        }
        let finest = self.finest().cells();
        if finest > MAX_CELLS {
            return Err(format!(
                "grid 1/{finest} needs more memory than is sensible; 1/{MAX_CELLS} is the finest"
            )
            .into());
        }
        for &r in &self.r {
            positive_r(r)?;
        }
        if let Some(r) = repeated(&self.r) {
            return Err(format!("`r` lists {r} twice; remove one").into());
        }
        if let Some(rule) = repeated(&self.stop) {
            return Err(format!("`stop` lists {rule} twice; remove one").into());
        }
        if self.max_iterations == 0 {
            return Err("`max_iterations` must be at least 1".into());
        }
        if self.draw_r.is_nan() {
            self.draw_r = self.r[self.r.len() / 2];
        }
        if !self.r.contains(&self.draw_r) {
            let r = self.draw_r;
            return Err(format!("`draw_r` = {r} is not among `r`; add it there").into());
        }
        if let Some(output) = repeated(&self.outputs) {
            return Err(format!("`outputs` lists {output} twice; remove one").into());
        }
        self.outputs.sort();
        if self.wants(Output::Identify) && self.paper_table.is_none() {
            return Err("`identify` explains a published table; add `paper_table`, or drop it from `outputs`".into());
        }
        // Counts on other grids are no less many, and would be compared all the same.
        if self.paper_table.is_some() && self.grids[0].cells() != COARSEST {
            return Err(format!(
                "the published tables begin with the grid 1/{COARSEST}; let `grids` begin with {COARSEST}, or leave out `paper_table`"
            )
            .into());
        }
        if self.title.chars().any(char::is_control) {
            return Err("`title` must be a single line".into());
        }
        Ok(())
    }

    /// Whether the scene asks for this output.
    pub(crate) fn wants(&self, output: Output) -> bool {
        self.outputs.contains(&output)
    }

    /// Whether this is one of the paper's problems; no two scenes are the same one.
    pub(crate) fn is_problem(&self) -> bool {
        matches!(self.paper_table, Some(1 | 2))
    }

    /// The problem as experiments take it, if it belongs to a published table.
    pub fn problem(&self) -> Option<Problem> {
        Some(Problem {
            number: self.paper_table?,
            f: self.f.to_string(),
            load: self.load,
            prolongation: self.prolongation,
            grids: self.grids.iter().map(|grid| grid.cells()).collect(),
            r: self.r.clone(),
            max_iterations: self.max_iterations,
        })
    }

    /// The finest grid.
    pub fn finest(&self) -> Grid {
        *self.grids.last().expect("validated: at least one grid")
    }
}

/// Finest grid for which two nodal vectors fit comfortably in memory.
pub const MAX_CELLS: usize = 8192;

/// The first item that is there twice.
fn repeated<T: PartialEq>(items: &[T]) -> Option<&T> {
    items.iter().enumerate().find(|(k, item)| items[..*k].contains(item)).map(|(_, item)| item)
}

/// The integral of f, beside that of |f|, if f is solvable by condition (2): the integral is negative, by more
/// than rounding.
pub(crate) fn solvable(integral: f64, of_size: f64) -> Result<f64> {
    if integral < -ROUNDING * of_size.abs() {
        return Ok(integral);
    }
    let size = integral.abs();
    let exactly =
        if size <= ROUNDING * of_size.abs() { "0".into() } else { shown_integral(integral) };
    Err(Error::input(format!(
        "the integral of f is {exactly}, but (2) asks for a negative one; lower f somewhere"
    )))
}

/// An integral of f as messages and answers show it.
pub(crate) fn shown_integral(integral: f64) -> String {
    match integral.abs() {
        1e-2..1e6 => format!("{integral:.4}"),
        _ => format!("{integral:.3e}"),
    }
}

/// What rounding may leave of an integral that is zero, over the integral of |f|.
const ROUNDING: f64 = 1e-12;

/// Checks that r is a positive number, and one that can be written out as the name of a cell.
pub(crate) fn positive_r(r: f64) -> Result<f64> {
    if (1e-12..=1e12).contains(&r) {
        return Ok(r);
    }
    Err(Error::input(format!(
        "r = {r:?} must be a positive number from 1e-12 to 1e12; the paper takes 0.5 to 1e6"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "title = \"t\"\nf = \"else=-1\"\noutputs = [\"table\"]\n";

    fn error(text: &str) -> String {
        Scene::parse("s", text).unwrap_err().to_string()
    }

    #[test]
    fn defaults_are_the_papers() {
        let scene = Scene::parse("s", GOOD).unwrap();
        assert_eq!(scene.finest().cells(), 64);
        assert_eq!(scene.r, [1e6, 10.0, 5.0, 1.0, 0.5]);
        assert_eq!(scene.stop, [StopRule::Signed]);
        assert!(scene.wants(Output::Table) && !scene.wants(Output::Surface));
    }

    #[test]
    fn problems_with_known_solutions_are_solvable() {
        for exact in crate::problem::exact::Exact::ALL {
            assert!(integral(&Source::Exact(exact)) < -0.5, "{exact:?}");
        }
    }

    #[test]
    fn mistakes_have_their_own_messages() {
        assert!(error(&format!("{GOOD}stop = [\"signed\", \"signed\"]\n")).contains("twice"));
        assert!(error(&GOOD.replace("[\"table\"]", "[\"table\", \"table\"]")).contains("twice"));
        let load = |load: &str| error(&format!("{GOOD}load = {load}\n"));
        assert!(load("\"exact\"").contains("a table such as { rule = \"exact\" }"));
        for rule in ["bilinear", "lumped-average"] {
            assert!(
                load(&format!("{{ rule = \"{rule}\", diagonal = \"rising\" }}"))
                    .contains("diagonal")
            );
        }
        assert!(error(&format!("{GOOD}grids = [1]\n")).contains("at least 2 cells"));
        assert!(error(&format!("{GOOD}draw_r = 3\n")).contains("not among `r`"));
        assert!(error(&format!("{GOOD}max_iterations = 0\n")).contains("at least 1"));
        assert!(error(&GOOD.replace("table", "identify")).contains("add `paper_table`"));
        let other_grids = format!("{GOOD}paper_table = 1\ngrids = [3, 6, 12, 24, 48]\n");
        assert!(error(&other_grids).contains("let `grids` begin with 4"));
        assert!(error(&GOOD.replace("\"t\"", "\"t\\nu\"")).contains("a single line"));
        assert!(error(&format!("{GOOD}stop = [\"never\"]\n")).contains("unknown variant `never`"));
    }
}
