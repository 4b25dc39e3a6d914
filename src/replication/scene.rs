//! Scenes: a problem with its grids, duality parameters, stopping rules and wanted outputs, read from TOML.

use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Failure, Result, from_toml};
use crate::pipeline::names::refuse_forbidden;
use crate::replication::domain::{CheckedMesh, DomainSettings, SceneDomain, name_or_table};
use serde::{Deserialize, Deserializer, Serialize};
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::{LoadRule, integrals};
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::experiments::problems::Problem;
use signorini_mathematics::identify::COARSEST;
use signorini_mathematics::mesh::Touching;
use signorini_mathematics::problem::law::{Law, LawParameter};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::StopRule;
use std::fmt;
use std::path::Path;

/// Output for which a scene may ask; no other output is computed.
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
    /// Values of f near the scene's with which the published counts still come out.
    Identify,
}

/// Writes the name used in scenes and file names.
impl fmt::Display for Output {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(out)
    }
}

/// A validated scene: a file of `pipeline/scenes/`, in which unknown keys are errors.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// File name without its ending.
    #[serde(skip_deserializing)]
    pub name: String,
    /// Title in figures and pages, a single line.
    pub title: String,
    /// Number of the published table to compare with, if there is one.
    pub paper_table: Option<u8>,
    /// Domain in place of the square, with f on it.
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub domain: Option<SceneDomain>,
    /// Right-hand side on the square; zero if there is a domain, which has an f of its own.
    pub f: Source,
    /// Law on the boundary; none for the paper's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<LawParameter>,
    /// Quadrature of the load vector.
    #[serde(default)]
    pub load: LoadRule,
    /// Interpolation to the next grid.
    #[serde(default)]
    pub prolongation: Prolongation,
    /// Nested grids of the square, coarsest first; none if there is a domain.
    #[serde(skip_serializing, default = "paper_grids", deserialize_with = "grids")]
    pub grids: Vec<Grid>,
    /// Duality parameters.
    #[serde(default = "paper_r")]
    pub r: Vec<f64>,
    /// Stopping rules; the first is the one compared with the paper.
    #[serde(default = "paper_stop")]
    pub stop: Vec<StopRule>,
    /// Limit on iterations per grid.
    #[serde(default = "default_limit")]
    pub max_iterations: usize,
    /// Wanted outputs, sorted.
    pub outputs: Vec<Output>,
    /// The r whose solution is drawn; always set in a scene that was [parsed](Scene::parse).
    draw_r: Option<f64>,
}

/// Scene on a domain, as its file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DomainScene {
    title: String,
    f: String,
    #[serde(deserialize_with = "name_or_table")]
    domain: DomainSettings,
    law: Option<LawParameter>,
    #[serde(default = "paper_r")]
    r: Vec<f64>,
    #[serde(default = "paper_stop")]
    stop: Vec<StopRule>,
    #[serde(default = "default_limit")]
    max_iterations: usize,
    outputs: Vec<Output>,
    draw_r: Option<f64>,
}

/// Keys of a scene on the square that mean nothing on other domains.
const OF_THE_SQUARE: [&str; 4] = ["grids", "load", "prolongation", "paper_table"];

/// Outputs of a scene on the square that other domains do not have, each with the reason.
const NOT_ON_DOMAINS: [(Output, &str); 2] = [
    (Output::History, "the method keeps no residuals on meshes"),
    (Output::Identify, "no table was published"),
];

impl DomainScene {
    /// Returns the scene, still without a name.
    fn scene(self) -> Result<Scene> {
        let Self { title, f, domain, law, r, stop, max_iterations, outputs, draw_r } = self;
        let f = f.split_whitespace().collect::<Vec<_>>().join(" ");
        Ok(Scene {
            name: String::new(),
            title,
            paper_table: None,
            domain: Some(SceneDomain {
                settings: domain,
                f,
                law: checked_law(law)?,
                files: InputFiles::new(),
            }),
            f: Source::constant(0.0),
            law,
            load: LoadRule::default(),
            prolongation: Prolongation::default(),
            grids: Vec::new(),
            r,
            stop,
            max_iterations,
            outputs,
            draw_r,
        })
    }
}

/// Returns the law of a scene with this parameter.
fn checked_law(parameter: Option<LawParameter>) -> Result<Law> {
    LawParameter::law_or_papers(parameter).map_err(|e| Error::input(format!("law: {e}")))
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

fn default_limit() -> usize {
    signorini_mathematics::saddle::Params::default().max_iterations
}

impl Scene {
    /// Parses and validates the text of a scene file; `name` names the scene in messages.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake, or what makes the scene unsolvable.
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        let what = format!("scene `{name}`");
        let keys: toml::Table = toml::from_str(text).unwrap_or_default();
        let mut scene = match keys.contains_key("domain") {
            false => from_toml::<Self>(&what, text)?,
            true => {
                if let Some(key) = OF_THE_SQUARE.iter().find(|key| keys.contains_key(**key)) {
                    return Err(Error::input(format!(
                        "{what}: `{key}` is for the square; leave it out beside `domain`, whose meshes are its refinements"
                    )));
                }
                let scene = from_toml::<DomainScene>(&what, text)?.scene();
                scene.map_err(|e| Error::input(format!("{what}: {e}")))?
            }
        };
        scene.name = name.into();
        scene.complete().map_err(|e| Error::input(format!("{what}: {e}")))?;
        Ok(scene)
    }

    /// Finds the mesh of the domain, if the scene has one, in the project in `root`, among the `known` files or else on
    /// the disk. Checks a domain without a mesh; [`Scene::check_domain`] checks one with a mesh, which takes time.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Io`]: no mesh, or a domain that does not fit the scene.
    pub(crate) fn find_mesh(&mut self, root: &Path, known: &mut InputFiles) -> Result<()> {
        let Some(domain) = &mut self.domain else { return Ok(()) };
        domain.find_mesh(root, known).map_err(|e| in_scene(&self.name, e))?;
        if domain.files.is_empty() {
            self.check_domain()?;
        }
        Ok(())
    }

    /// Reads the mesh of the domain, if the scene has one, and checks that it fits the scene. Returns the place where the
    /// domain touches itself, if there is one.
    ///
    /// # Errors
    /// [`Error::Input`] if it does not; [`Error::Io`].
    pub(crate) fn check_domain(&self) -> Result<Option<Touching>> {
        let Some(domain) = &self.domain else { return Ok(None) };
        let CheckedMesh { dimension, touching } =
            domain.check().map_err(|e| in_scene(&self.name, e))?;
        let mut pictures = [Output::Source, Output::Surface, Output::Contact].iter();
        match pictures.find(|output| dimension == 3 && self.outputs.contains(output)) {
            None => Ok(touching),
            Some(output) => Err(Error::input(format!(
                "scene `{name}`: `{output}` is a picture of a domain in the plane; drop it from `outputs`, and look at the solution with `signorini solve {name} --out {name}.vtu`",
                name = self.name
            ))),
        }
    }

    /// Fills in the values that follow from others, and makes the checks that a parser cannot.
    fn complete(&mut self) -> std::result::Result<(), Failure> {
        checked_law(self.law)?;
        if self.law.is_some() && self.paper_table.is_some() {
            return Err(
                "the published tables are for the paper's law; leave out `law`, or `paper_table`"
                    .into(),
            );
        }
        self.check_on_domain()?;
        if self.r.is_empty() || self.stop.is_empty() {
            let example = "r = [10], stop = [\"signed\"]";
            return Err(format!("`r` and `stop` must not be empty; e.g. {example}").into());
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
        let drawn = self.drawn_r();
        if !self.r.contains(&drawn) {
            return Err(format!("`draw_r` = {drawn} is not among `r`; add it there").into());
        }
        self.draw_r = Some(drawn);
        if let Some(output) = repeated(&self.outputs) {
            return Err(format!("`outputs` lists {output} twice; remove one").into());
        }
        self.outputs.sort();
        if self.wants(Output::Identify) && self.paper_table.is_none() {
            return Err("`identify` explains a published table; add `paper_table`, or drop it from `outputs`".into());
        }
        // As many counts on other grids would be compared without an error.
        if self.paper_table.is_some() && self.grids[0].cells() != COARSEST {
            return Err(format!(
                "the published tables begin with the grid 1/{COARSEST}; let `grids` begin with {COARSEST}, or leave out `paper_table`"
            )
            .into());
        }
        if self.title.contains(['\n', '\r']) {
            return Err("`title` must be a single line".into());
        }
        refuse_forbidden("`title`", &self.title)?;
        Ok(())
    }

    /// Makes the checks that concern the square or, on another domain, do not need the mesh.
    fn check_on_domain(&self) -> std::result::Result<(), Failure> {
        if self.domain.is_some() {
            let mut refused = NOT_ON_DOMAINS.iter();
            return match refused.find(|(output, _)| self.outputs.contains(output)) {
                None => Ok(()),
                Some((output, reason)) => {
                    Err(format!("`{output}` is for the square: {reason}; drop it from `outputs`")
                        .into())
                }
            };
        }
        // A known solution is proof enough, and its integral takes milliseconds on every command.
        if self.f.exact().is_none() || self.law.is_some() {
            let integrals = integrals(&self.f);
            solvable(
                &self.f,
                integrals,
                BoundaryFlux { law: self.law(), perimeter: Grid::PERIMETER },
            )?;
        }
        let finest = self.finest().cells();
        if finest > MAX_CELLS {
            return Err(format!(
                "grid 1/{finest} needs more memory than is sensible; 1/{MAX_CELLS} is the finest"
            )
            .into());
        }
        Ok(())
    }

    /// Returns the law on the boundary.
    pub(crate) fn law(&self) -> Law {
        LawParameter::law_or_papers(self.law).expect("validated: a law with this parameter")
    }

    /// Returns the r whose solution is drawn: the middle one, unless the scene names another.
    pub(crate) fn drawn_r(&self) -> f64 {
        self.draw_r.unwrap_or(self.r[self.r.len() / 2])
    }

    /// True if the scene asks for this output.
    pub(crate) fn wants(&self, output: Output) -> bool {
        self.outputs.contains(&output)
    }

    /// True if the scene is one of the paper's two problems; no two scenes of a project are the same problem.
    pub(crate) fn is_problem(&self) -> bool {
        matches!(self.paper_table, Some(1 | 2))
    }

    /// Returns the problem in the form that experiments take, if it belongs to a published table.
    pub fn problem(&self) -> Option<Problem> {
        Some(Problem {
            number: self.paper_table?,
            f: self.f.to_string(),
            law: self.law,
            load: self.load,
            prolongation: self.prolongation,
            grids: self.grids.iter().map(|grid| grid.cells()).collect(),
            r: self.r.clone(),
            max_iterations: self.max_iterations,
        })
    }

    /// Returns the finest grid of a scene on the square.
    pub fn finest(&self) -> Grid {
        *self.grids.last().expect("validated: at least one grid")
    }
}

/// Returns the error with the name of the scene before it, unless it is of the system, and names a path.
fn in_scene(name: &str, error: Error) -> Error {
    match error {
        Error::Input(text) => Error::input(format!("scene `{name}`: {text}")),
        other => other,
    }
}

/// Largest number of cells per side; two nodal vectors of that grid take about 1 GB.
pub const MAX_CELLS: usize = 8192;

/// Returns the first item that equals an earlier one.
pub(super) fn repeated<T: PartialEq>(items: &[T]) -> Option<&T> {
    items.iter().enumerate().find(|(k, item)| items[..*k].contains(item)).map(|(_, item)| item)
}

/// Boundary of a domain, and the law there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundaryFlux {
    /// Law of the flux.
    pub law: Law,
    /// Length or area of the boundary.
    pub perimeter: f64,
}

/// Returns the integral of f, given the integrals of f and of |f|.
///
/// # Errors
/// If f is too large or too small to compute with, or violates condition (2): the integral is negative, by more than
/// rounding; under another law, the flux can balance it, by more than rounding.
pub(crate) fn solvable<const D: usize>(
    f: &Source<D>,
    [integral, of_size]: [f64; 2],
    BoundaryFlux { law, perimeter }: BoundaryFlux,
) -> Result<f64> {
    f.check_scale(of_size).map_err(|e| Error::input(e.to_string()))?;
    if integral.is_nan() {
        return Err(Error::input(
            "f is not finite at some point; give a formula with finite values on the whole domain",
        ));
    }
    let rounding = ROUNDING * of_size.abs();
    match law.check_solvable_by(rounding, integral, perimeter) {
        Err(error) if !law.is_signorini() => return Err(Error::input(error.to_string())),
        Err(_) => (),
        Ok(()) => return Ok(integral),
    }
    let size = integral.abs();
    let exactly =
        if size <= ROUNDING * of_size.abs() { "0".into() } else { shown_integral(integral) };
    Err(Error::input(format!(
        "the integral of f is {exactly}, but (2) asks for a negative one; lower f somewhere"
    )))
}

/// Returns an integral of f with the digits that messages and answers show.
pub(crate) fn shown_integral(integral: f64) -> String {
    match integral.abs() {
        1e-2..1e6 => format!("{integral:.4}"),
        // The sum with zero is never the zero with a minus.
        _ => format!("{:.3e}", integral + 0.0),
    }
}

/// Bound of the rounding error of the integral of f, over the integral of |f|.
const ROUNDING: f64 = 1e-12;

/// Checks that r is a positive number that the name of a task can show without an exponent.
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
        for exact in signorini_mathematics::problem::exact::Exact::ALL {
            assert!(integrals(&Source::from(exact))[0] < -0.5, "{exact:?}");
        }
    }

    #[test]
    fn mistakes_have_their_own_messages() {
        assert!(error(&format!("{GOOD}stop = [\"signed\", \"signed\"]\n")).contains("twice"));
        assert!(error(&GOOD.replace("[\"table\"]", "[\"table\", \"table\"]")).contains("twice"));
        let no_table = error(&format!("{GOOD}load = \"exact\"\n"));
        assert!(no_table.contains("a table such as { rule = \"exact\" }"), "{no_table}");
        for rule in ["bilinear", "lumped-average"] {
            let load = format!("load = {{ rule = \"{rule}\", diagonal = \"rising\" }}\n");
            assert!(error(&format!("{GOOD}{load}")).contains("diagonal"));
        }
        assert!(error(&format!("{GOOD}grids = [1]\n")).contains("at least 2 cells"));
        assert!(error(&format!("{GOOD}draw_r = 3\n")).contains("not among `r`"));
        assert!(error(&format!("{GOOD}draw_r = nan\n")).contains("not among `r`"));
        assert!(error(&format!("{GOOD}max_iterations = 0\n")).contains("at least 1"));
        assert!(error(&GOOD.replace("table", "identify")).contains("add `paper_table`"));
        let other_grids = format!("{GOOD}paper_table = 1\ngrids = [3, 6, 12, 24, 48]\n");
        assert!(error(&other_grids).contains("let `grids` begin with 4"));
        assert!(error(&GOOD.replace("\"t\"", "\"t\\nu\"")).contains("a single line"));
        assert!(error(&GOOD.replace("\"t\"", "\"t\\uFFFE\"")).contains("U+FFFE"));
        assert!(error(&format!("{GOOD}stop = [\"never\"]\n")).contains("unknown variant `never`"));
    }
}
