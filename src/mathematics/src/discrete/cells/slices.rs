//! Integrals of a piecewise constant f over a cell of the cube that borders of its pieces cross.
//!
//! Each slice of the cell is integrated in closed form; along z the result is analytic between the heights at
//! which a border begins, ends, or meets others, and has at most square roots there. Gauss' rule in a variable
//! that smooths these roots is exact to rounding.

use super::bilinear;
use super::sweep::SweepCut;
use crate::problem::shape::{Shape, dot};

/// The pieces that share one cell of the cube, with room for the work on them.
#[derive(Default)]
pub struct CutCube {
    background: f64,
    /// Shapes in the coordinates of the cell, the last first: it wins.
    pieces: Vec<(Shape<3>, f64)>,
    planes: Vec<Plane>,
    spheres: Vec<Sphere>,
    stops: Vec<f64>,
    slice: SweepCut,
}

/// Relative difference of seven and fifteen points up to which, fifteen are exact to rounding: errors fall
/// geometrically.
const AGREED: f64 = 1e-11;
/// Halvings of a layer at which it is too thin to matter.
const DEEPEST: usize = 40;

/// The points with `normal . p = d`.
#[derive(Clone, Copy)]
struct Plane {
    normal: [f64; 3],
    d: f64,
}

#[derive(Clone, Copy)]
struct Sphere {
    centre: [f64; 3],
    radius: f64,
}

impl CutCube {
    /// Takes another cell, f there being `background` but for the pieces, of which the first wins.
    pub fn set(&mut self, background: f64, pieces: impl Iterator<Item = (Shape<3>, f64)>) {
        self.background = background;
        self.pieces.clear();
        self.pieces.extend(pieces);
    }

    /// The integral of f over the cell [-1/2, 1/2]^3.
    pub fn integral(&mut self) -> f64 {
        self.corners().iter().sum()
    }

    /// The integrals of f times the trilinear hat functions of the eight corners, x first.
    pub fn corners(&mut self) -> [f64; 8] {
        self.find_stops();
        let mut corners = [0.0; 8];
        for k in 1..self.stops.len() {
            let (low, high) = (self.stops[k - 1], self.stops[k]);
            if low < high {
                self.layer(low, high, 0, &mut corners);
            }
        }
        corners
    }

    /// Adds the integrals over the part of the cell between two heights, which is halved until two rules agree.
    fn layer(&mut self, low: f64, high: f64, depth: usize, corners: &mut [f64; 8]) {
        let (mut fine, mut coarse) = ([0.0; 8], [0.0; 8]);
        for (t, weight, gauss) in KRONROD {
            for t in [-t, t].into_iter().take(if t == 0.0 { 1 } else { 2 }) {
                // The map of [-1, 1] onto itself whose derivative vanishes at the ends turns a root of the
                // distance from a stop into a polynomial.
                let z = 0.5 * (low + high) + 0.25 * (high - low) * t * (3.0 - t * t);
                let slope = 0.75 * (high - low) * (1.0 - t * t);
                for (corner, hat) in self.hats(z).into_iter().enumerate() {
                    fine[corner] += slope * weight * hat;
                    coarse[corner] += slope * gauss * hat;
                }
            }
        }
        let apart = coarse.iter().zip(&fine).map(|(p, q)| (p - q).abs()).fold(0.0, f64::max);
        let greatest =
            self.pieces.iter().fold(self.background.abs(), |most, p| most.max(p.1.abs()));
        if depth < DEEPEST && apart > AGREED * greatest {
            let middle = 0.5 * (low + high);
            self.layer(low, middle, depth + 1, corners);
            self.layer(middle, high, depth + 1, corners);
        } else {
            corners.iter_mut().zip(fine).for_each(|(sum, part)| *sum += part);
        }
    }

    /// Integrals of f times the hats over the slice at height z.
    fn hats(&mut self, z: f64) -> [f64; 8] {
        let slices =
            self.pieces.iter().filter_map(|(shape, value)| Some((shape.slice(z)?, *value)));
        self.slice.set(self.background, slices);
        let slice = bilinear(self.slice.moments().first());
        let [lower, upper] = [0.5 - z, 0.5 + z].map(|height| slice.map(|hat| height * hat));
        std::array::from_fn(|corner| if corner < 4 { lower[corner] } else { upper[corner - 4] })
    }

    /// The heights between which the slices change analytically.
    fn find_stops(&mut self) {
        let axis = |axis: usize, d: f64| {
            let mut normal = [0.0; 3];
            normal[axis] = 1.0;
            Plane { normal, d }
        };
        let Self { pieces, planes, spheres, stops, .. } = self;
        planes.clear();
        spheres.clear();
        stops.clear();
        planes.extend([0, 1].into_iter().flat_map(|a| [axis(a, -0.5), axis(a, 0.5)]));
        for (shape, _) in pieces.iter() {
            match *shape {
                Shape::Box(sides) => {
                    stops.extend(sides[2]);
                    let faces = [0, 1].into_iter().flat_map(|a| sides[a].map(|s| (a, s)));
                    let inside = faces.filter(|(_, s)| s.abs() < 0.5);
                    planes.extend(inside.map(|(a, s)| axis(a, s)));
                }
                Shape::Ball { centre, radius } => spheres.push(Sphere { centre, radius }),
                Shape::HalfSpace { normal, d } => {
                    stops.push(d / normal[2]);
                    planes.push(Plane { normal, d });
                }
            }
        }
        // Two spheres meet in their radical plane.
        for k in 0..spheres.len() {
            for l in 0..k {
                planes.push(spheres[k].radical_plane(&spheres[l]));
            }
        }
        for sphere in spheres.iter() {
            stops.extend([sphere.centre[2] - sphere.radius, sphere.centre[2] + sphere.radius]);
            for (k, plane) in planes.iter().enumerate() {
                sphere.extremes_on(plane, stops);
                planes[..k].iter().for_each(|other| sphere.meet(plane, other, stops));
            }
        }
        for (k, p) in planes.iter().enumerate() {
            for (l, q) in planes[..k].iter().enumerate() {
                let line = cross(p.normal, q.normal);
                for r in &planes[..l] {
                    // Cramer's rule for z.
                    let [a, b, c] = [p, q, r].map(|plane| plane.normal);
                    let minor = |s: [f64; 3], t: [f64; 3]| s[0] * t[1] - s[1] * t[0];
                    let top = p.d * minor(b, c) + q.d * minor(c, a) + r.d * minor(a, b);
                    stops.push(top / dot(line, c));
                }
            }
        }
        stops.retain(|z| z.abs() < 0.5);
        stops.extend([-0.5, 0.5]);
        stops.sort_unstable_by(f64::total_cmp);
    }
}

impl Sphere {
    fn radical_plane(&self, other: &Self) -> Plane {
        let normal: [f64; 3] = std::array::from_fn(|k| other.centre[k] - self.centre[k]);
        let away = 0.5
            * (dot(normal, normal) + (self.radius - other.radius) * (self.radius + other.radius));
        Plane { normal, d: dot(normal, self.centre) + away }
    }

    /// The centre of the circle in a plane, and the square of its radius.
    fn circle(&self, plane: &Plane) -> ([f64; 3], f64) {
        let square = dot(plane.normal, plane.normal);
        let step = (plane.d - dot(plane.normal, self.centre)) / square;
        let distance = step * square.sqrt();
        let centre = std::array::from_fn(|k| self.centre[k] + step * plane.normal[k]);
        (centre, (self.radius - distance) * (self.radius + distance))
    }

    /// Adds the least and the greatest height of the circle in a plane.
    fn extremes_on(&self, plane: &Plane, stops: &mut Vec<f64>) {
        let (centre, square) = self.circle(plane);
        let [a, b, _] = plane.normal;
        let steepness = (a * a + b * b) / dot(plane.normal, plane.normal);
        let half = (square * steepness).sqrt();
        stops.extend([centre[2] - half, centre[2] + half]);
    }

    /// Adds the heights of the points that the sphere shares with two planes.
    fn meet(&self, p: &Plane, q: &Plane, stops: &mut Vec<f64>) {
        // The point of the line nearest to the centre of the circle in p lies along `across` from there.
        let (centre, square) = self.circle(p);
        let line = cross(p.normal, q.normal);
        let across = cross(line, p.normal);
        let step = (q.d - dot(q.normal, centre)) / dot(q.normal, across);
        let left = square - step * step * dot(across, across);
        let half = line[2] * (left / dot(line, line)).sqrt();
        let foot = centre[2] + step * across[2];
        stops.extend([foot - half, foot + half]);
    }
}

fn cross(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        p[l] * q[m] - p[m] * q[l]
    })
}

/// Nodes on [0, 1] and weights of Kronrod's rule with fifteen points on [-1, 1], and the weights there of Gauss'
/// rule with seven (Piessens et al., QUADPACK, 1983).
const KRONROD: [(f64, f64, f64); 8] = [
    (0.0, 0.209_482_141_084_727_83, 0.417_959_183_673_469_4),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_67),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7),
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
];
