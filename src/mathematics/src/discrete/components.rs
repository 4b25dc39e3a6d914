//! Connected components of a discrete problem, each with the sum of its load.

use super::load_stats::LoadStats;
use super::network::{Network, count_components};
use crate::problem::unsolvable::Component;

/// Components of a network with a load vector. `of_nodes` has the number of each node's component, from 0 on.
pub(crate) fn components(network: &Network, of_nodes: &[u32], load: &[f64]) -> Vec<Component> {
    let count = count_components(of_nodes);
    let mut loads = vec![Vec::new(); count];
    if count > 1 {
        for (&component, value) in of_nodes.iter().zip(load) {
            loads[component as usize].push(*value);
        }
    }
    let mut found = Vec::with_capacity(count);
    for (number, part) in (1..).zip(&loads) {
        let integral = LoadStats::measure(if count > 1 { part } else { load }).sum();
        let number = (count > 1).then_some(number);
        let has_fixed = false;
        found.push(Component { number, has_fixed, has_parts: true, measure: 0.0, integral });
    }
    for &node in network.fixed() {
        found[of_nodes[node as usize] as usize].has_fixed = true;
    }
    for contact in network.contact() {
        found[of_nodes[contact.node] as usize].measure += contact.measure;
    }
    found
}
