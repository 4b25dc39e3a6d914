//! The part of a reaction at a node that leaves through the boundary.

use crate::bounds::boundary::{BoundaryPart, PartLaw, shift_to_sum};
use crate::problem::law::{Law, LawSum};

/// Facet at a node of the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenFacet {
    /// Law on the facet.
    pub law: Law,
    /// Length or area.
    pub measure: f64,
    /// Outflow for a reaction at the node.
    pub outflow: f64,
}

/// Node of the boundary of a domain in D dimensions.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenNode<const D: usize> {
    /// Value of w.
    pub w: f64,
    /// Square of the norm of the gradient of the hat function.
    pub stiffness: f64,
}

impl<const D: usize> OpenNode<D> {
    /// Lets the reaction out through the facets as far as their laws allow, each in proportion to its measure; through
    /// the fixed ones alone if there are any. The flux of free facets is given, and so is that of a facet whose value
    /// is not the one at which the node sticks: w slips there. Returns the outflow.
    ///
    /// A reaction beyond the end of the interval to which w slips, where w is not the value of the law, does work on
    /// the difference, and one that is left to the cells lengthens the distance from `grad w`. The sum of both is about
    /// least for the reaction that is left after the best change of w at this node alone.
    pub(super) fn let_out(self, facets: &mut [OpenFacet], reaction: f64) -> f64 {
        let Self { w, stiffness } = self;
        // Each of the D nodes of a facet has the same part of the facet.
        let part = |law: Law, measure: f64| PartLaw::new(law, measure / D as f64);
        let mut laws = LawSum::default();
        facets.iter().for_each(|facet| laws.add(facet.law, facet.measure));
        let at = laws.mean().at();
        let is_given = |law: Law| law.is_free() || law.at() != at && !law.is_fixed();
        let flux_given = |law: Law, measure| part(law, measure).slipping(w - law.at());
        let (mut laws, mut fixed, mut given) = (LawSum::default(), 0.0, 0.0);
        for &OpenFacet { law, measure, .. } in &*facets {
            if is_given(law) {
                given += flux_given(law, measure);
                continue;
            }
            laws.add(law, measure);
            fixed += if law.is_fixed() { measure } else { 0.0 };
        }
        let (law, reaction) = (laws.mean(), reaction - given);
        let from = w - law.at();
        let left = if from == 0.0 { reaction } else { reaction - stiffness * from };
        let outflow = part(law, laws.measure).clamp(left);
        let whole = if fixed > 0.0 { fixed } else { laws.measure };
        let mut parts = Vec::with_capacity(facets.len());
        for &OpenFacet { law, measure, .. } in &*facets {
            let flux = match law.is_fixed() || fixed == 0.0 {
                _ if is_given(law) => flux_given(law, measure),
                true => outflow * (measure / whole),
                false => 0.0,
            };
            parts.push(BoundaryPart { flux, measure, law: part(law, measure) });
        }
        let is_outside = |part: &BoundaryPart| part.law.clamp(part.flux) != part.flux;
        if laws.only().is_none() && parts.iter().any(is_outside) {
            parts.iter_mut().for_each(|part| part.flux = part.law.clamp(part.flux));
            shift_to_sum(&mut parts, outflow + given);
        }
        facets.iter_mut().zip(parts).for_each(|(facet, part)| facet.outflow = part.flux);
        outflow + given
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outflows through facets of one length each with these laws.
    fn outflows(node: OpenNode<2>, laws: [Law; 2], reaction: f64) -> [f64; 2] {
        let mut facets = laws.map(|law| OpenFacet { law, measure: 0.5, outflow: f64::NAN });
        let sum = node.let_out(&mut facets, reaction);
        let found = facets.map(|facet| facet.outflow);
        assert_eq!(found[0] + found[1], sum);
        found
    }

    #[test]
    fn only_what_belongs_to_the_contact_leaves() {
        let node = OpenNode { w: 0.0, stiffness: 4.0 };
        let (law, friction) = (Law::SIGNORINI, Law::friction(1.0).unwrap());
        assert_eq!(outflows(node, [law; 2], 3.0), [1.5, 1.5]);
        assert_eq!(outflows(node, [law; 2], -3.0), [0.0, 0.0]);
        // A value far from the contact, and one that an iteration has not yet brought to zero.
        assert_eq!(outflows(OpenNode { w: 2.0, ..node }, [law; 2], 3.0), [0.0, 0.0]);
        assert_eq!(outflows(OpenNode { w: 0.25, ..node }, [law; 2], 3.0), [1.0, 1.0]);
        assert_eq!(outflows(OpenNode { w: 2.0, ..node }, [friction; 2], -0.4), [-0.25, -0.25]);
        assert_eq!(outflows(OpenNode { w: -2.0, ..node }, [friction; 2], 0.3), [0.25, 0.25]);
        assert_eq!(outflows(node, [law, Law::FREE], 3.0), [3.0, 0.0]);
        assert_eq!(outflows(node, [law, Law::FIXED], -3.0), [0.0, -3.0]);
        // The flux of a free facet is given; the value of the law is where v sticks.
        assert_eq!(outflows(node, [law, Law::free(-2.0).unwrap()], 3.0), [3.5, -0.5]);
        let high = [Law::above(2.0, 0.0).unwrap(); 2];
        assert_eq!(outflows(OpenNode { w: 2.0, ..node }, high, 3.0), [1.5, 1.5]);
        assert_eq!(outflows(OpenNode { w: 4.0, ..node }, high, 3.0), [0.0, 0.0]);
        // Where the node has another value, w slips: the flux of the law is given.
        let one = OpenNode { w: 1.0, ..node };
        let pulled = Law::above(0.0, -2.0).unwrap();
        assert_eq!(outflows(one, [pulled, Law::fixed(1.0).unwrap()], 3.0), [-0.5, 3.5]);
        // Each facet keeps to its law.
        assert_eq!(outflows(node, [law, friction], 3.0), [2.75, 0.25]);
        assert_eq!(outflows(node, [law, friction], -3.0), [0.0, -0.25]);
    }
}
