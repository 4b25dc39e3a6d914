//! The loop by which the bandwidth of the memory is measured, never inlined: only this package is optimised.

/// Array in memory that is updated in place.
pub struct MemoryStream(Vec<f64>);

impl MemoryStream {
    /// Array of so many zeros.
    pub fn new(entries: usize) -> Self {
        Self(vec![0.0; entries])
    }

    /// `a = 0.999 a`.
    #[inline(never)]
    pub fn update(&mut self) {
        for a in &mut self.0 {
            *a *= 0.999;
        }
    }

    /// Bytes that an update moves: each entry is read and written.
    pub fn bytes(&self) -> f64 {
        16.0 * self.0.len() as f64
    }
}
