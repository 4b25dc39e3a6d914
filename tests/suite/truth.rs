//! Finite elements against true solutions, and true solutions at nodes.

use crate::reference::REFERENCES;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::solvers::true_solution;
use signorini_mathematics::spectral::TrueSolution;
use signorini_mathematics::statement::{Domain, Fineness, Statement};

/// f on the square, with the load by which the discrete energy is that of the nodal vector.
fn statement(f: &str, cells: usize) -> Statement {
    Statement {
        load: Some(LoadRule::Exact { diagonal: Diagonal::default() }),
        fineness: Fineness::Width(cells),
        ..Statement::usual(Domain::square(), f)
    }
}

fn truth(f: &str, cells: usize) -> (Problem, TrueSolution) {
    let problem = statement(f, cells).problem(None, &|_| ()).unwrap();
    let found = true_solution(&problem).unwrap();
    (problem, found)
}

#[test]
fn bounds_hold_and_are_sharp() {
    for f in [
        "quadrant(ll)=3; else=-1.002",
        "quadrant(ll)=-6; else=1.998",
        "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5",
        "disc(-0.5,-0.5,0.4)=14; disc(0.5,0.5,0.3)=16; else=-5",
    ] {
        let true_energy = truth(f, 2).1.energy;
        let mut errors = Vec::new();
        for cells in [32, 64] {
            let solved = statement(f, cells).solved(None).unwrap();
            let bounds = solved.bounds().last().unwrap().as_ref().unwrap();
            let [low, high] = bounds.energy;
            assert!(low <= true_energy && true_energy <= high, "{f}: {low} {true_energy} {high}");
            // No less than the error in the energy norm, and hardly more.
            let error = (2.0 * (solved.energy() - true_energy)).sqrt();
            // Cells that a circle cuts add more than those that a straight jump does.
            let most = if f.contains("disc") { 1.05 } else { 1.02 };
            assert!((0.98..most).contains(&(bounds.error[1] / error)), "{f}: {bounds:?} {error}");
            errors.push(error);
        }
        let order = (errors[0] / errors[1]).log2();
        assert!((order - 1.0).abs() < 0.1, "{f}: {order}");
    }
}

#[test]
fn values_at_nodes_are_those_of_the_second_program() {
    let values = |f: &str| {
        let (problem, found) = truth(f, 8);
        found.at_nodes(&problem).y
    };
    let first = values("quadrant(ll)=3; else=-1.002");
    let second = values("quadrant(ll)=-6; else=1.998");
    // The corners in contact, the others, and the centre.
    assert_eq!((first[80], second[0]), (0.0, 0.0));
    assert!((first[0] - REFERENCES[3].corners[3]).abs() < 1e-11);
    assert!((second[40] - REFERENCES[4].centre).abs() < 1e-11);
    // The rim never sinks below zero.
    for values in [first, second] {
        let rim = (0..81).filter(|k| k % 9 == 0 || k % 9 == 8 || *k < 9 || *k >= 72);
        assert!(rim.clone().count() == 32 && rim.into_iter().all(|k| values[k] >= 0.0));
    }
}
