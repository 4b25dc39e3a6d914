//! The memory bandwidth of the machine.

use crate::discrete::streams;
use crate::timing::recorded::Bandwidth;
use std::hint::black_box;
use std::time::Instant;

/// Measures the bandwidth of the memory with arrays of `entries` doubles, one thread: the best of some
/// runs, since what disturbs only ever slows down.
pub(crate) fn bandwidth(entries: usize, runs: usize) -> Bandwidth {
    let (mut a, b, c) = (vec![0.0; entries], vec![1.0; entries], vec![2.0; entries]);
    let rate = |bytes: f64, seconds: f64| 1e-9 * bytes * entries as f64 / seconds;
    let (mut triad, mut update) = (0.0_f64, 0.0_f64);
    for _ in 0..runs {
        let start = Instant::now();
        streams::triad(&mut a, &b, &c);
        triad = triad.max(rate(24.0, start.elapsed().as_secs_f64()));
        black_box(&mut a);
        let start = Instant::now();
        streams::update(&mut a);
        update = update.max(rate(16.0, start.elapsed().as_secs_f64()));
        black_box(&mut a);
    }
    Bandwidth { megabytes: 8e-6 * entries as f64, triad, update }
}
