//! Numbers and times as people read them.

use std::time::Duration;

/// Returns a time in a unit that fits, with two digits or more.
pub(super) fn brief(time: Duration) -> String {
    let (number, unit) = match time.as_secs_f64() {
        s if s < 0.995e-3 => (1e6 * s, "µs"),
        s if s < 0.995 => (1e3 * s, "ms"),
        s if s < 99.5 => (s, "s"),
        s if s < 5970.0 => return format!("{:.0} min", s / 60.0),
        s => return format!("{:.0} h", s / 3600.0),
    };
    let decimals = usize::from(number < 9.95);
    format!("{number:.decimals$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_a_unit_that_fits() {
        let seconds =
            [9e-7, 4.2e-5, 0.9996e-3, 0.04, 0.999, 9.94, 9.96, 99.0, 100.0, 5940.0, 7200.0];
        let texts = seconds.map(|s| brief(Duration::from_secs_f64(s)));
        let expected = [
            "0.9 µs", "42 µs", "1.0 ms", "40 ms", "1.0 s", "9.9 s", "10 s", "99 s", "2 min",
            "99 min", "2 h",
        ];
        assert_eq!(texts, expected);
    }
}
