//! Numbers of an answer on each level: rows of tables, curves of pictures, `grids` in JSON; those of the last level are
//! numbers of the answer.

use serde::{Deserialize, Serialize};
use signorini_mathematics::bounds::Bounds;
use signorini_mathematics::discrete::end::{Outcome, Stop};
use signorini_mathematics::solvers::Solved;
use signorini_mathematics::statement::Statement;

/// Name of the end of the spectral solver.
const CONVERGED: &str = "converged";

/// Numbers on one level; of a true solution, which has none, those of the solution. What a solver does not have, or is
/// no number, is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct LevelNumbers {
    /// Cells per side of a uniform grid; on a mesh, how often it is refined.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cells: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) refinement: Option<usize>,
    pub(crate) nodes: Option<usize>,
    pub(crate) iterations: Option<usize>,
    /// Sweeps of a saddle-point method.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sweeps: Option<usize>,
    /// Name of the end, and the reason of the solver, whatever the verdict.
    pub(crate) stop: Option<String>,
    pub(crate) own_stop: Option<Stop>,
    /// Last change of the multiplier of a saddle-point method and the greatest components of the gradient, as
    /// [`Outcome`] has them.
    pub(crate) delta_a: Option<f64>,
    pub(crate) gradient_signed: Option<f64>,
    pub(crate) gradient_abs: Option<f64>,
    /// Energy: that of v or, where the accuracy of the energy was asked for, the number of the bracket nearest to it.
    pub(crate) energy: Option<f64>,
    /// Guaranteed bracket of the energy, bound of the error in the energy norm, and that over the solution, which is
    /// none where it is not below the solution.
    pub(crate) energy_lower: Option<f64>,
    pub(crate) energy_upper: Option<f64>,
    pub(crate) error_bound: Option<f64>,
    pub(crate) error_relative: Option<f64>,
    /// Least and greatest nodal value.
    pub(crate) v_least: Option<f64>,
    pub(crate) v_greatest: Option<f64>,
    /// Sum of the load vector.
    pub(crate) sum_load: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) kkt: Option<Residuals>,
}

/// Residuals of the conditions of the solution.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Residuals {
    pub(crate) stationarity: Option<f64>,
    pub(crate) min_y: Option<f64>,
    pub(crate) min_lambda: Option<f64>,
    /// Sum of v r over the boundary, with the law's term: zero at the solution.
    complementarity: Option<f64>,
    /// Largest natural residual of the law, for the paper's law `|min(y, A y - F)|`.
    pub(crate) max_min: Option<f64>,
    pub(crate) natural: Option<f64>,
    pub(crate) relative: Option<f64>,
}

impl Residuals {
    fn of(outcome: &Outcome) -> Self {
        let (kkt, work) = (outcome.kkt, outcome.work);
        Self {
            stationarity: Some(kkt.stationarity),
            min_y: kkt.min_y,
            min_lambda: kkt.min_lambda,
            complementarity: Some(work),
            max_min: Some(kkt.complementarity),
            natural: Some(kkt.natural),
            relative: Some(kkt.relative),
        }
    }
}

impl LevelNumbers {
    /// Numbers on all levels on which the solver ended, coarsest first; of a true solution one, without a level.
    pub(crate) fn all(statement: &Statement, solved: &Solved) -> Vec<Self> {
        let (mut all, first_level) = (Vec::new(), solved.run().map_or(0, |run| run.first_level));
        if let Some(found) = solved.truth() {
            let numbers = Self {
                iterations: Some(found.steps),
                stop: Some(CONVERGED.into()),
                energy: Some(found.energy),
                ..Self::default()
            };
            all.push(numbers.with(solved.last_bounds()));
        }
        for (number, outcome) in solved.ends().iter().enumerate() {
            let Outcome { cells, nodes, end, .. } = *outcome;
            let numbers = Self {
                cells,
                refinement: cells.is_none().then_some(first_level + number),
                nodes: Some(nodes),
                iterations: Some(end.iterations),
                sweeps: statement.solver.is_nested().then(|| end.sweeps()),
                stop: Some(outcome.name_of(statement.accuracy().is_some()).into()),
                own_stop: Some(end.stop),
                delta_a: end.delta_a,
                gradient_signed: outcome.gradient_signed,
                gradient_abs: outcome.gradient_abs,
                energy: Some(solved.energy_on(number)),
                v_least: Some(outcome.range[0]),
                v_greatest: Some(outcome.range[1]),
                sum_load: Some(outcome.sum_load),
                kkt: Some(Residuals::of(outcome)),
                ..Self::default()
            };
            all.push(numbers.with(solved.bounds_on(number)));
        }
        all
    }

    /// Numbers with these bounds, or without.
    pub(crate) fn with(self, bounds: Option<&Bounds>) -> Self {
        Self {
            energy_lower: bounds.map(|bounds| bounds.energy[0]),
            energy_upper: bounds.map(|bounds| bounds.energy[1]),
            error_bound: bounds.map(|bounds| bounds.error[1]),
            error_relative: bounds.map(Bounds::relative).filter(|relative| relative.is_finite()),
            ..self
        }
    }

    /// Number of iterations; none of what was not solved.
    pub(crate) fn count(&self) -> usize {
        self.iterations.unwrap_or_default()
    }

    /// Name of the end; empty of what was not solved.
    pub(crate) fn end(&self) -> &str {
        self.stop.as_deref().unwrap_or_default()
    }

    /// True if the solver ended without a solution of the discrete problem.
    pub(crate) fn is_no_solution(&self) -> bool {
        ["no-solution", "not-solved", "diverged"].contains(&self.end())
    }

    /// Name in a table: `1/64`, or on a mesh `833 nodes`; empty without a level.
    pub(crate) fn label(&self) -> String {
        match (self.cells, self.nodes) {
            (Some(cells), _) => format!("1/{cells}"),
            (None, Some(nodes)) => format!("{nodes} nodes"),
            (None, None) => String::new(),
        }
    }
}
