//! The book is built from the committed templates and solves of this run, and then inspected.

use signorini::discrete::grid::nested;
use signorini::discrete::load::{LoadRule, integral, load};
use signorini::discrete::transfer::Prolongation;
use signorini::experiments::accuracy;
use signorini::experiments::claims::{Plan, claims};
use signorini::experiments::cube::{self, cube};
use signorini::experiments::{rounding, stress};
use signorini::identify::record::Record;
use signorini::identify::{Findings, Questions, Variant, findings};
use signorini::pipeline::error::from_toml;
use signorini::pipeline::{Graph, Node, Stage};
use signorini::problem::source::Source;
use signorini::replication::paper::Paper;
use signorini::replication::project::{IDENTIFIED, Project};
use signorini::report::CommandHelp;
use signorini::report::{
    Artifact, Column, Compared, Figure, Figures, Level, Piece, Problem, Provenance, Report,
    ReportError, Row, Scene, Solution, Version, build, pages,
};
use signorini::saddle::{Params, StopReason, StopRule, solve_nested};
use signorini::timing::measure::{self, SOLVERS, measure};
use signorini::timing::recorded::{Peer, Timings};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

const CELLS: [usize; 5] = [4, 8, 16, 32, 64];
const R: [f64; 5] = [1e6, 10.0, 5.0, 1.0, 0.5];
/// Iterations after which a test gives up: (13) as printed needs more for some f.
const CAP: usize = 3000;
const FIGURES: [&str; 5] = ["figure1", "figure2", "histories", "contact", "identifiability"];

#[test]
fn the_book_opens_from_a_folder_without_any_request() {
    let files = book_files(&sample(|ours, off| ours + off));
    let book = build(&files, &scratch("offline")).unwrap();
    let shown = Path::new(env!("CARGO_TARGET_TMPDIR")).join("book");
    for (name, bytes) in &book {
        let path = shown.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    assert!(!scratch("offline").exists());

    let html = html(&book);
    assert!(html.len() >= 11, "{:?}", html.keys());
    for (name, text) in &html {
        for tag in tags(text) {
            let Some(target) = attribute(tag, "src").or(attribute(tag, "href")) else {
                continue;
            };
            let outside = target.contains("://") || target.starts_with("//");
            if !tag.starts_with("a ") {
                assert!(!outside, "{name} loads {target}");
            }
            if !outside && !target.starts_with("mailto:") {
                assert_resolves(&book, name, target);
            }
        }
    }
    let css = book.iter().filter(|(name, _)| name.ends_with(".css"));
    for (name, bytes) in css {
        let text = String::from_utf8_lossy(bytes);
        for url in text.split("url(").skip(1) {
            let url = url.split(')').next().unwrap().trim_matches(['"', '\'']);
            assert!(url.starts_with("data:") || !url.contains("//"), "{name} loads {url}");
            if !url.starts_with("data:") {
                assert_resolves(&book, name, url);
            }
        }
    }
    assert!(book.keys().any(|name| name.starts_with("searchindex")));
}

#[test]
fn every_formula_is_set_and_every_figure_is_there() {
    let files = book_files(&sample(|ours, _| ours));
    let book = build(&files, &scratch("formulas")).unwrap();
    let print = String::from_utf8_lossy(&book["print.html"]).into_owned();
    for n in 1..=13 {
        assert!(print.contains(&format!(r#"id="eq-{n}""#)), "equation ({n})");
    }
    assert!(print.matches("<math").count() > 200);
    assert!(!print.contains("merror"));
    for figure in FIGURES.into_iter().chain(bench_figures()) {
        assert!(print.contains(&format!(r#"src="figures/{figure}.svg""#)));
        assert!(book.contains_key(&format!("figures/{figure}.svg")));
    }
    let prose = print.split("<main>").nth(1).unwrap().split("</main>").next().unwrap();
    for left in ["$", "{{", "{%", "eq:", "\\("] {
        assert!(!prose.contains(left), "`{left}` was left in the text");
    }
}

#[test]
fn twice_gives_the_same_bytes() {
    let files = book_files(&sample(|ours, off| ours + off));
    let once = build(&files, &scratch("once")).unwrap();
    let twice = build(&files, &scratch("twice")).unwrap();
    assert_eq!(once.keys().collect::<Vec<_>>(), twice.keys().collect::<Vec<_>>());
    for (name, bytes) in &once {
        assert!(*bytes == twice[name], "{name} differs");
    }
}

#[test]
fn the_prose_follows_the_counts() {
    let exact = pages(&templates(), &sample(|ours, _| ours)).unwrap();
    let some = pages(&templates(), &sample(|ours, off| ours + off)).unwrap();
    let far = pages(&templates(), &sample(|ours, off| ours + 40 * off)).unwrap();
    let intro = |pages: &BTreeMap<String, String>| pages["src/introduction.md"].clone();
    assert!(intro(&exact).contains("All 50 published iteration counts"));
    assert!(intro(&some).contains("40 of the 50 published iteration counts"));
    assert!(intro(&some).contains("all the others within the declared tolerance"));
    assert!(!intro(&far).contains("all the others within"));
    let tables = |pages: &BTreeMap<String, String>| pages["src/tables.md"].clone();
    assert!(tables(&exact).contains("No count hangs on [rounding]"));
    // The ten values of Delta a are near in each sample.
    assert_eq!(tables(&exact).matches("class=\"near\"").count(), 10);
    assert_eq!(tables(&some).matches("class=\"near\"").count(), 20);
    assert_eq!(tables(&far).matches("class=\"far\"").count(), 10);
}

#[test]
fn fragile_counts_are_marked() {
    let mut data = sample(|ours, _| ours);
    let found = data.bench.get_mut("rounding").unwrap();
    found["fragile"] = 1.into();
    found["tables"][1]["rows"][2]["cells"][4]["flips"] = 3.into();
    let pages = pages(&templates(), &data).unwrap();
    assert_eq!(pages["src/tables.md"].matches("<sup>†</sup>").count(), 1);
    assert!(pages["src/tables.md"].contains("The mark † is for a count"));
    assert!(pages["src/stability.md"].contains("One of the 50 counts is fragile"));
}

#[test]
fn the_chapter_on_the_search_tells_what_was_found() {
    let mut data = sample(|ours, _| ours);
    let page =
        |data: &Report| pages(&templates(), data).unwrap().remove("src/identification.md").unwrap();
    let text = page(&data);
    // The committed alternatives are scored by the run, not quoted.
    assert!(text.contains("In problem 1, four of these give every count."), "{text}");
    assert!(text.contains("In problem 2, five of these give every count."));
    assert!(text.contains("In problem 2, $r = 0.5$, the paper prints $4.2 \\cdot 10^{-2}$"));
    assert!(text.contains("In problem 1, every $f$ with all counts has a positive sum"));
    assert!(text.contains("and 0 counts of Table 2"), "the printed rule with its own f");
    assert!(text.contains("`quadrant(ll)=2.99; else=-1` | 25 of 25"));
    for problem in &mut data.problems {
        problem.findings.alternatives.truncate(1);
        problem.findings.search.found.clear();
    }
    data.record.selection.variant.clear();
    let text = page(&data);
    assert!(text.contains("In problem 1, one of these give"), "{text}");
    assert!(!text.contains("The printed stopping rule had its chance"));
}

#[test]
fn the_chapter_on_cost_stands_with_and_without_recorded_times() {
    let mut data = sample(|ours, _| ours);
    let page = |data: &Report| pages(&templates(), data).unwrap().remove("src/cost.md").unwrap();
    let text = page(&data);
    for shown in ["| Optimal orders", "## The law", "### Where each", "| PETSc | `else=-1`"] {
        assert!(text.contains(shown), "{shown}: {text}");
    }
    data.timings = None;
    data.figures.bench.retain(|name, _| !["cost", "race"].contains(&&name[..]));
    let text = page(&data);
    assert!(text.contains("`signorini bench --record` measures all solvers"), "{text}");
    assert!(!text.contains("What the clock says") && !text.contains("ns per unknown"), "{text}");
}

#[test]
fn the_prose_stands_whatever_the_data_are() {
    let mut data = sample(|ours, _| ours + 1000);
    data.scenes.clear();
    for problem in &mut data.problems {
        std::mem::swap(&mut problem.signed, &mut problem.printed);
        problem.f = "disc(0,0,0.2)=1; else=-1".into();
        problem.load = "exact".into();
        problem.integral_f = f64::NAN;
        for column in &mut problem.signed_dual {
            column.outcomes[4].stop = StopReason::Diverged;
            column.outcomes[4].energy = f64::NAN;
        }
    }
    let pages = pages(&templates(), &data).unwrap();
    assert!(pages["src/introduction.md"].contains("0 of the 50 published iteration counts"));
    assert!(!pages["src/introduction.md"].contains("each quarter"));
    assert!(pages["src/stopping.md"].contains("diverged"));
    assert!(!pages["src/solutions.md"].contains("## Other scenes"));
    build(&with_theme(pages), &scratch("odd")).unwrap();
}

#[test]
fn a_load_without_solution_is_called_so() {
    let mut data = sample(|ours, _| ours);
    for (problem, sum) in data.problems.iter_mut().zip([0.07, -0.01]) {
        problem.integral_f = 0.04;
        for outcome in problem.signed.iter_mut().flat_map(|c| &mut c.outcomes) {
            outcome.sum_load = sum;
        }
        for outcome in problem.printed.iter_mut().flat_map(|c| &mut c.outcomes) {
            outcome.stop = StopReason::IterationLimit;
        }
    }
    let pages = pages(&templates(), &data).unwrap();
    let once = |page: &str, text: &str| {
        assert_eq!(pages[page].matches(text).count(), 1, "{page}: {text}");
    };
    once("src/figure1.md", "no saddle point exists");
    once("src/figure1.md", "the problem they approximate has none");
    once("src/stopping.md", "and cannot be:");
    once(
        "src/verdict.md",
        "A loose end in problem 1.** The values of $f$ that fit the table best leave",
    );
    once(
        "src/verdict.md",
        "A loose end in problem 2.** The values of $f$ that fit the table best have no",
    );
}

#[test]
fn what_the_data_lack_is_an_error_that_says_where() {
    let data = sample(|ours, _| ours);
    let broken = BTreeMap::from([("a.md.tera".to_string(), "one\n{{ nothing }}\n".to_string())]);
    let error = pages(&broken, &data).unwrap_err();
    assert!(
        matches!(&error, ReportError::Template { file, line: 2, .. } if file == "a.md.tera"),
        "{error}"
    );
    let broken = BTreeMap::from([("b.md.tera".to_string(), "\n\n{% if %}\n".to_string())]);
    let error = pages(&broken, &data).unwrap_err();
    assert!(
        matches!(&error, ReportError::Template { file, line: 3, .. } if file == "b.md.tera"),
        "{error}"
    );
}

#[test]
fn an_error_in_a_component_names_the_page_too() {
    let templates = BTreeMap::from([
        (
            "parts.tera".to_string(),
            "{% component c(x) %}\n{{ x.y }}\n{% endcomponent c %}".to_string(),
        ),
        ("page.md.tera".to_string(), "{{ <c x={1} /> }}".to_string()),
    ]);
    let error = pages(&templates, &sample(|ours, _| ours)).unwrap_err().to_string();
    assert!(error.starts_with("report/templates/parts.tera:2: "), "{error}");
    assert!(error.contains("page.md.tera"), "{error}");
}

/// A report of real solves; `published(ours, off)` invents the paper's count, `off` being 1 in ten cells.
fn sample(published: impl Fn(usize, usize) -> usize) -> Report {
    let problem = |number: usize, f: &str| {
        let source: Source = f.parse().unwrap();
        let Source::Pieces { pieces, .. } = &source else { panic!() };
        let signed = columns(&source, StopRule::Signed);
        let table = signed
            .iter()
            .enumerate()
            .map(|(k, column)| Row {
                r: column.r,
                counts: column
                    .outcomes
                    .iter()
                    .enumerate()
                    .map(|(n, outcome)| {
                        let ours = outcome.iterations;
                        let paper = published(ours, usize::from(n == k));
                        Compared {
                            ours,
                            paper,
                            exact: ours == paper,
                            within: ours.abs_diff(paper) <= 3,
                        }
                    })
                    .collect(),
                delta_a: Compared {
                    ours: column.outcomes[4].delta_a,
                    paper: column.outcomes[4].delta_a * 1.1,
                    exact: false,
                    within: true,
                },
            })
            .collect();
        Problem {
            number,
            title: format!("problem {number}"),
            f: source.to_string(),
            integral_f: integral(&source),
            pieces: pieces
                .iter()
                .map(|(region, value)| Piece { region: region.to_string(), value: *value })
                .collect(),
            load: "nodal".into(),
            tie: "lower-left".into(),
            diagonal: "rising".into(),
            prolongation: "bilinear".into(),
            printed: columns(&source, StopRule::Printed),
            signed_dual: columns(&source, StopRule::SignedDual),
            signed,
            table,
            findings: found(number, &source),
            solution: Solution {
                cells: 64,
                r: 1.0,
                least: -0.1,
                greatest: 0.2,
                contact_nodes: 100,
                boundary_nodes: 256,
            },
        }
    };
    let torsion: Source = "else=-1".parse().unwrap();
    let scene = Scene {
        name: "contact".into(),
        title: "the whole boundary in contact".into(),
        text: "# a scene\ntitle = \"contact\"\n".into(),
        figures: BTreeMap::new(),
        f: torsion.to_string(),
        integral_f: -1.0,
        exact: Some(r"v = -\cos \pi x \cos \pi y".into()),
        rule: "printed-dual".into(),
        r: 1.0,
        levels: columns(&torsion, StopRule::PrintedDual)[3]
            .outcomes
            .iter()
            .map(|&outcome| Level { outcome, error: Some(1e-3) })
            .collect(),
    };
    let hash = "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262".to_string();
    let figure = |name: &str| Figure {
        file: format!("{name}.svg"),
        note: String::new(),
        command: "signorini run --only figures".into(),
        hash: hash.clone(),
    };
    let artifact = |name: &str| Artifact { name: name.into(), hash: hash.clone() };
    Report {
        grids: CELLS.into(),
        r: R.into(),
        tolerance: "a count differs by at most 3".into(),
        problems: vec![
            problem(
                1,
                "quadrant(ll)=3.02; quadrant(lr)=-1; quadrant(ul)=-1.05; quadrant(ur)=-1.05",
            ),
            problem(2, "quadrant(ll)=-6.8; quadrant(lr)=2.2; quadrant(ul)=3.1; quadrant(ur)=1.4"),
        ],
        scenes: vec![Scene { exact: None, ..scene.clone() }, scene],
        figures: Figures {
            figure1: figure("figure1"),
            figure2: figure("figure2"),
            contact: figure("contact"),
            histories: figure("histories"),
            identifiability: figure("identifiability"),
            bench: bench_figures().map(|name| (name.into(), figure(name))).collect(),
        },
        bench: experiments().clone(),
        record: record(),
        commands: vec![CommandHelp {
            name: "run".into(),
            help:
                "Runs it.\n\nUsage: signorini run [SCENE]...\n\n  --f <F>  e.g. 'rect(0,1,0,1)=1'\n"
                    .into(),
        }],
        timings: Some(timings()),
        provenance: Provenance {
            command: "signorini run".into(),
            inputs: vec![
                artifact("pipeline/scenes/problem1.toml"),
                artifact("pipeline/paper.toml"),
            ],
            artifacts: vec![artifact("figures/figure1.svg")],
            versions: vec![Version { name: "signorini".into(), version: "0.1.0".into() }],
            graph: Graph::new(vec![
                node("solve/problem1/signed/r=1", Stage::Solve, &[]),
                node("report/book", Stage::Report, &["solve/problem1/signed/r=1"]),
            ]),
            license: "MIT OR Apache-2.0".into(),
        },
    }
}

fn node(id: &str, stage: Stage, needs: &[&str]) -> Node {
    Node { id: id.into(), stage, needs: needs.iter().map(|need| (*need).into()).collect() }
}

/// What the experiments find, with smaller plans.
fn experiments() -> &'static BTreeMap<String, serde_json::Value> {
    static ONCE: OnceLock<BTreeMap<String, serde_json::Value>> = OnceLock::new();
    ONCE.get_or_init(|| {
        let tables: Vec<_> = ["quadrant(ll)=3; else=-1.002", "quadrant(ll)=-6; else=1.998"]
            .iter()
            .zip(1..)
            .map(|(f, number)| rounding::TablePlan {
                number,
                f: (*f).into(),
                load: LoadRule::default(),
                prolongation: Prolongation::Bilinear,
                grids: CELLS.into(),
                r: R.into(),
            })
            .collect();
        let few = stress::Plan { cap: CAP, ..stress::Plan::new(tables.clone()) };
        let some = rounding::Plan { repetitions: 4, further: 1, ..rounding::Plan::new(tables) };
        let project = Project::read(Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()).unwrap();
        let targets = vec![(1e-2, 16), (1e-3, 16)];
        let coarse = Plan { per_decade: 1, targets, cap: 2000, ..Plan::of(&project.scenes) };
        let accurate = accuracy::Plan {
            cells: vec![8, 16, 32],
            others: vec![16],
            laws: vec![("exact(free-corner)".into(), vec![4, 8, 16])],
            race: vec![8, 16],
        };
        let accurate = accuracy::accuracy(&accurate).unwrap();
        BTreeMap::from([
            ("accuracy".into(), serde_json::to_value(accurate).unwrap()),
            ("claims".into(), serde_json::to_value(claims(&coarse).unwrap()).unwrap()),
            (
                "cube".into(),
                serde_json::to_value(cube(&cube::Plan { cells: vec![4, 8] }).unwrap()).unwrap(),
            ),
            ("stress".into(), serde_json::to_value(stress::stress(&few).unwrap()).unwrap()),
            ("rounding".into(), serde_json::to_value(rounding::rounding(&some).unwrap()).unwrap()),
        ])
    })
}

/// Names of the pictures of experiments and of recorded times.
fn bench_figures() -> impl Iterator<Item = &'static str> {
    let experiments =
        signorini::replication::stages::bench::PICTURES.iter().map(|picture| picture.name);
    experiments.chain(signorini::replication::stages::timings::names())
}

/// Times as `signorini bench` measures them, of the kind that one cannot rely on.
fn timings() -> Timings {
    let plan = measure::Plan { repeats: 1, quick: true, solvers: SOLVERS.into(), finest: 512 };
    static ONCE: OnceLock<Timings> = OnceLock::new();
    let measured = || {
        let mut timings = measure(&plan, |_| ()).unwrap();
        timings.peer.push(Peer {
            solver: "PETSc".into(),
            f: "else=-1".into(),
            cells: 64,
            theirs: 3.0,
            their_kkt: 1e-9,
            ours: 0.1,
            our_kkt: 1e-12,
            warm: true,
        });
        timings
    };
    ONCE.get_or_init(measured).clone()
}

/// The committed record.
fn record() -> Record {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(IDENTIFIED);
    from_toml(IDENTIFIED, &fs::read_to_string(path).unwrap()).unwrap()
}

/// What the stage `identify` finds about a published table, for a smaller search and map.
fn found(number: usize, f: &Source) -> Findings {
    static ONCE: [OnceLock<Findings>; 2] = [OnceLock::new(), OnceLock::new()];
    let find = || {
        let paper = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipeline/paper.toml");
        let paper = Paper::parse(&fs::read_to_string(paper).unwrap()).unwrap();
        let target = paper.target(number as u8).unwrap();
        let record = record();
        let values = "-6,-5.98,-1,1.99,2,2.99,3".into();
        let questions = Questions { values, points: 3, ..record.questions.clone() };
        let alternatives = record.alternatives(number as u8);
        findings(&target, &Variant::default(), f, alternatives, &questions, 2).unwrap()
    };
    ONCE[number - 1].get_or_init(find).clone()
}

fn columns(source: &Source, rule: StopRule) -> Vec<Column> {
    let grids = nested(&CELLS).unwrap();
    let loads: Vec<_> = grids.iter().map(|&g| load(g, source, LoadRule::default())).collect();
    R.iter()
        .map(|&r| {
            let params = Params { r, rule, max_iterations: CAP, ..Params::default() };
            let (outcomes, _) =
                solve_nested(&grids, &loads, &params, Prolongation::Bilinear, &mut ());
            Column { r, outcomes }
        })
        .collect()
}

fn templates() -> BTreeMap<String, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("report/templates");
    fs::read_dir(folder)
        .unwrap()
        .map(|entry| {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_string();
            (name, fs::read_to_string(path).unwrap())
        })
        .collect()
}

fn book_files(data: &Report) -> BTreeMap<String, Vec<u8>> {
    with_theme(pages(&templates(), data).unwrap())
}

/// What the report stage hands to `build`: pages, configuration, theme, figures.
fn with_theme(pages: BTreeMap<String, String>) -> BTreeMap<String, Vec<u8>> {
    let report = Path::new(env!("CARGO_MANIFEST_DIR")).join("report");
    let mut files: BTreeMap<_, _> =
        pages.into_iter().map(|(name, page)| (name, page.into_bytes())).collect();
    for name in [
        "book.toml",
        "theme/book.css",
        "theme/fonts/latinmodern-math.woff2",
        "theme/fonts/LICENSE-latinmodern-math.txt",
    ] {
        files.insert(name.into(), fs::read(report.join(name)).unwrap());
    }
    for name in FIGURES.into_iter().chain(bench_figures()) {
        files.insert(format!("src/figures/{name}.svg"), placeholder(name).into_bytes());
    }
    files
}

fn placeholder(name: &str) -> String {
    format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 800 360" width="800" height="360"><rect width="800" height="360" fill="#fff"/><path d="M40 320 L400 60 L760 320 Z" fill="#cfe3f5" stroke="#1f6fb2"/><text x="400" y="230" text-anchor="middle" font-size="28">{name}</text></svg>"##
    )
}

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("scratch-{name}"))
}

fn html(book: &BTreeMap<String, Vec<u8>>) -> BTreeMap<&str, String> {
    book.iter()
        .filter(|(name, _)| name.ends_with(".html"))
        .map(|(name, bytes)| (name.as_str(), String::from_utf8(bytes.clone()).unwrap()))
        .collect()
}

/// The insides of the tags of an HTML text.
fn tags(text: &str) -> impl Iterator<Item = &str> {
    text.split('<').skip(1).filter_map(|rest| rest.split('>').next())
}

fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    tag.split(&format!(r#" {name}=""#)).nth(1)?.split('"').next()
}

/// That the file, and the element in it, which `target` names in page `from` exist.
fn assert_resolves(book: &BTreeMap<String, Vec<u8>>, from: &str, target: &str) {
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let mut steps: Vec<&str> = from.split('/').collect();
    if !path.is_empty() {
        steps.pop();
        for step in path.split('/') {
            match step {
                "." => {}
                ".." => assert!(steps.pop().is_some(), "{from} leaves the book to {target}"),
                step => steps.push(step),
            }
        }
    }
    let file = steps.join("/");
    let bytes =
        book.get(&file).unwrap_or_else(|| panic!("{from} links to {target}, which is not there"));
    if !anchor.is_empty() {
        let id = format!(r#"id="{anchor}""#);
        assert!(
            String::from_utf8_lossy(bytes).contains(&id),
            "{from} links to {target}: no such place"
        );
    }
}
