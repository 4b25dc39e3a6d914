//! Numbers of a solution: a row of the table of a study.

use crate::replication::columns::{END, STOP, shown};
use crate::replication::record::details::{details, settings};
use crate::replication::record::levels::LevelNumbers;
use crate::replication::record::{Advice, Record};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use signorini_mathematics::bounds::Bounds;
use signorini_mathematics::problem::text::{interval, percent, plain};
use signorini_mathematics::solvers::{Solved, Solver};
use signorini_mathematics::statement::Statement;

/// Numbers of a solution, or the reason for which there is none. What a solver does not have, or is no number, is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Numbers {
    /// Numbers on the last level; of what is no solution without bounds.
    #[serde(flatten)]
    pub(crate) last: LevelNumbers,
    /// Errors of v in L2, in the H1 seminorm and at a node; none where the solution has no formula.
    pub(crate) error_l2: Option<f64>,
    pub(crate) error_h1: Option<f64>,
    pub(crate) error_max: Option<f64>,
    /// Distance of the energy from that of the true solution, over that; none unless it is asked for.
    pub(crate) error_true: Option<f64>,
    /// Length of the boundary in contact, with ends within the cell; in space the area of the nodes in contact.
    pub(crate) contact_length: Option<f64>,
    /// Distance within which the length of a true solution lies, as estimated.
    pub(crate) contact_length_error: Option<f64>,
    /// Contact force: the flux through the boundary where the law holds.
    pub(crate) force: Option<f64>,
    /// Cost in sweeps of the finest level, those of coarser levels included; none of factors and true solutions.
    pub(crate) work_units: Option<f64>,
    /// Iterations on each of the nested grids or meshes of a saddle-point method, coarsest first.
    pub(crate) iterations_per_grid: Option<Vec<usize>>,
    /// KKT residual over the largest load; none of a true solution.
    pub(crate) kkt_relative: Option<f64>,
    /// Solver that found it.
    pub(crate) solver: String,
    /// Approximations that the bounds leave out; none if there are none.
    pub(crate) reserve: Option<String>,
    /// Warnings that `solve` gives, a sentence each.
    pub(crate) warnings: Vec<String>,
    /// Remedy for them, or for the failure.
    pub(crate) remedy: Option<String>,
    /// Reason for which there is no solution, or not the accuracy that was asked for; other numbers are then those
    /// where the solver ended.
    pub(crate) reason: Option<String>,
    /// Parts of an answer that only JSON shows.
    #[serde(flatten)]
    pub(crate) details: Map<String, Value>,
}

impl Numbers {
    /// Numbers of the answer to a statement.
    pub(crate) fn of(statement: &Statement, solved: &Solved, record: &Record) -> Self {
        let bounds = solved.last_bounds().filter(|_| record.is_solution);
        let (run, errors) = (solved.run(), solved.errors());
        let levels = LevelNumbers::all(statement, solved);
        let last = levels.last().cloned().unwrap_or_default().with(bounds);
        let counts = solved.ends().iter().map(|end| end.end.iterations);
        let mut reserves = Vec::new();
        for reserve in solved.reserves() {
            reserves.push(reserve.name());
        }
        Self {
            error_l2: errors.map(|errors| errors.l2),
            error_h1: errors.map(|errors| errors.h1),
            error_max: errors.map(|errors| errors.max),
            error_true: record.error_true,
            contact_length: Some(solved.contact_length()),
            contact_length_error: solved.contact_length_error(),
            force: Some(solved.force()),
            work_units: work_units(solved),
            iterations_per_grid: statement.solver.is_nested().then(|| counts.collect()),
            kkt_relative: run.map(|run| run.last().kkt.relative),
            solver: run.map_or(statement.solver, |run| run.solver).to_string(),
            reserve: (bounds.is_some() && !reserves.is_empty()).then(|| reserves.join(" ")),
            warnings: record.facts(),
            remedy: record.remedy(),
            reason: record.failure.as_ref().map(Advice::sentence),
            details: details(statement, solved, record, &levels),
            last,
        }
    }

    /// Row of a statement without a solution, for this reason.
    pub(crate) fn without(statement: &Statement, reason: String) -> Self {
        let details = Map::from_iter([("failure".to_owned(), reason.clone().into())]);
        let solver = statement.solver.to_string();
        Self { solver, reason: Some(reason), details, ..Self::default() }
    }

    /// True for what is no solution, with the numbers where the solver ended.
    pub(crate) fn is_no_solution(&self) -> bool {
        self.reason.is_some() && self.last.nodes.is_some()
    }

    /// True if the energy is that of the true solution.
    pub(crate) fn has_true_energy(&self) -> bool {
        self.solver == Solver::Spectral.to_string()
    }

    /// The energy with so many digits, a true one with those of them that are known; nothing without one.
    pub(crate) fn shown_energy(&self, digits: usize) -> String {
        self.shown([("energy", digits)]).concat()
    }

    /// The numbers in columns, each with so many digits, those of a true solution with those of them that are known;
    /// nothing where there is none.
    pub(crate) fn shown<const N: usize>(&self, columns: [(&str, usize); N]) -> [String; N] {
        let (all, is_true) = (self.json(), self.has_true_energy());
        columns.map(|column| {
            shown(column, is_true, |name| all.get(name)?.as_f64()).unwrap_or_default()
        })
    }

    /// Guaranteed bounds in words; none where there are none.
    pub(crate) fn guarantee(&self) -> Option<Guarantee> {
        self.last.energy_lower?;
        let bounds = Bounds::deserialize(self.details.get("bound")?).ok()?;
        let in_space = self.details.get("dimension").is_some_and(|number| *number == 3);
        let domain = if in_space { "polyhedron" } else { "polygon" };
        let mut but = String::new();
        for reserve in self.reserve.iter().flat_map(|names| names.rsplit(' ')) {
            but += &match reserve == "polygon" {
                true => format!(", on the {domain}"),
                false => ", but for the quadrature of formulas".into(),
            };
        }
        let [least, most] = bounds.error;
        let range = match least > 0.0 {
            true => format!("{} to ", plain(least, 4)),
            false => "at most ".into(),
        };
        let mut error = format!("error in the energy norm {range}{}", plain(most, 4));
        if let Some(share) = self.last.error_relative.filter(|&share| share < 1.0 && most > 0.0) {
            error += &format!(", at most {} of the solution", percent(share, 3));
        }
        let mut parts = vec![format!("true energy in {}", interval(bounds.energy)), error];
        parts.extend(bounds.curve.map(|curve| {
            let curve = plain(curve, 2);
            format!("energy beside the {domain}, which no bound holds, about {curve}")
        }));
        Some(Guarantee { but, parts })
    }

    /// Numbers on all levels on which the solver ended, coarsest first; of a true solution one, without a level.
    pub(crate) fn levels(&self) -> Vec<LevelNumbers> {
        match self.details.get("grids") {
            Some(levels @ Value::Array(_)) => {
                Vec::deserialize(levels).expect("levels are read as they are written")
            }
            _ => vec![self.last.clone()],
        }
    }

    /// Numbers in some columns; none where the column has texts, or the solution has no such number.
    pub(crate) fn numbers<const N: usize>(&self, columns: [&str; N]) -> [Option<f64>; N] {
        let all = self.json();
        columns.map(|column| all.get(column)?.as_f64())
    }

    /// All columns, and all details.
    pub(crate) fn json(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(all)) => all,
            other => unreachable!("numbers are plain data: {other:?}"),
        }
    }

    /// Answer to a statement in JSON: all columns, all details, and the settings with which it was found on levels.
    pub(crate) fn answer(&self, statement: &Statement) -> Map<String, Value> {
        let mut answer = self.json();
        if answer.contains_key("unknowns") {
            let settings = settings(statement).into_iter();
            let settings: Map<_, _> =
                settings.map(|(name, of)| (name.to_owned(), of.json())).collect();
            answer.insert("settings".into(), settings.into());
        }
        answer
    }

    /// Values in some columns, null where there is none.
    pub(crate) fn values<'a>(&self, columns: &[&'a str]) -> Vec<(&'a str, Value)> {
        let (mut all, mut values) = (self.json(), Vec::new());
        for &column in columns {
            let field = if column == END { STOP } else { column };
            values.push((column, all.remove(field).unwrap_or_default()));
        }
        values
    }

    /// Values in some columns, with all digits; empty where there is none.
    pub(crate) fn cells(&self, columns: &[&str]) -> Vec<String> {
        self.values(columns).iter().map(|(_, value)| cell(value)).collect()
    }
}

/// Cost in sweeps of the finest level: visits of unknowns on all levels, over their number on the finest.
fn work_units(solved: &Solved) -> Option<f64> {
    let run = solved.run().filter(|run| run.solver != Solver::ActiveSet)?;
    if !run.solver.is_nested() {
        return Some(run.last().end.work_units);
    }
    let visits = run.ends.iter().map(|level| level.end.work_units * level.nodes as f64);
    Some(visits.sum::<f64>() / run.last().nodes as f64)
}

/// Guaranteed bounds in words.
pub(crate) struct Guarantee {
    /// Approximations that they leave out; empty if there are none.
    pub(crate) but: String,
    /// Bracket of the energy, bound of the error, and on a curved domain the energy beside it.
    pub(crate) parts: Vec<String>,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replication::columns::COLUMNS;

    #[test]
    fn every_column_is_a_field() {
        let numbers = serde_json::to_value(Numbers::default()).unwrap();
        for column in COLUMNS {
            assert!(numbers.get(column).is_some(), "{column}");
        }
    }
}
