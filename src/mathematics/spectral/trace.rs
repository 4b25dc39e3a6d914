//! The solution on the border.

use super::complex::{Complex, distance};
use super::map::{Angle, corner_angle, to_disc};
use super::panels::{Ends, LANES, Panel, Special};
use super::place::Place;
use super::problem::Problem;
use super::rule::{Rules, halved, interpolation};
use super::sources::{Field, Point};
use crate::discrete::contact::ContactArc;
use std::f64::consts::TAU;

/// Gaps that reach no further from a corner are left out: the energy feels the fourth power of that.
pub(super) const UNRESOLVED: f64 = 1e-4;

/// The solution on the whole border.
pub(super) struct Trace {
    pub ends: Ends,
    pub rules: Rules,
    pub panels: Vec<Panel>,
    pub points: Vec<Point>,
    /// v at the starts of the panels.
    starts: Vec<f64>,
}

impl Trace {
    pub(super) fn new(problem: &Problem, ends: Ends, rules: &Rules) -> Self {
        let field = Field::new(problem, &ends, rules, |_| true);
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
            points.iter_mut().zip(values).for_each(|(point, value)| point.value = value);
            before = if panel.contact { 0.0 } else { end };
            if panel.reversed {
                points.reverse();
            }
        }
        Self { panels: field.panels, rules: rules.clone(), ends, points, starts }
    }

    /// Whether its `i`-th point, counted around and around, is in contact.
    pub(super) fn in_contact(&self, i: usize) -> bool {
        self.panels[self.points[i % self.points.len()].panel].contact
    }

    /// The multiplier by which the contact at the `i`-th point is judged: infinite so near to a corner that gaps are
    /// left out, but for the last such point. Between it and the next a gap may end that is not left out.
    fn judged(&self, i: usize) -> f64 {
        let Point { place: Place { corner, t }, multiplier, .. } = self.points[i];
        let many = self.points.len();
        let outwards = (if t > 0.0 { i + 1 } else { i + many - 1 }) % many;
        match [i, outwards].map(|i| self.points[i].place.t.abs() <= UNRESOLVED) {
            [false, _] => multiplier,
            [true, false] => self.at(Place { corner, t: UNRESOLVED.copysign(t) })[1],
            [true, true] => f64::INFINITY,
        }
    }

    /// Of each point what must not be negative: in contact (0) the multiplier over the largest, elsewhere (1) v over
    /// its size, which is also that of psi: in a short gap v is far smaller than inside.
    pub(super) fn signs(&self) -> Vec<(usize, f64)> {
        let largest = self.points.iter().map(|p| p.multiplier).fold(0.0, f64::max);
        let size = self.points.iter().map(|p| p.value.max(p.psi.abs())).fold(0.0, f64::max);
        let sign = |(i, p): (usize, &Point)| match self.in_contact(i) {
            true => (0, self.judged(i) / largest),
            false => (1, p.value / size),
        };
        self.points.iter().enumerate().map(sign).collect()
    }

    /// The harmonic function v - psi inside, by Poisson's integral on the disc: its values on each panel
    /// are interpolated to parts that are no longer than their distance from `z`.
    pub(super) fn harmonic(&self, z: Complex) -> f64 {
        let (image, targets) = (to_disc(z), &self.rules.targets);
        let n = targets.len();
        let harmonic = |p: &Point| p.value - p.psi;
        // Less a constant, so that errors of the quadrature are relative to what is left.
        let mean = self.points.iter().map(harmonic).sum::<f64>() / self.points.len() as f64;
        let mut sum = 0.0;
        for (panel, points) in self.panels.iter().zip(self.points.chunks_exact(n)) {
            let mut values: Vec<f64> = points.iter().map(|p| harmonic(p) - mean).collect();
            if panel.reversed {
                values.reverse();
            }
            let corner = Complex::unit(corner_angle(panel.corner));
            let power = panel.target_power();
            let too_long = |part: [f64; 2]| {
                let segment =
                    part.map(|x| panel.place(panel.nodes(&[[x, 1.0]], power).t[0]).point());
                (segment[1] - segment[0]).norm() > distance(segment, z).max(1e-12)
            };
            let parts = halved([0.0, 1.0], too_long);
            if parts.len() == 1 {
                // The values are wanted where they are known.
                for (k, h) in values.iter().enumerate() {
                    let point = &points[if panel.reversed { n - 1 - k } else { k }];
                    let half = Complex::new(point.angle.cos, point.angle.sin);
                    let to = corner * half * half - image;
                    sum += point.weight * point.angle.slope * h / to.norm2();
                }
                continue;
            }
            for [from, to] in parts {
                let inside =
                    targets.iter().map(|&[x, w]| [from + (to - from) * x, (to - from) * w]);
                let inside: Vec<[f64; 2]> = inside.collect();
                let places: Vec<f64> = inside.iter().map(|&[x, _]| x).collect();
                let matrix = interpolation(targets, &places);
                for (rule, rows) in inside.chunks(LANES).zip(matrix.chunks(LANES * n)) {
                    let nodes = panel.nodes(rule, power);
                    for (k, row) in rows.chunks_exact(n).enumerate() {
                        let h: f64 = row.iter().zip(&values).map(|(m, h)| m * h).sum();
                        let Angle { sin, cos, slope } = nodes.angle(k);
                        let half = Complex::new(cos, sin);
                        let to = corner * half * half - image;
                        sum += nodes.weight[k] * slope * h / to.norm2();
                    }
                }
            }
        }
        mean + sum * (1.0 - image.norm2()) / TAU
    }

    /// v and dv/dn at a place on the border, interpolated between the points of its panel.
    pub(super) fn at(&self, place: Place) -> [f64; 2] {
        // As seen from the corner of a panel, at most two sides away.
        let seen_from = |panel: &Panel| {
            let corners = (place.corner - panel.corner + 1).rem_euclid(4) - 1;
            place.t + f64::from(corners)
        };
        let outside = |panel: &Panel| {
            let t = seen_from(panel);
            (panel.from - t).max(t - panel.to)
        };
        let nearest =
            |(_, a): &(usize, &Panel), (_, b): &(usize, &Panel)| outside(a).total_cmp(&outside(b));
        let (p, panel) =
            self.panels.iter().enumerate().min_by(nearest).expect("the border has panels");
        let t = seen_from(panel).clamp(panel.from, panel.to);
        let offset = if panel.reversed { panel.to - t } else { t - panel.from };
        let scale = offset / (panel.to - panel.from);
        let x = match panel.target_power() {
            1 => scale,
            2 => scale.sqrt(),
            _ => libm::cbrt(scale),
        };
        let n = self.rules.targets.len();
        let point = |k: usize| {
            let k = if panel.reversed { n - 1 - k } else { k };
            let Point { value, multiplier, .. } = self.points[p * n + k];
            [value, multiplier]
        };
        let row = interpolation(&self.rules.targets, &[x]);
        let [value, multiplier] =
            [0, 1].map(|which| row.iter().enumerate().map(|(k, m)| m * point(k)[which]).sum());
        // Better known by integration.
        let value = if place.t == 0.0 { self.corner_value(place.corner) } else { value };
        [value, multiplier]
    }

    /// The contact arcs with their forces; `total` is that on the whole border.
    pub(super) fn arcs(&self, total: f64) -> Vec<ContactArc> {
        let point = |place: Place| {
            let Complex { re, im } = place.point();
            [re, im]
        };
        if self.ends.places.is_empty() {
            let corner = point(Place { corner: 3, t: 0.0 });
            return vec![ContactArc { from: corner, to: corner, force: total }];
        }
        let force = |arc: usize| {
            let own = |panel: &Panel| panel.contact && panel.arcs == arc;
            let points = self.points.iter().filter(|p| own(&self.panels[p.panel]));
            points.map(|p| p.weight * p.multiplier).sum()
        };
        let arc = |(k, pair): (usize, &[Place])| ContactArc {
            from: point(pair[0]),
            to: point(pair[1]),
            force: force(k + 1),
        };
        self.ends.places.chunks_exact(2).enumerate().map(arc).collect()
    }

    /// v in a corner.
    pub(super) fn corner_value(&self, corner: i32) -> f64 {
        let begins = |panel: &Panel| {
            !panel.reversed
                && panel.special == Some(Special::Corner)
                && (panel.corner - corner).rem_euclid(4) == 0
        };
        self.panels.iter().position(begins).map_or(0.0, |p| self.starts[p])
    }
}
