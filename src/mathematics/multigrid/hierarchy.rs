//! The hierarchy of grids: what it holds, what goes in and comes out.

use std::marker::PhantomData;

use super::coarsest::Coarsest;
use super::input::{InputError, check_length, check_start};
use super::level::Level;
use super::load;
use super::pass;
use super::pass::Problem::Obstacle;
use super::pass::Stage::{Correct, Interpolate, Relax, Restrict};
use super::rows;
use super::rows::Colour::{Black, Red};
use super::stencil::{coupling, visit};
use super::stopping::{self, Hierarchy};
use super::transfer::Weighting;
use super::{Goal, MultigridParams, Outcome};
use crate::discrete::threads::among_threads;

/// What differs between the square and the cube, beside the stencil and the transfers.
pub trait Geometry: Weighting + Sized {
    /// What `n` must be.
    const CELLS: &str;
    /// Over-relaxation inside, on the colour that the transfers beside it do not rely on.
    const RELAXATION: f64;
    /// Over-relaxation of the half-sweeps that begin and end a visit to a correction problem.
    const COARSE_RELAXATION: f64;
    /// Factor of the corrections that reach an obstacle problem.
    const OVERCORRECTION: f64;
    /// Grids see two cycles per cycle of the grid above from this many grids below the finest.
    const TWICE_BELOW: usize;
    /// Whether the second of them is like the first (W-cycle) or visits all coarser grids once (F-cycle).
    const W_CYCLE: bool;

    /// Cells per side of the coarsest of the grids that lead to `n` cells; none if `n` cannot be used.
    fn coarsest(n: usize) -> Option<usize>;

    /// Sets `1 / (2 d + spring)` on all `levels`, coarsest first, for a contact set of a finer grid with `n`
    /// cells per side; returns the work in visits of unknowns.
    fn set_springs(n: usize, in_contact: &[bool], levels: &mut [Level]) -> f64;

    /// `allocate`, not generic: compiled and optimised with this package, not with that of the caller.
    fn allocated(n: usize) -> Result<Multigrid<Self>, InputError>;

    /// `run`, not generic for the same reason.
    fn solved(
        grids: &mut Multigrid<Self>,
        load: &[f64],
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<Outcome, InputError>;
}

/// Preallocated grids for problems with `n` cells per side.
pub struct Multigrid<G: Geometry> {
    /// Coarsest first.
    pub(super) levels: Vec<Level>,
    pub(super) coarsest: Coarsest,
    /// The grid and the contact set that the springs of the coarser grids stand for.
    pub(super) contact: (usize, Vec<bool>),
    /// The load is divided by this power of two, so that no residual over- or underflows.
    scale: f64,
    /// Norm of the load on the finest grid but one, before a residual took its place.
    coarse_load: f64,
    work_units: f64,
    /// Bytes moved, per unknown of the finest grid.
    traffic: f64,
    geometry: PhantomData<G>,
}

impl<G: Geometry> Multigrid<G> {
    /// Allocates the grids, 21.3 bytes per unknown on the square and 18.3 on the cube, and the rest of the
    /// last cache line of each row.
    ///
    /// # Errors
    /// If `n` is not a power of two (at least 2) times 1 or 3, on the square also 5 or 7.
    pub fn new(n: usize) -> Result<Self, InputError> {
        G::allocated(n)
    }

    pub(super) fn allocate(n: usize) -> Result<Self, InputError> {
        let coarsest = G::coarsest(n).ok_or(InputError::GridSize(n, G::CELLS))?;
        let cells = std::iter::successors(Some(coarsest), |cells| Some(2 * cells));
        Ok(Self {
            levels: cells.take_while(|&cells| cells <= n).map(Level::new::<G>).collect(),
            coarsest: Coarsest::new::<G>(coarsest),
            contact: (0, Vec::new()),
            scale: 1.0,
            coarse_load: 0.0,
            work_units: 0.0,
            traffic: 0.0,
            geometry: PhantomData,
        })
    }

    /// Memory that one thread needs, in bytes; each further one takes a few rows, or a slab on the cube.
    pub fn bytes(&self) -> usize {
        let levels: usize = self.levels.iter().map(Level::bytes).sum();
        levels + self.contact.1.len() + self.coarsest.bytes()
    }

    /// Bytes per unknown that the passes of the last solve and [`Multigrid::write_solution`] move together, if
    /// each reads and writes every row once: over the bandwidth of the memory, the time that nothing can save on
    /// grids too large for the caches.
    pub fn traffic(&self) -> f64 {
        self.traffic
    }

    /// Solves for one load; `start` replaces the nested iteration.
    ///
    /// # Errors
    /// If a length is wrong, a number is not finite, or the load does not have a negative sum.
    pub fn solve(
        &mut self,
        load: &[f64],
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<Outcome, InputError> {
        among_threads(self.finest().nodes, || G::solved(self, load, start, params))
    }

    pub(super) fn run(
        &mut self,
        load: &[f64],
        start: Option<&[f64]>,
        params: &MultigridParams,
    ) -> Result<Outcome, InputError> {
        // The input is read in one order and written in the other, in the end the solution.
        (self.work_units, self.traffic) = (0.0, 32.0);
        self.set_load(load)?;
        let finest = self.levels.len() - 1;
        if finest == 0 {
            self.solve_coarsest();
            return Ok(stopping::direct(self, params.goal));
        }
        if params.goal == Goal::DiscretisationError {
            self.coarse_load = self.coarse_norm();
        }
        let kkt = match start {
            Some(start) => {
                self.set_start(start)?;
                self.pass(finest, Obstacle, &[Relax(Red, 1.0), Relax(Black, 1.0), Restrict])
            }
            None => {
                self.nested_iteration();
                // As in the nested iteration: one sweep more saves a cycle.
                self.pass(finest, Obstacle, &Self::smooth_twice(Interpolate))
            }
        };
        Ok(stopping::iterate(self, kkt, params))
    }

    /// Copies the solution in the order of the load.
    ///
    /// # Panics
    /// If the slice has another length.
    pub fn write_solution(&self, solution: &mut [f64]) {
        let finest = self.finest();
        rows::merge(finest.n, &finest.values, self.scale, solution);
    }

    fn set_load(&mut self, load: &[f64]) -> Result<(), InputError> {
        let finest = self.levels.len() - 1;
        check_length(self.levels[finest].nodes, load)?;
        let (coarser, top) = self.levels.split_at_mut(finest);
        let top = &mut top[0];
        let extent = match coarser.last_mut() {
            Some(coarse) => load::take_and_weigh::<G>(load, top, coarse),
            None => load::take::<G>(load, top),
        };
        extent.check()?;
        self.scale = extent.scale();
        rows::scale(&mut top.load, 1.0 / self.scale);
        top.load_scale = extent.largest / self.scale;
        for l in (1..=finest).rev() {
            let (coarse, fine) = self.levels.split_at_mut(l);
            let (fine, coarse) = (&fine[0], &mut coarse[l - 1]);
            let (nodes, with_the_finer) = (fine.nodes as f64, l == finest && self.scale == 1.0);
            if !with_the_finer {
                load::weigh::<G>(fine, coarse);
            }
            self.count(pass::RESTRICT_LOAD * nodes);
            let read = if with_the_finer { 0.0 } else { 8.0 };
            self.move_bytes((read + 8.0 / f64::from(1 << G::AXES)) * nodes);
        }
        Ok(())
    }

    fn set_start(&mut self, start: &[f64]) -> Result<(), InputError> {
        let top = self.levels.last_mut().expect("at least one grid");
        check_start(top.nodes, start, self.scale)?;
        rows::split(top.n, start, &mut top.values);
        rows::scale(&mut top.values, 1.0 / self.scale);
        Ok(())
    }

    /// Norm of the load on the finest grid but one.
    fn coarse_norm(&mut self) -> f64 {
        let coarse = &self.levels[self.levels.len() - 2];
        let (norm, nodes) = (load::norm(coarse), coarse.nodes as f64);
        self.count(nodes / visit::<G>());
        self.move_bytes(8.0 * nodes);
        norm
    }

    pub(super) fn count(&mut self, visits: f64) {
        self.work_units += visits / self.finest().nodes as f64;
    }

    pub(super) fn move_bytes(&mut self, bytes: f64) {
        self.traffic += bytes / self.finest().nodes as f64;
    }

    fn finest(&self) -> &Level {
        self.levels.last().expect("at least one grid")
    }
}

/// Minimises `1/2 y'Ay - F'y` over `y >= 0` on the boundary, `A` the five- or seven-point stiffness matrix of the
/// natural boundary condition on a grid with `n` cells per side.
///
/// `load` and the solution hold `(n + 1)^2` or `(n + 1)^3` numbers, x fastest. `start` replaces the nested iteration.
///
/// # Errors
/// If `n` is not [as it must be](Geometry::CELLS), a length is wrong, a number is not finite, or the sum of the load
/// is not negative: then the energy is not bounded below, or has no unique minimiser.
pub fn solve<G: Geometry>(
    n: usize,
    load: &[f64],
    start: Option<&[f64]>,
    params: &MultigridParams,
) -> Result<(Vec<f64>, Outcome), InputError> {
    let mut workspace = Multigrid::<G>::new(n)?;
    let mut solution = vec![0.0; load.len()];
    let outcome = among_threads(load.len(), || {
        let outcome = workspace.solve(load, start, params)?;
        workspace.write_solution(&mut solution);
        Ok(outcome)
    })?;
    Ok((solution, outcome))
}

impl<G: Geometry> Hierarchy for Multigrid<G> {
    fn cycle(&mut self, last: bool, part: f64) -> f64 {
        let (finest, correct) = (self.levels.len() - 1, Correct(part * G::OVERCORRECTION));
        if last {
            // Often the only cycle there is: the near-constant modes must not wait for another.
            let smooth = [correct, Relax(Red, 1.0), Relax(Black, 1.0), Restrict];
            self.cycle(finest, &smooth, G::TWICE_BELOW.min(2))
        } else {
            self.cycle(finest, &Self::smooth_twice(correct), G::TWICE_BELOW)
        }
    }

    fn smooth_residual(&mut self) -> f64 {
        self.coarse_norm() / self.coarse_load
    }

    fn check(&mut self) -> f64 {
        self.work_units += 1.0;
        self.traffic += 16.0;
        pass::natural_residual::<G>(self.finest())
    }

    fn rounding(&mut self) -> f64 {
        self.work_units += 0.25;
        self.traffic += 8.0;
        let finest = self.finest();
        f64::EPSILON * finest.max_abs() * coupling::<G>(finest.n)
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
