//! Check of mdBook's directives in pages: the files that they include must be among those from which the book is made.

use super::markdown::place;
use regex::{Captures, Regex};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Directive in the sense of mdBook: one that a backslash turns into text, to the end of its line, or kind and rest.
static DIRECTIVE: LazyLock<Regex> = LazyLock::new(|| {
    let pattern = r"\\\{\{#.*\}\}|\{\{\s*#([a-zA-Z0-9_]+)\s+([^}]+)\}\}";
    Regex::new(pattern).expect("the pattern is tested")
});

/// Beginning of a directive.
static BEGINNING: LazyLock<Regex> =
    LazyLock::new(|| Regex::new(r"\{\{\s*#").expect("the pattern is tested"));

/// Depth of files that include each other beyond which mdBook gives up.
const DEPTH: usize = 10;

const REMEDY: &str = "name a file in report/templates by its path from the page, or a scene as \
    ../../pipeline/scenes/NAME.toml; copy other files into report/templates; `\\{{#` is the text itself";

/// Refuses a directive, of a page or of a file that it includes, that includes no file of `files`, or no part of one.
///
/// Paths of `files` begin in the folder of `book.toml`.
pub(super) fn check(page: &str, files: &BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    check_below(page, files, 0)
}

fn check_below(file: &str, files: &BTreeMap<String, Vec<u8>>, depth: usize) -> Result<(), String> {
    let Some(Ok(text)) = files.get(file).map(|bytes| std::str::from_utf8(bytes)) else {
        return Ok(());
    };
    for found in DIRECTIVE.captures_iter(text) {
        let Some(Target { path, part }) = included(&found) else { continue };
        let check = match resolved(file, path) {
            Some(there) if depth == DEPTH => Err(format!("{there} includes itself")),
            Some(there) => match files.get(&there) {
                Some(bytes) => has_part(bytes, part).map(|()| there),
                None => Err(REMEDY.into()),
            },
            None => Err(REMEDY.into()),
        };
        let there = check.map_err(|why| {
            let at = place(file, text, found.get(0).map_or(0, |whole| whole.start()));
            format!("{at}: `{}` includes nothing: {why}", &found[0])
        })?;
        check_below(&there, files, depth + 1)?;
    }
    Ok(())
}

/// Target of a directive.
struct Target<'a> {
    /// Path of a file.
    path: &'a str,
    /// Lines or anchor after the colon.
    part: Option<&'a str>,
}

/// Returns the target of a directive that includes a file.
fn included<'a>(found: &Captures<'a>) -> Option<Target<'a>> {
    let target = found.get(2)?.as_str().split_whitespace().next()?;
    match found.get(1)?.as_str() {
        "include" | "rustdoc_include" => Some(match target.split_once(':') {
            Some((path, part)) => Target { path, part: Some(part) },
            None => Target { path: target, part: None },
        }),
        "playground" | "playpen" => Some(Target { path: target, part: None }),
        _ => None,
    }
}

/// Returns a path in `file` as a path from the folder of `book.toml`; `None` for an absolute one.
fn resolved(file: &str, path: &str) -> Option<String> {
    let mut steps: Vec<&str> = file.split('/').collect();
    steps.pop();
    for step in path.split('/') {
        match step {
            "" => return None,
            "." => {}
            ".." if steps.last().is_some_and(|last| *last != "..") => _ = steps.pop(),
            step => steps.push(step),
        }
    }
    Some(steps.join("/"))
}

/// Refuses a file that lacks the part for which a directive asks.
fn has_part(bytes: &[u8], part: Option<&str>) -> Result<(), String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "the file is not UTF-8 text".to_owned())?;
    let Some(part) = part else { return Ok(()) };
    let mut parts = part.split(':');
    let (first, last) = (parts.next().unwrap_or_default(), parts.next());
    let lines = text.lines().count();
    match first.parse::<usize>() {
        Ok(0) => Err("lines are counted from 1 on".into()),
        Ok(line) if line > lines => Err(format!("the file has {lines} lines")),
        Ok(line) => is_last_line(last, line),
        Err(_) if first.is_empty() => is_last_line(last, 1),
        Err(_) => {
            let mut anchors = text.split("ANCHOR:").skip(1);
            match anchors.any(|anchor| anchor.split_whitespace().next() == Some(first)) {
                true => Ok(()),
                false => Err(format!("the file has no line with `ANCHOR: {first}`")),
            }
        }
    }
}

/// Refuses a last line before the `first` one, and what is no number of a line; without a number the part goes to the
/// end of the file.
fn is_last_line(last: Option<&str>, first: usize) -> Result<(), String> {
    let Some(last) = last.filter(|last| !last.is_empty()) else { return Ok(()) };
    match last.parse::<usize>() {
        Ok(last) if last < first => Err(format!("line {last} comes before line {first}")),
        Ok(_) => Ok(()),
        Err(_) => Err(format!("`{last}` is no number of a line")),
    }
}

/// Refuses a page whose HTML shows a directive that mdBook has not replaced.
pub(super) fn refuse_left(chapter: &str, markdown: &str, built: &[u8]) -> Result<(), String> {
    let shown = BEGINNING.find_iter(&String::from_utf8_lossy(built)).count();
    let texts = DIRECTIVE.captures_iter(markdown).filter(|found| found.get(1).is_none());
    let texts: Vec<_> = texts.filter_map(|found| found.get(0)).collect();
    let meant: usize = texts.iter().map(|text| BEGINNING.find_iter(text.as_str()).count()).sum();
    if shown <= meant {
        return Ok(());
    }
    let left = BEGINNING
        .find_iter(markdown)
        .find(|found| !texts.iter().any(|text| text.range().contains(&found.start())));
    let Some(left) = left else {
        return Err(format!(
            "{chapter}: a file that it includes has a directive `{{{{#`; take it out"
        ));
    };
    let at = place(chapter, markdown, left.start());
    let line = markdown[left.start()..].lines().next().unwrap_or_default();
    let end = line.find("}}").map_or(line.len(), |end| end + 2);
    Err(format!(
        "{at}: `{}` is replaced by nothing; use a directive of mdBook, or write `\\{{{{#` for the text itself",
        &line[..end]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(page: &str) -> Result<(), String> {
        let files = [
            ("src/sub/a.md", page),
            ("src/note.txt", "one\n// ANCHOR: part\ntwo\n// ANCHOR_END: part\n"),
            ("src/round.txt", "{{#include round.txt}}"),
            ("src/nested.txt", "\n{{#include no.txt}}"),
            ("../pipeline/scenes/plate.toml", "title = \"t\"\n"),
        ];
        let files = files.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()));
        let mut files = BTreeMap::from(files);
        files.insert("src/photo.png".into(), b"\x89PNG\xff".to_vec());
        check("src/sub/a.md", &files)
    }

    #[test]
    fn what_includes_nothing_is_named_with_its_line() {
        for page in [
            "{{#include ../note.txt}} and {{ #include ./../note.txt:2 }}",
            "```toml\n{{#include ../../../pipeline/scenes/plate.toml}}\n```",
            "{{#rustdoc_include ../note.txt:part}} {{#playground ../note.txt editable}}",
            "{{#include ../note.txt:2:}} {{#include ../note.txt::3}} {{#include ../note.txt:1:9:x}} {{#title Another}}",
            r"\{{#include no.txt}} and {{#include no.txt}}",
            "{{#include}} {{include no.txt}} {{#template no.txt}}",
        ] {
            assert_eq!(checked(page), Ok(()), "{page}");
        }
        for (page, why) in [
            ("{{#include no.txt}}", "nothing: name a file in report/templates"),
            ("{{#include note.txt}}", "name a file"),
            ("{{#include /etc/passwd}}", "name a file"),
            ("{{#include ../../../Cargo.toml}}", "name a file"),
            ("{{#include ../../../../pipeline/scenes/plate.toml}}", "name a file"),
            ("```rust\n{{#rustdoc_include no.rs:2:3}}\n```", "name a file"),
            ("{{#playground no.rs}}", "name a file"),
            ("{{#include ../note.txt:5}}", "the file has 4 lines"),
            ("{{#include ../note.txt:4:2}}", "line 2 comes before line 4"),
            ("{{#include ../note.txt::0}}", "line 0 comes before line 1"),
            ("{{#include ../note.txt:0:3}}", "counted from 1 on"),
            ("{{#rustdoc_include ../note.txt:1:two}}", "`two` is no number"),
            ("{{#include ../note.txt:par}}", "no line with `ANCHOR: par`"),
            ("{{#include ../photo.png}}", "not UTF-8"),
        ] {
            let error = checked(&format!("# A\n\n{page}\n")).unwrap_err();
            let line = 3 + usize::from(page.starts_with("```"));
            assert!(error.starts_with(&format!("src/sub/a.md:{line}: `{{{{#")), "{error}");
            assert!(error.contains(why) && !error.contains('\n'), "{error}");
        }
        let error = checked("{{#include ../nested.txt}}").unwrap_err();
        assert!(error.starts_with("src/nested.txt:2: `{{#include no.txt}}`"), "{error}");
        assert!(checked("{{#include ../round.txt}}").unwrap_err().contains("includes itself"));
    }

    fn left(markdown: &str, built: &str) -> Result<(), String> {
        refuse_left("src/a.md", markdown, built.as_bytes())
    }

    #[test]
    fn what_is_left_in_a_built_page_is_found_beside_what_is_meant_as_text() {
        let page = "\\{{#include a}} {{#b}}\n\n`{{#template c d}}`\n";
        assert_eq!(left(page, "<p>{{#include a}} {{#b}}</p> done"), Ok(()));
        let error = left(page, "{{#include a}} {{#b}} <code>{{#template c d}}</code>").unwrap_err();
        assert!(error.starts_with("src/a.md:3: `{{#template c d}}` is replaced by"), "{error}");
        assert!(left("{{#include n.txt}}", "{{ #x}}").unwrap_err().starts_with("src/a.md:1: "));
        assert!(left("\\{{#x}}", "{{#x}} {{#y}}").unwrap_err().contains("that it includes has"));
    }
}
