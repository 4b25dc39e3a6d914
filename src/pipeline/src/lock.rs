//! Advisory locks of the operating system, held by one process alone or shared; they end with their process.

use crate::error::{Error, IoContext, Result};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::Path;

/// Lock, held as long as the value exists.
#[derive(Debug)]
pub struct Lock {
    _file: File,
}

impl Lock {
    /// Takes the lock whose file is `path` for this process alone; creates the file and its folder if they do not
    /// exist.
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

    /// Takes the lock for this process alone; if another holds it, tells `busy` the holder, and waits.
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

    /// Takes the lock together with all others that share it; if another holds it alone, tells `busy` the holder, and
    /// waits.
    ///
    /// # Errors
    /// As [`Lock::wait`].
    pub fn share(path: &Path, busy: &dyn Fn(&str)) -> Result<Self> {
        let mut file = open(path)?;
        if !tried(file.try_lock_shared(), path)? {
            busy(&holder(&mut file));
            file.lock_shared().map_err(|e| refused(&e, path))?;
        }
        // All that share it write the same name, so that their order has no effect.
        Ok(Self::signed(file, SHARED))
    }

    /// Returns the lock, and writes its holder's name to the file, unless the disk is full.
    ///
    /// Writes the same name again: the time of the file is then the last at which the lock was taken.
    fn signed(mut file: File, name: &str) -> Self {
        if write_name(&mut file, name).is_err() {
            // The name of an earlier holder would be wrong.
            let _ = file.set_len(0);
        }
        Self { _file: file }
    }
}

fn write_name(file: &mut File, name: &str) -> io::Result<()> {
    let text = format!("{name}\n");
    file.rewind()?;
    file.write_all(text.as_bytes())?;
    file.set_len(text.len() as u64)
}

/// Name of the holders of a shared lock.
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

/// Returns the name of the last holder, for messages only.
fn holder(file: &mut File) -> String {
    let mut text = String::new();
    let _ = file.rewind().and_then(|()| file.read_to_string(&mut text));
    text.lines().next().unwrap_or("unknown process").into()
}

/// Returns true if the lock was free, false if another holds it.
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
