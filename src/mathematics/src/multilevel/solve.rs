//! Nested iteration and the stopping test.

use super::cycle::Cycle;
use super::iterate::{ContactProblem, Iterate};
use crate::discrete::end::End;
use crate::discrete::kkt::judge;
use crate::discrete::law_and_load::LawAndLoad;
use crate::discrete::nested::{NestedNetwork, restricted};
use crate::discrete::stop::Stop;
use crate::multigrid::active_set::active_set_on;
use crate::multigrid::input::{InputError, LoadStats, check_components, check_length};
use crate::multigrid::{Goal, MultigridParams, ROUNDING_FLOOR};
use crate::problem::law::Law;

/// Part of the energy's discretisation error that the last step may lower the energy by, where the discretisation error is
/// the goal. Each step lowers the distance to the least energy by ten and more, so that a hundredth of the discretisation
/// error, a tenth in the energy norm, is left.
const LAST_STEP: f64 = 0.1;
/// Multiple of the rounding floor up to which a residual that no longer falls is one of rounding errors.
const NEAR_FLOOR: f64 = 1e3;
/// Steps in which the residual has to halve; if it does not, no further step may raise the energy.
const PATIENCE: usize = 10;
/// Reduction of the residual in the time of a restart from which on it no longer falls.
const STAGNATION: f64 = 0.5;

/// Minimises the energy `1/2 y'Ay - F'y` with the law's term at the contact nodes on the last of nested networks, and
/// `y = 0` at its fixed nodes. `load` is the load vector F there. Returns the nodal vector, and the end.
///
/// # Errors
/// If the length of `load` is wrong, a number is not finite, or the flux cannot balance the load over a connected component
/// without fixed nodes; for the paper's law, if its sum is not negative there.
///
/// # Panics
/// If there are no levels.
pub fn solve_nested_networks(
    levels: &[NestedNetwork],
    LawAndLoad { law, load }: LawAndLoad<'_>,
    params: &MultigridParams,
) -> Result<(Vec<f64>, End), InputError> {
    let network = &levels[levels.len() - 1].network;
    check_length(network.nodes(), load)?;
    let components = Components::of(levels, law, load)?;
    let one_sided = law.one_sided(load);
    let shifted = one_sided.load(load, network.contact());
    let scale = LoadStats::measure(&shifted).scale();
    let loads = restricted(levels, shifted.iter().map(|value| value / scale).collect());
    let nested = NestedProblem { levels, loads, components, scale };
    let (mut y, mut progress) = nested.solve(f64::INFINITY, params)?;
    let limit = one_sided.limit / scale;
    if limit.is_finite() && nested.exceeds(limit, &y)? {
        let work = progress.work;
        (y, progress) = nested.solve(limit, params)?;
        progress.work += work;
    }
    y.iter_mut().for_each(|value| *value *= one_sided.signed(scale));
    let work_units = progress.work / network.nodes() as f64;
    let Progress { stop, cycles: iterations, .. } = progress;
    Ok((y, End { iterations, work_units, stop, delta_a: None }))
}

/// Nested problems under a law `[0, limit]`.
struct NestedProblem<'a> {
    levels: &'a [NestedNetwork],
    /// Scaled load of each level.
    loads: Vec<Vec<f64>>,
    components: Components,
    /// Factor by which the load was divided.
    scale: f64,
}

impl NestedProblem<'_> {
    fn finest(&self) -> usize {
        self.levels.len() - 1
    }

    /// Law on a level whose flux has this limit on the finest one.
    fn law(&self, limit: f64, level: usize) -> Result<Law, InputError> {
        let [finest, network] = [self.finest(), level].map(|level| &self.levels[level].network);
        // On curved boundaries the coarser polygons are shorter: their flux has to balance the same load.
        // Without contact nodes there is nothing to balance.
        let longer = if network.contact().is_empty() {
            1.0
        } else {
            finest.perimeter() / network.perimeter()
        };
        Ok(Law::new(0.0, limit * longer)?)
    }

    /// True if the flux of a nodal vector, solved for without a limit, exceeds this limit: otherwise it solves the problem
    /// with the limit, too.
    fn exceeds(&self, limit: f64, y: &[f64]) -> Result<bool, InputError> {
        let finest = self.finest();
        let (network, load) = (&self.levels[finest].network, &self.loads[finest]);
        let [with, without] = [self.law(limit, finest)?, Law::SIGNORINI]
            .map(|law| judge(network, law, y, load).kkt.natural);
        Ok(with > without)
    }

    /// Solves on all levels with this limit, each level started from the next coarser one.
    fn solve(
        &self,
        limit: f64,
        params: &MultigridParams,
    ) -> Result<(Vec<f64>, Progress), InputError> {
        let Self { levels, loads, components, scale } = self;
        let (finest, coarsest) = (self.finest(), &levels[0].network);
        let needed = components.needed(&loads[finest], limit);
        let law = self.law(limit, 0)?;
        let (mut y, direct) = active_set_on(coarsest, law, &loads[0])?;
        let mut cycle = Cycle::new(levels);
        let mut progress = Progress {
            stop: direct.stop,
            cycles: 0,
            residual: f64::INFINITY,
            coarse_energy: judge(coarsest, law, &y, &loads[0]).energy,
            work: direct.iterations as f64 * cycle.work_of_coarsest_step(),
        };
        for level in 1..levels.len() {
            y = levels[level].interpolate(&y);
            let problem = ContactProblem {
                network: &levels[level].network,
                law: self.law(limit, level)?,
                components: &components.of_contact[level],
                has_fixed: &components.has_fixed,
                needed: &needed,
            };
            let mut iterate = Iterate::new(&problem, &loads[level], y);
            if level < finest {
                iterate.step(&mut cycle, level);
                progress.coarse_energy = iterate.energy();
            } else {
                let target = FinestTarget { level, scale: *scale, params };
                progress.run(&mut iterate, &mut cycle, &target);
            }
            progress.work += iterate.work;
            y = iterate.y;
        }
        Ok((y, progress))
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
    fn of(levels: &[NestedNetwork], law: Law, load: &[f64]) -> Result<Self, InputError> {
        let mut of_nodes = levels[0].network.components();
        let mut of_contact = Vec::new();
        for level in levels {
            let of_parent = |&[parent, _]: &[u32; 2]| of_nodes[parent as usize];
            let new: Vec<u32> = level.parents.iter().map(of_parent).collect();
            of_nodes.extend(new);
            let contact = level.network.contact().iter();
            of_contact.push(contact.map(|contact| of_nodes[contact.node]).collect());
        }
        let has_fixed = check_components(&levels[levels.len() - 1].network, &of_nodes, law, load)?;
        Ok(Self { has_fixed, of_contact, of_nodes })
    }

    /// Measure of the boundary of each component that balances this load on the finest level if it slips down, with this
    /// limit of the flux.
    fn needed(&self, load: &[f64], limit: f64) -> Vec<f64> {
        let mut needed = vec![0.0; self.has_fixed.len()];
        for (&component, load) in self.of_nodes.iter().zip(load) {
            needed[component as usize] -= load / limit;
        }
        needed
    }
}

/// Target of the iteration on the finest level.
struct FinestTarget<'a> {
    level: usize,
    /// Factor by which the load was divided.
    scale: f64,
    params: &'a MultigridParams,
}

/// Iteration on the finest level.
struct Progress {
    stop: Stop,
    cycles: usize,
    /// Natural residual of the scaled load.
    residual: f64,
    /// Energy on the level before.
    coarse_energy: f64,
    /// Visits of unknowns.
    work: f64,
}

impl Progress {
    /// Applies steps until the goal is reached.
    fn run(&mut self, iterate: &mut Iterate<'_>, cycle: &mut Cycle<'_>, target: &FinestTarget<'_>) {
        let FinestTarget { level, scale, params } = *target;
        let mut renewed = f64::INFINITY;
        self.residual = iterate.natural_residual();
        let (mut halved, mut since) = (self.residual, 0);
        self.stop = loop {
            if self.cycles == params.max_cycles {
                break Stop::IterationLimit;
            }
            let lowered = iterate.step(cycle, level);
            self.cycles += 1;
            self.residual = iterate.natural_residual();
            if !self.residual.is_finite() {
                break Stop::Diverged;
            }
            since += 1;
            if self.residual <= 0.5 * halved {
                (halved, since) = (self.residual, 0);
            }
            // Sets of held nodes may follow each other in a circle; where the energy falls, none returns.
            iterate.is_guarded |= since >= PATIENCE;
            match params.goal {
                Goal::DiscretisationError => {
                    // The energy's error falls by four from one network to the next. On a curved boundary the domain
                    // changes as well, by as much.
                    let discretisation = (self.coarse_energy - iterate.energy()).abs() / 3.0;
                    if lowered <= LAST_STEP * discretisation {
                        break Stop::Converged;
                    }
                }
                Goal::Kkt(tolerance) if self.residual * scale <= tolerance => {
                    iterate.renew_residual();
                    self.residual = iterate.natural_residual();
                    if self.residual * scale <= tolerance {
                        break Stop::Converged;
                    }
                }
                Goal::Kkt(_) | Goal::RoundingFloor => {}
            }
            let floor = ROUNDING_FLOOR * iterate.rounding();
            if self.residual <= floor {
                // The residual of the recurrence goes on falling below that of the nodal vector.
                iterate.renew_residual();
                self.residual = iterate.natural_residual();
                let no_longer_falls =
                    self.residual >= STAGNATION * renewed && self.residual <= NEAR_FLOOR * floor;
                if self.residual <= floor || no_longer_falls {
                    break Stop::RoundingFloor;
                }
                renewed = self.residual;
            }
        };
    }
}
