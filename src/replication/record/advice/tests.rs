//! Each warning and each failure, with its remedies in the words of all who ask.

use super::*;
use signorini_mathematics::bounds::{Accuracy, NoBound};
use signorini_mathematics::discrete::end::{Stop, Violation};
use signorini_mathematics::problem::law::{Law, LawParameter};
use signorini_mathematics::solvers::SaddleSettings;
use signorini_mathematics::statement::Domain;

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
        Warning::Force { law: Law::SIGNORINI, force: 1.0, load: 0.5 },
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
        law: Some(LawParameter::Friction(0.3)),
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
    expect_test::expect![[r#"
        a note
        the KKT residual on grid 1/64 is 0.30 of the load
            use --stop printed-dual, or --solver multigrid | use --solver active-set | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
            use stop = ["printed-dual"], or solver = "multigrid" | use solver = "active-set" | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
        the coarsest grid is 1/63, and the tolerance is 10^-k on the k-th grid, here 0.1 on the last
            choose 1/(2^k m), such as 1/64, or --solver multigrid | choose 1/(2^k m), such as 1/64, or --solver multigrid | choose 1/(2^k m), such as 1/64, or --solver multigrid
            choose 1/(2^k m), such as 1/64, or solver = "multigrid" | choose 1/(2^k m), such as 1/64, or solver = "multigrid" | choose 1/(2^k m), such as 1/64, or solver = "multigrid"
        the load vector sums to a non-negative number on 1/4, 1/8, where the discrete problem has no solution
        the stopping rule was not met on 1/4
        the tolerance 1e-9 was not reached: the KKT residual is 1.00e-7 of the load at the iteration-limit
        rounding errors leave a KKT residual of 1.0e-5 of the load on grid 1/64
            choose another --h | choose another --h | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
            choose another `grids` | choose another `h` | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
        the load vector sums to +0.03000 on grid 1/64, the integral of f is -0.001500: values at the nodes miss where f jumps
            use --load exact | refine the grid | refine the grid
            use load = { rule = "exact" } | refine the grid | refine the grid
        the load vector sums to +0.03000 on grid 1/64, the integral of f is -0.001500: its points miss some of f
            choose a smaller --h | choose a smaller --h | write jumps of f as shapes, or refine the mesh
            choose a smaller `h` | choose a smaller `h` | write jumps of f as shapes, or refine the mesh
        the quadrature of f on grid 1/64 misses 0.020 of the integral of |f|
            choose a smaller --h | choose a smaller --h | write jumps of f as shapes, or refine the mesh
            choose a smaller `h` | choose a smaller `h` | write jumps of f as shapes, or refine the mesh
        f jumps on grid lines
            use --load bilinear | use --load bilinear | use --load bilinear
            use load = { rule = "bilinear" } | use load = { rule = "bilinear" } | use load = { rule = "bilinear" }
        the contact force 1.0000 does not balance the load, 0.50000, so the contact set is not that of the solution
            use --stop printed-dual, or --solver multigrid | use --solver active-set | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
            use stop = ["printed-dual"], or solver = "multigrid" | use solver = "active-set" | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
        no bound of the error: the points at which f is sampled miss 0.20 of the integral of |f|
        the energy is further from the true one than the error explains: the load vector is not that of f
            use --load exact | refine the grid | refine the grid
            use load = { rule = "exact" } | refine the grid | refine the grid
        the error may be 60 % of the solution
            refine the grid, or try --solver multigrid | refine the grid | refine the grid
            refine the grid, or try solver = "multigrid" | refine the grid | refine the grid
    "#]].assert_eq(&told);
}

#[test]
fn each_failure_has_a_remedy_in_each_voice() {
    let told = told(|adviser| failures().iter().map(|of| adviser.on_failure(of)).collect());
    expect_test::expect![[r#"
        uzawa diverged on grid 1/64 after 7 iterations
            choose a smaller r or scale f down | scale f down | scale f down
        the load vector sums to +0.03000 on grid 1/64, where the discrete problem has no solution
            use --load exact, another --h, or a lower f | use another --h or a lower f | change f, or widen the law
            use load = { rule = "exact" }, another `grids`, or a lower f | use another `h` or a lower f | change f, or widen the law
        stopped at the iteration-limit on grid 1/64
            raise --max-iterations, or use --solver multigrid | choose another --h | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
            raise `max_iterations`, or use solver = "multigrid" | choose another `h` | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
        the solver stopped as asked on grid 1/64, but the KKT residual is 0.70 of the load
            use --stop printed-dual, or --solver multigrid | use --solver active-set | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
            use stop = ["printed-dual"], or solver = "multigrid" | use solver = "active-set" | its cells are stretched too much; mesh with smaller aspects, or with fewer cells
        the accuracy 0.001 takes a grid of about 1/9000, too fine for memory; 1/8192 reaches about 1.0e-2
            --solver spectral needs no grid | --solver spectral needs no grid | --solver spectral needs no grid
            solver = "spectral" needs no grid | solver = "spectral" needs no grid | solver = "spectral" needs no grid
        the accuracy of the energy 1e-9 is not reached: error of the energy at most 1 % with 833 nodes; a finer mesh has more nodes than was asked for
            raise --most-nodes | raise --most-nodes | raise --most-nodes
        the accuracy of the energy 1e-9 is not reached: error of the energy at most 1 % with 833 nodes; interrupted
            let it run to its end | let it run to its end | let it run to its end
        the accuracy of the energy 1e-9 is not reached: error of the energy at most 1 % with 833 nodes; a finer mesh takes more memory than is left
            ask for less, or use --solver spectral | ask for less, or use --solver spectral | ask for less, or use --solver spectral
            ask for less, or use solver = "spectral" | ask for less, or use solver = "spectral" | ask for less, or use solver = "spectral"
        the accuracy of the energy 1e-9 is not reached: error of the energy at most 1 % with 833 nodes; a finer mesh takes more memory than is left
            ask for less | ask for less | ask for less
        the accuracy of the energy 1e-9 is not reached: error of the energy at most 1 % with 833 nodes; the bound of the error no longer falls
            the solver has not converged there: mesh with smaller aspects | the solver has not converged there: mesh with smaller aspects | the solver has not converged there: mesh with smaller aspects
        the accuracy of the energy 1e-9 is not reached: error of the energy at most 1 % with 833 nodes; the bound of the error no longer falls
            ask for less, or write jumps of f as shapes | ask for less, or write jumps of f as shapes | ask for less, or write jumps of f as shapes
        the accuracy of the energy 1e-9 is not reached: error of the energy at most 1 % with 833 nodes; the bound of the error no longer falls
            leave it out where v = 0 | leave it out where v = 0 | leave it out where v = 0
    "#]].assert_eq(&told);
}
