//! Domains, as scenes and options name them: a built-in domain or a Gmsh file, its refinements and its parts.

use crate::pipeline::error::{Error, Result};
use crate::pipeline::names::composed;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use signorini_mathematics::mesh::{AnyMesh, BuiltIn, Condition, gmsh, uniform_cube};
use std::collections::BTreeMap;
use std::fmt;

/// Number of nodes up to which a mesh is refined if nobody says how often, and up to which f is checked before a scene
/// is run.
pub(crate) const USUAL_NODES: f64 = 20_000.0;
/// Name of the domain that has grids in place of meshes.
const SQUARE: &str = "square";
/// Name of the domain whose meshes have as many cells along each side.
const CUBE: &str = "cube";

/// Domain, its refinements, and what holds on the parts of its boundary.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table such as { name = \"disc\", refine = 4 }")]
pub struct DomainSettings {
    /// Built-in domain, or Gmsh file.
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
    /// Cells along each side of the coarsest mesh of the cube; none for those of the built-in mesh.
    #[serde(skip)]
    pub cells: Option<usize>,
}

impl DomainSettings {
    /// Domain of this name, with all else as usual.
    pub(crate) fn named(name: &str) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// True for the square, which has grids in place of meshes.
    pub(crate) fn is_square(&self) -> bool {
        self.name == SQUARE
    }

    /// True for the cube, whose meshes have a width.
    pub(crate) fn is_cube(&self) -> bool {
        self.name == CUBE
    }

    /// Name of a setting that is about a mesh, if there is one.
    pub(crate) fn about_mesh(&self) -> Option<&'static str> {
        let Self { refine, free, fixed, curve, .. } = self;
        let settings = [
            ("refine", refine.is_some()),
            ("free", !free.is_empty()),
            ("fixed", !fixed.is_empty()),
            ("curve", !curve.is_empty()),
        ];
        first_given(settings)
    }

    /// True if the domain is read from a file.
    pub(crate) fn is_file(&self) -> bool {
        BuiltIn::named(&self.name).is_none()
    }

    /// Returns the coarsest mesh, from the contents of the Gmsh file unless the domain is built in. `dashes` stand
    /// before the names of settings in messages: those of options, or none.
    pub(crate) fn coarsest(&self, file: Option<&[u8]>, dashes: &str) -> Result<AnyMesh> {
        let name = &self.name;
        let mesh = match (file, self.cells) {
            (Some(bytes), _) => {
                gmsh::read(bytes).map_err(|e| Error::input(format!("{name}: {e}")))?
            }
            (None, Some(cells)) => uniform_cube(cells).into(),
            (None, None) => AnyMesh::built_in(name).ok_or_else(|| self.unknown(dashes))?,
        };
        self.with_conditions(mesh, dashes)
    }

    /// Returns the error that there is neither a built-in domain nor a file of this name.
    pub(crate) fn unknown(&self, dashes: &str) -> Error {
        let names = AnyMesh::built_in_names().join(", ");
        Error::input(format!(
            "{dashes}domain {}: no such domain, and no such file; choose one of {names}, or name a Gmsh file",
            self.name
        ))
    }

    /// Returns a mesh with the conditions and curves of its parts set.
    fn with_conditions(&self, mut mesh: AnyMesh, dashes: &str) -> Result<AnyMesh> {
        for (option, parts, condition) in
            [("free", &self.free, Condition::Free), ("fixed", &self.fixed, Condition::Fixed)]
        {
            for part in parts {
                let set = mesh.set_condition(&as_in_mesh(&mesh, part), condition);
                set.map_err(|e| Error::input(format!("{dashes}{option} {part}: {e}")))?;
            }
        }
        for (part, numbers) in &self.curve {
            let set = mesh.set_curve(&as_in_mesh(&mesh, part), numbers);
            set.map_err(|e| Error::input(format!("{dashes}curve {part}: {e}")))?;
        }
        Ok(mesh)
    }

    /// Refuses a number of refinements beside an accuracy, which chooses the meshes.
    pub(crate) fn check_adapted(&self, asked: &str, dashes: &str) -> Result<()> {
        match self.refine {
            None => Ok(()),
            Some(_) => Err(Error::input(format!(
                "{asked} and {dashes}refine both say how fine; leave one of them out"
            ))),
        }
    }

    /// Number of refinements of a mesh.
    pub(crate) fn refinements(&self, mesh: &AnyMesh) -> usize {
        self.refine.map_or_else(
            || (1..=20).take_while(|&times| nodes_after(mesh, times) <= USUAL_NODES).count(),
            usize::from,
        )
    }
}

/// Returns the name of a part as the mesh has it, which may write accents in another way.
fn as_in_mesh(mesh: &AnyMesh, part: &str) -> String {
    let same = mesh.part_names().find(|name| *name == part);
    let same = same.or_else(|| mesh.part_names().find(|name| composed(name) == composed(part)));
    same.map_or(part.to_owned(), Clone::clone)
}

/// Returns the name of the first setting that is given, if there is one.
pub(crate) fn first_given<const N: usize>(
    settings: [(&'static str, bool); N],
) -> Option<&'static str> {
    settings.into_iter().find(|(_, given)| *given).map(|(name, _)| name)
}

/// Reads a domain: a name or a file alone, or a table with more about it.
pub(crate) fn name_or_table<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> std::result::Result<DomainSettings, D::Error> {
    struct NameOrTable;
    impl<'de> Visitor<'de> for NameOrTable {
        type Value = DomainSettings;

        fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
            out.write_str(
                "a name such as \"disc\", a file such as \"gear.msh\", \
                 or a table such as { name = \"disc\", refine = 4 }",
            )
        }

        fn visit_str<E: serde::de::Error>(self, name: &str) -> std::result::Result<Self::Value, E> {
            Ok(DomainSettings::named(name))
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
