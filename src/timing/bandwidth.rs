//! Memory bandwidth of the machine.

use crate::timing::recorded::Bandwidth;
use signorini_mathematics::machine::streams;
use std::hint::black_box;
use std::time::Instant;

/// Measures the bandwidth of the memory with arrays of `entries` doubles, one thread: the best of some runs, because
/// other programs can only make a run slower.
pub(crate) fn bandwidth(entries: usize, runs: usize) -> Bandwidth {
    let (mut a, b, c) = (vec![0.0; entries], vec![1.0; entries], vec![2.0; entries]);
    let (mut triad, mut update) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..runs {
        let start = Instant::now();
        streams::triad(&mut a, &b, &c);
        triad = triad.min(start.elapsed().as_secs_f64());
        black_box(&mut a);
        let start = Instant::now();
        streams::update(&mut a);
        update = update.min(start.elapsed().as_secs_f64());
        black_box(&mut a);
    }
    let gigabytes = 8e-9 * entries as f64;
    // A store counts once: the triad moves three arrays, the update two.
    let [triad, update] = [3.0 * gigabytes / triad, 2.0 * gigabytes / update];
    Bandwidth { megabytes: 8e-6 * entries as f64, triad, update }
}
