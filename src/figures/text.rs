//! Numbers as readers expect them: no stray digits, true minus signs, round tick values.

/// `value` with `decimals` digits after the point, a true minus sign, and no negative zero.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.into(),
        Some(digits) => format!("\u{2212}{digits}"),
        None => text,
    }
}

/// `value` to at most four decimals, trailing zeros dropped.
pub(super) fn short(value: f64) -> String {
    const DECIMALS: usize = 4;
    if value != 0.0 && value.abs() < 0.5e-4 {
        return scientific(value);
    }
    let text = fixed(value, DECIMALS);
    text.trim_end_matches('0').trim_end_matches('.').into()
}

/// `10` to the power `exponent`, in superscript digits.
pub(super) fn power_of_ten(exponent: i32) -> String {
    let text = exponent.to_string();
    let digits = text.chars().map(|c| match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        digit => char::from_u32(0x2070 + u32::from(digit) - u32::from('0')).unwrap_or(digit),
    });
    format!("10{}", digits.collect::<String>())
}

fn scientific(value: f64) -> String {
    let text = format!("{value:.1e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = mantissa.trim_end_matches(".0").replace('-', "\u{2212}");
    format!("{mantissa}\u{b7}{}", power_of_ten(exponent.parse().unwrap_or(0)))
}

/// Round values to mark an axis with, and how to write them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    step: f64,
    decimals: usize,
    multiples: std::ops::RangeInclusive<i64>,
}

impl Ticks {
    /// Multiples of 1, 2 or 5 times a power of ten inside [lo, hi], at most `most` steps of them.
    pub(super) fn inside(lo: f64, hi: f64, most: usize) -> Self {
        let span = if hi > lo { hi - lo } else { 1.0 };
        let want = span / most.max(1) as f64;
        let slack = 1e-9;
        let power = libm::floor(libm::log10(want)) as i32;
        // Parsed, not multiplied up, so that every step is a shortest decimal.
        let step = |(mantissa, exponent): (u8, i32)| -> f64 {
            format!("{mantissa}e{exponent}").parse().unwrap_or(1.0)
        };
        let nice = [(1, power), (2, power), (5, power), (1, power + 1)];
        let nice = nice.into_iter().find(|&nice| step(nice) >= want * (1.0 - slack));
        let nice = nice.unwrap_or((1, power + 1));
        let (step, decimals) = (step(nice), usize::try_from(-nice.1).unwrap_or(0));
        let first = (lo / step - slack).ceil() as i64;
        let last = (hi / step + slack).floor() as i64;
        Self { step, decimals, multiples: first..=last }
    }

    pub(super) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.multiples.clone().map(|k| k as f64 * self.step)
    }

    pub(super) fn labelled(&self) -> impl Iterator<Item = (f64, String)> + '_ {
        self.values().map(|value| {
            // Rounding noise in k * step ends here: the text has as many decimals as the step.
            let text =
                if self.decimals > 4 { scientific(value) } else { fixed(value, self.decimals) };
            (value, if value == 0.0 { "0".into() } else { text })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_stray_digits_and_true_minus_signs() {
        assert_eq!(short(0.1 + 0.2), "0.3");
        assert_eq!(short(-1.006), "\u{2212}1.006");
        assert_eq!(short(-6.70), "\u{2212}6.7");
        assert_eq!(short(30.0), "30");
        assert_eq!(short(-0.0), "0");
        assert_eq!(short(2e-5), "2\u{b7}10\u{207b}\u{2075}");
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(power_of_ten(-12), "10\u{207b}\u{b9}\u{b2}");
        assert_eq!(power_of_ten(6), "10\u{2076}");
    }

    #[test]
    fn ticks_are_round_and_cover_what_they_say() {
        let texts = |ticks: Ticks| ticks.labelled().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(
            texts(Ticks::inside(-0.31, 0.3, 6)),
            ["\u{2212}0.2", "0", "0.2"].map(String::from)
        );
        assert_eq!(texts(Ticks::inside(0.0, 0.3, 3)), ["0", "0.1", "0.2", "0.3"].map(String::from));
        assert_eq!(texts(Ticks::inside(0.0, 0.0, 5)), ["0"].map(String::from));
        assert_eq!(texts(Ticks::inside(0.0, 200.0, 4)).last().unwrap(), "200");
    }
}
