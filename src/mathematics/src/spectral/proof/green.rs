//! A harmonic function h of few terms next to `g = v - psi`, by which rounding errors of v count less in the energy.
//!
//! By Green's second identity `oint h_n g - h g_n = 0`, where the index n is the derivative along the normal. With half
//! of this integral the energy by the [`integrals`](super::integrals) is the same, but its
//! derivatives by v and by dv/dn, `-g_n / 2` and `g / 2`, become those of g - h.

use super::cells::ProofCell;
use super::moduli::{Disc, Moduli, of_polynomial};
use super::samples::Sampled;
use crate::problem::complex::Complex;
use crate::spectral::fit::Fit;
use crate::spectral::fit::field::PlaneNode;
use crate::spectral::fit::least_squares::Columns;
use crate::spectral::functions::lanes::TOGETHER;
use crate::spectral::functions::{Functions, Hole, SpotSum, Values};
use crate::spectral::geometry::panels::Spot;

/// The function h: a polynomial, and powers and a logarithm for each hole.
pub(super) struct HarmonicFit {
    functions: Functions,
    /// Those of powers of holes, of polynomials, and of logarithms.
    coefficients: Vec<Complex>,
}

/// h at a point of the boundary.
pub(super) struct HarmonicNode {
    pub value: f64,
    /// Derivative along the normal.
    pub flux: f64,
    /// Bounds of the rounding errors of both.
    pub errors: [f64; 2],
}

impl HarmonicFit {
    /// Function whose real part is nearest to g at some points of cells.
    pub(super) fn new(fit: &Fit, samples: &[Sampled]) -> Self {
        /// Largest degree of polynomials, and number of powers of a hole.
        const DEGREES: [usize; 2] = [12, 8];
        /// One of so many points is taken.
        const APART: usize = 5;
        let arnoldi = fit.functions.arnoldi.iter().take(DEGREES[0]).cloned().collect();
        let holes = fit.functions.holes.iter();
        let holes = holes.map(|hole| Hole { powers: hole.powers.min(DEGREES[1]), ..hole.clone() });
        let functions = Functions { arnoldi, holes: holes.collect(), ..Functions::default() };
        let nodes: Vec<&PlaneNode> =
            samples.iter().flat_map(|own| own.nodes.iter().step_by(APART)).collect();
        let spots: Vec<Spot> = nodes.iter().map(|node| node.spot).collect();
        let (complex, logs) = (functions.complex(), functions.holes.len());
        let mut matrix = Columns::new(spots.len(), 2 * complex + logs);
        let mut values = Values::default();
        for (block, first) in spots.chunks(TOGETHER).zip((0..).step_by(TOGETHER)) {
            functions.at(block, &mut values);
            for (l, spot) in block.iter().enumerate() {
                let (i, weight) = (first + l, spot.weight.sqrt());
                for (k, own) in values.all[..complex].iter().enumerate() {
                    matrix.column(2 * k)[i] = weight * own.re[l];
                    matrix.column(2 * k + 1)[i] = -weight * own.im[l];
                }
                for (k, own) in values.all[complex..].iter().enumerate() {
                    matrix.column(2 * complex + k)[i] = weight * own.re[l];
                }
                matrix.column(2 * complex + logs)[i] = weight * HarmonicNode::of_g(nodes[i])[0];
            }
        }
        let x = matrix.solve();
        let (plain, logs) = x.split_at(2 * complex);
        let plain = plain.chunks_exact(2).map(|pair| Complex::new(pair[0], pair[1]));
        let coefficients = plain.chain(logs.iter().map(|&c| Complex::new(c, 0.0))).collect();
        Self { functions, coefficients }
    }

    /// Bounds of h and its derivative on the discs of cells.
    pub(super) fn moduli(&self, samples: &[Sampled]) -> Vec<Moduli> {
        let Functions { arnoldi, holes, .. } = &self.functions;
        let discs: Vec<Disc> = samples.iter().map(|own| own.own.cell.disc).collect();
        let powers = holes.iter().map(|hole| hole.powers).sum::<usize>();
        let (own, rest) = self.coefficients.split_at(powers);
        let (polynomial, logs) = rest.split_at(arnoldi.len() + 1);
        let mut moduli = of_polynomial(arnoldi, polynomial, &discs);
        for (sum, disc) in moduli.iter_mut().zip(discs) {
            let disc = Disc { inner: 0.0, ..disc };
            let mut own = own;
            for (hole, log) in holes.iter().zip(logs) {
                let (first, others) = own.split_at(hole.powers);
                sum.add(hole.moduli(disc, first, log.re));
                own = others;
            }
        }
        moduli
    }

    /// h at the points of a cell, with bounds of h and its derivative on its disc.
    pub(super) fn on(&self, own: &Sampled, moduli: Moduli) -> Vec<HarmonicNode> {
        let ProofCell { cell, .. } = own.own;
        let spots: Vec<Spot> = own.nodes.iter().map(|node| node.spot).collect();
        // Points are off by two units, and by those of log r; by Cauchy's estimate the slope changes.
        let units = if cell.is_log { 1.0 + cell.length() } else { 0.0 };
        let off = f64::EPSILON * (2.0 + cell.span[1] * units);
        let radius = if cell.is_log { 1.2 * cell.span[1] } else { 0.5 * cell.length() };
        let change = moduli.slope / (cell.disc.radius - radius);
        let mut nodes = Vec::with_capacity(spots.len());
        let sums = self.functions.bounded_sums(&self.coefficients, &spots);
        for (SpotSum { value, slope, errors }, node) in sums.into_iter().zip(&own.nodes) {
            let errors = [errors[0] + off * slope.norm(), errors[1] + off * change];
            let flux = (slope * node.normal()).re;
            nodes.push(HarmonicNode { value: value.re, flux, errors });
        }
        nodes
    }
}

impl HarmonicNode {
    /// g and its derivative along the normal.
    pub(super) fn of_g(node: &PlaneNode) -> [f64; 2] {
        [node.value - node.psi, node.flux - node.psi_flux]
    }

    /// Part of the point in half of the integral that is zero.
    pub(super) fn term(&self, node: &PlaneNode) -> f64 {
        let [g, rate] = Self::of_g(node);
        0.5 * node.spot.weight * (self.flux * g - self.value * rate)
    }
}

#[cfg(test)]
mod tests;
