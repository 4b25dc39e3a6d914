//! Guaranteed bounds under laws besides the paper's: known energies, disturbed vectors, symmetries, and meshes.

use crate::common::{Dice, Project, TABLE, bracket, gmsh_file};
use crate::laws::{FRICTION, FrictionProblem};
use signorini_mathematics::bounds::{Bounds, NoBound};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::levels::{Problem, ProblemError};
use signorini_mathematics::mesh::{AnyMesh, uniform_cube};
use signorini_mathematics::multigrid::{Goal, MultigridParams};
use signorini_mathematics::problem::law::{Law, LawNumber};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::problem::unsolvable::Unsolvable;
use signorini_mathematics::solvers::{Settings, Solver, solve};
use signorini_mathematics::square::bounds::bounds;
use signorini_mathematics::square::load::load;
use signorini_mathematics::square::multigrid::solve_square;

/// Largest width of the bracket at 1/256 for each problem with friction.
const WIDTHS: [f64; 6] = [2e-8, 8e-8, 2e-9, 3e-7, 2e-8, 2e-6];

fn solved(n: usize, f: &Source, law: Law, goal: Goal) -> (Grid, Vec<f64>) {
    let grid = Grid::new(n).unwrap();
    let params = MultigridParams { goal, ..MultigridParams::default() };
    let load = load(grid, f, LoadRule::Bilinear {});
    (grid, solve_square(n, law, &load, &params).unwrap().0)
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
        let problem = Problem::on_mesh(&cube.clone().with_law(near), 3, f).unwrap();
        let y = solve(&problem, &Settings::of(Solver::Multigrid)).unwrap().y;
        for size in [0.0, 1e-9, 1e-5] {
            let y = disturbed(&y, size, &mut dice);
            let best = problem.bounds(&y).unwrap();
            for law in far_laws(near) {
                let far = Problem::on_mesh(&cube.clone().with_law(law), 3, f).unwrap();
                let found = far.bounds(&y).unwrap();
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
fn what_the_law_cannot_balance_has_no_bound() {
    let (grid, law) = (Grid::new(8).unwrap(), Law::friction(0.99).unwrap());
    let zero = vec![0.0; grid.nodes()];
    let found = bounds(grid, &Source::constant(4.0), law, &zero);
    let [least, most] = [-4.0 * 0.99, 4.0 * 0.99];
    let (enough, has_parts) = (Some((LawNumber::Friction, 1.1)), false);
    let (component, integral, balanced) = (None, 4.0, [least, most]);
    let has_fluxes = false;
    let refused = Unsolvable { component, integral, balanced, enough, has_parts, has_fluxes };
    assert_eq!(found, Err(refused.into()));
    let mut nan = zero.clone();
    for node in [0, 4, 40] {
        nan[node] = f64::NAN;
        let found = bounds(grid, &Source::constant(1.0), law, &nan);
        assert_eq!(found, Err(NoBound::NotFinite));
        nan[node] = 0.0;
    }
    let lshape = AnyMesh::built_in("lshape").unwrap();
    let found = Problem::on_mesh(&lshape.with_law(law), 1, "else=400").err();
    assert!(matches!(found, Some(ProblemError::Unsolvable(_))), "{found:?}");
}

/// Rectangle of two squares with this side, the first from here to the right; its parts are called 1 to 4, from the
/// bottom on anticlockwise.
fn two_squares(from: f64, side: f64) -> String {
    let points = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [2, 1]];
    let nodes = (1..).zip(points.map(|point| point.map(|x| side * f64::from(x))));
    let nodes: Vec<_> = nodes.map(|(k, [x, y])| format!("{k} {} {y} 0", x + from)).collect();
    let cells = [[1, 2, 3], [1, 3, 4], [2, 5, 6], [2, 6, 3]]
        .map(|[a, b, c]| format!("2 2 9 9 {a} {b} {c}"));
    let sides = [[1, 1, 2], [1, 2, 5], [2, 5, 6], [3, 6, 3], [3, 3, 4], [4, 4, 1]];
    let sides = sides.map(|[part, a, b]| format!("1 2 {part} {part} {a} {b}"));
    let elements: Vec<_> =
        (1..).zip(cells.iter().chain(&sides)).map(|(k, line)| format!("{k} {line}")).collect();
    gmsh_file(&nodes.join("\n"), &elements.join("\n"))
}

#[test]
fn brackets_of_gaps_and_values_by_formulas_hold_known_energies_and_shrink() {
    let project = Project::with(TABLE);
    project.write("membrane.msh", two_squares(0.0, 0.5));
    project.write("power.msh", two_squares(-1.0, 1.0));
    let power = "(x^2+y^2)^0.75*cos(1.5*atan2(y,x))";
    let fixed = format!("--fixed '2={power}' --fixed '3={power}' --fixed '4={power}'");
    for (problem, energy) in [
        // Of two series, to twelve digits.
        (
            "--domain membrane.msh --f else=-1 --free 2 --free 4 --fixed 3=1 --gap '1=0.2+0.45*(1-cos(pi*x))'",
            0.494_429_697_794_469,
        ),
        // v is the real part of z^1.5.
        (&*format!("--domain power.msh --f else=0 {fixed}"), 1.721_690_362_044_479),
    ] {
        let widths = [2, 3, 4, 5].map(|times| {
            let answer = project.answer(&format!("{problem} --refine {times}"));
            let [low, high] = bracket(&answer);
            assert!(low <= energy && energy <= high, "{problem} {times}: {low} {high}");
            assert_eq!(answer["bound"]["reserve"][0], "quadrature");
            high - low
        });
        let shrinks = widths.windows(2).all(|pair| pair[1] < pair[0] / 3.2);
        assert!(shrinks, "{problem}: {widths:?}");
    }
}
