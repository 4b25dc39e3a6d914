//! Edges of a triangulation, in the order in which refinement numbers their midpoints.

/// Edges, by their node with the lower number, then by the other one.
pub(crate) struct Edges {
    /// Position of the first edge of each node, and the number of edges.
    starts: Vec<u32>,
    /// Node with the higher number of each edge.
    higher: Vec<u32>,
    /// Numbers of the edges of all cells, in each by the later one of its vertices, then by the other one.
    of_cells: Vec<u32>,
}

impl Edges {
    /// Edges of cells on this number of nodes.
    ///
    /// # Panics
    /// If there are more edges, counted in each cell, than 32 bits number.
    pub(crate) fn new<const V: usize>(nodes: usize, cells: &[[u32; V]]) -> Self {
        let mut starts = vec![0u32; nodes + 1];
        for_each_pair(cells, |lower, _| starts[lower as usize + 1] += 1);
        let mut total = 0u32;
        for start in &mut starts {
            total = total.checked_add(*start).expect("more edges than 32 bits number");
            *start = total;
        }
        let mut next = starts.clone();
        // The other node and the place, in one number.
        let (mut keys, mut place) = (vec![0; total as usize], 0);
        for_each_pair(cells, |lower, other| {
            let next = &mut next[lower as usize];
            keys[*next as usize] = (u64::from(other) << 32) | place;
            (*next, place) = (*next + 1, place + 1);
        });
        // Each edge stands there once for each of its cells.
        let (mut higher, mut of_cells) = (Vec::new(), vec![0; keys.len()]);
        let mut from = 0;
        for node in 0..nodes {
            let to = starts[node + 1] as usize;
            keys[from..to].sort_unstable();
            starts[node] = higher.len() as u32;
            let mut last = None;
            for key in &keys[from..to] {
                let other = (key >> 32) as u32;
                if last.replace(other) != Some(other) {
                    higher.push(other);
                }
                of_cells[*key as u32 as usize] = higher.len() as u32 - 1;
            }
            from = to;
        }
        starts[nodes] = higher.len() as u32;
        higher.shrink_to_fit();
        Self { starts, higher, of_cells }
    }

    /// Number of edges.
    pub(crate) fn len(&self) -> usize {
        self.higher.len()
    }

    /// Number of the edge between two vertices of a cell, the later one second.
    #[inline(always)]
    pub(crate) fn of_cell<const V: usize>(&self, cell: usize, [i, j]: [usize; 2]) -> usize {
        self.of_cells[V * (V - 1) / 2 * cell + j * (j - 1) / 2 + i] as usize
    }

    /// Number of the edge between two nodes.
    ///
    /// # Panics
    /// If there is none.
    pub(crate) fn between(&self, one: u32, two: u32) -> usize {
        let (lower, other) = (one.min(two) as usize, one.max(two));
        let (from, to) = (self.starts[lower] as usize, self.starts[lower + 1] as usize);
        let found = self.higher[from..to].iter().position(|&node| node == other);
        from + found.expect("the nodes are those of an edge")
    }

    /// Nodes of all edges, the lower number first.
    pub(crate) fn ends(&self) -> Vec<[u32; 2]> {
        let mut ends = Vec::with_capacity(self.len());
        for node in 0..self.starts.len() - 1 {
            let range = self.starts[node] as usize..self.starts[node + 1] as usize;
            ends.extend(self.higher[range].iter().map(|&other| [node as u32, other]));
        }
        ends
    }
}

/// Calls `visit` with the nodes of each pair of vertices of each cell, the lower number first.
fn for_each_pair<const V: usize>(cells: &[[u32; V]], mut visit: impl FnMut(u32, u32)) {
    for cell in cells {
        for i in 0..V {
            for j in 0..i {
                visit(cell[i].min(cell[j]), cell[i].max(cell[j]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_in_the_order_of_their_nodes() {
        let edges = Edges::new(4, &[[2, 0, 1], [1, 2, 3]]);
        assert_eq!(edges.ends(), [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(edges.between(3, 1), 3);
        assert_eq!([[0, 1], [0, 2], [1, 2]].map(|ends| edges.of_cell::<3>(1, ends)), [2, 3, 4]);
    }
}
