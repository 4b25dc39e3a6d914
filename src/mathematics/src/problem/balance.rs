//! Balance of a load by the boundary of a connected component under laws `[0, limit]`.
//!
//! Without fixed nodes, the fluxes of a solution sum to minus the load: nodes that slip down have their limit, nodes
//! that slip up have none, and nodes that stick anything between.

use super::law::BoundaryState;

/// Largest fluxes through the boundary of a component by the states of its nodes.
#[derive(Clone, Default)]
pub(crate) struct Balance {
    sticks: f64,
    slips_down: f64,
}

/// Value at a contact node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactValue {
    /// Number of the node.
    pub number: usize,
    /// Largest flux through the boundary at the node.
    pub most: f64,
    /// Value of y.
    pub value: f64,
    /// Multiplier, which decides between nodes with the same value.
    pub multiplier: f64,
}

impl Balance {
    /// Adds a node with this largest flux.
    pub(crate) fn see(&mut self, state: BoundaryState, most: f64) {
        match state {
            BoundaryState::Sticks => self.sticks += most,
            BoundaryState::SlipsDown => self.slips_down += most,
            BoundaryState::SlipsUp => {}
        }
    }

    /// True if the nodes that stick can balance the load, given the flux that does.
    pub(crate) fn holds(&self, needed: f64) -> bool {
        let most = self.slips_down + self.sticks;
        self.sticks > 0.0 && (self.slips_down..=most).contains(&needed.max(0.0))
    }
}

/// Sorts the nodes of a component by increasing values, then by decreasing multipliers: the order in which they begin
/// to slip down if a growing constant is subtracted from all values. Returns the place of the node which is zero after
/// the constant of least energy, where the nodes before have at most the flux `needed` that balances the load; under
/// the paper's law the first.
///
/// # Panics
/// If there are no nodes.
pub(crate) fn place_at_zero(nodes: &mut [ContactValue], needed: f64) -> usize {
    nodes.sort_by(|a, b| a.value.total_cmp(&b.value).then(b.multiplier.total_cmp(&a.multiplier)));
    let mut flux = 0.0;
    let reaches = |node: &ContactValue| {
        flux += node.most;
        flux >= needed
    };
    nodes.iter().position(reaches).unwrap_or(nodes.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(values: &[f64]) -> Vec<ContactValue> {
        let node = |(number, &value): (usize, &f64)| {
            let multiplier = number as f64;
            ContactValue { number, most: 0.5, value, multiplier }
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
    fn nodes_with_larger_multipliers_slip_down_first() {
        let mut nodes = nodes(&[0.0; 3]);
        assert_eq!(place_at_zero(&mut nodes, 0.7), 1);
        assert!(nodes.iter().map(|node| node.number).eq([2, 1, 0]));
    }
}
