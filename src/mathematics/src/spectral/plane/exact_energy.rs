//! The energy by Gauss rules on cells, with a bound of their errors and of rounding.

use super::boundary::State;
use super::cells::{CellStretch, POINTS, Singular, Surroundings, Track};
use super::energy::Integrals;
use super::moduli::{Moduli, of_psi, psi_errors};
use super::proof::Proof;
use super::psi::Psi;
use super::samples::Sampled;
use super::setup::Setup;
use crate::spectral::jumps::JumpEdge;
use crate::spectral::rule::gauss;

/// Energy with a bound of its error.
pub(super) struct BoundedEnergy {
    pub energy: f64,
    pub error: f64,
}

/// Energy of v on cells; `left` bounds the variation of v closer to splits than all cells, split by split.
///
/// # Errors
/// Part that is not proved.
pub(super) fn bounded_energy(
    proof: &Proof,
    samples: &[Sampled],
    left: &[Leftover],
) -> Result<BoundedEnergy, &'static str> {
    let nodes: Vec<_> = samples.iter().flat_map(|own| own.nodes.iter().copied()).collect();
    let mut sums = Integrals::on_boundary(proof.setup, proof.fit, &nodes);
    let (mut error, mut total) = (0.0, 0.0);
    for own in samples {
        let [of_values, terms] = rounding(proof, own);
        error += of_values + own.own.cell.gauss_error(modulus(proof, own));
        total += terms;
    }
    for edge in &proof.setup.jumps.edges {
        error += add_edge(proof.setup, edge, &mut sums)?;
    }
    for own in left {
        error += own.integrals;
    }
    // Those of the sum itself.
    error += (nodes.len() as f64 + 16.0) * f64::EPSILON * total;
    Ok(BoundedEnergy { energy: sums.completed().energy, error })
}

/// Boundary closer to a split than all cells, on one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leftover {
    pub interval: usize,
    /// Bound of the variation of v there, and of the integral of the modulus of its flux.
    pub variation: f64,
    /// Bound of the integrals of the energy there.
    pub integrals: f64,
}

impl Leftover {
    /// Of the cell that is nearest to the split.
    pub(super) fn of(proof: &Proof, own: &Sampled) -> Self {
        let (least, moduli) = (own.own.cell.span[0], &own.moduli);
        // Twice for the growth of logarithms.
        let terms =
            moduli.slope.iter().map(|[power, m]| 2.0 * m * libm::pow(least, *power) / power);
        let variation = terms.sum::<f64>();
        let (node, size) = (&own.nodes[0], EnergyFactors::of(proof, own));
        let value = node.value.abs() + node.psi.abs() + variation + size.rate * least;
        let integrals = 4.0 * value * (variation + size.rate * least) + size.constants * least;
        Self { interval: own.own.interval, variation, integrals }
    }
}

/// Factors of the bound of the integrand of the energy.
struct EnergyFactors {
    constants: f64,
    /// Bound of slopes but that of v.
    rate: f64,
}

impl EnergyFactors {
    fn of(proof: &Proof, own: &Sampled) -> Self {
        let interval = &proof.fit.walk.intervals[own.own.interval];
        let disc = own.own.cell.disc;
        let far = (disc.centre - proof.setup.centre).norm() + disc.radius;
        let f = match &proof.setup.jumps.psi {
            Psi::Jumps(_) => interval.f.abs(),
            Psi::Polynomial(f) => f.moduli(disc.centre.norm() + disc.radius)[0],
        };
        let q = if let State::Flux(q) = interval.state { q.abs() } else { 0.0 };
        let far = 1.0 + far + disc.centre.norm();
        let Moduli { value, slope } = own.moduli.psi;
        let constants = 8.0 * (1.0 + f) * (1.0 + f) * libm::pow(far, 4.0) * (1.0 + value + slope);
        Self { constants, rate: slope + q }
    }
}

/// Bound of the integrand of the energy on the ellipse of a cell, in its variable: each of its terms is v or psi times
/// a slope of v or psi, or f times psi and powers of the distance from the middle.
fn modulus(proof: &Proof, own: &Sampled) -> f64 {
    let (cell, moduli) = (&own.own.cell, &own.moduli);
    let r = if cell.is_log { cell.distances[1] } else { 1.0 };
    let [value, slope] = [&moduli.value, &moduli.slope]
        .map(|terms| terms.iter().map(|[g, m]| m * libm::pow(r, *g)).sum::<f64>());
    let size = EnergyFactors::of(proof, own);
    size.constants * (value + 1.0) * (slope + size.rate * r)
}

/// Error of the integrals of a cell by rounding of v, psi and their slopes, and the sum of the moduli of their terms.
///
/// The integrand of the energy is `1/2 (v (s l + psi_n - 2 q) - psi l - f psi)` with s = -1 where v should be zero and
/// 1 elsewhere, in which `int f psi` is an integral of `f (1/2 psi (x.n) - q psi_n - 1/4 f q (x.n))`, q = |x|^2 / 4.
fn rounding(proof: &Proof, own: &Sampled) -> [f64; 2] {
    let interval = &proof.fit.walk.intervals[own.own.interval];
    let q = if let State::Flux(q) = interval.state { q.abs() } else { 0.0 };
    let of_psi = psi_errors(own.moduli.psi_here);
    let mut sums = [0.0; 2];
    for (node, [value, slope]) in own.nodes.iter().zip(&own.rounding) {
        let (weight, z) = (node.spot.weight, node.spot.z);
        let by_value = 0.5 * (node.flux.abs() + node.psi_flux.abs()) + q;
        let by_slope = 0.5 * (node.value.abs() + node.psi.abs());
        let f = match &proof.setup.jumps.psi {
            Psi::Jumps(_) => interval.f.abs(),
            Psi::Polynomial(f) => f.moduli(z.norm())[0],
        };
        let square = 0.25 * (z - proof.setup.centre).norm2();
        let far = if matches!(proof.setup.jumps.psi, Psi::Jumps(_)) {
            2.0 * square.sqrt()
        } else {
            z.norm()
        };
        let by_psi = 0.5 * f * far + 0.5 * node.flux.abs();
        let by_psi_slope = f * square + 0.5 * node.value.abs();
        sums[0] += weight * (value * by_value + slope * by_slope);
        sums[0] += weight * (of_psi[0] * by_psi + of_psi[1] * by_psi_slope);
        sums[1] += weight * (node.value.abs() * by_value + node.psi.abs() * by_psi);
        sums[1] += weight * (node.psi_flux.abs() * by_psi_slope + f * f * far * square);
    }
    sums
}

/// Adds the integrals along a jump of f; returns a bound of their error.
fn add_edge(setup: &Setup, edge: &JumpEdge, sums: &mut Integrals) -> Result<f64, &'static str> {
    let singular = Singular { psi: &setup.jumps.psi, points: Vec::new() };
    let (curve, rule) = (edge.arc.curve, gauss(POINTS));
    let [start, end] = edge.arc.span;
    let half = 0.5 * (end - start);
    let [left, right] = edge.values;
    let mut error = 0.0;
    for (from, way, vertex) in [(start, 1.0, edge.arc.ends[0]), (end, -1.0, edge.arc.ends[1])] {
        let centre = curve.at(from);
        let reach = (singular.room(centre, Some(usize::MAX)) / 2.4)
            .min(0.25 / curve.curvature)
            .min(setup.diameter);
        let top = (0.2 * reach).min(half);
        let near = Surroundings { centre, top, least: 1e-16 * top, reach };
        let stretch = CellStretch {
            track: Track::Curve(curve, from, way),
            singular: &singular,
            curvature: curve.curvature,
            length: half,
            longest: 0.25 * setup.diameter,
            near: vertex.map(|_| near),
        };
        let cells = stretch.cells().ok_or("psi on jumps of f")?;
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        for cell in cells {
            let psi = of_psi(&setup.jumps.psi, cell.disc);
            let Moduli { value, slope } = psi;
            let errors = psi_errors(of_psi(&setup.jumps.psi, cell.hull));
            for [r, weight] in cell.nodes(&rule) {
                let s = from + way * r;
                points.push(curve.at(s));
                normals.push((-curve.direction(s).turned()).scaled(weight));
                let square = 0.25 * (curve.at(s) - setup.centre).norm2();
                let by_value = square.sqrt()
                    * (errors[0] + 8.0 * f64::EPSILON * (left + right).abs() * square);
                error += weight * (left - right).abs() * (by_value + square * errors[1]);
            }
            let far = 1.0 + (cell.disc.centre - setup.centre).norm() + cell.disc.radius;
            let size = (left - right).abs() * far * far * far;
            let size = 4.0 * size * (value + slope + left.abs() + right.abs());
            let scale = if cell.is_log { cell.distances[1] } else { 1.0 };
            error += cell.gauss_error(size * scale);
            if cell.is_log {
                error += 1e-16 * top * size;
            }
        }
        sums.add_jump(setup, edge.values, &points, &normals);
    }
    Ok(error)
}
