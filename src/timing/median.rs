//! Median of the times of equal runs.

use std::time::Instant;

/// Seconds that the runs of one median take together at most, once there are three.
const BUDGET: f64 = 2.0;
/// A measurement shorter than this repeats the run until it is as long.
const SHORTEST: f64 = 1e-3;

/// Median of some times.
pub(crate) struct MedianTime {
    pub(crate) seconds: f64,
    /// Distance of the quartiles over the median.
    pub(crate) spread: f64,
}

/// Times `run`, after one run that does not count.
pub(crate) fn time(repeats: usize, mut run: impl FnMut()) -> MedianTime {
    let first = seconds_per_run(1, &mut run);
    let times = ((SHORTEST / first).ceil() as usize).max(1);
    let mut seconds = Vec::new();
    while seconds.len() < repeats && (seconds.len() < 3 || seconds.iter().sum::<f64>() < BUDGET) {
        seconds.push(seconds_per_run(times, &mut run));
    }
    seconds.sort_by(f64::total_cmp);
    let [first, median, third] = [1, 2, 3].map(|k| seconds[k * (seconds.len() - 1) / 4]);
    MedianTime { seconds: median, spread: (third - first) / median }
}

/// Returns the mean time of a number of runs.
fn seconds_per_run(times: usize, run: &mut impl FnMut()) -> f64 {
    let start = Instant::now();
    for _ in 0..times {
        run();
    }
    start.elapsed().as_secs_f64() / times as f64
}
