//! Disks that are full, limited or read-only: one clear line, and the next run completes.

use crate::common::{EVERYTHING, Project, Said, TABLE, assert_same, promised, skip, wanting};
use std::fs;
use std::process::Command;

/// Runs a script as root of a mount namespace of its own; `None`, with the reason, where that is not allowed.
fn with_mounts(project: &Project, script: &str) -> Option<std::process::Output> {
    let mut probe = Command::new("unshare");
    if !probe
        .args(["-rm", "mount", "-t", "tmpfs", "tmpfs", "/mnt"])
        .output()
        .is_ok_and(|o| o.status.success())
    {
        skip("mounting in a namespace of one's own is not allowed here");
        return None;
    }
    let script = script.replace("signorini", env!("CARGO_BIN_EXE_signorini"));
    let mut command = Command::new("unshare");
    command.args(["-rm", "sh", "-c", &script]).current_dir(project.path("."));
    Some(command.output().unwrap())
}

#[test]
fn a_read_only_file_system_is_one_clear_line() {
    let project = Project::with(&wanting("[\"table\", \"source\"]"));
    fs::create_dir(project.path("cache")).unwrap();
    fs::create_dir(project.path("figures")).unwrap();
    let mut refused = 0;
    for folder in ["cache", "figures", "pipeline"] {
        let read_only =
            format!("mount --bind {folder} {folder} && mount -o remount,ro,bind {folder}");
        let script = format!("{read_only} && exec signorini run --cache-dir cache");
        let Some(output) = with_mounts(&project, &script) else { return };
        let said = Said::from(output);
        assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{said:?}");
        let error = said.err.lines().last().unwrap();
        assert!(error.starts_with("error: cannot ") && error.contains("Read-only file system"));
        assert!(error.contains(&format!("{folder}/")) && error.contains("; make it accessible"));
        assert_eq!(said.err.matches("error: ").count(), 1, "{said:?}");
        refused += 1;
    }
    assert_eq!(refused, promised("Folder read-only"));
    project.run(&["run", "--cache-dir", "cache"]).lines();
    assert_eq!(project.run(&["status", "--exit-code", "--cache-dir", "cache"]).code, Some(0));
}

#[test]
fn a_full_disk_is_one_clear_line_and_finished_cells_stay() {
    let project = Project::with(&wanting(EVERYTHING));
    fs::create_dir(project.path("cache")).unwrap();
    // A disk of nine pages, then the same with room: what was finished in the first run is not run again.
    let script = "mount -t tmpfs -o size=48k tmpfs cache && { signorini run -v --cache-dir cache; echo $? >&2; } && \
        mount -o remount,size=10M cache && signorini run -v --cache-dir cache";
    let Some(output) = with_mounts(&project, script) else { return };
    let said = Said::from(output);
    assert_eq!(said.code, Some(0), "{said:?}");
    let (first, second) = said.err.split_once("\n2\n").unwrap_or_else(|| panic!("{said:?}"));
    let error = first.lines().last().unwrap();
    assert!(
        error.starts_with("error: cannot ") && error.contains("No space left on device"),
        "{error}"
    );
    assert!(error.contains("free some space"), "{error}");
    assert_eq!(first.lines().filter(|line| line.starts_with("error: ")).count(), 1, "{first}");
    let ran = |log: &str| log.lines().filter(|line| line.starts_with("ran ")).count();
    assert!(ran(first) > 0, "{first}");
    assert_eq!(ran(first) + ran(second), 7, "each task succeeded once: {said:?}");

    let reference = Project::with(&wanting(EVERYTHING));
    reference.run(&["run"]).lines();
    let sizes = [4, 8, 12, 16, 20, 24, 28, 32, 36, 40, 44, 52, 56, 60, 64, 68, 72, 76, 80];
    assert_eq!(1 + sizes.len(), promised("Disk full"));
    let mut full = 0;
    for size in sizes {
        let project = Project::with(&wanting(EVERYTHING));
        fs::create_dir(project.path("cache")).unwrap();
        let script = script.replace("size=48k", &format!("size={size}k"));
        let script = script.replace("echo $? >&2;", "echo code=$? >&2;");
        let said = Said::from(with_mounts(&project, &script).expect("allowed above"));
        assert_eq!(said.code, Some(0), "{size}: {said:?}");
        let (first, _) = said.err.split_once("code=").unwrap();
        let errors: Vec<_> = first.lines().filter(|line| line.starts_with("error: ")).collect();
        assert_eq!(errors.len(), usize::from(!said.err.contains("code=0")), "{size}: {said:?}");
        assert!(errors.iter().all(|error| error.contains("free some space")), "{errors:?}");
        full += errors.len();
        assert_same(&project.files("figures"), &reference.files("figures"));
        let lock = |project: &Project| fs::read(project.path("pipeline/lock.toml")).unwrap();
        assert_eq!(lock(&project), lock(&reference), "{size}");
    }
    eprintln!("{full} of {} disks were too small", sizes.len());
    assert!(full >= sizes.len() / 2, "{full}");
}

#[test]
fn gc_makes_room_on_a_full_disk() {
    let project = Project::with(TABLE);
    for f in ["else=-1", "else=-2"] {
        project.scene("a", &TABLE.replace("else=-1", f));
        project.run(&["run", "--cache-dir", "first"]).lines();
    }
    fs::create_dir(project.path("cache")).unwrap();
    // There is no room for the name of who holds the lock, nor at first for manifests without earlier runs.
    let script = "mount -t tmpfs -o size=1M tmpfs cache && cp -r first/v2 cache && \
        { dd if=/dev/zero of=cache/fill 2> /dev/null; \
           signorini gc --cache-dir cache && signorini gc --cache-dir cache; }";
    let Some(output) = with_mounts(&project, script) else { return };
    let said = Said::from(output);
    let [first, second] = said.lines()[..] else { panic!("{said:?}") };
    assert!(first.starts_with("removed 5 files and 3 records of runs, "), "{said:?}");
    assert!(second.starts_with("removed 0 files, 0 B"), "{said:?}");
}

#[test]
fn a_file_size_limit_is_one_clear_line_and_the_next_run_completes() {
    let reference = Project::with(&wanting(EVERYTHING));
    reference.run(&["run"]).lines();
    let mut refused = 0;
    for blocks in 1..=16 {
        let project = Project::with(&wanting(EVERYTHING));
        let program = env!("CARGO_BIN_EXE_signorini");
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec {program} run");
        let mut shell = Command::new("sh");
        shell.args(["-c", &script]).current_dir(project.path("."));
        let said = Said::from(shell.output().unwrap());
        assert!(said.refusal().contains("raise the limit on file sizes"), "{blocks}: {said:?}");
        if blocks == 8 {
            let stale = project.stale();
            assert!(!stale.contains(&"solve/a/signed/r=10".into()), "finished cells are kept");
        }
        project.run(&["run"]).lines();
        assert_same(&project.made(), &reference.made());
        refused += 1;
    }
    assert_eq!(refused, promised("File size limit"));
}
