//! Settings of a book, in `book.toml`: six keys, each of which may be left out. What else mdBook asks is said here.

use crate::pipeline::error::{Error, Result, from_toml};
use crate::pipeline::names::refuse_forbidden;
use mdbook_driver::config::{Config, HtmlConfig, Search, SearchChapterSettings};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Name of the file in messages.
const NAME: &str = "report/book.toml";

/// Folder of mdBook's theme, from that of `book.toml`. Of `report/theme` it has the fonts alone: other files would
/// replace mdBook's own.
pub(super) const THEME: &str = "../theme-of-mdbook";

/// Ends of the names of pages with numbers and hashes, which nobody looks for by words: the search leaves them out.
const NOT_SEARCHED: [&str; 2] = ["-tables.md", "provenance.md"];

/// Settings of a book.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Settings {
    title: Option<Line>,
    description: Option<Line>,
    authors: Vec<Line>,
    language: Option<Line>,
    css: Vec<ThemeFile>,
    js: Vec<ThemeFile>,
}

/// Text on one line.
#[derive(Deserialize)]
#[serde(try_from = "String")]
struct Line(String);

impl TryFrom<String> for Line {
    type Error = Error;

    fn try_from(text: String) -> Result<Self> {
        refuse_forbidden("the text", &text).map(|()| Self(text))
    }
}

/// Path from `report` of a file in `report/theme`, where none is in the place of a file that mdBook makes.
#[derive(Deserialize)]
#[serde(try_from = "String")]
struct ThemeFile(String);

impl TryFrom<String> for ThemeFile {
    type Error = Error;

    fn try_from(path: String) -> Result<Self> {
        let name = path.strip_prefix("theme/").unwrap_or_default();
        match name.is_empty() || name.contains(['/', '\\']) {
            true => Err(Error::input(format!(
                "`{path}` is no file in report/theme; put it there, and write its name after `theme/`"
            ))),
            false => Ok(Self(path)),
        }
    }
}

impl Settings {
    /// Reads and checks `book.toml`.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of a mistake, of one in a list with that of the list.
    pub(super) fn read(book_toml: &[u8]) -> Result<Self> {
        from_toml(NAME, book_toml)
    }

    /// Refuses settings that name a file which is none of `files`, given by their paths from the folder of `book.toml`.
    pub(super) fn check_files(
        &self,
        files: &BTreeMap<String, Vec<u8>>,
    ) -> std::result::Result<(), String> {
        match self.css.iter().chain(&self.js).find(|file| !files.contains_key(&file.0)) {
            None => Ok(()),
            Some(ThemeFile(path)) => Err(format!(
                "{NAME} names `{path}`, but there is no such file in report/; put it there"
            )),
        }
    }

    /// Returns the settings of mdBook for a book with these pages, given by their paths among the pages.
    pub(super) fn of_mdbook<'a>(&self, pages: impl Iterator<Item = &'a str>) -> Config {
        let mut config = Config::default();
        config.book.title = text(self.title.as_ref());
        config.book.description = text(self.description.as_ref());
        config.book.authors = self.authors.iter().map(|author| author.0.clone()).collect();
        config.book.language = text(self.language.as_ref()).or(config.book.language);
        config.build.create_missing = false;
        // A readme is a page like any other.
        config.build.use_default_preprocessors = false;
        let mut search = Search::default();
        search.limit_results = 20;
        search.use_boolean_and = true;
        for page in pages.filter(|page| NOT_SEARCHED.iter().any(|end| page.ends_with(end))) {
            let mut left_out = SearchChapterSettings::default();
            left_out.enable = Some(false);
            search.chapter.insert(page.into(), left_out);
        }
        let mut html = HtmlConfig::default();
        html.theme = Some(THEME.into());
        html.additional_css = paths(&self.css);
        html.additional_js = paths(&self.js);
        html.playground.runnable = false;
        html.search = Some(search);
        // There is no server that could ask for it, and its links would be absolute.
        html.input_404 = Some(String::new());
        config.set("output.html", html).expect("a table of settings");
        let includes = BTreeMap::<String, String>::new();
        config.set("preprocessor.links", includes).expect("an empty table");
        config
    }
}

fn text(line: Option<&Line>) -> Option<String> {
    line.map(|line| line.0.clone())
}

fn paths(files: &[ThemeFile]) -> Vec<PathBuf> {
    files.iter().map(|file| PathBuf::from(&file.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_keys_are_taken_and_mistakes_have_their_line() {
        let all = "title = \"T\"\ndescription = \"D\"\nauthors = [\"A\", \"B\"]\nlanguage = \"ru\"\n\
                   css = [\"theme/a.css\"]\njs = [\"theme/a.js\"]\n";
        let config = Settings::read(all.as_bytes()).unwrap().of_mdbook(["a.md"].into_iter());
        assert_eq!(
            (config.book.title.as_deref(), config.book.language.as_deref()),
            (Some("T"), Some("ru"))
        );
        let css: Vec<String> = config.get("output.html.additional-css").unwrap().unwrap();
        assert_eq!(css, ["theme/a.css"]);
        let six = "expected one of `title`, `description`, `authors`, `language`, `css`, `js`";
        for (text, line, said) in [
            ("[book\n", 1, ""),
            ("title = \"x\"\nmultilingual = false\n", 2, six),
            ("[output.html]\n", 1, six),
            ("title = 3\n", 1, "expected a string"),
            ("authors = [\n\"A\",\n\"B\\uFFFF\"]\n", 1, "U+FFFF"),
            ("title = \"\"\"a\\u0001\"\"\"\n", 1, "U+0001"),
            ("\ncss = [\"/a.css\"]\n", 2, "is no file in report/theme"),
            ("css = [\n\"theme/a.css\",\n\"theme/../a.css\"]\n", 1, "is no file in report/theme"),
            ("js = [\"book.js\"]\n", 1, "is no file in report/theme"),
        ] {
            let error = Settings::read(text.as_bytes()).err().unwrap().to_string();
            assert!(error.starts_with(&format!("report/book.toml: line {line}: ")), "{error}");
            assert!(error.contains(said) && !error.contains('\n'), "{error}");
        }
    }
}
