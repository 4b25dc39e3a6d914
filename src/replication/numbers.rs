//! Numbers of a solution: a row of the table of a study.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use signorini_mathematics::bounds::{Accuracy, Bounds};
use signorini_mathematics::discrete::contact::ContactArc;
use signorini_mathematics::solvers::{Run, Solved};
use signorini_mathematics::statement::Statement;

/// Columns that only bounds give.
const OF_BOUNDS: [&str; 3] = ["energy_lower", "energy_upper", "error_relative"];

/// True if a column needs bounds.
pub(crate) fn is_of_bounds(column: &str) -> bool {
    OF_BOUNDS.contains(&column)
}

/// Columns of the numbers, in their order.
pub(crate) const COLUMNS: [&str; 15] = [
    "energy",
    "energy_lower",
    "energy_upper",
    "error_relative",
    "error_l2",
    "error_h1",
    "error_max",
    "v_least",
    "v_greatest",
    "contact_length",
    "force",
    "nodes",
    "iterations",
    "solver",
    "reason",
];

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
    /// Length of the boundary in contact, in space its area: on the square with ends within the cell, elsewhere that of
    /// the nodes in contact.
    contact_length: Option<f64>,
    /// Contact force: the flux through the boundary where the law holds.
    force: Option<f64>,
    nodes: Option<usize>,
    iterations: Option<usize>,
    /// Solver that found it.
    solver: String,
    /// Reason for which there is no solution.
    reason: Option<String>,
}

impl Numbers {
    /// Numbers of the answer to a statement, with bounds if they are wanted or were made for an accuracy; without a
    /// solution, the reason alone.
    pub(crate) fn of(statement: &Statement, solved: &Solved, with_bounds: bool) -> Self {
        let accuracy = statement.accuracy();
        if let Some(last) = solved.ends().last()
            && last.judged(accuracy.is_some()).is_failure()
        {
            let level = solved.problem.name(solved.problem.finest());
            return Self::without(
                statement,
                format!("{} on {level}", last.name().replace('-', " ")),
            );
        }
        let bounds = match with_bounds || accuracy.is_some() {
            true => solved.bounds().last().and_then(|bounds| bounds.as_ref().ok()),
            false => None,
        };
        let of_v = solved.energy();
        let energy = match (accuracy, bounds) {
            (Some(Accuracy::Energy(_)), Some(bounds)) => bounds.nearest_energy(of_v),
            _ => of_v,
        };
        let relative = bounds.map(Bounds::relative).filter(|relative| relative.is_finite());
        let (run, errors) = (solved.run(), solved.errors());
        let (last, truth) = (run.map(Run::last), solved.truth());
        Self {
            energy: Some(energy),
            energy_lower: bounds.map(|bounds| bounds.energy[0]),
            energy_upper: bounds.map(|bounds| bounds.energy[1]),
            error_relative: relative,
            error_l2: errors.map(|errors| errors.l2),
            error_h1: errors.map(|errors| errors.h1),
            error_max: errors.map(|errors| errors.max),
            v_least: last.map(|last| last.range[0]),
            v_greatest: last.map(|last| last.range[1]),
            contact_length: contact_length(solved),
            force: Some(solved.force()),
            nodes: last.map(|last| last.nodes),
            iterations: last.map(|last| last.end.iterations).or(truth.map(|found| found.steps)),
            solver: run.map_or(statement.solver, |run| run.solver).to_string(),
            reason: None,
        }
    }

    /// Row of a statement without a solution, for this reason.
    pub(crate) fn without(statement: &Statement, reason: String) -> Self {
        Self { solver: statement.solver.to_string(), reason: Some(reason), ..Self::default() }
    }

    /// Reason for which there is no solution.
    pub(crate) fn reason(&self) -> Option<&str> {
        self.reason.as_deref()
    }

    /// Number in a column; none if the column has texts, or the solution has no such number.
    pub(crate) fn number(&self, column: &str) -> Option<f64> {
        self.value(column).as_f64()
    }

    /// Value in a column, null where there is none.
    pub(crate) fn value(&self, column: &str) -> Value {
        let value = serde_json::to_value(self).expect("numbers are plain data");
        value.get(column).cloned().unwrap_or_default()
    }

    /// Values in some columns, with all digits; empty where there is none.
    pub(crate) fn cells(&self, columns: &[&str]) -> Vec<String> {
        let all = serde_json::to_value(self).expect("numbers are plain data");
        columns.iter().map(|column| cell(&all[column])).collect()
    }
}

/// Returns a value of a row as a table has it.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// Length of the boundary in contact, in space its area.
fn contact_length(solved: &Solved) -> Option<f64> {
    if solved.problem.lattices().is_some() {
        let arcs = solved.contact()?;
        return Some(arcs.iter().map(length_on_square).fold(0.0, |sum, length| sum + length));
    }
    let judgement = &solved.run()?.judgement;
    let nodes = judgement.contact.iter().zip(judgement.in_contact());
    Some(nodes.filter(|(_, is_held)| *is_held).fold(0.0, |sum, (node, _)| sum + node.measure))
}

/// Length of an arc on the boundary of the square, anticlockwise.
fn length_on_square(arc: &ContactArc) -> f64 {
    const SIDES: f64 = 4.0;
    if arc.closed {
        return SIDES;
    }
    (along_square(arc.to) - along_square(arc.from)).rem_euclid(SIDES)
}

/// Way along the boundary of the square from its lower left corner, anticlockwise.
fn along_square([x, y]: [f64; 2]) -> f64 {
    match () {
        () if y <= -0.5 => x + 0.5,
        () if x >= 0.5 => y + 1.5,
        () if y >= 0.5 => 2.5 - x,
        () => 3.5 - y,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_measured_anticlockwise() {
        let arc = |from, to| length_on_square(&ContactArc::new([from, to], 0.0));
        assert_eq!(arc([-0.25, -0.5], [0.25, -0.5]), 0.5);
        assert_eq!(arc([0.25, -0.5], [-0.25, -0.5]), 3.5);
        assert_eq!(arc([-0.5, -0.25], [-0.25, -0.5]), 0.5);
        assert_eq!(arc([0.5, 0.25], [0.25, 0.5]), 0.5);
        assert_eq!(arc([0.5, 0.5], [0.5, 0.5]), 4.0);
    }

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
