//! The part of a reaction at a node that leaves through the boundary.

use crate::bounds::boundary::PartLaw;
use crate::problem::law::Law;

/// Node of the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenNode {
    /// Value of w.
    pub w: f64,
    /// Square of the norm of the gradient of the hat function.
    pub stiffness: f64,
    /// Integral of the hat function over the boundary in contact.
    pub part: f64,
    /// Measure of the fixed facets at the node.
    pub fixed: f64,
}

impl OpenNode {
    /// Outflows through the boundary in contact and the fixed boundary: the reaction as far as the law allows.
    ///
    /// Where w is not zero, a reaction beyond the end of the interval to which w slips does work on w, and one that is
    /// left to the cells lengthens the distance from `grad w`. The sum of both is about least for the reaction that is
    /// left after the best change of w at this node alone.
    pub(super) fn let_out(self, law: Law, reaction: f64) -> [f64; 2] {
        let Self { w, stiffness, part, fixed } = self;
        if fixed > 0.0 {
            let beside = part * law.project(0.0);
            return [beside, reaction - beside];
        }
        let left = if w == 0.0 { reaction } else { reaction - stiffness * w };
        [if part > 0.0 { PartLaw::new(law, part).clamp(left) } else { 0.0 }, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_belongs_to_the_contact_leaves() {
        let node = OpenNode { w: 0.0, stiffness: 4.0, part: 0.5, fixed: 0.0 };
        let law = Law::SIGNORINI;
        assert_eq!(node.let_out(law, 3.0), [3.0, 0.0]);
        assert_eq!(node.let_out(law, -3.0), [0.0, 0.0]);
        // A value far from the contact, and one that an iteration has not yet brought to zero.
        assert_eq!(OpenNode { w: 2.0, ..node }.let_out(law, 3.0), [0.0, 0.0]);
        assert_eq!(OpenNode { w: 0.25, ..node }.let_out(law, 3.0), [2.0, 0.0]);
        let friction = Law::friction(1.0).unwrap();
        assert_eq!(OpenNode { w: 2.0, ..node }.let_out(friction, -0.4), [-0.5, 0.0]);
        assert_eq!(OpenNode { w: -2.0, ..node }.let_out(friction, 0.3), [0.5, 0.0]);
        assert_eq!(OpenNode { fixed: 1.0, ..node }.let_out(law, -3.0), [0.0, -3.0]);
    }
}
