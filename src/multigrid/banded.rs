//! Cholesky factors of small banded matrices, for coarsest grids.

/// A symmetric positive definite matrix, first by its entries and then by its factor `L`, `A = L L'`.
///
/// Row `k` holds the entries `(k, k - band ..= k)` of the lower triangle.
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

    /// Replaces all entries by those of another matrix of this size.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.lower.copy_from_slice(&other.lower);
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
            let (above, rest) = self.lower.split_at_mut(row * width);
            let (mine, pivot) = rest[..width].split_at_mut(band);
            let first = band.saturating_sub(row);
            for place in first..band {
                // Row `row` begins so many columns after that of the entry's column.
                let shift = band - place;
                let other = &above[(row - shift) * width..][..width];
                let known: f64 = mine[first..place]
                    .iter()
                    .zip(&other[first + shift..])
                    .map(|(a, b)| a * b)
                    .sum();
                mine[place] = (mine[place] - known) / other[band];
            }
            pivot[0] = (pivot[0] - dot(&mine[first..], &mine[first..])).sqrt();
        }
    }

    /// Solves `L L' x = b`, where `x` comes in as `b`.
    pub(super) fn solve(&self, x: &mut [f64]) {
        let (band, width) = (self.band, self.band + 1);
        for (row, entries) in self.lower.chunks_exact(width).enumerate() {
            let first = row.saturating_sub(band);
            let known = dot(&entries[band + first - row..band], &x[first..row]);
            x[row] = (x[row] - known) / entries[band];
        }
        for row in (0..self.size).rev() {
            let (solved, entries) = (&x[row + 1..], &self.lower[row * width..]);
            let (own, below) = entries.split_at(width);
            // Down the column, one place nearer to the start of its row in each.
            let mut known = 0.0;
            for (k, (entries, x)) in below.chunks_exact(width).zip(solved).take(band).enumerate() {
                known += entries[band - 1 - k] * x;
            }
            x[row] = (x[row] - known) / own[band];
        }
    }
}

/// The sum of the products, one after the other.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (a, b) in a.iter().zip(b) {
        sum += a * b;
    }
    sum
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
