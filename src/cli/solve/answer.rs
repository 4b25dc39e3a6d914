//! Answer of `solve`: the solution, its judgement apart from the solvers, and both as JSON and as text.

use super::bound::{self, TEN};
use super::clock::Part;
use super::points;
use super::request::Request;
use crate::cli::output::{in_columns, paragraph};
use crate::replication::numbers::Numbers;
use crate::replication::record::{Advice, Record, details};
use crate::table::Table;
use serde_json::{Value, json};
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::mesh::PointValue;
use signorini_mathematics::problem::text::plain;
use signorini_mathematics::solvers::{Run, Solved, Solver};

/// Digits of an energy, unless more are asked for, and the most that a number has.
const DIGITS: usize = 7;
const ALL_DIGITS: usize = 16;

/// Returns numbers of boundary nodes by their states in words.
fn states_in_words([sticks, slips_up, slips_down]: [usize; 3], has_contact: bool) -> String {
    let all = sticks + slips_up + slips_down;
    if has_contact {
        return format!("contact in {sticks} of {all} boundary nodes");
    }
    format!("{sticks} of {all} boundary nodes stick, {slips_up} slip up, {slips_down} slip down")
}

pub(super) struct Answer {
    /// Solution, with the problem on its levels.
    pub solved: Solved,
    /// Numbers of the solution, as tables and JSON have them.
    numbers: Numbers,
    /// v and its gradient at the points that are asked for.
    pub values: Vec<PointValue>,
    /// Warnings and failure.
    record: Record,
}

impl Answer {
    pub(super) fn new(request: &Request, solved: Solved) -> Self {
        let values = solved.values_at(&request.points);
        let record = Record::of((&request.statement, request.voice), &solved);
        let numbers = Numbers::of(&request.statement, &solved, &record);
        if solved.run().is_some() {
            request.clock.ended(Part::Bounds);
        }
        Self { solved, numbers, values, record }
    }

    /// Returns the energy that answers and, if it is another, that of v.
    fn energy_in_words(&self, request: &Request, run: &Run) -> String {
        let of_v = run.last().energy;
        let digits = match request.statement.accuracy() {
            Some(Accuracy::Energy(wanted)) => {
                ((2.0 - libm::log10(wanted)) as usize).clamp(DIGITS, ALL_DIGITS)
            }
            _ => DIGITS,
        };
        let mut text = format!("energy {}\n", self.numbers.shown_energy(digits));
        if self.solved.energy() != of_v {
            text += &format!("energy of the linear v {}\n", plain(of_v, DIGITS));
        }
        text
    }

    /// Returns the answer in JSON, with what belongs to this command alone.
    pub(super) fn json(&self, request: &Request) -> Value {
        let mut json = self.numbers.answer(&request.statement);
        json.insert("schema".into(), 1.into());
        json.insert("scene".into(), json!(request.name));
        json.insert("seconds".into(), request.clock.json());
        if self.solved.run().is_some() {
            json.insert("not_as_in_scene".into(), json!(request.overridden));
        }
        if !self.values.is_empty() {
            json.insert("values".into(), json!(self.values));
        }
        json.into()
    }

    /// True if no value is a number, so that the ends on the levels are all that is known.
    pub(super) fn has_diverged(&self) -> bool {
        self.solved.ends().last().is_some_and(|last| last.end.has_diverged())
    }

    /// Reason why the answer is not what was asked for.
    pub(super) fn failure(&self) -> Option<&Advice> {
        self.record.failure.as_ref()
    }

    /// Returns the answer, then how it was found, and v at points unless a file has it.
    pub(super) fn text(&self, request: &Request, points_in_file: bool) -> String {
        let levels = self.solved.problem.levels();
        let (name, f) = (&request.name, &levels.facts().f);
        let integral = plain(self.solved.integral(), 4);
        let mut text = format!("{name}: f = {f}, integral {integral}\n");
        if !self.record.is_solution {
            text += "not a solution, but where the solver ended:\n";
        }
        match (self.solved.truth(), self.solved.run()) {
            (Some(found), _) => {
                text += &self.truth(request);
                text += &request.clock.text("setup", &format!(" ({} Newton steps)", found.steps));
            }
            (None, Some(run)) => {
                if !self.has_diverged() {
                    text += &self.solution(request, run);
                }
                text += &self.method(request, run);
            }
            (None, None) => {}
        }
        let digits = if self.solved.truth().is_some() { 10 } else { 6 };
        if !points_in_file {
            text += &points::text(&self.values, digits);
        }
        text + &self.record.lines()
    }

    /// Returns a true solution in words.
    fn truth(&self, request: &Request) -> String {
        let Some(found) = self.solved.truth() else { return String::new() };
        let laws = request.statement.boundary.in_words().ok().flatten();
        let law = laws.map_or(String::new(), |laws| paragraph(&format!("law {laws}\n")));
        let energy =
            self.numbers.shown_energy(if found.bracket.is_ok() { ALL_DIGITS } else { TEN });
        let bounds = bound::text(&self.numbers) + &bound::boundary(&self.solved);
        let checks = paragraph(&format!("checks: {}\n", found.checks));
        format!("{law}energy {energy}\n{bounds}{checks}")
    }

    /// Returns what was asked for: the energy with its bounds, v, and the contact.
    fn solution(&self, request: &Request, run: &Run) -> String {
        let (problem, levels) = (&self.solved.problem, self.solved.problem.levels());
        let last = run.last();
        let mut text = self.energy_in_words(request, run);
        text += &bound::text(&self.numbers);
        if let Some(errors) = self.solved.errors() {
            let [l2, h1, max] = [errors.l2, errors.h1, errors.max].map(|error| plain(error, 3));
            text += &format!("errors: L2 {l2}, H1 {h1}, nodes {max}");
            if let Some(multiplier_l2) = errors.multiplier_l2 {
                text += &format!("; multiplier L2 {}", plain(multiplier_l2, 3));
            }
            text.push('\n');
        }
        if let Some(error) = self.numbers.error_true {
            text += &format!("energy off the true one by {} of it\n", plain(error, 3));
        }
        let [least, greatest] = last.range.map(|v| plain(v, 6));
        text += &format!("v from {least} to {greatest}\n");
        let arcs = self.solved.contact().unwrap_or_default();
        let states = run.judgement.state_counts();
        let states = [states.sticks, states.slips_up, states.slips_down];
        text += &states_in_words(states, problem.has_contact());
        let parts = problem.parts_in_contact(&run.judgement);
        if let Some(parts) = parts.as_ref().filter(|parts| arcs.is_empty() && !parts.is_empty()) {
            text += &format!(", on {parts}");
        }
        if arcs.iter().any(|arc| !arc.closed) {
            text += if levels.boundary().len() > 1 {
                "; arcs with the domain on the left"
            } else {
                "; arcs anticlockwise"
            };
        }
        text.push('\n');
        text + &bound::boundary(&self.solved)
    }

    /// Returns how the answer was found: the solver with its settings, the levels, and the time.
    fn method(&self, request: &Request, run: &Run) -> String {
        let (problem, solver) = (&self.solved.problem, request.statement.solver);
        let mut settings = vec![format!("solver {solver}")];
        settings.extend((run.solver != solver).then(|| format!("then {}", run.solver)));
        settings.extend(match self.solved.way() {
            Some(way) => Some(format!("{} {} meshes", way.tried, way.kind())),
            None => request.refined(problem.finest()),
        });
        let named = details::settings(&request.statement).into_iter();
        settings.extend(named.map(|(name, value)| format!("{name} {value}")));
        let mut text = paragraph(&settings.join(", ")) + "\n";
        if !request.overridden.is_empty() {
            text += &format!("not as in the scene: {}\n", request.overridden.join(", "));
        }
        text += &self.table(request, run);
        text += &self.end_of_meshes(run.y.len()).unwrap_or_default();
        let cost = match solver {
            Solver::Multigrid => format!(" ({:.1} sweeps)", run.last().end.work_units),
            _ => String::new(),
        };
        let setup = if problem.domain(0).cells().is_some() { "setup" } else { "mesh" };
        text + &request.clock.text(setup, &cost)
    }

    /// Returns the end of the way to an accuracy on meshes, the last with so many nodes.
    fn end_of_meshes(&self, nodes: usize) -> Option<String> {
        let way = self.solved.way()?;
        let (tried, reason) = (way.tried, way.end.in_words());
        Some(format!("{tried} meshes, the last of {nodes} nodes: {reason}\n"))
    }

    fn table(&self, request: &Request, Run { ends, .. }: &Run) -> String {
        let domain = self.solved.problem.domain(0);
        // An iteration of Arrow-Hurwicz is one sweep: a column of sweeps would repeat that of iterations.
        let nested = request.statement.solver.is_nested()
            && ends.iter().any(|outcome| outcome.end.sweeps() > outcome.end.iterations);
        let first = if domain.cells().is_some() { "grid" } else { "mesh" };
        let mut head = vec![first, "iterations", "stop", "energy", "KKT residual", "relative"];
        if nested {
            head.insert(2, "sweeps");
        }
        let mut rows = Vec::new();
        for outcome in ends {
            let mut row = vec![
                outcome.label(),
                outcome.end.iterations.to_string(),
                match self.solved.way() {
                    Some(_) => outcome.end.stop.name().to_owned(),
                    None => outcome.name().to_owned(),
                },
                plain(outcome.energy, DIGITS),
                plain(outcome.kkt.natural, 3),
                plain(outcome.kkt.relative, 3),
            ];
            if nested {
                row.insert(2, outcome.end.sweeps().to_string());
            }
            rows.push(row);
        }
        in_columns(&Table { rows, ..Table::new(head, &[]) })
    }
}
