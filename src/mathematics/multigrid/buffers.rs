//! What passes over the grids work with beside the grids themselves.

/// What a pass over one block of slabs needs beside the grids.
pub(super) struct Buffers {
    /// Residuals of the last three slabs of red nodes, slab `s` in place `s % 3`.
    pub(super) residuals: [Vec<f64>; 3],
    /// Sums over coarse rows, at even and at odd columns.
    pub(super) even: Vec<f64>,
    pub(super) odd: Vec<f64>,
    /// A coarse row in natural order.
    pub(super) row: Vec<f64>,
}

impl Buffers {
    /// For `n` cells in a row and slabs of so many places.
    pub(super) fn new(n: usize, slab: usize) -> Self {
        let residuals = [(); 3].map(|()| vec![0.0; slab]);
        let [even, odd, row] = [(); 3].map(|()| vec![0.0; n / 2 + 1]);
        Self { residuals, even, odd, row }
    }

    pub(super) fn bytes(&self) -> usize {
        let all = self.residuals.iter().chain([&self.even, &self.odd, &self.row]);
        all.map(|numbers| size_of_val(&numbers[..])).sum()
    }
}
