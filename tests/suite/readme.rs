//! Every command in the README and in the chapters that show some runs as written there, and the outputs
//! shown are the true ones.

use crate::common::Project;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Fenced blocks of a page, as (language, text), in order.
fn blocks(page: &str) -> Vec<(String, String)> {
    let text = fs::read_to_string(Path::new(ROOT).join(page)).unwrap();
    let mut blocks = Vec::new();
    // The fence of the block that is open, its language and its text.
    let mut open: Option<(String, String, String)> = None;
    for line in text.lines() {
        let language = line.trim_start_matches('`');
        let fence = &line[..line.len() - language.len()];
        match &mut open {
            None if fence.len() >= 3 => open = Some((fence.into(), language.into(), String::new())),
            None => {}
            // The text that a template puts in ends with a line of its own.
            Some((opened, _, _))
                if line
                    .strip_suffix(&**opened)
                    .is_some_and(|put| put.is_empty() || put.ends_with("}}")) =>
            {
                blocks.extend(open.take().map(|(_, language, text)| (language, text)));
            }
            Some((_, _, text)) => *text += &format!("{line}\n"),
        }
    }
    assert!(open.is_none(), "{page}: {open:?} does not end");
    blocks
}

#[test]
fn what_is_to_be_copied_fits_its_box() {
    /// Columns of a block of code in a window 1280 pixels wide.
    const COLUMNS: usize = 90;
    let mut long = Vec::new();
    let folder = Path::new(ROOT).join("report/templates");
    let pages = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let pages = pages.filter(|path| path.extension().is_some_and(|ending| ending == "tera"));
    for page in pages.chain([Path::new(ROOT).join("README.md")]) {
        for (language, text) in blocks(page.to_str().unwrap()) {
            if ["sh", "toml", "python"].contains(&&*language) {
                long.extend(
                    text.lines().filter(|l| l.chars().count() > COLUMNS).map(str::to_owned),
                );
            }
        }
    }
    for scene in ["plate", "regions", "free-corner"] {
        let text = fs::read_to_string(format!("{ROOT}/pipeline/scenes/{scene}.toml")).unwrap();
        long.extend(text.lines().filter(|l| l.chars().count() > COLUMNS).map(str::to_owned));
    }
    assert!(long.is_empty(), "{long:#?}");
}

/// Runs a README line in `project`, with the program that the tests built instead of `cargo run`.
fn run(line: &str, project: &Path) -> Output {
    let program = format!("'{}'", env!("CARGO_BIN_EXE_signorini"));
    let line = line.replace("cargo run --release -- ", &format!("{program} "));
    let line = line.replace("cargo run --release", &program);
    assert!(!line.contains("cargo"), "{line}");
    let output = Command::new("sh").args(["-c", &line]).current_dir(project).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {stderr}");
    output
}

#[test]
fn commands_run_and_outputs_are_true() {
    let place = Project::whole();
    let project = &place.path("");
    fs::create_dir(project.join("target")).unwrap();
    let mut ran = follow("README.md", project);
    assert_eq!(ran, 8, "commands of the README");
    // The scene put in on the way is gone again, and so is what it had drawn.
    run("cargo run --release", project);
    assert!(!project.join("figures/mine-surface.svg").exists());
    let again = run("cargo run --release", project).stdout;
    let verdict = "nothing to do: up to date; Tables 1 and 2: 50 of 50 counts as published, 9 of 10 Delta a to both \
        digits\nthe book: report/book/index.html\n";
    assert_eq!(String::from_utf8(again).unwrap(), verdict);
    assert!(project.join("report/book/index.html").is_file());
    assert!(project.join("target/v.svg").is_file());
    assert!(project.join("codecheck/codecheck.yml").is_file());

    ran = follow("report/templates/own-problems.md.tera", project);
    assert_eq!(ran, 11, "commands of the chapter");
    assert!(project.join("target/mesh.svg").is_file());
    assert!(project.join("target/line.csv").is_file());
    assert!(project.join("target/first/pipeline/scenes/plate.toml").is_file());

    // The page of the gallery has the commands as the run writes them.
    let gallery = project.join("report/src/gallery.md");
    ran = follow(gallery.to_str().unwrap(), project);
    assert_eq!(ran, 13, "commands of the gallery");
    let figures = fs::read_dir(project.join("figures")).unwrap();
    let names = figures.map(|file| file.unwrap().file_name().into_string().unwrap());
    let names = names.filter_map(|name| name.strip_suffix("-map.svg").map(str::to_owned));
    for name in names {
        // All but the lines for readers who cannot see the picture.
        let drawn = |folder: &str| {
            let svg = fs::read_to_string(project.join(folder)).unwrap();
            let lines = svg
                .lines()
                .filter(|l| !["<title>", "<desc>"].iter().any(|start| l.starts_with(start)));
            lines.map(str::to_owned).collect::<Vec<_>>()
        };
        run(
            &format!("cargo run --release -- solve {name} --map --out target/of-scene.svg"),
            project,
        );
        let [target, figure] = ["target/of-scene.svg".into(), format!("figures/{name}-map.svg")];
        assert_eq!(drawn(&target), drawn(&figure), "{name} of the command and of the run");
    }

    let pages = [("tutorial", 8), ("domains", 1), ("claims", 1), ("studies", 6)];
    for (page, commands) in pages {
        let page = project.join(format!("report/src/{page}.md"));
        assert_eq!(follow(page.to_str().unwrap(), project), commands, "{page:?}");
    }
    assert!(project.join("figures/round-map.svg").is_file());
    fs::remove_file(project.join("pipeline/scenes/round.toml")).unwrap();
    commands_of_captions_run(project);
}

#[test]
fn the_citation_and_the_changes_are_of_this_version() {
    let read = |file: &str| fs::read_to_string(Path::new(ROOT).join(file)).unwrap();
    let (citation, changes) = (read("CITATION.cff"), read("CHANGELOG.md"));
    let version = env!("CARGO_PKG_VERSION");
    assert!(citation.lines().any(|line| line == format!("version: {version}")), "{version}");
    let mut versions = changes.lines().filter_map(|line| line.strip_prefix("## "));
    let newest = versions.find(|version| *version != "Unreleased").unwrap();
    let (of, date) = newest.split_once(", ").unwrap();
    assert_eq!(of, version);
    assert!(citation.lines().any(|line| line == format!("date-released: \"{date}\"")), "{date}");
    let introduction = read("report/templates/introduction.md.tera");
    assert!(introduction.contains(&format!("  year = {{{}}}\n", &date[..4])), "{date}");
    let image = read("Containerfile");
    let compiler = read("rust-toolchain.toml");
    let (_, used) = image.split_once("rust:").unwrap();
    assert!(compiler.contains(&format!("channel = \"{}.", used.split('-').next().unwrap())));
    let archive: serde_json::Value = serde_json::from_str(&read(".zenodo.json")).unwrap();
    let title = archive["title"].as_str().unwrap();
    assert!(citation.contains(&format!("title: \"{title}\"")), "{title}");
}

/// The commands in captions of figures and tables make what is there already, but for one that takes minutes.
fn commands_of_captions_run(project: &Path) {
    let mut commands = BTreeSet::new();
    for page in fs::read_dir(project.join("report/src")).unwrap() {
        let path = page.unwrap().path();
        let text = if path.is_file() {
            fs::read_to_string(&path).unwrap_or_default()
        } else {
            String::new()
        };
        for rest in text.split("<span class=\"command\">Command `").skip(1) {
            commands.insert(rest.split('`').next().unwrap().to_owned());
        }
    }
    assert!(commands.len() > 8, "{commands:?}");
    run("cargo run --release -- run", project);
    for command in commands {
        let line = command.replace("signorini", "cargo run --release --");
        let said = String::from_utf8(run(&line, project).stdout).unwrap();
        assert!(
            said.starts_with("nothing to do") || command == "signorini diff",
            "{command}: {said}"
        );
    }
}

/// Does what a page says in its fenced blocks; returns how many commands that were.
fn follow(page: &str, project: &Path) -> usize {
    let blocks = blocks(page);
    let mut ran = 0;
    for (k, (language, text)) in blocks.iter().enumerate() {
        if language == "toml" && !text.is_empty() {
            fs::write(project.join("pipeline/scenes/mine.toml"), text).unwrap();
            run("cargo run --release -- run mine", project);
            fs::remove_file(project.join("pipeline/scenes/mine.toml")).unwrap();
        }
        if language != "sh" {
            continue;
        }
        // A command may go on in the next line.
        let text = text.replace("\\\n", " ");
        for line in text.lines().filter(|line| *line != "cargo test --release") {
            let output = run(line, project);
            ran += 1;
            let shown = blocks.get(k + 1).filter(|(language, _)| language == "text");
            if let Some((_, shown)) = shown {
                let true_output = String::from_utf8(output.stdout).unwrap();
                assert_eq!(without_times(&true_output), without_times(shown), "after `{line}`");
            }
        }
    }
    ran
}

/// Times, and how many files a run found missing, differ from run to run.
fn without_times(text: &str) -> String {
    let is_time = |word: &&str| word.parse::<f64>().is_ok_and(|_| word.contains('.'));
    text.lines()
        .filter(|line| !line.contains("files written"))
        .filter(|line| !line.starts_with("time: "))
        .map(|line| match line.split_once(" ran ") {
            Some((stage, rest)) => {
                let rest: Vec<_> = rest.split_whitespace().filter(|w| !is_time(w)).collect();
                format!("{stage} ran {}\n", rest.join(" "))
            }
            None => format!("{line}\n"),
        })
        .collect()
}
