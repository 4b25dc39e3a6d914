//! The condition (2) of the paper: whether a problem has a unique solution, asked of numbers in one place.

use super::law::{Law, LawNumber, LawSum};
use super::text::{Written, plain};
use std::fmt;

/// Reason for which a problem has no unique solution: over a connected component of the domain the fluxes that the laws
/// allow cannot balance f.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unsolvable {
    /// Number of the connected component, from 1 on; none if the domain is connected.
    pub component: Option<usize>,
    /// Integral of f.
    pub integral: f64,
    /// Lower and upper end of the integrals that can be balanced, neither of them reached; equal on a free boundary.
    pub balanced: [f64; 2],
    /// Number with which a law of the same kind balances it; none if none does.
    pub enough: Option<(LawNumber, f64)>,
    /// True if the boundary has parts that can be fixed.
    pub has_parts: bool,
    /// True if the flux of free parts is in the integral.
    pub has_fluxes: bool,
}

impl std::error::Error for Unsolvable {}

impl fmt::Display for Unsolvable {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { component, integral, balanced: [least, most], enough, has_parts, has_fluxes } =
            *self;
        let number = component.map_or_else(String::new, |number| format!("component {number} of "));
        if least == most {
            return write!(
                out,
                "the boundary of {number}the domain is free everywhere; let some of it be in contact or fixed"
            );
        }
        let over = component.map_or_else(String::new, |_| format!(" over {number}the domain"));
        let [low, high] = [least, most].map(|end| plain(end, 4));
        let one = match (least.is_finite(), most.is_finite()) {
            (true, true) => format!("one between {low} and {high}"),
            (false, _) if most == 0.0 => "a negative one".into(),
            (false, _) => format!("one below {high}"),
            (true, false) => format!("one above {low}"),
        };
        let mut remedies = Vec::new();
        let raised = |(of, to): (LawNumber, f64)| format!("raise {} to {}", of.name(), Written(to));
        remedies.extend(enough.map(raised));
        remedies.push(if least.is_finite() { "change f" } else { "lower f somewhere" }.into());
        remedies.extend(has_parts.then(|| "fix a part of the boundary".into()));
        let last = remedies.pop().unwrap_or_default();
        let others =
            if remedies.is_empty() { "" } else { &format!("{}, or ", remedies.join(", ")) };
        let what = if has_fluxes {
            "the integral of f and of the fluxes of free parts"
        } else {
            "the integral of f"
        };
        write!(
            out,
            "{what}{over} is {}, but the flux through the boundary can only balance {one}; {others}{last}",
            plain(integral, 4)
        )
    }
}

/// Connected component of a domain, with f or with a load vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Number, from 1 on; none if the domain is connected.
    pub number: Option<usize>,
    /// True if the boundary has parts that can be fixed.
    pub has_parts: bool,
    /// True if the flux of free parts is in the integral.
    pub has_fluxes: bool,
    /// Laws on its boundary.
    pub laws: LawSum,
    /// Integral of f, or the sum of the load vector, with the flux of free parts.
    pub integral: f64,
}

impl Component {
    /// The whole of a connected domain, with one law on all of a boundary of this measure.
    pub fn whole(law: Law, measure: f64, integral: f64) -> Self {
        let laws = LawSum::of(law, measure);
        Self { number: None, has_parts: false, has_fluxes: false, laws, integral }
    }

    /// Checks the condition (2): the flux that the laws allow can balance f by more than `rounding`, the largest
    /// rounding error of the integral. A fixed part of the boundary balances every f.
    ///
    /// # Errors
    /// [`Unsolvable`]. An integral within `rounding` is said to be zero.
    pub fn check(self, rounding: f64) -> Result<(), Unsolvable> {
        let Self { number: component, has_parts, has_fluxes, laws, integral } = self;
        let [lo, hi] = laws.fluxes;
        // By subtraction, since the negative of zero is another zero.
        let balanced = [0.0 - hi, 0.0 - lo];
        // NaN is left to the checks of numbers.
        if lo < hi && !(integral - rounding <= balanced[0] || integral + rounding >= balanced[1]) {
            return Ok(());
        }
        let integral = if integral.abs() <= rounding { 0.0 } else { integral };
        let enough = laws.balancing(-integral);
        Err(Unsolvable { component, integral, balanced, enough, has_parts, has_fluxes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flux_must_balance_f_with_something_to_spare() {
        let check = |law: Law, integral| Component::whole(law, 4.0, integral).check(0.0);
        let friction = Law::friction(0.3).unwrap();
        assert!(check(friction, -1.19).is_ok() && check(friction, 1.19).is_ok());
        let message = check(friction, 1.2).unwrap_err().to_string();
        assert!(message.contains("between -1.2") && !message.contains('\n'), "{message}");
        assert!(message.ends_with("; raise friction to 0.31, or change f"), "{message}");
        for integral in [1.2f64, -1.2, 17.3, -4e-9, 1e30] {
            let narrow = check(Law::friction(integral.abs() / 5.0).unwrap(), integral);
            let (of, enough) = narrow.unwrap_err().enough.unwrap();
            assert_eq!(check(of.law(enough).unwrap(), integral), Ok(()));
        }
        let limited = Law::limited(0.1).unwrap();
        let message = check(limited, -1.0).unwrap_err().to_string();
        assert!(message.ends_with("; raise limit to 0.26, or change f"), "{message}");
        let message = check(limited, 1.0).unwrap_err().to_string();
        assert!(message.ends_with("and 0; change f"), "{message}");
        assert!(check(Law::SIGNORINI, -1e-9).is_ok());
        let error = check(Law::SIGNORINI, 0.0).unwrap_err();
        assert_eq!(error.integral, 0.0);
        assert!(error.to_string().ends_with("a negative one; lower f somewhere"), "{error}");
        // Both are within the rounding errors of zero.
        for integral in [-1e-12, 1e-12] {
            let whole = Component::whole(Law::SIGNORINI, 4.0, integral);
            assert_eq!(whole.check(1e-11), Err(error));
        }
    }

    #[test]
    fn laws_of_parts_add_up() {
        let mut component = Component::whole(Law::SIGNORINI, 1.0, 0.2);
        component.laws.add(Law::friction(0.3).unwrap(), 0.5);
        let error = component.check(0.0).unwrap_err();
        assert!(error.to_string().contains("only balance one below 0.15"), "{error}");
        assert_eq!(Component { integral: 0.1, ..component }.check(0.0), Ok(()));
    }

    #[test]
    fn a_fixed_part_balances_every_load_and_a_free_boundary_none() {
        let mut whole = Component::whole(Law::FREE, 4.0, 1.0);
        let error = whole.check(0.0).unwrap_err();
        assert!(error.to_string().contains("free everywhere"), "{error}");
        whole.laws.add(Law::FIXED, 1.0);
        assert_eq!(whole.check(0.0), Ok(()));
    }
}
