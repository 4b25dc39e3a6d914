//! Domains with a name, as coarse meshes without a file.

use super::{Condition, Facet, MeshData, Part, PlaneMesh, Round, SpaceMesh};
use super::{uniform_cube, uniform_square};
use crate::discrete::grid::Grid;
use std::f64::consts::TAU;

/// Domain with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuiltIn {
    /// `(-1/2, 1/2)^2`, the paper's domain.
    Square,
    /// `(-1/2, 1/2)^3`.
    Cube,
    /// Unit disc.
    Disc,
    /// `(-1, 1)^2` without its lower right quarter.
    LShape,
    /// Ring between the circles of radius 1/2, `inner`, and 1, `outer`.
    Annulus,
    /// Unit ball.
    Ball,
}

/// Domains with their names.
pub const BUILT_IN: [(&str, BuiltIn); 6] = [
    ("square", BuiltIn::Square),
    ("cube", BuiltIn::Cube),
    ("disc", BuiltIn::Disc),
    ("lshape", BuiltIn::LShape),
    ("annulus", BuiltIn::Annulus),
    ("ball", BuiltIn::Ball),
];

impl BuiltIn {
    /// Domain of this name.
    pub fn named(name: &str) -> Option<Self> {
        BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, domain)| *domain)
    }

    /// Domain in words.
    pub fn description(self) -> &'static str {
        match self {
            Self::Square => "The square (-1/2, 1/2)^2, the domain of the paper",
            Self::Cube => "The cube (-1/2, 1/2)^3",
            Self::Disc => "The unit disc, whose boundary is `rim`",
            Self::LShape => "The square (-1, 1)^2 without its lower right quarter",
            Self::Annulus => "The ring between the circles of radius 1/2, `inner`, and 1, `outer`",
            Self::Ball => "The unit ball, whose boundary is `surface`",
        }
    }

    /// Coarsest mesh of a domain in the plane; none for one in space.
    pub fn plane(self) -> Option<PlaneMesh> {
        let data = match self {
            Self::Square => return Some(uniform_square(Grid::new(2).expect("two cells"))),
            Self::Disc => disc(),
            Self::LShape => lshape(),
            Self::Annulus => annulus(),
            Self::Cube | Self::Ball => return None,
        };
        Some(data.mesh().expect("a built-in mesh passes the checks"))
    }

    /// Coarsest mesh of a domain in space; none for one in the plane.
    pub fn space(self) -> Option<SpaceMesh> {
        match self {
            Self::Cube => Some(uniform_cube(2)),
            Self::Ball => Some(ball().mesh().expect("a built-in mesh passes the checks")),
            Self::Square | Self::Disc | Self::LShape | Self::Annulus => None,
        }
    }
}

/// Returns points at equal angles on the circle of this radius, the first at an angle of `turn` steps.
fn circle(points: u32, radius: f64, turn: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..points).map(move |k| {
        let (sine, cosine) = libm::sincos(TAU * (f64::from(k) + turn) / f64::from(points));
        [radius * cosine, radius * sine]
    })
}

fn round_part<const D: usize>(name: &str, radius: f64) -> Part<D> {
    let curve = Some(Round::sphere([0.0; D], radius));
    Part { names: name.into(), condition: Condition::Contact, curve }
}

/// Six triangles around the centre.
fn disc() -> MeshData<2, 3> {
    let sector = |k: u32| [0, 1 + k, 1 + (k + 1) % 6];
    MeshData {
        points: std::iter::once([0.0; 2]).chain(circle(6, 1.0, 0.0)).collect(),
        cells: (0..6).map(sector).collect(),
        facets: (0..6).map(|k| Facet { nodes: [1 + k, 1 + (k + 1) % 6], part: 0 }).collect(),
        parts: vec![round_part("rim", 1.0)],
        ..MeshData::default()
    }
}

/// Three unit squares of two triangles each.
fn lshape() -> MeshData<2, 3> {
    MeshData {
        points: vec![
            [-1.0, -1.0],
            [0.0, -1.0],
            [-1.0, 0.0],
            [0.0, 0.0],
            [1.0, 0.0],
            [-1.0, 1.0],
            [0.0, 1.0],
            [1.0, 1.0],
        ],
        cells: vec![[0, 1, 3], [0, 3, 2], [2, 3, 6], [2, 6, 5], [3, 4, 7], [3, 7, 6]],
        ..MeshData::default()
    }
}

/// Twelve points on each circle, those of the outer one half a step further.
fn annulus() -> MeshData<2, 3> {
    let (mut cells, mut facets) = (Vec::new(), Vec::new());
    for k in 0..12 {
        let next = (k + 1) % 12;
        let ([inner, inner_next], [outer, outer_next]) = ([k, next], [12 + k, 12 + next]);
        cells.extend([[inner, outer, inner_next], [inner_next, outer, outer_next]]);
        facets.extend([
            Facet { nodes: [inner, inner_next], part: 0 },
            Facet { nodes: [outer, outer_next], part: 1 },
        ]);
    }
    MeshData {
        points: circle(12, 0.5, 0.0).chain(circle(12, 1.0, 0.5)).collect(),
        cells,
        facets,
        parts: vec![round_part("inner", 0.5), round_part("outer", 1.0)],
        ..MeshData::default()
    }
}

/// Twenty tetrahedra between the centre and the faces of an icosahedron.
fn ball() -> MeshData<3, 4> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let scale = 1.0 / (1.0 + golden * golden).sqrt();
    let (short, long) = (scale, scale * golden);
    let mut points = vec![[0.0; 3]];
    for axis in 0..3 {
        for (s, l) in [(short, long), (-short, long), (short, -long), (-short, -long)] {
            let mut point = [0.0; 3];
            (point[axis], point[(axis + 1) % 3]) = (s, l);
            points.push(point);
        }
    }
    let distance = |a: u32, b: u32| -> f64 {
        let [a, b] = [points[a as usize], points[b as usize]];
        (0..3).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum()
    };
    // Three corners at the least distance from each other, twice `short`, are a face.
    let is_edge = |a: u32, b: u32| distance(a, b) < 1.01 * 4.0 * short * short;
    let (mut cells, mut facets) = (Vec::new(), Vec::new());
    for a in 1..=12 {
        for b in a + 1..=12 {
            for c in b + 1..=12 {
                if is_edge(a, b) && is_edge(b, c) && is_edge(a, c) {
                    let [p, q, r] = [a, b, c].map(|node| points[node as usize]);
                    let turns = p[0] * (q[1] * r[2] - q[2] * r[1])
                        + p[1] * (q[2] * r[0] - q[0] * r[2])
                        + p[2] * (q[0] * r[1] - q[1] * r[0]);
                    cells.push(if turns > 0.0 { [0, a, b, c] } else { [0, a, c, b] });
                    facets.push(Facet { nodes: [a, b, c], part: 0 });
                }
            }
        }
    }
    MeshData {
        points,
        cells,
        facets,
        parts: vec![round_part("surface", 1.0)],
        ..MeshData::default()
    }
}
