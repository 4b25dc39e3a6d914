//! The iteration (9)-(13) for all rows of a table at once: one lane per r, one load for all lanes.
//!
//! The arithmetic is that of [`crate::saddle`], operation by operation, so that the iterates agree to
//! the last bit; the lanes only put the five independent runs side by side, where they share loads,
//! neighbours and instructions. A lane that has made its iterations goes on unused.

use super::variant::{Measure, Order, ResidualTime, Variant};
use crate::discrete::grid::Grid;
use crate::discrete::transfer::Prolongation;

/// Rows carried at once: the five of the paper and one spare, to fill pairs of doubles.
pub(super) const LANES: usize = 6;

/// One number per row of the table.
pub(super) type Lane = [f64; LANES];

#[inline]
fn lanes(f: impl Fn(usize) -> f64) -> Lane {
    std::array::from_fn(f)
}

/// A boundary node and the neighbours its row of the stiffness matrix refers to.
#[derive(Clone, Copy)]
struct Edge {
    node: u32,
    /// The two neighbours along the boundary, each with the entry -1/2.
    along: [u32; 2],
    /// The neighbour inside with the entry -1, none at a corner.
    inward: Option<u32>,
    /// Weight of the multiplier, h or its multiple at a corner.
    weight: f64,
}

/// A grid with the state of the iteration on it and the buffers it needs.
pub(super) struct Level {
    grid: Grid,
    edges: Vec<Edge>,
    /// Position in `edges` of every boundary node in the order of rows.
    by_rows: Vec<u32>,
    pub(super) y: Vec<Lane>,
    /// Boundary vector.
    pub(super) a: Vec<Lane>,
    /// Row in which each lane last failed the comparison: the likeliest to fail next.
    failed: [usize; LANES],
}

impl Level {
    pub(super) fn new(grid: Grid, variant: &Variant) -> Self {
        let n = grid.cells();
        let edge = |b: usize| {
            let neighbour = |b: usize| {
                let (i, j) = grid.boundary_node(b % (4 * n));
                grid.index(i, j) as u32
            };
            let (i, j) = grid.boundary_node(b);
            let corner = grid.is_corner(b);
            let inward = match (i, j) {
                _ if corner => None,
                (_, 0) => Some(grid.index(i, 1)),
                (0, _) => Some(grid.index(1, j)),
                _ if i == n => Some(grid.index(n - 1, j)),
                _ => Some(grid.index(i, n - 1)),
            };
            Edge {
                node: grid.index(i, j) as u32,
                along: [neighbour(b + 4 * n - 1), neighbour(b + 1)],
                inward: inward.map(|node| node as u32),
                weight: grid.h() * if corner { variant.corner_weight() } else { 1.0 },
            }
        };
        let edges: Vec<Edge> = (0..grid.boundary_nodes()).map(edge).collect();
        let mut by_rows: Vec<u32> = (0..edges.len() as u32).collect();
        by_rows.sort_by_key(|&b| edges[b as usize].node);
        Self {
            grid,
            edges,
            by_rows,
            y: vec![[0.0; LANES]; grid.nodes()],
            a: vec![[0.0; LANES]; grid.boundary_nodes()],
            failed: [0; LANES],
        }
    }

    pub(super) fn reset(&mut self) {
        self.y.fill([0.0; LANES]);
        self.a.fill([0.0; LANES]);
    }

    /// One sweep (9)-(11).
    pub(super) fn sweep(&mut self, load: &[f64], r: &Lane, order: Order) {
        let n = self.grid.cells();
        match order {
            Order::Lexicographic => {
                let mut at = 0;
                for j in 0..=n {
                    let inner = j != 0 && j != n;
                    let ends = if inner { 1 } else { n + 1 };
                    self.relax_boundary(load, r, at, ends);
                    at += ends;
                    if inner {
                        self.relax_row(load, j);
                        self.relax_boundary(load, r, at, 1);
                        at += 1;
                    }
                }
            }
            Order::BoundaryFirst => {
                self.relax_boundary(load, r, 0, self.edges.len());
                (1..n).for_each(|j| self.relax_row(load, j));
            }
            Order::InteriorFirst => {
                (1..n).for_each(|j| self.relax_row(load, j));
                self.relax_boundary(load, r, 0, self.edges.len());
            }
        }
    }

    /// (9) for the interior nodes of row `j`, from west to east.
    fn relax_row(&mut self, load: &[f64], j: usize) {
        let (side, first) = (self.grid.side(), j * self.grid.side());
        let (below, rest) = self.y.split_at_mut(first);
        let (row, above) = rest.split_at_mut(side);
        let south = &below[first - side..][..side];
        let north = &above[..side];
        let load = &load[first..][..side];
        let row = &mut row[..side];
        let mut west = row[0];
        for i in 1..side - 1 {
            let (s, n, e, f) = (&south[i], &north[i], &row[i + 1], load[i]);
            west = lanes(|k| 0.25 * (((s[k] + n[k]) + (e[k] + f)) + west[k]));
            row[i] = west;
        }
    }

    /// (10) and (11) for `count` boundary nodes from the `first` on in the order of rows.
    fn relax_boundary(&mut self, load: &[f64], r: &Lane, first: usize, count: usize) {
        for &b in &self.by_rows[first..first + count] {
            let edge = self.edges[b as usize];
            let sum = self.neighbours(&edge, load);
            let (diagonal, inverse) = if edge.inward.is_some() { (2.0, 0.5) } else { (1.0, 1.0) };
            let (a, h) = (&self.a[b as usize], edge.weight);
            self.y[edge.node as usize] = lanes(|k| {
                let psi = inverse * sum[k];
                let held = (sum[k] + h * a[k]) / (diagonal + h * r[k]);
                if psi >= a[k] / r[k] { psi } else { held }
            });
        }
    }

    /// `F_i - sum_j A_ij y_j` over the neighbours j of a boundary node.
    fn neighbours(&self, edge: &Edge, load: &[f64]) -> Lane {
        let [p, q] = edge.along.map(|node| &self.y[node as usize]);
        let f = load[edge.node as usize];
        match edge.inward {
            Some(node) => {
                let inner = &self.y[node as usize];
                lanes(|k| 0.5 * (p[k] + q[k]) + inner[k] + f)
            }
            None => lanes(|k| 0.5 * (p[k] + q[k]) + f),
        }
    }

    /// The dual step (12); the largest change in each lane.
    pub(super) fn dual_step(&mut self, r: &Lane) -> Lane {
        let mut change = [0.0f64; LANES];
        for (edge, a) in self.edges.iter().zip(&mut self.a) {
            let y = &self.y[edge.node as usize];
            for k in 0..LANES {
                let next = a[k] - r[k] * y[k];
                let next = if next > 0.0 { next } else { 0.0 };
                change[k] = change[k].max((next - a[k]).abs());
                a[k] = next;
            }
        }
        change
    }

    /// The largest component of the gradient (8), or of its absolute value, in row `j`.
    fn gradient_row(&self, load: &[f64], r: &Lane, measure: Measure, j: usize, max: &mut Lane) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let absolute = measure == Measure::Printed;
        let mut note = |g: Lane| {
            for k in 0..LANES {
                let g = if absolute { g[k].abs() } else { g[k] };
                // This form compiles to one instruction per pair of lanes.
                max[k] = if g <= max[k] { max[k] } else { g };
            }
        };
        let mut boundary = |b: usize| {
            let edge = self.edges[b];
            let (y, a) = (&self.y[edge.node as usize], &self.a[b]);
            let sum = self.neighbours(&edge, load);
            let diagonal = if edge.inward.is_some() { 2.0 } else { 1.0 };
            note(lanes(|k| diagonal * y[k] - sum[k] - edge.weight * (a[k] - r[k] * y[k]).max(0.0)));
        };
        if j == 0 {
            (0..=n).for_each(boundary);
        } else if j == n {
            (2 * n..=3 * n).for_each(boundary);
        } else {
            boundary(4 * n - j);
            boundary(n + j);
            let row = |j: usize| &self.y[j * side..][..side];
            let (south, here, north) = (row(j - 1), row(j), row(j + 1));
            let load = &load[j * side..][..side];
            for i in 1..n {
                let (s, n, w, e) = (&south[i], &north[i], &here[i - 1], &here[i + 1]);
                let (y, f) = (&here[i], load[i]);
                note(lanes(|k| 4.0 * y[k] - (s[k] + n[k]) - (w[k] + e[k]) - f));
            }
        }
    }

    /// The stopping measure of every lane.
    pub(super) fn gradient(&self, load: &[f64], r: &Lane, measure: Measure) -> Lane {
        let mut max = [f64::NEG_INFINITY; LANES];
        for j in 0..self.grid.side() {
            self.gradient_row(load, r, measure, j, &mut max);
        }
        max
    }

    /// Whether the measure exceeds `tolerance` in every lane of `wanted`, seen from few rows.
    ///
    /// `false` only says that the rows which failed last no longer tell.
    pub(super) fn surely_above(
        &self,
        load: &[f64],
        r: &Lane,
        measure: Measure,
        wanted: &[bool; LANES],
        tolerance: f64,
    ) -> bool {
        let mut max = [f64::NEG_INFINITY; LANES];
        for k in 0..LANES {
            let told = max[k] > tolerance;
            if wanted[k] && !told {
                self.gradient_row(load, r, measure, self.failed[k], &mut max);
            }
        }
        (0..LANES).all(|k| !wanted[k] || max[k] > tolerance)
    }

    /// [`Self::gradient`], which also remembers the row of each lane's maximum.
    pub(super) fn gradient_noting(&mut self, load: &[f64], r: &Lane, measure: Measure) -> Lane {
        let mut max = [f64::NEG_INFINITY; LANES];
        for j in 0..self.grid.side() {
            let before = max;
            self.gradient_row(load, r, measure, j, &mut max);
            for k in 0..LANES {
                if max[k] != before[k] {
                    self.failed[k] = j;
                }
            }
        }
        max
    }

    /// Starts lane `k` of this grid from the prolongation of the same lane of the `coarse` one.
    pub(super) fn start_from(&mut self, coarse: &Level, k: usize, rule: Prolongation, dual: bool) {
        let (n, side) = (coarse.grid.cells(), self.grid.side());
        let at = |i: usize, j: usize| coarse.y[coarse.grid.index(i, j)][k];
        for j in 0..=n {
            for i in 0..=n {
                let p = 2 * j * side + 2 * i;
                self.y[p][k] = at(i, j);
                if i < n {
                    self.y[p + 1][k] = 0.5 * (at(i, j) + at(i + 1, j));
                }
                if j < n {
                    self.y[p + side][k] = 0.5 * (at(i, j) + at(i, j + 1));
                }
                if i < n && j < n {
                    let rising = at(i, j) + at(i + 1, j + 1);
                    let falling = at(i + 1, j) + at(i, j + 1);
                    self.y[p + side + 1][k] = match rule {
                        Prolongation::Bilinear => 0.25 * (rising + falling),
                        Prolongation::RisingDiagonal => 0.5 * rising,
                        Prolongation::FallingDiagonal => 0.5 * falling,
                    };
                }
            }
        }
        for b in 0..coarse.a.len() {
            let (here, next) = (coarse.a[b][k], coarse.a[(b + 1) % coarse.a.len()][k]);
            self.a[2 * b][k] = if dual { here } else { 0.0 };
            self.a[2 * b + 1][k] = if dual { 0.5 * (here + next) } else { 0.0 };
        }
    }

    /// Sweep, dual step and, if it is due before the dual step, the measure.
    pub(super) fn iterate(
        &mut self,
        load: &[f64],
        r: &Lane,
        variant: &Variant,
    ) -> (Lane, Option<Lane>) {
        self.sweep(load, r, variant.order);
        let early = (variant.residual == ResidualTime::BeforeDual)
            .then(|| self.gradient(load, r, variant.measure));
        (self.dual_step(r), early)
    }
}
