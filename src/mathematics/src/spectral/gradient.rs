//! v with its gradient at a point of the square.

use super::Solution;
use super::place::{BoundaryPlace, tangent};
use crate::problem::complex::Complex;

/// Distance from the boundary below which a point is taken for one of the boundary.
const ON_BOUNDARY: f64 = 1e-6;

impl Solution {
    /// v and its gradient at a point; none outside of the square. Inside, the gradient of the harmonic part is an
    /// integral over the boundary, which loses as many digits as the distance from there has zeros. On the boundary
    /// the normal part of the gradient is the multiplier.
    pub fn at(&self, point: &[f64]) -> Option<(f64, [f64; 2])> {
        let &[x, y] = point else { return None };
        let distance = 0.5 - x.abs().max(y.abs());
        if distance.is_nan() || distance < 0.0 {
            return None;
        }
        let z = Complex::new(x, y);
        if distance < ON_BOUNDARY {
            let place = BoundaryPlace::nearest(z);
            let [v, multiplier] = self.under_law(place.point().coordinates());
            let along = tangent(place.corner, place.t);
            // The side is on the left of its outer normal.
            let slope = along.scaled(self.trace.at(place).along);
            return Some((v, (slope - along.turned().scaled(multiplier)).coordinates()));
        }
        let [psi] = self.problem.jumps.psi.gradients(&[z])[..] else { return None };
        let gradient = psi + self.trace.harmonic_gradient(z);
        Some((self.value(x, y), gradient.coordinates()))
    }
}

#[cfg(test)]
mod tests {
    use crate::spectral::{SpectralParams, spectral};

    #[test]
    fn the_gradient_is_that_of_the_values_and_of_the_flux() {
        let f = "disc(-0.2,0.1,0.2)=6; else=-1".parse().unwrap();
        let solution = spectral(&f, SpectralParams::FINER).unwrap();
        // Inside a piece of f, where v is smooth.
        for [x, y] in [[0.3, -0.2], [-0.2, 0.05], [0.1, 0.45]] {
            let (v, gradient) = solution.at(&[x, y]).unwrap();
            assert_eq!(v, solution.value(x, y));
            let step = 1e-3;
            let differences = [[step, 0.0], [0.0, step]].map(|[dx, dy]| {
                let along = |k: f64| solution.value(x + k * dx, y + k * dy);
                (8.0 * (along(1.0) - along(-1.0)) - along(2.0) + along(-2.0)) / (12.0 * step)
            });
            for (one, other) in gradient.into_iter().zip(differences) {
                assert!((one - other).abs() < 1e-9, "({x}, {y}): {gradient:?} {differences:?}");
            }
        }
        for [x, y] in [[0.5, 0.1], [-0.5, 0.12], [0.2, 0.5], [-0.3, -0.5]] {
            let [v, multiplier] = solution.under_law([x, y]);
            let (value, [gx, gy]) = solution.at(&[x, y]).unwrap();
            let inside = [0.999 * x, 0.999 * y];
            let (_, near) = solution.at(&inside).unwrap();
            assert_eq!(value, v);
            let outwards = if x.abs() == 0.5 { gx * x.signum() } else { gy * y.signum() };
            assert!((outwards - multiplier).abs() < 1e-15);
            assert!((gx - near[0]).abs() + (gy - near[1]).abs() < 5e-3, "({x}, {y}): {near:?}");
        }
        assert_eq!(solution.at(&[0.5, 0.51]), None);
        assert_eq!(solution.at(&[0.1]), None);
    }
}
