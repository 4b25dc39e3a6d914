//! A mesh with its refinements as the levels of a problem.

use super::{
    ClosedCurve, Discrete, Drawing, Integrals, KnownErrors, Levels, NodalVectors, ProblemError,
    Step, Watch,
};
use crate::bounds::triangulation::{BoundedProblem, bounds_on_mesh};
use crate::bounds::{Bounds, NoBound};
use crate::discrete::contact::ContactArc;
use crate::discrete::kkt::{DiscreteDomain, Judgement, has_solution, judge};
use crate::discrete::network::Network;
use crate::formats::MeshFields;
use crate::mesh::{
    AnyMesh, Condition, CurveGain, CutShape, Mesh, MeshLoad, MeshSource, MeshSourceError,
    NestedMeshes, PlaneMesh, Sides, boundary_curves, curve_gains, mesh_arcs, mesh_errors,
    mesh_load, nested_meshes,
};
use crate::problem::error::SourceError;
use crate::problem::law::{ContactNode, Law};
use crate::problem::shape::Shape;
use crate::problem::unsolvable::Component;
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
    /// Guaranteed error in each cell of the finest mesh, if the meshes are adapted.
    errors: Option<Vec<f64>>,
}

impl<const D: usize, const V: usize> Triangulations<D, V>
where
    Shape<D>: CutShape<D, V>,
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
        let f = read(coarsest, f)?;
        let nested = nested_meshes(coarsest, times)?;
        watch(Step::Mesh);
        let load = mesh_load(&nested.meshes[times], &f)?;
        f.check_scale(&load)?;
        Ok(Self::of(nested, f, load))
    }

    /// Levels on nested meshes, with f and what it is on the finest.
    pub(crate) fn of(nested: NestedMeshes<D, V>, f: MeshSource<D>, load: MeshLoad) -> Self {
        let integrals = Integrals {
            of_f: load.integral,
            of_size: load.size,
            by_quadrature: load.unsettled.is_some(),
            is_known: f.known().is_some(),
        };
        Self { nested, f, load, integrals, errors: None }
    }

    /// Levels with the guaranteed error in each cell of the finest mesh.
    pub(crate) fn with_errors(self, errors: Vec<f64>) -> Self {
        Self { errors: Some(errors), ..self }
    }

    /// Finest mesh.
    fn finest(&self) -> &Mesh<D, V> {
        &self.nested.meshes[self.nested.meshes.len() - 1]
    }

    /// Discrete problem of the finest mesh.
    pub fn network(&self) -> &Network {
        &self.nested.networks[self.nested.networks.len() - 1].network
    }

    /// Multiplier of a pair of the finest mesh at all nodes, zero where there is no contact condition.
    fn multiplier(&self, pair: &Pair) -> Vec<f64> {
        let mut multiplier = vec![0.0; pair.y.len()];
        for (contact, a) in self.network().contact().iter().zip(&pair.a) {
            multiplier[contact.node] = *a;
        }
        multiplier
    }

    /// Guaranteed error in each cell of the finest mesh, as far as it is known.
    fn local_errors(&self, law: Law, y: &[f64]) -> Cow<'_, [f64]> {
        if let Some(errors) = &self.errors {
            return errors.into();
        }
        let (mesh, network, f) = (self.finest(), self.network(), &self.load);
        let bounded = BoundedProblem { mesh, sides: &Sides::new(mesh), network, f, law }.bounds(y);
        bounded.map_or_else(|_| Cow::default(), |bounds| bounds.errors().into())
    }

    /// A pair of the finest mesh as the fields of a file, with its multiplier at all nodes.
    fn fields<'a>(
        &'a self,
        pair: &'a Pair,
        [multiplier, errors]: [&'a [f64]; 2],
    ) -> MeshFields<'a, D, V> {
        let (mesh, f) = (self.finest(), &self.load.cells.mean);
        MeshFields { mesh, v: &pair.y, multiplier, f, errors }
    }

    /// Number of the finest level with no more triangles than the square has with so many cells across, or else of the
    /// coarsest.
    fn drawn(&self, most_cells: usize) -> usize {
        let fits = |mesh: &&Mesh<D, V>| mesh.cells().len() <= 2 * most_cells * most_cells;
        self.nested.meshes[1..].iter().take_while(fits).count()
    }
}

/// The mesh, if it lies in the plane.
fn plane<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> Option<&PlaneMesh> {
    (mesh as &dyn Any).downcast_ref()
}

/// Arc lengths of the nodes of a closed curve from the first, which is also the last.
fn arc_lengths(mesh: &PlaneMesh, nodes: &[usize]) -> Vec<f64> {
    let (mut lengths, mut sum) = (vec![0.0], 0.0);
    for (k, &node) in nodes.iter().enumerate() {
        let next = nodes[(k + 1) % nodes.len()];
        let [[ax, ay], [bx, by]] = [node, next].map(|node| mesh.points()[node]);
        sum += ((bx - ax) * (bx - ax) + (by - ay) * (by - ay)).sqrt();
        lengths.push(sum);
    }
    lengths
}

/// Reads f on a mesh.
pub(crate) fn read<const D: usize, const V: usize>(
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
            // Of adapted meshes most are not shown.
            level if self.errors.is_some() => format!("the mesh of {} nodes", self.nodes(level)),
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
        self.load.missed()
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

    fn notes(&self) -> Vec<String> {
        self.finest().notes()
    }

    fn has_fixed_part(&self) -> bool {
        !self.network().fixed().is_empty()
    }

    fn components(&self) -> Vec<Component> {
        DiscreteDomain::components(self.network(), &self.load.load)
    }

    fn components_on_curves(&self) -> Vec<Component> {
        let mut components = self.components();
        let of_nodes = self.network().components();
        for CurveGain { facet, measure, integral } in curve_gains(self.finest(), &self.f) {
            let facet = &self.finest().facets()[facet];
            let component = &mut components[of_nodes[facet.nodes[0] as usize] as usize];
            component.integral += integral;
            if self.finest().condition(facet) == Condition::Contact {
                component.measure += measure;
            }
        }
        components
    }

    fn is_solvable(&self, level: usize, law: Law, load: &[f64]) -> bool {
        has_solution(&self.nested.networks[level].network, law, load)
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
        Some(mesh_arcs(plane(self.finest())?, self.network(), y, judgement))
    }

    fn parts_in_contact(&self, judgement: &Judgement) -> Option<String> {
        let mut touches = vec![false; self.finest().points().len()];
        for (contact, touch) in self.network().contact().iter().zip(judgement.in_contact()) {
            touches[contact.node] = touch;
        }
        (self.finest().parts().len() > 1).then(|| self.finest().parts_of(&touches))
    }

    fn errors(&self, y: &[f64], _load: &[f64]) -> Option<KnownErrors> {
        let known = self.f.known().filter(|_| self.finest().is_unit_box())?;
        let values = mesh_errors(self.finest(), |point| known.sample(point), y);
        Some(KnownErrors { values, multiplier_l2: None })
    }

    fn bounds(&self, law: Law, y: &[f64]) -> Result<Bounds, NoBound> {
        bounds_on_mesh(self.finest(), self.network(), &self.load, law, y)
    }

    fn coarsest(&self) -> Option<&PlaneMesh> {
        plane(&self.nested.meshes[0])
    }

    fn mesh(&self) -> AnyMesh {
        self.finest().clone().into()
    }

    fn map_of_f(&self, most_cells: usize) -> Result<Option<(Drawing, Vec<f64>)>, SourceError> {
        let Some(drawing) = self.drawing(most_cells) else { return Ok(None) };
        let drawn = self.drawn(most_cells);
        let f = match drawn + 1 == self.count() {
            true => self.load.cells.mean.clone(),
            false => mesh_load(&self.nested.meshes[drawn], &self.f)?.cells.mean,
        };
        Ok(Some((drawing, f)))
    }

    fn drawing(&self, most_cells: usize) -> Option<Drawing> {
        let mesh = plane(&self.nested.meshes[self.drawn(most_cells)])?.clone();
        // The first nodes of a refined mesh are those of the coarser ones.
        let nodes = (0..mesh.points().len()).collect();
        Some(Drawing { mesh, nodes })
    }

    fn curves(&self) -> Option<Vec<ClosedCurve>> {
        let mesh = plane(self.finest())?;
        let mut conditions = vec![Condition::Contact; mesh.points().len()];
        for facet in mesh.facets() {
            conditions[facet.nodes[0] as usize] = mesh.condition(facet);
        }
        let mut curves = Vec::new();
        for curve in boundary_curves(mesh) {
            let parts = curve.parts.iter().map(|&part| mesh.parts()[part].names.to_string());
            let parts = Some(parts.collect::<Vec<_>>().join(", "));
            let mut places = arc_lengths(mesh, &curve.nodes);
            let length = places.pop().unwrap_or_default();
            curves.push(ClosedCurve {
                parts,
                points: curve.nodes.iter().map(|&node| mesh.points()[node]).collect(),
                conditions: curve.nodes.iter().map(|&node| conditions[node]).collect(),
                nodes: curve.nodes,
                places,
                length,
            });
        }
        Some(curves)
    }

    fn vtk_ending(&self) -> &'static str {
        "vtu"
    }

    fn vtk(&self, name: &str, law: Law, pair: &Pair) -> Vec<u8> {
        let errors = self.local_errors(law, &pair.y);
        self.fields(pair, [&self.multiplier(pair), &errors]).vtu(name)
    }

    fn npz(&self, law: Law, pair: &Pair) -> Option<Vec<u8>> {
        let errors = self.local_errors(law, &pair.y);
        self.fields(pair, [&self.multiplier(pair), &errors]).npz()
    }

    fn npy(&self, pair: &Pair) -> Vec<u8> {
        self.fields(pair, [&[]; 2]).npy()
    }

    fn discrete(&self) -> Discrete<'_> {
        Discrete::Networks(&self.nested.networks)
    }
}
