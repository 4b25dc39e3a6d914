//! Checks of a scene as a whole, of its outputs, and of its mesh.

use super::keys::SceneKeys;
use super::{Scene, in_scene};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::{in_shell, refuse_forbidden};
use crate::replication::fields::lists::repeated;
use crate::replication::fields::table::{Reading, Refused, Voice};
use crate::replication::mesh_files;
use crate::replication::output::Output;
use signorini_mathematics::identify::COARSEST;
use signorini_mathematics::solvers::{MOST_CELLS, Solver};
use signorini_mathematics::statement::Statement;

/// Outputs of a scene on the square that other domains do not have, each with the reason.
const NOT_ON_DOMAINS: [(Output, &str); 2] = [
    (Output::History, "the method keeps no residuals on meshes"),
    (Output::Identify, "no table was published"),
];

impl Scene {
    /// Checks that there is a problem to be solved, and reads the mesh of the domain, if the scene has one, and checks
    /// that it fits the scene. Takes time in the size of the problem: only a run of the scene asks for it. Returns what
    /// a user has to know, in a line each. A study has rows in place of such errors.
    ///
    /// # Errors
    /// [`Error::Input`] if there is none, or the mesh does not fit; [`Error::Io`].
    pub fn check(&self) -> Result<Vec<String>> {
        if self.is_study {
            return Ok(Vec::new());
        }
        self.checked().map_err(|e| in_scene(&self.name, e))
    }

    fn checked(&self) -> Result<Vec<String>> {
        let mesh = mesh_files::mesh(&self.statement, &self.files)?;
        let notes = mesh_files::check(&self.statement, mesh.as_ref())?;
        let Some(mesh) = mesh else {
            // The load of a published table is the paper's.
            let own = notes.into_iter().filter(|_| self.paper_table.is_none());
            return Ok(own.map(|note| note + "; load = \"bilinear\" does not").collect());
        };
        let (dimension, (_, nodes)) = (mesh.dimension(), mesh_files::size(&self.statement, &mesh)?);
        if let Some(accuracy) = self.statement.accuracy().filter(|_| dimension == 3) {
            let asked = Voice::Keys.accuracy(accuracy);
            let text =
                format!("{asked} is for domains in the plane; in space, `refine` says how fine");
            return Err(Error::input(text));
        }
        self.statement.solver.check_nodes(dimension, nodes).map_err(|e| {
            let remedy = "choose another `solver`, or fewer refinements";
            Error::input(format!("{e}; {remedy}"))
        })?;
        let mut pictures = [Output::Source, Output::Surface, Output::Map, Output::Contact].iter();
        match pictures.find(|output| dimension == 3 && self.outputs.contains(output)) {
            None => Ok(notes),
            Some(output) => Err(Error::input(format!(
                "`{output}` is a picture of a domain in the plane; drop it from `outputs`, and look \
                 at the solution with `signorini solve {name} --out {name}.vtu`",
                name = in_shell(&self.name)
            ))),
        }
    }

    /// Makes the checks that concern the scene as a whole.
    pub(super) fn complete(mut self) -> Reading<Self> {
        if !self.statement.boundary.is_signorini() && self.paper_table.is_some() {
            let text =
                "the published tables are for the paper's law; leave out `law`, or `paper_table`";
            return Err(Refused::new("law", text));
        }
        if self.statement.saddle.is_none() && self.wants(Output::History) {
            let text = format!(
                "`history` is of the saddle-point methods, not of {}; add solver = \"{}\", or drop it from `outputs`",
                self.statement.solver,
                Solver::ArrowHurwicz
            );
            return Err(Refused::new("outputs", text));
        }
        if let Some(output) = repeated(&self.outputs) {
            let text = format!("`outputs` lists {output} twice; remove one");
            return Err(Refused::new("outputs", text));
        }
        self.outputs.sort();
        if self.wants(Output::Identify) && self.paper_table.is_none() {
            let text = "`identify` explains a published table; add `paper_table`, or drop it from `outputs`";
            return Err(Refused::new("outputs", text));
        }
        if self.title.contains(['\n', '\r']) {
            return Err(Refused::new("title", "`title` must be a single line"));
        }
        refuse_forbidden("`title`", &self.title)
            .map_err(|e| Refused::new("title", e.to_string()))?;
        Ok(self)
    }
}

/// Checks a statement of a scene with these keys on the square or, on another domain, as far as no mesh is needed.
pub(super) fn check_on_domain(statement: &Statement, keys: &SceneKeys) -> Reading<()> {
    if !statement.has_grids() {
        if keys.paper_table.is_some() {
            let text = "`paper_table` is for the square; leave it out beside `domain`";
            return Err(Refused::new("paper_table", text));
        }
        let mut refused = NOT_ON_DOMAINS.iter();
        return match refused.find(|(output, _)| keys.outputs.contains(output)) {
            None => Ok(()),
            Some((output, reason)) => Err(Refused::new(
                "outputs",
                format!("`{output}` is for the square: {reason}; drop it from `outputs`"),
            )),
        };
    }
    let field = statement.fineness.field();
    let grids = statement.grids().map_err(|e| Refused::new(field, e.to_string()))?;
    // As many counts on other grids would be compared without an error.
    if keys.paper_table.is_some() && grids[0].cells() != COARSEST {
        return Err(Refused::new(
            "grids",
            format!(
                "the published tables begin with the grid 1/{COARSEST}; let `grids` begin with {COARSEST}, or \
             leave out `paper_table`"
            ),
        ));
    }
    let finest = grids[grids.len() - 1].cells();
    if let Err(e) = statement.solver.check_cells(finest) {
        return Err(Refused::new(field, format!("`{field}`: {e}")));
    }
    if finest > MOST_CELLS {
        return Err(Refused::new(
            field,
            format!(
                "grid 1/{finest} needs more memory than is sensible; 1/{MOST_CELLS} is the finest"
            ),
        ));
    }
    Ok(())
}
