//! Loops by which the bandwidth of the memory is measured, never inlined: only this package is optimised.

/// `a = b + c / 2`, the triad of the STREAM benchmark (McCalpin 1995): 24 bytes per entry.
#[inline(never)]
pub fn triad(a: &mut [f64], b: &[f64], c: &[f64]) {
    for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
        *a = b + 0.5 * c;
    }
}

/// `a = 0.999 a`: 16 bytes per entry.
#[inline(never)]
pub fn update(a: &mut [f64]) {
    for a in a {
        *a *= 0.999;
    }
}
