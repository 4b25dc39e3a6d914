//! Problems of `solve` on a mesh: a Gmsh file or a built-in domain, its parts, and its refinements.

use super::format::{Format, ReportedAs};
use super::{SolveArgs, cells};
use crate::figures::{MeshSurface, mesh_surfaces, uphill_on_mesh};
use crate::pipeline::error::{Error, Result};
use crate::replication::domain::{DomainSettings, drawn, nodes_after};
use crate::replication::scene::Scene;
use crate::timing::machine;
use signorini_mathematics::formats::MeshFields;
use signorini_mathematics::mesh::{AnyMesh, uniform_cube};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::triangulated::MeshProblem;
use std::collections::BTreeMap;

/// Problem on a mesh.
pub(super) struct MeshDomain {
    /// Mesh as it was read, with the conditions on its parts.
    coarsest: AnyMesh,
    /// Problem with all refinements.
    pub problem: MeshProblem,
    /// Length of the longest edge of the finest mesh.
    pub width: f64,
    /// Scene, file or built-in domain.
    pub name: String,
}

impl MeshDomain {
    /// Reads the mesh that the arguments or the scene name, if they name one, and refines it.
    pub(super) fn read(
        args: &SolveArgs,
        scene: Option<&Scene>,
        law: Law,
        overridden: &mut Vec<String>,
    ) -> Result<Option<Self>> {
        let Some(NamedDomain { name, settings, coarsest, f }) =
            NamedDomain::read(args, scene, overridden)?
        else {
            return Ok(None);
        };
        let times = settings.refinements(&coarsest);
        check_memory(&coarsest, times)?;
        let problem = MeshProblem::new(&coarsest, times, &f, law)
            .map_err(|e| Error::input(format!("{name}: {e}")))?;
        Ok(Some(Self { coarsest, width: problem.mesh.width(), problem, name }))
    }

    /// Returns the load vectors of all meshes, coarsest first.
    pub(super) fn loads(&self) -> Result<Vec<Vec<f64>>> {
        self.problem.loads().map_err(|e| Error::input(format!("{}: {e}", self.name)))
    }

    /// Returns the bytes of a file with the solution.
    pub(super) fn file(
        &self,
        kind: Format,
        pair: &Pair,
        ReportedAs { name, law }: ReportedAs<'_>,
    ) -> Result<Vec<u8>> {
        let Self { problem, coarsest, .. } = self;
        let multiplier = pair.multiplier_on(problem.network());
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
            Format::Svg => {
                let in_contact = pair.in_contact_on(problem.network(), law);
                let drawn = drawn(coarsest, problem.levels.len() - 1)?;
                picture(&drawn, &pair.y, &in_contact, name)
            }
        }
    }
}

/// Draws the solution on the finest of the nested meshes whose triangles can be told apart.
fn picture(drawn: &AnyMesh, y: &[f64], in_contact: &[bool], title: &str) -> Result<Vec<u8>> {
    let AnyMesh::Plane(mesh) = drawn else {
        return Err(Error::input("--out: a solution in space has no picture"));
    };
    // The first nodes of a refined mesh are those of the coarser ones.
    let nodes = mesh.points().len();
    let (y, in_contact) = (&y[..nodes], &in_contact[..nodes]);
    let azimuth = uphill_on_mesh(mesh, y);
    let surface = MeshSurface { title, mesh, y, in_contact, azimuth, range: None };
    let drawn = mesh_surfaces(1, &[surface]).svg(title, "Made by `signorini solve`.");
    drawn.map(String::into_bytes).map_err(Error::input)
}

/// Name of the domain that has a lattice in place of meshes.
const SQUARE: &str = "square";
/// Name of the domain whose meshes have as many cells along each side.
const CUBE: &str = "cube";

/// Domain as the arguments or the scene name it.
struct NamedDomain {
    name: String,
    settings: DomainSettings,
    coarsest: AnyMesh,
    /// f, as text.
    f: String,
}

impl NamedDomain {
    fn read(
        args: &SolveArgs,
        scene: Option<&Scene>,
        overridden: &mut Vec<String>,
    ) -> Result<Option<Self>> {
        if let Some(scene) = scene {
            return Self::of_scene(args, scene, overridden);
        }
        let Some(name) = args.domain.clone().filter(|name| name != SQUARE) else { return Ok(None) };
        let mut settings = DomainSettings {
            name: name.clone(),
            refine: args.refine,
            free: args.free.clone(),
            fixed: args.fixed.clone(),
            curve: BTreeMap::new(),
        };
        for text in &args.curve {
            let (part, numbers) = curve(text)?;
            if settings.curve.insert(part, numbers).is_some() {
                return Err(Error::input(format!(
                    "--curve {text}: the part has one already; name it once"
                )));
            }
        }
        let coarsest = match args.h.as_deref() {
            Some(h) if name == CUBE => {
                let cells = cells(h)?;
                settings.refine = Some(cells.trailing_zeros() as u8);
                let cube = uniform_cube(cells >> cells.trailing_zeros()).into();
                settings.with_conditions(cube, "--")?
            }
            Some(_) => {
                return Err(Error::input(format!(
                    "--h is for the square and the cube; refine {name} with --refine K"
                )));
            }
            None => {
                let refused = |e| Error::input(format!("{name}: {e}"));
                let file = settings.is_file().then(|| std::fs::read(&name));
                settings.coarsest(file.transpose().map_err(refused)?.as_deref(), "--")?
            }
        };
        let f = args.f.clone().unwrap_or_default();
        Ok(Some(Self { name, settings, coarsest, f }))
    }

    fn of_scene(
        args: &SolveArgs,
        scene: &Scene,
        overridden: &mut Vec<String>,
    ) -> Result<Option<Self>> {
        let Some(domain) = &scene.domain else { return Ok(None) };
        let coarsest = domain.coarsest(&domain.files)?;
        let mut settings = domain.settings.clone();
        let of_scene = settings.refinements(&coarsest);
        if let Some(refine) = args.refine.filter(|&refine| usize::from(refine) != of_scene) {
            overridden.push(format!("refine {refine} instead of {of_scene}"));
            settings.refine = Some(refine);
        }
        Ok(Some(Self { name: scene.name.clone(), settings, coarsest, f: domain.f.clone() }))
    }
}

/// Reads `PART=NUMBERS`: a part of the boundary, and the numbers of the curve on which it lies.
fn curve(text: &str) -> Result<(String, Vec<f64>)> {
    let read = || {
        let (part, numbers) = text.split_once('=')?;
        let numbers = numbers.split(',').map(|number| number.trim().parse().ok());
        Some((part.trim().to_owned(), numbers.collect::<Option<_>>()?))
    };
    read().ok_or_else(|| {
        Error::input(format!(
            "--curve {text}: write PART=NUMBERS, e.g. hole=0,0,0.3 for a circle of radius 0.3 around (0, 0)"
        ))
    })
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
