//! Domains other than the square, as scenes and options name them: a Gmsh file or a built-in domain, and its parts.

use crate::pipeline::error::{Error, Result};
use crate::pipeline::files::is_plain;
use crate::pipeline::{InputFile, InputFiles};
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use signorini_mathematics::mesh::{AnyMesh, BuiltIn, Condition, Touching, gmsh};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::triangulated::MeshProblem;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Number of nodes up to which a mesh is refined if nobody says how often, and up to which a scene is checked whenever
/// the project is read.
pub(crate) const USUAL_NODES: f64 = 20_000.0;
/// Most nodes of a mesh of a scene; the method of the paper takes days on it.
const MOST_NODES: f64 = 1e7;
/// Most triangles of a picture, beside which it would grow too large; each refinement makes four of one.
const MOST_TRIANGLES: usize = 2500;
/// Folder of the project from which scenes name their meshes.
const FOLDER: &str = "pipeline";

/// Domain, its refinements, and what holds on the parts of its boundary.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table such as { name = \"disc\", refine = 4 }")]
pub struct DomainSettings {
    /// Built-in domain, or Gmsh file.
    #[serde(alias = "mesh")]
    pub name: String,
    /// Number of refinements; none for the usual number.
    pub refine: Option<u8>,
    /// Parts of the boundary where dv/dn = 0.
    #[serde(default)]
    pub free: Vec<String>,
    /// Parts of the boundary where v = 0.
    #[serde(default)]
    pub fixed: Vec<String>,
    /// Circles, spheres and cylinders on which parts of the boundary lie, each by its numbers.
    #[serde(default)]
    pub curve: BTreeMap<String, Vec<f64>>,
}

impl DomainSettings {
    /// True if the domain is read from a file.
    pub(crate) fn is_file(&self) -> bool {
        BuiltIn::named(&self.name).is_none() && self.name.contains(['.', '/', '\\'])
    }

    /// Returns the coarsest mesh, from the contents of the Gmsh file if there is one. `dashes` stand before the names of
    /// settings in messages: those of options, or none.
    pub(crate) fn coarsest(&self, file: Option<&[u8]>, dashes: &str) -> Result<AnyMesh> {
        let name = &self.name;
        let mesh = match file {
            Some(bytes) => gmsh::read(bytes).map_err(|e| Error::input(format!("{name}: {e}")))?,
            None => AnyMesh::built_in(name).ok_or_else(|| {
                let names = AnyMesh::built_in_names().join(", ");
                Error::input(format!(
                    "{dashes}domain {name}: no such domain; choose one of {names}, or name a file such as gear.msh"
                ))
            })?,
        };
        self.with_conditions(mesh, dashes)
    }

    /// Returns a mesh with the conditions and curves of its parts set.
    pub(crate) fn with_conditions(&self, mut mesh: AnyMesh, dashes: &str) -> Result<AnyMesh> {
        for (option, parts, condition) in
            [("free", &self.free, Condition::Free), ("fixed", &self.fixed, Condition::Fixed)]
        {
            for part in parts {
                let set = mesh.set_condition(part, condition);
                set.map_err(|e| Error::input(format!("{dashes}{option} {part}: {e}")))?;
            }
        }
        for (part, numbers) in &self.curve {
            let set = mesh.set_curve(part, numbers);
            set.map_err(|e| Error::input(format!("{dashes}curve {part}: {e}")))?;
        }
        Ok(mesh)
    }

    /// Number of refinements of a mesh.
    pub(crate) fn refinements(&self, mesh: &AnyMesh) -> usize {
        self.refine.map_or_else(
            || (1..=20).take_while(|&times| nodes_after(mesh, times) <= USUAL_NODES).count(),
            usize::from,
        )
    }
}

/// Reads a domain: a name or a file alone, or a table with more about it.
pub(crate) fn name_or_table<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<DomainSettings, D::Error> {
    struct NameOrTable;
    impl<'de> Visitor<'de> for NameOrTable {
        type Value = DomainSettings;

        fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
            out.write_str("a name such as \"disc\", a file such as \"gear.msh\", or a table such as { name = \"disc\", refine = 4 }")
        }

        fn visit_str<E: serde::de::Error>(self, name: &str) -> std::result::Result<Self::Value, E> {
            Ok(DomainSettings { name: name.into(), ..DomainSettings::default() })
        }

        fn visit_map<A: MapAccess<'de>>(
            self,
            map: A,
        ) -> std::result::Result<Self::Value, A::Error> {
            DomainSettings::deserialize(MapAccessDeserializer::new(map))
        }
    }
    deserializer.deserialize_any(NameOrTable)
}

/// Number of nodes after some refinements: each multiplies the number of cells, and in the end of nodes, by 4 or 8.
pub(crate) fn nodes_after(mesh: &AnyMesh, times: usize) -> f64 {
    let factor = if mesh.dimension() == 2 { 4f64 } else { 8.0 };
    let nodes_per_cell = if mesh.dimension() == 2 { 0.5 } else { 1.0 / 6.0 };
    let cells = mesh.cells() as f64 * factor.powi(times as i32);
    (nodes_per_cell * cells).max(mesh.nodes() as f64)
}

/// Returns the finest of the nested meshes whose triangles can be told apart in a picture.
pub(crate) fn drawn(coarsest: &AnyMesh, times: usize) -> Result<AnyMesh> {
    let refinements = (0..times)
        .take_while(|&times| coarsest.cells() << (2 * (times + 1)) <= MOST_TRIANGLES)
        .count();
    coarsest.refined(refinements).map_err(|e| Error::input(e.to_string()))
}

/// Domain of a scene, with its f.
#[derive(Clone, Debug, Serialize)]
pub struct SceneDomain {
    /// Domain and its refinements.
    #[serde(flatten)]
    pub settings: DomainSettings,
    /// f, as text.
    pub f: String,
    /// Law on the boundary.
    #[serde(skip_serializing_if = "is_signorini", serialize_with = "as_text")]
    pub law: Law,
    /// Files of the project on which the domain depends, by path: the mesh, if there is one.
    #[serde(skip)]
    pub files: InputFiles,
}

/// Problem of a scene on a domain, and the mesh from which it is refined.
pub(crate) struct RefinedProblem {
    /// Mesh as it was read, with the conditions on its parts.
    pub coarsest: AnyMesh,
    /// Problem with all refinements.
    pub problem: MeshProblem,
}

/// Findings of the check of a mesh.
pub(crate) struct CheckedMesh {
    /// Number of dimensions.
    pub dimension: u8,
    /// Place where the domain touches itself with nodes of both sides, if there is one.
    pub touching: Option<Touching>,
}

/// True for the law that scenes do not name.
fn is_signorini(law: &Law) -> bool {
    law.is_signorini()
}

/// A law as its text.
fn as_text<S: Serializer>(law: &Law, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    serializer.collect_str(law)
}

impl SceneDomain {
    /// Returns the path of the mesh in the project.
    fn path(&self) -> Option<String> {
        let settings = &self.settings;
        settings.is_file().then(|| format!("{FOLDER}/{}", settings.name))
    }

    /// Finds the mesh in the project in `root`, among the `known` files or else on the disk, and does not read it: other
    /// scenes with this mesh share what is read.
    pub(crate) fn find_mesh(&mut self, root: &Path, known: &mut InputFiles) -> Result<()> {
        let Some(path) = self.path() else { return Ok(()) };
        if !is_plain(&path) {
            return Err(Error::input(format!(
                "{path}: name a file below {FOLDER}/ by its shortest path, as name = \"meshes/gear.msh\""
            )));
        }
        let file = match known.get(&path) {
            Some(file) => file.clone(),
            None => InputFile::if_there(&root.join(&path))?
                .ok_or_else(|| Error::input(format!("there is no {path}; put the mesh there")))?,
        };
        known.insert(path.clone(), file.clone());
        self.files.insert(path, file);
        Ok(())
    }

    /// Returns the coarsest mesh, read from these files.
    pub(crate) fn coarsest(&self, files: &InputFiles) -> Result<AnyMesh> {
        let file = self.path().and_then(|path| files.get(&path));
        self.settings.coarsest(file.map(InputFile::bytes).transpose()?, "")
    }

    /// Returns the problem, its mesh read from these files.
    pub(crate) fn problem(&self, files: &InputFiles) -> Result<RefinedProblem> {
        let coarsest = self.coarsest(files)?;
        let problem = self.refined(&coarsest)?;
        Ok(RefinedProblem { coarsest, problem })
    }

    fn refined(&self, coarsest: &AnyMesh) -> Result<MeshProblem> {
        MeshProblem::new(coarsest, self.settings.refinements(coarsest), &self.f, self.law)
            .map_err(|e| Error::input(e.to_string()))
    }

    /// Checks the mesh, its parts and, on meshes of the usual size, f.
    pub(crate) fn check(&self) -> Result<CheckedMesh> {
        let coarsest = self.coarsest(&self.files)?;
        let times = self.settings.refinements(&coarsest);
        let nodes = nodes_after(&coarsest, times);
        if nodes > MOST_NODES {
            return Err(Error::input(format!(
                "refine = {times} makes about {nodes:.0e} nodes, more than is sensible; {MOST_NODES:.0e} are the most"
            )));
        }
        if nodes <= USUAL_NODES {
            self.refined(&coarsest)?;
        }
        Ok(CheckedMesh { dimension: coarsest.dimension(), touching: coarsest.touching().cloned() })
    }
}
