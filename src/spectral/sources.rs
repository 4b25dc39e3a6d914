//! Quadrature nodes on the border and the Cauchy sums over them.

use super::Params;
use super::complex::Complex;
use super::map::{Angle, eighth_turns};
use super::panels::{Ends, Panel, Special};
use super::potential::Potential;
use super::rule::{gauss, integration, interpolation};
use crate::discrete::simd::vectorised;
use std::ops::Range;

/// Ratio of neighbouring panels towards corners and crossings.
const RATIO: f64 = 8.0;

/// The rules of one resolution.
#[derive(Clone)]
pub(super) struct Rules {
    /// Nodes of the sources.
    pub plain: Vec<[f64; 2]>,
    /// Nodes of the targets: one more, so that they interlace.
    pub targets: Vec<[f64; 2]>,
    /// From values at the targets to integrals from the start of the panel to each of them.
    pub integrals: Vec<f64>,
    /// Nodes of a graded panel, as fractions of its length from the corner.
    near: Vec<[f64; 2]>,
    /// From the plain nodes to these.
    to_near: Vec<f64>,
}

impl Rules {
    pub(super) fn new(Params { nodes, levels }: Params) -> Self {
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
        let targets = gauss(nodes + 1);
        Self { integrals: integration(&targets), targets, plain, near, to_near }
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

    /// For each target the sum over a group of weight (grad psi' - grad psi) . e k(theta - theta').
    #[inline(always)]
    fn sums(&self, group: &Group, targets: &Block, odd: bool) -> Lanes {
        let Range { start, end } = group.range;
        let [cos, sin] = eighth_turns(targets.corner - group.corner);
        let Complex { re, im } = group.direction;
        let (mut ts, mut tc, mut g) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            ts[k] = targets.sin[k] * cos + targets.cos[k] * sin;
            tc[k] = targets.cos[k] * cos - targets.sin[k] * sin;
            g[k] = targets.gradient[0][k] * re + targets.gradient[1][k] * im;
        }
        let sources = self.weight[start..end].iter().zip(&self.moment[start..end]);
        let sources = sources.zip(self.sin[start..end].iter().zip(&self.cos[start..end]));
        // Four fractions are brought to one denominator: divisions would take most of the time.
        let (mut sums, mut top, mut bottom) = ([0.0; LANES], [0.0; LANES], [1.0; LANES]);
        for (i, ((w, m), (s, c))) in sources.enumerate() {
            for k in 0..LANES {
                let a = m - g[k] * w;
                let a = if odd { a } else { a * (tc[k] * c + ts[k] * s) };
                let b = ts[k] * c - tc[k] * s;
                top[k] = top[k] * b + a * bottom[k];
                bottom[k] *= b;
            }
            if i % 4 == 3 || i + 1 == end - start {
                for k in 0..LANES {
                    sums[k] += top[k] / bottom[k];
                }
                (top, bottom) = ([0.0; LANES], [1.0; LANES]);
            }
        }
        sums
    }
}

/// Targets for which sums are made at once.
const LANES: usize = 4;
type Lanes = [f64; LANES];

/// Targets of one panel.
struct Block {
    corner: i32,
    sin: Lanes,
    cos: Lanes,
    gradient: [Lanes; 2],
}

impl Block {
    /// Of at most [`LANES`] targets; the last one fills what is left.
    fn new(targets: &[Target]) -> Self {
        let lanes = |of: fn(&Target) -> f64| {
            std::array::from_fn(|k| of(&targets[k.min(targets.len() - 1)]))
        };
        Self {
            corner: targets[0].corner,
            sin: lanes(|t| t.angle.sin),
            cos: lanes(|t| t.angle.cos),
            gradient: [lanes(|t| t.gradient.re), lanes(|t| t.gradient.im)],
        }
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

    /// Y at targets of panel `p`: times (-1)^k |P|^{1/2} it is l dp/dtheta in contact, dv/dtheta elsewhere.
    pub(super) fn at(&self, p: usize, targets: &[Target]) -> Vec<f64> {
        let mut sums = Vec::with_capacity(targets.len() + LANES);
        for block in targets.chunks(LANES) {
            let block = Block::new(block);
            let of_block = vectorised(
                #[inline(always)]
                || self.sums(p, &block),
            );
            sums.extend(of_block.map(|sum| -sum / std::f64::consts::TAU));
        }
        sums.truncate(targets.len());
        sums
    }

    /// The sums over all sources.
    #[inline(always)]
    fn sums(&self, p: usize, targets: &Block) -> Lanes {
        let many = self.panels.len();
        let panel = &self.panels[p];
        let across = if panel.reversed() { (p + 1) % many } else { (p + many - 1) % many };
        let replaced = match panel.kink() {
            None => [many; 2],
            Some(Special::Crossing) => [across, many],
            Some(_) => [p, across],
        };
        let mut sums = [0.0; LANES];
        for (q, group) in self.plain.groups.iter().enumerate() {
            let (sources, group) = if replaced.contains(&q) {
                (&self.graded, &self.graded.groups[self.graded_of[q]])
            } else {
                (self.plain, group)
            };
            let of_group = if self.odd {
                sources.sums(group, targets, true)
            } else {
                sources.sums(group, targets, false)
            };
            for k in 0..LANES {
                sums[k] += of_group[k];
            }
        }
        sums
    }
}
