//! Hands the program its compiler's version, for certificates, and a digest of what it is built from.
//!
//! It also has the program linked at a fixed address where that is known to work.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the program is built from, apart from the compiler and its options.
const SOURCES: [&str; 4] = ["src", "Cargo.toml", "Cargo.lock", "build.rs"];

/// The compiler's options and the features and target it builds for, as cargo tells a build script.
const OPTIONS: [&str; 6] =
    ["TARGET", "OPT_LEVEL", "DEBUG", "CARGO_ENCODED_RUSTFLAGS", "CARGO_CFG_FEATURE", "PROFILE"];

fn main() {
    let compiler = std::env::var("RUSTC").expect("cargo names the compiler");
    let said = Command::new(compiler).arg("-vV").output().expect("the compiler runs");
    let version = String::from_utf8(said.stdout).expect("a version is text");
    let short = version.lines().next().expect("the compiler tells its version");
    println!("cargo::rustc-env=SIGNORINI_RUSTC={short}");

    let mut digest = blake3::Hasher::new();
    // Each part with its length, so that no two lists of parts give the same bytes.
    let mut add = |part: &[u8]| {
        digest.update(&(part.len() as u64).to_le_bytes());
        digest.update(part);
    };
    add(version.as_bytes());
    for name in OPTIONS {
        add(name.as_bytes());
        add(variable(name).as_bytes());
    }
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
        for file in files(Path::new(source)).expect("the sources can be listed") {
            add(file.to_string_lossy().replace('\\', "/").as_bytes());
            add(&std::fs::read(&file).expect("the sources can be read"));
        }
    }
    println!("cargo::rustc-env=SIGNORINI_PROGRAM={}", digest.finalize().to_hex());

    // At a fixed address, the program starts without 260 000 relocations, and is smaller by their table.
    if variable("CARGO_CFG_TARGET_OS") == "linux" && variable("CARGO_CFG_TARGET_ENV") == "gnu" {
        println!("cargo::rustc-link-arg-bins=-no-pie");
    }
    // Functions that are compiled to the same code are kept once, where the linker is rustc's own, which can.
    let chosen =
        ["RUSTC_LINKER", "CARGO_ENCODED_RUSTFLAGS"].iter().any(|name| !variable(name).is_empty());
    if variable("TARGET") == "x86_64-unknown-linux-gnu" && !chosen {
        println!("cargo::rustc-link-arg-bins=-Wl,--icf=all");
    }
}

/// What cargo says under this name.
fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_default()
}

/// The file itself, or all files below a folder, sorted by path.
fn files(path: &Path) -> io::Result<Vec<PathBuf>> {
    if path.is_file() {
        return Ok(vec![path.to_path_buf()]);
    }
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    entries.sort();
    let below: Vec<Vec<PathBuf>> =
        entries.iter().map(|entry| files(entry)).collect::<io::Result<_>>()?;
    Ok(below.concat())
}
