//! Quadratic functions with Laplacian 1, by which integrals over a piece of f become those along its border.
//!
//! With p such a function and `-Lap psi = f`, over a piece on which f is constant,
//! ```text
//! int f psi = f oint (psi p_n - p psi_n) - f^2 oint (x.n) p / 4,     int f = f oint (x.n) / 2.
//! ```
//! p is about as large on the piece as the square of its width, if it is about the middle of a box round it, and the
//! more across a side of the box the longer that is: so no terms cancel.

use crate::problem::complex::Complex;
use crate::spectral::geometry::curve::Arc;

/// Box round a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub centre: Complex,
    /// Direction of its longer sides.
    pub axis: Complex,
    /// Half of its sides, the longer ones first.
    pub half: [f64; 2],
}

impl Extent {
    /// Box round arcs whose sides are parallel to the longest straight one.
    pub(crate) fn of(arcs: &[Arc]) -> Self {
        let mut longest = (0.0, Complex::new(1.0, 0.0));
        for Arc { curve, span: [from, to], .. } in arcs {
            let length = (to - from).abs();
            if curve.curvature == 0.0 && length > longest.0 {
                longest = (length, curve.tangent);
            }
        }
        let (_, mut axis) = longest;
        let mut range = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for (z, beyond) in arcs.iter().flat_map(|&arc| outline(arc)) {
            let [x, y] = (axis.conj() * z).coordinates();
            range[0] = [range[0][0].min(x - beyond), range[0][1].min(y - beyond)];
            range[1] = [range[1][0].max(x + beyond), range[1][1].max(y + beyond)];
        }
        let [low, high] = range;
        let centre = axis * Complex::new(0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]));
        let mut half = [0, 1].map(|k| 0.5 * (high[k] - low[k]));
        if half[0] < half[1] {
            half.reverse();
            axis = axis.turned();
        }
        Self { centre, axis, half }
    }

    /// Coordinates of a point along the longer and the shorter sides, from the centre.
    pub(crate) fn local(&self, z: Complex) -> [f64; 2] {
        (self.axis.conj() * (z - self.centre)).coordinates()
    }

    /// Distance of a point from the box.
    pub(crate) fn distance(&self, z: Complex) -> f64 {
        let [x, y] = self.local(z);
        let [x, y] = [x.abs() - self.half[0], y.abs() - self.half[1]].map(|beyond| beyond.max(0.0));
        (x * x + y * y).sqrt()
    }
}

/// Points with a distance each within which an arc lies.
fn outline(arc: Arc) -> Vec<(Complex, f64)> {
    let length = (arc.span[1] - arc.span[0]).abs();
    match arc.curve.centre() {
        // All of the circle.
        Some(centre) if arc.curve.curvature * length > 1.0 => {
            vec![(centre, 1.0 / arc.curve.curvature)]
        }
        round => arc.span.map(|s| (arc.curve.at(s), round.map_or(0.0, |_| length))).to_vec(),
    }
}

/// `(a x^2 + (1 - a) y^2) / 2` with x along an axis from a centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Quadratic {
    pub centre: Complex,
    axis: Complex,
    /// a.
    along: f64,
}

impl Quadratic {
    /// `|x - centre|^2 / 4`.
    pub(crate) const fn round(centre: Complex) -> Self {
        Self { centre, axis: Complex::new(1.0, 0.0), along: 0.5 }
    }

    /// That of a piece in a box.
    pub(crate) fn of(Extent { centre, axis, half: [long, across] }: Extent) -> Self {
        let along = across * across / (long * long + across * across);
        Self { centre, axis, along }
    }

    /// This function, with all seen from another point.
    pub(crate) fn seen_from(self, origin: Complex) -> Self {
        Self { centre: self.centre - origin, ..self }
    }

    /// Value with gradient.
    pub(crate) fn at(&self, z: Complex) -> (f64, Complex) {
        let seen = self.axis.conj() * (z - self.centre);
        let slope = Complex::new(self.along * seen.re, (1.0 - self.along) * seen.im);
        (0.5 * slope.dot(seen), self.axis * slope)
    }

    /// Bounds of the distance from the centre, of the value and of the gradient on a disc, in complex coordinates.
    pub(crate) fn bounds(&self, centre: Complex, radius: f64) -> [f64; 3] {
        let seen = self.axis.conj() * (centre - self.centre);
        let [x, y] = [seen.re.abs() + radius, seen.im.abs() + radius];
        let [a, b] = [self.along * x, (1.0 - self.along) * y];
        [x + y, 0.5 * (a * x + b * y), a + b]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::geometry::curve::Curve;

    #[test]
    fn a_quadratic_has_laplacian_one_and_is_as_small_as_its_box() {
        let way = Complex::new(0.6, 0.8);
        for [long, across] in [[1e-3, 1e-3], [0.3, 1e-3], [0.2, 1e-8]] {
            let from = Complex::new(0.1, -0.4);
            let corners = [(0.0, 0.0), (2.0 * long, 0.0), (2.0 * long, 2.0 * across)];
            let corners = corners.map(|(x, y)| from + way * Complex::new(x, y));
            let arcs = [0, 1].map(|k| {
                let step = corners[k + 1] - corners[k];
                let curve = Curve::line(corners[k], step.scaled(1.0 / step.norm()));
                Arc { curve, span: [0.0, step.norm()], ends: [None; 2] }
            });
            let extent = Extent::of(&arcs);
            assert!((extent.half[0] / long - 1.0).abs() < 1e-12, "{extent:?}");
            assert!((extent.half[1] / across - 1.0).abs() < 1e-7, "{extent:?}");
            for z in corners {
                assert!(extent.distance(z) < 1e-15, "{extent:?}");
                let beyond = extent.centre + (z - extent.centre).scaled(2.0);
                assert!((extent.distance(beyond) - (z - extent.centre).norm()).abs() < 1e-15);
            }
            let own = Quadratic::of(extent);
            let step = 0.01;
            let mut laplacian = -4.0 * own.at(from).0;
            for (x, y) in [(step, 0.0), (-step, 0.0), (0.0, step), (0.0, -step)] {
                let z = from + Complex::new(x, y);
                laplacian += own.at(z).0;
                let slope = (own.at(z).1 + own.at(from).1).scaled(0.5).dot(z - from);
                assert!((own.at(z).0 - own.at(from).0 - slope).abs() < 1e-15);
                let [far, value, rate] = own.bounds(from, 1.01 * step);
                assert!(far >= (z - own.centre).norm(), "{far}");
                assert!(value >= own.at(z).0 && rate >= own.at(z).1.norm(), "{value} {rate}");
            }
            assert!((laplacian / (step * step) - 1.0).abs() < 1e-8, "{laplacian}");
            for z in corners {
                assert!(own.at(z).0 <= 1.001 * across * across, "{extent:?}");
            }
        }
    }

    #[test]
    fn boxes_hold_circles_and_arcs() {
        let tangent = Complex::new(0.8, -0.6);
        let curve = Curve { origin: Complex::new(0.2, 0.1), tangent, curvature: 10.0 };
        for length in [0.02, 0.1, 0.3, 0.2 * std::f64::consts::PI] {
            let extent = Extent::of(&[Arc { curve, span: [0.1, 0.1 + length], ends: [None; 2] }]);
            for k in 0..=100 {
                let z = curve.at(0.1 + length * f64::from(k) / 100.0);
                assert!(extent.distance(z) < 1e-15, "{length} {extent:?} {z:?}");
            }
            assert!(extent.half[0] <= 1.5 * length.min(0.1), "{length} {extent:?}");
        }
    }
}
