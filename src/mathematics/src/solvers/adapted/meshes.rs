//! Meshes of a run of adaptive refinement, each with its discrete problem, and the solution on the finest.

use super::{Adaption, expected_squares, largest_parts};
use crate::bounds::triangulation::{
    BoundedProblem, LocalBounds, curve_shares, is_in_stretched_cells,
};
use crate::bounds::{Bounds, NoBound};
use crate::discrete::domain::DiscreteDomain;
use crate::discrete::domain::components;
use crate::discrete::end::{End, Outcome, Stop};
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::nested::NestedNetwork;
use crate::levels::{
    Problem, ProblemError, ROUNDING, Step, Triangulations, VectorErrors, Watch, check_missed, read,
};
use crate::machine::threads::{among_threads, join, map};
use crate::mesh::{
    Bisected, CellsBefore, MeshLoad, NestedMeshes, PlaneMesh, Sides, assemble_sides, bisect,
    check_meetings, check_values, label_longest_edges, mesh_load, mesh_load_after,
};
use crate::multigrid::active_set::active_set;
use crate::multigrid::{Goal, InputError, MultigridParams};
use crate::multilevel::{Improved, Start, improve_on_nested_networks};
use crate::problem::source::Source;
use crate::saddle::Monitor;
use crate::solvers::reach::Refining;
use crate::solvers::run::{Run, has_factors};
use crate::solvers::solved::{ReachEnd, Reached, Solved};
use crate::solvers::{Refusal, Solver};
use std::borrow::Cow;

/// Steps on each mesh but the first, at least.
const STEPS: usize = 4;
/// Most steps on a mesh whose factors are worth their time, which take over then.
const MOST_STEPS: usize = 100;
/// KKT residual over the largest load up to which a vector has converged: on well-shaped cells the first steps leave a
/// tenth of that.
const TOLERANCE: f64 = 0.02;
/// Residual, likewise, where steps are slow, as on stretched cells, whose bounds feel smaller ones.
const SLOW_TOLERANCE: f64 = 0.005;
/// Part of the square of the error that the marked cells have at most.
const MARKED: f64 = 0.65;
/// Least such part, where little is missing.
const LEAST_MARKED: f64 = 0.02;
/// Part of the square of the error in marked cells that the first bisections are expected to take away, about.
const GAIN: f64 = 0.77;
/// Least such part that is expected of later bisections, whatever the last ones have taken away.
const LEAST_GAIN: f64 = 0.6;
/// Part of the goal's square that is aimed at: a mesh that just misses the goal has cost as much as the last one.
const AIM: f64 = 0.95;
/// Part of the error that is left at most when the number of nodes has doubled; 0.71 is usual.
const FALL: f64 = 0.9;
/// Number of meshes with a bound from which on they tell whether the error falls.
const LEAST_ERRORS: usize = 4;
/// Numbers whose work takes as long as that on a node.
const COST: usize = 16;
/// Number of nodes up to which the polygon of a curved domain may be too coarse for a flux that balances f.
const COARSE: usize = 1000;
/// Number of nodes up to which rounding errors may leave a mesh without a bound, or long cells with one that is larger
/// than the solution.
const MOST_WITHOUT_BOUND: usize = 100_000;

/// Meshes so far, with the solution on the finest.
pub(super) struct Meshes<'a> {
    adaption: &'a Adaption<'a>,
    /// Is told each step.
    ended: Watch<'a>,
    /// f on each region.
    f: Vec<Source>,
    all: Vec<PlaneMesh>,
    networks: Vec<NestedNetwork>,
    /// True if the networks before the last one are of little use, as on stretched cells.
    is_slow: bool,
    /// Cells that were marked for each mesh but the first; none where all cells were divided into four.
    pub(super) marks: Vec<Vec<u32>>,
    /// Number of the connected component of each node of the finest mesh.
    component_of: Vec<u32>,
    /// Sides of the cells of the finest mesh.
    pub(super) sides: Sides<3>,
    /// f on the finest mesh.
    load: MeshLoad,
    /// Nodal vector of the finest mesh, interpolated before it is improved; none before there is a solution.
    y: Option<Vec<f64>>,
    /// Judgement of the vector.
    judgement: Option<Judgement>,
    pub(super) outcomes: Vec<Outcome>,
    /// Guaranteed bounds on each mesh with a solution.
    bounds: Vec<Result<Bounds, NoBound>>,
    /// Guaranteed bounds on the finest mesh with the parts of the cells, or the reason for which there are none.
    pub(super) found: Result<LocalBounds, NoBound>,
    /// Number of nodes and guaranteed error of each mesh so far that has one.
    errors: Vec<[f64; 2]>,
    /// True if the last such error may be larger than the solution.
    is_vague: bool,
    /// True if stretched cells have much of it.
    pub(super) is_stretched: bool,
    /// Part of the square of the error that the cells had that were marked last.
    marked: f64,
    /// Part of their square that their bisections are expected to take away.
    gain: f64,
}

impl<'a> Meshes<'a> {
    /// The first mesh.
    pub(super) fn new(adaption: &'a Adaption<'a>, ended: Watch<'a>) -> Result<Self, ProblemError> {
        let f = read(adaption.coarsest, adaption.f)?;
        check_meetings(adaption.coarsest)?;
        let mut mesh = adaption.coarsest.clone();
        label_longest_edges(&mut mesh);
        let sides = Sides::new(&mesh);
        let network = assemble_sides(&mesh, &sides);
        ended(Step::Mesh);
        let load = mesh_load(&mesh, &f[..])?;
        ended(Step::Load);
        load.check_scale(&f)?;
        Ok(Self {
            adaption,
            ended,
            f,
            component_of: network.components(),
            all: vec![mesh],
            networks: vec![NestedNetwork { network, parents: Vec::new() }],
            is_slow: false,
            marks: Vec::new(),
            sides,
            load,
            y: None,
            judgement: None,
            outcomes: Vec::new(),
            bounds: Vec::new(),
            found: Err(NoBound::NotFinite),
            errors: Vec::new(),
            is_vague: false,
            is_stretched: false,
            marked: MARKED,
            gain: GAIN,
        })
    }

    pub(super) fn finest(&self) -> &PlaneMesh {
        &self.all[self.all.len() - 1]
    }

    /// Solves on the finest mesh; returns the bounds, or the reason for which there are none.
    fn solved(&mut self) -> Result<Result<LocalBounds, NoBound>, ProblemError> {
        let network = &self.networks[self.networks.len() - 1].network;
        let found = components(network, &self.component_of, &self.load.load);
        let rounding = ROUNDING * (self.load.size + self.load.given);
        if let Err(reason) = found.iter().try_for_each(|of| of.check(rounding)) {
            return if self.is_coarse() { Ok(Err(reason.into())) } else { Err(reason.into()) };
        }
        let has_solution = found.iter().all(|of| of.check(0.0).is_ok());
        let tolerance = if self.is_slow || self.is_stretched { SLOW_TOLERANCE } else { TOLERANCE };
        let unit = DiscreteDomain::from(network).unit(&self.load.load);
        let goal = Goal::Kkt(tolerance * unit);
        let usual = MultigridParams::default();
        let max_cycles = if has_factors(2, self.nodes()) { MOST_STEPS } else { usual.max_cycles };
        let params = MultigridParams { goal, least_cycles: STEPS, max_cycles };
        let bounds = self.improve(&params, has_solution)?;
        self.note(&bounds);
        if !self.has_stalled() {
            return Ok(bounds);
        }
        self.errors.pop();
        self.outcomes.pop();
        self.bounds.pop();
        let bounds = self.improve(&MultigridParams::default(), has_solution)?;
        self.note(&bounds);
        Ok(bounds)
    }

    /// True if a finer mesh may have a flux that balances f although this one has none.
    fn is_coarse(&self) -> bool {
        let is_curved = self.finest().parts().iter().any(|part| part.curve.is_some());
        is_curved && self.nodes() <= COARSE
    }

    /// Solves, or improves the interpolated solution; returns the bounds.
    fn improve(
        &mut self,
        params: &MultigridParams,
        has_solution: bool,
    ) -> Result<Result<LocalBounds, NoBound>, ProblemError> {
        let y = self.y.as_deref().filter(|_| self.networks.len() > 1);
        let usual = MultigridParams::default();
        let params = if y.is_some() { params } else { &usual };
        let start = Start { y, is_slow: self.is_slow };
        let solved = improve_on_nested_networks(&self.networks, &self.load.load, start, params);
        (self.ended)(Step::Solver);
        let Improved { mut y, mut end, is_slow } = match solved {
            Err(InputError::Unsolvable(reason)) if self.is_coarse() => {
                return Ok(Err(reason.into()));
            }
            solved => solved?,
        };
        self.is_slow = is_slow;
        if end.stop == Stop::IterationLimit && has_factors(2, y.len()) {
            let network = &self.networks[self.networks.len() - 1].network;
            (y, end) = active_set(network, &self.load.load, Some(&y))?;
        }
        // The bound is the goal: rounding errors are small enough.
        let stop = if end.stop == Stop::RoundingFloor { Stop::Converged } else { end.stop };
        let end = End { stop, ..end };
        let network = &self.networks[self.networks.len() - 1].network;
        let (mesh, sides, f) = (self.finest(), &self.sides, &self.load);
        let bounded = BoundedProblem { mesh, sides, network, f };
        let missed = check_missed(f.missed());
        let (judgement, bounds) = among_threads(COST * y.len(), || {
            join(|| judge(network, &y, &f.load), || missed.and_then(|()| bounded.bounds(&y)))
        });
        let outcome = Outcome::new(end, &judgement, None, &self.load.load, has_solution);
        self.outcomes.push(outcome);
        self.bounds.push(without_parts(&bounds));
        (self.ended)(Step::Bounds);
        (self.y, self.judgement) = (Some(y), Some(judgement));
        Ok(bounds)
    }

    /// Notes the error of the finest mesh.
    fn note(&mut self, bounds: &Result<LocalBounds, NoBound>) {
        if let Ok(LocalBounds { bounds, squares }) = bounds {
            self.errors.push([self.nodes() as f64, bounds.error[1]]);
            self.is_vague = bounds.relative() > 1.0;
            self.is_stretched = is_in_stretched_cells(self.finest(), squares);
        }
    }

    /// True if the error has hardly fallen while the number of nodes has doubled, twice; the first meshes do not tell,
    /// and bounds that are larger than the solution do not while meshes are coarse.
    fn has_stalled(&self) -> bool {
        let is_vague = self.is_vague && self.nodes() <= MOST_WITHOUT_BOUND;
        if is_vague || self.errors.len() < LEAST_ERRORS {
            return false;
        }
        let Some(&[nodes, error]) = self.errors.last() else { return false };
        [0.5, 0.25].into_iter().all(|part| {
            let mut before = self.errors.iter().rev();
            before.find(|[few, _]| *few <= part * nodes).is_some_and(|[_, old]| error > FALL * old)
        })
    }

    /// Adds the next meshes, on the last of which a solution is sought; false if there is none that is allowed. Without
    /// bounds all cells are bisected.
    fn add_meshes(&mut self, bounds: Option<&LocalBounds>) -> Result<bool, ProblemError> {
        let bisected = self.bisected(bounds)?;
        self.add(bisected)
    }

    /// Adds meshes, each made from the one before; false if there are none.
    pub(super) fn add(&mut self, bisected: Vec<Bisected>) -> Result<bool, ProblemError> {
        (self.ended)(Step::Mesh);
        bisected.iter().try_for_each(|made| check_values(&made.mesh))?;
        let Some(Bisected { mesh, origins, .. }) = bisected.last() else { return Ok(false) };
        let mut origins = Cow::Borrowed(&origins[..]);
        for before in bisected.iter().rev().skip(1) {
            origins = origins.iter().map(|&cell| before.origins[cell as usize]).collect();
        }
        let before = CellsBefore { origins: &origins, f: &self.load.cells };
        let (f, ended) = (&self.f, self.ended);
        let (networks, load) = among_threads(COST * mesh.points().len(), || {
            let networks = || {
                let networks = map(&bisected, 1, |made| assemble_sides(&made.mesh, &made.sides));
                ended(Step::Mesh);
                networks
            };
            let load = || {
                let load = mesh_load_after(before, mesh, &f[..]);
                ended(Step::Load);
                load
            };
            join(networks, load)
        });
        self.load = load?;
        for (Bisected { mesh, sides, parents, .. }, network) in bisected.into_iter().zip(networks) {
            let level = NestedNetwork { network, parents };
            self.y = self.y.take().map(|y| level.interpolate(&y));
            for &[parent, _] in &level.parents {
                self.component_of.push(self.component_of[parent as usize]);
            }
            self.sides = sides;
            self.all.push(mesh);
            self.networks.push(level);
        }
        Ok(true)
    }

    /// The next meshes, as many as there are bisections between two solutions; fewer if one would have too many nodes
    /// or there is nothing to gain.
    fn bisected(&mut self, bounds: Option<&LocalBounds>) -> Result<Vec<Bisected>, ProblemError> {
        let (mut squares, fraction, times) = match bounds {
            Some(found) => {
                (self.squares(found), self.fraction(&found.bounds), self.adaption.bisections)
            }
            None => (vec![1.0; self.finest().cells().len()], 1.0, 1),
        };
        let mut made: Vec<Bisected> = Vec::new();
        for _ in 0..times {
            let (mesh, sides) = match made.last() {
                Some(last) => (&last.mesh, &last.sides),
                None => (self.finest(), &self.sides),
            };
            let marked = largest_parts(&squares, fraction);
            let next = bisect(mesh, sides, &marked)?;
            if next.mesh.points().len() > self.adaption.most_nodes || next.parents.is_empty() {
                break;
            }
            squares = expected_squares(&squares, &next.origins);
            made.push(next);
            self.marks.push(marked);
        }
        Ok(made)
    }

    /// Part of the square of the error that the cells to be marked have: all bisections until the goal is met are
    /// expected to take away the same part of what is left.
    fn fraction(&mut self, bounds: &Bounds) -> f64 {
        let bisections = self.adaption.bisections as f64;
        if let [.., [_, before], [_, now]] = self.errors[..] {
            let left = libm::pow(now / before, 2.0 / bisections);
            self.gain = ((1.0 - left) / self.marked).clamp(LEAST_GAIN, 1.0);
        }
        let left = AIM * self.adaption.goal.square_left(bounds);
        // While the bounds do not tell how much is left, it is much.
        self.marked = MARKED;
        if left > 0.0 {
            let most = bisections * libm::log(1.0 - self.gain * MARKED);
            let times = bisections * (libm::log(left) / most).ceil().max(1.0);
            let marked = (1.0 - libm::pow(left, 1.0 / times)) / self.gain;
            self.marked = marked.clamp(LEAST_MARKED, MARKED);
        }
        self.marked
    }

    /// Square of the error in each cell, with what the bounds do not feel.
    fn squares(&self, found: &LocalBounds) -> Vec<f64> {
        let mut squares = found.squares.clone();
        let y = self.y.as_deref().unwrap_or_default();
        let shares = curve_shares(self.finest(), &self.sides, &self.load.cells.mean, y);
        for share in shares.into_iter().flatten() {
            squares[share.cell as usize] += share.square;
        }
        squares
    }
}

impl Refining for Meshes<'_> {
    fn nodes(&self) -> usize {
        self.finest().points().len()
    }

    fn solve(&mut self, _: &mut dyn Monitor) -> Result<Result<Bounds, NoBound>, Refusal> {
        self.found = self.solved()?;
        Ok(without_parts(&self.found))
    }

    /// A solution may be rough: only its bound is asked for.
    fn has_failed(&self) -> bool {
        false
    }

    fn is_hopeless(&self, reason: &NoBound) -> bool {
        *reason == NoBound::NotFinite || self.nodes() > MOST_WITHOUT_BOUND
    }

    fn refine(&mut self) -> Result<Option<ReachEnd>, Refusal> {
        let found = std::mem::replace(&mut self.found, Err(NoBound::NotFinite));
        let reached = found.as_ref().map(|found| self.adaption.goal.reached(&found.bounds));
        let best = reached.unwrap_or(f64::INFINITY);
        let end = if reached.is_ok() && self.has_stalled() {
            Some(ReachEnd::Rounding { least: best })
        } else if self.add_meshes(found.as_ref().ok())? {
            None
        } else {
            Some(ReachEnd::Finest { needed: None, best })
        };
        self.found = found;
        Ok(end)
    }

    fn finished(mut self, reached: Reached) -> Result<Solved, Refusal> {
        let found = self.found.map_err(Refusal::NoBound)?;
        self.bounds.pop();
        let y = self.y.expect("a vector with bounds");
        let network = &self.networks[self.networks.len() - 1].network;
        let (mesh, sides, f) = (&self.all[self.all.len() - 1], &self.sides, &self.load);
        let errors = VectorErrors { y: y.clone(), of_cells: found.errors() };
        let bounded = BoundedProblem { mesh, sides, network, f };
        self.bounds.push(Ok(bounded.with_lower(found.bounds, &y)));
        (self.ended)(Step::Bounds);
        let is_curved = mesh.parts().iter().any(|part| part.curve.is_some());
        let nested = NestedMeshes { meshes: self.all, networks: self.networks, sides: self.sides };
        let levels =
            Triangulations::of(nested, (self.f, self.adaption.f), self.load).adapted(errors);
        let run = Run {
            solver: Solver::Multigrid,
            y,
            first_level: reached.tried - self.outcomes.len(),
            ends: self.outcomes,
            judgement: self.judgement.expect("a vector with bounds"),
        };
        let problem = Problem::checked(levels, is_curved);
        let reached = Reached { marks: Some(self.marks), ..reached };
        Ok(Solved::with_bounds(problem, run, self.bounds, reached))
    }
}

/// The bounds without the parts of the cells.
fn without_parts(found: &Result<LocalBounds, NoBound>) -> Result<Bounds, NoBound> {
    found.as_ref().map(|found| found.bounds.clone()).map_err(|reason| *reason)
}
