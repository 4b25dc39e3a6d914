//! Texts that users give: the characters that they may have, and their numbers.

use std::fmt;
use std::str::FromStr;

/// True if no line of text may have the character: a control character, or one of Unicode's noncharacters.
///
/// XML forbids most of them, even escaped, so that an SVG or VTK file with one cannot be read. Source: Extensible
/// Markup Language (XML) 1.0, fifth edition, production 2; The Unicode Standard, section 23.7.
pub fn is_forbidden(c: char) -> bool {
    let number = u32::from(c);
    c.is_control() || number & 0xFFFE == 0xFFFE || (0xFDD0..=0xFDEF).contains(&number)
}

/// Reads a finite number, or a fraction of two such as `-1/3`.
pub(super) fn number(text: &str) -> Option<f64> {
    let value = match text.split_once('/') {
        Some((above, below)) => decimal(above)? / decimal(below)?,
        None => decimal(text)?,
    };
    value.is_finite().then_some(value)
}

/// Returns nothing for an infinity too: one over it would pass as the number 0.
fn decimal(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

/// Number as a person writes it, `0.25` or `1e-310`, in the fewest digits that read back to the same bits.
pub struct Written(pub f64);

impl fmt::Display for Written {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        if value == 0.0 || (1e-5..1e16).contains(&value.abs()) {
            write!(out, "{value}")
        } else {
            write!(out, "{value:e}")
        }
    }
}

/// Reads a finite number or a fraction of two, as f has them.
impl FromStr for Written {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        number(text).map(Self).ok_or(())
    }
}

/// Returns a number with so many significant digits, as messages and answers show it: without an exponent from 1e-3 to
/// 1e5.
pub fn plain(number: f64, digits: usize) -> String {
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

/// Returns a part of one as a percentage with so many significant digits, a whole number without zeros behind it.
pub fn percent(part: f64, digits: usize) -> String {
    let text = plain(100.0 * part, digits);
    let whole = text.split_once('.').filter(|(_, zeros)| zeros.bytes().all(|digit| digit == b'0'));
    format!("{} %", whole.map_or(&*text, |(whole, _)| whole))
}

/// Returns the ends of an interval with the digits that tell them apart, rounded outwards.
pub fn interval([low, high]: [f64; 2]) -> String {
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

/// Returns a number with so many digits or, where it lies between two ends within which it is known, with those of them
/// that both ends share.
pub fn known(number: f64, ends: Option<[f64; 2]>, digits: usize) -> String {
    match ends {
        Some([low, high]) if low <= number && number <= high => shared([low, high], digits),
        _ => plain(number, digits),
    }
}

/// Returns a number that lies in an interval with the digits that both ends of it share, rounded, at most so many;
/// zeros after the point where it may be zero, and one digit where they share none.
fn shared([low, high]: [f64; 2], digits: usize) -> String {
    let size = low.abs().max(high.abs());
    if size == 0.0 {
        return "0".into();
    }
    let is_fixed = (1e-3..1e5).contains(&size) || low <= 0.0 && high >= 0.0;
    let first = libm::log10(size).floor().clamp(-300.0, 15.0) as i32;
    let last = digits as i32 - 1;
    let most = if is_fixed { (last - first).max(0) } else { last };
    let shown = (0..=most as usize).rev().find_map(|places| {
        let [low, high] = [low, high].map(|end| rounded(end, places, is_fixed));
        (low == high).then_some(low)
    });
    shown.unwrap_or_else(|| plain(0.5 * (low + high), 1))
}

/// Number with so many decimals, in fixed notation without the sign of a zero, or in scientific notation.
fn rounded(number: f64, places: usize, is_fixed: bool) -> String {
    if !is_fixed {
        return format!("{number:.places$e}");
    }
    let text = format!("{number:.places$}");
    match text.strip_prefix('-') {
        Some(zero) if !zero.contains(|digit| ('1'..='9').contains(&digit)) => zero.into(),
        _ => text,
    }
}

/// Numbers as the arguments of a shape, separated by commas.
pub(super) struct List<'a>(pub(super) &'a [f64]);

impl fmt::Display for List<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, value) in self.0.iter().enumerate() {
            let separator = if k > 0 { "," } else { "" };
            write!(out, "{separator}{}", Written(*value))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_xml_forbids_is_forbidden_and_letters_are_not() {
        for c in [
            '\0',
            '\t',
            '\n',
            '\u{7F}',
            '\u{85}',
            '\u{9F}',
            '\u{FFFE}',
            '\u{FFFF}',
            '\u{FDD0}',
            '\u{1FFFE}',
        ] {
            assert!(is_forbidden(c), "{c:?}");
        }
        for c in [' ', 'a', 'é', '\u{A0}', 'ß', '水', '\u{FEFF}', '\u{FFFD}', '🙂', '\u{10FFFD}']
        {
            assert!(!is_forbidden(c), "{c:?}");
        }
    }

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
    fn a_number_is_shown_with_the_digits_that_both_ends_share() {
        for (ends, text) in [
            ([-14.985_665_284_25, -14.985_665_284_03], "-14.985665284"),
            ([-0.096_334, -0.096_326], "-0.09633"),
            ([0.999_94, 1.000_06], "1.000"),
            ([-1e-8, 1e-8], "0.0000000"),
            ([0.0, -0.0], "0"),
            ([1.234_567e-12, 1.234_569e-12], "1.23457e-12"),
            ([583_249_850.0, 583_249_860.0], "5.83250e8"),
            ([-3.0, 5.0], "1"),
            ([0.1, 0.1], "0.1000000000000000"),
        ] {
            assert_eq!(known(0.5 * (ends[0] + ends[1]), Some(ends), 16), text, "{ends:?}");
        }
    }

    #[test]
    fn a_number_between_its_ends_has_no_more_digits_than_asked_for_and_one_beside_them_has_all() {
        let ends = Some([-14.985_665_284_25, -14.985_665_284_03]);
        for (number, digits, text) in [
            (-14.985_665_284_1, 6, "-14.9857"),
            (-14.985_665_284_1, 2, "-15"),
            (-14.985_665_284_1, 1, "-15"),
            (-14.985_66, 9, "-14.9856600"),
        ] {
            assert_eq!(known(number, ends, digits), text);
        }
        assert_eq!(known(1.0 / 3.0, None, 4), "0.3333");
        assert_eq!(known(2e-9, Some([1e-9, 3e-9]), 4), "2e-9");
    }

    proptest::proptest! {
        #[test]
        fn every_number_reads_back_to_the_same_bits(bits in proptest::prelude::any::<u64>()) {
            let value = f64::from_bits(bits);
            if value.is_finite() {
                let text = Written(value).to_string();
                proptest::prop_assert_eq!(number(&text).unwrap().to_bits(), bits);
                proptest::prop_assert!(text.len() <= 24, "{}", text);
            }
        }
    }
}
