//! The statement that fields make.

use super::Fields;
use super::names::check_names;
use super::table::{FIELDS, Reading, Refused, Voice};
use signorini_mathematics::problem::law::LawParameter;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{SaddleSettings, Solver};
use signorini_mathematics::statement::{Domain, Fineness, Statement};

impl Fields {
    /// Domain, f and law that are given, with all else as usual.
    pub(crate) fn usual(&self, voice: Voice) -> Reading<Statement> {
        let name = self.domain.name.as_ref();
        let domain = self.domain(name.map_or_else(Domain::square, Domain::named), voice)?;
        let f = self.f.as_deref().ok_or_else(|| Refused::new("f", "`f` is missing; add it"))?;
        let f = f_on(&domain, f, voice)?;
        Ok(Statement { law: self.law(voice)?, ..Statement::usual(domain, f) })
    }

    /// The statement of a scene with the f, the law and the parts that are given in place of its own.
    fn other_problem(&self, scene: Statement, voice: Voice) -> Reading<Statement> {
        let domain = self.domain(scene.domain, voice)?;
        let f = self.f.as_deref().map(|f| f_on(&domain, f, voice)).transpose()?;
        let law = self.law(voice)?.or(scene.law);
        Ok(Statement { f: f.unwrap_or(scene.f), law, domain, ..scene })
    }

    /// The statement with what these fields change in it.
    ///
    /// # Errors
    /// [`Refused`] if they do not go with it, or with each other, or have values that no statement has.
    pub(crate) fn over(&self, base: Statement, voice: Voice) -> Reading<Statement> {
        let solver = self.solver_over(&base, voice);
        self.check(voice, &base.domain, solver)?;
        let base = if voice == Voice::OverScene { self.other_problem(base, voice)? } else { base };
        if !solver.entry().in_space && base.domain.is_built_in_space() {
            let given = voice.with_value("solver", solver.entry().name);
            let text =
                format!("{given} is for domains in the plane; choose another, or leave it out");
            return Err(Refused::new("solver", text));
        }
        let fineness = self.fineness_over(&base, solver, voice)?;
        let load = base.load.filter(|_| solver != Solver::Spectral);
        // An accuracy concerns the solution for f, whatever load a scene takes; with the bilinear one bounds are
        // closest.
        let of_accuracy = self.accuracy().and(load.map(|_| Statement::LOAD));
        let saddle = base.saddle.unwrap_or_default();
        let saddle = solver.is_nested().then(|| self.saddle_over(saddle, voice)).transpose()?;
        let keeps = self.accuracy().is_none() && self.stop.is_none();
        let tolerance = self.tolerance.or(base.tolerance.filter(|_| keeps));
        positive("tolerance", tolerance, "1e-8", voice)?;
        Ok(Statement {
            fineness,
            solver,
            load: self.load.or(of_accuracy).or(load),
            saddle,
            tolerance: tolerance.filter(|_| solver == Solver::Multigrid || solver.is_nested()),
            ..base
        })
    }

    /// The domain with the parts and curves that are given in place of its own.
    fn domain(&self, mut domain: Domain, voice: Voice) -> Reading<Domain> {
        let of = &self.domain;
        let lists = [&of.free, &of.fixed, &of.curve];
        let is_about_mesh = of.refine.is_some() || lists.iter().any(|list| !list.is_empty());
        if voice == Voice::Keys && of.name.is_none() && is_about_mesh {
            let text = "missing field `name` of `domain`, which has no meshes without it; add it";
            return Err(Refused::new("domain", text));
        }
        // A part that one option names is no longer of the other kind.
        domain.free.retain(|part| !of.fixed.contains(part));
        domain.fixed.retain(|part| !of.free.contains(part));
        for (own, given) in [(&mut domain.free, &of.free), (&mut domain.fixed, &of.fixed)] {
            if !given.is_empty() {
                own.clone_from(given);
            }
        }
        if !of.curve.is_empty() {
            domain.curve.clear();
        }
        for text in &of.curve {
            let (part, numbers) = curve(text, voice)?;
            if domain.curve.insert(part, numbers).is_some() {
                let given = voice.with_value("curve", text);
                let text = format!("{given}: the part has one already; name it once");
                return Err(Refused::new("curve", text));
            }
        }
        Ok(domain)
    }

    fn law(&self, voice: Voice) -> Reading<Option<LawParameter>> {
        positive("friction", self.law.friction, "0.3", voice)?;
        positive("limit", self.law.limit, "0.3", voice)?;
        let limit = self.law.limit.map(LawParameter::Limit);
        Ok(self.law.friction.map(LawParameter::Friction).or(limit))
    }

    /// Solver that is given, or else that of the statement; among options, that for an accuracy, or the paper's for
    /// what only saddle-point methods take.
    fn solver_over(&self, base: &Statement, voice: Voice) -> Solver {
        let of_saddle = self.r.is_some() || self.stop.is_some() || self.max_iterations.is_some();
        match self.solver {
            Some(solver) => solver,
            None if voice == Voice::Keys => base.solver,
            None if self.accuracy().is_some() => Solver::Multigrid,
            None if of_saddle && !base.solver.is_nested() => Solver::ArrowHurwicz,
            None => base.solver,
        }
    }

    fn fineness_over(&self, base: &Statement, solver: Solver, voice: Voice) -> Reading<Fineness> {
        if let Some(accuracy) = self.accuracy() {
            let wanted = accuracy.wanted();
            if wanted > 0.0 && wanted < 1.0 {
                return Ok(Fineness::Within(accuracy));
            }
            let (field, example) = match self.accuracy {
                Some(_) => ("accuracy", "1e-3 for an error of 0.1 % in the energy norm"),
                None => ("accuracy_energy", "1e-6 for six digits of the energy"),
            };
            let asked = voice.accuracy(accuracy);
            return Err(Refused::new(
                field,
                format!("{asked}: must be between 0 and 1, e.g. {example}"),
            ));
        }
        if let Some(cells) = &self.grids {
            return Ok(Fineness::Grids(cells.clone()));
        }
        if let Some(h) = &self.h {
            let finest = cells(h, voice)?;
            return Ok(match &base.fineness {
                Fineness::Grids(_) => base.fineness.with_finest(finest),
                _ => Fineness::Width(finest),
            });
        }
        if let Some(times) = self.domain.refine {
            return Ok(Fineness::Refined(times));
        }
        let keeps = solver == Solver::Multigrid && self.tolerance.is_none();
        Ok(match base.fineness {
            Fineness::Within(_) if !keeps => Fineness::Usual,
            _ => base.fineness.clone(),
        })
    }

    fn saddle_over(&self, base: SaddleSettings, voice: Voice) -> Reading<SaddleSettings> {
        for &r in self.r.iter().flatten() {
            check_r(r)?;
        }
        if self.max_iterations == Some(0) {
            let text = format!("{} must be at least 1", voice.name("max_iterations"));
            return Err(Refused::new("max_iterations", text));
        }
        let stop = self.stop_rules(voice)?;
        Ok(SaddleSettings {
            prolongation: self.prolongation.unwrap_or(base.prolongation),
            r: self.draw_r.or(middle(self.r.as_deref())).unwrap_or(base.r),
            stop: stop.and_then(|rules| rules.first().copied()).unwrap_or(base.stop),
            max_iterations: self.max_iterations.map_or(base.max_iterations, |n| n as usize),
        })
    }

    /// Stopping rules that are given.
    pub(crate) fn stop_rules(&self, voice: Voice) -> Reading<Option<Vec<StopRule>>> {
        let Some(names) = &self.stop else { return Ok(None) };
        let mut rules = Vec::new();
        for name in names {
            rules.push(StopRule::named(name).ok_or_else(|| {
                let all = StopRule::ALL.map(StopRule::name).join(", ");
                let stop = voice.name("stop");
                Refused::new("stop", format!("{stop}: no rule `{name}`; choose one of {all}"))
            })?);
        }
        Ok(Some(rules))
    }
}

/// Reads f on a domain, on the square as far as it can be without a mesh.
fn f_on(domain: &Domain, f: &str, voice: Voice) -> Reading<String> {
    check_names(f)?;
    Ok(match domain.is_square() {
        true => {
            let read = f.parse::<Source>();
            let place = if voice == Voice::Keys { "" } else { "--f: " };
            read.map_err(|e| Refused::new("f", format!("{place}{e}")))?.to_string()
        }
        // Names of regions may have spaces.
        false if f.contains('"') => f.trim().to_owned(),
        false => f.split_whitespace().collect::<Vec<_>>().join(" "),
    })
}

/// The middle one of some numbers.
fn middle(numbers: Option<&[f64]>) -> Option<f64> {
    numbers.and_then(|numbers| numbers.get(numbers.len() / 2).copied())
}

/// Checks that r is a positive number that the name of a task can show without an exponent.
fn check_r(r: f64) -> Reading<()> {
    if (1e-12..=1e12).contains(&r) {
        return Ok(());
    }
    let text = "must be a positive number from 1e-12 to 1e12; the paper takes 0.5 to 1e6";
    Err(Refused::new("r", format!("r = {r:?} {text}")))
}

/// Refuses a number that is not positive and finite.
fn positive(field: &'static str, value: Option<f64>, example: &str, voice: Voice) -> Reading<()> {
    match value.filter(|value| !(*value > 0.0 && value.is_finite())) {
        None => Ok(()),
        Some(value) => {
            let given = voice.with_value(field, &value.to_string());
            let example = voice.with_value(field, example);
            Err(Refused::new(field, format!("{given}: must be a positive number, e.g. {example}")))
        }
    }
}

/// Reads `PART=NUMBERS`: a part of the boundary, and the numbers of the curve on which it lies.
fn curve(text: &str, voice: Voice) -> Reading<(String, Vec<f64>)> {
    // A name may have the sign.
    let read = text.rsplit_once('=').and_then(|(part, numbers)| {
        let numbers = numbers.split(',').map(|number| number.trim().parse().ok());
        Some((part.trim().to_owned(), numbers.collect::<Option<_>>()?))
    });
    read.ok_or_else(|| {
        let given = voice.with_value("curve", text);
        let remedy =
            "write PART=NUMBERS, e.g. hole=0,0,0.3 for a circle of radius 0.3 around (0, 0)";
        Refused::new("curve", format!("{given}: {remedy}"))
    })
}

/// Reads the cells per side from `1/N`, `N`, or a decimal that is one over an integer.
fn cells(h: &str, voice: Voice) -> Reading<usize> {
    let whole = h.strip_prefix("1/").unwrap_or(h).parse().ok();
    whole.or_else(|| cells_of_width(h.parse().ok()?)).filter(|n| *n > 0).ok_or_else(|| {
        let given = voice.with_value("h", h);
        Refused::new("h", format!("{given}: write the width as 1/N, such as 1/256, or as N"))
    })
}

/// Returns the integer whose reciprocal is the width, or is nearest to it.
fn cells_of_width(width: f64) -> Option<usize> {
    let n = (1.0 / width).round();
    (width > 0.0 && (n * width == 1.0 || 1.0 / n == width)).then_some(n as usize)
}

/// True if a statement has the problem of a scene, whatever solves it and how fine.
pub(crate) fn is_problem_of(scene: &Statement, asked: &Statement) -> bool {
    let mut of_problem = FIELDS.iter().filter(|field| field.is_of_problem);
    of_problem.all(|field| field.differing([scene, asked]).is_none())
}

/// Returns, in words, what a statement has in place of that of a scene, but for fields that vary.
pub(crate) fn overridden(
    of_scene: &Statement,
    asked: &Statement,
    varied: &[String],
) -> Vec<String> {
    let (varied, others): (Vec<_>, Vec<_>) =
        FIELDS.iter().partition(|field| varied.iter().any(|name| name == field.name));
    let ([name, new], [other, old]) = (fineness_in_words(asked), fineness_in_words(of_scene));
    let varies_fineness = varied.iter().any(|field| field.is_about_fineness());
    let mut fineness = match name == other {
        _ if varies_fineness || [&name, &new] == [&other, &old] => None,
        true => Some(format!("{name} {new} instead of {old}")),
        false => Some(format!("{name} {new} instead of {other} {old}")),
    };
    let mut all = Vec::new();
    for field in others {
        if field.is_about_fineness() {
            // All fields that say how fine have one line.
            all.extend(fineness.take());
        } else if let Some([new, old]) = field.differing([asked, of_scene]) {
            all.push(format!("{} {new} instead of {old}", field.name.replace('_', "-")));
        }
    }
    all
}

/// Returns the fineness of a statement in words: its name and its value.
fn fineness_in_words(statement: &Statement) -> [String; 2] {
    let fineness = &statement.fineness;
    match fineness {
        Fineness::Usual if !statement.domain.is_square() => ["refine".into(), "as usual".into()],
        Fineness::Usual | Fineness::Grids(_) | Fineness::Width(_) => {
            let finest = fineness.cells().last().copied().unwrap_or_default();
            ["finest grid".into(), format!("1/{finest}")]
        }
        Fineness::Refined(_) | Fineness::Within(_) => {
            [fineness.field().replace('_', "-"), fineness.to_string()]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_are_read_and_refused() {
        let cells = |h: &str| cells(h, Voice::Options);
        assert_eq!(cells("1/256").unwrap(), 256);
        assert_eq!(cells("0.25").unwrap(), 4);
        assert_eq!(cells("128").unwrap(), 128);
        for n in 1..2000 {
            let width = (1.0 / n as f64).to_string();
            assert_eq!(cells(&width).unwrap(), n);
        }
        for wrong in
            ["2/3", "0.3", "-0.25", "nan", "1/x", "x", "0", "1/0", "", "99999999999999999999"]
        {
            assert!(cells(wrong).is_err(), "{wrong}");
        }
    }
}
