//! Scratch memory of a pass over a block of rows.

use super::rows::stride;

/// Scratch memory of a pass over one block of rows.
pub(super) struct Buffers {
    /// Residuals of the last three rows of red nodes; row `j` is at index `j % 3`.
    pub(super) residuals: [Vec<f64>; 3],
    /// Sums over coarse rows, at even columns.
    pub(super) even: Vec<f64>,
    /// Sums over coarse rows, at odd columns.
    pub(super) odd: Vec<f64>,
    /// A coarse row in natural order.
    pub(super) row: Vec<f64>,
}

impl Buffers {
    /// Allocates buffers for a grid with `n` cells per side.
    pub(super) fn new(n: usize) -> Self {
        let residuals = [(); 3].map(|()| vec![0.0; stride(n)]);
        let [even, odd, row] = [(); 3].map(|()| vec![0.0; n / 2 + 1]);
        Self { residuals, even, odd, row }
    }

    /// Memory in bytes.
    pub(super) fn bytes(&self) -> usize {
        let all = self.residuals.iter().chain([&self.even, &self.odd, &self.row]);
        all.map(|numbers| size_of_val(&numbers[..])).sum()
    }
}
