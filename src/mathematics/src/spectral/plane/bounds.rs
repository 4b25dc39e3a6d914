//! Two bounds of the energy. Since `-Lap v = f` holds exactly, only conditions on the boundary are violated, by what is
//! seen there.
//!
//! *Upper.* Under a bounded law J(v) itself; under the paper's J(v + delta) = J(v) + delta F with delta the largest -v
//! on the boundary and F = oint l.
//!
//! *Lower.* `p = grad v + grad phi` with phi harmonic and `phi_n = eta`, which takes the flux into the law, and the
//! mean of eta to zero by a share of the room that the flux has. Then
//! ```text
//! J >= -1/2 |p|^2 >= -1/2 |grad v|^2 - oint v eta - C/2 oint eta^2,     |grad v|^2 = oint v l + int f v,
//! ```
//! with C the trace constant, `oint (w - mean)^2 <= C |grad w|^2`; eta^2 is so small that twice the diameter is taken,
//! without a proof. What the boundary violates is seen in points of it; so the bounds are called sampled.

use super::PlaneBracket;
use super::boundary::State;
use super::field::PlaneNode;
use super::search::PlaneFound;
use super::setup::Setup;
use crate::problem::law::Law;

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

/// Bounds of a solution.
pub(super) fn bracket(setup: &Setup, found: &PlaneFound) -> PlaneBracket {
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
    let mut reserve = vec!["v and its flux on the boundary: sampled".to_string()];
    if fixed > 0.0 {
        // v is moved to zero there by a function of about this energy.
        let off = weighted(&|n| if is_fixed(n) { n.value.abs() * n.flux.abs() } else { 0.0 });
        upper += BETWEEN * off;
        reserve.push("v on fixed sides: sampled".to_string());
    }
    PlaneBracket { lower, upper, reserve }
}
