//! The hierarchy of grids on the cube: nested iteration, cycles, and when to stop.

use rayon::prelude::*;

use super::coarsest;
use super::contact::ContactSet;
use super::level::{Level, share};
use super::surface;
use super::sweep::Problem::{Correction, Obstacle};
use super::sweep::{self, Problem};
use crate::multigrid::banded::Banded;
use crate::multigrid::input::{Extent, InputError, check_length};
use crate::multigrid::rows::Colour::{Black, Red};
use crate::multigrid::rows::{self, Rows, stride};
use crate::multigrid::square::{Goal, MultigridParams, Outcome, Progress};
use crate::multigrid::stopping::{self, Hierarchy};

/// Nested iteration stays on a grid until the natural residual is below this part of the load.
const SETTLED: f64 = 1.0;
/// Over-relaxation inside, on the colour that the transfers beside it do not rely on.
const RELAXATION: f64 = 1.25;
/// Cycles on one coarse grid of the nested iteration at most.
const MAX_NESTED_CYCLES: usize = 30;

/// Work in sweeps of the same grid. Interpolation to one colour takes two-point formulas at most nodes.
const TO_BLACK: f64 = 0.25;
const HALF_SWEEP: f64 = 0.5;
/// Residual of one colour, and thirteen-point formulas at an eighth of the nodes.
const RESTRICT: f64 = 0.75;
/// Twenty-seven-point formulas at an eighth of the nodes.
const RESTRICT_LOAD: f64 = 0.5;

/// Preallocated grids for problems on the cube with `n` cells per side.
pub struct Multigrid {
    /// Coarsest first.
    levels: Vec<Level>,
    /// Room for the residuals of one colour.
    residuals: Rows,
    /// The contact set that the springs of the coarser grids stand for.
    contact: Option<ContactSet>,
    coarsest: Banded,
    /// The load is divided by this power of two, so that no residual over- or underflows.
    scale: f64,
    work_units: f64,
}

impl Multigrid {
    /// Allocates 22.3 bytes per unknown, and the rest of the last cache line of each row.
    ///
    /// # Errors
    /// If `n` is not a power of two (at least 2), or three times one.
    pub fn new(n: usize) -> Result<Self, InputError> {
        let odd = n.checked_shr(n.trailing_zeros()).unwrap_or(0);
        if !n.is_multiple_of(2) || !matches!(odd, 1 | 3) {
            return Err(InputError::GridSize(n, "a power of two (at least 2), or three times one"));
        }
        let depth = n.trailing_zeros();
        let levels = (1..=depth).map(|doublings| Level::new(odd << doublings)).collect();
        Ok(Self {
            levels,
            residuals: Rows::zeros((n + 1) * (n + 1) * stride(n)),
            contact: None,
            coarsest: Banded::default(),
            scale: 1.0,
            work_units: 0.0,
        })
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let of_level = |level: &Level| {
            let halves = level.values.iter().chain(&level.load);
            halves.map(|half| size_of_val(&half[..])).sum::<usize>()
                + size_of_val(&level.inverse_diagonal[..])
        };
        let contact = self.contact.as_ref().map_or(0, ContactSet::bytes);
        let levels: usize = self.levels.iter().map(of_level).sum();
        let coarsest = self.coarsest.entries() * size_of::<f64>();
        levels + size_of_val(&self.residuals[..]) + contact + coarsest
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
        self.work_units = 0.0;
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
                self.smooth(finest, Obstacle)
            }
            None => {
                self.nested_iteration();
                self.interpolate(finest);
                match params.goal {
                    Goal::DiscretisationError => self.smooth(finest, Obstacle),
                    // As in the nested iteration: one sweep more saves a cycle.
                    _ => self.smooth_twice(finest, Obstacle),
                }
            }
        };
        Ok(stopping::iterate(self, kkt, params, monitor))
    }

    /// Copies the solution, x fastest, `(n + 1)^3` numbers.
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
        let extent = Extent::join(&rows::split(top.n, load, &mut top.load, Extent::of));
        extent.check()?;
        self.scale = extent.scale();
        if self.scale != 1.0 {
            rows::scale(&mut top.load, 1.0 / self.scale);
        }
        top.divide_load_by_couplings();
        top.load_scale = extent.largest / self.scale;
        for l in (1..=finest).rev() {
            let (coarse, fine) = self.levels.split_at_mut(l);
            sweep::restrict_load(&fine[0], &mut coarse[l - 1]);
            self.count(RESTRICT_LOAD * self.levels[l].nodes() as f64);
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
            self.interpolate(l);
            self.smooth_twice(l, Obstacle);
            for _ in 0..MAX_NESTED_CYCLES {
                self.coarse_correction(l);
                self.add_correction(l, Obstacle);
                let kkt = self.smooth_twice(l, Obstacle);
                if kkt <= SETTLED * self.levels[l].load_scale {
                    break;
                }
            }
        }
    }

    /// From the restricted residual of obstacle level `l` to the correction on level `l - 1`.
    fn coarse_correction(&mut self, l: usize) {
        let mut contact = ContactSet::of(&self.levels[l]);
        self.count(contact.reading_work());
        if contact.is_empty() {
            contact = self.lower_into_contact(l);
        }
        if self.contact.as_ref() != Some(&contact) {
            contact.set_springs(&mut self.levels[..l]);
            self.count(contact.spring_work());
            self.coarsest = coarsest::factor(&self.levels[0]);
            self.count(self.coarsest.factor_work() / coarsest::STENCIL);
            self.contact = Some(contact);
        }
        self.w_cycle(l - 1);
    }

    /// One cycle on the linear problem of level `l`, from zero.
    ///
    /// Two visits of the coarser grid: near-constant modes of semicoercive problems need accurate coarse
    /// solves, and there they cost little.
    fn w_cycle(&mut self, l: usize) {
        if l == 0 {
            coarsest::solve_linear(&mut self.levels[0], &self.coarsest);
            self.count(self.coarsest.solve_work() / coarsest::STENCIL);
            return;
        }
        let level = &mut self.levels[l];
        sweep::start_red(level, RELAXATION);
        sweep::relax(level, Correction, Black, 1.0);
        self.count_sweeps(l, TO_BLACK + HALF_SWEEP);
        self.restrict(l, Correction);
        self.w_cycle(l - 1);
        self.add_correction(l, Correction);
        self.smooth_twice(l, Correction);
        self.w_cycle(l - 1);
        self.add_correction(l, Correction);
        let level = &mut self.levels[l];
        sweep::relax(level, Correction, Red, 1.0);
        sweep::relax(level, Correction, Black, RELAXATION);
        self.count_sweeps(l, 2.0 * HALF_SWEEP);
    }

    /// One sweep, and the residual goes to the coarser grid; returns the natural residual.
    fn smooth(&mut self, l: usize, problem: Problem) -> f64 {
        let level = &mut self.levels[l];
        sweep::relax(level, problem, Red, 1.0);
        sweep::relax(level, problem, Black, 1.0);
        self.count_sweeps(l, 2.0 * HALF_SWEEP);
        self.restrict(l, problem)
    }

    /// Between two corrections: post-smoothing of one cycle, pre-smoothing of the next.
    ///
    /// Over-relaxed on the colour that the transfer beside it does not rely on.
    fn smooth_twice(&mut self, l: usize, problem: Problem) -> f64 {
        let level = &mut self.levels[l];
        for (colour, factor) in [(Red, 1.0), (Black, RELAXATION), (Red, RELAXATION), (Black, 1.0)] {
            sweep::relax(level, problem, colour, factor);
        }
        self.count_sweeps(l, 4.0 * HALF_SWEEP);
        self.restrict(l, problem)
    }

    fn restrict(&mut self, l: usize, problem: Problem) -> f64 {
        let (coarse, fine) = self.levels.split_at_mut(l);
        let natural = sweep::restrict(&fine[0], problem, &mut coarse[l - 1], &mut self.residuals);
        self.count_sweeps(l, RESTRICT);
        natural
    }

    fn add_correction(&mut self, l: usize, problem: Problem) {
        let (coarse, fine) = self.levels.split_at_mut(l);
        sweep::correct(&mut fine[0], problem, &coarse[l - 1]);
        self.count_sweeps(l, TO_BLACK);
    }

    fn interpolate(&mut self, l: usize) {
        let (coarse, fine) = self.levels.split_at_mut(l);
        sweep::interpolate(&mut fine[0], &coarse[l - 1]);
        self.count_sweeps(l, TO_BLACK);
    }

    /// Subtracts a constant such that one boundary node touches zero, and puts that one in contact.
    ///
    /// With an empty contact set the corrections would be unbounded; the sum of the load being
    /// negative, the solution does touch somewhere.
    fn lower_into_contact(&mut self, l: usize) -> ContactSet {
        let level = &mut self.levels[l];
        let (mut lowest, mut at) = (f64::INFINITY, [0, 0, 0]);
        surface::for_each_node(level.n, |_, node| {
            if level.value(node) < lowest {
                (lowest, at) = (level.value(node), node);
            }
        });
        for half in &mut level.values {
            half.par_iter_mut().with_min_len(1 << 14).for_each(|value| *value -= lowest);
        }
        let contact = ContactSet::single(level.n, at);
        self.count_sweeps(l, 0.25);
        contact
    }

    fn finest(&self) -> &Level {
        self.levels.last().expect("at least one grid")
    }

    fn count_sweeps(&mut self, l: usize, sweeps: f64) {
        self.count(sweeps * self.levels[l].nodes() as f64);
    }

    fn count(&mut self, visits: f64) {
        let unknowns = self.finest().nodes();
        self.work_units += visits / unknowns as f64;
    }
}

impl Hierarchy for Multigrid {
    fn cycle(&mut self, last: bool) -> f64 {
        let finest = self.levels.len() - 1;
        self.coarse_correction(finest);
        self.add_correction(finest, Obstacle);
        match last {
            true => self.smooth(finest, Obstacle),
            false => self.smooth_twice(finest, Obstacle),
        }
    }

    fn check(&mut self) -> f64 {
        self.work_units += 1.0;
        let finest = self.levels.last().expect("at least one grid");
        sweep::natural_residual(finest, &mut self.residuals)
    }

    fn rounding(&mut self) -> f64 {
        self.work_units += 0.25;
        // Couplings are of the size h.
        f64::EPSILON * self.finest().max_abs() / self.finest().n as f64
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

impl Level {
    /// From `F` to the load of the mirrored stencil.
    fn divide_load_by_couplings(&mut self) {
        let n = self.n;
        let of_row = |j: usize, k: usize, load: &mut [f64], first_column: usize| {
            let factor = n as f64 / (share(n, j) * share(n, k));
            load.iter_mut().for_each(|entry| *entry *= factor);
            if first_column == 0 {
                load[0] *= 2.0;
                load[n / 2] *= 2.0;
            }
        };
        for colour in [Red, Black] {
            let rows = &mut self.load[colour as usize];
            super::level::for_each_plane(n, rows, |k, plane| {
                for (j, load) in plane.chunks_exact_mut(stride(n)).enumerate() {
                    of_row(j, k, load, colour.first_column(j + k));
                }
                0.0
            });
        }
    }
}
