//! Random edits of a study: a dry run lists what the run then runs, and the run exports, byte for byte, what a run with
//! an empty cache exports.
//!
//! `SIGNORINI_EDITS` is the number of edits, 200 without it; `SIGNORINI_SEED` is the seed of the first study, which a
//! failure prints.

mod beside;

use crate::common::{Dice, PAPER, Project, Said, mesh_path};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::sync::LazyLock;

/// Edits of one study, after which another one begins.
const EDITS_OF_A_STUDY: usize = 20;

/// Of so many studies, one has a book.
const STUDIES_PER_BOOK: u64 = 10;

/// Files of a study that a run reads, by path.
pub(crate) type Files = BTreeMap<String, String>;

/// Scenes that share their keys: by a saddle-point method on the square, by another solver there, on a mesh, and those
/// that vary something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Method,
    Plain,
    Mesh,
    Varied,
}

use Kind::{Mesh, Method, Plain, Varied};

impl Kind {
    fn named(name: &str) -> Self {
        match name {
            "method" => Method,
            "plain" => Plain,
            "mesh" => Mesh,
            _ => Varied,
        }
    }
}

/// Kinds of scenes, a key that they have, and values of it.
type Key = (Vec<Kind>, &'static str, Vec<&'static str>);

/// Keys of scenes of some kinds, with values of each.
pub(crate) static KEYS: LazyLock<Vec<Key>> = LazyLock::new(|| {
    let lines = include_str!("edits/keys.txt").lines().filter(|line| !line.starts_with('#'));
    let keys = lines.map(|line| {
        let mut parts = line.split(" ¦ ");
        let kinds = parts.next().expect("kinds").split(',').map(Kind::named);
        (kinds.collect(), parts.next().expect("a key"), parts.collect())
    });
    keys.collect()
});

/// Kind of a scene.
pub(crate) fn kind(text: &str) -> Kind {
    let solves_by = |name: &str| text.contains(&format!("solver = \"{name}\""));
    if text.contains("vary = ") {
        return Varied;
    }
    match text.contains("domain = ") && !text.contains("\"square\"") {
        true => Mesh,
        false if solves_by("arrow-hurwicz") || solves_by("uzawa") => Method,
        false => Plain,
    }
}

const PAGES: &str = "report/templates";

/// A study with a scene by the paper's method, one by multigrid, and one on a mesh.
pub(crate) fn study() -> Files {
    let method = "title = \"One\"\nf = \"quadrant(ll)=3; else=-1.1\"\nsolver = \"arrow-hurwicz\"\ngrids = [4, 8]\n\
        r = [10, 1]\nstop = [\"signed\", \"printed\"]\noutputs = [\"table\", \"surface\", \"contact\", \"history\"]\n";
    let plain =
        "title = \"Two\"\nf = \"else=-1\"\ngrids = [4, 8]\noutputs = [\"table\", \"map\"]\n";
    let on_mesh = "title = \"Two\"\nf = \"else=-1\"\ndomain = { name = \"meshes/one.msh\", refine = 2 }\n\
        outputs = [\"table\", \"surface\"]\n";
    let varied = "title = \"Two\"\nf = \"disc(0,0,$R)=$b; else=-3\"\nh = 8\n\
        vary = { R = [0.1, \"1/4\"], b = [1, -0.5] }\noutputs = [\"table\", \"chart\"]\n";
    let files = [
        ("pipeline/scenes/a.toml", method.into()),
        ("pipeline/scenes/b.toml", plain.into()),
        ("pipeline/scenes/c.toml", on_mesh.into()),
        ("pipeline/scenes/v.toml", varied.into()),
        ("pipeline/meshes/one.msh", fs::read_to_string(mesh_path("square")).unwrap()),
        ("pipeline/paper.toml", PAPER.into()),
    ];
    files.map(|(path, text)| (path.to_owned(), text)).into()
}

/// A book of one page; with it, a run also makes the table of all results.
pub(crate) fn book() -> Files {
    let files = [
        ("report/templates/SUMMARY.md", "- [One](one.md)\n"),
        ("report/templates/one.md", "# One\n\nText.\n"),
    ];
    files.map(|(path, text)| (path.to_owned(), text.to_owned())).into()
}

/// One of several things.
fn one_of<'a, T>(dice: &mut Dice, things: &'a [T]) -> &'a T {
    &things[dice.below(things.len() as u64) as usize]
}

/// Paths of a study in a folder.
fn below(files: &Files, folder: &str) -> Vec<String> {
    files.keys().filter(|path| path.starts_with(folder)).cloned().collect()
}

/// Changes, adds or removes a key of a scene, or the order of its keys. Of a dozen keys, one may be of another kind.
fn edit_scene(dice: &mut Dice, text: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let (kind, any) = (kind(text), dice.below(12) == 0);
    let known: Vec<_> = KEYS.iter().filter(|(kinds, ..)| any || kinds.contains(&kind)).collect();
    let (_, key, values) = *one_of(dice, &known);
    let at = lines.iter().position(|line| line.starts_with(&format!("{key} = ")));
    match (dice.below(12), at) {
        (0, _) => lines.rotate_left(1),
        (1, _) => lines.insert(0, "# A remark.".into()),
        (2, Some(at)) => _ = lines.remove(at),
        (_, Some(at)) => lines[at] = format!("{key} = {}", one_of(dice, values)),
        (_, None) => lines.push(format!("{key} = {}", one_of(dice, values))),
    }
    lines.join("\n") + "\n"
}

/// Makes one edit, and says what it was.
fn edit(dice: &mut Dice, files: &mut Files) -> String {
    let scenes = below(files, "pipeline/scenes");
    let scene = one_of(dice, &scenes).clone();
    let other = format!("pipeline/scenes/{}.toml", one_of(dice, &["a", "b", "c", "d e"]));
    let page =
        format!("{PAGES}/{}", one_of(dice, &["one.md", "two.md", "three.md.tera", "sub/x.txt"]));
    let has_book = files.contains_key("report/templates/SUMMARY.md");
    match dice.below(16) {
        0 => {
            let text = files.remove(&scene).unwrap();
            let replaced = files.insert(other.clone(), text);
            // A name that is taken: both change places.
            files.extend(replaced.filter(|_| scene != other).map(|text| (scene.clone(), text)));
            format!("{scene} renamed {other}")
        }
        1 if scenes.len() > 1 => {
            files.remove(&scene);
            format!("{scene} removed")
        }
        2 => {
            files.insert(other.clone(), files[&scene].clone());
            format!("{scene} copied to {other}")
        }
        3 => {
            let mesh = files.get_mut("pipeline/meshes/one.msh").unwrap();
            *mesh = match mesh.contains("\"south\"") {
                true => mesh.replace("\"south\"", "\"north\""),
                false => mesh.replace("\"north\"", "\"south\"") + "\n",
            };
            "the mesh".into()
        }
        4 | 5 if has_book => {
            let text = format!("# Page\n\nText {}.\n", dice.below(3));
            files.insert(page.clone(), text);
            let mut summary = String::new();
            for path in below(files, PAGES).iter().filter(|path| path.ends_with(".md")) {
                let name = &path[PAGES.len() + 1..];
                summary += if name == "SUMMARY.md" { "" } else { "- [Page](" };
                summary += &if name == "SUMMARY.md" { String::new() } else { format!("{name})\n") };
            }
            files.insert(format!("{PAGES}/SUMMARY.md"), summary);
            format!("{page} written")
        }
        6 if has_book => {
            files.remove(&page);
            format!("{page} removed")
        }
        7 => {
            let paper = files.get_mut("pipeline/paper.toml").unwrap();
            *paper = match paper.contains("[1, 100000]") {
                true => paper.replace("[1, 100000]", "[1, 7]"),
                false => paper.replace("[1, 7]", "[1, 100000]"),
            };
            "the published table".into()
        }
        _ => {
            let text = edit_scene(dice, &files[&scene]);
            format!("{scene}: {:?} -> {text:?}", files.insert(scene.clone(), text.clone()).unwrap())
        }
    }
}

/// Brings the files of a project from one state to another.
pub(crate) fn write(project: &Project, from: &Files, to: &Files) {
    for path in from.keys().filter(|path| !to.contains_key(*path)) {
        fs::remove_file(project.path(path)).unwrap();
    }
    for (path, text) in to.iter().filter(|(path, text)| from.get(*path) != Some(text)) {
        fs::create_dir_all(project.path(path).parent().unwrap()).unwrap();
        project.write(path, text);
    }
}

/// A folder with these files, and no cache.
fn project(files: &Files) -> Project {
    let project = Project::empty();
    write(&project, &Files::new(), files);
    project
}

/// Files that a run exports, by path.
pub(crate) type Exported = BTreeMap<String, Vec<u8>>;

/// What a run exports and is compared; nothing of it is written by hand.
pub(crate) fn exported(project: &Project) -> Exported {
    let mut files = BTreeMap::new();
    for folder in ["figures", "report/src", "report/tables"] {
        let below = project.files(folder).into_iter();
        files.extend(below.map(|(name, bytes)| (format!("{folder}/{name}"), bytes)));
    }
    for file in ["report/results.csv", "pipeline/lock.toml"] {
        files.extend(fs::read(project.path(file)).ok().map(|bytes| (file.to_owned(), bytes)));
    }
    files
}

/// Tasks that a dry run lists as stale, and those that wait for them.
fn listed(dry: &Said) -> [BTreeSet<&str>; 2] {
    let lines = dry.out.lines().filter_map(|line| line.split_once(": "));
    let (stale, waits): (Vec<_>, Vec<_>) = lines
        .filter(|(_, verdict)| verdict.starts_with("stale") || verdict.starts_with("waits"))
        .partition(|(_, verdict)| verdict.starts_with("stale"));
    [stale, waits].map(|tasks| tasks.into_iter().map(|(task, _)| task).collect())
}

/// States of a study, each with what a run with an empty cache exported; none where it failed.
type Known = BTreeMap<Files, Result<Exported, Said>>;

/// What a run with an empty cache exports.
fn first_run(files: &Files) -> Result<Exported, Said> {
    let fresh = project(files);
    let run = fresh.run(&["run"]);
    if run.code == Some(0) { Ok(exported(&fresh)) } else { Err(run) }
}

/// Compares the dry run with the run, and the run with one of an empty cache; says what differs. `Ok(false)` if the
/// study is refused, or fails as a run with an empty cache does.
fn check(project: &Project, files: &Files, known: &mut Known) -> Result<bool, String> {
    let dry = project.run(&["run", "-n"]);
    let run = project.run(&["run", "-v"]);
    if dry.code == Some(2) {
        return match dry.refusal() == run.refusal() {
            true => Ok(false),
            false => Err(format!("refused differently:\n{dry:?}\n{run:?}")),
        };
    }
    let first = known.entry(files.clone()).or_insert_with(|| first_run(files));
    let theirs = match first {
        Ok(theirs) if run.code == Some(0) => theirs,
        // What fails only when it is solved, a dry run cannot tell.
        Err(first) if run.code == Some(3) && run.err.lines().last() == first.err.lines().last() => {
            return Ok(false);
        }
        other => return Err(format!("fails differently:\n{dry:?}\n{run:?}\n{other:?}")),
    };
    let ran: BTreeSet<&str> = run.ran().into_iter().collect();
    let [stale, waits] = listed(&dry);
    let may_run: BTreeSet<&str> = stale.union(&waits).copied().collect();
    if !(stale.is_subset(&ran) && ran.is_subset(&may_run)) {
        return Err(format!("ran {ran:?}, listed {stale:?} and {waits:?}"));
    }
    let says_nothing = |said: &Said| said.out.lines().any(|line| line.starts_with("nothing to do"));
    if says_nothing(&dry) != says_nothing(&run) {
        return Err(format!("the dry run: {:?}\nthe run: {:?}", dry.out, run.out));
    }
    let ours = exported(project);
    let names: BTreeSet<_> = ours.keys().chain(theirs.keys()).collect();
    let differ: Vec<_> =
        names.into_iter().filter(|name| ours.get(*name) != theirs.get(*name)).collect();
    if !differ.is_empty() {
        return Err(format!("differ from a run with an empty cache: {differ:?}"));
    }
    Ok(true)
}

/// Edits a study and checks it after each edit; panics with the seed and the last edits.
fn edit_and_check(seed: u64, edits: usize) {
    let mut dice = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let mut states = vec![study()];
    // A book takes most of the time.
    if seed % STUDIES_PER_BOOK == 1 {
        states[0].extend(book());
    }
    let project = project(&states[0]);
    let (mut made, mut known, mut done) = (Vec::new(), Known::new(), 0);
    check(&project, &states[0], &mut known)
        .unwrap_or_else(|why| panic!("seed {seed}, before all edits: {why}"));
    let mut now = states[0].clone();
    while done < edits {
        let mut next = now.clone();
        if dice.below(5) == 0 {
            next = one_of(&mut dice, &states).clone();
            made.push("back to an earlier state".into());
        } else {
            for _ in 0..=dice.below(2) {
                made.push(edit(&mut dice, &mut next));
            }
        }
        write(&project, &now, &next);
        match check(&project, &next, &mut known) {
            Ok(true) => {
                states.push(next.clone());
                done += 1;
                let beside = match dice.below(3) {
                    0 => beside::edit_an_export(&mut dice, &project),
                    1 => beside::compare_options(&mut dice, &project, &next).map(|_| ()),
                    _ => Ok(()),
                };
                beside.unwrap_or_else(|why| panic!("seed {seed}: {why}\n{next:#?}"));
            }
            Ok(false) => {
                // As whoever reads the message would.
                write(&project, &next, &now);
                made.push("undone".into());
                continue;
            }
            Err(why) => {
                let last = made.len().saturating_sub(8);
                panic!("seed {seed}: {why}\nafter {:#?}\n{next:#?}", &made[last..]);
            }
        }
        now = next;
    }
}

/// Number in the environment.
pub(crate) fn number(name: &str, usual: u64) -> u64 {
    let given = std::env::var(name).ok();
    given.map_or(usual, |text| text.parse().unwrap_or_else(|_| panic!("{name} is no number")))
}

#[test]
fn an_option_over_a_study_is_its_key() {
    let (project, files) = (project(&study()), study());
    let mut dice = Dice(number("SIGNORINI_SEED", 1) | 1);
    let rows = (0..30).filter(|_| beside::compare_options(&mut dice, &project, &files).unwrap());
    assert!(rows.count() > 8);
}

#[test]
fn after_every_edit_a_run_makes_what_a_first_run_would() {
    let (edits, seed) = (number("SIGNORINI_EDITS", 200) as usize, number("SIGNORINI_SEED", 1));
    for (study, first) in (0..edits).step_by(EDITS_OF_A_STUDY).enumerate() {
        edit_and_check(seed + study as u64, EDITS_OF_A_STUDY.min(edits - first));
    }
}
