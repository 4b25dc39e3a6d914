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
            // Where a circle touches the border from within, f beside it is that of the circle.
            let inward = panel.tangent.turned().scaled(PROBE);
            let [a, b, c] = [0.25, 0.5, 0.75].map(|part| {
                let t = panel.from + part * (panel.to - panel.from);
                problem.jumps.value(panel.point(t) + inward)
            });
            if a == b { a } else { c }
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
        let gradients = problem.psi.gradients(&CORNERS);
        for ((k, &z), gradient) in (0..).zip(&CORNERS).zip(gradients) {
            let value = trace.corner_value(k);
            let (_, gradient) = bilinear.less(z, 0.0, gradient);
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
        for edge in &problem.jumps.edges {
            // psi at the start of the piece; along the edge it is an integral of its gradient.
            let mut before = problem.psi.value(edge.curve.at(edge.span[0]));
            for piece in pieces(&problem.jumps, edge) {
                before = self.add_piece(problem, bilinear, rules, edge, &piece, before);
            }
        }
    }

    /// Adds a piece of an edge, given psi at its start; returns psi at its end.
    fn add_piece(
        &mut self,
        problem: &Problem,
        bilinear: &Bilinear,
        rules: &Rules,
        edge: &Edge,
        piece: &Piece,
        before: f64,
    ) -> f64 {
        let nodes = piece.nodes(&edge.curve, rules);
        let points: Vec<Complex> = nodes.iter().map(|&(z, ..)| z).collect();
        let gradients = problem.psi.gradients(&points);
        let changes = nodes
            .iter()
            .zip(&gradients)
            .map(|(&(_, normal, weight), g)| weight * g.dot(normal.turned()));
        let (values, end) = rules.integrate(before, piece.last, changes);
        let [left, right] = edge.values;
        for (((z, normal, weight), gradient), psi) in nodes.into_iter().zip(gradients).zip(values) {
            let (psi, gradient) = bilinear.less(z, psi, gradient);
            let (outward, square) = (z.dot(normal), 0.25 * z.norm2());
            let moment = (0.5 * psi - 0.25 * (left + right) * square) * outward
                - square * gradient.dot(normal);
            self.energy += weight * edge.jump() * moment;
            self.rellich += weight * edge.jump() * outward * psi;
        }
        end
    }
}

/// The bilinear function that equals psi in the corners, where l is known least.
struct Bilinear([f64; 4]);

impl Bilinear {
    fn new(problem: &Problem) -> Self {
        let mut c = [0.0; 4];
        for z in CORNERS {
            let value = problem.psi.value(z);
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

/// A piece of an edge, between parameters.
struct Piece {
    span: [f64; 2],
    /// Whether there is a vertex at its start or at its end.
    first: bool,
    last: bool,
}

impl Piece {
    /// Nodes, right normals and weights, counted from the vertex.
    fn nodes(&self, curve: &Curve, rules: &Rules) -> Vec<(Complex, Complex, f64)> {
        let [a, b] = self.span;
        let node = |&[x, w]: &[f64; 2]| {
            let (s, slope) =
                if self.first || self.last { (x * x * x, 3.0 * x * x) } else { (x, 1.0) };
            let s = if self.last { b - (b - a) * s } else { a + (b - a) * s };
            (curve.at(s), curve.normal(s), (b - a) * curve.speed() * slope * w)
        };
        rules.targets.iter().map(node).collect()
    }
}

/// The pieces of an edge in order, short where psi is singular.
fn pieces(jumps: &Jumps, edge: &Edge) -> Vec<Piece> {
    /// Longest piece of an arc, as an angle.
    const WIDEST: f64 = 1.6;
    let Edge { curve, span, ends, .. } = edge;
    let own = ends.map(|end| end.map(|v| jumps.vertices[v]));
    let [first, last] = own.map(|end| end.is_some());
    let mut left = vec![Piece { span: *span, first, last }];
    let mut pieces = Vec::new();
    while let Some(piece) = left.pop() {
        let Piece { span: [a, b], first, last } = piece;
        let length = (b - a) * curve.speed();
        let middle = 0.5 * (a + b);
        let along = [a, middle, b].map(|s| curve.at(s));
        let segment = [along[0], along[2]];
        let near = jumps
            .singular(along)
            .filter(|&v| !own.contains(&Some(v)))
            .map(|v| distance(segment, v))
            .fold(f64::INFINITY, f64::min);
        let wide = matches!(curve, Curve::Circle { .. }) && b - a > WIDEST;
        let graded = if first || last { 2.0 } else { 1.0 };
        if (first && last) || wide || (graded * length > near && length > 1e-9) {
            left.push(Piece { span: [middle, b], first: false, last });
            left.push(Piece { span: [a, middle], first, last: false });
        } else {
            pieces.push(piece);
        }
    }
    pieces
}
