//! Polynomials in the plane with real values: sums, products with their remainders, values and gradients.

use crate::machine::extremes::two_sum;
use crate::problem::complex::Complex;

/// Polynomial with real values: the sum of `Re(c z^m) |z|^(2k)`.
#[derive(Clone, Debug, Default)]
pub(crate) struct RealPolynomial {
    /// Coefficients c by k, and then by m.
    pub rows: Vec<Vec<Complex>>,
}

impl RealPolynomial {
    /// `Re(c z^m)`, the terms in the order of m.
    pub(crate) fn harmonic(coefficients: Vec<Complex>) -> Self {
        Self { rows: vec![coefficients] }
    }

    /// Value at z = 0.
    pub(crate) fn constant(&self) -> f64 {
        self.rows.first().and_then(|row| row.first()).map_or(0.0, |c| c.re)
    }

    /// Degree at most.
    pub(crate) fn degree(&self) -> usize {
        let degrees = self.rows.iter().enumerate().map(|(k, row)| 2 * k + row.len());
        degrees.max().unwrap_or(1).saturating_sub(1)
    }

    /// Terms with k, m and the coefficient.
    pub(crate) fn all(&self) -> impl Iterator<Item = (usize, usize, Complex)> {
        let rows = self.rows.iter().enumerate();
        rows.flat_map(|(k, row)| row.iter().enumerate().map(move |(m, c)| (k, m, *c)))
    }

    /// Bound of the modulus for |z| up to a radius: the sum of those of all terms.
    pub(crate) fn size(&self, radius: f64) -> f64 {
        let mut power = 1.0;
        let mut sum = 0.0;
        for row in &self.rows {
            let inner = row.iter().rev().fold(0.0, |sum, c| radius * sum + c.norm());
            sum += power * inner;
            power *= radius * radius;
        }
        sum
    }

    /// Each term times a weight by k and m.
    pub(crate) fn weighted(&self, weight: impl Fn(usize, usize) -> f64) -> Self {
        let mut rows = self.rows.clone();
        for (k, row) in rows.iter_mut().enumerate() {
            row.iter_mut().enumerate().for_each(|(m, c)| *c = c.scaled(weight(k, m)));
        }
        Self { rows }
    }

    /// Times `|z|^2`.
    pub(crate) fn raised(mut self) -> Self {
        self.rows.insert(0, Vec::new());
        self
    }

    /// Sum, and a bound of the moduli of its terms that were rounded, for |z| up to a radius.
    pub(crate) fn plus(&self, other: &Self, radius: f64) -> (Self, f64) {
        let (mut sum, mut rounded) = (self.clone(), 0.0);
        for (k, m, c) in other.all() {
            let own = sum.at(k, m);
            let both = *own + c;
            if *own != Complex::default() && c != Complex::default() {
                rounded += both.norm() * libm::pow(radius, (2 * k + m) as f64);
            }
            *own = both;
        }
        (sum, rounded)
    }

    /// Product by `Re a Re b = 1/2 Re(a b) + 1/2 Re(a conj b)`, and a bound of its error by rounding for |z| up to a
    /// radius: the sum of all remainders, which are known.
    pub(crate) fn times(&self, other: &Self, radius: f64) -> (Self, f64) {
        let (mut product, mut error) = (Self::default(), 0.0);
        for (k, m, a) in self.all().filter(|(_, _, a)| *a != Complex::default()) {
            for (l, n, b) in other.all().filter(|(_, _, b)| *b != Complex::default()) {
                let size = libm::pow(radius, (2 * (k + l) + m + n) as f64);
                let turned = if m < n { [a.conj(), b] } else { [a, b.conj()] };
                error += size * add_half(product.at(k + l, m + n), [a, b]);
                error += size * add_half(product.at(k + l + m.min(n), m.abs_diff(n)), turned);
            }
        }
        // The sum of remainders is rounded too.
        (product, 1.01 * error)
    }

    /// Coefficient by k and m, which is zero if it was not there.
    pub(crate) fn at(&mut self, k: usize, m: usize) -> &mut Complex {
        if self.rows.len() <= k {
            self.rows.resize(k + 1, Vec::new());
        }
        let row = &mut self.rows[k];
        if row.len() <= m {
            row.resize(m + 1, Complex::default());
        }
        &mut row[m]
    }

    /// Value at a point.
    pub(crate) fn value(&self, z: Complex) -> f64 {
        let square = z.norm2();
        let rows = self.rows.iter().rev();
        rows.fold(0.0, |sum, row| {
            let inner = row.iter().rev().fold(Complex::default(), |sum, c| sum * z + *c);
            square * sum + inner.re
        })
    }

    /// Gradient at a point: `|z|^(2k) conj(m c z^(m-1)) + 2k |z|^(2k-2) Re(c z^m) z`.
    pub(crate) fn gradient(&self, z: Complex) -> Complex {
        let square = z.norm2();
        let (mut slopes, mut along) = (Complex::default(), 0.0);
        for (k, row) in self.rows.iter().enumerate().rev() {
            let (mut value, mut slope) = (Complex::default(), Complex::default());
            for c in row.iter().rev() {
                slope = slope * z + value;
                value = value * z + *c;
            }
            slopes = slopes.scaled(square) + slope;
            // The power of |z| is lower by 2, and there is none for k = 0.
            if k > 0 {
                along = square * along + 2.0 * k as f64 * value.re;
            }
        }
        slopes.conj() + z.scaled(along)
    }
}

/// Adds half of a product, and returns the sum of the moduli of all remainders of rounding.
fn add_half(sum: &mut Complex, [a, b]: [Complex; 2]) -> f64 {
    let [re, of_re] = add_products(sum.re, [a.re, b.re], [-a.im, b.im]);
    let [im, of_im] = add_products(sum.im, [a.re, b.im], [a.im, b.re]);
    *sum = Complex::new(re, im);
    of_re + of_im
}

/// A number and half of two products, and the sum of the moduli of the remainders.
fn add_products(sum: f64, [a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    let [one, other] = [a * b, c * d];
    let remainders = libm::fma(a, b, -one).abs() + libm::fma(c, d, -other).abs();
    let [both, of_both] = two_sum(one, other);
    let [all, of_all] = two_sum(sum, 0.5 * both);
    [all, 0.5 * (remainders + of_both.abs()) + of_all.abs()]
}
