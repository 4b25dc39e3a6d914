//! The solution on the border, and from it the energy.

use super::complex::Complex;
use super::jumps::{Curve, Edge, Jumps, PROBE};
use super::map::{Angle, corner_angle, to_disc};
use super::newton::Problem;
use super::panels::{Ends, Node, Panel, Place, Special, distance};
use super::potential::CORNERS;
use super::rule::{integration, interpolation};
use super::sources::{Field, Rules, Sources};
use std::f64::consts::TAU;

/// Gaps that reach no further from a corner are left out: the energy feels the fourth power of that.
pub(super) const UNRESOLVED: f64 = 1e-4;

/// The solution at a point of the border.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub place: Place,
    /// Number of its panel.
    pub panel: usize,
    /// Quadrature weight with respect to the length of the border.
    pub weight: f64,
    pub value: f64,
    /// dv/dn.
    pub multiplier: f64,
    /// Derivative of v along the border.
    pub along: f64,
    pub psi: f64,
    pub gradient: Complex,
}

/// The solution on the whole border.
pub(super) struct Trace {
    pub panels: Vec<Panel>,
    pub points: Vec<Point>,
    /// v at the starts of the panels.
    starts: Vec<f64>,
}

impl Trace {
    pub fn new(problem: &Problem, ends: &Ends, rules: &Rules) -> Self {
        let panels = problem.panels(ends);
        let plain = Sources::plain(&problem.psi, ends, &panels, rules);
        let field = Field::new(ends, &panels, &plain, rules, |_| true);
        let n = rules.targets.len();
        let integrals = integration(&rules.targets);
        let mut points: Vec<Point> = Vec::with_capacity(n * panels.len());
        // v at the start of the panel.
        let mut before = 0.0;
        let mut starts = Vec::with_capacity(panels.len());
        for (p, panel) in panels.iter().enumerate() {
            let first = points.len();
            starts.push(before);
            for node in panel.nodes(&rules.targets, panel.target_power()) {
                let z = panel.point(node.t);
                let mut target = problem.target(panel, node.t);
                let (psi, gradient) = problem.psi.value_and_gradient(z);
                target.gradient = gradient;
                let y = field.at(p, &target);
                let derivative = ends.root(panel, node, target.angle) * y * target.angle.slope;
                points.push(Point {
                    place: Place { corner: panel.corner, t: node.t },
                    panel: p,
                    weight: node.weight,
                    value: 0.0,
                    multiplier: if panel.contact { derivative } else { 0.0 },
                    along: if panel.contact { 0.0 } else { derivative },
                    psi,
                    gradient,
                });
            }
            let points = &mut points[first..];
            before = if panel.contact {
                0.0
            } else {
                integrate(points, panel, before, rules, &integrals)
            };
            if panel.reversed() {
                points.reverse();
            }
        }
        Self { panels, points, starts }
    }

    /// The total of l over the border and the energy J = -1/2 int f v, by Green's identity with psi and
    /// by Rellich's.
    pub fn energies(&self, problem: &Problem, rules: &Rules) -> Energies {
        let mut sums = Sums::new(problem);
        sums.add_border(self);
        sums.add_corners(self);
        sums.add_edges(rules);
        let mut e = sums.energies;
        e.energy = -0.5 * (sums.source + e.work);
        e.rellich = -0.25 * sums.rellich;
        e
    }

    /// Whether its `i`-th point, counted around and around, is in contact.
    pub fn in_contact(&self, i: usize) -> bool {
        self.panels[self.points[i % self.points.len()].panel].contact
    }

    /// The largest multiplier, and the size of v: in a short gap it is far smaller than inside.
    pub fn largest(&self) -> [f64; 2] {
        let largest =
            |[l, v]: [f64; 2], p: &Point| [l.max(p.multiplier), v.max(p.value).max(p.psi.abs())];
        self.points.iter().fold([0.0; 2], largest)
    }

    /// The least multiplier in contact and the least v elsewhere, over the largest.
    pub fn least(&self) -> [f64; 2] {
        let mut least = [f64::INFINITY; 2];
        for p in &self.points {
            if !self.panels[p.panel].contact {
                least[1] = least[1].min(p.value);
            } else if p.place.t.abs() > UNRESOLVED {
                least[0] = least[0].min(p.multiplier);
            }
        }
        let [l, v] = self.largest();
        [least[0] / l, if least[1].is_finite() { least[1] / v } else { 0.0 }]
    }

    /// The harmonic function v - psi inside, by Poisson's integral on the disc: its values on each panel
    /// are interpolated to parts that are no longer than their distance from `z`.
    pub fn harmonic(&self, z: Complex, rules: &Rules) -> f64 {
        let image = to_disc(z);
        let n = rules.targets.len();
        let mut sum = 0.0;
        for (panel, points) in self.panels.iter().zip(self.points.chunks_exact(n)) {
            let mut values: Vec<f64> = points.iter().map(|p| p.value - p.psi).collect();
            if panel.reversed() {
                values.reverse();
            }
            let (sin, cos) = libm::sincos(corner_angle(panel.corner));
            let mut parts = vec![[0.0, 1.0]];
            while let Some([from, to]) = parts.pop() {
                let inside: Vec<[f64; 2]> = rules
                    .targets
                    .iter()
                    .map(|&[x, w]| [from + (to - from) * x, (to - from) * w])
                    .collect();
                let nodes: Vec<Node> = panel.nodes(&inside, panel.target_power()).collect();
                let segment = [nodes[0], nodes[n - 1]].map(|node| panel.point(node.t));
                if (segment[1] - segment[0]).norm() > distance(segment, z).max(1e-12) {
                    let middle = 0.5 * (from + to);
                    parts.extend([[from, middle], [middle, to]]);
                    continue;
                }
                let places: Vec<f64> = inside.iter().map(|&[x, _]| x).collect();
                let matrix = if to - from == 1.0 {
                    Vec::new()
                } else {
                    interpolation(&rules.targets, &places)
                };
                for (k, node) in nodes.iter().enumerate() {
                    let h = match matrix.get(k * n..(k + 1) * n) {
                        None => values[k],
                        Some(row) => row.iter().zip(&values).map(|(m, h)| m * h).sum(),
                    };
                    let angle = Angle::from_corner(node.t);
                    let half = Complex::new(angle.cos, angle.sin);
                    let to = Complex::new(cos, sin) * half * half - image;
                    sum += node.weight * angle.slope * h / to.norm2();
                }
            }
        }
        sum * (1.0 - image.norm2()) / TAU
    }

    /// v in a corner.
    pub fn corner_value(&self, corner: i32) -> f64 {
        let begins = |panel: &Panel| {
            panel.special[0] == Some(Special::Corner) && (panel.corner - corner).rem_euclid(4) == 0
        };
        self.panels.iter().position(begins).map_or(0.0, |p| self.starts[p])
    }
}

/// Fills in v at the points of a panel, in the order of the rule, from its derivative and from v at the
/// start of the panel; returns v at its end.
fn integrate(
    points: &mut [Point],
    panel: &Panel,
    start: f64,
    rules: &Rules,
    integrals: &[f64],
) -> f64 {
    let rate: Vec<f64> =
        points.iter().zip(&rules.targets).map(|(p, &[_, w])| p.along * p.weight / w).collect();
    let total: f64 = rate.iter().zip(&rules.targets).map(|(r, &[_, w])| r * w).sum();
    for (point, row) in points.iter_mut().zip(integrals.chunks_exact(rate.len())) {
        let part: f64 = row.iter().zip(&rate).map(|(m, r)| m * r).sum();
        point.value = start + if panel.reversed() { total - part } else { part };
    }
    start + total
}

/// Integrals over the border and over the square.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Energies {
    pub energy: f64,
    pub rellich: f64,
    /// Integral of l over the border.
    pub force: f64,
    /// Integral of f over the square.
    pub integral: f64,
    work: f64,
}

/// The integrals of [`Trace::energies`], as far as they have been summed.
struct Sums<'a> {
    problem: &'a Problem,
    bilinear: Bilinear,
    energies: Energies,
    /// The integral of f psi.
    source: f64,
    /// That of psi in Rellich's identity.
    rellich: f64,
}

impl<'a> Sums<'a> {
    fn new(problem: &'a Problem) -> Self {
        let (bilinear, energies) = (Bilinear::new(problem), Energies::default());
        Self { problem, bilinear, energies, source: 0.0, rellich: 0.0 }
    }

    fn add_border(&mut self, trace: &Trace) {
        let value = |panel: &Panel| {
            let z = panel.middle() + panel.tangent.turned().scaled(PROBE);
            self.problem.jumps.value(z.re, z.im)
        };
        let values: Vec<f64> = trace.panels.iter().map(value).collect();
        for point in &trace.points {
            let panel = &trace.panels[point.panel];
            let z = point.place.point();
            let (tangent, normal) = (panel.tangent, -panel.tangent.turned());
            let (psi, gradient) = self.bilinear.less(z, point.psi, point.gradient);
            let (psi_n, psi_s) = (gradient.dot(normal), gradient.dot(tangent));
            let f = values[point.panel];
            let (outward, square) = (z.dot(normal), 0.25 * z.norm2());
            let Point { weight, value: v, multiplier: l, along, .. } = *point;
            self.source +=
                weight * f * (0.5 * outward * psi - square * psi_n - 0.25 * f * outward * square);
            self.energies.work += weight * (psi * l - v * psi_n);
            self.energies.force += weight * l;
            self.energies.integral += weight * f * 0.5 * outward;
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
    fn add_corners(&mut self, trace: &Trace) {
        for (k, &z) in CORNERS.iter().enumerate() {
            let value = trace.corner_value(k as i32);
            let (_, gradient) = self.bilinear.less(z, 0.0, self.problem.psi.gradient(z));
            for (t, sign) in [(1.0, -1.0), (-1.0, 1.0)] {
                let tangent = super::panels::tangent(k as i32, t);
                let normal = -tangent.turned();
                self.rellich += sign
                    * value
                    * (z.dot(tangent) * gradient.dot(normal)
                        - z.dot(normal) * gradient.dot(tangent));
            }
        }
    }

    fn add_edges(&mut self, rules: &Rules) {
        let jumps = &self.problem.jumps;
        for edge in &jumps.edges {
            let [left, right] = edge.values;
            for (z, normal, weight) in edge_nodes(jumps, edge, rules) {
                let (psi, gradient) = self.problem.psi.value_and_gradient(z);
                let (psi, gradient) = self.bilinear.less(z, psi, gradient);
                let (outward, square) = (z.dot(normal), 0.25 * z.norm2());
                let moment = (0.5 * psi - 0.25 * (left + right) * square) * outward
                    - square * gradient.dot(normal);
                self.source += weight * edge.jump() * moment;
                self.rellich += weight * edge.jump() * outward * psi;
                self.energies.integral += weight * edge.jump() * 0.5 * outward;
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
