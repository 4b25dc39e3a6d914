//! The part of the energy along jumps of f, with bounds of its errors.

use super::cells::{CellStretch, EllipseCell, POINTS, Singular, Surroundings};
use super::exact_energy::BoundedEnergy;
use super::integrals::Integrals;
use super::moduli::{Moduli, TOUCHES, of_psi};
use crate::problem::complex::Complex;
use crate::spectral::geometry::curve::{Arc, ROUNDING};
use crate::spectral::geometry::panels::gauss;
use crate::spectral::setup::Setup;
use crate::spectral::source::groups::{GroupEdge, JumpGroup, PieceSide};
use crate::spectral::source::psi::Psi;

impl BoundedEnergy {
    /// Adds the integrals along a jump of f; the error is infinite if psi beside it has no bound.
    pub(super) fn add_edge(&mut self, setup: &Setup, group: &JumpGroup, own: &GroupEdge) {
        /// Part of a jump, over its longest cell in log r, that is left out at an end.
        const LEFT: f64 = 1e-24;
        let singular = Singular { psi: &group.psi, points: Vec::new() };
        let Arc { curve, span: [start, end], ends } = own.edge.arc;
        let half = 0.5 * (end - start);
        for (from, way, vertex) in [(start, 1.0, ends[0]), (end, -1.0, ends[1])] {
            let centre = curve.at(from);
            let reach = (singular.room(centre, Some(usize::MAX)) / 2.4)
                .min(0.25 / curve.curvature)
                .min(setup.diameter);
            let top = (0.2 * reach).min(half);
            let near = Surroundings { centre, top, least: LEFT * top, reach };
            // On the boundary another jump may end at the same point.
            let is_singular = vertex.is_some() || singular.room(centre, None) < TOUCHES;
            let stretch = CellStretch {
                curve,
                from,
                way,
                singular: &singular,
                length: half,
                longest: 0.25 * setup.diameter,
                near: is_singular.then_some(near),
            };
            for cell in stretch.cells() {
                let size = self.add_cell(group, own, [from, way], &cell);
                if cell.is_log && cell.span[0] <= 1.01 * near.least {
                    self.error += near.least * size;
                }
            }
        }
    }

    /// Adds the error of the energy if all of a small shape is off by rounding of coordinates: the integral of f on it
    /// times the gradient of what is smooth there of v.
    pub(super) fn add_moved(&mut self, setup: &Setup, group: &JumpGroup) {
        let Some(extent) = group.extent else { return };
        let jumps = group.edges.iter().map(|own| own.edge.jump().abs());
        let mass = 4.0 * extent.half[0] * extent.half[1] * jumps.sum::<f64>();
        let parts = group.psi.parts().iter();
        let others = parts.filter(|part| part.far.is_none() || part.middle != Complex::default());
        let others = Psi::Jumps(others.cloned().collect());
        let [rest] = others.gradients(&[Complex::default()])[..] else { return };
        let slope = rest.norm() + 2.0 * self.most_g / setup.domain.distance(group.middle);
        self.error += ROUNDING * mass * slope;
    }

    /// Adds the integrals on a cell of a jump, seen from an end, with the way from there. Returns a bound of the
    /// integrand of the energy.
    fn add_cell(
        &mut self,
        group: &JumpGroup,
        own: &GroupEdge,
        [from, way]: [f64; 2],
        cell: &EllipseCell,
    ) -> f64 {
        let curve = own.edge.arc.curve;
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        for [r, weight] in cell.nodes(gauss(POINTS)) {
            let s = from + way * r;
            points.push(curve.at(s));
            normals.push((-curve.direction(s).turned()).scaled(weight));
        }
        let mut sums = Integrals::default();
        let (values, gradients) = (group.psi.values(&points), group.psi.gradients(&points));
        sums.add_jump(own, [&points, &normals], (&values, &gradients));
        self.energy += sums.energy();
        self.balance += sums.source;
        self.cells += 1;
        self.add_jump_rounding((group, own), [&points, &normals], (&values, &gradients));
        let units = f64::EPSILON * (self.cells + POINTS + 16) as f64;
        let scale = if cell.is_log { cell.distances[1] } else { 1.0 };
        let Moduli { value, slope } = of_psi(&group.psi, cell.disc);
        let mut size = 0.0;
        for PieceSide { quadratic, f, square } in &own.sides {
            let [far, p, rate] = quadratic.bounds(cell.disc.centre, cell.disc.radius);
            size += 4.0 * (f.abs() * (value * rate + p * slope) + square.abs() * far * p);
            self.unbalanced += cell.gauss_error(f.abs() * far * scale);
            for (&z, normal) in points.iter().zip(&normals) {
                // Coordinates across a line parallel to an axis are those of the line.
                let outward = products(z, *normal) + products(quadratic.centre, *normal);
                self.unbalanced += units * f.abs() * outward;
            }
        }
        self.error += cell.gauss_error(size * scale);
        size
    }

    /// Adds the error by rounding of psi and of coordinates at points of a jump.
    fn add_jump_rounding(
        &mut self,
        (group, own): (&JumpGroup, &GroupEdge),
        [points, normals]: [&[Complex]; 2],
        (values, gradients): (&[f64], &[Complex]),
    ) {
        // Coordinates are off by two units.
        let off = 2.0 * f64::EPSILON * group.reach().min(1.0);
        for (i, errors) in group.psi.errors(points).into_iter().enumerate() {
            let (z, weight) = (points[i], 0.5 * normals[i].norm());
            let (value, slope) = (values[i].abs(), gradients[i].norm());
            // f differs next to a border that is off.
            self.error += 2.0 * weight * own.edge.jump().abs() * group.off * (value + self.most_g);
            for PieceSide { quadratic, f, square } in &own.sides {
                let (p, rate) = quadratic.at(z);
                let by_value = rate.norm() * (errors.value + off * slope);
                let by_slope = p * (errors.slope + off * errors.bend);
                let outward = 0.25 * square.abs() * (z - quadratic.centre).norm() * p;
                let terms = rate.norm() * value + p * slope;
                self.error += weight * f.abs() * (by_value + by_slope);
                self.terms += weight * (f.abs() * terms + outward);
            }
        }
    }
}

/// Sum of the moduli of the products of coordinates.
fn products(z: Complex, normal: Complex) -> f64 {
    (z.re * normal.re).abs() + (z.im * normal.im).abs()
}

#[cfg(test)]
mod tests;
