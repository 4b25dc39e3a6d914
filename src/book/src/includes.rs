//! Check of mdBook's directives in pages: the files that they include must be among those from which the book is made.

use super::markdown::place;
use regex::Regex;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Directive in the sense of mdBook: one that a backslash turns into text, to the end of its line, or its words.
static DIRECTIVE: LazyLock<Regex> = LazyLock::new(|| {
    Regex::new(r"\\\{\{#.*\}\}|\{\{\s*#([^}]+)\}\}").expect("the pattern is tested")
});

/// Depth of files that include each other beyond which mdBook gives up.
const DEPTH: usize = 10;

const REMEDY: &str = "write {{#include FILE}}, a file in report/templates by its path from the page, or a scene as \
    ../../pipeline/scenes/NAME.toml; copy other files into report/templates; `\\{{#` is the text itself";

/// Refuses a directive, of a page or of a file that it includes, that does not include a whole file of `files`.
///
/// Paths of `files` begin in the folder of the book.
pub(super) fn check(page: &str, files: &BTreeMap<String, Vec<u8>>) -> Result<(), String> {
    check_below(page, files, 0)
}

fn check_below(file: &str, files: &BTreeMap<String, Vec<u8>>, depth: usize) -> Result<(), String> {
    let Some(Ok(text)) = files.get(file).map(|bytes| std::str::from_utf8(bytes)) else {
        return Ok(());
    };
    for found in DIRECTIVE.captures_iter(text) {
        let Some(words) = found.get(1) else { continue };
        let path = words.as_str().strip_prefix("include ").and_then(|path| resolved(file, path));
        let Some(there) = path.filter(|there| files.contains_key(there) && depth < DEPTH) else {
            let at = place(file, text, found.get(0).map_or(0, |whole| whole.start()));
            return Err(format!("{at}: `{}` includes nothing: {REMEDY}", &found[0]));
        };
        check_below(&there, files, depth + 1)?;
    }
    Ok(())
}

/// Returns a path in `file` as a path from the folder of the book; `None` for an absolute one.
fn resolved(file: &str, path: &str) -> Option<String> {
    let mut steps: Vec<&str> = file.split('/').collect();
    steps.pop();
    for step in path.trim().split('/') {
        match step {
            "" => return None,
            "." => {}
            ".." if steps.last().is_some_and(|last| *last != "..") => _ = steps.pop(),
            step => steps.push(step),
        }
    }
    Some(steps.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(page: &str) -> Result<(), String> {
        let files = [
            ("src/sub/a.md", page),
            ("src/note.txt", "one\ntwo\n"),
            ("src/round.txt", "{{#include round.txt}}"),
            ("src/nested.txt", "\n{{#include no.txt}}"),
            ("../pipeline/scenes/plate.toml", "title = \"t\"\n"),
        ];
        let files = files.map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()));
        check("src/sub/a.md", &BTreeMap::from(files))
    }

    #[test]
    fn what_includes_nothing_is_named_with_its_line() {
        for page in [
            "{{#include ../note.txt}} and {{ #include ./../note.txt }}",
            "```toml\n{{#include ../../../pipeline/scenes/plate.toml}}\n```",
            r"\{{#include no.txt}} and {{#include no.txt}}",
            "{{include no.txt}}",
        ] {
            assert_eq!(checked(page), Ok(()), "{page}");
        }
        for page in [
            "{{#include no.txt}}",
            "{{#include note.txt}}",
            "{{#include /etc/passwd}}",
            "{{#include ../../../Cargo.toml}}",
            "{{#include ../../../../pipeline/scenes/plate.toml}}",
            "```rust\n{{#rustdoc_include ../note.txt:2:3}}\n```",
            "{{#playground no.rs}}",
            "{{#include ../note.txt:1}}",
            "{{#include}}",
            "{{#if x}}",
            "{{#include ../round.txt}}",
        ] {
            let error = checked(&format!("# A\n\n{page}\n")).unwrap_err();
            let line = 3 + usize::from(page.starts_with("```"));
            let place = format!("src/sub/a.md:{line}: `{{{{#");
            assert!(error.starts_with(&place) || page.contains("round"), "{error}");
            assert!(error.contains("nothing: write ") && !error.contains('\n'), "{error}");
        }
        let error = checked("{{#include ../nested.txt}}").unwrap_err();
        assert!(error.starts_with("src/nested.txt:2: `{{#include no.txt}}`"), "{error}");
    }
}
