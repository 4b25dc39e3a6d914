//! Complex numbers at some points side by side, so that loops over the points are loops of vectors.

use crate::machine::simd::vectorised;
use crate::problem::complex::Complex;

/// Points side by side.
pub(crate) const TOGETHER: usize = 16;

/// Complex numbers side by side, their real and imaginary parts apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ComplexLanes {
    pub re: [f64; TOGETHER],
    pub im: [f64; TOGETHER],
}

impl ComplexLanes {
    pub(crate) const ZERO: Self = Self::filled(Complex::new(0.0, 0.0));

    /// One number at all points.
    pub(crate) const fn filled(z: Complex) -> Self {
        Self { re: [z.re; TOGETHER], im: [z.im; TOGETHER] }
    }

    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Complex {
        Complex::new(self.re[lane], self.im[lane])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, z: Complex) {
        (self.re[lane], self.im[lane]) = (z.re, z.im);
    }

    /// Numbers of the first points.
    pub(crate) fn first(&self, many: usize) -> impl Iterator<Item = Complex> {
        (0..many).map(|lane| self.get(lane))
    }

    /// Adds a multiple of other numbers.
    #[inline(always)]
    pub(crate) fn add_scaled(&mut self, factor: Complex, other: &Self) {
        for l in 0..TOGETHER {
            self.set(l, self.get(l) + factor * other.get(l));
        }
    }

    #[inline(always)]
    pub(crate) fn scale(&mut self, factor: f64) {
        for l in 0..TOGETHER {
            self.set(l, self.get(l).scaled(factor));
        }
    }

    /// Products with other numbers.
    #[inline(always)]
    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut products = *self;
        for l in 0..TOGETHER {
            products.set(l, self.get(l) * other.get(l));
        }
        products
    }
}

/// Sum of numbers times coefficients.
pub(crate) fn summed(coefficients: &[Complex], numbers: &[ComplexLanes]) -> ComplexLanes {
    let mut sum = ComplexLanes::ZERO;
    vectorised(
        #[inline(always)]
        || {
            for (&c, own) in coefficients.iter().zip(numbers) {
                sum.add_scaled(c, own);
            }
        },
    );
    sum
}

/// Sum of numbers times coefficients, to which what each addition loses is added at last; and bounds of its rounding
/// errors, by those of the numbers in units in the last place.
pub(crate) fn bounded_sum(
    coefficients: &[Complex],
    units: &[f64],
    numbers: &[ComplexLanes],
) -> (ComplexLanes, [f64; TOGETHER]) {
    /// A modulus over the largest of both parts and of their sum over the root of two, at most.
    const OCTAGON: f64 = 1.0824;
    let (mut sum, mut lost) = (ComplexLanes::ZERO, ComplexLanes::ZERO);
    let mut errors = [0.0; TOGETHER];
    vectorised(
        #[inline(always)]
        || {
            for ((&c, units), own) in coefficients.iter().zip(units).zip(numbers) {
                for (l, error) in errors.iter_mut().enumerate() {
                    let term = c * own.get(l);
                    (sum.re[l], lost.re[l]) = added(sum.re[l], lost.re[l], term.re);
                    (sum.im[l], lost.im[l]) = added(sum.im[l], lost.im[l], term.im);
                    let [x, y] = [term.re.abs(), term.im.abs()];
                    let larger = if x > y { x } else { y };
                    let slanted = std::f64::consts::FRAC_1_SQRT_2 * (x + y);
                    *error += units * if larger > slanted { larger } else { slanted };
                }
            }
        },
    );
    for (l, error) in errors.iter_mut().enumerate() {
        sum.set(l, sum.get(l) + lost.get(l));
        *error = f64::EPSILON * (OCTAGON * *error + 2.0 * sum.get(l).norm());
    }
    (sum, errors)
}

/// A sum with another term, and what additions lost so far: Knuth, *The Art of Computer Programming* 2, 4.2.2.
#[inline(always)]
fn added(sum: f64, lost: f64, term: f64) -> (f64, f64) {
    let total = sum + term;
    let part = total - sum;
    (total, lost + ((sum - (total - part)) + (term - part)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_lose_nothing_and_errors_are_at_least_those_of_the_terms() {
        // Whole numbers of very different sizes, whose sum is three times the lane.
        let sizes = [1e17, 3.0, 1e17, -2e17];
        let mut numbers = [ComplexLanes::ZERO; 4];
        for (own, size) in numbers.iter_mut().zip(sizes) {
            for lane in 0..TOGETHER {
                own.set(lane, Complex::new(size, 0.0).scaled(lane as f64));
            }
        }
        let coefficients = [1.0, 1.0, 1.0, 1.0].map(|re| Complex::new(re, 0.0));
        let (sum, errors) = bounded_sum(&coefficients, &[2.0; 4], &numbers);
        let plain = summed(&coefficients, &numbers);
        for (lane, z) in sum.first(TOGETHER).enumerate() {
            let size = lane as f64;
            assert_eq!(z, Complex::new(3.0 * size, 0.0));
            assert!(errors[lane] >= f64::EPSILON * 2.0 * 4e17 * size);
            assert!((plain.get(lane) - z).norm() <= errors[lane]);
        }
        for k in 0..100 {
            let turned = [ComplexLanes::filled(Complex::unit(0.1 * f64::from(k)))];
            let (_, errors) = bounded_sum(&coefficients[..1], &[100.0], &turned);
            let size = errors[0] / f64::EPSILON;
            assert!((101.9..111.0).contains(&size), "{k}: {size}");
        }
    }
}
