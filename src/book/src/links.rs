//! Check of the links and pictures of a page: their targets must exist.

use super::markdown::{parse, place};
use percent_encoding::percent_decode_str;
use pulldown_cmark::{Event, LinkType, Tag};
use regex::Regex;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::LazyLock;

/// Text that looks like a link or a picture of a file with a space in its name, but is plain text in Markdown.
static SPACED: LazyLock<Regex> = LazyLock::new(|| {
    let pattern = r"\[[^\[\]\n]*\]\(([^()<>\x22'\n]* [^()<>\x22'\n]*\.[A-Za-z0-9]{1,5})\)";
    Regex::new(pattern).expect("the pattern is tested")
});

/// Refuses a link or a picture of a chapter without a target in the built book; `page` is the page of the chapter.
///
/// Links to other sites and to the top of this one are not followed, and tags of HTML are not read.
pub(super) fn check(
    chapter: &str,
    markdown: &str,
    page: &str,
    site: &Site<'_>,
) -> Result<(), String> {
    let mut text: Vec<Range<usize>> = Vec::new();
    for (event, range) in parse(markdown) {
        if matches!(event, Event::Text(_)) {
            // The parser ends a text at each bracket.
            match text.last_mut().filter(|last| last.end == range.start) {
                Some(last) => last.end = range.end,
                None => text.push(range),
            }
            continue;
        }
        let Event::Start(
            Tag::Link { link_type, dest_url, .. } | Tag::Image { link_type, dest_url, .. },
        ) = event
        else {
            continue;
        };
        if link_type != LinkType::Email
            && let Err(why) = site.follow(page, &dest_url)
        {
            let at = place(chapter, markdown, range.start);
            return Err(format!("{at}: the link to `{dest_url}` leads nowhere: {why}"));
        }
    }
    text.into_iter().try_for_each(|range| refuse_spaces(chapter, markdown, range))
}

/// Refuses text that is meant as a link or a picture, but is plain text because of the space in the name of its file.
fn refuse_spaces(chapter: &str, markdown: &str, text: Range<usize>) -> Result<(), String> {
    let Some(found) = SPACED.captures(&markdown[text.clone()]) else { return Ok(()) };
    let at = place(chapter, markdown, text.start + found.get(1).map_or(0, |name| name.start()));
    let name = &found[1];
    Err(format!("{at}: a space ends the link to `{name}`; write (<{name}>)"))
}

/// Returns the target of a link as mdBook writes it: links to pages in Markdown become links to their HTML. Of what
/// follows the ending, only an anchor is kept.
fn written(target: &str) -> String {
    match target.rsplit_once(".md") {
        Some((page, anchor)) if anchor.starts_with('#') => format!("{page}.html{anchor}"),
        Some((page, _)) if !target.starts_with('#') => format!("{page}.html"),
        _ => target.to_owned(),
    }
}

/// True if a link begins with a scheme, such as `https:`; a browser takes every such link for one to another place.
fn has_scheme(target: &str) -> bool {
    target.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

/// Built book in which links are followed.
pub(super) struct Site<'a> {
    built: &'a BTreeMap<String, Vec<u8>>,
    /// Names of places in the pages to which links led.
    anchors: RefCell<BTreeMap<String, BTreeSet<String>>>,
}

impl<'a> Site<'a> {
    pub(super) fn new(built: &'a BTreeMap<String, Vec<u8>>) -> Self {
        Self { built, anchors: RefCell::default() }
    }

    /// Follows a link of the file `page` of the book, as a browser does.
    ///
    /// # Errors
    /// The reason for which the target does not exist.
    fn follow(&self, page: &str, target: &str) -> Result<(), String> {
        if target.starts_with('/') || has_scheme(target) {
            return Ok(());
        }
        let written = written(target);
        let (path, fragment) = written.split_once('#').unwrap_or((&written, ""));
        let path = decoded(path.split('?').next().unwrap_or_default());
        let Some(file) = resolved(page, &path) else {
            // Above the book there may be more of a site, but none of its pages.
            return match target.contains(".md") {
                true => Err("it leads out of the book".into()),
                false => Ok(()),
            };
        };
        let is_folder = path.ends_with('/')
            || ["", ".", ".."].contains(&path.rsplit('/').next().unwrap_or_default());
        let file = match !path.is_empty() && is_folder {
            true => format!("{file}/index.html").trim_start_matches('/').to_owned(),
            false => file,
        };
        let Some(bytes) = self.built.get(&file) else {
            let remedy = match file.ends_with(".html") {
                true => "; its pages are those in SUMMARY.md",
                false => "",
            };
            return Err(format!("the book has no {file}{remedy}"));
        };
        match self.has_place(&file, bytes, fragment) {
            true => Ok(()),
            false => Err(format!(
                "{file} has no heading with this id, its text in small letters and - for spaces"
            )),
        }
    }

    /// True if a browser finds the place in the file.
    fn has_place(&self, file: &str, bytes: &[u8], fragment: &str) -> bool {
        // Text to be looked for is a hint, and other files than pages have rules of their own.
        let id = fragment.split(":~:").next().unwrap_or_default();
        if id.is_empty() || id.eq_ignore_ascii_case("top") || !file.ends_with(".html") {
            return true;
        }
        let mut known = self.anchors.borrow_mut();
        let places = known
            .entry(file.to_owned())
            .or_insert_with(|| anchors(&String::from_utf8_lossy(bytes)));
        places.contains(id) || places.contains(&decoded(id))
    }
}

/// Returns the path in the book to which a path in `page` leads; `None` if it leads out of the book.
fn resolved(page: &str, path: &str) -> Option<String> {
    let mut steps: Vec<&str> = page.split('/').collect();
    if !path.is_empty() {
        steps.pop();
    }
    for step in path.split('/').filter(|step| !["", "."].contains(step)) {
        match step {
            ".." => _ = steps.pop()?,
            step => steps.push(step),
        }
    }
    Some(steps.join("/"))
}

/// Returns the names of the places in a page to which links may lead, as mdBook writes them.
fn anchors(html: &str) -> BTreeSet<String> {
    let places = html.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next());
    let quotes = [
        ("&quot;", "\""),
        ("&#39;", "'"),
        ("&#x27;", "'"),
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&amp;", "&"),
    ];
    let unescaped = |place: &str| {
        quotes.iter().fold(place.to_owned(), |text, (from, to)| text.replace(from, to))
    };
    places.map(unescaped).collect()
}

/// Decodes `%20` and its like.
fn decoded(part: &str) -> String {
    percent_decode_str(part).decode_utf8_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks a link in the page `a` or `sub/b` of a small book, on line 3.
    fn checked(page: &str, link: &str) -> Result<(), String> {
        let html = "<h1 id=\"one\"></h1><h2 id=\"größe\"></h2><a id=\"x1\"></a>".as_bytes();
        let files = ["index.html", "a.html", "sub/b.html", "figures/my plate.svg", "results.csv"];
        let built = BTreeMap::from(files.map(|name| (name.to_owned(), html.to_vec())));
        let markdown = format!("# One\n\n{link}\n");
        check(&format!("src/{page}.md"), &markdown, &format!("{page}.html"), &Site::new(&built))
    }

    #[test]
    fn what_leads_nowhere_is_named_with_its_line() {
        for link in [
            "[x](sub/b.md), [x](sub/b.html?q#one), [x](#one), [x](#größe), [x](#gr%C3%B6%C3%9Fe), [x]()",
            "[x](./results.csv), ![x](figures/my%20plate.svg), ![x](<figures/my plate.svg>)",
            "[x](https://nowhere.md), [x](//nowhere.md), [x](/nowhere), <a@b.c>, [x](mailto:a@b.c), `[x](nowhere.md)`",
            "[x][y]\n\n[y]: a.md#one",
            "[x](#x1), [x](a.html#x1), [x](#top), [x](#), [x](a.md#), [x](sub/b.md?q=1#one), [x](#one:~:text=a)",
            "[x](./), [x](.), [x](./#one), [x](../), [x](../other/), [x](figures/my%20plate.svg#svgView(1,1))",
            "[x](git+ssh://a.b/c.md), [x](tel:+49-1), [x](?q)",
        ] {
            assert_eq!(checked("a", link), Ok(()), "{link}");
        }
        let links = "[x](../a.md), [x](b.md#one) and ![x](../figures/my%20plate.svg)";
        assert_eq!(checked("sub/b", links), Ok(()));
        for (link, why) in [
            ("[x](nowhere.md)", "`nowhere.md` leads nowhere: the book has no nowhere.html"),
            ("![x](figures/no.svg)", "the book has no figures/no.svg"),
            ("[x](#two)", "`#two` leads nowhere: a.html has no heading with this id"),
            ("[x](sub/b.md#two)", "sub/b.html has no heading"),
            ("[x][y]\n\n[y]: b.md", "the book has no b.html"),
            ("[x](../a.md)", "leads out of the book"),
            ("[x](#One)", "has no heading"),
            ("[x](sub/)", "the book has no sub/index.html"),
        ] {
            let error = checked("a", link).unwrap_err();
            assert!(error.starts_with("src/a.md:3: ") && error.contains(why), "{error}");
        }
        let error = checked("sub/b", "[x](a.md)").unwrap_err();
        assert!(error.contains("the book has no sub/a.html"), "{error}");
        for link in ["![x](figures/my plate.svg)", "*see* [the x](my notes.pdf), and"] {
            let error = checked("a", link).unwrap_err();
            assert!(error.starts_with("src/a.md:3: a space ends the link to `"), "{error}");
        }
        for prose in [
            "a[1](see the end.)",
            "`![x](my plate.svg)`",
            "$f[x](a b.c)$",
            "[x](results.csv \"a b.c\")",
        ] {
            assert_eq!(checked("a", prose), Ok(()), "{prose}");
        }
    }
}
