//! Texts that users give: the characters that they may have, and their numbers.

use std::fmt;

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
