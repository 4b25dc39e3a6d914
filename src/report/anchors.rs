//! Places in a built page to which links may lead.

use std::collections::BTreeSet;

/// Returns the names of the places in a page: every `id`, and the `name` of links.
pub(super) fn anchors(html: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut rest = html;
    while let Some(at) = rest.find('<') {
        rest = &rest[at + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            rest = after(comment, "-->");
        } else if rest.starts_with(|c: char| c.is_ascii_alphabetic()) {
            let element = word(rest);
            rest = &rest[element.len()..];
            while let Some(attribute) = next_attribute(&mut rest) {
                let is_place = attribute.name.eq_ignore_ascii_case("id")
                    || attribute.name.eq_ignore_ascii_case("name")
                        && element.eq_ignore_ascii_case("a");
                if is_place && !attribute.value.is_empty() {
                    found.insert(unescaped(attribute.value));
                }
            }
            // Nothing in these two is a tag.
            for verbatim in ["script", "style"] {
                if element.eq_ignore_ascii_case(verbatim) {
                    rest = after(rest, &format!("</{verbatim}"));
                }
            }
        }
    }
    found
}

/// Attribute of a tag.
struct Attribute<'a> {
    name: &'a str,
    /// Value as written; empty if there is none.
    value: &'a str,
}

/// Takes an attribute from the rest of a tag; `None` at the bracket that ends the tag.
///
/// Pages have megabytes of paths in their pictures: of a value in quotes, only its end is looked for.
fn next_attribute<'a>(rest: &mut &'a str) -> Option<Attribute<'a>> {
    let text = rest.trim_start_matches(|c: char| c.is_ascii_whitespace() || c == '/');
    // Whatever comes first belongs to the name: a browser reads on in the same way.
    let first = text.chars().next().filter(|&c| c != '>')?.len_utf8();
    let name = &text[..first + word(&text[first..]).len()];
    let text = text[name.len()..].trim_ascii_start();
    let Some(text) = text.strip_prefix('=').map(str::trim_ascii_start) else {
        *rest = text;
        return Some(Attribute { name, value: "" });
    };
    let value = match text.chars().next() {
        Some(quote @ ('"' | '\'')) => text[1..].split(quote).next().unwrap_or_default(),
        _ => text.split(|c: char| c.is_ascii_whitespace() || c == '>').next().unwrap_or_default(),
    };
    let quotes = if text.starts_with(['"', '\'']) { 2 } else { 0 };
    *rest = text.get(value.len() + quotes..).unwrap_or_default();
    Some(Attribute { name, value })
}

/// Returns the name of an element or of an attribute at the beginning of a text.
fn word(text: &str) -> &str {
    text.split(|c: char| c.is_ascii_whitespace() || "/>=".contains(c)).next().unwrap_or_default()
}

/// Returns what follows an end, or nothing if there is none.
fn after<'a>(text: &'a str, end: &str) -> &'a str {
    text.split_once(end).map_or("", |(_, rest)| rest)
}

/// Replaces the references to characters that mdBook writes in attributes.
fn unescaped(value: &str) -> String {
    let quotes = value.replace("&quot;", "\"").replace("&#39;", "'").replace("&#x27;", "'");
    quotes
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&nbsp;", "\u{A0}")
        .replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_a_browser_finds_by_its_name_is_found() {
        let html = "<h1 class=\"a\" id=\"one\">id=\"text\"</h1><a name=two></a><A NAME='three'/>\
                    <p data-x=\">\" id = \"a&amp;b\"><input name=\"field\"><!-- <a id=\"comment\"> -->\
                    <script>s = '<a id=\"script\">'</script><td\nid=\"last\"><p data-id=\"data\">";
        let found = anchors(html);
        assert_eq!(Vec::from_iter(&found), ["a&b", "last", "one", "three", "two"]);
    }
}
