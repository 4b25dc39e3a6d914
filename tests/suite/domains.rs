//! Multigrid on the square and on the cube: agreement with the direct method, claims, scaling, starts and refusals.

use crate::solvers::{BYTES, absurd_starts, assert_threads_do_not_matter, distance};
use crate::{cube, multigrid as square};
use signorini_mathematics::discrete::law_and_load::LawAndLoad;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::experiments::problems;
use signorini_mathematics::multigrid::active_set::active_set;
use signorini_mathematics::multigrid::cube::Cube;
use signorini_mathematics::multigrid::square::Square;
use signorini_mathematics::multigrid::{
    Goal, InputError, Multigrid, MultigridOutcome, MultigridParams, solve_cube, solve_square,
};
use signorini_mathematics::problem::law::Law;

/// Name of a problem, and its load.
type Named = (&'static str, Vec<f64>);
/// A solution and the outcome of multigrid.
type Solved = Result<(Vec<f64>, MultigridOutcome), InputError>;

/// A domain on which multigrid and the direct method run.
pub(crate) trait Domain {
    const DIMENSION: i32;
    /// Cells per side of the grids on which multigrid is compared with the direct method.
    const COMPARED: [usize; 5];
    /// Cells per side of the grid of the other tests.
    const CELLS_PER_SIDE: usize;
    /// Cells per side of a grid on which several threads have work.
    const FINE: usize;
    const BYTES_PER_NODE: f64;
    /// A problem with a formula for the solution, and with a part of the boundary that is not in contact.
    const FREE: &str;
    /// Numbers of cells per side that multigrid refuses.
    const REFUSED: &[usize];

    fn natural_residual(n: usize, y: &[f64], load: &[f64]) -> f64;
    fn exact_loads(n: usize) -> Vec<Named>;
    fn stress_loads(n: usize) -> Vec<Named>;

    fn solve(
        n: usize,
        problem: LawAndLoad<'_>,
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Solved;
    fn direct(n: usize, load: &[f64]) -> Result<Vec<f64>, InputError>;
    fn workspace(n: usize) -> Result<Multigrid, InputError>;

    fn nodes(n: usize) -> usize {
        (n + 1).pow(Self::DIMENSION.unsigned_abs())
    }

    /// The load of a problem with a formula for the solution.
    fn exact_load(n: usize, name: &str) -> Vec<f64> {
        let mut all = Self::exact_loads(n).into_iter();
        all.find(|(other, _)| *other == name).expect("a problem of this name").1
    }
}

impl Domain for Square {
    const DIMENSION: i32 = 2;
    const COMPARED: [usize; 5] = [4, 6, 16, 40, 64];
    const CELLS_PER_SIDE: usize = 64;
    const FINE: usize = 512;
    const BYTES_PER_NODE: f64 = BYTES[0];
    const FREE: &str = "free-corner";
    const REFUSED: &[usize] = &[0, 1, 9, 11];

    fn solve(
        n: usize,
        problem: LawAndLoad<'_>,
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Solved {
        solve_square(n, problem, start, params)
    }

    fn direct(n: usize, load: &[f64]) -> Result<Vec<f64>, InputError> {
        active_set::<Square>(n, Law::SIGNORINI, load).map(|(y, _)| y)
    }

    fn workspace(n: usize) -> Result<Multigrid, InputError> {
        Multigrid::square(n)
    }

    fn natural_residual(n: usize, y: &[f64], load: &[f64]) -> f64 {
        square::natural_residual(n, y, load)
    }

    fn exact_loads(n: usize) -> Vec<Named> {
        square::exact_loads(n)
    }

    fn stress_loads(n: usize) -> Vec<Named> {
        problems::stress_loads(n)
    }
}

impl Domain for Cube {
    const DIMENSION: i32 = 3;
    const COMPARED: [usize; 5] = [2, 4, 6, 8, 12];
    const CELLS_PER_SIDE: usize = 32;
    const FINE: usize = 64;
    const BYTES_PER_NODE: f64 = BYTES[1];
    const FREE: &str = "free-disc";
    const REFUSED: &[usize] = &[0, 1, 9, 10, 14];

    fn solve(
        n: usize,
        problem: LawAndLoad<'_>,
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Solved {
        solve_cube(n, problem, start, params)
    }

    fn direct(n: usize, load: &[f64]) -> Result<Vec<f64>, InputError> {
        active_set::<Cube>(n, Law::SIGNORINI, load).map(|(y, _)| y)
    }

    fn workspace(n: usize) -> Result<Multigrid, InputError> {
        Multigrid::cube(n)
    }

    fn natural_residual(n: usize, y: &[f64], load: &[f64]) -> f64 {
        cube::natural_residual(n, y, load)
    }

    fn exact_loads(n: usize) -> Vec<Named> {
        cube::exact_loads(n)
    }

    fn stress_loads(n: usize) -> Vec<Named> {
        crate::cube_loads::stress_loads(n)
    }
}

pub(crate) fn run<D: Domain>(n: usize, load: &[f64], goal: Goal) -> (Vec<f64>, MultigridOutcome) {
    let params = MultigridParams { goal, ..Default::default() };
    D::solve(n, Law::SIGNORINI.with_load(load), None, &params).expect("valid load")
}

/// Natural residual that rounding errors alone leave, in the units of the load.
pub(crate) fn rounding_level<D: Domain>(n: usize, y: &[f64]) -> f64 {
    32.0 * f64::EPSILON * largest(y) * (n as f64).powi(2 - D::DIMENSION)
}

/// By how much two ways to compute a residual differ, adding in another order.
pub(crate) fn slack<D: Domain>(n: usize, y: &[f64]) -> f64 {
    0.25 * rounding_level::<D>(n, y)
}

pub(crate) fn largest(y: &[f64]) -> f64 {
    y.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

fn multigrid_and_active_set_agree_to_rounding<D: Domain>() {
    for n in D::COMPARED {
        for (name, load) in D::exact_loads(n).into_iter().chain(D::stress_loads(n)) {
            let (y, outcome) = run::<D>(n, &load, Goal::RoundingFloor);
            let oracle = D::direct(n, &load).expect("valid load");
            assert_eq!(outcome.stop, Stop::RoundingFloor, "{name} {n} {outcome:?}");
            // Values are determined up to the conditioning of the contact set.
            let rounding = 500.0 * f64::EPSILON * largest(&oracle) * n as f64;
            let apart = distance(&y, &oracle);
            assert!(apart <= rounding, "{name} {n} {apart:e} {rounding:e}");
            for y in [&y, &oracle] {
                let level = rounding_level::<D>(n, y) + slack::<D>(n, y);
                let left = D::natural_residual(n, y, &load);
                assert!(left <= level, "{name} {n} {left:e} {level:e} {outcome:?}");
            }
        }
    }
}

fn a_claimed_tolerance_holds<D: Domain>() {
    let n = D::CELLS_PER_SIDE;
    for (name, load) in D::stress_loads(n) {
        for exponent in 2..20 {
            let tolerance = 10_f64.powi(-exponent);
            let (y, outcome) = run::<D>(n, &load, Goal::Kkt(tolerance));
            let claimed = match outcome.stop {
                Stop::Converged => tolerance,
                Stop::RoundingFloor => rounding_level::<D>(n, &y),
                stop => panic!("{name} {tolerance:e} {stop:?}"),
            };
            let measured = D::natural_residual(n, &y, &load);
            assert!(measured <= claimed + slack::<D>(n, &y), "{name} {measured:e} {outcome:?}");
        }
    }
}

fn solutions_scale_with_the_load<D: Domain>() {
    let n = D::CELLS_PER_SIDE / 2;
    let load = D::exact_load(n, D::FREE);
    for goal in [Goal::DiscretisationError, Goal::RoundingFloor] {
        let (y, plain) = run::<D>(n, &load, goal);
        // Squares of the largest and of the least overflow and underflow.
        for exponent in [-960, -500, -332, -40, 40, 332, 500, 1000] {
            let factor = 2_f64.powi(exponent);
            let scaled: Vec<_> = load.iter().map(|entry| entry * factor).collect();
            let (z, outcome) = run::<D>(n, &scaled, goal);
            assert_eq!((outcome.stop, outcome.cycles), (plain.stop, plain.cycles), "2^{exponent}");
            assert!(y.iter().zip(&z).all(|(y, z)| y * factor == *z), "2^{exponent}");
        }
    }
}

fn threads_do_not_change_a_bit<D: Domain>() {
    let load = D::exact_load(D::FINE, D::FREE);
    assert_threads_do_not_matter(|| run::<D>(D::FINE, &load, Goal::RoundingFloor).0);
}

fn absurd_starts_lead_to_the_same_solution<D: Domain>() {
    let (n, params) = (D::CELLS_PER_SIDE, MultigridParams::default());
    for (name, load) in D::exact_loads(n) {
        let (y, _) = run::<D>(n, &load, Goal::RoundingFloor);
        for (k, start) in absurd_starts(&y).iter().enumerate() {
            let (z, outcome) =
                D::solve(n, Law::SIGNORINI.with_load(&load), Some(start), &params).expect("valid");
            assert_eq!(outcome.stop, Stop::RoundingFloor, "{name} start {k} {outcome:?}");
            let rounding = 1e3 * f64::EPSILON * largest(&y);
            assert!(distance(&y, &z) < rounding, "{name} start {k} {}", distance(&y, &z));
        }
    }
}

fn impossible_input_is_refused<D: Domain>() {
    let (n, params) = (8, MultigridParams::default());
    let expected = D::nodes(n);
    let good = vec![-1.0; expected];
    let refusals = |n: usize, load: &[f64]| {
        let direct = D::direct(n, load).map(|_| ());
        [D::solve(n, Law::SIGNORINI.with_load(load), None, &params).map(|_| ()), direct]
    };
    for &wrong in D::REFUSED {
        let refusal =
            D::solve(wrong, Law::SIGNORINI.with_load(&vec![-1.0; D::nodes(wrong)]), None, &params)
                .map(|_| ());
        assert!(
            matches!(refusal, Err(InputError::GridSize { cells, .. }) if cells == wrong),
            "{wrong}"
        );
    }
    let short = Err(InputError::Length { found: expected - 1, expected });
    assert_eq!(refusals(n, &good[1..]), [short.clone(), short]);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut bad = good.clone();
        bad[40] = value;
        let not_finite = |what| Err(InputError::NotFinite(what));
        assert_eq!(refusals(n, &bad), [not_finite("load"), not_finite("load")]);
        let start = D::solve(n, Law::SIGNORINI.with_load(&good), Some(&bad), &params).map(|_| ());
        assert_eq!(start, not_finite("start"));
    }
    for value in [1.0, 0.0] {
        let sum = Err(InputError::NotCoercive(value * expected as f64));
        assert_eq!(refusals(n, &vec![value; expected]), [sum.clone(), sum]);
    }
    // The smallest negative sum there is must not drown in rounding errors.
    let mut barely = vec![1e16, -1e16, -1.0];
    barely.resize(expected, 0.0);
    assert_eq!(refusals(n, &barely), [Ok(()), Ok(())]);
}

fn the_workspace_stays_small_and_can_be_used_again<D: Domain>() {
    let n = D::FINE;
    let mut workspace = D::workspace(n).expect("valid size");
    let mut solve = |load: &[f64]| {
        workspace
            .solve(Law::SIGNORINI.with_load(load), None, &MultigridParams::default())
            .expect("valid load");
        let mut y = vec![0.0; load.len()];
        workspace.write_solution(&mut y);
        y
    };
    let load = D::exact_load(n, D::FREE);
    let first = solve(&load);
    solve(&D::exact_load(n, "full-contact"));
    assert!(first == solve(&load));
    let bytes = workspace.bytes() as f64 / D::nodes(n) as f64;
    assert!(bytes <= D::BYTES_PER_NODE, "{bytes}");
}

/// Makes a module with each test for a domain.
macro_rules! tests_on {
    ($module:ident, $domain:ty: $($test:ident)*) => {
        mod $module {
            $(#[test] fn $test() { super::$test::<$domain>() })*
        }
    };
    ($($test:ident)*) => {
        tests_on!(on_the_square, signorini_mathematics::multigrid::square::Square: $($test)*);
        tests_on!(on_the_cube, signorini_mathematics::multigrid::cube::Cube: $($test)*);
    };
}

tests_on! {
    multigrid_and_active_set_agree_to_rounding
    a_claimed_tolerance_holds
    solutions_scale_with_the_load
    threads_do_not_change_a_bit
    absurd_starts_lead_to_the_same_solution
    impossible_input_is_refused
    the_workspace_stays_small_and_can_be_used_again
}
