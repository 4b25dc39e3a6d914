//! Brackets of problems whose energy and solution are known: on the unit square u depends on x alone, with u = 0 on the
//! left, a law on the right and free sides between.
//!
//! With `M = int x f dx`, `u' = q + int_x^1 f`, and q the point of the interval of the law next to -M; `J(u) = -1/2 int
//! u'^2`. Vectors are spoilt on the sides and inside, in both directions and by all sizes, so that each term of the
//! bounds is the largest of some of them.

use super::bounds_on_mesh;
use super::{Facet, MeshData, straight};
use crate::bounds::triangulation::BoundedProblem;
use crate::discrete::network::Network;
use crate::mesh::{MeshLoad, PlaneMesh, Sides, assemble, mesh_load};
use crate::problem::law::Law;
use crate::problem::source::Source;

/// Part of f along x: where it ends, and its value and slope from 0 on.
type LinearPart = (f64, [f64; 2]);

/// Functions f of x, as text and as parts.
const SOURCES: [(&str, &[LinearPart]); 7] = [
    ("else=-1", &[(1.0, [-1.0, 0.0])]),
    ("else=2", &[(1.0, [2.0, 0.0])]),
    ("halfplane(1,0,0.3)=5; else=-4", &[(0.3, [5.0, 0.0]), (1.0, [-4.0, 0.0])]),
    ("halfplane(1,0,0.1)=10; else=0", &[(0.1, [10.0, 0.0]), (1.0, [0.0, 0.0])]),
    // A jump so small that hardly anything but what is spoilt is an error.
    ("halfplane(1,0,0.33)=2; else=2.01", &[(0.33, [2.0, 0.0]), (1.0, [2.01, 0.0])]),
    ("formula(2-2*x)", &[(1.0, [2.0, -2.0])]),
    ("formula(3*x-2)", &[(1.0, [-2.0, 3.0])]),
];

/// The solution.
struct Line {
    /// `|grad u|^2`.
    square: f64,
    /// u' on the left and on the right.
    slopes: [f64; 2],
}

impl Line {
    fn new(parts: &[LinearPart], law: Law) -> Self {
        const POINTS: usize = 4000;
        let (mut moment, mut sum, mut squares) = (0.0, 0.0, [0.0; 3]);
        let mut start = parts.iter().rev().skip(1).map(|part| part.0).chain([0.0]);
        for &(end, [value, slope]) in parts.iter().rev() {
            let step = (end - start.next().unwrap()) / POINTS as f64;
            for k in 0..POINTS {
                let x = end - (k as f64 + 0.5) * step;
                let f = value + slope * x;
                moment += x * f * step;
                // Integral of f from x on.
                let after = sum + 0.5 * f * step;
                squares = [0, 1, 2].map(|p| squares[p] + after.powi(p as i32) * step);
                sum += f * step;
            }
        }
        let q = (-moment).clamp(law.lo(), law.hi());
        let square = q * q * squares[0] + 2.0 * q * squares[1] + squares[2];
        Self { square, slopes: [q + sum, q] }
    }

    fn energy(&self) -> f64 {
        -0.5 * self.square
    }
}

/// Unit square of n by n cells, each cut by the rising diagonal; fixed on the left, under a law on the right.
fn mesh(n: u32, law: Law) -> PlaneMesh {
    let parts = [("fixed", Law::FIXED), ("law", law), ("free", Law::FREE)];
    let parts = parts.map(|(name, law)| straight(name, law)).into();
    let mut data = MeshData { parts, ..MeshData::default() };
    for (j, i) in (0..=n).flat_map(|j| (0..=n).map(move |i| (j, i))) {
        data.points.push([i, j].map(|k| f64::from(k) / f64::from(n)));
        let node = j * (n + 1) + i;
        if i < n && j < n {
            let above = node + n + 1;
            data.cells.extend([[node, node + 1, above + 1], [node, above + 1, above]]);
        }
        if i < n && (j == 0 || j == n) {
            data.facets.push(Facet { nodes: [node, node + 1], part: 2 });
        }
        if j < n && (i == 0 || i == n) {
            data.facets.push(Facet { nodes: [node, node + n + 1], part: u16::from(i == n) });
        }
    }
    data.mesh().unwrap()
}

/// A problem on a mesh with its solution.
struct KnownProblem {
    mesh: PlaneMesh,
    network: Network,
    f: MeshLoad,
    law: Law,
    line: Line,
    n: usize,
}

impl KnownProblem {
    fn new(n: u32, (text, parts): (&str, &[LinearPart]), law: Law) -> Self {
        let mesh = mesh(n, law);
        let f = mesh_load(&mesh, &text.parse::<Source>().unwrap()).unwrap();
        let network = assemble(&mesh);
        Self { network, f, law, line: Line::new(parts, law), mesh, n: n as usize }
    }

    /// u' at a place.
    fn slope(&self, parts: &[LinearPart], x: f64) -> f64 {
        let (mut after, mut start) = (self.line.slopes[1], 0.0);
        for &(to, [value, slope]) in parts {
            let from = f64::max(start, x);
            if from < to {
                after += (to - from) * (value + 0.5 * slope * (from + to));
            }
            start = to;
        }
        after
    }

    /// Values of u at the nodes.
    fn values(&self, parts: &[LinearPart]) -> Vec<f64> {
        const POINTS: usize = 400;
        let mut columns = Vec::new();
        for i in 0..=self.n {
            let step = i as f64 / self.n as f64 / POINTS as f64;
            let points = (0..POINTS).map(|k| (k as f64 + 0.5) * step);
            columns.push(points.map(|x| step * self.slope(parts, x)).sum::<f64>());
        }
        (0..self.mesh.points().len()).map(|node| columns[node % (self.n + 1)]).collect()
    }

    /// Mean of a nodal vector along a column of nodes.
    fn mean_at(&self, i: usize, y: &[f64]) -> f64 {
        let column: Vec<f64> = y.iter().skip(i).step_by(self.n + 1).copied().collect();
        column.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).sum::<f64>() / self.n as f64
    }

    /// Norm of the gradient of u less the linear function of a vector.
    fn error(&self, y: &[f64]) -> f64 {
        let square = 2.0 * self.network.energy(y, &vec![0.0; y.len()]);
        let load: f64 = self.f.load.iter().zip(y).map(|(f, y)| f * y).sum();
        let [left, right] = self.line.slopes;
        let product = load + right * self.mean_at(self.n, y) - left * self.mean_at(0, y);
        (self.line.square - 2.0 * product + square).max(0.0).sqrt()
    }

    fn check(&self, text: &str, y: &[f64]) {
        let bounds = bounds_on_mesh(&self.mesh, &self.network, &self.f, y).unwrap();
        let (energy, error, [low, high]) = (self.line.energy(), self.error(y), bounds.energy);
        let place = format!("{text}, 1/{}, {}: {y:?}", self.n, self.law);
        assert!(low <= energy + 1e-6 && energy - 1e-6 <= high, "{place}: {low} {energy} {high}");
        let [least, most] = bounds.error;
        assert!(least <= error + 1e-6 && error - 1e-6 <= most, "{place}: {least} {error} {most}");
    }
}

/// Amounts added to one node, to a column, or to all but the fixed side.
fn spoilt(n: usize, y: &[f64]) -> Vec<Vec<f64>> {
    let (side, mut all) = (n + 1, vec![y.to_vec(), vec![0.0; y.len()]]);
    for size in [0.5, -0.5, 0.02, -0.02] {
        for column in 0..side {
            let mut one = y.to_vec();
            one[column + side * (column % side)] += size;
            all.push(one);
            let mut whole = y.to_vec();
            whole.iter_mut().skip(column).step_by(side).for_each(|value| *value += size);
            all.push(whole);
        }
        all.push(y.iter().map(|value| value * (1.0 + size)).collect());
    }
    all
}

#[test]
fn brackets_hold_known_energies_and_errors_of_spoilt_vectors() {
    let laws = [
        Law::SIGNORINI,
        Law::friction(0.4).unwrap(),
        Law::friction(2.0).unwrap(),
        Law::limited(0.2).unwrap(),
    ];
    for (source, n) in SOURCES.iter().flat_map(|&source| [1, 3].map(|n| (source, n))) {
        for law in laws {
            let problem = KnownProblem::new(n, source, law);
            // Nearly that of a free side.
            let free = KnownProblem::new(n, source, Law::limited(1e-9).unwrap());
            for y in [problem.values(source.1), free.values(source.1)] {
                for y in spoilt(n as usize, &y) {
                    problem.check(source.0, &y);
                }
            }
        }
    }
}

#[test]
fn the_squares_of_the_errors_in_the_cells_sum_to_that_of_the_whole() {
    let problem = KnownProblem::new(4, SOURCES[1], Law::friction(0.4).unwrap());
    // The flux at a node with a small value is not at the end of the law, and does work.
    for value in [None, Some(0.7), Some(0.01)] {
        let mut y = problem.values(SOURCES[1].1);
        y[9] = value.unwrap_or(y[9]);
        let sides = Sides::new(&problem.mesh);
        let KnownProblem { mesh, network, f, .. } = &problem;
        let found = BoundedProblem { mesh, sides: &sides, network, f }.bounds(&y).unwrap();
        let sum: f64 = found.squares.iter().sum();
        let square = found.bounds.error[1].powi(2);
        assert!((sum - square).abs() < 1e-9 * square, "{sum} {square}");
    }
}

#[test]
fn the_means_of_f_alone_are_no_upper_bound() {
    // By the means the energy of this vector is -0.107, below the least one, -0.1.
    let problem = KnownProblem::new(1, SOURCES[5], Law::SIGNORINI);
    problem.check(SOURCES[5].0, &[0.0, 0.37, 0.0, 0.52]);
}

#[test]
fn deviations_of_f_from_its_means_count_by_poincares_constant() {
    // f is 1 below the falling diagonal and -1 above: without mean on both cells. The energy of c (cos pi x + cos pi y)
    // is an upper bound of the least one, where friction takes 0.0033 at most.
    let f: Source = "halfplane(1,1,1)=-1; else=1".parse().unwrap();
    let data = MeshData {
        points: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        cells: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    };
    let mesh = data.mesh().unwrap().with_law(Law::friction(0.01).unwrap());
    let load = mesh_load(&mesh, &f).unwrap();
    let found = bounds_on_mesh(&mesh, &assemble(&mesh), &load, &[0.0; 4]).unwrap();
    assert!(found.energy[0] < -0.030, "{found:?}");
}
