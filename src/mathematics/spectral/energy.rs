//! The energy of the solution, from integrals over the border and along the jumps of f, and moments of f by the same.

use super::along::Node;
use super::complex::Complex;
use super::jumps::{Edge, Jumps};
use super::place::{CORNERS, Place};
use super::problem::Problem;
use super::rule::Rules;
use super::sources::Point;
use super::trace::Trace;

/// Integrals over the border and over the square.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Energies {
    /// J = -1/2 int f v, by Green's identity with psi.
    pub energy: f64,
    /// The same by Rellich's identity.
    pub rellich: f64,
    /// Integral of l over the border.
    pub force: f64,
    /// Integrals of f times the [`HARMONIC`] polynomials, by Green's identity with psi on the border.
    contour: [f64; HARMONIC],
    /// The same by the divergence theorem, over the border and along the jumps.
    area: [f64; HARMONIC],
}

/// Polynomials for which moments of f are compared: 1, x, y, xy and x^2 - y^2.
const HARMONIC: usize = 5;
const DEGREES: [f64; HARMONIC] = [0.0, 1.0, 1.0, 2.0, 2.0];

/// The polynomials and their gradients.
fn harmonic(Complex { re: x, im: y }: Complex) -> [(f64, Complex); HARMONIC] {
    let gradients = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [y, x], [2.0 * x, -2.0 * y]];
    let values = [1.0, x, y, x * y, (x - y) * (x + y)];
    std::array::from_fn(|k| (values[k], Complex::new(gradients[k][0], gradients[k][1])))
}

impl Energies {
    pub(super) fn of(trace: &Trace, problem: &Problem) -> Self {
        let (mut energies, bilinear) = (Self::default(), Bilinear::new(problem));
        energies.add_border(trace, problem, &bilinear);
        energies.add_edges(problem, &bilinear, &trace.rules);
        Self { energy: -0.5 * energies.energy, rellich: -0.25 * energies.rellich, ..energies }
    }

    /// The largest difference of moments of f, as psi and the jumps have them, from those of its pieces in closed form:
    /// times a size of v it is by how much the energy may be off.
    pub(super) fn moments_off(&self, problem: &Problem) -> f64 {
        let differences = problem.moments.iter().zip(self.contour.iter().zip(&self.area));
        differences.map(|(m, (c, a))| (c - m).abs().max((a - m).abs())).fold(0.0, f64::max)
    }

    fn add_border(&mut self, trace: &Trace, problem: &Problem, bilinear: &Bilinear) {
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
            for (k, (p, slope)) in harmonic(z).into_iter().enumerate() {
                self.contour[k] += weight * (psi * slope.dot(normal) - p * psi_n);
                self.area[k] += weight * f * p * outward / (DEGREES[k] + 2.0);
            }
            let (h, h_s) = (v - psi, along - psi_s);
            let tau = z.dot(tangent);
            let u = z.dot(gradient) - 2.0 * psi;
            self.rellich += weight
                * (outward * (f * v + 0.5 * (l * l - along * along)) - outward * f * h
                    + outward * h_s * psi_s
                    - 2.0 * h * psi_n
                    - tau * h_s * psi_n
                    - u * (l - psi_n));
        }
    }

    fn add_edges(&mut self, problem: &Problem, bilinear: &Bilinear, rules: &Rules) {
        let Jumps { edges, psi, .. } = &problem.jumps;
        let mut at_vertices: Vec<Option<f64>> = vec![None; psi.vertices.len()];
        let mut waiting: Vec<&Edge> = edges.iter().collect();
        while !waiting.is_empty() {
            // First those with an end where psi is known or on the border.
            let known = |end: &Option<usize>| end.is_none_or(|v| at_vertices[v].is_some());
            let next = waiting.iter().position(|edge| edge.arc.ends.iter().any(known));
            let &Edge { arc, values: [left, right] } = waiting.swap_remove(next.unwrap_or(0));
            let backwards = known(&arc.ends[1]) && !known(&arc.ends[0]);
            let arc = if backwards { arc.reversed() } else { arc };
            let from = || problem.psi(arc.curve.at(arc.span[0]), rules);
            let start = arc.ends[0].and_then(|v| at_vertices[v]).unwrap_or_else(from);
            let add = |&Node { point, normal, weight, gradient }: &Node, psi| {
                let (psi, gradient) = bilinear.less(point, psi, gradient);
                let (outward, square) = (point.dot(normal), 0.25 * point.norm2());
                let moment = (0.5 * psi - 0.25 * (left + right) * square) * outward
                    - square * gradient.dot(normal);
                self.energy += weight * (left - right) * moment;
                self.rellich += weight * (left - right) * outward * psi;
                for (k, (p, _)) in harmonic(point).into_iter().enumerate() {
                    self.area[k] += weight * (left - right) * p * outward / (DEGREES[k] + 2.0);
                }
            };
            let end = problem.along(arc, start, rules, add);
            for (vertex, psi) in arc.ends.into_iter().zip([start, end]) {
                vertex.into_iter().for_each(|v| at_vertices[v] = Some(psi));
            }
        }
    }
}

/// The bilinear function that equals psi in the corners, where l is known least.
struct Bilinear([f64; 4]);

impl Bilinear {
    fn new(problem: &Problem) -> Self {
        let mut c = [0.0; 4];
        for z in CORNERS {
            let value = problem.border.value(Place::of(z));
            let basis = [0.25, z.re, z.im, 4.0 * z.re * z.im];
            c.iter_mut().zip(basis).for_each(|(c, b)| *c += b * value);
        }
        Self(c)
    }

    fn less(&self, z: Complex, value: f64, gradient: Complex) -> (f64, Complex) {
        let [c, x, y, xy] = self.0;
        let plane = c + x * z.re + y * z.im + xy * z.re * z.im;
        (value - plane, gradient - Complex::new(x + xy * z.im, y + xy * z.re))
    }
}
