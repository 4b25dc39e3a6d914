//! Texts of laws on parts of the boundary: `PART`, `PART=NUMBER`, or a number of all parts that are not named.
//!
//! Central are [`under`], which reads such texts into a statement, and [`texts_of_law`], which writes them.

use signorini_mathematics::problem::law::LawNumber;
use signorini_mathematics::problem::text::Written;
use signorini_mathematics::statement::Statement;
use std::collections::BTreeMap;
use std::ops::Range;

/// Texts of the numbers of this kind: that of all parts that are not named, and those of each part.
pub(super) fn texts_of_law(of: &Statement, law: LawNumber) -> Vec<String> {
    let texts = of.boundary.numbers(law).map(|(part, number)| match said(law, part) {
        _ if part.is_empty() => number.to_string(),
        (_, None) if number.number() == Some(0.0) => part.to_owned(),
        _ => format!("{part}={number}"),
    });
    texts.collect()
}

/// True if a text is a number or a formula, with names in place of numbers or without; or is meant to be one.
fn is_number(text: &str) -> bool {
    text.trim().parse::<f64>().is_ok()
        || text.contains(['(', '*', '/', '^'])
        || LawNumber::Gap.read(&with_ones(text)).is_ok()
}

/// Returns a text with ones in place of its names.
fn with_ones(text: &str) -> String {
    with_known(text, &names(text).map(|name| (name.to_owned(), 1.0)).collect())
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
        let number = law.read(number.unwrap_or("0"))?;
        if numbers.insert(part, number.clone()).is_some_and(|before| before != number) {
            return Err("the part has a number already; name it once".into());
        }
        boundary = boundary.with(part, law, number);
    }
    Ok(Statement { boundary, ..of })
}

/// Returns a text in one line, unless names of regions in quotes may have spaces.
pub(super) fn one_line(text: &str) -> String {
    match text.contains('"') {
        true => text.trim().to_owned(),
        false => text.split_whitespace().collect::<Vec<_>>().join(" "),
    }
}

/// True if the text can be a name in place of a number.
pub(super) fn is_name(text: &str) -> bool {
    !text.is_empty()
        && !text.starts_with(|c: char| c.is_ascii_digit())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

/// Returns the places of the names in f or the number of a law, behind their dollars; what stands in quotes has no
/// names.
pub(super) fn places(f: &str) -> Vec<Range<usize>> {
    let (mut places, mut is_quoted) = (Vec::new(), false);
    for (at, sign) in f.match_indices(['"', '$']) {
        let rest = &f[at + 1..];
        let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        let end = at + 1 + end.unwrap_or(rest.len());
        match sign {
            "\"" => is_quoted = !is_quoted,
            _ if !is_quoted && is_name(&f[at + 1..end]) => places.push(at + 1..end),
            _ => {}
        }
    }
    places
}

/// Returns the names in f or the number of a law.
pub(super) fn names(f: &str) -> impl Iterator<Item = &str> {
    places(f).into_iter().map(|place| &f[place])
}

/// Returns the number of a law with numbers in place of its names, as far as they have some.
pub(super) fn with_known(number: &str, numbers: &BTreeMap<String, f64>) -> String {
    let (mut text, mut end) = (String::new(), 0);
    for place in places(number) {
        if let Some(known) = numbers.get(&number[place.clone()]) {
            text += &format!("{}({})", &number[end..place.start - 1], Written(*known));
            end = place.end;
        }
    }
    text + &number[end..]
}
