//! Programs that `book.toml` names. A run knows a program by its bytes: one with a path lies in the folder of
//! `book.toml`, one without is looked for where the system looks.

use super::paths::{is_inside, plain};
use super::settings::{Program, Settings};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::hash;
use std::collections::BTreeMap;
use std::env;
use std::path::{Component, Path, PathBuf};

/// Characters between the words of a script in an argument.
const BETWEEN: &str = " \t\n;|&<>()=\"'`,";

/// Program with its arguments, as a table of `book.toml` asks for it.
pub(super) struct CommandLine {
    /// Table of `book.toml`: `output` or `preprocessor`.
    pub kind: &'static str,
    /// Name of the table.
    pub name: String,
    /// Program, and its arguments.
    pub words: Vec<String>,
}

impl CommandLine {
    /// Splits the command of a table into words.
    ///
    /// # Errors
    /// A sentence if there are none.
    pub(super) fn of(
        kind: &'static str,
        name: &str,
        table: &Program,
    ) -> std::result::Result<Self, String> {
        let line = table.command.clone().unwrap_or(format!("mdbook-{name}"));
        let words = shlex::split(&line).filter(|words| !words.is_empty());
        let words = words.ok_or_else(|| format!("`{line}` is no command; mend [{kind}.{name}]"))?;
        Ok(Self { kind, name: name.to_owned(), words })
    }

    /// Returns the path of the program in the folder of `book.toml`; `None` if the system looks for it.
    pub(super) fn path(&self) -> Option<&str> {
        Some(self.words[0].as_str()).filter(|word| word.contains(['/', std::path::MAIN_SEPARATOR]))
    }

    /// Refuses paths that lead out of the folder of `book.toml`.
    fn check(&self) -> std::result::Result<(), String> {
        let inside = "a run must know when it changes: copy it into report/";
        if let Some(path) = self.path().filter(|path| !is_inside(path) || path.starts_with('~')) {
            return Err(format!(
                "the program `{path}` leads out of report/, and {inside}, or install it and name it without a path"
            ));
        }
        // Outputs are made in the folder of their name.
        let depth = if self.kind == "output" { 2 } else { 0 };
        let mut words = self.words[1..].iter().flat_map(|word| word.split(|c| BETWEEN.contains(c)));
        match words.find(|word| leads_out(word, depth)) {
            None => Ok(()),
            Some(word) => Err(format!("the argument `{word}` leads out of report/, and {inside}")),
        }
    }
}

/// True if a word is a path that leads out of a folder so many folders above; files of devices hold nothing.
fn leads_out(word: &str, above: i32) -> bool {
    if ["~/", "$HOME", "${HOME"].iter().any(|home| word.starts_with(home)) || word == "~" {
        return true;
    }
    let path = Path::new(word);
    if path.is_absolute() {
        return path.parent().is_some() && (path.is_file() || path.is_dir());
    }
    let mut depth = above;
    path.components().any(|part| {
        match part {
            Component::ParentDir => depth -= 1,
            Component::Normal(_) => depth += 1,
            _ => (),
        }
        depth < 0
    })
}

/// Returns the programs of a book.
fn lines(settings: &Settings<'_>) -> Result<Vec<CommandLine>> {
    let tables = [("output", &settings.outputs), ("preprocessor", &settings.preprocessors)];
    let tables =
        tables.into_iter().flat_map(|(kind, tables)| tables.iter().map(move |one| (kind, one)));
    let line = |(kind, (name, table)): (&'static str, (&String, &Program))| {
        CommandLine::of(kind, name, table).map_err(|e| refusal(settings, [kind, name], &e))
    };
    tables.map(line).collect()
}

fn refusal(settings: &Settings<'_>, [kind, name]: [&str; 2], said: &str) -> Error {
    settings.refusal(&[kind, name, "command"], said)
}

/// Refuses programs, arguments and names of outputs that lead out of the folder of `book.toml`.
pub(super) fn check(settings: &Settings<'_>) -> Result<()> {
    for line in lines(settings)? {
        let CommandLine { kind, name, .. } = &line;
        if name.contains(['/', '\\']) || !is_inside(name) {
            let said = format!("`{name}` names no folder for an output; rename it");
            return Err(settings.refusal(&[kind, name], &said));
        }
        line.check().map_err(|e| refusal(settings, [kind, name], &e))?;
    }
    Ok(())
}

/// Refuses a program with a path that is none of `files`.
pub(super) fn check_files(
    settings: &Settings<'_>,
    files: &BTreeMap<String, Vec<u8>>,
) -> Result<()> {
    for line in lines(settings)? {
        if let Some(path) = line.path().filter(|path| !files.contains_key(&plain(path))) {
            let said = format!(
                "the program is `{path}`, but there is no such file in report/; put it there"
            );
            return Err(refusal(settings, [line.kind, &line.name], &said));
        }
    }
    Ok(())
}

/// Returns the paths of the programs in the folder of `book.toml`.
pub(super) fn own(settings: &Settings<'_>) -> Result<Vec<String>> {
    let lines = lines(settings)?;
    Ok(lines.iter().filter_map(CommandLine::path).map(plain).collect())
}

/// Returns the hashes of the programs for which the system looks, by name; in place of a missing one's hash, `missing`.
pub(crate) fn hashes(book_toml: &[u8]) -> BTreeMap<String, String> {
    // A mistake in `book.toml` is said before anything runs.
    let lines = Settings::read(book_toml).and_then(|settings| lines(&settings)).unwrap_or_default();
    let names = lines.iter().filter(|line| line.path().is_none()).map(|line| &line.words[0]);
    names
        .map(|name| (name.clone(), found(name).map_or("missing".into(), |bytes| hash(&bytes))))
        .collect()
}

/// Returns the bytes of the program that the system finds under a name.
fn found(name: &str) -> Option<Vec<u8>> {
    let folders = env::var_os("PATH")?;
    let mut paths = env::split_paths(&folders).map(|folder: PathBuf| folder.join(name));
    std::fs::read(paths.find(|path| path.is_file())?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(text: &str) -> Result<()> {
        check(&Settings::read(text.as_bytes()).unwrap())
    }

    #[test]
    fn programs_that_lead_out_are_refused_with_their_line() {
        let html = "[output.html]\n";
        for (text, line) in [
            ("[output.\"../x\"]\ncommand = \"true\"", 2),
            ("[output.x]\ncommand = \"/bin/true\"", 3),
            ("[output.x]\ncommand = \"../true\"", 3),
            ("[output.x]\ncommand = \"sh ../../../x\"", 3),
            ("[output.x]\ncommand = \"sh -c 'cat < /bin/sh'\"", 3),
            ("[preprocessor.x]\ncommand = \"~/bin/x\"", 3),
            ("[preprocessor.x]\nbefore = [\"links\"]\ncommand = \"sh ../x\"", 4),
            ("[preprocessor.x]\ncommand = \"sh --from=/bin\"", 3),
            ("[output.x]\ncommand = \"'\"\n", 3),
        ] {
            let error = checked(&format!("{html}{text}\n")).unwrap_err().to_string();
            let place = format!("report/book.toml: line {line}: ");
            assert!(error.starts_with(&place), "{text}: {error}");
        }
        let good = "[output.x]\ncommand = \"sh -c 'cat > /dev/null; echo x > made.txt'\"\n\
                    [output.y]\ncommand = \"python3 ../../tools/y.py --base=/\"\n\
                    [preprocessor.z]\ncommand = \"./tools/z\"\n";
        checked(good).unwrap();
    }

    #[test]
    fn a_program_that_the_system_finds_is_known_by_its_bytes() {
        let toml = "[output.x]\ncommand = \"sh -c true\"\n[output.none-such]\n\
             [preprocessor.y]\ncommand = \"tools/y\"\n";
        let hashes = hashes(toml.as_bytes());
        assert_eq!(hashes.keys().collect::<Vec<_>>(), ["mdbook-none-such", "sh"]);
        assert_eq!(hashes["mdbook-none-such"], "missing");
        assert_eq!(hashes["sh"].len(), 64);
    }
}
