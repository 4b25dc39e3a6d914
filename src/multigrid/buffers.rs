//! What passes over the grids work with beside the grids themselves.

/// Numbers along one coarse row.
pub struct Sums {
    /// Sums over rows of the finer grid, at even and at odd columns.
    pub(super) even: Vec<f64>,
    pub(super) odd: Vec<f64>,
    /// The coarse row.
    pub(super) row: Vec<f64>,
}

impl Sums {
    pub(super) fn new(coarse_n: usize) -> Self {
        let nodes = || vec![0.0; coarse_n + 1];
        Self { even: nodes(), odd: nodes(), row: nodes() }
    }
}

/// What a pass over one block of slabs needs beside the grids.
pub(super) struct Buffers {
    /// Residuals of the last three slabs of red nodes, slab `s` in place `s % 3`.
    pub(super) residuals: [Vec<f64>; 3],
    pub(super) sums: Sums,
}

impl Buffers {
    /// For `n` cells in a row and slabs of so many places.
    pub(super) fn new(n: usize, slab: usize) -> Self {
        let residuals = [(); 3].map(|()| vec![0.0; slab]);
        Self { residuals, sums: Sums::new(n / 2) }
    }

    pub(super) fn bytes(&self) -> usize {
        let Sums { even, odd, row } = &self.sums;
        let all = self.residuals.iter().chain([even, odd, row]);
        all.map(|numbers| size_of_val(&numbers[..])).sum()
    }
}
