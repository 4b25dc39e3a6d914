//! Arithmetics that round the operations of the iteration in other ways.

use crate::experiments::numbers::RandomNumbers;
use crate::saddle::batch::{Arithmetic, LANES, V};
use std::array::from_fn;

/// All sums from the other end.
pub(super) struct Reversed;

impl Arithmetic for Reversed {
    #[inline(always)]
    fn star(&mut self, [load, east, north, south, west]: [V; 5]) -> V {
        (((west + south) + north) + east) + load
    }
    #[inline(always)]
    fn edge(&mut self, [load, first, second, third]: [V; 4]) -> V {
        ((third + second) + first) + load
    }
}

/// A product and the sum it enters rounded together, as compilers may.
pub(super) struct Fused;

impl Arithmetic for Fused {
    #[inline(always)]
    fn step(&mut self, a: f64, r: f64, y: f64) -> f64 {
        libm::fma(-r, y, a)
    }
}

/// Random relative errors of at most `size`.
#[derive(Clone, Copy)]
pub(super) struct Noise {
    pub(super) size: f64,
    pub(super) random: RandomNumbers,
}

/// Returns `value`, off by a random relative error of at most `size`.
#[inline(always)]
pub(super) fn perturbed(value: f64, size: f64, random: &mut RandomNumbers) -> f64 {
    value + value * (size * (2.0 * random.unit() - 1.0))
}

/// Arithmetic in which the value of each node is off by a random relative error, whose largest size belongs to the run.
pub(super) struct Noisy {
    size: [f64; LANES],
    random: [RandomNumbers; LANES],
    /// Errors of all runs; those of a run in a lane are out of date.
    runs: Vec<Noise>,
}

impl Noisy {
    pub(super) fn new(runs: Vec<Noise>) -> Self {
        Self { size: [0.0; LANES], random: [RandomNumbers::new(0, 0); LANES], runs }
    }
}

impl Arithmetic for Noisy {
    #[inline(always)]
    fn node(&mut self, y: V) -> V {
        V(from_fn(
            #[inline(always)]
            |l| perturbed(y.0[l], self.size[l], &mut self.random[l]),
        ))
    }
    fn enter(&mut self, lane: usize, run: usize) {
        let Noise { size, random } = self.runs[run];
        (self.size[lane], self.random[lane]) = (size, random);
    }
    fn leave(&mut self, lane: usize, run: usize) {
        self.runs[run].random = self.random[lane];
    }
}
