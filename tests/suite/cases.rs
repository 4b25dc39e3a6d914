//! Commands with what they print: the pages `tests/cases/*.md`, which read as documentation and are run as tests.
//!
//! A block of code whose language is followed by a path is a file; a block `console` holds commands of the shell, each
//! behind `$ ` and followed by what it prints. A part of a page, from one `## ` to the next, has a project of its own,
//! in which the files before the first part are as well. A refusal, exit code 2 with one line `error: ` on standard
//! error and nothing else, is that line. Otherwise `? ` has the exit code where it is not 0, and lines of standard
//! error follow those of standard output, each behind `2> `. In what is printed, `[..]` stands for any text within a
//! line, and a line `...` for any number of lines.
//!
//! `UPDATE_EXPECT=1` writes anew what the commands print now, where that differs. Lines of times, `time: ` and `took `,
//! are written without the times.

use crate::common::{Project, Said, TALK, promised};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// One test for each page.
macro_rules! pages {
    ($($page:ident),+ $(,)?) => {
        const PAGES: &[&str] = &[$(stringify!($page)),+];
        $(#[test]
        fn $page() {
            check(stringify!($page));
        })+
    };
}

pages! {
    answers, book, boundary, cache, certificate, comparison, damage, domains, equations, f, files, identify, init, links,
    meshes, names, others, refusals, runs, studies,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases")
}

#[test]
fn each_page_is_run() {
    let files = fs::read_dir(folder()).unwrap().map(|file| file.unwrap().path());
    let mut names: Vec<_> = files.map(|file| file.with_extension("")).collect();
    names.sort_unstable();
    assert_eq!(names, PAGES.iter().map(|page| folder().join(page)).collect::<Vec<_>>());
}

/// Runs a page, and compares or writes anew what it says that its commands print.
fn check(page: &str) {
    let file = folder().join(page).with_extension("md");
    let text = fs::read_to_string(&file).unwrap();
    let (now, wrong) = run(&text);
    if std::env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(&file, now).unwrap();
    } else {
        assert!(wrong.is_empty(), "UPDATE_EXPECT=1 writes tests/cases/{page}.md anew\n{wrong}");
    }
}

/// The page with what its commands print now, where that differs, and the commands for which it does.
fn run(page: &str) -> (String, String) {
    let (mut now, mut wrong) = (String::new(), String::new());
    let mut common: Vec<(&str, String)> = Vec::new();
    let mut project: Option<Project> = None;
    let mut lines = page.lines().enumerate();
    while let Some((_, line)) = lines.next() {
        writeln!(now, "{line}").unwrap();
        if line.starts_with("## ") {
            project = Some(new_project(&common));
        }
        let Some(head) = line.strip_prefix("```") else { continue };
        let (first, block) = block(&mut lines);
        if head == "console" {
            let project = project.as_ref().expect("commands stand in a part of the page");
            let mut at = 0;
            while at < block.len() {
                let line = first + at;
                let (command, expected) = case(&block, &mut at);
                let said = told(&shell(project, &command.join("\n")));
                if matches(expected, &said.lines().collect::<Vec<_>>()) {
                    command.iter().chain(expected).for_each(|line| now += &format!("{line}\n"));
                    continue;
                }
                let command = command.join("\n");
                write!(now, "{command}\n{said}").unwrap();
                writeln!(wrong, "{line}: {command}\n{said}instead of\n{}\n", expected.join("\n"))
                    .unwrap();
            }
        } else if let Some((_, path)) = head.split_once(' ') {
            let text = block.iter().fold(String::new(), |text, line| text + line + "\n");
            now += &text;
            match &project {
                Some(project) => add_file(project, path, &text),
                None => common.push((path, text)),
            }
        }
        now += "```\n";
    }
    (now, wrong)
}

/// A project with these files.
fn new_project(files: &[(&str, String)]) -> Project {
    let project = Project::empty();
    files.iter().for_each(|(path, text)| add_file(&project, path, text));
    project
}

fn add_file(project: &Project, path: &str, text: &str) {
    fs::create_dir_all(project.path(path).parent().unwrap()).unwrap();
    project.write(path, text);
}

/// Number of the first line of a block and its lines.
fn block<'a>(lines: &mut impl Iterator<Item = (usize, &'a str)>) -> (usize, Vec<&'a str>) {
    let block: Vec<_> = lines.take_while(|(_, line)| !line.starts_with("```")).collect();
    (block.first().map_or(0, |(k, _)| k + 1), block.into_iter().map(|(_, line)| line).collect())
}

/// The next command of a block, over lines that end with a backslash, and what is printed.
fn case<'a, 'b>(block: &'b [&'a str], at: &mut usize) -> (&'b [&'a str], &'b [&'a str]) {
    let start = *at;
    assert!(block[start].starts_with("$ "), "a command begins with `$ `: {}", block[start]);
    while block[*at].ends_with('\\') {
        *at += 1;
    }
    *at += 1;
    let printed = *at;
    while *at < block.len() && !block[*at].starts_with("$ ") {
        *at += 1;
    }
    (&block[start..printed], &block[printed..*at])
}

/// Runs a line of the shell in a project, where `signorini` is the program.
fn shell(project: &Project, command: &str) -> Said {
    let program = Path::new(env!("CARGO_BIN_EXE_signorini")).parent().unwrap().to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths([program].into_iter().chain(std::env::split_paths(&path)));
    let mut bash = Command::new("bash");
    bash.args(["-c", command.trim_start_matches("$ ")]).env("PATH", path.unwrap());
    TALK.iter().for_each(|name| _ = bash.env_remove(name));
    let meshes = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/meshes");
    bash.env("MESHES", meshes).current_dir(project.path(""));
    let said: Said = bash.stdin(Stdio::null()).output().expect("bash starts").into();
    // The place of the project is not the same everywhere. Nor is that of the checkout, after whose length lines are
    // broken elsewhere: nothing that is printed has it.
    let folder = project.path("").to_string_lossy().into_owned();
    let plain = |text: &str| text.replace(folder.trim_end_matches('/'), "[..]");
    Said { code: said.code, out: plain(&said.out), err: plain(&said.err) }
}

/// What a command printed, as pages have it.
fn told(said: &Said) -> String {
    let is_refusal = said.code == Some(2) && said.out.is_empty() && said.err.lines().count() == 1;
    if is_refusal && said.err.starts_with("error: ") {
        return said.err.clone();
    }
    let mut text = String::new();
    match said.code {
        Some(0) => {}
        Some(code) => writeln!(text, "? {code}").unwrap(),
        None => text += "? signal\n",
    }
    said.out.lines().for_each(|line| writeln!(text, "{}", without_times(line)).unwrap());
    said.err.lines().for_each(|line| writeln!(text, "2> {}", without_times(line)).unwrap());
    text
}

/// A line of an answer or of a run without the times that it tells.
fn without_times(line: &str) -> &str {
    ["time: [..]", "took [..]"]
        .into_iter()
        .find(|told| line.starts_with(told.trim_end_matches("[..]")))
        .unwrap_or(line)
}

/// Whether these lines are the expected ones; empty lines at the end do not count.
fn matches(expected: &[&str], lines: &[&str]) -> bool {
    match (expected, lines) {
        ([rest @ .., ""], _) if lines.last() != Some(&"") => matches(rest, lines),
        ([], _) => lines.is_empty(),
        (["...", rest @ ..], _) => (0..=lines.len()).any(|k| matches(rest, &lines[k..])),
        ([first, rest @ ..], [line, lines @ ..]) => {
            matches_line(first, line) && matches(rest, lines)
        }
        _ => false,
    }
}

fn matches_line(expected: &str, line: &str) -> bool {
    match expected.split_once("[..]") {
        None => expected == line,
        Some((start, rest)) => line.strip_prefix(start).is_some_and(|line| {
            (0..=line.len()).any(|k| line.is_char_boundary(k) && matches_line(rest, &line[k..]))
        }),
    }
}

#[test]
fn pages_have_as_many_faults_as_promised() {
    for (page, part, mark, fault) in [
        ("files", "## Mistakes in a scene\n", "error: scene `a`: ", "Mistake in a scene"),
        (
            "runs",
            "## A record that is damaged",
            "[..]/pipeline/lock.toml: line",
            "`pipeline/lock.toml` damaged",
        ),
    ] {
        let text = fs::read_to_string(folder().join(page).with_extension("md")).unwrap();
        let part = text.split_once(part).unwrap().1.split("\n## ").next().unwrap();
        assert_eq!(part.matches(mark).count(), promised(fault), "{fault}");
    }
}

#[test]
fn what_differs_is_found_and_written_anew() {
    let page =
        "## A\n```console\n$ echo a b; exit 3\n? 3\na [..]\n$ echo c >&2\n...\n2> d\n```\nend\n";
    let (now, wrong) = run(page);
    assert_eq!(wrong, "6: $ echo c >&2\n2> c\ninstead of\n...\n2> d\n\n");
    assert_eq!(now, page.replace("...\n2> d\n", "2> c\n"));
}
