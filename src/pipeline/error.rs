//! The one error type above the mathematics: a line that names the remedy, and an exit code.

use serde::de::DeserializeOwned;
use std::io;
use std::path::{Path, PathBuf};

/// Why a command ended early. Each kind has its exit code; see [`Error::exit_code`].
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Wrong input or configuration; the text names the remedy.
    #[error("{0}")]
    Input(String),
    /// A name that nothing has; the text says which there are.
    #[error("{0}")]
    Unknown(String),
    /// The system refused to read or write.
    #[error("cannot {verb} {}: {source}; {remedy}", path.display())]
    Io {
        /// What was tried: `read`, `write`, ...
        verb: &'static str,
        /// On what.
        path: PathBuf,
        /// The system's words.
        source: io::Error,
        /// What the user can do.
        remedy: &'static str,
    },
    /// Tasks that failed, each with its reason.
    #[error("{}", .0.join("\n"))]
    Stage(Vec<String>),
    /// Ctrl-C.
    #[error("interrupted; what was finished is kept, repeat the command to go on")]
    Interrupted,
}

/// What every fallible function above the mathematics returns.
pub type Result<T> = std::result::Result<T, Error>;

/// Why a task could not do its work: whatever went wrong below, in words.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

impl Error {
    /// Wrong input or configuration.
    pub fn input(text: impl Into<String>) -> Self {
        Self::Input(text.into())
    }

    /// Exit code of the process: 2 for input and I/O, 3 for a failed stage, 130 when interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(_) | Self::Unknown(_) | Self::Io { .. } => 2,
            Self::Stage(_) => 3,
            Self::Interrupted => 130,
        }
    }
}

/// Description of what [`conflict`] finds.
pub(crate) const CONFLICT: &str = "conflict of a merge";

/// Line of the first conflict that `git merge` marked in a text, if there is one.
pub(crate) fn conflict(text: &[u8]) -> Option<usize> {
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

/// Turns an I/O result into ours, with the path and a remedy that fits the kind of failure.
pub trait IoContext<T> {
    /// Names what was tried on which path.
    ///
    /// # Errors
    /// The I/O error, as [`Error::Io`].
    fn context(self, verb: &'static str, path: &Path) -> Result<T>;
}

impl<T> IoContext<T> for io::Result<T> {
    fn context(self, verb: &'static str, path: &Path) -> Result<T> {
        self.map_err(|source| {
            let remedy = match source.kind() {
                io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                    "free some space (`signorini gc` helps) and repeat the command: what a run has finished is kept"
                }
                io::ErrorKind::FileTooLarge => {
                    "raise the limit on file sizes (`ulimit -f`) and repeat the command: what a run has finished is kept"
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
