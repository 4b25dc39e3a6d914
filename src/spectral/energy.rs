//! The energy of the solution, from integrals over the border and along the jumps of f.

use super::complex::Complex;
use super::curve::Curve;
use super::jumps::{Edge, Jumps, PROBE};
use super::panels::{Panel, distance};
use super::potential::CORNERS;
use super::problem::Problem;
use super::sources::Rules;
use super::trace::{Point, Trace};

/// Integrals over the border and over the square.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Energies {
    /// J = -1/2 int f v, by Green's identity with psi.
    pub energy: f64,
    /// The same by Rellich's identity.
    pub rellich: f64,
    /// Integral of l over the border.
    pub force: f64,
    /// Integral of f over the square.
    pub integral: f64,
}

impl Energies {
    pub(super) fn of(trace: &Trace, problem: &Problem, rules: &Rules) -> Self {
        let (mut energies, bilinear) = (Self::default(), Bilinear::new(problem));
        energies.add_border(trace, problem, &bilinear);
        energies.add_corners(trace, problem, &bilinear);
        energies.add_edges(problem, &bilinear, rules);
        Self { energy: -0.5 * energies.energy, rellich: -0.25 * energies.rellich, ..energies }
    }

    fn add_border(&mut self, trace: &Trace, problem: &Problem, bilinear: &Bilinear) {
        let value = |panel: &Panel| {
            problem.jumps.value(panel.middle() + panel.tangent.turned().scaled(PROBE))
        };
        let values: Vec<f64> = trace.panels.iter().map(value).collect();
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
            self.integral += weight * f * 0.5 * outward;
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

    /// What partial integration along the sides leaves at the corners, where psi vanishes but its gradient
    /// does not.
    fn add_corners(&mut self, trace: &Trace, problem: &Problem, bilinear: &Bilinear) {
        for (k, &z) in (0..).zip(&CORNERS) {
            let value = trace.corner_value(k);
            let (_, gradient) = bilinear.less(z, 0.0, problem.psi.gradient(z));
            for (t, sign) in [(1.0, -1.0), (-1.0, 1.0)] {
                let tangent = super::panels::tangent(k, t);
                let normal = -tangent.turned();
                self.rellich += sign
                    * value
                    * (z.dot(tangent) * gradient.dot(normal)
                        - z.dot(normal) * gradient.dot(tangent));
            }
        }
    }

    fn add_edges(&mut self, problem: &Problem, bilinear: &Bilinear, rules: &Rules) {
        let jumps = &problem.jumps;
        for edge in &jumps.edges {
            let [left, right] = edge.values;
            for (z, normal, weight) in edge_nodes(jumps, edge, rules) {
                let (psi, gradient) = problem.psi.value_and_gradient(z);
                let (psi, gradient) = bilinear.less(z, psi, gradient);
                let (outward, square) = (z.dot(normal), 0.25 * z.norm2());
                let moment = (0.5 * psi - 0.25 * (left + right) * square) * outward
                    - square * gradient.dot(normal);
                self.energy += weight * edge.jump() * moment;
                self.rellich += weight * edge.jump() * outward * psi;
                self.integral += weight * edge.jump() * 0.5 * outward;
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
            let value = problem.psi.value_and_gradient(z).0;
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

/// Nodes, right normals and weights along an edge, in short pieces where psi is singular.
fn edge_nodes(jumps: &Jumps, edge: &Edge, rules: &Rules) -> Vec<(Complex, Complex, f64)> {
    /// Longest piece of an arc, as an angle.
    const WIDEST: f64 = 1.6;
    let Edge { curve, span, ends, .. } = edge;
    let speed = curve.speed();
    let own = ends.map(|end| end.map(|v| jumps.vertices[v]));
    let mut pieces = vec![(*span, own.map(|end| end.is_some()))];
    let mut nodes = Vec::new();
    while let Some(([a, b], [first, last])) = pieces.pop() {
        let length = (b - a) * speed;
        let middle = 0.5 * (a + b);
        let segment = [curve.at(a), curve.at(b)];
        let near = jumps
            .singular(curve.at(middle))
            .filter(|&v| !own.contains(&Some(v)))
            .map(|v| distance(segment, v))
            .fold(f64::INFINITY, f64::min);
        let wide = matches!(curve, Curve::Circle { .. }) && b - a > WIDEST;
        if (first && last) || wide || (length > near && length > 1e-9) {
            pieces.push(([a, middle], [first, false]));
            pieces.push(([middle, b], [false, last]));
            continue;
        }
        for &[x, w] in &rules.targets {
            let (s, slope) = if first || last { (x * x * x, 3.0 * x * x) } else { (x, 1.0) };
            let s = if last { b - (b - a) * s } else { a + (b - a) * s };
            nodes.push((curve.at(s), curve.normal(s), length * slope * w));
        }
    }
    nodes
}
