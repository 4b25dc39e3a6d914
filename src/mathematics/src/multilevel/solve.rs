//! Nested networks as the levels of the driver.

use super::cycle::Cycle;
use super::iterate::{ContactProblem, Iterate};
use super::levels::NetworkLevels;
use super::smoothed::{STRONG, VERY_STRONG};
use crate::discrete::components::components;
use crate::discrete::end::End;
use crate::discrete::kkt::judge;
use crate::discrete::law_and_load::LawAndLoad;
use crate::discrete::load_stats::LoadStats;
use crate::discrete::nested::NestedNetwork;
use crate::discrete::norms::largest;
use crate::discrete::stop::Stop;
use crate::multigrid::MultigridParams;
use crate::multigrid::active_set::active_set_on;
use crate::multigrid::driver::{self, Hierarchy, LoadScale};
use crate::multigrid::input::{InputError, check_length, check_load};
use crate::problem::law::Law;

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

/// Minimises the energy `1/2 y'Ay - F'y` with the law's term at the contact nodes on the last of nested networks, and
/// `y = 0` at its fixed nodes. `load` is the load vector F there. Returns the nodal vector, and the end.
///
/// # Errors
/// If the length of `load` is wrong, a number is not finite, or the flux cannot balance the load over a connected
/// component without fixed nodes; for the paper's law, if its sum is not negative there.
///
/// # Panics
/// If there are no levels.
pub fn solve_nested_networks(
    levels: &[NestedNetwork],
    problem: LawAndLoad<'_>,
    params: &MultigridParams,
) -> Result<(Vec<f64>, End), InputError> {
    let Improved { y, end, .. } =
        improve_on_nested_networks(levels, problem, Start::default(), params)?;
    Ok((y, end))
}

/// Facts known before a run on nested networks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Start<'a> {
    /// Nodal vector near the solution of the last network, in place of the solutions on the networks before it.
    pub y: Option<&'a [f64]>,
    /// True if the networks before the last one are of little use, as a run before has found.
    pub is_slow: bool,
}

/// End of a run on nested networks.
pub struct Improved {
    /// Nodal vector of the last network.
    pub y: Vec<f64>,
    /// End of the iteration.
    pub end: End,
    /// True if the networks before the last one have been of little use, or are said to be, as on stretched cells.
    pub is_slow: bool,
}

/// As [`solve_nested_networks`], with a start. Where the steps are slow, aggregates of the last network along its very
/// strong couplings take the place of the networks before it; where those are slow as well, the rest is done on the
/// levels that lower the residual more for their work.
///
/// # Errors
/// As [`solve_nested_networks`].
///
/// # Panics
/// If there are no levels.
pub fn improve_on_nested_networks(
    levels: &[NestedNetwork],
    problem: LawAndLoad<'_>,
    start: Start<'_>,
    params: &MultigridParams,
) -> Result<Improved, InputError> {
    let last = &levels[levels.len() - 1..];
    if start.is_slow {
        return Ok(solve_on(last, problem, start, true, params)?.improved);
    }
    let nested = solve_on(levels, problem, start, false, params)?;
    if !nested.improved.is_slow {
        return Ok(nested.improved);
    }
    let mut work = Work::of(&nested);
    let again = Start { y: Some(&nested.improved.y), is_slow: true };
    let aggregated = solve_on(last, problem, again, false, params)?;
    work.add(&aggregated);
    if !aggregated.is_cut_short {
        return Ok(work.with(aggregated.improved));
    }
    // Both are slow: go on with the one that lowers the residual more for its work.
    let is_slow = aggregated.speed >= nested.speed;
    let from = Start { y: Some(&aggregated.improved.y), is_slow };
    let chosen = if is_slow { last } else { levels };
    let rest = solve_on(chosen, problem, from, true, params)?;
    work.add(&rest);
    Ok(work.with(rest.improved))
}

/// Run on some levels.
struct LevelRun {
    improved: Improved,
    /// True if it ended since its steps were slow.
    is_cut_short: bool,
    /// Part by which the last measured steps lowered the logarithm of the residual, over their work.
    speed: f64,
}

/// Steps and work of several runs.
struct Work {
    iterations: usize,
    units: f64,
}

impl Work {
    fn of(run: &LevelRun) -> Self {
        Self { iterations: run.improved.end.iterations, units: run.improved.end.work_units }
    }

    fn add(&mut self, run: &LevelRun) {
        self.iterations += run.improved.end.iterations;
        self.units += run.improved.end.work_units;
    }

    /// The last of the runs, with the steps and the work of all.
    fn with(self, last: Improved) -> Improved {
        let end = End { iterations: self.iterations, work_units: self.units, ..last.end };
        Improved { end, ..last }
    }
}

/// Runs on these levels, and levels of aggregates below them: after a slow run of very strongly coupled nodes. Slow
/// steps end the run unless it is `to_the_end`.
fn solve_on(
    levels: &[NestedNetwork],
    LawAndLoad { law, load }: LawAndLoad<'_>,
    start: Start<'_>,
    to_the_end: bool,
    params: &MultigridParams,
) -> Result<LevelRun, InputError> {
    check_length(levels[levels.len() - 1].network.nodes(), load)?;
    let levels = NetworkLevels::new(levels, if start.is_slow { VERY_STRONG } else { STRONG });
    let load = &levels.renumbered(load);
    let components = Components::of(&levels, law, load)?;
    let one_sided = law.one_sided(load);
    let shifted = one_sided.load(load, levels.network(levels.finest()).contact());
    let scale = LoadStats::measure(&shifted).scale();
    let loads = levels.restricted(shifted.iter().map(|value| value / scale).collect());
    let nested = NestedProblem { levels, loads, components, scale };
    let mut run = NetworkRun::new(&nested);
    let factor = one_sided.signed(1.0) / scale;
    let scaled = |y: &[f64]| y.iter().map(|value| factor * value).collect::<Vec<f64>>();
    run.start = start.y.map(|y| scaled(&nested.levels.renumbered(y)));
    run.has_other_levels = !to_the_end;
    let end = driver::solve(&mut run, one_sided.limit, params)?;
    let is_cut_short = end.stop == Stop::IterationLimit && run.is_slow();
    let (is_slow, speed) = (start.is_slow || is_cut_short, run.speed());
    let mut y = nested.levels.in_order_of_mesh(run.take_y());
    y.iter_mut().for_each(|value| *value *= one_sided.signed(scale));
    Ok(LevelRun { improved: Improved { y, end, is_slow }, is_cut_short, speed })
}

/// Nested problems under a law `[0, limit]`.
struct NestedProblem<'a> {
    levels: NetworkLevels<'a>,
    /// Scaled load of each level.
    loads: Vec<Vec<f64>>,
    components: Components,
    /// Factor by which the load was divided.
    scale: f64,
}

impl NestedProblem<'_> {
    fn finest(&self) -> usize {
        self.levels.finest()
    }

    /// Law on a level whose flux has this limit on the finest one.
    fn law(&self, limit: f64, level: usize) -> Result<Law, InputError> {
        let [finest, network] = [self.finest(), level].map(|level| self.levels.network(level));
        // On curved boundaries the coarser polygons are shorter: their flux has to balance the same load.
        // Without contact nodes there is nothing to balance.
        let longer = if network.contact().is_empty() {
            1.0
        } else {
            finest.perimeter() / network.perimeter()
        };
        Ok(Law::new(0.0, limit * longer)?)
    }
}

/// Connected components of nested networks.
struct Components {
    /// True for each component that has a fixed node.
    has_fixed: Vec<bool>,
    /// Component of each contact node, for each level.
    of_contact: Vec<Vec<u32>>,
    /// Component of each node of the finest level.
    of_nodes: Vec<u32>,
}

impl Components {
    /// Finds the components, and checks the load on the finest level.
    fn of(levels: &NetworkLevels<'_>, law: Law, load: &[f64]) -> Result<Self, InputError> {
        let (of_nodes, of_contact) = levels.components();
        let found = components(levels.network(levels.finest()), &of_nodes, load);
        check_load(&found, law)?;
        let has_fixed = found.iter().map(|component| component.has_fixed).collect();
        Ok(Self { has_fixed, of_contact, of_nodes })
    }

    /// Measure of the boundary of each component that balances this load on the finest level if it slips down, with
    /// this limit of the flux.
    fn needed(&self, load: &[f64], limit: f64) -> Vec<f64> {
        let mut needed = vec![0.0; self.has_fixed.len()];
        for (&component, load) in self.of_nodes.iter().zip(load) {
            needed[component as usize] -= load / limit;
        }
        needed
    }
}

/// Solution of nested problems.
struct NetworkRun<'a> {
    nested: &'a NestedProblem<'a>,
    cycle: Cycle<'a>,
    /// Nodal vector from which the finest level starts, divided as the load.
    start: Option<Vec<f64>>,
    /// True if slow steps are to end, since other levels may be of more use.
    has_other_levels: bool,
    /// Limit of the flux, divided as the load.
    limit: f64,
    /// Measure of the boundary of each component that balances the load if it slips down.
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
    fn new(nested: &'a NestedProblem<'a>) -> Self {
        Self {
            nested,
            cycle: Cycle::new(&nested.levels),
            start: None,
            has_other_levels: true,
            limit: f64::INFINITY,
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
    fn speed(&self) -> f64 {
        let work =
            self.iterate.as_ref().map_or(f64::INFINITY, |iterate| iterate.work - self.worked);
        if self.measured == 0 || self.residual == 0.0 {
            return 0.0;
        }
        libm::log(self.before / self.residual) / work
    }

    /// Takes the nodal vector of the present level.
    fn take_y(&mut self) -> Vec<f64> {
        let Some(iterate) = self.iterate.take() else { return std::mem::take(&mut self.coarsest) };
        self.work += iterate.work;
        iterate.y
    }

    /// Begins with this nodal vector on a level; returns its residual after one sweep.
    fn begin(&mut self, level: usize, y: Vec<f64>) -> Result<f64, InputError> {
        let NestedProblem { levels, loads, components, .. } = self.nested;
        let problem = ContactProblem {
            network: levels.network(level),
            law: self.nested.law(self.limit, level)?,
            components: &components.of_contact[level],
            has_fixed: &components.has_fixed,
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

    fn set_problem(&mut self, limit: f64) -> Result<LoadScale, InputError> {
        let NestedProblem { loads, components, scale, .. } = self.nested;
        // What has been done before counts as well.
        self.take_y();
        self.limit = limit / scale;
        let load = &loads[self.finest()];
        self.needed = components.needed(load, self.limit);
        Ok(LoadScale { scale: *scale, largest: largest(load) })
    }

    fn solve_coarsest(&mut self) -> Result<Stop, InputError> {
        if self.nested.levels.coarsest_mesh > 0 {
            return self.solve_aggregates();
        }
        let (network, load) = (self.nested.levels.network(0), &self.nested.loads[0]);
        let law = self.nested.law(self.limit, 0)?;
        let (y, end) = active_set_on(network, law, load)?;
        self.coarse_energy = judge(network, law, &y, load).energy;
        self.work += self.cycle.coarsest_work(end.iterations);
        self.coarsest = y;
        Ok(end.stop)
    }

    fn refine(&mut self, level: usize) -> Result<f64, InputError> {
        let y = self.nested.levels.interpolate(level, &self.take_y());
        self.begin(level, y)
    }

    fn starts_with_limit(&self) -> bool {
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

    fn residual_under(&mut self, limit: f64) -> Result<f64, InputError> {
        let finest = self.finest();
        let (network, load) = (self.nested.levels.network(finest), &self.nested.loads[finest]);
        let law = self.nested.law(limit / self.nested.scale, finest)?;
        let y = self.iterate.as_ref().map_or(&self.coarsest, |iterate| &iterate.y);
        Ok(judge(network, law, y, load).kkt.natural)
    }

    fn work_units(&self) -> f64 {
        let work = self.work + self.iterate.as_ref().map_or(0.0, |iterate| iterate.work);
        work / self.nested.levels.network(self.finest()).nodes() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{AnyMesh, gmsh, mesh_load, on_regions, refined};

    #[test]
    fn meshes_take_over_again_where_aggregates_are_slower() {
        let file = include_bytes!("../../../../tests/meshes/plate60.msh");
        let AnyMesh::Space(mesh) = gmsh::read(file).unwrap() else { panic!("a mesh in space") };
        let (networks, mesh) = refined(&mesh, 2).unwrap();
        let f = on_regions::<3>("formula(4*x-3)", mesh.region_names(), mesh.extent()).unwrap();
        let load = mesh_load(&mesh, &f[..]).unwrap().load;
        let law = Law::friction(0.00595).unwrap();
        let params = MultigridParams::default();
        let (y, end) = solve_nested_networks(&networks, law.with_load(&load), &params).unwrap();
        let network = &networks[2].network;
        let kkt = judge(network, law, &y, &load).kkt;
        assert!(
            end.stop == Stop::RoundingFloor && end.iterations < 200,
            "{} {end:?} {kkt:?}",
            y.len()
        );
        // Each row is a sum of products, each of which is rounded.
        let rounding =
            network.row_length() * f64::EPSILON * largest(network.diagonal()) * largest(&y);
        assert!(kkt.natural < rounding, "{kkt:?} {rounding:e}");
    }
}
