//! Two bounds of the energy. Since `-Lap v = f` holds exactly, only conditions on the boundary are violated, by what is
//! seen there. Where dv/dn should be q, the energy has `-q (v - at)`; of a free side, on which v takes any value, `at`
//! is 0.
//!
//! # Method
//! With l = dv/dn, the energy that is printed is
//! ```text
//! J = 1/2 oint v l - 1/2 int f v - int q (v - at) - int (v - at) l,
//! ```
//! the third integral over where dv/dn should be q, the last one over where v should be `at`.
//!
//! *Upper.* Let delta be at least |v - at| where v should be `at`, and at - v where it should be above. On the boundary
//! let w be v moved towards `at` by delta, or to it; on free sides v less a linear function between the values of v - w
//! at the splits. Then w is `at` where it must be and on the side of it that belongs to q, and with an extension W of
//! w - v
//! ```text
//! J(v + W) = J(v) + oint l W + 1/2 int |grad W|^2 + ... = J + int (l - q) W + 1/2 int |grad W|^2,
//! ```
//! which is at most `J + delta int |l - q| + 1/2 int |grad W|^2`, the integral over where dv/dn should be q.
//!
//! Where sides meet with different values v leaves one of them: on the half of that side which is next to the corner W
//! goes linearly to the value that it has there, with v farther than delta from `at` on all of it.
//!
//! *Lower.* Let eta take the flux into the law: `eta = q - l` where dv/dn should be q, the violation where v should be
//! `at`, and there also a constant that makes `oint eta = 0` on each loop, on a part where there is room in the law.
//! With an extension E of `H = int eta ds`, `p = grad v + rot E` has `-div p = f` and `p.n = l + eta`, so that
//! ```text
//! J(u) >= oint at (p.n) - 1/2 int |p|^2
//!       = oint at (l + eta) - 1/2 int |grad v|^2 - oint v eta - 1/2 int |grad E|^2
//!       = J - int (v - at) eta - 1/2 int |grad E|^2,     int |grad v|^2 = oint v l + int f v,
//! ```
//! the last integral over where v should be `at`, hence |v - at| <= delta. A hole on which v should be `at` nowhere is
//! balanced
//! by a multiple of `log |z - middle|` that is added to v.
//!
//! So both bounds are J but for terms that are quadratic in what the conditions miss; [`extension`](super::extension)
//! bounds the two Dirichlet integrals, [`samples`](super::samples) all quantities between points, and
//! [`exact_energy`](super::exact_energy) the error of J. If all `at` are zero, J(0) = 0, and the upper bound is at most
//! zero.
//!
//! *Another f.* Where `-Lap psi` is not f but differs from it by g, as for a formula whose coefficients are rounded or
//! curves that count as one, J above is that of the other function. The setup comes with bounds of the integral of |g|
//! and of a field r with `-div r = g` ([`Changes`]); p becomes `grad v + rot E + r`, whose flux is off by no more than
//! |r|, which counts among the errors of l. So both ends move by `int |g v|`, the upper one by `int |g W|` more, and in
//! the lower one `|grad E|` becomes `|grad E| + |r|`. By the maximum principle |v| is at most its bound on the boundary
//! and that of a potential of |f| more (`SourceSize`). The part of a shape that reaches beyond the boundary, by less
//! than a tolerance, is no change of f, but counts in `int f psi`, by |psi|.
//!
//! [`Changes`]: crate::spectral::source::changes::Changes

use super::cells::ProofCell;
use super::exact_energy::{Leftover, bounded_energy};
use super::extension::Room;
use super::residual::{Distances, FluxBalance, hole_logs, uncertain};
use super::samples::{Quantity, Sampled, Test};
use super::{PlaneBracket, Proof};
use crate::spectral::contact::search::PlaneFound;
use crate::spectral::setup::Setup;
use crate::spectral::source::jumps::PlaneJumps;

/// Bounds of a solution, whatever their distance.
///
/// # Errors
/// Step of the proof that does not apply.
pub(crate) fn bracket(setup: &Setup, found: &PlaneFound) -> Result<PlaneBracket, &'static str> {
    let proved = proved(setup, found)?;
    // J(0) = 0 without values of laws.
    let least = if setup.domain.has_values() { f64::INFINITY } else { 0.0 };
    Ok(PlaneBracket { upper: proved.upper.min(least), ..proved })
}

/// Reason for which there is no answer: neither a bracket nor an energy that rounding leaves as it is.
pub(crate) const ROUNDED: &str = "an energy with fewer errors by rounding";

/// Error of the energy by rounding, over half of the integral of |grad v|^2, above which an energy without a bracket is
/// none.
const ROUGH: f64 = 1e-6;

/// Both ends by the argument above, with what most of their distance comes from.
///
/// # Errors
/// Step of the proof that does not apply.
pub(super) fn proved(setup: &Setup, found: &PlaneFound) -> Result<PlaneBracket, &'static str> {
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
    let balance = FluxBalance::new(&proof, &samples, &left, found.sizes.flux);
    // Without a bracket nothing would say how far the energy is off.
    let is_rough = exact.error > ROUGH * exact.size();
    let balance = balance.map_err(|step| if is_rough { ROUNDED } else { step })?;
    let near = left.iter().fold(0.0f64, |most, own| most.max(own.variation));
    let of_w = room.integral(&cells, [distances.range(), near], &distances.slopes);
    let of_e = room.integral(&cells, [balance.range, near], &balance.slopes);
    let change = SourceChange::new(setup, &samples, distances.delta + near);
    let both = ends([exact.energy, exact.error], &distances, &balance, &change, [of_w, of_e]);
    let moved = distances.delta * (balance.moved + balance.missed);
    let terms = [
        ("rounding in the integrals of the energy", 2.0 * exact.error),
        ("v on the boundary", moved + 0.5 * of_w),
        ("the flux through the boundary", 0.5 * of_e),
        ("f, which is rounded or changed by a tolerance", 2.0 * change.of_v),
    ];
    let (cause, _) =
        terms.into_iter().max_by(|one, other| one.1.total_cmp(&other.1)).unwrap_or_default();
    let [lower, upper] = both;
    if lower.is_finite() && upper.is_finite() {
        let gradient = setup.domain.has_values().then(|| {
            let missed = exact.size_error(balance.missed, largest(&samples));
            least_gradient([exact.size(), missed], upper - lower)
        });
        let (energy, size) = (exact.energy, exact.size());
        Ok(PlaneBracket { energy, lower, upper, size, gradient, cause })
    } else {
        Err("bounds of v next to corners")
    }
}

/// Lower bound of the norm of grad u, from half of the square of that of grad v with its error and the width of the
/// bracket: half of the squares of the norms of grad (u - v - W) and of grad W are no larger than that.
fn least_gradient([size, error]: [f64; 2], width: f64) -> f64 {
    let of_v = (2.0 * (size - error).max(0.0)).sqrt();
    (of_v - 2.0 * (2.0 * width).sqrt()).max(0.0)
}

/// Bound of |v| and of |v - at| on the boundary.
fn largest(samples: &[Sampled]) -> f64 {
    samples
        .iter()
        .fold(0.0, |most, own| most.max(own.most(Test::of(Quantity::Value)) + own.moduli.at.value))
}

/// Effect on the bounds of what `-Lap psi` differs from f.
struct SourceChange {
    /// Bound of the integral of the difference times v.
    of_v: f64,
    /// That of the difference times W.
    of_w: f64,
    /// Bound of the L2 norm of the field whose divergence the difference is.
    field: f64,
}

impl SourceChange {
    /// By bounds of v on the cells of the boundary, and of W.
    fn new(setup: &Setup, samples: &[Sampled], of_w: f64) -> Self {
        let PlaneJumps { changes, inner, .. } = &setup.jumps;
        let on_boundary = samples.iter().map(|own| own.most(Test::of(Quantity::Value)));
        let nodes = samples.iter().flat_map(|own| &own.nodes);
        let psi = nodes.fold(0.0f64, |most, node| most.max(node.psi.abs()));
        let of_v = on_boundary.fold(0.0, f64::max) + of_w + inner + 2.0 * psi;
        Self {
            of_v: changes.mass * of_v,
            of_w: changes.mass * of_w,
            field: changes.square(setup.diameter).sqrt(),
        }
    }
}

/// Both ends, from the energy with its error and bounds of the Dirichlet integrals of W and E.
fn ends(
    [energy, error]: [f64; 2],
    distances: &Distances,
    balance: &FluxBalance,
    change: &SourceChange,
    [of_w, of_e]: [f64; 2],
) -> [f64; 2] {
    let of_e = (of_e.sqrt() + change.field).powi(2);
    let lower = energy - error - distances.delta * balance.moved - 0.5 * of_e;
    let upper = energy + error + distances.delta * balance.missed + 0.5 * of_w;
    [lower - change.of_v, upper + change.of_v + change.of_w]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_that_of_v_less_what_the_bracket_leaves() {
        assert!((least_gradient([2.01, 0.01], 0.005) - 1.8).abs() < 1e-15);
        assert_eq!(least_gradient([1e-3, 2e-3], 0.0), 0.0);
    }

    #[test]
    fn ends_are_those_of_the_argument() {
        let distances = Distances { delta: 0.5, slopes: Vec::new() };
        let slopes = Vec::new();
        let balance = FluxBalance { range: 0.0, slopes, moved: 2e-2, missed: 2e-3 };
        let none = SourceChange { of_v: 0.0, of_w: 0.0, field: 0.0 };
        let [lower, upper] = ends([1.0, 1e-6], &distances, &balance, &none, [2e-4, 2e-5]);
        assert!((1.0 - lower - 1.0011e-2).abs() < 1e-13, "{lower}");
        assert!((upper - 1.0 - 1.101e-3).abs() < 1e-13, "{upper}");
        let change = SourceChange { of_v: 1e-3, of_w: 1e-4, field: 3e-2 };
        let moved = ends([1.0, 1e-6], &distances, &balance, &change, [2e-4, 1.6e-3]);
        let field = 0.5 * (4e-2f64 + 3e-2).powi(2);
        assert!((1.0 - moved[0] - 1.1001e-2 - field).abs() < 1e-13, "{moved:?}");
        assert!((moved[1] - 1.0 - 2.201e-3).abs() < 1e-13, "{moved:?}");
        // W is v or part of it, with either sign.
        assert_eq!(distances.range(), 1.0);
    }
}
