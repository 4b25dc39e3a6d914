//! The grid or network on which a discrete problem is posed.

use super::components::components;
use super::grid::Grid;
use super::load_stats::LoadStats;
use super::network::Network;
use crate::problem::law::ContactNode;
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
