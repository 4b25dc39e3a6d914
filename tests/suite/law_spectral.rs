//! True solutions under laws besides the paper's: known energies and ends, Green's identity, symmetries, multigrid.

use crate::common::Dice;
use signorini_mathematics::bounds::bounds;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::{LoadRule, integral, load};
use signorini_mathematics::experiments::problems::FRICTION;
use signorini_mathematics::multigrid::{MultigridParams, solve_square};
use signorini_mathematics::problem::law::{BoundaryState, Law};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::problem::unsolvable::Component;
use signorini_mathematics::spectral::{Solution, SpectralError, SpectralParams, spectral_under};

fn solved(f: &str, law: Law) -> Solution {
    spectral_under(law, &f.parse().unwrap(), SpectralParams::default())
        .unwrap_or_else(|e| panic!("{f}, {law}: {e}"))
}

fn friction(at: usize) -> Solution {
    solved(FRICTION[at].f, FRICTION[at].law())
}

/// Energy of the grid's solution as h goes to zero: its error falls by four with each halving of h.
fn extrapolated(f: &str, law: Law) -> f64 {
    let [coarse, fine] = [512, 1024].map(|n| {
        let grid = Grid::new(n).unwrap();
        let load = load(grid, &f.parse::<Source>().unwrap(), LoadRule::Bilinear {});
        let params = MultigridParams::default();
        let (y, _) = solve_square(n, law.with_load(&load), None, &params).unwrap();
        judge(grid, law, &y, &load).energy
    });
    fine + (fine - coarse) / 3.0
}

/// Distance along the boundary from the lower left corner, anticlockwise.
fn along([x, y]: [f64; 2]) -> f64 {
    if y == -0.5 {
        x + 0.5
    } else if x == 0.5 {
        1.5 + y
    } else if y == 0.5 {
        2.5 - x
    } else {
        3.5 - y
    }
}

#[test]
fn energies_and_ends_are_those_in_quadruple_precision() {
    let [a, d] = [friction(0), friction(3)];
    for (solution, expected) in [(&a, -0.024_787_188_375_613_304), (&d, -0.627_952_316_469_321_7)] {
        let error = solution.energy / expected - 1.0;
        assert!(error.abs() < 1e-14, "{error:e}");
    }
    let arc = &a.contact[0];
    // Distances along the boundary, anticlockwise from the lower left corner.
    assert!((along(arc.from) - 0.602_923_113_064_346_7).abs() < 1e-14, "{arc:?}");
    assert!((along(arc.to) - 3.397_076_886_935_653).abs() < 1e-14, "{arc:?}");
    for arc in d.contact {
        let half = 0.5 * (along(arc.to) - along(arc.from));
        assert!((half - 0.015_508_230_392_821_913).abs() < 1e-14, "{half}");
    }
}

#[test]
fn energies_are_the_limits_of_multigrid_and_the_flux_balances_f() {
    for problem in FRICTION {
        let (f, law) = (problem.f, problem.law());
        let solution = solved(f, law);
        let off = solution.energy / extrapolated(f, law) - 1.0;
        assert!(off.abs() < 1e-7, "{problem:?}: {off:e}");
        let fine = solution.at_resolution(SpectralParams::FINER).unwrap();
        assert!(fine.checks.green.abs() < 1e-13, "{problem:?}: {}", fine.checks);
        assert!(fine.checks.resolution.unwrap().abs() < 1e-13, "{problem:?}: {}", fine.checks);
    }
}

#[test]
fn c_f_with_the_law_as_wide_gives_c_v() {
    for (f, other, factor) in [
        (FRICTION[0].f, "quadrant(ll)=-6; else=2.004", -2.0),
        (FRICTION[3].f, "halfplane(1,0,0)=-24; else=24", -3.0),
    ] {
        let g = if factor == -2.0 { 0.3 } else { 1.0 };
        let one = solved(f, Law::friction(g).unwrap());
        let two = solved(other, Law::friction(g * f64::abs(factor)).unwrap());
        let off = two.energy / (factor * factor * one.energy) - 1.0;
        assert!(off.abs() < 1e-13, "{other}: {off:e}");
        let [v, w] = [&one, &two].map(|solution| solution.value(0.31, 0.17));
        assert!((w - factor * v).abs() < 1e-12, "{other}: {v} {w}");
    }
}

#[test]
fn arcs_between_both_signs_shorten_exponentially_with_one_over_g() {
    // Half-lengths by a program in quadruple precision, written apart from this one.
    for (g, expected) in
        [(0.9, 7.3e-3), (0.8, 2.9e-3), (0.7, 9.4e-4), (0.6, 2.1e-4), (0.5, 2.56e-5), (0.45, 6.3e-6)]
    {
        let solution = solved(FRICTION[3].f, Law::friction(g).unwrap());
        assert_eq!(solution.contact.len(), 2);
        for arc in &solution.contact {
            let half = 0.5 * (along(arc.to) - along(arc.from));
            assert!((half / expected - 1.0).abs() < 2e-2, "{g}: {half:e}");
            assert!((arc.to[0] + arc.from[0]).abs() < 1e-6 * half.abs(), "{g}: {arc:?}");
        }
    }
    // Far below what a grid sees: energies that the limit of multigrid confirms, and two resolutions that agree.
    for (g, digits) in [(0.5, 1e-10), (0.4, 1e-9), (0.36, 1e-8)] {
        let law = Law::friction(g).unwrap();
        let solution = solved(FRICTION[3].f, law);
        let off = solution.energy / extrapolated(FRICTION[3].f, law) - 1.0;
        assert!(off.abs() < 1e-6, "{g}: {off:e}");
        let fine = solution.at_resolution(SpectralParams::FINER).unwrap();
        assert!(fine.checks.resolution.unwrap().abs() < digits, "{g}: {}", fine.checks);
    }
}

#[test]
fn energies_with_both_signs_lie_in_the_brackets_of_a_grid() {
    let mut dice = Dice(47);
    let mut solutions = 0;
    while solutions < 20 {
        let [a, b, c] = [0.0; 3].map(|_| dice.between(-1.0, 1.0));
        let [p, q] = [0.0; 2].map(|_| dice.between(4.0, 10.0));
        let text = format!(
            "halfplane({a:.2},{b:.2},{:.2})={p:.1}; disc({:.2},0.1,0.15)=2; else={:.1}",
            0.2 * c,
            0.3 * b,
            -q
        );
        let f: Source = text.parse().unwrap();
        let law = Law::friction(dice.between(0.45, 1.5)).unwrap();
        if Component::in_contact(Grid::PERIMETER, integral(&f)).check(law, 0.0).is_err() {
            continue;
        }
        let grid = Grid::new(128).unwrap();
        let load = load(grid, &f, LoadRule::Bilinear {});
        let params = MultigridParams::default();
        let (y, _) = solve_square(128, law.with_load(&load), None, &params).unwrap();
        let states = judge(grid, law, &y, &load).states;
        if [BoundaryState::SlipsUp, BoundaryState::SlipsDown].iter().all(|s| states.contains(s)) {
            let [low, high] = bounds(grid, &f, law, &y).unwrap().energy;
            let energy = solved(&text, law).energy;
            assert!((low..=high).contains(&energy), "{text} {law}: {energy} {low} {high}");
            solutions += 1;
        }
    }
}

#[test]
fn a_corner_between_opposite_signs_is_solved_or_refused() {
    // On the grid of the start v has both signs at nodes beside two opposite corners, which stick.
    let (f, law) = ("quadrant(ur)=-351; else=116.6", Law::limited(0.15).unwrap());
    match spectral_under(law, &f.parse().unwrap(), SpectralParams::default()) {
        Ok(solution) => {
            let energy = solution.energy;
            assert!((-1_374.558_619_792..=-1_374.558_231_372).contains(&energy), "{energy}");
        }
        Err(error) => assert_eq!(error, SpectralError::ShortArcs(law)),
    }
}

#[test]
fn arcs_too_short_between_both_signs_are_refused_with_one_line() {
    let f = FRICTION[3].source();
    let law = Law::friction(0.3).unwrap();
    let error = spectral_under(law, &f, SpectralParams::default()).err();
    assert_eq!(error, Some(SpectralError::ShortArcs(law)));
}
