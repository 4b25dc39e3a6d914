//! The discrete problem: the grid or network on which it is posed, with its connected components, the law on the
//! boundary, and the load vector.
//!
//! A solver takes law and load at once. Neither is a setting of the solver, and neither has a default, so that no
//! caller can forget the law.

use super::grid::Grid;
use super::load_stats::LoadStats;
use super::network::{Network, count_components};
use crate::problem::law::{ContactNode, Law};
use crate::problem::unsolvable::Component;
use std::borrow::Cow;

/// Grid of the square or network on which a discrete problem is posed.
#[derive(Clone, Copy, Debug)]
pub enum DiscreteDomain<'a> {
    /// Grid of the square, without a matrix in memory.
    Grid(Grid),
    /// Network of a mesh.
    Network(&'a Network),
}

impl From<Grid> for DiscreteDomain<'_> {
    fn from(grid: Grid) -> Self {
        Self::Grid(grid)
    }
}

impl<'a> From<&'a Network> for DiscreteDomain<'a> {
    fn from(network: &'a Network) -> Self {
        Self::Network(network)
    }
}

impl<'a> DiscreteDomain<'a> {
    /// Number of nodes, the length of a nodal vector.
    pub fn nodes(self) -> usize {
        match self {
            Self::Grid(grid) => grid.nodes(),
            Self::Network(network) => network.nodes(),
        }
    }

    /// Cells per side of a uniform grid; none on a mesh.
    pub fn cells(self) -> Option<usize> {
        match self {
            Self::Grid(grid) => Some(grid.cells()),
            Self::Network(_) => None,
        }
    }

    /// Cells per side of the grid; on a mesh, as many as would give as many nodes on the square.
    pub(crate) fn width(self) -> usize {
        self.cells().unwrap_or_else(|| (self.nodes() as f64).sqrt() as usize)
    }

    /// Boundary nodes where the law holds, in the order of a boundary vector.
    pub fn contact(self) -> Cow<'a, [ContactNode]> {
        match self {
            Self::Grid(grid) => grid.contact_nodes().into(),
            Self::Network(network) => network.contact().into(),
        }
    }

    /// True if v = 0 on a part of the boundary.
    pub fn has_fixed_part(self) -> bool {
        match self {
            Self::Grid(_) => false,
            Self::Network(network) => !network.fixed().is_empty(),
        }
    }

    /// Connected components, with a load vector.
    pub(crate) fn components(self, load: &[f64]) -> Vec<Component> {
        match self {
            Self::Grid(_) => {
                vec![Component::in_contact(Grid::PERIMETER, LoadStats::measure(load).sum())]
            }
            Self::Network(network) => components(network, &network.components(), load),
        }
    }
}

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

/// Law on the boundary, and load vector.
#[derive(Clone, Copy, Debug)]
pub struct LawAndLoad<'a> {
    /// Law on the boundary.
    pub law: Law,
    /// Load vector F (6), one number per node.
    pub load: &'a [f64],
}

impl Law {
    /// Returns this law with a load vector.
    pub fn with_load(self, load: &[f64]) -> LawAndLoad<'_> {
        LawAndLoad { law: self, load }
    }
}
