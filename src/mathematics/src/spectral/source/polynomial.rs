//! Polynomial right-hand sides, with psi and the integrals of both.

use super::expansion::{Expansion, expanded};
use super::real_polynomial::RealPolynomial;
use crate::problem::complex::Complex;
use crate::problem::formula::Formula;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::frame::Frame;

/// Polynomial f in the coordinates of a frame, with psi.
#[derive(Clone, Debug)]
pub(crate) struct Polynomial {
    f: RealPolynomial,
    /// psi with `-Lap psi = f`.
    psi: RealPolynomial,
    /// The function r with `int f = oint (x.n) r`.
    radial: RealPolynomial,
    /// The function r with `int f psi = oint (x.n) r`.
    radial_with_psi: RealPolynomial,
    /// Radius of a disc round the origin that holds the domain.
    pub radius: f64,
    /// Bound of the difference of `-Lap psi` and the formula on this disc.
    pub error: f64,
    /// Bound of the error of `radial_with_psi` by rounding of its coefficients, on this disc.
    pub product_error: f64,
}

impl Polynomial {
    /// Polynomial that a formula is in the frame of a domain.
    ///
    /// # Errors
    /// [`PlaneError::Source`] if it is none, or of too high a degree.
    pub(crate) fn of_formula(formula: &Formula, domain: &PlaneDomain) -> Result<Self, PlaneError> {
        let (Frame { height, .. }, [xs, ys]) = (domain.frame, domain.extent());
        let seen = xs.into_iter().flat_map(|x| ys.map(|y| Complex::new(x, y).norm()));
        // Arcs are seen in a hundred points.
        let radius = 1.01 * seen.fold(0.0, f64::max);
        let expansion = Expansion { frame: domain.frame, radius };
        let (f, error) = expanded(formula, &expansion).map_err(PlaneError::Source)?;
        Ok(Self::new(f.weighted(|_, _| 1.0 / height), error / height, radius))
    }

    /// With a bound of the error of its coefficients on a disc.
    fn new(f: RealPolynomial, error: f64, radius: f64) -> Self {
        let product = |k: usize, m: usize| 4.0 * ((k + 1) * (k + m + 1)) as f64;
        let psi = f.weighted(|k, m| -1.0 / product(k, m)).raised();
        let by_degree = |k: usize, m: usize| 1.0 / (2 * k + m + 2) as f64;
        let sizes = [&f, &psi].map(|own| own.size(radius));
        let rounding = (6 + 2 * f.terms()) as f64 * f64::EPSILON;
        Self {
            radial: f.weighted(by_degree),
            radial_with_psi: f.times(&psi, radius).0.weighted(by_degree),
            product_error: rounding * sizes[0] * sizes[1],
            // Coefficients of psi are rounded twice.
            error: error + 2.0 * f64::EPSILON * sizes[0],
            radius,
            f,
            psi,
        }
    }

    /// Units in the last place, over the sums of the moduli of all terms, by which values are off.
    pub(crate) fn units(&self) -> f64 {
        8.0 + 2.0 * self.psi.degree() as f64
    }

    /// f at a point.
    pub(crate) fn value(&self, z: Complex) -> f64 {
        self.f.value(z)
    }

    /// psi at a point.
    pub(crate) fn psi(&self, z: Complex) -> f64 {
        self.psi.value(z)
    }

    /// Gradient of psi at a point.
    pub(crate) fn psi_gradient(&self, z: Complex) -> Complex {
        self.psi.gradient(z)
    }

    /// The function r with `int f = oint (x.n) r`: each term over its degree plus 2.
    pub(crate) fn radial(&self, z: Complex) -> f64 {
        self.radial.value(z)
    }

    /// The function r with `int f psi = oint (x.n) r`.
    pub(crate) fn radial_with_psi(&self, z: Complex) -> f64 {
        self.radial_with_psi.value(z)
    }

    /// Bound of the modulus of that for |z| up to a radius.
    pub(crate) fn product_modulus(&self, radius: f64) -> f64 {
        self.radial_with_psi.size(radius)
    }

    /// Bounds of the moduli of f, of psi and of the gradient of psi for |z| up to a radius, also for complex
    /// coordinates with z and conj(z) up to that radius each.
    pub(crate) fn moduli(&self, radius: f64) -> [f64; 3] {
        let slope = self.psi.weighted(|k, m| (2 * k + m) as f64).size(radius) / radius;
        [self.f.size(radius), self.psi.size(radius), if radius > 0.0 { slope } else { 0.0 }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectral::geometry::polygons::{polygon, square};

    fn polynomial(text: &str) -> Polynomial {
        Polynomial::of_formula(&Formula::read(text, 2).unwrap(), &square()).unwrap()
    }

    #[test]
    fn psi_has_the_formula_as_its_laplacian_and_the_gradient_of_its_values() {
        let text = "(x - 2*y)^3*y/7 - (1 + x*y^2)^2/-4 + sqrt(2)*x^16 - 3";
        let (f, formula) = (polynomial(text), Formula::read(text, 2).unwrap());
        assert!(f.error < 1e-12, "{}", f.error);
        for [x, y] in [[0.0, 0.0], [0.41, -0.33], [-0.5, 0.5]] {
            let z = Complex::new(x, y);
            assert!((f.value(z) - formula.at(&[x, y])).abs() < 1e-14);
            let step = 1e-3;
            let [east, west, north, south] = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]]
                .map(|[dx, dy]| f.psi(Complex::new(x + dx, y + dy)));
            let laplacian = (east + west + north + south - 4.0 * f.psi(z)) / (step * step);
            assert!((laplacian + formula.at(&[x, y])).abs() < 1e-5, "{laplacian}");
            let slope = f.psi_gradient(z);
            assert!((slope.re - (east - west) / (2.0 * step)).abs() < 1e-5, "{slope:?}");
            assert!((slope.im - (north - south) / (2.0 * step)).abs() < 1e-5, "{slope:?}");
        }
    }

    #[test]
    fn integrals_over_a_disc_are_those_of_polar_coordinates() {
        // On the disc of radius 1 the integral of x^2 y^2 is pi / 24, and its psi is
        // -(x^4 y^2 + x^2 y^4)/.. in powers of z; the product is taken from the definition.
        let f = polynomial("x^2*y^2 + x^3 - 1");
        let many = 64;
        let mut sums = [0.0; 2];
        for k in 0..many {
            let z = Complex::unit(std::f64::consts::TAU * f64::from(k) / f64::from(many));
            let weight = std::f64::consts::TAU / f64::from(many);
            sums[0] += weight * f.radial(z);
            sums[1] += weight * f.radial_with_psi(z);
        }
        let mut inner = 0.0;
        for node in crate::spectral::geometry::panels::gauss(20) {
            for k in 0..many {
                let angle = std::f64::consts::TAU * f64::from(k) / f64::from(many);
                let z = Complex::unit(angle).scaled(node.x);
                let weight = node.weight * node.x * std::f64::consts::TAU / f64::from(many);
                inner += weight * f.value(z) * f.psi(z);
            }
        }
        let area = std::f64::consts::PI * (1.0 / 24.0 - 1.0);
        assert!((sums[0] - area).abs() < 1e-13, "{}", sums[0]);
        assert!((sums[1] - inner).abs() < 1e-13, "{} {inner}", sums[1]);
    }

    #[test]
    fn what_is_no_polynomial_is_refused_with_the_reason() {
        for (text, words) in [
            ("abs(x) - 2", "no polynomial in x and y: abs of x or y"),
            ("1/(2 + x)", "no polynomial in x and y: a division by x or y"),
            ("2^x", "no polynomial in x and y: a power"),
            ("x^0.5", "no polynomial in x and y: a power"),
            ("x^40 + y", "a polynomial of degree 40 as it is written; the solver takes up to 32"),
            ("(x^9*y)^1000", "degree 10000"),
        ] {
            let formula = Formula::read(text, 2).unwrap();
            let Err(error) = Polynomial::of_formula(&formula, &square()) else { panic!("{text}") };
            assert!(error.to_string().contains(words), "{error}");
        }
    }

    #[test]
    fn the_error_of_an_expansion_is_bounded_far_from_the_origin_too() {
        let mut far = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]]);
        far.frame = Frame { origin: [1000.0, 0.0], unit: 0.5, height: 1.0 };
        let formula = Formula::read("(x - 1000)^8 - y/3", 2).unwrap();
        let f = Polynomial::of_formula(&formula, &far).unwrap();
        for point in [[1000.1, 0.05], [1000.75, 0.5], [1001.0, 1.0]] {
            let seen = far.frame.seen(point);
            let off = (f.value(seen) - formula.at(&point)).abs();
            assert!(off <= f.error + 1e-14 && f.error < 1e-9, "{off} {}", f.error);
        }
    }
}
