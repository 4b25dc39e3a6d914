//! Circulations around a node in space: fluxes without divergence, by which the flux of a patch gets its least norm.
//!
//! There is one around each inner edge at the node; around an inner node their sum is zero. On each cell a circulation
//! is a constant field, so that the system for their strengths is that of linear elements on the surface of the patch.

use super::cells::{RaviartThomas, difference};
use super::fan::{Fan, Member};
use crate::mesh::dot;

/// Number of circulations above which they are left out: the flux has the right divergence without them.
const LARGEST: usize = 400;

/// No circulation.
const NONE: u32 = u32::MAX;

/// Edge between the node of a fan and another.
#[derive(Clone, Copy)]
struct Edge {
    node: u32,
    /// Number of the circulation around the edge, or [`NONE`].
    number: u32,
}

/// Circulation within one cell: out through one side, in through another.
#[derive(Clone, Copy)]
struct Turn<const D: usize> {
    /// Number of the circulation, or [`NONE`].
    number: u32,
    /// Position of the side, in the cell, through which a positive circulation leaves.
    out: usize,
    /// Position of the side through which it enters.
    back: usize,
    /// Sense: 1 or -1.
    sense: f64,
    /// Field of the circulation of strength 1.
    field: [f64; D],
}

/// Position of the vertex of this rank among the vertices other than one.
fn other_vertex(vertex: usize, rank: usize) -> usize {
    if rank < vertex { rank } else { rank + 1 }
}

/// Circulations of the fan of a node, with storage that is used again.
pub(super) struct Circulations {
    /// Edges at the node.
    edges: Vec<Edge>,
    /// Number of circulations.
    count: usize,
    /// Matrix of their products, row by row, as far as the diagonal.
    matrix: Vec<f64>,
    /// Right-hand side, then strengths.
    strengths: Vec<f64>,
}

impl Circulations {
    /// Empty storage.
    pub(super) fn new() -> Self {
        Self { edges: Vec::new(), count: 0, matrix: Vec::new(), strengths: Vec::new() }
    }

    /// Adds the circulations to the flux of a fan by which the distance from the gradient of w becomes least.
    pub(super) fn minimise<const D: usize, const V: usize>(&mut self, fan: &mut Fan<'_, D, V>) {
        self.number(fan);
        if (1..=LARGEST).contains(&self.count) {
            self.assemble(fan);
            self.solve();
            for place in 0..fan.members.len() {
                for turn in Self::turns(fan, &fan.members[place]) {
                    if turn.number != NONE {
                        let strength = turn.sense * self.strengths[turn.number as usize];
                        fan.members[place].outflows[turn.out] += strength;
                        fan.members[place].outflows[turn.back] -= strength;
                    }
                }
            }
        }
    }

    /// Numbers the circulations.
    fn number<const D: usize, const V: usize>(&mut self, fan: &mut Fan<'_, D, V>) {
        self.count = 0;
        self.edges.clear();
        self.edges.extend(fan.boundary_nodes().map(|node| Edge { node, number: NONE }));
        // Without a boundary one of the circulations follows from the others.
        let mut is_left_out = !fan.is_closed();
        for member in &mut fan.members {
            let nodes = fan.mesh.cells()[member.cell as usize];
            for (slot, node) in nodes.into_iter().enumerate() {
                if slot == member.vertex {
                    continue;
                }
                // A fan has so few edges that a search is fast.
                let found = self.edges.iter().find(|edge| edge.node == node);
                member.numbers[slot] = if let Some(edge) = found {
                    edge.number
                } else {
                    let number = if is_left_out { self.count as u32 } else { NONE };
                    self.count += usize::from(is_left_out);
                    is_left_out = true;
                    self.edges.push(Edge { node, number });
                    number
                };
            }
        }
    }

    /// Circulations within a cell.
    #[inline(always)]
    fn turns<const D: usize, const V: usize>(
        fan: &Fan<'_, D, V>,
        member: &Member<V>,
    ) -> [Turn<D>; 3] {
        let nodes = &fan.mesh.cells()[member.cell as usize];
        let vertices = fan.mesh.vertices(nodes);
        let cell = &member.data;
        // The node before the other vertices in their order is an even permutation for even positions of the node.
        let sense = if member.vertex.is_multiple_of(2) == cell.is_mirrored { -1.0 } else { 1.0 };
        let scale = sense / (D as f64 * cell.volume);
        std::array::from_fn(|k| {
            let [around, out, back] = [k, k + 1, k + 2].map(|k| other_vertex(member.vertex, k % 3));
            let number = member.numbers[around];
            let field = difference(vertices[back], vertices[out]).map(|x| scale * x);
            Turn { number, out, back, sense, field }
        })
    }

    /// Forms the matrix, and the right-hand side: minus the products with the flux so far less the gradient of w.
    fn assemble<const D: usize, const V: usize>(&mut self, fan: &Fan<'_, D, V>) {
        self.matrix.clear();
        self.matrix.resize(self.count * self.count, 0.0);
        self.strengths.clear();
        self.strengths.resize(self.count, 0.0);
        for member in &fan.members {
            let cell = &member.data;
            let vertices = fan.mesh.vertices(&fan.mesh.cells()[member.cell as usize]);
            let mut outflows: [f64; V] = std::array::from_fn(|k| member.outflows[k] + cell.work[k]);
            outflows[member.vertex] = 0.0;
            let mean = RaviartThomas::new(vertices, cell.volume).mean(outflows);
            let turns = Self::turns(fan, member);
            for turn in turns.iter().filter(|turn| turn.number != NONE) {
                let row = turn.number as usize;
                self.strengths[row] -= cell.volume * dot(turn.field, mean);
                for other in turns.iter().filter(|other| other.number <= turn.number) {
                    let entry = &mut self.matrix[row * self.count + other.number as usize];
                    *entry += cell.volume * dot(turn.field, other.field);
                }
            }
        }
    }

    /// Replaces the right-hand side by the strengths, by Cholesky's factors `L D L^T`.
    fn solve(&mut self) {
        let n = self.count;
        for i in 0..n {
            for j in 0..=i {
                let (above, row) = self.matrix.split_at_mut(i * n);
                let mut sum = row[j];
                if j < i {
                    // Entries of the row are those of L times D until the row is complete.
                    sum -= (0..j).map(|k| row[k] * above[j * n + k]).sum::<f64>();
                    row[j] = sum;
                } else {
                    for k in 0..i {
                        let factor = row[k] / above[k * n + k];
                        sum -= row[k] * factor;
                        row[k] = factor;
                    }
                    // A pivot that is lost to rounding leaves out the circulation.
                    row[i] = if sum > 0.0 { sum } else { f64::INFINITY };
                }
            }
            let row = &self.matrix[i * n..i * n + i];
            let (done, rest) = self.strengths.split_at_mut(i);
            rest[0] -= row.iter().zip(done).map(|(factor, x)| factor * *x).sum::<f64>();
        }
        for i in (0..n).rev() {
            let below: f64 = (i + 1..n).map(|k| self.matrix[k * n + i] * self.strengths[k]).sum();
            self.strengths[i] = self.strengths[i] / self.matrix[i * n + i] - below;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factors_solve_a_system() {
        let mut system = Circulations::new();
        system.count = 3;
        system.matrix = vec![4.0, 0.0, 0.0, 1.0, 3.0, 0.0, -1.0, 0.5, 2.0];
        let solution = [1.0, -2.0, 3.0];
        system.strengths = vec![4.0 - 2.0 - 3.0, 1.0 - 6.0 + 1.5, -1.0 - 1.0 + 6.0];
        system.solve();
        assert!(system.strengths.iter().zip(solution).all(|(x, y)| (x - y).abs() < 1e-14));
    }
}
