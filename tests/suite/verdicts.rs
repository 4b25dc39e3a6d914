//! What `solve` does not call a solution, `run` does not call one either.

use crate::common::Project;

/// The criterion is met by the zero pair already: the load is far below its tolerance.
const TINY: &str = "title = \"Tiny\"\nf = \"else=-1e-8\"\nsolver = \"arrow-hurwicz\"\nr = [10]\nstop = [\"signed\"]\nload = { rule = \"exact\" }\n\
    outputs = [\"table\", \"surface\", \"contact\"]\n";
/// The nodes see the disc as larger than it is: the load sums to a positive number on the coarse grids.
const LIFTED: &str = "title = \"Lifted\"\nf = \"rect(-0.27,0.27,-0.27,0.27)=3; else=-1.6\"\ngrids = [4, 8]\n\
    solver = \"arrow-hurwicz\"\nr = [10]\nstop = [\"signed\"]\n\
    load = { rule = \"nodal\", diagonal = \"rising\" }\noutputs = [\"table\", \"surface\"]\n";
const SOLVED: &str = "title = \"Suction\"\nf = \"else=-1\"\ngrids = [4, 8]\n\
    solver = \"arrow-hurwicz\"\nr = [10]\nstop = [\"printed-dual\"]\nload = { rule = \"exact\" }\noutputs = [\"table\", \"surface\"]\n";

/// Values of a column of `report/results.csv` for a scene.
fn column(project: &Project, scene: &str, name: &str) -> Vec<String> {
    let text = std::fs::read_to_string(project.path("report/results.csv")).unwrap();
    let mut lines = text.lines();
    let place = lines.next().unwrap().split(',').position(|head| head == name).unwrap();
    let of_scene = lines.filter(|line| line.starts_with(&format!("{scene},")));
    of_scene.map(|line| line.split(',').nth(place).unwrap().to_owned()).collect()
}

#[test]
fn a_run_judges_its_solves_as_solve_does() {
    let project = Project::with(TINY);
    project.scene("lifted", LIFTED);
    project.scene("solved", SOLVED);
    std::fs::create_dir(project.path("report/templates")).unwrap();
    project.write("report/book.toml", "title = \"t\"\n");
    project.write("report/templates/SUMMARY.md", "[All](all.md)\n");
    project.write("report/templates/all.md", "# All\n");
    let ran = project.run(&["run"]);
    for scene in ["a", "lifted", "solved"] {
        let solved = project.run(&["solve", scene, "--json"]);
        let json: serde_json::Value = serde_json::from_str(&solved.out).unwrap();
        let said = json["stop"].as_str().unwrap().to_owned();
        assert_eq!(column(&project, scene, "stop").last(), Some(&said), "{scene}");
        assert!(column(&project, scene, "met").iter().all(|met| met == "true"), "{scene}");
        let picture = project.path(&format!("figures/{scene}-surface.svg"));
        let picture = std::fs::read_to_string(picture).unwrap();
        let is_solution = said == "converged";
        let mut lines = ran.err.lines().filter(|line| line.starts_with(&format!("{scene}: ")));
        assert_eq!(lines.any(|line| line.ends_with("says why")), !is_solution, "{}", ran.err);
        assert_eq!(
            picture.contains(&format!(" ({})</text>", said.replace('-', " "))),
            !is_solution
        );
        assert_eq!(solved.code, Some(if is_solution { 0 } else { 3 }), "{scene}");
    }
    assert_eq!(column(&project, "a", "stop").last().unwrap(), "not-solved");
    assert_eq!(column(&project, "lifted", "stop"), ["no-solution"; 2]);
    let contact = std::fs::read_to_string(project.path("figures/a-contact.svg")).unwrap();
    assert!(contact.contains(", not solved</text>"), "the line of the rule says so");
    let table = project.files(".signorini/v2/objects");
    let has =
        |text: &str| table.values().any(|bytes| String::from_utf8_lossy(bytes).contains(text));
    assert!(has("r,1/4,1/8,delta_a,stop 1/4,stop 1/8\n"), "a table says so too");
    assert!(project.run(&["run", "--quiet", "--force"]).err.is_empty());
}
