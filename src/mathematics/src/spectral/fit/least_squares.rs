//! Linear least squares by Householder's reflections, blocked: Schreiber and Van Loan, *A storage-efficient WY
//! representation for products of Householder transformations*, SIAM J. Sci. Stat. Comput. 10 (1989).

use crate::machine::simd::vectorised;

/// Reflections that are applied together to all columns that follow.
const BLOCK: usize = 32;
/// Reflections that are applied together to the other columns of their block.
const PART: usize = 8;
/// Numbers side by side in a loop.
const LANES: usize = 8;
/// Rows and columns of a product whose entries are kept in registers.
const TALL: usize = 2 * LANES;
const WIDE: usize = 4;
/// Groups of [`WIDE`] columns that are taken together, so that the reflections stay in the cache.
const GROUPS: usize = 4;
/// Rows of reflections that are taken with all of these, so that they stay in the nearest cache.
const NEAR: usize = 64;
/// Size of the multiple of the identity below the columns, which have norm 1: it keeps the coefficients small where
/// columns depend on each other.
const RIDGE: f64 = 1e-15;

/// Matrix by columns, the last of which is the right-hand side, with room for a multiple of the identity below.
pub(crate) struct Columns {
    /// Rows without those of the identity.
    pub rows: usize,
    /// Unknowns.
    pub unknowns: usize,
    /// Rows of storage: a multiple of [`TALL`].
    height: usize,
    entries: Vec<f64>,
}

impl Columns {
    /// Zeros.
    pub(crate) fn new(rows: usize, unknowns: usize) -> Self {
        let height = (rows + unknowns).next_multiple_of(TALL);
        Self { rows, unknowns, height, entries: vec![0.0; height * (unknowns + 1)] }
    }

    /// Column by its number, without the rows of the identity.
    pub(crate) fn column(&mut self, k: usize) -> &mut [f64] {
        let from = k * self.height;
        &mut self.entries[from..from + self.rows]
    }

    /// Coefficients of the columns whose sum is nearest to the right-hand side; destroys the matrix.
    pub(crate) fn solve(mut self) -> Vec<f64> {
        let (rows, many, height) = (self.rows, self.unknowns, self.height);
        let mut scales = Vec::with_capacity(many);
        for k in 0..many {
            let column = self.column(k);
            let norm = column.iter().map(|x| x * x).sum::<f64>().sqrt();
            let scale = if norm > 0.0 { 1.0 / norm } else { 1.0 };
            column.iter_mut().for_each(|x| *x *= scale);
            scales.push(scale);
            self.entries[k * height + rows + k] = RIDGE;
        }
        for from in (0..many).step_by(BLOCK) {
            let to = (from + BLOCK).min(many);
            // Below, the identity is not yet touched.
            let limit = (rows + to).next_multiple_of(TALL);
            vectorised(
                #[inline(always)]
                || reflect(&mut self.entries, height, [from, to], limit),
            );
        }
        let mut x = self.entries[many * height..many * height + many].to_vec();
        for k in (0..many).rev() {
            let column = &self.entries[k * height..k * height + k + 1];
            x[k] /= column[k];
            let value = x[k];
            x[..k].iter_mut().zip(column).for_each(|(x, r)| *x -= r * value);
        }
        x.iter().zip(scales).map(|(x, scale)| x * scale).collect()
    }
}

/// Numbers beside each other.
type Lanes = [f64; LANES];

/// Reflections whose product is `I - V T V'`. The columns they are applied to have a height, and their first rows are
/// left alone.
struct Reflections {
    /// V, [`LANES`] rows of all columns after each other.
    by_columns: Vec<[Lanes; BLOCK]>,
    /// V, all rows of [`LANES`] columns after each other.
    by_rows: [Vec<Lanes>; BLOCK / LANES],
    /// T by columns.
    t: [[f64; BLOCK]; BLOCK],
}

/// Reflects a block of columns to triangular form, and all that follow with it. Rows from `limit` on are zero in the
/// block.
#[inline(always)]
fn reflect(entries: &mut [f64], height: usize, [from, to]: [usize; 2], limit: usize) {
    // Rows above the block are left alone, but for those beside its first.
    let top = from / TALL * TALL;
    let tall = limit - top;
    let mut all = Reflections {
        by_columns: vec![[[0.0; LANES]; BLOCK]; tall / LANES],
        by_rows: std::array::from_fn(|_| vec![[0.0; LANES]; tall]),
        t: [[0.0; BLOCK]; BLOCK],
    };
    let mut part = vec![0.0; PART * tall];
    for start in (from..to).step_by(PART) {
        let end = (start + PART).min(to);
        for j in start..end {
            let (pivot, after) = entries[j * height + top..].split_at_mut(height);
            let own = &mut part[(j - start) * tall..(j - start + 1) * tall];
            let tau = reflection(&mut pivot[..tall], j - top, own);
            for other in after.chunks_mut(height).take(end - 1 - j) {
                let factor = tau * dot(own, &other[..tall]);
                other.iter_mut().zip(own.iter()).for_each(|(x, v)| *x -= factor * v);
            }
            all.set(j - from, own, tau);
        }
        let span = [start - from, end - from];
        all.join(span, &part);
        all.apply(span, &mut entries[end * height..to * height], [height, top]);
    }
    all.apply([0, to - from], &mut entries[to * height..], [height, top]);
}

/// Finds and applies the reflection that takes a column, from a row on, to a multiple of a unit vector.
#[inline(always)]
fn reflection(column: &mut [f64], first: usize, v: &mut [f64]) -> f64 {
    v[..first].fill(0.0);
    v[first..].copy_from_slice(&column[first..]);
    let norm = dot(v, v).sqrt();
    let size = if v[first] > 0.0 { -norm } else { norm };
    let head = v[first] - size;
    // A column of zeros cannot be: the identity is below.
    let scale = 1.0 / head;
    v.iter_mut().for_each(|x| *x *= scale);
    v[first] = 1.0;
    column[first..].fill(0.0);
    column[first] = size;
    -head / size
}

impl Reflections {
    /// Sets a column of V.
    #[inline(always)]
    fn set(&mut self, number: usize, v: &[f64], tau: f64) {
        for (rows, x) in self.by_columns.iter_mut().zip(v.chunks_exact(LANES)) {
            rows[number].copy_from_slice(x);
        }
        for (row, x) in self.by_rows[number / LANES].iter_mut().zip(v) {
            row[number % LANES] = *x;
        }
        self.t[number][number] = tau;
    }

    /// Completes columns of T, for the reflections of a part.
    #[inline(always)]
    fn join(&mut self, [from, to]: [usize; 2], part: &[f64]) {
        let tall = part.len() / PART;
        let products = self.products([0, to], &part[..(to - from) * tall], [tall, 0]);
        for (j, products) in (from..to).zip(products.as_flattened()) {
            let tau = self.t[j][j];
            for i in 0..j {
                let sum: f64 = (i..j).map(|k| self.t[k][i] * products[k]).sum();
                self.t[j][i] = -tau * sum;
            }
        }
    }

    /// Applies the transposed product of some reflections, `I - V T' V'`, to columns.
    #[inline(always)]
    fn apply(&self, [from, to]: [usize; 2], columns: &mut [f64], [height, top]: [usize; 2]) {
        for columns in columns.chunks_mut(GROUPS * WIDE * height) {
            let mut factors = [[[0.0; BLOCK]; WIDE]; GROUPS];
            let products = self.products([from, to], columns, [height, top]);
            let both = factors.as_flattened_mut().iter_mut().zip(products.as_flattened());
            for (factors, products) in both {
                for (i, factor) in factors.iter_mut().enumerate().take(to).skip(from) {
                    for (t, product) in self.t[i][from..=i].iter().zip(&products[from..=i]) {
                        *factor -= t * product;
                    }
                }
            }
            self.add(&factors, [from, to], columns, [height, top]);
        }
    }

    /// Products of reflections with up to `GROUPS * WIDE` columns.
    #[inline(always)]
    fn products(
        &self,
        [from, to]: [usize; 2],
        columns: &[f64],
        [height, top]: [usize; 2],
    ) -> [[[f64; BLOCK]; WIDE]; GROUPS] {
        const MANY: usize = BLOCK / LANES;
        let tall = self.by_rows[0].len();
        let mut found = [[[0.0; BLOCK]; WIDE]; GROUPS];
        for first in (0..tall).step_by(NEAR) {
            let rows = first..(first + NEAR).min(tall);
            for (found, columns) in found.iter_mut().zip(columns.chunks(WIDE * height)) {
                let last = columns.len() / height - 1;
                let others = [0, 1, 2, 3]
                    .map(|c: usize| &columns[c.min(last) * height + top..][rows.clone()]);
                for k in (from / LANES..to.div_ceil(LANES)).step_by(2) {
                    let both = [k, (k + 1) % MANY];
                    let mut sums = [[[0.0; LANES]; WIDE]; 2];
                    for (k, sums) in both.into_iter().zip(&mut sums) {
                        for (found, sums) in found.iter().zip(sums) {
                            sums.copy_from_slice(&found[k * LANES..(k + 1) * LANES]);
                        }
                    }
                    add_products(&mut sums, both.map(|k| &self.by_rows[k][rows.clone()]), others);
                    for (k, sums) in both.into_iter().zip(&sums) {
                        for (found, sums) in found.iter_mut().zip(sums) {
                            found[k * LANES..(k + 1) * LANES].copy_from_slice(sums);
                        }
                    }
                }
            }
        }
        found
    }

    /// Adds multiples of the columns of V from one on to up to `GROUPS * WIDE` columns.
    #[inline(always)]
    fn add(
        &self,
        factors: &[[[f64; BLOCK]; WIDE]; GROUPS],
        [from, to]: [usize; 2],
        columns: &mut [f64],
        [height, top]: [usize; 2],
    ) {
        for (at, rows) in self.by_columns.chunks_exact(2).enumerate() {
            let row = top + at * TALL;
            let groups = factors.iter().zip(columns.chunks_mut(WIDE * height));
            for (factors, columns) in groups {
                let mut sums = [[[0.0; LANES]; WIDE]; 2];
                for (c, column) in columns.chunks(height).enumerate() {
                    for (i, sums) in sums.iter_mut().enumerate() {
                        sums[c].copy_from_slice(&column[row + i * LANES..][..LANES]);
                    }
                }
                let own = factors.each_ref().map(|own| &own[from..to]);
                add_products(&mut sums, [0, 1].map(|i: usize| &rows[i][from..to]), own);
                for (c, column) in columns.chunks_mut(height).enumerate() {
                    for (i, sums) in sums.iter().enumerate() {
                        column[row + i * LANES..][..LANES].copy_from_slice(&sums[c]);
                    }
                }
            }
        }
    }
}

/// Adds the product of a matrix with [`TALL`] rows, and one with [`WIDE`] columns.
#[inline(always)]
fn add_products(sums: &mut [[Lanes; WIDE]; 2], a: [&[Lanes]; 2], b: [&[f64]; WIDE]) {
    let many = a[0].len();
    let [p, q] = a.map(|a| &a[..many]);
    let [e, f, g, h] = b.map(|b| &b[..many]);
    // A copy is kept in registers.
    let mut own = *sums;
    for k in 0..many {
        let (rows, factors) = ([&p[k], &q[k]], [e[k], f[k], g[k], h[k]]);
        for i in 0..2 {
            for c in 0..WIDE {
                for l in 0..LANES {
                    own[i][c][l] = rows[i][l].mul_add(factors[c], own[i][c][l]);
                }
            }
        }
    }
    *sums = own;
}

/// Sum of products, in an order that no instruction set changes.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; TALL];
    for (x, y) in a.chunks_exact(TALL).zip(b.chunks_exact(TALL)) {
        for l in 0..TALL {
            sums[l] += x[l] * y[l];
        }
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_residual_is_orthogonal_to_the_columns() {
        for [rows, unknowns] in [[90, 70], [300, 33], [20, 5]] {
            let entry =
                |i: usize, k: usize| libm::sin((1 + i * (k + 3) + k * k * i * i % 7) as f64);
            let mut matrix = Columns::new(rows, unknowns);
            for k in 0..=unknowns {
                matrix.column(k).iter_mut().enumerate().for_each(|(i, x)| *x = entry(i, k));
            }
            let x = matrix.solve();
            let residual: Vec<f64> = (0..rows)
                .map(|i| {
                    entry(i, unknowns) - (0..unknowns).map(|k| entry(i, k) * x[k]).sum::<f64>()
                })
                .collect();
            for k in 0..unknowns {
                let product: f64 = residual.iter().enumerate().map(|(i, r)| r * entry(i, k)).sum();
                assert!(product.abs() < 1e-12, "{rows} {unknowns} {k}: {product}");
            }
        }
    }
}
