//! Circulations around a node in space: fluxes without divergence, by which the flux of a patch gets its least norm.
//!
//! There is one around each inner edge at the node; around an inner node their sum is zero. On each cell a circulation
//! is a constant field, so that the system for their strengths is that of linear elements on the surface of the patch.

use super::fan::Fan;
use super::few::FewNumbers;
use crate::machine::simd::vectorised;

/// Number of circulations above which they are left out: the flux has the right divergence without them.
const LARGEST: usize = 400;
/// Number of the edges without a circulation: their row of the matrix is not used.
const NONE: u32 = 0;
/// Entries of a row that are changed together.
const ENTRIES: usize = 4;

/// Circulations of the fan of a node, with storage that is used again.
#[derive(Default)]
pub(super) struct Circulations {
    /// Number of the circulation around the edge to each node, from 1 on, or [`NONE`].
    edges: FewNumbers,
    /// Numbers of the circulations around the edges to the other vertices of each cell.
    numbers: Vec<[u32; 3]>,
    /// Number of circulations.
    count: usize,
    /// Entries of a row: the matrix, the right-hand side and what fills the last vector.
    width: usize,
    /// Products of the circulations with each other, on and behind the diagonal, row by row; behind those of each row
    /// minus the product with the flux so far less the gradient of w.
    matrix: Vec<f64>,
    /// Strengths of the circulations.
    strengths: Vec<f64>,
}

impl Circulations {
    /// Adds the circulations to the flux of a fan by which the distance from the gradient of w becomes least.
    pub(super) fn minimise<const D: usize, const V: usize>(&mut self, fan: &mut Fan<'_, D, V>) {
        self.number(fan);
        if !(1..=LARGEST).contains(&self.count) {
            return;
        }
        self.assemble(fan);
        vectorised(|| self.solve());
        for (member, numbers) in fan.members.iter_mut().zip(&self.numbers) {
            let sense = member.shape.sense();
            let [a, b, c] = numbers.map(|number| sense * self.strengths[number as usize]);
            let turned = [c - b, a - c, b - a];
            member.outflows.iter_mut().zip(turned).for_each(|(outflow, turned)| *outflow += turned);
        }
    }

    /// Numbers the circulations.
    fn number<const D: usize, const V: usize>(&mut self, fan: &Fan<'_, D, V>) {
        self.numbers.clear();
        // Each member but the first has one edge at most that those before it have not.
        self.edges.clear(fan.members.len() + 3);
        for node in fan.boundary_nodes() {
            self.edges.number_or(node, NONE);
        }
        // Without a boundary one of the circulations follows from the others.
        let mut next = if fan.is_closed() { NONE } else { 1 };
        for member in &fan.members {
            let mut numbers = [NONE; 3];
            for (number, node) in numbers.iter_mut().zip(member.others) {
                *number = self.edges.number_or(node, next);
                next += u32::from(*number == next);
            }
            self.numbers.push(numbers);
        }
        self.count = next as usize - 1;
    }

    /// Makes room for the matrix.
    fn clear(&mut self) {
        self.width = (self.count + 2).next_multiple_of(ENTRIES);
        self.matrix.clear();
        self.matrix.resize((self.count + 1) * self.width, 0.0);
        self.strengths.clear();
        self.strengths.resize(self.count + 1, 0.0);
    }

    /// Forms the matrix and the right-hand side.
    fn assemble<const D: usize, const V: usize>(&mut self, fan: &Fan<'_, D, V>) {
        self.clear();
        for (member, numbers) in fan.members.iter().zip(&self.numbers) {
            let [products, loads] = member.shape.products(member.outflows);
            for k in 0..3 {
                let (at, i) = (numbers[k] as usize, numbers[(k + 1) % 3] as usize);
                let j = numbers[(k + 2) % 3] as usize;
                // Around the three edges the fields sum to zero.
                self.matrix[i * self.width + i] -= products[k];
                self.matrix[j * self.width + j] -= products[k];
                self.matrix[i.min(j) * self.width + i.max(j)] += products[k];
                self.matrix[at * self.width + self.count + 1] -= loads[k];
            }
        }
    }

    /// Finds the strengths by elimination.
    #[inline(always)]
    fn solve(&mut self) {
        let (n, width) = (self.count, self.width);
        for k in 1..n + 1 {
            let (above, below) = self.matrix.split_at_mut((k + 1) * width);
            let row = &mut above[k * width..];
            // A pivot that is lost to rounding leaves out the circulation.
            let inverse = if row[k] > 0.0 { 1.0 / row[k] } else { 0.0 };
            row[k] = inverse;
            for (later, other) in below.chunks_exact_mut(width).enumerate() {
                let i = k + 1 + later;
                let factor = inverse * row[i];
                if factor != 0.0 {
                    let from = i / ENTRIES * ENTRIES;
                    let entries = other[from..].as_chunks_mut::<ENTRIES>().0;
                    let of_row = row[from..].as_chunks::<ENTRIES>().0;
                    for (entries, of_row) in entries.iter_mut().zip(of_row) {
                        for e in 0..ENTRIES {
                            entries[e] -= factor * of_row[e];
                        }
                    }
                }
            }
        }
        for k in (1..n + 1).rev() {
            let row = &self.matrix[k * width..];
            let (done, found) = self.strengths.split_at_mut(k + 1);
            let later = row[k + 1..].iter().zip(found).map(|(entry, x)| entry * *x).sum::<f64>();
            done[k] = row[k] * (row[n + 1] - later);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factors_solve_a_system() {
        let mut system = Circulations { count: 3, ..Circulations::default() };
        system.clear();
        let rows =
            [[4.0, 1.0, -1.0, -1.0], [f64::NAN, 3.0, 0.5, -3.5], [f64::NAN, f64::NAN, 2.0, 4.0]];
        for (row, place) in rows.iter().zip(1..) {
            system.matrix[place * system.width + 1..][..4].copy_from_slice(row);
        }
        system.solve();
        let solution = [0.0, 1.0, -2.0, 3.0];
        assert!(system.strengths.iter().zip(solution).all(|(x, y)| (x - y).abs() < 1e-14));
    }
}
