//! Lower bound of the error in the plane, from quadratic functions.
//!
//! Let b vanish on the contact boundary and the fixed boundary. Then `w + b` is in K with w, and the law's terms of both
//! are the same, so that `|grad (u - w)|^2 - |grad (u - w - b)|^2 = 2 (J(w) - J(w + b)) = 2 r(b) - |grad b|^2`, with
//! `r(b) = (f, b) - (grad w, grad b)`. The best multiple of b gives `|grad (u - w)|^2 >= r(b)^2 / |grad b|^2`. Here b is
//! a sum of bubbles `4 p q` on the edges, p and q the hat functions of the ends, each as large as is best for it alone.

use super::BoundedProblem;
use super::cells::gradient;
use crate::mesh::{BoundarySide, Condition, Element, dot};

/// Rounding errors of a residual, in roundings of its terms.
const ROUNDINGS: f64 = 64.0;

/// Residual of the bubble of an edge.
#[derive(Clone, Copy, Default)]
struct EdgeBubble {
    residual: f64,
    /// Square of the norm of the gradient; infinite if the bubble is left out.
    stiffness: f64,
    /// Sum of the absolute values of the residual's terms.
    magnitude: f64,
}

/// Returns a lower bound of `|grad (u - w)|` for a nodal vector w in K; zero in space.
pub(super) fn lower<const D: usize, const V: usize>(
    problem: &BoundedProblem<'_, D, V>,
    w: &[f64],
) -> f64 {
    if D != 2 {
        return 0.0;
    }
    let &BoundedProblem { mesh, sides, f, .. } = problem;
    let mut bubbles = vec![EdgeBubble::default(); sides.len()];
    for (number, nodes) in mesh.cells().iter().enumerate() {
        let element = Element::new(mesh.vertices(nodes));
        let slope = gradient(&element, nodes.map(|node| w[node as usize]));
        // The mean of f is not enough where f is not constant.
        let is_whole = f.deviation.as_ref().is_none_or(|deviation| deviation[number] == 0.0);
        let stiffness = if is_whole { 4.0 / 3.0 * squares(&element) } else { f64::INFINITY };
        for (side, of_hat) in sides.numbers(number as u32).into_iter().zip(element.gradients) {
            let load = element.volume * f.mean[number] / 3.0;
            let work = 4.0 / 3.0 * element.volume * dot(slope, of_hat);
            let bubble = &mut bubbles[side as usize];
            bubble.residual += load + work;
            bubble.stiffness += stiffness;
            bubble.magnitude += load.abs() + work.abs();
        }
    }
    for (facet, &BoundarySide { side, .. }) in mesh.facets().iter().zip(sides.of_facets()) {
        if mesh.condition(facet) != Condition::Free {
            bubbles[side as usize].stiffness = f64::INFINITY;
        }
    }
    let (mut product, mut rounding) = (0.0, 0.0);
    for bubble in &bubbles {
        let size = bubble.residual / bubble.stiffness;
        product += size * bubble.residual;
        rounding += size.abs() * bubble.magnitude;
    }
    let mut square = 0.0;
    for (number, nodes) in mesh.cells().iter().enumerate() {
        let element = Element::new(mesh.vertices(nodes));
        let sizes = sides.numbers(number as u32).map(|side| {
            let EdgeBubble { residual, stiffness, .. } = bubbles[side as usize];
            residual / stiffness
        });
        let whole = squares(&element);
        for k in 0..V {
            let next = (k + 1) % V;
            let coupling = 2.0 * element.stiffness(k, next);
            square += 4.0 / 3.0 * whole * sizes[k] * sizes[k];
            square += 8.0 / 3.0 * coupling * sizes[k] * sizes[next];
        }
    }
    let product = product - ROUNDINGS * f64::EPSILON * rounding;
    // Sums of as many terms as there are cells.
    let sums = 1.0 - f64::EPSILON * 8.0 * mesh.cells().len() as f64;
    let bound = product.max(0.0) / square.sqrt() * sums;
    if bound.is_finite() { bound } else { 0.0 }
}

/// Sum of the squares of the norms of the gradients of the hat functions on a cell.
fn squares<const D: usize, const V: usize>(element: &Element<D, V>) -> f64 {
    (0..V).map(|k| element.stiffness(k, k)).sum()
}
