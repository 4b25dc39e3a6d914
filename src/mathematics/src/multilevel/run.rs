//! Nested networks as the levels of the driver.

use super::cycle::Cycle;
use super::iterate::{ContactProblem, Iterate};
use super::levels::NestedProblem;
use crate::discrete::end::Stop;
use crate::discrete::kkt::judge;
use crate::discrete::norms::largest;
use crate::multigrid::InputError;
use crate::multigrid::active_set::active_set;
use crate::multigrid::driver::{self, Hierarchy, LoadScale};

/// Part of the energy's discretisation error that the last step may lower the energy by, where the discretisation error
/// is the goal. Each step lowers the distance to the least energy by ten and more, so that a hundredth of the
/// discretisation error, a tenth in the energy norm, is left.
const LAST_STEP: f64 = 0.1;
/// Number of steps over which their speed is measured.
const MEASURED_STEPS: usize = 8;
/// Part of the residual that is left after these steps from which on they are slow: 15 to 21 steps are usual to
/// rounding errors, and each leaves a third.
const SLOW: f64 = 0.03;
/// Such part from which on no further step may raise the energy.
const STALLED: f64 = 0.5;
/// Part of what is left of a distance that a step is worth its time for.
const LEAST_GAIN: f64 = 0.01;
/// Most steps on the coarsest level of aggregates.
const COARSEST_STEPS: usize = 30;

/// Solution of nested problems.
pub(super) struct NetworkRun<'a> {
    nested: &'a NestedProblem<'a>,
    cycle: Cycle<'a>,
    /// Nodal vector from which the finest level starts, divided as the load.
    pub(super) start: Option<Vec<f64>>,
    /// True if slow steps are to end, since other levels may be of more use.
    pub(super) has_other_levels: bool,
    /// True if the laws have their limits.
    has_limits: bool,
    /// Flux through the boundary of each component that balances the load.
    needed: Vec<f64>,
    /// Nodal vector of the coarsest level.
    coarsest: Vec<f64>,
    /// Nodal vector of a finer level.
    iterate: Option<Iterate<'a>>,
    /// Energy on the level before.
    coarse_energy: f64,
    /// Energy by which the last step has lowered that on the finest level.
    lowered: f64,
    /// Residual on the finest level before the last steps, by which their speed is measured.
    before: f64,
    /// Number of these steps.
    measured: usize,
    /// Work on the finest level before them.
    worked: f64,
    /// Residual on the finest level after the last step.
    residual: f64,
    /// Visits of unknowns on the levels before.
    work: f64,
}

impl<'a> NetworkRun<'a> {
    pub(super) fn new(nested: &'a NestedProblem<'a>) -> Self {
        Self {
            nested,
            cycle: Cycle::new(&nested.levels),
            start: None,
            has_other_levels: true,
            has_limits: false,
            needed: Vec::new(),
            coarsest: Vec::new(),
            iterate: None,
            coarse_energy: 0.0,
            lowered: 0.0,
            before: f64::INFINITY,
            measured: 0,
            worked: 0.0,
            residual: f64::INFINITY,
            work: 0.0,
        }
    }

    /// Part by which the measured steps lowered the logarithm of the residual, over the work on the finest level.
    pub(super) fn speed(&self) -> f64 {
        let work =
            self.iterate.as_ref().map_or(f64::INFINITY, |iterate| iterate.work - self.worked);
        if self.measured == 0 || self.residual == 0.0 {
            return 0.0;
        }
        libm::log(self.before / self.residual) / work
    }

    /// Takes the nodal vector of the present level.
    pub(super) fn take_y(&mut self) -> Vec<f64> {
        let Some(iterate) = self.iterate.take() else { return std::mem::take(&mut self.coarsest) };
        self.work += iterate.work;
        iterate.y
    }

    /// Begins with this nodal vector on a level; returns its residual after one sweep.
    fn begin(&mut self, level: usize, y: Vec<f64>) -> Result<f64, InputError> {
        let NestedProblem { levels, loads, components, .. } = self.nested;
        let problem = ContactProblem {
            network: levels.network(level),
            laws: self.nested.laws(self.has_limits, level)?,
            components: &components.of_contact[level],
            is_held: &components.is_held,
            needed: self.needed.clone(),
        };
        let iterate = self.iterate.insert(Iterate::new(problem, &loads[level], y));
        let residual = iterate.natural_residual();
        (self.before, self.measured, self.residual) = (residual, 0, residual);
        self.worked = iterate.work;
        Ok(residual)
    }

    /// Solves on the coarsest level of aggregates, where the cycle is the inverse but for the contact set.
    fn solve_aggregates(&mut self) -> Result<Stop, InputError> {
        let mut residual = self.begin(0, vec![0.0; self.nested.levels.network(0).nodes()])?;
        let iterate = self.iterate.as_mut().expect("just begun");
        for _ in 0..COARSEST_STEPS {
            if residual <= driver::ROUNDING_FLOOR * iterate.rounding() {
                break;
            }
            iterate.step(&mut self.cycle, 0);
            residual = iterate.natural_residual();
        }
        Ok(Stop::IterationLimit)
    }

    /// Nodal vector on the finest level, where that is not the coarsest.
    fn fine(&mut self) -> &mut Iterate<'a> {
        self.iterate.as_mut().expect("a level finer than the coarsest")
    }
}

impl Hierarchy for NetworkRun<'_> {
    const BY_RECURRENCE: bool = true;

    fn finest(&self) -> usize {
        self.nested.finest()
    }

    fn set_problem(&mut self, has_limits: bool) -> Result<LoadScale, InputError> {
        let NestedProblem { loads, components, scale, .. } = self.nested;
        // What has been done before counts as well.
        self.take_y();
        self.has_limits = has_limits;
        let load = &loads[self.finest()];
        self.needed = components.needed(load);
        Ok(LoadScale { scale: *scale, largest: largest(load) })
    }

    fn solve_coarsest(&mut self) -> Result<Stop, InputError> {
        if self.nested.levels.coarsest_mesh > 0 {
            return self.solve_aggregates();
        }
        let laws = self.nested.laws(self.has_limits, 0)?;
        let (network, load) =
            (self.nested.levels.network(0).with_laws(&laws), &self.nested.loads[0]);
        let (y, end) = active_set(&network, load, None)?;
        self.coarse_energy = judge(&network, &y, load).energy;
        self.work += self.cycle.coarsest_work(end.iterations);
        self.coarsest = y;
        Ok(end.stop)
    }

    fn refine(&mut self, level: usize) -> Result<f64, InputError> {
        let y = self.nested.levels.interpolate(level, &self.take_y());
        self.begin(level, y)
    }

    fn starts_with_limits(&self) -> bool {
        self.start.is_some()
    }

    fn start(&mut self) -> Result<Option<f64>, InputError> {
        let finest = self.finest();
        self.start.take().map(|y| self.begin(finest, y)).transpose()
    }

    fn settle(&mut self, level: usize) {
        let iterate = self.iterate.as_mut().expect("a level finer than the coarsest");
        iterate.step(&mut self.cycle, level);
        self.coarse_energy = iterate.energy();
    }

    fn step(&mut self, _residual: f64) -> f64 {
        let finest = self.finest();
        if self.measured == MEASURED_STEPS {
            (self.before, self.measured) = (self.residual, 0);
            self.worked = self.fine().work;
        }
        let iterate = self.iterate.as_mut().expect("a level finer than the coarsest");
        self.lowered = iterate.step(&mut self.cycle, finest);
        (self.residual, self.measured) = (iterate.natural_residual(), self.measured + 1);
        // Sets of held nodes may follow each other in a circle; where the energy falls, none returns.
        iterate.is_guarded |=
            self.measured == MEASURED_STEPS && self.residual > STALLED * self.before;
        self.residual
    }

    fn is_slow(&self) -> bool {
        let is_measured = self.measured == MEASURED_STEPS;
        self.has_other_levels && is_measured && self.residual > SLOW * self.before
    }

    /// The energy's error falls by four from one network to the next. On a curved boundary the domain changes as well,
    /// by as much.
    fn is_within_discretisation_error(&mut self) -> bool {
        // Energies of aggregates say nothing of the discretisation error.
        if self.finest() == self.nested.levels.coarsest_mesh {
            return false;
        }
        let discretisation = (self.coarse_energy - self.fine().energy()).abs() / 3.0;
        self.lowered <= LAST_STEP * discretisation
    }

    fn gains_little(&mut self, distance: f64) -> bool {
        let left = distance + self.fine().energy();
        self.lowered <= LEAST_GAIN * left
    }

    fn computed_residual(&mut self) -> f64 {
        let iterate = self.fine();
        iterate.renew_residual();
        iterate.natural_residual()
    }

    fn rounding(&mut self) -> f64 {
        self.fine().rounding()
    }

    fn residual_under(&mut self, has_limits: bool) -> Result<f64, InputError> {
        let finest = self.finest();
        let (network, load) = (self.nested.levels.network(finest), &self.nested.loads[finest]);
        let laws = self.nested.laws(has_limits, finest)?;
        let y = self.iterate.as_ref().map_or(&self.coarsest, |iterate| &iterate.y);
        Ok(network.natural_residual(&laws, y, |node| network.gradient_at(node, y, load)))
    }

    fn work_units(&self) -> f64 {
        let work = self.work + self.iterate.as_ref().map_or(0.0, |iterate| iterate.work);
        work / self.nested.levels.network(self.finest()).nodes() as f64
    }
}
