//! Sums with their errors by rounding.

/// Sum of two numbers and its remainder, which is a number (Knuth).
pub(crate) fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let of_b = sum - a;
    [sum, (a - (sum - of_b)) + (b - of_b)]
}
