//! Solvers of optimal cost, multigrid on the square and multilevel iteration on the mesh of the cube: agreement with
//! the direct method, claims, scaling and refusals.

use crate::common::config;
use crate::hard_loads::{self, nodal_load, with_deficit};
use crate::multigrid::{exact_loads, natural_residual};
use crate::solvers::{assert_threads_do_not_matter, distance};
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::TestCaseError;
use signorini_mathematics::discrete::end::{End, Stop};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::nested::NestedNetwork;
use signorini_mathematics::discrete::network::Network;
use signorini_mathematics::mesh::{SpaceMesh, mesh_load, refined, uniform_cube};
use signorini_mathematics::multigrid::active_set::active_set;
use signorini_mathematics::multigrid::{Goal, InputError, MultigridParams};
use signorini_mathematics::multilevel::solve_nested_networks;
use signorini_mathematics::problem::exact::CubeExact;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::problem::unsolvable::Unsolvable;
use signorini_mathematics::square::multigrid::solve_square;
use std::f64::consts::TAU;

/// Name of a problem, and its load.
type Named = (&'static str, Vec<f64>);
/// A solution and the outcome of the solver.
type Solved = Result<(Vec<f64>, End), InputError>;

/// A discrete domain on which a solver of optimal cost and the direct method run.
pub(crate) trait Domain: Sync {
    fn nodes(&self) -> usize;
    /// Natural residual that rounding errors alone leave, in the units of the load.
    fn rounding_level(&self, y: &[f64]) -> f64;
    fn natural_residual(&self, y: &[f64], load: &[f64]) -> f64;
    /// Loads of the problems with a formula for the solution; the last one has a part of the boundary that is not in
    /// contact.
    fn exact_loads(&self) -> Vec<Named>;
    fn stress_loads(&self) -> Vec<Named>;
    fn solve(&self, load: &[f64], params: &MultigridParams) -> Solved;
    fn direct(&self, load: &[f64]) -> Result<Vec<f64>, InputError>;
}

/// The square with so many cells per side.
pub(crate) struct SquareGrid(pub usize);

impl Domain for SquareGrid {
    fn nodes(&self) -> usize {
        (self.0 + 1).pow(2)
    }

    fn rounding_level(&self, y: &[f64]) -> f64 {
        32.0 * f64::EPSILON * largest(y)
    }

    fn natural_residual(&self, y: &[f64], load: &[f64]) -> f64 {
        natural_residual(self.0, y, load)
    }

    fn exact_loads(&self) -> Vec<Named> {
        exact_loads(self.0)
    }

    fn stress_loads(&self) -> Vec<Named> {
        hard_loads::stress_loads(self.0)
    }

    fn solve(&self, load: &[f64], params: &MultigridParams) -> Solved {
        solve_square(self.0, Law::SIGNORINI, load, params)
    }

    fn direct(&self, load: &[f64]) -> Result<Vec<f64>, InputError> {
        let network = Network::of_square(Grid::new(self.0).expect("fine enough"), Law::SIGNORINI);
        active_set(&network, load, None).map(|(y, _)| y)
    }
}

/// The mesh of the cube and its refinements.
pub(crate) struct CubeMesh {
    pub(crate) levels: Vec<NestedNetwork>,
    pub(crate) mesh: SpaceMesh,
}

impl CubeMesh {
    /// The mesh with so many cells per side, refined some times.
    pub(crate) fn new(coarsest: usize, times: usize) -> Self {
        let (levels, mesh) = refined(&uniform_cube(coarsest), times).expect("a small mesh");
        Self { levels, mesh }
    }

    pub(crate) fn network(&self) -> &Network {
        &self.levels[self.levels.len() - 1].network
    }

    pub(crate) fn cells_per_side(&self) -> usize {
        (self.mesh.points().len() as f64).cbrt().round() as usize - 1
    }

    /// Integrals of f times the hat functions.
    pub(crate) fn load(&self, f: &Source<3>) -> Vec<f64> {
        mesh_load(&self.mesh, f).expect("a finite f").load
    }

    /// Nodal load of `f` with this deficit; without one as it is.
    pub(crate) fn nodal_load(&self, deficit: Option<f64>, f: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
        let ones = self.network().masses();
        let load = self.mesh.points().iter().zip(ones).map(|(&point, mass)| mass * f(point));
        match deficit {
            Some(deficit) => with_deficit(load.collect(), ones, deficit),
            None => load.collect(),
        }
    }
}

impl Domain for CubeMesh {
    fn nodes(&self) -> usize {
        self.mesh.points().len()
    }

    fn rounding_level(&self, y: &[f64]) -> f64 {
        let terms = y.iter().zip(self.network().diagonal()).map(|(y, diagonal)| y * diagonal);
        32.0 * f64::EPSILON * largest(&terms.collect::<Vec<_>>())
    }

    fn natural_residual(&self, y: &[f64], load: &[f64]) -> f64 {
        judge(self.network(), y, load).kkt.natural
    }

    fn exact_loads(&self) -> Vec<Named> {
        let load = |problem: CubeExact| self.nodal_load(None, |point| problem.at(point).f);
        CubeExact::ALL.map(|problem| (problem.name(), load(problem))).into()
    }

    /// Contact all over, on one face, on a disc, around a free ball, and at ever fewer nodes: on faces, edges
    /// and corners, at last at one corner.
    fn stress_loads(&self) -> Vec<Named> {
        let waves = |[x, y, z]: [f64; 3]| {
            (TAU * x).sin() + 0.7 * (3.0 * y + 1.0).cos() + 0.6 * (4.0 * z - 0.5).sin()
        };
        let chess = |[x, y, z]: [f64; 3]| (TAU * x).cos() * (TAU * y).cos() * (TAU * z).cos();
        let octant = |[x, y, z]: [f64; 3]| {
            if x <= 0.0 && y <= 0.0 && z <= 0.0 { 1.0 } else { -1.0 / 7.0 }
        };
        let slab = |[_, _, z]: [f64; 3]| if z <= 0.2 { -1.0 } else { 1.1 };
        let ball = |[x, y, z]: [f64; 3]| if x * x + y * y + z * z <= 0.09 { 5.0 } else { -1.0 };
        let width = 1.5 / self.cells_per_side() as f64;
        let spike = |[x, y, z]: [f64; 3]| {
            if (x * x + (y - 0.2).powi(2) + z * z).sqrt() < width { 1e4 } else { -1.0 }
        };
        let stripes = |[x, y, z]: [f64; 3]| (20.0 * (x + 0.7 * y)).sin() + 0.1 * z;
        let noise = |[x, y, z]: [f64; 3]| {
            ((x * 517.3 + y * 917.7 + z * 311.9).sin() * 4317.5).rem_euclid(1.0) - 0.5
        };
        let jumps = |[x, y, z]: [f64; 3]| match (x <= 0.0, y <= 0.0, z <= 0.0) {
            (true, true, _) => -1e6,
            (true, false, true) => 3e5,
            _ => 1.0,
        };
        vec![
            ("slab", self.nodal_load(None, slab)),
            ("ball", self.nodal_load(None, ball)),
            ("waves 1e-1", self.nodal_load(Some(1e-1), waves)),
            ("waves 1e-3", self.nodal_load(Some(1e-3), waves)),
            ("waves 1e-6", self.nodal_load(Some(1e-6), waves)),
            ("waves 1e-12", self.nodal_load(Some(1e-12), waves)),
            ("chess 1e-2", self.nodal_load(Some(1e-2), chess)),
            ("chess 1e-5", self.nodal_load(Some(1e-5), chess)),
            ("chess 1e-10", self.nodal_load(Some(1e-10), chess)),
            ("octant 1e-1", self.nodal_load(Some(1e-1), octant)),
            ("octant 1e-4", self.nodal_load(Some(1e-4), octant)),
            ("octant 1e-8", self.nodal_load(Some(1e-8), octant)),
            ("stripes 1e-2", self.nodal_load(Some(1e-2), stripes)),
            ("stripes 1e-4", self.nodal_load(Some(1e-4), stripes)),
            ("noise 1e-1", self.nodal_load(Some(1e-1), noise)),
            ("noise 1e-4", self.nodal_load(Some(1e-4), noise)),
            ("spike", self.nodal_load(Some(1e-2), spike)),
            ("jumps", self.nodal_load(None, jumps)),
        ]
    }

    fn solve(&self, load: &[f64], params: &MultigridParams) -> Solved {
        solve_nested_networks(&self.levels, load, params)
    }

    fn direct(&self, load: &[f64]) -> Result<Vec<f64>, InputError> {
        active_set(self.network(), load, None).map(|(y, _)| y)
    }
}

pub(crate) fn run(domain: &impl Domain, load: &[f64], goal: Goal) -> (Vec<f64>, End) {
    let params = MultigridParams { goal, ..Default::default() };
    domain.solve(load, &params).expect("valid load")
}

pub(crate) fn largest(y: &[f64]) -> f64 {
    y.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

fn free_load(domain: &impl Domain) -> Vec<f64> {
    domain.exact_loads().pop().expect("problems").1
}

fn agree_to_rounding(domain: &impl Domain, cells: usize) {
    for (name, load) in domain.exact_loads().into_iter().chain(domain.stress_loads()) {
        let (y, outcome) = run(domain, &load, Goal::RoundingFloor);
        let oracle = domain.direct(&load).expect("valid load");
        assert_eq!(outcome.stop, Stop::RoundingFloor, "{name} {cells} {outcome:?}");
        // Values are determined up to the conditioning of the contact set.
        let rounding = 500.0 * f64::EPSILON * largest(&oracle) * cells as f64;
        let apart = distance(&y, &oracle);
        assert!(apart <= rounding, "{name} {cells} {apart:e} {rounding:e}");
        for y in [&y, &oracle] {
            // A residual computed by adding in another order differs by a quarter of the level at most.
            let level = 1.25 * domain.rounding_level(y);
            let left = domain.natural_residual(y, &load);
            assert!(left <= level, "{name} {cells} {left:e} {level:e} {outcome:?}");
        }
    }
}

#[test]
fn optimal_and_direct_solvers_agree_to_rounding() {
    for n in [4, 6, 16, 40, 64] {
        agree_to_rounding(&SquareGrid(n), n);
    }
    for (coarsest, times) in [(1, 1), (1, 2), (3, 1), (1, 3)] {
        agree_to_rounding(&CubeMesh::new(coarsest, times), coarsest << times);
    }
}

fn claimed_tolerances_hold(domain: &impl Domain) {
    for (name, load) in domain.stress_loads() {
        for exponent in 2..20 {
            let tolerance = 10_f64.powi(-exponent);
            let (y, outcome) = run(domain, &load, Goal::Kkt(tolerance));
            let level = domain.rounding_level(&y);
            let claimed = match outcome.stop {
                Stop::Converged => tolerance,
                Stop::RoundingFloor => level,
                stop => panic!("{name} {tolerance:e} {stop:?}"),
            };
            let measured = domain.natural_residual(&y, &load);
            assert!(
                measured <= claimed + 0.25 * level,
                "{name} {measured:e} {level:e} {outcome:?}"
            );
        }
    }
}

#[test]
fn a_claimed_tolerance_holds() {
    claimed_tolerances_hold(&SquareGrid(64));
    claimed_tolerances_hold(&CubeMesh::new(1, 3));
}

fn scale_with_the_load(domain: &impl Domain) {
    let load = free_load(domain);
    for goal in [Goal::DiscretisationError, Goal::RoundingFloor] {
        let (y, plain) = run(domain, &load, goal);
        // Squares of the largest and of the least overflow and underflow.
        for exponent in [-960, -500, -332, -40, 40, 332, 500, 1000] {
            let factor = 2_f64.powi(exponent);
            let scaled: Vec<_> = load.iter().map(|entry| entry * factor).collect();
            let (z, outcome) = run(domain, &scaled, goal);
            assert_eq!(
                (outcome.stop, outcome.iterations),
                (plain.stop, plain.iterations),
                "2^{exponent}"
            );
            assert!(y.iter().zip(&z).all(|(y, z)| y * factor == *z), "2^{exponent}");
        }
    }
}

#[test]
fn solutions_scale_with_the_load() {
    scale_with_the_load(&SquareGrid(32));
    scale_with_the_load(&CubeMesh::new(1, 3));
}

#[test]
fn threads_do_not_change_a_bit() {
    let (square, cube) = (SquareGrid(512), CubeMesh::new(1, 5));
    let [on_square, on_cube] = [free_load(&square), free_load(&cube)];
    assert_threads_do_not_matter(|| run(&square, &on_square, Goal::RoundingFloor).0);
    assert_threads_do_not_matter(|| run(&cube, &on_cube, Goal::RoundingFloor).0);
}

fn refuses_impossible_loads(domain: &impl Domain) {
    let expected = domain.nodes();
    let good = vec![-1.0; expected];
    let refusals = |load: &[f64]| {
        let solved = domain.solve(load, &MultigridParams::default()).map(|_| ());
        [solved, domain.direct(load).map(|_| ())]
    };
    let short = Err(InputError::Length { found: expected - 1, expected });
    assert_eq!(refusals(&good[1..]), [short.clone(), short]);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut bad = good.clone();
        bad[40] = value;
        let not_finite = Err(InputError::NotFinite);
        assert_eq!(refusals(&bad), [not_finite.clone(), not_finite]);
    }
    for value in [1.0, 0.0] {
        for refusal in refusals(&vec![value; expected]) {
            let Err(InputError::Unsolvable(Unsolvable { integral, .. })) = refusal else {
                panic!("{refusal:?}")
            };
            assert_eq!(integral, value * expected as f64);
        }
    }
    // The smallest negative sum there is must not drown in rounding errors.
    let mut barely = vec![1e16, -1e16, -1.0];
    barely.resize(expected, 0.0);
    assert_eq!(refusals(&barely), [Ok(()), Ok(())]);
}

#[test]
fn impossible_loads_are_refused() {
    refuses_impossible_loads(&SquareGrid(8));
    refuses_impossible_loads(&CubeMesh::new(1, 3));
}

/// Waves of these amplitudes and noise at a point.
pub(crate) fn rough(amplitudes: &[f64], roughness: f64, [x, y, z]: [f64; 3]) -> f64 {
    let wave = |(k, a): (usize, &f64)| {
        let (x, y) = ((k / 4 + 1) as f64 * 2.0 * x + k as f64, (k % 4) as f64 * 2.5 * y);
        a * x.sin() * (y + 0.3).cos() * (2.0 * z + k as f64).cos()
    };
    let smooth: f64 = amplitudes.iter().enumerate().map(wave).sum();
    smooth + roughness * ((x * 517.3 + y * 917.7 + z * 311.9).sin() * 4317.5).fract()
}

/// Multigrid ends at the rounding floor, as near to the direct method as this multiple of it.
fn is_solved(domain: &impl Domain, load: &[f64], multiple: f64) -> Result<(), TestCaseError> {
    let (y, outcome) = run(domain, load, Goal::RoundingFloor);
    prop_assert_eq!(outcome.stop, Stop::RoundingFloor);
    let oracle = domain.direct(load).expect("valid");
    // Twice what the solver asks for: the check adds in another order.
    let level = 2.0 * domain.rounding_level(&oracle);
    prop_assert!(domain.natural_residual(&y, load) <= level, "{outcome:?}");
    prop_assert!(domain.natural_residual(&oracle, load) <= level);
    let apart = distance(&y, &oracle);
    prop_assert!(apart <= multiple * level, "{}", apart / level);
    Ok(())
}

proptest! {
    #![proptest_config(config(56))]

    /// Random loads, from smooth to rough, with any negative sum.
    #[test]
    fn random_problems_are_solved(
        (log_n, odd) in (1_u32..6, select(vec![1_usize, 3])),
        (coarsest, times) in select(vec![(1, 1), (1, 2), (3, 1), (1, 3)]),
        amplitudes in prop::collection::vec(-1.0..1.0_f64, 12),
        roughness in 0.0..1.0_f64,
        deficit_exponent in -8.0..-0.3_f64,
    ) {
        let (n, deficit) = (odd << log_n, Some(10_f64.powf(deficit_exponent)));
        let f = |point| rough(&amplitudes, roughness, point);
        is_solved(&SquareGrid(n), &nodal_load(n, deficit, |x, y| f([x, y, 0.0])), 1e4)?;
        let cube = CubeMesh::new(coarsest, times);
        is_solved(&cube, &cube.nodal_load(deficit, f), 1e6)?;
    }
}
