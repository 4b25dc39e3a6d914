//! Gauss rules on (0, 1), interpolation and integration between their nodes, and parts of a range to apply them to.

use super::SpectralParams;
use std::f64::consts::PI;

/// Ratio of neighbouring panels towards corners and crossings.
const RATIO: f64 = 8.0;

/// Node of a Gauss rule on (0, 1).
#[derive(Clone, Copy)]
pub(super) struct GaussNode {
    pub x: f64,
    pub weight: f64,
}

impl GaussNode {
    /// Node of the rule on the range from `from` to `to`.
    pub(super) fn on(self, [from, to]: [f64; 2]) -> Self {
        let length = to - from;
        Self { x: from + length * self.x, weight: length * self.weight }
    }
}

/// Rules of one resolution.
#[derive(Clone)]
pub(super) struct Rules {
    /// Nodes of the sources: one more than targets, so that they interlace.
    pub plain: Vec<GaussNode>,
    /// Nodes of the targets.
    pub targets: Vec<GaussNode>,
    /// Matrix from values at the targets to integrals from the start of the panel to each target, row by row.
    pub integrals: Vec<f64>,
    /// Nodes of a graded panel, as fractions of its length from the corner.
    pub near: Vec<GaussNode>,
}

impl Rules {
    pub(super) fn new(SpectralParams { nodes, levels }: SpectralParams) -> Self {
        let plain = gauss(nodes + 1);
        let mut near = Vec::with_capacity(plain.len() * (levels as usize + 1));
        let mut to = 1.0;
        for level in 0..=levels {
            let from = if level == levels { 0.0 } else { to / RATIO };
            near.extend(plain.iter().map(|node| node.on([from, to])));
            to = from;
        }
        let targets = gauss(nodes);
        Self { integrals: integration(&targets), targets, plain, near }
    }

    /// Integrates a function along a piece from its value `start` at the start of the piece. Returns its values at the
    /// targets, and at the end of the piece. The `changes` are derivatives at the targets times the weights there; the
    /// targets of a reversed piece are counted from its end.
    pub(super) fn integrate(
        &self,
        start: f64,
        reversed: bool,
        changes: impl Iterator<Item = f64>,
    ) -> (Vec<f64>, f64) {
        let rates: Vec<f64> = changes.zip(&self.targets).map(|(c, node)| c / node.weight).collect();
        let total: f64 = rates.iter().zip(&self.targets).map(|(r, node)| r * node.weight).sum();
        let mut values = Vec::with_capacity(rates.len());
        for row in self.integrals.chunks_exact(rates.len()) {
            let part: f64 = row.iter().zip(&rates).map(|(m, r)| m * r).sum();
            values.push(start + if reversed { total - part } else { part });
        }
        (values, start + total)
    }
}

/// Nodes and weights of the Gauss-Legendre rule with `n` nodes on (0, 1), ascending.
pub(super) fn gauss(n: usize) -> Vec<GaussNode> {
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

/// Matrix that interpolates values at Gauss nodes to the points `x`, row by row for the points.
pub(super) fn interpolation(rule: &[GaussNode], x: &[f64]) -> Vec<f64> {
    // Barycentric weights of Gauss nodes (Wang and Xiang 2012).
    let mut weights = Vec::with_capacity(rule.len());
    for (i, &GaussNode { x, weight }) in rule.iter().enumerate() {
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        weights.push(sign * (x * (1.0 - x) * weight).sqrt());
    }
    let mut matrix = Vec::with_capacity(rule.len() * x.len());
    for &x in x {
        if rule.iter().any(|node| node.x == x) {
            matrix.extend(rule.iter().map(|node| if node.x == x { 1.0 } else { 0.0 }));
            continue;
        }
        let row = matrix.len();
        matrix.extend(rule.iter().zip(&weights).map(|(node, weight)| weight / (x - node.x)));
        let sum: f64 = matrix[row..].iter().sum();
        matrix[row..].iter_mut().for_each(|entry| *entry /= sum);
    }
    matrix
}

/// Matrix that takes values at Gauss nodes to integrals from 0 to each node, row by row.
fn integration(rule: &[GaussNode]) -> Vec<f64> {
    let n = rule.len();
    // A polynomial is its Legendre series, whose coefficients the rule gives exactly.
    let values: Vec<Vec<f64>> = rule.iter().map(|node| legendre(n, 2.0 * node.x - 1.0)).collect();
    let mut matrix = Vec::with_capacity(n * n);
    for (to, target) in values.iter().zip(rule) {
        let integrals: Vec<f64> = (1..n).map(|k| to[k + 1] - to[k - 1]).collect();
        for (at, node) in values.iter().zip(rule) {
            let sum: f64 = integrals.iter().zip(&at[1..]).map(|(i, p)| i * p).sum();
            matrix.push(node.weight * (target.x + 0.5 * sum));
        }
    }
    matrix
}

/// Parts of a range, in order: each part for which `at` returns a point is cut there.
pub(super) fn cut(range: [f64; 2], at: impl Fn([f64; 2]) -> Option<f64>) -> Vec<[f64; 2]> {
    let (mut left, mut parts) = (vec![range], Vec::new());
    while let Some(part @ [from, to]) = left.pop() {
        match at(part) {
            Some(middle) => left.extend([[middle, to], [from, middle]]),
            None => parts.push(part),
        }
    }
    parts
}

/// Parts of a range, in order, halved until none is too long.
pub(super) fn halved(range: [f64; 2], too_long: impl Fn([f64; 2]) -> bool) -> Vec<[f64; 2]> {
    cut(range, |part| too_long(part).then_some(0.5 * (part[0] + part[1])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn power(x: f64, k: i32) -> f64 {
        (0..k).fold(1.0, |p, _| p * x)
    }

    #[test]
    fn polynomials_are_integrated_and_interpolated_exactly() {
        let rule = gauss(9);
        let integral: f64 = rule.iter().map(|node| node.weight * power(node.x, 17)).sum();
        assert!((integral - 1.0 / 18.0).abs() < 1e-16);
        let matrix = interpolation(&rule, &[0.013, 0.77]);
        for (row, x) in matrix.chunks(9).zip([0.013, 0.77]) {
            let value: f64 = row.iter().zip(&rule).map(|(m, node)| m * power(node.x, 8)).sum();
            assert!((value - power(x, 8)).abs() < 1e-15);
        }
        let matrix = integration(&rule);
        for (row, &GaussNode { x, .. }) in matrix.chunks(9).zip(&rule) {
            let value: f64 = row.iter().zip(&rule).map(|(m, node)| m * power(node.x, 8)).sum();
            assert!((value - power(x, 9) / 9.0).abs() < 1e-15, "{x}");
        }
    }
}
