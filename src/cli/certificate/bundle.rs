//! Folder of a bundle: it becomes the bundle, whatever an earlier certificate, also an interrupted one, left there, and
//! no file is lost that a certificate did not write.

use super::contents::{File, INPUTS, sha256};
use super::{MANIFEST, RECORD};
use crate::cli::output::{OutputFile, talk};
use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::{
    leftovers, read, remove, remove_from, temporary_folder, write_atomically,
};
use crate::pipeline::hash;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, TryLockError};
use std::io::ErrorKind;
use std::path::{Component, Path};

/// Folders of the bundle in which a file of somebody else is worth a word.
const RESULTS: [&str; 2] = ["figures/", "tables/"];

/// Number of files that a message names.
const NAMED: usize = 3;

/// Folder of a bundle, with what earlier certificates are on record to have written there.
struct Bundle<'a> {
    folder: &'a Path,
    /// SHA-256 of each file that the RO-Crate describes, by path; empty if a certificate wrote none.
    described: BTreeMap<String, String>,
    /// True if there is an RO-Crate that no certificate wrote.
    is_foreign: bool,
    /// Manifest, which has the blake3 of each file; empty if there is none.
    manifest: String,
}

/// Origin of what lies at the path of a file.
#[derive(Debug, PartialEq)]
enum Origin {
    /// Nothing is there.
    Absent,
    /// The bytes of the new certificate.
    New,
    /// An earlier certificate wrote it, or it is empty.
    Earlier,
    /// Somebody else, as far as is known.
    Other,
}

/// Change of a folder to a bundle.
struct FolderChange<'a> {
    write: Vec<&'a File>,
    remove: BTreeSet<String>,
}

/// Writes a bundle of these files to the folder, in place of an earlier one; if files would be lost that a certificate
/// did not write, or would lie among the inputs, nothing is written. With `force`, a folder of which nothing is on
/// record is overwritten, as an interrupted certificate leaves it.
///
/// # Errors
/// [`Error::Input`] naming the files that are in the way; [`Error::Io`].
pub(super) fn write(folder: &Path, files: &[File], force: bool) -> Result<()> {
    fs::create_dir_all(folder).context("create", folder)?;
    // A folder that cannot be locked is left to one certificate at a time by hand.
    let lock = fs::File::open(folder);
    if let Ok(lock) = &lock
        && let Err(TryLockError::WouldBlock) = lock.try_lock()
    {
        let folder = folder.display();
        return Err(Error::input(format!("another signorini is at work in {folder}; wait for it")));
    }
    let bundle = Bundle::read(folder)?;
    bundle.perform(&bundle.change(files, force)?)?;
    let known: BTreeSet<&str> = files.iter().map(|file| file.path.as_str()).collect();
    for part in RESULTS {
        let others = bundle.others(part, &known)?;
        if !others.is_empty() {
            talk(&format!("note: no part of the certificate: {}", bundle.list(&others)));
        }
    }
    Ok(())
}

impl<'a> Bundle<'a> {
    fn read(folder: &'a Path) -> Result<Self> {
        let mut bundle =
            Self { folder, described: BTreeMap::new(), is_foreign: false, manifest: String::new() };
        if let Ok(Some(bytes)) = bundle.found(MANIFEST)? {
            String::from_utf8_lossy(&bytes).trim().clone_into(&mut bundle.manifest);
        }
        if let Ok(Some(bytes)) = bundle.found(RECORD)?
            && let Ok(record) = serde_json::from_slice::<Value>(&bytes)
        {
            match described(&record) {
                Some(files) => bundle.described = files,
                None => bundle.is_foreign = true,
            }
        }
        Ok(bundle)
    }

    /// Returns the bytes of the file at this path, `None` if there is nothing, or the path of what is in the way: a
    /// link or a folder in the place of the file, or what is no folder above it.
    fn found(&self, path: &str) -> Result<std::result::Result<Option<Vec<u8>>, String>> {
        let mut here = String::new();
        for part in path.split('/') {
            here += part;
            let on_disk = self.folder.join(&here);
            let kind = match fs::symlink_metadata(&on_disk) {
                Err(e) if e.kind() == ErrorKind::NotFound => return Ok(Ok(None)),
                kind => kind.context("read", &on_disk)?,
            };
            let is_last = here.len() == path.len();
            if is_last && !kind.is_file() || !is_last && !kind.is_dir() {
                return Ok(Err(here));
            }
            if !is_last {
                here.push('/');
            }
        }
        let on_disk = self.folder.join(path);
        Ok(Ok(Some(read(&on_disk).context("read", &on_disk)?)))
    }

    /// True if an earlier certificate wrote these bytes, as far as they are on record.
    fn wrote(&self, path: &str, bytes: &[u8]) -> bool {
        match path {
            RECORD if !self.manifest_is_ours() => !self.described.is_empty(),
            MANIFEST => self.manifest_is_ours(),
            _ => {
                self.manifest.contains(&hash(bytes))
                    || self.described.get(path).is_some_and(|known| *known == sha256(bytes))
            }
        }
    }

    /// True if a certificate wrote the manifest, which somebody may have edited: only such a one names a record of the
    /// run.
    fn manifest_is_ours(&self) -> bool {
        self.manifest.contains("\n  run_record: ")
    }

    /// Returns the origin of what lies at the path of a file of which `new` are the new bytes, if it is in the bundle.
    fn origin(&self, path: &str, new: Option<&[u8]>) -> Result<(Origin, String)> {
        let (found, place) = match self.found(path)? {
            Ok(found) => (found, path.to_owned()),
            Err(place) => return Ok((Origin::Other, place)),
        };
        let origin = match found {
            None => Origin::Absent,
            Some(found) if new == Some(&found) => Origin::New,
            Some(found) if found.is_empty() || self.wrote(path, &found) => Origin::Earlier,
            Some(_) => Origin::Other,
        };
        Ok((origin, place))
    }

    /// Returns the change that makes the folder the bundle of these files.
    fn change<'b>(&self, files: &'b [File], force: bool) -> Result<FolderChange<'b>> {
        // A certificate writes its record first: what is not in a record that is there, it has not written.
        let overwrites = force && self.described.is_empty() && self.manifest.is_empty();
        let mut change = FolderChange { write: Vec::new(), remove: BTreeSet::new() };
        let mut in_the_way = BTreeSet::new();
        for file in files {
            let (origin, place) = self.origin(&file.path, Some(&file.bytes))?;
            // The option is there for the manifest, which people complete by hand.
            let forced = force && file.path == MANIFEST
                || overwrites && !(self.is_foreign && file.path == RECORD);
            match origin {
                Origin::New => continue,
                Origin::Absent => {}
                Origin::Other if !forced || place != file.path || !self.is_file(&place) => {
                    in_the_way.insert(place);
                    continue;
                }
                Origin::Earlier | Origin::Other => {
                    change.remove.insert(file.path.clone());
                }
            }
            change.write.push(file);
        }
        let new: BTreeSet<&str> = files.iter().map(|file| file.path.as_str()).collect();
        let manifest = self.manifest_is_ours().then_some(MANIFEST);
        for path in self.described.keys().map(String::as_str).chain(manifest) {
            if new.contains(path) || !is_inside(path) {
                continue;
            }
            match self.origin(path, None)? {
                (Origin::Earlier, _) => _ = change.remove.insert(path.to_owned()),
                (Origin::Other, place) if place == path => _ = in_the_way.insert(place),
                _ => {}
            }
        }
        self.refuse(&in_the_way, "there already and not as a certificate wrote")?;
        let kept: BTreeSet<&str> =
            new.iter().copied().chain(change.remove.iter().map(String::as_str)).collect();
        let others = self.others(INPUTS, &kept)?;
        self.refuse(
            &others,
            "none of the inputs of the run, among which it lies: no certificate wrote",
        )?;
        Ok(change)
    }

    fn is_file(&self, path: &str) -> bool {
        fs::symlink_metadata(self.folder.join(path)).is_ok_and(|there| there.is_file())
    }

    /// Refuses a change with these paths in its way.
    fn refuse(&self, paths: &BTreeSet<String>, why: &str) -> Result<()> {
        if paths.is_empty() {
            return Ok(());
        }
        let (is, it) = if paths.len() == 1 { ("is", "it") } else { ("are", "them") };
        let names = self.list(paths);
        Err(Error::input(format!(
            "{names} {is} {why} {it}; move {it} away, or name another folder with --output"
        )))
    }

    /// Names the first of some paths in the bundle, and counts the others.
    fn list(&self, paths: &BTreeSet<String>) -> String {
        let names = paths.iter().take(NAMED);
        let names: Vec<_> =
            names.map(|path| self.folder.join(path).display().to_string()).collect();
        match paths.len() - names.len() {
            0 => names.join(", "),
            more => format!("{} and {more} more", names.join(", ")),
        }
    }

    /// Returns the paths below the folder `top` of the bundle that are not `known`: files and links, and in the place
    /// of all its files a folder that has no known one.
    fn others(&self, top: &str, known: &BTreeSet<&str>) -> Result<BTreeSet<String>> {
        let (mut others, mut folders) = (BTreeSet::new(), vec![top.to_owned()]);
        while let Some(prefix) = folders.pop() {
            let here = self.folder.join(&prefix);
            if !here.is_dir() {
                continue;
            }
            for entry in fs::read_dir(&here).context("read", &here)? {
                let entry = entry.context("read", &here)?;
                let path = format!("{prefix}{}", entry.file_name().to_string_lossy());
                let is_folder = entry.file_type().context("read", &entry.path())?.is_dir();
                let inside = format!("{path}/");
                if is_folder && known.iter().any(|known| known.starts_with(&inside)) {
                    folders.push(inside);
                } else if is_folder && has_files(&entry.path())
                    || !is_folder && !known.contains(path.as_str())
                {
                    others.insert(path);
                }
            }
        }
        Ok(others)
    }

    /// Makes the folder the bundle, so that after an interruption at any point every file of a certificate is on
    /// record: earlier files that the new record would not know go before it, and new files come after it.
    fn perform(&self, change: &FolderChange) -> Result<()> {
        for path in change.remove.iter().chain(change.write.iter().map(|file| &file.path)) {
            let path = self.folder.join(path);
            if path.parent().is_some_and(Path::is_dir) {
                OutputFile::check(&path)?;
            }
        }
        remove(&leftovers([self.folder.to_path_buf()]));
        let ready = temporary_folder(self.folder).context("write to", self.folder)?;
        for file in &change.write {
            write_atomically(&ready.path().join(&file.path), &file.bytes)?;
        }
        for path in change.remove.iter().filter(|path| *path != RECORD) {
            remove_from(self.folder, &self.folder.join(path))?;
        }
        let (first, rest): (Vec<&File>, Vec<&File>) =
            change.write.iter().copied().partition(|file| file.path == RECORD);
        for file in first.into_iter().chain(rest) {
            let path = self.folder.join(&file.path);
            let parent = path.parent().expect("a file lies in a folder");
            fs::create_dir_all(parent).context("create", parent)?;
            fs::rename(ready.path().join(&file.path), &path).context("write", &path)?;
        }
        remove_empty_folders(&self.folder.join(INPUTS));
        Ok(())
    }
}

/// Returns the SHA-256 of each file that an RO-Crate of a certificate describes, by path; `None` for another RO-Crate.
fn described(record: &Value) -> Option<BTreeMap<String, String>> {
    let entities = record["@graph"].as_array()?;
    entities.iter().find(|one| one["@id"] == "#run" && one["name"] == "signorini run")?;
    let mut files = BTreeMap::new();
    for file in entities.iter().filter(|one| one["@type"] == "File") {
        let (path, hash) = (file["name"].as_str()?, file["sha256"].as_str()?);
        files.insert(path.to_owned(), hash.to_owned());
    }
    Some(files)
}

/// True if a path leads to a place below its start: somebody may have edited the record that it is from.
fn is_inside(path: &str) -> bool {
    Path::new(path).components().all(|part| matches!(part, Component::Normal(_)))
}

/// True if there is a file or a link in a folder or below it.
fn has_files(folder: &Path) -> bool {
    // A folder that cannot be read may have some.
    let Ok(entries) = fs::read_dir(folder) else { return true };
    entries.flatten().any(|entry| match entry.file_type().is_ok_and(|kind| kind.is_dir()) {
        true => has_files(&entry.path()),
        false => true,
    })
}

/// Removes the folders below this one that hold nothing.
fn remove_empty_folders(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            remove_empty_folders(&entry.path());
            // Fails for a folder that is not empty.
            let _ = fs::remove_dir(entry.path());
        }
    }
}
