//! Lower bound of the error, from quadratic functions.
//!
//! Let b vanish on the contact boundary and the fixed boundary. Then `w + b` is in K with w, and the law's terms of
//! both are the same, so that `|grad (u - w)|^2 - |grad (u - w - b)|^2 = 2 (J(w) - J(w + b)) = 2 r(b) - |grad b|^2`,
//! with `r(b) = (f, b) - (grad w, grad b)`. The best multiple of b gives `|grad (u - w)|^2 >= r(b)^2 / |grad b|^2`.
//! Here b is a sum of bubbles `4 p q` on the edges, p and q the hat functions of the ends, each as large as is best for
//! it alone.

use super::BoundedProblem;
use super::cells::gradient;
use crate::mesh::{Condition, Edges, Element, dot};

/// Rounding errors of a residual, in roundings of its terms.
const ROUNDINGS: f64 = 64.0;

/// Bubble of an edge.
#[derive(Clone, Copy, Default)]
struct EdgeBubble {
    residual: f64,
    /// Square of the norm of the gradient; infinite if the bubble is left out.
    stiffness: f64,
    /// Sum of the absolute values of the residual's terms.
    magnitude: f64,
}

impl EdgeBubble {
    /// Factor that is best for the bubble alone.
    fn size(self) -> f64 {
        self.residual / self.stiffness
    }
}

/// Bubbles on the edges of a cell, by their ends among the vertices.
struct CellBubbles<const D: usize, const V: usize> {
    element: Element<D, V>,
}

impl<const D: usize, const V: usize> CellBubbles<D, V> {
    /// Pairs of vertices.
    fn edges() -> impl Iterator<Item = [usize; 2]> {
        (0..V).flat_map(|j| (0..j).map(move |i| [i, j]))
    }

    /// Integral of the product of the gradients of two bubbles.
    fn product(&self, one: [usize; 2], two: [usize; 2]) -> f64 {
        let mut sum = 0.0;
        for k in 0..2 {
            for l in 0..2 {
                // The integral of the product of two hat functions is twice as large if they are the same.
                let hats = if one[k] == two[l] { 2.0 } else { 1.0 };
                sum += hats * self.element.stiffness(one[1 - k], two[1 - l]);
            }
        }
        16.0 * sum / (V * (V + 1)) as f64
    }
}

/// Returns a lower bound of `|grad (u - w)|` for a nodal vector w in K.
pub(super) fn lower<const D: usize, const V: usize>(
    problem: &BoundedProblem<'_, D, V>,
    w: &[f64],
) -> f64 {
    let &BoundedProblem { mesh, f, .. } = problem;
    let edges = Edges::new(mesh.points().len(), mesh.cells());
    let mut bubbles = vec![EdgeBubble::default(); edges.len()];
    for (number, nodes) in mesh.cells().iter().enumerate() {
        let element = Element::new(mesh.vertices(nodes));
        let slope = gradient(&element, nodes.map(|node| w[node as usize]));
        // The mean of f is not enough where f is not constant.
        let is_whole = f.deviation.as_ref().is_none_or(|deviation| deviation[number] == 0.0);
        let load = 4.0 * f.mean[number] * element.volume / (V * (V + 1)) as f64;
        let cell = CellBubbles { element };
        for [i, j] in CellBubbles::<D, V>::edges() {
            let [p, q] = [i, j].map(|k| dot(slope, cell.element.gradients[k]));
            let work = 4.0 * cell.element.volume * (p + q) / V as f64;
            let bubble = &mut bubbles[edges.between(nodes[i], nodes[j])];
            bubble.residual += load - work;
            bubble.magnitude += load.abs() + work.abs();
            bubble.stiffness += if is_whole { cell.product([i, j], [i, j]) } else { f64::INFINITY };
        }
    }
    for facet in mesh.facets().iter().filter(|facet| mesh.condition(facet) != Condition::Free) {
        for (k, &one) in facet.nodes.iter().enumerate() {
            for &two in &facet.nodes[..k] {
                bubbles[edges.between(one, two)].stiffness = f64::INFINITY;
            }
        }
    }
    let (mut product, mut rounding) = (0.0, 0.0);
    for bubble in &bubbles {
        product += bubble.size() * bubble.residual;
        rounding += bubble.size().abs() * bubble.magnitude;
    }
    let mut square = 0.0;
    for nodes in mesh.cells() {
        let cell = CellBubbles { element: Element::new(mesh.vertices(nodes)) };
        let mut all = [([0; 2], 0.0); 6];
        for (of_edge, [i, j]) in all.iter_mut().zip(CellBubbles::<D, V>::edges()) {
            *of_edge = ([i, j], bubbles[edges.between(nodes[i], nodes[j])].size());
        }
        let all = &all[..V * (V - 1) / 2];
        for (one, of_one) in all {
            for (two, of_two) in all {
                square += of_one * of_two * cell.product(*one, *two);
            }
        }
    }
    let product = product - ROUNDINGS * f64::EPSILON * rounding;
    // Sums of as many terms as there are cells.
    let sums = 1.0 - f64::EPSILON * 16.0 * mesh.cells().len() as f64;
    let bound = product.max(0.0) / square.sqrt() * sums;
    if bound.is_finite() { bound } else { 0.0 }
}
