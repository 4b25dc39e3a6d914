//! Direct solution of the linear problems of a network, with nodes in contact held at zero, by
//! factors of sparse matrices.

use super::order::minimum_degree;
use crate::discrete::network::Network;

/// Order of the unknowns in the factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FactorOrder {
    /// Numbers of the nodes: as good as others on small grids.
    Natural,
    /// Minimum degree, for all else.
    MinimumDegree,
}

/// Stiffness matrix of a network, and its factors for one set of held nodes.
pub(crate) struct Direct {
    /// Place of each node in the factors.
    places: Vec<u32>,
    factors: Factors,
    /// Diagonal, right-hand side or solution, in the order of the factors.
    x: Vec<f64>,
}

impl Direct {
    pub(crate) fn new(network: &Network, order: FactorOrder) -> Self {
        let nodes = network.nodes();
        let places = match order {
            FactorOrder::Natural => (0..nodes as u32).collect(),
            FactorOrder::MinimumDegree => minimum_degree(network),
        };
        let mut lower = Vec::new();
        for node in 0..nodes {
            let couplings = network.row(node);
            for (&other, &weight) in couplings.others.iter().zip(couplings.weights) {
                let [row, column] = [node, other as usize].map(|node| places[node]);
                if row > column {
                    lower.push(LowerEntry { row, column, value: -weight });
                }
            }
        }
        Self { places, factors: Factors::new(nodes, lower), x: vec![0.0; nodes] }
    }

    /// Number of multiplications of one factorisation.
    pub(crate) fn factor_work(&self) -> f64 {
        self.factors.factor_work()
    }

    /// Number of multiplications of one solution.
    pub(crate) fn solve_work(&self) -> f64 {
        self.factors.solve_work()
    }

    /// Number of multiplications of one step of the active set method: a factorisation, and a solution with refinement.
    pub(crate) fn step_work(&self) -> f64 {
        self.factor_work() + 2.0 * self.solve_work()
    }

    /// Factors the matrix with these entries on the diagonal; where an entry is infinite the node is held at zero.
    pub(crate) fn factor(&mut self, diagonal: impl IntoIterator<Item = f64>) {
        for (&place, diagonal) in self.places.iter().zip(diagonal) {
            self.x[place as usize] = diagonal;
        }
        self.factors.factor(&self.x);
    }

    /// Replaces a right-hand side by the solution; it must be zero at held nodes.
    pub(crate) fn solve(&mut self, values: &mut [f64]) {
        for (&place, value) in self.places.iter().zip(&*values) {
            self.x[place as usize] = *value;
        }
        self.factors.solve(&mut self.x);
        for (&place, value) in self.places.iter().zip(values) {
            *value = self.x[place as usize];
        }
    }
}

/// Symmetric positive definite matrix, and its factors `A = L D L'`, with the pattern of L and zeros kept.
///
/// The rows of L are computed one after the other, along the paths of the elimination tree: J. W. H. Liu, SIAM J.
/// Matrix Anal. Appl. 11 (1990) 134-172; T. A. Davis, Direct Methods for Sparse Linear Systems, SIAM 2006, 4.7.
pub(crate) struct Factors {
    /// Rows of the matrix left of the diagonal.
    matrix: LowerRows,
    /// Column of the first entry of each column of L below the diagonal; [`NONE`] without entries.
    parents: Vec<u32>,
    /// Places at which the entries of each column of L begin, and the last ones end.
    starts: Vec<usize>,
    /// Rows of the entries of L below the diagonal, column by column, increasing in each.
    rows: Vec<u32>,
    /// These entries.
    entries: Vec<f64>,
    /// Inverses of the entries of D.
    inverses: Vec<f64>,
    work: RowWork,
}

/// Rows of the lower triangle of a matrix, without the diagonal.
struct LowerRows {
    starts: Vec<usize>,
    columns: Vec<u32>,
    entries: Vec<f64>,
}

/// Entry of the lower triangle of a matrix, `column < row`.
#[derive(Clone, Copy)]
pub(crate) struct LowerEntry {
    pub(crate) row: u32,
    pub(crate) column: u32,
    pub(crate) value: f64,
}

/// Buffers for one row of L.
struct RowWork {
    /// Values of the row; zero between two rows.
    values: Vec<f64>,
    /// Row in which each column was met last.
    met: Vec<u32>,
    /// Columns of the row.
    pattern: Vec<u32>,
    /// End of the entries of each column so far.
    ends: Vec<usize>,
}

/// Number of no row or column.
const NONE: u32 = u32::MAX;

impl Factors {
    /// Pattern of the factors of a matrix with these entries below the diagonal.
    pub(crate) fn new(size: usize, mut lower: Vec<LowerEntry>) -> Self {
        lower.sort_by_key(|entry| (entry.row, entry.column));
        let mut matrix =
            LowerRows { starts: vec![0; size + 1], columns: Vec::new(), entries: Vec::new() };
        for entry in &lower {
            matrix.starts[entry.row as usize + 1] += 1;
            matrix.columns.push(entry.column);
            matrix.entries.push(entry.value);
        }
        for row in 0..size {
            matrix.starts[row + 1] += matrix.starts[row];
        }
        let parents = matrix.elimination_tree();
        let mut work = RowWork {
            values: vec![0.0; size],
            met: vec![NONE; size],
            pattern: Vec::new(),
            ends: vec![0; size],
        };
        let mut starts = vec![0; size + 1];
        for row in 0..size {
            work.find_pattern(&matrix, &parents, row);
            work.pattern.iter().for_each(|&column| starts[column as usize + 1] += 1);
        }
        for column in 0..size {
            starts[column + 1] += starts[column];
        }
        let count = starts[size];
        let (rows, entries, inverses) = (vec![0; count], vec![0.0; count], vec![0.0; size]);
        Self { matrix, parents, starts, rows, entries, inverses, work }
    }

    /// Number of entries of each column of L below the diagonal.
    fn counts(&self) -> impl Iterator<Item = usize> {
        self.starts.windows(2).map(|ends| ends[1] - ends[0])
    }

    /// Number of multiplications of the factorisation.
    pub(crate) fn factor_work(&self) -> f64 {
        self.counts().map(|below| (below * (below + 3) / 2) as f64).sum()
    }

    /// Number of multiplications of one solution.
    pub(crate) fn solve_work(&self) -> f64 {
        self.counts().map(|below| 2 * below + 1).sum::<usize>() as f64
    }

    /// Factors the matrix with these entries on the diagonal; a row and a column whose entry is infinite are replaced
    /// by those of the unit matrix.
    pub(crate) fn factor(&mut self, diagonal: &[f64]) {
        let Self { matrix, parents, starts, rows, entries, inverses, work } = self;
        work.met.fill(NONE);
        work.ends.copy_from_slice(&starts[..diagonal.len()]);
        for (row, &own) in diagonal.iter().enumerate() {
            work.find_pattern(matrix, parents, row);
            // The same order of additions whatever the pattern.
            work.pattern.sort_unstable();
            if own.is_finite() {
                for place in matrix.starts[row]..matrix.starts[row + 1] {
                    let column = matrix.columns[place] as usize;
                    if diagonal[column].is_finite() {
                        work.values[column] = matrix.entries[place];
                    }
                }
            }
            let mut pivot = if own.is_finite() { own } else { 1.0 };
            for &column in &work.pattern {
                let column = column as usize;
                let value = std::mem::take(&mut work.values[column]);
                let factor = inverses[column] * value;
                let (start, end) = (starts[column], work.ends[column]);
                for (&below, entry) in rows[start..end].iter().zip(&entries[start..end]) {
                    work.values[below as usize] -= factor * entry;
                }
                pivot -= factor * value;
                (rows[end], entries[end]) = (row as u32, value);
                work.ends[column] += 1;
            }
            inverses[row] = 1.0 / pivot;
        }
        for (ends, inverse) in starts.windows(2).zip(inverses) {
            entries[ends[0]..ends[1]].iter_mut().for_each(|entry| *entry *= *inverse);
        }
    }

    /// Solves `L D L' x = b`; `x` is `b` at first.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let columns = self.starts.windows(2).map(|ends| ends[0]..ends[1]).enumerate();
        for (column, places) in columns.clone() {
            let solved = x[column];
            for (&row, entry) in self.rows[places.clone()].iter().zip(&self.entries[places]) {
                x[row as usize] -= entry * solved;
            }
        }
        x.iter_mut().zip(&self.inverses).for_each(|(x, inverse)| *x *= inverse);
        for (column, places) in columns.rev() {
            let below = self.rows[places.clone()].iter().zip(&self.entries[places]);
            for (&row, entry) in below.rev() {
                x[column] -= entry * x[row as usize];
            }
        }
    }
}

impl LowerRows {
    /// Columns of a row left of the diagonal.
    fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.starts[row]..self.starts[row + 1]]
    }

    /// Elimination tree: for each column the row of the first entry of L below the diagonal.
    fn elimination_tree(&self) -> Vec<u32> {
        let size = self.starts.len() - 1;
        let (mut parents, mut ancestors) = (vec![NONE; size], vec![NONE; size]);
        for row in 0..size {
            for &column in self.columns(row) {
                let mut next = column;
                while next != NONE && (next as usize) < row {
                    let above = std::mem::replace(&mut ancestors[next as usize], row as u32);
                    if above == NONE {
                        parents[next as usize] = row as u32;
                    }
                    next = above;
                }
            }
        }
        parents
    }
}

impl RowWork {
    /// Finds the columns of a row of L left of the diagonal.
    fn find_pattern(&mut self, matrix: &LowerRows, parents: &[u32], row: usize) {
        self.pattern.clear();
        for &column in matrix.columns(row) {
            let mut next = column;
            while (next as usize) < row && self.met[next as usize] != row as u32 {
                self.met[next as usize] = row as u32;
                self.pattern.push(next);
                next = parents[next as usize];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entry of the product of the matrix of the test with `x`.
    fn product(x: &[f64], fixed: usize, row: usize) -> f64 {
        if row == fixed {
            return x[row];
        }
        let near = [row.wrapping_sub(3), row.wrapping_sub(1), row + 1, row + 3];
        let coupled = near.into_iter().filter(|&k| k < x.len() && k != fixed);
        4.0 * x[row] - coupled.map(|k| x[k]).sum::<f64>()
    }

    #[test]
    fn solves_what_it_multiplied() {
        // Diagonal 4, entries -1 at distances 1 and 3; unknown 5 is fixed.
        let (size, fixed) = (9, 5);
        let mut lower = Vec::new();
        for row in 0..size as u32 {
            for distance in [1, 3] {
                let column = row.checked_sub(distance);
                lower.extend(column.map(|column| LowerEntry { row, column, value: -1.0 }));
            }
        }
        let mut factors = Factors::new(size, lower);
        let mut diagonal = vec![4.0; size];
        diagonal[fixed] = f64::INFINITY;
        let x: Vec<f64> = (0..size).map(|k| (k * k % 7) as f64).collect();
        // Factors are made anew for each set of fixed unknowns.
        for _ in 0..2 {
            let mut b: Vec<_> = (0..size).map(|row| product(&x, fixed, row)).collect();
            factors.factor(&diagonal);
            factors.solve(&mut b);
            assert!(x.iter().zip(&b).all(|(x, b)| (x - b).abs() < 1e-14), "{b:?}");
        }
    }
}
