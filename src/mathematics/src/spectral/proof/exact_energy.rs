//! The energy by Gauss rules on cells, with a bound of their errors and of rounding.
//!
//! Rounding is a model: a bound of the errors of v, psi and their slopes at each point, in units in the last place of
//! all their terms, times the derivatives of the integrand by them; what is wrong with the points themselves counts
//! among those errors. That is nearly all of the distance of the two bounds of most solutions; so the integrals are
//! such that these derivatives are small ([`green`](super::green)).

use super::Proof;
use super::cells::POINTS;
use super::green::{HarmonicFit, HarmonicNode};
use super::integrals::Integrals;
use super::moduli::{Disc, Moduli, of_f};
use super::samples::Sampled;
use crate::problem::complex::Complex;
use crate::spectral::fit::Fit;
use crate::spectral::fit::field::PlaneNode;
use crate::spectral::geometry::boundary::{
    JoinedCrossing, JoinedPiece, PlaneCrossing, State, Walk,
};
use crate::spectral::setup::Setup;
use crate::spectral::source::psi::Psi;

/// Energy with a bound of its error.
#[derive(Default)]
pub(super) struct BoundedEnergy {
    pub energy: f64,
    pub error: f64,
    /// Integral of `at` dv/dn over the boundary.
    pub(super) given: f64,
    /// Integral of dv/dn over the boundary plus that of f, which is zero.
    pub(super) balance: f64,
    /// Bound of the error of that.
    pub(super) unbalanced: f64,
    /// Sum of the moduli of all terms.
    pub(super) terms: f64,
    /// Number of cells, whose integrals are added.
    pub(super) cells: usize,
    /// Bound of |v - psi|, which is harmonic.
    pub(super) most_g: f64,
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
    let harmonic = HarmonicFit::new(proof.fit, samples);
    let mut sum = BoundedEnergy { cells: samples.len(), ..BoundedEnergy::default() };
    let mut largest = 0.0f64;
    let g = samples.iter().flat_map(|own| &own.nodes).map(|node| HarmonicNode::of_g(node)[0].abs());
    // Larger between the points, where v has been bounded, by less than all of it.
    sum.most_g = 2.0 * g.fold(0.0, f64::max);
    for (own, h) in samples.iter().zip(harmonic.moduli(samples)) {
        let nodes = harmonic.on(own, h);
        let integrals = Integrals::on_boundary(proof.setup, proof.fit, &own.nodes);
        let green: f64 = own.nodes.iter().zip(&nodes).map(|(v, h)| h.term(v)).sum();
        sum.energy += integrals.energy() + green;
        sum.given += integrals.given;
        sum.add_balance(proof, own, integrals);
        sum.add_rounding(proof, own, &nodes);
        sum.error += own.own.cell.gauss_error(modulus(proof, own, h));
        largest = largest.max(h.value + h.slope);
    }
    sum.add_source(proof.setup, &proof.fit.walk);
    if !sum.error.is_finite() {
        return Err("psi on jumps of f");
    }
    for own in left {
        sum.unbalanced += own.variation;
        sum.error += own.integrals + largest * own.around;
    }
    // Terms have few operations each, and are added cell by cell; weights of Gauss rules are off by some units.
    sum.error += 0.5 * (sum.cells + POINTS + 64) as f64 * f64::EPSILON * sum.terms;
    // If f on the boundary or along a jump were not that of psi, this would not be zero.
    if sum.balance.abs() > sum.unbalanced { Err("f") } else { Ok(sum) }
}

/// Energy of a fit by points of the boundary, with no bound of its error, and the integral of dv/dn plus that of f.
pub(crate) fn unproved(setup: &Setup, fit: &Fit, nodes: &[PlaneNode]) -> [f64; 2] {
    let mut sum = BoundedEnergy::default();
    sum.add_source(setup, &fit.walk);
    let integrals = Integrals::on_boundary(setup, fit, nodes);
    [sum.energy + integrals.energy(), sum.balance + integrals.force + integrals.source]
}

/// Boundary closer to a split than all cells, on one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leftover {
    pub interval: usize,
    /// Bound of the variation of v there, and of the integral of the modulus of its flux.
    pub variation: f64,
    /// Bound of the integrals of the energy there.
    pub integrals: f64,
    /// Bound of the sum of the integrals of the moduli of g and dg/dn.
    pub around: f64,
}

impl Leftover {
    /// Of the cell that is nearest to the split.
    pub(super) fn of(proof: &Proof, own: &Sampled) -> Self {
        let (least, moduli) = (own.own.cell.span[0], &own.moduli);
        let split = proof.fit.walk.intervals[own.own.interval].splits[own.own.side];
        // Twice for the growth of logarithms.
        let terms =
            moduli.slope.iter().map(|[power, m]| 2.0 * m * libm::pow(least, *power) / power);
        // Beyond a jump that is joined with the split, psi is another function, up to where both meet.
        let joined = proof.fit.walk.joined.iter().filter(|own| own.split == split);
        let joined = joined.map(|own| 4.0 * own.crossing.change.abs() * own.offset * own.offset);
        let variation = terms.sum::<f64>() + joined.sum::<f64>();
        let (node, size) = (&own.nodes[0], EnergyFactors::of(proof, own));
        let known = node.value.abs() + node.at.abs() + node.psi.abs();
        let value = known + variation + size.rate * least;
        let flux = variation + size.rate * least;
        let integrals = 4.0 * value * flux + size.constants * least;
        Self { interval: own.own.interval, variation, integrals, around: value * least + flux }
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
        let f = of_f(&proof.setup.jumps.psi, interval.f, disc);
        let q = if let State::Flux(q) = interval.state { q.abs() } else { 0.0 };
        let Moduli { value, slope } = own.moduli.psi;
        let constants = match &proof.setup.jumps.psi {
            Psi::Smooth(own) => {
                let far = disc.centre.norm() + disc.radius;
                let both = [&own.f, &own.psi].map(|own| own.moduli(Complex::default(), far)[0]);
                far * both[0] * both[1]
            }
            Psi::Jumps(_) => 2.0 * f * far * (value + far * slope + f * far * far),
        };
        Self { constants, rate: slope + q }
    }
}

/// Bound of the integrand of the energy on the ellipse of a cell, in its variable: each of its terms is v, psi or the
/// value of the law, which is in the bound of v, times a slope of v or psi, or f times psi and powers of the distance
/// from the middle; with that of Green's identity for h.
fn modulus(proof: &Proof, own: &Sampled, h: Moduli) -> f64 {
    let (cell, moduli) = (&own.own.cell, &own.moduli);
    let r = if cell.is_log { cell.distances[1] } else { 1.0 };
    let [value, slope] = [&moduli.value, &moduli.slope]
        .map(|terms| terms.iter().map(|[g, m]| m * libm::pow(r, *g)).sum::<f64>());
    let size = EnergyFactors::of(proof, own);
    // The normal of an arc, continued, is longer than 1.
    let green = h.value * slope + 1.8 * h.slope * value * r;
    4.0 * (value + moduli.psi.value) * (slope + size.rate * r) + size.constants * r + green
}

/// Bounds of the integrand of the energy that belongs to a change of f by 1 at a point of the boundary, and of its
/// change over a distance along a side there.
fn per_change(setup: &Setup, z: Complex, f: f64, distance: f64) -> [f64; 2] {
    let psi = &setup.jumps.psi;
    let (far, size) = ((z - setup.centre).norm(), setup.diameter);
    let (value, slope) = (psi.value(z).abs(), psi.gradients(&[z])[0].norm());
    // The second derivatives of psi are integrals of 1 / |w - z| along the jumps, J / 2 pi times.
    let bend = jumps(psi, z) * (1.0 + libm::log(size / distance.max(f64::MIN_POSITIVE)).max(0.0));
    let sides = setup.domain.sides().map(|side| side.curvature().abs());
    let turns = 1.0 + size * sides.fold(0.0, f64::max);
    let integrand = 0.5 * far * (0.5 * value + 0.25 * far * slope + 0.125 * f * far * far);
    let rate = value + 2.0 * far * slope + far * far * (2.0 * bend + f);
    [integrand, turns * rate * distance]
}

/// Sum of the moduli of all jumps of f and of its background, but for those of small shapes, whose psi has a bound of
/// its second derivatives in place of them.
fn jumps(psi: &Psi, z: Complex) -> f64 {
    let mut sum = 0.0;
    for part in psi.parts() {
        sum += match part.far_from(z) {
            Some(far) => far.sizes(z - part.middle).bend,
            None => {
                let sizes = part.potential.jumps.iter().map(|jump| jump.size.abs());
                sizes.sum::<f64>() + part.potential.background.abs()
            }
        };
    }
    sum
}

impl BoundedEnergy {
    /// Half of the integral of |grad v|^2.
    pub(super) fn size(&self) -> f64 {
        (self.given - self.energy).abs()
    }

    /// Error of that, from bounds of the integral of the flux that is missed and of |v - at|: in the integral of `at`
    /// times l less the energy, q stands for l where dv/dn should be q.
    pub(super) fn size_error(&self, missed: f64, largest: f64) -> f64 {
        self.error + largest * (missed + self.unbalanced)
    }

    /// Adds the integrals of dv/dn and of f on a cell, with a bound of their errors.
    fn add_balance(&mut self, proof: &Proof, own: &Sampled, integrals: Integrals) {
        let cell = &own.own.cell;
        self.balance += integrals.force + integrals.source;
        let radius = cell.disc.centre.norm() + cell.disc.radius;
        let around = Disc { centre: Complex::default(), radius, inner: 0.0 };
        let f = of_f(&proof.setup.jumps.psi, proof.fit.walk.intervals[own.own.interval].f, around);
        let units = f64::EPSILON * (self.cells + POINTS + 16) as f64;
        let scale = if cell.is_log { cell.distances[1] } else { 1.0 };
        let weights = if cell.is_log { f64::EPSILON * (1.0 + cell.length()) } else { 0.0 };
        let far = (cell.disc.centre - proof.setup.centre).norm() + cell.disc.centre.norm();
        let of_source = f * (far + 2.0 * cell.disc.radius);
        let off = proof.setup.jumps.changes.field;
        for (node, [_, slope]) in own.nodes.iter().zip(&own.rounding) {
            let slope = slope - off;
            let here = match &proof.setup.jumps.psi {
                Psi::Smooth(own) => {
                    let away = node.spot.z.norm();
                    self.unbalanced += node.spot.weight * away * own.radial_errors[0];
                    away * own.f.size(away)
                }
                Psi::Jumps(_) => of_source,
            };
            let terms = node.flux.abs() + here;
            self.unbalanced += node.spot.weight * (slope + (units + weights) * terms);
        }
        let slopes = own.moduli.slope.iter();
        let modulus: f64 = slopes.map(|[power, m]| m * libm::pow(scale, *power)).sum();
        self.unbalanced += cell.gauss_error(modulus + 1.8 * of_source * scale);
    }

    /// Adds the integrals along all jumps of f, and where these end beside the splits of a walk.
    fn add_source(&mut self, setup: &Setup, walk: &Walk) {
        for group in &setup.jumps.groups {
            group.edges.iter().for_each(|edge| self.add_edge(setup, group, edge));
            self.add_moved(setup, group);
        }
        walk.joined_pieces().into_iter().for_each(|piece| self.add_joined(setup, walk, piece));
        walk.joined.iter().for_each(|own| self.add_gap(setup, walk, own));
    }

    /// Adds a piece between a crossing and the split with which it is joined.
    fn add_joined(&mut self, setup: &Setup, walk: &Walk, piece: JoinedPiece) {
        let split = &walk.splits[piece.split];
        let mut sums = Integrals::default();
        sums.add_joined(setup, walk, piece);
        self.energy += sums.energy();
        self.balance += sums.source;
        let (length, f) = (piece.length(), piece.f.abs() + piece.counted.abs());
        let change = (piece.f - piece.counted).abs();
        let [integrand, moved] = per_change(setup, split.z, f, 2.0 * length);
        let off = 8.0 * f64::EPSILON * setup.perimeter;
        self.error += change * ((integrand + moved) * off + length * moved);
        self.unbalanced += change * setup.diameter * (off + length * length);
    }

    /// Adds what is between the end of a jump and the crossing, by which neither f on its left nor on its right has a
    /// closed boundary.
    fn add_gap(&mut self, setup: &Setup, walk: &Walk, own: &JoinedCrossing) {
        let PlaneCrossing { change, gap, .. } = own.crossing;
        let split = &walk.splits[own.split];
        let mut intervals = walk.intervals.iter();
        let beside = intervals.find(|interval| interval.splits[0] == own.split);
        let f = beside.map_or(0.0, |interval| 2.0 * (interval.f.abs() + change.abs()));
        let [integrand, moved] = per_change(setup, split.z, f, gap + own.offset.abs());
        self.error += change.abs() * gap * (integrand + moved);
        self.unbalanced += change.abs() * gap * setup.diameter;
    }

    /// Adds the error of the integrals of a cell by rounding of v, psi and their slopes.
    ///
    /// The integrand of the energy is `1/2 (v (s l + psi_n - 2 q) - psi l - f psi) + at m` with s = -1, m = l and q = 0
    /// where v should be `at`, and s = 1 and m = q elsewhere, in which `int f psi` is an integral of
    /// `f (1/2 psi (x.n) - p psi_n - 1/4 f p (x.n))`, p = |x|^2 / 4; that of Green's identity is
    /// `1/2 (h_n (v - psi) - h (l - psi_n))`.
    fn add_rounding(&mut self, proof: &Proof, own: &Sampled, harmonic: &[HarmonicNode]) {
        let (cell, interval) = (&own.own.cell, &proof.fit.walk.intervals[own.own.interval]);
        let off_value = proof.setup.domain.side(interval).off;
        let f = of_f(&proof.setup.jumps.psi, interval.f, cell.disc);
        // Weights in log r.
        let weights = if cell.is_log { f64::EPSILON * (1.0 + cell.length()) } else { 0.0 };
        // That of the field of the changes of f is none of v.
        let off = proof.setup.jumps.changes.field;
        let both =
            own.nodes.iter().zip(own.rounding.iter().map(|&[value, slope]| [value, slope - off]));
        for (((node, [value, slope]), psi), h) in both.zip(&own.psi).zip(harmonic) {
            let (v, l, [g, rate]) = (node.value, node.flux, HarmonicNode::of_g(node));
            let (z, at) = (node.spot.z, node.at);
            let (sign, q, held) = match interval.state {
                State::Held => (-1.0, 0.0, at),
                State::Flux(q) => (1.0, q, 0.0),
            };
            let square = 0.25 * (z - proof.setup.centre).norm2();
            let far = z.norm().max(2.0 * square.sqrt());
            let by_value = 0.5 * (sign * l + node.psi_flux - 2.0 * q + h.flux).abs() + slope;
            let by_slope = 0.5 * (sign * v + 2.0 * held - node.psi - h.value).abs();
            // Derivatives, terms and rounding of the part of the energy that is an integral of f and psi alone.
            let [of_psi, of_slope, of_f, rounded] = match &proof.setup.jumps.psi {
                Psi::Jumps(_) => {
                    let rest = square * (node.psi_flux.abs() + 0.25 * f * far);
                    [0.5 * f * far, f * square, f * (0.5 * node.psi.abs() * far + rest), 0.0]
                }
                Psi::Smooth(own) => {
                    let product = z.norm() * own.product(z.norm());
                    let rounding = own.units()[1] * f64::EPSILON * product;
                    [0.0, 0.0, product, rounding + z.norm() * own.radial_errors[1]]
                }
            };
            let by_psi = 0.5 * ((l + h.flux).abs() + of_psi);
            let by_psi_slope = 0.5 * ((v + h.value).abs() + of_slope);
            let terms = v.abs() * (1.5 * l.abs() + 0.5 * node.psi_flux.abs() + q.abs())
                + at.abs() * (l.abs() + q.abs())
                + 0.5 * (node.psi.abs() * l.abs() + of_f)
                + 0.5 * (h.flux * g).abs()
                + 0.5 * (h.value * rate).abs();
            let error = value * by_value
                + slope * by_slope
                + psi.value * by_psi
                + psi.slope * by_psi_slope
                + 0.5 * rounded
                + off_value * (l.abs() + q.abs())
                + 0.5 * (h.errors[0] * rate.abs() + h.errors[1] * g.abs())
                + weights * terms;
            self.error += node.spot.weight * error;
            self.terms += node.spot.weight * terms;
        }
    }
}

#[cfg(test)]
mod tests;
