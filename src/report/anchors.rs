//! Places in a built page to which links may lead.

use regex::Regex;
use std::collections::BTreeSet;
use std::sync::LazyLock;

/// Comment or script, in which nothing is a tag; or a tag with its attributes.
static TAG: LazyLock<Regex> = LazyLock::new(|| {
    let pattern = concat!(
        r"(?si)<!--.*?-->|<(?:script|style)\b.*?</(?:script|style)|",
        r#"<([a-z][^\s/>]*)((?:[^>"']|"[^"]*"|'[^']*')*)>"#
    );
    Regex::new(pattern).expect("the pattern is tested")
});

/// Attribute that names a place.
static NAME: LazyLock<Regex> = LazyLock::new(|| {
    let pattern = r#"(?si)(?:^|[\s"'/])(id|name)\s*=\s*(?:"([^"]*)"|'([^']*)'|([^\s"'>]+))"#;
    Regex::new(pattern).expect("the pattern is tested")
});

/// Returns the names of the places in a page: every `id`, and the `name` of links.
pub(super) fn anchors(html: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for tag in TAG.captures_iter(html) {
        let (Some(element), Some(attributes)) = (tag.get(1), tag.get(2)) else { continue };
        for name in NAME.captures_iter(attributes.as_str()) {
            let is_place =
                name[1].eq_ignore_ascii_case("id") || element.as_str().eq_ignore_ascii_case("a");
            let value = (2..=4).find_map(|k| name.get(k)).map_or("", |value| value.as_str());
            if is_place {
                found.insert(unescaped(value));
            }
        }
    }
    found
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
