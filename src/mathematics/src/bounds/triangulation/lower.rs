//! Lower bound of the error, from quadratic functions.
//!
//! Let b vanish on the boundary but for its free parts, with the flux h. Then `w + b` is in K with w, and the law's
//! terms of both are the same, so that `|u - w|^2 - |u - w - b|^2 = 2 (J(w) - J(w + b)) = 2 r(b) - |b|^2` in the energy
//! norm, with `r(b) = (f, b) + <h, b> - (k grad w, grad b) - (c w, b)`. The best multiple of b gives `|u - w|^2 >=
//! r(b)^2 / |b|^2`. Here b is a sum of bubbles `4 p q` on the edges, p and q the hat functions of the ends, each as
//! large as is best for it alone.

use super::BoundedProblem;
use super::cells::{COST, at_nodes, gradient};
use super::linear::product;
use crate::bounds::boundary::PartLaw;
use crate::machine::threads::{among_threads, for_runs, items_per_task, map_range};
use crate::mesh::{BoundarySide, Element, Mesh, Sides, dot, measure};
use crate::problem::law::Law;

/// Rounding errors of a residual, in roundings of its terms.
const ROUNDINGS: f64 = 64.0;
/// Number of cells between which their parts are added to the bubbles.
const RUN: usize = 1 << 12;
/// Most edges of a cell.
const MOST_EDGES: usize = 6;

/// Bubble of an edge.
#[derive(Clone, Copy, Default)]
struct EdgeBubble {
    residual: f64,
    /// Square of the energy norm; infinite if the bubble is left out.
    stiffness: f64,
    /// Sum of the absolute values of the residual's terms.
    magnitude: f64,
}

/// Pairs of vertices of a cell.
fn pairs<const V: usize>() -> &'static [[usize; 2]] {
    const PAIRS: [[usize; 2]; MOST_EDGES] = [[0, 1], [0, 2], [1, 2], [0, 3], [1, 3], [2, 3]];
    &PAIRS[..V * (V - 1) / 2]
}

/// Returns a lower bound of the energy norm of `u - w` for a nodal vector w in K.
pub(super) fn lower<const D: usize, const V: usize>(
    problem: &BoundedProblem<'_, D, V>,
    w: &[f64],
) -> f64 {
    let mesh = problem.mesh;
    among_threads(COST * mesh.cells().len(), || {
        let bubbles = bubbles(problem, w);
        let (mut product, mut rounding) = (0.0, 0.0);
        let mut sizes = Vec::with_capacity(bubbles.len());
        for EdgeBubble { residual, stiffness, magnitude } in bubbles {
            // The factor that is best for the bubble alone.
            let size = residual / stiffness;
            product += size * residual;
            rounding += size.abs() * magnitude;
            sizes.push(size);
        }
        let square = square(mesh, problem.sides, &sizes);
        let product = product - ROUNDINGS * f64::EPSILON * rounding;
        // Sums of as many terms as there are cells.
        let sums = 1.0 - f64::EPSILON * 16.0 * mesh.cells().len() as f64;
        let bound = product.max(0.0) / square.sqrt() * sums;
        if bound.is_finite() { bound } else { 0.0 }
    })
}

/// Bubbles on all edges.
fn bubbles<const D: usize, const V: usize>(
    problem: &BoundedProblem<'_, D, V>,
    w: &[f64],
) -> Vec<EdgeBubble> {
    let &BoundedProblem { mesh, sides, f, .. } = problem;
    let of_cell = |number: usize, parts: &mut [EdgeBubble]| {
        let nodes = &mesh.cells()[number];
        let (element, k) = (Element::new(mesh.vertices(nodes)), mesh.k(number));
        let slope = gradient(&element, at_nodes(nodes, w)).map(|slope| k * slope);
        // The mean of f is not enough where f is not constant.
        let is_whole = f.cells.deviation.as_ref().is_none_or(|deviation| deviation[number] == 0.0);
        let load = 4.0 * f.cells.mean[number] * element.volume / (V * (V + 1)) as f64;
        for (part, &[i, j]) in parts.iter_mut().zip(pairs::<V>()) {
            let [p, q] = [element.gradients[i], element.gradients[j]];
            let work = 4.0 * element.volume * (dot(slope, p) + dot(slope, q)) / V as f64;
            let square = 2.0 * (dot(p, p) + dot(q, q) + dot(p, q));
            let mut stiffness = k * 16.0 * element.volume * square / (V * (V + 1)) as f64;
            let mut load = load;
            if mesh.reaction > 0.0 {
                let values = at_nodes(nodes, w);
                let around = values.iter().sum::<f64>() + values[i] + values[j];
                let part = 4.0 * mesh.reaction * element.volume / (V * (V + 1) * (V + 2)) as f64;
                load -= part * around;
                stiffness += mesh.reaction * bubbles_product::<V>(element.volume, [i, j], [i, j]);
            }
            let stiffness = if is_whole { stiffness } else { f64::INFINITY };
            let (residual, magnitude) = (load - work, load.abs() + work.abs());
            *part = EdgeBubble { residual, stiffness, magnitude };
        }
    };
    let mut bubbles = vec![EdgeBubble::default(); sides.edges()];
    let edges = pairs::<V>().len();
    let mut parts = vec![EdgeBubble::default(); edges * RUN.min(mesh.cells().len())];
    let each = items_per_task(parts.len() / edges, COST);
    for (start, cells) in (0..).step_by(RUN).zip(mesh.cells().chunks(RUN)) {
        let parts = &mut parts[..edges * cells.len()];
        for_runs(parts, edges * each, &|run, parts| {
            let numbers = start + run * each..;
            numbers.zip(parts.chunks_exact_mut(edges)).for_each(|(k, parts)| of_cell(k, parts));
        });
        for (number, parts) in (start..).zip(parts.chunks_exact(edges)) {
            for (k, &ends) in pairs::<V>().iter().enumerate() {
                let part = parts[k];
                let bubble = &mut bubbles[sides.edge(number as u32, ends)];
                bubble.residual += part.residual;
                bubble.stiffness += part.stiffness;
                bubble.magnitude += part.magnitude;
            }
        }
    }
    for (facet, &BoundarySide { side, cell }) in mesh.facets().iter().zip(sides.of_facets()) {
        let law = mesh.law(facet);
        // The bubble of an edge has this part of the flux through a facet.
        let given =
            4.0 / (D * (D + 1)) as f64 * PartLaw::new(law, measure(mesh.corners(facet))).least;
        if law != Law::FREE {
            let opposite = sides.slot(cell, side);
            for &ends in pairs::<V>().iter().filter(|ends| !ends.contains(&opposite)) {
                let edge = sides.edge(cell, ends);
                if law.is_free() {
                    bubbles[edge].residual += given;
                    bubbles[edge].magnitude += given.abs();
                } else {
                    bubbles[edge].stiffness = f64::INFINITY;
                }
            }
        }
    }
    bubbles
}

/// Integral over a cell of the product of two bubbles on edges: that of four hat functions has a factor of 4, 2 or 1
/// where the edges have two, one or no node in common.
fn bubbles_product<const V: usize>(volume: f64, one: [usize; 2], two: [usize; 2]) -> f64 {
    let common = one.iter().filter(|end| two.contains(end)).count();
    16.0 * volume * [1.0, 2.0, 4.0][common] / (V * (V + 1) * (V + 2) * (V + 3)) as f64
}

/// Square of the energy norm of the sum of bubbles with these sizes.
fn square<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    sides: &Sides<V>,
    sizes: &[f64],
) -> f64 {
    let of_cell = |number: usize| {
        let nodes = &mesh.cells()[number];
        let Element { volume, gradients, .. } = Element::new(mesh.vertices(nodes));
        // The gradient of 4 p q is 4 grad q where p is 1.
        let mut slopes = [[0.0; D]; V];
        for &[i, j] in pairs::<V>() {
            let size = 4.0 * sizes[sides.edge(number as u32, [i, j])];
            for d in 0..D {
                slopes[i][d] += size * gradients[j][d];
                slopes[j][d] += size * gradients[i][d];
            }
        }
        let mut sum = mesh.k(number) * product(volume, &slopes, &slopes);
        if mesh.reaction > 0.0 {
            let size = |ends: &[usize; 2]| sizes[sides.edge(number as u32, *ends)];
            for one in pairs::<V>() {
                for two in pairs::<V>() {
                    let product = bubbles_product::<V>(volume, *one, *two);
                    sum += mesh.reaction * size(one) * size(two) * product;
                }
            }
        }
        sum
    };
    let runs = 0..mesh.cells().len().div_ceil(RUN);
    let each = items_per_task(runs.len(), COST * RUN);
    let of_runs = map_range(runs, each, |run| -> f64 {
        (RUN * run..mesh.cells().len().min(RUN * (run + 1))).map(of_cell).sum()
    });
    of_runs.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::quadrature::{QuadraturePoint, quadrature};
    use crate::mesh::{BuiltIn, uniform_cube};

    /// Integral of the product of the gradients of two bubbles on a cell.
    fn product<const D: usize, const V: usize>(
        element: &Element<D, V>,
        one: [usize; 2],
        two: [usize; 2],
    ) -> f64 {
        let mut sum = 0.0;
        for (k, l) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            // The integral of the product of two hat functions is twice as large if they are the same.
            let hats = if one[k] == two[l] { 2.0 } else { 1.0 };
            sum += hats * element.stiffness(one[1 - k], two[1 - l]);
        }
        16.0 * sum / (V * (V + 1)) as f64
    }

    fn check<const D: usize, const V: usize>(mut mesh: Mesh<D, V>) {
        (mesh.k, mesh.reaction) = (vec![3.0], 700.0);
        let (mesh, sides) = (&mesh, Sides::new(&mesh));
        let sizes: Vec<_> =
            (0..sides.edges()).map(|edge| libm::sin(78.233 * edge as f64)).collect();
        let mut expected = 0.0;
        for (number, nodes) in mesh.cells().iter().enumerate() {
            let element = Element::new(mesh.vertices(nodes));
            for (&one, &two) in
                pairs::<V>().iter().flat_map(|one| pairs::<V>().iter().map(move |two| (one, two)))
            {
                let [p, q] = [one, two].map(|ends| sizes[sides.edge(number as u32, ends)]);
                expected += 3.0 * p * q * product(&element, one, two);
                for QuadraturePoint { barycentric: b, weight } in quadrature::<V>() {
                    let bubbles = 16.0 * b[one[0]] * b[one[1]] * b[two[0]] * b[two[1]];
                    expected += 700.0 * p * q * element.volume * weight * bubbles;
                }
            }
        }
        let found = square(mesh, &sides, &sizes);
        assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
    }

    #[test]
    fn bubbles_that_overlap_have_the_norm_of_their_sum() {
        check(BuiltIn::LShape.plane().unwrap());
        check(uniform_cube(2));
    }
}
