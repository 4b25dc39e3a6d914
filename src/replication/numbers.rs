//! Numbers of a solution: a row of the table of a study.

use crate::replication::columns::{END, STOP};
use crate::replication::record::Record;
use crate::replication::record::advice::Warning;
use crate::replication::record::details::{answering_energy, details};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use signorini_mathematics::bounds::Bounds;
use signorini_mathematics::levels::Reserve;
use signorini_mathematics::solvers::{Run, Solved, Solver};
use signorini_mathematics::statement::Statement;

/// Numbers of a solution, or the reason for which there is none; what a solver does not have is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Numbers {
    /// Energy: that of v or, where the accuracy of the energy was asked for, the number of the bracket nearest to it.
    energy: Option<f64>,
    /// Guaranteed bracket of the energy.
    energy_lower: Option<f64>,
    energy_upper: Option<f64>,
    /// Guaranteed bound of the error in the energy norm, over the solution; none where it is not below the solution.
    error_relative: Option<f64>,
    /// Errors of v in L2, in the H1 seminorm and at a node; none where the solution has no formula.
    error_l2: Option<f64>,
    error_h1: Option<f64>,
    error_max: Option<f64>,
    /// Least and greatest nodal value.
    v_least: Option<f64>,
    v_greatest: Option<f64>,
    /// Length of the boundary in contact, with ends within the cell; in space the area of the nodes in contact.
    contact_length: Option<f64>,
    /// Distance within which the length of a true solution lies, as estimated.
    contact_length_error: Option<f64>,
    /// Contact force: the flux through the boundary where the law holds.
    force: Option<f64>,
    nodes: Option<usize>,
    iterations: Option<usize>,
    /// Cost of multigrid, in sweeps of the finest level.
    work_units: Option<f64>,
    /// Iterations on each of the nested grids or meshes of a saddle-point method, coarsest first.
    iterations_per_grid: Option<Vec<usize>>,
    /// Name of the end of the solver.
    stop: Option<String>,
    /// KKT residual over the largest load; none of a true solution.
    kkt_relative: Option<f64>,
    /// Solver that found it.
    solver: String,
    /// Approximations that the bounds leave out; none if there are none.
    reserve: Option<String>,
    /// Warnings that `solve` gives, a sentence each.
    warnings: Vec<String>,
    /// Remedy for them, or for the failure.
    remedy: Option<String>,
    /// Reason for which there is no solution, or not the accuracy that was asked for; other numbers are then those
    /// where the solver ended.
    reason: Option<String>,
    /// Parts of an answer that only JSON shows.
    #[serde(flatten)]
    details: Map<String, Value>,
}

impl Numbers {
    /// Numbers of the answer to a statement; of what is no solution without bounds.
    pub(crate) fn of(statement: &Statement, solved: &Solved, record: &Record) -> Self {
        let bounds = solved.bounds().last().and_then(|bounds| bounds.as_ref().ok());
        let bounds = bounds.filter(|_| record.failure.is_none());
        let energy = answering_energy(statement, solved);
        let relative = bounds.map(Bounds::relative).filter(|relative| relative.is_finite());
        let (run, errors) = (solved.run(), solved.errors());
        let (last, truth) = (run.map(Run::last), solved.truth());
        let is_bounded = statement.accuracy().is_some();
        let stop = last.map_or(CONVERGED, |last| last.name_of(is_bounded));
        let is_multigrid = statement.solver == Solver::Multigrid;
        let counts = solved.ends().iter().map(|end| end.end.iterations);
        let reserves = solved.reserves().into_iter().map(Reserve::name).collect::<Vec<_>>();
        Self {
            energy: Some(energy).filter(|energy| energy.is_finite()),
            energy_lower: bounds.map(|bounds| bounds.energy[0]),
            energy_upper: bounds.map(|bounds| bounds.energy[1]),
            error_relative: relative,
            error_l2: errors.map(|errors| errors.l2),
            error_h1: errors.map(|errors| errors.h1),
            error_max: errors.map(|errors| errors.max),
            v_least: last.map(|last| last.range[0]),
            v_greatest: last.map(|last| last.range[1]),
            contact_length: Some(solved.contact_length()),
            contact_length_error: solved.contact_length_error(),
            force: Some(solved.force()),
            nodes: last.map(|last| last.nodes),
            iterations: last.map(|last| last.end.iterations).or(truth.map(|found| found.steps)),
            work_units: last.filter(|_| is_multigrid).map(|last| last.end.work_units),
            iterations_per_grid: statement.solver.is_nested().then(|| counts.collect()),
            stop: Some(stop.into()),
            kkt_relative: last.map(|last| last.kkt.relative),
            solver: run.map_or(statement.solver, |run| run.solver).to_string(),
            reserve: (bounds.is_some() && !reserves.is_empty()).then(|| reserves.join(" ")),
            warnings: record.facts(),
            remedy: record.remedy(),
            reason: record.refusal().map(Warning::sentence),
            details: details(statement, solved, record),
        }
    }

    /// Row of a statement without a solution, for this reason.
    pub(crate) fn without(statement: &Statement, reason: String) -> Self {
        let details = Map::from_iter([("failure".to_owned(), reason.clone().into())]);
        let solver = statement.solver.to_string();
        Self { solver, reason: Some(reason), details, ..Self::default() }
    }

    /// Warnings, a sentence each.
    pub(crate) fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Remedy for the warnings.
    pub(crate) fn remedy(&self) -> Option<&str> {
        self.remedy.as_deref()
    }

    /// True for what is no solution, with the numbers where the solver ended.
    pub(crate) fn is_no_solution(&self) -> bool {
        self.reason.is_some() && self.nodes.is_some()
    }

    /// Reason for which there is no solution.
    pub(crate) fn reason(&self) -> Option<&str> {
        self.reason.as_deref()
    }

    /// True if the energy is that of the true solution, or the number of its bracket that is nearest to that of v.
    pub(crate) fn has_true_energy(&self) -> bool {
        self.solver == Solver::Spectral.to_string()
            || self.details.contains_key("energy_of_linear_v")
    }

    /// Number in a column; none if the column has texts, or the solution has no such number.
    pub(crate) fn number(&self, column: &str) -> Option<f64> {
        self.values(&[column])[0].1.as_f64()
    }

    /// Parts of an answer that only JSON shows.
    pub(crate) fn details(&self) -> &Map<String, Value> {
        &self.details
    }

    /// All columns, and all details.
    pub(crate) fn json(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(all)) => all,
            other => unreachable!("numbers are plain data: {other:?}"),
        }
    }

    /// Values in some columns, null where there is none.
    pub(crate) fn values<'a>(&self, columns: &[&'a str]) -> Vec<(&'a str, Value)> {
        let mut all = self.json();
        let value = |&column: &&'a str| {
            let field = if column == END { STOP } else { column };
            (column, all.remove(field).unwrap_or_default())
        };
        columns.iter().map(value).collect()
    }

    /// Values in some columns, with all digits; empty where there is none.
    pub(crate) fn cells(&self, columns: &[&str]) -> Vec<String> {
        self.values(columns).iter().map(|(_, value)| cell(value)).collect()
    }
}

/// Returns a value of a row as a table has it.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Array(values) if values.iter().all(Value::is_number) => {
            values.iter().map(Value::to_string).collect::<Vec<_>>().join(" ")
        }
        Value::Array(sentences) => {
            sentences.iter().filter_map(Value::as_str).collect::<Vec<_>>().join("; ")
        }
        other => other.to_string(),
    }
}

/// Name of the end of the spectral solver.
pub(crate) const CONVERGED: &str = "converged";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replication::columns::COLUMNS;

    #[test]
    fn every_column_is_a_field() {
        let numbers = serde_json::to_value(Numbers::default()).unwrap();
        let mut fields: Vec<_> = numbers.as_object().unwrap().keys().map(String::as_str).collect();
        let mut known = COLUMNS.to_vec();
        fields.sort_unstable();
        known.sort_unstable();
        assert_eq!(fields, known);
    }
}
