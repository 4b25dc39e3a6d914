//! By how much v misses the conditions on the boundary, cell by cell, and what follows from it for the functions whose
//! extensions the bounds of the energy need.

use super::Proof;
use super::exact_energy::Leftover;
use super::samples::{Deficit, Quantity, Sampled, Test};
use crate::problem::law::Law;
use crate::spectral::fit::field::Sizes;
use crate::spectral::geometry::boundary::{State, sign};
use std::f64::consts::TAU;

/// Test of v being on the side of the value of a law that belongs to a flux.
fn signed(law: Law, q: f64) -> Test {
    Test { sign: sign(law, q), ..Test::of(Quantity::Above) }
}

/// Violation of the law by the flux on a cell, where v should have its value.
fn violation(law: Law, own: &Sampled) -> Deficit {
    let mut sum = Deficit { most: 0.0, integral: 0.0, scaled: 0.0, room: f64::INFINITY };
    for (sign, constant) in [(1.0, law.lo()), (-1.0, law.hi())] {
        if constant.is_finite() {
            let one = own.deficit(Test { quantity: Quantity::Flux, sign, constant });
            sum.most += one.most;
            sum.integral += one.integral;
            sum.scaled += one.scaled;
            sum.room = sum.room.min(one.room);
        }
    }
    sum
}

/// Condition of a cell, and the law that says so.
fn condition(proof: &Proof, own: &Sampled) -> (State, Law) {
    let interval = &proof.fit.walk.intervals[own.own.interval];
    (interval.state, interval.law)
}

/// True if signs on a cell are not certain, and matter.
pub(super) fn uncertain(proof: &Proof, own: &Sampled, sizes: Sizes) -> bool {
    /// Size of v, over that of the solution, that does not matter.
    const SMALL: f64 = 1e-11;
    /// Slope of v, times r in log r, that does not matter.
    const STEEP: f64 = 1e-7;
    let small = SMALL * sizes.value;
    match condition(proof, own) {
        (State::Held, law) if law.may_move() => {
            violation(law, own).integral > small.max(8.0 * own.noise(Quantity::Flux))
        }
        (State::Flux(q), law) if law.may_move() => {
            let small = small.max(8.0 * own.noise(Quantity::Value));
            let deficit = own.deficit(signed(law, q));
            deficit.most > small
                || deficit.room < 10.0 * small
                    && own.most(Test::of(Quantity::Slope)) > STEEP * sizes.value
        }
        _ => false,
    }
}

/// Coefficients of logarithms that balance the flux of loops on which v should have a value nowhere: of a hole by its
/// own, of the outer loop by that of the first hole on which v should have one somewhere.
pub(super) fn hole_logs(proof: &Proof, samples: &[Sampled]) -> Vec<f64> {
    let excess: Vec<Option<f64>> =
        (0..proof.setup.domain.rings.len()).map(|ring| excess(samples, ring)).collect();
    let mut logs: Vec<f64> = excess[1..].iter().map(|own| own.unwrap_or(0.0) / TAU).collect();
    let held = excess[1..].iter().position(Option::is_none);
    if let (Some(outer), Some(hole)) = (excess[0], held) {
        logs[hole] = -outer / TAU - logs.iter().sum::<f64>();
    }
    logs
}

/// Integral of the flux less what it should be on a loop; none if v should have a value somewhere on it.
fn excess(samples: &[Sampled], ring: usize) -> Option<f64> {
    let mut excess = 0.0;
    let own = samples.iter().filter(|own| own.nodes[0].ring == ring);
    for node in own.flat_map(|own| &own.nodes) {
        let State::Flux(q) = node.state else { return None };
        excess += node.spot.weight * (node.flux - q);
    }
    Some(excess)
}

/// True if the values of the laws on both sides of a split differ.
fn has_step(proof: &Proof, split: usize) -> bool {
    let (walk, domain) = (&proof.fit.walk, &proof.setup.domain);
    let beside = walk.intervals.iter().filter(|own| own.splits.contains(&split));
    let beside = beside.map(|own| domain.side(own)).filter(|side| !side.law.is_free());
    let at = beside.map(|side| (domain.value(side, walk.splits[split].z).0, side.off));
    let [least, most] = at.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], (at, off)| {
        [least.min(at + off), most.max(at - off)]
    });
    least < most
}

/// Distance of v from what it should be.
pub(super) struct Distances {
    /// Bound of the distance of v from the value of the law where it should have that, and of that part of v that is on
    /// the wrong side of it.
    pub delta: f64,
    /// Bounds of the slope of W, cell by cell; in log r times r.
    pub slopes: Vec<f64>,
}

impl Distances {
    /// Range of W, which is between -delta and delta.
    pub(super) fn range(&self) -> f64 {
        2.0 * self.delta
    }

    pub(super) fn new(proof: &Proof, samples: &[Sampled], left: &[Leftover]) -> Self {
        let near = left.iter().fold(0.0f64, |most, own| most.max(own.variation));
        let (mut delta, mut rooms) = (0.0f64, Vec::with_capacity(samples.len()));
        for own in samples {
            let (most, room) = match condition(proof, own) {
                (State::Held, _) => (own.most(Test::of(Quantity::Above)), 0.0),
                (State::Flux(q), law) if law.may_move() => {
                    let deficit = own.deficit(signed(law, q));
                    (deficit.most, deficit.room)
                }
                (State::Flux(_), _) => (0.0, 0.0),
            };
            delta = delta.max(most);
            rooms.push(room);
        }
        delta += near;
        let mut slopes = Vec::with_capacity(samples.len());
        for (own, room) in samples.iter().zip(rooms) {
            let interval = &proof.fit.walk.intervals[own.own.interval];
            let r = if own.own.cell.is_log { own.own.cell.span[1] } else { 1.0 };
            slopes.push(match condition(proof, own) {
                (State::Flux(_), law) if law.is_free() => 2.0 * delta / interval.length * r,
                (State::Flux(_), _) if has_step(proof, interval.splits[own.own.side]) => match room
                {
                    room if room >= delta => 4.0 * delta / interval.length * r,
                    _ => f64::INFINITY,
                },
                (State::Flux(_), _) if room >= delta => 0.0,
                _ => own.most(Test::of(Quantity::Slope)),
            });
        }
        Self { delta, slopes }
    }
}

/// Distance of the flux from what it should be, with what balances it.
pub(super) struct FluxBalance {
    /// Range of H.
    pub range: f64,
    /// Bounds of eta, cell by cell; in log r times r.
    pub slopes: Vec<f64>,
    /// Bound of the integral of |eta| where v should have the value of the law.
    pub moved: f64,
    /// Bound of the integral of |l - q| where the flux should be q.
    pub missed: f64,
}

/// Room of the flux, over its size, that is enough for what is added.
const ROOM: f64 = 1e-4;

/// Bounds of eta on a cell.
#[derive(Clone, Copy, Debug, Default)]
struct Eta {
    /// Integral, as far as it is known.
    known: f64,
    /// Bound of the rest of the integral.
    unknown: f64,
    /// Bound of the integral of its modulus.
    most: f64,
    /// Bound of its modulus; in log r times r.
    slope: f64,
    /// Length of a part on which a constant may be added.
    open: f64,
}

impl Eta {
    /// Eta where the flux should be q: q less the flux.
    fn where_flux_is(q: f64, own: &Sampled) -> Self {
        let (cell, mut eta) = (&own.own.cell, Self::default());
        for (node, [_, error]) in own.nodes.iter().zip(&own.rounding) {
            eta.known += node.spot.weight * (q - node.flux);
            eta.unknown += node.spot.weight * error;
        }
        eta.slope = own.most(Test { constant: q, ..Test::of(Quantity::Flux) });
        eta.most = eta.slope * cell.length();
        let scale = if cell.is_log { cell.distances[1] } else { 1.0 };
        let terms = own.moduli.slope.iter();
        let modulus: f64 = terms.map(|[g, m]| m * libm::pow(scale, *g)).sum();
        eta.unknown += cell.gauss_error(modulus + q.abs() * scale);
        eta
    }

    /// Eta where v should have the value of the law; a constant may be added on a loop that is not `fixed`, if the room
    /// of the flux is more than `least`.
    fn under_law(law: &Deficit, own: &Sampled, least: f64, fixed: bool) -> Self {
        let cell = &own.own.cell;
        let (most, unknown) = (law.integral, law.integral);
        let slope = if cell.is_log { law.scaled } else { law.most };
        let is_open = law.room > least && !fixed && !cell.is_log;
        Self { most, unknown, slope, open: if is_open { cell.length() } else { 0.0 }, known: 0.0 }
    }

    /// Eta where v is fixed, whatever the flux.
    fn where_fixed(own: &Sampled) -> Self {
        let cell = &own.own.cell;
        Self { open: if cell.is_log { 0.0 } else { cell.length() }, ..Self::default() }
    }
}

/// Sums of eta on a loop.
struct LoopEta {
    /// Positions of its cells.
    cells: Vec<usize>,
    /// Integral, as far as it is known.
    known: f64,
    /// Bound of the rest of the integral.
    unknown: f64,
    /// Bound of the variation of what is closer to splits than the cells.
    near: f64,
    /// Length of the parts on which a constant may be added.
    open: f64,
    /// True if v is fixed on a part of the loop.
    is_fixed: bool,
    /// True if [`hole_logs`] balances the loop.
    is_balanced: bool,
}

impl LoopEta {
    /// Bound of the constant that, added where it may, makes the integral of eta zero; `flux` is the size of the flux.
    fn added(&self, flux: f64) -> Result<f64, &'static str> {
        if self.is_balanced {
            return Ok(0.0);
        }
        let added = (self.known.abs() + self.unknown) / self.open;
        match added <= ROOM * flux || self.is_fixed && added.is_finite() {
            true => Ok(added),
            false => Err("room of the flux in the law"),
        }
    }

    /// The constant itself, but for what is unknown.
    fn share(&self) -> f64 {
        if self.is_balanced { 0.0 } else { -self.known / self.open }
    }
}

impl FluxBalance {
    /// With the size of the flux, by which room is measured.
    ///
    /// # Errors
    /// Part that is not proved.
    pub(super) fn new(
        proof: &Proof,
        samples: &[Sampled],
        left: &[Leftover],
        flux: f64,
    ) -> Result<Self, &'static str> {
        let fixed = fixed_loops(proof);
        let mut balance = Self { range: 0.0, slopes: Vec::new(), moved: 0.0, missed: 0.0 };
        let mut etas = Vec::with_capacity(samples.len());
        for own in samples {
            etas.push(match condition(proof, own) {
                (State::Flux(q), _) => {
                    let eta = Eta::where_flux_is(q, own);
                    balance.missed += eta.most;
                    eta
                }
                (State::Held, law) if law.is_fixed() => Eta::where_fixed(own),
                (State::Held, law) => {
                    let law = violation(law, own);
                    balance.moved += law.integral;
                    Eta::under_law(&law, own, ROOM * flux, fixed[own.nodes[0].ring])
                }
            });
        }
        let mut slopes: Vec<f64> = etas.iter().map(|eta| eta.slope).collect();
        for own in loops(proof, samples, left, (&etas, fixed)) {
            let added = own.added(flux)?;
            balance.moved += added * own.open + own.near;
            balance.missed += own.near;
            balance.range =
                balance.range.max(range(proof, samples, &own, &etas) + 2.0 * own.unknown);
            for p in own.cells {
                if etas[p].open > 0.0 {
                    slopes[p] += added;
                }
            }
        }
        balance.slopes = slopes;
        Ok(balance)
    }
}

/// For each loop, true if v is fixed on a part of it.
fn fixed_loops(proof: &Proof) -> Vec<bool> {
    let mut fixed = vec![false; proof.setup.domain.rings.len()];
    for own in &proof.fit.walk.intervals {
        fixed[own.ring] |= own.state == State::Held && own.law.is_fixed();
    }
    fixed
}

/// Sums of eta on each loop, with what is true for each: that v is fixed on a part of it.
fn loops(
    proof: &Proof,
    samples: &[Sampled],
    left: &[Leftover],
    (etas, fixed): (&[Eta], Vec<bool>),
) -> Vec<LoopEta> {
    let balanced = balanced(samples, fixed.len());
    let mut loops = Vec::with_capacity(fixed.len());
    for (ring, (is_fixed, is_balanced)) in fixed.into_iter().zip(balanced).enumerate() {
        let cells: Vec<usize> =
            (0..samples.len()).filter(|&p| samples[p].nodes[0].ring == ring).collect();
        let near = left.iter().filter(|own| proof.fit.walk.intervals[own.interval].ring == ring);
        let near: f64 = near.map(|own| own.variation).sum();
        let (mut known, mut open, mut unknown) = (0.0, 0.0, near);
        for &p in &cells {
            known += etas[p].known;
            open += etas[p].open;
            unknown += etas[p].unknown;
        }
        loops.push(LoopEta { cells, known, unknown, near, open, is_fixed, is_balanced });
    }
    loops
}

/// Loops that [`hole_logs`] balances.
fn balanced(samples: &[Sampled], rings: usize) -> Vec<bool> {
    let mut open = vec![true; rings];
    for node in samples.iter().flat_map(|own| &own.nodes) {
        open[node.ring] &= node.state != State::Held;
    }
    open[0] &= !open[1..].iter().all(|&own| own);
    open
}

/// Range of H on a loop, but for what is unknown of eta.
fn range(proof: &Proof, samples: &[Sampled], own: &LoopEta, etas: &[Eta]) -> f64 {
    let (mut order, share) = (own.cells.clone(), own.share());
    order.sort_by(|&p, &q| {
        let [one, other] = [p, q].map(|p| samples[p].own);
        let [from, start] = [one, other].map(|own| own.along(&proof.fit.walk)[0]);
        one.interval.cmp(&other.interval).then(from.total_cmp(&start))
    });
    let (mut sum, mut least, mut most, mut within) = (0.0f64, 0.0f64, 0.0f64, 0.0f64);
    for p in order {
        let eta = etas[p];
        sum += eta.known + share * eta.open;
        (least, most) = (least.min(sum), most.max(sum));
        within = within.max(eta.most + share.abs() * eta.open);
    }
    most - least + 2.0 * within
}

#[cfg(test)]
mod tests;
