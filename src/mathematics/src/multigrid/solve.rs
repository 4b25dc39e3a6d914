//! The solution of one problem: the input of the load, the steps, and the output of the solution.

use super::cycle::{DOUBLE_VISITS_BELOW, OVERCORRECTION};
use super::input::{InputError, LoadStats, check_length, check_start};
use super::level::MultigridLevel;
use super::load;
use super::pass;
use super::pass::Stage::{Correct, Interpolate, Relax, Restrict};
use super::rows;
use super::rows::Colour::{Black, Red};
use super::stencil::{MULTIPLICATIONS_PER_VISIT, contact_nodes};
use super::stopping::{self, CyclePart, CyclePosition, CycledHierarchy, InitialState};
use super::workspace::Multigrid;
use super::{Goal, MultigridParams};
use crate::discrete::end::End;
use crate::discrete::law_and_load::LawAndLoad;
use crate::discrete::stop::Stop;
use crate::problem::law::Law;

/// Boundary of the unit square.
const PERIMETER: f64 = 4.0;

impl Multigrid {
    /// Solves the problem in this thread, or in all threads of its pool.
    pub(super) fn solve_here(
        &mut self,
        problem: LawAndLoad<'_>,
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<End, InputError> {
        // The load is read in natural order and written in red and black rows, the solution the other way round.
        (self.work_units, self.traffic) = (0.0, 32.0);
        self.set_problem(problem)?;
        let (mut stop, mut iterations) = self.solve_prepared(start, params)?;
        if self.is_limit_exceeded() {
            self.set_problem(problem)?;
            self.set_limit(self.one_sided.limit);
            (stop, iterations) = self.solve_prepared(start, params)?;
        }
        Ok(End { iterations, work_units: self.work_units, stop, delta_a: None })
    }

    /// True if the flux somewhere exceeds the limit of the law, without which the problem has been solved: otherwise the
    /// solution without the limit is the one with it.
    fn is_limit_exceeded(&mut self) -> bool {
        if self.one_sided.limit.is_infinite() {
            return false;
        }
        let without = self.full_residual();
        self.set_limit(self.one_sided.limit);
        self.full_residual() > without
    }

    /// Solves the problem that has been set.
    fn solve_prepared(
        &mut self,
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<(Stop, usize), InputError> {
        if self.levels.len() > 1 {
            return self.solve_iteratively(start, params);
        }
        self.solve_coarsest();
        let stop = stopping::direct(self.full_residual() * self.scale, params.goal);
        Ok((stop, 0))
    }

    fn solve_iteratively(
        &mut self,
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<(Stop, usize), InputError> {
        let finest = self.levels.len() - 1;
        if params.goal == Goal::DiscretisationError {
            self.coarse_load = self.coarse_norm();
        }
        let residual = match start {
            Some(start) => {
                self.set_start(start)?;
                self.pass_under_law(finest, &[Relax(Red, 1.0), Relax(Black, 1.0), Restrict])
            }
            None => {
                self.nested_iteration();
                // As in the nested iteration, one sweep more saves a cycle.
                self.pass_under_law(finest, &Self::smooth_twice(Interpolate))
            }
        };
        let initial = InitialState { residual, load: self.finest().load_scale, scale: self.scale };
        Ok(stopping::iterate(self, initial, params))
    }

    /// Copies the solution in the order of the load.
    ///
    /// # Panics
    /// If the slice has another length.
    pub fn write_solution(&self, solution: &mut [f64]) {
        let finest = self.finest();
        rows::merge(finest.n, &finest.values, self.one_sided.signed(self.scale), solution);
    }

    /// Sets the scaled loads of all grids, without the limit of the law.
    fn set_problem(&mut self, LawAndLoad { law, load }: LawAndLoad<'_>) -> Result<(), InputError> {
        let (n, nodes) = (self.finest().n, self.finest().nodes);
        check_length(nodes, load)?;
        self.one_sided = law.one_sided(load);
        if self.one_sided.is_same() {
            self.set_load(load, law)?;
        } else {
            LoadStats::measure(load).check(law, PERIMETER)?;
            let load = self.one_sided.load(load, &contact_nodes(n));
            self.set_load(&load, Law::SIGNORINI)?;
        }
        self.set_limit(f64::INFINITY);
        Ok(())
    }

    /// Sets the largest flux on all grids.
    fn set_limit(&mut self, limit: f64) {
        for level in &mut self.levels {
            level.limit = 2.0 / level.n as f64 * (limit / self.scale);
        }
        self.needed = self.needed_flow / limit;
    }

    /// Sets the scaled loads of all grids.
    fn set_load(&mut self, load: &[f64], law: Law) -> Result<(), InputError> {
        let finest = self.levels.len() - 1;
        let (coarser, top) = self.levels.split_at_mut(finest);
        let top = &mut top[0];
        let stats = match coarser.last_mut() {
            Some(coarse) => load::set_finest_two(load, top, coarse),
            None => load::set_finest(load, top),
        };
        stats.check(law, PERIMETER)?;
        self.needed_flow = -stats.sum();
        self.scale = stats.scale();
        rows::scale(&mut top.load, 1.0 / self.scale);
        top.load_scale = stats.largest / self.scale;
        for l in (1..=finest).rev() {
            let (coarse, fine) = self.levels.split_at_mut(l);
            let (fine, coarse) = (&fine[0], &mut coarse[l - 1]);
            let nodes = fine.nodes as f64;
            let set_with_the_finest = l == finest && self.scale == 1.0;
            if !set_with_the_finest {
                load::restrict(fine, coarse);
            }
            self.count(pass::RESTRICT_LOAD * nodes);
            let read = if set_with_the_finest { 0.0 } else { 8.0 };
            self.move_bytes((read + 2.0) * nodes);
        }
        Ok(())
    }

    fn set_start(&mut self, start: &[f64]) -> Result<(), InputError> {
        let top = self.levels.last_mut().expect("at least one grid");
        check_start(top.nodes, start, self.scale)?;
        rows::split(top.n, start, &mut top.values);
        rows::scale(&mut top.values, self.one_sided.signed(1.0 / self.scale));
        Ok(())
    }

    /// Norm of the load on the finest grid but one.
    fn coarse_norm(&mut self) -> f64 {
        let coarse = &self.levels[self.levels.len() - 2];
        let (norm, nodes) = (load::norm(coarse), coarse.nodes as f64);
        self.count(nodes / MULTIPLICATIONS_PER_VISIT);
        self.move_bytes(8.0 * nodes);
        norm
    }

    /// Adds visits of unknowns to the work units.
    pub(super) fn count(&mut self, visits: f64) {
        self.work_units += visits / self.finest().nodes as f64;
    }

    /// Adds bytes to the traffic.
    pub(super) fn move_bytes(&mut self, bytes: f64) {
        self.traffic += bytes / self.finest().nodes as f64;
    }

    pub(super) fn finest(&self) -> &MultigridLevel {
        self.levels.last().expect("at least one grid")
    }
}

impl CycledHierarchy for Multigrid {
    fn cycle(&mut self, position: CyclePosition, part: CyclePart) -> f64 {
        let finest = self.levels.len() - 1;
        let double_visits_below = match position {
            // Near-constant modes must converge in this cycle: double visits begin on a finer grid.
            CyclePosition::Last => DOUBLE_VISITS_BELOW.min(2),
            CyclePosition::Inner => DOUBLE_VISITS_BELOW,
        };
        self.find_correction(finest, double_visits_below);
        let part = match part {
            CyclePart::Fixed(part) => part,
            CyclePart::LeastEnergy => self.search(finest),
        };
        let correct = Correct(part * OVERCORRECTION);
        match position {
            CyclePosition::Last => self
                .pass_under_law(finest, &[correct, Relax(Red, 1.0), Relax(Black, 1.0), Restrict]),
            CyclePosition::Inner => self.pass_under_law(finest, &Self::smooth_twice(correct)),
        }
    }

    fn has_limit(&self) -> bool {
        self.finest().limit.is_finite()
    }

    fn smooth_residual(&mut self) -> f64 {
        self.coarse_norm() / self.coarse_load
    }

    fn full_residual(&mut self) -> f64 {
        self.work_units += 1.0;
        self.traffic += 16.0;
        pass::natural_residual(self.finest())
    }

    fn rounding(&mut self) -> f64 {
        self.work_units += 0.25;
        self.traffic += 8.0;
        f64::EPSILON * self.finest().max_abs()
    }
}
