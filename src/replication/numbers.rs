//! Numbers of a solution: a row of the table of a study.

use crate::replication::columns::{END, STOP, shown};
use crate::replication::record::Record;
use crate::replication::record::advice::Warning;
use crate::replication::record::details::{details, settings};
use crate::replication::record::levels::LevelNumbers;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use signorini_mathematics::bounds::Bounds;
use signorini_mathematics::levels::Reserve;
use signorini_mathematics::problem::text::{interval, percent, plain};
use signorini_mathematics::solvers::{Run, Solved, Solver};
use signorini_mathematics::statement::Statement;

/// Numbers of a solution, or the reason for which there is none; what a solver does not have is none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Numbers {
    /// Energy: that of v or, where the accuracy of the energy was asked for, the number of the bracket nearest to it.
    pub(crate) energy: Option<f64>,
    /// Guaranteed bracket of the energy.
    pub(crate) energy_lower: Option<f64>,
    pub(crate) energy_upper: Option<f64>,
    /// Guaranteed bound of the error in the energy norm, over the solution; none where it is not below the solution.
    pub(crate) error_relative: Option<f64>,
    /// Errors of v in L2, in the H1 seminorm and at a node; none where the solution has no formula.
    pub(crate) error_l2: Option<f64>,
    pub(crate) error_h1: Option<f64>,
    pub(crate) error_max: Option<f64>,
    /// Least and greatest nodal value.
    pub(crate) v_least: Option<f64>,
    pub(crate) v_greatest: Option<f64>,
    /// Length of the boundary in contact, with ends within the cell; in space the area of the nodes in contact.
    pub(crate) contact_length: Option<f64>,
    /// Distance within which the length of a true solution lies, as estimated.
    pub(crate) contact_length_error: Option<f64>,
    /// Contact force: the flux through the boundary where the law holds.
    pub(crate) force: Option<f64>,
    pub(crate) nodes: Option<usize>,
    pub(crate) iterations: Option<usize>,
    /// Cost in sweeps of the finest level, those of coarser levels included; none of factors and true solutions.
    pub(crate) work_units: Option<f64>,
    /// Iterations on each of the nested grids or meshes of a saddle-point method, coarsest first.
    pub(crate) iterations_per_grid: Option<Vec<usize>>,
    /// Name of the end of the solver.
    pub(crate) stop: Option<String>,
    /// KKT residual over the largest load; none of a true solution.
    pub(crate) kkt_relative: Option<f64>,
    /// Last change of the multiplier of a saddle-point method.
    pub(crate) delta_a: Option<f64>,
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
    /// Numbers of the answer to a statement; of what is no solution without bounds.
    pub(crate) fn of(statement: &Statement, solved: &Solved, record: &Record) -> Self {
        let bounds = solved.last_bounds().filter(|_| record.failure.is_none());
        let energy = solved.energy();
        let relative = bounds.map(Bounds::relative).filter(|relative| relative.is_finite());
        let (run, errors) = (solved.run(), solved.errors());
        let (last, truth) = (run.map(Run::last), solved.truth());
        let is_bounded = statement.accuracy().is_some();
        let stop = last.map_or(CONVERGED, |last| last.name_of(is_bounded));
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
            work_units: work_units(solved),
            iterations_per_grid: statement.solver.is_nested().then(|| counts.collect()),
            stop: Some(stop.into()),
            kkt_relative: last.map(|last| last.kkt.relative),
            delta_a: last.and_then(|last| last.end.delta_a),
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

    /// True for what is no solution, with the numbers where the solver ended.
    pub(crate) fn is_no_solution(&self) -> bool {
        self.reason.is_some() && self.nodes.is_some()
    }

    /// Guaranteed bounds; none where there are none, or no solution.
    pub(crate) fn bounds(&self) -> Option<Bounds> {
        self.energy_lower?;
        Bounds::deserialize(self.details.get("bound")?).ok()
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
        let bounds = self.bounds()?;
        let in_space = self.details.get("dimension").is_some_and(|number| *number == 3);
        let domain = if in_space { "polyhedron" } else { "polygon" };
        let mut but = String::new();
        for reserve in self.reserve.iter().flat_map(|names| names.rsplit(' ')) {
            but += &match reserve == Reserve::Polygon.name() {
                true => format!(", on the {domain}"),
                false => ", but for the quadrature of f".into(),
            };
        }
        let [least, most] = bounds.error;
        let range = match least > 0.0 {
            true => format!("{} to ", plain(least, 4)),
            false => "at most ".into(),
        };
        let error =
            format!("error in the energy norm {range}{}", with_share(most, bounds.relative()));
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
            _ => {
                let numbers = LevelNumbers {
                    iterations: self.iterations.unwrap_or_default(),
                    stop: self.stop.clone().unwrap_or_default(),
                    energy: self.energy,
                    ..LevelNumbers::default()
                };
                vec![numbers.with(self.bounds().as_ref())]
            }
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
            let settings: Map<_, _> = settings.map(|(name, of)| (name.to_owned(), of)).collect();
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

/// Returns a bound of the error, and its share of the solution if that is below one.
pub(crate) fn with_share(bound: f64, share: f64) -> String {
    let of_solution = match share < 1.0 && bound > 0.0 {
        true => format!(", at most {} of the solution", percent(share, 3)),
        false => String::new(),
    };
    plain(bound, 4) + &of_solution
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
