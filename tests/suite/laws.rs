//! Laws on the boundary besides the paper's: solvers that agree, symmetries to the last bit, and known energies.

use crate::common::{Dice, gmsh_file};
use crate::domains::CubeMesh;
use signorini_mathematics::discrete::end::{End, Stop};
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::nested::{DiscreteLevels, NestedNetwork};
use signorini_mathematics::discrete::network::Network;
use signorini_mathematics::mesh::gmsh::read;
use signorini_mathematics::mesh::{AnyMesh, refined};
use signorini_mathematics::multigrid::active_set::active_set;
use signorini_mathematics::multigrid::{InputError, MultigridParams};
use signorini_mathematics::multilevel::solve_nested_networks;
use signorini_mathematics::problem::law::{BoundaryState, Law, LawNumber};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::{Pair, Params, StopRule, solve, solve_nested};
use signorini_mathematics::solvers::Solved;
use signorini_mathematics::square::load::load;
use signorini_mathematics::square::multigrid::solve_square;
use signorini_mathematics::statement::{Boundary, Domain, Fineness, Statement};

/// Iterations of the paper's method for the problems with friction under the printed rule with r = 1e6 on 1/4 to 1/64,
/// as a program written apart from this one counts them.
const COUNTS: [[usize; 5]; 6] = [
    [1, 6, 44, 198, 882],
    [2, 10, 54, 223, 941],
    [1, 3, 25, 104, 652],
    [3, 11, 56, 219, 1007],
    [2, 13, 114, 604, 2623],
    [3, 11, 101, 659, 3508],
];

/// Problem with friction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrictionProblem {
    /// f in the notation of scenes.
    pub(crate) f: &'static str,
    /// Bound of |dv/dn|.
    pub(crate) g: f64,
}

/// Problems with friction. In the first three v has one sign, and so it has in the last two; in the fourth both. The
/// flux of the last one is nearly at its bound everywhere.
pub(crate) const FRICTION: [FrictionProblem; 6] = [
    FrictionProblem { f: "quadrant(ll)=3; else=-1.002", g: 0.3 },
    FrictionProblem { f: "quadrant(ll)=-6; else=1.998", g: 0.6 },
    FrictionProblem { f: "else=1", g: 0.3 },
    FrictionProblem { f: "halfplane(1,0,0)=8; else=-8", g: 1.0 },
    FrictionProblem { f: "rect(-0.5,0,-0.25,0.25)=6; else=-1", g: 0.25 },
    FrictionProblem { f: "else=4", g: 1.01 },
];

impl FrictionProblem {
    /// Returns f.
    pub(crate) fn source(self) -> Source {
        self.f.parse().expect("a valid f")
    }

    /// Returns the law.
    pub(crate) fn law(self) -> Law {
        Law::friction(self.g).expect("a positive bound")
    }
}

const BILINEAR: LoadRule = LoadRule::Bilinear {};

fn load_of(n: usize, f: &str) -> (Grid, Vec<f64>) {
    let grid = Grid::new(n).unwrap();
    (grid, load(grid, &f.parse::<Source>().unwrap(), BILINEAR))
}

/// Solution and end of multigrid on the square.
fn on_square(n: usize, law: Law, load: &[f64]) -> Result<(Vec<f64>, End), InputError> {
    solve_square(n, law, load, &MultigridParams::default())
}

/// Networks with one law at all contact nodes.
pub(crate) fn under(levels: &[NestedNetwork], law: Law) -> Vec<NestedNetwork> {
    let mut levels = levels.to_vec();
    for NestedNetwork { network, .. } in &mut levels {
        *network = network.with_laws(&vec![law; network.contact().len()]);
    }
    levels
}

/// Solution and end of multigrid on nested networks.
fn on_networks(
    levels: &[NestedNetwork],
    law: Law,
    load: &[f64],
) -> Result<(Vec<f64>, End), InputError> {
    solve_nested_networks(&under(levels, law), load, &MultigridParams::default())
}

fn negative(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| -value).collect()
}

/// Load and law at random: in most cases the mean of f nearly vanishes, so that v has both signs.
fn random_problem(network: &Network, dice: &mut Dice) -> (Law, Vec<f64>) {
    let nodes = network.nodes();
    let mut shape = vec![0.0; nodes];
    // Two waves over the numbers of the nodes, one of them cut off: smooth and with jumps.
    let [a, b, c] = [0, 1, 2].map(|_| dice.between(-1.0, 1.0));
    for (node, value) in shape.iter_mut().enumerate() {
        let t = node as f64 / nodes as f64;
        *value = 8.0 * a * (6.0 * (t + b)).sin() + if t < c.abs() { 4.0 * c } else { -1.0 };
    }
    let total: f64 = network.masses().iter().sum();
    let integral: f64 = shape.iter().zip(network.masses()).map(|(f, mass)| f * mass).sum();
    let kept = if dice.between(0.0, 1.0) < 0.7 { dice.between(-0.05, 0.05) } else { 1.0 };
    let mean = (1.0 - kept) * integral / total;
    let load: Vec<f64> =
        shape.iter().zip(network.masses()).map(|(f, mass)| (f - mean) * mass).collect();
    let sum: f64 = load.iter().sum();
    let perimeter = network.laws().measure;
    // Just above the least bound that can balance the load, up to one under which most nodes stick.
    let t = dice.between(0.0, 1.0);
    let g = 1.001 * sum.abs() / perimeter + 1e-3 + 2.0 * t * t;
    let law = if sum < 0.0 && dice.between(0.0, 1.0) < 0.2 {
        Law::limited(2.0 * g)
    } else {
        Law::friction(g)
    };
    (law.unwrap(), load)
}

/// Fails unless multigrid and the active set method agree on random problems, some with both signs.
fn compare(
    network: &Network,
    problems: usize,
    mut solve: impl FnMut(Law, &[f64]) -> Result<(Vec<f64>, End), InputError>,
) {
    let mut dice = Dice(network.nodes() as u64);
    let mut with_both_signs = 0;
    for problem in 0..problems {
        let (law, load) = random_problem(network, &mut dice);
        let (y, outcome) = solve(law, &load).unwrap();
        let network = &network.with_laws(&vec![law; network.contact().len()]);
        assert_eq!(outcome.stop, Stop::RoundingFloor, "{problem}: {law}");
        let (expected, _) = active_set(network, &load, None).unwrap();
        let judged = judge(network, &y, &load);
        let largest = expected.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let far = y.iter().zip(&expected).any(|(a, b)| (a - b).abs() > 1e-8 * largest);
        assert!(!far && judged.kkt.relative < 1e-8, "{problem}: {law} {:?}", judged.kkt);
        let has = |state| judged.states.contains(&state);
        let both = has(BoundaryState::SlipsUp) && has(BoundaryState::SlipsDown);
        with_both_signs += usize::from(both);
    }
    assert!(with_both_signs * 8 > problems, "{with_both_signs} of {problems} have both signs");
}

#[test]
fn multigrid_and_the_active_set_agree_on_random_laws() {
    for (n, problems) in [(16, 1500), (32, 1000)] {
        let network = Network::of_square(Grid::new(n).unwrap(), Law::SIGNORINI);
        compare(&network, problems, |law, load| on_square(n, law, load));
    }
}

#[test]
fn so_they_do_on_meshes() {
    for name in ["disc", "lshape", "annulus"] {
        let AnyMesh::Plane(mesh) = AnyMesh::built_in(name).unwrap() else { panic!("in space") };
        let (levels, _) = refined(&mesh, 3).unwrap();
        compare(&levels[3].network, 700, |law, load| on_networks(&levels, law, load));
    }
    let cube = CubeMesh::new(1, 3);
    compare(cube.network(), 500, |law, load| on_networks(&cube.levels, law, load));
}

#[test]
fn energies_with_friction_are_those_of_the_true_solutions() {
    // By a spectral method in quadruple precision, written apart from this program.
    for (at, expected) in [(0, -0.024_787_188_375_613_3), (3, -0.627_952_316_469_321_7)] {
        let problem = FRICTION[at];
        let law = problem.law();
        let energy = |n: usize| {
            let (grid, load) = load_of(n, problem.f);
            let (y, _) = on_square(n, law, &load).unwrap();
            judge((grid, law), &y, &load).energy
        };
        // The error falls by four with each halving of h.
        let [coarse, fine] = [512, 1024].map(energy);
        let extrapolated = fine + (fine - coarse) / 3.0;
        assert!((extrapolated - expected).abs() < 1e-8, "{problem:?}: {extrapolated}");
    }
}

/// The integral of f over the cell of width h around each node, inside the square, for f with jumps on lines of the
/// grid.
fn averaged(grid: Grid, f: &Source) -> Vec<f64> {
    let (quarter, side) = (0.25 * grid.h(), grid.side());
    let mut load = vec![0.0; grid.nodes()];
    for (node, entry) in load.iter_mut().enumerate() {
        let [x, y] = [node % side, node / side].map(|place| grid.coordinate(place));
        for [across, up] in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            let point = [x + across * quarter, y + up * quarter];
            if point.iter().all(|place| place.abs() < 0.5) {
                *entry += 4.0 * quarter * quarter * f.at(point);
            }
        }
    }
    load
}

#[test]
fn the_papers_method_with_friction_has_the_counts_of_another_program() {
    let grids = nested(&[4, 8, 16, 32, 64]).unwrap();
    for (problem, expected) in FRICTION.into_iter().zip(COUNTS) {
        let f = problem.source();
        let loads: Vec<_> = grids.iter().map(|&grid| averaged(grid, &f)).collect();
        let params = Params { r: 1e6, rule: StopRule::Printed, ..Params::default() };
        let (outcomes, _) =
            solve_nested(DiscreteLevels::Grids(&grids, problem.law()), &loads, &params, &mut ());
        let counts: Vec<_> = outcomes.iter().map(|outcome| outcome.end.iterations).collect();
        assert_eq!(counts, expected, "{problem:?}");
    }
}

#[test]
fn minus_f_with_friction_gives_minus_v_to_the_last_bit() {
    for problem in FRICTION {
        let law = problem.law();
        let (grid, load) = load_of(32, problem.f);
        let opposite = negative(&load);
        let [(y, _), (minus, _)] = [&load, &opposite].map(|load| on_square(32, law, load).unwrap());
        assert!(negative(&y) == minus, "{problem:?}: multigrid");
        let network = &Network::of_square(grid, law);
        let [(y, _), (minus, _)] =
            [&load, &opposite].map(|load| active_set(network, load, None).unwrap());
        assert!(negative(&y) == minus, "{problem:?}: active set");
        let params = Params { rule: StopRule::Printed, tolerance: 1e-3, ..Params::default() };
        let [(pair, run), (minus, other)] = [&load, &opposite].map(|load| {
            let mut pair = Pair::zero((grid, Law::SIGNORINI));
            let run = solve((grid, law), load, &params, &mut pair);
            (pair, run)
        });
        assert!((negative(&pair.y), negative(&pair.a)) == (minus.y, minus.a), "{problem:?}");
        assert_eq!(run.end.sweeps(), other.end.sweeps(), "{problem:?}");
    }
}

#[test]
fn a_limit_that_no_reaction_reaches_gives_the_bits_of_the_papers_law() {
    for f in ["quadrant(ll)=-6; else=1.998", "disc(0.1,0.2,0.2)=5; else=-2"] {
        let (grid, load) = load_of(32, f);
        let (y, _) = on_square(32, Law::SIGNORINI, &load).unwrap();
        let judged = judge((grid, Law::SIGNORINI), &y, &load);
        let most = judged.flux.iter().fold(0.0f64, |most, flux| most.max(*flux)) / grid.h();
        let limited = Law::limited(1.0001 * most).unwrap();
        assert!(y == on_square(32, limited, &load).unwrap().0, "{f}");
        let [(y, _), (z, _)] = [Law::SIGNORINI, limited]
            .map(|law| active_set(&Network::of_square(grid, law), &load, None).unwrap());
        assert!(y == z, "{f}");
        // A limit below the largest reaction is felt.
        let felt = Law::limited(0.7 * most).unwrap();
        assert!(y != on_square(32, felt, &load).unwrap().0, "{f}");
    }
}

#[test]
fn friction_where_v_has_one_sign_is_the_papers_problem_with_another_load() {
    for problem in [0, 2, 4, 5].map(|at| FRICTION[at]) {
        let (grid, load) = load_of(32, problem.f);
        let law = problem.law();
        let (y, _) = on_square(32, law, &load).unwrap();
        let mut less = load.clone();
        grid.boundary().for_each(|node| less[node] -= grid.h() * problem.g);
        let (z, _) = on_square(32, Law::SIGNORINI, &less).unwrap();
        assert!(y == z, "{problem:?}");
        assert!(grid.boundary().all(|node| y[node] >= 0.0), "{problem:?}");
    }
}

#[test]
fn components_may_slip_in_opposite_directions() {
    // Two squares that do not touch.
    let file = gmsh_file(
        "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 2 0 0\n6 3 0 0\n7 3 1 0\n8 2 1 0",
        "1 2 2 1 1 1 2 3\n2 2 2 1 1 1 3 4\n3 2 2 2 2 5 6 7\n4 2 2 2 2 5 7 8",
    );
    let AnyMesh::Plane(mesh) = read(file.as_bytes()).unwrap() else { panic!("in space") };
    let (levels, mesh) = refined(&mesh.with_law(Law::friction(0.2).unwrap()), 4).unwrap();
    let network = &levels[4].network;
    // Positive near one corner, negative elsewhere; on the right square the negative of it.
    let mut load = vec![0.0; network.nodes()];
    for (node, [x, y]) in mesh.points().iter().enumerate() {
        let [sign, x] = if *x < 1.5 { [1.0, *x] } else { [-1.0, x - 2.0] };
        load[node] = sign * network.masses()[node] * if x + y < 0.8 { 3.0 } else { -0.6 };
    }
    let (y, outcome) = solve_nested_networks(&levels, &load, &MultigridParams::default()).unwrap();
    assert_eq!(outcome.stop, Stop::RoundingFloor);
    let (expected, _) = active_set(network, &load, None).unwrap();
    let mut left = 0.0f64;
    for (node, [x, y_at]) in mesh.points().iter().enumerate() {
        assert!((y[node] - expected[node]).abs() < 1e-10, "{} {}", y[node], expected[node]);
        if *x < 1.5 {
            let opposite = [x + 2.0, *y_at];
            let other = mesh.points().iter().position(|point| *point == opposite).unwrap();
            assert!((y[node] + y[other]).abs() < 1e-10, "{} {}", y[node], y[other]);
            left = left.max(y[node]);
        }
    }
    assert!(left > 0.01, "{left}");
    assert!(judge(network, &y, &load).kkt.relative < 1e-9);
}

/// Solution on the square with laws on its boundary.
fn under_laws(laws: &[(&str, LawNumber, f64)]) -> Solved {
    let with =
        |all: Boundary, (part, of, number): &(&str, LawNumber, f64)| all.with(part, *of, *number);
    let boundary = laws.iter().fold(Boundary::default(), with);
    let usual = Statement::usual(Domain::square(), "disc(0.1,0,0.2)=3; else=-1");
    Statement { boundary, fineness: Fineness::Width(16), ..usual }.solved(None).unwrap()
}

#[test]
fn a_gap_on_all_of_the_square_adds_it_to_v() {
    let gap = 0.3;
    let grids = under_laws(&[]);
    // Sides with names have a mesh.
    let sides = ["left", "right", "bottom", "top"].map(|side| (side, LawNumber::Gap, 0.0));
    let [at_zero, above] = [under_laws(&sides), under_laws(&[("", LawNumber::Gap, gap)])];
    assert!(grids.problem.lattices().is_some() && at_zero.problem.lattices().is_none());
    let shift = gap * at_zero.integral();
    assert!((above.energy() - at_zero.energy() + shift).abs() < 1e-12, "{}", above.energy());
    assert!((at_zero.energy() - grids.energy()).abs() < 1e-3 * grids.energy().abs());
    for (above, y) in above.pair().y.iter().zip(at_zero.pair().y) {
        assert!((above - y - gap).abs() < 1e-11, "{above} {y}");
    }
}

#[test]
fn fluxes_through_all_parts_balance_f() {
    let laws = [
        ("top", LawNumber::Fixed, 1.0),
        ("left", LawNumber::Free, -0.5),
        ("bottom", LawNumber::Friction, 0.3),
        ("", LawNumber::Gap, 0.2),
    ];
    let solved = under_laws(&laws);
    let run = solved.run().unwrap();
    let parts = solved.problem.on_parts(&run.y, &run.judgement);
    let sum: f64 = parts.iter().map(|part| part.force).sum();
    // The flux through free parts is in the integral, and in the sum.
    let integral = solved.problem.levels().facts().integral;
    assert!((sum + integral).abs() < 1e-3, "{sum} {integral} {parts:?}");
    let of = |name: &str| parts.iter().find(|part| part.name == name).unwrap();
    assert!((of("left").force + 0.5).abs() < 1e-12 && of("top").force > 0.5, "{parts:?}");
    // v is below the value everywhere, at the fixed end too.
    let drained = under_laws(&[
        ("top", LawNumber::Below, 9.0),
        ("top", LawNumber::Flux, 0.2),
        ("right", LawNumber::Fixed, 0.0),
        ("left", LawNumber::Free, 0.0),
        ("bottom", LawNumber::Free, 0.0),
    ]);
    let run = drained.run().unwrap();
    let parts = drained.problem.on_parts(&run.y, &run.judgement);
    let top = parts.iter().find(|part| part.name == "top").unwrap();
    assert!((top.force - 0.2).abs() < 1e-12, "{parts:?}");
    assert_eq!(of("bottom").states.all(), 17);
    assert_eq!(of("top").states.all(), 0);
}
