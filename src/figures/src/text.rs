//! Text of numbers: no stray digits, true minus signs, round tick values.

/// Returns `value` with `decimals` digits after the point, a true minus sign, and no negative zero.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.into(),
        Some(digits) => format!("\u{2212}{digits}"),
        None => text,
    }
}

/// Numbers at least this large are written with a power of ten.
const LARGE: f64 = 1e6;

/// Returns `value` to at most four decimals, trailing zeros dropped; with a power of ten if it is very small or large.
pub(super) fn short(value: f64) -> String {
    const DECIMALS: usize = 4;
    if value != 0.0 && !(0.5e-4..LARGE).contains(&value.abs()) {
        return scientific(value, DECIMALS);
    }
    without_zeros(&fixed(value, DECIMALS)).into()
}

/// Returns the width of a number in a wide sans-serif font, over the size of the font; fonts are not measured.
pub(super) fn number_width(number: &str) -> f64 {
    number.chars().map(character_width).sum()
}

fn character_width(character: char) -> f64 {
    match character {
        '.' | '\u{b7}' => 0.32,
        '\u{2212}' => 0.84,
        '\u{207b}' => 0.53,
        '\u{b9}' | '\u{b2}' | '\u{b3}' | '\u{2070}'..='\u{2079}' => 0.41,
        _ => 0.64,
    }
}

/// Returns a decimal without the zeros that end its fraction.
pub(super) fn without_zeros(decimal: &str) -> &str {
    match decimal.contains('.') {
        true => decimal.trim_end_matches('0').trim_end_matches('.'),
        false => decimal,
    }
}

/// Returns `10` to the power `exponent`, in superscript digits.
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

/// Returns `value` as a number from 1 to 10, to at most `decimals` decimals, times a power of ten.
fn scientific(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa = without_zeros(mantissa).replace('-', "\u{2212}");
    format!("{mantissa}\u{b7}{}", power_of_ten(exponent.parse().unwrap_or(0)))
}

/// Round values that are marked on an axis, with their text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    step: f64,
    /// Exponent of the power of ten in the step.
    power: i32,
    multiples: std::ops::RangeInclusive<i64>,
}

impl Ticks {
    /// Returns the multiples of 1, 2 or 5 times a power of ten inside [lo, hi], at most `most` steps of them.
    pub(super) fn inside(lo: f64, hi: f64, most: usize) -> Self {
        let most = most.max(1) as f64;
        let span = if hi > lo { hi - lo } else { 1.0 };
        let want = span / most;
        let slack = 1e-9;
        let mut power = libm::floor(libm::log10(want)) as i32;
        let [one, two, five] = [1, 2, 5].map(|digit| decimal(digit, power));
        let enough = want * (1.0 - slack);
        let step = match [one, two, five].into_iter().find(|&step| step >= enough) {
            Some(step) => step,
            None => {
                power += 1;
                decimal(1, power)
            }
        };
        let first = (lo / step - slack).ceil() as i64;
        let last = (hi / step + slack).floor() as i64;
        Self { step, power, multiples: first..=last }
    }

    pub(super) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        self.multiples.clone().map(|k| k as f64 * self.step)
    }

    /// Returns the values with their texts.
    pub(super) fn labelled(&self) -> Vec<(f64, String)> {
        let decimals = usize::try_from(-self.power).unwrap_or(0);
        let plain = decimals <= 4 && self.values().all(|value| value.abs() < LARGE);
        let labels = self.values().map(|value| {
            let label = match plain {
                _ if value == 0.0 => "0".into(),
                // The text has as many decimals as the step: the rounding error of k * step is not printed.
                true => fixed(value, decimals),
                false => {
                    let power = libm::floor(libm::log10(value.abs())) as i32;
                    scientific(value, usize::try_from(power - self.power).unwrap_or(0))
                }
            };
            (value, label)
        });
        labels.collect()
    }

    /// Width of the longest label, over the size of its font.
    pub(super) fn widest(&self) -> f64 {
        self.labelled().iter().map(|(_, label)| number_width(label)).fold(0.0, f64::max)
    }
}

/// Returns the double nearest to `digit` times a power of ten: a product would have a rounding error.
fn decimal(digit: u8, power: i32) -> f64 {
    format!("{digit}e{power}").parse().unwrap_or(1.0)
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
        assert_eq!(short(999_999.0), "999999");
        assert_eq!(short(-1.5e6), "\u{2212}1.5\u{b7}10\u{2076}");
        assert_eq!(short(12_345_678.0), "1.2346\u{b7}10\u{2077}");
        assert_eq!(short(1e300), "1\u{b7}10\u{b3}\u{2070}\u{2070}");
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(power_of_ten(-12), "10\u{207b}\u{b9}\u{b2}");
        assert_eq!(power_of_ten(6), "10\u{2076}");
    }

    #[test]
    fn ticks_are_round_and_cover_what_they_say() {
        assert_eq!(labels(-0.31, 0.3, 6), ["\u{2212}0.2", "0", "0.2"]);
        assert_eq!(labels(0.0, 0.3, 3), ["0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels(0.0, 0.0, 5), ["0"]);
        assert_eq!(labels(0.0, 200.0, 4).last().unwrap(), "200");
        assert_eq!(
            labels(-5e5, 1e6, 3),
            ["\u{2212}5\u{b7}10\u{2075}", "0", "5\u{b7}10\u{2075}", "1\u{b7}10\u{2076}"]
        );
        // Labels of neighbours differ.
        let close = labels(1.2e-7, 1.24e-7, 4);
        assert_eq!(close[1], "1.21\u{b7}10\u{207b}\u{2077}", "{close:?}");
    }

    fn labels(lo: f64, hi: f64, most: usize) -> Vec<String> {
        Ticks::inside(lo, hi, most).labelled().into_iter().map(|(_, text)| text).collect()
    }
}
