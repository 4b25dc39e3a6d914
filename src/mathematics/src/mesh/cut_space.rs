//! Tetrahedra that borders of boxes, half-spaces and balls cross.
//!
//! Planes cut a tetrahedron into smaller ones, on each of which f is constant but for balls. A ball takes its
//! [share](super::ball) of each in closed form, less that of the balls inside it. Two spheres that cross each other
//! meet in the plane in which the powers of a point to both are the same: on each side of that plane, the one ball is
//! inside the other. Only for balls so large that their surfaces are nearly planes, slices are integrated as on the
//! cube.

use super::ball::{self, Corners, PartMeasure};
use super::cut::{CutMoments, CutShape, FramedCell};
use super::geometry::{centroid, dot};
use crate::discrete::cells::CutCube;
use crate::problem::shape::{Shape, plain};

/// Radius over the size of a cell from which on the closed form loses digits: it takes angles at the centre.
const FLAT: f64 = 300.0;
/// Volume over that of the cell below which a part of it is a rounding error.
const NOTHING: f64 = 1e-16;

impl CutShape<3, 4> for Shape<3> {
    type Storage = CutCube;

    fn integrate(
        storage: &mut CutCube,
        cell: &FramedCell<3, 4>,
        background: f64,
        pieces: &[(Self, f64)],
    ) -> CutMoments<3> {
        let is_flat =
            |(shape, _): &(Self, f64)| matches!(shape, Self::Ball { radius, .. } if *radius > FLAT);
        if pieces.iter().any(is_flat) {
            return by_slices(storage, cell, background, pieces);
        }
        let least = NOTHING * cell.element.volume;
        let mut parts = Parts { background, least, sums: CutMoments::ZERO };
        parts.add(cell.framed, pieces, &mut Vec::new());
        parts.sums
    }
}

impl CutMoments<3> {
    const ZERO: Self = Self { one: 0.0, first: [0.0; 3], square: 0.0, size: 0.0 };
}

/// Ball that may cover some of a part of a cell, over the pieces that have not been looked at.
#[derive(Clone, Copy, Debug)]
struct OpenBall {
    centre: [f64; 3],
    radius: f64,
    value: f64,
}

impl OpenBall {
    /// Square of the distance between the centres.
    fn square_to(&self, other: &Self) -> f64 {
        let way: [f64; 3] = std::array::from_fn(|d| self.centre[d] - other.centre[d]);
        dot(way, way)
    }

    fn holds(&self, other: &Self) -> bool {
        let room = self.radius - other.radius;
        room >= 0.0 && self.square_to(other) <= room * room
    }

    /// True if the spheres meet.
    fn crosses(&self, other: &Self) -> bool {
        let apart = self.radius + other.radius;
        self.square_to(other) < apart * apart && !self.holds(other) && !other.holds(self)
    }

    /// Plane `normal . x = d` in which the powers of a point to both balls are the same; that to this ball is less
    /// where the left side is.
    fn radical_plane(&self, other: &Self) -> ([f64; 3], f64) {
        let normal: [f64; 3] = std::array::from_fn(|d| other.centre[d] - self.centre[d]);
        let middle = std::array::from_fn(|d| 0.5 * (self.centre[d] + other.centre[d]));
        let radii = (self.radius - other.radius) * (self.radius + other.radius);
        (normal, dot(normal, middle) + 0.5 * radii)
    }

    /// True if this ball holds what the other one has of a part around this point, which no radical plane cuts.
    fn holds_at(&self, other: &Self, middle: [f64; 3]) -> bool {
        if !self.crosses(other) {
            return self.holds(other);
        }
        let (normal, d) = self.radical_plane(other);
        dot(normal, middle) <= d
    }
}

/// Integrals over the parts of a cell.
struct Parts {
    background: f64,
    /// Volume below which a part is left out.
    least: f64,
    sums: CutMoments<3>,
}

impl Parts {
    /// Adds a part with these corners, on which `pieces` lie over the background, the first one on top, and below
    /// `balls`.
    fn add(&mut self, corners: Corners, pieces: &[(Shape<3>, f64)], balls: &mut Vec<OpenBall>) {
        if ball::volume(corners) < self.least {
            return;
        }
        let Some(((shape, value), below)) = pieces.split_first() else {
            return self.settle(corners, self.background, balls);
        };
        if corners.iter().all(|&corner| shape.contains(corner)) {
            return self.settle(corners, *value, balls);
        }
        match *shape {
            Shape::Ball { centre, radius } => {
                balls.push(OpenBall { centre, radius, value: *value });
                self.add(corners, below, balls);
                balls.pop();
            }
            Shape::HalfSpace { normal, d } => {
                let (normal, d) = plain(normal, d);
                let [inside, outside] = halves(corners, normal, d);
                inside.into_iter().for_each(|part| self.settle(part, *value, balls));
                outside.into_iter().for_each(|part| self.add(part, below, balls));
            }
            Shape::Box(sides) => {
                let mut inside = vec![corners];
                for (axis, sign, d) in (0..3)
                    .flat_map(|axis| [(axis, -1.0, -sides[axis][0]), (axis, 1.0, sides[axis][1])])
                {
                    let mut normal = [0.0; 3];
                    normal[axis] = sign;
                    let mut kept = Vec::new();
                    for part in inside {
                        let [within, beyond] = halves(part, normal, d);
                        kept.extend(within);
                        beyond.into_iter().for_each(|part| self.add(part, below, balls));
                    }
                    inside = kept;
                }
                inside.into_iter().for_each(|part| self.settle(part, *value, balls));
            }
        }
    }

    /// Adds a part with one value but in `balls`, of which the first one wins.
    fn settle(&mut self, corners: Corners, value: f64, balls: &[OpenBall]) {
        let mut parts = vec![corners];
        for (k, ball) in balls.iter().enumerate() {
            for other in balls[..k].iter().filter(|other| ball.crosses(other)) {
                let (normal, d) = ball.radical_plane(other);
                parts =
                    parts.into_iter().flat_map(|part| halves(part, normal, d)).flatten().collect();
            }
        }
        parts.into_iter().for_each(|part| self.settle_nested(part, value, balls));
    }

    /// As [`Parts::settle`], where of two balls one holds the other, or they have nothing in common.
    fn settle_nested(&mut self, corners: Corners, value: f64, balls: &[OpenBall]) {
        self.count(value, self.background, ball::whole(corners));
        let middle = centroid(corners);
        for (k, ball) in balls.iter().enumerate() {
            if balls[..k].iter().any(|above| above.holds_at(ball, middle)) {
                continue;
            }
            // The ball lies in the first one below that holds it, if there is one.
            let around = balls[k + 1..].iter().find(|below| below.holds_at(ball, middle));
            let before = around.map_or(value, |ball| ball.value);
            if ball.value != before {
                self.count(ball.value, before, ball::common(corners, ball.centre, ball.radius));
            }
        }
    }

    /// Puts one value in place of another.
    fn count(&mut self, value: f64, before: f64, PartMeasure { volume, first }: PartMeasure) {
        let sums = &mut self.sums;
        let [new, old] = [value, before].map(|value| value - self.background);
        sums.one += (new - old) * volume;
        sums.first.iter_mut().zip(first).for_each(|(sum, first)| *sum += (new - old) * first);
        sums.square += (new * new - old * old) * volume;
        sums.size += (value.abs() - before.abs()) * volume;
    }
}

/// Parts of a tetrahedron on both sides of a plane: where `normal . x <= d`, and the others.
fn halves(corners: Corners, normal: [f64; 3], d: f64) -> [Vec<Corners>; 2] {
    let heights = corners.map(|corner| dot(normal, corner) - d);
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for (k, height) in heights.iter().enumerate() {
        if *height <= 0.0 { below.push(k) } else { above.push(k) }
    }
    let cut = |a: usize, b: usize| -> [f64; 3] {
        let share = heights[a] / (heights[a] - heights[b]);
        std::array::from_fn(|axis| corners[a][axis] + share * (corners[b][axis] - corners[a][axis]))
    };
    match (&below[..], &above[..]) {
        (_, []) => [vec![corners], Vec::new()],
        ([], _) => [Vec::new(), vec![corners]],
        (&[p], &[a, b, c]) | (&[a, b, c], &[p]) => {
            let cuts = [a, b, c].map(|other| cut(p, other));
            let tip = vec![[corners[p], cuts[0], cuts[1], cuts[2]]];
            let rest = prism(cuts, [a, b, c].map(|k| corners[k])).to_vec();
            if below.len() == 1 { [tip, rest] } else { [rest, tip] }
        }
        _ => {
            let ([p, q], [r, s]) = ([below[0], below[1]], [above[0], above[1]]);
            let [pr, ps, qr, qs] = [cut(p, r), cut(p, s), cut(q, r), cut(q, s)];
            let lower = prism([corners[p], pr, ps], [corners[q], qr, qs]);
            let upper = prism([corners[r], pr, qr], [corners[s], ps, qs]);
            [lower.to_vec(), upper.to_vec()]
        }
    }
}

/// The tetrahedra that make up a prism between two triangles.
fn prism([a, b, c]: [[f64; 3]; 3], [d, e, f]: [[f64; 3]; 3]) -> [Corners; 3] {
    [[a, b, c, d], [b, c, d, e], [c, d, e, f]]
}

/// Integrals over a cell by slices: painted over with zero on the half-spaces outside, a function has the integrals
/// over the cell as those over the unit cube.
pub(super) fn by_slices(
    storage: &mut CutCube,
    cell: &FramedCell<3, 4>,
    background: f64,
    pieces: &[(Shape<3>, f64)],
) -> CutMoments<3> {
    let functions: [fn(f64, f64) -> f64; 3] =
        [|f, c| f - c, |f, c| (f - c) * (f - c), |f, c| f.abs() - c.abs()];
    let [corners, square, size] = functions.map(|function| {
        let above = pieces.iter().map(|&(shape, value)| (shape, function(value, background)));
        storage.set(0.0, cell.outside().into_iter().map(|shape| (shape, 0.0)).chain(above));
        storage.corners()
    });
    let first = std::array::from_fn(|axis| {
        let sides = corners.iter().enumerate();
        sides.map(|(k, hat)| if k >> axis & 1 == 1 { 0.5 * hat } else { -0.5 * hat }).sum()
    });
    let [one, square, size] = [corners, square, size].map(|hats| hats.iter().sum());
    CutMoments { one, first, square, size }
}
