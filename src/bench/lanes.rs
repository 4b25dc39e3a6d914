//! Many runs of Arrow-Hurwicz and Uzawa on one grid at once, one per vector lane, each as if it were alone.
//!
//! A sweep waits at each node for its western neighbour, and all runs wait alike: eight of them
//! side by side cost little more than one. A run's stopping rule is first tried at the node that broke it
//! last; all nodes are looked at only when that one no longer does. The counts are those of
//! [`arrow_hurwicz`](crate::saddle::arrow_hurwicz) and [`uzawa`](crate::saddle::uzawa).

use crate::grid::Grid;
use crate::saddle::{Pair, StopRule};
use crate::stiffness::residual;
use std::array::from_fn;
use std::ops::{Add, Mul};

/// Runs side by side.
pub const LANES: usize = 8;

/// When the multiplier is stepped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// After each sweep.
    ArrowHurwicz,
    /// When the inner gradient, with the proximal term of this weight (none if zero), is small enough.
    Uzawa {
        /// Weight c of [`ProximalParams`](crate::saddle::ProximalParams).
        weight: f64,
        /// The bound on the inner gradient that is always enough, in units of F.
        inner: f64,
        /// Whether a tenth of the gradient at the last step of the multiplier is enough as well.
        loose: bool,
    },
}

/// When a run has reached its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// A stopping rule with its tolerance, tried after each step of the multiplier.
    Rule(StopRule, f64),
    /// The natural KKT residual over the largest component of F, tried after each step of the multiplier.
    Kkt(f64),
}

/// A run to be done.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// Load vector F.
    pub load: &'a [f64],
    /// Where it starts.
    pub start: &'a Pair,
    /// The method.
    pub method: Method,
    /// Duality parameter r > 0.
    pub r: f64,
    /// When it ends.
    pub goal: Goal,
    /// Sweeps after which to give up.
    pub cap: usize,
}

/// How a run ended.
#[derive(Clone, Debug)]
pub struct End {
    /// Sweeps done.
    pub sweeps: usize,
    /// Whether the goal was reached.
    pub met: bool,
    /// Change of the multiplier in its last step.
    pub delta_a: f64,
    /// The last pair.
    pub pair: Pair,
}

/// Does all jobs; the ends are in the order of the jobs.
///
/// # Panics
/// If a load vector or a start has the wrong length for `grid`.
pub fn run(grid: Grid, jobs: &[Job]) -> Vec<End> {
    let mut ends: Vec<Option<End>> = vec![None; jobs.len()];
    let mut waiting = jobs.iter().enumerate();
    let mut lanes = Lanes::new(grid);
    let mut runs: [Option<Run>; LANES] = [const { None }; LANES];
    loop {
        for (lane, run) in runs.iter_mut().enumerate().filter(|(_, run)| run.is_none()) {
            *run = waiting.next().map(|(number, job)| lanes.enter(lane, number, job));
        }
        if runs.iter().all(Option::is_none) {
            return ends.into_iter().flatten().collect();
        }
        lanes.sweep();
        let steps = from_fn(|lane| {
            runs[lane].as_mut().is_some_and(|run| match run.job.method {
                Method::ArrowHurwicz => true,
                Method::Uzawa { .. } => {
                    lanes.within(lane, Measure::Inner, run.inner, &mut run.inner_witness, run.job)
                }
            })
        });
        let changes = lanes.step(steps);
        for lane in 0..LANES {
            let Some(run) = runs[lane].as_mut() else { continue };
            run.sweeps += 1;
            if steps[lane] {
                run.delta_a = changes[lane];
                lanes.after_step(lane, run);
            }
            let met = steps[lane] && run.met(&mut lanes, lane);
            if met || run.sweeps == run.job.cap {
                let Run { sweeps, delta_a, .. } = *run;
                ends[run.number] = Some(End { sweeps, met, delta_a, pair: lanes.pair(lane) });
                runs[lane] = None;
            }
        }
    }
}

/// A job in a lane.
struct Run<'a> {
    number: usize,
    job: &'a Job<'a>,
    sweeps: usize,
    delta_a: f64,
    /// Bound on the inner gradient.
    inner: f64,
    /// Nodes that broke the goal and the inner bound when last looked at.
    witness: usize,
    inner_witness: usize,
    /// Largest component of F.
    scale: f64,
}

impl Run<'_> {
    /// Whether the goal is reached, after a step of the multiplier.
    fn met(&mut self, lanes: &mut Lanes, lane: usize) -> bool {
        let (measure, bound, dual) = match self.job.goal {
            Goal::Kkt(target) => (Measure::Kkt, target * self.scale, false),
            Goal::Rule(StopRule::Signed, tolerance) => (Measure::Signed, tolerance, false),
            Goal::Rule(StopRule::Printed, tolerance) => (Measure::Printed, tolerance, false),
            Goal::Rule(StopRule::SignedDual, tolerance) => (Measure::Signed, tolerance, true),
            Goal::Rule(StopRule::PrintedDual, tolerance) => (Measure::Printed, tolerance, true),
        };
        (!dual || self.delta_a <= bound)
            && lanes.within(lane, measure, bound, &mut self.witness, self.job)
    }
}

/// What is measured at a node.
#[derive(Clone, Copy, PartialEq)]
enum Measure {
    /// The gradient (8).
    Signed,
    /// Its absolute value.
    Printed,
    /// The same, with the proximal term.
    Inner,
    /// `|A y - F|` inside, `|min(y, A y - F)|` on the boundary.
    Kkt,
}

/// A number per lane.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct V([f64; LANES]);

impl Add for V {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] + other.0[l]))
    }
}

impl Mul for V {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] * other.0[l]))
    }
}

impl V {
    fn all(value: f64) -> Self {
        Self([value; LANES])
    }
}

/// The iterates of all lanes, node by node, and room for one of them apart.
struct Lanes {
    grid: Grid,
    r: V,
    /// The proximal term's share of an interior node.
    shift: V,
    /// Diagonals of edge and corner rows, each with its inverse, and the inverse inside.
    edge: [V; 2],
    corner: [V; 2],
    inside: V,
    y: Vec<V>,
    a: Vec<V>,
    /// F, with the proximal term.
    load: Vec<V>,
    boundary: Vec<usize>,
    y_apart: Vec<f64>,
    load_apart: Vec<f64>,
    values: Vec<f64>,
}

impl Lanes {
    fn new(grid: Grid) -> Self {
        let nodes = || vec![V::all(0.0); grid.nodes()];
        let apart = || vec![0.0; grid.nodes()];
        Self {
            grid,
            r: V::all(1.0),
            shift: V::all(0.0),
            edge: [V::all(2.0), V::all(0.5)],
            corner: [V::all(1.0); 2],
            inside: V::all(0.25),
            y: nodes(),
            a: vec![V::all(0.0); grid.boundary_nodes()],
            load: nodes(),
            boundary: grid.boundary().collect(),
            y_apart: apart(),
            load_apart: apart(),
            values: apart(),
        }
    }

    fn enter<'a>(&mut self, lane: usize, number: usize, job: &'a Job) -> Run<'a> {
        assert!(job.load.len() == self.grid.nodes() && job.start.y.len() == self.grid.nodes());
        assert!(job.start.a.len() == self.grid.boundary_nodes() && job.r > 0.0);
        self.r.0[lane] = job.r;
        self.y.iter_mut().zip(&job.start.y).for_each(|(y, start)| y.0[lane] = *start);
        self.a.iter_mut().zip(&job.start.a).for_each(|(a, start)| a.0[lane] = *start);
        self.load.iter_mut().zip(job.load).for_each(|(load, f)| load.0[lane] = *f);
        let scale = job.load.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()));
        let (weight, inner) = match job.method {
            Method::ArrowHurwicz => (0.0, 0.0),
            Method::Uzawa { weight, inner, loose } => {
                (weight, if loose { inner.max(0.1 * scale) } else { inner })
            }
        };
        let shift = weight * self.grid.h() * self.grid.h();
        self.shift.0[lane] = shift;
        self.inside.0[lane] = 1.0 / (4.0 + shift);
        for (k, value) in [2.0 + 0.5 * shift, 1.0 + 0.25 * shift].into_iter().enumerate() {
            let [diagonal, inverse] = if k == 0 { &mut self.edge } else { &mut self.corner };
            (diagonal.0[lane], inverse.0[lane]) = (value, 1.0 / value);
        }
        self.regularise(lane, job.load);
        Run { number, job, sweeps: 0, delta_a: 0.0, inner, witness: 0, inner_witness: 0, scale }
    }

    /// Sets the proximal term to pull towards y as it is now.
    fn regularise(&mut self, lane: usize, load: &[f64]) {
        let shift = self.shift.0[lane];
        if shift > 0.0 {
            let (n, side) = (self.grid.cells(), self.grid.side());
            let half = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 };
            for (k, target) in self.load.iter_mut().enumerate() {
                target.0[lane] =
                    load[k] + half(k % side) * half(k / side) * shift * self.y[k].0[lane];
            }
        }
    }

    /// (9)-(11) in every lane.
    fn sweep(&mut self) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let inside = self.inside;
        for i in 0..=n {
            self.relax_boundary(i, i, 0);
        }
        for j in 1..n {
            self.relax_boundary(4 * n - j, 0, j);
            let (below, rest) = self.y.split_at_mut(j * side);
            let (row, above) = rest.split_at_mut(side);
            let south = &below[(j - 1) * side..][..side];
            let (north, load) = (&above[..side], &self.load[j * side..][..side]);
            let mut west = row[0];
            for i in 1..n {
                west = inside * (((south[i] + north[i]) + (row[i + 1] + load[i])) + west);
                row[i] = west;
            }
            self.relax_boundary(n + j, n, j);
        }
        for i in 0..=n {
            self.relax_boundary(3 * n - i, i, n);
        }
    }

    /// (10) and (11) at boundary node `b` (`4 n` is node 0 again), in column `i` and row `j`.
    fn relax_boundary(&mut self, b: usize, i: usize, j: usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let node = j * side + i;
        let (y, half) = (&self.y, V::all(0.5));
        let x = if i == 0 { y[node + 1] } else { y[node - 1] };
        let z = if j == 0 { y[node + side] } else { y[node - side] };
        let (neighbours, [diagonal, inverse]) = match (i == 0 || i == n, j == 0 || j == n) {
            (true, true) => (half * (x + z), self.corner),
            (_, true) => (half * (y[node - 1] + y[node + 1]) + z, self.edge),
            _ => (half * (y[node - side] + y[node + side]) + x, self.edge),
        };
        let (sum, a, h) = (neighbours + self.load[node], self.a[b], self.grid.h());
        self.y[node] = V(from_fn(|l| {
            let (psi, r) = (inverse.0[l] * sum.0[l], self.r.0[l]);
            let pulled = (sum.0[l] + h * a.0[l]) / (diagonal.0[l] + h * r);
            if psi >= a.0[l] / r { psi } else { pulled }
        }));
    }

    /// (12) in the lanes that step, and the largest change in each.
    fn step(&mut self, steps: [bool; LANES]) -> [f64; LANES] {
        let mut changes = [0.0f64; LANES];
        for (a, &node) in self.a.iter_mut().zip(&self.boundary) {
            let y = self.y[node];
            for l in 0..LANES {
                let next = a.0[l] - self.r.0[l] * y.0[l];
                let next = if next > 0.0 { next } else { 0.0 };
                let next = if steps[l] { next } else { a.0[l] };
                let change = (next - a.0[l]).abs();
                changes[l] = if change > changes[l] { change } else { changes[l] };
                a.0[l] = next;
            }
        }
        changes
    }

    /// Prepares the next inner minimisation.
    fn after_step(&mut self, lane: usize, run: &mut Run) {
        if let Method::Uzawa { inner, loose, .. } = run.job.method {
            if loose {
                let (gradient, _) = self.worst(lane, Measure::Printed, run.job);
                run.inner = (0.1 * gradient).max(inner);
            }
            self.regularise(lane, run.job.load);
        }
    }

    /// Whether a measure is at most `bound` everywhere; NaN never is.
    fn within(
        &mut self,
        lane: usize,
        measure: Measure,
        bound: f64,
        witness: &mut usize,
        job: &Job,
    ) -> bool {
        let load = match measure {
            Measure::Inner => self.load[*witness].0[lane],
            _ => job.load[*witness],
        };
        let flux = self.flux(lane, *witness, load);
        let (i, j) = (*witness % self.grid.side(), *witness / self.grid.side());
        let y = self.y[*witness].0[lane];
        let a = self.boundary_index(i, j).map(|b| self.a[b].0[lane]);
        let value = self.value(lane, measure, (i, j), y, flux, a);
        if !(value <= bound) {
            return false;
        }
        let (value, node) = self.worst(lane, measure, job);
        *witness = node;
        value <= bound
    }

    /// The largest value of a measure over all nodes, and where it is.
    fn worst(&mut self, lane: usize, measure: Measure, job: &Job) -> (f64, usize) {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let take = |from: &[V], to: &mut [f64]| {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = from.0[lane]);
        };
        take(&self.y, &mut self.y_apart);
        let mut load = job.load;
        if measure == Measure::Inner {
            take(&self.load, &mut self.load_apart);
            load = &self.load_apart;
        }
        residual(self.grid, &self.y_apart, load, &mut self.values);
        let mut values = std::mem::take(&mut self.values);
        for (b, &node) in self.boundary.iter().enumerate() {
            let (i, j) = (node % side, node / side);
            let a = Some(self.a[b].0[lane]);
            values[node] = self.value(lane, measure, (i, j), self.y_apart[node], values[node], a);
        }
        for j in 1..n {
            for i in 1..n {
                let k = j * side + i;
                values[k] = self.value(lane, measure, (i, j), self.y_apart[k], values[k], None);
            }
        }
        let mut worst = (f64::NEG_INFINITY, 0);
        for (node, &value) in values.iter().enumerate() {
            if !(value <= worst.0) {
                worst = (value, node);
            }
        }
        self.values = values;
        worst
    }

    /// The measure at a node, from y, `A y - F` and, on the boundary, the multiplier there.
    #[inline(always)]
    fn value(
        &self,
        lane: usize,
        measure: Measure,
        (i, j): (usize, usize),
        y: f64,
        flux: f64,
        a: Option<f64>,
    ) -> f64 {
        let mut flux = flux;
        if measure == Measure::Kkt {
            return if a.is_some() && y < flux { y.abs() } else { flux.abs() };
        }
        let n = self.grid.cells();
        if measure == Measure::Inner && self.shift.0[lane] > 0.0 {
            let shift = self.shift.0[lane];
            let mass = if j == 0 || j == n { 0.5 * shift } else { shift };
            flux += mass * y;
            if i == 0 || i == n {
                flux -= 0.5 * mass * y;
            }
        }
        if let Some(a) = a {
            flux -= self.grid.h() * (a - self.r.0[lane] * y).max(0.0);
        }
        if measure == Measure::Signed { flux } else { flux.abs() }
    }

    /// `A y - load` at a node of a lane, rounded as in [`residual`].
    fn flux(&self, lane: usize, node: usize, load: f64) -> f64 {
        let (n, side) = (self.grid.cells(), self.grid.side());
        let (i, j) = (node % side, node / side);
        let y = |k: usize| self.y[k].0[lane];
        let x = || if i == 0 { y(node + 1) } else { y(node - 1) };
        let z = || if j == 0 { y(node + side) } else { y(node - side) };
        let along_x = || y(node - 1) + y(node + 1);
        let along_y = || y(node - side) + y(node + side);
        match (i == 0 || i == n, j == 0 || j == n) {
            (true, true) => y(node) - 0.5 * (x() + z()) - load,
            (_, true) => 2.0 * y(node) - 0.5 * along_x() - z() - load,
            (true, _) => 2.0 * y(node) - 0.5 * along_y() - x() - load,
            _ => 4.0 * y(node) - along_y() - along_x() - load,
        }
    }

    /// Position in a boundary vector of the node in column `i` and row `j`.
    fn boundary_index(&self, i: usize, j: usize) -> Option<usize> {
        let n = self.grid.cells();
        match (i, j) {
            (_, 0) => Some(i),
            _ if i == n => Some(n + j),
            _ if j == n => Some(3 * n - i),
            (0, _) => Some(4 * n - j),
            _ => None,
        }
    }

    fn pair(&self, lane: usize) -> Pair {
        let take = |from: &[V]| from.iter().map(|v| v.0[lane]).collect();
        Pair { y: take(&self.y), a: take(&self.a) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::{LoadRule, load};
    use crate::saddle::{
        Params, ProximalParams, StopReason, UzawaParams, arrow_hurwicz, uzawa, uzawa_proximal,
    };

    fn setting() -> (Grid, Vec<f64>, Pair) {
        let grid = Grid::new(16).unwrap();
        let f = "quadrant(ll)=-6; else=1.998".parse().unwrap();
        (grid, load(grid, &f, LoadRule::LumpedAverage), Pair::zero(grid))
    }

    #[test]
    fn each_lane_is_arrow_hurwicz_to_the_last_bit() {
        let (grid, load, start) = setting();
        let all = || [0.3, 1.0, 5.0, 1e6].iter().flat_map(|&r| StopRule::ALL.map(|rule| (r, rule)));
        let job = |(r, rule)| {
            let (method, goal) = (Method::ArrowHurwicz, Goal::Rule(rule, 1e-4));
            Job { load: &load, start: &start, method, r, goal, cap: 1000 }
        };
        let ends = run(grid, &all().map(job).collect::<Vec<_>>());
        for ((r, rule), ours) in all().zip(ends) {
            let params = Params { r, rule, tolerance: 1e-4, max_iterations: 1000 };
            let mut pair = start.clone();
            let theirs = arrow_hurwicz(grid, &load, &params, &mut pair, None);
            assert_eq!((ours.sweeps, ours.delta_a), (theirs.iterations, theirs.delta_a));
            assert_eq!(ours.met, theirs.stop == StopReason::Converged);
            assert_eq!(ours.pair, pair);
        }
    }

    #[test]
    fn and_uzawa_with_and_without_the_proximal_term() {
        let (grid, load, start) = setting();
        let all = [(0.0, 3.0), (1.0, 3.0), (10.0, 1e4), (0.0, 1e4)];
        let jobs = all.map(|(weight, r)| {
            let method = Method::Uzawa { weight, inner: 1e-5, loose: false };
            let goal = Goal::Rule(StopRule::Printed, 1e-4);
            Job { load: &load, start: &start, method, r, goal, cap: 100_000 }
        });
        for ((weight, r), ours) in all.into_iter().zip(run(grid, &jobs)) {
            let rule = StopRule::Printed;
            let params = UzawaParams { r, tolerance: 1e-4, rule, ..UzawaParams::default() };
            let mut pair = start.clone();
            let theirs = if weight > 0.0 {
                let params = ProximalParams { uzawa: params, weight };
                uzawa_proximal(grid, &load, &params, &mut pair, None)
            } else {
                uzawa(grid, &load, &params, &mut pair, None)
            };
            assert_eq!((ours.sweeps, ours.delta_a), (theirs.sweeps, theirs.end.delta_a));
            assert_eq!((ours.met, &ours.pair), (true, &pair));
        }
    }
}
