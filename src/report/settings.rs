//! Settings of mdBook in `book.toml`. A run must know of each file that the book is made from, and mdBook may write
//! into its own folder alone: every path in the settings lies in the folder of `book.toml`.

use super::line::line;
use super::paths::{is_inside, plain};
use crate::pipeline::error::{Error, Result, from_toml};
use crate::pipeline::names::refuse_forbidden;
use mdbook_driver::config::{Config, HtmlConfig};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of the file in messages.
const NAME: &str = "report/book.toml";

/// Settings that mdBook reads only when it needs them, without a word on their mistakes.
#[derive(Default, Deserialize)]
#[serde(default)]
struct ReadLate {
    output: Outputs,
    preprocessor: BTreeMap<String, Program>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Outputs {
    html: HtmlConfig,
}

/// Outputs that programs make.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Made {
    output: BTreeMap<String, Program>,
}

/// Table of an output, or of a preprocessor.
#[derive(Default, Deserialize)]
#[serde(default)]
pub(super) struct Program {
    /// Program with its arguments; none for the usual name.
    pub command: Option<String>,
    /// True if nothing is said when the program is missing.
    pub optional: bool,
}

/// Settings of a book, read and checked as far as `book.toml` alone allows.
pub(super) struct Settings<'a> {
    text: &'a str,
    /// Settings as mdBook takes them.
    pub config: Config,
    /// Settings of the pages in HTML.
    pub html: HtmlConfig,
    /// Outputs by name, without those that mdBook makes itself.
    pub outputs: BTreeMap<String, Program>,
    /// Preprocessors by name, without those of mdBook itself.
    pub preprocessors: BTreeMap<String, Program>,
}

impl<'a> Settings<'a> {
    /// Reads and checks `book.toml`, but for the programs that it names.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of a mistake, or of a path that leads out of the folder.
    pub(super) fn read(book_toml: &'a [u8]) -> Result<Self> {
        let mut config: Config = from_toml(NAME, book_toml)?;
        let ReadLate { output: Outputs { html }, mut preprocessor } = from_toml(NAME, book_toml)?;
        let Made { mut output } = from_toml(NAME, book_toml)?;
        output.retain(|name, _| !["html", "markdown"].contains(&name.as_str()));
        preprocessor.retain(|name, _| !["links", "index"].contains(&name.as_str()));
        config.build.create_missing = false;
        let text = std::str::from_utf8(book_toml).expect("parsed as text");
        let settings = Self { text, config, html, outputs: output, preprocessors: preprocessor };
        settings.check_folders()?;
        settings.check_texts()?;
        settings.check_paths()?;
        Ok(settings)
    }

    /// True if mdBook makes HTML.
    pub(super) fn has_html(&self) -> bool {
        self.config.contains_key("output.html") || self.number_of_outputs() == 0
    }

    /// Returns the folder of the HTML in the built book; mdBook makes a folder for each output if there are several.
    pub(super) fn html_folder(&self) -> Option<&'static str> {
        self.has_html().then_some(if self.number_of_outputs() > 1 { "html/" } else { "" })
    }

    fn number_of_outputs(&self) -> usize {
        let makes = |name: &&&str| self.config.contains_key(&format!("output.{name}"));
        ["html", "markdown"].iter().filter(makes).count() + self.outputs.len()
    }

    /// True if mdBook's own preprocessor with this name works on the pages.
    pub(super) fn is_on(&self, preprocessor: &str) -> bool {
        self.config.build.use_default_preprocessors
            || self.config.contains_key(&format!("preprocessor.{preprocessor}"))
    }

    /// mdBook empties the first folder and may write to the second: neither may hold files of the user.
    fn check_folders(&self) -> Result<()> {
        for (keys, folder, ours) in [
            (["build", "build-dir"], &self.config.build.build_dir, "book"),
            (["book", "src"], &self.config.book.src, "src"),
        ] {
            if folder != Path::new(ours) {
                let said =
                    format!("{} is `{}`, but must be `{ours}`", keys.join("."), folder.display());
                return Err(self.refusal(&keys, &said));
            }
        }
        Ok(())
    }

    fn check_texts(&self) -> Result<()> {
        let book = &self.config.book;
        let html = &self.html;
        let texts = [
            (&["book", "title"][..], &book.title),
            (&["book", "description"], &book.description),
            (&["book", "language"], &book.language),
            (&["output", "html", "cname"], &html.cname),
            (&["output", "html", "site-url"], &html.site_url),
            (&["output", "html", "git-repository-url"], &html.git_repository_url),
            (&["output", "html", "edit-url-template"], &html.edit_url_template),
        ];
        let authors = book.authors.iter().map(|author| (&["book", "authors"][..], author));
        let texts = texts.into_iter().filter_map(|(keys, text)| Some((keys, text.as_ref()?)));
        for (keys, text) in texts.chain(authors) {
            let what = keys.join(".");
            refuse_forbidden(&what, text).map_err(|e| self.refusal(keys, &e.to_string()))?;
        }
        Ok(())
    }

    /// Refuses paths that lead out of the folder of `book.toml`.
    fn check_paths(&self) -> Result<()> {
        for (keys, path) in self.paths() {
            if !is_inside(&path) {
                let said = format!(
                    "{} is `{path}`, which leads out of report/; copy what it names into report/, and name the copy \
                     by its path there",
                    keys[..3].join(".")
                );
                return Err(self.refusal(&borrowed(&keys), &said));
            }
        }
        for name in self.html.redirect.keys() {
            let page = redirected(name);
            if !is_inside(page) || page.ends_with('/') {
                let said = format!(
                    "the redirect from `{name}` is none from a page of the book; name the page by its path in the \
                     book, as \"/old.html\""
                );
                return Err(self.refusal(&["output", "html", "redirect", name], &said));
            }
        }
        Ok(())
    }

    /// Returns the files and folders that the settings name, each by its path in the folder of `book.toml`, or for the
    /// page on errors in that of the pages, with the keys of the setting.
    fn paths(&self) -> Vec<(Vec<String>, String)> {
        let mut paths = Vec::new();
        let mut add = |keys: &[&str], path: &str| {
            let keys = ["output", "html"].iter().chain(keys).map(|key| (*key).to_owned());
            paths.push((keys.collect(), path.to_owned()));
        };
        for (key, files) in self.added() {
            for (k, file) in files.iter().enumerate() {
                add(&[key, &k.to_string()], &file.to_string_lossy());
            }
        }
        if let Some(theme) = &self.html.theme {
            add(&["theme"], &theme.to_string_lossy());
        }
        if let Some(page) = self.html.input_404.as_ref().filter(|page| !page.is_empty()) {
            add(&["input-404"], page);
        }
        paths
    }

    /// Returns the lists of files for the pages, each with its key.
    fn added(&self) -> [(&'static str, &[PathBuf]); 2] {
        [("additional-css", &self.html.additional_css), ("additional-js", &self.html.additional_js)]
    }

    /// Refuses settings that name none of `files`, whose paths begin in the folder of `book.toml`.
    pub(super) fn check_files(&self, files: &BTreeMap<String, Vec<u8>>) -> Result<()> {
        for (keys, path) in self.paths() {
            let plain = plain(&path);
            let (is_there, kind) = match keys[2].as_str() {
                "theme" => {
                    let inside = format!("{plain}/");
                    (files.keys().any(|name| name.starts_with(&inside)), "folder with files")
                }
                "input-404" => {
                    let is_page =
                        files.contains_key(&format!("src/{plain}")) && plain.ends_with(".md");
                    (is_page, "page `*.md` in report/templates")
                }
                _ => (files.contains_key(&plain), "file in report/"),
            };
            if !is_there {
                let setting = keys[..3].join(".");
                let template = plain.strip_prefix("templates/").map(|name| format!("src/{name}"));
                let said = match template.filter(|name| files.contains_key(name)) {
                    Some(name) => format!(
                        "{setting} is `{path}`, whose name for mdBook is `{name}`; write that"
                    ),
                    None => {
                        format!("{setting} is `{path}`, but there is no such {kind}; put it there")
                    }
                };
                return Err(self.refusal(&borrowed(&keys), &said));
            }
        }
        Ok(())
    }

    /// Refuses a file for the pages, or a redirect, in the place of a file that mdBook makes; `is_made` says whether it
    /// makes one of this name.
    pub(super) fn check_names(&self, is_made: impl Fn(&str) -> bool) -> Result<()> {
        for (key, files) in self.added() {
            for (k, file) in files.iter().enumerate() {
                let file = plain(&file.to_string_lossy());
                if is_made(&file) {
                    let said = format!(
                        "{key} names `{file}`, but mdBook makes a file of this name itself; rename this one"
                    );
                    return Err(self.refusal(&["output", "html", key, &k.to_string()], &said));
                }
            }
        }
        for name in self.html.redirect.keys().filter(|name| !name.contains('#')) {
            if is_made(redirected(name)) {
                let said = format!(
                    "the redirect from `{name}` is from a page that the book has; leave it out"
                );
                return Err(self.refusal(&["output", "html", "redirect", name], &said));
            }
        }
        Ok(())
    }

    /// Returns an error with the line of a setting.
    pub(super) fn refusal(&self, keys: &[&str], said: &str) -> Error {
        Error::input(format!("{NAME}: line {}: {said}", line(self.text, keys)))
    }
}

fn borrowed(keys: &[String]) -> Vec<&str> {
    keys.iter().map(String::as_str).collect()
}

/// Returns the path in the book from which a redirect leads; mdBook ignores slashes before it.
fn redirected(name: &str) -> &str {
    let path = name.rsplit_once('#').map_or(name, |(path, _)| path);
    path.trim_start_matches('/')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        let error = Settings::read(text.as_bytes()).err().unwrap().to_string();
        assert!(!error.contains('\n'), "{error}");
        error
    }

    #[test]
    fn paths_that_lead_out_are_refused_with_their_line() {
        let html = "[output.html]\n";
        for (text, line) in [
            ("additional-css = [\"/a.css\"]", 2),
            ("additional-css = [\n  \"a.css\",\n  \"../a.css\"]", 4),
            ("additional-js = [\"b/../../a.js\"]", 2),
            ("theme = \"../theme\"", 2),
            ("theme = \"/theme\"", 2),
            ("input-404 = \"../404.md\"", 2),
            ("cname = \"x\"\nredirect = { \"/../x.html\" = \"a.html\" }", 3),
            ("[output.html.redirect]\n\"/a.html\" = \"b.html\"\n\"../x.html#y\" = \"a.html\"", 4),
        ] {
            let error = error(&format!("{html}{text}\n"));
            assert!(
                error.starts_with(&format!("report/book.toml: line {line}: ")),
                "{text}: {error}"
            );
        }
    }

    #[test]
    fn paths_that_stay_inside_are_taken() {
        let good = "[output.html]\nadditional-css = [\"./a.css\", \"theme/b.css\"]\n\
            theme = \"./theme\"\ninput-404 = \"\"\n\
                    [output.html.redirect]\n\"/old/a.html\" = \"https://a.b\"\n\"a.html#x\" = \"b.html\"\n\
                    [output.x]\ncommand = \"sh -c 'cat > /dev/null; echo x > made.txt'\"\n\
                    [output.y]\ncommand = \"python3 ../../tools/y.py --base=/\"\n[output.markdown]\n\
                    [preprocessor.z]\ncommand = \"tools/z\"\n[preprocessor.links]\n";
        assert!(Settings::read(good.as_bytes()).is_ok());
    }

    #[test]
    fn mistakes_have_their_line() {
        for (text, line, said) in [
            ("[book\n", 1, ""),
            ("[book]\ntitle = \"x\"\nmultilingual = false\n", 3, "unknown field `multilingual`"),
            ("[output.html]\ncopy-fonts = true\n", 2, "unknown field `copy-fonts`"),
            ("[output.html.search]\nenable = 1\n", 2, "expected a boolean"),
            ("[output.x]\ncommand = 3\n", 2, "expected a string"),
            ("[preprocessor.x]\ncommand = 3\n", 2, "expected a string"),
            ("[book]\nsrc = \"pages\"\n", 2, "must be `src`"),
            ("[build]\n\nbuild-dir = \"../x\"\n", 3, "must be `book`"),
            ("[book]\nauthors = [\"A\", \"B\\uFFFF\"]\n", 2, "U+FFFF"),
            ("[book]\ntitle = \"\"\"a\\u0001\"\"\"\n", 2, "U+0001"),
        ] {
            let error = error(text);
            assert!(error.starts_with(&format!("report/book.toml: line {line}: ")), "{error}");
            assert!(error.contains(said), "{error}");
        }
    }
}
