//! Problems with values, gaps, fluxes, k and a reaction: closed forms, brackets that contain them, and solvers that
//! agree.

use super::{Settings, Solver, solve};
use crate::bounds::Bounds;
use crate::bounds::boundary::mean_product;
use crate::discrete::kkt::judge;
use crate::discrete::network::Network;
use crate::discrete::norms::{largest, worst};
use crate::levels::{Problem, ProblemError};
use crate::mesh::{AnyMesh, Element, Facet, MeshData, MeshError, Part, PlaneMesh, centroid, dot};
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

    /// 1, or another factor of the flux.
    fn k(&mut self) -> f64 {
        libm::exp2(self.between(-3.0, 3.0).max(0.0) - self.between(-3.0, 3.0).max(0.0))
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

/// The mesh with its cells in two regions: the second are those whose centroid is so.
fn with_regions(mesh: AnyMesh, is_second: impl Fn([f64; 2]) -> bool) -> AnyMesh {
    let AnyMesh::Plane(mut mesh) = mesh else { panic!("a mesh in the plane") };
    let centroids = mesh.cells().iter().map(|cell| centroid(mesh.vertices(cell)));
    mesh.regions = centroids.map(|at| u16::from(is_second(at))).collect();
    (mesh.region_names, mesh.k) = (vec!["one".into(), "two".into()], vec![1.0; 2]);
    AnyMesh::Plane(mesh)
}

/// `-(k v')' + c v = f` on an interval from 0 with laws at its ends; k and f have numbers on both halves.
#[derive(Clone, Copy, Debug)]
struct Strip {
    halves: [Half; 2],
    reaction: f64,
    length: f64,
    laws: [Law; 2],
}

/// Values and fluxes at the ends of a strip, energy, and square of the energy norm.
#[derive(Clone, Copy, Debug)]
struct StripSolution {
    values: [f64; 2],
    fluxes: [f64; 2],
    energy: f64,
    square: f64,
}

impl StripSolution {
    /// Energy norm of v less a nodal vector.
    fn error(self, problem: &Problem, length: f64, y: &[f64]) -> f64 {
        let load: f64 = problem.load().iter().zip(y).map(|(f, y)| f * y).sum();
        let mesh = problem.levels().mesh(problem.finest());
        let mesh = mesh.plane().unwrap();
        // The load vector has the fluxes of free parts.
        let is_free =
            |name: &str| mesh.parts().iter().any(|of| of.names.contains(name) && of.law.is_free());
        let ends = [("left", 0.0), ("right", length)].into_iter().zip(self.fluxes);
        let through = ends.filter(|((name, _), _)| !is_free(name));
        let product: f64 =
            load + through.map(|((_, x), l)| HEIGHT * l * mean_at(problem, y, x)).sum::<f64>();
        (self.square - 2.0 * product + energy_square(mesh, y)).max(0.0).sqrt()
    }
}

/// Square of the energy norm of a nodal vector, without lumping.
fn energy_square(mesh: &PlaneMesh, y: &[f64]) -> f64 {
    let mut square = 0.0;
    for (number, cell) in mesh.cells().iter().enumerate() {
        let element = Element::<2, 3>::new(mesh.vertices(cell));
        let values = cell.map(|node| y[node as usize]);
        let slope = element.gradient(values);
        let density = mesh.k(number) * dot(slope, slope);
        square += element.volume * (density + mesh.reaction * mean_product(values, values));
    }
    square
}

/// k and f on a half of a strip.
#[derive(Clone, Copy, Debug)]
struct Half {
    k: f64,
    f: f64,
}

impl Half {
    /// v and k v' behind the half, and the integral of f v over it, from v and k v' before it.
    fn behind(self, reaction: f64, length: f64, [v, s]: [f64; 2]) -> [f64; 3] {
        let Self { k, f } = self;
        if reaction == 0.0 {
            let behind = v + s * length / k - 0.5 * f * length * length / k;
            let cubic = length.powi(3) / 6.0;
            let integral = v * length + 0.5 * s * length * length / k - f * cubic / k;
            return [behind, s - f * length, f * integral];
        }
        let (rate, rest) = ((reaction / k).sqrt(), v - f / reaction);
        let [cosh, sinh] = [libm::cosh(rate * length), libm::sinh(rate * length)];
        let behind = f / reaction + rest * cosh + s / (k * rate) * sinh;
        let slope = k * rate * rest * sinh + s * cosh;
        [behind, slope, f * (slope - s + f * length) / reaction]
    }
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

    /// v and k v' at the right end, and the integral of f v, from v and k v' at 0.
    fn behind(self, from: [f64; 2]) -> [f64; 3] {
        let [one, two] = self.halves;
        let [v, s, before] = one.behind(self.reaction, 0.5 * self.length, from);
        let [v, s, after] = two.behind(self.reaction, 0.5 * self.length, [v, s]);
        [v, s, before + after]
    }

    /// The solution in closed form.
    fn solution(self) -> Option<StripSolution> {
        let laws = self.laws;
        // What is behind is linear in v and k v' at 0.
        let rest = self.behind([0.0; 2]);
        let [of_v, of_s] = [[1.0, 0.0], [0.0, 1.0]].map(|from| {
            let behind = self.behind(from);
            [behind[0] - rest[0], behind[1] - rest[1]]
        });
        for (one, side) in Self::states(laws[0]) {
            for (two, other_side) in Self::states(laws[1]) {
                let at_0 = match one {
                    None => [1.0, 0.0, laws[0].at()],
                    Some(flux) => [0.0, -1.0, flux],
                };
                let row = |k: usize, value: f64| [of_v[k], of_s[k], value - rest[k]];
                let behind = two.map_or_else(|| row(0, laws[1].at()), |flux| row(1, flux));
                let determinant = at_0[0] * behind[1] - at_0[1] * behind[0];
                if determinant.abs() < 1e-12 {
                    continue;
                }
                let v = (at_0[2] * behind[1] - at_0[1] * behind[2]) / determinant;
                let s = (at_0[0] * behind[2] - at_0[2] * behind[0]) / determinant;
                let [other, flux, of_f] = self.behind([v, s]);
                let (fluxes, values) = ([-s, flux], [v, other]);
                let is_lawful = |k: usize, side: f64| {
                    let [lo, hi] = laws[k].room(fluxes[k]);
                    let from = side * (values[k] - laws[k].at());
                    (lo >= 0.0 && hi >= 0.0 || side != 0.0) && (from >= 0.0 || laws[k].is_free())
                };
                if is_lawful(0, side) && is_lawful(1, other_side) {
                    let square = of_f + fluxes[0] * values[0] + fluxes[1] * values[1];
                    let of_laws = laws[0].potential(values[0]) + laws[1].potential(values[1]);
                    let energy = HEIGHT * (0.5 * square - of_f + of_laws);
                    let square = HEIGHT * square;
                    return Some(StripSolution { values, fluxes, energy, square });
                }
            }
        }
        None
    }

    /// True if linear elements have the values of v at the nodes.
    fn is_exact(self) -> bool {
        self.reaction == 0.0
    }

    fn problem(self, times: usize) -> Result<Problem, ProblemError> {
        let laws = [self.laws[0], self.laws[1], Law::FREE, Law::FREE];
        let mesh = rectangle([self.length, HEIGHT], [4, 1], laws);
        let [one, two] = self.halves;
        let mut mesh = with_regions(mesh, |[x, _]| x > 0.5 * self.length);
        mesh.set_k(&format!("region(one)={}; region(two)={}", one.k, two.k)).unwrap();
        mesh.set_reaction(self.reaction).unwrap();
        Problem::on_mesh(&mesh, times, &format!("region(one)={}; region(two)={}", one.f, two.f))
    }
}

/// Mean over a vertical line of nodes.
fn mean_at(problem: &Problem, y: &[f64], x: f64) -> f64 {
    let mesh = problem.levels().mesh(problem.finest());
    let points = mesh.plane().unwrap().points();
    let height = points.iter().fold(0.0f64, |most, point| most.max(point[1]));
    let nodes = points.iter().zip(y).filter(|(point, _)| point[0] == x);
    let (mut sum, mut weights) = (0.0, 0.0);
    for (point, value) in nodes {
        let weight = if [0.0, height].contains(&point[1]) { 0.5 } else { 1.0 };
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
        let halves = [0; 2].map(|_| Half { k: dice.k(), f: dice.between(-2.0, 2.0) });
        let reaction = dice.between(-4.0, 4.0).max(0.0);
        let strip = Strip { halves, reaction, length: dice.between(0.5, 2.0), laws };
        let Some(known) = strip.solution() else {
            assert!(matches!(strip.problem(0), Err(ProblemError::Unsolvable(_))), "{strip:?}");
            continue;
        };
        seen += 1;
        let StripSolution { values: ends, energy, square, .. } = known;
        let mut widths = Vec::new();
        for times in [1, 3] {
            let problem = strip.problem(times).unwrap();
            for solver in [Solver::ActiveSet, Solver::Multigrid] {
                let y = solution(&problem, solver);
                // On these cells the means over columns of nodes are values of v, if all nodes of an end have one
                // state.
                let means = [0.0, strip.length].map(|x| mean_at(&problem, &y, x));
                let off = means.iter().zip(ends).map(|(y, v)| (y - v).abs()).fold(0.0, f64::max);
                let is_even = strip.is_exact() && has_one_state_on_each_end(&problem, &y);
                let width = problem.levels().facts().width;
                let allowed = if is_even { 1e-10 } else { 2.0 * width * width };
                assert!(off < allowed, "{strip:?} {solver:?} {times}: {means:?} {ends:?}");
                even += usize::from(is_even);
                let disturbed = y.iter().map(|value| value + dice.between(-0.1, 0.1)).collect();
                let [of_disturbed, bounds] = [disturbed, y].map(|y| problem.bounds(&y).unwrap());
                for bounds in [&of_disturbed, &bounds] {
                    let [low, high] = bounds.energy;
                    assert!(low <= energy && energy <= high, "{strip:?}: {energy} {bounds:?}");
                    assert!(
                        bounds.gradient.is_none_or(|least| least <= square.sqrt()),
                        "{strip:?}: {square} {bounds:?}"
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
    assert!(slips > 10 && even > 100, "{slips} {even}");
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
        // Rounding errors of a residual grow with the diagonal, which is 4 where k is 1.
        tolerance: 0.25e-13 * largest(network.diagonal()),
        rule: StopRule::PrintedDual,
        max_iterations: 2_000_000,
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
        let mut mesh = with_regions(random_mesh(&mut dice), |[x, y]| (x > 0.5) == (y > 0.5));
        mesh.set_k(&format!("region(one)={}; else={}", dice.k(), dice.k())).unwrap();
        mesh.set_reaction(dice.between(-5.0, 5.0).max(0.0)).unwrap();
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
    f: &'static str,
    k: &'static str,
    values: Vec<[&'static str; 2]>,
    energy: f64,
}

fn with_formulas() -> [Formulas; 8] {
    let fixed = Law::FIXED;
    let above = Law::SIGNORINI;
    let [high, low] = [1.0, 0.25].map(|value| Law::fixed(value).unwrap());
    let [strong, weak] = [-1.5, -1.0].map(|flux| Law::free(flux).unwrap());
    fn on_bottom(sizes: [f64; 2], cells: [u32; 2], top: Law) -> AnyMesh {
        rectangle(sizes, cells, [Law::FREE, Law::FREE, Law::SIGNORINI, top])
    }
    let power = "((x-1)^2+y^2)^0.75*cos(1.5*atan2(y,x-1))";
    [
        // Of two series, to twelve digits, as the next three; contact from x = 0.7895 on.
        Formulas {
            mesh: on_bottom([1.0, 0.5], [4, 2], high),
            f: "else=-1",
            k: "1",
            values: vec![["bottom", "0.2+0.45*(1-cos(3.141592653589793*x))"]],
            energy: 0.494_429_697_794_469,
        },
        Formulas {
            mesh: on_bottom([1.0, 0.5], [4, 2], strong),
            f: "else=1",
            k: "2",
            values: vec![["bottom", "0.1+0.3*(1-cos(3.141592653589793*x))"]],
            energy: 0.324_702_642_811_702,
        },
        Formulas {
            mesh: with_regions(on_bottom([1.0; 2], [4, 4], low), |[_, y]| y > 0.5),
            f: "region(one)=-0.4; region(two)=0.2",
            k: "region(two)=5; else=1",
            values: vec![["bottom", "0.25*(1-cos(3.141592653589793*x))"]],
            energy: 0.055_017_346_944_244_7,
        },
        Formulas {
            mesh: with_regions(on_bottom([1.0, 0.75], [4, 3], weak), |[_, y]| y > 0.25),
            f: "else=0",
            k: "region(one)=0.5; region(two)=4",
            values: vec![["bottom", "0.75*(1-cos(3.141592653589793*x))"]],
            energy: 0.726_990_317_745_179,
        },
        // v = Re z^1.5: contact where x < 1. Its values are not linear on sides.
        Formulas {
            mesh: rectangle([2.0, 1.0], [4, 2], [fixed, fixed, above, fixed]),
            f: "else=0",
            k: "1",
            values: vec![["left", power], ["right", power], ["top", power]],
            energy: 1.721_690_362_044_479,
        },
        // v = x^2 - y^2 on thin cells.
        Formulas {
            mesh: rectangle([1.0, 0.02], [4, 2], [fixed; 4]),
            f: "else=0",
            k: "1",
            values: ["left", "right", "bottom", "top"].map(|part| [part, "x^2-y^2"]).to_vec(),
            energy: 2.0 / 3.0 * (0.02 + 0.02f64.powi(3)),
        },
        // v = exp(x) sin(y): fluxes by formulas on two sides.
        Formulas {
            mesh: rectangle([1.0; 2], [2, 2], [Law::FREE, Law::FREE, fixed, fixed]),
            f: "else=0",
            k: "1",
            values: vec![["left", "-sin(y)"], ["right", "e*sin(y)"], ["top", "exp(x)*sin(1)"]],
            energy: (libm::exp(2.0) - 1.0) * (libm::sin(2.0) - 1.0) / 4.0,
        },
        // Contact where |theta| < pi / 2.
        Formulas {
            mesh: AnyMesh::built_in("disc").unwrap(),
            f: "else=-1",
            k: "1",
            values: vec![["rim", "x"]],
            energy: 1.222_749_345_068_3,
        },
    ]
}

#[test]
fn brackets_contain_the_energies_of_values_by_formulas_and_shrink() {
    for Formulas { mut mesh, f, k, values, energy } in with_formulas() {
        mesh.set_k(k).unwrap();
        values.iter().for_each(|[part, value]| mesh.set_value(part, value).unwrap());
        let mut widths = Vec::new();
        for times in [2, 3, 4, 5] {
            let problem = Problem::on_mesh(&mesh, times, f).unwrap();
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
        assert!(100.0 * own < by_mesh, "{laws:?} {f}: {own} {by_mesh}");
    }
    // Contact may end arbitrarily close to corners.
    assert!(found > 27, "{found}");
}

/// Ring `1/2 < r < 1` of so many sectors and layers, with k = 2 up to r = 3/4 and 1/2 beyond.
fn ring_of_two([sectors, layers]: [u32; 2]) -> AnyMesh {
    let mut data = MeshData::default();
    for (layer, sector) in (0..=layers).flat_map(|i| (0..sectors).map(move |j| (i, j))) {
        let radius = 0.5 + 0.5 * f64::from(layer) / f64::from(layers);
        let angle = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
        data.points.push([radius * libm::cos(angle), radius * libm::sin(angle)]);
        let (node, next) = (layer * sectors + sector, layer * sectors + (sector + 1) % sectors);
        if layer < layers {
            data.cells
                .extend([[node, next, next + sectors], [node, next + sectors, node + sectors]]);
        }
        if layer == 0 || layer == layers {
            data.facets.push(Facet { nodes: [node, next], part: u16::from(layer > 0) });
        }
    }
    let friction = Law::friction(0.4).and_then(|law| law.with_at(0.2)).unwrap();
    let parts = [("inner", friction), ("outer", Law::fixed(-0.3).unwrap())];
    data.parts = parts.map(|(name, law)| Part { names: name.into(), law, curve: None }).to_vec();
    let mesh = AnyMesh::Plane(data.mesh().unwrap());
    let mut mesh = with_regions(mesh, |[x, y]| libm::hypot(x, y) > 0.75);
    mesh.set_k("region(one)=2; else=1/2").unwrap();
    mesh
}

#[test]
fn rings_of_two_materials_come_near_the_energy_of_circles() {
    let (energy, inside) = (0.906_561_670_030_084, 0.016_169_752_421_823);
    let mut off = Vec::new();
    for sectors in [48, 96, 192] {
        let problem = Problem::on_mesh(&ring_of_two([sectors, sectors / 12]), 0, "else=1").unwrap();
        let y = solution(&problem, Solver::Multigrid);
        let [low, high] = problem.bounds(&y).unwrap().energy;
        off.push([high - low, (low - energy).abs(), (high - energy).abs(), (y[0] - inside).abs()]);
    }
    for [coarse, fine] in [[0, 1], [1, 2]].map(|pair| pair.map(|k| off[k])) {
        assert!(coarse.iter().zip(fine).all(|(coarse, fine)| fine < coarse / 3.5), "{off:?}");
    }
}

#[test]
fn strips_of_two_materials_and_with_a_reaction_have_their_numbers() {
    fn strip(k: &str, reaction: f64, laws: [Law; 2]) -> AnyMesh {
        let mesh = rectangle([1.0, HEIGHT], [5, 1], [laws[0], laws[1], Law::FREE, Law::FREE]);
        let mut mesh = with_regions(mesh, |[x, _]| x > 0.4);
        mesh.set_k(k).unwrap();
        mesh.set_reaction(reaction).unwrap();
        mesh
    }
    fn above(gap: f64) -> Law {
        Law::above(gap, 0.0).unwrap()
    }
    let friction = Law::friction(0.6).unwrap().with_at(0.25).unwrap();
    let limit = Law::limited(1.0).unwrap().with_at(0.3).unwrap();
    let of_two = ["region(one)=2; region(two)=1/2", "region(one)=1/2; else=1"];
    for (mesh, f, energy, first) in [
        (
            strip(of_two[0], 0.0, [Law::free(0.5).unwrap(), friction]),
            "region(one)=-1; region(two)=0.5",
            -0.0457,
            Some(0.61),
        ),
        (
            strip(of_two[1], 0.0, [limit, Law::fixed(-0.6).unwrap()]),
            "region(one)=-3; region(two)=-1",
            -0.1128,
            Some(-0.58),
        ),
        (strip("1", 4.0, [above(0.3), above(0.7)]), "else=2", -0.138_431_669_039_090_2, None),
    ] {
        let mut widths = Vec::new();
        for times in [1, 2, 3] {
            let problem = Problem::on_mesh(&mesh, times, f).unwrap();
            let y = solution(&problem, Solver::Multigrid);
            assert!(first.is_none_or(|first| (mean_at(&problem, &y, 0.0) - first).abs() < 1e-10));
            // The strips are 0.3 high.
            let [low, high] = problem.bounds(&y).unwrap().energy.map(|of| of * 0.3 / HEIGHT);
            assert!(low <= energy && energy <= high, "{f}: {low} {energy} {high}");
            widths.push(high - low);
        }
        assert!(widths.windows(2).all(|two| two[1] < two[0] / 3.5), "{f}: {widths:?}");
    }
}

/// A mesh with a formula of f on it.
struct Scaled {
    mesh: AnyMesh,
    f: &'static str,
    times: usize,
}

#[test]
fn four_times_the_coefficients_the_fluxes_and_f_make_four_times_the_energies() {
    let (at_zero, free) = (Law::new(-0.5, 0.25).unwrap(), Law::free(0.5).unwrap());
    let moving = at_zero.with_at(0.125).unwrap();
    fn named(name: &str, law: Law) -> AnyMesh {
        let mut mesh = AnyMesh::built_in(name).unwrap();
        let parts: Vec<_> = mesh.part_names().cloned().collect();
        parts.iter().for_each(|part| mesh.set_law(part, law).unwrap());
        mesh
    }
    let mut membrane = rectangle([1.0; 2], [2, 2], [at_zero, free, Law::SIGNORINI, Law::FIXED]);
    membrane.set_value("bottom", "0.1*(1-cos(3*x))").unwrap();
    let thin = rectangle([1.0, 0.02], [4, 2], [at_zero, free, Law::SIGNORINI, Law::FIXED]);
    fn of_law(law: Law, factor: f64) -> Law {
        match law {
            _ if law.is_free() => Law::free(factor * law.lo()).unwrap(),
            _ if law.is_fixed() => law,
            _ => {
                let scaled = Law::new(factor * law.lo(), factor * law.hi()).unwrap();
                let at = law.at();
                if at.is_nan() { scaled.by_formula() } else { scaled.with_at(at).unwrap() }
            }
        }
    }
    for Scaled { mesh, f, times } in [
        Scaled { mesh: membrane, f: "formula(FACTOR*(x-y^2-1))", times: 2 },
        Scaled { mesh: thin, f: "formula(FACTOR*x)", times: 3 },
        Scaled { mesh: named("disc", moving), f: "formula(FACTOR*sin(3*x))", times: 3 },
        Scaled { mesh: named("annulus", Law::SIGNORINI), f: "else=-FACTOR", times: 2 },
        Scaled { mesh: named("ball", moving), f: "formula(FACTOR*(x-y*z))", times: 2 },
    ] {
        let found = [1.0, 4.0].map(|factor: f64| {
            let mut mesh = mesh.clone();
            mesh.set_k(&(0.5 * factor).to_string()).unwrap();
            mesh.set_reaction(0.75 * factor).unwrap();
            match &mut mesh {
                AnyMesh::Plane(mesh) => {
                    mesh.parts_mut()
                        .iter_mut()
                        .for_each(|part| part.law = of_law(part.law, factor));
                }
                AnyMesh::Space(mesh) => {
                    mesh.parts_mut()
                        .iter_mut()
                        .for_each(|part| part.law = of_law(part.law, factor));
                }
            }
            if f.contains("y^2") {
                mesh.set_value("right", &format!("{factor}*sin(3*y)")).unwrap();
            }
            let f = f.replace("FACTOR", &factor.to_string());
            let problem = Problem::on_mesh(&mesh, times, &f).unwrap();
            let (y, _) =
                active_set(&problem.networks().unwrap()[times].network, problem.load(), None)
                    .unwrap();
            let disturbed: Vec<_> =
                y.iter().enumerate().map(|(k, v)| v + 1e-2 * ((k % 7) as f64 - 3.0)).collect();
            let mut numbers = vec![problem.judge(&y).energy / factor];
            for y in [&y, &disturbed] {
                let bounds = problem.bounds(y).unwrap();
                numbers.extend(bounds.energy.map(|energy| energy / factor));
                numbers.extend(bounds.error.map(|error| error / factor.sqrt()));
                numbers.extend(bounds.gradient.map(|size| size / factor.sqrt()));
                numbers.extend(bounds.curve.map(|curve| curve / factor));
                let errors = problem.levels().local_errors(y).into_iter();
                numbers.push(errors.fold(0.0, f64::max) / factor.sqrt());
            }
            numbers
        });
        for (one, four) in found[0].iter().zip(&found[1]) {
            assert!((one - four).abs() <= 1e-10 * one.abs(), "{f}: {found:?}");
        }
        assert!(found[0].len() == found[1].len() && found[0].iter().all(|x| x.is_finite()));
    }
}

#[test]
fn errors_of_spoilt_vectors_lie_in_their_bounds_under_a_strong_reaction() {
    let mut dice = Dice(13);
    let mut seen = 0;
    while seen < 60 {
        let laws = [dice.law(), dice.law()];
        let halves = [0; 2].map(|_| Half { k: dice.k(), f: dice.between(-2.0, 2.0) });
        let length = dice.between(0.5, 2.0);
        // The closed form has the exponentials of the length times the root of c/k.
        let least = halves[0].k.min(halves[1].k);
        let reaction = least * (dice.between(1.0, 8.0) / length).powi(2);
        let strip = Strip { halves, reaction, length, laws };
        let Some(known) = strip.solution() else { continue };
        seen += 1;
        let problem = strip.problem(0).unwrap();
        let y = solution(&problem, Solver::ActiveSet);
        let size = dice.between(-0.5, 0.5);
        let raised = y.iter().map(|y| y + size).collect();
        let noisy = y.iter().map(|y| y + dice.between(-0.1, 0.1)).collect();
        let mut beyond = y.clone();
        for of in problem.networks().unwrap()[0].network.boundary() {
            let has_room = of.law.hi().is_finite() || y[of.node] != of.law.at();
            beyond[of.node] -= if has_room { 0.0 } else { 0.5 };
        }
        for y in [y, raised, noisy, beyond] {
            let (bounds, error) =
                (problem.bounds(&y).unwrap(), known.error(&problem, strip.length, &y));
            let ([low, high], [least, most]) = (bounds.energy, bounds.error);
            assert!(low <= known.energy && known.energy <= high, "{strip:?}: {known:?} {bounds:?}");
            let rounding = 1e-7 * (1.0 + known.square.sqrt());
            assert!(
                least <= error + rounding && error <= most + rounding,
                "{strip:?}: {error} {bounds:?}"
            );
        }
    }
}

#[test]
fn values_by_a_formula_under_a_strong_reaction_are_in_the_bounds() {
    // v = exp(-s x), s^2 = c, f = 0.
    for (s, times) in [(4.0f64, 0), (10.0, 0), (10.0, 2), (20.0, 0), (20.0, 1), (20.0, 3)] {
        let mut mesh = rectangle([1.0; 2], [2, 2], [Law::FIXED; 4]);
        mesh.set_reaction(s * s).unwrap();
        for part in ["left", "right", "bottom", "top"] {
            mesh.set_value(part, &format!("exp(-{s}*x)")).unwrap();
        }
        let problem = Problem::on_mesh(&mesh, times, "else=0").unwrap();
        let energy = 0.5 * s * (1.0 - libm::exp(-2.0 * s));
        let y = solution(&problem, Solver::ActiveSet);
        let noisy: Vec<_> =
            y.iter().enumerate().map(|(k, y)| y + 0.02 * ((k % 5) as f64 - 2.0)).collect();
        for y in [y, noisy] {
            let bounds = problem.bounds(&y).unwrap();
            let of_mesh = problem.levels().mesh(times);
            let ends = [0.0, 1.0].map(|x| libm::exp(-s * x) * mean_at(&problem, &y, x));
            let square = energy_square(of_mesh.plane().unwrap(), &y);
            let error = (2.0 * energy - 2.0 * s * (ends[0] - ends[1]) + square).max(0.0).sqrt();
            let [low, high] = bounds.energy;
            assert!(low <= energy && energy <= high, "{s} {times}: {energy} {bounds:?}");
            assert!(error <= bounds.error[1], "{s} {times}: {error} {bounds:?}");
        }
    }
}

#[test]
fn a_reaction_bears_every_load_of_a_free_boundary() {
    let mut mesh = ring_of_two([48, 4]);
    let AnyMesh::Plane(plane) = &mut mesh else { panic!("a mesh in the plane") };
    plane.parts_mut().iter_mut().for_each(|part| part.law = Law::FREE);
    mesh.set_reaction(2.0).unwrap();
    let problem = Problem::on_mesh(&mesh, 0, "else=1").unwrap();
    let area = problem.levels().facts().integral;
    for solver in [Solver::Multigrid, Solver::ActiveSet] {
        let y = solution(&problem, solver);
        assert!(y.iter().all(|y| (y - 0.5).abs() < 1e-12), "{solver:?}");
        let Bounds { energy: [low, high], error, .. } = problem.bounds(&y).unwrap();
        assert!(low <= -0.25 * area && -0.25 * area <= high && high - low < 1e-9);
        assert!(error[1] < 1e-5, "{error:?}");
        assert!((problem.networks().unwrap()[0].network.reacted(&y).unwrap() - area).abs() < 1e-11);
    }
}
