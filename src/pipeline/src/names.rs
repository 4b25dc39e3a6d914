//! Names of files: those of files that no one means to keep and characters that none may have.

use crate::error::{Error, Result};
use crate::files::{folder_of, is_forbidden};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use unicode_normalization::UnicodeNormalization;

/// Beginnings of the names of hidden files, of locks and of files of office programs.
const BEGINNINGS: [&str; 3] = [".", "#", "~"];

/// Endings of backups, of files that are being written or loaded, and of files that merges and patches leave.
const ENDINGS: [&str; 10] =
    ["~", "#", ".bak", ".orig", ".part", ".rej", ".swp", ".tmp", "desktop.ini", "thumbs.db"];

/// True if the name is one that operating systems, editors and other programs give to files of their own, which are
/// neither read nor published. Capitals do not count.
pub fn is_left_behind(name: &str) -> bool {
    let small = name.to_lowercase();
    // A page whose name does not end with `.md` or `.md.tera` is a copy of that page.
    let is_copy = small.split_once(".md.").is_some_and(|(_, end)| end != "tera");
    BEGINNINGS.iter().any(|beginning| small.starts_with(beginning))
        || ENDINGS.iter().any(|ending| small.ends_with(ending))
        || is_copy
}

/// Returns a text with its accents in one of the two ways to write them. Files from a Mac have names in the other one:
/// whatever names are looked up is compared in this form.
pub fn composed(text: &str) -> String {
    // Nearly every text, and without accents.
    if text.is_ascii() { text.to_owned() } else { text.nfc().collect() }
}

/// Returns the path of a file that exists, whichever way its names write accents; the path as it is if there is none.
pub fn found(path: &Path) -> PathBuf {
    let mut place = PathBuf::new();
    for part in path {
        let exact = place.join(part);
        let other = || {
            let wanted = composed(part.to_str()?);
            let mut entries = folder_of(&exact).read_dir().ok()?.flatten();
            let is_alike =
                |name: &OsStr| name.to_str().is_some_and(|name| composed(name) == wanted);
            Some(place.join(entries.find(|entry| is_alike(&entry.file_name()))?.file_name()))
        };
        place = match exact.exists() || exact.is_symlink() {
            true => exact,
            false => other().unwrap_or(exact),
        };
    }
    place
}

/// True if two names are one where file names ignore capitals, or write accents the other way.
pub fn are_alike(one: &str, other: &str) -> bool {
    composed(one).to_lowercase() == composed(other).to_lowercase()
}

/// Returns a word of a command as a shell reads it.
pub fn in_shell(word: &str) -> String {
    match !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || "/._=-".contains(c)) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

/// Returns a text of at most about `most` characters: of a longer one, such as an f of many pieces, without its middle.
pub fn shortened(text: &str, most: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= most {
        return text.to_owned();
    }
    let [start, end] = [&letters[..most / 2], &letters[letters.len() - most / 2..]];
    format!("{} ... {}", String::from_iter(start), String::from_iter(end))
}

/// Refuses a text with a character that no line of text may have; `what` names the text.
///
/// # Errors
/// [`Error::Input`], with the remedy.
pub fn refuse_forbidden(what: &str, text: &str) -> Result<()> {
    refuse_with(what, text, "take it out")
}

/// Refuses a name with a character that no line of text may have; `what` is named by it.
///
/// # Errors
/// [`Error::Input`], with the remedy.
pub fn refuse_forbidden_name(what: &str, name: &str) -> Result<()> {
    refuse_with(&format!("the name of {what} {name:?}"), name, &format!("rename the {what}"))
}

fn refuse_with(what: &str, text: &str, remedy: &str) -> Result<()> {
    match text.chars().find(|c| is_forbidden(*c)) {
        None => Ok(()),
        Some(c) => Err(Error::input(format!("{what} has {}; {remedy}", described(c)))),
    }
}

/// Returns the words for a character that no one sees.
pub fn described(c: char) -> String {
    format!("the character U+{:04X}, which no line of text may have", u32::from(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_programs_leave_is_told_from_what_people_keep() {
        for name in [
            "~$notes.docx",
            ".~lock.notes.odt#",
            "~WRL0001.tmp",
            "photo.png.part",
            "x.TMP",
            "plate.md~",
            "plate.md.~1~",
            "#plate.md#",
            ".plate.md.swp",
            ".plate.md.kate-swp",
            "plate.md.sb-0815-abc",
            "plate.bak",
            "plate.orig",
            "THUMBS.DB",
            "Desktop.ini",
            ".DS_Store",
            "._photo.png",
        ] {
            assert!(is_left_behind(name), "{name:?}");
        }
        for name in [
            "plate.md",
            "plate.md.tera",
            "a.old.txt",
            "2024",
            "LICENSE",
            "part.md",
            "download.svg",
            "x_LOCAL_min.svg",
            "template.toml",
            "backup",
        ] {
            assert!(!is_left_behind(name), "{name:?}");
        }
    }
}
