//! Files as bytes: read whole if they are files, written whole or not at all.

use crate::error::{IoContext, Result};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Component, Path, PathBuf};
use tempfile::NamedTempFile;

/// Beginning and end of the names of temporary files; the part between them is random.
const TEMPORARY: [&str; 2] = [".signorini-", ".tmp"];

/// Writes a whole file or nothing: to a temporary name in the same folder, synced, then renamed.
///
/// Links are followed, and a file that exists keeps its permissions. Other hard links to it keep the old bytes.
///
/// # Errors
/// [`Error::Io`](crate::error::Error::Io).
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<()> {
    let target = link_target(path).context("write", path)?;
    let kept = fs::metadata(&target).ok().map(|there| there.permissions());
    let folder = folder_of(&target);
    fs::create_dir_all(folder).context("create", folder)?;
    let write = || {
        let file = temporary_file(folder, bytes, kept.is_some())?;
        if let Some(permissions) = kept {
            file.as_file().set_permissions(permissions)?;
        }
        file.as_file().sync_all()?;
        file.persist(&target).map_err(io::Error::from)
    };
    write().context("write", &target)?;
    Ok(())
}

/// Returns the end of a chain of links, which need not exist; the path itself if it is no link.
///
/// # Errors
/// If the links form a circle.
pub fn link_target(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        match fs::read_link(&target) {
            Ok(next) => target = folder_of(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(io::Error::new(ErrorKind::Unsupported, "Too many levels of symbolic links"))
}

/// Number of links in a chain beyond which systems take it for a circle.
const MOST_LINKS: usize = 40;

/// Writes a whole file or nothing, with the temporary name in a folder that exists, on the same file system.
///
/// After a loss of power the file may be damaged: whoever reads it must know its hash.
pub(super) fn write_by_way_of(scratch: &Path, path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = folder_of(path);
    fs::create_dir_all(folder).context("create", folder)?;
    let write = || temporary_file(scratch, bytes, false)?.persist(path).map_err(io::Error::from);
    write().context("write", path)?;
    Ok(())
}

/// Writes a temporary file, private or with the permissions of any new file.
fn temporary_file(folder: &Path, bytes: &[u8], is_private: bool) -> io::Result<NamedTempFile> {
    let mut temporary = tempfile::Builder::new();
    temporary.prefix(TEMPORARY[0]).suffix(TEMPORARY[1]);
    // By default a temporary file is private. One with permissions to keep stays so until it has them.
    #[cfg(unix)]
    if !is_private {
        temporary.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    }
    let mut file = temporary.tempfile_in(folder)?;
    file.write_all(bytes)?;
    Ok(file)
}

/// Returns the folder of a file, the current folder if the path names none.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
}

/// Creates a folder in this one, which is removed when the value is dropped; [`leftovers`] finds it by its name.
///
/// # Errors
/// Those of the system.
pub fn temporary_folder(folder: &Path) -> io::Result<tempfile::TempDir> {
    fs::create_dir_all(folder)?;
    tempfile::Builder::new().prefix(TEMPORARY[0]).suffix(TEMPORARY[1]).tempdir_in(folder)
}

/// True if the name has the form that [`write_atomically`] gives to files that are not yet whole.
pub(super) fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY[0]) && name.ends_with(TEMPORARY[1])
}

/// Returns the temporary files and folders in those of these folders that can be read.
///
/// If no run is at work, runs that were killed have left them.
pub fn leftovers(folders: impl IntoIterator<Item = PathBuf>) -> Vec<PathBuf> {
    let mut leftovers = Vec::new();
    for entries in folders.into_iter().filter_map(|folder| fs::read_dir(folder).ok()) {
        for entry in entries.flatten() {
            if is_temporary(&entry.file_name().to_string_lossy()) {
                leftovers.push(entry.path());
            }
        }
    }
    leftovers
}

/// Removes the [`leftovers`]; the caller holds the lock.
pub fn remove(leftovers: &[PathBuf]) {
    for path in leftovers {
        // A leftover that cannot be removed does no harm.
        let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    }
}

/// Removes a file, and the folders up to `top` that it leaves empty.
///
/// # Errors
/// [`Error::Io`](crate::error::Error::Io).
pub(super) fn remove_from(top: &Path, file: &Path) -> Result<()> {
    fs::remove_file(file).context("remove", file)?;
    for folder in file.ancestors().skip(1).take_while(|folder| *folder != top) {
        // Fails for a folder that is not empty.
        if fs::remove_dir(folder).is_err() {
            break;
        }
    }
    Ok(())
}

/// Returns the contents of a file, or of the file to which a link points; refuses a path that is neither file nor
/// folder, such as a pipe, which may never end.
///
/// # Errors
/// Those of the system, and for such a path.
pub(super) fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    read_in_pieces(path, |piece| bytes.extend_from_slice(piece))?;
    Ok(bytes)
}

/// Passes the contents of a file to `pass`, piece by piece, in as few calls of the system as possible.
fn read_in_pieces(path: &Path, mut pass: impl FnMut(&[u8])) -> io::Result<()> {
    thread_local!(static PIECE: RefCell<Vec<u8>> = RefCell::new(vec![0; 1 << 17]));
    let there = fs::metadata(path)?;
    refuse_special(&there)?;
    let mut file = File::open(path)?;
    let mut read = 0;
    PIECE.with_borrow_mut(|piece| {
        loop {
            let length = match file.read(piece) {
                Err(e) if e.kind() == ErrorKind::Interrupted => continue,
                length => length?,
            };
            pass(&piece[..length]);
            read += length as u64;
            // A file of the length that the system tells needs no further call to find its end.
            if length == 0 || read == there.len() {
                return Ok(());
            }
        }
    })
}

/// Refuses what is neither file nor folder, such as a pipe.
fn refuse_special(there: &Metadata) -> io::Result<()> {
    if there.is_file() || there.is_dir() {
        return Ok(());
    }
    Err(io::Error::new(ErrorKind::Unsupported, "it is neither a file nor a folder"))
}

/// Returns the hexadecimal blake3 of a file, `None` if it does not exist.
pub(super) fn hash_if_there(path: &Path) -> Result<Option<String>> {
    if_there(path, hash_of(path))
}

/// Returns the hexadecimal blake3 of a file, which is read in pieces.
pub(super) fn hash_of(path: &Path) -> io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    read_in_pieces(path, |piece| {
        hasher.update(piece);
    })?;
    Ok(hasher.finalize().to_hex().to_string())
}

/// Returns the contents of a file, `None` if it does not exist.
///
/// # Errors
/// [`Error::Io`](crate::error::Error::Io) if it exists and cannot be read.
pub fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>> {
    if_there(path, read(path))
}

/// Turns the error that a file or folder does not exist into `None`; a link to nothing exists.
pub(super) fn if_there<T>(path: &Path, read: io::Result<T>) -> Result<Option<T>> {
    match read {
        Err(e)
            if matches!(e.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory)
                && !path.is_symlink() =>
        {
            Ok(None)
        }
        found => found.map(Some).context("read", path),
    }
}

/// Returns the text of a file.
///
/// # Errors
/// [`Error::Io`](crate::error::Error::Io) if the file cannot be read or is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let text = read(path).and_then(|bytes| {
        String::from_utf8(bytes)
            .map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is not UTF-8"))
    });
    text.context("read", path)
}

/// True if a path with `/` is a single line, on every system leads to a place below its start, and is the only spelling
/// of that place.
pub fn is_plain(path: &str) -> bool {
    // In one pass over bytes, since this is asked of every artifact.
    let (mut length, mut dots) = (0, 0);
    for &byte in path.as_bytes().iter().chain(b"/") {
        match byte {
            // A path drops empty parts and most dots: another spelling of one place, not a place of its own.
            b'/' if length == dots && length < 3 => return false,
            b'/' => (length, dots) = (0, 0),
            b'\\' | 0..b' ' | 0x7F => return false,
            _ => (length, dots) = (length + 1, dots + u32::from(byte == b'.')),
        }
    }
    let normal = |part| matches!(part, Component::Normal(_));
    (path.is_ascii() || !path.contains(is_forbidden))
        && (cfg!(unix) || Path::new(path).components().all(normal))
}

/// True if no line of text may have the character: a control character, or one of Unicode's noncharacters.
///
/// XML forbids most of them. The mathematics, which knows nothing of this package, has the same rule for names in
/// meshes: `problem::text::is_forbidden`.
pub fn is_forbidden(c: char) -> bool {
    let number = u32::from(c);
    c.is_control() || number & 0xFFFE == 0xFFFE || (0xFDD0..=0xFDEF).contains(&number)
}

/// Failure to list or read a file or folder, with its path.
pub type TreeError = (PathBuf, io::Error);

/// Reads every file below `folder`; paths begin there, with `/` on every system. As [`list_tree`].
///
/// # Errors
/// As [`list_tree`], and for a file that cannot be read.
pub fn read_tree(
    folder: &Path,
    skip: impl Fn(&str) -> bool,
) -> std::result::Result<BTreeMap<String, Vec<u8>>, TreeError> {
    let mut files = BTreeMap::new();
    for (name, path) in list_tree(folder, skip)? {
        files.insert(name, read(&path).map_err(|e| (path, e))?);
    }
    Ok(files)
}

/// Lists every file below `folder`, each by its path from there, with `/` on every system.
///
/// Files and folders are left out if `skip` is true for their path. Links to folders are refused, because they may form
/// a circle or lead to the whole disk.
///
/// # Errors
/// For such a link, a name that is not UTF-8, and a folder that cannot be listed.
pub fn list_tree(
    folder: &Path,
    skip: impl Fn(&str) -> bool,
) -> std::result::Result<BTreeMap<String, PathBuf>, TreeError> {
    let mut files = BTreeMap::new();
    let mut folders = vec![String::new()];
    while let Some(prefix) = folders.pop() {
        let here = folder.join(&prefix);
        for entry in fs::read_dir(&here).map_err(|e| (here.clone(), e))? {
            let entry = entry.map_err(|e| (here.clone(), e))?;
            let path = entry.path();
            let name = entry.file_name().into_string().map_err(|_| {
                let why = "its name is not UTF-8";
                (path.clone(), io::Error::new(ErrorKind::InvalidFilename, why))
            })?;
            let name = format!("{prefix}{name}");
            if skip(&name) {
                continue;
            }
            let kind = entry.file_type().map_err(|e| (path.clone(), e))?;
            if kind.is_dir() {
                folders.push(name + "/");
            } else if kind.is_symlink() && path.is_dir() {
                return Err((path, io::Error::new(ErrorKind::Unsupported, "it links to a folder")));
            } else {
                // A link to nothing is refused by whoever reads it.
                let special = fs::metadata(&path).and_then(|there| refuse_special(&there));
                match special {
                    Err(e) if e.kind() == ErrorKind::Unsupported => return Err((path, e)),
                    _ => _ = files.insert(name, path),
                }
            }
        }
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_by_their_path_and_skipped_by_it() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("a/b")).unwrap();
        fs::create_dir_all(folder.path().join("skip")).unwrap();
        for name in ["one", "a/two", "a/b/three", "skip/four", "a/skip"] {
            fs::write(folder.path().join(name), name).unwrap();
        }
        let files = read_tree(folder.path(), |name| name == "skip").unwrap();
        let names: Vec<&str> = files.keys().map(String::as_str).collect();
        assert_eq!(names, ["a/b/three", "a/skip", "a/two", "one"]);
        assert!(files.iter().all(|(name, bytes)| name.as_bytes() == bytes));
        let (path, _) = read_tree(&folder.path().join("none"), |_| false).unwrap_err();
        assert!(path.ends_with("none"));
    }

    #[test]
    #[cfg(unix)]
    fn links_to_files_are_followed() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("one"), "one").unwrap();
        std::os::unix::fs::symlink("one", folder.path().join("two")).unwrap();
        assert_eq!(read_tree(folder.path(), |_| false).unwrap()["two"], b"one");
    }

    #[test]
    fn paths_that_lead_upwards_are_not_plain() {
        assert!(["a", "a/b", "a/r=1.5", "...", ".a/b.", "\u{e9}"].into_iter().all(is_plain));
        assert!(
            ![
                "",
                "/a",
                "../a",
                "a/../b",
                ".",
                "a\\..\\b",
                "a\nb",
                "a\u{FFFE}",
                "a\u{7F}",
                "a\u{85}",
                ".."
            ]
            .into_iter()
            .any(is_plain)
        );
        assert!(
            !["./a", "a/./b", "a//b", "a/", "a/."].into_iter().any(is_plain),
            "other spellings"
        );
    }
}
