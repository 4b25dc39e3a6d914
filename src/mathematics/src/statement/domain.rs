//! Domain of a statement: a built-in one or a Gmsh file, and what holds on the parts of its boundary.

use super::StatementError;
use crate::mesh::{AnyMesh, BuiltIn, gmsh, uniform_cube};
use crate::problem::law::{Law, LawParameter};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use unicode_normalization::UnicodeNormalization;

/// Domain, and what holds on the parts of its boundary.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    /// Built-in domain, or Gmsh file.
    pub name: String,
    /// Parts of the boundary where dv/dn = 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub free: Vec<String>,
    /// Parts of the boundary where v = 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fixed: Vec<String>,
    /// Parts of the boundary with laws of their own.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub laws: BTreeMap<String, LawParameter>,
    /// Circles, spheres and cylinders on which parts of the boundary lie, each by its numbers.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub curve: BTreeMap<String, Vec<f64>>,
}

/// Name of the domain that has grids in place of meshes.
const SQUARE: &str = "square";
/// Name of the domain whose meshes have as many cells along each side.
const CUBE: &str = "cube";

impl Domain {
    /// Domain of this name, with the boundary in contact everywhere.
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// The paper's square.
    pub fn square() -> Self {
        Self::named(SQUARE)
    }

    /// True for the square, which has grids in place of meshes.
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
    /// cube, if that is the domain and they are given.
    pub(super) fn mesh(
        &self,
        file: Option<&[u8]>,
        cells: Option<usize>,
    ) -> Result<AnyMesh, StatementError> {
        let mut mesh = match (file, cells) {
            (Some(bytes), _) => {
                gmsh::read(bytes).map_err(|e| StatementError::field("domain", &self.name, e))?
            }
            (None, Some(cells)) => uniform_cube(cells).into(),
            (None, None) => AnyMesh::built_in(&self.name).ok_or_else(|| self.unknown())?,
        };
        let free = self.free.iter().map(|part| ("free", part, Law::FREE));
        let fixed = self.fixed.iter().map(|part| ("fixed", part, Law::FIXED));
        let mut laws: Vec<_> = free.chain(fixed).collect();
        for (part, parameter) in &self.laws {
            laws.push((parameter.named().0, part, parameter.law()?));
        }
        for (field, part, law) in laws {
            let set = mesh.set_law(&as_in_mesh(&mesh, part), law);
            set.map_err(|e| StatementError::field(field, part, e))?;
        }
        for (part, numbers) in &self.curve {
            let set = mesh.set_curve(&as_in_mesh(&mesh, part), numbers);
            set.map_err(|e| StatementError::field("curve", part, e))?;
        }
        Ok(mesh)
    }
}

/// Returns the name of a part as the mesh has it, which may write accents in another way.
fn as_in_mesh(mesh: &AnyMesh, part: &str) -> String {
    let same = mesh.part_names().find(|name| *name == part);
    let alike = |name: &&String| name.nfc().eq(part.nfc());
    let same = same.or_else(|| mesh.part_names().find(alike));
    same.map_or(part.to_owned(), Clone::clone)
}
