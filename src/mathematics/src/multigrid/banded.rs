//! Factors of banded matrices, for coarsest grids and the active set method.

/// A symmetric positive definite matrix, or its factors, `A = L D L'`.
///
/// Row `k` of a matrix holds the entries `(k, k - band ..= k)` of the lower triangle. Row `k` of the factors holds the
/// entries of `L`, and the inverse of the entry of `D` in place of the diagonal of `L`, which is 1.
pub(crate) struct Banded {
    size: usize,
    band: usize,
    lower: Vec<f64>,
    /// Buffer for a column below the diagonal.
    column: Vec<f64>,
}

impl Banded {
    /// Zero matrix.
    pub(crate) fn zeros(size: usize, band: usize) -> Self {
        Self { size, band, lower: vec![0.0; size * (band + 1)], column: vec![0.0; band] }
    }

    /// Replaces all entries by those of another matrix of this size.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.lower.copy_from_slice(&other.lower);
    }

    fn place(&self, row: usize, column: usize) -> usize {
        row * (self.band + 1) + self.band + column - row
    }

    /// Entry of the lower triangle, `column <= row <= column + band`.
    pub(crate) fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        let place = self.place(row, column);
        &mut self.lower[place]
    }

    /// Number of multiplications of the factorisation.
    pub(crate) fn factor_work(&self) -> f64 {
        self.columns().map(|below| below * (below + 3) / 2).sum::<usize>() as f64
    }

    /// Number of multiplications of one solution.
    pub(crate) fn solve_work(&self) -> f64 {
        self.columns().map(|below| 2 * below + 1).sum::<usize>() as f64
    }

    /// Number of entries of each column below the diagonal.
    fn columns(&self) -> impl Iterator<Item = usize> {
        (0..self.size).rev().map(|rows| rows.min(self.band))
    }

    /// Number of stored numbers.
    pub(crate) fn entries(&self) -> usize {
        self.lower.len() + self.band
    }

    /// Replaces row and column `k` by those of the unit matrix.
    pub(crate) fn fix(&mut self, k: usize) {
        self.lower[k * (self.band + 1)..(k + 1) * (self.band + 1)].fill(0.0);
        *self.entry(k, k) = 1.0;
        for row in k + 1..self.size.min(k + self.band + 1) {
            *self.entry(row, k) = 0.0;
        }
    }

    /// Replaces the entries by those of the factors.
    pub(crate) fn factor(&mut self) {
        let band = self.band;
        for k in 0..self.size {
            let pivot = self.entry(k, k);
            let inverse = 1.0 / *pivot;
            *pivot = inverse;
            let below = k + 1..self.size.min(k + band + 1);
            for row in below.clone() {
                self.column[row - k - 1] = *self.entry(row, k);
            }
            for row in below {
                let (place, column) = (self.place(row, k), &self.column[..row - k]);
                let factor = inverse * column[row - k - 1];
                self.lower[place] = factor;
                let right = &mut self.lower[place + 1..][..row - k];
                right.iter_mut().zip(column).for_each(|(entry, column)| *entry -= factor * column);
            }
        }
    }

    /// Solves `L D L' x = b`; `x` is `b` at first.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let (band, rows) = (self.band, self.lower.chunks_exact(self.band + 1));
        for (row, entries) in rows.clone().enumerate() {
            let (solved, rest) = x.split_at_mut(row);
            let reach = band.min(row);
            let known = entries[band - reach..].iter().zip(&solved[row - reach..]);
            known.for_each(|(entry, x)| rest[0] -= entry * x);
        }
        x.iter_mut().zip(rows.clone()).for_each(|(x, entries)| *x *= entries[band]);
        for (row, entries) in rows.enumerate().rev() {
            let (above, solved) = x.split_at_mut(row);
            let reach = band.min(row);
            let known = above[row - reach..].iter_mut().zip(&entries[band - reach..]);
            known.for_each(|(x, entry)| *x -= entry * solved[0]);
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
        let mut matrix = Banded::zeros(size, 3);
        for k in 0..size {
            *matrix.entry(k, k) = 4.0;
            for distance in [1, 3] {
                if k >= distance {
                    *matrix.entry(k, k - distance) = -1.0;
                }
            }
        }
        matrix.fix(fixed);
        let x: Vec<f64> = (0..size).map(|k| (k * k % 7) as f64).collect();
        let mut b: Vec<_> = (0..size).map(|row| product(&x, fixed, row)).collect();
        matrix.factor();
        matrix.solve(&mut b);
        assert!(x.iter().zip(&b).all(|(x, b)| (x - b).abs() < 1e-14), "{b:?}");
    }
}
