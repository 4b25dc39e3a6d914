//! A mesh of either dimension.

use super::refine;
use super::source::k_on_regions;
use super::{
    BUILT_IN, BuiltIn, Mesh, MeshError, Names, Part, PlaneMesh, Round, SpaceMesh, measure,
};
use crate::problem::error::SCALE;
use crate::problem::formula::Formula;
use crate::problem::law::Law;
use crate::problem::text::Written;
use std::any::Any;
use std::collections::BTreeMap;

/// Mesh in the plane or in space.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyMesh {
    /// In the plane.
    Plane(PlaneMesh),
    /// In space.
    Space(SpaceMesh),
}

/// Part of the boundary with its share of each node.
pub(crate) struct PartShares {
    /// Names.
    pub name: String,
    /// Law.
    pub law: Law,
    /// Law in words.
    pub in_words: String,
    /// Length or area of the part at its nodes, with the law there, of a free part with the mean flux.
    pub nodes: BTreeMap<usize, (f64, Law)>,
}

/// Value of an expression of the mesh, the same in both dimensions.
macro_rules! either {
    ($any:expr, $mesh:ident => $value:expr) => {
        match $any {
            Self::Plane($mesh) => $value,
            Self::Space($mesh) => $value,
        }
    };
}

impl From<PlaneMesh> for AnyMesh {
    fn from(mesh: PlaneMesh) -> Self {
        Self::Plane(mesh)
    }
}

impl From<SpaceMesh> for AnyMesh {
    fn from(mesh: SpaceMesh) -> Self {
        Self::Space(mesh)
    }
}

impl AnyMesh {
    /// Coarsest mesh of a built-in domain, or `None` if there is no domain of this name.
    pub fn built_in(name: &str) -> Option<Self> {
        let domain = BuiltIn::named(name)?;
        domain.plane().map(Self::Plane).or_else(|| domain.space().map(Self::Space))
    }

    /// Names of the built-in domains.
    pub fn built_in_names() -> Vec<&'static str> {
        BUILT_IN.iter().map(|(name, _)| *name).collect()
    }

    /// The mesh, if it has this dimension.
    pub(crate) fn of_dimension<const D: usize, const V: usize>(&self) -> Option<&Mesh<D, V>> {
        let mesh: &dyn Any = match self {
            Self::Plane(mesh) => mesh,
            Self::Space(mesh) => mesh,
        };
        mesh.downcast_ref()
    }

    /// Number of dimensions, 2 or 3.
    pub fn dimension(&self) -> u8 {
        match self {
            Self::Plane(_) => 2,
            Self::Space(_) => 3,
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        either!(self, mesh => mesh.points.len())
    }

    /// Number of triangles or tetrahedra.
    pub fn cells(&self) -> usize {
        either!(self, mesh => mesh.cells.len())
    }

    /// Names of the parts of the boundary, those of one part together.
    pub fn part_names(&self) -> impl Iterator<Item = &String> {
        let (plane, space) = match self {
            Self::Plane(mesh) => (&mesh.parts[..], &[][..]),
            Self::Space(mesh) => (&[][..], &mesh.parts[..]),
        };
        plane
            .iter()
            .flat_map(|part| part.names.iter())
            .chain(space.iter().flat_map(|part| part.names.iter()))
    }

    /// Names of the regions.
    pub fn region_names(&self) -> &[Names] {
        either!(self, mesh => &mesh.region_names)
    }

    /// Coordinates of the nodes, one node after the other.
    pub(crate) fn coordinates(&self) -> &[f64] {
        either!(self, mesh => mesh.points.as_flattened())
    }

    /// Places of the nodes in the space of the mesh's file.
    pub(crate) fn points_in_space(&self) -> Vec<[f64; 3]> {
        either!(self, mesh => mesh.points.iter().map(|point| mesh.in_space(point)).collect())
    }

    /// Numbers of the vertices of each cell in the positive sense, one cell after the other.
    pub(crate) fn positive_cells(&self) -> Vec<u32> {
        either!(self, mesh => mesh.positive_cells().flatten().collect())
    }

    /// Position of the region of each cell in [`AnyMesh::region_names`].
    pub(crate) fn regions(&self) -> &[u16] {
        either!(self, mesh => &mesh.regions)
    }

    /// Length of the longest edge.
    pub fn width(&self) -> f64 {
        either!(self, mesh => mesh.width())
    }

    /// The mesh, if it lies in the plane.
    pub fn plane(&self) -> Option<&PlaneMesh> {
        match self {
            Self::Plane(mesh) => Some(mesh),
            Self::Space(_) => None,
        }
    }

    /// Number of nodes after some refinements, about: each multiplies the number of cells, and in the end of nodes, by
    /// 4 or 8.
    pub fn nodes_after(&self, times: usize) -> f64 {
        let factor = if self.dimension() == 2 { 4f64 } else { 8.0 };
        let nodes_per_cell = if self.dimension() == 2 { 0.5 } else { 1.0 / 6.0 };
        let cells = self.cells() as f64 * factor.powi(times as i32);
        (nodes_per_cell * cells).max(self.nodes() as f64)
    }

    /// True if refinement puts new nodes on a curve, so that the domain changes with the mesh.
    pub fn is_curved(&self) -> bool {
        either!(self, mesh => mesh.is_curved())
    }

    /// Mesh after some uniform refinements.
    ///
    /// # Errors
    /// As [`refine`].
    pub fn refined(&self, times: usize) -> Result<Self, MeshError> {
        let mut mesh = self.clone();
        for _ in 0..times {
            mesh = match mesh {
                Self::Plane(mesh) => Self::Plane(refine(&mesh)?.mesh),
                Self::Space(mesh) => Self::Space(refine(&mesh)?.mesh),
            };
        }
        Ok(mesh)
    }

    /// Longest side of the least box around the domain, along the axes.
    pub fn extent(&self) -> f64 {
        either!(self, mesh => mesh.extent())
    }

    /// Returns, in a line each, what a user has to know of the mesh: what was read otherwise than it stands in its
    /// file, and where the domain touches itself.
    pub fn notes(&self) -> Vec<String> {
        either!(self, mesh => mesh.notes())
    }

    /// Names of the parts of the boundary on which nodes lie, as [`Mesh::parts_of`] has them; none if the boundary has
    /// one part.
    pub(crate) fn parts_of(&self, marked: &[bool]) -> Option<String> {
        either!(self, mesh => (mesh.parts.len() > 1).then(|| mesh.parts_of(marked)))
    }

    /// For each part of the boundary its names, its law with that in words, and its nodes with their shares of its
    /// length or area.
    pub(crate) fn shares(&self) -> Vec<PartShares> {
        either!(self, mesh => mesh.shares())
    }

    /// The mesh with this law on all parts that have the paper's.
    #[must_use]
    pub fn with_law(self, law: Law) -> Self {
        either!(self, mesh => mesh.with_law(law).into())
    }

    /// Sets the law on the facets of this name.
    ///
    /// # Errors
    /// A sentence if no facets of the boundary have this name, or some have another law already.
    pub fn set_law(&mut self, name: &str, law: Law) -> Result<(), String> {
        either!(self, mesh => mesh.set_law(name, law))
    }

    /// Sets the value of the law on the facets of this name, or the flux of a free part, to a formula in the
    /// coordinates.
    ///
    /// # Errors
    /// A sentence if no facets of the boundary have this name, or the text is no formula.
    pub fn set_value(&mut self, name: &str, formula: &str) -> Result<(), String> {
        either!(self, mesh => {
            let parts = mesh.parts_named(name, "no law holds")?;
            mesh.set_values(parts, formula)
        })
    }

    /// Sets the law on the parts of the boundary with none of these names, with the formula of its value, if it has
    /// one.
    ///
    /// # Errors
    /// A sentence if the text is no formula.
    pub(crate) fn set_others(
        &mut self,
        named: &[String],
        law: Law,
        formula: Option<&Formula>,
    ) -> Result<(), String> {
        either!(self, mesh => {
            let parts = mesh.parts.iter().enumerate();
            let others = parts.filter(|(_, part)| !named.iter().any(|name| part.names.contains(name)));
            let others: Vec<_> = others.map(|(number, _)| number).collect();
            others.iter().for_each(|&part| mesh.parts[part].law = law);
            formula.map_or(Ok(()), |formula| mesh.set_values(others, &formula.to_string()))
        })
    }

    /// Sets the factor k of each region, where the flux is `k grad v`: a number of all of them, or text as that of f.
    ///
    /// # Errors
    /// A sentence if the text does not say a positive number of each region.
    pub fn set_k(&mut self, text: &str) -> Result<(), String> {
        either!(self, mesh => mesh.k = k_on_regions(text, &mesh.region_names)?);
        Ok(())
    }

    /// Sets the factor c of the term c v of the equation.
    ///
    /// # Errors
    /// A sentence unless the number is 0, or positive and of a size to compute with.
    pub fn set_reaction(&mut self, c: f64) -> Result<(), String> {
        if c != 0.0 && !SCALE.contains(&c) {
            let [least, most] = [SCALE.start, SCALE.end].map(Written);
            return Err(format!("must be 0, or a positive number from {least} to {most}"));
        }
        either!(self, mesh => mesh.reaction = c);
        Ok(())
    }

    /// Puts a part of the boundary, and its nodes, on a circle, sphere or cylinder, given by its numbers: the centre
    /// and the radius, or a point, a direction and the radius.
    ///
    /// # Errors
    /// A sentence if no facets of the boundary have this name, some are on another curve already, the numbers are no
    /// curve, or a node is farther off it than the digits of a file explain.
    pub fn set_curve(&mut self, part: &str, numbers: &[f64]) -> Result<(), String> {
        let refused = || {
            let numbers: Vec<_> = numbers.iter().map(f64::to_string).collect();
            format!(
                "`{}`: a circle takes x, y, radius; a sphere x, y, z, radius; a cylinder a point, a direction and a \
                 radius: x, y, z, dx, dy, dz, radius; all finite, the radius above 0",
                numbers.join(",")
            )
        };
        let is_radius = numbers.last().is_some_and(|&radius| radius > 0.0);
        if !is_radius || !numbers.iter().all(|number| number.is_finite()) {
            return Err(refused());
        }
        match self {
            Self::Plane(mesh) => {
                let &[x, y, radius] = numbers else { return Err(refused()) };
                mesh.set_curve(part, Round::sphere([x, y], radius))
            }
            Self::Space(mesh) => match *numbers {
                [x, y, z, radius] => mesh.set_curve(part, Round::sphere([x, y, z], radius)),
                [x, y, z, dx, dy, dz, radius] => {
                    let largest = dx.abs().max(dy.abs()).max(dz.abs());
                    if largest == 0.0 {
                        return Err(refused());
                    }
                    // The squares of the numbers themselves may be zero or infinite.
                    let scaled = [dx, dy, dz].map(|d| d / largest);
                    let length = scaled.iter().map(|d| d * d).sum::<f64>().sqrt();
                    let axis = scaled.map(|d| d / length);
                    mesh.set_curve(part, Round { centre: [x, y, z], axis, radius })
                }
                _ => Err(refused()),
            },
        }
    }
}

impl<const D: usize, const V: usize> Mesh<D, V> {
    /// Positions of the parts that have this name; `where_inside` says why nothing inside the domain is a part.
    pub(super) fn parts_named(&self, name: &str, where_inside: &str) -> Result<Vec<usize>, String> {
        let has_name = |&part: &usize| self.parts[part].names.contains(name);
        let found: Vec<_> = (0..self.parts.len()).filter(has_name).collect();
        if !found.is_empty() {
            return Ok(found);
        }
        let parts = Names::all(self.parts.iter().map(|part| &part.names));
        let is_inside = self.inside.iter().any(|inside| inside == name);
        Err(match is_inside {
            true => format!(
                "`{name}` lies inside the domain, where {where_inside}; the parts of the boundary are {parts}"
            ),
            false => format!("the mesh has no part `{name}`; its parts are {parts}"),
        })
    }

    fn set_law(&mut self, name: &str, law: Law) -> Result<(), String> {
        for part in self.parts_named(name, "no law holds")? {
            let part = &mut self.parts[part];
            if part.law != Law::SIGNORINI && part.law != law {
                let names = &part.names;
                return Err(format!(
                    "facets named {names} would have two laws, {} and {law}; choose one of the two",
                    part.law
                ));
            }
            part.law = law;
        }
        Ok(())
    }

    /// As [`AnyMesh::shares`].
    fn shares(&self) -> Vec<PartShares> {
        let of_part = |(part, number): (&Part<D>, u16)| PartShares {
            name: part.names.to_string(),
            law: part.law,
            in_words: part.law.in_words(self.value(number)),
            nodes: BTreeMap::new(),
        };
        let mut shares: Vec<_> = self.parts.iter().zip(0..).map(of_part).collect();
        for facet in &self.facets {
            let share = measure(self.corners(facet)) / D as f64;
            for node in facet.nodes {
                let law = self.law_at(facet, node);
                let of_node = shares[usize::from(facet.part)].nodes.entry(node as usize);
                let (sum, own) = of_node.or_insert((0.0, law));
                if law.is_free() && *own != law {
                    *own = law.with_flux((*sum * own.lo() + share * law.lo()) / (*sum + share));
                }
                *sum += share;
            }
        }
        shares
    }

    /// Sets the values of the laws on these parts to a formula.
    fn set_values(&mut self, parts: Vec<usize>, formula: &str) -> Result<(), String> {
        let value = Formula::in_law(formula, D)?;
        for part in parts {
            self.parts[part].law = self.parts[part].law.by_formula();
            self.values.retain(|(own, _)| usize::from(*own) != part);
            self.values.push((part as u16, value.clone()));
        }
        Ok(())
    }

    /// Length of the longest edge.
    pub fn width(&self) -> f64 {
        self.cells.iter().fold(0.0, |most, cell| super::size(self.vertices(cell)).max(most))
    }
}
