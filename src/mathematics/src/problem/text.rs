//! Characters of the texts that users give: titles, names of files, of parts of a mesh, and pages.

/// True if no line of text may have the character: a control character, or one of Unicode's noncharacters.
///
/// XML forbids most of them, even escaped, so that an SVG or VTK file with one cannot be read. Source: Extensible Markup
/// Language (XML) 1.0, fifth edition, production 2; The Unicode Standard, section 23.7.
pub fn is_forbidden(c: char) -> bool {
    let number = u32::from(c);
    c.is_control() || number & 0xFFFE == 0xFFFE || (0xFDD0..=0xFDEF).contains(&number)
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
}
