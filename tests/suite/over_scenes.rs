//! Options beside a scene ask for another problem: its f, its law and its parts are replaced, and the answer is that of
//! the options alone.

use crate::common::{Project, TABLE};
use serde_json::Value;

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

/// Energies of an answer or of all members of a study.
fn energies(project: &Project, line: &str) -> Vec<Value> {
    let said = project.line(&format!("solve {line} --json"));
    assert_eq!(said.code, Some(0), "{line}: {said:?}");
    match serde_json::from_str::<Value>(&said.out) {
        Ok(one) => vec![one["energy"].clone()],
        Err(_) => {
            said.out.lines().map(|row| row.parse::<Value>().unwrap()["energy"].clone()).collect()
        }
    }
}

#[test]
fn options_replace_f_the_law_and_the_parts_of_a_scene() {
    let project = project();
    for (over, alone) in [
        ("--friction 1", "--fixed inner --friction 1"),
        ("--limit 3", "--fixed inner --limit 3"),
        ("--free inner", "--free inner --friction 2"),
        ("--fixed outer", "--fixed outer --friction 2"),
        ("--free outer", "--free outer --fixed inner --friction 2"),
    ] {
        let alone = format!("--f else=-1 --domain annulus --refine 1 {alone}");
        assert_eq!(
            energies(&project, &format!("ring {over}")),
            energies(&project, &alone),
            "{over}"
        );
    }
    // The scene itself has no solution.
    let [over, alone] = ["none", "--h 8"]
        .map(|problem| energies(&project, &format!("{problem} --f 'halfplane(1,0,0)=8; else=-9'")));
    assert_eq!(over, alone);
}

#[test]
fn studies_of_a_scene_vary_f_the_law_and_the_parts() {
    let project = project();
    let of = |line: &str| energies(&project, line);
    let laws = of("ring --vary friction=0.5,1");
    assert_eq!(laws, ["0.5", "1"].map(|g| of(&format!("ring --friction {g}")).remove(0)));
    let loads = of("ring --vary 'f=else=-1|else=-2'");
    assert_eq!(loads, ["else=-1", "else=-2"].map(|f| of(&format!("ring --f {f}")).remove(0)));
    let names = of("none --f 'disc(0,0,$R)=1; else=-1' --vary R=0.1,1/4");
    let alone =
        ["0.1", "1/4"].map(|r| of(&format!("none --f 'disc(0,0,{r})=1; else=-1'")).remove(0));
    assert_eq!(names, alone);
    let varied = "disc(0,0,$R)=1; else=-1\"\nvary = { R = [0.1, 0.2] }";
    project.scene("study", &NONE.replace("else=1\"", varied).replace("map", "table"));
    let law = of("study --friction 0.24");
    assert!(law.len() == 2 && law != of("study"), "{law:?}");
}
