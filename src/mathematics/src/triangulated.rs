//! A problem on a triangulation with its refinements: from a mesh and f to what the solvers take.

use crate::bounds::triangulation::bounds_on_mesh;
use crate::bounds::{Bounds, NoBound};
use crate::discrete::contact::ContactArc;
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::nested::NestedNetwork;
use crate::discrete::network::Network;
use crate::mesh::{
    AnyMesh, CutShape, Mesh, MeshError, MeshLoad, MeshSource, MeshSourceError, mesh_arcs,
    mesh_load, refined,
};
use crate::multigrid::InputError;
use crate::multigrid::input::loaded_components;
use crate::problem::error::SourceError;
use crate::problem::law::{Law, LawError};
use crate::problem::shape::Shape;

/// Problem on a triangulation and its refinements.
pub struct MeshProblem {
    /// Discrete problems, coarsest first.
    pub levels: Vec<NestedNetwork>,
    /// Finest mesh.
    pub mesh: AnyMesh,
    /// f, in one line.
    pub text: String,
    /// f on the finest mesh.
    pub f: MeshLoad,
    /// Coarsest mesh.
    coarsest: AnyMesh,
    /// Law on the boundary.
    pub law: Law,
}

/// Why there is no problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshProblemError {
    /// The mesh cannot be refined.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The text is no f on the mesh.
    #[error(transparent)]
    Text(#[from] MeshSourceError),
    /// f is not finite, or too large or too small to compute with.
    #[error(transparent)]
    Scale(#[from] SourceError),
    /// No solution, or no unique one.
    #[error(
        "the integral of f is {integral:.4e} over {place}, but (2) asks for a negative one where no part is fixed; lower f somewhere, or fix a part of the boundary"
    )]
    NotCoercive {
        /// Integral of f.
        integral: f64,
        /// Connected component of the domain.
        place: String,
    },
    /// Under another law than the paper's, no solution, or no unique one.
    #[error("over {place} {error}")]
    Law {
        /// Connected component of the domain.
        place: String,
        /// The integral of f, and those that the flux can balance.
        error: LawError,
    },
    /// A connected component whose whole boundary is free.
    #[error(
        "the boundary of {0} is free everywhere; let some of the boundary be in contact or fixed"
    )]
    Insulated(String),
}

/// Bound of the rounding error of the integral of f, over the integral of |f|.
const ROUNDING: f64 = 1e-12;

impl MeshProblem {
    /// Refines a mesh `times` times, and integrates f, given as text, on the finest one.
    ///
    /// # Errors
    /// [`MeshProblemError`].
    pub fn new(
        coarsest: &AnyMesh,
        times: usize,
        f: &str,
        law: Law,
    ) -> Result<Self, MeshProblemError> {
        let problem = match coarsest {
            AnyMesh::Plane(mesh) => Self::prepared(mesh, times, f, law)?,
            AnyMesh::Space(mesh) => Self::prepared(mesh, times, f, law)?,
        };
        problem.check_solvable()?;
        Ok(problem)
    }

    fn prepared<const D: usize, const V: usize>(
        coarsest: &Mesh<D, V>,
        times: usize,
        f: &str,
        law: Law,
    ) -> Result<Self, MeshProblemError>
    where
        AnyMesh: From<Mesh<D, V>>,
        Shape<D>: CutShape<D, V>,
    {
        let f = read(coarsest, f)?;
        let (levels, mesh) = refined(coarsest, times)?;
        let load = mesh_load(&mesh, &f)?;
        f.check_scale(load.size)?;
        let (text, coarsest) = (f.text().into(), coarsest.clone().into());
        Ok(Self { levels, mesh: mesh.into(), text, f: load, coarsest, law })
    }

    /// Discrete problem on the finest mesh.
    pub fn network(&self) -> &Network {
        &self.levels[self.levels.len() - 1].network
    }

    /// Load vectors of all levels, coarsest first: (6) on each mesh.
    ///
    /// # Errors
    /// [`MeshProblemError`] if f is not finite at a point of a coarser mesh.
    pub fn loads(&self) -> Result<Vec<Vec<f64>>, MeshProblemError> {
        let (mut loads, mut mesh) = (Vec::new(), self.coarsest.clone());
        for coarser in 1..self.levels.len() {
            loads.push(load_on(&mesh, &self.text)?.load);
            if coarser + 1 < self.levels.len() {
                mesh = mesh.refined(1)?;
            }
        }
        loads.push(self.f.load.clone());
        Ok(loads)
    }

    /// Judges a nodal vector of the finest mesh, apart from the solvers.
    pub fn judge(&self, y: &[f64]) -> Judgement {
        judge(self.network(), self.law, y, &self.f.load)
    }

    /// Returns guaranteed bounds for a nodal vector of the finest mesh.
    ///
    /// # Errors
    /// As [`bounds_on_mesh`].
    pub fn bounds(&self, y: &[f64]) -> Result<Bounds, NoBound> {
        match &self.mesh {
            AnyMesh::Plane(mesh) => {
                bounds_on_mesh(mesh, self.network(), &self.f.cells, self.law, y)
            }
            AnyMesh::Space(mesh) => {
                bounds_on_mesh(mesh, self.network(), &self.f.cells, self.law, y)
            }
        }
    }

    /// Returns the arcs in contact; `None` in space.
    pub fn arcs(&self, y: &[f64], judgement: &Judgement) -> Option<Vec<ContactArc>> {
        match &self.mesh {
            AnyMesh::Plane(mesh) => Some(mesh_arcs(mesh, self.network(), y, judgement)),
            AnyMesh::Space(_) => None,
        }
    }

    /// Checks that the flux can balance the load of each connected component without a fixed part, for the paper's law
    /// the condition (2).
    fn check_solvable(&self) -> Result<(), MeshProblemError> {
        let network = self.network();
        let found = loaded_components(network, &network.components(), &self.f.load);
        for (component, loaded) in found.iter().enumerate() {
            let place = match found.len() {
                1 => "the domain".to_owned(),
                _ => format!("component {} of the domain", component + 1),
            };
            if !loaded.has_fixed && loaded.measure == 0.0 {
                return Err(MeshProblemError::Insulated(place));
            }
            match loaded.check(self.law, ROUNDING * self.f.size) {
                Err(InputError::Law(error)) => return Err(MeshProblemError::Law { place, error }),
                Err(_) => {
                    return Err(MeshProblemError::NotCoercive { integral: loaded.sum, place });
                }
                Ok(()) => {}
            }
        }
        Ok(())
    }
}

/// Reads f on a mesh.
fn read<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    f: &str,
) -> Result<MeshSource<D>, MeshSourceError> {
    // A power of ten, which messages show.
    let size = libm::exp10(libm::log10(mesh.largest_coordinate()).ceil());
    MeshSource::read(f, mesh.region_names(), size)
}

/// Returns the means of f, given as text, over the cells of a mesh.
///
/// # Errors
/// As [`MeshSource::read`], and [`SourceError::NoValue`] where f is not finite.
pub fn means_on(mesh: &AnyMesh, f: &str) -> Result<Vec<f64>, MeshProblemError> {
    Ok(load_on(mesh, f)?.cells.mean)
}

/// Integrates f, given as text, on a mesh.
fn load_on(mesh: &AnyMesh, f: &str) -> Result<MeshLoad, MeshProblemError> {
    Ok(match mesh {
        AnyMesh::Plane(mesh) => mesh_load(mesh, &read(mesh, f)?)?,
        AnyMesh::Space(mesh) => mesh_load(mesh, &read(mesh, f)?)?,
    })
}
