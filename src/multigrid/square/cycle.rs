//! The hierarchy of grids: nested iteration, cycles, and when to stop.

use rayon::prelude::*;

use super::contact::ContactSet;
use super::level::Level;
use super::pass::Problem::{Correction, Obstacle};
use super::pass::Stage::{Correct, Interpolate, Relax, Restrict, StartRed};
use super::pass::{self, Problem, Stage};
use super::{Goal, MultigridParams, Outcome, Progress, coarsest};
use crate::multigrid::input::{Extent, InputError, check_length};
use crate::multigrid::rows::{self, Colour};
use crate::multigrid::stopping::{self, Hierarchy};

/// Coarse grids see two cycles per cycle of the grid above from this many grids below the finest.
const F_CYCLE_DEPTH: usize = 3;
/// Corrections from a V-cycle fall short by up to a tenth where the wavelength is a few cells of the
/// coarser grid; enlarged by this factor they err to both sides alike.
const OVERCORRECTION: f64 = 1.08;
/// Over-relaxation inside, on the colour that the transfers beside it do not rely on.
const RELAXATION: f64 = 1.15;
/// Over-relaxation of the half-sweeps that begin and end a visit to a correction problem.
const COARSE_RELAXATION: f64 = 1.45;
/// Nested iteration stays on a grid until the natural residual is below this part of the load.
const SETTLED: f64 = 1.0;
/// Cycles on one coarse grid of the nested iteration at most.
const MAX_NESTED_CYCLES: usize = 30;

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
        // Four cells per side are solved directly, which is cheaper than going down to two.
        let coarsest = if odd == 1 { depth.min(2) } else { 1 };
        let levels = (coarsest..=depth).map(|doublings| Level::new(odd << doublings)).collect();
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
        monitor: impl FnMut(&Progress),
    ) -> Result<Outcome, InputError> {
        (self.work_units, self.traffic) = (0.0, 0.0);
        self.set_load(load)?;
        let finest = self.levels.len() - 1;
        if finest == 0 {
            let work = coarsest::solve_obstacle(&mut self.levels[0]);
            self.count(work);
            return Ok(stopping::direct(self, params.goal));
        }
        let kkt = match start {
            Some(start) => {
                self.set_start(start)?;
                let first = [Relax(Colour::Red, 1.0), Relax(Colour::Black, 1.0), Restrict];
                self.pass(finest, Obstacle, &first)
            }
            None => {
                self.nested_iteration();
                match params.goal {
                    Goal::DiscretisationError => self.pass(finest, Obstacle, &smooth(Interpolate)),
                    // As in the nested iteration: one sweep more saves a cycle.
                    _ => self.pass(finest, Obstacle, &smooth_twice(Interpolate)),
                }
            }
        };
        Ok(stopping::iterate(self, kkt, params, monitor))
    }

    /// Copies the solution, row-major, `(n + 1)^2` numbers.
    ///
    /// # Panics
    /// If the slice has another length.
    pub fn write_solution(&self, solution: &mut [f64]) {
        let finest = self.finest();
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
        let top = self.levels.last_mut().expect("at least one grid");
        check_length(top.nodes(), start)?;
        rows::set_scaled(top.n, start, self.scale, &mut top.values)
    }

    /// Solves on all grids but the finest, each started from the one below.
    ///
    /// Two sweeps before the first correction let the contact set settle.
    fn nested_iteration(&mut self) {
        let work = coarsest::solve_obstacle(&mut self.levels[0]);
        self.count(work);
        for l in 1..self.levels.len() - 1 {
            self.pass(l, Obstacle, &smooth_twice(Interpolate));
            for _ in 0..MAX_NESTED_CYCLES {
                self.coarse_correction(l);
                let kkt = self.pass(l, Obstacle, &smooth_twice(Correct(OVERCORRECTION)));
                if kkt <= SETTLED * self.levels[l].load_scale {
                    break;
                }
            }
        }
    }

    /// From the restricted residual of obstacle level `l` to the correction on level `l - 1`.
    fn coarse_correction(&mut self, l: usize) {
        let mut contact = ContactSet::of(&self.levels[l]);
        if contact.is_empty() {
            contact = self.lower_into_contact(l);
        }
        for level in &mut self.levels[..l] {
            level.inverse_diagonal = contact.inverse_diagonal(level.n);
        }
        // Perimeters of all grids together: once to read, once to write.
        self.count(8.0 * self.levels[l].n as f64 * 2.0);
        self.correct(l - 1, l.saturating_sub(F_CYCLE_DEPTH), true);
    }

    /// One cycle on the linear problem of level `l`, from zero; from level `f_from` down, and while
    /// `f_cycle`, an F-cycle: the coarser problem gets an F-cycle and then a V-cycle.
    fn correct(&mut self, l: usize, f_from: usize, f_cycle: bool) {
        if l == 0 {
            let work = coarsest::solve_linear(&mut self.levels[0]);
            self.count(work);
            return;
        }
        let first = [StartRed(COARSE_RELAXATION), Relax(Colour::Black, 1.0), Restrict];
        self.pass(l, Correction, &first);
        self.correct(l - 1, f_from, f_cycle);
        if f_cycle && l <= f_from {
            self.pass(l, Correction, &smooth_twice(Correct(1.0)));
            self.correct(l - 1, f_from, false);
        }
        // What comes from an F-cycle or, two grids below, a direct solution, near-constant modes above all, is
        // complete, and must not grow on the finest grid. (That it does one grid below costs nothing: without,
        // 8 cells take 3 % more cycles, 12 and 28 cells 4 to 8 % less, finer grids the same.)
        let factor = if l == f_from + 1 { 1.0 / OVERCORRECTION } else { 1.0 };
        let last =
            [Correct(factor), Relax(Colour::Red, 1.0), Relax(Colour::Black, COARSE_RELAXATION)];
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

    fn count(&mut self, visits: f64) {
        self.work_units += visits / self.unknowns();
    }

    fn move_bytes(&mut self, bytes: f64) {
        self.traffic += bytes / self.unknowns();
    }

    fn finest(&self) -> &Level {
        self.levels.last().expect("at least one grid")
    }

    fn unknowns(&self) -> f64 {
        self.finest().nodes() as f64
    }
}

impl Hierarchy for Multigrid {
    fn cycle(&mut self, last: bool) -> f64 {
        let finest = self.levels.len() - 1;
        self.coarse_correction(finest);
        match last {
            true => self.pass(finest, Obstacle, &smooth(Correct(OVERCORRECTION))),
            false => self.pass(finest, Obstacle, &smooth_twice(Correct(OVERCORRECTION))),
        }
    }

    fn check(&mut self) -> f64 {
        self.work_units += 1.0;
        self.traffic += 16.0;
        pass::natural_residual(self.finest())
    }

    fn rounding(&mut self) -> f64 {
        self.work_units += 0.25;
        self.traffic += 8.0;
        f64::EPSILON * self.finest().max_abs()
    }

    fn load_scale(&self) -> f64 {
        self.finest().load_scale
    }

    fn scale(&self) -> f64 {
        self.scale
    }

    fn work_units(&self) -> f64 {
        self.work_units
    }
}

/// One sweep after values or a correction came from the coarser grid.
fn smooth(from_coarser: Stage) -> [Stage; 4] {
    [from_coarser, Relax(Colour::Red, 1.0), Relax(Colour::Black, 1.0), Restrict]
}

/// Between two coarse-grid corrections: post-smoothing of one cycle, pre-smoothing of the next.
fn smooth_twice(from_coarser: Stage) -> [Stage; 6] {
    [
        from_coarser,
        Relax(Colour::Red, 1.0),
        Relax(Colour::Black, RELAXATION),
        Relax(Colour::Red, RELAXATION),
        Relax(Colour::Black, 1.0),
        Restrict,
    ]
}
