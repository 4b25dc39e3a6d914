//! Hashes of files that have not changed since a run noted them, so that a run with nothing to do need not read them.
//!
//! As git's index tells them: a file by its number in the file system, whatever its name, and a change by its size and
//! times. Central is the time that the file system itself sets at every change, and that no program can set back. A
//! copy of a project has other numbers and times, and is read again.

use super::files::{folder_of, hash_if_there, hash_of, read};
use super::place::write_own;
use crate::error::Result;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::fs::{self, File, Metadata};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, SystemTime};

/// Path of the notes in the project.
const PATH: &str = "pipeline/.hashes";

/// Beginning of the notes; other notes have another one.
const HEADER: &[u8] = b"signorini: hashes of files, 1\n";

/// State of a file: its number, its size, and the times in nanoseconds at which its bytes and anything of it were last
/// changed. Whoever writes to a file by a call of the system changes it. A second write to a page that a program has
/// mapped into its memory need not; `run --locked` and `status --verify`, which read all files, notice it.
type FileState = [u8; 32];

/// Noted hash: a state, and the hash of the bytes at that time.
type NotedHash = [u8; 64];

/// Hashes of files by their state, on one file system.
#[derive(Debug, Default)]
pub struct KnownHashes {
    device: u64,
    /// In ascending order.
    noted: Vec<NotedHash>,
    /// True once a file was asked for of which nothing is known.
    missed: AtomicBool,
}

impl KnownHashes {
    /// Reads the notes of a project; if they are missing or damaged, nothing is known.
    pub fn read(project: &Path) -> Self {
        Self::parse(&project.join(PATH)).unwrap_or_default()
    }

    fn parse(path: &Path) -> Option<Self> {
        let there = fs::metadata(path).ok().filter(Metadata::is_file)?;
        let bytes = fs::read(path).ok()?;
        let (noted, seal) = bytes.split_last_chunk::<{ blake3::OUT_LEN }>()?;
        let (hashes, []) = noted.strip_prefix(HEADER)?.as_chunks() else { return None };
        let sealed = blake3::hash(noted) == *seal;
        sealed.then(|| Self { device: device(&there), noted: hashes.to_vec(), ..Self::default() })
    }

    /// True if a file was asked for of which nothing is known.
    pub fn missed(&self) -> bool {
        self.missed.load(Ordering::Relaxed)
    }

    /// Returns the hexadecimal hash of a file that has not changed since its hash was noted.
    pub(super) fn of(&self, path: &Path) -> Option<String> {
        let there = fs::metadata(path).ok()?;
        let noted = self.noted(&there);
        if noted.is_none() {
            self.missed.store(true, Ordering::Relaxed);
        }
        let hash = noted?.last_chunk::<{ blake3::OUT_LEN }>()?;
        Some(blake3::Hash::from_bytes(*hash).to_hex().to_string())
    }

    /// Returns the hexadecimal hash of a file, which is read unless its hash is known; `None` if it does not exist.
    pub(super) fn hash_if_there(&self, path: &Path) -> Result<Option<String>> {
        self.of(path).map_or_else(|| hash_if_there(path), |known| Ok(Some(known)))
    }

    fn noted(&self, there: &Metadata) -> Option<&NotedHash> {
        let state = state(there).filter(|_| device(there) == self.device)?;
        let found = self.noted.binary_search_by(|noted| noted[..state.len()].cmp(&state)).ok()?;
        Some(&self.noted[found])
    }

    /// Notes the hashes of these files, some below the folder `cache`, for the next run; those that are known are not
    /// read.
    ///
    /// Easily broken: a file that is changed twice within one tick of the file system's clock has one state before and
    /// after the second change. So a file is noted only if that clock has gone on since its last change before the file
    /// is read, and if it is in the same state after. And files of the cache are written without waiting for the disk:
    /// they are noted only when the disk has them, so that one that a loss of power damages is read again.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io) if the notes cannot be written.
    pub fn note(&self, project: &Path, cache: &Path, files: &BTreeSet<PathBuf>) -> Result<()> {
        let path = project.join(PATH);
        let Ok(clock) = later(folder_of(&path)) else { return Ok(()) };
        let noted = files.par_iter();
        let noted = noted.filter_map(|file| self.note_of(file, clock, file.starts_with(cache)));
        let noted: BTreeSet<NotedHash> = noted.collect();
        let mut bytes = HEADER.to_vec();
        bytes.extend(noted.into_iter().flatten());
        bytes.extend_from_slice(blake3::hash(&bytes).as_bytes());
        if read(&path).is_ok_and(|there| there == bytes) {
            return Ok(());
        }
        write_own(project, PATH, &bytes)
    }

    /// Returns what to note of a file on this device whose last change was before `now`, if it can be read and, where
    /// it was written without, synced.
    fn note_of(&self, file: &Path, (on, now): (u64, u64), sync: bool) -> Option<NotedHash> {
        let there = fs::metadata(file).ok()?;
        if let Some(known) = self.noted(&there) {
            return Some(*known);
        }
        let before = state(&there).filter(|_| device(&there) == on && changed(&there) < now)?;
        let hash = blake3::Hash::from_hex(hash_of(file).ok()?).ok()?;
        if sync {
            File::open(file).and_then(|file| file.sync_all()).ok()?;
        }
        let after = state(&fs::metadata(file).ok()?)?;
        let noted = [&before[..], hash.as_bytes()].concat();
        noted.try_into().ok().filter(|_| before == after)
    }
}

/// Returns the device of a folder and the time on the clock of its file system, if possible a time after those of all
/// its files.
fn later(folder: &Path) -> io::Result<(u64, u64)> {
    let (device, first) = time(folder)?;
    // Clocks of file systems tick every ten milliseconds or more often. Of a slower one, the youngest files are not
    // noted.
    for _ in 0..20 {
        std::thread::sleep(Duration::from_millis(1));
        let (_, now) = time(folder)?;
        if now > first {
            return Ok((device, now));
        }
    }
    Ok((device, first))
}

/// Returns the device of a folder and the time on the clock of its file system: of the last change of a new file,
/// which has no name.
///
/// The time is of a past before all files where the file system keeps no time but the one that programs can set.
fn time(folder: &Path) -> io::Result<(u64, u64)> {
    let file = tempfile::tempfile_in(folder)?;
    file.set_modified(SystemTime::UNIX_EPOCH + Duration::from_secs(1))?;
    let there = file.metadata()?;
    // On systems that do not tell, nothing is noted.
    state(&there).ok_or(io::ErrorKind::Unsupported)?;
    Ok((device(&there), changed(&there)))
}

/// Returns the state of a file, `None` for anything else.
fn state(there: &Metadata) -> Option<FileState> {
    use std::os::unix::fs::MetadataExt;
    let modified = nanoseconds(there.mtime(), there.mtime_nsec());
    let numbers = [there.ino(), there.len(), modified, changed(there)];
    numbers.map(u64::to_le_bytes).as_flattened().try_into().ok().filter(|_| there.is_file())
}

/// Returns the time in nanoseconds at which anything of a file was last changed.
fn changed(there: &Metadata) -> u64 {
    use std::os::unix::fs::MetadataExt;
    nanoseconds(there.ctime(), there.ctime_nsec())
}

fn nanoseconds(seconds: i64, more: i64) -> u64 {
    seconds.wrapping_mul(1_000_000_000).wrapping_add(more) as u64
}

fn device(there: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::dev(there)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hash;
    use std::os::unix::fs::FileExt;

    /// A project with one file, and the file's path.
    fn project() -> (tempfile::TempDir, PathBuf) {
        let project = tempfile::tempdir().unwrap();
        fs::create_dir(project.path().join("pipeline")).unwrap();
        let file = project.path().join("mesh");
        fs::write(&file, "one").unwrap();
        (project, file)
    }

    /// Writes the notes of a project; returns the hash of a file by them.
    fn noted(project: &Path, file: &Path) -> Option<String> {
        let files = BTreeSet::from([file.to_path_buf()]);
        KnownHashes::default().note(project, project, &files).unwrap();
        KnownHashes::read(project).of(file)
    }

    fn overwrite(file: &Path, bytes: &[u8]) {
        File::options().write(true).open(file).unwrap().write_all_at(bytes, 0).unwrap();
    }

    fn date(file: &Path, time: SystemTime) {
        File::options().write(true).open(file).unwrap().set_modified(time).unwrap();
    }

    #[test]
    fn what_has_not_changed_is_known_and_each_change_is_noticed() {
        let (project, file) = project();
        let (here, other) = (project.path(), project.path().join("other"));
        let far = SystemTime::UNIX_EPOCH + Duration::from_hours(24 * 365 * 130);
        let ways: [(&str, &dyn Fn(SystemTime)); 7] = [
            ("same size", &|_| overwrite(&file, b"two")),
            ("same size, date set back", &|before| {
                overwrite(&file, b"two");
                date(&file, before);
            }),
            ("same size, date of the future", &|_| {
                overwrite(&file, b"two");
                date(&file, far);
            }),
            ("another file of the same size and date", &|before| {
                fs::write(&other, "two").unwrap();
                date(&other, before);
                fs::rename(&other, &file).unwrap();
            }),
            ("an older file of the same size and date", &|_| {
                fs::rename(here.join("older"), &file).unwrap();
            }),
            ("truncated", &|_| {
                File::options().write(true).open(&file).unwrap().set_len(1).unwrap();
            }),
            ("by another name", &|_| {
                fs::hard_link(&file, here.join("link")).unwrap();
                overwrite(&here.join("link"), b"two");
            }),
        ];
        for (way, change) in ways {
            fs::write(here.join("older"), "two").unwrap();
            fs::write(&file, "one").unwrap();
            let before = fs::metadata(&file).unwrap().modified().unwrap();
            date(&here.join("older"), before);
            assert_eq!(noted(here, &file), Some(hash(b"one")), "{way}");
            change(before);
            let known = KnownHashes::read(here);
            let now = hash(&fs::read(&file).unwrap());
            assert_ne!(now, hash(b"one"), "{way}");
            assert_eq!(known.of(&file), None, "{way}");
            assert!(known.missed() && known.hash_if_there(&file).unwrap() == Some(now), "{way}");
        }
        // A date of the future alone changes nothing that could not be noted.
        date(&file, far);
        assert_eq!(noted(here, &file), Some(hash(b"two")));
        overwrite(&file, b"six");
        date(&file, far);
        assert_eq!(KnownHashes::read(here).of(&file), None);
    }

    #[test]
    fn a_file_that_may_change_within_the_same_tick_is_not_noted() {
        let (_project, file) = project();
        let there = fs::metadata(&file).unwrap();
        let nothing = KnownHashes::default();
        let note = |now: u64| nothing.note_of(&file, (device(&there), now), false);
        assert_eq!(note(changed(&there)), None);
        assert!(note(changed(&there) + 1).is_some());
        let other = (device(&there) + 1, u64::MAX);
        assert_eq!(nothing.note_of(&file, other, false), None, "another disk");
    }

    #[test]
    fn a_copy_of_a_project_and_damaged_notes_tell_nothing() {
        let (project, file) = project();
        assert!(noted(project.path(), &file).is_some());
        let (copy, same) = self::project();
        let there = project.path().join(PATH);
        fs::copy(&there, copy.path().join(PATH)).unwrap();
        assert_eq!(KnownHashes::read(copy.path()).of(&same), None);
        let bytes = fs::read(&there).unwrap();
        assert_eq!(bytes.len(), HEADER.len() + 64 + 32);
        for k in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[k] ^= 1;
            for damaged in [&damaged[..], &bytes[..k], &[&bytes[..], &bytes[..k + 1]].concat()] {
                fs::write(&there, damaged).unwrap();
                assert_eq!(KnownHashes::read(project.path()).of(&file), None, "{k}");
            }
        }
    }

    #[test]
    fn notes_that_stay_the_same_are_not_written_again() {
        let (project, file) = project();
        assert!(noted(project.path(), &file).is_some());
        let now = || state(&fs::metadata(project.path().join(PATH)).unwrap());
        let before = now();
        assert!(noted(project.path(), &file).is_some());
        assert_eq!(now(), before);
    }
}
