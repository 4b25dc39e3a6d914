//! Tests of curves of boundaries: rims between two parts, and nodes beside their curve.

use crate::mesh::{AnyMesh, Facet, MeshData, Names, Part, SpaceMesh};
use crate::problem::law::Law;
use std::f64::consts::{FRAC_PI_4, FRAC_PI_6, PI, TAU};

/// Radius of the rim of the caps of height 1/2 of the unit ball.
const RIM: f64 = 0.8660254037844386;

/// Rim nodes at this height, behind a node of the axis.
fn ring(radius: f64, z: f64) -> Vec<[f64; 3]> {
    let rim = (0..6).map(|k| {
        let (sine, cosine) = libm::sincos(TAU * f64::from(k) / 6.0);
        [radius * cosine, radius * sine, z]
    });
    std::iter::once([0.0, 0.0, z]).chain(rim).collect()
}

fn named(name: &str) -> Part<3> {
    Part { names: Names::from(name), law: Law::SIGNORINI, curve: None }
}

/// Facets between a pole and the rim, whose nodes are 1 to 6.
fn fan(pole: u32, part: u16) -> impl Iterator<Item = Facet<3>> {
    (0..6).map(move |k| Facet { nodes: [pole, 1 + k, 1 + (k + 1) % 6], part })
}

/// Cells between two poles and the rim.
fn cells(poles: [u32; 2]) -> impl Iterator<Item = [u32; 4]> {
    (0..6).map(move |k| [poles[0], poles[1], 1 + k, 1 + (k + 1) % 6])
}

/// Cap of the unit ball on a plane or, if a second pole is given, on another surface.
fn on_rim(radius: f64, z: f64, top: f64, bottom: Option<f64>) -> SpaceMesh {
    let mut points = ring(radius, z);
    points.push([0.0, 0.0, top]);
    let mut all: Vec<_> = cells([0, 7]).collect();
    if let Some(bottom) = bottom {
        points.push([0.0, 0.0, bottom]);
        all.extend(cells([8, 0]));
    }
    let facets = fan(7, 0).chain(fan(if bottom.is_some() { 8 } else { 0 }, 1)).collect();
    let parts = vec![named("top"), named("bottom")];
    MeshData { points, cells: all, facets, parts, ..MeshData::default() }.mesh().unwrap()
}

/// Checks that the volume of refinements goes to this one, by a quarter of the error each time.
fn fills(mut mesh: SpaceMesh, volume: f64) {
    let mut errors = Vec::new();
    for _ in 0..4 {
        mesh = crate::mesh::refine(&mesh).unwrap().mesh;
        errors.push((mesh.volume() - volume).abs());
    }
    assert!(errors[3] < 0.01 * volume && errors[3] < 0.3 * errors[2], "{errors:?} {volume}");
}

fn curved(mesh: SpaceMesh, curves: &[(&str, &[f64])]) -> SpaceMesh {
    let mut mesh = AnyMesh::from(mesh);
    curves.iter().for_each(|(part, curve)| mesh.set_curve(part, curve).unwrap());
    assert_eq!(mesh.notes(), [""; 0]);
    let AnyMesh::Space(mesh) = mesh else { panic!("a mesh in space") };
    mesh
}

const CAP: f64 = PI * 0.25 * 2.5 / 3.0;

#[test]
fn the_rim_of_a_cap_stays_in_the_plane_of_its_base() {
    let cap = curved(on_rim(RIM, 0.5, 1.0, None), &[("top", &[0.0, 0.0, 0.0, 1.0])]);
    let fine = crate::mesh::refine(&crate::mesh::refine(&cap).unwrap().mesh).unwrap().mesh;
    assert!(fine.points().iter().all(|point| point[2] > 0.5 - 1e-12));
    fills(cap, CAP);
}

#[test]
fn the_rim_between_two_spheres_lies_on_both() {
    let lens = on_rim(RIM, 0.0, 0.5, Some(-0.5));
    let curves: [(&str, &[f64]); 2] =
        [("top", &[0.0, 0.0, -0.5, 1.0]), ("bottom", &[0.0, 0.0, 0.5, 1.0])];
    fills(curved(lens, &curves), 2.0 * CAP);
}

#[test]
fn a_hemisphere_on_a_cylinder_keeps_the_circle_between_them() {
    let mut points = ring(1.0, 0.0);
    points.push([0.0, 0.0, 1.0]);
    points.extend(ring(1.0, -1.0));
    let mut all: Vec<_> = cells([0, 7]).collect();
    let mut facets: Vec<_> = fan(7, 0).collect();
    for k in 0..6 {
        let mut base = [0, 1 + k, 1 + (k + 1) % 6];
        base.sort_unstable();
        let ([i, j, l], below) = (base, base.map(|node| node + 8));
        all.extend([
            [i, j, l, below[2]],
            [i, j, below[1], below[2]],
            [i, below[0], below[1], below[2]],
        ]);
        facets.extend([
            Facet { nodes: [j, l, below[2]], part: 1 },
            Facet { nodes: [j, below[1], below[2]], part: 1 },
        ]);
    }
    let parts = vec![named("top"), named("side")];
    let mesh = MeshData { points, cells: all, facets, parts, ..MeshData::default() };
    let side: &[f64] = &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0];
    let curves: [(&str, &[f64]); 2] = [("top", &[0.0, 0.0, 0.0, 1.0]), ("side", side)];
    fills(curved(mesh.mesh().unwrap(), &curves), 4.0 * FRAC_PI_6 + PI);
}

#[test]
fn what_lies_beyond_a_cap_is_added_in_the_plane_of_its_base() {
    use crate::mesh::{Sides, curve_gains, refine};
    use crate::problem::source::Source;
    let cap = curved(on_rim(RIM, 0.5, 1.0, None), &[("top", &[0.0, 0.0, 0.0, 1.0])]);
    let mesh = refine(&refine(&cap).unwrap().mesh).unwrap().mesh;
    let gains = curve_gains(&mesh, &Sides::new(&mesh), &Source::<3>::constant(1.0));
    let volume = mesh.volume() + gains.iter().map(|gain| gain.integral).sum::<f64>();
    assert!((volume / CAP - 1.0).abs() < 5e-3, "{volume} {CAP}");
    let base: f64 = mesh
        .facets()
        .iter()
        .filter(|facet| facet.part == 1)
        .map(|facet| crate::mesh::measure(mesh.corners(facet)))
        .sum();
    let at_base = gains.iter().filter(|gain| mesh.facets()[gain.facet].part == 1);
    let with_gains = base + at_base.map(|gain| gain.measure).sum::<f64>();
    // Of the 24 edges of the rim each is halved twice or more: at least the polygon of 96 sides, no more than the disc.
    let polygon = 48.0 * 0.75 * libm::sin(TAU / 96.0);
    assert!((polygon * (1.0 - 1e-12)..0.75 * PI).contains(&with_gains), "{with_gains} {polygon}");
}

#[test]
fn an_edge_beside_facets_of_an_unknown_curve_stays_straight_and_is_told() {
    let mut mesh = AnyMesh::from(on_rim(RIM, 0.0, 0.5, Some(-0.2)));
    mesh.set_curve("top", &[0.0, 0.0, -0.5, 1.0]).unwrap();
    let notes = mesh.notes();
    assert!(notes.len() == 1 && notes[0].contains("top, bottom stay straight"), "{notes:?}");
}

#[test]
fn nodes_beside_their_curve_are_moved_onto_it_and_told() {
    // The digits of the file end at the fourth place.
    let mut mesh = AnyMesh::from(on_rim(0.8660, 0.5, 1.0, None));
    mesh.set_curve("top", &[0.0, 0.0, 0.0, 1.0]).unwrap();
    let notes = mesh.notes();
    assert!(notes.len() == 1 && notes[0].contains("`top` are moved onto its curve"), "{notes:?}");
    let AnyMesh::Space(mesh) = mesh else { panic!("a mesh in space") };
    for rim in &mesh.points()[1..7] {
        let radius = (rim[0] * rim[0] + rim[1] * rim[1]).sqrt();
        assert!((radius - RIM).abs() < 1e-12 && (rim[2] - 0.5).abs() < 1e-12, "{rim:?}");
    }
    let mut far = AnyMesh::from(on_rim(0.865, 0.5, 1.0, None));
    let said = far.set_curve("top", &[0.0, 0.0, 0.0, 1.0]).unwrap_err();
    assert!(said.contains("is off its curve by"), "{said}");
}

/// Surface of a body around the origin, of triangles that each see it.
#[derive(Default)]
struct Shell {
    points: Vec<[f64; 3]>,
    facets: Vec<Facet<3>>,
}

impl Shell {
    /// Number of the point at this place.
    fn node(&mut self, place: [f64; 3]) -> u32 {
        let is_there = |point: &[f64; 3]| (0..3).all(|d| (point[d] - place[d]).abs() < 1e-9);
        let known = self.points.iter().position(is_there);
        let number = known.unwrap_or(self.points.len());
        if known.is_none() {
            self.points.push(place);
        }
        number as u32 + 1
    }

    /// Adds two triangles between two pairs of points.
    fn add_band(&mut self, part: u16, [a, b, c, d]: [[f64; 3]; 4]) {
        let [a, b, c, d] = [a, b, c, d].map(|place| self.node(place));
        self.facets.extend([[a, b, c], [a, c, d]].map(|nodes| Facet { nodes, part }));
    }

    fn add_triangle(&mut self, part: u16, places: [[f64; 3]; 3]) {
        let nodes = places.map(|place| self.node(place));
        self.facets.push(Facet { nodes, part });
    }

    /// Body of the cones over all triangles, the last ones first if that is asked for.
    fn body(&self, names: [&str; 3], is_reversed: bool) -> SpaceMesh {
        let points = [&[[0.0; 3]], &self.points[..]].concat();
        let mut facets = self.facets.clone();
        if is_reversed {
            facets.reverse();
        }
        let cells = facets.iter().map(|Facet { nodes: [a, b, c], .. }| [0, *a, *b, *c]).collect();
        let parts = names.map(named).into();
        MeshData { points, cells, facets, parts, ..MeshData::default() }.mesh().unwrap()
    }
}

/// Checks that the refinements of a body fill this volume, and that their nodes do not depend on the order of elements.
fn fills_in_any_order(shell: &Shell, names: [&str; 3], curves: &[(&str, &[f64])], volume: f64) {
    let [one, two] = [false, true].map(|is_reversed| {
        let mesh = curved(shell.body(names, is_reversed), curves);
        fills(mesh.clone(), volume);
        let mesh = crate::mesh::refine(&mesh).unwrap().mesh;
        crate::mesh::refine(&mesh).unwrap().mesh
    });
    let mut places = [one, two].map(|mesh| mesh.points().to_vec());
    for points in &mut places {
        points.iter_mut().for_each(|point| *point = point.map(|x| (1e9 * x).round() + 0.0));
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
    }
    assert_eq!(places[0], places[1]);
}

/// Point of the unit cylinder around the x axis, at an eighth of a turn from the top.
fn on_pipe(x: f64, eighths: i32) -> [f64; 3] {
    let (sine, cosine) = libm::sincos(f64::from(eighths) * FRAC_PI_4);
    [x, sine, cosine]
}

#[test]
fn two_pipes_that_meet_keep_the_curve_between_them() {
    let mut shell = Shell::default();
    for i in -2..2 {
        for j in -4..4 {
            let [x, next] = [i, i + 1].map(f64::from);
            if !((-1..1).contains(&i) && (-1..1).contains(&j)) {
                let corners = [(x, j), (next, j), (next, j + 1), (x, j + 1)];
                shell.add_band(0, corners.map(|(x, j)| on_pipe(x, j)));
            }
        }
    }
    let around = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
    let branch = |k: usize, z: Option<f64>| {
        let (sine, cosine) = libm::sincos(k as f64 * FRAC_PI_4);
        [0.5 * cosine, 0.5 * sine, z.unwrap_or((1.0 - 0.25 * sine * sine).sqrt())]
    };
    for k in 0..8 {
        let next = (k + 1) % 8;
        let [here, there] = [k, next].map(|k| on_pipe(f64::from(around[k].0), around[k].1));
        shell.add_band(0, [branch(k, None), here, there, branch(next, None)]);
        let [low, high] = [k, next].map(|k| [branch(k, None), branch(k, Some(2.0))]);
        shell.add_band(1, [low[0], high[0], high[1], low[1]]);
        shell.add_triangle(2, [[0.0, 0.0, 2.0], low[1], high[1]]);
    }
    for (x, j) in [-2.0, 2.0].into_iter().flat_map(|x| (-4..4).map(move |j| (x, j))) {
        shell.add_triangle(2, [[x, 0.0, 0.0], on_pipe(x, j), on_pipe(x, j + 1)]);
    }
    let curves: [(&str, &[f64]); 2] = [
        ("pipe", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]),
        ("branch", &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.5]),
    ];
    // The volume that both have is the integral of `2 sqrt(1/4 - y^2) sqrt(1 - y^2)`, y = sin(t) / 2.
    let steps = 64;
    let both: f64 = (0..steps)
        .map(|k| {
            let (sine, cosine) = libm::sincos((f64::from(k) + 0.5) / f64::from(steps) * PI);
            0.5 * sine * sine * (1.0 - 0.25 * cosine * cosine).sqrt() * PI / f64::from(steps)
        })
        .sum();
    fills_in_any_order(&shell, ["pipe", "branch", "ends"], &curves, 4.5 * PI - both);
}

#[test]
fn a_ball_that_a_cylinder_crosses_keeps_the_curve_between_them() {
    // The axis of the cylinder is beside the centre of the ball.
    let beside = 0.1;
    let at = |radius: f64, z: f64, k: usize| {
        let (sine, cosine) = libm::sincos(k as f64 * FRAC_PI_4);
        [radius * cosine, radius * sine, z]
    };
    let side = |z: Option<f64>, k: usize| {
        let [x, y, _] = at(0.5, 0.0, k);
        let x = x + beside;
        [x, y, z.unwrap_or((1.0 - x * x - y * y).sqrt())]
    };
    let mut shell = Shell::default();
    for (k, next) in (0..8).map(|k| (k, (k + 1) % 8)) {
        let rings = [k, next].map(|k| {
            let low = libm::sqrt(0.5);
            [
                at(low, -(1.0 - low * low).sqrt(), k),
                at(1.0, 0.0, k),
                at(0.9, libm::sqrt(0.19), k),
                side(None, k),
                side(Some(1.5), k),
            ]
        });
        shell.add_triangle(0, [[0.0, 0.0, -1.0], rings[0][0], rings[1][0]]);
        for (level, part) in [(0, 0), (1, 0), (2, 0), (3, 1)] {
            let [[a, d], [b, c]] = rings.map(|ring| [ring[level], ring[level + 1]]);
            shell.add_band(part, [a, b, c, d]);
        }
        shell.add_triangle(2, [[beside, 0.0, 1.5], rings[0][4], rings[1][4]]);
    }
    let curves: [(&str, &[f64]); 2] =
        [("ball", &[0.0, 0.0, 0.0, 1.0]), ("side", &[beside, 0.0, 0.0, 0.0, 0.0, 1.0, 0.5])];
    // The height of the cylinder over the sphere, by the midpoints of polar coordinates.
    let (steps, mut above) = (200, 0.0);
    for (i, j) in (0..steps).flat_map(|i| (0..steps).map(move |j| (i, j))) {
        let radius = 0.5 * (f64::from(i) + 0.5) / f64::from(steps);
        let (sine, cosine) = libm::sincos(TAU * f64::from(j) / f64::from(steps));
        let (x, y) = (beside + radius * cosine, radius * sine);
        let area = radius * 0.5 / f64::from(steps) * TAU / f64::from(steps);
        above += (1.5 - (1.0 - x * x - y * y).sqrt()) * area;
    }
    fills_in_any_order(&shell, ["ball", "side", "top"], &curves, 4.0 / 3.0 * PI + above);
}
