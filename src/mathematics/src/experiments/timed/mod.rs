//! Runs of all solvers whose times are compared: what is prepared before a clock starts, what the clock surrounds, and
//! what the run has reached. The clock itself is the caller's.
//!
//! Load vectors, and for multigrid from grid to grid the workspace too, are made before. Saddle-point methods check the
//! optimality conditions after every eighth of the sweeps made so far; these checks are part of the run. Central is
//! [`TimedPlan::runs`].

mod goal;
mod refined;
mod scaling;
mod solved;
mod truth;

use super::known::KnownSolution;
use super::problems::CONTACT;
use super::rows::Row;
use crate::experiments::work::REACHED;
use crate::problem::exact::Exact;
use crate::solvers::Solver;
use std::sync::Arc;

/// Runs to time.
#[derive(Clone, Debug)]
pub struct TimedPlan {
    /// Solvers.
    pub solvers: Vec<Solver>,
    /// Cells per side of the finest grid: a power of two.
    pub finest: usize,
    /// Coarse grids and little data, to see that everything works.
    pub quick: bool,
    /// Numbers of threads with which multigrid runs from grid to grid.
    pub threads: Vec<usize>,
    /// The paper's problems: names, and f in the notation of scenes.
    pub problems: Vec<(String, String)>,
}

/// Facts about a run that was judged: a row of the record of times, but for the time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedFacts {
    /// Name of the table.
    pub table: &'static str,
    /// The row.
    pub row: Row,
}

/// A run, with all that is made before the clock starts.
pub struct TimedRun {
    /// Name in words of the measurement; runs of a solver on one grid to several goals share it.
    pub name: String,
    /// Name of the series: runs that differ in size alone, the smallest first.
    pub series: String,
    /// Expected time over that of the run before in the series; 0 for a run that is to be timed however long it takes.
    pub growth: f64,
    /// Series whose longest run this one need not exceed.
    pub rival: Option<&'static str>,
    /// Number of threads that the run can use; none for those of the program.
    pub threads: Option<usize>,
    execute: Box<dyn Fn() + Send + Sync>,
    judge: Box<dyn Fn() -> Result<Option<TimedFacts>, String> + Send + Sync>,
}

/// Runs that share what is prepared for them.
type Prepared = Result<Vec<TimedRun>, String>;

impl TimedRun {
    /// Takes one call whose result is judged, but not while the clock runs.
    fn new<T>(
        name: String,
        run: impl Fn() -> T + Send + Sync + 'static,
        judge: impl Fn(T) -> Result<Option<TimedFacts>, String> + Send + Sync + 'static,
    ) -> Self {
        let run = Arc::new(run);
        let same = Arc::clone(&run);
        Self {
            series: name.clone(),
            name,
            growth: 0.0,
            rival: None,
            threads: None,
            execute: Box::new(move || drop(run())),
            judge: Box::new(move || judge(same())),
        }
    }

    /// Runs once: what a clock surrounds.
    pub fn execute(&self) {
        (self.execute)();
    }

    /// Runs once, and judges the result; none if it is not worth a time.
    ///
    /// # Errors
    /// A sentence if the solver fails.
    pub fn judged(&self) -> Result<Option<TimedFacts>, String> {
        (self.judge)()
    }
}

impl TimedPlan {
    /// Problem on which multigrid runs from grid to grid.
    pub const SCALED: Exact = Exact::FreeCorner;
    /// Error over that of the discretisation up to which a run has reached it.
    pub const REACHED: f64 = REACHED;
    /// Goal, in words, of a run under the stopping rule of the published tables.
    pub const PUBLISHED: &str = "published stop";

    /// Runs in their order, those that share what is prepared together; they are prepared when their turn comes.
    ///
    /// 1. Multigrid from grid to grid, with each number of threads.
    /// 2. Every solver on grids, on every problem and grid, to each of its goals.
    /// 3. The spectral solver, on every problem.
    /// 4. Adaptive and uniform refinement of the L-shape.
    ///
    /// # Errors
    /// A sentence if the spectral solver cannot solve one of the paper's problems; of a list, if a grid cannot be used.
    pub fn runs(&self) -> Result<impl Iterator<Item = Prepared>, String> {
        let paper = self.problems.iter().map(|(name, f)| (&name[..], &f[..]));
        let mut known = Vec::new();
        for (name, f) in paper.chain(CONTACT) {
            known.push(KnownSolution::spectral(name, f)?);
        }
        let truths: Vec<_> =
            known.iter().map(|known| (known.name().to_owned(), known.f())).collect();
        let has_multigrid = self.solvers.contains(&Solver::Multigrid);
        let has_spectral = self.solvers.contains(&Solver::Spectral);
        let scaling = has_multigrid.then(|| scaling::runs(self));
        let solved = solved::runs(self, known);
        let truths = has_spectral.then(|| truths.into_iter().map(truth::run));
        let refined = has_multigrid.then(|| refined::runs(self.finest));
        let on_square = scaling.into_iter().flatten().chain(solved);
        Ok(on_square.chain(truths.into_iter().flatten()).chain(refined.into_iter().flatten()))
    }

    /// Array that exceeds the caches, by which the bandwidth of the memory is measured.
    pub fn stream(&self) -> Vec<f64> {
        vec![0.0; if self.quick { 1 << 20 } else { 1 << 25 }]
    }
}
