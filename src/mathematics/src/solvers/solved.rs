//! Solution of a problem, whatever solved it and on whatever domain.

use super::run::{FoundSolution, Run};
use crate::bounds::{Accuracy, Bounds, NoBound};
use crate::discrete::contact::ContactArc;
use crate::discrete::end::Outcome;
use crate::discrete::kkt::StateCounts;
use crate::discrete::norms::Errors;
use crate::levels::{OnPart, Problem, Reserve};
use crate::mesh::{PartShares, PointValue};
use crate::saddle::Pair;
use crate::spectral::TrueSolution;
use std::sync::OnceLock;

/// Reason for which grids or meshes become no finer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReachEnd {
    /// The bound is small enough.
    Goal,
    /// No finer grid or mesh is allowed.
    Finest {
        /// Cells per side of the grid that the accuracy takes, about; none for meshes.
        needed: Option<f64>,
        /// Bound on the finest grid that is allowed, about; for meshes, on the last one.
        best: f64,
    },
    /// No more nodes were asked for.
    MostNodes {
        /// Bound on the last mesh.
        best: f64,
    },
    /// Whoever watches has broken off.
    Interrupted {
        /// Bound on the last grid or mesh.
        best: f64,
    },
    /// Rounding errors: the bound no longer falls.
    Rounding {
        /// Least bound so far.
        least: f64,
    },
    /// The solver found no solution.
    NoSolution,
}

impl ReachEnd {
    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Goal => "goal",
            Self::Finest { .. } => "memory",
            Self::MostNodes { .. } => "most nodes",
            Self::Interrupted { .. } => "interrupted",
            Self::Rounding { .. } => "no longer falls",
            Self::NoSolution => "no solution",
        }
    }

    /// Reason, in words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Goal => "the error is as small as asked",
            Self::Finest { .. } => "a finer mesh takes more memory than is left",
            Self::MostNodes { .. } => "a finer mesh has more nodes than was asked for",
            Self::Interrupted { .. } => "interrupted",
            Self::Rounding { .. } => "the bound of the error no longer falls",
            Self::NoSolution => "there is no solution",
        }
    }
}

/// Way to an accuracy.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// Accuracy that was asked for.
    pub accuracy: Accuracy,
    /// Reason for which there is no finer grid or mesh.
    pub end: ReachEnd,
    /// Number of grids or meshes on which a solution was sought, with those that are too coarse for one.
    pub tried: usize,
    /// Cells that were marked for each bisection of adapted meshes, from which [`Problem::on_bisected`] makes them
    /// anew, empty where all cells were divided into four; none on the square.
    ///
    /// [`Problem::on_bisected`]: crate::levels::Problem::on_bisected
    pub marks: Option<Vec<Vec<u32>>>,
}

impl Reached {
    /// Kind of the meshes, in answers: `uniform` if all cells were divided into four each time.
    pub fn kind(&self) -> &'static str {
        let is_uniform = |marks: &Vec<_>| !marks.is_empty() && marks.iter().all(Vec::is_empty);
        if self.marks.as_ref().is_some_and(is_uniform) { "uniform" } else { "adapted" }
    }
}

/// Solution of a problem.
pub struct Solved {
    /// Problem, on the levels on which it was solved.
    pub problem: Problem,
    /// Solution as the solver found it.
    found: FoundSolution,
    /// Guaranteed bounds on the last levels, coarsest first; one by one for an accuracy, else for the finest alone,
    /// once they are needed.
    bounds: OnceLock<Vec<Result<Bounds, NoBound>>>,
    /// Way to an accuracy; none if none was asked for.
    pub reached: Option<Reached>,
}

impl Solved {
    /// Solution of a problem on its levels.
    pub(crate) fn new(problem: Problem, found: FoundSolution) -> Self {
        Self { problem, found, bounds: OnceLock::new(), reached: None }
    }

    /// Solution with an accuracy, and the bounds on the last levels.
    pub(super) fn with_bounds(
        problem: Problem,
        run: Run,
        bounds: Vec<Result<Bounds, NoBound>>,
        reached: Reached,
    ) -> Self {
        Self {
            problem,
            found: FoundSolution::Vector(run),
            bounds: bounds.into(),
            reached: Some(reached),
        }
    }

    /// Way to an accuracy on meshes, if that is how the solution was found.
    pub fn way(&self) -> Option<&Reached> {
        self.reached.as_ref().filter(|reached| reached.marks.is_some())
    }

    /// Run of a solver on levels; none of a true solution.
    pub fn run(&self) -> Option<&Run> {
        match &self.found {
            FoundSolution::Vector(run) => Some(run),
            FoundSolution::Truth(_) => None,
        }
    }

    /// True solution; none if it was sought on levels.
    pub fn truth(&self) -> Option<&TrueSolution> {
        match &self.found {
            FoundSolution::Vector(_) => None,
            FoundSolution::Truth(found) => Some(found),
        }
    }

    /// End on each level on which the solver ended, coarsest first; none of a true solution.
    pub fn ends(&self) -> &[Outcome] {
        self.run().map_or(&[], |run| &run.ends)
    }

    /// Bounds on the last levels, the finest last: on all for an accuracy; else on the finest alone; of a true solution
    /// its own. They are guaranteed but for what [`Solved::reserves`] lists.
    pub fn bounds(&self) -> &[Result<Bounds, NoBound>] {
        self.bounds.get_or_init(|| {
            let bounds = match &self.found {
                FoundSolution::Vector(run) => self.problem.bounds(&run.y),
                FoundSolution::Truth(found) => found.bounds(),
            };
            vec![bounds]
        })
    }

    /// Approximations that the bounds leave out.
    pub fn reserves(&self) -> Vec<Reserve> {
        match &self.found {
            FoundSolution::Vector(_) => self.problem.reserves(),
            FoundSolution::Truth(_) => Vec::new(),
        }
    }

    /// Bounds on the finest level; none where there are none.
    pub fn last_bounds(&self) -> Option<&Bounds> {
        self.bounds().last()?.as_ref().ok()
    }

    /// Reason for which there are no bounds on the finest level.
    pub fn no_bound(&self) -> Option<&NoBound> {
        self.bounds().last()?.as_ref().err()
    }

    /// Bounds where the solver ended as the `end` of this number says; none where there are none.
    pub fn bounds_on(&self, end: usize) -> Option<&Bounds> {
        let from_last = self.ends().len() - end;
        self.bounds().get(self.bounds().len().checked_sub(from_last)?)?.as_ref().ok()
    }

    /// Energy that answers where the solver ended as the `end` of this number says: that of v or, with the accuracy of
    /// the energy that was asked for, the number of the guaranteed bracket that is nearest to it.
    pub fn energy_on(&self, end: usize) -> f64 {
        let of_v = self.ends()[end].energy;
        let asked = self.reached.as_ref().map(|reached| reached.accuracy);
        match (asked, self.bounds_on(end)) {
            (Some(Accuracy::Energy(_)), Some(bounds)) => bounds.nearest_energy(of_v),
            _ => of_v,
        }
    }

    /// Energy that answers: of the true solution, or on the finest level, as [`Solved::energy_on`] has it.
    pub fn energy(&self) -> f64 {
        match &self.found {
            FoundSolution::Vector(run) => self.energy_on(run.ends.len() - 1),
            FoundSolution::Truth(found) => found.energy,
        }
    }

    /// Arcs in contact on the boundary of a domain in the plane, with ends estimated within the cell unless the
    /// solution is the true one; none in space. A force that is a sum of rounding errors is zero.
    pub fn contact(&self) -> Option<Vec<ContactArc>> {
        let mut arcs = match &self.found {
            FoundSolution::Vector(Run { y, judgement, .. }) => self.problem.arcs(y, judgement)?,
            FoundSolution::Truth(found) => found.contact.clone(),
        };
        let facts = self.problem.levels().facts();
        arcs.iter_mut().for_each(|arc| arc.force = facts.without_rounding(arc.force));
        Some(arcs)
    }

    /// Length of the boundary in contact, that of the arcs of [`Solved::contact`]; in space the area of the nodes in
    /// contact.
    pub fn contact_length(&self) -> f64 {
        match (self.contact(), self.run()) {
            (None, Some(run)) => run.judgement.area_in_contact(),
            (arcs, _) => {
                arcs.iter().flatten().map(|arc| arc.length).fold(0.0, |sum, length| sum + length)
            }
        }
    }

    /// Distance within which the length in contact of a true solution lies from [`Solved::contact_length`], as its ends
    /// estimate it; none of another.
    pub fn contact_length_error(&self) -> Option<f64> {
        let errors = self.truth()?.contact.iter().flat_map(|arc| arc.error.unwrap_or_default());
        Some(errors.fold(0.0, |sum, error| sum + error))
    }

    /// Total contact force; under another law than the paper's the flux through all of the boundary. A sum of rounding
    /// errors is zero.
    pub fn force(&self) -> f64 {
        let force = match &self.found {
            FoundSolution::Vector(run) => run.judgement.force(),
            FoundSolution::Truth(found) => found.force,
        };
        self.problem.levels().facts().without_rounding(force)
    }

    /// Integral of the reaction c v; none without one.
    pub fn reacted(&self) -> Option<f64> {
        self.problem.networks()?.last()?.network.reacted(&self.run()?.y)
    }

    /// Forces on each part of the boundary of a mesh, of a vector with the states of its nodes; none on grids.
    pub fn on_parts(&self) -> Vec<OnPart> {
        let found = match &self.found {
            FoundSolution::Vector(run) => return self.problem.on_parts(&run.y, &run.judgement),
            FoundSolution::Truth(found) => found,
        };
        let (levels, mut parts) = (self.problem.levels(), Vec::new());
        for PartShares { name, law, in_words, .. } in levels.mesh(0).shares() {
            if let Some(&force) = found.forces.get(&name) {
                let force = levels.facts().without_rounding(force);
                let states = StateCounts::default();
                parts.push(OnPart { name, law, in_words, force, states });
            }
        }
        parts
    }

    /// Integral of f: of a true solution over the domain, else over the finest level. A sum of rounding errors is zero.
    pub fn integral(&self) -> f64 {
        let facts = self.problem.levels().facts();
        facts.without_rounding(self.truth().map_or(facts.integral, |found| found.integral))
    }

    /// Errors of v on the finest level; none if the solution is not known.
    pub fn errors(&self) -> Option<Errors> {
        let (run, problem) = (self.run()?, &self.problem);
        let is_known = problem.is_signorini();
        problem.errors(&run.y).filter(|_| is_known)
    }

    /// Solution on the finest level, as [`Run::pair`] has it.
    pub fn pair(&self) -> Pair {
        match &self.found {
            FoundSolution::Vector(run) => run.pair(),
            FoundSolution::Truth(found) => found.at_nodes(&self.problem),
        }
    }

    /// v and its gradient at points, as [`Problem::values_at`] has them; those of a true solution itself, if it is one.
    pub fn values_at(&self, points: &[Vec<f64>]) -> Vec<PointValue> {
        match &self.found {
            FoundSolution::Vector(run) => self.problem.values_at(&run.y, points),
            FoundSolution::Truth(found) => {
                points.iter().map(|point| PointValue::new(point, found.at(point))).collect()
            }
        }
    }
}

impl TrueSolution {
    /// Bounds that follow from those of the energy, or the reason for which there are none.
    pub(crate) fn bounds(&self) -> Result<Bounds, NoBound> {
        let Self { bracket, gradient, .. } = *self;
        let bounds = bracket.map(|ends| Bounds { gradient, ..Bounds::of_energy(ends) });
        bounds.map_err(|step| NoBound::Unproved { step })
    }
}
