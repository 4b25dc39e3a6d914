//! Defaults of scenes, what is read back, and mistakes.

use super::*;
use signorini_mathematics::solvers::Solver;
use signorini_mathematics::square::load::integrals;

const GOOD: &str = "title = \"t\"\nf = \"else=-1\"\noutputs = [\"table\"]\n";

#[test]
fn defaults_are_the_papers_for_its_tables_and_else_those_of_solve() {
    let papers = Scene::parse("s", &format!("{GOOD}paper_table = 1\n")).unwrap();
    assert_eq!(papers.finest().cells(), 64);
    assert_eq!(papers.statement.solver, Solver::ArrowHurwicz);
    assert_eq!(papers.load(), LoadRule::default());
    assert_eq!(papers.r(), [1e6, 10.0, 5.0, 1.0, 0.5]);
    assert_eq!(papers.rules(), [Some(StopRule::Signed)]);
    assert!(papers.wants(Output::Table) && !papers.wants(Output::Surface));
    let own = Scene::parse("s", GOOD).unwrap();
    assert_eq!((own.finest().cells(), own.statement.solver), (64, Solver::Multigrid));
    assert_eq!(own.load(), LoadRule::Bilinear {});
    assert_eq!(own.rules(), [None]);
    let method = Scene::parse("s", &format!("{GOOD}solver = \"uzawa\"\n")).unwrap();
    assert_eq!(method.load(), own.load());
    assert_eq!((method.r(), method.rules()), (vec![10.0], vec![Some(StopRule::Printed)]));
}

#[test]
fn lists_of_rules_and_r_are_vary_written_short() {
    let method = format!("{GOOD}solver = \"arrow-hurwicz\"\n");
    let lists = "stop = [\"signed\", \"printed\"]\nr = [1, 10]\n";
    let vary = "vary = { stop = [\"signed\", \"printed\"], r = [1, 10] }\n";
    let [short, long] =
        [lists, vary].map(|lines| Scene::parse("s", &format!("{method}{lines}")).unwrap());
    assert_eq!((short.is_study, long.is_study), (false, true));
    assert_eq!(short.study, long.study);
    assert_eq!(short.drawn(Some(StopRule::Printed)), &short.study.members[3]);
    let drawn = Scene::parse("s", &format!("{method}{vary}draw_r = 10\n")).unwrap_err();
    assert!(drawn.to_string().contains("leave it out of a study"), "{drawn}");
    let product = "r = [1, 10]\nvary = { friction = [1, 2] }\n";
    let product = Scene::parse("s", &format!("{method}{product}")).unwrap().study;
    assert_eq!((product.names, product.members.len()), (vec!["friction".into(), "r".into()], 4));
    for list in ["r = []\n", "stop = []\n"] {
        for vary in ["", "vary = { friction = [1, 2] }\n"] {
            let refused = Scene::parse("s", &format!("{method}{list}{vary}")).unwrap_err();
            assert!(refused.to_string().contains("has no values"), "{list}");
        }
    }
}

#[test]
fn tasks_read_back_the_scene_that_was_hashed() {
    let method = "solver = \"uzawa\"\nr = [1, 0.1, 1e12]\ndraw_r = 0.1\nstop = [\"printed\", \"signed\"]\n\
        max_iterations = 7\nprolongation = \"rising-diagonal\"\nlaw = { friction = 0.3 }\n\
        load = { rule = \"nodal\", tie = \"upper-left\", diagonal = \"falling\" }\n";
    let on_mesh = "domain = { name = \"annulus\", refine = 2, free = [\"outer\", \"inner\"], fixed = [\"a.b\"], \
        curve = { outer = [0.0, 0.1, 0.5], \"a.b\" = [0, 0, 1] } }\n";
    let mut scenes = Vec::new();
    for f in [
        "else=-1",
        "else=-0.1",
        "halfplane(0.1,0.7,-0.3)=2; rect(-0.1,0.3,-0.2,0.1)=1e-3; disc(0,0,0.1)=-7; else=-1.998",
        "halfplane(5e-324,5e-324,0)=1; halfplane(1.7e308,1.7e308,1.7e308)=-3; else=-1",
        "formula( x*y  - 1.1 )",
        "exact(full-contact)",
    ] {
        scenes.push(GOOD.replace("else=-1", f));
        scenes.push(GOOD.replace("else=-1", f) + "paper_table = 2\n");
    }
    for more in
        [method, on_mesh, "accuracy = 0.1\n", "accuracy_energy = 0.1\nlaw = { limit = 3 }\n"]
    {
        scenes.push(GOOD.to_owned() + more);
    }
    for text in scenes {
        let scene = Scene::parse("s", &text).unwrap();
        let written = serde_json::to_value(&scene).unwrap();
        let back: Scene = serde_json::from_value(written.clone()).unwrap();
        assert_eq!(format!("{scene:?}"), format!("{back:?}"), "{text}");
        assert_eq!(serde_json::to_value(&back).unwrap(), written, "{text}");
    }
}

#[test]
fn problems_with_known_solutions_are_solvable() {
    for exact in signorini_mathematics::problem::exact::Exact::ALL {
        assert!(integrals(&Source::from(exact))[0] < -0.5, "{exact:?}");
    }
}
