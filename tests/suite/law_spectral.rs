//! True solutions under laws besides the paper's: known energies and ends, Green's identity, symmetries, multigrid.

use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::{LoadRule, load};
use signorini_mathematics::multigrid::{MultigridParams, solve_square};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::spectral::{Solution, SpectralError, SpectralParams, spectral_under};

/// Problems with friction: name, f and the bound g.
const FRICTION: [(&str, &str, f64); 6] = [
    ("A", "quadrant(ll)=3; else=-1.002", 0.3),
    ("B", "quadrant(ll)=-6; else=1.998", 0.6),
    ("C", "else=1", 0.3),
    ("D", "halfplane(1,0,0)=8; else=-8", 1.0),
    ("E", "rect(-0.5,0,-0.25,0.25)=6; else=-1", 0.25),
    ("F", "else=4", 1.01),
];

fn solved(f: &str, law: Law) -> Solution {
    spectral_under(law, &f.parse().unwrap(), SpectralParams::default())
        .unwrap_or_else(|e| panic!("{f}, {law}: {e}"))
}

fn friction(at: usize) -> Solution {
    let (_, f, g) = FRICTION[at];
    solved(f, Law::friction(g).unwrap())
}

/// Energy of the grid's solution as h goes to zero: its error falls by four with each halving of h.
fn extrapolated(f: &str, law: Law) -> f64 {
    let [coarse, fine] = [512, 1024].map(|n| {
        let grid = Grid::new(n).unwrap();
        let load = load(grid, &f.parse::<Source>().unwrap(), LoadRule::Bilinear {});
        let params = MultigridParams { law, ..MultigridParams::default() };
        let (y, _) = solve_square(n, &load, None, &params).unwrap();
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
    let arc = a.contact[0];
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
    for (name, f, g) in FRICTION {
        let law = Law::friction(g).unwrap();
        let solution = solved(f, law);
        let off = solution.energy / extrapolated(f, law) - 1.0;
        assert!(off.abs() < 1e-7, "{name}: {off:e}");
        let fine = solution.at_resolution(SpectralParams::FINER).unwrap();
        assert!(fine.checks.green.abs() < 1e-13, "{name}: {}", fine.checks);
        assert!(fine.checks.resolution.unwrap().abs() < 1e-13, "{name}: {}", fine.checks);
    }
}

#[test]
fn c_f_with_the_law_as_wide_gives_c_v() {
    for (f, other, factor) in [
        (FRICTION[0].1, "quadrant(ll)=-6; else=2.004", -2.0),
        (FRICTION[3].1, "halfplane(1,0,0)=-24; else=24", -3.0),
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
fn arcs_too_short_between_both_signs_are_refused_with_one_line() {
    let f = FRICTION[3].1.parse().unwrap();
    let law = Law::friction(0.3).unwrap();
    let error = spectral_under(law, &f, SpectralParams::default()).err();
    assert_eq!(error, Some(SpectralError::ShortArcs(law)));
}
