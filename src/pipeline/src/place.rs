//! Places of files: where links lead, and where a run may write and remove.
//!
//! Central is [`place`]: whatever a run writes or removes has a place in the project by its real path, not by its
//! text, so that no link of a project that somebody else has made leads a run to other files.

use super::files::{folder_of, link_target, write_atomically};
use crate::error::{Error, IoContext, Result};
use std::path::{Component, Path, PathBuf};

/// Folders of a project in which nothing is written but what has its place there: inputs of runs, and the history.
pub const INPUTS: [&str; 4] = ["pipeline", "report/templates", "report/theme", ".git"];

/// Folders of a project in which nobody else's folder lies: inputs, exports and the history.
pub const TAKEN: [&str; 4] = ["pipeline", "report", "figures", ".git"];

/// Returns the real path of a place in a project, or anywhere else, that need not exist; messages call it `what`.
///
/// # Errors
/// [`Error::Input`] if a link leads the path out of the project, or the place lies in one of the folders `not_in` of
/// the project; [`Error::Io`] if links form a circle.
pub fn place(project: &Path, path: &Path, what: &str, not_in: &[&str]) -> Result<PathBuf> {
    let (root, end) = (real(project), real(&link_target(path).context("write", path)?));
    let leads_out = !end.starts_with(&root)
        && [&root, &without_dots(project)].iter().any(|root| without_dots(path).starts_with(root));
    if leads_out {
        return Err(Error::input(format!(
            "{what}: a link leads out of the project, to {}; remove the link, or name that place itself",
            end.display()
        )));
    }
    match not_in.iter().find(|folder| end.starts_with(root.join(folder))) {
        Some(folder) => Err(Error::input(format!(
            "{what} would lie in {folder}/, which has other files; choose another place"
        ))),
        None => Ok(end),
    }
}

/// Returns the real path of a file that runs keep in the project, such as `figures/v.svg`.
///
/// # Errors
/// As [`place`]: a link leads out of the project, or among inputs.
pub fn own_place(project: &Path, path: &str) -> Result<PathBuf> {
    let others: Vec<&str> =
        INPUTS.into_iter().filter(|folder| !Path::new(path).starts_with(folder)).collect();
    place(project, &project.join(path), path, &others)
}

/// True if no link leads to the file of this path in the project.
pub(super) fn is_no_link(project: &Path, path: &str) -> bool {
    let file = project.join(path);
    !file.is_symlink() && real(folder_of(&file)) == real(project).join(folder_of(Path::new(path)))
}

/// Writes a whole file that runs keep in the project, or nothing.
///
/// # Errors
/// As [`own_place`] and [`write_atomically`].
pub fn write_own(project: &Path, path: &str, bytes: &[u8]) -> Result<()> {
    write_atomically(&own_place(project, path)?, bytes)
}

/// Returns an absolute path without `.` and `..`, its links as they are.
pub fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()).components() {
        match part {
            Component::ParentDir => _ = plain.pop(),
            part => plain.push(part),
        }
    }
    plain
}

/// Returns the path without links, `.` and `..`; its last parts need not exist.
pub fn real(path: &Path) -> PathBuf {
    if let Ok(real) = path.canonicalize() {
        return real;
    }
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
    match (path.parent(), path.components().next_back()) {
        // Below a folder that does not exist there are no links.
        (Some(parent), Some(Component::ParentDir)) => {
            let mut path = real(parent);
            path.pop();
            path
        }
        (Some(parent), Some(last)) => real(parent).join(last),
        _ => path,
    }
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::symlink;

    #[test]
    fn what_does_not_exist_yet_has_its_place_too() {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path().canonicalize().unwrap();
        symlink(&here, here.join("link")).unwrap();
        for path in ["new/file", "link/new/file", "none/../new/file", "none/more/../../new/./file"]
        {
            assert_eq!(real(&here.join(path)), here.join("new/file"), "{path}");
        }
    }

    #[test]
    fn a_place_is_in_the_project_by_its_real_path() {
        let folder = tempfile::tempdir().unwrap();
        let project = folder.path().join("project");
        for inside in ["pipeline/scenes", "report/templates", "figures", "shared"] {
            fs::create_dir_all(project.join(inside)).unwrap();
        }
        let links = [
            ("figures/out", "../.."),
            ("figures/out.svg", "../../v.svg"),
            ("figures/scenes", "../pipeline/scenes"),
            ("figures/scene.svg", "../pipeline/scenes/a.toml"),
            ("report/src", "templates"),
            ("figures/shared", "../shared"),
            ("figures/up.svg", "../figures/v.svg"),
        ];
        links.iter().for_each(|(link, end)| symlink(end, project.join(link)).unwrap());
        for path in
            ["figures/v.svg", "figures/shared/v.svg", "figures/up.svg", "pipeline/lock.toml"]
        {
            assert!(own_place(&project, path).is_ok(), "{path}");
        }
        for path in ["figures/out/v.svg", "figures/out.svg", "figures/out/new/v.svg"] {
            let refusal = own_place(&project, path).unwrap_err().to_string();
            assert!(refusal.contains("out of the project"), "{refusal}");
        }
        for path in ["figures/scenes/b.toml", "figures/scene.svg", "report/src/one.md"] {
            let refusal = own_place(&project, path).unwrap_err().to_string();
            assert!(refusal.contains("which has other files"), "{refusal}");
        }
        let direct =
            ["figures/v.svg", "figures/shared/v.svg", "figures/up.svg", "figures/out/v.svg"];
        assert_eq!(direct.map(|path| is_no_link(&project, path)), [true, false, false, false]);
        // Who names another place than one of the project means it.
        for path in ["../v.svg", "figures/../../v.svg"] {
            assert!(place(&project, &project.join(path), path, &INPUTS).is_ok(), "{path}");
        }
    }
}
