//! v, its slopes, their rounding errors, and bounds of their moduli on cells.

use super::Proof;
use super::cells::{POINTS, ProofCell};
use super::moduli::{Disc, Moduli, TURNS, of_f, of_functions, of_polynomial, of_psi};
use super::samples::{CellModuli, Sampled};
use crate::problem::complex::Complex;
use crate::spectral::fit::field::node;
use crate::spectral::functions::{Power, SpotSum};
use crate::spectral::geometry::panels::{Spot, gauss};

impl Proof<'_> {
    /// Bounds of moduli on the ellipses of cells.
    fn moduli(&self, cells: &[ProofCell]) -> Vec<CellModuli> {
        let discs: Vec<Disc> = cells.iter().map(|own| own.cell.disc).collect();
        let arnoldi = &self.fit.functions.arnoldi;
        let own = &self.fit.coefficients[self.fit.coefficients.len() - arnoldi.len() - 1..];
        let polynomials = of_polynomial(arnoldi, own, &discs);
        let both = cells.iter().zip(polynomials);
        both.map(|(own, polynomial)| self.moduli_on(own, polynomial)).collect()
    }

    /// Bounds of moduli on the ellipse of a cell, from those of the polynomial.
    fn moduli_on(&self, own: &ProofCell, polynomial: Moduli) -> CellModuli {
        let interval = &self.fit.walk.intervals[own.interval];
        let split = own.cell.is_log.then_some(interval.splits[own.side]);
        let mut rest = of_functions(self.fit, own.cell.disc, split);
        rest.add(polynomial);
        let psi = of_psi(&self.setup.jumps.psi, own.cell.disc);
        rest.add(psi);
        let side = self.setup.domain.side(interval);
        let Disc { centre, radius, .. } = own.cell.disc;
        let at = side.formula.map(|k| self.setup.domain.values[k].moduli(centre, radius));
        let [value, slope] = at.unwrap_or([side.law.at().abs(), 0.0]);
        let at = Moduli { value, slope };
        rest.add(at);
        // The normal of an arc, continued, is longer than 1.
        rest.slope *= if interval.curvature == 0.0 { 1.0 } else { 1.8 };
        let (value, slope) = (vec![[0.0, rest.value]], vec![[1.0, rest.slope]]);
        let mut moduli = CellModuli { value, slope, rest, psi, at };
        if split.is_some() {
            self.add_own(own, split, &mut moduli);
        }
        moduli
    }

    /// Adds the bounds of the functions of a split on a cell in log r.
    fn add_own(&self, own: &ProofCell, split: Option<usize>, moduli: &mut CellModuli) {
        let Disc { radius, .. } = own.cell.disc;
        for (family, coefficients) in self.fit.families().filter(|(own, _)| own.split == split) {
            for (k, &Power { power, log: is_log }) in family.powers.iter().enumerate() {
                let (mut value, mut slope) = (0.0, 0.0);
                let by_cuts = coefficients.chunks_exact(family.powers.len());
                for (&d, c) in family.lengths.iter().zip(by_cuts) {
                    let least = d - radius;
                    let sizes = own.cell.distances.map(|r| (libm::log(r).abs(), r));
                    let log = sizes[0].0.max(sizes[1].0) + libm::log(least).abs() + TURNS[1] + 1.0;
                    let [own_log, factor] =
                        if is_log { [log, power * log + 1.0] } else { [1.0, power] };
                    let size = c[k].norm() * libm::pow(1.2 / least, power);
                    value += size * own_log;
                    // The distance along an arc over that in the plane, and the length of the normal.
                    slope += size * factor * d / least * 1.25 * 1.5;
                }
                moduli.value.push([power, value]);
                moduli.slope.push([power, slope]);
            }
        }
    }

    /// v on cells.
    pub(super) fn samples(&self, cells: &[ProofCell]) -> Vec<Sampled> {
        let rule = gauss(POINTS);
        let mut spots: Vec<Spot> = Vec::with_capacity(cells.len() * POINTS);
        let mut distances: Vec<f64> = Vec::with_capacity(cells.len() * POINTS);
        for own in cells {
            for [r, weight] in own.cell.nodes(rule) {
                distances.push(r);
                let mut spot = self.fit.walk.spot(own.interval, own.side, r, weight);
                if !own.cell.is_log {
                    // All functions see the same point.
                    spot.split = usize::MAX;
                }
                spots.push(spot);
            }
        }
        let sums = self.fit.functions.bounded_sums(&self.fit.all_coefficients(), &spots);
        let points: Vec<Complex> = spots.iter().map(|spot| spot.z).collect();
        let psi = &self.setup.jumps.psi;
        let (values, gradients) = (psi.values(&points), psi.gradients(&points));
        let psi_errors = psi.errors(&points);
        // That of the field whose divergence is the change of f.
        let off_flux = self.setup.jumps.changes.field;
        let mut samples = Vec::with_capacity(cells.len());
        for (k, (own, moduli)) in cells.iter().zip(self.moduli(cells)).enumerate() {
            let range = k * POINTS..(k + 1) * POINTS;
            let interval = &self.fit.walk.intervals[own.interval];
            let side = self.setup.domain.side(interval);
            let mut sampled = Sampled::new(*own, moduli, distances[range.clone()].to_vec());
            for i in range {
                let (spot, gradient) = (spots[i], gradients[i]);
                let SpotSum { value, slope, errors } = sums[i];
                let node = node(self.setup, self.fit, spot, [value, slope], (values[i], gradient));
                sampled.nodes.push(node);
                let rate = gradient - self.setup.domain.value(side, spot.z).1;
                sampled.slopes.push((slope * spot.tangent).re + rate.dot(spot.tangent));
                sampled.rounding.push([errors[0] + side.off, errors[1] + off_flux]);
                sampled.psi.push(psi_errors[i]);
            }
            let f = of_f(psi, interval.f, own.cell.disc);
            sampled.add_rounding(f, interval.curvature);
            self.add_logs(&mut sampled);
            samples.push(sampled);
        }
        samples
    }

    /// Adds the logarithms of holes that are added to v.
    pub(super) fn add_logs(&self, sampled: &mut Sampled) {
        /// Rounding errors, in units in the last place.
        const UNITS: f64 = 8.0;
        for (hole, &c) in self.fit.functions.holes.iter().zip(&self.logs) {
            let Moduli { value, slope } = hole.moduli(sampled.own.cell.disc, &[], c);
            sampled.moduli.value.push([0.0, value]);
            sampled.moduli.slope.push([1.0, 1.8 * slope]);
            let errors = sampled.rounding.iter_mut();
            for ((node, slope), errors) in
                sampled.nodes.iter_mut().zip(&mut sampled.slopes).zip(errors)
            {
                let away = node.spot.z - hole.middle;
                let size = 1.0 / away.norm2();
                let log = 0.5 * c * libm::log(away.norm2());
                errors[0] += UNITS * f64::EPSILON * (log.abs() + c.abs());
                errors[1] += UNITS * f64::EPSILON * c.abs() * size.sqrt();
                node.value += log;
                node.flux += c * size * away.dot(node.normal());
                *slope += c * size * away.dot(node.spot.tangent);
            }
        }
    }
}
