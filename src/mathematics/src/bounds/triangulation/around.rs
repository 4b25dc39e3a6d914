//! First cells around the nodes of a triangulation.

/// First cell around each node, from which the fan of the node is found. The lists of all cells around the nodes would
/// be as long as those of the vertices of the cells.
pub(super) struct FirstCells {
    /// Lowest number of a cell with the node; the number of cells if there is none.
    first: Vec<u32>,
    /// Number of cells with the node.
    counts: Vec<u32>,
    /// Nodes in the order of their first cells: patches of near nodes are near in memory.
    pub order: Vec<u32>,
}

impl FirstCells {
    /// First cells around this number of nodes.
    pub(super) fn new<const V: usize>(nodes: usize, cells: &[[u32; V]]) -> Self {
        let (first, counts) = (vec![cells.len() as u32; nodes], vec![0; nodes]);
        let mut found = Self { first, counts, order: Vec::with_capacity(nodes) };
        for (number, cell) in (0..).zip(cells) {
            for &node in cell {
                let count = &mut found.counts[node as usize];
                if *count == 0 {
                    found.first[node as usize] = number;
                    found.order.push(node);
                }
                *count += 1;
            }
        }
        found
    }

    /// Number of cells around a node.
    pub(super) fn count(&self, node: u32) -> usize {
        self.counts[node as usize] as usize
    }

    /// Lowest number of a cell with a node beside those found before; none if these are all.
    ///
    /// A fan has all cells around a node, unless the domain touches itself there: only then all cells are searched.
    pub(super) fn next<const V: usize>(
        &self,
        node: u32,
        found: &[u32],
        cells: &[[u32; V]],
    ) -> Option<u32> {
        if found.len() == self.count(node) {
            return None;
        }
        let first = self.first[node as usize];
        let is_next = |cell: &u32| cells[*cell as usize].contains(&node) && !found.contains(cell);
        if found.is_empty() { Some(first) } else { (first..cells.len() as u32).find(is_next) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::BuiltIn;

    #[test]
    fn cells_around_a_node_are_found_in_any_order() {
        let mesh = BuiltIn::Disc.plane().unwrap();
        let around = FirstCells::new(7, mesh.cells());
        assert_eq!(around.next(0, &[], mesh.cells()), Some(0));
        assert_eq!(around.next(0, &[0, 2, 1], mesh.cells()), Some(3));
        assert_eq!(around.next(0, &[0, 2, 1, 3, 5, 4], mesh.cells()), None);
    }
}
