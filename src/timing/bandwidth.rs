//! The machine that times were measured on: its processor, system, caches and memory bandwidth.

use crate::timing::machine;
use crate::timing::recorded::{Bandwidth, Machine};
use std::fs;
use std::hint::black_box;
use std::time::Instant;

impl Machine {
    /// Asks the system; what it does not tell is called unknown.
    pub(crate) fn here(repeats: usize) -> Self {
        let unknown = || "unknown".to_owned();
        let load = fs::read_to_string("/proc/loadavg").ok();
        let load = load.and_then(|text| text.split(' ').next()?.parse().ok());
        Self {
            cpu: machine::processor(),
            cores: machine::cores(),
            caches: caches().unwrap_or_else(unknown),
            os: format!(
                "{} {} {}",
                std::env::consts::OS,
                machine::kernel(),
                std::env::consts::ARCH
            ),
            rustc: machine::COMPILER.into(),
            load: load.unwrap_or(0.0),
            repeats,
        }
    }
}

/// `L1d 48K, L2 2048K, L3 ...`, as the first core sees them.
fn caches() -> Option<String> {
    let mut found = Vec::new();
    for index in 0..8 {
        let read = |what: &str| {
            let path = format!("/sys/devices/system/cpu/cpu0/cache/index{index}/{what}");
            fs::read_to_string(path).map(|text| text.trim().to_owned()).ok()
        };
        let (Some(level), Some(kind), Some(size)) = (read("level"), read("type"), read("size"))
        else {
            break;
        };
        match kind.as_str() {
            "Instruction" => {}
            "Data" => found.push(format!("L{level}d {size}")),
            _ => found.push(format!("L{level} {size}")),
        }
    }
    (!found.is_empty()).then(|| found.join(", "))
}

/// Measures the bandwidth of the memory with arrays of `entries` doubles, one thread: the best of some
/// runs, since what disturbs only ever slows down.
pub(crate) fn bandwidth(entries: usize, runs: usize) -> Bandwidth {
    let (mut a, b, c) = (vec![0.0; entries], vec![1.0; entries], vec![2.0; entries]);
    let rate = |bytes: f64, seconds: f64| 1e-9 * bytes * entries as f64 / seconds;
    let (mut triad, mut update) = (0.0_f64, 0.0_f64);
    for _ in 0..runs {
        let start = Instant::now();
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + 0.5 * c;
        }
        triad = triad.max(rate(24.0, start.elapsed().as_secs_f64()));
        black_box(&mut a);
        let start = Instant::now();
        for a in &mut a {
            *a *= 0.999;
        }
        update = update.max(rate(16.0, start.elapsed().as_secs_f64()));
        black_box(&mut a);
    }
    Bandwidth { megabytes: 8e-6 * entries as f64, triad, update }
}
