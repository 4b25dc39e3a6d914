//! Problems of `solve` on a mesh: a Gmsh file or a built-in domain, its parts, and its refinements.

use super::SolveArgs;
use super::format::Format;
use crate::figures::{MeshSurface, mesh_surfaces, uphill_on_mesh};
use crate::pipeline::error::{Error, Result};
use crate::timing::machine;
use signorini_mathematics::formats::MeshFields;
use signorini_mathematics::mesh::{AnyMesh, Condition, gmsh};
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::triangulated::MeshProblem;
use std::path::Path;

/// Number of nodes up to which a mesh is refined if the user does not say how often.
const USUAL_NODES: usize = 20_000;

/// Most triangles of a picture, beside which it would grow too large; each refinement makes four of one.
const MOST_TRIANGLES: usize = 2500;

/// Problem on a mesh.
pub(super) struct MeshDomain {
    /// Mesh as it was read, with the conditions on its parts.
    coarsest: AnyMesh,
    /// Problem with all refinements.
    pub problem: MeshProblem,
    /// Length of the longest edge of the finest mesh.
    pub width: f64,
    /// File or built-in domain.
    pub name: String,
}

impl MeshDomain {
    /// Reads the mesh that the arguments name, if they name one, and refines it.
    pub(super) fn read(args: &SolveArgs) -> Result<Option<Self>> {
        let (name, mut mesh) = match (&args.mesh, &args.domain) {
            (Some(path), _) => (path.display().to_string(), from_file(path)?),
            (None, Some(name)) => (name.clone(), built_in(name)?),
            (None, None) => return Ok(None),
        };
        set_conditions(&mut mesh, "--free", &args.free, Condition::Free)?;
        set_conditions(&mut mesh, "--fixed", &args.fixed, Condition::Fixed)?;
        for curve in &args.curve {
            set_curve(&mut mesh, curve)?;
        }
        let times = args.refine.map_or_else(|| usual_refinements(&mesh), usize::from);
        check_memory(&mesh, times)?;
        let f = args.f.as_deref().unwrap_or_default();
        let problem =
            MeshProblem::new(&mesh, times, f).map_err(|e| Error::input(format!("{name}: {e}")))?;
        Ok(Some(Self { coarsest: mesh, width: problem.mesh.width(), problem, name }))
    }

    /// Returns the bytes of a file with the solution.
    pub(super) fn file(&self, kind: Format, pair: &Pair, name: &str) -> Result<Vec<u8>> {
        let Self { problem, coarsest, .. } = self;
        let mut multiplier = vec![0.0; pair.y.len()];
        for (contact, a) in problem.network().contact().iter().zip(&pair.a) {
            multiplier[contact.node as usize] = *a;
        }
        let fields = MeshFields {
            mesh: &problem.mesh,
            v: &pair.y,
            multiplier: &multiplier,
            f: &problem.f.cells.mean,
        };
        match kind {
            Format::Npy => Ok(fields.npy()),
            Format::Npz => fields.npz().ok_or_else(|| {
                Error::input("--out: an .npz file holds at most 4 GB; use .npy or .vtu")
            }),
            Format::Vti | Format::Vtu => Ok(fields.vtu(name)),
            Format::Svg => picture(coarsest, problem.levels.len() - 1, &fields, name),
        }
    }
}

/// Draws the solution on the finest of the nested meshes whose triangles can be told apart.
fn picture(
    coarsest: &AnyMesh,
    times: usize,
    fields: &MeshFields<'_>,
    title: &str,
) -> Result<Vec<u8>> {
    let refinements = (0..times)
        .take_while(|&times| coarsest.cells() << (2 * (times + 1)) <= MOST_TRIANGLES)
        .count();
    let drawn = coarsest.refined(refinements).map_err(|e| Error::input(e.to_string()))?;
    let AnyMesh::Plane(mesh) = &drawn else {
        return Err(Error::input("--out: a solution in space has no picture"));
    };
    // The first nodes of a refined mesh are those of the coarser ones.
    let nodes = mesh.points().len();
    let y = &fields.v[..nodes];
    let in_contact: Vec<bool> = fields.multiplier[..nodes].iter().map(|a| *a > 0.0).collect();
    let azimuth = uphill_on_mesh(mesh, y);
    let surface = MeshSurface { title, mesh, y, in_contact: &in_contact, azimuth, range: None };
    let drawn = mesh_surfaces(1, &[surface]).svg(title, "Made by `signorini solve`.");
    drawn.map(String::into_bytes).map_err(Error::input)
}

fn from_file(path: &Path) -> Result<AnyMesh> {
    let refused = |e: &dyn std::fmt::Display| Error::input(format!("{}: {e}", path.display()));
    let bytes = std::fs::read(path).map_err(|e| refused(&e))?;
    gmsh::read(&bytes).map_err(|e| refused(&e))
}

fn built_in(name: &str) -> Result<AnyMesh> {
    AnyMesh::built_in(name).ok_or_else(|| {
        let names = AnyMesh::built_in_names().join(", ");
        Error::input(format!(
            "--domain {name}: no such domain; choose one of {names}, or give a file with --mesh"
        ))
    })
}

fn set_conditions(
    mesh: &mut AnyMesh,
    option: &str,
    parts: &[String],
    condition: Condition,
) -> Result<()> {
    for part in parts {
        let set = mesh.set_condition(part, condition);
        set.map_err(|e| Error::input(format!("{option} {part}: {e}")))?;
    }
    Ok(())
}

/// Reads `PART=NUMBERS`, and puts the part on that curve.
fn set_curve(mesh: &mut AnyMesh, text: &str) -> Result<()> {
    let wrong = || {
        Error::input(format!(
            "--curve {text}: write PART=NUMBERS, e.g. hole=0,0,0.3 for a circle of radius 0.3 around (0, 0)"
        ))
    };
    let (part, numbers) = text.split_once('=').ok_or_else(wrong)?;
    let numbers: Vec<f64> = numbers
        .split(',')
        .map(|number| number.trim().parse().ok().filter(|number: &f64| number.is_finite()))
        .collect::<Option<_>>()
        .ok_or_else(wrong)?;
    mesh.set_curve(part.trim(), &numbers).map_err(|e| Error::input(format!("--curve {text}: {e}")))
}

/// Number of nodes after some refinements: each multiplies the number of cells, and in the end of nodes, by 4 or 8.
fn nodes_after(mesh: &AnyMesh, times: usize) -> f64 {
    let factor = if mesh.dimension() == 2 { 4f64 } else { 8.0 };
    let nodes_per_cell = if mesh.dimension() == 2 { 0.5 } else { 1.0 / 6.0 };
    let cells = mesh.cells() as f64 * factor.powi(times as i32);
    (nodes_per_cell * cells).max(mesh.nodes() as f64)
}

/// Number of refinements that keep a mesh small.
fn usual_refinements(mesh: &AnyMesh) -> usize {
    (1..=20).take_while(|&times| nodes_after(mesh, times) <= USUAL_NODES as f64).count()
}

/// Refuses refinements that take more memory than there is.
fn check_memory(mesh: &AnyMesh, times: usize) -> Result<()> {
    // Of mesh, network, solver and bounds: measured, rounded up.
    let per_node = if mesh.dimension() == 2 { 600.0 } else { 1500.0 };
    let left = machine::available_memory().unwrap_or(u64::MAX) as f64;
    let taken = |times: usize| per_node * nodes_after(mesh, times);
    if taken(times) <= left {
        return Ok(());
    }
    let fits = (0..times).rev().find(|&times| taken(times) <= left).unwrap_or(0);
    Err(Error::input(format!(
        "--refine {times} takes about {:.0} MB of memory, where {:.0} MB are left; {fits} would fit",
        taken(times) / 1e6,
        left / 1e6
    )))
}
