//! Domains with a name, as coarse meshes without a file, and uniform meshes of the square and the cube, whose nodes are
//! in natural order: x runs fastest.

use super::{Facet, MeshData, Part, PlaneMesh, Round, SpaceMesh};
use crate::discrete::grid::Grid;
use crate::problem::law::Law;
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
    Part { names: name.into(), law: Law::SIGNORINI, curve }
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

/// The paper's triangulation of the square: each cell is cut by its rising diagonal.
pub fn uniform_square(grid: Grid) -> PlaneMesh {
    let n = grid.cells();
    // The quotient is rounded once, so that lines shared by nested grids coincide to the bit.
    let lines: Vec<_> = (0..=n).map(|i| i as f64 / n as f64 - 0.5).collect();
    lattice_mesh(&lines)
}

/// The paper's triangulation of the square, with its sides as parts: `bottom`, `right`, `top` and `left`.
///
/// # Panics
/// If `n` is zero.
pub(crate) fn square_with_sides(n: usize) -> PlaneMesh {
    let mut mesh = uniform_square(Grid::new(n).expect("some cells"));
    let sides = ["bottom", "right", "top", "left"];
    mesh.parts = sides.map(|side| Part { names: side.into(), ..mesh.parts[0].clone() }).to_vec();
    for facet in &mut mesh.facets {
        let [[x0, y0], [x1, y1]] = facet.nodes.map(|node| mesh.points[node as usize]);
        let is_on = [y0 + y1 == -1.0, x0 + x1 == 1.0, y0 + y1 == 1.0, x0 + x1 == -1.0];
        let side = is_on.iter().position(|is_on| *is_on).expect("an edge of the boundary");
        facet.part = side as u16;
    }
    mesh
}

/// Triangulation of the square between these lines, the same along both axes, ascending; each cell is cut by its rising
/// diagonal.
///
/// # Panics
/// If there are less than two lines, or they do not ascend.
pub fn lattice_mesh(lines: &[f64]) -> PlaneMesh {
    let (n, side) = (lines.len() - 1, lines.len());
    let points = lines.iter().flat_map(|&y| lines.iter().map(move |&x| [x, y])).collect();
    let mut cells = Vec::with_capacity(2 * n * n);
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let [ll, lr, ul, ur] =
            [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| (j * side + i) as u32);
        cells.extend([[ll, lr, ur], [ll, ur, ul]]);
    }
    MeshData { points, cells, ..MeshData::default() }.lattice()
}

/// Kuhn's triangulation of the unit cube with `n` cells per side: six tetrahedra in each cell, along the paths from its
/// lowest to its highest corner (H. W. Kuhn, IBM J. Res. Dev. 4, 1960). Its stiffness matrix is that of the seven-point
/// stencil times 1 / n, but along the edges of the cube, where neighbours are coupled by a third or a sixth of 1 / n,
/// not by a quarter.
///
/// # Panics
/// If `n` is zero.
pub fn uniform_cube(n: usize) -> SpaceMesh {
    const AXES: [[usize; 3]; 6] =
        [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    let side = n + 1;
    let place = |node: usize| [node % side, node / side % side, node / (side * side)];
    let points =
        (0..side.pow(3)).map(|node| place(node).map(|i| i as f64 / n as f64 - 0.5)).collect();
    let mut cells = Vec::with_capacity(6 * n.pow(3));
    for node in (0..side.pow(3)).filter(|&node| place(node).iter().all(|&i| i < n)) {
        for axes in AXES {
            // In the order of the path, from which refinement makes cells of the same kind; the checks turn every other
            // one.
            let mut cell = [node as u32; 4];
            for (step, &axis) in axes.iter().enumerate() {
                cell[step + 1] = cell[step] + side.pow(axis as u32) as u32;
            }
            cells.push(cell);
        }
    }
    MeshData { points, cells, ..MeshData::default() }.lattice()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::network::Network;
    use crate::mesh::{assemble, refined};

    #[test]
    fn the_square_has_the_rows_of_the_five_point_matrix() {
        let grid = Grid::new(8).unwrap();
        let (general, special) =
            (assemble(&uniform_square(grid)), Network::of_square(grid, Law::SIGNORINI));
        for node in 0..grid.nodes() {
            let [a, b] = [general.row(node), special.row(node)];
            assert_eq!((a.others, a.weights), (b.others, b.weights));
        }
        let measures = general.contact().iter().map(|contact| contact.measure);
        assert!(measures.zip(0..).all(|(measure, _)| measure == grid.h()));
        // The diagonals end at two corners, which have two triangles each.
        assert!((general.masses()[0] * 64.0 * 3.0 - 1.0).abs() < 1e-15);
        assert!((general.masses()[8] * 64.0 * 6.0 - 1.0).abs() < 1e-15);
    }

    /// Number of nodes in the order of a coordinate, of the lattice with n cells per side.
    fn lattice_number(point: [f64; 3], n: usize) -> usize {
        let [i, j, k] = point.map(|x| ((x + 0.5) * n as f64).round() as usize);
        i + (n + 1) * (j + (n + 1) * k)
    }

    /// Part of the coupling inside that neighbours along an axis have, by their places along the other two.
    fn share(one: usize, two: usize, n: usize) -> f64 {
        match [one, two].map(|i| i == 0 || i == n) {
            [false, false] => 1.0,
            // An edge of the cube, which two paths of a cell follow, or one.
            [true, true] if one == two => 1.0 / 3.0,
            [true, true] => 1.0 / 6.0,
            _ => 0.5,
        }
    }

    #[test]
    fn refinements_of_the_cube_have_the_rows_of_the_seven_point_matrix() {
        for (coarsest, times) in [(1, 2), (2, 1), (3, 1), (4, 0), (5, 0)] {
            let n = coarsest << times;
            let (levels, mesh) = refined(&uniform_cube(coarsest), times).unwrap();
            let network = &levels[times].network;
            let numbers: Vec<_> = mesh.points().iter().map(|&p| lattice_number(p, n)).collect();
            let h = 1.0 / n as f64;
            for node in 0..network.nodes() {
                let at = |number: usize| {
                    [number % (n + 1), number / (n + 1) % (n + 1), number / (n + 1).pow(2)]
                };
                let here = at(numbers[node]);
                let row = network.row(node);
                let mut expected = 0;
                for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, n)]) {
                    expected += usize::from(here[axis] != side);
                }
                assert_eq!(row.others.len(), expected, "{here:?}");
                for (&other, weight) in row.others.iter().zip(row.weights) {
                    let there = at(numbers[other as usize]);
                    let axis = (0..3).find(|&d| here[d] != there[d]).unwrap();
                    let [one, two] = [here[(axis + 1) % 3], here[(axis + 2) % 3]];
                    let across = share(one, two, n);
                    assert!((weight - h * across).abs() < 1e-15, "{here:?} {there:?}");
                }
            }
            assert_eq!(network.contact().len(), (n + 1).pow(3) - (n - 1).pow(3));
            assert!((network.masses().iter().sum::<f64>() - 1.0).abs() < 1e-14);
            assert!((network.laws().measure - 6.0).abs() < 1e-13);
        }
    }
}
