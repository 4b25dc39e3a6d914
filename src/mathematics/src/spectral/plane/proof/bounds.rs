//! Two bounds of the energy. Since `-Lap v = f` holds exactly, only conditions on the boundary are violated, by what is
//! seen there.
//!
//! # Method
//! With l = dv/dn, the energy that is printed is
//! ```text
//! J = 1/2 oint v l - 1/2 int f v - int q v - int v l,     where dv/dn should be q, and where v should be zero.
//! ```
//! *Upper.* Let delta be at least |v| where v should be zero, and -v where it should be positive. On the boundary let w
//! be v moved towards zero by delta, or to it; on free sides v less a linear function between the values of v - w at
//! the splits. Then w is zero where it must be and has the sign that belongs to q, and with an extension W of w - v
//! ```text
//! J(v + W) = J(v) + oint l W + 1/2 int |grad W|^2 + ... = J + int (l - q) W + 1/2 int |grad W|^2,
//! ```
//! which is at most `J + delta int |l - q| + 1/2 int |grad W|^2`, the integral over where dv/dn should be q.
//!
//! *Lower.* Let eta take the flux into the law: `eta = q - l` where dv/dn should be q, the violation where v should be
//! zero, and there also a constant that makes `oint eta = 0` on each loop, on a part where there is room in the law.
//! With an extension E of `H = int eta ds`, `p = grad v + rot E` has `-div p = f` and `p.n = l + eta`, so that
//! ```text
//! J(u) >= -1/2 int |p|^2 = -1/2 int |grad v|^2 - oint v eta - 1/2 int |grad E|^2,
//!       = J - int v eta - 1/2 int |grad E|^2,     int |grad v|^2 = oint v l + int f v,
//! ```
//! the integral over where v should be zero, hence |v| <= delta. A hole on which v should be zero nowhere is balanced
//! by a multiple of `log |z - middle|` that is added to v.
//!
//! So both bounds are J but for terms that are quadratic in what the conditions miss; [`extension`](super::extension)
//! bounds the two Dirichlet integrals, [`samples`](super::samples) all quantities between points, and
//! [`exact_energy`](super::exact_energy) the error of J. Where one of them does not succeed, the bounds are of samples:
//! J(v) itself, or J(v + delta) under the paper's law, and a trace constant of twice the diameter.

use super::Proof;
use super::cells::ProofCell;
use super::exact_energy::{Leftover, bounded_energy};
use super::extension::Room;
use super::residual::{Distances, FluxBalance, hole_logs, uncertain};
use super::samples::Sampled;
use crate::problem::law::Law;
use crate::spectral::plane::PlaneBracket;
use crate::spectral::plane::boundary::State;
use crate::spectral::plane::field::PlaneNode;
use crate::spectral::plane::psi::Psi;
use crate::spectral::plane::search::PlaneFound;
use crate::spectral::plane::setup::Setup;

/// Bounds of a solution.
pub(in crate::spectral::plane) fn bracket(setup: &Setup, found: &PlaneFound) -> PlaneBracket {
    /// Distance of proved bounds, over the energy, from which on samples say more.
    const WIDE: f64 = 1e-5;
    let reason = match proved(setup, found) {
        Ok([lower, upper]) if upper - lower <= WIDE * found.integrals.energy.abs() => {
            let mut reserve = Vec::new();
            if let Psi::Polynomial(_) = setup.jumps.psi {
                // That a formula is a polynomial is seen at points.
                reserve.push("f: sampled".into());
            }
            return PlaneBracket { lower, upper, reserve };
        }
        Ok(_) => "v and its flux on the boundary",
        Err(reason) => reason,
    };
    let [lower, upper] = sampled(setup, found);
    PlaneBracket { lower, upper, reserve: vec![format!("{reason}: sampled")] }
}

/// Bounds that are proved.
///
/// # Errors
/// Part that is not proved.
pub(super) fn proved(setup: &Setup, found: &PlaneFound) -> Result<[f64; 2], &'static str> {
    /// Halvings of cells where signs are not certain.
    const ROUNDS: usize = 8;
    let fit = &found.fit;
    let mut proof = Proof::new(setup, fit)?;
    let mut samples = proof.samples(&proof.cells()?);
    proof.logs = hole_logs(&proof, &samples);
    samples.iter_mut().for_each(|own| proof.add_logs(own));
    for _ in 0..ROUNDS {
        let (unsure, sure): (Vec<Sampled>, Vec<Sampled>) =
            samples.into_iter().partition(|own| uncertain(&proof, own, found.sizes));
        let halves: Vec<ProofCell> =
            unsure.iter().filter_map(|own| proof.halves(own.own)).flatten().collect();
        samples = sure;
        if halves.len() < 2 * unsure.len() || halves.is_empty() {
            samples.extend(unsure);
            break;
        }
        samples.extend(proof.samples(&halves));
    }
    let left = leftovers(&proof, &samples);
    let exact = bounded_energy(&proof, &samples, &left)?;
    let cells: Vec<ProofCell> = samples.iter().map(|own| own.own).collect();
    let room = Room::new(&fit.walk, &proof.chords, &cells);
    let distances = Distances::new(&proof, &samples, &left);
    let balance = FluxBalance::new(&proof, &samples, &left, found.sizes.flux)?;
    let near = left.iter().fold(0.0f64, |most, own| most.max(own.variation));
    let of_w = room.integral(&cells, [distances.range(), near], &distances.slopes);
    let of_e = room.integral(&cells, [balance.range, near], &balance.slopes);
    let [lower, upper] = ends([exact.energy, exact.error], &distances, &balance, [of_w, of_e]);
    if lower.is_finite() && upper.is_finite() {
        Ok([lower, upper])
    } else {
        Err("v next to corners")
    }
}

/// Both ends, from the energy with its error and bounds of the Dirichlet integrals of W and E.
fn ends(
    [energy, error]: [f64; 2],
    distances: &Distances,
    balance: &FluxBalance,
    [of_w, of_e]: [f64; 2],
) -> [f64; 2] {
    let lower = energy - error - distances.delta * balance.moved - 0.5 * of_e;
    let upper = energy + error + distances.delta * balance.missed + 0.5 * of_w;
    [lower, upper]
}

/// Boundary closer to splits than all cells.
fn leftovers(proof: &Proof, samples: &[Sampled]) -> Vec<Leftover> {
    let mut left = Vec::new();
    for (interval, near) in proof.near.iter().enumerate() {
        for side in [0, 1] {
            let Some(near) = near[side] else { continue };
            let own = samples.iter().filter(|own| {
                (own.own.interval, own.own.side) == (interval, side)
                    && own.own.cell.span[0] <= 1.01 * near.least
            });
            left.extend(own.map(|own| Leftover::of(proof, own)));
        }
    }
    left
}

/// Share by which v may be farther below zero between the points than at them.
const BETWEEN: f64 = 2.0;

/// True on fixed sides.
fn is_fixed(n: &PlaneNode) -> bool {
    !n.lawful && n.state == State::Held
}

/// The flux without its violation of the law, or of zero on free sides.
fn allowed(law: Law, n: &PlaneNode) -> f64 {
    match n.state {
        _ if n.lawful => law.project(n.flux),
        State::Held => n.flux,
        State::Flux(_) => 0.0,
    }
}

/// Bounds that hold if v and its flux are nowhere farther off than at points of the boundary.
fn sampled(setup: &Setup, found: &PlaneFound) -> [f64; 2] {
    let (law, integrals, nodes) = (setup.law, &found.integrals, &found.nodes);
    let weighted = |part: &dyn Fn(&PlaneNode) -> f64| {
        nodes.iter().map(|n| n.spot.weight * part(n)).sum::<f64>()
    };
    let excess = weighted(&|n| allowed(law, n) - n.flux);
    let fixed = weighted(&|n| f64::from(is_fixed(n)));
    // Room of the flux on the side to which it must go, no more than its own size where that is infinite.
    let room = |n: &PlaneNode| match () {
        () if fixed > 0.0 => f64::from(is_fixed(n)),
        () if !n.lawful => 0.0,
        () if excess > 0.0 && law.lo().is_finite() => allowed(law, n) - law.lo(),
        () if excess < 0.0 && law.hi().is_finite() => law.hi() - allowed(law, n),
        () => 1.0,
    };
    let rooms = weighted(&room);
    let share = if rooms > 0.0 { excess / rooms } else { 0.0 };
    let eta = |n: &PlaneNode| allowed(law, n) - n.flux - share * room(n);
    let moved = weighted(&|n| n.value * eta(n));
    let square = weighted(&|n| eta(n) * eta(n));
    // What the quadrature of the flux misses, and rounding.
    let size = nodes.iter().fold(0.0f64, |most, n| most.max(n.value.abs()));
    let rounding = 2e-15 * (integrals.work.abs() + integrals.flux_work.abs());
    let missed = (integrals.force + integrals.source).abs() * size + rounding;
    let trace = 2.0 * setup.diameter;
    let found_room = if rooms > 0.0 { 0.0 } else { f64::INFINITY };
    let lower = -found_room
        - 0.5 * (integrals.flux_work + integrals.work)
        - moved
        - 0.5 * trace * square
        - missed;
    let potential = weighted(&|n| if n.lawful { law.potential(n.value) } else { 0.0 });
    let mut upper = 0.5 * (integrals.flux_work - integrals.work) + potential + missed;
    if !law.is_bounded() {
        let sign = if law.hi().is_infinite() { 1.0 } else { -1.0 };
        let lawful = nodes.iter().filter(|n| n.lawful);
        let below = lawful.fold(0.0f64, |most, n| most.max(-sign * n.value));
        upper += BETWEEN * below * integrals.force.abs().max(setup.perimeter * found.sizes.flux);
    }
    if fixed > 0.0 {
        // v is moved to zero there by a function of about this energy.
        let off = weighted(&|n| if is_fixed(n) { n.value.abs() * n.flux.abs() } else { 0.0 });
        upper += BETWEEN * off;
    }
    [lower, upper]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_those_of_the_argument() {
        let distances = Distances { delta: 0.5, slopes: Vec::new() };
        let slopes = Vec::new();
        let balance = FluxBalance { range: 0.0, slopes, moved: 2e-2, missed: 2e-3 };
        let [lower, upper] = ends([1.0, 1e-6], &distances, &balance, [2e-4, 2e-5]);
        assert!((1.0 - lower - 1.0011e-2).abs() < 1e-13, "{lower}");
        assert!((upper - 1.0 - 1.101e-3).abs() < 1e-13, "{upper}");
        // W is v or part of it, with either sign.
        assert_eq!(distances.range(), 1.0);
    }
}
