//! The published counts in single precision, by a plain copy of the method.

use crate::common::this_project as project;
use signorini::replication::scene::Scene;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::load;
use signorini_mathematics::saddle::{NestedGrids, Pair, run_nested, tolerance};

/// Neighbours of a node in its row of the stiffness matrix (5).
enum Row {
    /// South, north, east, west: the entries are -1, and 4 on the diagonal.
    Inside([usize; 4]),
    /// Boundary node `b`, with two neighbours along the boundary, and one inside unless the node is a corner: the
    /// entries are -1/2, -1/2, -1, and 2 on the diagonal; that of a corner is 1.
    Boundary { b: usize, along: [usize; 2], inward: Option<usize> },
}

impl Row {
    fn of(grid: Grid, k: usize) -> Self {
        let (n, side) = (grid.cells(), grid.side());
        let (i, j) = (k % side, k / side);
        let beside = if i == 0 { k + 1 } else { k - 1 };
        let across = if j == 0 { k + side } else { k - side };
        let (along, inward) = match ([0, n].contains(&i), [0, n].contains(&j)) {
            (false, false) => return Self::Inside([k - side, k + side, k + 1, k - 1]),
            (true, true) => ([beside, across], None),
            (true, false) => ([k - side, k + side], Some(beside)),
            (false, true) => ([k - 1, k + 1], Some(across)),
        };
        Self::Boundary { b: grid.boundary_index(i, j), along, inward }
    }
}

/// The method (9)-(13) with the signed rule on one grid. The operations, and their order, are those of the definition
/// `saddle/plain.rs`.
struct Single {
    rows: Vec<Row>,
    load: Vec<f32>,
    h: f32,
    r: f32,
    y: Vec<f32>,
    a: Vec<f32>,
}

impl Single {
    /// Terms of the neighbours of a boundary node, along the boundary and inward, and the diagonal.
    fn terms(&self, along: [usize; 2], inward: Option<usize>) -> [f32; 3] {
        let along = 0.5 * (self.y[along[0]] + self.y[along[1]]);
        let diagonal = if inward.is_some() { 2.0 } else { 1.0 };
        [along, inward.map_or(0.0, |k| self.y[k]), diagonal]
    }

    /// Makes a sweep (9)-(11) and a step (12).
    fn iterate(&mut self) {
        for k in 0..self.rows.len() {
            let (y, load) = (&self.y, self.load[k]);
            self.y[k] = match self.rows[k] {
                Row::Inside([south, north, east, west]) => {
                    (((y[south] + y[north]) + (y[east] + load)) + y[west]) / 4.0
                }
                Row::Boundary { b, along, inward } => {
                    let [along, inward, diagonal] = self.terms(along, inward);
                    let (sum, a) = (along + inward + load, self.a[b]);
                    let free = sum / diagonal;
                    let held = (sum + self.h * a) / (diagonal + self.h * self.r);
                    if free >= a / self.r { free } else { held }
                }
            };
        }
        for (k, row) in self.rows.iter().enumerate() {
            if let Row::Boundary { b, .. } = *row {
                self.a[b] = (self.a[b] - self.r * self.y[k]).max(0.0);
            }
        }
    }

    /// Component of the gradient (8) at node `k`.
    fn gradient(&self, k: usize) -> f32 {
        let (y, load) = (&self.y, self.load[k]);
        match self.rows[k] {
            Row::Inside([south, north, east, west]) => {
                4.0 * y[k] - (y[south] + y[north]) - (y[west] + y[east]) - load
            }
            Row::Boundary { b, along, inward } => {
                let [along, inward, diagonal] = self.terms(along, inward);
                let pull = (self.a[b] - self.r * y[k]).max(0.0);
                diagonal * y[k] - along - inward - load - self.h * pull
            }
        }
    }

    /// Iterates until no component of the gradient exceeds `tolerance`. Returns the number of iterations, or `None`
    /// after `limit`.
    fn count(&mut self, tolerance: f32, limit: usize) -> Option<usize> {
        for iteration in 1..=limit {
            self.iterate();
            if (0..self.rows.len()).all(|k| self.gradient(k) <= tolerance) {
                return Some(iteration);
            }
        }
        None
    }
}

/// Rounds to single precision.
fn narrow(values: &[f64]) -> Vec<f32> {
    values.iter().map(|&value| value as f32).collect()
}

/// Returns the same numbers in double precision.
fn wide(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&value| value.into()).collect()
}

/// Returns the counts for one r on all grids of a scene. From grid to grid the pair is prolonged in double precision.
fn counts(scene: &Scene, r: f64, limit: usize) -> Vec<Option<usize>> {
    let (grids, mut counts) = (&scene.grids()[..], Vec::new());
    let levels = NestedGrids { grids, prolongation: scene.saddle().prolongation };
    run_nested(&levels, &mut [Pair::zero(grids[0])], |k, [pair]: &mut [Pair; 1]| {
        let grid = grids[k];
        let mut single = Single {
            rows: (0..grid.nodes()).map(|node| Row::of(grid, node)).collect(),
            load: narrow(&load(grid, &scene.source(), scene.load())),
            h: grid.h() as f32,
            r: r as f32,
            y: narrow(&pair.y),
            a: narrow(&pair.a),
        };
        counts.push(single.count(tolerance(k + 1) as f32, limit));
        *pair = Pair { y: wide(&single.y), a: wide(&single.a) };
        Ok::<(), ()>(())
    })
    .unwrap();
    counts
}

#[test]
fn single_precision_changes_no_published_count() {
    let project = project();
    let (mut same, mut changed) = (0, Vec::new());
    for scene in &project.scenes {
        let Some(number) = scene.paper_table else { continue };
        let table = project.paper.table.iter().find(|table| table.number == number).unwrap();
        for (&r, published) in project.paper.r.iter().zip(&table.counts) {
            let limit = 2 * published.iter().max().unwrap();
            let counts = counts(scene, r, limit);
            assert_eq!(counts.len(), published.len());
            for (k, (&ours, &theirs)) in counts.iter().zip(published).enumerate() {
                if ours == Some(theirs) {
                    same += 1;
                } else {
                    changed.push((number, r, k, theirs, ours));
                }
            }
        }
    }
    assert_eq!((same, changed), (50, Vec::new()));
}
