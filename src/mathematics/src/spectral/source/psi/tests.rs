//! psi outside of shapes that are not so small that its closed form loses digits.

use super::*;
use crate::spectral::geometry::curve::{Arc, Curve};
use crate::spectral::source::quadratic::Extent;
use std::f64::consts::PI;

/// Jumps of 2 along a polygon, or along a circle round the origin, with their box.
fn closed(corners: &[Complex], radius: f64) -> (Potential, Extent) {
    let mut potential = Potential { vertices: corners.to_vec(), ..Potential::default() };
    let many = corners.len();
    for k in 0..many {
        let (next, way) = ((k + 1) % many, corners[(k + 1) % many] - corners[k]);
        let length = way.norm();
        let tangent = Complex::new(way.re / length, way.im / length);
        let ends = [Some(k), Some(next)];
        potential
            .add(Arc { curve: Curve::line(corners[k], tangent), span: [0.0, length], ends }, 2.0);
    }
    if many == 0 {
        let (origin, tangent) = (Complex::new(0.0, -radius), Complex::new(1.0, 0.0));
        let curve = Curve { origin, tangent, curvature: 1.0 / radius };
        potential.add(Arc { curve, span: [0.0, TAU * radius], ends: [None; 2] }, 2.0);
    }
    let arcs: Vec<Arc> = potential.jumps.iter().map(|jump| jump.arc).collect();
    let extent = Extent::of(&arcs);
    (potential, extent)
}

fn points(own: &[(f64, f64)]) -> Vec<Complex> {
    own.iter().map(|&(x, y)| Complex::new(x, y)).collect()
}

#[test]
fn psi_outside_is_that_of_the_sides() {
    let shapes = [
        points(&[]),
        points(&[(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05)]),
        points(&[(-0.01, -0.3), (0.01, -0.3), (0.01, 0.3), (-0.01, 0.3)]),
        points(&[(-0.1, -0.05), (0.12, -0.03), (0.02, 0.08)]),
    ];
    for corners in &shapes {
        let (potential, extent) = closed(corners, 0.07);
        let sides = PsiPart::new(Complex::default(), potential.clone(), None);
        let far = FarField::new(&potential, extent);
        let mut seen = 0;
        for k in 0..400 {
            let k = f64::from(k);
            // Near the shape, beside it, and on the longer sides of the thin one.
            let mut z = Complex::unit(k).scaled(0.01 * k);
            if k < 40.0 {
                z = Complex::new(0.01, -0.1 + 0.005 * k);
            }
            if !far.holds(z) {
                continue;
            }
            seen += 1;
            let (value, slope) = far.at(z);
            let (mut values, mut gradients) = ([0.0], [Complex::default()]);
            sides.add_values(&[z], &mut values);
            sides.add_gradients(&[z], &mut gradients);
            let sizes = far.sizes(z);
            let off = (value - values[0]).abs();
            assert!(off < 2e-15 * (1.0 + z.norm2()), "{corners:?} {z:?}: {off}");
            let off = (slope - gradients[0]).norm();
            assert!(off < 4e-15 * (1.0 + z.norm()), "{corners:?} {z:?}: {off}");
            assert!(sizes.value >= value.abs() && sizes.slope >= slope.norm(), "{corners:?} {z:?}");
            let step = Complex::new(1e-4 * z.norm(), 0.0);
            let bend = (far.at(z + step).1 - far.at(z - step).1).norm() / (2.0 * step.re);
            assert!(sizes.bend >= bend || !far.holds(z - step), "{corners:?} {z:?}: {bend}");
            assert!(sizes.slope < 30.0 * slope.norm(), "{corners:?} {z:?}: {slope:?}");
        }
        assert!(seen > 100, "{corners:?} {seen}");
    }
}

#[test]
fn psi_of_small_shapes_is_that_of_large_ones_scaled() {
    // psi of f on a shape that is s times as large is s^2 psi + s^2 log s M_0 / 2 pi at s z.
    let corners = points(&[(-0.1, -0.05), (0.12, -0.03), (0.02, 0.08)]);
    let square = points(&[(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)]);
    for (corners, area) in [(points(&[]), PI * 0.0049), (corners, 0.0131), (square, 0.04)] {
        let scale = 1e-8;
        let [one, small] = [1.0, scale].map(|s| {
            let scaled: Vec<Complex> = corners.iter().map(|z| z.scaled(s)).collect();
            let (potential, extent) = closed(&scaled, 0.07 * s);
            FarField::new(&potential, extent)
        });
        assert!((one.mass / small.mass * scale * scale - 1.0).abs() < 1e-12);
        assert!(one.mass >= 2.0 * area * (1.0 - 1e-12), "{}", one.mass);
        let z = Complex::new(3.0, -2.0);
        let [(value, slope), (scaled, rate)] = [one.at(z), small.at(z.scaled(scale))];
        let exact = value - 2.0 * area / TAU * libm::log(scale);
        assert!((scaled / (scale * scale) - exact).abs() < 1e-14, "{scaled} {exact}");
        assert!((rate.scaled(1.0 / scale) - slope).norm() < 1e-14, "{rate:?} {slope:?}");
    }
}
