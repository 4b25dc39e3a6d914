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
