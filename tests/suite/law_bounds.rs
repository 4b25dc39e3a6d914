//! Guaranteed bounds under laws besides the paper's: known energies, disturbed vectors, symmetries, and meshes.

use crate::common::Dice;
use crate::laws::{FRICTION, FrictionProblem};
use signorini_mathematics::bounds::{Bounds, NoBound, bounds};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{LoadRule, load};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{AnyMesh, Mesh, uniform_cube};
use signorini_mathematics::multigrid::{Goal, MultigridParams, solve_square};
use signorini_mathematics::problem::law::{BoundaryState, Law, LawParameter};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::problem::unsolvable::Unsolvable;
use signorini_mathematics::solvers::{Run, Settings, Solver, solve};

/// Largest width of the bracket at 1/256 for each problem with friction.
const WIDTHS: [f64; 6] = [2e-8, 8e-8, 2e-9, 3e-7, 2e-8, 2e-6];

/// Energies of the first and the fourth problem with friction, by a spectral method in quadruple precision, written
/// apart from this program.
const ENERGIES: [(usize, f64); 2] = [(0, -0.024_787_188_375_613_3), (3, -0.627_952_316_469_321_7)];

fn solved(n: usize, f: &Source, law: Law, goal: Goal) -> (Grid, Vec<f64>) {
    let grid = Grid::new(n).unwrap();
    let params = MultigridParams { goal, ..MultigridParams::default() };
    let load = load(grid, f, LoadRule::Bilinear {});
    (grid, solve_square(n, law.with_load(&load), &params).unwrap().0)
}

/// Bounds of the solution of a problem on a grid.
fn of_problem(problem: FrictionProblem, n: usize) -> Bounds {
    let (f, law) = (problem.source(), problem.law());
    let (grid, y) = solved(n, &f, law, Goal::RoundingFloor);
    bounds(grid, &f, law, &y).unwrap()
}

fn width(bounds: &Bounds) -> f64 {
    bounds.energy[1] - bounds.energy[0]
}

fn holds(bounds: &Bounds, energy: f64) -> bool {
    bounds.energy[0] <= energy && energy <= bounds.energy[1]
}

/// True if intervals have a point in common.
fn overlap(intervals: &[[f64; 2]]) -> bool {
    let low = intervals.iter().fold(f64::MIN, |low, interval| low.max(interval[0]));
    let high = intervals.iter().fold(f64::MAX, |high, interval| high.min(interval[1]));
    low <= high
}

fn disturbed(y: &[f64], size: f64, dice: &mut Dice) -> Vec<f64> {
    y.iter().map(|value| value + size * dice.between(-1.0, 1.0)).collect()
}

#[test]
fn brackets_hold_the_true_energies_of_solutions_and_of_vectors_stopped_early() {
    for (at, energy) in ENERGIES {
        let problem = FRICTION[at];
        let (f, law) = (problem.source(), problem.law());
        for n in [16, 32, 64, 128, 256] {
            for goal in [Goal::RoundingFloor, Goal::DiscretisationError] {
                let (grid, y) = solved(n, &f, law, goal);
                let found = bounds(grid, &f, law, &y).unwrap();
                assert!(holds(&found, energy), "{problem:?} 1/{n} {goal:?}: {found:?}");
            }
        }
    }
}

#[test]
fn brackets_of_disturbed_vectors_hold_the_true_energies() {
    let mut dice = Dice(31);
    for (at, energy) in ENERGIES {
        let problem = FRICTION[at];
        let (f, law) = (problem.source(), problem.law());
        let (grid, y) = solved(32, &f, law, Goal::RoundingFloor);
        let best = bounds(grid, &f, law, &y).unwrap();
        for k in 0..300 {
            let size = 10f64.powi(-(k % 7));
            let found = bounds(grid, &f, law, &disturbed(&y, size, &mut dice)).unwrap();
            assert!(holds(&found, energy), "{problem:?} {k}: {found:?}");
            assert!(found.error[0] <= found.error[1], "{problem:?} {k}: {found:?}");
            assert!(size > 1e-5 || found.error[1] < 1.2 * best.error[1], "{problem:?}: {found:?}");
        }
    }
}

#[test]
fn brackets_of_all_grids_overlap_and_shrink() {
    for (problem, allowed) in FRICTION.into_iter().zip(WIDTHS) {
        let grids = [16, 32, 64, 128, 256, 512].map(|n| of_problem(problem, n));
        assert!(overlap(&grids.each_ref().map(|found| found.energy)), "{problem:?}: {grids:?}");
        let widths = grids.each_ref().map(width);
        let effectivity = grids.each_ref().map(|found| found.error[1] / found.error[0]);
        println!("{problem:?}: widths {widths:?}, upper over lower bound {effectivity:?}");
        assert!(widths[4] < allowed, "{problem:?}: {widths:?}");
        let rate = (widths[0] / widths[4]).powf(0.25);
        assert!(rate > 4.0, "{problem:?}: {rate} {widths:?}");
    }
}

#[test]
fn minus_f_has_the_same_bounds() {
    let mut dice = Dice(5);
    for problem in FRICTION {
        let (f, law) = (problem.source(), problem.law());
        let Source::Pieces { background, pieces } = &f else { panic!("{problem:?}") };
        let pieces = pieces.iter().map(|(region, value)| (*region, -value));
        let minus = Source::Pieces { background: -background, pieces: pieces.collect() };
        let (grid, y) = solved(32, &f, law, Goal::RoundingFloor);
        for size in [0.0, 1e-6, 1e-2] {
            let y = disturbed(&y, size, &mut dice);
            let opposite: Vec<f64> = y.iter().map(|value| -value).collect();
            let one = bounds(grid, &f, law, &y).unwrap();
            let other = bounds(grid, &minus, law, &opposite).unwrap();
            let far = one.energy.iter().zip(other.energy).any(|(a, b)| (a - b).abs() > 1e-11);
            assert!(
                !far && (one.error[1] - other.error[1]).abs() < 1e-9,
                "{problem:?}: {one:?} {other:?}"
            );
        }
    }
}

#[test]
fn reflected_laws_have_the_bounds_of_the_papers() {
    let [f, minus]: [Source; 2] =
        ["quadrant(ll)=3; else=-1.25", "quadrant(ll)=-3; else=1.25"].map(|f| f.parse().unwrap());
    let (grid, y) = solved(32, &f, Law::SIGNORINI, Goal::RoundingFloor);
    let opposite: Vec<f64> = y.iter().map(|value| -value).collect();
    let one = bounds(grid, &f, Law::SIGNORINI, &y).unwrap();
    assert_eq!(one, bounds(grid, &minus, Law::SIGNORINI.reflected(), &opposite).unwrap());
    // A limit that no reaction reaches changes the reactions by no more than the way in which f is balanced.
    let limited = bounds(grid, &f, Law::limited(100.0).unwrap(), &y).unwrap();
    let far = one.energy.iter().zip(limited.energy).any(|(a, b)| (a - b).abs() > 1e-10);
    assert!(!far, "{one:?} {limited:?}");
}

#[test]
fn where_v_has_one_sign_the_upper_end_of_the_interval_plays_no_part() {
    for problem in [0, 2, 4, 5].map(|at| FRICTION[at]) {
        let (f, law) = (problem.source(), problem.law());
        let half_line = Law::new(-problem.g, f64::INFINITY).unwrap();
        let (grid, y) = solved(64, &f, law, Goal::RoundingFloor);
        assert!(y == solved(64, &f, half_line, Goal::RoundingFloor).1, "{problem:?}");
        let [one, other] = [law, half_line].map(|law| bounds(grid, &f, law, &y).unwrap());
        // The fluxes differ by the way in which they balance f.
        let far = one.energy.iter().zip(other.energy).any(|(a, b)| (a - b).abs() > 1e-10);
        assert!(!far, "{problem:?}: {one:?} {other:?}");
        assert!((one.error[1] - other.error[1]).abs() < 1e-8, "{problem:?}: {one:?} {other:?}");
    }
}

/// Laws whose far ends no reaction reaches, from ends that are near to the greatest numbers there are.
fn far_laws(near: Law) -> Vec<Law> {
    let law = |end: f64| if near.lo() < 0.0 { Law::friction(end) } else { Law::limited(end) };
    [1e3, 1e6, 1e9, 1e13, 1e100, 1e300].map(|end| law(end).unwrap()).to_vec()
}

#[test]
fn an_end_of_the_interval_that_no_reaction_reaches_does_not_widen_the_bounds() {
    let f: Source = "rect(-0.2,0.35,-0.3,0.1)=1.1; else=-0.41".parse().unwrap();
    let mut dice = Dice(9);
    // Under the friction v = 0 on the whole boundary.
    for near in [Law::limited(100.0).unwrap(), Law::friction(100.0).unwrap()] {
        let (grid, y) = solved(64, &f, near, Goal::RoundingFloor);
        for size in [0.0, 1e-9, 1e-5] {
            let y = disturbed(&y, size, &mut dice);
            let best = bounds(grid, &f, near, &y).unwrap();
            for law in far_laws(near) {
                let found = bounds(grid, &f, law, &y).unwrap();
                assert!(width(&found) <= width(&best) + 1e-11, "{law} {size}: {found:?} {best:?}");
                assert!(found.error[1] <= best.error[1] + 1e-9, "{law}: {found:?} {best:?}");
                assert!(overlap(&[found.energy, best.energy]), "{law}: {found:?} {best:?}");
            }
        }
    }
}

#[test]
fn nor_does_it_on_meshes() {
    let f = "box(-0.2,0.3,-0.3,0.1,-0.5,0.5)=1.1; else=-0.41";
    let cube = AnyMesh::Space(uniform_cube(1));
    let mut dice = Dice(10);
    for near in [Law::limited(100.0).unwrap(), Law::friction(100.0).unwrap()] {
        let problem = Problem::on_mesh(&cube, 3, f, near).unwrap();
        let y = solve(&problem, &Settings::of(Solver::Multigrid)).unwrap().y;
        for size in [0.0, 1e-9, 1e-5] {
            let y = disturbed(&y, size, &mut dice);
            let best = problem.bounds(&y).unwrap();
            for law in far_laws(near) {
                let found = problem.levels().bounds(law, &y).unwrap();
                // Which of two valid fluxes gives the lower end is a matter of rounding.
                let allowed = width(&best) * (1.0 + 1e-6);
                assert!(width(&found) <= allowed, "{law} {size}: {found:?} {best:?}");
                assert!(found.error[1] <= best.error[1] + 1e-9, "{law}: {found:?} {best:?}");
                assert!(overlap(&[found.energy, best.energy]), "{law}: {found:?} {best:?}");
            }
        }
    }
}

#[test]
fn the_energy_is_never_above_that_of_zero() {
    let f: Source = "quadrant(ll)=3; else=-1.25".parse().unwrap();
    let grid = Grid::new(16).unwrap();
    let disc = AnyMesh::built_in("disc").unwrap();
    let halves = "halfplane(1,0,0)=1; else=-1.3";
    let on_disc = Problem::on_mesh(&disc, 2, halves, Law::SIGNORINI).unwrap();
    let mut dice = Dice(11);
    for law in [Law::SIGNORINI, Law::friction(0.3).unwrap(), Law::limited(2.0).unwrap()] {
        for size in [1.0, 100.0] {
            let y: Vec<f64> = vec![size; grid.nodes()];
            let y = disturbed(&y, size, &mut dice);
            let [low, high] = bounds(grid, &f, law, &y).unwrap().energy;
            assert!(low < high && high <= 0.0, "{law} {size}: {low} {high}");
            let y = disturbed(&vec![size; on_disc.load().len()], size, &mut dice);
            let found = on_disc.levels().bounds(law, &y).unwrap();
            assert!(
                found.energy[0] < found.energy[1] && found.energy[1] <= 0.0,
                "{law}: {found:?}"
            );
        }
    }
}

#[test]
fn what_the_law_cannot_balance_has_no_bound() {
    let (grid, law) = (Grid::new(8).unwrap(), Law::friction(0.99).unwrap());
    let zero = vec![0.0; grid.nodes()];
    let found = bounds(grid, &Source::constant(4.0), law, &zero);
    let [least, most] = [-4.0 * 0.99, 4.0 * 0.99];
    let (enough, has_parts) = (Some(LawParameter::Friction(1.1)), false);
    let integral = 4.0;
    let refused =
        Unsolvable::Unbalanced { integral, component: None, least, most, enough, has_parts };
    assert_eq!(found, Err(refused.into()));
    let mut nan = zero.clone();
    for node in [0, 4, 40] {
        nan[node] = f64::NAN;
        let found = bounds(grid, &Source::constant(1.0), law, &nan);
        assert_eq!(found, Err(NoBound::NotFinite));
        nan[node] = 0.0;
    }
    let lshape = AnyMesh::built_in("lshape").unwrap();
    let wide = Law::friction(1e4).unwrap();
    let problem = Problem::on_mesh(&lshape, 1, "else=400", wide).unwrap();
    let found = problem.levels().bounds(law, &vec![0.0; problem.load().len()]);
    let is_refused = matches!(found, Err(NoBound::Unsolvable(Unsolvable::Unbalanced { .. })));
    assert!(is_refused, "{found:?}");
}

fn plane(name: &str) -> Mesh<2, 3> {
    let AnyMesh::Plane(mesh) = AnyMesh::built_in(name).unwrap() else { panic!("in space") };
    mesh
}

#[test]
fn brackets_of_nested_meshes_hold_one_energy_under_random_laws() {
    let mut dice = Dice(77);
    let mut with_both_signs = 0;
    for name in ["lshape", "lshape", "disc"] {
        let mut coarse = plane(name);
        coarse.parts_mut().iter_mut().for_each(|part| part.curve = None);
        let coarse = AnyMesh::Plane(coarse);
        for problem in 0..25 {
            let [left, right] = [0.0; 2].map(|_| dice.between(-6.0, 6.0));
            let f = format!("halfplane(1,0,0)={left}; else={right}");
            let on = |times, law| Problem::on_mesh(&coarse, times, &f, law).unwrap();
            let finest = on(3, Law::friction(1e4).unwrap());
            let integral = finest.levels().facts().integral;
            let perimeter = finest.networks().unwrap()[3].network.perimeter();
            let g = 1.01 * integral.abs() / perimeter + 0.02 + dice.between(0.0, 1.0).powi(2);
            let law = match problem % 4 {
                0 => Law::new(-g, 2.0 * g),
                1 => Law::new(-3.0 * g, g),
                _ => Law::friction(g),
            };
            let law = law.unwrap();
            let mut energies = Vec::new();
            for times in 1..=3 {
                let on_mesh = on(times, law);
                let Run { y, judgement, .. } =
                    solve(&on_mesh, &Settings::of(Solver::ActiveSet)).unwrap();
                let states = judgement.states;
                let both = [BoundaryState::SlipsUp, BoundaryState::SlipsDown];
                with_both_signs += usize::from(both.iter().all(|state| states.contains(state)));
                for size in [0.0, 1e-6, 1e-2, 1.0] {
                    let wrong = disturbed(&y, size, &mut dice);
                    let found = on_mesh.bounds(&wrong).unwrap();
                    let [low, high] = found.energy;
                    assert!(low <= high, "{name} {problem} {law}: {found:?}");
                    energies.push(found.energy);
                }
            }
            assert!(overlap(&energies), "{name} {problem} {law}: {energies:?}");
            let [first, last] = [0, 8].map(|k: usize| energies[k][1] - energies[k][0]);
            assert!(last < 0.5 * first, "{name} {problem} {law}: {energies:?}");
        }
    }
    assert!(with_both_signs > 10, "{with_both_signs}");
}
