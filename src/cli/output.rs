//! Output of the program: data on standard output, messages on standard error, files that the user named.

use crate::pipeline;
use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::{folder_of, link_target, write_atomically};
use crate::pipeline::names::in_shell;
use crate::pipeline::place::{place, real, without_dots};
use crate::replication::project::Project;
use crate::table::Table;
use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use terminal_size::terminal_size_of;
use unicode_width::UnicodeWidthStr;

/// Writes data to standard output; a reader that has closed it is no error.
pub(super) fn say(text: &str) -> Result<u8> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(0),
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(0),
        Err(e) => Err(Error::input(format!(
            "cannot write to standard output: {e}; redirect it elsewhere"
        ))),
    }
}

/// Writes lines for people to standard output, on a terminal no longer than its lines.
pub(super) fn tell(text: &str) -> Result<u8> {
    say(&fitted(text, columns_of(&std::io::stdout())))
}

/// Writes a line on standard error, on a terminal as lines no longer than its own.
pub(super) fn talk(line: &str) {
    pipeline::talk(&for_talk(line));
}

/// Returns a line for standard error, on a terminal as lines no longer than its own.
pub(super) fn for_talk(line: &str) -> String {
    fitted(line, columns_of(&std::io::stderr()))
}

/// Number of columns of a terminal; without limit for what is none, or does not say.
pub(super) fn columns_of(stream: &(impl IsTerminal + std::os::fd::AsFd)) -> usize {
    if !stream.is_terminal() {
        return usize::MAX;
    }
    let columns = terminal_size_of(stream).map(|(width, _)| usize::from(width.0));
    columns.filter(|&columns| columns > 0).unwrap_or(usize::MAX)
}

/// Returns a text with the lines that are longer than `width` broken between words, and not between the groups of three
/// digits of a number; what follows is indented.
pub(super) fn fitted(text: &str, width: usize) -> String {
    const MORE: &str = "  ";
    let mut lines = Vec::new();
    for line in text.split('\n') {
        // No character takes more columns than bytes.
        if line.len() <= width || shown_width(line) <= width {
            lines.push(line.to_owned());
            continue;
        }
        let indent = &line[..line.len() - line.trim_start_matches(' ').len()];
        let mut last = String::new();
        for word in words(line) {
            let is_begun = !last.trim().is_empty();
            if is_begun && shown_width(&last) + shown_width(word.trim_end()) > width {
                lines.push(last.trim_end().to_owned());
                last = format!("{indent}{MORE}");
            }
            last += word;
        }
        lines.push(last);
    }
    lines.join("\n")
}

/// Splits a line into words, each with the space behind it; groups of digits are one word.
fn words(line: &str) -> Vec<&str> {
    let (mut words, mut start) = (Vec::new(), 0);
    for (at, _) in line.match_indices(' ') {
        let group = line[at + 1..].chars().take_while(char::is_ascii_digit).count();
        if group == 3 && line[..at].ends_with(|c: char| c.is_ascii_digit()) {
            continue;
        }
        words.push(&line[start..=at]);
        start = at + 1;
    }
    words.push(&line[start..]);
    words
}

/// Number of columns of a text on a terminal, on which the codes of colours take none.
fn shown_width(text: &str) -> usize {
    anstream::adapter::strip_str(text).to_string().width()
}

pub(super) fn say_json(value: &impl serde::Serialize) -> Result<u8> {
    let text = serde_json::to_string_pretty(value).expect("answers are plain data");
    say(&(text + "\n"))
}

pub(super) fn styled(text: &str, color: anstyle::AnsiColor) -> String {
    let style = anstyle::Style::new().fg_color(Some(color.into())).bold();
    format!("{style}{text}{style:#}")
}

/// Returns a table for standard output: on a terminal without the columns that it has no room for.
pub(super) fn in_columns(table: &Table) -> String {
    table.text_within(columns_of(&std::io::stdout()))
}

/// Returns a text for standard output with its long lines broken between words, on a terminal no longer than its lines.
pub(super) fn paragraph(text: &str) -> String {
    /// Columns of a long line that is none of a table.
    const WIDTH: usize = 80;
    fitted(text, WIDTH.min(columns_of(&std::io::stdout())))
}

/// Cuts a text to this number of columns; dots mark the cut.
pub(super) fn cut(text: &str, width: usize) -> String {
    if text.width() <= width {
        return text.to_owned();
    }
    let mut end = 0;
    for (at, c) in text.char_indices() {
        let next = at + c.len_utf8();
        if text[..next].width() + 3 > width {
            break;
        }
        end = next;
    }
    text[..end].trim_end().to_owned() + "..."
}

/// Quotes a path for a shell, to be copied into a command.
pub(super) fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    in_shell(&if text.starts_with('-') { format!("./{text}") } else { text })
}

/// Refuses a path that begins with `~`: a shell replaces that by a home folder, but not after an `=` or within quotes.
pub(super) fn refuse_tilde(path: &Path) -> Result<()> {
    let first = path.components().next().and_then(|part| part.as_os_str().to_str());
    match first.is_some_and(|first| first.starts_with('~')) {
        true => Err(Error::input(format!(
            "{}: the shell has left the `~` as it is; write \"$HOME\" in its place, or ./~ for a folder of this name",
            path.display()
        ))),
        false => Ok(()),
    }
}

/// Refuses a folder for output that does not exist: its name may be misspelt.
pub(super) fn is_there(folder: &Path) -> Result<()> {
    refuse_tilde(folder)?;
    if folder.is_dir() {
        return Ok(());
    }
    Err(Error::input(format!(
        "--output {}: no such folder; make it with `mkdir -p {}`",
        folder.display(),
        quoted(folder)
    )))
}

/// Refuses a place that the user named in the folders `not_in` of a project, and one to which a link leads out of a
/// project: of that to which the path belongs, and of that in which its links end.
pub(super) fn in_projects(path: &Path, what: &str, not_in: &[&str]) -> Result<()> {
    for start in [without_dots(path), real(path)] {
        if let Ok(root) = Project::find(&start) {
            place(&root, path, what, not_in)?;
        }
    }
    Ok(())
}

/// File that the user named, checked to be writable before the work whose result it will hold.
#[derive(Debug)]
pub(super) struct OutputFile {
    path: PathBuf,
}

impl OutputFile {
    /// Checks that `path` can be written.
    pub(super) fn check(path: &Path) -> Result<Self> {
        refuse_tilde(path)?;
        if !path.exists() || path.is_file() {
            in_projects(path, &path.display().to_string(), &["pipeline", ".git"])?;
        }
        Self::writable(path)
    }

    fn writable(path: &Path) -> Result<Self> {
        match why_not_writable(path)? {
            Some(why) => Err(Error::input(format!("cannot write {}: {why}", path.display()))),
            None => Ok(Self { path: path.to_path_buf() }),
        }
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn write(&self, bytes: &[u8]) -> Result<()> {
        // A pipe or a device can only be written in place.
        let written = match self.path.exists() && !self.path.is_file() {
            true => fs::write(&self.path, bytes).context("write", &self.path),
            false => write_atomically(&self.path, bytes),
        };
        written.map_err(|mut e| {
            if let Error::Io { source, remedy, .. } = &mut e
                && [ErrorKind::StorageFull, ErrorKind::QuotaExceeded, ErrorKind::FileTooLarge]
                    .contains(&source.kind())
            {
                *remedy = "free some space, raise the limit, or name a file elsewhere";
            }
            e
        })
    }
}

/// Returns, with a remedy, why a path cannot be written, if it cannot. The last folder on it need not be there.
fn why_not_writable(path: &Path) -> Result<Option<String>> {
    // `file_name` of `v.npy/` is `v.npy`.
    let is_folder = path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/");
    let Some(name) = path.file_name().filter(|_| !is_folder) else {
        return Ok(Some("it is a folder; name a file".into()));
    };
    let target = match link_target(path) {
        Ok(target) => target,
        Err(e) => return Ok(Some(format!("{e}; remove the link, or name another file"))),
    };
    if target != path && target.is_file() && target.extension() != path.extension() {
        return Ok(Some(format!(
            "it links to {}, a file of another kind; remove the link, or name another file",
            target.display()
        )));
    }
    let mut folder = folder_of(&target);
    if target == path && !folder.exists() && folder_of(folder).is_dir() {
        // It is made with the file.
        folder = folder_of(folder);
    }
    if !folder.is_dir() {
        return Ok(Some(match target == path {
            true => "no such folder; make it, or name another file".into(),
            false => format!(
                "it links to {}, where there is no such folder; make it, or name another file",
                target.display()
            ),
        }));
    }
    if path.exists() && !path.is_file() {
        return Ok(None);
    }
    if let Err(e) = OpenOptions::new().append(true).open(path)
        && e.kind() != ErrorKind::NotFound
    {
        return Ok(Some(format!("{e}; make it writable, or name another file")));
    }
    let trial = folder.join(format!(".{}.trial{}", name.to_string_lossy(), std::process::id()));
    if let Err(e) = OpenOptions::new().write(true).create_new(true).open(&trial) {
        return Ok(Some(format!("{e}; name a file elsewhere")));
    }
    fs::remove_file(&trial).context("remove", &trial)?;
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_character_takes_more_columns_than_bytes() {
        let wide = ('\0'..=char::MAX).find(|c| shown_width(&c.to_string()) > c.len_utf8());
        assert_eq!(wide, None);
    }

    #[test]
    fn lines_are_broken_between_words_and_only_where_they_must() {
        let text =
            "a table   stays  as it is\nwarning: the error may be as large as the solution\n";
        let broken =
            "a table   stays  as it is\nwarning: the error may be\n  as large as the\n  solution\n";
        assert_eq!(fitted(text, 25), broken);
        assert_eq!(fitted(text, usize::MAX), text);
        assert_eq!(
            fitted("  a word-that-is-too-long b", 8),
            "  a\n    word-that-is-too-long\n    b"
        );
        // A number is not broken between its groups of digits.
        assert_eq!(
            fitted("the 104 025 336 nodes 12 345", 12),
            "the\n  104 025 336\n  nodes\n  12 345"
        );
        assert_eq!(fitted("in 4 1000 ab", 6), "in 4\n  1000\n  ab");
        // The codes of colours take no columns, and wide letters two.
        let red = styled("error", anstyle::AnsiColor::Red);
        assert_eq!(fitted(&format!("{red}: 鍋鍋"), 11), format!("{red}: 鍋鍋"));
        assert_eq!(fitted(&format!("{red}: 鍋鍋"), 10), format!("{red}:\n  鍋鍋"));
    }

    #[test]
    fn a_cut_is_counted_as_a_terminal_shows_it() {
        assert_eq!(cut("鍋鍋鍋鍋", 8), "鍋鍋鍋鍋");
        assert_eq!(cut("鍋鍋鍋鍋", 7), "鍋鍋...");
        assert_eq!(cut("e\u{301}te\u{301}te\u{301}", 4), "e\u{301}...");
        assert_eq!(cut("abcd", 2), "...");
    }
}
