//! Options beside a scene ask for another problem: its f, its law and its parts are replaced, and the answer is that of
//! the options alone.

use crate::common::{Project, TABLE};
use serde_json::Value;

const F: &str = "halfplane(1,0,0)=8; else=-9";
/// Ring with a fixed part and friction.
const RING: &str = "title = \"t\"\nf = \"else=-1\"\ndomain = { name = \"annulus\", refine = 1, fixed = [\"inner\"] }\n\
    law = { friction = 2.0 }\noutputs = [\"map\"]\n";
/// The square, which has no solution.
const NONE: &str = "title = \"t\"\nf = \"else=1\"\nh = 8\noutputs = [\"map\"]\n";

fn project() -> Project {
    let project = Project::with(TABLE);
    project.scene("ring", RING);
    project.scene("none", NONE);
    project
}

/// Energy of a row of a study, or on the finest level of an answer.
fn energy(value: Value) -> Value {
    let levels = value["levels"].as_array();
    levels.map_or(&value, |levels| &levels[levels.len() - 1])["energy"].clone()
}

/// Energies of an answer or of all members of a study.
fn energies(project: &Project, args: &[&str]) -> Vec<Value> {
    let said = project.run(&[&["solve"], args, &["--json"]].concat());
    assert_eq!(said.code, Some(0), "{args:?}: {said:?}");
    match serde_json::from_str(&said.out) {
        Ok(one) => vec![energy(one)],
        Err(_) => said.out.lines().map(|row| energy(serde_json::from_str(row).unwrap())).collect(),
    }
}

#[test]
fn options_replace_f_the_law_and_the_parts_of_a_scene() {
    let project = project();
    let annulus = ["--f", "else=-1", "--domain", "annulus", "--refine", "1"];
    for (over, alone) in [
        (&["ring", "--friction", "1"][..], &["--fixed", "inner", "--friction", "1"][..]),
        (&["ring", "--limit", "3"], &["--fixed", "inner", "--limit", "3"]),
        (&["ring", "--free", "inner"], &["--free", "inner", "--friction", "2"]),
        (&["ring", "--fixed", "outer"], &["--fixed", "outer", "--friction", "2"]),
        (&["ring", "--free", "outer"], &["--free", "outer", "--fixed", "inner", "--friction", "2"]),
    ] {
        let [over, alone] = [over.to_vec(), [&annulus, alone].concat()];
        assert_eq!(energies(&project, &over), energies(&project, &alone), "{over:?}");
    }
    // The scene itself has no solution.
    let own = energies(&project, &["--f", F, "--h", "8"]);
    assert_eq!(energies(&project, &["none", "--f", F]), own);
    let said = project.run(&["solve", "ring", "--limit", "3", "--free", "inner"]);
    let words = "not as in the scene: free inner instead of none, fixed none instead of inner, friction none \
                 instead of 2, limit 3 instead of none";
    assert!(said.out.replace("\n  ", " ").contains(words), "{said:?}");
}

#[test]
fn studies_of_a_scene_vary_f_the_law_and_the_parts() {
    let project = project();
    let of = |args: &[&str]| energies(&project, args);
    let laws = of(&["ring", "--vary", "friction=0.5,1"]);
    assert_eq!(laws, ["0.5", "1"].map(|g| of(&["ring", "--friction", g]).remove(0)));
    let loads = of(&["ring", "--vary", "f=else=-1|else=-2"]);
    assert_eq!(loads, ["else=-1", "else=-2"].map(|f| of(&["ring", "--f", f]).remove(0)));
    let names = of(&["none", "--f", "disc(0,0,$R)=1; else=-1", "--vary", "R=0.1,1/4"]);
    let alone = ["0.1", "1/4"].map(|radius| format!("disc(0,0,{radius})=1; else=-1"));
    assert_eq!(names, alone.map(|f| of(&["none", "--f", &f]).remove(0)));
    project.scene(
        "study",
        &NONE
            .replace("else=1\"", "disc(0,0,$R)=1; else=-1\"\nvary = { R = [0.1, 0.2] }")
            .replace("map", "table"),
    );
    let law = of(&["study", "--friction", "0.24"]);
    assert_eq!(law.len(), 2);
    assert_ne!(law, of(&["study"]));
    for (args, words) in [
        (&["study", "--f", F][..], "--f does not go with a scene that varies R"),
        (&["ring", "--vary", "fixed=|outer"], "the scene has such parts"),
        (&["ring", "--h", "8"], "--h does not go with the scene's domain, annulus"),
        (&["none", "--free", "left"], "--free does not go with the scene's domain, square"),
        (&["ring", "--domain", "disc"], "--domain does not go with a scene, which has its own"),
        (&["ring", "--friction", "-1"], "must be a positive number"),
        (&["ring", "--f", "else=-$R"], "--vary R=0.1,0.2"),
        (&["ring", "--friction", "1", "--limit", "1"], "both say which law holds"),
    ] {
        let said = project.run(&[&["solve"], args].concat());
        assert!(said.refusal().contains(words), "{words}: {said:?}");
    }
}
