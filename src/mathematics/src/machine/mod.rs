//! The machine: vector instructions, threads, memory in large pages.

pub(crate) mod extremes;
pub mod memory;
pub(crate) mod simd;
pub(crate) mod threads;
