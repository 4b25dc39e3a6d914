//! The grids of the square as the levels of the driver: the input of the load, the steps, and the output of the
//! solution.
//!
//! If the residual is that of two cycles before, two contact sets alternate: the next cycle applies half a correction.
//! Where the law limits the flux, and two cycles have hardly lowered the residual, all later ones apply the part of the
//! correction with the least energy.

use super::cycle::{DOUBLE_VISITS_BELOW, OVERCORRECTION};
use super::level::MultigridLevel;
use super::pass::Stage::{Correct, Interpolate, Relax, Restrict};
use super::rows::Colour::{Black, Red};
use super::stencil::{MULTIPLICATIONS_PER_VISIT, contact_nodes};
use super::workspace::Multigrid;
use super::{load, pass, rows};
use crate::discrete::end::{End, Stop};
use crate::discrete::grid::Grid;
use crate::discrete::load_stats::LoadStats;
use crate::machine::threads::among_threads;
use crate::multigrid::driver::{self, Hierarchy, LoadScale};
use crate::multigrid::{Goal, InputError, MultigridParams, check_length, check_load};
use crate::problem::law::{Law, LawSum, OneSided};
use crate::problem::unsolvable::Component;

/// Ratio of the residual to the load, both on the finest grid but one in the root mean square, below which the
/// discretisation error is reached.
///
/// The algebraic error is then below a tenth of the discretisation error in the energy norm, in all of 20 000 random
/// problems. The largest residual would not do: single nodes at the ends of contact have large residuals and next to
/// no energy.
const DISCRETISATION: f64 = 0.01;
/// Reduction of the natural residual by each of two cycles from which on, where values have both signs, the part of the
/// correction is chosen by its energy.
const STALLING: f64 = 0.3;
/// Relative difference between the residuals of this cycle and of two cycles before, below which two contact sets are
/// taken to alternate.
const ALTERNATION: f64 = 1e-3;

/// The square with a load.
fn loaded_square(law: Law, stats: &LoadStats) -> Component {
    Component::whole(law, Grid::PERIMETER, stats.sum())
}

impl Multigrid {
    /// Solves the problem for one load.
    ///
    /// # Errors
    /// If a length is wrong, a number is not finite, or the flux cannot balance the load; under the paper's law, if its
    /// sum is not negative.
    pub fn solve(
        &mut self,
        law: Law,
        load: &[f64],
        params: &MultigridParams,
    ) -> Result<End, InputError> {
        among_threads(self.finest().nodes, || {
            self.work_units = 0.0;
            let laws = LawSum::of(law, Grid::PERIMETER);
            self.one_sided = OneSided::new(&laws, load);
            let mut run =
                SquareRun { grids: self, law, load, goal: params.goal, parts: PartRule::default() };
            driver::solve(&mut run, law.is_bounded(), params)
        })
    }

    /// Copies the solution in the order of the load.
    ///
    /// # Panics
    /// If the slice has another length.
    pub fn write_solution(&self, solution: &mut [f64]) {
        let finest = self.finest();
        rows::merge(finest.n, &finest.values, self.one_sided.signed(self.scale), solution);
    }

    /// Sets the scaled loads of all grids.
    fn set_problem(&mut self, law: Law, load: &[f64]) -> Result<(), InputError> {
        let (n, nodes) = (self.finest().n, self.finest().nodes);
        check_length(nodes, load)?;
        if !self.one_sided.is_reflected && law.lo() == 0.0 {
            return self.set_load(load, law);
        }
        check_load(&[loaded_square(law, &LoadStats::measure(load))])?;
        let load = self.one_sided.load(load, &contact_nodes(n, law));
        self.set_load(&load, Law::SIGNORINI)
    }

    /// Sets the largest flux on all grids: none without limits.
    fn set_limit(&mut self, law: Law, has_limits: bool) {
        let limit = if has_limits { self.one_sided.law(law).hi() } else { f64::INFINITY };
        for level in &mut self.levels {
            level.limit = 2.0 / level.n as f64 * (limit / self.scale);
        }
        self.limit = limit;
    }

    /// Sets the scaled loads of all grids.
    fn set_load(&mut self, load: &[f64], law: Law) -> Result<(), InputError> {
        let finest = self.levels.len() - 1;
        let top = &mut self.levels[finest];
        let stats = load::set_finest(load, top);
        check_load(&[loaded_square(law, &stats)])?;
        self.needed = -stats.sum();
        self.scale = stats.scale();
        rows::scale(&mut top.load, 1.0 / self.scale);
        top.load_scale = stats.largest / self.scale;
        for l in (1..=finest).rev() {
            let (coarse, fine) = self.levels.split_at_mut(l);
            let (fine, coarse) = (&fine[0], &mut coarse[l - 1]);
            let nodes = fine.nodes as f64;
            load::restrict(fine, coarse);
            self.count(pass::RESTRICT_LOAD * nodes);
        }
        Ok(())
    }

    /// Norm of the load on the finest grid but one.
    fn coarse_norm(&mut self) -> f64 {
        let coarse = &self.levels[self.levels.len() - 2];
        let (norm, nodes) = (load::norm(coarse), coarse.nodes as f64);
        self.count(nodes / MULTIPLICATIONS_PER_VISIT);
        norm
    }

    /// Adds visits of unknowns to the work units.
    pub(super) fn count(&mut self, visits: f64) {
        self.work_units += visits / self.finest().nodes as f64;
    }

    pub(super) fn finest(&self) -> &MultigridLevel {
        self.levels.last().expect("at least one grid")
    }

    /// Natural residual of all nodes.
    fn natural_residual(&mut self) -> f64 {
        self.work_units += 1.0;
        pass::natural_residual(self.finest())
    }
}

/// Solution of one problem on the grids of the square.
struct SquareRun<'a> {
    grids: &'a mut Multigrid,
    law: Law,
    load: &'a [f64],
    goal: Goal,
    parts: PartRule,
}

impl Hierarchy for SquareRun<'_> {
    const BY_RECURRENCE: bool = false;

    fn finest(&self) -> usize {
        self.grids.levels.len() - 1
    }

    fn set_problem(&mut self, has_limits: bool) -> Result<LoadScale, InputError> {
        let grids = &mut *self.grids;
        grids.set_problem(self.law, self.load)?;
        grids.set_limit(self.law, has_limits);
        if self.goal == Goal::DiscretisationError && grids.levels.len() > 1 {
            grids.coarse_load = grids.coarse_norm();
        }
        self.parts = PartRule::default();
        Ok(LoadScale { scale: grids.scale, largest: grids.finest().load_scale })
    }

    fn solve_coarsest(&mut self) -> Result<Stop, InputError> {
        self.grids.solve_coarsest();
        if self.finest() > 0 {
            return Ok(Stop::Converged);
        }
        let residual = self.grids.natural_residual() * self.grids.scale;
        Ok(match self.goal {
            Goal::Kkt(tolerance) if residual > tolerance => Stop::RoundingFloor,
            Goal::RoundingFloor => Stop::RoundingFloor,
            Goal::Kkt(_) | Goal::Gain(_) | Goal::DiscretisationError => Stop::Converged,
        })
    }

    /// One sweep more than in other cycles saves a cycle.
    fn refine(&mut self, level: usize) -> Result<f64, InputError> {
        Ok(self.grids.pass_under_law(level, &Multigrid::smooth_twice(Interpolate)))
    }

    fn settle(&mut self, level: usize) {
        self.grids.settle(level);
    }

    /// One cycle; returns the residual of the red nodes.
    fn step(&mut self, residual: f64) -> f64 {
        let (finest, grids) = (self.finest(), &mut *self.grids);
        let is_last = self.goal == Goal::DiscretisationError;
        // Near-constant modes must converge in a cycle that is expected to be the last: double visits begin on a finer
        // grid.
        let double_visits_below =
            if is_last { DOUBLE_VISITS_BELOW.min(2) } else { DOUBLE_VISITS_BELOW };
        grids.find_correction(finest, double_visits_below);
        let has_limit = grids.finest().limit.is_finite();
        let part = match self.parts.next(residual, has_limit) {
            CyclePart::Fixed(part) => part,
            CyclePart::LeastEnergy => grids.search(finest),
        };
        let correct = Correct(part * OVERCORRECTION);
        if is_last {
            // It does not smooth for a next one.
            let stages = [correct, Relax(Red, 1.0), Relax(Black, 1.0), Restrict];
            return grids.pass_under_law(finest, &stages);
        }
        grids.pass_under_law(finest, &Multigrid::smooth_twice(correct))
    }

    fn is_within_discretisation_error(&mut self) -> bool {
        self.grids.coarse_norm() / self.grids.coarse_load <= DISCRETISATION
    }

    fn computed_residual(&mut self) -> f64 {
        self.grids.natural_residual()
    }

    fn rounding(&mut self) -> f64 {
        self.grids.work_units += 0.25;
        f64::EPSILON * self.grids.finest().max_abs()
    }

    fn residual_under(&mut self, has_limits: bool) -> Result<f64, InputError> {
        self.grids.set_limit(self.law, has_limits);
        Ok(self.grids.natural_residual())
    }

    fn work_units(&self) -> f64 {
        self.grids.work_units
    }
}

/// Part of the correction that a cycle adds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum CyclePart {
    /// This multiple of it.
    Fixed(f64),
    /// The part with the least energy.
    LeastEnergy,
}

/// Choice of the part of the correction, by the residuals so far.
struct PartRule {
    /// Residuals before the last two cycles, the last one first.
    last: [f64; 2],
    /// True if two cycles have hardly lowered the residual.
    has_stalled: bool,
}

impl Default for PartRule {
    fn default() -> Self {
        Self { last: [f64::INFINITY; 2], has_stalled: false }
    }
}

impl PartRule {
    /// Part of the next correction, where the residual is this one.
    fn next(&mut self, residual: f64, has_limit: bool) -> CyclePart {
        let [previous, before] = self.last;
        self.last = [residual, previous];
        // Each of two contact sets may lead to the other; half a correction ends the alternation.
        let alternates = (residual - before).abs() <= ALTERNATION * residual;
        self.has_stalled |= residual > STALLING * previous && previous > STALLING * before;
        if self.has_stalled && has_limit {
            CyclePart::LeastEnergy
        } else if alternates {
            CyclePart::Fixed(0.5)
        } else {
            CyclePart::Fixed(1.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// PartRule of the correction before which the residuals are these.
    fn parts(residuals: &[f64], has_limit: bool) -> Vec<CyclePart> {
        let mut parts = PartRule::default();
        residuals.iter().map(|residual| parts.next(*residual, has_limit)).collect()
    }

    #[test]
    fn alternating_residuals_halve_the_correction() {
        assert_eq!(
            parts(&[1.0, 0.3, 0.8, 0.3001, 0.01], false),
            [1.0, 1.0, 1.0, 0.5, 1.0].map(CyclePart::Fixed)
        );
        // Residuals of about the same size do not alternate.
        assert_eq!(parts(&[1.0, 0.3, 0.8, 0.302], false), [CyclePart::Fixed(1.0); 4]);
    }

    #[test]
    fn residuals_that_stall_under_a_limit_end_fixed_parts() {
        let stalled = parts(&[1.0, 0.4, 0.2, 0.01], true);
        assert_eq!(stalled[..2], [CyclePart::Fixed(1.0); 2]);
        assert_eq!(stalled[2..], [CyclePart::LeastEnergy; 2]);
    }
}
