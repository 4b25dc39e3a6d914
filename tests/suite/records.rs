//! What is left for others to read: the reviewer's certificate, the trace of a run, and times for estimates.

use crate::common::{EVERYTHING, Project, Said, TABLE, assert_same, promised, wanting};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

/// A project with a published table of which one cell comes out differently and one is far off.
fn published() -> Project {
    Project::with(&(wanting(EVERYTHING) + "paper_table = 1\n"))
}

/// How many files the manifest of a certificate names, each of which is in the bundle with the hash it is said to have.
fn files_of_manifest(project: &Project, yaml: &str) -> usize {
    let mut files = 0;
    let mut rest = yaml.lines().filter_map(|line| line.trim_start().split_once(": "));
    while let Some((key, value)) = rest.next() {
        if key == "- file" {
            let (_, comment) = rest.next().unwrap();
            let (_, hash) = comment.trim_matches('"').rsplit_once("blake3 ").unwrap();
            let bytes = fs::read(project.path("codecheck").join(value.trim_matches('"'))).unwrap();
            assert_eq!(signorini::pipeline::hash(&bytes), hash, "{value}");
            files += 1;
        }
    }
    files
}

#[test]
fn a_certificate_says_what_matched_and_how_to_do_it_again() {
    let project = published();
    project.run(&["run"]).lines();
    let args = ["certificate", "--name", "A. \"R\" Reviewer", "--orcid", "0000-0002-1825-0097"];
    let command = |args: &[&str]| {
        let mut command = project.command(args);
        command.env("SOURCE_DATE_EPOCH", "1795245605");
        Said::from(command.output().unwrap())
    };
    let said = command(&args);
    let lines = said.lines();
    assert!(lines[0].ends_with("codecheck/certificate.md"), "{said:?}");
    assert!(lines[1].ends_with("codecheck/codecheck.yml") && said.err.contains("2 of 4"));

    let yaml = fs::read_to_string(project.path("codecheck/codecheck.yml")).unwrap();
    assert!(
        yaml.starts_with("%YAML 1.1\n---\nversion: \"https://codecheck.org.uk/spec/config/1.0\"\n")
    );
    let keys: Vec<&str> = yaml
        .lines()
        .skip(2)
        .filter(|l| !l.starts_with(' '))
        .map(|l| l.split(':').next().unwrap())
        .collect();
    let wanted = "version manifest paper codechecker report summary repository check_time certificate signorini";
    assert_eq!(keys, wanted.split(' ').collect::<Vec<_>>());
    for line in [
        "codechecker:\n  - name: \"A. \\\"R\\\" Reviewer\"\n    ORCID: \"0000-0002-1825-0097\"\n",
        "check_time: \"2026-11-21 07:20:05\"\n",
        "  authors:\n    - name: \"N. N. Maksimova (Н. Н. Максимова)\"\n",
        "    compiler: \"rustc 1.",
        "    processor: \"",
    ] {
        assert!(yaml.contains(line), "{line} is not in {yaml}");
    }
    assert_eq!(files_of_manifest(&project, &yaml), 7, "a table, four figures, and the data of two");

    let page = fs::read_to_string(project.path("codecheck/certificate.md")).unwrap();
    for part in [
        "| Table 1 (`a`) | 2 of 4 | 3 of 4 | 0 of 2 | 2 of 2 |",
        "| Table 1, r = 10, grid 2 | 2 | 4 | within tolerance: off by 2 |",
        "| Table 1, r = 1, grid 2 | 100000 | 7 | **outside** tolerance: off by 99993 |",
        "| Table 1, r = 10, Δa | 1.0e-4 | 2.12e-2 | within tolerance: a factor of ",
        "| `pipeline/scenes/a.toml` | `",
        "| `cargo run --release -- run --locked` | fails if",
        "| cores | ",
        "polars 0.55",
    ] {
        assert!(page.contains(part), "{part} is not in {page}");
    }
    // The same again is the same but for the clock, and nothing is overwritten unasked.
    let first = project.files("codecheck");
    assert!(command(&args).refusal().contains("codecheck.yml is there already; move it away"));
    command(&[&args[..], &["--force"]].concat()).lines();
    assert_same(&project.files("codecheck"), &first);
    assert_eq!(project.run(&["run"]).lines(), ["nothing to do"], "it is no part of the run");
}

#[test]
fn a_certificate_is_refused_unless_everything_is_up_to_date() {
    let project = published();
    let refused = |project: &Project, why: &str| {
        let said = project.run(&["certificate"]);
        assert!(said.refusal().contains(why), "{why}: {said:?}");
        assert!(!project.path("codecheck").exists());
    };
    refused(&project, "of 8 tasks are not up to date (solve/a/signed/r=10 stale: never ran)");
    project.run(&["run"]).lines();
    project.scene("a", &(wanting(EVERYTHING).replace("else=-1", "else=-2") + "paper_table = 1\n"));
    refused(&project, "do `signorini run` first");
    project.scene("a", &(wanting(EVERYTHING) + "paper_table = 1\n"));
    let figure = fs::read(project.path("figures/figure1.svg")).unwrap();
    project.write("figures/figure1.svg", "<svg>mine</svg>");
    refused(&project, "figures/figure1.svg was edited by hand");
    fs::remove_file(project.path("figures/figure1.svg")).unwrap();
    refused(&project, "files in figures/ or report/ are missing or old");
    project.write("figures/figure1.svg", figure);
    let lock = fs::read_to_string(project.path("pipeline/lock.toml")).unwrap();
    project.write("pipeline/lock.toml", lock.replace("[exports]", "\"more\" = \"0\"\n[exports]"));
    refused(&project, "pipeline/lock.toml differs from this run in 1 hashes (more: 0 -> absent)");
    project.write("pipeline/lock.toml", lock);
    let said = project.run(&["certificate", "--output", "nowhere"]);
    assert!(said.refusal().contains("--output nowhere: no such folder; make it with `mkdir"));
    let said = project.run(&["certificate", "--output", "report"]);
    assert!(said.refusal().contains("the certificate would lie in report/"), "{said:?}");
    fs::create_dir(project.path("here")).unwrap();
    project.run(&["certificate", "--output", "here"]).lines();
    assert!(project.path("here/codecheck.yml").exists() && !project.path("codecheck").exists());
    // Nothing to compare with.
    project.scene("a", TABLE);
    project.run(&["run"]).lines();
    refused(&project, "no scene has a `paper_table`");
}

/// The complete events of a trace, by thread, in the order of the file.
fn events(project: &Project, file: &str) -> BTreeMap<u64, Vec<Value>> {
    let trace: Value = serde_json::from_slice(&fs::read(project.path(file)).unwrap()).unwrap();
    let mut threads = BTreeMap::<u64, Vec<Value>>::new();
    for event in trace.as_array().unwrap() {
        match event["ph"].as_str().unwrap() {
            "M" => assert_eq!(event["name"], "thread_name"),
            "X" => threads.entry(event["tid"].as_u64().unwrap()).or_default().push(event.clone()),
            other => panic!("{other}"),
        }
    }
    threads
}

fn of_kind<'a>(threads: &'a BTreeMap<u64, Vec<Value>>, kind: &str) -> Vec<&'a Value> {
    threads.values().flatten().filter(|event| event["cat"] == kind).collect()
}

#[test]
fn a_trace_nests_and_has_one_event_for_each_task_that_ran() {
    let project = published();
    let said = project.run(&["run", "-v", "-j", "2", "--trace", "trace.json"]);
    let threads = events(&project, "trace.json");
    let mut ran: Vec<_> =
        of_kind(&threads, "task").iter().map(|e| e["name"].as_str().unwrap()).collect();
    ran.sort_unstable();
    assert_eq!(ran, said.ran());
    for (thread, events) in &threads {
        // Spans that are open, by their ends: each event lies in the last one, or after it.
        let mut open: Vec<f64> = Vec::new();
        for event in events {
            let start = event["ts"].as_f64().unwrap();
            let end = start + event["dur"].as_f64().unwrap();
            while open.last().is_some_and(|last| *last <= start) {
                open.pop();
            }
            // Microseconds have three decimals.
            assert!(open.last().is_none_or(|last| end <= last + 0.01), "{thread}: {event}");
            open.push(end);
        }
        // Those that run tasks do nothing else: lookups beside them would not nest.
        let of_task = |event: &Value| event["cat"] == "task" || event["cat"] == "step";
        let runs_tasks = of_task(&events[0]);
        assert!(events.iter().all(|event| of_task(event) == runs_tasks), "{thread}");
    }
    for task in of_kind(&threads, "task") {
        assert_eq!(
            (&task["args"]["verdict"], &task["args"]["reason"]),
            (&"ran".into(), &"never ran".into())
        );
        assert!(task["args"]["bytes"].as_u64().unwrap() > 0, "{task}");
    }
    assert_eq!(of_kind(&threads, "lookup").len(), ran.len());

    // One cell anew, everything else a hit; the trace is in nothing that is hashed.
    let made = project.made();
    project.run(&["run", "--trace", "trace.json"]).lines();
    let threads = events(&project, "trace.json");
    assert!(of_kind(&threads, "task").is_empty());
    let lookups = of_kind(&threads, "lookup");
    assert!(lookups.len() == ran.len() && lookups.iter().all(|e| e["args"]["verdict"] == "hit"));
    assert_same(&project.made(), &made);
    let nowhere = project.run(&["run", "--force", "--trace", "no/trace.json"]);
    assert!(nowhere.refusal().contains("cannot write no/trace.json: no such folder"));
}

#[test]
fn a_failed_run_leaves_a_trace_too() {
    let wild = TABLE.replace("else=-1", "else=-1e308").replace("[10, 1]", "[1e12]");
    let project = Project::with(&(wild + "max_iterations = 50\n"));
    assert_eq!(project.run(&["run", "--trace", "trace.json"]).code, Some(3));
    let threads = events(&project, "trace.json");
    let task = of_kind(&threads, "task")[0];
    assert_eq!(task["args"]["verdict"], "failed");
    assert!(task["args"]["reason"].as_str().unwrap().contains("diverged on grid 1/4"), "{task}");
}

#[test]
fn times_of_the_last_run_make_an_estimate_and_nothing_else() {
    let project = Project::with(TABLE);
    assert_eq!(project.run(&["run", "-n"]).err, "", "nothing is known yet");
    let first = project.run(&["run"]);
    assert!(first.err.starts_with("3 tasks to run (never ran)\n"), "{first:?}");
    assert!(first.err.lines().last().unwrap().starts_with("took "), "{first:?}");
    let made = project.made();
    let times: Value =
        serde_json::from_slice(&fs::read(project.path(".signorini/times.json")).unwrap()).unwrap();
    assert_eq!(times["seconds"].as_object().unwrap().len(), 3, "{times}");
    // Known tasks by themselves, a new one by its siblings: two at 100 s on one thread, and a table.
    let known = r#"{"schema":1,"seconds":{"solve/a/signed/r=1":100,"solve/a/signed/r=10":100,"tabulate/a/signed":20}}"#;
    project.write(".signorini/times.json", known);
    project.scene("a", &TABLE.replace("[10, 1]", "[10, 5]"));
    let dry = project.run(&["run", "-n", "-j", "1"]);
    assert_eq!(dry.err, "about 2 min, if all that waits has to run\n");
    let said = project.run(&["run", "-j", "1"]);
    assert!(said.err.starts_with("2 tasks to run, about 2 min left (never ran)\n"), "{said:?}");
    assert!(said.err.contains("(2 min expected)"), "{said:?}");
    // Whatever is in the file, results are the same, and it is mended.
    project.scene("a", TABLE);
    let damage = [&b"{"[..], b"\xff\xfe", b"[]", b""];
    assert_eq!(damage.len() + 2, promised("Record of times damaged"));
    for damage in damage {
        project.write(".signorini/times.json", damage);
        let forced = project.run(&["run", "--force"]);
        assert!(forced.err.starts_with("3 tasks to run (forced)\n"), "{forced:?}");
        assert!(fs::read(project.path(".signorini/times.json")).unwrap().starts_with(b"{\n"));
    }
    fs::remove_file(project.path(".signorini/times.json")).unwrap();
    fs::create_dir(project.path(".signorini/times.json")).unwrap();
    project.run(&["run", "--force"]).lines();
    project.run(&["gc"]).lines();
    let mut now = project.made();
    now.retain(|name, _| made.contains_key(name));
    for (name, bytes) in made.iter().filter(|(name, _)| !name.ends_with(".json")) {
        assert!(now[name] == *bytes, "{name}");
    }
}
