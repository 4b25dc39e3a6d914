//! Settings of a book: its title, in `book.toml`, and what else mdBook asks.

use mdbook_driver::config::{Config, HtmlConfig, Search};
use serde::Deserialize;
use signorini_pipeline::error::{Error, Result, from_toml};
use signorini_pipeline::names::refuse_forbidden;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Name of the file in messages.
const NAME: &str = "report/book.toml";

/// Folder of mdBook's theme, from that of `book.toml`. Of `report/theme` it has the fonts alone: other files would
/// replace mdBook's own.
pub(super) const THEME: &str = "../theme-of-mdbook";

/// Settings of a book.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct Settings {
    title: Option<Line>,
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

impl Settings {
    /// Reads and checks `book.toml`.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of a mistake.
    pub(super) fn read(book_toml: &[u8]) -> Result<Self> {
        from_toml(NAME, book_toml)
    }

    /// Returns the settings of mdBook for a book with these files, given by their paths from the folder of `book.toml`;
    /// styles and scripts in `report/theme` are of all pages.
    pub(super) fn of_mdbook(&self, files: &BTreeMap<String, Vec<u8>>) -> Config {
        let mut config = Config::default();
        config.book.title = self.title.as_ref().map(|title| title.0.clone());
        config.build.create_missing = false;
        // A readme is a page like any other.
        config.build.use_default_preprocessors = false;
        let mut search = Search::default();
        search.limit_results = 20;
        search.use_boolean_and = true;
        let mut html = HtmlConfig::default();
        html.theme = Some(THEME.into());
        html.additional_css = of_theme(files, ".css");
        html.additional_js = of_theme(files, ".js");
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

/// Returns the paths of the files in `report/theme` itself with this ending.
fn of_theme(files: &BTreeMap<String, Vec<u8>>, ending: &str) -> Vec<PathBuf> {
    let of_theme = files.keys().filter(|path| {
        path.strip_prefix("theme/")
            .is_some_and(|name| !name.contains('/') && name.ends_with(ending))
    });
    of_theme.map(PathBuf::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_title_is_taken_and_mistakes_have_their_line() {
        let files = ["theme/a.css", "theme/b.js", "theme/fonts/c.css", "src/d.css"];
        let files = files.map(|name| (name.to_owned(), Vec::new())).into();
        let config = Settings::read(b"title = \"T\"\n").unwrap().of_mdbook(&files);
        assert_eq!(config.book.title.as_deref(), Some("T"));
        for (key, name) in [("css", "theme/a.css"), ("js", "theme/b.js")] {
            let key = format!("output.html.additional-{key}");
            assert_eq!(config.get::<Vec<String>>(&key).unwrap().unwrap(), [name]);
        }
        for (text, line, said) in [
            ("[book\n", 1, ""),
            ("title = \"x\"\nmultilingual = false\n", 2, "expected `title`"),
            ("[output.html]\n", 1, "expected `title`"),
            ("title = 3\n", 1, "expected a string"),
            ("title = \"\"\"a\\u0001\"\"\"\n", 1, "U+0001"),
        ] {
            let error = Settings::read(text.as_bytes()).err().unwrap().to_string();
            assert!(error.starts_with(&format!("report/book.toml: line {line}: ")), "{error}");
            assert!(error.contains(said) && !error.contains('\n'), "{error}");
        }
    }
}
