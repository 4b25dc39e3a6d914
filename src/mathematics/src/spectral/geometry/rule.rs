//! Gauss rules on (0, 1), and parts of a range to apply them to.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// Node of a Gauss rule on (0, 1).
#[derive(Clone, Copy)]
pub(in crate::spectral) struct GaussNode {
    pub x: f64,
    pub weight: f64,
}

/// Most nodes of a rule.
const MOST: usize = 48;

/// Nodes and weights of the Gauss-Legendre rule with `n` nodes on (0, 1), 48 at most, ascending.
pub(in crate::spectral) fn gauss(n: usize) -> &'static [GaussNode] {
    static RULES: [OnceLock<Vec<GaussNode>>; MOST + 1] = [const { OnceLock::new() }; MOST + 1];
    RULES[n].get_or_init(|| found(n))
}

/// Finds a rule.
fn found(n: usize) -> Vec<GaussNode> {
    let mut rule = vec![GaussNode { x: 0.5, weight: 1.0 }; n];
    for i in 0..n.div_ceil(2) {
        let mut x = libm::cos(PI * (i as f64 + 0.75) / (n as f64 + 0.5));
        let mut slope = 1.0;
        // The first guess has two digits at least, and each step doubles them; the slope is that before it.
        for _ in 0..5 {
            let values = legendre(n, x);
            let (p, q) = (values[n], values[n - 1]);
            slope = n as f64 * (x * p - q) / (x * x - 1.0);
            x -= p / slope;
        }
        let weight = 1.0 / ((1.0 - x * x) * slope * slope);
        rule[i] = GaussNode { x: 0.5 * (1.0 - x), weight };
        rule[n - 1 - i] = GaussNode { x: 0.5 * (1.0 + x), weight };
    }
    rule
}

/// Legendre polynomials of degrees 0 to `n` at `x`.
fn legendre(n: usize, x: f64) -> Vec<f64> {
    let mut values = Vec::with_capacity(n + 1);
    values.extend([1.0, x]);
    for k in 1..n {
        let part = k as f64 / (k as f64 + 1.0);
        let lifted = x * values[k];
        values.push(lifted + part * (lifted - values[k - 1]));
    }
    values
}

/// Parts of a range, in order: each part for which `at` returns a point between its ends is cut there.
pub(in crate::spectral) fn cut(
    range: [f64; 2],
    at: impl Fn([f64; 2]) -> Option<f64>,
) -> Vec<[f64; 2]> {
    let (mut left, mut parts) = (vec![range], Vec::new());
    while let Some(part @ [from, to]) = left.pop() {
        // No number lies between neighbours.
        match at(part).filter(|&middle| from < middle && middle < to) {
            Some(middle) => left.extend([[middle, to], [from, middle]]),
            None => parts.push(part),
        }
    }
    parts
}

/// Parts of a range, in order, halved until none is too long.
pub(in crate::spectral) fn halved(
    range: [f64; 2],
    too_long: impl Fn([f64; 2]) -> bool,
) -> Vec<[f64; 2]> {
    cut(range, |part| too_long(part).then_some(0.5 * (part[0] + part[1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power(x: f64, k: i32) -> f64 {
        (0..k).fold(1.0, |p, _| p * x)
    }

    #[test]
    fn ranges_are_cut_until_no_number_lies_between() {
        let range = [0.3, 0.3 + 3.0 * f64::EPSILON];
        let parts = halved(range, |_| true);
        assert_eq!((parts[0][0], parts[parts.len() - 1][1]), (range[0], range[1]));
        assert!(parts.iter().all(|&[from, to]| to.to_bits() == from.to_bits() + 1), "{parts:?}");
    }

    #[test]
    fn polynomials_are_integrated_exactly() {
        let rule = gauss(9);
        let integral: f64 = rule.iter().map(|node| node.weight * power(node.x, 17)).sum();
        assert!((integral - 1.0 / 18.0).abs() < 1e-16);
    }
}
