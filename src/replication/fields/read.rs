//! The statement that fields make.

use super::Fields;
use super::names::{NAMED, check_names, without_values};
use super::parts::{names, one_line};
use super::table::{FIELDS, Field, Reading, Refused, Voice, without_accuracy};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::solvers::Solver;
use signorini_mathematics::statement::{Domain, Fineness, Statement, StatementError};

impl Fields {
    /// The statement of these fields, with all else as usual.
    ///
    /// # Errors
    /// As [`Fields::over`].
    pub(crate) fn stated(&self, voice: Voice) -> Reading<Statement> {
        self.over(Statement::usual(Domain::square(), ""), voice)
    }

    /// The statement with what these fields change in it; f has to be among them, unless it is that of a scene.
    ///
    /// # Errors
    /// [`Refused`] if they do not go with it, or with each other, or have values that no statement has.
    pub(crate) fn over(&self, base: Statement, voice: Voice) -> Reading<Statement> {
        if voice != Voice::OverScene && !self.has("f") {
            return Err(Refused::new("f", "`f` is missing; add it"));
        }
        let mut of = Statement { solver: self.usual_solver(&base, voice), ..base };
        // What else may be given depends on these.
        let (first, others): (Vec<_>, Vec<_>) =
            FIELDS.iter().partition(|field| field.decides_others());
        for field in first {
            of = self.give(field, of, voice)?;
        }
        let (solver, has_grids) = (of.solver, of.has_grids());
        self.check(voice, &of)?;
        for part in [""].into_iter().chain(of.boundary.names()) {
            of.boundary.law(part).map_err(|e| match &e {
                StatementError::Field { field, .. } => Refused::new(field, voice.sentence(&e)),
                _ => Refused::new("law", e.to_string()),
            })?;
        }
        if !solver.entry().in_space && of.domain.is_built_in_space() {
            let given = voice.with_value("solver", solver.entry().name);
            let text =
                format!("{given} is for domains in the plane; choose another, or leave it out");
            return Err(Refused::new("solver", text));
        }
        of.load = of.load.or(Some(Statement::LOAD));
        of.load = of.load.filter(|_| has_grids && solver != Solver::Spectral);
        let mut saddle = of.saddle.unwrap_or_default();
        if !has_grids {
            saddle.prolongation = <_>::default();
            of.fineness = of.fineness.on_meshes();
        }
        of.saddle = solver.is_nested().then_some(saddle);
        of.tolerance = of.tolerance.filter(|_| solver == Solver::Multigrid || solver.is_nested());
        if solver != Solver::Multigrid {
            of.fineness = without_accuracy(of.fineness);
        }
        for field in others {
            of = self.give(field, of, voice)?;
        }
        if self.has("f") {
            of.f = f_on(has_grids, &of.f, voice)?;
        }
        Ok(of)
    }

    /// The statement with the value of a field, if it is given.
    fn give(&self, field: &Field, of: Statement, voice: Voice) -> Reading<Statement> {
        let Some(given) = self.0.get(field.name) else { return Ok(of) };
        let named = given.iter().find_map(|text| field.named_in(text));
        if let Some(name) = named.and_then(|(_, number)| names(number).next()) {
            return Err(without_values(field.name, name));
        }
        if NAMED.contains(&field.name) {
            check_names(field.name, &given.concat())?;
        }
        (field.set)(of, given).map_err(|reason| {
            let given = voice.with_value(field.name, &given.join(" "));
            Refused::new(field.name, format!("{given}: {reason}"))
        })
    }

    /// Solver, unless one is given: that of the statement or, among options, that for an accuracy, or the paper's for
    /// what only saddle-point methods take.
    fn usual_solver(&self, base: &Statement, voice: Voice) -> Solver {
        let [is_within, is_saddle] =
            [&["accuracy", "accuracy_energy"][..], &["r", "stop", "max_iterations"]]
                .map(|names| names.iter().any(|name| self.has(name)));
        match base.solver {
            own if voice == Voice::Keys => own,
            _ if is_within => Solver::Multigrid,
            own if is_saddle && !own.is_nested() => Solver::ArrowHurwicz,
            own => own,
        }
    }
}

/// Reads f, on grids as far as it can be without a mesh.
fn f_on(has_grids: bool, f: &str, voice: Voice) -> Reading<String> {
    Ok(match has_grids {
        true => {
            let read = f.parse::<Source>();
            let place = if voice == Voice::Keys { "" } else { "--f: " };
            read.map_err(|e| Refused::new("f", format!("{place}{e}")))?.to_string()
        }
        false => one_line(f),
    })
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
