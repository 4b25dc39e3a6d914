//! Differences of a nodal vector, row by row, and the bubbles that make it a piecewise quadratic function.

use super::flux::{NodeFluxes, through_edges};

/// One row of nodes: differences along it and across it.
///
/// Beyond the boundary the vector continues by reflection plus twice the reaction, so that the five-point
/// equation holds there as inside and every stencil is that of the interior.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeRow {
    pub v: Vec<f64>,
    /// Differences over the edges of this row; the first and the last one lie beyond the boundary.
    pub along: Vec<f64>,
    /// Third differences over the edges of this row.
    pub third: Vec<f64>,
    /// Second differences across the row.
    pub across: Vec<f64>,
    /// Sum of both second differences.
    pub laplacian: Vec<f64>,
    /// Coefficients of the bubbles on the edges of this row.
    pub bubble: Vec<f64>,
}

/// What lies between two rows of nodes: the vertical edges.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeRow {
    pub along: Vec<f64>,
    pub third: Vec<f64>,
    pub bubble: Vec<f64>,
}

impl NodeRow {
    pub(super) fn new(n: usize) -> Self {
        let nodes = || vec![0.0; n + 1];
        Self {
            v: nodes(),
            along: vec![0.0; n + 2],
            third: vec![0.0; n],
            across: nodes(),
            laplacian: nodes(),
            bubble: vec![0.0; n],
        }
    }

    /// Sets the row from its values, the differences to the rows below and above, and the reactions at
    /// its ends.
    #[inline(always)]
    pub(super) fn set(&mut self, v: &[f64], below: &[f64], above: &[f64], [left, right]: [f64; 2]) {
        let n = v.len() - 1;
        self.v.copy_from_slice(v);
        for (along, (&right, &left)) in self.along[1..=n].iter_mut().zip(v[1..].iter().zip(v)) {
            *along = right - left;
        }
        self.along[0] = -self.along[1] - 2.0 * left;
        self.along[n + 1] = -self.along[n] + 2.0 * right;
        let along = &self.along[..n + 2];
        let (across, laplacian) = (&mut self.across[..n + 1], &mut self.laplacian[..n + 1]);
        let (below, above) = (&below[..n + 1], &above[..n + 1]);
        for i in 0..=n {
            across[i] = above[i] - below[i];
            laplacian[i] = (along[i + 1] - along[i]) + across[i];
        }
        let (third, bubble) = (&mut self.third[..n], &mut self.bubble[..n]);
        for i in 0..n {
            third[i] = (along[i + 2] - along[i + 1]) - (along[i + 1] - along[i]);
            bubble[i] = 0.25 * (along[i + 2] - along[i]);
        }
    }

    /// The largest |v|.
    #[inline(always)]
    pub(super) fn largest(&self) -> f64 {
        const LANES: usize = 16;
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        let (blocks, rest) = self.v.as_chunks::<LANES>();
        let mut largest = [0.0; LANES];
        for block in blocks {
            for (largest, v) in largest.iter_mut().zip(block) {
                *largest = larger(v.abs(), *largest);
            }
        }
        rest.iter().map(|v| v.abs()).chain(largest).fold(0.0, larger)
    }

    /// Adds to the bubbles the slopes of the fluxes that f needs at its seams; `lower` to `upper` are
    /// the fluxes around the nodes of the row below, this one and the one above.
    pub(super) fn follow_seams(&mut self, [lower, here, upper]: [&NodeFluxes; 3], ends: [bool; 2]) {
        let n = self.bubble.len();
        let share = if ends[0] || ends[1] { 0.5 } else { 0.25 };
        let mut add = |lower: &NodeFluxes, upper: &NodeFluxes| {
            for_each_near(n, &[&lower.seams, &upper.seams], |i| {
                let [left, right, ..] = through_edges(lower, upper, i);
                self.bubble[i] += share * (right - left);
            });
        };
        if !ends[0] {
            add(lower, here);
        }
        if !ends[1] {
            add(here, upper);
        }
    }
}

impl EdgeRow {
    pub(super) fn new(n: usize) -> Self {
        let nodes = || vec![0.0; n + 1];
        Self { along: nodes(), third: nodes(), bubble: nodes() }
    }

    /// Sets third differences and bubbles from the second differences in the rows below and above.
    #[inline(always)]
    pub(super) fn set(&mut self, below: &[f64], above: &[f64]) {
        let nodes = self.third.len();
        let (third, bubble) = (&mut self.third[..nodes], &mut self.bubble[..nodes]);
        let (below, above) = (&below[..nodes], &above[..nodes]);
        for i in 0..nodes {
            third[i] = above[i] - below[i];
            bubble[i] = 0.25 * (above[i] + below[i]);
        }
    }

    /// As [`NodeRow::follow_seams`], for the edges between two rows of nodes.
    pub(super) fn follow_seams(&mut self, lower: &NodeFluxes, upper: &NodeFluxes) {
        let n = self.bubble.len() - 1;
        for_each_near(n, &[&lower.seams, &upper.seams], |i| {
            let [.., bottom, top] = through_edges(lower, upper, i);
            for node in [i, i + 1] {
                let share = if node == 0 || node == n { 0.5 } else { 0.25 };
                self.bubble[node] += share * (top - bottom);
            }
        });
    }
}

/// Calls `cell` once for each cell of a row next to a node of the seams.
fn for_each_near(n: usize, seams: &[&Vec<[usize; 2]>], mut cell: impl FnMut(usize)) {
    for [from, to] in union(n, seams.iter().map(|seams| &seams[..]), [1, 0]) {
        (from..=to).for_each(&mut cell);
    }
}

/// The cells of a row of `n` within `before` cells left and `after` right of seams' nodes, as disjoint
/// inclusive ranges.
pub(super) fn union<'a>(
    n: usize,
    seams: impl Iterator<Item = &'a [[usize; 2]]>,
    [before, after]: [usize; 2],
) -> Vec<[usize; 2]> {
    let mut all: Vec<[usize; 2]> = seams
        .flatten()
        .map(|&[from, to]| [from.saturating_sub(before), (to + after).min(n - 1)])
        .collect();
    all.sort_unstable();
    let mut joined: Vec<[usize; 2]> = Vec::with_capacity(all.len());
    for [from, to] in all {
        match joined.last_mut() {
            Some(last) if from <= last[1] + 1 => last[1] = last[1].max(to),
            _ => joined.push([from, to]),
        }
    }
    joined
}

/// The coefficient of the bubble on an edge of the boundary with end values `p` and `q`, cut so that the
/// function stays nonnegative: its Bernstein coefficients are p, (p + q - c) / 2 and q.
pub(super) fn admissible(bubble: f64, p: f64, q: f64) -> f64 {
    if p == 0.0 && q == 0.0 { 0.0 } else { bubble.min(p + q) }
}
