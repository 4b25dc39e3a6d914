//! Statements said in two voices: a command saved as a scene gives, when it is run, the numbers of `solve` to the last
//! bit; a scene's command gives those of the scene.
//!
//! `SIGNORINI_SEED` is the seed, which a failure prints.

use crate::common::{Dice, Project};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

/// Domain, with the options that name it; where it is a mesh, with some that are about one.
const DOMAINS: [&[&str]; 7] = [
    &[],
    &["--domain", "cube"],
    &["--domain", "disc"],
    &["--domain", "lshape"],
    &["--domain", "annulus", "--free", "inner"],
    &["--domain", "ball"],
    &["--domain", "pipeline/meshes/gear.msh", "--free", "hole", "--curve", "hole=0,0,0.3"],
];

/// Laws.
const LAWS: [&[&str]; 3] = [&[], &["--friction"], &["--limit"]];

/// Solvers that are on all domains, then the one that is in the plane.
const SOLVERS: [&str; 6] =
    ["multigrid", "active-set", "arrow-hurwicz", "uzawa", "uzawa-proximal", "spectral"];

/// A project with a mesh and a scene.
fn project() -> Project {
    let project = Project::with("title = 't'\nf = 'else=-1'\ngrids = [4]\noutputs = ['table']\n");
    fs::create_dir(project.path("pipeline/meshes")).unwrap();
    let gear = format!("{}/tests/meshes/gear.msh", env!("CARGO_MANIFEST_DIR"));
    fs::copy(gear, project.path("pipeline/meshes/gear.msh")).unwrap();
    project.add_book("# Statements\n");
    project
}

/// Options of a random problem on a domain under a law, with a solver.
fn command(dice: &mut Dice, domain: &[&str], law: &[&str], solver: &str) -> Vec<String> {
    let owned = |words: &[&str]| -> Vec<String> { words.iter().map(|&word| word.into()).collect() };
    let (is_square, is_nested) =
        (domain.is_empty(), solver.starts_with(['u', 'w']) || solver == "arrow-hurwicz");
    let f = match dice.below(3) {
        0 => format!("else={}", -dice.between(0.5, 1.0)),
        _ if solver == "spectral" || domain.contains(&"ball") || domain.contains(&"cube") => {
            "else=-0.75".into()
        }
        1 => format!("disc(0.1,0.1,{})=2; else=-1", dice.between(0.1, 0.2)),
        _ => "formula(0.5*x - 0.75)".into(),
    };
    let mut words = owned(&["--f", &f]);
    words.extend(owned(domain));
    if let [law] = law {
        words.extend([(*law).to_owned(), dice.between(1.0, 2.0).to_string()]);
    }
    let in_plane = !domain.contains(&"ball") && !domain.contains(&"cube");
    let fine: &[&[&str]] = match (is_square, solver) {
        (true, "spectral") => &[&[]],
        (true, "multigrid") => &[
            &["--h", "1/16"],
            &["--grids", "4,8"],
            &["--accuracy", "0.3"],
            &["--tolerance", "1e-6", "--h", "8"],
        ],
        (true, _) => &[&["--h", "1/8"], &["--grids", "4,8"], &["--grids", "3,6,12"]],
        (false, "multigrid") if in_plane => &[
            &["--refine", "1"],
            &["--accuracy-energy", "0.3"],
            &["--refine", "0", "--tolerance", "1e-6"],
        ],
        (false, _) if domain.contains(&"cube") => &[&["--h", "1/6"], &["--refine", "1"]],
        (false, _) => &[&["--refine", "1"], &["--refine", "0"]],
    };
    words.extend(owned(fine[dice.below(fine.len() as u64) as usize]));
    words.extend(owned(&["--solver", solver]));
    if is_square && solver != "spectral" && dice.below(2) == 0 {
        let loads = [
            "nodal",
            "exact",
            "nodal,upper-left,falling",
            "exact,falling",
            "nodal,lower-right,none",
        ];
        words.extend(owned(&["--load", loads[dice.below(5) as usize]]));
    }
    if is_nested {
        words.extend(["--r".to_owned(), dice.between(1.0, 20.0).to_string()]);
        let rules = ["signed", "printed", "signed-dual", "printed-dual"];
        words.extend(owned(&["--stop", rules[dice.below(4) as usize]]));
        words.extend(["--max-iterations".to_owned(), (3000 + dice.below(1000)).to_string()]);
        if is_square {
            words.extend(owned(&[
                "--prolongation",
                ["bilinear", "falling-diagonal"][dice.below(2) as usize],
            ]));
        }
    }
    words
}

/// Numbers of an answer that a table has as well: the energy on each level, or of the solution without one, and the
/// bounds on the last.
fn numbers(json: &Value) -> [Vec<u64>; 2] {
    let energies = match json["grids"].as_array() {
        Some(grids) => {
            let mut energies: Vec<_> =
                grids.iter().map(|grid| grid["energy"].as_f64().unwrap()).collect();
            // Where the accuracy of the energy is asked for, the bracket has it.
            *energies.last_mut().unwrap() = json["energy"].as_f64().unwrap();
            energies
        }
        None => vec![json["energy"].as_f64().unwrap()],
    };
    let bounds = json["bound"]["energy"].as_array();
    let bounds = bounds.into_iter().flatten().map(|bound| bound.as_f64().unwrap());
    [bits(energies), bits(bounds)]
}

fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u64> {
    numbers.into_iter().map(f64::to_bits).collect()
}

/// The same numbers of each scene by the table of a run.
fn of_table(csv: &str) -> BTreeMap<String, [Vec<u64>; 2]> {
    let mut lines = csv.lines();
    let head: Vec<_> = lines.next().unwrap().split(',').collect();
    let place = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let (energy, bounds) = (place("energy"), [place("energy_lower"), place("energy_upper")]);
    let mut of_scenes = BTreeMap::<String, [Vec<u64>; 2]>::new();
    for line in lines {
        let cells = fields(line);
        let number = |k: usize| cells[k].parse::<f64>().ok();
        let [energies, last] = of_scenes.entry(cells[0].clone()).or_default();
        energies.extend(number(energy).map(f64::to_bits));
        *last = bits(bounds.into_iter().filter_map(number));
    }
    of_scenes
}

/// Fields of a line in CSV.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

#[test]
fn a_command_that_is_saved_and_run_has_the_numbers_of_solve_to_the_last_bit() {
    let seed = std::env::var("SIGNORINI_SEED").map_or(60, |seed| seed.parse().unwrap());
    let (mut dice, project) = (Dice(seed), project());
    let (mut answers, mut saved) = (BTreeMap::new(), 0);
    for domain in DOMAINS {
        let in_space = domain.contains(&"ball") || domain.contains(&"cube");
        // The gear has too many sides for the last.
        let has_last = !in_space && !domain.iter().any(|word| word.ends_with(".msh"));
        let solvers = if has_last { &SOLVERS[..] } else { &SOLVERS[..5] };
        for (law, solver) in
            LAWS.iter().flat_map(|law| solvers.iter().map(move |solver| (law, solver)))
        {
            let name = format!("saved-{saved:03}");
            let words = command(&mut dice, domain, law, solver);
            let words: Vec<_> = words.iter().map(String::as_str).collect();
            let said = project.run(&[&["solve", "--json", "--save", &name], &words[..]].concat());
            saved += 1;
            let place = format!("pipeline/scenes/{name}.toml");
            assert!(
                said.err.contains(&format!("wrote {place}")),
                "seed {seed}: {words:?} {said:?}"
            );
            let text = fs::read_to_string(project.path(&place)).unwrap();
            // A cap on iterations is an end, too.
            assert!(
                matches!(said.code, Some(0 | 3)) && !said.out.is_empty(),
                "seed {seed}: {words:?} {said:?}"
            );
            answers.insert(name, (said.json(), format!("{words:?}\n{text}")));
        }
    }
    assert!(saved >= 100, "{saved}");
    let ran = project.run(&["run", "-k"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let of_run = of_table(&fs::read_to_string(project.path("report/results.csv")).unwrap());
    for (name, (json, what)) in &answers {
        let [energies, bounds] = numbers(json);
        // A saddle-point method has no bounds in the table, where its rule stops far from the solution.
        let bounds = if json["sweeps"].is_null() { bounds } else { Vec::new() };
        assert_eq!(of_run[name], [energies, bounds], "seed {seed}: {name}: {what}");
        // So has the scene, and the command that it is listed with.
        if dice.below(5) == 0 {
            let listed = project.run(&["list", name, "--json"]).json();
            let words = shlex::split(listed["command"].as_str().unwrap()).unwrap();
            let mut words: Vec<_> = words.iter().map(String::as_str).skip(1).collect();
            words.push("--json");
            for again in [project.run(&words), project.run(&["solve", name, "--json"])] {
                assert_eq!(numbers(&again.json()), numbers(json), "seed {seed}: {name}: {what}");
            }
        }
    }
}
