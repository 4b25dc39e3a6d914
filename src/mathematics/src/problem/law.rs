//! The law on the boundary: the flux dv/dn stays in an interval, and v leaves a value only where the flux is at an end
//! of it.
//!
//! With the flux `l = dv/dn` in `[lo, hi]`:
//!
//! | state | v | l |
//! | --- | --- | --- |
//! | sticks | `at` | anything in `[lo, hi]` |
//! | slips up | above `at` | `lo` |
//! | slips down | below `at` | `hi` |
//!
//! A free part, dv/dn = h, has `[h, h]`, and a fixed one, v = `at`, `(-inf, inf)`: there nothing moves from one state
//! to another. The law of a node is the sum of the intervals of its facets.
//!
//! The paper's problem (1) has `at` = 0 and `[0, inf)`: nothing slips down, and what sticks is in contact. Friction
//! with the bound g has `[-g, g]` (Glowinski, Lions and Tremolieres, *Numerical Analysis of Variational Inequalities*,
//! 1981), and a membrane that lets at most a given flow through `[0, hi]` (Duvaut and Lions, *Inequalities in Mechanics
//! and Physics*, 1976). The energy of the problem has the term `j(v)`, the largest of `-l (v - at)` over the interval.
//! In the paper's formulas the projection onto the interval takes the place of `( )^+`.

use super::error::SCALE;
use super::formula::Formula;
use super::text::Written;
use crate::machine::extremes::{max_or_nan, min_or_nan};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Difference of two values that rounding errors may make, over the largest value.
pub(crate) const SAME: f64 = 1e-12;

/// Law on a part of the boundary, or at a node: the value that v leaves only where the flux is at an end of an
/// interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// The value; 0 where the interval is one number, since v takes any value there, and NaN if it is a formula, so
    /// that what does not ask for its values at points fails.
    at: f64,
    /// Ends of the interval of the flux; NaN of a free part whose flux is a formula.
    lo: f64,
    hi: f64,
}

/// Meaning of a number of the law on a part of the boundary; the paper's law has none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LawNumber {
    /// The flux of a free part.
    Free,
    /// The value of v on a fixed part.
    Fixed,
    /// The value above which v is not.
    Below,
    /// Bound g of the friction: the flux lies in `[-g, g]`.
    Friction,
    /// Largest flux: it lies in `[0, limit]`.
    Limit,
    /// The value that v leaves only where the flux is at an end: the least one, unless a law of friction or a limit is
    /// given.
    Gap,
    /// The flux where v is not at the value of an obstacle.
    Flux,
}

/// Node of the boundary with its law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactNode {
    /// Number of the node.
    pub node: usize,
    /// Length or area of the boundary at the node: the integral of the hat function over the facets that are not free.
    pub measure: f64,
    /// Interval of the mean flux: the sum of the intervals of the facets over the measure.
    pub law: Law,
}

/// Sum of the laws on some of the boundary: of the facets at a node, or of a connected component.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LawSum {
    /// Length or area, without what is free.
    pub measure: f64,
    /// Least and largest flux through all of it.
    pub fluxes: [f64; 2],
    /// The law, if there is one.
    law: Option<Law>,
    /// True if there are several.
    is_mixed: bool,
    /// Value of v where there are several; see [`Law::meet`].
    pub(crate) at: f64,
}

/// Numbers that make no law.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LawError {
    /// A parameter that is not a positive, finite number.
    #[error("{name} = {value} must be a positive number, e.g. {name} = 0.3")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Value of the parameter.
        value: f64,
    },
    /// A value or a flux with which no solver computes.
    #[error(
        "{name} = {} must be 0, or a number of a size from {} to {}", Written(*value),
        Written(SCALE.start), Written(SCALE.end)
    )]
    Number {
        /// Name of the number.
        name: &'static str,
        /// The number.
        value: f64,
    },
    /// Ends of an interval that is empty, has no inner point, or is not bounded on either side.
    #[error(
        "the flux must lie between two numbers, the first smaller and at most one infinite, not {lo} and {hi}"
    )]
    Interval {
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
}

/// State of a boundary node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BoundaryState {
    /// v is the value of the law; for the paper's law, contact.
    Sticks,
    /// v is above it, with the least flux.
    SlipsUp,
    /// v is below it, with the largest flux.
    SlipsDown,
}

/// A problem as one for v or -v with another load, under laws one end of which is 0: `[0, limit]`, or `(-inf, 0]` where
/// another part of the boundary holds v from the other side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OneSided {
    /// True if the problem is that of -v.
    pub is_reflected: bool,
}

impl OneSided {
    /// The problem with this load vector under these laws.
    ///
    /// The end with the smaller absolute value becomes 0. For friction, where both are as far from 0, the end becomes 0
    /// towards which v mostly slips: the load of largest absolute value decides. So f and -f lead to the same numbers,
    /// and where v - `at` has one sign, the limit plays no part.
    pub(crate) fn new(laws: &LawSum, load: &[f64]) -> Self {
        let [lo, hi] = laws.fluxes;
        let is_reflected = if lo == -hi {
            let mut largest = 0.0f64;
            for value in load {
                if value.abs() > largest.abs() {
                    largest = *value;
                }
            }
            largest < 0.0
        } else {
            lo.abs() > hi.abs()
        };
        Self { is_reflected }
    }

    /// Law of v or -v, and the end that becomes 0: the lower one, if it is finite.
    fn turned(self, law: Law) -> (Law, f64) {
        let law = if self.is_reflected { law.reflected() } else { law };
        let end = if law.lo.is_finite() { law.lo } else { law.hi };
        (law, if end.is_finite() { end } else { 0.0 })
    }

    /// Law of the other problem.
    pub(crate) fn law(self, law: Law) -> Law {
        let (Law { at, lo, hi }, end) = self.turned(law);
        Law { at, lo: lo - end, hi: hi - end }
    }

    /// Load vector of the other problem, for the load vector F and the nodes with a law.
    pub(crate) fn load(self, load: &[f64], contact: &[ContactNode]) -> Vec<f64> {
        let mut shifted: Vec<f64> = load.iter().map(|value| self.signed(*value)).collect();
        for &ContactNode { node, measure, law } in contact {
            shifted[node] += measure * self.turned(law).1;
        }
        shifted
    }

    /// Value of the problem as given for one of the other problem, or the other way round.
    pub(crate) fn signed(self, value: f64) -> f64 {
        if self.is_reflected { -value } else { value }
    }
}

impl LawSum {
    /// One law on a boundary of this measure.
    pub fn of(law: Law, measure: f64) -> Self {
        let mut sum = Self::default();
        sum.add(law, measure);
        sum
    }

    /// Adds a part of the boundary of this measure.
    pub fn add(&mut self, law: Law, measure: f64) {
        if law.is_free() {
            return;
        }
        let through = |end: f64| if end.is_finite() { measure * end } else { end };
        let [lo, hi] = self.fluxes;
        let largest = self.at.abs().max(law.at.abs());
        self.at = Law { at: self.at, lo, hi }.meet(law, largest).unwrap_or(self.at);
        self.measure += measure;
        self.fluxes[0] += through(law.lo);
        self.fluxes[1] += through(law.hi);
        self.is_mixed |= *self.law.get_or_insert(law) != law;
    }

    /// The law, if there is one on all that is not free; free without any.
    pub fn only(&self) -> Option<Law> {
        (!self.is_mixed).then(|| self.law.unwrap_or(Law::FREE))
    }

    /// The law, or of several the interval of the mean flux.
    pub(crate) fn mean(&self) -> Law {
        let [lo, hi] = self.fluxes.map(|flux| flux / self.measure);
        self.only().unwrap_or(Law { at: self.at, lo, hi })
    }

    /// Node with these laws on its facets.
    pub(crate) fn at_node(&self, node: usize) -> ContactNode {
        ContactNode { node, measure: self.measure, law: self.mean() }
    }

    /// Friction or limit, in two digits and with something to spare, under which this flux can leave; none if the laws
    /// are neither, or no limit lets such a flux through.
    pub(super) fn balancing(&self, flux: f64) -> Option<(LawNumber, f64)> {
        let ([lo, hi], mean) = (self.fluxes, flux / self.measure);
        let (of, value) = match () {
            () if lo == -hi => (LawNumber::Friction, above(mean.abs())),
            () if lo == 0.0 && mean > 0.0 => (LawNumber::Limit, above(mean)),
            () => return None,
        };
        of.law(value).is_ok().then_some((of, value))
    }
}

/// Equation of one boundary unknown in the modified functional (7): `A_ii y = sum + measure l`, where the flux is l.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundaryRow {
    /// Load less the products of the other values with their entries of A: `F_i - sum_j A_ij y_j`, j not i.
    pub sum: f64,
    /// Diagonal entry `A_ii`.
    pub diagonal: f64,
    /// Part of the boundary at the node, h on the square.
    pub measure: f64,
    /// Multiplier.
    pub a: f64,
    /// Duality parameter r > 0.
    pub r: f64,
}

impl Law {
    /// The paper's law: v >= 0, dv/dn >= 0, and one of both zero.
    pub const SIGNORINI: Self = Self { at: 0.0, lo: 0.0, hi: f64::INFINITY };
    /// dv/dn = 0.
    pub const FREE: Self = Self { at: 0.0, lo: 0.0, hi: 0.0 };
    /// v = 0.
    pub const FIXED: Self = Self { at: 0.0, lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// The law of these parts, if they all have the same; the paper's without any.
    pub(crate) fn only(parts: &[(String, Self)]) -> Option<Self> {
        let first = parts.first().map_or(Self::SIGNORINI, |part| part.1);
        parts.iter().all(|part| part.1 == first).then_some(first)
    }

    /// The law as it stands in messages, with the formula of its value, if it has one.
    pub fn in_words(self, formula: Option<&Formula>) -> String {
        formula.map_or_else(|| self.to_string(), |_| Conditions { law: self, formula }.to_string())
    }

    /// True if what sticks may begin to slip, and what slips to stick: neither a free nor a fixed part.
    pub fn may_move(self) -> bool {
        !self.is_free() && !self.is_fixed()
    }

    /// True if the flux is given: dv/dn = `lo`.
    pub fn is_free(self) -> bool {
        self.lo == self.hi || self.lo.is_nan()
    }

    /// True if v is given: v = `at`.
    pub fn is_fixed(self) -> bool {
        self.lo == f64::NEG_INFINITY && self.hi == f64::INFINITY
    }

    /// True if v stays above the value, with no flux elsewhere: what sticks is in contact.
    pub fn is_contact(self) -> bool {
        self.lo == 0.0 && self.hi == f64::INFINITY
    }

    /// Flux where v is known: that of a free part, or an end where v is off the value by more than `rounding`; none
    /// where the flux may be anything in the interval.
    pub fn flux_of(self, v: f64, rounding: f64) -> Option<f64> {
        let end = match v - self.at {
            _ if self.is_free() => self.lo,
            above if above > rounding => self.lo,
            above if above < -rounding => self.hi,
            _ => return None,
        };
        Some(end).filter(|end| end.is_finite())
    }

    /// v = `value`.
    ///
    /// # Errors
    /// [`LawError::Number`] unless the value is 0 or in [`SCALE`].
    pub fn fixed(value: f64) -> Result<Self, LawError> {
        Self::FIXED.with_at(value)
    }

    /// dv/dn = `flux`.
    ///
    /// # Errors
    /// [`LawError::Number`] unless the flux is 0 or in [`SCALE`].
    pub fn free(flux: f64) -> Result<Self, LawError> {
        let flux = sized("flux", flux)?;
        Ok(Self { at: 0.0, lo: flux, hi: flux })
    }

    /// v >= `gap`, and dv/dn = `flux` where v is above it: less than `flux` nowhere.
    ///
    /// # Errors
    /// [`LawError::Number`] unless both are 0 or in [`SCALE`].
    pub fn above(gap: f64, flux: f64) -> Result<Self, LawError> {
        Self { lo: sized("flux", flux)?, ..Self::SIGNORINI }.with_at(gap)
    }

    /// v <= `gap`, and dv/dn = `flux` where v is below it: more than `flux` nowhere.
    ///
    /// # Errors
    /// [`LawError::Number`] unless both are 0 or in [`SCALE`].
    pub fn below(gap: f64, flux: f64) -> Result<Self, LawError> {
        Self { hi: sized("flux", flux)?, ..Self::FIXED }.with_at(gap)
    }

    /// The law with another value.
    ///
    /// # Errors
    /// [`LawError::Number`] unless the value is 0 or in [`SCALE`].
    pub fn with_at(self, at: f64) -> Result<Self, LawError> {
        let at = sized("value", at)?;
        Ok(Self { at: if self.is_free() { 0.0 } else { at }, ..self })
    }

    /// The law in units of v and of dv/dn.
    pub(crate) fn in_units(self, value: f64, flux: f64) -> Self {
        Self { at: self.at / value, lo: self.lo / flux, hi: self.hi / flux }
    }

    /// The law with a formula in place of its value, or of a free part of its flux.
    #[must_use]
    pub fn by_formula(self) -> Self {
        if self.is_free() { self.with_flux(f64::NAN) } else { Self { at: f64::NAN, ..self } }
    }

    /// True if a formula is in place of its value or its flux.
    pub fn is_by_formula(self) -> bool {
        self.at.is_nan() || self.lo.is_nan()
    }

    /// The law of a free part with this flux.
    pub(crate) fn with_flux(self, flux: f64) -> Self {
        Self { lo: flux, hi: flux, ..self }
    }

    /// The law with this value, which is known to be one.
    pub(crate) fn scaled_at(self, at: f64) -> Self {
        Self { at, ..self }
    }

    /// Value that v has unless the flux is at an end of the interval; 0 on a free part, where v takes any value, and
    /// NaN if it is a formula.
    pub fn at(self) -> f64 {
        self.at
    }

    /// Law with the flux in `[lo, hi]`.
    ///
    /// # Errors
    /// [`LawError::Interval`] unless `lo < hi` with at most one of them infinite.
    pub fn new(lo: f64, hi: f64) -> Result<Self, LawError> {
        let is_bounded = lo.is_finite() || hi.is_finite();
        if lo < hi && is_bounded {
            Ok(Self { at: 0.0, lo, hi })
        } else {
            Err(LawError::Interval { lo, hi })
        }
    }

    /// Friction: `|dv/dn| <= g`, with v against it where the flux is at the bound.
    ///
    /// # Errors
    /// [`LawError::Parameter`] unless g is positive and finite.
    pub fn friction(g: f64) -> Result<Self, LawError> {
        let g = positive("friction", g)?;
        Ok(Self { at: 0.0, lo: -g, hi: g })
    }

    /// Limited flow: the paper's law, but with v < 0 where the flux is at the limit.
    ///
    /// # Errors
    /// [`LawError::Parameter`] unless the limit is positive and finite.
    pub fn limited(limit: f64) -> Result<Self, LawError> {
        Ok(Self { at: 0.0, lo: 0.0, hi: positive("limit", limit)? })
    }

    /// Least flux.
    pub fn lo(self) -> f64 {
        self.lo
    }

    /// Largest flux.
    pub fn hi(self) -> f64 {
        self.hi
    }

    /// True if both ends of the interval are finite, so that v may have any sign.
    pub fn is_bounded(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// True if v may have this value.
    fn allows(self, v: f64) -> bool {
        (v >= self.at || self.hi.is_finite()) && (v <= self.at || self.lo.is_finite())
    }

    /// Value of v at a point where parts with this law and another one meet, unless the flux is at an end of the sum of
    /// both intervals: that of the fixed part, if the other law allows it; of two least values the larger one, of two
    /// largest ones the smaller one. None if the laws contradict each other, or v would have two such values.
    ///
    /// Values that differ by rounding errors are the same, where the `largest` value is this one.
    pub(crate) fn meet(self, other: Self, largest: f64) -> Option<f64> {
        let [one, two] = [self.at, other.at];
        let is_same = (one - two).abs() <= SAME * largest;
        match () {
            () if self.is_free() => Some(two),
            () if other.is_free() => Some(one),
            () if self.is_fixed() && (is_same || other.allows(one)) => Some(one),
            () if other.is_fixed() && (is_same || self.allows(two)) => Some(two),
            () if self.is_fixed() || other.is_fixed() => None,
            () if self.hi == f64::INFINITY && other.hi == f64::INFINITY => Some(one.max(two)),
            () if self.lo == -f64::INFINITY && other.lo == -f64::INFINITY => Some(one.min(two)),
            () => is_same.then_some(one),
        }
    }

    /// Distances of a flux from the lower and the upper end: negative beyond.
    pub fn room(self, flux: f64) -> [f64; 2] {
        [flux - self.lo, self.hi - flux]
    }

    /// Law of -v, if this is the law of v.
    #[must_use]
    pub fn reflected(self) -> Self {
        Self { at: 0.0 - self.at, lo: 0.0 - self.hi, hi: 0.0 - self.lo }
    }

    /// Law `[0, limit]`.
    pub(crate) fn up_to(limit: f64) -> Self {
        Self { at: 0.0, lo: 0.0, hi: limit }
    }

    /// The point of the interval next to a flux, which takes the place of `( )^+` in (8) and (12).
    #[inline(always)]
    pub fn project(self, flux: f64) -> f64 {
        let above = if flux > self.lo { flux } else { self.lo };
        if above < self.hi { above } else { self.hi }
    }

    /// Minimiser (10), (11) of the modified functional over one boundary unknown, not of a fixed part.
    #[inline(always)]
    pub(crate) fn relax(self, row: BoundaryRow) -> f64 {
        let BoundaryRow { sum, diagonal, measure, a, r } = row;
        let up = (sum + measure * self.lo) / diagonal;
        if up - self.at >= (a - self.lo) / r {
            return up;
        }
        let down = (sum + measure * self.hi) / diagonal;
        if down - self.at <= (a - self.hi) / r {
            return down;
        }
        (sum + measure * (a + r * self.at)) / (diagonal + measure * r)
    }

    /// Minimiser of the energy over one boundary unknown, `Law::relax` as r grows: the diagonal entry times y is
    /// `sum` and the flux times `measure`.
    #[inline(always)]
    pub fn settle(self, sum: f64, diagonal: f64, measure: f64) -> f64 {
        let up = (sum + measure * self.lo) / diagonal;
        let down = (sum + measure * self.hi) / diagonal;
        up.max(down.min(self.at))
    }

    /// Natural residual at a boundary node where `gradient` is that of the energy without the boundary, `(A y - F)_i`:
    /// the distance of the gradient from the point of `measure` times the interval that is next to
    /// `gradient - (y - at)`.
    ///
    /// For the paper's law `|min(y, gradient)|`.
    #[inline(always)]
    pub fn residual(self, y: f64, gradient: f64, measure: f64) -> f64 {
        let [above_lo, above_hi] = self.above_ends(gradient, measure);
        min_or_nan(above_lo, max_or_nan(y - self.at, above_hi)).abs()
    }

    /// Differences between a gradient and `measure` times the ends of the interval; infinite for an infinite end,
    /// whatever the gradient.
    #[inline(always)]
    pub(crate) fn above_ends(self, gradient: f64, measure: f64) -> [f64; 2] {
        let [mut above_lo, mut above_hi] = [-self.lo, -self.hi];
        if self.lo.is_finite() {
            above_lo = gradient - measure * self.lo;
        }
        if self.hi.is_finite() {
            above_hi = gradient - measure * self.hi;
        }
        [above_lo, above_hi]
    }

    /// State at a boundary node, where differences up to `rounding` are rounding errors: a node sticks where the
    /// gradient is inside, and where both it and v are undecided. NaN slips up.
    pub fn state(self, y: f64, gradient: f64, measure: f64, rounding: f64) -> BoundaryState {
        let [above_lo, above_hi] = self.above_ends(gradient, measure);
        let from = y - self.at;
        if above_hi - from > rounding {
            BoundaryState::SlipsDown
        } else if from - above_lo <= rounding {
            BoundaryState::Sticks
        } else {
            BoundaryState::SlipsUp
        }
    }

    /// True if a flux is farther than `rounding` from both ends of the interval.
    pub fn is_inside(self, flux: f64, rounding: f64) -> bool {
        flux - self.lo > rounding && self.hi - flux > rounding
    }

    /// Term j(v) of the energy, per length or area of the boundary. For an infinite end of the interval, which v on the
    /// other side of `at` violates, zero there.
    #[inline(always)]
    pub fn potential(self, v: f64) -> f64 {
        let from = v - self.at;
        let flux = if from > 0.0 { self.lo } else { self.hi };
        if flux.is_finite() { -flux * from } else { 0.0 }
    }
}

/// The law, as it stands in messages.
impl fmt::Display for Law {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::SIGNORINI => out.write_str("Signorini"),
            Self::FREE => out.write_str("free"),
            Self::FIXED => out.write_str("fixed"),
            law => Conditions { law, formula: None }.fmt(out),
        }
    }
}

/// The conditions on v and its flux, as they stand in messages, with the formula in place of the value.
pub(crate) struct Conditions<'a> {
    pub law: Law,
    pub formula: Option<&'a Formula>,
}

impl fmt::Display for Conditions<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let law @ Law { at, lo, hi } = self.law;
        let value = match self.formula {
            Some(formula) => formula.to_string(),
            None if law.is_by_formula() => "a formula".to_owned(),
            None => Written(if law.is_free() { lo } else { at }).to_string(),
        };
        match () {
            () if law.is_free() => return write!(out, "dv/dn = {value}"),
            () if law.is_fixed() => return write!(out, "v = {value}"),
            () if hi == f64::INFINITY => write!(out, "v >= {value}")?,
            () if lo == f64::NEG_INFINITY => write!(out, "v <= {value}")?,
            () if lo == -hi => write!(out, "friction {}", Written(hi))?,
            () => write!(out, "flux from {} to {}", Written(lo), Written(hi))?,
        }
        match [lo, hi].map(f64::is_finite) {
            [true, true] if at == 0.0 => Ok(()),
            [true, true] => write!(out, " at v = {value}"),
            [is_above, _] => match if is_above { lo } else { hi } {
                0.0 => Ok(()),
                flux => write!(out, ", dv/dn = {} elsewhere", Written(flux)),
            },
        }
    }
}

impl LawNumber {
    /// Name in options, scenes and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Fixed => "fixed",
            Self::Below => "below",
            Self::Friction => "friction",
            Self::Limit => "limit",
            Self::Gap => "gap",
            Self::Flux => "flux",
        }
    }

    /// True if it says which law holds; others are of such a law, or of the paper's.
    pub fn is_law(self) -> bool {
        !matches!(self, Self::Gap | Self::Flux)
    }

    /// True if a law that this number says has that number too.
    pub fn goes_with(self, other: Self) -> bool {
        match self {
            Self::Below => other == Self::Flux,
            Self::Friction | Self::Limit => other == Self::Gap,
            Self::Gap | Self::Flux => true,
            Self::Free | Self::Fixed => false,
        }
    }

    /// True if a formula may take its place: it is the value of a law, or the flux of a free part.
    pub fn takes_formulas(self) -> bool {
        matches!(self, Self::Free | Self::Fixed | Self::Below | Self::Gap)
    }

    /// Reads the number, or the formula in its place.
    ///
    /// # Errors
    /// The fault of the text, with the remedy.
    pub fn read(self, text: &str) -> Result<Formula, String> {
        let read = Formula::in_law(text, 3);
        if self.takes_formulas() {
            return read;
        }
        let number = read.as_ref().ok().and_then(Formula::number);
        let is_positive = matches!(self, Self::Friction | Self::Limit);
        match number {
            Some(number) if !is_positive || number > 0.0 => read,
            _ => Err(format!(
                "must be a {}number, e.g. 0.3",
                if is_positive { "positive " } else { "" }
            )),
        }
    }

    /// Law with this number.
    ///
    /// # Errors
    /// [`LawError::Parameter`] or [`LawError::Number`].
    pub fn law(self, number: f64) -> Result<Law, LawError> {
        match self {
            Self::Free => Law::free(number),
            Self::Fixed => Law::fixed(number),
            Self::Friction => Law::friction(number),
            Self::Limit => Law::limited(number),
            Self::Below => Law::below(number, 0.0),
            Self::Gap => Law::above(number, 0.0),
            Self::Flux => Law::above(0.0, number),
        }
    }
}

/// Name of the integral of dv/dn over the boundary, in words.
pub fn name_of_force(has_contact: bool) -> &'static str {
    if has_contact { "contact force" } else { "flux through the boundary" }
}

/// A number of two digits above a positive one.
fn above(value: f64) -> f64 {
    let scientific = format!("{value:e}");
    let exponent =
        scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok());
    let unit = exponent.map_or(f64::NAN, |exponent| libm::exp10(f64::from(exponent - 1)));
    format!("{:.1e}", value + unit).parse().unwrap_or(f64::NAN)
}

fn sized(name: &'static str, value: f64) -> Result<f64, LawError> {
    // The sum with 0 takes the sign from -0.
    match value == 0.0 || SCALE.contains(&value.abs()) {
        true => Ok(0.0 + value),
        false => Err(LawError::Number { name, value }),
    }
}

fn positive(name: &'static str, value: f64) -> Result<f64, LawError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(LawError::Parameter { name, value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Value that the paper's formulas (10) and (11) give.
    fn papers_relaxation(row: BoundaryRow) -> f64 {
        let BoundaryRow { sum, diagonal, measure, a, r } = row;
        let psi = sum / diagonal;
        if psi >= a / r { psi } else { (sum + measure * a) / (diagonal + measure * r) }
    }

    /// Modified functional in one unknown, with twice Huber's function for the boundary.
    fn functional(law: Law, row: BoundaryRow, y: f64) -> f64 {
        let BoundaryRow { sum, diagonal, measure, a, r } = row;
        let s = a - r * y;
        let inside = law.project(s);
        // The integral of 2 P(s) over s.
        let h = inside * inside + 2.0 * inside * (s - inside);
        0.5 * diagonal * y * y - sum * y + measure / (2.0 * r) * h
    }

    fn rows() -> impl Strategy<Value = BoundaryRow> {
        (-2.0..2.0f64, 0.5..3.0f64, 0.01..1.0f64, -1.0..1.0f64, 1e-3..1e6f64)
            .prop_map(|(sum, diagonal, measure, a, r)| BoundaryRow { sum, diagonal, measure, a, r })
    }

    proptest! {
        #[test]
        fn the_papers_law_gives_the_papers_bits(row in rows(), y in -1.0..1.0f64) {
            let row = BoundaryRow { a: row.a.abs(), ..row };
            let law = Law::SIGNORINI;
            prop_assert_eq!(law.relax(row).to_bits(), papers_relaxation(row).to_bits());
            prop_assert_eq!(law.project(row.sum).to_bits(), row.sum.max(0.0).to_bits());
            let natural = y.min(row.sum).abs();
            prop_assert_eq!(law.residual(y, row.sum, row.measure).to_bits(), natural.to_bits());
        }

        #[test]
        fn a_relaxation_minimises_the_functional(
            row in rows(), lo in -1.0..0.5f64, width in 0.01..2.0f64, other in -1.0..1.0f64,
        ) {
            let law = Law::new(lo, lo + width).unwrap();
            let row = BoundaryRow { a: law.project(row.a), ..row };
            let best = law.relax(row);
            let least = functional(law, row, best);
            let rounding = 1e-13 * (1.0 + least.abs() + 0.5 / row.r + row.r);
            for y in [best + other, best + 1e-3 * other, -best] {
                prop_assert!(functional(law, row, y) >= least - rounding);
            }
        }

        #[test]
        fn the_reflected_law_is_that_of_minus_v(row in rows(), lo in -1.0..0.5f64, y in -1.0..1.0f64) {
            let law = Law::new(lo, 1.0).unwrap();
            let reflected = BoundaryRow { sum: -row.sum, a: -row.a, ..row };
            prop_assert_eq!(law.reflected().relax(reflected), -law.relax(row));
            prop_assert_eq!(law.reflected().project(-row.sum), -law.project(row.sum));
            prop_assert_eq!(law.reflected().potential(-y), law.potential(y));
            let residual = law.reflected().residual(-y, -row.sum, row.measure);
            prop_assert_eq!(residual, law.residual(y, row.sum, row.measure));
        }

        #[test]
        fn the_residual_is_the_distance_from_the_law(
            gradient in -1.0..1.0f64, y in -1.0..1.0f64, lo in -1.0..0.5f64, measure in 0.01..1.0f64,
        ) {
            let law = Law::new(lo, 0.6).unwrap();
            let [least, most] = [measure * law.lo(), measure * law.hi()];
            let expected = (gradient - (gradient - y).max(least).min(most)).abs();
            prop_assert!((law.residual(y, gradient, measure) - expected).abs() < 1e-15);
        }
    }

    #[test]
    fn nan_is_never_hidden() {
        for law in [Law::SIGNORINI, Law::friction(0.3).unwrap()] {
            assert!(law.residual(f64::NAN, f64::NAN, 0.1).is_nan());
            assert!(law.residual(0.0, f64::NAN, 0.1).is_nan());
        }
    }

    #[test]
    fn bad_laws_are_refused_with_one_line() {
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for error in [Law::friction(value), Law::limited(value)].map(Result::unwrap_err) {
                assert!(error.to_string().contains("must be a positive number"), "{error}");
            }
        }
        let unsized_laws = [Law::fixed(f64::NAN), Law::free(f64::INFINITY), Law::fixed(1e-200)];
        for error in unsized_laws.map(Result::unwrap_err) {
            assert!(matches!(error, LawError::Number { .. }), "{error}");
        }
        let unbounded = [f64::NEG_INFINITY, f64::INFINITY];
        for [lo, hi] in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0], [0.0, f64::NAN], unbounded] {
            assert!(matches!(Law::new(lo, hi), Err(LawError::Interval { .. })), "{lo} {hi}");
        }
    }

    #[test]
    fn texts_have_no_rows_of_zeros() {
        let friction = [0.3, 2.0, 1e300, 1e-7].map(|g| Law::friction(g).unwrap().to_string());
        assert_eq!(friction, ["friction 0.3", "friction 2", "friction 1e300", "friction 1e-7"]);
        let friction = Law::friction(0.3).unwrap().with_at(0.2).unwrap();
        let others = [Law::above(0.2, 0.0), Law::above(0.0, -0.5), Law::below(1.0, 0.0)];
        let words = [others, [Law::fixed(-1.0), Law::free(2.0), Ok(friction)]].concat();
        let words: Vec<_> = words.into_iter().map(|law| law.unwrap().to_string()).collect();
        assert_eq!(
            words,
            [
                "v >= 0.2",
                "v >= 0, dv/dn = -0.5 elsewhere",
                "v <= 1",
                "v = -1",
                "dv/dn = 2",
                "friction 0.3 at v = 0.2"
            ]
        );
    }

    #[test]
    fn states_follow_the_flux() {
        let law = Law::friction(0.5).unwrap();
        let state = |y: f64, flux: f64| law.state(y, 0.1 * flux, 0.1, 1e-12);
        assert_eq!(state(0.0, 0.3), BoundaryState::Sticks);
        assert_eq!(state(0.2, -0.5), BoundaryState::SlipsUp);
        assert_eq!(state(-0.2, 0.5), BoundaryState::SlipsDown);
    }
}
