//! Cells of curves on which v is analytic in an ellipse: the error of polynomials and Gauss rules on them is bounded.
//!
//! A function that is analytic in the ellipse with foci at -1 and 1 and half axes `(rho + 1/rho) / 2` and
//! `(rho - 1/rho) / 2`, and at most M there, differs from a polynomial of degree n - 1 by no more than
//! `2 M rho^(1-n) / (rho - 1)`, and the Gauss rule of n points is wrong by no more than
//! `(64/15) M rho^(2-2n) / (1 - rho^-2)`: Trefethen, *Approximation Theory and Approximation Practice* (2013), theorems
//! 8.2 and 19.3.
//!
//! Away from the singular points a cell is a part of the curve, and the ellipse lies in a disc that holds none of them.
//! Next to a split all is a sum of powers of the distance r from it times analytic functions; there the variable is
//! log r, in which powers are entire, and the ellipse lies between two circles round the split.

use super::moduli::{Disc, room_of_psi};
use crate::problem::complex::Complex;
use crate::spectral::geometry::boundary::Walk;
use crate::spectral::geometry::curve::Curve;
use crate::spectral::geometry::panels::{self, GaussNode, cut, gauss};
use crate::spectral::source::psi::Psi;

/// Gauss points of a cell.
pub(super) const POINTS: usize = 28;
/// Least and greatest half axis of an ellipse.
const AXES: [f64; 2] = [1.893, 3.3];
/// Longest half cell as an angle.
const WIDEST: f64 = 0.17;

/// Points at which v, continued from the boundary, is singular.
pub(super) struct Singular<'a> {
    pub psi: &'a Psi,
    /// Points with the number of the split that each is.
    pub points: Vec<(Complex, Option<usize>)>,
}

impl Singular<'_> {
    /// Distance of a point from all of them but a split, if it is that one.
    pub(super) fn room(&self, z: Complex, split: Option<usize>) -> f64 {
        let others = self.points.iter().filter(|(_, own)| split.is_none() || *own != split);
        let room = others.map(|(point, _)| (*point - z).norm()).fold(f64::INFINITY, f64::min);
        room.min(room_of_psi(self.psi, z, split.is_some()))
    }
}

/// Surroundings of a split.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    pub centre: Complex,
    /// Largest distance of cells in log r.
    pub top: f64,
    /// Distance from which on nothing is bounded by cells.
    pub least: f64,
    /// Distance within which nothing else is singular.
    pub reach: f64,
}

/// Half of a piece of a curve, seen from one of its ends.
#[derive(Clone, Copy)]
pub(super) struct CellStretch<'a> {
    pub curve: Curve,
    /// Place of the end along the curve, and 1 if the piece runs in the direction of the curve from there, else -1.
    pub from: f64,
    pub way: f64,
    pub singular: &'a Singular<'a>,
    pub length: f64,
    /// Longest cell.
    pub longest: f64,
    /// Surroundings of the end, if it is singular.
    pub near: Option<Surroundings>,
}

/// Cell of a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct EllipseCell {
    /// Least and greatest distance from the end.
    pub span: [f64; 2],
    /// True if its variable is log r.
    pub is_log: bool,
    pub rho: f64,
    /// Disc that holds its ellipse.
    pub disc: Disc,
    /// Least and greatest distance from the end on the ellipse.
    pub distances: [f64; 2],
}

impl CellStretch<'_> {
    /// Point by the distance from the end.
    fn at(&self, s: f64) -> Complex {
        self.curve.at(self.from + self.way * s)
    }

    /// Cells of the stretch, on the shortest of which functions may have no bound.
    pub(super) fn cells(&self) -> Vec<EllipseCell> {
        let mut cells = Vec::new();
        let top = self.near.map_or(0.0, |near| near.top);
        if let Some(near) = self.near {
            let mut to = near.top;
            while to > 1.000_001 * near.least {
                let room = libm::log(near.reach / to);
                let most = if to > 1e-9 * near.reach { 2.4 } else { 8.0 };
                let half = room.min(most).min(0.5 * libm::log(to / near.least));
                let from = to * libm::exp(-2.0 * half);
                cells.push(Self::log_cell(near, [from, to]));
                to = from;
            }
        }
        if top < self.length {
            for span in cut([top, self.length], |span| self.cut_at(span)) {
                cells.push(self.plain_cell(span));
            }
        }
        cells
    }

    /// The two halves of a cell.
    pub(super) fn halves(&self, cell: EllipseCell) -> Option<[EllipseCell; 2]> {
        let [from, to] = cell.span;
        let near = self.near.filter(|_| cell.is_log);
        let middle = if near.is_some() { (from * to).sqrt() } else { 0.5 * (from + to) };
        let halves = [[from, middle], [middle, to]].map(|span| match near {
            Some(near) => Self::log_cell(near, span),
            None => self.plain_cell(span),
        });
        halves.iter().all(EllipseCell::has_bounds).then_some(halves)
    }

    fn log_cell(near: Surroundings, span: [f64; 2]) -> EllipseCell {
        let half = 0.5 * libm::log(span[1] / span[0]);
        let axis = (1.0 + libm::log(near.reach / span[1]) / half).min(AXES[1]);
        let beyond = libm::exp(half * (axis - 1.0));
        let distances = [span[0] / beyond, span[1] * beyond];
        // On an arc the distance in the plane differs by up to a fifth from that along it.
        let (radius, inner) = (1.2 * near.reach, 0.8 * distances[0]);
        let disc = Disc { centre: near.centre, radius, inner };
        EllipseCell { span, is_log: true, rho: axis + (axis * axis - 1.0).sqrt(), disc, distances }
    }

    /// Half axis of the ellipse of a cell.
    fn axis(&self, [from, to]: [f64; 2]) -> f64 {
        let (half, bend) = (0.5 * (to - from), self.curve.curvature);
        let room = 0.85 * self.singular.room(self.at(0.5 * (from + to)), None);
        let along =
            if bend == 0.0 { room } else { (libm::log1p(bend * room) / bend).min(0.5 / bend) };
        (along / half).min(AXES[1])
    }

    fn cut_at(&self, span: [f64; 2]) -> Option<f64> {
        let [from, to] = span;
        let length = to - from;
        let is_long = length > self.longest || 0.5 * length * self.curve.curvature > WIDEST;
        let at = if to > 4.0 * from && from > 0.0 { (from * to).sqrt() } else { 0.5 * (from + to) };
        (length > 1e-12 && (is_long || self.axis(span) < AXES[0])).then_some(at)
    }

    fn plain_cell(&self, span: [f64; 2]) -> EllipseCell {
        let [from, to] = span;
        let (middle, half, bend) = (0.5 * (from + to), 0.5 * (to - from), self.curve.curvature);
        let axis = self.axis(span);
        // Without an ellipse all errors are infinite.
        let axis = if axis < AXES[0] { 1.0 } else { axis };
        let along = axis * half;
        let radius = if bend == 0.0 { along } else { libm::expm1(bend * along) / bend };
        let disc = Disc { centre: self.at(middle), radius, inner: 0.0 };
        let distances = [middle - along, middle + along];
        EllipseCell { span, is_log: false, rho: axis + (axis * axis - 1.0).sqrt(), disc, distances }
    }
}

/// Cell of an interval, seen from one of its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct ProofCell {
    pub interval: usize,
    /// 0 if its points are seen from the start of the interval, 1 from the end.
    pub side: usize,
    pub cell: EllipseCell,
}

impl ProofCell {
    /// Part of the interval, from its start.
    pub(super) fn along(&self, walk: &Walk) -> [f64; 2] {
        let [from, to] = self.cell.span;
        let length = walk.intervals[self.interval].length;
        if self.side == 0 { [from, to] } else { [length - to, length - from] }
    }

    /// Point in its middle.
    pub(super) fn middle(&self, walk: &Walk) -> Complex {
        let [from, to] = self.cell.span;
        walk.spot(self.interval, self.side, 0.5 * (from + to), 0.0).z
    }
}

impl EllipseCell {
    /// True if functions on it have bounds.
    pub(super) fn has_bounds(&self) -> bool {
        self.rho > 1.0
    }

    /// Distances from the end and weights of a Gauss rule.
    pub(super) fn nodes(&self, rule: &[GaussNode]) -> Vec<[f64; 2]> {
        let [from, to] = self.span;
        let length = self.length();
        let mut nodes = Vec::with_capacity(rule.len());
        for &GaussNode { x, weight } in rule {
            let r =
                if self.is_log { to * libm::exp(length * (x - 1.0)) } else { from + length * x };
            nodes.push([r, length * weight * if self.is_log { r } else { 1.0 }]);
        }
        nodes
    }

    /// Length in its variable.
    pub(super) fn length(&self) -> f64 {
        match self.is_log {
            true => libm::log(self.span[1] / self.span[0]),
            false => self.span[1] - self.span[0],
        }
    }

    /// Largest error of a polynomial of degree `POINTS - 1` through the Gauss points, for a function with this bound
    /// on the ellipse. The norm of the interpolation is at most n: by Cauchy and Schwarz the sum of the moduli of its
    /// basis is no more than the root of 2 times the sum of `(2k + 1) / 2`, k < n.
    pub(super) fn tail(&self, modulus: f64) -> f64 {
        let n = POINTS as f64;
        (1.0 + n) * 2.0 * modulus * libm::pow(self.rho, 1.0 - n) / (self.rho - 1.0)
    }

    /// Largest error of the Gauss rule, for a function of its variable with this bound on the ellipse.
    pub(super) fn gauss_error(&self, modulus: f64) -> f64 {
        let small = libm::pow(self.rho, 2.0 - 2.0 * POINTS as f64);
        0.5 * self.length() * 64.0 / 15.0 * modulus * small / (1.0 - libm::pow(self.rho, -2.0))
    }
}

/// Weights from values at the Gauss points of a cell to coefficients of Legendre polynomials, point by point.
pub(super) fn legendre() -> Vec<[f64; POINTS]> {
    let mut weights = vec![[0.0; POINTS]; POINTS];
    for (weights, node) in weights.iter_mut().zip(gauss(POINTS)) {
        let values = panels::legendre(POINTS - 1, 2.0 * node.x - 1.0);
        for (k, (weight, value)) in weights.iter_mut().zip(values).enumerate() {
            *weight = (2 * k + 1) as f64 * node.weight * value;
        }
    }
    weights
}

#[cfg(test)]
mod tests;
