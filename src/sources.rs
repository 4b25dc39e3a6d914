//! Source files of the program: those that the compiler reads, found as it finds them; for the build script.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

/// Returns the source file `root`, the files of the modules that it declares, and the files that these include, in
/// turn; sorted by path. Only files below `folder` count: others are inputs of tasks, or documentation. Modules of unit
/// tests are no part of the program.
pub(crate) fn files(root: &Path, folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut found = BTreeSet::new();
    let mut open = vec![root.to_path_buf()];
    while let Some(file) = open.pop() {
        if found.contains(&file) {
            continue;
        }
        if file.extension().is_some_and(|ending| ending == "rs") {
            let named = named(&file, &std::fs::read_to_string(&file)?);
            open.extend(named.into_iter().filter(|path| path.starts_with(folder)));
        }
        found.insert(file);
    }
    Ok(found.into_iter().collect())
}

/// Returns the files that a source file with this text names and that exist: of modules, and those that it includes.
fn named(file: &Path, text: &str) -> Vec<PathBuf> {
    let here = file.parent().unwrap_or(Path::new(""));
    let is_root = ["lib.rs", "main.rs", "mod.rs"].iter().any(|name| file.ends_with(name));
    let below = if is_root { here.to_path_buf() } else { file.with_extension("") };
    // The unit tests of a file are at its end.
    let text = text.split("\nmod tests {").next().unwrap_or_default();
    let mut named = Vec::new();
    let mut attribute = "";
    for line in text.lines().map(str::trim).filter(|line| !line.starts_with("//")) {
        if let Some(module) = module(line).filter(|_| attribute != "#[cfg(test)]") {
            match attribute.strip_prefix("#[path = \"").and_then(|rest| rest.strip_suffix("\"]")) {
                Some(path) => named.push(here.join(path)),
                None => named.extend([
                    below.join(format!("{module}.rs")),
                    below.join(module).join("mod.rs"),
                ]),
            }
        }
        if !line.starts_with("#[") {
            named.extend(included(line).map(|path| here.join(path)));
        }
        attribute = line;
    }
    named.into_iter().map(|path| without_dots(&path)).filter(|path| path.is_file()).collect()
}

/// Returns the name of the module whose file a line declares, if it declares one.
fn module(line: &str) -> Option<&str> {
    let declared = match line.strip_prefix("pub") {
        Some(rest) => rest.split_once("mod ").filter(|(visible, _)| visible.ends_with(' '))?.1,
        None => line.strip_prefix("mod ")?,
    };
    declared.strip_suffix(';')
}

/// Returns the paths of the files that a line of a source includes.
fn included(line: &str) -> impl Iterator<Item = &str> {
    let macros = ["include!(\"", "include_str!(\"", "include_bytes!(\""];
    let paths = macros.into_iter().flat_map(|name| line.split(name).skip(1));
    paths.filter_map(|rest| rest.split('"').next())
}

/// Returns a path without the parts `..` and those before them.
fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        if part.as_os_str() != ".." || !plain.pop() {
            plain.push(part);
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    /// Writes files below a folder.
    fn write(folder: &Path, files: &[(&str, &str)]) {
        for (name, text) in files {
            let path = folder.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
    }

    #[test]
    fn a_source_is_what_the_compiler_reads() {
        let folder = tempfile::tempdir().unwrap();
        let src = folder.path().join("src");
        let own = [
            ("cli/init/gitignore", "target"),
            ("cli/init/page.md", "# Page"),
            (
                "cli/init.rs",
                "const PAGE: &str = include_str!(\"init/page.md\");\n    include_str!(\"init/gitignore\");",
            ),
            (
                "cli/mod.rs",
                "//! mod none;\npub(super) mod init;\nmod inline { }\n#[path = \"moved.rs\"]\nmod place;",
            ),
            ("cli/moved.rs", "\n#[cfg(test)]\nmod tests {\n    include_str!(\"../page.md\");\n}\n"),
            (
                "lib.rs",
                "pub mod cli;\npub(crate) mod one;\n#[cfg(test)]\nmod checks;\n#[doc = include_str!(\"notes.md\")]",
            ),
            ("one/two.rs", "include_str!(\"../../outside.toml\")"),
            ("one.rs", "mod two;"),
        ];
        write(&src, &own);
        // What people, editors and systems leave beside them, and what only tests and documentation read.
        let others = [
            "../outside.toml",
            ".idea/workspace.toml",
            "checks.rs",
            "cli copy/init.rs",
            "cli copy/mod.rs",
            "cli/init (copy).rs",
            "cli/init.rs.orig",
            "cli/init/page (1).md",
            "cli/mod_BACKUP_4711.rs",
            "cli/none.rs",
            "copy_of_one.rs",
            "notes.md",
            "one/notes.toml",
            "page.md",
        ];
        write(&src, &others.map(|name| (name, "mod lost;")));
        let found = files(&src.join("lib.rs"), &src).unwrap();
        assert_eq!(found, own.map(|(name, _)| src.join(name)));
    }

    #[test]
    fn every_source_of_this_program_is_found() {
        let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let mut found = BTreeSet::new();
        for root in ["lib.rs", "main.rs", "mathematics/src/lib.rs", "pipeline/src/lib.rs"] {
            found.extend(files(&src.join(root), &src).unwrap());
        }
        let (mut lost, mut folders) = (Vec::new(), vec![src]);
        while let Some(folder) = folders.pop() {
            for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                match path.extension().and_then(|ending| ending.to_str()) {
                    _ if path.is_dir() => folders.push(path),
                    Some("rs") if !found.contains(&path) => lost.push(path),
                    _ => {}
                }
            }
        }
        // Modules of unit tests; and this one, which is a module of the build script.
        let of_tests = ["tests.rs", "samples.rs", "sources.rs"];
        lost.retain(|path| !of_tests.iter().any(|name| path.ends_with(name)));
        lost.retain(|path| path.iter().all(|part| part != "tests"));
        assert_eq!(lost, Vec::<PathBuf>::new());
        for included in ["cli/init/gitattributes", "pipeline/src/engine/head.smk"] {
            assert!(found.iter().any(|path| path.ends_with(included)), "{included}");
        }
    }
}
