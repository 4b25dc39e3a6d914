//! Texts of laws on parts of the boundary: `PART`, `PART=NUMBER`, or a number of all parts that are not named.
//!
//! Central are [`under`], which reads such texts into a statement, and [`texts_of_law`], which writes them.

use signorini_mathematics::problem::law::LawNumber;
use signorini_mathematics::problem::text::Written;
use signorini_mathematics::statement::Statement;
use std::collections::BTreeMap;

/// Texts of the numbers of this kind: that of all parts that are not named, and those of each part.
pub(super) fn texts_of_law(of: &Statement, law: LawNumber) -> Vec<String> {
    let text = |(part, number): (&str, f64)| match said(law, part) {
        _ if part.is_empty() => Written(number).to_string(),
        (_, None) if number == 0.0 => part.to_owned(),
        _ => format!("{part}={}", Written(number)),
    };
    of.boundary.numbers(law).map(text).collect()
}

/// True if a text is a number, or a name in its place.
fn is_number(text: &str) -> bool {
    text.trim().parse::<f64>().is_ok()
        || text.parse::<Written>().is_ok()
        || signed_name(text).is_some()
}

/// The part of which a text says something, empty for all that are not named, and the number; a part that is free,
/// fixed or below a value may stand without one.
pub(super) fn said(law: LawNumber, text: &str) -> (&str, Option<&str>) {
    let stands_alone = matches!(law, LawNumber::Free | LawNumber::Fixed | LawNumber::Below);
    match text.rsplit_once('=') {
        // A name may have the sign.
        Some((part, number)) if !stands_alone || is_number(number) => {
            (part.trim_end(), Some(number))
        }
        _ if stands_alone => (text, None),
        _ => ("", Some(text)),
    }
}

/// The statement with these numbers of one kind in place of others of this kind, and of other laws on their parts.
pub(super) fn under(of: Statement, law: LawNumber, given: &[String]) -> Result<Statement, String> {
    let (mut boundary, mut numbers) = (of.boundary.without(law), BTreeMap::new());
    for text in given {
        let (part, number) = said(law, text);
        if part.is_empty() && number != Some(text.as_str()) {
            return Err("the name of a part is empty".into());
        }
        let number = number.unwrap_or("0");
        // A negative zero is zero.
        let number = number.parse().ok().map(|Written(number)| 0.0 + number);
        let number = match law {
            LawNumber::Friction | LawNumber::Limit => number
                .filter(|number| *number > 0.0)
                .ok_or("must be a positive number, e.g. 0.3")?,
            _ => number.ok_or("must be a number, e.g. 0.3")?,
        };
        if numbers.insert(part, number).is_some_and(|before| before != number) {
            return Err("the part has a number already; name it once".into());
        }
        boundary = boundary.with(part, law, number);
    }
    Ok(Statement { boundary, ..of })
}

/// True if the text can be a name in place of a number.
pub(super) fn is_name(text: &str) -> bool {
    !text.is_empty()
        && !text.starts_with(|c: char| c.is_ascii_digit())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// The name in place of a number, with its sign, as `-$G`; none if the text is no such thing.
pub(super) fn signed_name(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let (sign, text) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    text.strip_prefix('$').filter(|name| is_name(name)).map(|name| (sign, name))
}
