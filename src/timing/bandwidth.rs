//! Memory bandwidth of the machine.

use signorini_mathematics::experiments::timed::TimedPlan;
use signorini_mathematics::machine::streams::update;
use std::hint::black_box;
use std::time::Instant;

/// Measures the bandwidth in GB/s with which one thread updates an array in place: the best of some runs, because other
/// programs can only make a run slower.
pub(crate) fn bandwidth(timed: &TimedPlan, runs: usize) -> f64 {
    let (mut stream, mut fastest) = (timed.stream(), f64::INFINITY);
    for _ in 0..runs {
        let start = Instant::now();
        update(&mut stream);
        fastest = fastest.min(start.elapsed().as_secs_f64());
        black_box(&mut stream);
    }
    // Each entry is read and written.
    1e-9 * 16.0 * stream.len() as f64 / fastest
}
