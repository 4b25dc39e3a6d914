//! f and its particular solution psi, with -Lap psi = f, in closed form.
//!
//! Of constant pieces: [`curves`] finds the curves across which f jumps, [`jumps`] has f with psi, whose gradient is a
//! sum over the jumps ([`potential`]) and whose values are in [`psi`]; small closed shapes are seen from their own
//! middles ([`groups`]). Of formulas: [`expansion`] multiplies them out to a [`smooth`] function.
//!
//! Borders between [`regions`] of a mesh on which f differs are the polygons that the edges of the mesh are. No part of
//! a mesh lies inside of it, so that no circle can be named for a border.

pub(super) mod changes;
pub(super) mod closed_edges;
pub(super) mod curves;
pub(super) mod expansion;
pub(super) mod far_field;
pub(super) mod groups;
pub(super) mod jumps;
pub(super) mod potential;
pub(super) mod psi;
pub(super) mod psi_sizes;
pub(super) mod quadratic;
pub(super) mod smooth;

use crate::mesh::PlaneMesh;
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::domain::{directions, ray_hits};
use crate::spectral::geometry::frame::Frame;
use crate::spectral::geometry::outline::{MeshOutline, OutlineEdge};
use crate::spectral::geometry::side::PlaneSide;
use smooth::SmoothSource;
use std::collections::BTreeMap;

/// Right-hand side of a domain in the plane.
#[derive(Clone, Debug)]
pub(crate) enum PlaneSource {
    /// Constant pieces on regions.
    Pieces(Regions),
    /// A polynomial with waves, in the coordinates of the domain's frame.
    Smooth(SmoothSource),
}

/// Constant pieces on regions with straight borders, and circular ones along the boundary of the domain.
#[derive(Clone, Debug)]
pub(crate) struct Regions {
    /// Borders of regions on which f differs, with each other and along the boundary of the domain, each once; none if
    /// f is the same on all.
    pub borders: Vec<RegionBorder>,
    /// f on the regions.
    pub pieces: Vec<Source>,
}

/// Border of regions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RegionBorder {
    /// The border: its condition and part are not read.
    pub side: PlaneSide,
    /// Regions on the left and on the right; none outside of the domain.
    pub regions: [Option<usize>; 2],
}

impl RegionBorder {
    /// True if it lies inside of the domain.
    pub(crate) fn is_inside(&self) -> bool {
        self.regions.iter().all(Option::is_some)
    }
}

impl Regions {
    /// The same pieces on all of a domain.
    pub(crate) fn all(f: Source) -> Self {
        Self { borders: Vec::new(), pieces: vec![f] }
    }

    /// f at a point of the domain.
    pub(crate) fn at(&self, z: Complex) -> f64 {
        self.pieces[self.region(z)].at(z.coordinates())
    }

    /// Region at a point of the domain: that on this side of the first border in a direction.
    fn region(&self, z: Complex) -> usize {
        let mut found = 0;
        for direction in directions() {
            let hits = ray_hits(self.borders.iter().map(|border| &border.side), z, direction);
            let ahead = hits.into_iter().filter(|hit| hit.distance > 0.0);
            let first = ahead.min_by(|one, other| one.distance.total_cmp(&other.distance));
            let Some(hit) = first else { continue };
            let [left, right] = self.borders[hit.side].regions;
            // Between an arc of the boundary and its chord the domain is on the other side.
            let here = if hit.is_left { left.or(right) } else { right.or(left) };
            found = here.unwrap_or(found);
            if !hit.is_unsure {
                break;
            }
        }
        found
    }
}

/// Returns f with these pieces on the regions of a mesh, all in the coordinates of a frame.
///
/// # Errors
/// [`PlaneError::Domain`] if a border bends by too little for a corner.
pub(crate) fn regions(
    mesh: &PlaneMesh,
    pieces: Vec<Source>,
    frame: Frame,
) -> Result<Regions, PlaneError> {
    let mut in_use = mesh.regions().iter().map(|&region| &pieces[usize::from(region)]);
    let one = in_use.next().expect("a mesh has a cell");
    if in_use.all(|f| f == one) {
        return Ok(Regions::all(one.clone()));
    }
    // Regions with the same f are one.
    let first = pieces.iter().map(|f| pieces.iter().position(|other| other == f));
    let first: Vec<usize> = first.map(|first| first.expect("f is itself")).collect();
    let mut left: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for (&[a, b, c], &region) in mesh.cells().iter().zip(mesh.regions()) {
        left.extend([[a, b], [b, c], [c, a]].map(|edge| (edge, first[usize::from(region)])));
    }
    let beside = |[a, b]: [u32; 2]| [[a, b], [b, a]].map(|edge| left.get(&edge).copied());
    let is_border = |&&[a, b]: &&[u32; 2]| {
        let [one, other] = beside([a, b]);
        one != other && (a < b || other.is_none())
    };
    let edges: Vec<[u32; 2]> = left.keys().filter(is_border).copied().collect();
    let mut borders = Vec::new();
    for nodes in paths(&edges) {
        let regions = beside([nodes[0], nodes[1]]);
        let points = nodes.iter().map(|&node| mesh.points()[node as usize]);
        let points: Vec<_> = points.map(|[x, y]| Complex::new(x, y)).collect();
        let edge = OutlineEdge { circle: None, law: Law::FREE, part: 0 };
        let edges = vec![edge; points.len() - 1];
        let sides = MeshOutline::new(points, edges, frame).sides()?;
        borders.extend(sides.into_iter().map(|side| RegionBorder { side, regions }));
    }
    Ok(Regions { borders, pieces })
}

/// Paths of edges, each edge once, between nodes in which other than two edges meet; closed paths begin and end in one
/// node.
fn paths(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut beside: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for &[a, b] in edges {
        beside.entry(a).or_default().push(b);
        beside.entry(b).or_default().push(a);
    }
    let (through, ends): (Vec<u32>, Vec<u32>) =
        beside.keys().copied().partition(|node| beside[node].len() == 2);
    let mut paths = Vec::new();
    for &start in ends.iter().chain(&through) {
        while let Some(mut node) = step(&mut beside, start) {
            let mut path = vec![start, node];
            while node != start
                && through.binary_search(&node).is_ok()
                && let Some(next) = step(&mut beside, node)
            {
                path.push(next);
                node = next;
            }
            paths.push(path);
        }
    }
    paths
}

/// Goes from a node along an edge, which it takes away from both ends.
fn step(beside: &mut BTreeMap<u32, Vec<u32>>, node: u32) -> Option<u32> {
    let next = beside.get_mut(&node)?.pop()?;
    beside.entry(next).or_default().retain(|&other| other != node);
    Some(next)
}
