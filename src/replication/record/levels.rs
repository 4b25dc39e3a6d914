//! Numbers of an answer on each level: rows of tables, curves of pictures, and `grids` in JSON.

use serde::{Deserialize, Serialize};
use signorini_mathematics::bounds::Bounds;
use signorini_mathematics::discrete::end::Outcome;
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::solvers::{Run, Solved};
use signorini_mathematics::statement::Statement;

/// Numbers on one level; of a true solution, which has none, those of the solution. What is no number is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LevelNumbers {
    /// Cells per side of a uniform grid; on a mesh, how often it is refined.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cells: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) refinement: Option<usize>,
    pub(crate) nodes: Option<usize>,
    pub(crate) iterations: usize,
    /// Sweeps of a saddle-point method.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) sweeps: Option<usize>,
    /// Name of the end, and the reason of the solver, whatever the verdict; none of a true solution.
    pub(crate) stop: String,
    pub(crate) own_stop: Option<Stop>,
    /// Last change of the multiplier and the greatest components of the gradient, as [`Outcome`] has them.
    pub(crate) delta_a: Option<f64>,
    pub(crate) gradient_signed: Option<f64>,
    pub(crate) gradient_abs: Option<f64>,
    /// Energy that answers, see [`Solved::energy_on`].
    pub(crate) energy: Option<f64>,
    /// Guaranteed bracket of the energy, bound of the error in the energy norm, and that over the solution.
    pub(crate) energy_lower: Option<f64>,
    pub(crate) energy_upper: Option<f64>,
    pub(crate) error_bound: Option<f64>,
    pub(crate) error_relative: Option<f64>,
    /// Least and greatest nodal value.
    pub(crate) v_least: Option<f64>,
    pub(crate) v_greatest: Option<f64>,
    /// Sum of the load vector.
    pub(crate) sum_load: Option<f64>,
    pub(crate) kkt: Residuals,
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
    pub(crate) fn of(outcome: &Outcome) -> Self {
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
    /// Numbers on all levels on which a run ended, coarsest first.
    pub(crate) fn all(statement: &Statement, solved: &Solved, run: &Run) -> Vec<Self> {
        let mut all = Vec::new();
        for (number, outcome) in run.ends.iter().enumerate() {
            let Outcome { cells, nodes, end, .. } = *outcome;
            let numbers = Self {
                cells,
                refinement: cells.is_none().then_some(run.first_level + number),
                nodes: Some(nodes),
                iterations: end.iterations,
                sweeps: statement.solver.is_nested().then(|| end.sweeps()),
                stop: outcome.name_of(statement.accuracy().is_some()).into(),
                own_stop: Some(end.stop),
                delta_a: end.delta_a,
                gradient_signed: outcome.gradient_signed,
                gradient_abs: outcome.gradient_abs,
                energy: Some(solved.energy_on(number)),
                v_least: Some(outcome.range[0]),
                v_greatest: Some(outcome.range[1]),
                sum_load: Some(outcome.sum_load),
                kkt: Residuals::of(outcome),
                ..Self::default()
            };
            all.push(numbers.with(solved.bounds_on(number)));
        }
        all
    }

    /// Numbers with these bounds.
    pub(crate) fn with(self, bounds: Option<&Bounds>) -> Self {
        let Some(bounds) = bounds else { return self };
        Self {
            energy_lower: Some(bounds.energy[0]),
            energy_upper: Some(bounds.energy[1]),
            error_bound: Some(bounds.error[1]),
            error_relative: Some(bounds.relative()),
            ..self
        }
    }

    /// True if the solver ended without a solution of the discrete problem.
    pub(crate) fn is_no_solution(&self) -> bool {
        ["no-solution", "not-solved", "diverged"].contains(&&*self.stop)
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
