//! Meshes of a run of adaptive refinement, each with its discrete problem, and the solution on the finest.

use super::marking::largest_parts;
use super::{AdaptedEnd, AdaptedRun, Adaption};
use crate::bounds::NoBound;
use crate::bounds::triangulation::{BoundedProblem, LocalBounds, curve_shares};
use crate::discrete::components::components;
use crate::discrete::end::{End, Outcome};
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::nested::NestedNetwork;
use crate::discrete::stop::Stop;
use crate::levels::{Problem, ProblemError, ROUNDING, Triangulations};
use crate::machine::threads::among_threads;
use crate::mesh::{
    Bisected, CellsBefore, MeshLoad, MeshSource, NestedMeshes, PlaneMesh, Sides, assemble_sides,
    bisect, label_longest_edges, mesh_load, mesh_load_after,
};
use crate::multigrid::{InputError, MultigridParams};
use crate::multilevel::{improve_on_nested_networks, solve_nested_networks};
use crate::problem::unsolvable::{Component, Unsolvable};

/// Steps on each mesh but the first.
const STEPS: usize = 2;
/// Steps at most to a solution up to rounding.
const MOST_STEPS: usize = 100;
/// Part of the square of the error that the marked cells have.
const MARKED: f64 = 0.5;
/// Least such part, where little is missing.
const LEAST_MARKED: f64 = 0.1;
/// Part of the square of the error in marked cells that their bisections take away, about.
const GAIN: f64 = 0.7;
/// Part of the error that is left at most when the number of nodes has doubled; 0.71 is usual.
const FALL: f64 = 0.9;
/// Numbers whose work takes as long as that on a node.
const COST: usize = 16;
/// Number of nodes up to which the polygon of a curved domain may be too coarse for a flux that balances f.
const COARSE: usize = 1000;
/// Number of nodes up to which rounding errors may leave a mesh without a bound.
const MOST_WITHOUT_BOUND: usize = 100_000;

/// Meshes so far, with the solution on the finest.
pub(super) struct Meshes<'a> {
    adaption: &'a Adaption<'a>,
    f: MeshSource<2>,
    all: Vec<PlaneMesh>,
    networks: Vec<NestedNetwork>,
    /// Number of the connected component of each node of the finest mesh.
    component_of: Vec<u32>,
    /// Sides of the cells of the finest mesh.
    sides: Sides<3>,
    /// f on the finest mesh.
    load: MeshLoad,
    /// Nodal vector of the finest mesh, interpolated before it is improved; none before there is a solution.
    y: Option<Vec<f64>>,
    /// Judgement of the vector.
    judgement: Option<Judgement>,
    outcomes: Vec<Outcome>,
    /// Number of nodes and guaranteed error of each mesh so far that has one.
    errors: Vec<[f64; 2]>,
}

impl<'a> Meshes<'a> {
    /// The first mesh.
    pub(super) fn new(adaption: &'a Adaption<'a>, f: MeshSource<2>) -> Result<Self, ProblemError> {
        let mut mesh = adaption.coarsest.clone();
        label_longest_edges(&mut mesh);
        let sides = Sides::new(&mesh);
        let network = assemble_sides(&mesh, &sides);
        let load = mesh_load(&mesh, &f)?;
        f.check_scale(load.size)?;
        Ok(Self {
            adaption,
            f,
            component_of: network.components(),
            all: vec![mesh],
            networks: vec![NestedNetwork { network, parents: Vec::new() }],
            sides,
            load,
            y: None,
            judgement: None,
            outcomes: Vec::new(),
            errors: Vec::new(),
        })
    }

    fn finest(&self) -> &PlaneMesh {
        &self.all[self.all.len() - 1]
    }

    /// Number of nodes of the finest mesh.
    pub(super) fn nodes(&self) -> usize {
        self.finest().points().len()
    }

    /// Solves on the finest mesh; returns the bounds, or the reason for which there are none.
    pub(super) fn solved(&mut self) -> Result<Result<LocalBounds, NoBound>, ProblemError> {
        let network = &self.networks[self.networks.len() - 1].network;
        let found = components(network, &self.component_of, &self.load.load);
        let rounding = ROUNDING * self.load.size;
        if let Err(reason) = self.check(&found, rounding) {
            return if self.is_coarse() { Ok(Err(reason.into())) } else { Err(reason.into()) };
        }
        let has_solution = self.check(&found, 0.0).is_ok();
        let mut bounds = self.improve(STEPS, has_solution)?;
        self.note(&bounds);
        if self.has_stalled() {
            self.errors.pop();
            self.outcomes.pop();
            bounds = self.improve(MOST_STEPS, has_solution)?;
            self.note(&bounds);
        }
        Ok(bounds)
    }

    fn check(&self, components: &[Component], rounding: f64) -> Result<(), Unsolvable> {
        components.iter().try_for_each(|component| component.check(self.adaption.law, rounding))
    }

    /// True if a finer mesh may have a flux that balances f although this one has none.
    fn is_coarse(&self) -> bool {
        let is_curved = self.finest().parts().iter().any(|part| part.curve.is_some());
        is_curved && self.nodes() <= COARSE
    }

    /// True if a finer mesh has no bound either, for a reason why this one has none.
    pub(super) fn is_hopeless(&self, reason: &NoBound) -> bool {
        *reason == NoBound::NotFinite || self.nodes() > MOST_WITHOUT_BOUND
    }

    /// Solves, or improves the solution by some steps; returns the bounds.
    fn improve(
        &mut self,
        steps: usize,
        has_solution: bool,
    ) -> Result<Result<LocalBounds, NoBound>, ProblemError> {
        let law = self.adaption.law;
        let problem = law.with_load(&self.load.load);
        let solved = match &self.y {
            Some(start) if self.networks.len() > 1 => {
                improve_on_nested_networks(&self.networks, problem, start, steps)
            }
            _ => solve_nested_networks(&self.networks, problem, &MultigridParams::default()),
        };
        let (y, end) = match solved {
            Err(InputError::Unsolvable(reason)) if self.is_coarse() => {
                return Ok(Err(reason.into()));
            }
            solved => solved?,
        };
        // The bound is the goal, not the number of steps or a residual.
        let stop = if end.stop == Stop::Diverged { end.stop } else { Stop::Converged };
        let end = End { stop, ..end };
        let network = &self.networks[self.networks.len() - 1].network;
        let (mesh, sides, f) = (self.finest(), &self.sides, &self.load.cells);
        let bounded = BoundedProblem { mesh, sides, network, f, law };
        let (judgement, bounds) = among_threads(COST * y.len(), || {
            rayon::join(|| judge(network, law, &y, &self.load.load), || bounded.bounds(&y))
        });
        let outcome = Outcome::new(end, &judgement, None, &self.load.load, has_solution);
        self.outcomes.push(outcome);
        (self.y, self.judgement) = (Some(y), Some(judgement));
        Ok(bounds)
    }

    /// Notes the error of the finest mesh.
    fn note(&mut self, bounds: &Result<LocalBounds, NoBound>) {
        if let Ok(LocalBounds { bounds, .. }) = bounds {
            self.errors.push([self.nodes() as f64, bounds.error[1]]);
        }
    }

    /// True if the error has hardly fallen while the number of nodes has doubled, twice.
    pub(super) fn has_stalled(&self) -> bool {
        let Some(&[nodes, error]) = self.errors.last() else { return false };
        [0.5, 0.25].into_iter().all(|part| {
            let mut before = self.errors.iter().rev();
            before.find(|[few, _]| *few <= part * nodes).is_some_and(|[_, old]| error > FALL * old)
        })
    }

    /// Adds the next mesh; false if it would have too many nodes. Without bounds all cells are bisected.
    pub(super) fn refine(&mut self, bounds: Option<&LocalBounds>) -> Result<bool, ProblemError> {
        let marked = match bounds {
            Some(found) => self.marked(found),
            None => (0..self.finest().cells().len() as u32).collect(),
        };
        let Bisected { mesh, sides, parents, origins } =
            bisect(self.finest(), &self.sides, &marked)?;
        // Without marked cells there is nothing to gain.
        if mesh.points().len() > self.adaption.most_nodes || parents.is_empty() {
            return Ok(false);
        }
        let before = CellsBefore { origins: &origins, f: &self.load.cells };
        let (network, load) = among_threads(COST * mesh.points().len(), || {
            let load = || mesh_load_after(before, &mesh, &self.f);
            rayon::join(|| assemble_sides(&mesh, &sides), load)
        });
        let level = NestedNetwork { network, parents };
        self.y = self.y.take().map(|y| level.interpolate(&y));
        for &[parent, _] in &level.parents {
            self.component_of.push(self.component_of[parent as usize]);
        }
        self.load = load?;
        self.sides = sides;
        self.all.push(mesh);
        self.networks.push(level);
        Ok(true)
    }

    /// Cells to be bisected.
    fn marked(&self, LocalBounds { bounds, squares }: &LocalBounds) -> Vec<u32> {
        let left = 1.0 - self.adaption.goal.square_left(bounds);
        let fraction = (left / GAIN).clamp(LEAST_MARKED, MARKED);
        let y = self.y.as_deref().unwrap_or_default();
        match curve_shares(self.finest(), &self.sides, &self.load.cells.mean, y) {
            None => largest_parts(squares, fraction),
            Some(shares) => {
                let mut squares = squares.clone();
                shares.iter().for_each(|share| squares[share.cell as usize] += share.square);
                largest_parts(&squares, fraction)
            }
        }
    }

    /// Problem on the meshes, with the solution.
    pub(super) fn finished(
        self,
        end: AdaptedEnd,
        LocalBounds { bounds, squares }: LocalBounds,
    ) -> AdaptedRun {
        let law = self.adaption.law;
        let y = self.y.expect("a vector with bounds");
        let network = &self.networks[self.networks.len() - 1].network;
        let (mesh, sides, f) = (&self.all[self.all.len() - 1], &self.sides, &self.load.cells);
        let bounds = BoundedProblem { mesh, sides, network, f, law }.with_lower(bounds, &y);
        let is_curved = mesh.parts().iter().any(|part| part.curve.is_some());
        let nested = NestedMeshes { meshes: self.all, networks: self.networks };
        let levels = Triangulations::of(nested, self.f, self.load)
            .with_errors(squares.iter().map(|square| square.max(0.0).sqrt()).collect());
        AdaptedRun {
            problem: Problem::checked(levels, law, is_curved),
            y,
            judgement: self.judgement.expect("a vector with bounds"),
            bounds,
            outcomes: self.outcomes,
            end,
        }
    }
}
