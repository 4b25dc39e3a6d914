//! One run at a time: an advisory lock of the operating system, which dies with its process.

use crate::pipeline::error::{Error, IoContext, Result};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::Path;

/// Held as long as this process may write to what the lock stands for.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Takes the lock whose file is `path`; the file and its folder are created if need be.
    ///
    /// # Errors
    /// [`Error::Input`] naming the process that holds it; [`Error::Io`].
    pub fn take(path: &Path) -> Result<Self> {
        let folder = path.parent().expect("a lock lies in a folder");
        fs::create_dir_all(folder).context("create", folder)?;
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .context("open", path)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                // The holder's name is a courtesy; the refusal stands without it.
                let _ = file.read_to_string(&mut holder);
                return Err(Error::input(format!(
                    "another signorini ({}) is at work in {}; wait for it",
                    if holder.is_empty() { "unknown process" } else { holder.trim() },
                    folder.display()
                )));
            }
            Err(TryLockError::Error(e)) => return Err(e).context("lock", path),
        }
        file.set_len(0).context("write", path)?;
        writeln!(file, "process {}", std::process::id()).context("write", path)?;
        Ok(Self { _file: file })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_taker_is_told_who_holds_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/lock");
        let held = Lock::take(&path).unwrap();
        let refused = Lock::take(&path).unwrap_err().to_string();
        assert!(refused.contains(&format!("process {}", std::process::id())), "{refused}");
        drop(held);
        // What an earlier holder wrote goes whole, however long it was.
        fs::write(&path, "process 123456789012345 of another system\n").unwrap();
        let _held = Lock::take(&path).unwrap();
        let says = fs::read_to_string(&path).unwrap();
        assert_eq!(says, format!("process {}\n", std::process::id()));
    }
}
