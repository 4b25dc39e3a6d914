//! Settings of mdBook, of which a book has its title alone.

use mdbook_driver::config::{Config, HtmlConfig, Search};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Folder of mdBook's theme, from that of the book. Of `report/theme` it has the fonts alone: other files would replace
/// mdBook's own.
pub(super) const THEME: &str = "../theme-of-mdbook";

/// Returns the settings of mdBook for a book with this title and these files, given by their paths in its folder;
/// styles and scripts in `report/theme` are of all pages.
pub(super) fn of_mdbook(title: Option<&str>, files: &BTreeMap<String, Vec<u8>>) -> Config {
    let mut config = Config::default();
    config.book.title = title.map(str::to_owned);
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
    fn styles_and_scripts_of_the_theme_are_of_all_pages() {
        let files = ["theme/a.css", "theme/b.js", "theme/fonts/c.css", "src/d.css"];
        let files = files.map(|name| (name.to_owned(), Vec::new())).into();
        let config = of_mdbook(Some("T"), &files);
        assert_eq!(config.book.title.as_deref(), Some("T"));
        for (key, name) in [("css", "theme/a.css"), ("js", "theme/b.js")] {
            let key = format!("output.html.additional-{key}");
            assert_eq!(config.get::<Vec<String>>(&key).unwrap().unwrap(), [name]);
        }
    }
}
