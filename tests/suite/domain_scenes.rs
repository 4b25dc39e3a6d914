//! Scenes on domains without a boundary in contact.

use crate::common::{Project, TABLE, number};

#[test]
fn scenes_without_a_boundary_in_contact_run_as_they_are_solved() {
    let project = Project::with(TABLE);
    project.add_book("# One\n");
    let pictures = "outputs = [\"table\", \"source\", \"surface\", \"map\", \"contact\"]\n";
    let disc = "domain = { name = \"disc\", refine = 1, fixed = [\"rim\"] }\n";
    let annulus =
        "domain = { name = \"annulus\", refine = 0, fixed = [\"inner\"], free = [\"outer\"] }\n";
    let ball = "domain = { name = \"ball\", refine = 0, fixed = [\"surface\"] }\n";
    let mut scenes =
        vec![format!("{}accuracy = 0.3\n{pictures}", disc.replace(", refine = 1", ""))];
    for keys in
        ["", "solver = \"arrow-hurwicz\"\n", "solver = \"uzawa\"\n", "law = { friction = 1 }\n"]
    {
        for (domain, outputs) in
            [(disc, pictures), (annulus, pictures), (ball, "outputs = [\"table\"]\n")]
        {
            scenes.push(format!("{domain}{keys}{outputs}"));
        }
    }
    for (k, keys) in scenes.iter().enumerate() {
        project.scene(&format!("held{k}"), &format!("title = \"Held\"\nf = \"else=-1\"\n{keys}"));
    }
    project.run(&["run"]).lines();
    let held: Vec<_> = project.results().into_iter().filter(|row| row["problem"] != "a").collect();
    assert!(held.len() >= scenes.len());
    for row in held {
        assert_eq!([&row["kkt_min_y"], &row["kkt_min_lambda"]], [""; 2], "{row:?}");
        let finite = |name: &str| row[name].parse().is_ok_and(f64::is_finite);
        assert!(["energy", "kkt_natural", "kkt_relative"].into_iter().all(finite), "{row:?}");
    }
    let json = project.answer("held1");
    assert!(json["kkt"]["min_y"].is_null() && number(&json["energy"]) < 0.0, "{json}");
}
