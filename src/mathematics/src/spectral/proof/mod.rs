//! Proof of the two bounds of the energy: the argument from the data to both ends, step by step.
//!
//! Each step has a formula, a function, and a test that fails without it; `tests/broken/plane.toml` lists what was
//! broken to see that they do.
//!
//! # Statement
//! Given are a domain with straight and circular sides, f (constant on pieces, or smooth in closed form), and a law on
//! each side, a value `at`, which may be smooth too, and an interval `lo <= dv/dn <= hi`, with one value where v sticks
//! on both sides of a corner, but for rounding; u minimises the energy J, and J(u) is what the two ends hold. They are
//! made from any function `v = psi + Re g` of the form below, right or not: nothing of how v was found is used.
//!
//! 1. *Data.* The curves, points and values of the setup are those of the statement but for rounding of coordinates by
//!    two units in the last place, which counts as an error of the energy (step 7). A crossing of f that is joined with
//!    a corner next to it counts where it is (`BoundedEnergy::add_joined`), a bend of a side is kept, however small.
//!    Where numbers nearly agree and count as one, f is changed on a set that is bounded with the jumps ([`Changes`]):
//!    between curves that count as one (`add_moved`, `add_between`) or touch (`add_overlap`), on shapes without borders
//!    (`add_disc`), and in what the pieces between points that count as one enclose (`add_joined`). Step 8 has the
//!    effect; a problem of which so more than a small share of f changes is refused. Tests: `solution::tests::changes`.
//! 2. *The equation.* `-Lap psi = f` holds exactly but for these changes: all pieces of all borders of f are jumps of
//!    psi (`Jumps::new`), which add up to zero in each vertex (`Jumps::check_vertices`), so that both differ by one
//!    constant, which is none where f is known. Values are also compared with f beside the middle of each jump
//!    (`has_values`), and the integral of f with that of dv/dn. g is analytic in the domain if no cut and no pole lies
//!    in it: tips are clear of the closed domain, and a cut that begins outside, or at a corner between both sides,
//!    meets the boundary no earlier than 1.1 of its length (`is_outside`); middles of holes lie in holes. Tests:
//!    `tests::refused`.
//! 3. *Cells.* The boundary is cut into cells on which v, continued to an ellipse round the cell, is analytic
//!    ([`cells`]). The ellipse lies in a disc that holds no singular point; next to a corner, an end of contact or a
//!    crossing the variable is log r, and the ellipse lies between two circles round it. With M a bound of the modulus
//!    there ([`moduli`], [`on_cells`]), the polynomial through 28 Gauss points is off by at most `(1 + 28) 2 M rho^-27
//!    / (rho - 1)`, and the Gauss rule by `(64/15) M rho^-54 / (1 - rho^-2)` half lengths (`EllipseCell::tail`,
//!    `EllipseCell::gauss_error`). Tests: `cells::tests`, with polynomials for which both are nearly reached and all
//!    ellipses against all singular points; `moduli::tests`, with the largest moduli of functions on discs.
//! 4. *Between the points.* A function is within the sum of the moduli of its coefficients in Legendre polynomials,
//!    plus that error, plus 28 times the largest rounding error at the points, 28 being no less than the norm of the
//!    interpolation ([`samples`]). Tests: `samples::tests`, with functions that vanish at all points, with errors at
//!    each of them, and against 45 points of each cell.
//! 5. *What v misses* ([`residual`]). delta bounds |v - at| where v should be `at` and the part of v - at with the
//!    wrong sign; eta is what takes the flux into the law, `q - l` on gaps, and on each loop a constant on a part with
//!    room makes `oint eta = 0`. On a loop on which v should be `at` nowhere a logarithm does so that is added to v: of
//!    the hole itself, or, for the outer loop, of a hole on which v should be `at` somewhere. Tests: `residual::tests`.
//! 6. *Extensions* ([`extension`]). With W equal to the step from v to an admissible function on the boundary, and E to
//!    `H = int eta ds`, which has a constant of its own on each loop,
//!    ```text
//!    int |grad W|^2 <= int rho^2,     rho the largest of constants round the cells:
//!    rho_p = max(range / delta_p, 1.05 slope),     on an area of at most 2 delta_p length + pi delta_p^2.
//!    ```
//!    Tests: `extension::tests`, against harmonic functions of a circle, and all circles against the other pieces.
//! 7. *The energy of v* ([`exact_energy`]). Gauss rules on the cells, with their errors, what lies closer to splits
//!    than all cells (the integral of a sum of powers), and rounding: errors at points times the derivatives of the
//!    integrand by them, which Green's identity makes small ([`green`]). A small closed shape of f is seen from the
//!    middle of its box ([`jump_energy`]): what is off of its borders against each other changes f there, by the jump
//!    times |v|, and what is off of all of it counts by the gradient of what is smooth there of v. Tests:
//!    `exact_energy::tests`, with derivatives by differences, and energies in closed form; `solution::tests::small`,
//!    with shapes down to 1e-9 of the domain.
//! 8. *Both ends* ([`bounds`]):
//!    ```text
//!    lower = J - error - delta int |eta| - 1/2 int |grad E|^2,     over where v should be `at`,
//!    upper = J + error + delta int |l - q| + 1/2 int |grad W|^2,   over where dv/dn should be q.
//!    ```
//!    Tests: `tests::brackets`, more than twenty problems whose energies are known, each spoilt by harmonic functions
//!    of known energy in all places and both directions; `tests::ends`, with ends of contact that move.
//!
//! # Next to corners
//! Closer than `least` to a split H (or W) is `h`, on both sides a constant plus a sum of powers `c_p r^p`; let V be a
//! bound of the sum of `|c_p| least^p`. The interpolation between both sides along circles, `h_1 + (h_2 - h_1) theta /
//! angle`, has
//! ```text
//! int h_r^2 <= angle / 2 (two sides) sum p q / (p + q) |c_p c_q| least^(p + q) <= angle p_max / 2 V^2,
//! int h_theta^2 / r^2 <= 1 / angle int (2 sum |c_p| r^p)^2 / r dr <= 2 / (p_min angle) V^2,
//! ```
//! since `p q / (p + q) <= (p + q) / 4`. On the way down to zero between `least` and twice that, as `h(least) (2 - r /
//! least)`, it has `3/2 angle V^2` and `4 log 2 / angle V^2`. With powers from 1/4, that of a slit between a free side
//! and contact, to 4.5 the sum is `(3.75 angle + 10.8 / angle) V^2`, less than the `22 (4 pi + 128 / angle) V^2` that
//! [`extension`] has. A logarithm beside a power grows towards the corner; `Leftover::variation` has twice the modulus
//! for it, which is enough where `p |log least| >= 1`.
//!
//! # Rounding is a model
//! That a function is off by some units in the last place of its terms is not proved but taken from how it is
//! computed: 16 of each power of a corner, and 8 times the power more, since a logarithm is multiplied by it; 6 + k of
//! the k-th polynomial or power of a hole; 16 and one for each jump of the terms of psi, and 16 of those by which it is
//! found away from small shapes. Arnoldi's recurrence for polynomials multiplies by z and subtracts what came before, k
//! times; that its errors are not magnified holds as far as the polynomials, orthogonal on the boundary, are of about
//! unit size there, and is seen on bars of 1 : 20 and on polygons, where the true error is at most 0.4 of half of the
//! distance of the bounds. Sums over cells lose no more than half a unit of all terms for each addition. Ends of arcs
//! are computed from angles; sides that meet farther apart than 2e-14 of the size of the domain are refused. Tests:
//! `psi_errors::tests`, `green::tests`, and the differences of closed forms in `exact_energy::tests`.
//!
//! So a guarantee is one for the statement as in step 1, and but for this model.
//!
//! [`Changes`]: crate::spectral::source::changes::Changes

mod bounds;
mod cells;
mod exact_energy;
mod extension;
mod green;
mod integrals;
mod jump_energy;
mod moduli;
mod on_cells;
mod psi_errors;
mod residual;
mod samples;

use super::fit::Fit;
use super::functions::Family;
use super::setup::Setup;
use crate::problem::complex::Complex;
use crate::spectral::source::groups::{JumpGroup, beside_edge};
pub(super) use bounds::{ROUNDED, bracket};
use cells::{CellStretch, ProofCell, Singular, Surroundings};
pub(super) use exact_energy::unproved;
use extension::{Chord, share};
use std::f64::consts::PI;

/// Two bounds of the energy, guaranteed but for the model of rounding errors on this page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlaneBracket {
    /// The energy by the same integrals, between both.
    pub energy: f64,
    /// Lower bound.
    pub lower: f64,
    /// Upper bound, at most that of v = 0 if no law has a value.
    pub upper: f64,
    /// Half of the integral of |grad v|^2, by those integrals: the modulus of the energy if no law has a value.
    pub size: f64,
    /// Lower bound of the L2 norm of grad u; none if no law has a value, where it follows from the upper bound.
    pub gradient: Option<f64>,
    /// Name of the largest term of their distance.
    pub cause: &'static str,
}

impl PlaneBracket {
    /// Lower and upper bound.
    pub(crate) fn ends(&self) -> [f64; 2] {
        [self.lower, self.upper]
    }

    /// Distance of the bounds over half of the integral of |grad v|^2.
    pub(crate) fn relative(&self) -> f64 {
        let width = self.upper - self.lower;
        if width > 0.0 { width / self.size } else { 0.0 }
    }
}

/// All that is needed to bound v on the boundary.
struct Proof<'a> {
    setup: &'a Setup,
    fit: &'a Fit,
    singular: Singular<'a>,
    /// Surroundings of the ends of intervals, if they are splits towards which cells get short.
    near: Vec<[Option<Surroundings>; 2]>,
    chords: Vec<Chord>,
    /// Additions to the coefficients of the logarithms of holes.
    logs: Vec<f64>,
}

/// Largest share of the distance within which nothing else is singular, and of that from other sides.
const TOP: [f64; 2] = [0.2, 0.3];
/// Logarithm of the size of what is left closer to a split, over the coefficients.
const LEFT: f64 = 50.0;
/// Logarithm of the least distance over the largest: powers of smaller ones cannot be written.
const DEEPEST: f64 = 145.0;

impl<'a> Proof<'a> {
    /// Finds all that is singular, and proves that no cut meets the domain.
    ///
    /// # Errors
    /// Part that is not proved.
    fn new(setup: &'a Setup, fit: &'a Fit) -> Result<Self, &'static str> {
        let mut points = Vec::new();
        for (k, split) in fit.walk.splits.iter().enumerate() {
            if split.depth() < 1.0 {
                points.push((split.z, Some(k)));
            }
        }
        for family in &fit.functions.families {
            if !is_outside(setup, fit, family) {
                return Err("cuts beside the domain");
            }
            if !has_poles_alone(family) {
                points.push((family.point, family.split));
            }
            let ends = family.lengths.iter().map(|&d| family.point - family.inwards.scaled(d));
            points.extend(ends.map(|end| (end, None)));
        }
        if !setup.jumps.groups.iter().all(has_values) {
            return Err("f");
        }
        for hole in &fit.functions.holes {
            if setup.domain.holds(hole.middle) || setup.domain.distance(hole.middle) < 1e-9 {
                return Err("middles of holes");
            }
            points.push((hole.middle, None));
        }
        let mut proof = Self {
            singular: Singular { psi: &setup.jumps.psi, points },
            near: Vec::new(),
            chords: Chord::all(&fit.walk),
            logs: vec![0.0; fit.logs.len()],
            setup,
            fit,
        };
        for k in 0..fit.walk.intervals.len() {
            let near = [proof.surroundings(k, 0)?, proof.surroundings(k, 1)?];
            proof.near.push(near);
        }
        Ok(proof)
    }

    /// Surroundings of an end of an interval.
    fn surroundings(&self, k: usize, side: usize) -> Result<Option<Surroundings>, &'static str> {
        let (walk, interval) = (&self.fit.walk, &self.fit.walk.intervals[k]);
        let number = interval.splits[side];
        let split = &walk.splits[number];
        if split.depth() >= 1.0 {
            return Ok(None);
        }
        let adjacent = walk.intervals.iter().filter(|own| own.splits.contains(&number));
        let bend = adjacent.fold(0.0f64, |most, own| most.max(own.curvature.abs()));
        let others = self.chords.iter();
        let others = others.filter(|o| !walk.intervals[o.interval].splits.contains(&number));
        let clear = others.map(|chord| chord.distance(split.z)).fold(f64::INFINITY, f64::min);
        let room = self.singular.room(split.z, Some(number));
        let reach = (room / 2.4).min(0.25 / bend).min(self.setup.diameter);
        let turned = 0.25 * share(split.angle) / bend;
        let top = (TOP[0] * reach).min(TOP[1] * clear).min(turned).min(0.5 * interval.length);
        if top < 1e-11 {
            return Err("v next to singular points that are beside each other");
        }
        let family = self.fit.functions.families.iter().find(|family| family.split == Some(number));
        let powers = family.map_or(&[][..], |family| &family.powers);
        let weakest = powers.iter().fold(1.0f64, |least, power| least.min(power.power));
        let least = top * libm::exp(-(LEFT / weakest).min(DEEPEST));
        Ok(Some(Surroundings { centre: split.z, top, least, reach }))
    }

    /// Half of an interval.
    fn stretch(&'a self, interval: usize, side: usize) -> CellStretch<'a> {
        let own = &self.fit.walk.intervals[interval];
        let along = self.setup.domain.side(own);
        let [way, start] = [along.way(), own.from + [0.0, own.length][side]];
        CellStretch {
            curve: along.arc.curve,
            from: along.arc.span[0] + way * start,
            way: [way, -way][side],
            singular: &self.singular,
            length: 0.5 * own.length,
            longest: self.setup.diameter / 10.0,
            near: self.near[interval][side],
        }
    }

    /// Cells of all of the boundary.
    ///
    /// # Errors
    /// Part that is not proved.
    fn cells(&self) -> Result<Vec<ProofCell>, &'static str> {
        let mut cells = Vec::new();
        for interval in 0..self.fit.walk.intervals.len() {
            for side in [0, 1] {
                let own = self.stretch(interval, side).cells().into_iter();
                cells.extend(own.map(|cell| ProofCell { interval, side, cell }));
            }
        }
        match cells.iter().all(|own| own.cell.has_bounds()) {
            true => Ok(cells),
            false => Err("v next to singular points behind the boundary"),
        }
    }

    /// The halves of a cell.
    fn halves(&self, own: ProofCell) -> Option<[ProofCell; 2]> {
        let halves = self.stretch(own.interval, own.side).halves(own.cell)?;
        Some(halves.map(|cell| ProofCell { cell, ..own }))
    }
}

/// True if `-Lap psi` is f on both sides of the jumps of a group, next to their middles; not looked at where points so
/// near are one but for rounding.
fn has_values(group: &JumpGroup) -> bool {
    let edges = || group.edges.iter().map(|own| &own.edge);
    edges().all(|edge| {
        let size = 1e-9 * (edge.values[0].abs() + edge.values[1].abs());
        let points = beside_edge(edge, edges());
        let is_near = (points[0] - points[1]).norm() < 10.0 * f64::EPSILON * group.reach();
        let [left, right] = points.map(|z| group.psi.source(z));
        is_near || (left - edge.values[0]).abs() <= size && (right - edge.values[1]).abs() <= size
    })
}

/// True if all its functions are rational, so that the point itself is not singular.
fn has_poles_alone(family: &Family) -> bool {
    family.split.is_none() && family.powers.iter().all(|p| !p.log && p.power == p.power.round())
}

/// True if the cuts of a family lie outside of the domain: from a corner the longest leads outwards, away from both
/// sides; from other points, which are outside, it does not meet the boundary; and there is more room by a tenth.
fn is_outside(setup: &Setup, fit: &Fit, family: &Family) -> bool {
    let longest = family.lengths.iter().fold(0.0f64, |most, &d| most.max(d));
    let outwards = -family.inwards;
    let mut ends = family.lengths.iter().map(|&d| family.point + outwards.scaled(d));
    if !ends.all(|end| is_clear(setup, end)) {
        return false;
    }
    if has_poles_alone(family) {
        return true;
    }
    let begins = match family.split {
        Some(split) => fit.walk.splits[split].angle < 2.0 * PI - 1e-3,
        None => is_clear(setup, family.point),
    };
    begins && setup.domain.exit(family.point, outwards) > 1.1 * longest
}

/// True if a point is outside of the closed domain, farther than what [`PlaneDomain::exit`] does not see.
///
/// [`PlaneDomain::exit`]: crate::spectral::geometry::domain::PlaneDomain::exit
fn is_clear(setup: &Setup, z: Complex) -> bool {
    setup.domain.distance(z) > 5e-11 && !setup.domain.holds(z)
}

#[cfg(test)]
mod bench;
#[cfg(test)]
mod tests;
