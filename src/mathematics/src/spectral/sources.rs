//! Quadrature nodes on the boundary, and sums of Cauchy kernels over them.

use super::boundary::BoundaryPotential;
use super::map::{Angle, eighth_turns};
use super::panels::{Ends, GradedRule, LANES, Panel, Special, panels};
use super::place::BoundaryPlace;
use super::problem::SpectralProblem;
use super::rule::Rules;
use crate::machine::simd::vectorised;
use crate::problem::complex::Complex;
use std::ops::Range;

/// Sources on consecutive panels.
#[derive(Default)]
pub(super) struct Sources {
    pub groups: Vec<Group>,
    /// Weights over (-1)^k |P|^{1/2}, and for odd m over the cosine below: then, with half the angles t and s,
    /// 1 / sin(t - s) is 1 / (sin t - cos t tan s).
    pub weight: Vec<f64>,
    /// Weights times the data: the derivative of psi in the panel's direction, on gaps plus the flux.
    pub moment: Vec<f64>,
    /// Tangents of half the angles from the panels' corners.
    pub tan: Vec<f64>,
    /// Cosines of half the angles from the panels' corners.
    pub cos: Vec<f64>,
}

/// Sources of one panel.
pub(super) struct Group {
    pub corner: i32,
    pub direction: Complex,
    pub range: Range<usize>,
}

impl Sources {
    /// Adds the nodes of a rule on a panel.
    fn add(&mut self, psi: &BoundaryPotential, ends: &Ends, panel: &Panel, rule: GradedRule) {
        let start = self.weight.len();
        let direction = panel.direction();
        let component = if direction.re == 0.0 { 2 } else { 1 };
        let sign = direction.re + direction.im;
        let flux = if panel.contact { 0.0 } else { panel.flux };
        let odd = ends.arcs() % 2 == 1;
        vectorised(
            #[inline(always)]
            || {
                for part in rule.nodes.chunks(LANES) {
                    let many = part.len();
                    let nodes = panel.nodes(GradedRule { nodes: part, ..rule });
                    let [derivative] = psi.at(panel.corner, &nodes.t, [component]);
                    let mut weight = ends.roots(panel, &nodes);
                    let (mut moment, mut tan) = ([0.0; LANES], [0.0; LANES]);
                    for k in 0..LANES {
                        let factor = if odd { nodes.cos[k] } else { 1.0 };
                        tan[k] = nodes.sin[k] / nodes.cos[k];
                        weight[k] = nodes.weight[k] / (weight[k] * factor);
                        moment[k] = weight[k] * sign * derivative[k] + weight[k] * flux;
                    }
                    self.weight.extend_from_slice(&weight[..many]);
                    self.moment.extend_from_slice(&moment[..many]);
                    self.tan.extend_from_slice(&tan[..many]);
                    self.cos.extend_from_slice(&nodes.cos[..many]);
                }
            },
        );
        self.groups.push(Group {
            corner: panel.corner,
            direction,
            range: start..self.weight.len(),
        });
    }

    /// Sums over a group of `weight (grad psi' - grad psi) . e kappa(theta - theta')`, for each target. Each `JOINED`
    /// fractions are brought to one denominator: divisions would take most of the time. If `JOINED` is 1, sources that
    /// coincide with the target are left out.
    #[inline(always)]
    fn sums<const JOINED: usize>(
        &self,
        group: &Group,
        targets: &TargetBlock,
        odd: bool,
    ) -> [f64; LANES] {
        let (range, [ts, tc, g]) = (group.range.clone(), targets.seen_from(group));
        let mut sums = [0.0; LANES];
        let weights = self.weight[range.clone()].chunks(JOINED);
        let moments = self.moment[range.clone()].chunks(JOINED);
        for ((weights, moments), tans) in weights.zip(moments).zip(self.tan[range].chunks(JOINED)) {
            let (mut top, mut bottom) = ([0.0; LANES], [1.0; LANES]);
            for ((w, m), t) in weights.iter().zip(moments).zip(tans) {
                for k in 0..LANES {
                    let a = m - g[k] * w;
                    let a = if odd { a } else { a * (tc[k] + ts[k] * t) };
                    let b = ts[k] - tc[k] * t;
                    top[k] = top[k] * b + a * bottom[k];
                    bottom[k] *= b;
                }
            }
            for k in 0..LANES {
                sums[k] += if JOINED == 1 && bottom[k] == 0.0 { 0.0 } else { top[k] / bottom[k] };
            }
        }
        sums
    }
}

/// Targets of one panel for which sums are made at once, with the vectors that they subtract.
struct TargetBlock {
    corner: i32,
    sin: [f64; LANES],
    cos: [f64; LANES],
    subtracted: [[f64; LANES]; 2],
}

impl TargetBlock {
    /// Sines and cosines of half the angles from the corner of a group, and the parts of the vectors in its direction.
    #[inline(always)]
    fn seen_from(&self, group: &Group) -> [[f64; LANES]; 3] {
        let [cos, sin] = eighth_turns(self.corner - group.corner);
        let Complex { re, im } = group.direction;
        let (mut s, mut c, mut g) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            s[k] = self.sin[k] * cos + self.cos[k] * sin;
            c[k] = self.cos[k] * cos - self.sin[k] * sin;
            g[k] = self.subtracted[0][k] * re + self.subtracted[1][k] * im;
        }
        [s, c, g]
    }
}

/// All sources: plain ones, and graded ones for the targets next to kinks.
pub(super) struct SourceField<'a> {
    psi: &'a BoundaryPotential,
    ends: &'a Ends,
    rules: &'a Rules,
    pub panels: Vec<Panel>,
    /// Sources for all targets but those next to a kink, panel by panel.
    pub plain: Sources,
    /// Graded sources of the panels next to kinks.
    graded: Sources,
    /// Number of each panel's group of graded sources, if it has one.
    graded_of: Vec<Option<usize>>,
}

/// Solution at a point of the boundary.
#[derive(Clone, Copy)]
pub(super) struct Point {
    pub place: BoundaryPlace,
    /// Number of its panel.
    pub panel: usize,
    pub angle: Angle,
    /// Quadrature weight with respect to the length of the boundary.
    pub weight: f64,
    pub psi: f64,
    pub gradient: Complex,
    /// (-1)^k |P|^{1/2} times the derivative of the angle along the boundary.
    pub root: f64,
    /// v, zero until its derivative is integrated.
    pub value: f64,
    /// dv/dn.
    pub multiplier: f64,
    /// Derivative of v along the boundary.
    pub along: f64,
}

impl Point {
    /// Value of the harmonic function v - psi.
    pub(super) fn harmonic(&self) -> f64 {
        self.value - self.psi
    }
}

impl<'a> SourceField<'a> {
    /// Grades the panels next to kinks that are `wanted`.
    pub(super) fn new(
        problem: &'a SpectralProblem,
        ends: &'a Ends,
        rules: &'a Rules,
        wanted: impl Fn(&Panel) -> bool,
    ) -> Self {
        let (psi, panels) = (&problem.boundary_psi, panels(ends, &problem.jumps));
        let (mut plain, mut graded) = (Sources::default(), Sources::default());
        let mut graded_of = vec![None; panels.len()];
        for (panel, number) in panels.iter().zip(&mut graded_of) {
            let power = if panel.end().is_some() { 2 } else { 1 };
            plain.add(psi, ends, panel, GradedRule { nodes: &rules.plain, power });
            if panel.kink().is_some() && wanted(panel) {
                *number = Some(graded.groups.len());
                graded.add(psi, ends, panel, GradedRule { nodes: &rules.near, power: 1 });
            }
        }
        Self { psi, ends, rules, panels, plain, graded, graded_of }
    }

    /// Solution at the targets of panel `p`.
    pub(super) fn on_panel(&self, p: usize) -> Vec<Point> {
        let panel = &self.panels[p];
        let mut found = Vec::with_capacity(self.rules.targets.len());
        vectorised(
            #[inline(always)]
            || {
                for part in self.rules.targets.chunks(LANES) {
                    let rule = GradedRule { nodes: part, power: panel.target_power() };
                    let nodes = panel.nodes(rule);
                    let [psi, x, y] = self.psi.at(panel.corner, &nodes.t, [0, 1, 2]);
                    let shifts = nodes.t.map(|t| panel.shift(t));
                    let block = TargetBlock {
                        corner: panel.corner,
                        sin: nodes.sin,
                        cos: nodes.cos,
                        subtracted: [
                            std::array::from_fn(|k| x[k] + shifts[k].re),
                            std::array::from_fn(|k| y[k] + shifts[k].im),
                        ],
                    };
                    let (sums, roots) = (self.sums(p, &block), self.ends.roots(panel, &nodes));
                    found.extend((0..part.len()).map(|k| {
                        let angle = nodes.angle(k);
                        let root = roots[k] * angle.slope;
                        let derivative = -root * sums[k] / std::f64::consts::TAU;
                        // More was subtracted than the gradient of psi, with which the sum would be v's derivative.
                        let (multiplier, along) = if panel.contact {
                            (derivative + panel.flux, 0.0)
                        } else {
                            (panel.flux, derivative - shifts[k].dot(panel.tangent))
                        };
                        Point {
                            place: panel.place(nodes.t[k]),
                            panel: p,
                            angle,
                            weight: nodes.weight[k],
                            psi: psi[k],
                            gradient: Complex::new(x[k], y[k]),
                            root,
                            value: 0.0,
                            multiplier,
                            along,
                        }
                    }));
                }
            },
        );
        found
    }

    /// Sums over all sources, for each target.
    #[inline(always)]
    fn sums(&self, p: usize, targets: &TargetBlock) -> [f64; LANES] {
        /// Number of factors in a product: next to corners, where the angles are tiny, products of many more would
        /// underflow.
        const JOINED: usize = 6;
        let sums = self.sums_joined::<JOINED>(p, targets);
        if sums.iter().sum::<f64>().is_finite() { sums } else { self.sums_apart(p, targets) }
    }

    /// Sums over all sources that do not coincide with a target: some do on a panel of the length of a few rounding
    /// errors.
    #[cold]
    #[inline(never)]
    fn sums_apart(&self, p: usize, targets: &TargetBlock) -> [f64; LANES] {
        self.sums_joined::<1>(p, targets)
    }

    #[inline(always)]
    fn sums_joined<const JOINED: usize>(&self, p: usize, targets: &TargetBlock) -> [f64; LANES] {
        let many = self.panels.len();
        let panel = &self.panels[p];
        let across = if panel.reversed { (p + 1) % many } else { (p + many - 1) % many };
        let replaced = match panel.kink() {
            None => [many; 2],
            Some(Special::Crossing) => [across, many],
            Some(_) => [p, across],
        };
        let mut sums = [0.0; LANES];
        for (q, group) in self.plain.groups.iter().enumerate() {
            let (sources, group) = if replaced.contains(&q) {
                let graded = self.graded_of[q].expect("panels next to kinks are graded");
                (&self.graded, &self.graded.groups[graded])
            } else {
                (&self.plain, group)
            };
            let part = if self.ends.arcs() % 2 == 1 {
                sources.sums::<JOINED>(group, targets, true)
            } else {
                sources.sums::<JOINED>(group, targets, false)
            };
            for k in 0..LANES {
                sums[k] += part[k];
            }
        }
        sums
    }
}
