//! The tasks run by engines of others, and by several processes on one cache: each once, to the same bytes.

use crate::common::{EVERYTHING, Project, TABLE, assert_same, skip, wanting};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Six cells of two scenes, their tables, pictures and a book.
fn small() -> Project {
    let project = Project::with(&wanting(EVERYTHING));
    project.scene("b", &TABLE.replace("else=-1", "disc(0,0,0.3)=1; else=-2"));
    project.add_book("# One\n");
    project
}

/// As many scenes with one cell and a table each.
fn many(scenes: usize) -> Project {
    let scene = |k: usize| {
        let f = format!("else=-{}.{:03}", 1 + k / 1000, k % 1000 + 1);
        TABLE.replace("else=-1", &f).replace("[10, 1]", "[10]")
    };
    let project = Project::with(&scene(0));
    (1..scenes).for_each(|k| project.scene(&format!("s{k:03}"), &scene(k)));
    project
}

/// Ids of all tasks, each after all it needs.
fn tasks(project: &Project) -> Vec<String> {
    let dag = project.run(&["dag"]);
    dag.lines().iter().map(|line| line.split(" <- ").next().unwrap().to_owned()).collect()
}

/// What one run makes of the same project.
fn made_at_once(project: fn() -> Project) -> BTreeMap<String, Vec<u8>> {
    let reference = project();
    reference.run(&["run"]).lines();
    reference.made()
}

#[test]
fn results_do_not_depend_on_threads_or_place() {
    let made = made_at_once(small);
    assert!(made.len() > 20, "there is something to compare: {}", made.len());
    for jobs in ["1", "5"] {
        let elsewhere = small();
        elsewhere.run(&["run", "-j", jobs]).lines();
        assert_same(&elsewhere.made(), &made);
    }
}

/// After the engine: nothing is left to run, and what is written then is as after one run.
#[track_caller]
fn assert_done(project: &Project, wanted: &BTreeMap<String, Vec<u8>>) {
    assert!(!project.path("figures").exists(), "an engine writes to the cache alone");
    let run = project.run(&["run", "-v"]);
    assert_eq!(run.ran(), [""; 0], "{run:?}");
    assert_same(&project.made(), wanted);
    project.run(&["run"]).nothing_to_do();
}

#[test]
fn single_tasks_make_what_a_run_makes() {
    let project = small();
    for id in tasks(&project) {
        let ran = project.run(&["run", "-v", "--task", &id]);
        assert_eq!(ran.ran(), [id.as_str()]);
        project.run(&["run", "--task", &id]).nothing_to_do();
    }
    assert_done(&project, &made_at_once(small));
}

#[test]
fn processes_at_work_on_one_cache_do_each_task_once() {
    let project = small();
    let ids = tasks(&project);
    let args: Vec<&str> = ids.iter().flat_map(|id| ["--task", id]).collect();
    let args = [&["run", "-v"], &args[..]].concat();
    let start = || {
        let mut command = project.command(&args);
        command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let children: Vec<_> = (0..6).map(|_| start()).collect();
    let mut ran: Vec<String> = Vec::new();
    for child in children {
        let said = crate::common::Said::from(child.wait_with_output().unwrap());
        ran.extend(said.ran().into_iter().map(str::to_owned));
    }
    ran.sort();
    let mut wanted = ids;
    wanted.sort();
    assert_eq!(ran, wanted, "each once, by whichever process");
    assert_done(&project, &made_at_once(small));
}

#[test]
fn whole_runs_and_gc_keep_out_of_the_way_of_single_tasks() {
    let project = small();
    let id = &tasks(&project)[0];
    let args = ["run", "--task", id];
    project.run(&args).lines();
    let lock =
        File::options().read(true).write(true).open(project.path(".signorini/lock")).unwrap();
    lock.lock_shared().unwrap();
    for command in ["run", "gc"] {
        let said = project.run(&[command]);
        assert!(said.refusal().contains("(`run --task`) is at work"), "{said:?}");
    }
    project.run(&args).lines();
    lock.unlock().unwrap();
    // The other way round, single tasks wait.
    lock.lock().unwrap();
    let mut child = project.command(&args);
    let mut child = child.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let waits = lines.next().unwrap().unwrap();
    assert!(waits.starts_with("waiting for ") && child.try_wait().unwrap().is_none(), "{waits}");
    lock.unlock().unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout), "nothing to do: up to date\n");
}

#[test]
fn a_killed_process_loses_its_task_alone() {
    // A cell that would take minutes, and one that takes none.
    let text = TABLE.replace("[4, 8]", "[4, 8, 16, 32, 64, 128]").replace("signed", "printed");
    let slow = "r = [1e-9, 10]\nmax_iterations = 100000000";
    let project = Project::with(&text.replace("r = [10, 1]", slow));
    let [long, short] = ["solve/a/printed/r=0.000000001", "solve/a/printed/r=10"];
    let mut child = project.command(&["run", "--task", long]);
    let mut child = child.stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let line = lines.next().unwrap().unwrap();
    assert!(line.starts_with("1 task to run"), "{line}");
    assert_eq!(project.run(&["run", "-v", "--task", short]).ran(), [short]);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(project.stale(), [long, "tabulate/a"]);
    // Its lock has died with it.
    project.run(&["gc"]).lines();
    let text = project.read("pipeline/scenes/a.toml");
    project.scene("a", &text.replace("100000000", "100"));
    assert_eq!(project.run(&["run", "-v", "--task", long]).ran(), [long]);
}

/// A workflow for the project, in a file of it.
fn workflow(project: &Project, form: &str, name: &str) {
    let said = project.run(&["dag", form]);
    assert_eq!(said.code, Some(0), "{said:?}");
    project.write(name, said.out);
}

/// Runs an engine in the project.
fn engine(project: &Project, command: &str, args: &[&str]) -> Output {
    let mut command = Command::new(command);
    command.args(args).current_dir(project.path("")).stdin(Stdio::null());
    command.env_remove("SNAKEMAKE_PROFILE").output().unwrap()
}

/// Whether a program can be started.
fn is_there(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).status().is_ok()
}

/// A command for engines that is the program, but notes each task that it is asked for.
fn noted(project: &Project, file: &str, name: &str) -> String {
    let program = env!("CARGO_BIN_EXE_signorini");
    let wrapper =
        "#!/bin/sh\ncase $1 in run) echo \"$*\" >> PLACE/asked ;; esac\nexec PROGRAM \"$@\"\n";
    let place = project.path("").to_string_lossy().into_owned();
    project.write(name, wrapper.replace("PLACE", &place).replace("PROGRAM", program));
    let path = project.path(name);
    #[cfg(unix)]
    fs::set_permissions(&path, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let text = project.read(file);
    project.write(file, text.replace(program, &path.to_string_lossy()));
    path.to_string_lossy().into_owned()
}

/// How many tasks engines have asked for since the last time.
fn asked(project: &Project) -> usize {
    let path = project.path("asked");
    let asked = fs::read_to_string(&path).unwrap_or_default().lines().count();
    let _ = fs::remove_file(path);
    asked
}

/// Characters that are special to a shell, to Python or to Snakemake.
const SPECIAL: &str = "a b'c\"d#e$HOME%f:g=h(i)&j~k!`l`é";

#[test]
#[cfg(unix)]
fn snakemake_runs_a_program_and_a_project_in_folders_with_special_names() {
    if !is_there("snakemake") {
        return skip(NO_SNAKEMAKE);
    }
    let folder = tempfile::tempdir().unwrap();
    let [program, project, elsewhere] =
        ["program", "project", "cache"].map(|name| folder.path().join(format!("{name} {SPECIAL}")));
    fs::create_dir(&program).unwrap();
    let program = program.join("signorini");
    fs::copy(env!("CARGO_BIN_EXE_signorini"), &program).unwrap();
    fs::create_dir_all(project.join("pipeline/scenes")).unwrap();
    fs::create_dir(project.join("report")).unwrap();
    fs::write(project.join("pipeline/scenes/it's $HOME.toml"), TABLE).unwrap();
    let succeeds = |program: &Path, args: &[&str]| {
        let mut command = Command::new(program);
        let output =
            command.args(args).current_dir(&project).stdin(Stdio::null()).output().unwrap();
        assert!(output.status.success(), "{args:?}: {output:?}");
        output.stdout
    };
    // The cache in the project, and elsewhere.
    for cache in [project.join(".signorini"), elsewhere] {
        let options = ["--cache-dir", cache.to_str().unwrap()];
        let text = succeeds(&program, &[&["dag", "--snakemake"], &options[..]].concat());
        fs::write(project.join("workflow"), text).unwrap();
        let args = ["--cores", "1", "--quiet", "all", "--snakefile", "workflow"];
        succeeds(Path::new("snakemake"), &args);
        let stamps = fs::read_dir(cache.join("v2/stamps")).unwrap().count();
        assert_eq!(stamps, 3, "two cells and their table");
        let said = succeeds(&program, &[&["run", "-v"], &options[..]].concat());
        assert!(!String::from_utf8_lossy(&said).contains(" ran "), "{said:?}");
    }
}

#[test]
fn the_dag_as_json_has_a_stamp_for_each_task() {
    let project = small();
    let dag = || project.run(&["dag", "--json"]).json();
    let json = dag();
    assert_eq!(json["schema"], 1);
    let all = json["tasks"].as_array().unwrap();
    let ids: Vec<&str> = all.iter().map(|task| task["id"].as_str().unwrap()).collect();
    assert_eq!(ids, tasks(&project));
    let stamp = |k: usize| PathBuf::from(all[k]["stamp"].as_str().unwrap());
    project.run(&["run", "--task", ids[0]]).lines();
    assert!(project.path("").join(stamp(0)).exists() && !project.path("").join(stamp(1)).exists());
    assert_eq!(dag(), json, "a run does not change what is to be made");
    let snakefile = project.run(&["dag", "--snakemake"]).out;
    for id in ids {
        let stage = id.split('/').next().unwrap();
        let rule = format!("rule {stage}:");
        assert_eq!(snakefile.matches(&rule).count(), 1, "{snakefile}");
    }
}

/// What is said where Snakemake is not installed.
const NO_SNAKEMAKE: &str =
    "no snakemake on the PATH (`pip install snakemake` in a virtual environment)";

/// Runs Snakemake in the project; `None` where there is none.
fn snakemake(project: &Project, args: &[&str]) -> Option<Output> {
    if !is_there("snakemake") {
        skip(NO_SNAKEMAKE);
        return None;
    }
    workflow(project, "--snakemake", "Snakefile");
    noted(project, "Snakefile", "noted");
    let output = engine(project, "snakemake", args);
    assert!(output.status.success(), "{output:?}");
    Some(output)
}

#[test]
fn snakemake_runs_the_tasks() {
    let project = small();
    let args = ["--cores", "2", "--quiet", "all"];
    if snakemake(&project, &args).is_none() {
        return;
    }
    assert_eq!(asked(&project), tasks(&project).len());
    engine(&project, "snakemake", &args);
    assert_eq!(asked(&project), 0, "what is done is done");
    assert_done(&project, &made_at_once(small));
    project.scene("b", &TABLE.replace("else=-1", "disc(0,0,0.3)=1; else=-3"));
    assert!(engine(&project, "snakemake", &args).status.success());
    assert_eq!(asked(&project), 5);
}

#[test]
#[ignore = "takes some minutes; run with --ignored"]
fn snakemake_runs_two_hundred_scenes() {
    let project = many(200);
    if snakemake(&project, &["--cores", "2", "--quiet", "all"]).is_some() {
        assert_done(&project, &made_at_once(|| many(200)));
    }
}
