//! Balance of a load by the boundary of a connected component under laws `[0, limit]` or `(-inf, 0]`.
//!
//! Without fixed nodes, the fluxes of a solution sum to minus the load: nodes that slip down have their largest flux,
//! nodes that slip up have none, and nodes that stick anything between.

use super::law::BoundaryState;
use std::cmp::Ordering;

/// Largest fluxes through the boundary of a component by the states of its nodes.
#[derive(Clone, Default)]
pub(crate) struct Balance {
    sticks: f64,
    slips_down: f64,
    /// True if a node takes any negative flux.
    has_upper: bool,
    /// True if such a node sticks.
    upper_sticks: bool,
}

/// Value at a contact node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactValue {
    /// Number of the node.
    pub number: usize,
    /// Least and largest flux through the boundary at the node.
    pub ends: [f64; 2],
    /// Value of y less that of the law.
    pub value: f64,
    /// Multiplier, which decides between nodes with the same value.
    pub multiplier: f64,
}

impl Balance {
    /// Adds a node with these ends of the flux.
    pub(crate) fn see(&mut self, state: BoundaryState, [least, most]: [f64; 2]) {
        self.has_upper |= least < 0.0;
        self.upper_sticks |= least < 0.0 && state == BoundaryState::Sticks;
        match state {
            BoundaryState::Sticks => self.sticks += most,
            BoundaryState::SlipsDown => self.slips_down += most,
            BoundaryState::SlipsUp => {}
        }
    }

    /// True if the nodes that stick can balance the load, given the flux that does.
    pub(crate) fn holds(&self, needed: f64) -> bool {
        let most = self.slips_down + self.sticks;
        if self.upper_sticks {
            return needed <= most;
        }
        let needed = if self.has_upper { needed } else { needed.max(0.0) };
        self.sticks > 0.0 && (self.slips_down..=most).contains(&needed)
    }
}

/// Sorts the nodes of a component by increasing values, then by decreasing multipliers: the order in which they begin
/// to slip down if a growing constant is subtracted from all values. Returns the place of the node which is zero after
/// the constant of least energy, where the nodes before have at most the flux `needed` that balances the load, and none
/// behind it must not slip up; under the paper's law the first.
///
/// # Panics
/// If there are no nodes.
pub(crate) fn place_at_zero(nodes: &mut [ContactValue], needed: f64) -> usize {
    nodes.sort_by(|a, b| a.value.total_cmp(&b.value).then(b.multiplier.total_cmp(&a.multiplier)));
    let last_upper = nodes.iter().rposition(|node| node.ends[0] < 0.0).unwrap_or(0);
    let mut flux = 0.0;
    let reaches = |(place, node): (usize, &ContactValue)| {
        let most = node.ends[1];
        flux += most;
        most == f64::INFINITY || (flux >= needed && place >= last_upper)
    };
    nodes.iter().enumerate().position(reaches).unwrap_or(nodes.len() - 1)
}

impl ContactValue {
    /// State of the node, where the one at `zero` in their order has the value zero, and this one is at `place`.
    pub(crate) fn state(&self, place: usize, zero: usize) -> BoundaryState {
        let [least, most] = self.ends;
        match place.cmp(&zero) {
            Ordering::Less if most.is_finite() => BoundaryState::SlipsDown,
            Ordering::Greater if least.is_finite() => BoundaryState::SlipsUp,
            _ => BoundaryState::Sticks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(values: &[f64]) -> Vec<ContactValue> {
        let node = |(number, &value): (usize, &f64)| {
            let multiplier = number as f64;
            ContactValue { number, ends: [0.0, 0.5], value, multiplier }
        };
        values.iter().enumerate().map(node).collect()
    }

    #[test]
    fn the_shift_is_a_quantile_of_the_values() {
        let values = [3.0, -1.0, 2.0, 0.0];
        let number_at = |needed: f64| {
            let mut nodes = nodes(&values);
            let place = place_at_zero(&mut nodes, needed);
            nodes[place].number
        };
        assert_eq!([0.0, 0.5, 0.6, 1.2, 2.0, 2.1].map(number_at), [1, 1, 3, 2, 0, 0]);
    }

    #[test]
    fn values_held_from_above_are_not_exceeded() {
        let mut nodes = nodes(&[0.0, 1.0, 2.0, 3.0]);
        nodes[2].ends = [f64::NEG_INFINITY, 0.0];
        let zero_at = |nodes: &[ContactValue], needed| place_at_zero(&mut nodes.to_vec(), needed);
        assert_eq!([-1.0, 0.7, 1.2].map(|needed| zero_at(&nodes, needed)), [2, 2, 3]);
        assert_eq!(nodes[3].state(3, 2), BoundaryState::SlipsUp);
        assert_eq!(nodes[2].state(2, 1), BoundaryState::Sticks);
        // Held from below as well, the lower one of the two is met first.
        nodes[1].ends = [0.0, f64::INFINITY];
        assert_eq!([-1.0, 0.7].map(|needed| zero_at(&nodes, needed)), [1, 1]);
        let mut balance = Balance::default();
        balance.see(BoundaryState::SlipsUp, nodes[1].ends);
        assert!(!balance.holds(-1.0));
        balance.see(BoundaryState::Sticks, nodes[2].ends);
        assert!(balance.holds(-1.0) && !balance.holds(0.7));
    }

    #[test]
    fn nodes_with_larger_multipliers_slip_down_first() {
        let mut nodes = nodes(&[0.0; 3]);
        assert_eq!(place_at_zero(&mut nodes, 0.7), 1);
        assert!(nodes.iter().map(|node| node.number).eq([2, 1, 0]));
    }
}
