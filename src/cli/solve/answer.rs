//! Answer of `solve`: the solution, its judgement apart from the solvers, and both as JSON and as text.

use super::advice::{self, Warning, combined, remedies};
use super::bound::{self, BoundaryWords};
use super::clock::Part;
use super::request::Request;
use crate::cli::output::{in_columns, paragraph};
use crate::table::Table;
use serde::Serialize;
use serde_json::{Value, json};
use signorini_mathematics::bounds::{Accuracy, Bounds, NoBound};
use signorini_mathematics::discrete::contact::ContactArc;
use signorini_mathematics::discrete::end::Outcome;
use signorini_mathematics::discrete::kkt::Judgement;
use signorini_mathematics::discrete::norms::Errors;
use signorini_mathematics::levels::KnownErrors;
use signorini_mathematics::problem::law::{BoundaryState, Law};
use signorini_mathematics::problem::text::{Written, plain};
use signorini_mathematics::saddle::Pair;
use signorini_mathematics::solvers::{Run, Solver};
use std::collections::BTreeMap;

/// Digits of an energy, unless more are asked for.
const DIGITS: usize = 7;

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

    /// Returns the numbers in words.
    fn text(self, law: Law) -> String {
        let (Self { sticks, slips_up, slips_down }, all) = (self, self.all());
        if law.is_signorini() {
            return format!("contact in {sticks} of {all} boundary nodes");
        }
        format!(
            "{sticks} of {all} boundary nodes stick, {slips_up} slip up, {slips_down} slip down"
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
    pub run: Run,
    /// Solution on the finest level, with the multiplier that follows from it, not with one of the solver.
    pub pair: Pair,
    /// Numbers of boundary nodes by their states.
    states: States,
    /// Arcs in contact, with ends estimated within the cell; `None` in space.
    contact: Option<Vec<ContactArc>>,
    /// Total contact force: sum of r over the nodes in contact, and of the law's flux over the others.
    pub force: f64,
    /// Errors, if the solution is known.
    errors: Option<KnownErrors>,
    /// Guaranteed bounds, or the reason for their absence.
    pub bounds: Result<Bounds, NoBound>,
    pub warnings: Vec<Warning>,
    /// Reason why the answer is no solution.
    pub failure: Option<Warning>,
    /// Reason why the solution is not as accurate as asked.
    pub shortfall: Option<Warning>,
}

impl Answer {
    pub(super) fn new(request: &Request, run: Run, bounds: Result<Bounds, NoBound>) -> Self {
        let (problem, law) = (&request.problem, request.problem.law());
        let (y, judgement) = (&run.y, &run.judgement);
        let Judgement { contact, flux, states: of_nodes, .. } = judgement;
        let mut force = 0.0;
        let mut states = States { sticks: 0, slips_up: 0, slips_down: 0 };
        for ((state, contact), flux) in of_nodes.iter().zip(contact).zip(flux) {
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
        let levels = problem.levels();
        let mut answer = Self {
            states,
            contact: levels.arcs(y, judgement),
            force,
            errors: levels.errors(y, problem.load()).filter(|_| law.is_signorini()),
            bounds,
            pair: Pair { y: y.clone(), a: judgement.multiplier(y) },
            run,
            warnings: Vec::new(),
            failure: None,
            shortfall: None,
        };
        answer.judge(request);
        request.clock.ended(Part::Bounds);
        answer
    }

    /// End on the finest level.
    pub(super) fn last(&self) -> &Outcome {
        self.run.last()
    }

    /// Energy that answers, which has the accuracy of the energy that was asked for.
    fn energy(&self, request: &Request) -> f64 {
        match (request.accuracy(), &self.bounds) {
            (Some(Accuracy::Energy(_)), Ok(bounds)) => bounds.nearest_energy(self.last().energy),
            _ => self.last().energy,
        }
    }

    /// Returns that energy and, if it is another, that of v.
    fn energy_in_words(&self, request: &Request) -> String {
        let digits = match request.accuracy() {
            Some(Accuracy::Energy(wanted)) => DIGITS.max(2 + (-libm::log10(wanted)) as usize),
            _ => DIGITS,
        };
        let (energy, of_v) = (self.energy(request), self.last().energy);
        let mut text = format!("energy {}\n", plain(energy, digits));
        if energy != of_v {
            text += &format!("energy of the linear v {}\n", plain(of_v, DIGITS));
        }
        text
    }

    /// Name of the end on the finest grid.
    fn end(&self, request: &Request) -> &str {
        // A guaranteed bound that was asked for has been reached; residuals of single nodes do not contradict it.
        if request.accuracy().is_some() { self.last().end.stop.name() } else { self.last().name() }
    }

    pub(super) fn json(&self, request: &Request) -> Value {
        let (problem, levels) = (&request.problem, request.problem.levels());
        let (last, ends, solver) = (self.last(), &self.run.ends, request.solver());
        let mut grids = Vec::new();
        for (level, outcome) in (self.run.first_level..).zip(ends) {
            grids.push(outcome_json(solver, level, outcome));
        }
        let (kkt, bounds) = (last.kkt, self.bounds.as_ref().ok());
        let integral = levels.integrals().of_f;
        let [v_least, v_greatest] = last.range;
        let warnings = self.warnings.iter().map(|warning| warning.fact.clone());
        let mut json = json!({
            "schema": 1,
            "scene": request.name,
            "f": levels.f(),
            "dimension": levels.dimension(),
            "solver": request.solver(),
            "settings": request.settings().into_iter().collect::<BTreeMap<_, _>>(),
            "not_as_in_scene": request.overridden,
            "h": request.width(),
            "unknowns": self.pair.y.len(),
            "iterations": last.end.iterations,
            "iterations_per_grid": ends.iter().map(|end| end.end.iterations).collect::<Vec<_>>(),
            "stop": self.end(request),
            "grids": grids,
            "energy": self.energy(request),
            "v_least": v_least,
            "v_greatest": v_greatest,
            "integral_f": integral,
            "sum_load": last.sum_load,
            "kkt": {
                "stationarity": kkt.stationarity,
                "min_y": kkt.min_y,
                "min_lambda": kkt.min_lambda,
                "complementarity": self.run.judgement.work,
                "max_min": kkt.complementarity,
                "natural": kkt.natural,
                "relative": kkt.relative,
            },
            "contact_nodes": { "nodes": self.states.sticks, "boundary_nodes": self.states.all() },
            "bound": bounds.map(|bounds| {
                json!({
                    "energy": bounds.energy,
                    "error": bounds.error,
                    "recovered": bounds.recovered,
                    "relative": {
                        "energy": bounds.relative_energy(),
                        "error": bounds.relative(),
                    },
                    "reserve": problem.reserves(),
                })
            }),
            "contact": self.contact,
            "force": self.force,
            "warnings": request.warnings.iter().cloned().chain(warnings).collect::<Vec<_>>(),
            "failure": self.refusal().map(|failure| &failure.fact),
            "remedy": self.remedy(),
            "seconds": request.clock.json(),
        });
        if !problem.law().is_signorini() {
            json["law"] = law_json(problem.law());
            json["states"] = json!(self.states);
        }
        if solver.is_nested() {
            json["sweeps"] = last.end.sweeps().into();
            json["sweeps_per_grid"] =
                ends.iter().map(|outcome| outcome.end.sweeps()).collect::<Vec<_>>().into();
        }
        if solver == Solver::Multigrid {
            json["work_units"] = last.end.work_units.into();
        }
        if let Some(curve) = bounds.and_then(|bounds| bounds.curve) {
            json["bound"]["curve"] = curve.into();
        }
        if let Some(Accuracy::Energy(_)) = request.accuracy() {
            json["energy_of_linear_v"] = last.energy.into();
        }
        if let Some(meshes) = request.adapted {
            json["adapted"] = meshes.json(request.accuracy().zip(bounds));
        }
        if let Some(KnownErrors { values, multiplier_l2 }) = &self.errors {
            json["errors"] = json!(values);
            if let Some(multiplier_l2) = *multiplier_l2 {
                json["errors"]["multiplier_l2"] = multiplier_l2.into();
            }
        }
        if let Err(reason) = &self.bounds {
            json["bound_reason"] = reason.to_string().into();
        }
        if self.contact.is_none() {
            json["contact_reason"] =
                "the contact set in space is part of a surface, without arcs".into();
        }
        json
    }

    /// Reason why the answer is not what was asked for.
    pub(super) fn refusal(&self) -> Option<&Warning> {
        self.failure.as_ref().or(self.shortfall.as_ref())
    }

    /// Returns the advice that the text gives, in one line for all warnings; what is no solution has its own.
    fn remedy(&self) -> Option<String> {
        let of_end = self.refusal().into_iter().flat_map(|failure| failure.remedies.clone());
        let of_warnings =
            if self.failure.is_some() { Vec::new() } else { remedies(&self.warnings) };
        let all: Vec<_> = of_end.chain(of_warnings).collect();
        (!all.is_empty()).then(|| combined(&all))
    }

    /// Returns the answer, then how it was found; with `recover`, the recovered solution is part of the answer.
    pub(super) fn text(&self, request: &Request, recover: bool) -> String {
        let levels = request.problem.levels();
        let (name, f) = (&request.name, levels.f());
        let integral = plain(levels.integrals().of_f, 4);
        let mut text = format!("{name}: f = {f}, integral {integral}\n");
        if self.failure.is_some() {
            text += "not a solution, but where the solver ended:\n";
        }
        text += &self.solution(request, recover);
        text += &self.method(request);
        text + &advice::lines(&self.warnings, self.failure.is_some())
    }

    /// Returns what was asked for: the energy with its bounds, v, and the contact.
    fn solution(&self, request: &Request, recover: bool) -> String {
        let (problem, levels) = (&request.problem, request.problem.levels());
        let (last, law, integral) = (self.last(), problem.law(), levels.integrals().of_f);
        let mut text = self.energy_in_words(request);
        if !last.verdict().is_failure() || request.accuracy().is_some() {
            text += &bound::text(&self.bounds, problem, recover);
        }
        if let Some(KnownErrors { values, multiplier_l2 }) = &self.errors {
            let Errors { l2, h1, max, .. } = values;
            let [l2, h1, max] = [*l2, *h1, *max].map(|error| plain(error, 3));
            text += &format!("errors: L2 {l2}, H1 {h1}, nodes {max}");
            if let Some(multiplier_l2) = multiplier_l2 {
                text += &format!("; multiplier L2 {}", plain(*multiplier_l2, 3));
            }
            text.push('\n');
        }
        let [least, greatest] = last.range.map(|v| plain(v, 6));
        text += &format!("v from {least} to {greatest}\n");
        let arcs = self.contact.as_deref().unwrap_or_default();
        text += &self.states.text(law);
        let parts = levels.parts_in_contact(&self.run.judgement);
        if let Some(parts) = parts.as_ref().filter(|parts| arcs.is_empty() && !parts.is_empty()) {
            text += &format!(", on {parts}");
        }
        if arcs.iter().any(|arc| !arc.closed) {
            let curves = levels.curves().map_or(0, |curves| curves.len());
            text += if curves > 1 {
                "; arcs with the domain on the left"
            } else {
                "; arcs anticlockwise"
            };
        }
        text.push('\n');
        let words = BoundaryWords::of(law);
        for arc in arcs {
            let part = arc.part.clone().filter(|_| parts.is_some());
            text += &words.arc(&ContactArc { part, ..arc.clone() }, levels.integrals(), 6);
        }
        text += &words.force([self.force, 0.0 - integral], levels.integrals(), 6);
        if levels.has_fixed_part() {
            text += "fixed parts carry the difference\n";
        }
        if self.load_misses(request) {
            let minus_sum = plain(0.0 - last.sum_load, 6);
            text += &format!("minus the sum of the load {minus_sum}\n");
        }
        text
    }

    /// Returns how the answer was found: the solver with its settings, the levels, and the time.
    fn method(&self, request: &Request) -> String {
        let mut settings = vec![format!("solver {}", request.solver())];
        settings.extend(request.refined());
        for (name, value) in request.settings() {
            settings.push(match (value.as_str(), value.as_f64()) {
                (Some(text), _) => format!("{name} {text}"),
                (None, Some(number)) => format!("{name} {}", Written(number)),
                (None, None) => format!("{name} {value}"),
            });
        }
        let mut text = paragraph(&settings.join(", ")) + "\n";
        if !request.overridden.is_empty() {
            text += &format!("not as in the scene: {}\n", request.overridden.join(", "));
        }
        text += &self.table(request);
        if let Some(meshes) = request.adapted {
            text += &meshes.text();
        }
        let cost = match request.solver() {
            Solver::Multigrid => format!(" ({:.1} sweeps)", self.last().end.work_units),
            _ => String::new(),
        };
        let setup = if request.problem.levels().cells(0).is_some() { "setup" } else { "mesh" };
        text + &request.clock.text(setup, &cost)
    }

    fn table(&self, request: &Request) -> String {
        let (ends, levels) = (&self.run.ends, request.problem.levels());
        // An iteration of Arrow-Hurwicz is one sweep: a column of sweeps would repeat that of iterations.
        let nested = request.solver().is_nested()
            && ends.iter().any(|outcome| outcome.end.sweeps() > outcome.end.iterations);
        let first = if levels.cells(0).is_some() { "grid" } else { "mesh" };
        let mut head = vec![first, "iterations", "stop", "energy", "KKT residual", "relative"];
        if nested {
            head.insert(2, "sweeps");
        }
        let mut rows = Vec::new();
        for outcome in ends {
            let mut row = vec![
                outcome.label(),
                outcome.end.iterations.to_string(),
                match request.adapted {
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

/// Outcome of a solver on the level with this number, as JSON.
fn outcome_json(solver: Solver, level: usize, outcome: &Outcome) -> Value {
    let mut json = json!({
        "iterations": outcome.end.iterations,
        "stop": outcome.name(),
        "energy": outcome.energy,
        "sum_load": outcome.sum_load,
        "nodes": outcome.nodes,
        // On a coarse grid the natural residual is enough.
        "kkt": { "natural": outcome.kkt.natural, "relative": outcome.kkt.relative },
    });
    match outcome.cells {
        Some(cells) => json["cells"] = cells.into(),
        None => json["refinement"] = level.into(),
    }
    if solver.is_nested() {
        json["sweeps"] = outcome.end.sweeps().into();
    }
    json
}
