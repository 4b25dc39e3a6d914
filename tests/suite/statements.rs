//! Statements said in two voices: a command saved as a scene, and the command of a scene, give the numbers of `solve`
//! to the last bit; what runs of scenes say is in `voices`.
//!
//! `SIGNORINI_SEED` is the seed, which a failure prints.

use crate::common::{Dice, Project, mesh_path};
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
const SOLVERS: [&str; 7] = [
    "multigrid",
    "active-set",
    "arrow-hurwicz",
    "uzawa",
    "uzawa-loose",
    "uzawa-proximal",
    "spectral",
];

/// A project with a mesh and a scene.
fn project() -> Project {
    let project = Project::with("title = 't'\nf = 'else=-1'\ngrids = [4]\noutputs = ['table']\n");
    fs::create_dir(project.path("pipeline/meshes")).unwrap();
    fs::copy(mesh_path("gear"), project.path("pipeline/meshes/gear.msh")).unwrap();
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

/// Energies of an answer on all levels, and its bounds.
fn numbers(json: &Value) -> [&Value; 2] {
    [if json["grids"].is_null() { &json["energy"] } else { &json["grids"] }, &json["bound"]]
}

#[test]
fn a_command_that_is_saved_has_the_numbers_of_solve_to_the_last_bit() {
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
            let text = project.read(&place);
            // A cap on iterations is an end, too.
            assert!(
                matches!(said.code, Some(0 | 3)) && !said.out.is_empty(),
                "seed {seed}: {words:?} {said:?}"
            );
            answers.insert(name, (said.json(), format!("seed {seed}: {words:?}\n{text}")));
        }
    }
    assert!(saved >= 100, "{saved}");
    for (name, (json, what)) in &answers {
        // So has the command that it is listed with.
        let mut again = vec![project.run(&["solve", name, "--json"])];
        if dice.below(5) == 0 {
            let listed = project.run(&["list", name, "--json"]).json();
            let command = listed["command"].as_str().unwrap().trim_start_matches("signorini ");
            again.push(project.line(&format!("{command} --json")));
        }
        for said in again {
            assert_eq!(numbers(&said.json()), numbers(json), "{what}");
        }
    }
}
