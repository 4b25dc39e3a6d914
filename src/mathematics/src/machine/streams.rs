//! The loop by which the bandwidth of the memory is measured, never inlined: only this package is optimised.

/// Updates an array in place, `a = 0.999 a`: each entry is read and written.
#[inline(never)]
pub fn update(array: &mut [f64]) {
    for a in array {
        *a *= 0.999;
    }
}
