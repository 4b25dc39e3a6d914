//! Linear least squares by Householder's reflections, blocked: Schreiber and Van Loan, *A storage-efficient WY
//! representation for products of Householder transformations*, SIAM J. Sci. Stat. Comput. 10 (1989).

use crate::machine::simd::vectorised;

/// Reflections that are applied together.
const BLOCK: usize = 32;
/// Numbers side by side in a loop.
const LANES: usize = 8;
/// Columns that are taken together.
const WIDE: usize = 4;
/// Size of the multiple of the identity below the columns, which have norm 1: it keeps the coefficients small where
/// columns depend on each other.
const RIDGE: f64 = 1e-15;

/// Matrix by columns, the last of which is the right-hand side, with room for a multiple of the identity below.
pub(super) struct Columns {
    /// Rows without those of the identity.
    pub rows: usize,
    /// Unknowns.
    pub unknowns: usize,
    /// Rows of storage: a multiple of [`LANES`].
    height: usize,
    entries: Vec<f64>,
}

impl Columns {
    /// Zeros.
    pub(super) fn new(rows: usize, unknowns: usize) -> Self {
        let height = (rows + unknowns).next_multiple_of(LANES);
        Self { rows, unknowns, height, entries: vec![0.0; height * (unknowns + 1)] }
    }

    /// Column by its number, without the rows of the identity.
    pub(super) fn column(&mut self, k: usize) -> &mut [f64] {
        let from = k * self.height;
        &mut self.entries[from..from + self.rows]
    }

    /// Coefficients of the columns whose sum is nearest to the right-hand side; destroys the matrix.
    pub(super) fn solve(mut self) -> Vec<f64> {
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
        let mut from = 0;
        while from < many {
            let to = (from + BLOCK).min(many);
            // Below, the identity is not yet touched.
            let limit = (rows + to).next_multiple_of(LANES);
            vectorised(
                #[inline(always)]
                || reflect(&mut self.entries, height, [from, to], limit),
            );
            from = to;
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

/// Reflects a block of columns to triangular form, and all that follow with it. Rows from `limit` on are zero in the
/// block.
#[inline(always)]
fn reflect(entries: &mut [f64], height: usize, [from, to]: [usize; 2], limit: usize) {
    let many = to - from;
    // Rows above the block are left alone, but for those that fill the first lanes.
    let top = from / LANES * LANES;
    let tall = limit - top;
    let mut v = vec![0.0; tall * many.next_multiple_of(WIDE)];
    let mut t = [[0.0; BLOCK]; BLOCK];
    for j in 0..many {
        let (pivot, after) = entries[(from + j) * height + top..].split_at_mut(height);
        let column = &mut pivot[..tall];
        let own = &mut v[j * tall..(j + 1) * tall];
        let first = from + j - top;
        own[first..].copy_from_slice(&column[first..]);
        let norm = dot(own, own).sqrt();
        let size = if own[first] > 0.0 { -norm } else { norm };
        let head = own[first] - size;
        // A column of zeros cannot be: the identity is below.
        let scale = 1.0 / head;
        own.iter_mut().for_each(|x| *x *= scale);
        own[first] = 1.0;
        let tau = -head / size;
        column[first..].fill(0.0);
        column[first] = size;
        for k in 0..many - 1 - j {
            let other = &mut after[k * height..k * height + tall];
            let factor = tau * dot(own, other);
            other.iter_mut().zip(own.iter()).for_each(|(x, v)| *x -= factor * v);
        }
        // The product of the reflections is I - V T V'.
        let mut products = [0.0; BLOCK];
        for k in 0..j {
            products[k] = dot(&v[k * tall..(k + 1) * tall], &v[j * tall..(j + 1) * tall]);
        }
        for (i, row) in t[..j].iter_mut().enumerate() {
            let sum: f64 =
                row[i..j].iter().zip(&products[i..j]).map(|(t, product)| t * product).sum();
            row[j] = -tau * sum;
        }
        t[j][j] = tau;
    }
    for columns in entries[to * height..].chunks_mut(WIDE * height) {
        apply(&v, &t, tall, many, Trailing { columns, height, top });
    }
}

/// Columns to which reflections are applied.
struct Trailing<'a> {
    columns: &'a mut [f64],
    height: usize,
    top: usize,
}

/// Applies the transposed product of reflections `I - V T' V'` to up to [`WIDE`] columns.
#[inline(always)]
fn apply(v: &[f64], t: &[[f64; BLOCK]; BLOCK], tall: usize, many: usize, trailing: Trailing) {
    let Trailing { columns, height, top } = trailing;
    let mut w = [[0.0; WIDE]; BLOCK];
    let wide = columns.len() / height;
    let start = |c: usize| c.min(wide - 1) * height + top;
    let others = [0, 1, 2, 3].map(|c| &columns[start(c)..start(c) + tall]);
    for (k, w) in w[..many].iter_mut().enumerate() {
        *w = products(&v[k * tall..(k + 1) * tall], others);
    }
    let mut tw = [[0.0; WIDE]; BLOCK];
    for i in 0..many {
        for k in 0..=i {
            for c in 0..WIDE {
                tw[i][c] += t[k][i] * w[k][c];
            }
        }
    }
    for group in (0..many).step_by(WIDE) {
        let own = [0, 1, 2, 3].map(|k| &v[(group + k) * tall..(group + k + 1) * tall]);
        for c in 0..wide {
            let factors = [0, 1, 2, 3].map(|k| tw[group + k][c]);
            subtract(&mut columns[c * height + top..c * height + top + tall], own, factors);
        }
    }
}

/// Sum of products.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 2 * LANES];
    for (x, y) in a.chunks_exact(2 * LANES).zip(b.chunks_exact(2 * LANES)) {
        for l in 0..2 * LANES {
            sums[l] += x[l] * y[l];
        }
    }
    let rest = a.len() / (2 * LANES) * (2 * LANES);
    for (l, (x, y)) in a[rest..].iter().zip(&b[rest..]).enumerate() {
        sums[l] += x * y;
    }
    total(&sums)
}

/// Sum of numbers, in an order that no instruction set changes.
#[inline(always)]
fn total(sums: &[f64]) -> f64 {
    let mut total = 0.0;
    for sum in sums {
        total += sum;
    }
    total
}

/// Products of a column with others.
#[inline(always)]
fn products(a: &[f64], [p, q, r, s]: [&[f64]; WIDE]) -> [f64; WIDE] {
    const BOTH: usize = 2 * LANES;
    // Each in a variable of its own, so that it is kept in registers.
    let (mut s0, mut s1, mut s2, mut s3) = ([0.0; BOTH], [0.0; BOTH], [0.0; BOTH], [0.0; BOTH]);
    let whole = a.len() / BOTH * BOTH;
    let mut at = 0;
    while at < whole {
        add_products(&mut s0, &a[at..at + BOTH], &p[at..at + BOTH]);
        add_products(&mut s1, &a[at..at + BOTH], &q[at..at + BOTH]);
        add_products(&mut s2, &a[at..at + BOTH], &r[at..at + BOTH]);
        add_products(&mut s3, &a[at..at + BOTH], &s[at..at + BOTH]);
        at += BOTH;
    }
    for (sums, b) in [(&mut s0, p), (&mut s1, q), (&mut s2, r), (&mut s3, s)] {
        add_products(sums, &a[at..], &b[at..]);
    }
    [total(&s0), total(&s1), total(&s2), total(&s3)]
}

/// Adds products, side by side.
#[inline(always)]
fn add_products(sums: &mut [f64], a: &[f64], b: &[f64]) {
    for ((sum, x), y) in sums.iter_mut().zip(a).zip(b) {
        *sum += x * y;
    }
}

/// Subtracts multiples of columns.
#[inline(always)]
fn subtract(from: &mut [f64], [a, b, c, d]: [&[f64]; WIDE], [e, f, g, h]: [f64; WIDE]) {
    let many = from.len();
    let (a, b, c, d) = (&a[..many], &b[..many], &c[..many], &d[..many]);
    for i in 0..many {
        from[i] -= (a[i] * e + b[i] * f) + (c[i] * g + d[i] * h);
    }
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
