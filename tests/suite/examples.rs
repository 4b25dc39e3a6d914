//! The programs in `src/mathematics/examples/` run, and hold what they assert.

#[path = "../../src/mathematics/examples/adapted.rs"]
mod adapted;
#[path = "../../src/mathematics/examples/counts.rs"]
mod counts;
#[path = "../../src/mathematics/examples/friction.rs"]
mod friction;
#[path = "../../src/mathematics/examples/truth.rs"]
mod truth;

use std::fs;

#[test]
fn each_program_runs() {
    let programs = [adapted::main, counts::main, friction::main, truth::main];
    for program in programs {
        program().unwrap();
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/mathematics/examples");
    assert_eq!(fs::read_dir(folder).unwrap().count(), programs.len());
    let front = include_str!("../../src/mathematics/src/lib.rs");
    for file in fs::read_dir(folder).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        assert!(front.contains(&format!("`{name}`")), "the front page does not name {name}");
    }
}
