//! Quadrature nodes on the border and the Cauchy sums over them.

use super::complex::Complex;
use super::map::Angle;
use super::panels::{Ends, Panel, Special};
use super::potential::Potential;
use super::rule::{gauss, interpolation};
use std::ops::Range;

/// Ratio of neighbouring panels towards corners and crossings.
const RATIO: f64 = 8.0;

/// The rules of one resolution.
pub(super) struct Rules {
    /// Nodes of the sources.
    pub plain: Vec<[f64; 2]>,
    /// Nodes of the targets: one more, so that they interlace.
    pub targets: Vec<[f64; 2]>,
    /// Nodes of a graded panel, as fractions of its length from the corner.
    near: Vec<[f64; 2]>,
    /// From the plain nodes to these.
    to_near: Vec<f64>,
}

impl Rules {
    pub(super) fn new(nodes: usize, levels: u32) -> Self {
        let plain = gauss(nodes);
        let mut near = Vec::with_capacity(nodes * (levels as usize + 1));
        let mut to = 1.0;
        for level in 0..=levels {
            let from = if level == levels { 0.0 } else { to / RATIO };
            near.extend(plain.iter().map(|&[x, w]| [from + (to - from) * x, (to - from) * w]));
            to = from;
        }
        let fractions: Vec<f64> = near.iter().map(|&[x, _]| x).collect();
        let to_near = interpolation(&plain, &fractions);
        Self { targets: gauss(nodes + 1), plain, near, to_near }
    }
}

/// Sources on consecutive panels.
#[derive(Default)]
pub(super) struct Sources {
    pub groups: Vec<Group>,
    /// Weight over (-1)^k |P|^{1/2}.
    pub weight: Vec<f64>,
    /// The same times the derivative of psi in the panel's direction.
    pub moment: Vec<f64>,
    /// Sine and cosine of half the angle from the panel's corner.
    pub sin: Vec<f64>,
    pub cos: Vec<f64>,
}

/// The sources of one panel.
pub(super) struct Group {
    pub corner: i32,
    pub direction: Complex,
    pub range: Range<usize>,
}

/// A point of the border with the gradient of psi there.
#[derive(Clone, Copy)]
pub(super) struct Target {
    pub corner: i32,
    pub angle: Angle,
    pub gradient: Complex,
}

impl Sources {
    /// Nodes that serve all targets but those next to a kink.
    pub(super) fn plain(psi: &Potential, ends: &Ends, panels: &[Panel], rules: &Rules) -> Self {
        let mut sources = Self::default();
        for panel in panels {
            let power = if panel.end().is_some() { 2 } else { 1 };
            sources.group(panel, |sources| {
                for node in panel.nodes(&rules.plain, power) {
                    let angle = Angle::from_corner(node.t);
                    let derivative = psi.gradient(panel.point(node.t)).dot(panel.direction());
                    let weight = node.weight / ends.root(panel, node, angle);
                    sources.push(weight, derivative, angle);
                }
            });
        }
        sources
    }

    /// Nodes graded towards the corner or crossing at one end of the panel; `plain` are those of the panel.
    fn graded(ends: &Ends, panel: &Panel, rules: &Rules, plain: &[f64], sources: &mut Self) {
        let n = rules.plain.len();
        sources.group(panel, |sources| {
            let nodes = panel.nodes(&rules.near, 1);
            for (node, row) in nodes.zip(rules.to_near.chunks_exact(n)) {
                let angle = Angle::from_corner(node.t);
                let derivative = row.iter().zip(plain).map(|(m, d)| m * d).sum();
                let weight = node.weight / ends.root(panel, node, angle);
                sources.push(weight, derivative, angle);
            }
        });
    }

    fn push(&mut self, weight: f64, derivative: f64, angle: Angle) {
        self.weight.push(weight);
        self.moment.push(weight * derivative);
        self.sin.push(angle.sin);
        self.cos.push(angle.cos);
    }

    fn group(&mut self, panel: &Panel, fill: impl FnOnce(&mut Self)) {
        let start = self.weight.len();
        fill(self);
        self.groups.push(Group {
            corner: panel.corner,
            direction: panel.direction(),
            range: start..self.weight.len(),
        });
    }

    /// The sum over the sources of a group of weight (grad psi' - grad psi) . e k(theta - theta').
    fn sum(&self, group: &Group, target: &Target, odd: bool) -> f64 {
        let [ts, tc] = target.angle.seen_from(target.corner - group.corner);
        let g = target.gradient.dot(group.direction);
        let range = group.range.clone();
        let (weight, moment) = (&self.weight[range.clone()], &self.moment[range.clone()]);
        let (sin, cos) = (&self.sin[range.clone()], &self.cos[range]);
        let sources = weight.iter().zip(moment).zip(sin.iter().zip(cos));
        let mut sum = 0.0;
        if odd {
            for ((w, m), (s, c)) in sources {
                sum += (m - g * w) / (ts * c - tc * s);
            }
        } else {
            for ((w, m), (s, c)) in sources {
                sum += (m - g * w) * (tc * c + ts * s) / (ts * c - tc * s);
            }
        }
        sum
    }
}

/// All sources: plain ones and, where they do not serve, graded ones.
pub(super) struct Field<'a> {
    pub panels: &'a [Panel],
    pub plain: &'a Sources,
    odd: bool,
    /// Graded sources of the panels next to kinks, and which group is whose.
    graded: Sources,
    graded_of: Vec<usize>,
}

impl<'a> Field<'a> {
    /// Grades the panels next to kinks that are `wanted`.
    pub(super) fn new(
        ends: &Ends,
        panels: &'a [Panel],
        plain: &'a Sources,
        rules: &Rules,
        wanted: impl Fn(&Panel) -> bool,
    ) -> Self {
        let mut graded = Sources::default();
        let mut graded_of = vec![usize::MAX; panels.len()];
        for (p, panel) in panels.iter().enumerate() {
            if panel.kink().is_some() && wanted(panel) {
                let range = plain.groups[p].range.clone();
                let derivatives: Vec<f64> = plain.moment[range.clone()]
                    .iter()
                    .zip(&plain.weight[range])
                    .map(|(moment, weight)| moment / weight)
                    .collect();
                graded_of[p] = graded.groups.len();
                Sources::graded(ends, panel, rules, &derivatives, &mut graded);
            }
        }
        Self { panels, plain, odd: ends.arcs() % 2 == 1, graded, graded_of }
    }

    /// Y at a target of panel `p`: times (-1)^k |P|^{1/2} it is l dp/dtheta in contact, dv/dtheta elsewhere.
    pub(super) fn at(&self, p: usize, target: &Target) -> f64 {
        let many = self.panels.len();
        let panel = &self.panels[p];
        let across = if panel.reversed() { (p + 1) % many } else { (p + many - 1) % many };
        let replaced = match panel.kink() {
            None => [many; 2],
            Some(Special::Crossing) => [across, many],
            Some(_) => [p, across],
        };
        let mut sum = 0.0;
        for (q, group) in self.plain.groups.iter().enumerate() {
            sum += if replaced.contains(&q) {
                self.graded.sum(&self.graded.groups[self.graded_of[q]], target, self.odd)
            } else {
                self.plain.sum(group, target, self.odd)
            };
        }
        -sum / std::f64::consts::TAU
    }
}
