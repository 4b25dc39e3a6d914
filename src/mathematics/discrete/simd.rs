//! Loops compiled for the vector instructions that the processor has.

/// Does the work with the widest vectors that the processor has; the bits are the same with all of them.
///
/// Only what is inlined here is compiled for them: the closure, and what it calls, want `#[inline(always)]`.
#[inline(always)]
pub(crate) fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        // DQ extends F.
        if std::arch::is_x86_feature_detected!("avx512dq") {
            // SAFETY: the processor has the features that the function is compiled for.
            return unsafe { avx512(work) };
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { avx2(work) };
        }
    }
    work()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq")]
fn avx512<R>(work: impl FnOnce() -> R) -> R {
    work()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn avx2<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Numbers that are compared side by side: too many for the compiler to write out one by one, after which it would
/// gather those of several blocks in one vector.
pub(crate) const LANES: usize = 64;

/// The largest absolute value of many rows, NaN if a number is; kept in independent lanes so that it vectorises.
///
/// As integers the bits of absolute values have the order of the numbers, and those of NaN come last.
#[derive(Clone, Copy)]
pub(crate) struct Largest([i64; LANES]);

impl Default for Largest {
    fn default() -> Self {
        Self([0; LANES])
    }
}

impl Largest {
    /// Takes `factor` times each number into account.
    #[inline(always)]
    pub(crate) fn see(&mut self, factor: f64, x: &[f64]) {
        for block in x.chunks(LANES) {
            for (largest, value) in self.0.iter_mut().zip(block) {
                *largest = ((factor * value).abs().to_bits() as i64).max(*largest);
            }
        }
    }

    /// Takes a number into account.
    #[inline(always)]
    pub(crate) fn put(&mut self, value: f64) {
        self.0[0] = self.0[0].max(value.abs().to_bits() as i64);
    }

    /// The largest; 0 if there was no number.
    #[inline(always)]
    pub(crate) fn value(self) -> f64 {
        f64::from_bits(self.0.into_iter().fold(0, i64::max) as u64)
    }
}

/// The results of the same work without vector instructions and with each kind that the processor has.
#[cfg(test)]
pub(crate) fn with_each<R>(work: impl Fn() -> R) -> Vec<R> {
    let mut results = vec![work()];
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has the features that the function is compiled for.
            results.push(unsafe { avx2(&work) });
        }
        if std::arch::is_x86_feature_detected!("avx512dq") {
            // SAFETY: as above.
            results.push(unsafe { avx512(&work) });
        }
    }
    results
}
