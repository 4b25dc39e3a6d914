//! The discrete problem without its load vector: the grid with its law or network on which it is posed, and its
//! connected components.

use super::grid::Grid;
use super::load_stats::LoadStats;
use super::network::{Network, count_components};
use crate::machine::simd::Largest;
use crate::problem::law::{ContactNode, Law};
use crate::problem::unsolvable::Component;
use std::borrow::Cow;

/// Grid of the square or network on which a discrete problem is posed.
#[derive(Clone, Copy, Debug)]
pub enum DiscreteDomain<'a> {
    /// Grid of the square, without a matrix in memory, and the law on its boundary.
    Grid(Grid, Law),
    /// Network of a mesh.
    Network(&'a Network),
}

impl From<(Grid, Law)> for DiscreteDomain<'_> {
    fn from((grid, law): (Grid, Law)) -> Self {
        Self::Grid(grid, law)
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
            Self::Grid(grid, _) => grid.nodes(),
            Self::Network(network) => network.nodes(),
        }
    }

    /// Cells per side of a uniform grid; none on a mesh.
    pub fn cells(self) -> Option<usize> {
        match self {
            Self::Grid(grid, _) => Some(grid.cells()),
            Self::Network(_) => None,
        }
    }

    /// Cells per side of the grid; on a mesh, as many as would give as many nodes on the square.
    pub(crate) fn width(self) -> usize {
        self.cells().unwrap_or_else(|| (self.nodes() as f64).sqrt() as usize)
    }

    /// Boundary nodes that are neither free nor fixed, in the order of a boundary vector.
    pub fn contact(self) -> Cow<'a, [ContactNode]> {
        match self {
            Self::Grid(grid, law) => grid.contact_nodes(law).into(),
            Self::Network(network) => network.contact().into(),
        }
    }

    /// True if v is given on a part of the boundary, or a reaction bears a part of the load.
    pub fn bears_load(self) -> bool {
        match self {
            Self::Grid(..) => false,
            Self::Network(network) => !network.held().is_empty() || network.has_reaction(),
        }
    }

    /// Number beside which residuals are small or not: the largest component of the load vector; without a load, the
    /// largest product of a value at which y sticks with the diagonal of A.
    pub(crate) fn unit(self, load: &[f64]) -> f64 {
        let mut largest = Largest::default();
        largest.see(1.0, load);
        match (largest.value(), self) {
            (0.0, Self::Network(network)) => network.size_of_values(),
            (load, _) => load,
        }
    }

    /// Connected components, with a load vector.
    pub(crate) fn components(self, load: &[f64]) -> Vec<Component> {
        match self {
            Self::Grid(_, law) => {
                vec![Component::whole(law, Grid::PERIMETER, LoadStats::measure(load).sum())]
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
        found.push(Component {
            number,
            has_parts: true,
            ..Component::whole(Law::FREE, 0.0, integral)
        });
    }
    for &ContactNode { node, measure, law } in network.boundary() {
        found[of_nodes[node] as usize].laws.add(law, measure);
    }
    // A reaction bears every load, as a fixed part does.
    let held = found.iter_mut().zip(network.held_components(of_nodes));
    held.filter(|(_, is_held)| *is_held).for_each(|(of, _)| of.laws.add(Law::FIXED, 1.0));
    found
}
