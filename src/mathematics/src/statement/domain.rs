//! Domain of a statement: a built-in one or a Gmsh file, with the curves of its boundary.

use super::StatementError;
use crate::mesh::{AnyMesh, BuiltIn, gmsh, square_with_sides, uniform_cube};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use unicode_normalization::UnicodeNormalization;

/// Domain, and the curves on which parts of its boundary lie.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    /// Built-in domain, or Gmsh file.
    pub name: String,
    /// Circles, spheres and cylinders on which parts of the boundary lie, each by its numbers.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub curve: BTreeMap<String, Vec<f64>>,
}

/// Name of the paper's domain.
const SQUARE: &str = "square";
/// Name of the domain whose meshes have as many cells along each side.
const CUBE: &str = "cube";

impl Domain {
    /// Domain of this name, whose boundary has no curves.
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// The paper's square.
    pub fn square() -> Self {
        Self::named(SQUARE)
    }

    /// True for the paper's square.
    pub fn is_square(&self) -> bool {
        self.name == SQUARE
    }

    /// True for the cube, whose meshes have a width.
    pub fn is_cube(&self) -> bool {
        self.name == CUBE
    }

    /// True for a built-in domain in space; of a file, its mesh tells.
    pub fn is_built_in_space(&self) -> bool {
        matches!(BuiltIn::named(&self.name), Some(BuiltIn::Cube | BuiltIn::Ball))
    }

    /// True if the domain is read from a file.
    pub fn is_file(&self) -> bool {
        BuiltIn::named(&self.name).is_none() && !self.is_square()
    }

    /// The error that there is neither a built-in domain nor a file of this name.
    pub fn unknown(&self) -> StatementError {
        let names = AnyMesh::built_in_names().join(", ");
        let reason =
            format!("no such domain, and no such file; choose one of {names}, or name a Gmsh file");
        StatementError::field("domain", &self.name, reason)
    }

    /// Coarsest mesh, from the contents of the Gmsh file unless the domain is built in; `cells` along each side of the
    /// square or the cube, if they are given.
    pub(super) fn mesh(
        &self,
        file: Option<&[u8]>,
        cells: Option<usize>,
    ) -> Result<AnyMesh, StatementError> {
        let mut mesh = match (file, cells) {
            (Some(bytes), _) => {
                gmsh::read(bytes).map_err(|e| StatementError::field("domain", &self.name, e))?
            }
            (None, Some(cells)) if self.is_square() => square_with_sides(cells).into(),
            (None, Some(cells)) => uniform_cube(cells).into(),
            (None, None) => AnyMesh::built_in(&self.name).ok_or_else(|| self.unknown())?,
        };
        for (part, numbers) in &self.curve {
            let set = mesh.set_curve(&as_in_mesh(&mesh, part), numbers);
            set.map_err(|e| StatementError::field("curve", part, e))?;
        }
        Ok(mesh)
    }
}

/// Returns the name of a part as the mesh has it, which may write accents in another way.
pub(super) fn as_in_mesh(mesh: &AnyMesh, part: &str) -> String {
    let same = mesh.part_names().find(|name| *name == part);
    let alike = |name: &&String| name.nfc().eq(part.nfc());
    let same = same.or_else(|| mesh.part_names().find(alike));
    same.map_or(part.to_owned(), Clone::clone)
}
