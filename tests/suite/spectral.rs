//! The spectral solver against digits computed in quadruple precision, its own identities and multigrid.

use crate::common::{Dice, random_source};
use crate::reference::REFERENCES;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule, load};
use signorini_mathematics::discrete::stiffness::energy;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::multigrid::{self, MultigridParams};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::solvers::{Refusal, Settings, Solver, solve};
use signorini_mathematics::spectral::{
    Solution, SpectralError, SpectralParams, spectral, true_solution,
};

fn solved(f: &str, params: SpectralParams) -> Solution {
    spectral(&f.parse().unwrap(), params).unwrap_or_else(|e| panic!("{f}: {e}"))
}

#[test]
fn the_table_of_solvers_runs_it_on_a_problem() {
    let settings = Settings::of(Solver::Spectral);
    let grids = || vec![Grid::new(64).unwrap()];
    let f = "rect(-0.25,0.25,-0.25,0.25)=4; else=-1.5";
    for law in [Law::SIGNORINI, Law::friction(0.3).unwrap()] {
        let source = f.parse().unwrap();
        let problem = Problem::on_square(grids(), source, LoadRule::Bilinear {}, law).unwrap();
        let run = solve(&problem, &settings).unwrap();
        let others = solve(&problem, &Settings::of(Solver::Multigrid)).unwrap();
        let distance =
            run.y.iter().zip(&others.y).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(0.0 < distance && distance < 1e-3, "{law}: {distance}");
        assert_eq!((run.last().name(), run.ends.len(), run.first_level), ("converged", 1, 0));
        let truth = true_solution(law, &f.parse().unwrap()).unwrap().energy;
        let [low, high] = problem.bounds(&run.y).unwrap().energy;
        assert!(low <= truth && truth <= high, "{law}: {low} {truth} {high}");
    }
    let formula = "formula(abs(x) - 1)".parse().unwrap();
    let problem = Problem::on_square(grids(), formula, LoadRule::Bilinear {}, Law::SIGNORINI);
    let refused = solve(&problem.unwrap(), &settings).err();
    assert!(matches!(refused, Some(Refusal::Spectral(SpectralError::Plane(_)))));
    let cube = AnyMesh::built_in("cube").unwrap();
    let problem = Problem::on_mesh(&cube, 1, "else=-1", Law::SIGNORINI).unwrap();
    let refused = solve(&problem, &settings).err();
    assert_eq!(refused, Some(Refusal::NotInSpace(Solver::Spectral)));
}

#[track_caller]
fn close(found: f64, known: f64, tolerance: f64) {
    assert!((found - known).abs() <= tolerance, "{found:e}, not {known:e}: {:e}", found - known);
}

#[test]
fn reference_digits_are_reached() {
    for (params, energy, value, end) in [
        (SpectralParams::default(), 2e-13, 1e-12, 3e-14),
        (SpectralParams::FINER, 5e-15, 2e-14, 2e-14),
    ] {
        for known in &REFERENCES {
            let solution = solved(known.f, params);
            close(solution.energy, known.energy, energy);
            close(solution.value(0.0, 0.0), known.centre, value);
            for (found, known) in solution.corners().into_iter().zip(known.corners) {
                close(found, known, value);
            }
            let [arc] = &solution.contact[..] else { panic!("{}: one arc", known.f) };
            match known.contact {
                None => assert_eq!(arc.from, arc.to),
                Some(contact) => {
                    let ends = contact.iter().flatten();
                    for (found, &known) in arc.from.iter().chain(&arc.to).zip(ends) {
                        close(*found, known, end);
                    }
                }
            }
            // The force is what the load leaves.
            close(arc.force, -solution.integral, 1e-11);
        }
    }
}

#[test]
fn two_arcs_share_the_force_by_symmetry() {
    let f = "rect(-0.2,0.2,-0.5,-0.3)=4; rect(-0.2,0.2,0.3,0.5)=4; else=-2";
    let solution = solved(f, SpectralParams::default());
    let [right, left] = &solution.contact[..] else { panic!("two arcs") };
    close(right.force, 0.52, 1e-12);
    close(left.force, 0.52, 1e-12);
    close(right.from[0], 0.2300788663452236, 1e-13);
    close(left.from[0], -right.to[0], 1e-13);
}

#[test]
fn an_end_of_contact_that_coarse_grids_put_before_a_corner_is_found_behind_it() {
    let f = "halfplane(-0.2,-0.837,-0.26)=3.75; disc(-0.28,0.48,0.07)=7.66; halfplane(0.75,-0.767,-0.28)=-1.62; \
        else=-0.5";
    let contact = solved(f, SpectralParams::default()).contact;
    let [arc] = &contact[..] else { panic!("one arc") };
    let [x, y] = arc.to;
    close(x, 0.5, 0.0);
    assert!((4e-5..6e-5).contains(&(y + 0.5)), "{y}");
    assert!(compare(&f.parse().unwrap()).abs() < 0.15);
}

/// Where the integral of f nearly vanishes, v is nearly linear along a side: long arcs end little beyond a corner.
#[test]
fn a_nearly_vanishing_integral_is_solved() {
    for f in [
        "rect(0,0.5,-0.5,0.5)=1; else=-1.00008",
        "rect(0,0.5,-0.5,0.5)=1; else=-1.0002",
        "rect(0,0.5,-0.5,0.5)=1; else=-1.0003",
        "halfplane(0,1,0)=4.999; else=-5",
    ] {
        let solution = solved(f, SpectralParams::default());
        let force: f64 = solution.contact.iter().map(|arc| arc.force).sum();
        close(force / -solution.integral, 1.0, 1e-8);
        let finer =
            solution.at_resolution(SpectralParams::FINER).unwrap_or_else(|e| panic!("{f}: {e}"));
        close(finer.energy / solution.energy, 1.0, 1e-12);
        for (arc, other) in solution.contact.iter().zip(&finer.contact) {
            close(arc.to[0] - other.to[0], 0.0, 1e-9);
            close(arc.to[1] - other.to[1], 0.0, 1e-9);
        }
    }
}

#[test]
fn gaps_round_a_corner_are_found_between_the_points_beside_it() {
    for f in [
        "disc(-0.5,-0.5,0.15)=0.234375",
        "disc(-0.5,-0.5,0.387)=0.099609",
        "disc(-0.5,-0.5,0.26)=0.158203",
    ] {
        let solution = solved(&format!("{f}; else=-1"), SpectralParams::default());
        let [arc] = &solution.contact[..] else { panic!("{f}: {:?}", solution.contact) };
        let ends = [arc.from[0] + 0.5, arc.to[1] + 0.5];
        assert!(ends.iter().all(|end| (1e-4..3e-4).contains(end)), "{f}: {ends:?}");
        // f is the same from both sides.
        close(ends[0], ends[1], 1e-4 * ends[0]);
    }
}

#[test]
fn values_near_the_border_agree_between_resolutions() {
    let f = "rect(0.25,0.5,0.25,0.5)=2; else=-1";
    let [coarse, fine] =
        [SpectralParams::default(), SpectralParams::FINER].map(|params| solved(f, params));
    for (x, y) in [(0.125, 0.25), (-0.25, 0.375), (0.375, 0.375), (0.0, -0.4375), (-0.499, 0.2)] {
        close(coarse.value(x, y), fine.value(x, y), 1e-10);
    }
    // Free, and in contact.
    close(fine.value(0.4999, 0.4999), fine.corners()[1], 1e-6);
    close(fine.value(-0.4999999, 0.0), 0.0, 1e-6);
}

#[test]
fn discs_that_touch_the_border_from_within_are_solved() {
    // In the middle of a panel, elsewhere, and in the middle of half a side.
    for (disc, radius) in [("0,0.125", 0.5), ("0.1,0.2", 0.4), ("-0.25,-0.35", 0.15)] {
        let energy = |radius: f64| {
            solved(&format!("disc({disc},{radius})=-4; else=-1"), SpectralParams::default()).energy
        };
        close(energy(radius), energy(radius - 1e-7), 1e-6);
    }
}

#[test]
fn a_disc_may_touch_a_side_where_a_rectangle_ends() {
    let f =
        "disc(0.4,0.32,0.1)=-7.05; rect(0.35,0.51,-0.38,0.32)=-1.3; quadrant(ll)=2.69; else=-2.78";
    assert!(compare(&f.parse().unwrap()).abs() < 0.15);
}

#[test]
fn discs_of_one_size_may_touch() {
    // In the middle of what the square and the line y = -1/4 leave of the first.
    let f = "disc(0.5,-0.375,0.25)=-1; disc(0,-0.375,0.25)=-6; rect(0,0.1,-0.5,-0.25)=6; else=-1";
    assert!(compare(&f.parse().unwrap()).abs() < 0.15);
}

#[test]
fn f_is_read_between_curves_that_touch_beside_a_crossing() {
    for f in [
        "rect(-0.3,-0.25,-0.249999,0)=0; disc(0,-0.25,0.25)=4; else=-6",
        "disc(1.7e-6,0.25,0.5)=-6; rect(0,0.3,-0.25,0)=-2; else=1",
        "quadrant(ur)=-8; disc(0.5,-0.499999,0.5)=-8; else=-2",
        "disc(0,0.5,0.5)=2; rect(-0.5,0,0.4999982,0.5)=-5; else=-4.8",
    ] {
        assert!(compare(&f.parse().unwrap()).abs() < 0.15, "{f}");
    }
}

#[test]
fn a_gap_beside_a_corner_is_found_from_one_round_it() {
    // The load is positive near the corner, but not on the side along which contact goes round it.
    let f = "rect(-0.4998,0,0.25,0.5)=0.5; disc(0.5,0,0.2)=1; else=-3";
    let contact = solved(f, SpectralParams::default()).contact;
    let [arc] = &contact[..] else { panic!("one arc") };
    let [[x0, y0], [x1, y1]] = [arc.from, arc.to];
    close(y0, 0.5, 0.0);
    close(y1, 0.5, 0.0);
    assert!(-0.5 < x0 && x0 < x1 && x1 < -0.49, "{x0} {x1}");
}

#[test]
fn a_large_disc_comes_close_to_a_half_plane() {
    let energy = |quadrant: &str, region: &str| {
        let f = format!("quadrant({quadrant})=-3.4; {region}=-2.9; else=1.26");
        solved(&f, SpectralParams::default()).energy
    };
    let (limit, change) = (energy("ul", "halfplane(0,1,0)"), 0.014966);
    let radius = 1e3;
    let disc = energy("ul", &format!("disc(0.1,-{radius},{radius})"));
    // First order in one over the radius, by the guaranteed bracket on 1/2048.
    close(radius * (disc - limit), change, 1e-5);
    // Turned by a right angle, it has all digits again.
    close(energy("ll", &format!("disc({radius},0.1,{radius})")), disc, 1e-15);
}

#[test]
fn jumps_that_nearly_coincide_are_told_apart() {
    let energy = |left: &str| {
        let f = format!("rect({left},0.25,-0.3,0.1)=1; quadrant(ul)=-2; else=-1");
        solved(&f, SpectralParams::default()).energy
    };
    let known = energy("0");
    for gap in ["1e-13", "1e-12", "1e-10", "1e-9", "1e-7"] {
        close(energy(gap), known, gap.parse().unwrap());
    }
}

#[test]
fn what_nearly_touches_is_as_good_as_touching() {
    let energy = |f: &str| {
        let solution = solved(f, SpectralParams::default());
        let fine =
            solution.at_resolution(SpectralParams::FINER).unwrap_or_else(|e| panic!("{f}: {e}"));
        close(fine.energy, solution.energy, 1e-11);
        fine.energy
    };
    // By how much a number may be off, and how f depends on it. A disc at a side from within and from without, an
    // edge along a side, a sliver there, a centre on a side with a tangent beside it, two discs, a disc at a side
    // where a rectangle ends, and a disc that is next to nothing.
    let families: [fn(f64) -> String; 8] = [
        |d| format!("disc(0.25,0,{})=5; else=-2", 0.25 + d),
        |d| format!("disc(0.375,{},0.25)=5; else=-1", -0.75 + d),
        |d| format!("rect(-0.1,0.25,{},-0.25)=-3; else=-1", -0.5 + d),
        |d| format!("rect({},0.6,-0.1,0.25)=-8; else=-2", 0.5 - d),
        |d| format!("rect(-0.24,0,0.125,0.3)=2; disc(-0.125,{},0.125)=30; else=-2", 0.5 - d),
        |d| format!("disc(-0.2,0.1,0.2)=3; disc(0.1,0.1,{})=4; else=-3", 0.1 + d),
        |d| format!("disc(0.4,{},0.1)=-7; rect(0.35,0.6,-0.38,0.32)=-1; else=-2", 0.32 + d),
        |d| format!("disc(0.1,-0.2,{})=3; quadrant(ll)=3; else=-1.002", 1e-300 + d),
    ];
    for family in families {
        let touching = energy(&family(0.0));
        for d in [1e-15, 1e-13, 1e-10, 1e-8, 1e-6] {
            close(energy(&family(d)), touching, 1e-11 + 4.0 * d);
        }
    }
}

#[test]
fn the_length_of_a_normal_does_not_matter() {
    let energy = |f: &str| spectral(&f.parse().unwrap(), SpectralParams::default()).unwrap().energy;
    for length in ["1e-160", "1e160", "5e-324", "1e-320", "1.7e308"] {
        let f = format!("halfplane({length},{length},0)=1; else=-2");
        assert_eq!(energy(&f), energy("halfplane(1,1,0)=1; else=-2"));
    }
}

#[test]
fn a_line_far_away_is_none() {
    let energy = |f: &str| solved(f, SpectralParams::default()).energy;
    let known = energy("disc(0,0,0.3)=1; else=-2");
    for line in ["halfplane(1,2,1e300)", "halfplane(5e-324,0,1)", "halfplane(1,1,20)"] {
        assert_eq!(energy(&format!("{line}=-2; disc(0,0,0.3)=1; else=3")), known, "{line}");
    }
}

#[test]
fn the_unit_of_f_does_not_matter() {
    let f = |unit: f64| {
        format!(
            "rect(0.25,0.5,0.25,0.5)={:e}; disc(-0.3,0,0.1)={:e}; else={:e}",
            2.0 * unit,
            unit,
            -unit
        )
    };
    let known = solved(&f(1.0), SpectralParams::default());
    for unit in [1e-130, 1e-60, 1e60, 1e130] {
        let found = solved(&f(unit), SpectralParams::default());
        close(found.energy / unit / unit / known.energy, 1.0, 1e-13);
        close(found.contact[0].from[0], known.contact[0].from[0], 1e-13);
    }
}

#[test]
fn what_is_not_solved_is_refused() {
    let refused = |f: &str| spectral(&f.parse().unwrap(), SpectralParams::default()).err();
    assert!(matches!(refused("else=1"), Some(SpectralError::Unsolvable(_))));
    assert!(matches!(refused("exact(torsion)"), Some(SpectralError::NotPieces)));
    // A jump that is too small to be seen is missed in the force.
    let lost = "disc(0.3,-0.4,1e-12)=-1e20; else=-1";
    assert!(matches!(refused(lost), Some(SpectralError::Unchecked { .. })));
}

/// How far the spectral energy is from extrapolated ones, over what one halving of h changes.
fn compare(f: &Source) -> f64 {
    let solution = spectral(f, SpectralParams::default()).unwrap_or_else(|e| panic!("{f}: {e}"));
    let [coarse, fine] = [64, 128].map(|n| {
        let grid = Grid::new(n).unwrap();
        let load = load(grid, f, LoadRule::Exact { diagonal: Diagonal::Rising });
        let (y, _) = multigrid::solve_square(
            n,
            Law::SIGNORINI.with_load(&load),
            None,
            &MultigridParams::default(),
        )
        .unwrap();
        energy(grid, &y, &load)
    });
    let change = fine - coarse;
    (fine + change / 3.0 - solution.energy) / change.abs().max(1e-9 * fine.abs())
}

#[test]
fn a_thousand_random_problems_agree_with_extrapolated_finite_elements() {
    let mut dice = Dice(12);
    for _ in 0..1000 {
        let f = random_source(&mut dice);
        let ratio = compare(&f);
        assert!(ratio.abs() < 0.15, "{f}: {ratio}");
    }
}
