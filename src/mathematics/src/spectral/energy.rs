//! Energy of the solution, and moments of f, from integrals over the boundary and along the jumps of f.

use super::along::Node;
use super::jumps::{JumpEdge, Jumps};
use super::place::{BoundaryPlace, CORNERS};
use super::problem::SpectralProblem;
use super::rule::Rules;
use super::sources::Point;
use super::trace::Trace;
use crate::problem::complex::Complex;

/// Integrals over the boundary and over the square.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Energies {
    /// `J = -1/2 int f v - 1/2 int l v`, the first by Green's identity with psi; the second is zero for the paper's
    /// law.
    pub energy: f64,
    /// J by Rellich's identity.
    pub rellich: f64,
    /// Integral of l over the boundary.
    pub force: f64,
    /// Integral of l v over the boundary: less that of the law's potential.
    work: f64,
    /// Integrals of f times the [`HARMONIC`] polynomials, by Green's identity with psi on the boundary.
    contour: [f64; HARMONIC],
    /// Integrals of f times the polynomials, by the divergence theorem, over the boundary and along the jumps.
    area: [f64; HARMONIC],
}

/// Polynomials for which moments of f are compared: 1, x, y, xy and x^2 - y^2.
const HARMONIC: usize = 5;
const DEGREES: [f64; HARMONIC] = [0.0, 1.0, 1.0, 2.0, 2.0];

/// Values of the polynomials at a point.
fn harmonic(Complex { re: x, im: y }: Complex) -> [f64; HARMONIC] {
    [1.0, x, y, x * y, (x - y) * (x + y)]
}

/// Gradients of the polynomials at a point.
fn harmonic_gradients(Complex { re: x, im: y }: Complex) -> [Complex; HARMONIC] {
    let gradients = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [y, x], [2.0 * x, -2.0 * y]];
    gradients.map(|[x, y]| Complex::new(x, y))
}

impl Energies {
    pub(super) fn new(trace: &Trace, problem: &SpectralProblem) -> Self {
        let (mut energies, bilinear) = (Self::default(), Bilinear::new(problem));
        energies.add_boundary(trace, problem, &bilinear);
        energies.add_edges(problem, &bilinear, &trace.rules);
        let Self { energy, rellich, work, .. } = energies;
        let [energy, rellich] = [0.5 * energy, 0.25 * rellich].map(|part| -part - 0.5 * work);
        Self { energy, rellich, ..energies }
    }

    /// Largest difference of the moments of f by psi and by the jumps from the moments of the pieces in closed form:
    /// the energy may be wrong by this, times the size of v.
    pub(super) fn moments_off(&self, problem: &SpectralProblem) -> f64 {
        let mut largest = 0.0_f64;
        for (k, moment) in problem.moments.iter().enumerate() {
            let [contour, area] = [self.contour[k], self.area[k]].map(|m| (m - moment).abs());
            largest = largest.max(contour.max(area));
        }
        largest
    }

    fn add_boundary(&mut self, trace: &Trace, problem: &SpectralProblem, bilinear: &Bilinear) {
        let values: Vec<f64> = trace.panels.iter().map(|panel| problem.beside(panel)).collect();
        for point in &trace.points {
            let panel = &trace.panels[point.panel];
            let z = point.place.point();
            let (tangent, normal) = (panel.tangent, -panel.tangent.turned());
            let Point { weight, value: v, multiplier: l, along, .. } = *point;
            let (psi, gradient) = bilinear.less(z, point.psi, point.gradient);
            let (psi_n, psi_s) = (gradient.dot(normal), gradient.dot(tangent));
            let f = values[point.panel];
            let (outward, square) = (z.dot(normal), 0.25 * z.norm2());
            self.energy += weight
                * (f * (0.5 * outward * psi - square * psi_n - 0.25 * f * outward * square)
                    + psi * l
                    - v * psi_n);
            self.force += weight * l;
            self.work += weight * l * v;
            let (polynomials, slopes) = (harmonic(z), harmonic_gradients(z));
            for k in 0..HARMONIC {
                self.contour[k] += weight * (psi * slopes[k].dot(normal) - polynomials[k] * psi_n);
                self.area[k] += weight * f * polynomials[k] * outward / (DEGREES[k] + 2.0);
            }
            let (h, h_s) = (v - psi, along - psi_s);
            let tau = z.dot(tangent);
            let u = z.dot(gradient) - 2.0 * psi;
            self.rellich += weight
                * (outward * (f * v + 0.5 * (l * l - along * along)) + tau * l * along
                    - outward * f * h
                    + outward * h_s * psi_s
                    - 2.0 * h * psi_n
                    - tau * h_s * psi_n
                    - u * (l - psi_n));
        }
    }

    fn add_edges(&mut self, problem: &SpectralProblem, bilinear: &Bilinear, rules: &Rules) {
        let Jumps { edges, psi, .. } = &problem.jumps;
        // psi at the vertices, as far as it is known.
        let mut at_vertices: Vec<Option<f64>> = vec![None; psi.vertices.len()];
        let mut waiting: Vec<&JumpEdge> = edges.iter().collect();
        while !waiting.is_empty() {
            // First those with an end at which psi is known, or on the boundary.
            let next = waiting
                .iter()
                .position(|edge| edge.arc.ends.into_iter().any(|end| is_known(end, &at_vertices)));
            let &JumpEdge { mut arc, values } = waiting.swap_remove(next.unwrap_or(0));
            if is_known(arc.ends[1], &at_vertices) && !is_known(arc.ends[0], &at_vertices) {
                arc = arc.reversed();
            }
            let start = match arc.ends[0].and_then(|v| at_vertices[v]) {
                Some(psi) => psi,
                None => problem.psi(arc.curve.at(arc.span[0]), rules),
            };
            let end = problem.along(arc, start, rules, |node, psi| {
                self.add_node(node, psi, values, bilinear);
            });
            for (vertex, psi) in arc.ends.into_iter().zip([start, end]) {
                if let Some(v) = vertex {
                    at_vertices[v] = Some(psi);
                }
            }
        }
    }

    /// Adds a node on an edge, with psi there and f on the left and on the right.
    fn add_node(&mut self, node: &Node, psi: f64, [left, right]: [f64; 2], bilinear: &Bilinear) {
        let Node { point, normal, weight, gradient } = *node;
        let (psi, gradient) = bilinear.less(point, psi, gradient);
        let (outward, square) = (point.dot(normal), 0.25 * point.norm2());
        let moment =
            (0.5 * psi - 0.25 * (left + right) * square) * outward - square * gradient.dot(normal);
        self.energy += weight * (left - right) * moment;
        self.rellich += weight * (left - right) * outward * psi;
        for (k, polynomial) in harmonic(point).into_iter().enumerate() {
            self.area[k] += weight * (left - right) * polynomial * outward / (DEGREES[k] + 2.0);
        }
    }
}

/// True if psi is known at an end of an edge: at a vertex, or on the boundary.
fn is_known(end: Option<usize>, at_vertices: &[Option<f64>]) -> bool {
    end.is_none_or(|v| at_vertices[v].is_some())
}

/// Bilinear function that equals psi in the corners, where l is least accurate.
struct Bilinear([f64; 4]);

impl Bilinear {
    fn new(problem: &SpectralProblem) -> Self {
        let mut c = [0.0; 4];
        for z in CORNERS {
            let value = problem.boundary_psi.value(BoundaryPlace::nearest(z));
            let basis = [0.25, z.re, z.im, 4.0 * z.re * z.im];
            for (c, b) in c.iter_mut().zip(basis) {
                *c += b * value;
            }
        }
        Self(c)
    }

    /// Subtracts the function from a `value` and a `gradient` at a point.
    fn less(&self, z: Complex, value: f64, gradient: Complex) -> (f64, Complex) {
        let [c, x, y, xy] = self.0;
        let plane = c + x * z.re + y * z.im + xy * z.re * z.im;
        (value - plane, gradient - Complex::new(x + xy * z.im, y + xy * z.re))
    }
}
