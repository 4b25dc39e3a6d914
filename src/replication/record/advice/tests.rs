//! Each warning and each failure, with its remedies in the words of all who ask.

use super::*;
use signorini_mathematics::bounds::{Accuracy, NoBound};
use signorini_mathematics::discrete::end::{Stop, Violation};
use signorini_mathematics::problem::law::LawNumber;
use signorini_mathematics::solvers::SaddleSettings;
use signorini_mathematics::statement::{Boundary, Domain};

/// Warnings, one of each kind.
fn warnings() -> Vec<Warning> {
    let level = || "grid 1/64".to_owned();
    let (sum_load, integral) = (0.03, -0.0015);
    vec![
        Warning::Note("a note".into()),
        Warning::Rough { level: level(), relative: 0.3 },
        Warning::FineStart { cells: 63, grids: 1 },
        Warning::NoCoarseSolution { levels: "1/4, 1/8".into() },
        Warning::CutOff { goal: "stopping rule", levels: "1/4".into() },
        Warning::Tolerance { tolerance: 1e-9, relative: 1e-7, stop: Stop::IterationLimit },
        Warning::Rounding { level: level(), relative: 1e-5 },
        Warning::Load { level: level(), sum_load, integral },
        Warning::Points { level: level(), sum_load, integral },
        Warning::Quadrature { level: level(), missed: 0.02 },
        Warning::Jumps("f jumps on grid lines".into()),
        Warning::Force { has_contact: true, force: 1.0, load: 0.5 },
        Warning::NoBound(NoBound::Missed { part: 0.2 }),
        Warning::Energy,
        Warning::Error { relative: 0.6 },
    ]
}

/// Failures, one of each kind, and those of an accuracy with each end.
fn failures() -> Vec<Failure> {
    let level = || "grid 1/64".to_owned();
    let (accuracy, best) = (Accuracy::Error(1e-3), 0.01);
    let without = |end, has_converged, by_quadrature, takes_spectral| Failure::Accuracy {
        accuracy: Accuracy::Energy(1e-9),
        reached: best,
        nodes: 833,
        end,
        has_converged,
        by_quadrature,
        takes_spectral,
    };
    vec![
        Failure::Diverged { solver: Solver::Uzawa, level: level(), iterations: 7 },
        Failure::NoSolution { level: level(), sum_load: 0.03 },
        Failure::CutOff { stop: Stop::IterationLimit, level: level() },
        Failure::NotSolved { level: level(), violation: Violation::Residual(0.7) },
        Failure::TooFine { accuracy, needed: 9e3, best },
        without(ReachEnd::MostNodes { best }, true, false, false),
        without(ReachEnd::Interrupted { best }, true, false, false),
        without(ReachEnd::Finest { needed: None, best }, true, false, true),
        without(ReachEnd::Finest { needed: None, best }, true, false, false),
        without(ReachEnd::Rounding { least: best }, false, false, true),
        without(ReachEnd::Rounding { least: best }, true, true, true),
        without(ReachEnd::Rounding { least: f64::INFINITY }, true, false, false),
    ]
}

/// Statements with all remedies: of the paper's method with its load, of multigrid, and on a mesh.
fn statements() -> [(Statement, Solver); 3] {
    let square = Statement::usual(Domain::square(), "else=-1");
    let papers = Statement {
        solver: Solver::ArrowHurwicz,
        load: Some(LoadRule::default()),
        saddle: Some(SaddleSettings::default()),
        fineness: Fineness::Grids(vec![4, 64]),
        ..square.clone()
    };
    let disc = Statement {
        boundary: Boundary::under(LawNumber::Friction, 0.3),
        ..Statement::usual(Domain::named("disc"), "else=-1")
    };
    [(papers, Solver::ArrowHurwicz), (square, Solver::Multigrid), (disc, Solver::ActiveSet)]
}

/// Facts, below each its remedies: of each statement as options have them, and as keys if these are other words.
fn told(advice: impl Fn(Adviser<'_>) -> Vec<Advice>) -> String {
    let statements = statements();
    let [options, keys, over_scene] =
        [Voice::Options, Voice::Keys, Voice::OverScene].map(|voice| {
            let advisers = statements.iter().map(|(statement, found_by)| Adviser {
                statement,
                voice,
                found_by: *found_by,
            });
            advisers.map(&advice).collect::<Vec<_>>()
        });
    assert_eq!(options, over_scene);
    let mut text = String::new();
    for (k, Advice { fact, .. }) in options[0].iter().enumerate() {
        text += &format!("{fact}\n");
        let mut last = String::new();
        for voice in [&options, &keys] {
            let remedies = voice.iter().map(|of| combined(&of[k].remedies));
            let line = format!("    {}\n", remedies.collect::<Vec<_>>().join(" | "));
            if line != last && !of_nothing(&line) {
                text += &line;
            }
            last = line;
        }
    }
    text
}

/// True for a line without a remedy.
fn of_nothing(line: &str) -> bool {
    line.trim_matches([' ', '|', '\n']).is_empty()
}

#[test]
fn each_warning_has_a_remedy_in_each_voice() {
    let told = told(|adviser| warnings().iter().map(|of| adviser.on_warning(of)).collect());
    expect_test::expect_file!["warnings.txt"].assert_eq(&told);
}

#[test]
fn each_failure_has_a_remedy_in_each_voice() {
    let told = told(|adviser| failures().iter().map(|of| adviser.on_failure(of)).collect());
    expect_test::expect_file!["failures.txt"].assert_eq(&told);
}
