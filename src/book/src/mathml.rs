//! Formulas of the pages: LaTeX between dollars becomes MathML, and links to labels get their texts and targets.

use super::labels::Labels;
use super::markdown::{parse, place, split_tag};
use pulldown_cmark::{Event, Tag};
use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Parser as Latex, Storage, push_mathml};
use std::ops::Range;

/// Replaces formulas by MathML and `[](eq:n)` by a link to equation (n); leaves code unchanged.
///
/// `$...$` is inline, `$$...$$` displayed, `\$` a dollar; `\tag{n}` at the end of a displayed
/// formula numbers it. The result is Markdown again.
pub(super) fn convert(chapter: &str, markdown: &str, labels: &Labels) -> Result<String, String> {
    let mut page = Rewritten { markdown, out: String::with_capacity(2 * markdown.len()), done: 0 };
    for (event, range) in parse(markdown) {
        let at = range.start;
        let rewritten = match event {
            Event::InlineMath(latex) => page.inline(range, &latex),
            Event::DisplayMath(latex) => page.displayed(range, &latex),
            Event::Start(Tag::Link { dest_url, .. }) => match labels.link(chapter, &dest_url) {
                Some(link) => link.map(|link| page.replace(range, &link)),
                None => Ok(()),
            },
            Event::Text(_) => match bare_dollar(markdown, range) {
                Some(at) => {
                    let at = place(chapter, markdown, at);
                    return Err(format!(
                        "{at}: unpaired `$`; write `\\$` for a dollar, or close the formula"
                    ));
                }
                None => Ok(()),
            },
            _ => Ok(()),
        };
        rewritten.map_err(|what| format!("{}: {what}", place(chapter, markdown, at)))?;
    }
    page.out.push_str(&markdown[page.done..]);
    Ok(page.out)
}

/// Page in which parts are replaced, one after the other.
struct Rewritten<'a> {
    markdown: &'a str,
    out: String,
    /// Number of bytes of `markdown` that are replaced or copied already.
    done: usize,
}

impl Rewritten<'_> {
    fn replace(&mut self, range: Range<usize>, text: &str) {
        self.out.push_str(&self.markdown[self.done..range.start]);
        self.out.push_str(text);
        self.done = range.end;
    }

    fn inline(&mut self, range: Range<usize>, latex: &str) -> Result<(), String> {
        let math = set(latex, DisplayMode::Inline)?;
        // Browsers break a line between a formula and the mark after it.
        match self.markdown[range.end..].chars().next().filter(|c| ",.;:)".contains(*c)) {
            Some(mark) => self.replace(
                range.start..range.end + mark.len_utf8(),
                &format!(r#"<span class="nobreak">{math}{mark}</span>"#),
            ),
            None => self.replace(range, &math),
        }
        Ok(())
    }

    fn displayed(&mut self, range: Range<usize>, latex: &str) -> Result<(), String> {
        let (body, label) = split_tag(latex);
        let math = set(body, DisplayMode::Block)?;
        let equation = match label {
            Some(n) => format!(
                r#"<span class="equation" id="eq-{n}">{math}<span class="tag">({n})</span></span>"#
            ),
            None => format!(r#"<span class="equation">{math}</span>"#),
        };
        self.replace(range, &equation);
        Ok(())
    }
}

/// Returns the position of a dollar in `range` that no backslash escapes.
fn bare_dollar(markdown: &str, range: Range<usize>) -> Option<usize> {
    range.clone().find(|&at| markdown.as_bytes()[at] == b'$' && !markdown[..at].ends_with('\\'))
}

/// Sets a formula as MathML.
fn set(latex: &str, display_mode: DisplayMode) -> Result<String, String> {
    let storage = Storage::new();
    let events: Vec<_> = Latex::new(latex, &storage)
        .collect::<Result<_, _>>()
        .map_err(|error| not_set(latex, first_line(&error.to_string())))?;
    let config = RenderConfig { display_mode, ..RenderConfig::default() };
    let mut mathml = String::new();
    push_mathml(&mut mathml, events.into_iter().map(Ok::<_, std::convert::Infallible>), config)
        .map_err(|error| not_set(latex, &error.to_string()))?;
    if let DisplayMode::Block = display_mode {
        // The limit stands below the slope of a large integral sign: without its width there would be a hole.
        let narrow = r#"<msub style="margin-inline-end:-0.35em"><mo movablelimits="false">∫</mo>"#;
        mathml = mathml.replace(r#"<msub><mo movablelimits="false">∫</mo>"#, narrow);
    }
    Ok(shield(&without_depth(&with_lines(mathml))))
}

/// Lines above and below a formula: the element, the mark that the renderer writes, its symbol, and its side.
const LINES: [(&str, &str, &str, &str); 2] = [
    ("mover", "<mi>‾</mi>", "‾", "top"),
    ("munder", r#"<mo stretchy="true">_</mo>"#, "_", "bottom"),
];

/// Draws the marks of lines as borders of what they belong to.
///
/// Chromium does not stretch a mark: it would cover one letter of a longer formula, which then is another. The mark
/// stays in the text, unseen, for whoever hears or copies it.
fn with_lines(mut mathml: String) -> String {
    for (element, mark, symbol, side) in LINES {
        let (open, close) = (format!("<{element}>"), format!("</{element}>"));
        let (any, end) = (format!("<{element}"), format!("{mark}{close}"));
        while let Some(at) = mathml.find(&end) {
            let is_whole = |(start, _): &(usize, &str)| {
                let inside = &mathml[start + open.len()..at];
                inside.matches(&any).count() == inside.matches(&close).count()
            };
            let mut starts = mathml[..at].rmatch_indices(&open);
            let (start, _) = starts.find(is_whole).expect("every element that ends has begun");
            let inside = &mathml[start + open.len()..at];
            let with = format!(
                "<{element} class=\"line\"><mrow style=\"border-{side}:0.055em solid;padding-{side}:0.1em\">\
                 {inside}</mrow><mo style=\"visibility:hidden;font-size:1px\">{symbol}</mo></{element}>"
            );
            mathml.replace_range(start..at + end.len(), &with);
        }
    }
    mathml
}

/// Letters that reach below the line.
const DEEP: &str = "fgjpqyQβγζημξρςφχψ";

/// Closing bracket, as the renderer writes it; it reaches below the line as well.
const BRACKET: &str = r#"<mo symmetric="false" stretchy="false">)</mo>"#;

/// Puts subscripts of what reaches below the line where those of other letters are, as TeX does; a browser puts them
/// lower.
fn without_depth(mathml: &str) -> String {
    let mut mathml = mathml.to_owned();
    let letters = DEEP.chars().map(|letter| format!("<mi>{letter}</mi>"));
    for deep in letters.chain([BRACKET.to_owned()]) {
        for script in ["<msub>", "<msubsup>"] {
            let with = format!(r#"{script}<mpadded depth="0">{deep}</mpadded>"#);
            mathml = mathml.replace(&format!("{script}{deep}"), &with);
        }
    }
    mathml
}

fn not_set(latex: &str, message: &str) -> String {
    format!("cannot set the formula `{}`: {message}", latex.trim())
}

/// Returns the first line of a message of the parser, which marks the place in further lines; our message has the whole
/// formula.
fn first_line(message: &str) -> &str {
    message.lines().next().unwrap_or_default().trim_start_matches("parsing error: ")
}

/// Writes characters that Markdown could read as markup as character references, and the whole formula on one line.
fn shield(mathml: &str) -> String {
    // Inline is the default. Solidus and bars are ordinary symbols in TeX but spaced operators in MathML; and the
    // renderer escapes the ampersand of the entity it writes for a control space.
    let mathml = mathml
        .replace(r#"<math display="inline">"#, "<math>")
        .replace("<mo>/</mo>", r#"<mo lspace="0" rspace="0">/</mo>"#)
        .replace(r#""false">|</mo>"#, r#""false" lspace="0" rspace="0">|</mo>"#)
        .replace("&amp;nbsp;", "&#160;");
    let (mut out, mut in_tag) = (String::with_capacity(mathml.len()), false);
    for c in mathml.chars() {
        match c {
            '<' => in_tag = true,
            '>' => in_tag = false,
            '\n' => {
                out.push(' ');
                continue;
            }
            '*' | '_' | '`' | '[' | ']' | '|' | '~' | '\\' | '\'' | '"' | '.' | '-' | '!' | '$'
                if !in_tag =>
            {
                out.push_str(&format!("&#{};", c as u32));
                continue;
            }
            _ => {}
        }
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::summary::listed;
    use super::*;
    use std::collections::BTreeMap;

    fn converted(markdown: &str) -> Result<String, String> {
        let labels = Labels::of(&BTreeMap::from([("src/a.md", markdown)]), &[])?;
        convert("src/a.md", markdown, &labels)
    }

    #[test]
    fn inline_and_display_formulas_become_mathml() {
        let text = converted("Let $x_1$ and\n\n$$\ny = -1/2\n$$\n").unwrap();
        assert!(text.starts_with("Let <math><msub>"), "{text}");
        assert!(text.contains("<span class=\"equation\"><math display=\"block\">"));
        assert!(text.contains("<mo lspace=\"0\" rspace=\"0\">/</mo>"), "{text}");
        assert!(!text.contains('$') && text.ends_with("</math></span>\n"));
        assert!(converted(r"$a\ b$").unwrap().contains("&#160;"));
        assert!(converted("$a$, b").unwrap().ends_with("</math>,</span> b"));
    }

    #[test]
    fn a_line_covers_all_that_it_belongs_to() {
        let line = "<mrow style=\"border-top:0.055em solid;padding-top:0.1em\">";
        for (latex, lines) in [
            (r"\overline{\log (b / a)}", 1),
            (r"\bar t a", 1),
            (r"\overline{a + \overline{b c}} \overline{d}", 3),
            (r"\overline{\hat a b}", 1),
        ] {
            let text = converted(&format!("${latex}$")).unwrap();
            assert!(!text.contains("<mi>‾</mi>"), "{text}");
            assert_eq!(text.matches(line).count(), lines, "{text}");
            assert_eq!(text.matches(">‾</mo></mover>").count(), lines, "{text}");
        }
        let text = converted(r"$\overline{a b} c$").unwrap();
        let covered = text.split(line).nth(1).unwrap().split(">‾<").next().unwrap();
        assert!(covered.contains("<mi>b</mi>") && !covered.contains("<mi>c</mi>"), "{text}");
        let text = converted(r"$\underline{\lambda}$").unwrap();
        assert!(text.contains("border-bottom") && !text.contains("stretchy=\"true\""), "{text}");
    }

    #[test]
    fn subscripts_are_at_one_height_and_integrals_have_no_hole() {
        let text = converted(r"$y_i \psi_i^n a_i (A y)_i$").unwrap();
        assert_eq!(text.matches("<mpadded depth=\"0\">").count(), 3, "{text}");
        assert!(text.contains("<msub><mi>a</mi>"), "{text}");
        let hole = "<msub style=\"margin-inline-end:-0.35em\">";
        assert!(converted("$$\\int_\\Omega f$$").unwrap().contains(hole));
        assert!(!converted("$\\int_\\Omega f$").unwrap().contains(hole));
    }

    #[test]
    fn code_and_escaped_dollars_stay() {
        let text = "Pay \\$5 for `$x$`.\n\n```sh\necho $HOME $x$\n```\n\n    $indented$\n";
        assert_eq!(converted(text).unwrap(), text);
    }

    #[test]
    fn formulas_survive_inside_tables_lists_and_emphasis() {
        let text =
            converted("| $a$ | b |\n|---|---|\n| $\\lvert x\\rvert$ | *$a_b$* |\n\n- $z^*$\n");
        let text = text.unwrap();
        assert!(text.lines().nth(2).unwrap().matches('|').count() == 3, "{text}");
        assert!(!text.contains('_') && text.contains("&#124;"), "{text}");
    }

    #[test]
    fn equations_and_figures_are_numbered_and_linked() {
        let equation = converted("$$ x \\tag{7} $$\n\nsee [](eq:7).").unwrap();
        assert!(equation.contains(r#"id="eq-7""#) && equation.contains("(7)</span>"));
        assert!(equation.ends_with("see [(7)](<a.md#eq-7>)."), "{equation}");
        let page = "<figure id=\"figure-x\">\n\n**[](figure:x).** Text\n\n</figure>\n";
        let listed = listed("[A](a.md)").unwrap();
        let labels = Labels::of(&BTreeMap::from([("src/a.md", page)]), &listed).unwrap();
        let shown = convert("src/a.md", page, &labels).unwrap();
        assert!(shown.contains("**[Figure 0.1](<a.md#figure-x>).** Text"), "{shown}");
    }

    fn message(markdown: &str) -> String {
        converted(markdown).unwrap_err()
    }

    #[test]
    fn mistakes_are_named() {
        let formula = message("fine $x$ and $\\frac{1}$");
        assert!(
            formula.starts_with("src/a.md:1: cannot set the formula `\\frac{1}`: "),
            "{formula}"
        );
        assert!(message("\nlone $ sign").starts_with("src/a.md:2: unpaired `$`"));
        assert!(message("\n[](eq:99)").starts_with("src/a.md:2: no equation is tagged (99)"));
    }
}
