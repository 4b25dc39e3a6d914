//! Hands the program its compiler's version, for certificates, and a digest of what it is built from.

#[path = "src/sources.rs"]
mod sources;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files from which the compiler starts, of the program, its packages and this script; what they name lies in `src`.
const ROOTS: [&str; 5] = [
    "src/lib.rs",
    "src/main.rs",
    "src/mathematics/src/lib.rs",
    "src/pipeline/src/lib.rs",
    "build.rs",
];

/// Files that cargo reads.
const PACKAGES: [&str; 4] =
    ["Cargo.toml", "src/mathematics/Cargo.toml", "src/pipeline/Cargo.toml", "Cargo.lock"];

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
    let mut files: BTreeSet<PathBuf> = PACKAGES.iter().map(PathBuf::from).collect();
    for root in ROOTS {
        let found = sources::files(Path::new(root), Path::new("src"));
        files.extend(found.expect("the sources can be read"));
    }
    for file in files {
        // File by file: cargo would take a folder for changed when an editor leaves something there. A new source is
        // named by one that is there already.
        println!("cargo::rerun-if-changed={}", file.display());
        add(file.to_string_lossy().replace('\\', "/").as_bytes());
        add(&std::fs::read(&file).expect("the sources can be read"));
    }
    println!("cargo::rustc-env=SIGNORINI_PROGRAM={}", digest.finalize().to_hex());
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
