//! Memory bandwidth of the machine.

use signorini_mathematics::machine::streams;
use std::hint::black_box;
use std::time::Instant;

/// Measures the bandwidth in GB/s with which one thread updates an array of `entries` doubles in place: the best of
/// some runs, because other programs can only make a run slower.
pub(crate) fn bandwidth(entries: usize, runs: usize) -> f64 {
    let (mut a, mut fastest) = (vec![0.0; entries], f64::INFINITY);
    for _ in 0..runs {
        let start = Instant::now();
        streams::update(&mut a);
        fastest = fastest.min(start.elapsed().as_secs_f64());
        black_box(&mut a);
    }
    // Each entry is read and written.
    2.0 * 8e-9 * entries as f64 / fastest
}
