//! Triangulations of domains in the plane and in space: the paper's F_h, with named regions and boundary parts.
//!
//! D is the dimension; a cell, a triangle or tetrahedron, has V = D + 1 vertices, a facet, an edge or triangle, has D.

mod any;
mod assemble;
mod at;
mod ball;
mod beyond;
mod bisect;
mod boundary;
mod builtin;
mod check;
mod curve;
mod cut;
mod cut_space;
mod edges;
mod error;
mod errors;
mod facet_boxes;
mod facets;
mod geometry;
pub mod gmsh;
mod hanging;
mod load;
mod names;
mod nested;
mod on_curve;
mod origin;
mod overlap;
mod pinched;
mod refine;
mod same_place;
mod sides;
mod source;
mod split;
mod surface;

pub use any::AnyMesh;
pub(crate) use any::PartShares;
pub use assemble::assemble;
pub(crate) use assemble::{assemble_inverse, assemble_sides, check_meetings, check_values};
pub use at::PointValue;
pub(crate) use beyond::{CurveGain, curve_gains};
pub(crate) use bisect::{Bisected, bisect, is_stretched, label_longest_edges, quarter};
pub use boundary::arcs;
pub(crate) use boundary::boundary_curves;
pub use boundary::{ClosedCurve, square_boundary};
pub use builtin::{BUILT_IN, BuiltIn};
pub use curve::Round;
pub use cut::{ConstantPieces, CutMoments, CutShape, FramedCell};
pub(crate) use edges::Edges;
pub use error::MeshError;
pub use errors::mesh_errors;

pub(crate) use builtin::square_with_sides;
pub use builtin::{lattice_mesh, uniform_cube, uniform_square};
pub(crate) use facets::sorted;
pub use geometry::{Element, centroid, size, volume};
use geometry::{bounds, longest_side};
pub(crate) use geometry::{difference, dot, measure};
pub use load::{CellData, MeshLoad, OnCells, mesh_load};
pub(crate) use load::{CellsBefore, mesh_load_after};
pub use names::Names;
pub use nested::refined;
pub(crate) use nested::{NestedMeshes, nested_meshes};
pub(crate) use origin::{MeshOrigin, PlaneInSpace};
pub use refine::{Refined, refine};
pub(crate) use sides::{BoundarySide, Neighbour, Sides, position};
pub(crate) use source::on_regions;

use crate::discrete::quadrature::facet_points;
use crate::problem::formula::Formula;
use crate::problem::law::Law;

/// Named part of the boundary: the facets that have the same names.
#[derive(Clone, Debug, PartialEq)]
pub struct Part<const D: usize> {
    /// Names.
    pub names: Names,
    /// Law there.
    pub law: Law,
    /// Surface on which the part lies, unless it is the polygon or polyhedron itself.
    pub curve: Option<Round<D>>,
}

/// Edge or triangle of the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet<const D: usize> {
    /// Numbers of its nodes.
    pub nodes: [u32; D],
    /// Position of its part in [`Mesh::parts`].
    pub part: u16,
}

/// Triangulation without hanging nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh<const D: usize, const V: usize> {
    /// Coordinates of the nodes.
    pub(crate) points: Vec<[f64; D]>,
    /// Numbers of the vertices of each cell, in the order that refinement wants: in space some in the negative sense.
    pub(crate) cells: Vec<[u32; V]>,
    /// Number of the element of the file in which each cell lies; of a refined mesh none, unless it is curved.
    pub(crate) elements: Vec<u64>,
    /// Position of the region of each cell in `region_names`.
    pub(crate) regions: Vec<u16>,
    /// Names of the regions.
    pub(crate) region_names: Vec<Names>,
    /// Factor k of each region: the flux is `k grad v`.
    pub(crate) k: Vec<f64>,
    /// Factor c of the term c v of the equation, not negative.
    pub(crate) reaction: f64,
    /// Facets of the boundary.
    pub(crate) facets: Vec<Facet<D>>,
    /// Parts of the boundary.
    pub(crate) parts: Vec<Part<D>>,
    /// Values of laws, and fluxes of free parts, that are no numbers but formulas, with the position of the part of
    /// each.
    pub(crate) values: Vec<(u16, Formula)>,
    /// Names of facets that all lie inside the domain.
    pub(crate) inside: Vec<String>,
    /// Lines to be told of places where the domain touches itself.
    pub(crate) touching: Vec<String>,
    /// Lines to be told of nodes that were moved onto the curves of their parts.
    pub(crate) moved: Vec<String>,
    /// Place of the mesh in its file, and what was read otherwise than it stands there.
    pub(crate) origin: MeshOrigin,
}

/// Triangulation in the plane.
pub type PlaneMesh = Mesh<2, 3>;
/// Triangulation in space.
pub type SpaceMesh = Mesh<3, 4>;

/// What a mesh is made from: data of a file or a program, not yet checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData<const D: usize, const V: usize> {
    /// Coordinates of the nodes.
    pub points: Vec<[f64; D]>,
    /// Numbers of the vertices of each cell.
    pub cells: Vec<[u32; V]>,
    /// Position of the region of each cell in `region_names`; empty if there are no regions.
    pub regions: Vec<u16>,
    /// Names of the regions.
    pub region_names: Vec<Names>,
    /// Facets with named parts; a facet of the boundary that is not here belongs to a part named `boundary`.
    pub facets: Vec<Facet<D>>,
    /// Parts of the boundary.
    pub parts: Vec<Part<D>>,
    /// Names of nodes and cells in messages, if they are not their numbers from 0 on.
    pub tags: Tags,
}

/// Numbers by which a file names its nodes and cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tags {
    /// Number of each node; empty if it is its position.
    pub nodes: Vec<u64>,
    /// Number of each cell; empty if it is its position.
    pub cells: Vec<u64>,
}

impl<const D: usize, const V: usize> Mesh<D, V> {
    /// Coordinates of the nodes.
    pub fn points(&self) -> &[[f64; D]] {
        &self.points
    }

    /// Numbers of the vertices of each cell: in the plane in the positive sense, in space in the order that refinement
    /// wants, which is the negative sense for some; see [`Mesh::positive_cells`].
    pub fn cells(&self) -> &[[u32; V]] {
        &self.cells
    }

    /// Numbers of the vertices of each cell in the positive sense, as other programs want them.
    pub fn positive_cells(&self) -> impl Iterator<Item = [u32; V]> {
        self.cells.iter().map(|cell| {
            let is_mirrored = Element::new(self.vertices(cell)).is_mirrored;
            if is_mirrored { check::turned(*cell) } else { *cell }
        })
    }

    /// Position of the region of each cell in [`Mesh::region_names`].
    pub fn regions(&self) -> &[u16] {
        &self.regions
    }

    /// Names of the regions.
    pub fn region_names(&self) -> &[Names] {
        &self.region_names
    }

    /// k on a cell: the flux is `k grad v`.
    #[inline(always)]
    pub(crate) fn k(&self, cell: usize) -> f64 {
        // Most meshes have one region.
        if let [k] = self.k[..] { k } else { self.k[usize::from(self.regions[cell])] }
    }

    /// True if k is 1 everywhere, and there is no reaction.
    pub(crate) fn is_laplacian(&self) -> bool {
        self.k.iter().all(|k| *k == 1.0) && self.reaction == 0.0
    }

    /// Facets of the boundary.
    pub fn facets(&self) -> &[Facet<D>] {
        &self.facets
    }

    /// Facets that are neither free nor fixed.
    fn facets_with_law(&self) -> impl Iterator<Item = &Facet<D>> {
        self.facets.iter().filter(|facet| self.law(facet).may_move())
    }

    /// Names of the parts on which nodes lie: of the facets of the law with all of their nodes among those that are
    /// `marked`, or without such facets, of those with one.
    fn parts_of(&self, marked: &[bool]) -> String {
        let with = |least: usize| {
            let count = |facet: &&Facet<D>| {
                facet.nodes.iter().filter(|&&node| marked[node as usize]).count() >= least
            };
            let facets = self.facets_with_law().filter(count);
            Names::all(facets.map(|facet| &self.parts[usize::from(facet.part)].names))
        };
        let names = with(D);
        if names.is_empty() { with(1) } else { names }
    }

    /// Parts of the boundary.
    pub fn parts(&self) -> &[Part<D>] {
        &self.parts
    }

    /// Names of the parts of the boundary that are neither free nor fixed, with their laws.
    pub fn laws(&self) -> Vec<(String, Law)> {
        let parts = self.parts.iter().filter(|part| part.law.may_move());
        parts.map(|part| (part.names.to_string(), part.law)).collect()
    }

    /// Parts of the boundary, whose laws and curves may be changed.
    pub fn parts_mut(&mut self) -> &mut [Part<D>] {
        &mut self.parts
    }

    /// The mesh with this law on all parts that have the paper's.
    #[must_use]
    pub fn with_law(mut self, law: Law) -> Self {
        let parts = self.parts.iter_mut().filter(|part| part.law == Law::SIGNORINI);
        parts.for_each(|part| part.law = law);
        self
    }

    /// Lines to be told of places where the domain touches itself with nodes of both sides.
    pub fn touching(&self) -> &[String] {
        &self.touching
    }

    /// As [`AnyMesh::notes`].
    pub(crate) fn notes(&self) -> Vec<String> {
        let kept = self.touching.iter().chain(&self.moved).cloned();
        self.origin.notes().into_iter().chain(kept).chain(self.straight_edges()).collect()
    }

    /// Place in the space of the file of a point of the domain.
    fn in_space(&self, point: &[f64; D]) -> [f64; 3] {
        let place = std::array::from_fn(|d| point.get(d).copied().unwrap_or_default());
        let [x, y, _] = place;
        if D == 2 { self.origin.plane.in_space([x, y]) } else { place }
    }

    /// Law on a facet: its value is NaN where it is a formula, and the flux of a free part by a formula the mean.
    pub fn law(&self, facet: &Facet<D>) -> Law {
        let law = self.parts[facet.part as usize].law;
        match self.value(facet.part) {
            Some(flux) if law.is_free() => law.with_flux(self.means(facet, flux).iter().sum()),
            _ => law,
        }
    }

    /// Means over a facet of a formula times the hat functions of its nodes.
    fn means(&self, facet: &Facet<D>, formula: &Formula) -> [f64; D] {
        let (corners, mut means) = (self.corners(facet), [0.0; D]);
        for point in facet_points::<D>() {
            let value = point.weight * formula.at(&point.within(corners));
            means
                .iter_mut()
                .zip(point.barycentric)
                .for_each(|(mean, share)| *mean += share * value);
        }
        means
    }

    /// Formula of the value of the law on a part, or of the flux of a free one, if it is no number.
    pub(crate) fn value(&self, part: u16) -> Option<&Formula> {
        self.values.iter().find(|(own, _)| *own == part).map(|(_, value)| value)
    }

    /// Law on a facet for one of its nodes: with the value there, or the mean flux of a free part with the weight of
    /// the hat function of the node.
    pub(crate) fn law_at(&self, facet: &Facet<D>, node: u32) -> Law {
        let law = self.parts[usize::from(facet.part)].law;
        let Some(formula) = self.value(facet.part) else { return law };
        if law.is_free() {
            let of_nodes = facet.nodes.into_iter().zip(self.means(facet, formula));
            let mean: f64 = of_nodes.filter(|(own, _)| *own == node).map(|(_, mean)| mean).sum();
            return law.with_flux(D as f64 * mean);
        }
        law.scaled_at(formula.at(&self.points[node as usize]))
    }

    /// True if the value of a law is a formula.
    pub(crate) fn has_values_by_formulas(&self) -> bool {
        self.values.iter().any(|(part, _)| !self.parts[usize::from(*part)].law.is_free())
    }

    /// Vertices of a cell.
    #[inline]
    pub fn vertices(&self, cell: &[u32; V]) -> [[f64; D]; V] {
        let mut vertices = [[0.0; D]; V];
        for (vertex, &node) in vertices.iter_mut().zip(cell) {
            *vertex = self.points[node as usize];
        }
        vertices
    }

    /// Vertices of a facet.
    pub fn corners(&self, facet: &Facet<D>) -> [[f64; D]; D] {
        facet.nodes.map(|node| self.points[node as usize])
    }

    /// Longest side of the least box around the domain, along the axes.
    pub fn extent(&self) -> f64 {
        longest_side(bounds(&self.points))
    }

    /// True if the domain is (-1/2, 1/2)^D with all of its boundary in contact, the domain of the known solutions.
    pub fn is_unit_box(&self) -> bool {
        const ROUNDING: f64 = 1e-9;
        let is_half = |end: f64| (end.abs() - 0.5).abs() < ROUNDING;
        bounds(&self.points).as_flattened().iter().all(|&end| is_half(end))
            && (self.volume() - 1.0).abs() < ROUNDING
            && self.parts.iter().all(|part| part.law.may_move())
    }

    /// Largest coordinate, without its sign.
    pub fn largest_coordinate(&self) -> f64 {
        self.points.iter().flatten().fold(0.0, |largest, x| x.abs().max(largest))
    }

    /// Length, area or volume of the domain.
    pub fn volume(&self) -> f64 {
        self.cells.iter().map(|cell| volume(self.vertices(cell))).sum()
    }
}
