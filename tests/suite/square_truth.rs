//! True solutions on the square against energies by conformal maps and a Riemann-Hilbert problem, against multigrid,
//! and where borders of f touch.

use crate::common::{Dice, random_source};
use crate::reference::REFERENCES;
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::law::{Law, LawNumber};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::solvers::{Refusal, Settings, Solver, solve};
use signorini_mathematics::spectral::{PlaneError, TrueSolution};

/// Problems, one a line: the energy to fourteen digits, the number of arcs in contact, the law, and f. In the order of
/// the table: several arcs; an end of contact behind a corner; a nearly vanishing integral of f; a gap round a corner;
/// discs that touch sides, shapes and one another; shapes that nearly touch; borders that are nearly one, tiny or far
/// away; other laws. Energies by a solver of conformal maps, at two resolutions.
const CASES: &str = include_str!("square_truth.txt");

/// Problem on a grid of the square with so many cells per side.
fn problem(f: &str, law: Law, cells: usize) -> Problem {
    let f: Source = f.parse().unwrap();
    Problem::on_square(nested(&[cells]).unwrap(), f, LoadRule::Bilinear {}, law)
        .unwrap_or_else(|e| panic!("{e}"))
}

fn solved_under(f: &str, law: Law) -> TrueSolution {
    problem(f, law, 2).true_solution().unwrap_or_else(|e| panic!("{f}, {law}: {e}"))
}

fn solved(f: &str) -> TrueSolution {
    solved_under(f, Law::SIGNORINI)
}

/// Law of a case: the paper's without a number.
fn law_of(text: &str) -> Law {
    let law = text.split_once(' ').map(|(name, number)| {
        let of = if name == "limit" { LawNumber::Limit } else { LawNumber::Friction };
        of.law(number.parse().unwrap()).unwrap()
    });
    law.unwrap_or(Law::SIGNORINI)
}

#[track_caller]
fn close(found: f64, known: f64, tolerance: f64) {
    assert!((found - known).abs() <= tolerance, "{found:e}, not {known:e}: {:e}", found - known);
}

#[test]
fn energies_and_brackets_are_those_by_conformal_maps() {
    let mut without_bracket = Vec::new();
    for line in CASES.lines() {
        let (known, f) = line.split_once(" | ").unwrap();
        let [energy, arcs, law] = known.splitn(3, ' ').collect::<Vec<_>>()[..] else {
            panic!("{line}")
        };
        let (energy, arcs): (f64, usize) = (energy.parse().unwrap(), arcs.parse().unwrap());
        let solution = solved_under(f, law_of(law));
        let error = solution.energy / energy - 1.0;
        assert!(error.abs() < 1e-12, "{f} {law}: {error:e}");
        assert_eq!(solution.contact.len(), arcs, "{f} {law}");
        close(
            solution.force / (1.0 + solution.integral.abs()),
            -solution.integral / (1.0 + solution.integral.abs()),
            1e-9,
        );
        match solution.bracket {
            // Of the energy here fourteen digits are known.
            Ok([low, high]) => {
                let slack = 1e-13 * energy.abs();
                assert!(low - slack <= energy && energy <= high + slack, "{f} {law}: {low} {high}");
                assert!(high - low < 1e-9 * energy.abs(), "{f} {law}: {low} {high}");
            }
            Err(_) => without_bracket.push(f),
        }
    }
    assert!(without_bracket.len() <= 1, "{without_bracket:?}");
}

#[test]
fn values_and_ends_are_those_in_quadruple_precision() {
    for known in &REFERENCES {
        let solution = solved(known.f);
        close(solution.energy, known.energy, 1e-12 * known.energy.abs());
        close(solution.values(&[[0.0; 2]])[0], known.centre, 1e-11);
        let corners = [[0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]];
        for (corner, known) in corners.into_iter().zip(known.corners) {
            close(solution.on_boundary(corner)[0], known, 1e-11);
        }
        let [arc] = &solution.contact[..] else { panic!("{}: one arc", known.f) };
        assert_eq!(arc.closed, known.contact.is_none(), "{}", known.f);
        for (found, known) in [arc.from, arc.to].into_iter().zip(known.contact.iter().flatten()) {
            (0..2).for_each(|k| close(found[k], known[k], 1e-10));
        }
    }
}

#[test]
fn arcs_between_both_signs_shorten_exponentially_with_one_over_g() {
    // Half-lengths by a program in quadruple precision, written apart from this one.
    for (g, expected) in
        [(1.0, 0.015_508_230_392_821_913), (0.7, 9.4e-4), (0.5, 2.56e-5), (0.45, 6.3e-6)]
    {
        let solution = solved_under("halfplane(1,0,0)=8; else=-8", Law::friction(g).unwrap());
        assert_eq!(solution.contact.len(), 2);
        for arc in &solution.contact {
            let half = 0.5 * (arc.to[0] - arc.from[0]).abs();
            assert!((half / expected - 1.0).abs() < 2e-2, "{g}: {half:e}");
            assert!((arc.to[0] + arc.from[0]).abs() < 1e-6 * half, "{g}: {arc:?}");
        }
    }
}

#[test]
fn c_f_with_the_law_as_wide_gives_c_v_and_so_does_the_unit_of_f() {
    let friction = |g: f64| Law::friction(g).unwrap();
    let one = solved_under("quadrant(ll)=3; else=-1.002", friction(0.3));
    let two = solved_under("quadrant(ll)=-6; else=2.004", friction(0.6));
    close(two.energy / (4.0 * one.energy), 1.0, 1e-12);
    let [v, w] = [&one, &two].map(|solution| solution.values(&[[0.31, 0.17]])[0]);
    close(w, -2.0 * v, 1e-11);
    let f = |unit: f64| format!("rect(0.25,0.5,0.25,0.5)={:e}; else={:e}", 2.0 * unit, -unit);
    let known = solved(&f(1.0)).energy;
    for unit in [1e-120, 1e120] {
        close(solved(&f(unit)).energy / unit / unit / known, 1.0, 1e-12);
    }
}

#[test]
fn a_large_disc_loses_digits_as_its_bracket_says() {
    // By conformal maps; in the square the disc is nearly a half-plane.
    let known = -0.091_459_613_924_587;
    let solution = solved("quadrant(ul)=-3.4; disc(0.1,-1000,1000)=-2.9; else=1.26");
    let [low, high] = solution.bracket.unwrap();
    assert!(low <= known && known <= high && high - low < 1e-4 * known.abs(), "{low} {high}");
    close(solution.energy, known, 1e-9);
}

#[test]
fn what_nearly_touches_is_as_good_as_touching() {
    // By how much a number may be off, and how f depends on it. A disc at a side from within and from without, an
    // edge along a side, a sliver there, a centre on a side with a tangent beside it, two discs, and a disc at a
    // side where a rectangle ends.
    let families: [fn(f64) -> String; 7] = [
        |d| format!("disc(0.25,0,{})=5; else=-2", 0.25 + d),
        |d| format!("disc(0.375,{},0.25)=5; else=-1", -0.75 + d),
        |d| format!("rect(-0.1,0.25,{},-0.25)=-3; else=-1", -0.5 + d),
        |d| format!("rect({},0.6,-0.1,0.25)=-8; else=-2", 0.5 - d),
        |d| format!("rect(-0.24,0,0.125,0.3)=2; disc(-0.125,{},0.125)=30; else=-2", 0.5 - d),
        |d| format!("disc(-0.2,0.1,0.2)=3; disc(0.1,0.1,{})=4; else=-3", 0.1 + d),
        |d| format!("disc(0.4,{},0.1)=-7; rect(0.35,0.6,-0.38,0.32)=-1; else=-2", 0.32 + d),
    ];
    // Borders that run along a side, 1e-6 away from it or less, but not on it.
    let mut refused = Vec::new();
    for family in families {
        let touching = solved(&family(0.0)).energy;
        for d in [1e-15, 1e-13, 1e-10, 1e-8, 1e-6] {
            match problem(&family(d), Law::SIGNORINI, 2).true_solution() {
                Ok(near) => close(near.energy, touching, 1e-11 + 4.0 * d),
                Err(error) => refused.push(format!("{}: {error}", family(d))),
            }
        }
    }
    assert!(refused.len() <= 5, "{refused:#?}");
}

#[test]
fn what_is_not_solved_is_refused() {
    let cube = AnyMesh::built_in("cube").unwrap();
    let in_space = Problem::on_mesh(&cube, 1, "else=-1").unwrap();
    assert_eq!(in_space.true_solution().err(), Some(Refusal::NotInSpace(Solver::Spectral)));
    // No polynomial; a disc that is too small to be seen.
    for f in ["formula(abs(x) - 1)", "disc(0.3,-0.4,1e-12)=-1e20; else=-1"] {
        let refused = problem(f, Law::SIGNORINI, 2).true_solution().err();
        assert!(
            matches!(refused, Some(Refusal::Spectral(PlaneError::Source(_)))),
            "{f}: {refused:?}"
        );
    }
}

#[test]
fn random_energies_lie_in_the_brackets_of_multigrid_and_of_their_own() {
    let mut dice = Dice(12);
    for k in 0..45 {
        let f = random_source(&mut dice).to_string();
        let law = [Law::SIGNORINI, Law::limited(30.0).unwrap(), Law::friction(8.0).unwrap()][k % 3];
        let problem = problem(&f, law, 64);
        let truth = problem.true_solution().unwrap_or_else(|e| panic!("{f}, {law}: {e}"));
        let run = solve(&problem, &Settings::of(Solver::Multigrid)).unwrap();
        let [low, high] = problem.bounds(&run.y).unwrap().energy;
        assert!(low <= truth.energy && truth.energy <= high, "{f}, {law}: {low} {high}");
        let own = truth.bracket.unwrap_or_else(|e| panic!("{f}, {law}: {e}"));
        assert!(
            own[0] <= high && own[1] >= low && own[1] - own[0] < high - low,
            "{f}, {law}: {own:?}"
        );
    }
}

#[test]
fn the_table_of_solvers_evaluates_it_at_nodes() {
    for law in [Law::SIGNORINI, Law::friction(0.3).unwrap()] {
        let problem = problem("rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5", law, 64);
        let [truth, others] = [Solver::Spectral, Solver::Multigrid]
            .map(|by| solve(&problem, &Settings::of(by)).unwrap());
        let apart = truth.y.iter().zip(&others.y).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(0.0 < apart && apart < 1e-3, "{law}: {apart}");
        assert_eq!((truth.last().name(), truth.ends.len(), truth.first_level), ("converged", 1, 0));
        assert_eq!(truth.y.len(), Grid::new(64).unwrap().nodes());
    }
}

#[test]
fn borders_that_cross_the_boundary_next_to_a_corner_have_brackets() {
    // By how much the border is moved changes the energy in proportion.
    let energy = |offset: f64| {
        let solution = solved(&format!("halfplane(1,-1,{offset:e})=3; else=-4"));
        let [low, high] = solution.bracket.unwrap();
        assert!(high - low < 1e-10 * high.abs(), "{offset:e}: {low} {high}");
        [low, high]
    };
    let [[_, near], [_, far]] = [1e-7, 1e-6].map(energy);
    for offset in [3e-9, 2e-9, 1e-9, 6e-10, 4e-10] {
        let [low, high] = energy(offset);
        let known = near + (near - far) * (1e-7 - offset) / 9e-7;
        assert!(low - 1e-11 < known && known < high + 1e-11, "{offset:e}: {low} {known} {high}");
    }
}
