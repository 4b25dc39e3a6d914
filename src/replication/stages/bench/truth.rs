//! True solutions on the square beside those of a second program in higher precision, and at the nodes of a grid.

use crate::pipeline::error::from_record;
use crate::pipeline::{Artifacts, InputFiles, Inputs, Made, Task};
use crate::replication::project::{Project, TRUTH};
use crate::replication::stages::to_json;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::solvers::{Solved, Solver};
use signorini_mathematics::statement::{Domain, Fineness, Statement};

/// Contents of `pipeline/truth.toml`, as `benches/peers/truth.py` writes it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TruthFile {
    solution: Vec<Solution>,
}

/// Solution of one problem, as decimals: a double would lose half of them.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Solution {
    f: String,
    energy: String,
    centre: String,
    /// Values of v, anticlockwise from the lower left corner.
    corners: [String; 4],
    contact: Vec<Arc>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Arc {
    from: [String; 2],
    to: [String; 2],
    force: String,
}

/// Corners of the square, in the order of the record.
const CORNERS: [[f64; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
/// Cells per side of the grid at whose nodes the solutions of the paper's problems are given.
const SAMPLED: usize = 32;

/// Returns the number of some decimals.
fn number(digits: &str) -> Result<f64, String> {
    digits.parse().map_err(|_| format!("{TRUTH}: `{digits}` is no number"))
}

impl Solution {
    /// Largest difference of a number of ours from one of the record.
    fn difference(&self, ours: &Solved) -> Result<f64, String> {
        let ours = ours.truth().ok_or("no true solution")?;
        let mut differences = vec![
            number(&self.energy)? - ours.energy,
            number(&self.centre)? - ours.values(&[[0.0; 2]])[0],
        ];
        for (digits, corner) in self.corners.iter().zip(CORNERS) {
            differences.push(number(digits)? - ours.on_boundary(corner)[0]);
        }
        if self.contact.len() != ours.contact.len() {
            return Err(format!("{TRUTH}: `{}` has other arcs of contact here", self.f));
        }
        for arc in &self.contact {
            let own = ours.contact.iter();
            let own = own.map(|own| arc.difference(own.force, [own.from, own.to]));
            let own = own.collect::<Result<Vec<_>, _>>()?;
            differences.push(own.into_iter().fold(f64::INFINITY, f64::min));
        }
        Ok(differences.into_iter().fold(0.0, |largest, one| largest.max(one.abs())))
    }
}

impl Arc {
    /// Largest difference from the force and the ends of an arc of ours.
    fn difference(&self, force: f64, [from, to]: [[f64; 2]; 2]) -> Result<f64, String> {
        let mut difference = (number(&self.force)? - force).abs();
        let ends = self.from.iter().zip(from).chain(self.to.iter().zip(to));
        for (digits, own) in ends {
            difference = difference.max((number(digits)? - own).abs());
        }
        Ok(difference)
    }
}

/// Solution of f on a grid of the square by a solver, with the load by which the discrete energy is that of the nodal
/// vector; of the true solution, the grid at whose nodes it is given.
fn solved(f: &str, cells: usize, solver: Solver) -> Result<Solved, String> {
    let fineness = Fineness::Width(cells);
    let statement = Statement { fineness, ..Statement::usual(Domain::square(), f) };
    let statement = Statement { solver, ..statement.exactly() };
    statement.solved(None).map_err(|e| format!("{f}: {e}"))
}

/// The paper's problems, by f, and the cells per side of their finest grids.
#[derive(Serialize, Deserialize)]
pub(super) struct AskedTruth {
    problems: Vec<(String, usize)>,
}

impl AskedTruth {
    /// The task of the book; none without the record.
    pub(super) fn task(project: &Project) -> Option<Task> {
        let file = project.files.get(TRUTH)?.clone();
        let problems = project.problems().into_iter();
        let problems =
            problems.map(|scene| (scene.statement.f.clone(), scene.finest().cells())).collect();
        let task = Task::new(super::id("truth"), &Self { problems }, Vec::new(), Self::made);
        Some(task.with_files(InputFiles::from([(TRUTH.to_owned(), file)])))
    }

    fn made(&self, inputs: &Inputs) -> Made {
        let record = inputs.file(TRUTH)?.ok_or("no true solutions")?;
        let mut found = compared(from_record(TRUTH, record)?)?;
        let mut samples = Vec::new();
        for (f, cells) in &self.problems {
            let truth = solved(f, SAMPLED, Solver::Spectral)?;
            let Pair { y, a } = truth.pair();
            let discrete = solved(f, *cells, Solver::Multigrid)?;
            // No less than the error in the energy norm.
            let error = (2.0 * (discrete.energy() - truth.energy())).sqrt();
            samples.push(json!({ "cells": SAMPLED, "v": y, "a": a, "error": error }));
        }
        found["samples"] = samples.into();
        Ok(Artifacts::from([(super::RESULT.into(), to_json(&found))]))
    }
}

/// Returns the record, the largest difference of ours from it, the largest width of our brackets of the energy over
/// it, and the largest flux that our solutions do not balance over the integral of |f|.
fn compared(record: TruthFile) -> Result<Value, String> {
    let (mut difference, mut bracket, mut balance) = (0.0f64, 0.0f64, 0.0f64);
    for theirs in &record.solution {
        let ours = solved(&theirs.f, SAMPLED, Solver::Spectral)?;
        difference = difference.max(theirs.difference(&ours)?);
        let checks = ours.truth().map(|truth| &truth.checks).ok_or("no true solution")?;
        bracket = bracket.max(checks.bracket.unwrap_or(f64::INFINITY));
        balance = balance.max(checks.balance.abs());
    }
    Ok(json!({
        "solutions": record.solution, "difference": difference, "bracket": bracket, "balance": balance,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RECORD: &str = include_str!("../../../../pipeline/truth.toml");

    /// An arc of contact more.
    const ARC: &str = "[[solution.contact]]\nfrom = [\"0\", \"0\"]\nto = [\"0\", \"0\"]\nforce = \"1\"\n\
        [[solution.contact]]";

    fn found(record: &str) -> Result<Value, String> {
        compared(toml::from_str(record).map_err(|e| e.to_string())?)
    }

    #[test]
    fn the_record_agrees_with_our_solutions() {
        let found = found(RECORD).unwrap();
        assert_eq!(found["solutions"].as_array().unwrap().len(), 6);
        for name in ["difference", "bracket", "balance"] {
            assert!(found[name].as_f64().unwrap() < 1e-10, "{name}: {}", found[name]);
        }
        let end = "0.44518817282294007002";
        assert!(RECORD.contains(end));
        let other = self::found(&RECORD.replace(end, "0.44518817"));
        assert!(other.unwrap()["difference"].as_f64().unwrap() > 1e-9);
    }

    #[test]
    fn a_broken_record_is_refused() {
        let first = &RECORD[RECORD.find("[[solution]]").unwrap()..];
        for (old, new) in [
            ("energy = \"-0.1", "energy = \"minus 0.1"),
            ("centre", "center"),
            ("force = \"0.0015", "force = \"O.0015"),
            ("[[solution.contact]]", ARC),
        ] {
            assert!(found(&first.replacen(old, new, 1)).is_err(), "{new}");
        }
    }
}
