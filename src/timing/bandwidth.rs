//! Memory bandwidth of the machine.

use signorini_mathematics::experiments::timed::TimedPlan;
use std::hint::black_box;
use std::time::Instant;

/// Measures the bandwidth in GB/s with which one thread updates an array in place: the best of some runs, because other
/// programs can only make a run slower.
pub(crate) fn bandwidth(timed: &TimedPlan, runs: usize) -> f64 {
    let (mut stream, mut fastest) = (timed.stream(), f64::INFINITY);
    for _ in 0..runs {
        let start = Instant::now();
        stream.update();
        fastest = fastest.min(start.elapsed().as_secs_f64());
        black_box(&mut stream);
    }
    1e-9 * stream.bytes() / fastest
}
