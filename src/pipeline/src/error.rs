//! The one error type above the mathematics: a line that names the remedy, and an exit code.

use serde::de::DeserializeOwned;
use std::io;
use std::path::{Path, PathBuf};

/// Reason for which a command ended early. Each kind has an exit code; see [`Error::exit_code`].
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Wrong input or configuration; the text names the remedy.
    #[error("{0}")]
    Input(String),
    /// Unknown name; the text lists the known ones.
    #[error("{0}")]
    Unknown(String),
    /// The system refused to read or write.
    #[error("cannot {verb} {}: {source}; {remedy}", path.display())]
    Io {
        /// Verb for the attempt: `read`, `write`, ...
        verb: &'static str,
        /// Path of the attempt.
        path: PathBuf,
        /// Error of the system.
        source: io::Error,
        /// Advice to the user.
        remedy: &'static str,
    },
    /// Tasks that failed, or an answer that is not what was asked for, each with its reason.
    #[error("{}", .0.join("\n"))]
    Stage(Vec<String>),
    /// Ctrl-C.
    #[error("interrupted; what was finished is kept, repeat the command to go on")]
    Interrupted,
}

/// Result of every fallible function above the mathematics.
pub type Result<T> = std::result::Result<T, Error>;

/// Reason for which a task could not do its work: any error from below.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

impl Error {
    /// Returns the error for wrong input or configuration.
    pub fn input(text: impl Into<String>) -> Self {
        Self::Input(text.into())
    }

    /// Exit code of the process: 2 for input and I/O, 3 for what failed, 130 when interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) | Self::Unknown(_) | Self::Io { .. } => 2,
            Self::Stage(_) => 3,
            Self::Interrupted => 130,
        }
    }
}

/// Name for a [`conflict`] in messages.
pub const CONFLICT: &str = "conflict of a merge";

/// Returns the line of the first conflict that `git merge` marked in a text, if there is one.
pub fn conflict(text: &[u8]) -> Option<usize> {
    let mut lines = text.split(|&byte| byte == b'\n').enumerate();
    let (first, _) = lines.find(|(_, line)| line.starts_with(b"<<<<<<< "))?;
    lines.find(|(_, line)| line.trim_ascii_end() == b"=======")?;
    lines.find(|(_, line)| line.starts_with(b">>>>>>> "))?;
    Some(first + 1)
}

/// Reads TOML; `what` names it in messages.
///
/// # Errors
/// [`Error::Input`] with the line of the mistake, or if the text is not UTF-8.
pub fn from_toml<T: DeserializeOwned>(what: &str, text: impl AsRef<[u8]>) -> Result<T> {
    let text = std::str::from_utf8(text.as_ref())
        .map_err(|_| Error::input(format!("{what} is not UTF-8; save it as UTF-8")))?;
    toml::from_str(text).map_err(|error| {
        if let Some(line) = conflict(text.as_bytes()) {
            return Error::input(format!("{what}: line {line}: {CONFLICT}; resolve it there"));
        }
        let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
        let message = error.message().replace('\n', " ");
        Error::input(format!("{what}: line {line}: {message}"))
    })
}

/// Number of the format of the files that this program writes and reads back, which they have as `schema`.
pub(crate) const SCHEMA: u64 = 1;

/// Reads TOML that this program, or one of this project, has written; `what` names it in messages.
///
/// # Errors
/// As [`from_toml`]; of a file with a greater number of format, or with a key that this program does not know, the text
/// asks whether a newer program has written it.
pub fn from_record<T: DeserializeOwned>(what: &str, text: impl AsRef<[u8]>) -> Result<T> {
    let table: toml::Table = from_toml(what, &text)?;
    if let Some(found) = table.get("schema").and_then(toml::Value::as_integer) {
        refuse_newer(what, found as u64)?;
    }
    from_toml(what, text).map_err(|error| match error.to_string().contains("unknown field") {
        true => Error::input(format!(
            "{error}, which signorini {VERSION} does not know; {BY_A_NEWER_ONE}"
        )),
        false => error,
    })
}

/// Refuses a file that this program writes with a greater number of format.
pub(crate) fn refuse_newer(what: &str, schema: u64) -> Result<()> {
    match schema > SCHEMA {
        true => Err(Error::input(format!(
            "{what} has schema {schema} that signorini {VERSION} does not know; {BY_A_NEWER_ONE}"
        ))),
        false => Ok(()),
    }
}

/// Version of this program.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Question on a file that this program does not understand.
const BY_A_NEWER_ONE: &str = "was it written by a newer one?";

/// Turns an I/O result into ours, with the path and a remedy that fits the kind of failure.
pub trait IoContext<T> {
    /// Adds the attempt, as a verb, and its path.
    ///
    /// # Errors
    /// The I/O error, as [`Error::Io`].
    fn context(self, verb: &'static str, path: &Path) -> Result<T>;
}

impl<T> IoContext<T> for io::Result<T> {
    fn context(self, verb: &'static str, path: &Path) -> Result<T> {
        self.map_err(|source| {
            let remedy = match source.kind() {
                // Without a kind of its own in the library.
                _ if source.to_string().starts_with("Too many levels of symbolic links") => {
                    "it links to itself: remove the link"
                }
                io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                    "free some space (`signorini gc` helps) and repeat the command: what a run has finished is kept"
                }
                io::ErrorKind::FileTooLarge => {
                    "raise the limit on file sizes (`ulimit -f`) and repeat the command: what a run has finished is \
                     kept"
                }
                io::ErrorKind::InvalidData => "save it as UTF-8",
                io::ErrorKind::InvalidFilename => "rename it",
                io::ErrorKind::IsADirectory
                | io::ErrorKind::AlreadyExists
                | io::ErrorKind::Unsupported => "move it away",
                io::ErrorKind::PermissionDenied
                | io::ErrorKind::ReadOnlyFilesystem
                | io::ErrorKind::NotADirectory => {
                    "make it accessible, or choose another place (for the cache with --cache-dir)"
                }
                io::ErrorKind::NotFound => "check the path",
                _ => "run again; if it persists, look after the disk",
            };
            Error::Io { verb, path: path.to_path_buf(), source, remedy }
        })
    }
}
