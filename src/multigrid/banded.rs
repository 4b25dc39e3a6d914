//! Cholesky factors of small banded matrices, for coarsest grids.

/// A symmetric positive definite matrix, first by its entries and then by its factor `L`, `A = L L'`.
///
/// Row `k` holds the entries `(k, k - band ..= k)` of the lower triangle.
#[derive(Default)]
pub(super) struct Banded {
    size: usize,
    band: usize,
    lower: Vec<f64>,
}

impl Banded {
    /// The zero matrix.
    pub(super) fn zeros(size: usize, band: usize) -> Self {
        Self { size, band, lower: vec![0.0; size * (band + 1)] }
    }

    fn place(&self, row: usize, column: usize) -> usize {
        row * (self.band + 1) + self.band + column - row
    }

    /// The entry of the lower triangle, `column <= row <= column + band`.
    pub(super) fn entry(&mut self, row: usize, column: usize) -> &mut f64 {
        let place = self.place(row, column);
        &mut self.lower[place]
    }

    /// Multiplications that the factorisation takes.
    pub(super) fn factor_work(&self) -> f64 {
        (self.size * self.band * (self.band + 1) / 2) as f64
    }

    /// Multiplications that one solution takes.
    pub(super) fn solve_work(&self) -> f64 {
        (2 * self.size * self.band) as f64
    }

    /// How many numbers are stored.
    pub(super) fn entries(&self) -> usize {
        self.lower.len()
    }

    /// Replaces row and column `k` by those of the unit matrix.
    pub(super) fn fix(&mut self, k: usize) {
        self.lower[k * (self.band + 1)..(k + 1) * (self.band + 1)].fill(0.0);
        *self.entry(k, k) = 1.0;
        for row in k + 1..self.size.min(k + self.band + 1) {
            *self.entry(row, k) = 0.0;
        }
    }

    /// Replaces the entries by those of the factor.
    pub(super) fn factor(&mut self) {
        let (band, width) = (self.band, self.band + 1);
        for row in 0..self.size {
            let first = row.saturating_sub(band);
            for column in first..=row {
                let from = first.max(column.saturating_sub(band));
                let (mine, other) = (self.place(row, from), self.place(column, from));
                let known: f64 =
                    (0..column - from).map(|m| self.lower[mine + m] * self.lower[other + m]).sum();
                let at = self.place(row, column);
                let rest = self.lower[at] - known;
                let pivot = self.lower[column * width + band];
                self.lower[at] = if column < row { rest / pivot } else { rest.sqrt() };
            }
        }
    }

    /// Solves `L L' x = b`, where `x` comes in as `b`.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let (size, band, width) = (self.size, self.band, self.band + 1);
        for row in 0..size {
            let first = row.saturating_sub(band);
            let mine = &self.lower[self.place(row, first)..row * width + band];
            let known: f64 = mine.iter().zip(&x[first..row]).map(|(l, x)| l * x).sum();
            x[row] = (x[row] - known) / self.lower[row * width + band];
        }
        for row in (0..size).rev() {
            let known: f64 = (row + 1..size.min(row + width))
                .map(|m| self.lower[self.place(m, row)] * x[m])
                .sum();
            x[row] = (x[row] - known) / self.lower[row * width + band];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let times = |k: usize| {
            let free = |m: usize| m < size && m != fixed;
            let near = [k.wrapping_sub(3), k.wrapping_sub(1), k + 1, k + 3];
            4.0 * x[k] - near.into_iter().filter(|&m| free(m)).map(|m| x[m]).sum::<f64>()
        };
        let mut b: Vec<_> = (0..size).map(|k| if k == fixed { x[k] } else { times(k) }).collect();
        matrix.factor();
        matrix.solve(&mut b);
        assert!(x.iter().zip(&b).all(|(x, b)| (x - b).abs() < 1e-14), "{b:?}");
    }
}
