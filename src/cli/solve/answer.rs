//! What came out and what it is worth: judged apart from the solvers, as JSON and as text.

use super::bound;
use super::problem::Problem;
use crate::bounds::Bounds;
use crate::cli::output::columns;
use crate::discrete::contact::ContactArc;
use crate::discrete::kkt::{Judgement, Kkt};
use crate::discrete::norms::Errors;
use crate::replication::scene::shown_integral;
use crate::saddle::{Pair, tolerance};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Largest relative KKT residual, and largest sum of v r over the energy, of what may be called solved:
/// above, half of the load is out of balance.
const SOLVED: f64 = 0.5;
/// Above this relative KKT residual the answer carries a warning.
const ROUGH: f64 = 0.1;
/// Cells per side of the coarsest grid above which the grids are not what the stopping rule is made for.
const COARSE: usize = 8;

/// How a solver stopped on one grid.
#[derive(Serialize)]
pub(super) struct Level {
    pub cells: usize,
    pub iterations: usize,
    /// Gauss-Seidel sweeps, if they are what the solver does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweeps: Option<usize>,
    pub stop: String,
    pub energy: f64,
    pub sum_load: f64,
    #[serde(serialize_with = "natural")]
    pub kkt: Kkt,
}

/// Of a coarse grid, the natural residual says enough.
fn natural<S: serde::Serializer>(kkt: &Kkt, out: S) -> Result<S::Ok, S::Error> {
    json!({ "natural": kkt.natural, "relative": kkt.relative }).serialize(out)
}

pub(super) struct Solved {
    /// One entry per grid on which it stopped, coarsest first.
    pub levels: Vec<Level>,
    /// On the finest grid.
    pub pair: Pair,
    /// What it is worth.
    pub judgement: Judgement,
    /// Cost in sweeps of the finest grid, if the solver counts it.
    pub work_units: Option<f64>,
}

pub(super) struct Answer {
    pub solved: Solved,
    /// The sum of v r over the boundary, r the gradient of the energy: zero at the solution, and elsewhere,
    /// if all other conditions hold, a bound of the energy's error.
    complementarity: f64,
    /// Boundary nodes in contact, and all.
    contact_nodes: [usize; 2],
    /// With ends estimated within the cell; `None` on the cube.
    contact: Option<Vec<ContactArc>>,
    /// Of values, and of the multiplier in L2 where it has a formula too.
    errors: Option<(Errors, Option<f64>)>,
    /// Guaranteed bounds, or why there are none.
    pub bounds: Result<Bounds, String>,
    /// For grids and load vectors, and for the solver.
    seconds: [f64; 2],
    warnings: Vec<String>,
    /// Why the answer is none, in a sentence with a remedy.
    pub failure: Option<String>,
}

impl Answer {
    pub(super) fn new(problem: &Problem, solved: Solved, load: &[f64], seconds: [f64; 2]) -> Self {
        let (n, y) = (problem.finest(), &solved.pair.y);
        let nodes = problem.domain.boundary(n);
        let Judgement { flux, .. } = &solved.judgement;
        let in_contact = solved.judgement.in_contact(nodes.iter().copied(), y);
        let mut answer = Self {
            complementarity: nodes.iter().zip(flux).map(|(&node, flux)| y[node] * flux).sum(),
            contact_nodes: [in_contact.into_iter().filter(|&of| of).count(), nodes.len()],
            contact: problem.domain.contact(n, y, &solved.judgement),
            errors: problem.domain.errors(n, y, load),
            bounds: problem.domain.bounds(n, y),
            solved,
            seconds,
            warnings: Vec::new(),
            failure: None,
        };
        answer.judge(problem);
        answer
    }

    fn last(&self) -> &Level {
        self.solved.levels.last().expect("at least one grid")
    }

    /// Decides whether the answer is one, and collects what else is to be known of it.
    fn judge(&mut self, problem: &Problem) {
        let last = self.solved.levels.len() - 1;
        let (name, finest) = (problem.name(), problem.finest());
        let Level { ref stop, kkt, energy, sum_load, .. } = self.solved.levels[last];
        let mut verdict = None;
        if sum_load >= 0.0 {
            verdict = Some("no-solution");
            self.failure = Some(problem.without_solution(sum_load));
        } else if stop.ends_with("-limit") {
            let remedy = if problem.solver.is_nested() {
                "raise --max-iterations, or use --solver multigrid"
            } else {
                "choose another --h"
            };
            self.failure =
                Some(format!("{name}: stopped at the {stop} on grid 1/{finest}; {remedy}"));
        } else if problem.accuracy.is_some() {
            // A guaranteed bound has been reached; residuals of single nodes take nothing from it.
        } else if let Some(why) = self.disagreement(kkt.relative, energy) {
            verdict = Some("not-solved");
            self.failure = Some(format!(
                "{name}: the solver stopped as asked on grid 1/{finest}, but {why}; {}",
                problem.closer()
            ));
        } else if kkt.relative > ROUGH {
            self.warnings.push(format!(
                "the KKT residual on grid 1/{finest} is {:.2} of the load; {}",
                kkt.relative,
                problem.closer()
            ));
        }
        if let Some(verdict) = verdict {
            self.solved.levels[last].stop = verdict.into();
        }
        self.warn_of_grids(problem);
        self.warn_of_load(problem, sum_load);
        if let (Ok(bounds), None) = (&self.bounds, problem.accuracy) {
            self.warnings.extend(bound::warnings(bounds, energy, problem.solver));
        }
        if !energy.is_finite() {
            self.warnings.push(
                "the energy grows with the square of f and is beyond double precision; scale f down".into(),
            );
        }
    }

    /// What the conditions of the solution say against an answer, from y and F alone.
    fn disagreement(&self, relative: f64, energy: f64) -> Option<String> {
        let gap = self.complementarity.abs();
        if relative.is_nan() || relative > SOLVED {
            Some(format!("the KKT residual is {relative:.2} of the load"))
        } else if energy > 0.0 {
            Some(format!("the energy {energy:.3e} is above that of v = 0"))
        } else if gap > SOLVED * energy.abs() && gap.is_normal() {
            Some(format!("the sum of v r is {gap:.3e}, beside an energy of {energy:.3e}"))
        } else {
            None
        }
    }

    fn warn_of_grids(&mut self, problem: &Problem) {
        let (coarsest, count) = (problem.grids[0], problem.grids.len());
        if problem.solver.is_nested() && coarsest > COARSE {
            let what = if count == 1 { "has no coarser ones" } else { "begins the nested grids" };
            self.warnings.push(format!(
                "grid 1/{coarsest} {what}, and the tolerance is 10^-k on the k-th grid, here {:e} on the last; choose 1/(2^k m), such as 1/64, or --solver multigrid",
                tolerance(count)
            ));
        }
        let coarse = &self.solved.levels[..self.solved.levels.len() - 1];
        let list = |which: &dyn Fn(&Level) -> bool| -> Option<String> {
            let of: Vec<_> =
                coarse.iter().filter(|l| which(l)).map(|l| format!("1/{}", l.cells)).collect();
            (!of.is_empty()).then(|| of.join(", "))
        };
        let unsolvable = list(&|level| level.sum_load >= 0.0).map(|grids| format!(
            "the load vector sums to a non-negative number on {grids}, where the discrete problem has no solution"
        ));
        let unmet = list(&|level| level.stop != "converged")
            .map(|grids| format!("the stopping rule was not met on {grids}"));
        self.warnings.extend([unsolvable, unmet].into_iter().flatten());
    }

    /// Where the load vector is that of another f.
    fn warn_of_load(&mut self, problem: &Problem, sum_load: f64) {
        let (integral, n) = (problem.integral, problem.finest());
        if problem.domain.load_slack(n).is_some_and(|slack| (sum_load - integral).abs() > slack) {
            self.warnings.push(format!(
                "the load vector sums to {sum_load:+.3e} on grid 1/{n}, the integral of f is {integral:+.3e}: values at the nodes miss where f jumps; --load exact does not"
            ));
        }
    }

    pub(super) fn json(&self, problem: &Problem) -> Value {
        let last = self.last();
        let (n, kkt, bounds) = (problem.finest(), last.kkt, self.bounds.as_ref().ok());
        let per_grid = |of: fn(&Level) -> Option<usize>| -> Vec<usize> {
            self.solved.levels.iter().filter_map(of).collect()
        };
        let mut json = json!({
            "schema": 1,
            "scene": problem.name(),
            "f": problem.domain.f(),
            "dimension": problem.domain.dimension(),
            "solver": problem.solver,
            "settings": problem.settings().into_iter().collect::<BTreeMap<_, _>>(),
            "not_as_in_scene": problem.overridden,
            "h": 1.0 / n as f64,
            "unknowns": self.solved.pair.y.len(),
            "iterations": last.iterations,
            "iterations_per_grid": per_grid(|level| Some(level.iterations)),
            "stop": last.stop,
            "grids": self.solved.levels,
            "energy": last.energy,
            "integral_f": problem.integral,
            "sum_load": last.sum_load,
            "kkt": {
                "stationarity": kkt.stationarity,
                "min_y": kkt.min_y,
                "min_lambda": kkt.min_lambda,
                "complementarity": self.complementarity,
                "max_min": kkt.complementarity,
                "natural": kkt.natural,
                "relative": kkt.relative,
            },
            "contact_nodes": { "nodes": self.contact_nodes[0], "boundary_nodes": self.contact_nodes[1] },
            "bound": bounds.map(|of| {
                json!({
                    "energy": of.energy,
                    "error": of.error,
                    "recovered": of.recovered,
                    "relative": { "energy": of.relative_energy(), "error": of.relative() },
                })
            }),
            "contact": self.contact,
            "warnings": problem.warnings.iter().chain(&self.warnings).collect::<Vec<_>>(),
            "seconds": { "setup": self.seconds[0], "solve": self.seconds[1] },
        });
        if let Some(sweeps) = last.sweeps {
            json["sweeps"] = sweeps.into();
            json["sweeps_per_grid"] = per_grid(|level| level.sweeps).into();
        }
        if let Some(work_units) = self.solved.work_units {
            json["work_units"] = work_units.into();
        }
        if let Some((errors, multiplier)) = &self.errors {
            json["errors"] = json!(errors);
            if let Some(multiplier) = multiplier {
                json["errors"]["multiplier_l2"] = (*multiplier).into();
            }
        }
        if let Err(reason) = &self.bounds {
            json["bound_reason"] = reason.as_str().into();
        }
        json
    }

    pub(super) fn text(&self, problem: &Problem) -> String {
        let name = if problem.domain.dimension() == 3 { "cube" } else { problem.name() };
        let (f, integral) = (problem.domain.f(), shown_integral(problem.integral));
        let mut text = format!("{name}: f = {f}, integral {integral}\n");
        let settings = problem.settings().into_iter().map(|(name, value)| match value {
            Value::String(text) => format!("{name} {text}"),
            value => format!("{name} {value}"),
        });
        let settings: Vec<_> = settings.collect();
        if !settings.is_empty() {
            text += &format!("{}\n", settings.join(", "));
        }
        if !problem.overridden.is_empty() {
            text += &format!("not as in the scene: {}\n", problem.overridden.join(", "));
        }
        text += &self.table();
        text += &format!("solved in {:.3} s", self.seconds[1]);
        if let Some(work_units) = self.solved.work_units {
            text += &format!(", the cost of {work_units:.1} sweeps");
        }
        let [nodes, all] = self.contact_nodes;
        text += &format!("\ncontact in {nodes} of {all} boundary nodes\n");
        self.contact.iter().flatten().for_each(|arc| text += &bound::contact(arc, 6));
        if let Some((e, multiplier)) = &self.errors {
            text += &format!("errors: L2 {:.2e}, H1 {:.2e}, nodes {:.2e}", e.l2, e.h1, e.max);
            if let Some(multiplier) = multiplier {
                text += &format!("; multiplier L2 {multiplier:.2e}");
            }
            text.push('\n');
        }
        text += &bound::text(&self.bounds, self.errors.is_some());
        self.warnings.iter().for_each(|warning| text += &format!("warning: {warning}\n"));
        text
    }

    fn table(&self) -> String {
        let levels = &self.solved.levels;
        // One sweep to an iteration is what Arrow-Hurwicz means; a column would only repeat it.
        let nested = levels.iter().any(|o| o.sweeps.is_some_and(|sweeps| sweeps > o.iterations));
        let mut head = vec!["grid", "iterations", "stop", "energy", "KKT residual", "relative"];
        let row = |level: &Level| {
            let mut row = vec![
                format!("1/{}", level.cells),
                level.iterations.to_string(),
                level.stop.clone(),
                format!("{:.6e}", level.energy),
                format!("{:.2e}", level.kkt.natural),
                format!("{:.2e}", level.kkt.relative),
            ];
            if nested {
                row.insert(2, level.sweeps.unwrap_or(level.iterations).to_string());
            }
            row
        };
        if nested {
            head.insert(2, "sweeps");
        }
        columns(&head, &[], levels.iter().map(row).collect())
    }
}
