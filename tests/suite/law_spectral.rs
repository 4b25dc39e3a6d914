//! True solutions under laws besides the paper's: known energies and ends, Green's identity, symmetries, multigrid.

use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::{LoadRule, load};
use signorini_mathematics::multigrid::{MultigridParams, solve_square};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::spectral::{Solution, SpectralParams, spectral_under};

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
    println!("{:?} {:?}", a.contact, d.contact);
}

#[test]
fn laws_measured() {
    for (name, f, g) in FRICTION {
        let law = Law::friction(g).unwrap();
        match spectral_under(law, &f.parse().unwrap(), SpectralParams::default()) {
            Ok(s) => {
                let fine = s
                    .at_resolution(SpectralParams::FINER)
                    .map(|s| s.energy / extrapolated(f, law) - 1.0);
                println!(
                    "{name} {:.17} {} steps {} arcs {:?} {fine:?}",
                    s.energy,
                    s.checks,
                    s.steps,
                    s.contact.iter().map(|c| (along(c.from), along(c.to))).collect::<Vec<_>>()
                );
            }
            Err(e) => println!("{name}: {e}"),
        }
    }
    for g in [1.2, 1.1, 0.9, 0.8, 0.7, 0.6, 0.5, 0.45, 0.4, 0.3, 0.1] {
        match spectral_under(
            Law::friction(g).unwrap(),
            &FRICTION[3].1.parse().unwrap(),
            SpectralParams::default(),
        ) {
            Ok(s) => println!(
                "D {g} {:.17} {} {:?}",
                s.energy,
                s.checks,
                s.contact.iter().map(|c| along(c.to) - along(c.from)).collect::<Vec<_>>()
            ),
            Err(e) => println!("D {g}: {e}"),
        }
    }
}
