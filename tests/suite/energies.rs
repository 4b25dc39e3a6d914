//! Energies and their guaranteed brackets, as `solve` and scenes give them.

use crate::common::{Dice, Project, TABLE, bracket, gmsh_file, mesh_path, number};
use serde_json::{Value, json};

fn energy(json: &Value) -> f64 {
    number(&json["energy"])
}

/// f on a box around a point of every domain, with an integral that is little below zero.
fn random_f(dice: &mut Dice) -> String {
    let [x0, y0] = [0.0; 2].map(|_| dice.between(-0.45, -0.05));
    let [x1, y1] = [x0, y0].map(|least| dice.between(least + 0.1, 0.45));
    let value = dice.between(0.5, 2.0);
    let around = value * (x1 - x0) * (y1 - y0) * dice.between(1.1, 1.6);
    format!("rect({x0},{x1},{y0},{y1})={value}; else=-{}", around + 0.05)
}

#[test]
fn the_energy_that_is_printed_has_the_accuracy_that_was_asked_for() {
    let project = Project::with(TABLE);
    let mut dice = Dice(4);
    // The linear v is 2.5 % off on the grid on which the bracket is narrow enough.
    let mut cases = vec![("square", "rect(-0.2,0.35,-0.3,0.1)=1.1; else=-0.41".to_owned())];
    for domain in ["square", "square", "square", "lshape", "lshape", "disc", "annulus"] {
        cases.push((domain, random_f(&mut dice)));
    }
    for (case, (domain, f)) in cases.iter().enumerate() {
        let solve = |wanted: f64| {
            let line = format!("--domain {domain} --f '{f}' --accuracy-energy {wanted}");
            (project.answer(&line), project.line(&format!("solve {line}")))
        };
        let wanted = if case % 2 == 0 { 1e-2 } else { 3e-3 };
        let [(found, said), (finer, _)] = [wanted, 0.1 * wanted].map(solve);
        let [low, high] = bracket(&finer);
        let off = (energy(&found) - 0.5 * (low + high)).abs();
        assert!(off <= wanted * -high + (high - low), "{domain} {f}: {found} {low} {high}");
        let [low, high] = bracket(&found);
        assert!(low <= energy(&found) && energy(&found) <= high, "{domain} {f}: {found}");
        // Text and JSON say the same, and what v has is called so.
        let shown: f64 = said.lines()[1].strip_prefix("energy ").unwrap().parse().unwrap();
        assert!((shown / energy(&found) - 1.0).abs() < 1e-6, "{said:?}");
        let of_v = found["energy_of_linear_v"].as_f64().unwrap();
        let is_named = said.out.contains("\nenergy of the linear v ");
        assert_eq!(is_named, of_v != energy(&found), "{said:?}");
        assert_eq!(found["energy"], found["grids"].as_array().unwrap().last().unwrap()["energy"]);
    }
}

#[test]
fn an_exact_load_has_its_energy_for_the_upper_end() {
    let project = Project::with(TABLE);
    let lshape = "lshape --f 'disc(-0.36,0.69,0.02)=-1410; else=-0.991'";
    let ball = "ball --f 'ball(0.31,0.27,0.2,0.03)=-20000; else=-0.5'";
    let gear = mesh_path("gear");
    for (problem, law, times) in [
        (lshape, "", [4, 6]),
        (lshape, "--friction 3", [3, 5]),
        (ball, "", [2, 3]),
        (ball, "--friction 4", [2, 3]),
        ("disc --f 'disc(0.3,0.2,0.07)=90; else=-1'", "--limit 3", [2, 4]),
        (&format!("{gear} --f 'disc(0.1,0.7,0.01)=300; halfplane(1,0,0)=-1; else=-2'"), "", [0, 1]),
    ] {
        let [coarse, fine] = times
            .map(|times| project.answer(&format!("--domain {problem} {law} --refine {times}")));
        for json in [&coarse, &fine] {
            let ([low, high], energy) = (bracket(json), energy(json));
            let rounding = 1e-9 * energy.abs();
            assert!(low < high && (high - energy).abs() <= rounding, "{problem} {law}: {json}");
        }
        // Polygons of a curved domain have energies of their own.
        if problem == lshape {
            let [[low, high], [finer_low, finer_high]] = [&coarse, &fine].map(bracket);
            assert!(low <= finer_high && finer_low <= high, "{coarse} {fine}");
        }
    }
}

#[test]
fn where_f_is_zero_the_answer_is_exact() {
    let project = Project::with(TABLE);
    for line in [
        "--domain lshape --f else=0 --friction 1 --accuracy 0.1",
        "--domain annulus --f else=0 --fixed inner --accuracy-energy 0.1",
        "--domain disc --f 'formula(0*x)' --friction 1 --accuracy 0.1",
        "--domain ball --f else=0 --friction 1",
        "--domain annulus --f 'rect(-0.2,0.2,-0.2,0.2)=1e-30; else=0' --fixed inner",
        "--f else=0 --friction 1",
        "--f else=0 --friction 2 --accuracy 0.01",
        "--f 'disc(3,3,0.5)=7; else=0' --friction 1 --accuracy-energy 0.01",
    ] {
        let json = project.answer(line);
        assert_eq!([bracket(&json), [energy(&json); 2]], [[0.0; 2]; 2], "{json}");
        let relative = &json["bound"]["relative"];
        assert_eq!(relative, &json!({ "energy": 0.0, "error": 0.0 }), "{json}");
        let warnings = json["warnings"].as_array().unwrap().len();
        assert_eq!(warnings, usize::from(line.contains("disc(3")), "{json}");
        if json["adapted"].is_object() {
            assert_eq!(json["adapted"]["end"], "goal");
        }
    }
}

#[test]
fn brackets_of_an_f_that_the_points_miss_are_left_out() {
    let project = Project::with(TABLE);
    let f = "formula(-1+2.5e3*exp(-1e4*((x-0.1)^2+(y-0.13)^2)))";
    let on_grid = |how: &str| project.answer(&format!("--f '{f}' {how}"));
    let coarse = on_grid("--h 1/8");
    assert_eq!(coarse["bound"], Value::Null, "{coarse}");
    let reason = coarse["bound_reason"].as_str().unwrap();
    assert!(reason.starts_with("the points at which f is sampled miss "), "{reason}");
    // Other voices say it as well.
    let sentence = Value::from(format!("no bound of the error: {reason}"));
    let row = on_grid("--vary h=1/8");
    assert!(row["energy_lower"].is_null(), "{row}");
    for said in [&coarse, &row] {
        assert!(said["warnings"].as_array().unwrap().contains(&sentence), "{said}");
    }
    project.scene("m", &format!("title = \"t\"\nf = \"{f}\"\nh = 8\noutputs = [\"table\"]\n"));
    project.run(&["run", "m"]);
    let table = project.read("report/tables/m.tex");
    assert!(table.contains(sentence.as_str().unwrap()), "{table}");
    let fine = on_grid("--h 1/128");
    let [low, high] = bracket(&fine);
    // An accuracy goes on to a grid whose points miss nothing.
    let json = on_grid("--accuracy 0.2");
    let [other_low, other_high] = bracket(&json);
    assert!(low <= other_high && other_low <= high, "{fine} {json}");
}

#[test]
fn integrals_beyond_the_range_are_refused_with_their_number() {
    let project = Project::with(TABLE);
    let square = "1 0 0 0\n2 1e30 0 0\n3 1e30 1e30 0\n4 0 1e30 0";
    project.write("large.msh", gmsh_file(square, "1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4"));
    for (f, words) in [
        ("else=-1e100", "the integral of |f| is 1.00000000000"),
        ("else=-1e131", "the largest value of |f| is 1e131"),
        ("formula(-1e80-1e10*x)", "the integral of |f| is"),
    ] {
        let said = project.run(&["solve", "--domain", "large.msh", "--f", f]);
        assert!(said.refusal().contains(words), "{said:?}");
    }
    assert!(energy(&project.answer("--domain large.msh --f else=-1e69")).is_finite());
}

#[test]
fn uzawa_ends_at_every_scale() {
    let project = Project::with(TABLE);
    let mut sweeps = Vec::new();
    for scale in ["", "e4", "e6", "e7", "e8", "e9", "e10", "e14"] {
        let f = format!(
            "rect(-0.2,0.35,-0.3,0.1)=1.1{scale}; disc(-0.25,0.2,0.12)=-0.7{scale}; else=-0.41{scale}"
        );
        for solver in ["uzawa", "uzawa-loose", "uzawa-proximal"] {
            let json = project.answer(&format!("--h 1/16 --f '{f}' --solver {solver}"));
            assert_eq!(json["stop"], "converged", "{scale}: {json}");
            sweeps.push(json["sweeps"].as_u64().unwrap());
        }
    }
    // Before, 50 000 on this grid at 1e10, and beyond a million at 1e8 on one of 1/64.
    assert!(sweeps.iter().all(|count| *count < 4_000), "{sweeps:?}");
}
