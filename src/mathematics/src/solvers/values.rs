//! Problems with values, gaps and fluxes: closed forms, brackets that contain them, and solvers that agree.

use super::{Settings, Solver, solve};
use crate::bounds::Bounds;
use crate::discrete::kkt::judge;
use crate::discrete::network::Network;
use crate::discrete::norms::worst;
use crate::levels::{Problem, ProblemError};
use crate::mesh::{AnyMesh, Facet, MeshData, MeshError, Part, PlaneMesh};
use crate::multigrid::active_set::active_set;
use crate::multigrid::{Goal, MultigridParams};
use crate::multilevel::solve_nested_networks;
use crate::problem::law::{BoundaryState, Law};
use crate::saddle::{self, Pair, Params, StopRule};

/// Random numbers.
struct Dice(u64);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Law of one of eight kinds.
    fn law(&mut self) -> Law {
        let [at, flux, bound] =
            [self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(0.1, 2.0)];
        let law = match self.between(0.0, 8.0) as usize {
            0 => Law::fixed(at),
            1 => Law::free(flux),
            2 => Law::above(at, 0.0),
            3 => Law::above(at, flux),
            4 => Law::below(at, flux),
            5 => Law::friction(bound).and_then(|law| law.with_at(at)),
            6 => Law::limited(bound).and_then(|law| law.with_at(at)),
            _ => Law::new(flux, flux + bound).and_then(|law| law.with_at(at)),
        };
        law.unwrap()
    }
}

/// Rectangle `[0, length] x [0, height]` of `columns` times `rows` cells, each cut by the rising diagonal, with the
/// laws of the parts left, right, bottom and top.
fn rectangle([length, height]: [f64; 2], [columns, rows]: [u32; 2], laws: [Law; 4]) -> AnyMesh {
    let mut data = MeshData::default();
    for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
        let [x, y] = [(i, columns), (j, rows)].map(|(k, n)| f64::from(k) / f64::from(n));
        data.points.push([length * x, height * y]);
        let node = j * (columns + 1) + i;
        let above = node + columns + 1;
        if i < columns && j < rows {
            data.cells.extend([[node, node + 1, above + 1], [node, above + 1, above]]);
        }
        let mut add = |is_there: bool, nodes, part| {
            if is_there {
                data.facets.push(Facet { nodes, part });
            }
        };
        add(j < rows && i == 0, [node, above], 0);
        add(j < rows && i == columns, [node, above], 1);
        add(i < columns && j == 0, [node, node + 1], 2);
        add(i < columns && j == rows, [node, node + 1], 3);
    }
    let parts = ["left", "right", "bottom", "top"].into_iter().zip(laws);
    data.parts = parts.map(|(name, law)| Part { names: name.into(), law, curve: None }).collect();
    AnyMesh::Plane(data.mesh().unwrap())
}

/// `-v'' = f` on an interval from 0, with laws at its ends.
#[derive(Clone, Copy, Debug)]
struct Strip {
    f: f64,
    length: f64,
    laws: [Law; 2],
}

/// Height of the rectangle that stands for a strip.
const HEIGHT: f64 = 0.25;

impl Strip {
    /// Values and fluxes that an end may have: v or the flux is given, and v is on a side of the law's value.
    fn states(law: Law) -> Vec<(Option<f64>, f64)> {
        let mut states = Vec::new();
        if !law.is_free() {
            states.push((None, 0.0));
        }
        for (flux, side) in [(law.lo(), 1.0), (law.hi(), -1.0)] {
            if flux.is_finite() {
                states.push((Some(flux), side));
            }
        }
        states
    }

    /// Values of v at the ends, energy, and norm of the gradient, in closed form.
    fn solution(self) -> Option<([f64; 2], f64, f64)> {
        let Self { f, length, laws } = self;
        for (one, side) in Self::states(laws[0]) {
            for (two, other_side) in Self::states(laws[1]) {
                // v(x) = v(0) - l x - f x^2 / 2, where l is the flux at 0.
                let rise = |l: f64| -l * length - 0.5 * f * length * length;
                let [at, other_at] = laws.map(Law::at);
                let (l, v) = match (one, two) {
                    (None, None) => ((at - other_at) / length - 0.5 * f * length, at),
                    (Some(l), None) => (l, other_at - rise(l)),
                    (None, Some(other)) => (-f * length - other, at),
                    (Some(_), Some(_)) => continue,
                };
                let (fluxes, values) = ([l, -f * length - l], [v, v + rise(l)]);
                let is_lawful = |k: usize, side: f64| {
                    let [lo, hi] = laws[k].room(fluxes[k]);
                    let from = side * (values[k] - laws[k].at());
                    (lo >= 0.0 && hi >= 0.0 || side != 0.0) && (from >= 0.0 || laws[k].is_free())
                };
                if is_lawful(0, side) && is_lawful(1, other_side) {
                    let slopes =
                        l * l * length + l * f * length.powi(2) + f * f * length.powi(3) / 3.0;
                    let integral = v * length - 0.5 * l * length.powi(2) - f * length.powi(3) / 6.0;
                    let of_laws = laws[0].potential(values[0]) + laws[1].potential(values[1]);
                    let energy = HEIGHT * (0.5 * slopes - f * integral + of_laws);
                    return Some((values, energy, (HEIGHT * slopes).sqrt()));
                }
            }
        }
        None
    }

    fn problem(self, times: usize) -> Result<Problem, ProblemError> {
        let laws = [self.laws[0], self.laws[1], Law::FREE, Law::FREE];
        let mesh = rectangle([self.length, HEIGHT], [4, 1], laws);
        Problem::on_mesh(&mesh, times, &format!("else={}", self.f))
    }
}

/// Mean over a vertical line of nodes.
fn mean_at(problem: &Problem, y: &[f64], x: f64) -> f64 {
    let mesh = problem.levels().mesh(problem.finest());
    let nodes = mesh.plane().unwrap().points().iter().zip(y).filter(|(point, _)| point[0] == x);
    let (mut sum, mut weights) = (0.0, 0.0);
    for (point, value) in nodes {
        let weight = if [0.0, HEIGHT].contains(&point[1]) { 0.5 } else { 1.0 };
        sum += weight * value;
        weights += weight;
    }
    sum / weights
}

fn has_one_state_on_each_end(problem: &Problem, y: &[f64]) -> bool {
    let mesh = problem.levels().mesh(problem.finest());
    let (points, judged) = (mesh.plane().unwrap().points(), problem.judge(y));
    let nodes = judged.contact.iter().zip(&judged.states);
    let mut ends = [Vec::new(), Vec::new()];
    nodes.for_each(|(of, state)| ends[usize::from(points[of.node][0] > 0.0)].push(*state));
    ends.iter().all(|states| states.windows(2).all(|two| two[0] == two[1]))
}

fn solution(problem: &Problem, solver: Solver) -> Vec<f64> {
    solve(problem, &Settings::of(solver)).unwrap().y
}

#[test]
fn strips_have_the_values_and_the_energies_of_the_closed_form() {
    let mut dice = Dice(5);
    let (mut seen, mut slips, mut even) = (0, 0, 0);
    while seen < 100 {
        let laws = [dice.law(), dice.law()];
        let strip = Strip { f: dice.between(-2.0, 2.0), length: dice.between(0.5, 2.0), laws };
        let Some((ends, energy, norm)) = strip.solution() else {
            assert!(matches!(strip.problem(0), Err(ProblemError::Unsolvable(_))), "{strip:?}");
            continue;
        };
        seen += 1;
        let mut widths = Vec::new();
        for times in [1, 3] {
            let problem = strip.problem(times).unwrap();
            for solver in [Solver::ActiveSet, Solver::Multigrid] {
                let y = solution(&problem, solver);
                // On these cells the means over columns of nodes are values of v, if all nodes of an end have one
                // state.
                let means = [0.0, strip.length].map(|x| mean_at(&problem, &y, x));
                let off = means.iter().zip(ends).map(|(y, v)| (y - v).abs()).fold(0.0, f64::max);
                let is_even = has_one_state_on_each_end(&problem, &y);
                let allowed = if is_even { 1e-10 } else { problem.levels().facts().width.powi(2) };
                assert!(off < allowed, "{strip:?} {solver:?} {times}: {means:?} {ends:?}");
                even += usize::from(is_even);
                let disturbed = y.iter().map(|value| value + dice.between(-0.1, 0.1)).collect();
                let [of_disturbed, bounds] = [disturbed, y].map(|y| problem.bounds(&y).unwrap());
                for bounds in [&of_disturbed, &bounds] {
                    let [low, high] = bounds.energy;
                    assert!(low <= energy && energy <= high, "{strip:?}: {energy} {bounds:?}");
                    assert!(
                        bounds.gradient.is_none_or(|least| least <= norm),
                        "{strip:?}: {norm} {bounds:?}"
                    );
                }
                widths.push(bounds.energy[1] - bounds.energy[0]);
            }
            let judged = problem.judge(&solution(&problem, Solver::ActiveSet));
            slips += usize::from(judged.states.contains(&BoundaryState::SlipsDown));
        }
        let shrinks = widths[2] < widths[0] / 12.0 || widths[0] < 1e-9;
        assert!(shrinks, "{strip:?}: {widths:?}");
    }
    assert!(slips > 10 && even > 200, "{slips} {even}");
}

/// Difference of two vectors over the size of the values of both.
fn apart(one: &[f64], two: &[f64]) -> f64 {
    let size = one.iter().chain(two).fold(1.0f64, |most, value| most.max(value.abs()));
    worst(one.iter().zip(two).map(|(a, b)| a - b)) / size
}

/// Solution by the problem for `y - G`, G with the values of the laws on the boundary and zero elsewhere, whose laws
/// have the value 0; and its energy, of the problem as given.
fn by_lift(network: &Network, load: &[f64]) -> (Vec<f64>, f64) {
    let mut lift = vec![0.0; load.len()];
    let laws: Vec<_> = network.boundary().iter().map(|of| of.law.with_at(0.0).unwrap()).collect();
    network.boundary().iter().for_each(|of| lift[of.node] = of.law.at());
    let mut left = vec![0.0; load.len()];
    network.gradient(&lift, load, &mut left);
    left.iter_mut().for_each(|value| *value = -*value);
    let network_of_rest = network.with_laws(&laws);
    let (rest, _) = active_set(&network_of_rest, &left, None).unwrap();
    let energy = judge(&network_of_rest, &rest, &left).energy + network.energy(&lift, load);
    (rest.iter().zip(&lift).map(|(rest, lift)| rest + lift).collect(), energy)
}

/// Values by the paper's method.
fn by_saddle_point(network: &Network, load: &[f64]) -> Vec<f64> {
    let mut pair = Pair { y: vec![0.0; load.len()], a: vec![0.0; network.contact().len()] };
    let params = Params {
        r: 10.0,
        tolerance: 1e-13,
        rule: StopRule::PrintedDual,
        max_iterations: 200_000,
        ..Params::default()
    };
    let outcome = saddle::solve(network, load, &params, &mut pair);
    assert!(outcome.end.has_converged(), "{:?}", outcome.end);
    pair.y
}

/// Square with a law on each side, or a strip or a ring of straight sides with one at each end.
fn random_mesh(dice: &mut Dice) -> AnyMesh {
    let laws = [0; 4].map(|_| dice.law());
    match dice.between(0.0, 4.0) as usize {
        0 => rectangle([2.0, HEIGHT], [4, 1], [laws[0], laws[1], Law::FREE, Law::FREE]),
        1 => {
            let mut ring = AnyMesh::built_in("annulus").unwrap();
            ring.set_law("inner", laws[0]).unwrap();
            ring.set_law("outer", laws[1]).unwrap();
            let AnyMesh::Plane(mesh) = &mut ring else { panic!("in the plane") };
            mesh.parts_mut().iter_mut().for_each(|part| part.curve = None);
            ring
        }
        _ => rectangle([1.0, 1.0], [2, 2], laws),
    }
}

/// Puts one formula in place of the values of all laws, so that they agree where parts meet, and of the fluxes of free
/// parts.
fn put_formula(mesh: &mut AnyMesh, dice: &mut Dice) -> String {
    let [a, b, c] = [0; 3].map(|_| dice.between(-1.0, 1.0));
    let formula = format!("{a} + {b}*x*y + {c}*sin(3*x - y)");
    let names: Vec<_> = mesh.part_names().cloned().collect();
    names.iter().for_each(|part| mesh.set_value(part, &formula).unwrap());
    formula
}

#[test]
fn solvers_agree_on_squares_strips_and_rings_with_values_and_formulas() {
    let mut dice = Dice(7);
    let (mut seen, mut refused, mut by_formulas) = (0, 0, 0);
    while seen < 160 {
        let mut mesh = random_mesh(&mut dice);
        let [low, high] = [0; 2].map(|_| dice.between(-6.0, 6.0));
        let f = format!("halfplane(1,0.5,{})={low}; else={high}", dice.between(0.2, 1.0));
        let has_formula = dice.between(0.0, 1.0) > 0.4;
        let formula = has_formula.then(|| put_formula(&mut mesh, &mut dice));
        let context = format!("{f} {formula:?} {:?}", mesh.plane().map(PlaneMesh::parts));
        let problem = match Problem::on_mesh(&mesh, 2, &f) {
            Ok(problem) => problem,
            Err(ProblemError::Mesh(MeshError::Meeting { .. }) | ProblemError::Unsolvable(_)) => {
                refused += 1;
                continue;
            }
            Err(error) => panic!("{error}"),
        };
        (seen, by_formulas) = (seen + 1, by_formulas + usize::from(has_formula));
        let networks = problem.networks().unwrap();
        let (network, load) = (&networks[2].network, problem.load());
        let (y, end) = active_set(network, load, None).unwrap();
        let judged = judge(network, &y, load);
        assert!(judged.kkt.relative < 1e-11, "{context}: {end:?} {:?}", judged.kkt);
        let (by_multigrid, end) =
            solve_nested_networks(networks, load, &MultigridParams::default()).unwrap();
        assert!(apart(&y, &by_multigrid) < 1e-9, "{context}: {end:?}");
        assert!(apart(&y, &by_saddle_point(network, load)) < 1e-9, "{context}");
        let (lifted, energy) = by_lift(network, load);
        assert!(apart(&y, &lifted) < 1e-9, "{context}");
        assert!((energy - judged.energy).abs() < 1e-11 * (1.0 + energy.abs()), "{context}");
        // Brackets of all vectors and meshes contain the same number.
        let finer = Problem::on_mesh(&mesh, 4, &f).unwrap();
        let best = finer.bounds(&solution(&finer, Solver::Multigrid)).unwrap();
        let disturbed: Vec<_> = y.iter().map(|value| value + dice.between(-0.01, 0.01)).collect();
        for vector in [&y, &disturbed] {
            let found = problem.bounds(vector).unwrap();
            let overlap = found.energy[0] <= best.energy[1] && best.energy[0] <= found.energy[1];
            assert!(overlap, "{context}: {found:?} {best:?}");
            assert!(found.error[0] <= found.error[1], "{context}: {found:?}");
        }
    }
    assert!(refused > 10 && by_formulas > 99, "{refused} {by_formulas}");
}

#[test]
fn a_law_that_nothing_meets_beside_another_value_is_its_flux() {
    // v > 0 everywhere: v >= 0 with the flux -0.3 elsewhere is that flux, although v is 1 where the parts meet.
    let top = Law::fixed(1.0).unwrap();
    let [above, free] = [Law::above(0.0, -0.3), Law::free(-0.3)].map(Result::unwrap);
    let found = [above, free].map(|law| {
        let mesh = rectangle([1.0; 2], [2, 2], [law, law, law, top]);
        let problem = Problem::on_mesh(&mesh, 3, "else=0").unwrap();
        let y = solution(&problem, Solver::ActiveSet);
        let bounds = problem.bounds(&y).unwrap();
        (problem.judge(&y).energy, bounds.energy)
    });
    let [(energy, [low, high]), (of_free, [low_of_free, high_of_free])] = found;
    assert!((energy - of_free).abs() < 1e-12 && (high - high_of_free).abs() < 1e-9, "{found:?}");
    assert!(high - low < 1.1 * (high_of_free - low_of_free), "{found:?}");
}

#[test]
fn values_without_a_load_are_solved_to_a_part_of_their_size() {
    // v = 1e-3 - 1e-4 x: no load tells of its size.
    let friction = Law::friction(1e-4).unwrap();
    let laws = [Law::fixed(1e-3).unwrap(), friction, Law::FREE, Law::FREE];
    let problem = Problem::on_mesh(&rectangle([1.0; 2], [2, 2], laws), 2, "else=0").unwrap();
    let goal = Goal::Kkt(1e-8 * problem.unit());
    for solver in [Solver::ActiveSet, Solver::Multigrid, Solver::Uzawa] {
        let run = solve(&problem, &Settings { goal, ..Settings::of(solver) }).unwrap();
        let end = run.ends.last().unwrap();
        assert!(end.kkt.relative <= 1e-8 && !end.verdict().is_failure(), "{solver:?}: {end:?}");
        assert!((mean_at(&problem, &run.y, 1.0) - 9e-4).abs() < 1e-9, "{solver:?}");
    }
}

#[test]
fn a_ring_with_a_value_inside_has_the_energy_of_its_closed_form() {
    // f = -4 on 1/2 < r < 1, v = 1 inside, v >= 1/4 outside: v = r^2 + a log r + b with dv/dr = 0 at r = 1.
    let (energy, outside) = (7.193_968_447_583_92, 0.363_705_638_880_11);
    let mut ring = AnyMesh::built_in("annulus").unwrap();
    ring.set_law("inner", Law::fixed(1.0).unwrap()).unwrap();
    ring.set_law("outer", Law::above(0.25, 0.0).unwrap()).unwrap();
    let mut off = Vec::new();
    for times in [3, 4, 5] {
        let problem = Problem::on_mesh(&ring, times, "else=-4").unwrap();
        let y = solution(&problem, Solver::Multigrid);
        let judged = problem.judge(&y);
        assert_eq!(judged.state_counts().sticks, 0);
        let value =
            judged.contact.iter().map(|of| y[of.node]).sum::<f64>() / judged.contact.len() as f64;
        let bounds = problem.bounds(&y).unwrap();
        let estimated = bounds.curve.unwrap();
        let [low, high] = bounds.energy;
        assert!(low - estimated <= energy && energy <= high + estimated, "{bounds:?}");
        off.push([(judged.energy - energy).abs(), (value - outside).abs(), high - low]);
    }
    for [coarse, fine] in [[0, 1], [1, 2]].map(|pair| pair.map(|k| off[k])) {
        for (coarse, fine) in coarse.iter().zip(fine) {
            assert!(fine < coarse / 3.0, "{off:?}");
        }
    }
}

/// Problem with values by formulas, and its energy to all digits.
struct Formulas {
    mesh: AnyMesh,
    f: f64,
    values: Vec<[&'static str; 2]>,
    energy: f64,
}

fn with_formulas() -> [Formulas; 5] {
    let fixed = Law::FIXED;
    let above = Law::SIGNORINI;
    let membrane =
        rectangle([1.0, 0.5], [4, 2], [Law::FREE, Law::FREE, above, Law::fixed(1.0).unwrap()]);
    let power = "((x-1)^2+y^2)^0.75*cos(1.5*atan2(y,x-1))";
    [
        // Of two series, to twelve digits; contact from x = 0.7895 on.
        Formulas {
            mesh: membrane,
            f: -1.0,
            values: vec![["bottom", "0.2+0.45*(1-cos(3.141592653589793*x))"]],
            energy: 0.494_429_697_794_469,
        },
        // v = Re z^1.5: contact where x < 1. Its values are not linear on sides.
        Formulas {
            mesh: rectangle([2.0, 1.0], [4, 2], [fixed, fixed, above, fixed]),
            f: 0.0,
            values: vec![["left", power], ["right", power], ["top", power]],
            energy: 1.721_690_362_044_479,
        },
        // v = x^2 - y^2 on thin cells.
        Formulas {
            mesh: rectangle([1.0, 0.02], [4, 2], [fixed; 4]),
            f: 0.0,
            values: ["left", "right", "bottom", "top"].map(|part| [part, "x^2-y^2"]).to_vec(),
            energy: 2.0 / 3.0 * (0.02 + 0.02f64.powi(3)),
        },
        // v = exp(x) sin(y): fluxes by formulas on two sides.
        Formulas {
            mesh: rectangle([1.0; 2], [2, 2], [Law::FREE, Law::FREE, fixed, fixed]),
            f: 0.0,
            values: vec![["left", "-sin(y)"], ["right", "e*sin(y)"], ["top", "exp(x)*sin(1)"]],
            energy: (libm::exp(2.0) - 1.0) * (libm::sin(2.0) - 1.0) / 4.0,
        },
        // Contact where |theta| < pi / 2.
        Formulas {
            mesh: AnyMesh::built_in("disc").unwrap(),
            f: -1.0,
            values: vec![["rim", "x"]],
            energy: 1.222_749_345_068_3,
        },
    ]
}

#[test]
fn brackets_contain_the_energies_of_values_by_formulas_and_shrink() {
    for Formulas { mut mesh, f, values, energy } in with_formulas() {
        values.iter().for_each(|[part, value]| mesh.set_value(part, value).unwrap());
        let mut widths = Vec::new();
        for times in [2, 3, 4, 5] {
            let problem = Problem::on_mesh(&mesh, times, &format!("else={f}")).unwrap();
            let y = solution(&problem, Solver::Multigrid);
            let (expected, _) =
                active_set(&problem.networks().unwrap()[times].network, problem.load(), None)
                    .unwrap();
            assert!(apart(&y, &expected) < 1e-9, "{values:?}");
            let disturbed: Vec<_> =
                y.iter().enumerate().map(|(k, v)| v + 1e-2 * ((k % 7) as f64 - 3.0)).collect();
            for y in [&disturbed, &y] {
                let bounds = problem.bounds(y).unwrap();
                let curve = bounds.curve.unwrap_or(0.0);
                let [low, high] = bounds.energy;
                assert!(
                    low - curve <= energy && energy <= high + curve,
                    "{values:?} {times}: {bounds:?}"
                );
                if y != &disturbed {
                    widths.push(high - low);
                }
            }
        }
        let shrinks = widths.windows(2).all(|pair| pair[1] < pair[0] / 3.0);
        assert!(shrinks, "{values:?}: {widths:?}");
    }
}

#[test]
fn a_flux_that_no_flux_of_cells_has_is_in_the_bounds() {
    // v = cos(2 pi y) sinh(2 pi (1 - x)) / (2 pi cosh(2 pi)): on two cells the given flux has the mean 0, and v is 0.
    let laws = [Law::FREE, Law::FIXED, Law::FREE, Law::FREE];
    let mut mesh = rectangle([1.0; 2], [1, 1], laws);
    mesh.set_value("left", "cos(2*pi*y)").unwrap();
    let problem = Problem::on_mesh(&mesh, 0, "else=0").unwrap();
    let bounds = problem.bounds(&[0.0; 4]).unwrap();
    let turn = 2.0 * std::f64::consts::PI;
    let energy = -libm::tanh(turn) / (4.0 * turn);
    let [[low, high], [_, error]] = [bounds.energy, bounds.error];
    assert!(low <= energy && energy <= high, "{bounds:?}");
    assert!(error * error >= -2.0 * energy, "{bounds:?}");
}

#[test]
fn the_energy_has_the_integral_of_a_flux_times_v() {
    let laws = [Law::FREE, Law::FIXED, Law::FREE, Law::FREE];
    let mut mesh = rectangle([1.0; 2], [1, 1], laws);
    mesh.set_value("left", "y^2").unwrap();
    let problem = Problem::on_mesh(&mesh, 0, "else=0").unwrap();
    // The integrals of y^2 times 1 - y and times y.
    let given = 0.09 / 12.0 + 0.06 / 4.0;
    let y = [0.09, 0.0, 0.06, 0.0];
    let expected = problem.networks().unwrap()[0].network.energy(&y, &[0.0; 4]) - given;
    let [_, high] = problem.bounds(&y).unwrap().energy;
    assert!((high - expected).abs() < 1e-12, "{high} {expected}");
    assert!((problem.judge(&y).energy - expected).abs() < 1e-14);
    let finer = Problem::on_mesh(&mesh, 2, "else=0").unwrap();
    let zero = vec![0.0; finer.load().len()];
    let left = &finer.on_parts(&zero, &finer.judge(&zero))[0];
    assert!((left.force - 1.0 / 3.0).abs() < 1e-14, "{left:?}");
    assert_eq!(left.in_words, "dv/dn = y^2");
}

#[test]
fn brackets_in_space_contain_the_energy_of_values_and_fluxes_by_formulas() {
    // v = x y z, with its flux at the top.
    let AnyMesh::Space(mut cube) = AnyMesh::built_in("cube").unwrap() else { panic!("in space") };
    let names = ["others", "top"].into_iter().zip([Law::FIXED, Law::FREE]);
    cube.parts = names.map(|(name, law)| Part { names: name.into(), law, curve: None }).collect();
    for facet in &mut cube.facets {
        let is_top = facet.nodes.iter().all(|&node| cube.points[node as usize][2] == 0.5);
        facet.part = u16::from(is_top);
    }
    let mut mesh = AnyMesh::Space(cube);
    mesh.set_value("others", "x*y*z").unwrap();
    mesh.set_value("top", "x*y").unwrap();
    let mut widths = Vec::new();
    for times in [0, 1, 2] {
        let problem = Problem::on_mesh(&mesh, times, "else=0").unwrap();
        let [low, high] = problem.bounds(&solution(&problem, Solver::Multigrid)).unwrap().energy;
        assert!(low <= 1.0 / 144.0 && 1.0 / 144.0 <= high, "{times}: {low} {high}");
        widths.push(high - low);
    }
    let shrinks = widths.windows(2).all(|pair| pair[1] < pair[0] / 3.0);
    assert!(shrinks, "{widths:?}");
}

#[test]
fn a_formula_that_is_a_number_has_the_bounds_of_the_number() {
    let [with_number, mut with_formula] = [-0.25, 0.0].map(|value| {
        let bottom = Law::above(value, -0.5).unwrap();
        let laws = [Law::FREE, Law::FREE, bottom, Law::fixed(1.0).unwrap()];
        rectangle([1.0, 0.5], [4, 2], laws)
    });
    with_formula.set_value("bottom", "-1/4").unwrap();
    let [one, two] = [with_number, with_formula].map(|mesh| {
        let problem = Problem::on_mesh(&mesh, 3, "else=-1").unwrap();
        let y = solution(&problem, Solver::Multigrid);
        let [low, high] = problem.bounds(&y).unwrap().energy;
        [low, high, problem.judge(&y).energy]
    });
    for (one, two) in one.iter().zip(two) {
        assert!((one - two).abs() < 1e-12, "{one} {two}");
    }
}

#[test]
fn laws_of_parts_that_meet_are_refused_where_no_function_has_both() {
    let refused =
        |laws: [Law; 4]| Problem::on_mesh(&rectangle([1.0; 2], [1; 2], laws), 0, "else=-1").err();
    let [fixed, high] = [0.0, 1.0].map(|value| Law::fixed(value).unwrap());
    let above = Law::above(0.5, 0.0).unwrap();
    let message = |laws| refused(laws).map(|error| error.to_string());
    let found = message([fixed, Law::FREE, above, Law::FREE]).unwrap();
    assert_eq!(
        found,
        "left, where v = 0, meets bottom, where v >= 0.5, at (0, 0): v cannot stick at both values there; make them \
         equal, or leave a free part between the two"
    );
    let found = message([fixed, Law::FREE, Law::FREE, high]).unwrap();
    assert!(found.starts_with("left, where v = 0, meets top, where v = 1, at (0, 1)"), "{found}");
    assert_eq!(message([high, Law::FREE, above, Law::FREE]), None);
    let friction = Law::friction(0.3).unwrap();
    assert!(message([friction, Law::FREE, above, Law::FREE]).is_some());
    // Values that differ by rounding errors are the same.
    let nearly = Law::above(1.0 + 1e-15, 0.0).unwrap();
    assert_eq!(message([high, Law::FREE, nearly, Law::FREE]), None);
}

#[test]
fn true_solutions_lie_in_the_bounds_of_meshes() {
    let mut dice = Dice(11);
    let (mut seen, mut found) = (0, 0);
    while seen < 30 {
        let (at, free) = (dice.between(-1.0, 1.0), Law::free(dice.between(-1.0, 1.0)).unwrap());
        // Laws with one value, on all sides or on two that meet; or with two values and free sides between them.
        let laws = match seen % 3 {
            0 => [0; 4].map(|_| dice.law().with_at(at).unwrap()),
            1 => [dice.law(), free, dice.law().with_at(at).unwrap(), free],
            _ => [dice.law(), dice.law(), free, Law::FREE],
        };
        let mesh = rectangle([1.0, 1.0], [2, 2], laws);
        let [low, high] = [0; 2].map(|_| dice.between(-6.0, 6.0));
        let f = format!("halfplane(1,0.5,{})={low}; else={high}", dice.between(0.2, 1.0));
        let Ok(problem) = Problem::on_mesh(&mesh, 4, &f) else { continue };
        let of_mesh = problem.bounds(&solution(&problem, Solver::Multigrid)).unwrap();
        let truth = match problem.true_solution() {
            Ok(truth) => truth,
            Err(error) if error.to_string().contains(" meet at ") => continue,
            Err(_) => {
                seen += 1;
                continue;
            }
        };
        (seen, found) = (seen + 1, found + 1);
        let [low, high] = truth.bracket.unwrap();
        let [least, most] = of_mesh.energy;
        assert!(low <= most && least <= high, "{laws:?} {f}: {low} {high} {of_mesh:?}");
        assert!(high - low < 1e-9, "{laws:?} {f}: {low} {high}");
        let [by_mesh, own] = [&of_mesh, &truth.bounds().unwrap()].map(Bounds::relative);
        assert!(own < 1e-4 && own < by_mesh, "{laws:?} {f}: {own} {by_mesh}");
    }
    // Contact may end arbitrarily close to corners.
    assert!(found > 27, "{found}");
}
