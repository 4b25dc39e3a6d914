//! Files that tasks read: hashed in pieces when somebody asks for the hash, read whole when a task or a check needs the
//! bytes, each at most once in a process.

use super::Inputs;
use super::files::{hash_of, if_there, read};
use super::hash;
use crate::error::{Error, IoContext, Result};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Files by path in the project.
pub type InputFiles = BTreeMap<String, InputFile>;

/// File that tasks read. Copies share what is known of the contents.
#[derive(Clone, Debug)]
pub struct InputFile(Arc<Content>);

/// Contents of a file, as far as they are known.
#[derive(Debug)]
struct Content {
    path: PathBuf,
    bytes: OnceLock<Vec<u8>>,
    hash: OnceLock<String>,
    /// Held by the thread that reads the file, so that others wait for what it finds.
    reading: Mutex<()>,
}

impl InputFile {
    /// Returns the file with this path, of which nothing is read yet.
    pub fn new(path: PathBuf) -> Self {
        let (bytes, hash) = (OnceLock::new(), OnceLock::new());
        Self(Arc::new(Content { path, bytes, hash, reading: Mutex::new(()) }))
    }

    /// Returns the file with this path and these contents.
    pub fn with(path: PathBuf, bytes: Vec<u8>) -> Self {
        let file = Self::new(path);
        // The cell is new, and so empty.
        let _ = file.0.bytes.set(bytes);
        file
    }

    /// Returns the file with this path, `None` if it does not exist.
    ///
    /// # Errors
    /// [`Error::Io`] if the system does not tell, or the path is a link to nothing.
    pub fn if_there(path: &Path) -> Result<Option<Self>> {
        Ok(if_there(path, fs::metadata(path))?.map(|_| Self::new(path.to_path_buf())))
    }

    /// Returns the hexadecimal blake3 of the contents.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read.
    pub fn hash(&self) -> Result<&str> {
        let Content { path, bytes, hash, reading } = &*self.0;
        if let Some(known) = hash.get() {
            return Ok(known);
        }
        let _reading = reading.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = hash.get() {
            return Ok(known);
        }
        let found = match bytes.get() {
            Some(bytes) => super::hash(bytes),
            None => hash_of(path).context("read", path)?,
        };
        Ok(hash.get_or_init(|| found))
    }

    /// Returns the contents.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be read; [`Error::Input`] if it was changed since it was hashed.
    pub fn bytes(&self) -> Result<&[u8]> {
        let Content { path, bytes, hash: known, reading } = &*self.0;
        if let Some(bytes) = bytes.get() {
            return Ok(bytes);
        }
        let _reading = reading.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(bytes) = bytes.get() {
            return Ok(bytes);
        }
        let found = read(path).context("read", path)?;
        if known.get().is_some_and(|known| *known != hash(&found)) {
            let path = path.display();
            return Err(Error::input(format!("{path} was changed while signorini ran; run again")));
        }
        Ok(bytes.get_or_init(|| found))
    }
}

impl Inputs<'_> {
    /// Returns the contents of a file that the task names, `None` if it names no file with this path.
    ///
    /// # Errors
    /// As [`InputFile::bytes`].
    pub fn file(&self, path: &str) -> Result<Option<&[u8]>> {
        self.files.get(path).map(InputFile::bytes).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_hashed_once_and_read_once_whoever_asks() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh");
        fs::write(&path, "one").unwrap();
        let file = InputFile::if_there(&path).unwrap().unwrap();
        let copy = file.clone();
        assert_eq!(file.hash().unwrap(), hash(b"one"));
        assert_eq!(copy.bytes().unwrap(), b"one");
        // Nobody could read it now.
        fs::remove_file(&path).unwrap();
        assert_eq!((copy.hash().unwrap(), file.bytes().unwrap()), (&*hash(b"one"), &b"one"[..]));
        assert!(InputFile::if_there(&path).unwrap().is_none());
        assert!(InputFile::new(path).hash().unwrap_err().to_string().contains("check the path"));
    }

    #[test]
    fn bytes_other_than_those_that_were_hashed_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh");
        fs::write(&path, "one").unwrap();
        let file = InputFile::new(path.clone());
        file.hash().unwrap();
        fs::write(&path, "two").unwrap();
        assert!(file.bytes().unwrap_err().to_string().contains("was changed while signorini ran"));
        let other = InputFile::with(path, b"three".to_vec());
        assert_eq!(other.hash().unwrap(), hash(b"three"));
    }
}
