//! Names in f, each behind a dollar, in whose place a study has values.

use super::table::{Reading, Refused};

/// True if the text can be a name in f.
pub(super) fn is_name(text: &str) -> bool {
    !text.is_empty()
        && !text.starts_with(|c: char| c.is_ascii_digit())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Part of an f.
pub(super) enum Piece<'a> {
    /// Name behind a dollar.
    Name(&'a str),
    /// Any other text.
    Text(&'a str),
}

impl Piece<'_> {
    pub(super) fn text(&self) -> &str {
        match self {
            Self::Name(text) | Self::Text(text) => text,
        }
    }
}

/// Returns the parts of an f; what stands in quotes has no names.
pub(super) fn pieces(f: &str) -> Vec<Piece<'_>> {
    let (mut pieces, mut rest) = (Vec::new(), f);
    let (mut from, mut is_quoted) = (0, false);
    while let Some(found) = rest[from..].find(['"', '$']) {
        let at = from + found;
        let name = &rest[at + 1..];
        let end = name.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        let name = &name[..end.unwrap_or(name.len())];
        if rest[at..].starts_with('"') {
            (is_quoted, from) = (!is_quoted, at + 1);
        } else if is_quoted || !is_name(name) {
            from = at + 1;
        } else {
            pieces.extend([Piece::Text(&rest[..at]), Piece::Name(name)]);
            (rest, from) = (&rest[at + 1 + name.len()..], 0);
        }
    }
    pieces.push(Piece::Text(rest));
    pieces
}

/// Refuses an f with a name to which nothing has given a value.
pub(super) fn check_names(f: &str) -> Reading<()> {
    pieces(f).iter().try_for_each(|piece| match piece {
        Piece::Name(name) => Err(without_values(name)),
        Piece::Text(_) => Ok(()),
    })
}

/// Refusal of a name in f that has no values.
pub(super) fn without_values(name: &str) -> Refused {
    let text = format!(
        "f has ${name}, which has no values; add vary = {{ {name} = [0.1, 0.2] }}, or --vary {name}=0.1,0.2"
    );
    Refused::new("f", text)
}
