//! A mesh with its refinements as the levels of a problem.

use super::unsolvable::Component;
use super::{Discrete, Integrals, KnownErrors, Levels, NodalVectors, Unsolvable};
use crate::bounds::triangulation::bounds_on_mesh;
use crate::bounds::{Bounds, NoBound};
use crate::discrete::contact::ContactArc;
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::network::Network;
use crate::mesh::{
    AnyMesh, CutShape, Mesh, MeshLoad, MeshSource, MeshSourceError, NestedMeshes, PlaneMesh,
    Touching, mesh_arcs, mesh_errors, mesh_load, nested_meshes,
};
use crate::multigrid::input::{LoadedComponent, loaded_components};
use crate::problem::error::SourceError;
use crate::problem::law::{ContactNode, Law};
use crate::problem::shape::Shape;
use crate::saddle::Pair;
use std::any::Any;
use std::borrow::Cow;

/// Mesh and its refinements, with f.
pub struct Triangulations<const D: usize, const V: usize> {
    nested: NestedMeshes<D, V>,
    /// Right-hand side.
    f: MeshSource<D>,
    /// f on the finest mesh.
    load: MeshLoad,
    integrals: Integrals,
}

impl<const D: usize, const V: usize> Triangulations<D, V>
where
    Shape<D>: CutShape<D, V>,
{
    /// Levels on a mesh and its refinements, `times` of them, with f given as text.
    ///
    /// # Errors
    /// [`Unsolvable`] if the text is no f on the mesh, f is not finite, or the mesh cannot be refined.
    pub(super) fn new(coarsest: &Mesh<D, V>, times: usize, f: &str) -> Result<Self, Unsolvable> {
        let f = read(coarsest, f)?;
        let nested = nested_meshes(coarsest, times)?;
        let load = mesh_load(&nested.meshes[times], &f)?;
        f.check_scale(load.size)?;
        let integrals = Integrals {
            of_f: load.integral,
            of_size: load.size,
            by_quadrature: load.unsettled.is_some(),
        };
        Ok(Self { nested, f, load, integrals })
    }

    /// Finest mesh.
    fn finest(&self) -> &Mesh<D, V> {
        &self.nested.meshes[self.nested.meshes.len() - 1]
    }

    /// Discrete problem of the finest mesh.
    pub fn network(&self) -> &Network {
        &self.nested.networks[self.nested.networks.len() - 1].network
    }

    /// Connected components of the domain.
    pub(super) fn components(&self) -> Vec<Component> {
        let network = self.network();
        let found = loaded_components(network, &network.components(), &self.load.load);
        let mut components = Vec::new();
        for (number, &LoadedComponent { has_fixed, measure, sum }) in (1..).zip(&found) {
            let number = (found.len() > 1).then_some(number);
            components.push(Component {
                number,
                has_fixed,
                has_parts: true,
                measure,
                integral: sum,
            });
        }
        components
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

impl<const D: usize, const V: usize> Levels for Triangulations<D, V>
where
    Shape<D>: CutShape<D, V>,
    AnyMesh: From<Mesh<D, V>>,
{
    fn count(&self) -> usize {
        self.nested.meshes.len()
    }

    fn dimension(&self) -> u8 {
        D as u8
    }

    fn name(&self, level: usize) -> String {
        match level {
            0 => "the coarsest mesh".into(),
            level => format!("refinement {level}"),
        }
    }

    fn cells(&self, _level: usize) -> Option<usize> {
        None
    }

    fn nodes(&self, level: usize) -> usize {
        self.nested.meshes[level].points().len()
    }

    fn width(&self) -> f64 {
        self.finest().width()
    }

    fn extent(&self) -> f64 {
        self.finest().extent()
    }

    fn f(&self) -> String {
        self.f.text().into()
    }

    fn outside(&self) -> Vec<String> {
        // Shapes know whether they reach into the unit box, and no other domain.
        if self.finest().is_unit_box() { self.f.outside() } else { Vec::new() }
    }

    fn integrals(&self) -> &Integrals {
        &self.integrals
    }

    fn missed(&self) -> Option<f64> {
        self.load.unsettled.map(|unsettled| unsettled / self.load.size)
    }

    fn finest_load(&self) -> &[f64] {
        &self.load.load
    }

    fn load(&self, level: usize) -> Result<Cow<'_, [f64]>, SourceError> {
        if level + 1 == self.count() {
            return Ok(self.finest_load().into());
        }
        Ok(mesh_load(&self.nested.meshes[level], &self.f)?.load.into())
    }

    fn contact(&self) -> Cow<'_, [ContactNode]> {
        self.network().contact().into()
    }

    fn touching(&self) -> Option<&Touching> {
        self.finest().touching()
    }

    fn has_fixed_part(&self) -> bool {
        !self.network().fixed().is_empty()
    }

    fn is_solvable(&self, level: usize, law: Law, load: &[f64]) -> bool {
        let network = &self.nested.networks[level].network;
        let components = loaded_components(network, &network.components(), load);
        components.iter().all(|component| component.check(law, 0.0).is_ok())
    }

    fn judge(
        &self,
        level: usize,
        law: Law,
        NodalVectors { y, load }: NodalVectors<'_>,
    ) -> Judgement {
        judge(&self.nested.networks[level].network, law, y, load)
    }

    fn in_contact(&self, law: Law, pair: &Pair) -> Vec<bool> {
        pair.in_contact(self.network(), law)
    }

    fn arcs(&self, y: &[f64], judgement: &Judgement) -> Option<Vec<ContactArc>> {
        let plane = (self.finest() as &dyn Any).downcast_ref::<PlaneMesh>()?;
        Some(mesh_arcs(plane, self.network(), y, judgement))
    }

    fn errors(&self, y: &[f64], _load: &[f64]) -> Option<KnownErrors> {
        let known = self.f.known().filter(|_| self.finest().is_unit_box())?;
        let values = mesh_errors(self.finest(), |point| known.sample(point), y);
        Some(KnownErrors { values, multiplier_l2: None })
    }

    fn bounds(&self, law: Law, y: &[f64]) -> Result<Bounds, NoBound> {
        bounds_on_mesh(self.finest(), self.network(), &self.load.cells, law, y)
    }

    fn mesh(&self, level: usize) -> AnyMesh {
        self.nested.meshes[level].clone().into()
    }

    fn means(&self, level: usize) -> Result<Vec<f64>, SourceError> {
        if level + 1 == self.count() {
            return Ok(self.load.cells.mean.clone());
        }
        Ok(mesh_load(&self.nested.meshes[level], &self.f)?.cells.mean)
    }

    fn discrete(&self) -> Discrete<'_> {
        Discrete::Networks(&self.nested.networks)
    }
}
