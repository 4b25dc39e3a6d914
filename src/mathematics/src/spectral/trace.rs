//! Solution on the boundary.

use super::complex::distance;
use super::map::{Angle, K, corner_angle, to_disc};
use super::panels::{Ends, GradedRule, LANES, Panel, Special};
use super::place::BoundaryPlace;
use super::problem::SpectralProblem;
use super::rule::{GaussNode, Rules, halved, interpolation};
use super::sources::{Point, SourceField};
use crate::discrete::contact::ContactArc;
use crate::problem::complex::Complex;
use crate::problem::law::Law;
use std::f64::consts::TAU;

/// Distance from a corner up to which gaps are left out: the energy changes by the fourth power of it.
pub(super) const UNRESOLVED: f64 = 1e-4;

/// Solution on the whole boundary.
pub(super) struct Trace {
    pub ends: Ends,
    pub rules: Rules,
    pub panels: Vec<Panel>,
    pub points: Vec<Point>,
    /// v at the starts of the panels.
    starts: Vec<f64>,
}

impl Trace {
    pub(super) fn new(problem: &SpectralProblem, ends: Ends, rules: &Rules) -> Self {
        let field = SourceField::new(problem, &ends, rules, |_| true);
        let panels = &field.panels;
        let n = rules.targets.len();
        let mut points: Vec<Point> = Vec::with_capacity(n * panels.len());
        // v at the start of the panel.
        let mut before = 0.0;
        let mut starts = Vec::with_capacity(panels.len());
        for (p, panel) in panels.iter().enumerate() {
            let first = points.len();
            starts.push(before);
            points.extend(field.on_panel(p));
            let points = &mut points[first..];
            let changes = points.iter().map(|p| p.along * p.weight);
            let (values, end) = rules.integrate(before, panel.reversed, changes);
            for (point, value) in points.iter_mut().zip(values) {
                point.value = value;
            }
            before = if panel.contact { 0.0 } else { end };
            if panel.reversed {
                points.reverse();
            }
        }
        Self { panels: field.panels, rules: rules.clone(), ends, points, starts }
    }

    /// True if the `i`-th point, counted around and around, is in contact.
    pub(super) fn in_contact(&self, i: usize) -> bool {
        self.panels[self.points[i % self.points.len()].panel].contact
    }

    /// Multiplier by which the contact at the `i`-th point is judged. None so near to a corner that gaps are left out,
    /// but for the last such point: between it and the next point a gap may end that is not left out.
    fn judged(&self, i: usize) -> Option<f64> {
        let Point { place: BoundaryPlace { corner, t }, multiplier, .. } = self.points[i];
        let many = self.points.len();
        let outwards = (if t > 0.0 { i + 1 } else { i + many - 1 }) % many;
        match [i, outwards].map(|i| self.points[i].place.t.abs() <= UNRESOLVED) {
            [false, _] => Some(multiplier),
            [true, false] => {
                Some(self.at(BoundaryPlace { corner, t: UNRESOLVED.copysign(t) }).multiplier)
            }
            [true, true] => None,
        }
    }

    /// v at a point, less where the gap is to slip down.
    fn upward(&self, point: &Point, law: Law) -> f64 {
        let panel = &self.panels[point.panel];
        if !panel.contact && panel.flux == law.hi() { -point.value } else { point.value }
    }

    /// Sign conditions at all points.
    pub(super) fn signs(&self, law: Law) -> Vec<Sign> {
        let widths = self.points.iter().flat_map(|p| law.room(p.multiplier));
        let largest = widths.filter(|width| width.is_finite()).fold(0.0, f64::max);
        let values = self.points.iter().map(|p| self.upward(p, law).max(p.psi.abs()));
        let size = values.fold(0.0, f64::max);
        let mut signs = Vec::with_capacity(self.points.len());
        for (i, p) in self.points.iter().enumerate() {
            let contact = self.in_contact(i);
            let value = match contact {
                true => self.judged(i).map(|multiplier| {
                    let [above_lo, below_hi] = law.room(multiplier);
                    above_lo.min(below_hi) / largest
                }),
                false => Some(self.upward(p, law) / size),
            };
            signs.push(Sign { contact, value });
        }
        signs
    }

    /// Harmonic function v - psi inside, by Poisson's integral on the disc.
    pub(super) fn harmonic(&self, z: Complex) -> f64 {
        let (image, mut sum) = (to_disc(z), 0.0);
        let mean = self.around(z, |point, share| sum += share / (point - image).norm2());
        mean + sum * (1.0 - image.norm2()) / TAU
    }

    /// Gradient of that function: from the derivative of Schwarz's integral, and `Phi' = K (1 + Phi^4)^(1/2)`.
    pub(super) fn harmonic_gradient(&self, z: Complex) -> Complex {
        let (image, mut sum) = (to_disc(z), Complex::default());
        self.around(z, |point, share| {
            let to = point - image;
            sum = sum + (point / (to * to)).scaled(share);
        });
        let square = image * image;
        let slope = (square * square).shifted(1.0).sqrt();
        (sum * slope).scaled(2.0 * K / TAU).conj()
    }

    /// Passes points of the circle to `take`, each with the harmonic function there, less a constant, times a weight
    /// of the quadrature: the values on each panel are interpolated to parts that are no longer than their distance
    /// from `z`. Returns the constant, so that errors of the quadrature are relative to what is left.
    fn around(&self, z: Complex, mut take: impl FnMut(Complex, f64)) -> f64 {
        let targets = &self.rules.targets;
        let n = targets.len();
        let mean = self.points.iter().map(Point::harmonic).sum::<f64>() / self.points.len() as f64;
        for (panel, points) in self.panels.iter().zip(self.points.chunks_exact(n)) {
            let mut values: Vec<f64> = points.iter().map(|p| p.harmonic() - mean).collect();
            if panel.reversed {
                values.reverse();
            }
            let corner = Complex::unit(corner_angle(panel.corner));
            let power = panel.target_power();
            let parts = halved([0.0, 1.0], |part| {
                let segment = part.map(|x| {
                    let rule = GradedRule { nodes: &[GaussNode { x, weight: 1.0 }], power };
                    panel.place(panel.nodes(rule).t[0]).point()
                });
                (segment[1] - segment[0]).norm() > distance(segment, z).max(1e-12)
            });
            if parts.len() == 1 {
                // The values are wanted where they are known.
                for (k, h) in values.iter().enumerate() {
                    let point = &points[if panel.reversed { n - 1 - k } else { k }];
                    let half = Complex::new(point.angle.cos, point.angle.sin);
                    take(corner * half * half, point.weight * point.angle.slope * h);
                }
                continue;
            }
            for part in parts {
                let inside: Vec<GaussNode> = targets.iter().map(|node| node.on(part)).collect();
                let places: Vec<f64> = inside.iter().map(|node| node.x).collect();
                let matrix = interpolation(targets, &places);
                for (nodes, rows) in inside.chunks(LANES).zip(matrix.chunks(LANES * n)) {
                    let nodes = panel.nodes(GradedRule { nodes, power });
                    for (k, row) in rows.chunks_exact(n).enumerate() {
                        let h: f64 = row.iter().zip(&values).map(|(m, h)| m * h).sum();
                        let Angle { sin, cos, slope } = nodes.angle(k);
                        let half = Complex::new(cos, sin);
                        take(corner * half * half, nodes.weight[k] * slope * h);
                    }
                }
            }
        }
        mean
    }

    /// v and its gradient at a place on the boundary, interpolated between the points of its panel.
    pub(super) fn at(&self, place: BoundaryPlace) -> BoundaryValues {
        let panels = self.panels.iter().enumerate();
        let nearest = panels.min_by(|a, b| a.1.distance(place).total_cmp(&b.1.distance(place)));
        let (p, panel) = nearest.expect("the boundary has panels");
        let t = panel.local(place).clamp(panel.from, panel.to);
        let offset = if panel.reversed { panel.to - t } else { t - panel.from };
        let scale = offset / (panel.to - panel.from);
        let x = match panel.target_power() {
            1 => scale,
            2 => scale.sqrt(),
            _ => libm::cbrt(scale),
        };
        let n = self.rules.targets.len();
        let mut points: Vec<&Point> = self.points[p * n..][..n].iter().collect();
        if panel.reversed {
            points.reverse();
        }
        let row = interpolation(&self.rules.targets, &[x]);
        // In a corner v is more accurate by integration.
        let value = match place.t == 0.0 {
            true => self.corner_value(place.corner),
            false => row.iter().zip(&points).map(|(m, point)| m * point.value).sum(),
        };
        let multiplier = row.iter().zip(&points).map(|(m, point)| m * point.multiplier).sum();
        let along = row.iter().zip(&points).map(|(m, point)| m * point.along).sum();
        BoundaryValues { value, multiplier, along }
    }

    /// Contact arcs with their forces; `total` is the force on the whole boundary.
    pub(super) fn arcs(&self, total: f64) -> Vec<ContactArc> {
        if self.ends.places.is_empty() {
            let corner = BoundaryPlace { corner: 3, t: 0.0 }.point().coordinates();
            return vec![ContactArc::on_square([corner; 2], total)];
        }
        let mut arcs = Vec::with_capacity(self.ends.arcs());
        for (k, ends) in self.ends.places.chunks_exact(2).enumerate() {
            let [from, to] = [ends[0], ends[1]].map(|place| place.point().coordinates());
            arcs.push(ContactArc::on_square([from, to], self.force(k + 1)));
        }
        arcs
    }

    /// Force on an arc of contact.
    fn force(&self, arc: usize) -> f64 {
        let own = self.points.iter().filter(|point| {
            let panel = &self.panels[point.panel];
            panel.contact && panel.arcs == arc
        });
        own.map(|point| point.weight * point.multiplier).sum()
    }

    /// v in a corner.
    pub(super) fn corner_value(&self, corner: i32) -> f64 {
        let panel = self.panels.iter().position(|panel| {
            !panel.reversed
                && panel.special == Some(Special::Corner)
                && (panel.corner - corner).rem_euclid(4) == 0
        });
        panel.map_or(0.0, |p| self.starts[p])
    }
}

/// v, dv/dn and the derivative of v along the boundary, anticlockwise, at a point of the boundary.
pub(super) struct BoundaryValues {
    pub value: f64,
    pub multiplier: f64,
    pub along: f64,
}

/// Sign condition at a point of the boundary: in contact the distance of the multiplier from the nearer end of the law,
/// elsewhere v must not be negative, or not positive where the gap slips down.
pub(super) struct Sign {
    pub contact: bool,
    /// Distance over the largest, or v over its size; none for a multiplier that is too near to a corner to be
    /// judged. The size of v is also that of psi: in a short gap v is far smaller than inside.
    pub value: Option<f64>,
}
