//! The condition (2) of the paper: whether a problem has a unique solution, asked of numbers in one place.

use super::law::{Law, LawParameter};
use super::text::{Written, plain};

/// Reason for which a problem has no unique solution: a connected component of the domain violates the condition (2).
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unsolvable {
    /// The integral of f is not negative, which the paper's law asks for.
    #[error(
        "the integral of f{} is {}, but the flux through the boundary can only balance a negative one; lower f \
         somewhere{}",
        over(*component),
        plain(*integral, 4),
        if *has_parts { ", or fix a part of the boundary" } else { "" }
    )]
    NotCoercive {
        /// Integral of f.
        integral: f64,
        /// Number of the connected component, from 1 on; none if the domain is connected.
        component: Option<usize>,
        /// True if the boundary has parts that can be fixed.
        has_parts: bool,
    },
    /// The integral of f is one that the flux under another law cannot balance.
    #[error(
        "the integral of f{} is {}, but the flux through the boundary can only balance one between {} and {}; {}",
        over(*component),
        plain(*integral, 4),
        plain(*least, 4),
        plain(*most, 4),
        remedy(*enough, *has_parts)
    )]
    Unbalanced {
        /// Integral of f.
        integral: f64,
        /// Number of the connected component, from 1 on; none if the domain is connected.
        component: Option<usize>,
        /// Lower end of the integrals that can be balanced; not reached.
        least: f64,
        /// Upper end; not reached.
        most: f64,
        /// Law of the same kind that balances it; none if none does.
        enough: Option<LawParameter>,
        /// True if the boundary has parts that can be fixed.
        has_parts: bool,
    },
    /// The whole boundary is free.
    #[error(
        "the boundary of {} is free everywhere; let some of it be in contact or fixed",
        component.map_or("the domain".into(), |number| format!("component {number} of the domain"))
    )]
    Insulated {
        /// Number of the connected component, from 1 on; none if the domain is connected.
        component: Option<usize>,
    },
}

impl Unsolvable {
    /// Integral that cannot be balanced; none if none can.
    pub fn integral(&self) -> Option<f64> {
        match *self {
            Self::NotCoercive { integral, .. } | Self::Unbalanced { integral, .. } => {
                Some(integral)
            }
            Self::Insulated { .. } => None,
        }
    }
}

/// Words for the component of the domain.
fn over(component: Option<usize>) -> String {
    component.map_or_else(String::new, |number| format!(" over component {number} of the domain"))
}

/// Advice where the law cannot balance f; the boundary may have parts.
fn remedy(enough: Option<LawParameter>, has_parts: bool) -> String {
    let raised = enough.map(|parameter| match parameter {
        LawParameter::Friction(g) => format!("raise friction to {}", Written(g)),
        LawParameter::Limit(limit) => format!("raise limit to {}", Written(limit)),
    });
    match (raised, has_parts) {
        (Some(raised), true) => format!("{raised}, change f, or fix a part of the boundary"),
        (Some(raised), false) => format!("{raised}, or change f"),
        (None, true) => "change f, or fix a part of the boundary".into(),
        (None, false) => "change f".into(),
    }
}

/// Connected component of a domain, with f or with a load vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Number, from 1 on; none if the domain is connected.
    pub number: Option<usize>,
    /// True if v = 0 on a part of its boundary.
    pub has_fixed: bool,
    /// True if the boundary has parts that can be fixed.
    pub has_parts: bool,
    /// Length or area of its boundary in contact.
    pub measure: f64,
    /// Integral of f, or the sum of the load vector.
    pub integral: f64,
}

impl Component {
    /// The whole of a connected domain whose boundary, of this measure, is in contact everywhere.
    pub fn in_contact(measure: f64, integral: f64) -> Self {
        Self { number: None, has_fixed: false, has_parts: false, measure, integral }
    }

    /// Checks the condition (2): the flux that the law allows can balance f by more than `rounding`, the largest
    /// rounding error of the integral. A fixed part of the boundary balances every f.
    ///
    /// # Errors
    /// [`Unsolvable`]. An integral within `rounding` is said to be zero.
    pub fn check(self, law: Law, rounding: f64) -> Result<(), Unsolvable> {
        let Self { number: component, has_fixed, has_parts, measure, integral } = self;
        if has_fixed {
            return Ok(());
        }
        if measure == 0.0 {
            return Err(Unsolvable::Insulated { component });
        }
        let [least, most] = law.balanced(measure);
        // NaN is left to the checks of numbers.
        if !(integral - rounding <= least || integral + rounding >= most) {
            return Ok(());
        }
        let integral = if integral.abs() <= rounding { 0.0 } else { integral };
        Err(if law.is_signorini() {
            Unsolvable::NotCoercive { integral, component, has_parts }
        } else {
            let enough = law.balancing(-integral / measure);
            Unsolvable::Unbalanced { integral, component, least, most, enough, has_parts }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flux_must_balance_f_with_something_to_spare() {
        let check = |law: Law, integral| Component::in_contact(4.0, integral).check(law, 0.0);
        let friction = Law::friction(0.3).unwrap();
        assert!(check(friction, -1.19).is_ok() && check(friction, 1.19).is_ok());
        let message = check(friction, 1.2).unwrap_err().to_string();
        assert!(message.contains("between -1.2") && !message.contains('\n'), "{message}");
        assert!(message.ends_with("; raise friction to 0.31, or change f"), "{message}");
        for integral in [1.2f64, -1.2, 17.3, -4e-9, 1e30] {
            let narrow = check(Law::friction(integral.abs() / 5.0).unwrap(), integral);
            let Err(Unsolvable::Unbalanced { enough: Some(enough), .. }) = narrow else { panic!() };
            assert_eq!(check(enough.law().unwrap(), integral), Ok(()));
        }
        let limited = Law::limited(0.1).unwrap();
        let message = check(limited, -1.0).unwrap_err().to_string();
        assert!(message.ends_with("; raise limit to 0.26, or change f"), "{message}");
        let message = check(limited, 1.0).unwrap_err().to_string();
        assert!(message.ends_with("and 0; change f"), "{message}");
        assert!(check(Law::SIGNORINI, -1e-9).is_ok());
        let error = check(Law::SIGNORINI, 0.0).unwrap_err();
        assert!(matches!(error, Unsolvable::NotCoercive { integral: 0.0, .. }), "{error}");
        // Both are within the rounding errors of zero.
        for integral in [-1e-12, 1e-12] {
            let whole = Component::in_contact(4.0, integral);
            assert_eq!(whole.check(Law::SIGNORINI, 1e-11), Err(error));
        }
    }

    #[test]
    fn a_fixed_part_balances_every_load_and_a_free_boundary_none() {
        let whole = Component::in_contact(0.0, -1.0);
        let error = whole.check(Law::SIGNORINI, 0.0);
        assert_eq!(error, Err(Unsolvable::Insulated { component: None }));
        let fixed = Component { has_fixed: true, integral: 1.0, ..whole };
        assert_eq!(fixed.check(Law::SIGNORINI, 0.0), Ok(()));
    }
}
