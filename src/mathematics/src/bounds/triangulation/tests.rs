//! Brackets that must hold the true energy, and the distance between the bounds and the error.

mod cube;
mod formulas;
mod known;
mod random;
mod rounding;
mod stretched;

use super::linear::{at_vertices, outflows, product};
use super::*;
use crate::discrete::grid::Grid;
use crate::discrete::load::{Diagonal, LoadRule};
use crate::mesh::{
    BoundarySide, BuiltIn, CellData, Element, Facet, MeshData, Part, assemble, refine,
};
use crate::multigrid::MultigridParams;
use crate::problem::law::Law;
use crate::problem::unsolvable::Unsolvable;
use crate::square::load::load;
use crate::square::multigrid::solve_square;

/// Bounds for a nodal vector, with the lower one of the error.
fn bounds_on_mesh<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    network: &Network,
    f: &MeshLoad,
    y: &[f64],
) -> Result<Bounds, NoBound> {
    let problem = BoundedProblem { mesh, sides: &Sides::new(mesh), network, f };
    Ok(problem.with_lower(problem.bounds(y)?.bounds, y))
}

/// Load vector of an f that is constant on each cell.
fn load_of_cells<const D: usize, const V: usize>(mesh: &Mesh<D, V>, f: &[f64]) -> Vec<f64> {
    let mut load = vec![0.0; mesh.points().len()];
    for (cell, f) in mesh.cells().iter().zip(f) {
        let share = f * Element::new(mesh.vertices(cell)).volume / V as f64;
        cell.iter().for_each(|&node| load[node as usize] += share);
    }
    load
}

/// An f that is constant on each cell.
fn constant_on_cells<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    mean: Vec<f64>,
) -> MeshLoad {
    let load = load_of_cells(mesh, &mean);
    let (integral, size) = (load.iter().sum(), f64::NAN);
    MeshLoad {
        load,
        cells: CellData { mean, deviation: None, shares: None },
        integral,
        size,
        given: 0.0,
        given_flux: 0.0,
        unsettled: None,
        moved: 0.0,
    }
}

/// Discrete problem on a mesh with straight sides, and a nodal vector.
#[derive(Clone)]
struct TestProblem<const D: usize, const V: usize> {
    mesh: Mesh<D, V>,
    network: Network,
    f: MeshLoad,
    y: Vec<f64>,
}

impl<const D: usize, const V: usize> TestProblem<D, V> {
    fn new(mut mesh: Mesh<D, V>, mean: Vec<f64>) -> Self {
        mesh.parts_mut().iter_mut().for_each(|part| part.curve = None);
        let network = assemble(&mesh);
        let y = vec![0.0; network.nodes()];
        let f = constant_on_cells(&mesh, mean);
        Self { mesh, network, f, y }
    }

    /// Refined mesh, with the same f and the same function.
    fn refined(&self) -> Self {
        let refined = refine(&self.mesh).unwrap();
        let mean = self.f.cells.mean.iter().flat_map(|f| std::iter::repeat_n(*f, 1 << D)).collect();
        let mut y = self.y.clone();
        let midpoints = refined.parents.iter();
        y.extend(
            midpoints.map(|nodes| 0.5 * nodes.map(|k| self.y[k as usize]).iter().sum::<f64>()),
        );
        Self { y, ..Self::new(refined.mesh, mean) }
    }

    /// Solves the discrete problem by projected over-relaxation, at most this number of sweeps.
    fn relax(&mut self, sweeps: usize) {
        let nodes = self.y.len();
        let load = load_of_cells(&self.mesh, &self.f.cells.mean);
        let mut range = vec![[f64::NEG_INFINITY, f64::INFINITY]; nodes];
        self.network.contact().iter().for_each(|contact| range[contact.node][0] = 0.0);
        self.network.held().iter().for_each(|held| range[held.node] = [0.0; 2]);
        let factor = 2.0 / (1.0 + 2.0 / libm::pow(nodes as f64, 1.0 / D as f64));
        for _ in 0..sweeps {
            let (mut change, mut size) = (0.0f64, 0.0f64);
            for node in 0..nodes {
                let sum = self.network.row(node).add_to(load[node], &self.y);
                let old = self.y[node];
                let relaxed = old + factor * (sum / self.network.diagonal()[node] - old);
                let value = relaxed.clamp(range[node][0], range[node][1]);
                change = change.max((value - old).abs());
                size = size.max(value.abs());
                self.y[node] = value;
            }
            if change <= 1e-11 * size {
                return;
            }
        }
    }

    /// The problem with a law on all of the boundary.
    fn under(mut self, law: Law) -> Self {
        self.mesh.parts_mut().iter_mut().for_each(|part| part.law = law);
        self.network = assemble(&self.mesh);
        self
    }

    fn bounds(&self) -> Bounds {
        bounds_on_mesh(&self.mesh, &self.network, &self.f, &self.y).unwrap()
    }

    /// Solutions on refined meshes, with their bounds.
    fn levels(mut self, levels: usize) -> Vec<(Self, Bounds)> {
        let mut all = Vec::new();
        for _ in 0..levels {
            self = self.refined();
            self.relax(100_000);
            let bounds = self.bounds();
            all.push((self.clone(), bounds));
        }
        all
    }
}

fn disc(f: [f64; 6]) -> TestProblem<2, 3> {
    TestProblem::new(BuiltIn::Disc.plane().unwrap(), f.into())
}

fn annulus(inner: Law) -> TestProblem<2, 3> {
    annulus_under([inner, Law::SIGNORINI])
}

/// Ring with laws on the inner and the outer circle.
fn annulus_under(laws: [Law; 2]) -> TestProblem<2, 3> {
    let mut mesh = BuiltIn::Annulus.plane().unwrap();
    mesh.parts_mut().iter_mut().zip(laws).for_each(|(part, law)| part.law = law);
    TestProblem::new(mesh, (0..24).map(|k| if k < 6 { 3.0 } else { -1.5 }).collect())
}

/// Unit square of n by n cells, each cut by the rising diagonal, with a value of f for each square.
fn square(n: u32, value: impl Fn(u32, u32) -> f64) -> TestProblem<2, 3> {
    let mut data = MeshData::default();
    let mut f = Vec::new();
    for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
        data.points.push([i, j].map(|k| f64::from(k) / f64::from(n)));
        if i < n && j < n {
            let [ll, ul] = [j, j + 1].map(|j| j * (n + 1) + i);
            data.cells.extend([[ll, ll + 1, ul + 1], [ll, ul + 1, ul]]);
            f.extend([value(i, j); 2]);
        }
    }
    TestProblem::new(data.mesh().unwrap(), f)
}

fn straight<const D: usize>(name: &str, law: Law) -> Part<D> {
    Part { names: name.into(), law, curve: None }
}

/// True if intervals have a point in common.
fn overlap(intervals: &[[f64; 2]]) -> bool {
    let low = intervals.iter().fold(f64::MIN, |low, interval| low.max(interval[0]));
    let high = intervals.iter().fold(f64::MAX, |high, interval| high.min(interval[1]));
    low <= high
}

#[test]
fn the_polygon_of_the_disc_is_bracketed_on_all_its_refinements() {
    let levels = disc([-1.0; 6]).levels(5);
    for (problem, _) in &levels {
        assert!(problem.network.contact().iter().all(|c| problem.y[c.node] == 0.0));
    }
    let energies: Vec<_> = levels.iter().map(|(_, bounds)| bounds.energy).collect();
    assert!(overlap(&energies), "{energies:?}");
    let [low, high] = energies[4];
    assert!(high - low < 2e-3 * high.abs());
}

#[test]
fn the_square_has_the_bracket_of_its_grid() {
    for n in [16, 64] {
        let source = "quadrant(ll)=3; else=-1.1".parse().unwrap();
        let grid = Grid::new(n).unwrap();
        let load = load(grid, &source, LoadRule::Exact { diagonal: Diagonal::default() });
        let params = MultigridParams::default();
        let (y, _) = solve_square(n, Law::SIGNORINI, &load, &params).unwrap();
        let half = n as u32 / 2;
        let mut problem = square(n as u32, |i, j| if i.max(j) < half { 3.0 } else { -1.1 });
        problem.y.clone_from(&y);
        let of_grid = crate::square::bounds::bounds(grid, &source, Law::SIGNORINI, &y).unwrap();
        let of_mesh = problem.bounds();
        assert!(overlap(&[of_grid.energy, of_mesh.energy]), "{of_grid:?} {of_mesh:?}");
        assert!(of_grid.error[0] <= of_mesh.error[1] && of_mesh.error[1] < 1.6 * of_grid.error[1]);
    }
}

/// Bound of the error over the error on the first levels, as far as the energy of the last level shows the error.
fn effectivities<const D: usize, const V: usize>(
    problem: TestProblem<D, V>,
    levels: usize,
    first: usize,
) -> Vec<f64> {
    let levels = problem.levels(levels);
    let exact = levels.last().unwrap().1.energy[1];
    let bounds = levels.iter().take(first).map(|(_, bounds)| bounds);
    bounds.map(|bounds| bounds.error[1] / root(2.0 * (bounds.energy[1] - exact))).collect()
}

#[test]
fn bounds_are_little_longer_than_the_error() {
    let sectors = [4.0, -1.5, -1.5, -1.5, -1.5, -1.5];
    let lshape = TestProblem::new(BuiltIn::LShape.plane().unwrap(), sectors.into());
    let all = [
        (1.3, 6, disc([-1.0; 6])),
        (1.3, 6, disc(sectors)),
        (1.45, 7, lshape),
        (1.5, 6, annulus(Law::SIGNORINI)),
        (1.4, 6, annulus(Law::FIXED)),
        (1.5, 6, annulus(Law::FREE)),
    ];
    for (most, levels, problem) in all {
        let found = effectivities(problem, levels, levels - 4);
        assert!(found.iter().all(|found| (1.0..most).contains(found)), "{found:?}");
    }
    let mut ball = BuiltIn::Ball.space().unwrap();
    for law in [Law::SIGNORINI, Law::FIXED] {
        ball.parts_mut()[0].law = law;
        let f = (0..20).map(|k| if k < 4 { 3.0 } else { -1.5 }).collect();
        let found = effectivities(TestProblem::new(ball.clone(), f), 4, 2);
        assert!(found.iter().all(|found| (1.0..1.4).contains(found)), "{found:?}");
    }
}

/// Numbers between -1 and 1 that look random.
fn noise(count: usize, frequency: f64) -> Vec<f64> {
    (1..=count).map(|k| libm::sin(k as f64 * frequency)).collect()
}

/// Checks that a flux balances f on all cells, and that the law allows it.
fn check_flux(cells: &Cells<'_, 2, 3>, sides: &Sides<3>, flux: &[SideFlux<2>]) {
    for (cell, mass) in (0..).zip(cells.masses()) {
        let outflows = outflows(sides, cell, &cells.mesh.cells()[cell as usize], flux);
        let outflow = 0.5 * outflows.as_flattened().iter().sum::<f64>();
        assert!((outflow + mass).abs() < 1e-12, "{outflow} {mass}");
    }
    check_law(cells, sides, flux);
}

/// Checks that the law allows a flux through the boundary.
fn check_law(cells: &Cells<'_, 2, 3>, sides: &Sides<3>, flux: &[SideFlux<2>]) {
    for (facet, at) in cells.mesh.facets().iter().zip(sides.of_facets()) {
        let (interval, flux) = (cells.interval(facet), flux[at.side as usize]);
        assert_eq!(flux.map(|flux| interval.clamp(flux)), flux);
    }
}

#[test]
fn sigma_is_a_flux_for_every_vector() {
    let laws = [
        Law::SIGNORINI,
        Law::friction(0.7).unwrap(),
        Law::friction(2.0).unwrap(),
        Law::limited(1.3).unwrap(),
    ];
    let inner = [Law::FREE, Law::FIXED, Law::SIGNORINI, Law::friction(0.7).unwrap()];
    for (k, inner) in (0..32).zip(inner.into_iter().cycle()) {
        for law in laws {
            let mut problem = annulus_under([inner, law]).refined();
            problem.y = noise(problem.y.len(), 12.9898 + f64::from(k));
            let sides = Sides::new(&problem.mesh);
            let w = admissible(&problem.network, Slips::ALL, &problem.y);
            let cells = Cells { mesh: &problem.mesh, w: &w, f: &problem.f.cells };
            let forest = OnceLock::new();
            let mut flux = equilibrated(&cells, &sides, &problem.network, &forest).unwrap();
            check_flux(&cells, &sides, &flux);
            let before = flux.clone();
            let forest = forest.get().unwrap();
            circulate_quadratic(&cells, &sides, forest, 1.0, &mut flux);
            assert_ne!(flux, before);
            check_flux(&cells, &sides, &flux);
        }
    }
}

/// Square of the norm of a flux.
fn square_of(problem: &TestProblem<2, 3>, sides: &Sides<3>, flux: &[f64]) -> f64 {
    let cells = problem.mesh.cells().iter().enumerate();
    let squares = cells.map(|(number, cell)| {
        let vertices = problem.mesh.vertices(cell);
        let volume = Element::new(vertices).volume;
        let outflows = sides.outflows(number as u32, flux).map(|outflow| [outflow; 3]);
        let values = at_vertices(&vertices, volume, &outflows);
        product(volume, &values, &values)
    });
    squares.sum()
}

#[test]
fn circulations_around_all_nodes_lower_the_norm_and_keep_the_balance() {
    for inner in [Law::FREE, Law::FIXED, Law::SIGNORINI] {
        let mut problem = annulus(inner).refined();
        problem.y = noise(problem.y.len(), 12.9898);
        let w = admissible(&problem.network, Slips::ALL, &problem.y);
        let sides = Sides::new(&problem.mesh);
        let (mesh, f) = (&problem.mesh, &problem.f.cells);
        let cells = Cells { mesh, w: &w, f };
        let triangles = triangles(mesh);
        let before = of_patches(&cells, &sides, &triangles);
        let mut after = before.clone();
        circulate(&cells, &sides, &triangles, &problem.network, &mut after);
        let squares = [&before, &after].map(|flux| square_of(&problem, &sides, flux));
        assert!(squares[1] < 0.99 * squares[0], "{squares:?}");
        for cell in 0..mesh.cells().len() as u32 {
            let [one, two] =
                [&before, &after].map(|flux| sides.outflows(cell, flux).iter().sum::<f64>());
            assert!((one - two).abs() < 1e-12);
        }
        let facets = problem.mesh.facets();
        for (facet, &BoundarySide { side, .. }) in facets.iter().zip(sides.of_facets()) {
            match problem.mesh.law(facet) {
                Law::FREE => assert!(after[side as usize] == 0.0),
                Law::FIXED => {}
                _ => assert!(after[side as usize] >= 0.0),
            }
        }
    }
}

#[test]
fn the_identity_holds_to_rounding() {
    let (problem, bounds) = annulus(Law::FIXED).levels(3).pop().unwrap();
    let load = load_of_cells(&problem.mesh, &problem.f.cells.mean);
    let [low, high] = bounds.energy;
    assert!((problem.network.energy(&problem.y, &load) - high).abs() < 1e-11);
    assert!((2.0 * (high - low) - bounds.error[1].powi(2)).abs() < 1e-11);
    assert_eq!(bounds.recovered, None);
    // The lower bound is that of a quadratic function.
    assert!(0.5 * bounds.error[1] < bounds.error[0] && bounds.error[0] < bounds.error[1]);
}

#[test]
fn domains_that_touch_in_a_node_are_bounded_together() {
    let data = MeshData {
        points: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]],
        cells: vec![[0, 1, 2], [0, 3, 4]],
        facets: vec![Facet { nodes: [0, 1], part: 0 }, Facet { nodes: [3, 4], part: 1 }],
        parts: vec![straight("fixed", Law::FIXED), straight("free", Law::FREE)],
        ..MeshData::default()
    };
    let mut problem = TestProblem::new(data.mesh().unwrap(), vec![1.0, -2.0]);
    let levels = problem.clone().levels(5);
    let energies: Vec<_> = levels.iter().map(|(_, bounds)| bounds.energy).collect();
    assert!(overlap(&energies), "{energies:?}");
    let [low, high] = energies[4];
    assert!(high - low < 2e-2 * high.abs(), "{low} {high}");
    // The half that has no fixed side decides.
    problem.f.cells.mean[1] = 0.0;
    let found = bounds_on_mesh(&problem.mesh, &problem.network, &problem.f, &problem.y);
    assert!(matches!(found, Err(NoBound::Unsolvable(_))), "{found:?}");
}

fn refused(problem: &TestProblem<2, 3>, expected: NoBound) {
    let found = bounds_on_mesh(&problem.mesh, &problem.network, &problem.f, &problem.y);
    assert_eq!(found, Err(expected));
    assert!(!expected.to_string().contains('\n'));
}

#[test]
fn problems_without_bounds_are_refused_with_one_line() {
    let balanced = [f64::NEG_INFINITY, 0.0];
    let zero = Unsolvable {
        component: None,
        integral: 0.0,
        balanced,
        enough: None,
        has_parts: true,
        has_fluxes: false,
    };
    refused(&disc([0.0; 6]), zero.into());
    let mut free = disc([-1.0; 6]);
    free.mesh.parts_mut()[0].law = Law::FREE;
    let found = bounds_on_mesh(&free.mesh, &free.network, &free.f, &free.y).unwrap_err();
    assert!(found.to_string().contains("free everywhere"), "{found}");
    for place in [0, 3] {
        let mut nan = disc([-1.0; 6]);
        nan.y[place] = f64::NAN;
        refused(&nan, NoBound::NotFinite);
        let mut nan = disc([-1.0; 6]);
        nan.f.cells.mean[place] = f64::NAN;
        refused(&nan, NoBound::NotFinite);
    }
    refused(&disc([-1e200; 6]), NoBound::NotFinite);
    refused(&disc([-1e-200; 6]), NoBound::NotFinite);
}
