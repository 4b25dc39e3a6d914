//! Hands the program its compiler's version, for certificates, and a digest of what it is built from.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files outside of `src` from which the program is built.
const OUTSIDE: [&str; 3] = ["Cargo.toml", "Cargo.lock", "build.rs"];

/// The compiler's options and the features and target it builds for, as cargo tells a build script.
const OPTIONS: [&str; 6] =
    ["TARGET", "OPT_LEVEL", "DEBUG", "CARGO_ENCODED_RUSTFLAGS", "CARGO_CFG_FEATURE", "PROFILE"];

fn main() {
    let compiler = std::env::var("RUSTC").expect("cargo names the compiler");
    let said = Command::new(compiler).arg("-vV").output().expect("the compiler runs");
    let version = String::from_utf8(said.stdout).expect("a version is text");
    let short = version.lines().next().expect("the compiler tells its version");
    println!("cargo::rustc-env=SIGNORINI_RUSTC={short}");
    link_in_place();

    let mut digest = blake3::Hasher::new();
    // Each part with its length, so that no two lists of parts give the same bytes.
    let mut add = |part: &[u8]| {
        digest.update(&(part.len() as u64).to_le_bytes());
        digest.update(part);
    };
    add(version.as_bytes());
    for name in OPTIONS {
        add(name.as_bytes());
        add(std::env::var(name).unwrap_or_default().as_bytes());
    }
    let mut files: BTreeSet<PathBuf> = OUTSIDE.iter().map(PathBuf::from).collect();
    add_sources(Path::new("src"), &mut files);
    for file in files {
        // File by file: cargo would take a folder for changed when an editor leaves something there. A new source is
        // named by one that is there already.
        println!("cargo::rerun-if-changed={}", file.display());
        add(file.to_string_lossy().replace('\\', "/").as_bytes());
        add(&fs::read(&file).expect("the sources can be read"));
    }
    println!("cargo::rustc-env=SIGNORINI_PROGRAM={}", digest.finalize().to_hex());
}

/// Adds every file below a folder that the compiler may read, tests as well: all but hidden files, copies that editors
/// leave, which end with `~`, and the folder of what calls the program from Python.
fn add_sources(folder: &Path, files: &mut BTreeSet<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the sources can be read") {
        let path = entry.expect("the sources can be read").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with('.') || name.ends_with('~') || path == Path::new("src/python") {
            continue;
        }
        match path.is_dir() {
            true => add_sources(&path, files),
            false => _ = files.insert(path),
        }
    }
}

/// Links the program for one place in memory where the linker can: else the loader patches 290 000 addresses of code
/// that is not optimised, which takes three quarters of the time of a start.
fn link_in_place() {
    let target =
        |about: &str| std::env::var(format!("CARGO_CFG_TARGET_{about}")).unwrap_or_default();
    // Elsewhere, and with a C library that is linked in, the option is refused or has another meaning.
    if target("OS") == "linux"
        && target("ENV") == "gnu"
        && !target("FEATURE").contains("crt-static")
    {
        println!("cargo::rustc-link-arg-bins=-no-pie");
    }
}
