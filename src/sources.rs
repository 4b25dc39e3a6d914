//! Source files of the program, distinguished by their names from files that editors leave; for the build script.

use std::io;
use std::path::{Path, PathBuf};

/// Endings of the files that the sources in Rust include.
const INCLUDED: [&str; 5] = [".tera", ".toml", ".md", ".mk", ".smk"];

/// Returns the file itself, or all source files below a folder, sorted by path.
pub(crate) fn files(path: &Path) -> io::Result<Vec<PathBuf>> {
    if path.is_file() {
        return Ok(vec![path.to_path_buf()]);
    }
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path)? {
        let entry = entry?;
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_str().unwrap_or_default();
        if entry.file_type()?.is_dir() {
            if !name.starts_with('.') {
                files.extend(self::files(&path)?);
            }
        // A link may point to nothing.
        } else if is_source(name) && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// True if a source file of this program may have this name: a module in small letters, or a file that one includes.
fn is_source(name: &str) -> bool {
    match name.strip_suffix(".rs") {
        Some(module) => module.chars().all(|c| is_word(c) && !c.is_ascii_uppercase()),
        None => {
            name == "gitignore"
                || name.starts_with(is_word)
                    && name.chars().all(|c| is_word(c) || c == '.')
                    && INCLUDED.iter().any(|ending| name.ends_with(ending))
        }
    }
}

fn is_word(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn what_editors_leave_beside_the_sources_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let own = ["cli/gitignore", "cli/head.mk", "cli/mod.rs", "cli/page.md.tera", "lib.rs"];
        let others = [
            "#lib.rs#",
            ".DS_Store",
            ".cli.un~",
            ".idea/workspace.toml",
            ".lib.rs.swp",
            "4913",
            "cli/mod (copy).rs",
            "cli/mod.rs.orig",
            "cli/mod.rs.rej",
            "cli/mod.rs~",
            "cli/mod_BACKUP_4711.rs",
            "cli/page (1).md.tera",
            "cli/page.md.tera.bak",
        ];
        for name in own.iter().chain(&others) {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, name).unwrap();
        }
        #[cfg(unix)]
        for name in [".#lib.rs", "cli/.#mod.rs", "cli/lost.rs"] {
            std::os::unix::fs::symlink("user@host.4711:1", folder.path().join(name)).unwrap();
        }
        let found = files(folder.path()).unwrap();
        assert_eq!(found, own.map(|name| folder.path().join(name)));
    }

    #[test]
    fn the_rule_knows_every_file_that_is_there_and_that_another_includes() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let known = files(&root.join("src")).unwrap();
        let mut included = 0;
        for source in known.iter().filter(|file| file.extension().is_some_and(|end| end == "rs")) {
            let text = fs::read_to_string(source).unwrap();
            // This file speaks of the macro without using it.
            let named =
                text.split("include_str!(\"").skip(1).filter_map(|rest| rest.split('"').next());
            for name in named.filter(|_| !source.ends_with("src/sources.rs")) {
                let file = source.parent().unwrap().join(name).canonicalize().unwrap();
                if file.starts_with(root.join("src").canonicalize().unwrap()) {
                    let mut known = known.iter().filter_map(|known| known.canonicalize().ok());
                    assert!(known.any(|known| known == file), "{name}");
                    included += 1;
                }
            }
        }
        assert!(included > 8, "{included}");
    }
}
