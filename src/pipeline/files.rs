//! Folders as bytes by path.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Every file below `folder` by its path from there, with `/` on every system.
///
/// Files and folders whose path `skip` names are left out.
///
/// # Errors
/// What could not be read, and why.
pub(crate) fn read_tree(
    folder: &Path,
    skip: impl Fn(&str) -> bool,
) -> Result<BTreeMap<String, Vec<u8>>, (PathBuf, io::Error)> {
    let mut files = BTreeMap::new();
    let mut folders = vec![String::new()];
    while let Some(prefix) = folders.pop() {
        let here = folder.join(&prefix);
        for entry in fs::read_dir(&here).map_err(|e| (here.clone(), e))? {
            let entry = entry.map_err(|e| (here.clone(), e))?;
            let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
            let path = entry.path();
            if skip(&name) {
                continue;
            }
            if path.is_dir() {
                folders.push(name + "/");
            } else {
                files.insert(name, fs::read(&path).map_err(|e| (path, e))?);
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
}
