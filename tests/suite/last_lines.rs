//! The end of a run: how the tables compare, which solves have no solution, and the commands that show them.

use crate::common::{PAPER, Project, TABLE};

/// Two rows as published, by the program itself: what is computed, with a Delta a of which the first agrees.
fn as_published(project: &Project) -> String {
    let json = project.run(&["diff", "--json"]).json();
    let rows = json["tables"][0]["rows"].as_array().unwrap();
    let counts: Vec<_> = rows.iter().map(|row| row["ours"].to_string()).collect();
    let first = rows[0]["delta_a_ours"].as_f64().unwrap();
    PAPER
        .replace("[[1, 2], [1, 100000]]", &format!("[{}]", counts.join(", ")))
        .replace("[1e-4, 1e-4]", &format!("[{first:.1e}, 1e-4]"))
}

#[test]
fn a_run_ends_with_how_its_tables_compare() {
    let project = Project::with(&format!("{TABLE}paper_table = 1\n"));
    let said = project.run(&["run"]);
    let verdict = "Table 1: 2 of 4 counts as published, 0 of 2 Delta a to both digits, some outside the tolerance; \
        `signorini diff` shows each";
    assert_eq!(said.lines().last(), Some(&verdict));
    let again = project.run(&["run"]);
    assert_eq!(again.lines(), [format!("nothing to do: up to date; {verdict}")]);
    assert_eq!(project.run(&["run", "-n"]).out, again.out);

    project.write("pipeline/paper.toml", as_published(&project));
    let said = project.run(&["run"]);
    let verdict = "Table 1: 4 of 4 counts as published, 1 of 2 Delta a to both digits";
    assert_eq!(said.lines().last(), Some(&verdict));
    // `diff` says the same of the same numbers, last.
    let diff = project.run(&["diff"]);
    let total = [verdict, "every number is within the tolerance of its table"];
    assert_eq!(diff.lines()[diff.lines().len() - 2..], total);

    // A table without a scene is told; of tables nobody asks for in this run nothing is said.
    let paper = as_published(&project);
    let (_, table) = paper.split_once("[[table]]").unwrap();
    let second = table.replace("number = 1", "number = 2");
    project.write("pipeline/paper.toml", format!("{paper}\n[[table]]{second}"));
    assert_eq!(
        project.run(&["run"]).out.trim_end(),
        format!("nothing to do: up to date; {verdict}; no scene has table 2")
    );
    project.scene("b", TABLE);
    assert!(!project.run(&["run", "b"]).out.contains("as published"));
}

#[test]
fn solves_without_a_solution_are_told_with_a_command_that_shows_them() {
    // The load of the nodal rule is positive on grid 1/4 and its like, as in problem 1.
    let scene = "title = \"t\"\nf = \"quadrant(ll)=3; else=-1.002\"\ngrids = [4, 8]\nr = [10, 1]\n\
        solver = \"arrow-hurwicz\"\nload = { rule = \"nodal\" }\nstop = [\"signed\"]\noutputs = [\"table\"]\n";
    let far = "title = \"t\"\nf = \"quadrant(ll)=-6; else=1.998\"\ngrids = [4, 8, 16]\nr = [10, 1]\n\
        solver = \"arrow-hurwicz\"\nload = { rule = \"nodal\" }\nstop = [\"printed-dual\", \"signed\"]\noutputs = [\"table\"]\n";
    let project = Project::with(scene);
    project.scene("far", far);
    let said = project.run(&["run"]);
    let lines: Vec<_> = said.err.lines().filter(|line| line.ends_with("says why")).collect();
    let [of_a, of_far] = lines[..] else { panic!("{said:?}") };
    assert_eq!(of_a, "a: no-solution with r = 10, r = 1; `signorini solve a --r 10` says why");
    assert_eq!(
        of_far,
        "far: not-solved with r = 1 under signed; `signorini solve far --r 1 --stop signed` says why"
    );
    for (line, end) in [(of_a, "no-solution"), (of_far, "not-solved")] {
        let command = line.split('`').nth(1).unwrap();
        let args: Vec<_> = command.split(' ').skip(1).collect();
        let shown = project.run(&args);
        assert!(shown.code == Some(3) && shown.err.starts_with("error: "), "{shown:?}");
        let last = shown.out.lines().rfind(|line| line.trim_start().starts_with("1/")).unwrap();
        assert!(last.contains(end), "{command}: {shown:?}");
    }

    // With all counts as published, the end of these solves is a finding, and no alarm.
    let project = Project::with(&format!("{scene}paper_table = 1\n"));
    assert!(project.run(&["run"]).err.contains("a: no-solution with r = 10, r = 1;"));
    project.write("pipeline/paper.toml", as_published(&project));
    let said = project.run(&["run", "--force"]);
    assert!(said.out.contains("4 of 4 counts as published"), "{said:?}");
    assert!(!said.err.contains("no-solution"), "{said:?}");
}
