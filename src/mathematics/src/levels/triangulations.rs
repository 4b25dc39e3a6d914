//! A mesh with its refinements as the levels of a problem.

use super::{Drawing, Facts, Levels, ProblemError, Step, Watch};
use crate::bounds::triangulation::BoundedProblem;
use crate::bounds::{Bounds, NoBound};
use crate::discrete::domain::components;
use crate::discrete::nested::{DiscreteLevels, NestedNetwork, nested_components};
use crate::discrete::network::Network;
use crate::mesh::{
    AnyMesh, ClosedCurve, CurveGain, CutShape, Mesh, MeshLoad, NestedMeshes, Sides,
    boundary_curves, curve_gains, mesh_load, nested_meshes, on_regions,
};
use crate::problem::error::SourceError;
use crate::problem::law::Law;
use crate::problem::shape::Shape;
use crate::problem::source::Source;
use crate::problem::unsolvable::Component;
use std::borrow::Cow;
use std::sync::Mutex;

/// Mesh and its refinements, with f.
pub(crate) struct Triangulations<const D: usize, const V: usize> {
    /// Meshes, coarsest first.
    meshes: Vec<AnyMesh>,
    /// Discrete problem of each mesh.
    networks: Vec<NestedNetwork>,
    /// Right-hand side on each region.
    f: Vec<Source<D>>,
    /// f on the finest mesh.
    load: MeshLoad,
    facts: Facts,
    /// Sides of the finest mesh.
    sides: Sides<V>,
    /// Guaranteed errors that were asked for last: bounds and files take those of one vector.
    errors: Mutex<Option<VectorErrors>>,
}

/// Guaranteed error of a nodal vector in each cell.
pub(crate) struct VectorErrors {
    pub y: Vec<f64>,
    pub of_cells: Vec<f64>,
}

impl<const D: usize, const V: usize> Triangulations<D, V>
where
    Shape<D>: CutShape<D, V>,
    AnyMesh: From<Mesh<D, V>>,
{
    /// Levels on a mesh and its refinements, `times` of them, with f given as text; `watch` is told when they are made.
    ///
    /// # Errors
    /// [`ProblemError`] if the text is no f on the mesh, f is not finite, or the mesh cannot be refined.
    pub(super) fn new(
        coarsest: &Mesh<D, V>,
        times: usize,
        f: &str,
        watch: Watch<'_>,
    ) -> Result<Self, ProblemError> {
        let (f, text) = (read(coarsest, f)?, f);
        let nested = nested_meshes(coarsest, times)?;
        watch(Step::Mesh);
        let load = mesh_load(&nested.meshes[times], &f[..])?;
        load.check_scale(&f)?;
        Ok(Self::of(nested, (f, text), load))
    }

    /// Levels on nested meshes, with f on each region and its text, and what it is on the finest.
    pub(crate) fn of(
        nested: NestedMeshes<D, V>,
        (f, text): (Vec<Source<D>>, &str),
        load: MeshLoad,
    ) -> Self {
        let finest = &nested.meshes[nested.meshes.len() - 1];
        // Shapes know whether they reach into the unit box, and no other domain.
        let outside = f.iter().map(Source::outside).find(|notes| !notes.is_empty());
        let outside = outside.filter(|_| finest.is_unit_box());
        let known = match &f[0] {
            Source::Exact(known) if f.iter().all(|other| *other == f[0]) => {
                Some(*known).filter(|_| finest.is_laplacian())
            }
            _ => None,
        };
        let facts = Facts {
            dimension: D as u8,
            width: finest.width(),
            extent: finest.extent(),
            f: text.split_whitespace().collect::<Vec<_>>().join(" "),
            integral: load.integral,
            size: load.size,
            given: load.given,
            given_flux: load.given_flux,
            by_quadrature: load.unsettled.is_some() || !finest.values.is_empty(),
            known,
            notes: finest.notes().into_iter().chain(outside.into_iter().flatten()).collect(),
            is_adapted: false,
        };
        let NestedMeshes { meshes, networks, sides } = nested;
        let meshes = meshes.into_iter().map(AnyMesh::from).collect();
        Self { meshes, networks, f, load, facts, sides, errors: Mutex::default() }
    }

    /// Levels of an adapted mesh, with guaranteed errors on the finest.
    pub(crate) fn adapted(self, errors: VectorErrors) -> Self {
        let facts = Facts { is_adapted: true, ..self.facts };
        Self { errors: Mutex::new(Some(errors)), facts, ..self }
    }

    /// Guaranteed errors of a nodal vector in each cell, if they were asked for last.
    fn known_errors(&self, y: &[f64]) -> Option<Vec<f64>> {
        let errors = self.errors.lock().expect("no panic before");
        let errors = errors.as_ref().filter(|errors| errors.y == y);
        errors.map(|errors| errors.of_cells.clone())
    }

    /// Mesh of a level.
    fn on(&self, level: usize) -> &Mesh<D, V> {
        self.meshes[level].of_dimension().expect("all meshes have this dimension")
    }

    /// Finest mesh.
    fn finest(&self) -> &Mesh<D, V> {
        self.on(self.meshes.len() - 1)
    }

    /// Discrete problem of the finest mesh.
    fn network(&self) -> &Network {
        &self.networks[self.networks.len() - 1].network
    }

    /// Number of the finest level with no more triangles than the square has with so many cells across, or else of the
    /// coarsest.
    fn drawn(&self, most_cells: usize) -> usize {
        let most = most_cells.saturating_mul(most_cells).saturating_mul(2);
        self.meshes[1..].iter().take_while(|mesh| mesh.cells() <= most).count()
    }
}

/// Reads f on each region of a mesh.
pub(crate) fn read<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    f: &str,
) -> Result<Vec<Source<D>>, SourceError> {
    // A power of ten, which messages show.
    let size = libm::exp10(libm::log10(mesh.largest_coordinate()).ceil());
    on_regions(f, mesh.region_names(), size)
}

impl<const D: usize, const V: usize> Levels for Triangulations<D, V>
where
    Shape<D>: CutShape<D, V>,
    AnyMesh: From<Mesh<D, V>>,
{
    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn discrete(&self) -> DiscreteLevels<'_> {
        DiscreteLevels::Networks(&self.networks)
    }

    fn mesh(&self, level: usize) -> Cow<'_, AnyMesh> {
        Cow::Borrowed(&self.meshes[level])
    }

    fn boundary(&self) -> Vec<ClosedCurve> {
        let finest = self.meshes[self.meshes.len() - 1].plane();
        finest.map_or_else(Vec::new, boundary_curves)
    }

    fn drawing(&self, most_cells: usize) -> Option<Drawing> {
        let mesh = self.meshes[self.drawn(most_cells)].plane()?.clone();
        // The first nodes of a refined mesh are those of the coarser ones.
        let nodes = (0..mesh.points().len()).collect();
        Some(Drawing { mesh, nodes })
    }

    fn means(&self, most_cells: usize) -> Result<Cow<'_, [f64]>, SourceError> {
        let drawn = self.drawn(most_cells);
        if drawn + 1 == self.meshes.len() {
            return Ok((&self.load.cells.mean[..]).into());
        }
        Ok(mesh_load(self.on(drawn), &self.f[..])?.cells.mean.into())
    }

    fn missed(&self) -> Option<f64> {
        self.load.missed()
    }

    fn finest_load(&self) -> &[f64] {
        &self.load.load
    }

    fn load(&self, level: usize) -> Result<Cow<'_, [f64]>, SourceError> {
        if level + 1 == self.meshes.len() {
            return Ok(self.finest_load().into());
        }
        Ok(mesh_load(self.on(level), &self.f[..])?.load.into())
    }

    fn components(&self) -> Vec<Component> {
        let mut components =
            components(self.network(), &nested_components(&self.networks), &self.load.load);
        let has_fluxes = self.facts.given != 0.0;
        components.iter_mut().for_each(|of| of.has_fluxes = has_fluxes);
        components
    }

    fn components_on_curves(&self) -> Vec<Component> {
        let mut components = self.components();
        let of_nodes = nested_components(&self.networks);
        let gains = curve_gains(self.finest(), &self.sides, &self.f[..]);
        for CurveGain { facet, measure, integral } in gains {
            let facet = &self.finest().facets()[facet];
            let component = &mut components[of_nodes[facet.nodes[0] as usize] as usize];
            let law = self.finest().law(facet);
            component.integral += integral + if law.is_free() { law.lo() * measure } else { 0.0 };
            component.laws.add(law, measure);
        }
        components
    }

    fn laws(&self) -> Vec<(String, Law)> {
        self.finest().laws()
    }

    fn bounds(&self, y: &[f64]) -> Result<Bounds, NoBound> {
        let (mesh, sides) = (self.finest(), &self.sides);
        let (network, f) = (self.network(), &self.load);
        let bounded = BoundedProblem { mesh, sides, network, f };
        let found = bounded.bounds(y)?;
        let errors = VectorErrors { y: y.to_vec(), of_cells: found.errors() };
        *self.errors.lock().expect("no panic before") = Some(errors);
        Ok(bounded.with_lower(found.bounds, y))
    }

    fn local_errors(&self, y: &[f64]) -> Vec<f64> {
        self.known_errors(y).unwrap_or_else(|| {
            // The bounds leave the errors behind.
            self.bounds(y).ok().and_then(|_| self.known_errors(y)).unwrap_or_default()
        })
    }
}
