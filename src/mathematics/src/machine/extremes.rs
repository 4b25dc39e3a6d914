//! Least and greatest of two numbers, named after what becomes of NaN, and a sum with its error by rounding.

/// The lesser of two numbers, NaN if either is; `f64::min` would pass over it.
#[inline(always)]
pub(crate) fn min_or_nan(a: f64, b: f64) -> f64 {
    if a <= b || a.is_nan() { a } else { b }
}

/// The greater of two numbers, NaN if either is; `f64::max` would pass over it.
#[inline(always)]
pub(crate) fn max_or_nan(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// The greater of two numbers; the second one if either is NaN. One machine instruction, which `f64::max` is not.
#[inline(always)]
pub(crate) fn max_or_second(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The least and the greatest of some numbers; those that are NaN are passed over.
pub(crate) fn range(values: &[f64]) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.iter().fold(none, |[least, greatest], &value| [least.min(value), greatest.max(value)])
}

/// Sum of two numbers and its remainder, which is a number (Knuth).
#[inline(always)]
pub(crate) fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let of_b = sum - a;
    [sum, (a - (sum - of_b)) + (b - of_b)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nan_is_kept_or_passed_over_as_the_name_says() {
        const NAN: f64 = f64::NAN;
        for [a, b] in [[1.0, NAN], [NAN, 1.0], [NAN, NAN]] {
            assert!(min_or_nan(a, b).is_nan() && max_or_nan(a, b).is_nan());
        }
        assert_eq!(max_or_second(NAN, 1.0), 1.0);
        assert!(max_or_second(1.0, NAN).is_nan());
        for [a, b] in [[1.0, 2.0], [2.0, 1.0]] {
            assert_eq!([min_or_nan(a, b), max_or_nan(a, b), max_or_second(a, b)], [1.0, 2.0, 2.0]);
        }
    }
}
