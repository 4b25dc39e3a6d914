//! One run at a time: an advisory lock of the operating system, which dies with its process.

use crate::pipeline::error::{Error, IoContext, Result};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::Path;

/// Name of the lock in the cache folder.
pub(super) const FILE: &str = "lock";

/// Held as long as this process may write to the cache.
#[derive(Debug)]
pub struct CacheLock {
    _file: File,
}

impl CacheLock {
    /// Takes the lock of the cache in `folder`, which is created if need be.
    ///
    /// # Errors
    /// [`Error::Input`] naming the process that holds it; [`Error::Io`].
    pub fn take(folder: &Path) -> Result<Self> {
        fs::create_dir_all(folder).context("create", folder)?;
        let path = folder.join(FILE);
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .context("open", &path)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                // The holder's name is a courtesy; the refusal stands without it.
                let _ = file.read_to_string(&mut holder);
                return Err(Error::input(format!(
                    "another signorini ({}) is using {}; wait for it, or give --cache-dir",
                    if holder.is_empty() { "unknown process" } else { holder.trim() },
                    folder.display()
                )));
            }
            Err(TryLockError::Error(e)) => return Err(e).context("lock", &path),
        }
        file.set_len(0).context("write", &path)?;
        writeln!(file, "process {}", std::process::id()).context("write", &path)?;
        Ok(Self { _file: file })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_taker_is_told_who_holds_it() {
        let folder = tempfile::tempdir().unwrap();
        let held = CacheLock::take(folder.path()).unwrap();
        let refused = CacheLock::take(folder.path()).unwrap_err().to_string();
        assert!(refused.contains(&format!("process {}", std::process::id())), "{refused}");
        drop(held);
        CacheLock::take(folder.path()).unwrap();
    }
}
