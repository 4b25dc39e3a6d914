//! The machine: vector instructions, threads, memory in large pages, and the loops that measure its bandwidth.

pub(crate) mod extremes;
pub mod memory;
pub(crate) mod simd;
pub mod streams;
pub(crate) mod sums;
pub(crate) mod threads;
