//! Volume and first moments of what a ball and a tetrahedron have in common, in closed form.
//!
//! With the centre at 0 and the radius 1, let F be the part inside the ball of the side in the plane `n . x = h`, n the
//! normal outwards, and S the part of the sphere inside the tetrahedron. By the divergence theorem for x and for
//! `|x|^2`, since the integral of the normal over the whole surface is 0,
//!
//! ```text
//! 3 volume = sum over the sides of h |F| + |S|,
//! 2 (integral of x) = sum over the sides of n (integral over F of |x|^2 - 1).
//! ```
//!
//! |S| is the sum of the solid angles of the sides without F. All integrals over F and the rest of a side are sums over
//! the edges, each cut at the circle: in polar coordinates around the foot of the centre they are integrals over the
//! angle.

use super::geometry::{centroid, dot};

/// Corners of a tetrahedron.
pub(super) type Corners = [[f64; 3]; 4];

/// Volume and integrals of the coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct PartMeasure {
    pub volume: f64,
    pub first: [f64; 3],
}

/// Volume of a tetrahedron.
pub(super) fn volume(corners: Corners) -> f64 {
    determinant(corners).abs() / 6.0
}

/// Measure of a tetrahedron.
pub(super) fn whole(corners: Corners) -> PartMeasure {
    let volume = volume(corners);
    PartMeasure { volume, first: centroid(corners).map(|x| volume * x) }
}

/// Measure of what a tetrahedron and a ball have in common.
pub(super) fn common(corners: Corners, centre: [f64; 3], radius: f64) -> PartMeasure {
    let scaled = corners.map(|corner| difference(corner, centre).map(|x| x / radius));
    if scaled.iter().all(|&x| dot(x, x) <= 1.0) {
        return whole(corners);
    }
    let all = volume(corners);
    let sign = if determinant(corners) < 0.0 { -1.0 } else { 1.0 };
    let mut sums = SideSums::default();
    for vertex in 0..4 {
        // The next three vertices run anticlockwise around every second vertex.
        let [a, b, c] = [1, 2, 3].map(|step| scaled[(vertex + step) % 4]);
        let outwards = if vertex % 2 == 0 { sign } else { -sign };
        sums.add_side(if outwards > 0.0 { [a, b, c] } else { [a, c, b] });
    }
    let cube = radius * radius * radius;
    // The solid angle is known up to multiples of rounding only, which must not make more than there is.
    let volume = ((sums.flow + sums.sphere) / 3.0 * cube).clamp(0.0, all);
    let first = std::array::from_fn(|d| 0.5 * sums.moment[d] * cube * radius + centre[d] * volume);
    PartMeasure { volume, first }
}

/// Sums over the sides of a tetrahedron.
#[derive(Clone, Copy, Debug, Default)]
struct SideSums {
    /// Of h |F|.
    flow: f64,
    /// Solid angle of the sides without F.
    sphere: f64,
    /// Of n times the integral of `|x|^2 - 1`.
    moment: [f64; 3],
}

impl SideSums {
    /// Adds a side, whose corners run anticlockwise as seen from outside.
    fn add_side(&mut self, corners: [[f64; 3]; 3]) {
        let normal = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
        let length = dot(normal, normal).sqrt();
        if length == 0.0 {
            return;
        }
        let normal = normal.map(|x| x / length);
        let height = dot(normal, corners[0]);
        let circle = Circle { height, square: (1.0 - height) * (1.0 + height) };
        let mut sums = PlaneSums::default();
        for k in 0..3 {
            let [p, q] = [corners[k], corners[(k + 1) % 3]];
            let way = difference(q, p);
            let length = dot(way, way).sqrt();
            if length == 0.0 {
                continue;
            }
            let along = way.map(|x| x / length);
            // Distance of the foot from the line, positive to the left of it.
            let away = dot(cross(p, along), normal);
            circle.add_edge(&mut sums, SideEdge { away, ends: [dot(p, along), dot(q, along)] });
        }
        self.flow += height * sums.area;
        self.sphere += sums.angle;
        let moment = (height * height - 1.0) * sums.area + sums.polar;
        self.moment.iter_mut().zip(normal).for_each(|(sum, n)| *sum += moment * n);
    }
}

/// Integrals over a side, in polar coordinates r, phi of its plane around the foot of the centre.
#[derive(Clone, Copy, Debug, Default)]
struct PlaneSums {
    /// Area inside the circle.
    area: f64,
    /// Integral of r^2 there.
    polar: f64,
    /// Solid angle outside.
    angle: f64,
}

/// Intersection of a plane and the unit sphere.
#[derive(Clone, Copy, Debug)]
struct Circle {
    /// Distance of the plane from the centre, negative below it.
    height: f64,
    /// Square of the radius, not positive if the plane does not meet the sphere.
    square: f64,
}

/// Edge of a side: `away` is its distance from the foot, `ends` are coordinates along it from the point next to the
/// foot on.
#[derive(Clone, Copy, Debug)]
struct SideEdge {
    away: f64,
    ends: [f64; 2],
}

impl Circle {
    fn add_edge(&self, sums: &mut PlaneSums, SideEdge { away, ends: [start, end] }: SideEdge) {
        // By rounding, a short edge may run backwards.
        let end = end.max(start);
        let half = (self.square - away * away).max(0.0).sqrt();
        let [first, second] = [(-half).clamp(start, end), half.clamp(start, end)];
        self.add_outside(sums, away, [start, first]);
        self.add_outside(sums, away, [second, end]);
        if first < second {
            let square = away * away;
            let cubes = (second * second * second - first * first * first) / 3.0;
            sums.area += 0.5 * away * (second - first);
            sums.polar += 0.25 * away * (square * (second - first) + cubes);
        }
    }

    /// Adds the sector over a part of an edge outside the circle.
    fn add_outside(&self, sums: &mut PlaneSums, away: f64, [start, end]: [f64; 2]) {
        // A line through the foot bounds no sector.
        if start >= end || away == 0.0 {
            return;
        }
        let (distance, sign) = (away.abs(), if away < 0.0 { -1.0 } else { 1.0 });
        let square = distance * distance;
        let turn = sign * libm::atan2(distance * (end - start), square + start * end);
        let inside = self.square.max(0.0);
        sums.area += 0.5 * inside * turn;
        sums.polar += 0.25 * inside * inside * turn;
        let seen = [start, end].map(|t| {
            let far = (self.height * self.height + square + t * t).sqrt();
            libm::atan2(self.height * t, distance * far)
        });
        // Of a plane that misses the sphere, the whole cone.
        let full = self.height.clamp(-1.0, 1.0);
        sums.angle += full * turn - sign * (seen[1] - seen[0]);
    }
}

/// Six times the volume of a tetrahedron, negative if its corners run in the negative sense.
fn determinant([a, b, c, d]: Corners) -> f64 {
    dot(cross(difference(b, a), difference(c, a)), difference(d, a))
}

fn difference(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|d| p[d] - q[d])
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::cut::FramedCell;
    use crate::mesh::cut_space::by_slices;
    use crate::problem::shape::Shape;
    use std::f64::consts::PI;

    const CORNERS: Corners =
        [[-0.5, -0.4, -0.5], [0.5, -0.3, -0.45], [-0.3, 0.6, -0.4], [-0.1, -0.2, 0.5]];

    #[test]
    fn balls_inside_and_balls_around_have_all() {
        for radius in [1e-9, 1e-3, 0.01] {
            let found = common(CORNERS, [-0.15, -0.15, -0.25], radius);
            assert!((found.volume / (4.0 / 3.0 * PI * radius.powi(3)) - 1.0).abs() < 1e-12);
            assert!((found.first[2] / found.volume + 0.25).abs() < 1e-12);
        }
        assert_eq!(common(CORNERS, [0.0; 3], 2.0), whole(CORNERS));
        assert!(common(CORNERS, [1.0, 1.0, 1.0], 0.5).volume < 1e-15);
    }

    #[test]
    fn halves_and_eighths_of_balls_are_found_where_the_centre_lies_on_the_border() {
        let corner = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let ball = 4.0 / 3.0 * PI * 0.2f64.powi(3);
        for (centre, share) in [([0.0; 3], 0.125), ([0.3, 0.0, 0.0], 0.25), ([0.3, 0.3, 0.0], 0.5)]
        {
            let found = common(corner, centre, 0.2);
            assert!((found.volume / ball - share).abs() < 1e-14, "{centre:?} {found:?}");
        }
    }

    #[test]
    fn shares_are_those_of_slices() {
        let mirrored = [CORNERS[1], CORNERS[0], CORNERS[2], CORNERS[3]];
        for (k, corners) in [CORNERS, mirrored].into_iter().cycle().take(24).enumerate() {
            let wave = |n: f64| 0.5 * libm::sin(n * (k + 1) as f64);
            let centre = [wave(1.3), wave(2.9), wave(4.1)];
            let radius = 0.05 + 1.2 * wave(0.7).abs();
            let cell = FramedCell::new(corners);
            let found = common(cell.framed, centre, radius);
            let piece = (Shape::Ball { centre, radius }, 1.0);
            let slices =
                by_slices(&mut crate::discrete::cells::CutCube::default(), &cell, 0.0, &[piece]);
            assert!((found.volume - slices.one).abs() < 1e-10, "{k}: {found:?} {slices:?}");
            for (p, q) in found.first.iter().zip(slices.first) {
                assert!((p - q).abs() < 1e-10, "{k}: {found:?} {slices:?}");
            }
        }
    }
}
