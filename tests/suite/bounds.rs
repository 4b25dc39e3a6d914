//! The guaranteed bounds: brackets of reference energies, effectivity, and answers that are wrong.

use crate::common::{Dice, random_source};
use crate::reference::REFERENCES;
use rayon::prelude::*;
use signorini_mathematics::bounds::{Bounds, NoBound};
use signorini_mathematics::discrete::contact::ContactArc;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{arcs, square_boundary};
use signorini_mathematics::multigrid::{Goal, MultigridParams};
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::problem::unsolvable::Unsolvable;
use signorini_mathematics::saddle::{Pair, Params, StopRule, solve};
use signorini_mathematics::solvers::Refusal;
use signorini_mathematics::spectral::TrueSolution;
use signorini_mathematics::square::bounds::bounds;
use signorini_mathematics::square::load::{integral, load};
use signorini_mathematics::square::multigrid::solve_square;

const EXACT: LoadRule = LoadRule::Exact { diagonal: Diagonal::Rising };

fn solved(n: usize, f: &Source, rule: LoadRule, goal: Goal) -> (Grid, Vec<f64>) {
    let grid = Grid::new(n).unwrap();
    let params = MultigridParams { goal, ..MultigridParams::default() };
    (grid, solve_square(n, Law::SIGNORINI, &load(grid, f, rule), &params).unwrap().0)
}

/// True solution on the square under the paper's law.
fn truth_of(f: &Source) -> Result<TrueSolution, Refusal> {
    let grids = vec![Grid::new(2).unwrap()];
    let problem = Problem::on_square(grids, f.clone(), LoadRule::Bilinear {}, Law::SIGNORINI);
    problem.unwrap().true_solution()
}

/// Problems with their true energies.
fn energies() -> impl Iterator<Item = (&'static str, f64)> {
    REFERENCES.iter().map(|known| (known.f, known.energy))
}

#[test]
fn brackets_shrink_like_the_third_power_of_the_width() {
    for (text, _) in energies() {
        let f: Source = text.parse().unwrap();
        let width = |n| {
            let (grid, y) = solved(n, &f, EXACT, Goal::RoundingFloor);
            let [low, high] = bounds(grid, &f, Law::SIGNORINI, &y).unwrap().energy;
            high - low
        };
        let order = (width(64) / width(512)).log2() / 3.0;
        assert!(order > 2.7, "{text}: {order}");
    }
}

/// How far inside the bracket the true energy is at least, over the width of the bracket, for vectors that
/// claim to solve a problem: right, with wrong loads, and stopped early by multigrid and the paper's method.
fn least_margin(f: &Source, cells: usize) -> f64 {
    let failed = |e| panic!("{f}: {e}");
    let truth = truth_of(f).unwrap_or_else(failed);
    let energy = truth.energy;
    let slack = truth.bracket.map_or(1e-9 * energy.abs(), |[low, high]| high - low);
    let grid = Grid::new(cells).unwrap();
    let mut least = f64::INFINITY;
    let mut judge = |what: &dyn std::fmt::Debug, y: &[f64]| {
        let [low, high] = bounds(grid, f, Law::SIGNORINI, y).unwrap().energy;
        let inside = (energy - low).min(high - energy);
        assert!(inside >= -slack, "{f}, 1/{cells}, {what:?}: {inside:e}, slack {slack:e}");
        least = least.min(inside / (high - low));
    };
    for rule in [EXACT, LoadRule::Bilinear {}, LoadRule::default()] {
        let load = load(grid, f, rule);
        if load.iter().sum::<f64>() >= 0.0 {
            // The sum of an exact load is the integral of f, which is negative.
            assert!(![EXACT, LoadRule::Bilinear {}].contains(&rule), "{f}, 1/{cells}, {rule:?}");
            continue;
        }
        for (goal, max_cycles) in [
            (Goal::RoundingFloor, 100),
            (Goal::DiscretisationError, 100),
            (Goal::RoundingFloor, 0),
            (Goal::RoundingFloor, 1),
        ] {
            let params = MultigridParams { goal, max_cycles, ..MultigridParams::default() };
            let (y, _) = solve_square(cells, Law::SIGNORINI, &load, &params).unwrap();
            judge(&(rule, goal, max_cycles), &y);
        }
        for max_iterations in [1, 10, 100] {
            let params = Params { max_iterations, rule: StopRule::Printed, ..Params::default() };
            let mut pair = Pair::zero((grid, Law::SIGNORINI));
            solve((grid, Law::SIGNORINI), &load, &params, &mut pair);
            judge(&(rule, max_iterations), &pair.y);
        }
    }
    least
}

#[test]
fn brackets_hold_the_true_energies_of_random_problems() {
    let mut dice = Dice(22);
    let problems: Vec<_> =
        (0..150).map(|k| (random_source(&mut dice), [8, 12, 16, 24, 32][k % 5])).collect();
    let margins = problems.par_iter().map(|(f, cells)| least_margin(f, *cells));
    let least = margins.reduce(|| f64::INFINITY, f64::min);
    println!("least margin over the width of the bracket: {least:.1e}");
}

/// Shapes whose sides and vertices coincide, or miss each other by up to a hundredth, with a negative integral.
fn nearly_touching(dice: &mut Dice) -> Source {
    let mut one_of = |list: &[f64]| list[dice.below(list.len() as u64) as usize];
    loop {
        let mut text = String::new();
        for _ in 0..one_of(&[1.0, 2.0, 3.0, 4.0]) as usize {
            let mut near = |list: &[f64]| {
                let off = one_of(&[1e-16, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2]);
                one_of(list) + one_of(&[0.0, 0.0, -1.0, 1.0]) * off
            };
            let [x, y, u, v] = [(); 4].map(|()| near(&[-0.75, -0.5, -0.25, 0.0, 0.125, 0.3, 0.5]));
            let shape = match near(&[0.0, 1.0, 2.0]).round() as usize {
                0 if x < u && y < v => format!("rect({x},{u},{y},{v})"),
                1 => format!("disc({x},{y},{})", near(&[0.125, 0.25, 0.5, 0.75, 1.0])),
                2 => format!("halfplane({},1,{x})", near(&[-1.0, 0.0, 0.5])),
                _ => "quadrant(ul)".into(),
            };
            text += &format!("{shape}={}; ", one_of(&[-8.0, -1.0, 0.0, 0.001, 2.0, 30.0]));
        }
        let f: Source = (text + &format!("else={}", one_of(&[-5.0, -1.0, 1.0]))).parse().unwrap();
        if integral(&f) < -0.02 {
            return f;
        }
    }
}

#[test]
fn what_nearly_touches_is_answered_rightly_or_refused() {
    let mut dice = Dice(9);
    let problems: Vec<_> = (0..150).map(|_| nearly_touching(&mut dice)).collect();
    let answered = |f: &&Source| {
        let Ok(solution) = truth_of(f) else { return false };
        let (grid, y) = solved(64, f, EXACT, Goal::RoundingFloor);
        let [low, high] = bounds(grid, f, Law::SIGNORINI, &y).unwrap().energy;
        let slack = 1e-9 * low.abs();
        let inside = (low - slack..=high + slack).contains(&solution.energy);
        assert!(inside, "{f}: {} not in {low}..{high}", solution.energy);
        true
    };
    let answered = problems.par_iter().filter(answered).count();
    println!("answered: {answered} of {}", problems.len());
    // A border that runs along a side, but not on it, is refused.
    assert!(answered >= 140, "{answered}");
}

#[test]
fn errors_of_known_solutions_lie_between_the_bounds() {
    use signorini_mathematics::square::errors::errors;
    for problem in Exact::ALL {
        let f = Source::from(problem);
        for n in [64, 128] {
            let grid = Grid::new(n).unwrap();
            let load = load(grid, &f, EXACT);
            let y = solve_square(n, Law::SIGNORINI, &load, &MultigridParams::default()).unwrap().0;
            let error = errors(grid, problem, &y).h1;
            let [least, most] = bounds(grid, &f, Law::SIGNORINI, &y).unwrap().error;
            // The quadrature of the error is good to about 1e-4 of it.
            assert!(
                least <= 1.0002 * error && 0.9998 * error <= most,
                "{problem:?} 1/{n}: {least} {error} {most}"
            );
            assert!(
                most < 1.01 * error && least > 0.99 * error,
                "{problem:?} 1/{n}: {least} {error} {most}"
            );
        }
    }
}

#[test]
fn the_bound_of_the_error_is_effective() {
    for (text, energy) in energies() {
        let f: Source = text.parse().unwrap();
        for n in [64, 128, 256] {
            let allowed = 1.0 + 0.01 * 64.0 / n as f64;
            let (grid, y) = solved(n, &f, LoadRule::Bilinear {}, Goal::RoundingFloor);
            // With the exact load the energy of the discrete problem is that of v, and the reactions of the
            // true solution do hardly any work on v.
            let ours = judge((grid, Law::SIGNORINI), &y, &load(grid, &f, EXACT)).energy;
            let error = (2.0 * (ours - energy)).sqrt();
            let Bounds { error: [least, most], recovered, .. } =
                bounds(grid, &f, Law::SIGNORINI, &y).unwrap();
            assert!(error <= most && most < allowed * error, "{text} 1/{n}: {}", most / error);
            assert!(least <= error && least > 0.985 * error, "{text} 1/{n}: {}", least / error);
            let recovered = recovered.expect("the square has a recovery");
            assert!(recovered < 0.3 * error, "{text} 1/{n}: {recovered} {error}");
        }
    }
}

/// The arcs of the solution for f, and its nodes in contact.
fn contact(n: usize, f: &Source) -> (Vec<ContactArc>, usize) {
    let (grid, y) = solved(n, f, EXACT, Goal::RoundingFloor);
    let judgement = judge((grid, Law::SIGNORINI), &y, &load(grid, f, EXACT));
    (
        arcs(&[square_boundary(grid, Law::SIGNORINI)], &y, &judgement),
        grid.boundary().filter(|&node| y[node] == 0.0).count(),
    )
}

#[test]
fn contact_is_reported_with_its_ends_and_its_whole_force() {
    let (contact, _) = contact(256, &REFERENCES[0].f.parse().unwrap());
    let [arc] = &contact[..] else { panic!("{contact:?}") };
    for (found, want) in [arc.from, arc.to].into_iter().zip(REFERENCES[0].contact.unwrap()) {
        assert!((0..2).all(|k| (found[k] - want[k]).abs() < 0.25 / 256.0), "{arc:?}");
    }
    assert!((arc.force - 0.8125).abs() < 1e-12);
}

#[test]
fn contact_in_one_node_is_not_contact_everywhere() {
    let f = "disc(0.115,-0.435,0.0315)=-144.8; else=0.364".parse().unwrap();
    let (contact, 1) = contact(8, &f) else { panic!("one node") };
    let [arc] = &contact[..] else { panic!("{contact:?}") };
    assert_eq!((arc.from, arc.to), ([0.0625, -0.5], [0.1875, -0.5]));
}

#[test]
fn forces_are_those_of_the_multiplier_however_weak() {
    // Its force is less than what f puts on half a cell.
    let (contact, 1) = contact(64, &"quadrant(ll)=3; else=-1.00001".parse().unwrap()) else {
        panic!("one node")
    };
    let [arc] = &contact[..] else { panic!("{contact:?}") };
    assert!((arc.force - 7.5e-6).abs() < 1e-11, "{arc:?}");
}

#[test]
fn the_bound_is_effective_where_the_load_hides_the_reaction() {
    // The load against bilinear hats is larger than that of the vector by more than the force in its only node.
    let (text, energy) = energies().nth(4).unwrap();
    let f: Source = text.parse().unwrap();
    let (grid, y) = solved(16, &f, EXACT, Goal::RoundingFloor);
    assert_eq!(grid.boundary().filter(|&node| y[node] == 0.0).count(), 1);
    let Bounds { energy: [low, high], error: [_, most], .. } =
        bounds(grid, &f, Law::SIGNORINI, &y).unwrap();
    let ours = judge((grid, Law::SIGNORINI), &y, &load(grid, &f, EXACT)).energy;
    let error = (2.0 * (ours - energy)).sqrt();
    assert!(low <= energy && energy <= high && high - low < 1e-4, "{low} {high}");
    assert!(error <= most && most < 1.01 * error, "{most} {error}");
}

#[test]
fn what_has_no_solution_has_no_bound() {
    let grid = Grid::new(8).unwrap();
    let zero = vec![0.0; grid.nodes()];
    let found = bounds(grid, &Source::constant(1.0), Law::SIGNORINI, &zero);
    let balanced = [f64::NEG_INFINITY, 0.0];
    let refused = Unsolvable {
        component: None,
        integral: 1.0,
        balanced,
        enough: None,
        has_parts: false,
        has_fluxes: false,
    };
    assert_eq!(found, Err(refused.into()));
    let huge = vec![1e200; grid.nodes()];
    assert_eq!(
        bounds(grid, &Source::constant(-1e200), Law::SIGNORINI, &huge),
        Err(NoBound::NotFinite)
    );
    // Inside, and on the boundary beside a value below zero.
    for (node, lowest) in [(40, 0.0), (4, 0.0), (4, -1.0)] {
        let mut nan = zero.clone();
        (nan[node], nan[80]) = (f64::NAN, lowest);
        assert_eq!(
            bounds(grid, &Source::constant(-1.0), Law::SIGNORINI, &nan),
            Err(NoBound::NotFinite)
        );
    }
}

#[test]
fn no_bound_is_given_where_squares_underflow() {
    let text = "quadrant(ll)=3; else=-1.25";
    let f: Source = text.parse().unwrap();
    let (grid, y) = solved(16, &f, EXACT, Goal::RoundingFloor);
    let [low, high] = bounds(grid, &f, Law::SIGNORINI, &y).unwrap().energy;
    // Powers of two, by which f and y are exact and the energies are scaled twice.
    for (power, known) in [(-400, true), (-480, true), (-490, false), (-530, false), (-1000, false)]
    {
        let factor = 2f64.powi(power);
        let f =
            format!("quadrant(ll)={:e}; else={:e}", 3.0 * factor, -1.25 * factor).parse().unwrap();
        let y: Vec<f64> = y.iter().map(|value| factor * value).collect();
        match bounds(grid, &f, Law::SIGNORINI, &y) {
            Ok(Bounds { energy, .. }) => {
                let energy = energy.map(|e| e / factor / factor);
                let far = (energy[0] - low).abs() + (energy[1] - high).abs();
                assert!(known && far <= 1e-9 * low.abs(), "2^{power}: {energy:?} {low} {high}");
            }
            Err(refused) => assert!(!known && refused == NoBound::NotFinite, "2^{power}"),
        }
    }
}
