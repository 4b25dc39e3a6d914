//! Smooth f, with psi.

use super::expansion::{Expansion, in_frame};
use crate::problem::complex::Complex;
use crate::problem::formula::Formula;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::panels::gauss;
use crate::spectral::smooth::{Smooth, Wave};

/// Smooth f in the coordinates of a frame, with psi.
#[derive(Clone, Debug)]
pub(crate) struct SmoothSource {
    pub f: Smooth,
    /// psi with `-Lap psi = f`.
    pub psi: Smooth,
    /// Radius of a disc round the origin that holds the domain.
    pub radius: f64,
    /// Bound of the difference of `-Lap psi` and the formula on this disc.
    pub error: f64,
    /// Points of the rule of [`Self::radial`].
    points: usize,
    /// Bounds of the errors of that on this disc, but for rounding.
    pub radial_errors: [f64; 2],
}

impl SmoothSource {
    /// f as a formula in the frame of a domain.
    ///
    /// # Errors
    /// [`PlaneError::Source`] if its psi is not known.
    pub(crate) fn of_formula(formula: &Formula, domain: &PlaneDomain) -> Result<Self, PlaneError> {
        fn refused(what: impl std::fmt::Display) -> PlaneError {
            PlaneError::Source(format!("f {what}"))
        }
        let radius = Expansion::on(domain).radius;
        let (mut f, error) = in_frame(formula, domain, domain.frame.height).map_err(refused)?;
        let error = error + f.settle(radius);
        Self::new(f, error, radius).map_err(refused)
    }

    /// With a bound of the error of its coefficients on a disc.
    ///
    /// # Errors
    /// The kind of f.
    fn new(f: Smooth, error: f64, radius: f64) -> Result<Self, &'static str> {
        /// Least product of both exponents of a wave, over the square of their sum.
        const HARMONIC: f64 = 1e-6;
        let product = |k: usize, m: usize| 4.0 * ((k + 1) * (k + m + 1)) as f64;
        let polynomial = f.polynomial.weighted(|k, m| -1.0 / product(k, m)).raised();
        let mut psi = Smooth { polynomial, waves: Vec::new() };
        for &wave in &f.waves {
            let [a, b] = wave.exponents;
            let by = (a * b).scaled(-4.0);
            if (a * b).norm() <= HARMONIC * wave.rate() * wave.rate() {
                return Err("has a part without Laplacian, such as exp(x)*sin(y)");
            }
            psi.waves.push(Wave { c: wave.c / by, ..wave });
        }
        // All of a polynomial, and the more the faster both change.
        let fast = (f.rate() + psi.rate()) * radius;
        let of_waves = if psi.waves.is_empty() { 0 } else { 10 + fast as usize };
        let degree = f.polynomial.degree() + psi.polynomial.degree();
        let points = (degree.div_ceil(2) + 1 + of_waves).min(MOST_POINTS);
        let sizes =
            |r: f64| [f.moduli(Complex::default(), r)[0], psi.moduli(Complex::default(), r)[0]];
        let radial_errors = match psi.waves.is_empty() {
            true => [0.0; 2],
            false => [
                radial_error(points, |t| t * sizes(t * radius)[0]),
                radial_error(points, |t| t * sizes(t * radius).iter().product::<f64>()),
            ],
        };
        // Coefficients of psi are rounded too.
        let error = error + 16.0 * f64::EPSILON * f.size(radius);
        Ok(Self { f, psi, radius, error, points, radial_errors })
    }

    /// The functions r with `int f = oint (x.n) r`, and with `int f psi = oint (x.n) r`: `int t f(t x) dt` over t up
    /// to 1, by a Gauss rule.
    pub(crate) fn radial(&self, z: Complex) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for node in gauss(self.points) {
            let seen = z.scaled(node.x);
            let own = node.weight * node.x * self.f.value(seen);
            sums[0] += own;
            sums[1] += own * self.psi.value(seen);
        }
        sums
    }

    /// Sum of the moduli of all terms of the second of these functions for |z| up to a radius.
    pub(crate) fn product(&self, radius: f64) -> f64 {
        let terms = gauss(self.points).iter().map(|node| {
            let seen = node.x * radius;
            node.weight * node.x * self.f.size(seen) * self.psi.size(seen)
        });
        terms.sum()
    }

    /// Units in the last place, over the bounds of moduli, by which values are off; of products with sums of those.
    pub(crate) fn units(&self) -> [f64; 2] {
        let own = self.psi.units(self.radius);
        [own, own + self.f.units(self.radius) + self.points as f64]
    }
}

/// Most points of a rule.
const MOST_POINTS: usize = 48;

/// Bound of the error of a Gauss rule on (0, 1), by bounds of the function for moduli of its variable; see the proof's
/// cells.
fn radial_error(points: usize, most: impl Fn(f64) -> f64) -> f64 {
    let error = |rho: f64| {
        let reach = 0.5 + 0.25 * (rho + 1.0 / rho);
        let small = libm::pow(rho, -2.0 * points as f64);
        32.0 / 15.0 * most(reach) * small / (1.0 - 1.0 / (rho * rho))
    };
    [3.0, 5.0, 8.0, 12.0, 20.0].into_iter().map(error).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::law::Law;
    use crate::spectral::geometry::frame::Frame;
    use crate::spectral::geometry::polygons::{circle, polygon, square};
    use std::f64::consts::TAU;

    fn smooth(text: &str) -> SmoothSource {
        SmoothSource::of_formula(&Formula::read(text, 2).unwrap(), &square()).unwrap()
    }

    #[test]
    fn psi_has_the_formula_as_its_laplacian_and_the_gradient_of_its_values() {
        for text in [
            "(x - 2*y)^3*y/7 - (1 + x*y^2)^2/-4 + sqrt(2)*x^16 - 3",
            "2*pi*sin(2*pi*x) - x^3*y",
            "(1 + cos(3*x - y + 0.4)*sin(y/2 - 1))^2 - exp(2*y - x)*sin(5*x)/3",
            "sin(0.1*3*x)*sin(0.3*x) + exp(0.2*y)",
        ] {
            let (f, formula) = (smooth(text), Formula::read(text, 2).unwrap());
            assert!(f.error < 1e-12, "{}", f.error);
            for [x, y] in [[0.0, 0.0], [0.41, -0.33], [-0.5, 0.5]] {
                let z = Complex::new(x, y);
                let off = (f.f.value(z) - formula.at(&[x, y])).abs();
                assert!(off < 1e-14 + f.error, "{text}: {off}");
                let step = 1e-3;
                let [east, west, north, south] =
                    [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]]
                        .map(|[dx, dy]| f.psi.value(Complex::new(x + dx, y + dy)));
                let laplacian =
                    (east + west + north + south - 4.0 * f.psi.value(z)) / (step * step);
                assert!((laplacian + formula.at(&[x, y])).abs() < 1e-4, "{text}: {laplacian}");
                let slope = f.psi.gradient(z);
                assert!((slope.re - (east - west) / (2.0 * step)).abs() < 1e-4, "{slope:?}");
                assert!((slope.im - (north - south) / (2.0 * step)).abs() < 1e-4, "{slope:?}");
                let [value, rate] = f.psi.moduli(z, 0.0);
                assert!(f.psi.value(z).abs() <= value && slope.norm() <= rate, "{value} {rate}");
            }
        }
    }

    #[test]
    fn moduli_bound_all_complex_coordinates_beside_a_point() {
        let f = smooth("exp(2*y - x)*sin(5*x) + x*y - cos(3*y)").f;
        let (centre, radius) = (Complex::new(0.3, -0.2), 0.25);
        let [value, _] = f.moduli(centre, radius);
        let mut most = 0.0f64;
        for k in 0..400 {
            let [z, w] = [0.1, 0.37].map(|turn| Complex::unit(turn * f64::from(k)).scaled(radius));
            let (z, w) = (centre + z, centre.conj() + w);
            // Re F is half of the sum of F and its conjugate, as functions of z and w.
            let mut sum = Complex::default();
            for &Wave { c, exponents: [a, b] } in &f.waves {
                for (c, a, b) in [(c, a, b), (c.conj(), b.conj(), a.conj())] {
                    let power = a * z + b * w;
                    sum = sum + (c * Complex::unit(power.im)).scaled(0.5 * libm::exp(power.re));
                }
            }
            // x y is (z^2 - w^2) / 4i.
            let product = (z * z - w * w) * Complex::new(0.0, -0.25);
            most = most.max((sum + product).norm());
        }
        assert!(most <= value && value < 8.0 * most, "{most} {value}");
    }

    #[test]
    fn integrals_over_a_disc_are_those_of_polar_coordinates() {
        for text in ["x^2*y^2 + x^3 - 1", "x^2 - 1 + cos(9*x - 2*y)*sin(y)"] {
            let domain = PlaneDomain::new(vec![circle(1.0, Law::SIGNORINI, true)]).unwrap();
            let f = Formula::read(text, 2).unwrap();
            let f = SmoothSource::of_formula(&f, &domain).unwrap();
            let many = 64;
            let (mut sums, mut inner) = ([0.0; 2], [0.0; 2]);
            for k in 0..many {
                let way = Complex::unit(TAU * f64::from(k) / f64::from(many));
                let weight = TAU / f64::from(many);
                let own = f.radial(way);
                (0..2).for_each(|k| sums[k] += weight * own[k]);
                for node in gauss(30) {
                    let (z, weight) = (way.scaled(node.x), weight * node.weight * node.x);
                    inner[0] += weight * f.f.value(z);
                    inner[1] += weight * f.f.value(z) * f.psi.value(z);
                }
            }
            for k in 0..2 {
                assert!((sums[k] - inner[k]).abs() < 1e-13, "{text}: {sums:?} {inner:?}");
                assert!(f.radial_errors[k] < 1e-14, "{:?}", f.radial_errors);
            }
        }
    }

    #[test]
    fn the_error_of_a_rule_is_no_more_than_its_bound() {
        // Of e^(9 t).
        for points in [4, 7, 10] {
            let rule: f64 =
                gauss(points).iter().map(|node| node.weight * libm::exp(9.0 * node.x)).sum();
            let off = (rule - libm::expm1(9.0) / 9.0).abs();
            let bound = radial_error(points, |t| libm::exp(9.0 * t));
            assert!(off <= bound && bound < 1e3 * off, "{points}: {off} {bound}");
        }
    }

    #[test]
    fn what_is_no_polynomial_is_refused_with_the_reason() {
        for (text, words) in [
            (
                "abs(x) - 2",
                "no sum of polynomials and of sin, cos and exp of linear functions: abs of a function of x or y",
            ),
            (
                "1/(2 + x)",
                "no sum of polynomials and of sin, cos and exp of linear functions: a division by x or y",
            ),
            ("2^x", "no sum of polynomials and of sin, cos and exp of linear functions: a power"),
            ("x^0.5", "no sum of polynomials and of sin, cos and exp of linear functions: a power"),
            ("x^40 + y", "a polynomial of degree 40 as it is written; the solver takes up to 32"),
            ("(x^9*y)^1000", "degree 10000"),
        ] {
            let formula = Formula::read(text, 2).unwrap();
            let Err(error) = SmoothSource::of_formula(&formula, &square()) else {
                panic!("{text}")
            };
            assert!(error.to_string().contains(words), "{error}");
        }
    }

    #[test]
    fn the_error_of_an_expansion_is_bounded_far_from_the_origin_too() {
        let mut far = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]]);
        far.frame = Frame { origin: [1000.0, 0.0], unit: 0.5, height: 1.0 };
        let formula = Formula::read("(x - 1000)^8 - y/3", 2).unwrap();
        let f = SmoothSource::of_formula(&formula, &far).unwrap();
        for point in [[1000.1, 0.05], [1000.75, 0.5], [1001.0, 1.0]] {
            let seen = far.frame.seen(point);
            let off = (f.f.value(seen) - formula.at(&point)).abs();
            assert!(off <= f.error + 1e-14 && f.error < 1e-9, "{off} {}", f.error);
        }
    }
}
