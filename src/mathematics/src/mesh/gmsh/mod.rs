//! Meshes of [Gmsh](https://gmsh.info), from files of the versions 2.2 and 4.1, in text and in bytes.
//!
//! Triangles and tetrahedra of first order are read, and physical groups name regions and parts of the boundary. The
//! reader is our own because the crate `mshio` reads version 4.1 only, and has had no release for years.

mod build;
mod elements;
mod error;
mod groups;
mod nodes;
mod scanner;

pub use error::{Fault, FilePlace, GmshError};

use super::AnyMesh;
use build::Sections;
use elements::FileElements;
use groups::{Entities, GroupNames};
use nodes::FileNodes;
use scanner::{Scanner, Version};

/// Reads a mesh: in space if there are tetrahedra, else in the plane.
///
/// Nodes keep the order of the file; nodes of no line, triangle or tetrahedron are left out. A group without a name has
/// its number for a name; cells without a group are the region `domain`.
///
/// # Errors
/// [`GmshError`], with the section and the line or byte, or the number of the element.
pub fn read(bytes: &[u8]) -> Result<AnyMesh, GmshError> {
    let mut scanner = Scanner::new(bytes)?;
    let (mut names, mut entities, mut nodes, mut elements) = (None, None, None, None);
    while let Some(section) = scanner.section()? {
        match section {
            "PhysicalNames" => set_once(&mut names, &mut scanner, GroupNames::read)?,
            "Entities" if scanner.version == Version::Four => {
                if elements.is_some() {
                    return Err(scanner.fault(Fault::Order("Entities")));
                }
                scanner.begin_bytes()?;
                set_once(&mut entities, &mut scanner, Entities::read)?;
            }
            "Nodes" => set_once(&mut nodes, &mut scanner, FileNodes::read)?,
            "Elements" => {
                let Some(nodes) = &nodes else { return Err(scanner.fault(Fault::Order("Nodes"))) };
                let entities = entities.get_or_insert_default();
                set_once(&mut elements, &mut scanner, |scanner| {
                    FileElements::read(scanner, nodes, entities)
                })?;
            }
            "PartitionedEntities" => return Err(scanner.fault(Fault::Partitioned)),
            _ => {
                scanner.skip()?;
                continue;
            }
        }
        scanner.end()?;
    }
    let names = names.unwrap_or_default();
    let nodes = nodes.ok_or(GmshError::Missing("Nodes"))?;
    let elements = elements.ok_or(GmshError::Missing("Elements"))?;
    Sections { names, nodes, elements }.mesh()
}

/// Reads a section that may be there once.
fn set_once<'a, T>(
    section: &mut Option<T>,
    scanner: &mut Scanner<'a>,
    read: impl FnOnce(&mut Scanner<'a>) -> Result<T, GmshError>,
) -> Result<(), GmshError> {
    if section.is_some() {
        return Err(scanner.fault(Fault::SectionTwice));
    }
    *section = Some(read(scanner)?);
    Ok(())
}
