//! Studies: members as single solves, tables, charts, interrupts and refusals; and what calls the program from Python.

use crate::common::{Project, Said, TABLE, interrupt, send, skip, wait_for_handler};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Output, Stdio};

const F: &str = "halfplane(1,0,0)=8; else=-9";
const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Project with the study `s`, of this f and these lines.
fn with(f: &str, lines: &str) -> Project {
    let project = Project::with(TABLE);
    project.scene("s", &format!("title = \"t\"\nf = \"{f}\"\n{lines}\n"));
    project
}

/// Study of four members, one of which has no solution.
fn four() -> Project {
    let lines = "vary = { friction = [0.1, 1], h = [\"1/8\", 16] }\noutputs = [\"table\", \"chart\"]\n\
        chart = { x = \"friction\", y = \"force\", log = [\"x\"] }";
    with(F, lines)
}

/// Rows of the table of a study in CSV, each with its cells by column.
fn rows(project: &Project, file: &str) -> Vec<Value> {
    let text = fs::read_to_string(project.path(file)).unwrap();
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let cells = lines.map(|line| line.splitn(head.len(), ','));
    let rows =
        cells.map(|cells| head.iter().zip(cells).map(|(name, cell)| (*name, cell)).collect());
    rows.collect()
}

#[test]
fn members_are_single_solves_to_the_last_bit() {
    let project = four();
    let said = project.run(&["run", "s"]);
    assert!(
        said.err.contains("s: no-solution with ")
            && said.err.contains("; report/tables/s.csv says why"),
        "{said:?}"
    );
    assert_eq!(said.code, Some(0), "{said:?}");
    let files = "wrote figures/s-chart.csv, .svg, report/tables/s.csv, .md, .tex\n";
    assert!(said.out.ends_with(files), "{said:?}");
    let mut solved = 0;
    for row in rows(&project, "report/tables/s.csv") {
        let [g, h] = ["friction", "h"].map(|name| row[name].as_str().unwrap());
        let single = project.run(&["solve", "--f", F, "--friction", g, "--h", h, "--json"]);
        if single.code != Some(0) {
            assert!(!row["reason"].as_str().unwrap().is_empty() && row["energy"] == "", "{row}");
            continue;
        }
        solved += 1;
        let single = single.json();
        let bound = &single["bound"];
        for (column, value) in [
            ("energy", &single["energy"]),
            ("energy_lower", &bound["energy"][0]),
            ("energy_upper", &bound["energy"][1]),
            ("error_relative", &bound["relative"]["error"]),
            ("v_least", &single["v_least"]),
            ("v_greatest", &single["v_greatest"]),
            ("force", &single["force"]),
            ("nodes", &single["unknowns"]),
            ("iterations", &single["iterations"]),
        ] {
            assert_eq!(row[column], value.to_string(), "{column} of {row}");
        }
        assert_eq!(row["solver"], single["solver"]);
    }
    assert_eq!(solved, 2);
    let chart = fs::read_to_string(project.path("figures/s-chart.csv")).unwrap();
    assert_eq!(chart.lines().count(), 1 + solved, "{chart}");
}

#[test]
fn options_scenes_and_saved_scenes_are_one_study() {
    let project = four();
    let options = ["--vary", "friction=0.1,1", "--vary", "h=1/8,16"];
    let mut saves = vec!["solve", "--f", F, "--save", "saved", "--csv", "by-options.csv"];
    saves.extend(options);
    project.run(&saves).lines();
    project.run(&["run", "-k", "s", "saved"]).lines();
    project.run(&["solve", "saved", "--csv", "of-scene.csv"]).lines();
    let read = |path: &str| fs::read_to_string(project.path(path)).unwrap();
    for path in ["report/tables/s.csv", "report/tables/saved.csv", "of-scene.csv"] {
        assert_eq!(read(path), read("by-options.csv"), "{path}");
    }
    let json = project.run(&[&["solve", "--f", F, "--json"][..], &options].concat());
    let lines: Vec<Value> = json.lines().iter().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!(lines.len(), 4);
    assert_eq!(lines[2]["friction"], 1);
    assert_eq!(lines[2]["h"], 0.125);
    assert_eq!(
        lines[2]["energy"].to_string(),
        rows(&project, "of-scene.csv")[2]["energy"].as_str().unwrap()
    );
    let text = project.run(&[&["solve", "--f", F][..], &options].concat());
    assert!(text.lines().iter().all(|line| line.len() <= 80), "{text:?}");
}

/// Study of so many members.
fn of(members: usize) -> Project {
    let values: Vec<_> = (1..=members).map(|k| format!("{}", 1.0 + k as f64 / 1000.0)).collect();
    let values = values.join(", ");
    with(F, &format!("h = \"1/4\"\nvary = {{ friction = [{values}] }}\noutputs = [\"table\"]"))
}

#[test]
fn a_thousand_members_are_solved_once() {
    let project = of(1000);
    let said = project.run(&["run", "s"]);
    assert!(said.lines().iter().any(|line| line.starts_with("solve     1000 of 1000")), "{said:?}");
    project.run(&["run", "s"]).nothing_to_do();
    assert_eq!(rows(&project, "report/tables/s.csv").len(), 1000);
}

#[test]
fn killed_and_interrupted_studies_go_on_where_they_were() {
    let whole = of(200);
    whole.run(&["run", "s"]).lines();
    let table = fs::read(whole.path("report/tables/s.csv")).unwrap();
    for signal in ["KILL", "INT"] {
        let project = of(200);
        let mut command = project.command(&["run", "-v", "-j", "1", "s"]);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        wait_for_handler(&child);
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let ran =
            lines.by_ref().filter(|l| l.as_ref().is_ok_and(|l| l.starts_with("ran "))).take(20);
        assert_eq!(ran.count(), 20);
        if signal == "INT" {
            interrupt(&child);
        } else {
            send(signal, &child);
        }
        let before = 20 + lines.filter(|l| l.as_ref().is_ok_and(|l| l.starts_with("ran "))).count();
        child.wait().unwrap();
        let after = project.run(&["run", "-v", "s"]).ran().len();
        // The member at work when a run is killed may be solved again.
        assert!((200..=202).contains(&(before + after)) && after < 185, "{before} + {after}");
        assert_eq!(fs::read(project.path("report/tables/s.csv")).unwrap(), table, "{signal}");
    }
}

/// Rows of a study, of this project or of options.
fn rows_of_own(study: &[&str]) -> Vec<Value> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_signorini"));
    command.args(["solve", "--json"]).args(study).current_dir(ROOT);
    let said = Said::from(command.output().unwrap());
    said.lines().iter().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn errors_on_the_cube_fall_at_the_optimal_rate() {
    let f = "f=exact(full-contact)|exact(free-strip)|exact(free-disc)";
    let rows = rows_of_own(&["--domain", "cube", "--vary", f, "--vary", "h=16,32"]);
    assert_eq!(rows.len(), 6);
    for meshes in rows.chunks(2) {
        for (column, order, reach) in
            [("error_l2", 2.0, 0.1), ("error_h1", 1.0, 0.05), ("error_max", 2.0, 0.2)]
        {
            let [coarse, fine] = [0, 1].map(|k| meshes[k][column].as_f64().unwrap());
            let found = (coarse / fine).log2();
            assert!((found - order).abs() < reach, "{column} {found}: {}", meshes[1]);
        }
    }
}

#[test]
fn arcs_that_stick_shrink_exponentially_as_friction_gets_weaker() {
    let rows = rows_of_own(&["arcs"]);
    let number = |row: &Value, name: &str| row[name].as_f64().unwrap();
    // Two arcs of equal length.
    let lengths: Vec<f64> = rows.iter().map(|row| number(row, "contact_length") / 2.0).collect();
    assert!(lengths.len() == 7 && lengths[0] > 1e-2 && lengths[6] < 1e-4, "{lengths:?}");
    for pair in rows.windows(2) {
        let [one, next] = [&pair[0], &pair[1]];
        let fall = number(one, "contact_length") / number(next, "contact_length");
        let rate = fall.ln() / (1.0 / number(next, "friction") - 1.0 / number(one, "friction"));
        assert!((5.5..7.5).contains(&rate), "{rate}: {one} {next}");
    }
}

#[test]
fn pictures_for_print_have_a_width_and_no_title() {
    let project = with(
        F,
        "law = { friction = 1 }\noutputs = [\"map\"]\npicture = { width = \"85mm\", title = false }",
    );
    project.run(&["run", "s"]).lines();
    let map = fs::read_to_string(project.path("figures/s-map.svg")).unwrap();
    assert!(
        map.contains(" width=\"85mm\" height=\"") && map.contains("<title>Map of v: t</title>"),
        "{map}"
    );
    let args = ["solve", "s", "--map", "--no-title", "--width", "85mm", "--out", "v.svg"];
    project.run(&args).lines();
    let drawn = |path: &str| {
        let text = fs::read_to_string(project.path(path)).unwrap();
        text.lines()
            .filter(|l| !l.starts_with("<title>") && !l.starts_with("<desc>"))
            .collect::<Vec<_>>()
            .join("\n")
    };
    assert_eq!(drawn("v.svg"), drawn("figures/s-map.svg"));
    let said = project.run(&["solve", "s", "--width", "5 ells", "--out", "v.svg"]);
    assert!(said.code == Some(2) && said.err.contains("such as 85mm"), "{said:?}");
    let said = project.run(&["solve", "s", "--no-title", "--out", "v.npz"]);
    assert!(said.refusal().contains("--no-title is for a picture"), "{said:?}");
}

/// Runs Python with the module of this project and the program that the tests built; none without NumPy.
pub(crate) fn python(args: &[&str]) -> Option<Output> {
    let run = |args: &[&str]| {
        let mut command = Command::new("python3");
        command.args(args).current_dir(ROOT).env("PYTHONDONTWRITEBYTECODE", "1");
        command.env("PYTHONPATH", "src/python").env("SIGNORINI", env!("CARGO_BIN_EXE_signorini"));
        command.output()
    };
    if !run(&["-c", "import numpy"]).is_ok_and(|found| found.status.success()) {
        skip("no python3 with numpy");
        return None;
    }
    Some(run(args).unwrap())
}

#[test]
fn the_notebook_has_the_outputs_that_it_keeps() {
    let Some(output) = python(&["tests/notebook.py", "src/python/signorini.ipynb"]) else { return };
    let said = Said::from(output);
    assert_eq!(said.lines(), ["5 cells"]);
}

#[test]
fn python_varies_values_of_any_kind() {
    let program = "import signorini\n\
        f = 'disc(0,0,$R)=4; else=-1'\n\
        print(signorini.study({'R': 0.1, 'h': [8, '1/16']}, f=f)['h'])\n\
        print(signorini.study({'grids': ['4,8']}, f='else=-1')['grids'])\n\
        print(signorini.study({'solver': 'multigrid'}, f='else=-1', h=8)['solver'])\n\
        print(signorini.study({'f': ['else=-1', 'formula(min(x,y) - 1)']}, h=8)['f'])\n\
        print(signorini.study({'fixed': [['inner', 'outer'], []]}, f='else=-1', domain='annulus', refine=0)['fixed'])\n\
        a = signorini.study({'a': [-2, 3]}, f='formula($a^2 - 6)', h=8)\n\
        print(a['a'], a['energy'][0] == signorini.solve(f='formula(4 - 6)', h=8).energy)\n\
        for vary in [{}, {'R': ['a|b']}, {'R': [None]}]:\n\
        \x20   try: signorini.study(vary, f=f)\n\
        \x20   except signorini.Refused as e: print(e)\n";
    let Some(output) = python(&["-c", program]) else { return };
    let said = Said::from(output);
    let want = [
        "[0.125  0.0625]",
        "['4,8']",
        "['multigrid']",
        "['else=-1' 'formula(min(x, y) - 1)']",
        "['inner,outer' '']",
        "[-2  3] True",
        "nothing is varied; give the values of an option, as in study({\"friction\": [0.2, 0.4]}, f=F)",
        "R: a value with | cannot be varied; solve it alone",
        "--vary R=None: a name in f is a number, such as 0.25 or 1/4; what is no number varies as a field, as f does",
    ];
    assert_eq!(said.lines(), want);
}

#[test]
fn python_raises_the_line_of_the_program() {
    let program = "import signorini\n\
        try: signorini.solve(f='else=1')\n\
        except signorini.Refused as e: print(e)\n\
        square = signorini.solve(f='rect(-0.5,0.5,-0.5,0)=-3; else=1', h='1/8')\n\
        middles = square.points[square.cells].mean(axis=1)\n\
        print(((middles[:, 1] < 0) == (square.f == -3)).all(), square.v.shape, square.multiplier.shape)\n\
        at = signorini.solve(f='else=-1', h=8, at=[(0, 0), (9, 9)])\n\
        print(at, [value['v'] for value in at.values])\n\
        none = signorini.study({'friction': [0.01]}, f='else=-1')\n\
        print(none['energy'], none['reason'][0][:15])\n";
    let Some(output) = python(&["-c", program]) else { return };
    let said = Said::from(output);
    let want = [
        "the integral of f is 1.000, but the flux through the boundary can only balance a negative one; lower f somewhere",
        "True (81,) (81,)",
        "<solution, else=-1, energy -0.01671152, 81 nodes> [-0.0727826286764706, None]",
        "[nan] the integral of",
    ];
    assert_eq!(said.lines(), want);
}
