//! Contact on the finest level.

use super::Problem;
use crate::discrete::contact::ContactArc;
use crate::discrete::kkt::Judgement;
use crate::mesh::arcs;
use crate::saddle::Pair;

impl Problem {
    /// Contact at the nodes of a boundary vector, as [`Pair::in_contact`] has it.
    pub fn in_contact(&self, pair: &Pair) -> Vec<bool> {
        pair.in_contact(self.domain(self.finest()), self.law())
    }

    /// Arcs in contact on the boundary of a domain in the plane, for a nodal vector and its judgement; none in space.
    pub fn arcs(&self, y: &[f64], judgement: &Judgement) -> Option<Vec<ContactArc>> {
        let is_plane = self.levels().facts().dimension == 2;
        is_plane.then(|| arcs(&self.levels().boundary(), y, judgement))
    }

    /// Names of the parts of the boundary that are in contact by a judgement, empty if there is no contact; none where
    /// the boundary has one part, and on the square, whose sides have no names.
    pub fn parts_in_contact(&self, judgement: &Judgement) -> Option<String> {
        self.networks()?;
        let touches = self.at_nodes(&judgement.in_contact(), false);
        self.levels().mesh(self.finest()).parts_of(&touches)
    }

    /// Puts values at the boundary nodes into a nodal vector with this value elsewhere.
    pub fn at_nodes<T: Copy>(&self, values: &[T], elsewhere: T) -> Vec<T> {
        let domain = self.domain(self.finest());
        let mut nodal = vec![elsewhere; domain.nodes()];
        for (contact, value) in domain.contact().iter().zip(values) {
            nodal[contact.node] = *value;
        }
        nodal
    }
}
