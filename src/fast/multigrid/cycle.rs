//! The hierarchy of grids: nested iteration, cycles, and when to stop.

use rayon::prelude::*;

use super::contact::ContactSet;
use super::level::Level;
use super::pass::Problem::{Correction, Obstacle};
use super::pass::Stage::{Correct, Interpolate, Relax, Restrict, StartRed};
use super::pass::{self, Problem, Stage};
use super::{Goal, MultigridParams, Outcome, Progress, coarsest};
use crate::fast::StopReason;
use crate::fast::input::{Extent, InputError, check_length};
use crate::fast::rows::{self, Colour};

/// Coarse grids see two cycles per cycle of the grid above from this many grids below the finest.
const F_CYCLE_DEPTH: usize = 3;
/// Nested iteration stays on a grid until the natural residual is below this part of the load.
const SETTLED: f64 = 1.0;
/// Cycles on one coarse grid of the nested iteration at most.
const MAX_NESTED_CYCLES: usize = 30;
/// The discretisation error is reached after two cycles if the natural residual is this part of the load.
const DISCRETISATION: f64 = 0.05;
/// A cycle that reduces the natural residual by less is suspected to work on rounding errors.
const STAGNATION: f64 = 0.5;
/// Natural residual of a perfectly rounded solution, in units of `EPSILON * max |y|`, generously.
const FLOOR: f64 = 32.0;

/// Growth of the natural residual, over its first value or the load, that ends the iteration.
const HOPELESS: f64 = 1e12;

/// Preallocated grids for problems with `n` cells per side.
pub struct Multigrid {
    /// Coarsest first.
    levels: Vec<Level>,
    /// The load is divided by this power of two, so that no residual over- or underflows.
    scale: f64,
    work_units: f64,
    /// Bytes moved, per unknown of the finest grid.
    traffic: f64,
}

impl Multigrid {
    /// Allocates 21.3 bytes per unknown, and a few more cache lines per row.
    ///
    /// # Errors
    /// If `n` is not a power of two (at least 2) times 1, 3, 5 or 7.
    pub fn new(n: usize) -> Result<Self, InputError> {
        let odd = n.checked_shr(n.trailing_zeros()).unwrap_or(0);
        if !n.is_multiple_of(2) || !matches!(odd, 1 | 3 | 5 | 7) {
            return Err(InputError::GridSize(n, "a power of two (at least 2) times 1, 3, 5 or 7"));
        }
        let depth = n.trailing_zeros();
        let levels = (1..=depth).map(|doublings| Level::new(odd << doublings)).collect();
        Ok(Self { levels, scale: 1.0, work_units: 0.0, traffic: 0.0 })
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let of_level = |level: &Level| {
            let halves = level.values.iter().chain(&level.load);
            halves.map(|half| size_of_val(&half[..])).sum::<usize>()
                + size_of_val(&level.inverse_diagonal[..])
        };
        self.levels.iter().map(of_level).sum()
    }

    /// Bytes per unknown that the passes of the last solve moved together, if each reads and writes every
    /// row once: over the bandwidth of the memory, the time that nothing can save on grids too large for
    /// the caches.
    pub fn traffic(&self) -> f64 {
        self.traffic
    }

    /// Solves for one load; see [`multigrid`](super::multigrid).
    ///
    /// # Errors
    /// If a length is wrong, a number is not finite, or the load does not have a negative sum.
    pub fn solve(
        &mut self,
        load: &[f64],
        start: Option<&[f64]>,
        params: &MultigridParams,
        mut monitor: impl FnMut(&Progress),
    ) -> Result<Outcome, InputError> {
        (self.work_units, self.traffic) = (0.0, 0.0);
        self.set_load(load)?;
        let finest = self.levels.len() - 1;
        if finest == 0 {
            return Ok(self.solve_directly(params.goal));
        }
        let over = params.relaxation;
        let between_corrections = smooth_twice(Correct, over);
        let mut kkt = match start {
            Some(start) => {
                self.set_start(start)?;
                let first = [Relax(Colour::Red, 1.0), Relax(Colour::Black, 1.0), Restrict];
                self.pass(finest, Obstacle, &first)
            }
            None => {
                self.nested_iteration(over);
                match params.goal {
                    Goal::DiscretisationError => self.pass(finest, Obstacle, &FROM_COARSER),
                    // As in the nested iteration: one sweep more saves a cycle.
                    _ => self.pass(finest, Obstacle, &smooth_twice(Interpolate, over)),
                }
            }
        };
        let hopeless = HOPELESS * kkt.max(self.levels[finest].load_scale);
        let mut cycles = 0;
        let stop = loop {
            if cycles == params.max_cycles {
                break StopReason::CycleLimit;
            }
            let last_one = params.goal == Goal::DiscretisationError && cycles > 0;
            let previous = kkt;
            self.coarse_correction(finest, over);
            let stages: &[Stage] = if last_one { &SMOOTH } else { &between_corrections };
            kkt = self.pass(finest, Obstacle, stages);
            cycles += 1;
            let raw = kkt * self.scale;
            monitor(&Progress { cycle: cycles, kkt: raw, work_units: self.work_units });
            if !kkt.is_finite() || kkt > hopeless {
                break StopReason::Diverged;
            }
            match params.goal {
                Goal::DiscretisationError => {
                    let small = DISCRETISATION * self.levels[finest].load_scale;
                    if last_one && kkt <= small {
                        break StopReason::Converged;
                    }
                }
                // What the pass measured leaves out the black nodes: check before claiming.
                Goal::Kkt(tolerance) if raw <= tolerance => {
                    kkt = self.check();
                    if kkt * self.scale <= tolerance {
                        break StopReason::Converged;
                    }
                }
                Goal::Kkt(_) | Goal::RoundingFloor => {}
            }
            if kkt >= STAGNATION * previous {
                let floor = FLOOR * f64::EPSILON * self.levels[finest].max_abs();
                self.work_units += 0.25;
                self.traffic += 8.0;
                if kkt <= floor {
                    kkt = self.check();
                    if kkt <= floor {
                        break StopReason::RoundingFloor;
                    }
                }
            }
        };
        let kkt = kkt * self.scale;
        Ok(Outcome { stop, cycles, kkt, work_units: self.work_units })
    }

    /// Copies the solution, row-major, `(n + 1)^2` numbers.
    pub fn write_solution(&self, solution: &mut [f64]) {
        let finest = &self.levels[self.levels.len() - 1];
        rows::merge(finest.n, &finest.values, self.scale, solution);
    }

    fn set_load(&mut self, load: &[f64]) -> Result<(), InputError> {
        let finest = self.levels.len() - 1;
        let top = &mut self.levels[finest];
        check_length(top.nodes(), load)?;
        let extents = rows::split(top.n, load, &mut top.load, Extent::of);
        // Read in one order, written in the other.
        self.traffic += 16.0;
        let extent = Extent::join(&extents);
        extent.check()?;
        self.scale = extent.scale();
        if self.scale != 1.0 {
            rows::scale(&mut top.load, 1.0 / self.scale);
        }
        top.load_scale = extent.largest / self.scale;
        for l in (1..=finest).rev() {
            let (coarse, fine) = self.levels.split_at_mut(l);
            pass::restrict_load(&fine[0], &mut coarse[l - 1]);
            let nodes = self.levels[l].nodes() as f64;
            self.count(pass::RESTRICT_LOAD * nodes);
            self.move_bytes(10.0 * nodes);
        }
        Ok(())
    }

    fn set_start(&mut self, start: &[f64]) -> Result<(), InputError> {
        let scale = self.scale;
        let top = self.levels.last_mut().expect("at least one grid");
        check_length(top.nodes(), start)?;
        if start.iter().any(|value| !(value / scale).is_finite()) {
            return Err(InputError::NotFinite("start"));
        }
        rows::split(top.n, start, &mut top.values, |_| ());
        if scale != 1.0 {
            rows::scale(&mut top.values, 1.0 / scale);
        }
        Ok(())
    }

    /// The finest grid is the coarsest: nothing to iterate.
    fn solve_directly(&mut self, goal: Goal) -> Outcome {
        coarsest::solve_obstacle(&mut self.levels[0]);
        let kkt = self.check() * self.scale;
        let stop = match goal {
            Goal::Kkt(tolerance) if kkt > tolerance => StopReason::RoundingFloor,
            Goal::RoundingFloor => StopReason::RoundingFloor,
            Goal::Kkt(_) | Goal::DiscretisationError => StopReason::Converged,
        };
        Outcome { stop, cycles: 0, kkt, work_units: self.work_units }
    }

    /// Solves on all grids but the finest, each started from the one below.
    ///
    /// Two sweeps before the first correction let the contact set settle.
    fn nested_iteration(&mut self, over: f64) {
        coarsest::solve_obstacle(&mut self.levels[0]);
        for l in 1..self.levels.len() - 1 {
            self.pass(l, Obstacle, &smooth_twice(Interpolate, over));
            for _ in 0..MAX_NESTED_CYCLES {
                self.coarse_correction(l, over);
                let kkt = self.pass(l, Obstacle, &smooth_twice(Correct, over));
                if kkt <= SETTLED * self.levels[l].load_scale {
                    break;
                }
            }
        }
    }

    /// From the restricted residual of obstacle level `l` to the correction on level `l - 1`.
    fn coarse_correction(&mut self, l: usize, over: f64) {
        let mut contact = ContactSet::of(&self.levels[l]);
        if contact.is_empty() {
            contact = self.lower_into_contact(l);
        }
        for level in &mut self.levels[..l] {
            level.inverse_diagonal = contact.inverse_diagonal(level.n);
        }
        // Perimeters of all grids together: once to read, once to write.
        self.count(8.0 * self.levels[l].n as f64 * 2.0);
        self.correct(l - 1, over, l.saturating_sub(F_CYCLE_DEPTH), true);
    }

    /// One cycle on the linear problem of level `l`, from zero; from level `f_from` down, and while
    /// `f_cycle`, an F-cycle: the coarser problem gets an F-cycle and then a V-cycle.
    fn correct(&mut self, l: usize, over: f64, f_from: usize, f_cycle: bool) {
        if l == 0 {
            let coarsest = &mut self.levels[0];
            coarsest::solve_linear(coarsest);
            let flops_per_visit = 10.0;
            let width = coarsest.n as f64 + 1.0;
            self.count(width.powi(4) / flops_per_visit);
            return;
        }
        self.pass(l, Correction, &[StartRed(over), Relax(Colour::Black, 1.0), Restrict]);
        self.correct(l - 1, over, f_from, f_cycle);
        if f_cycle && l <= f_from {
            self.pass(l, Correction, &smooth_twice(Correct, over));
            self.correct(l - 1, over, f_from, false);
        }
        let last = [Correct, Relax(Colour::Red, 1.0), Relax(Colour::Black, over)];
        self.pass(l, Correction, &last);
    }

    /// Subtracts a constant such that one boundary node touches zero, and puts that one in contact.
    ///
    /// With an empty contact set the corrections would be unbounded; the sum of the load being
    /// negative, the solution does touch somewhere.
    fn lower_into_contact(&mut self, l: usize) -> ContactSet {
        let level = &mut self.levels[l];
        let mut lowest = (f64::INFINITY, 0, 0);
        Level::for_each_boundary_node(level.n, |_, i, j| {
            if level.value(i, j) < lowest.0 {
                lowest = (level.value(i, j), i, j);
            }
        });
        let (shift, i, j) = lowest;
        for half in &mut level.values {
            half.par_iter_mut().with_min_len(1 << 14).for_each(|value| *value -= shift);
        }
        let (contact, nodes) = (ContactSet::single(level.n, i, j), level.nodes());
        self.count(0.25 * nodes as f64);
        self.move_bytes(16.0 * nodes as f64);
        contact
    }

    fn pass(&mut self, l: usize, problem: Problem, stages: &[Stage]) -> f64 {
        let (coarse, fine) = self.levels.split_at_mut(l);
        let natural_residual = pass::run(&mut fine[0], &mut coarse[l - 1], problem, stages);
        let nodes = self.levels[l].nodes() as f64;
        self.count(pass::work(stages) * nodes);
        self.move_bytes(pass::traffic(stages) * nodes);
        natural_residual
    }

    /// Natural residual of the finest grid, all nodes.
    fn check(&mut self) -> f64 {
        self.work_units += 1.0;
        self.traffic += 16.0;
        pass::natural_residual(self.levels.last().expect("at least one grid"))
    }

    fn count(&mut self, visits: f64) {
        self.work_units += visits / self.unknowns();
    }

    fn move_bytes(&mut self, bytes: f64) {
        self.traffic += bytes / self.unknowns();
    }

    fn unknowns(&self) -> f64 {
        self.levels.last().expect("at least one grid").nodes() as f64
    }
}

/// First pass on a grid of the nested iteration.
const FROM_COARSER: [Stage; 4] =
    [Interpolate, Relax(Colour::Red, 1.0), Relax(Colour::Black, 1.0), Restrict];
/// After the last coarse-grid correction.
const SMOOTH: [Stage; 4] = [Correct, Relax(Colour::Red, 1.0), Relax(Colour::Black, 1.0), Restrict];

/// Between two coarse-grid corrections: post-smoothing of one cycle, pre-smoothing of the next.
fn smooth_twice(from_coarser: Stage, over: f64) -> [Stage; 6] {
    [
        from_coarser,
        Relax(Colour::Red, 1.0),
        Relax(Colour::Black, over),
        Relax(Colour::Red, over),
        Relax(Colour::Black, 1.0),
        Restrict,
    ]
}
