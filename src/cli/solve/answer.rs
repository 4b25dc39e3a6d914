//! Answer of `solve`: the solution, its judgement apart from the solvers, and both as JSON and as text.

use super::bound::{self, BoundaryWords};
use super::domain::{Domain, Guarantee, KnownErrors};
use super::problem::Problem;
use crate::cli::output::columns;
use signorini_mathematics::discrete::contact::ContactArc;
use signorini_mathematics::discrete::kkt::{Judgement, Kkt};
use signorini_mathematics::discrete::norms::Errors;

use crate::replication::scene::shown_integral;
use serde::Serialize;
use serde_json::{Value, json};
use signorini_mathematics::discrete::stop::Stop;
use signorini_mathematics::discrete::verdict::Verdict;
use signorini_mathematics::problem::law::{BoundaryState, Law};
use signorini_mathematics::saddle::{Outcome, Pair};
use std::collections::BTreeMap;

/// End of a solver on one grid.
pub(super) struct Level {
    /// Number of the grid: cells per side, or refinements.
    pub number: usize,
    pub iterations: usize,
    /// Gauss-Seidel sweeps, if the solver consists of sweeps.
    pub sweeps: Option<usize>,
    /// Reason for which the solver ended.
    pub stop: Stop,
    pub energy: f64,
    pub sum_load: f64,
    pub kkt: Kkt,
    pub verdict: Verdict,
}

impl Level {
    /// End of a saddle-point method on the grid with this number.
    pub(super) fn of_outcome(number: usize, outcome: &Outcome) -> Self {
        Self {
            number,
            iterations: outcome.iterations,
            sweeps: Some(outcome.sweeps),
            stop: outcome.stop,
            energy: outcome.energy,
            sum_load: outcome.sum_load,
            kkt: outcome.kkt,
            verdict: outcome.verdict(),
        }
    }

    /// Name of the end: the verdict if the vector is no solution, else the reason of the solver.
    pub(super) fn end(&self) -> &str {
        self.verdict.end(self.stop)
    }
}

impl Level {
    fn json(&self, domain: &Domain) -> Value {
        let mut level = json!({
            "iterations": self.iterations,
            "stop": self.end(),
            "energy": self.energy,
            "sum_load": self.sum_load,
            // On a coarse grid the natural residual is enough.
            "kkt": { "natural": self.kkt.natural, "relative": self.kkt.relative },
        });
        match domain {
            Domain::Square { .. } | Domain::Cube { .. } => level["cells"] = self.number.into(),
            Domain::Mesh(mesh) => {
                level["refinement"] = self.number.into();
                level["nodes"] = mesh.problem.levels[self.number].network.nodes().into();
            }
        }
        if let Some(sweeps) = self.sweeps {
            level["sweeps"] = sweeps.into();
        }
        level
    }
}

pub(super) struct Solved {
    /// One entry per grid on which the solver stopped, coarsest first.
    pub levels: Vec<Level>,
    /// Solution on the finest grid, with its multiplier.
    pub pair: Pair,
    /// Judgement of the solution.
    pub judgement: Judgement,
    /// Cost in sweeps of the finest grid, if the solver counts it.
    pub work_units: Option<f64>,
}

impl Solved {
    /// Returns the nodal vector `y` with the multiplier that follows from it, not with a multiplier of the solver.
    pub(super) fn new(
        levels: Vec<Level>,
        y: Vec<f64>,
        judgement: Judgement,
        work_units: Option<f64>,
    ) -> Self {
        let a = judgement.multiplier(&y);
        Self { levels, pair: Pair { y, a }, judgement, work_units }
    }
}

/// Numbers of boundary nodes by their states.
#[derive(Clone, Copy, Debug, Serialize)]
struct States {
    /// Nodes at zero; under the paper's law, in contact.
    sticks: usize,
    slips_up: usize,
    slips_down: usize,
}

impl States {
    fn all(self) -> usize {
        self.sticks + self.slips_up + self.slips_down
    }

    fn text(self, law: Law) -> String {
        let (Self { sticks, slips_up, slips_down }, all) = (self, self.all());
        if law.is_signorini() {
            return format!("contact in {sticks} of {all} boundary nodes (arcs run anticlockwise)");
        }
        format!(
            "{sticks} of {all} boundary nodes stick, {slips_up} slip up, {slips_down} slip down\n(arcs run anticlockwise)"
        )
    }
}

/// Interval of a law.
pub(super) fn law_json(law: Law) -> Value {
    json!({ "lo": finite(law.lo()), "hi": finite(law.hi()) })
}

/// A number, null if it is infinite.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

pub(super) struct Answer {
    pub solved: Solved,
    /// Numbers of boundary nodes by their states.
    states: States,
    /// Arcs in contact, with ends estimated within the cell; `None` on the cube.
    contact: Option<Vec<ContactArc>>,
    /// Total contact force: sum of r over the nodes in contact, and of the law's flux over the others.
    pub force: f64,
    /// Errors, if the solution is known.
    errors: Option<KnownErrors>,
    /// Guaranteed bounds, or the reason for their absence.
    pub bounds: Result<Guarantee, String>,
    /// Run times for grids and load vectors, and for the solver.
    seconds: [f64; 2],
    pub warnings: Vec<String>,
    /// Reason why the answer is no solution, in a sentence with a remedy.
    pub failure: Option<String>,
}

impl Answer {
    pub(super) fn new(problem: &Problem, solved: Solved, load: &[f64], seconds: [f64; 2]) -> Self {
        let (n, y) = (problem.finest(), &solved.pair.y);
        let law = problem.law;
        let Judgement { contact, flux, .. } = &solved.judgement;
        let mut force = 0.0;
        let mut states = States { sticks: 0, slips_up: 0, slips_down: 0 };
        for ((state, contact), flux) in solved.judgement.states.iter().zip(contact).zip(flux) {
            match state {
                BoundaryState::Sticks => {
                    states.sticks += 1;
                    force += flux;
                }
                BoundaryState::SlipsUp => {
                    states.slips_up += 1;
                    force += contact.measure * law.lo();
                }
                BoundaryState::SlipsDown => {
                    states.slips_down += 1;
                    force += contact.measure * law.hi();
                }
            }
        }
        let mut answer = Self {
            states,
            contact: problem.domain.contact(n, y, &solved.judgement),
            force,
            errors: problem.domain.errors(n, y, load).filter(|_| law.is_signorini()),
            bounds: problem.domain.bounds(n, law, y),
            solved,
            seconds,
            warnings: Vec::new(),
            failure: None,
        };
        answer.judge(problem);
        answer
    }

    pub(super) fn last(&self) -> &Level {
        self.solved.levels.last().expect("at least one grid")
    }

    /// Name of the end on the finest grid.
    fn end(&self, problem: &Problem) -> &str {
        // A guaranteed bound that was asked for has been reached; residuals of single nodes do not contradict it.
        if problem.accuracy.is_some() { self.last().stop.name() } else { self.last().end() }
    }

    pub(super) fn json(&self, problem: &Problem) -> Value {
        let last = self.last();
        let (n, kkt, bounds) = (problem.finest(), last.kkt, self.bounds.as_ref().ok());
        let levels = &self.solved.levels;
        let mut json = json!({
            "schema": 1,
            "scene": problem.name(),
            "f": problem.domain.f(),
            "dimension": problem.domain.dimension(),
            "solver": problem.solver,
            "settings": problem.settings().into_iter().collect::<BTreeMap<_, _>>(),
            "not_as_in_scene": problem.overridden,
            "h": problem.domain.h(n),
            "unknowns": self.solved.pair.y.len(),
            "iterations": last.iterations,
            "iterations_per_grid": levels.iter().map(|level| level.iterations).collect::<Vec<_>>(),
            "stop": self.end(problem),
            "grids": levels.iter().map(|level| level.json(&problem.domain)).collect::<Vec<_>>(),
            "energy": last.energy,
            "integral_f": problem.integral,
            "sum_load": last.sum_load,
            "kkt": {
                "stationarity": kkt.stationarity,
                "min_y": kkt.min_y,
                "min_lambda": kkt.min_lambda,
                "complementarity": self.solved.judgement.work,
                "max_min": kkt.complementarity,
                "natural": kkt.natural,
                "relative": kkt.relative,
            },
            "contact_nodes": { "nodes": self.states.sticks, "boundary_nodes": self.states.all() },
            "bound": bounds.map(|Guarantee { bounds: of, reserve }| {
                json!({
                    "energy": of.energy,
                    "error": of.error,
                    "recovered": of.recovered,
                    "relative": { "energy": of.relative_energy(), "error": of.relative() },
                    "reserve": reserve,
                })
            }),
            "contact": self.contact,
            "force": self.force,
            "warnings": problem.warnings.iter().chain(&self.warnings).collect::<Vec<_>>(),
            "seconds": { "setup": self.seconds[0], "solve": self.seconds[1] },
        });
        if !problem.law.is_signorini() {
            json["law"] = law_json(problem.law);
            json["states"] = json!(self.states);
        }
        if let Some(sweeps) = last.sweeps {
            json["sweeps"] = sweeps.into();
            json["sweeps_per_grid"] =
                levels.iter().filter_map(|level| level.sweeps).collect::<Vec<_>>().into();
        }
        if let Some(work_units) = self.solved.work_units {
            json["work_units"] = work_units.into();
        }
        if let Some(KnownErrors { values, multiplier_l2 }) = &self.errors {
            json["errors"] = json!(values);
            if let Some(multiplier_l2) = *multiplier_l2 {
                json["errors"]["multiplier_l2"] = multiplier_l2.into();
            }
        }
        if let Err(reason) = &self.bounds {
            json["bound_reason"] = reason.as_str().into();
        }
        if self.contact.is_none() {
            json["contact_reason"] =
                "the contact set in space is part of a surface, without arcs".into();
        }
        json
    }

    pub(super) fn text(&self, problem: &Problem) -> String {
        let name = match problem.domain {
            Domain::Cube { .. } => "cube",
            Domain::Square { .. } | Domain::Mesh(_) => problem.name(),
        };
        let (f, integral) = (problem.domain.f(), shown_integral(problem.integral));
        let mut text = format!("{name}: f = {f}, integral {integral}\n");
        let mut settings = Vec::new();
        for (name, value) in problem.settings() {
            settings.push(match value {
                Value::String(text) => format!("{name} {text}"),
                value => format!("{name} {value}"),
            });
        }
        if !settings.is_empty() {
            text += &format!("{}\n", settings.join(", "));
        }
        if !problem.overridden.is_empty() {
            text += &format!("not as in the scene: {}\n", problem.overridden.join(", "));
        }
        text += &self.table(&problem.domain);
        text += &format!("solved in {:.3} s", self.seconds[1]);
        if let Some(work_units) = self.solved.work_units {
            text += &format!(", the cost of {work_units:.1} sweeps");
        }
        text += &format!("\n{}\n", self.states.text(problem.law));
        let words = BoundaryWords::of(problem.law);
        for arc in self.contact.iter().flatten() {
            text += &words.arc(arc, 6);
        }
        text += &words.force(self.force, 0.0 - problem.integral, 6);
        if self.load_misses(problem) {
            text += &format!("minus the sum of the load {:.5e}\n", 0.0 - self.last().sum_load);
        }
        if let Some(KnownErrors { values, multiplier_l2 }) = &self.errors {
            let Errors { l2, h1, max, .. } = values;
            text += &format!("errors: L2 {l2:.2e}, H1 {h1:.2e}, nodes {max:.2e}");
            if let Some(multiplier_l2) = multiplier_l2 {
                text += &format!("; multiplier L2 {multiplier_l2:.2e}");
            }
            text.push('\n');
        }
        if !self.last().verdict.is_failure() || problem.accuracy.is_some() {
            text += &bound::text(&self.bounds, problem.domain.dimension());
        }
        for warning in &self.warnings {
            text += &format!("warning: {warning}\n");
        }
        text
    }

    fn table(&self, domain: &Domain) -> String {
        let levels = &self.solved.levels;
        // An iteration of Arrow-Hurwicz is one sweep: a column of sweeps would repeat that of iterations.
        let nested = levels.iter().any(|o| o.sweeps.is_some_and(|sweeps| sweeps > o.iterations));
        let first = if matches!(domain, Domain::Mesh(_)) { "nodes" } else { "grid" };
        let mut head = vec![first, "iterations", "stop", "energy", "KKT residual", "relative"];
        if nested {
            head.insert(2, "sweeps");
        }
        let mut rows = Vec::new();
        for level in levels {
            let mut row = vec![
                domain.row(level.number),
                level.iterations.to_string(),
                level.end().to_owned(),
                format!("{:.6e}", level.energy),
                format!("{:.2e}", level.kkt.natural),
                format!("{:.2e}", level.kkt.relative),
            ];
            if nested {
                row.insert(2, level.sweeps.unwrap_or(level.iterations).to_string());
            }
            rows.push(row);
        }
        columns(&head, &[], rows)
    }
}
