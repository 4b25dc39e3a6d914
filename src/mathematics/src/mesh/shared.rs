//! Values of f at the points that cells share: the nodes of a mesh and the midpoints of its edges.

use super::{Edges, Mesh};
use crate::discrete::adaptive::{COST, SHARED_POINTS};
use crate::machine::threads::map;

/// Values of f at the nodes of a mesh, and at the midpoints of its edges.
pub(super) struct SharedValues {
    nodes: Vec<f64>,
    edges: Edges,
    middles: Vec<f64>,
}

impl SharedValues {
    /// Values of a function of the point alone.
    pub(super) fn of<const D: usize, const V: usize>(
        mesh: &Mesh<D, V>,
        f: impl Fn([f64; D]) -> f64 + Sync,
    ) -> Self {
        let points = mesh.points();
        let edges = Edges::new(points.len(), mesh.cells());
        let ends = edges.ends();
        // Zeros have one sign, whatever the order of the vertices.
        let nodes = map(points, COST, |point| f(point.map(|x| x + 0.0)));
        let middles = map(&ends, COST, |nodes| {
            let [p, q] = nodes.map(|node| points[node as usize]);
            f(std::array::from_fn(|d| 0.5 * p[d] + 0.5 * q[d] + 0.0))
        });
        Self { nodes, edges, middles }
    }

    /// Values at the vertices of a cell, behind each those at the midpoints of its edges to the vertices before.
    pub(super) fn on<const V: usize>(&self, cell: [u32; V]) -> [f64; SHARED_POINTS] {
        let (mut values, mut count) = ([f64::NAN; SHARED_POINTS], 0);
        for a in 0..V {
            values[count] = self.nodes[cell[a] as usize];
            for b in 0..a {
                values[count + 1 + b] = self.middles[self.edges.between(cell[a], cell[b])];
            }
            count += 1 + a;
        }
        values
    }
}
