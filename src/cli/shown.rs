//! Numbers and times as people read them.

use std::time::Duration;

/// Returns a number with so many significant digits, without an exponent from 1e-3 to 1e5.
pub(super) fn plain(number: f64, digits: usize) -> String {
    if number == 0.0 {
        return "0".into();
    }
    let last = digits - 1;
    let scientific = format!("{number:.last$e}");
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse().ok());
    match exponent {
        Some(exponent @ -3..=4) => {
            let decimals = (last as i32 - exponent).max(0) as usize;
            format!("{number:.decimals$}")
        }
        _ => scientific,
    }
}

/// As [`plain`], with a plus before a positive number.
pub(super) fn signed(number: f64, digits: usize) -> String {
    let sign = if number > 0.0 { "+" } else { "" };
    format!("{sign}{}", plain(number, digits))
}

/// Returns the ends of an interval with the digits that tell them apart, rounded outwards.
pub(super) fn interval([low, high]: [f64; 2]) -> String {
    /// Digits beyond those in which the ends agree.
    const MORE: f64 = 2.0;
    let size = low.abs().max(high.abs());
    let agree = -libm::log10((high - low) / size);
    // Without a width, or with ends that are no numbers, all digits are shown.
    let digits = if agree.is_finite() { (agree + MORE).ceil().clamp(3.0, 16.0) } else { 16.0 };
    let outwards = |end: f64, sign: f64| {
        let text = plain(end, digits as usize);
        let shown: f64 = text.parse().unwrap_or(end);
        if sign * (shown - end) >= 0.0 {
            return text;
        }
        let unit = libm::exp10(libm::log10(end.abs()).floor() + 1.0 - digits);
        plain(end + sign * unit, digits as usize)
    };
    format!("[{}, {}]", outwards(low, -1.0), outwards(high, 1.0))
}

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
    fn numbers_have_no_exponent_where_none_is_needed() {
        let shown = [1.02146, -5.0, 0.0, -0.0, 1e-3, 9.99e-4, 99999.0, 99999.6, 1e5, -0.125]
            .map(|number| plain(number, 5));
        let expected = [
            "1.0215",
            "-5.0000",
            "0",
            "0",
            "0.0010000",
            "9.9900e-4",
            "99999",
            "1.0000e5",
            "1.0000e5",
            "-0.12500",
        ];
        assert_eq!(shown, expected);
        assert_eq!(["+0.50", "-0.50", "0"], [0.5, -0.5, -0.0].map(|number| signed(number, 2)));
    }

    #[test]
    fn an_interval_as_shown_contains_the_interval() {
        assert_eq!(interval([-0.0528253904, -0.0528241168]), "[-0.05282540, -0.05282411]");
        let ends = [-9.5e-7, -0.911685, -0.1, 1.0 / 3.0, 0.7, 9.99999, 12345.678];
        for low in ends {
            for width in [0.0, 1e-12, 3.7e-6, 0.0123, 4.0] {
                let (low, high) = (low, low + width);
                let shown = interval([low, high]);
                let inner = shown.trim_matches(['[', ']']);
                let (from, to) = inner.split_once(", ").unwrap();
                let [from, to]: [f64; 2] = [from, to].map(|end| end.parse().unwrap());
                assert!(from <= low && high <= to, "{shown}: {low:e} {high:e}");
                assert!(to - from <= 1.5 * width + 1e-14 * low.abs(), "{shown}: {low:e} {high:e}");
            }
        }
    }

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
