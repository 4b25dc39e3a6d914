//! Advisory locks of the operating system, which die with their process: for one alone, or for several.

use crate::pipeline::error::{Error, IoContext, Result};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::Path;

/// Held as long as this process may write to what the lock stands for.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Takes the lock whose file is `path` alone; the file and its folder are created if need be.
    ///
    /// # Errors
    /// [`Error::Input`] naming the process that holds it; [`Error::Io`].
    pub fn take(path: &Path) -> Result<Self> {
        let mut file = open(path)?;
        if !tried(file.try_lock(), path)? {
            let folder = path.parent().unwrap_or(path).display();
            return Err(Error::input(format!(
                "another signorini ({}) is at work in {folder}; wait for it",
                holder(&mut file)
            )));
        }
        Ok(Self::signed(file, &alone()))
    }

    /// The same, but waits for whoever holds the lock, after `busy` was told who that is.
    ///
    /// # Errors
    /// [`Error::Io`], and [`Error::Input`] where the file system has no locks.
    pub fn wait(path: &Path, busy: &dyn Fn(&str)) -> Result<Self> {
        let mut file = open(path)?;
        if !tried(file.try_lock(), path)? {
            busy(&holder(&mut file));
            file.lock().map_err(|e| refused(&e, path))?;
        }
        Ok(Self::signed(file, &alone()))
    }

    /// Takes the lock together with all others who share it; waits for one who holds it alone.
    ///
    /// # Errors
    /// As [`Lock::wait`].
    pub fn share(path: &Path, busy: &dyn Fn(&str)) -> Result<Self> {
        let mut file = open(path)?;
        if !tried(file.try_lock_shared(), path)? {
            busy(&holder(&mut file));
            file.lock_shared().map_err(|e| refused(&e, path))?;
        }
        // All who share it write the same, so that it does not matter who comes first.
        Ok(Self::signed(file, SHARED))
    }

    /// The lock, with its holder's name in the file, if that can be written: on a full disk it cannot.
    fn signed(mut file: File, name: &str) -> Self {
        if holder(&mut file) != name {
            let text = format!("{name}\n");
            let write = |file: &mut File| {
                file.rewind()?;
                file.write_all(text.as_bytes())?;
                file.set_len(text.len() as u64)
            };
            if write(&mut file).is_err() {
                // Better no name than that of another.
                let _ = file.set_len(0);
            }
        }
        Self { _file: file }
    }
}

/// What those who share a lock are called.
const SHARED: &str = "`run --task`";

fn alone() -> String {
    format!("process {}", std::process::id())
}

fn open(path: &Path) -> Result<File> {
    let folder = path.parent().expect("a lock lies in a folder");
    fs::create_dir_all(folder).context("create", folder)?;
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false).open(path).context("open", path)
}

/// Who wrote last that it holds the lock: a courtesy, on which nothing depends.
fn holder(file: &mut File) -> String {
    let mut text = String::new();
    let _ = file.rewind().and_then(|()| file.read_to_string(&mut text));
    text.lines().next().unwrap_or("unknown process").into()
}

/// Whether the lock was to be had at once.
fn tried(lock: std::result::Result<(), TryLockError>, path: &Path) -> Result<bool> {
    match lock {
        Ok(()) => Ok(true),
        Err(TryLockError::WouldBlock) => Ok(false),
        Err(TryLockError::Error(e)) => Err(refused(&e, path)),
    }
}

fn refused(e: &io::Error, path: &Path) -> Error {
    Error::input(format!("cannot lock {}: {e}; use a file system that has locks", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_an_earlier_holder_goes_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/lock");
        drop(Lock::take(&path).unwrap());
        fs::write(&path, "process 123456789012345 of another system\nand more\n").unwrap();
        let named = holder(&mut File::open(&path).unwrap());
        assert_eq!(named, "process 123456789012345 of another system", "in one line");
        let _held = Lock::take(&path).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), format!("{}\n", alone()));
    }
}
