//! Texts of the user in Markdown and in CSV.

/// Returns a text of the user in a form that shows it unchanged, in Markdown, in `<code>` there, and as the value of an
/// attribute: signs that have a meaning in any of these, and those that are set as others, are written by number, ends
/// of lines as spaces.
pub fn in_markdown(text: &str) -> String {
    let mut shown = String::new();
    let mut last = ' ';
    let mut left = text.chars();
    while let Some(c) = left.next() {
        let next = left.clone().next().unwrap_or(' ');
        // A line below a word has no meaning within it.
        let is_plain = c == '_' && last.is_ascii_alphanumeric() && next.is_ascii_alphanumeric();
        let is_set_as_another = c == last && "-.".contains(c);
        match is_set_as_another || !is_plain && "\\`*_[]{}<>&|~^$#\"'".contains(c) {
            _ if c.is_control() => shown.push(' '),
            true => shown += &format!("&#{};", u32::from(c)),
            false => shown.push(c),
        }
        last = c;
    }
    shown
}

/// Returns a name of the user as code in Markdown.
pub fn code_in_markdown(name: &str) -> String {
    match name.chars().all(|c| c.is_alphanumeric() || "/._-".contains(c)) {
        true => format!("`{name}`"),
        false => format!("<code>{}</code>", in_markdown(name)),
    }
}

/// Returns lines of cells in CSV, as RFC 4180 asks for it.
pub fn csv<Line>(lines: impl IntoIterator<Item = Line>) -> String
where
    Line: IntoIterator,
    Line::Item: AsRef<[u8]>,
{
    let mut csv = csv::Writer::from_writer(Vec::new());
    for line in lines {
        csv.write_record(line).expect("lines of a table are as long as its head");
    }
    let bytes = csv.into_inner().expect("memory takes every byte");
    String::from_utf8(bytes).expect("cells are texts")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_of_the_user_is_shown_as_it_is() {
        for text in [
            "Price $5 and $6",
            "x^2^ _x_ x__y a_b _ab_c_ m_|n",
            "See [a](nope.md) ![b](c.svg)",
            "<b>x</b> &amp; *s* _t_ ~~u~~",
            "a | b \\ {{#include x}} `c` \"d\" 'e' -- ... #f",
        ] {
            let shown = in_markdown(text);
            for markdown in [format!("**{shown}**"), format!("| a |\n| - |\n| {shown} |\n")] {
                let mut read = String::new();
                for event in
                    pulldown_cmark::Parser::new_ext(&markdown, pulldown_cmark::Options::all())
                {
                    match event {
                        pulldown_cmark::Event::Text(text) => read += &text,
                        pulldown_cmark::Event::Start(_) | pulldown_cmark::Event::End(_) => {}
                        other => panic!("{other:?}"),
                    }
                }
                assert_eq!(
                    read.strip_prefix('a').filter(|_| markdown.starts_with('|')).unwrap_or(&read),
                    text
                );
            }
            assert!(!shown.contains(['"', '<', '$', '{']), "{shown}");
        }
    }
}
