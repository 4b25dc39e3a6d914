//! Scenes from TOML: the statements that the keys of a file make.

use super::Scene;
use super::check::check_on_domain;
use super::keys::{SCENE_KEYS, SceneKeys};
use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Result, from_toml};
use crate::replication::fields::Fields;
use crate::replication::fields::lists::{EXAMPLE, Products, Varied};
use crate::replication::fields::member::Member;
use crate::replication::fields::table::{Reading, Refused, Voice};
use crate::replication::fields::vary::{VARY, Vary};
use crate::replication::output::Output;
use crate::replication::study::Study;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{SaddleSettings, Solver};
use signorini_mathematics::statement::{Domain, Statement};
use toml::{Table, Value};

/// Duality parameters of the published tables.
const PAPERS_R: [f64; 5] = [1e6, 10.0, 5.0, 1.0, 0.5];

impl Scene {
    /// Parses and validates the text of a scene file; `name` names the scene in messages.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake. [`Scene::check`] tells whether there is a problem to be solved.
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        let what = format!("scene `{name}`");
        let mut given: Table = from_toml(&what, text)?;
        given.retain(|key, _| !SCENE_KEYS.contains(&key));
        let short = short_lists(&mut given);
        let fields = Fields::of_keys(given, &SCENE_KEYS).map_err(|e| in_file(&what, text, e))?;
        let scene = Self::of(name, from_toml(&what, text)?, &fields, short);
        scene.and_then(Self::complete).map_err(|e| in_file(&what, text, e))
    }

    /// The scene of these keys, with fields of its statement, of which lists are `vary` written short.
    fn of(name: &str, mut keys: SceneKeys, fields: &Fields, short: Vec<Varied>) -> Reading<Self> {
        let (is_study, is_papers) = (keys.vary.is_some(), keys.paper_table.is_some());
        let mut lists = short;
        let mut base = Statement::usual(Domain::square(), "");
        if is_papers {
            check_papers(fields, is_study)?;
            base = of_the_tables(base);
            if !fields.has("r") && lists.iter().all(|list| list.name != "r") {
                lists
                    .push(Varied { name: "r".into(), values: PAPERS_R.map(Value::Float).to_vec() });
            }
        }
        let Products(mut products) = keys.vary.take().unwrap_or(Products(vec![Vec::new()]));
        let key = lists.last().filter(|_| !is_study).map_or(VARY, |list| &list.name);
        products.iter_mut().for_each(|product| product.extend(lists.iter().cloned()));
        let vary = Vary::of(&products, key).map_err(|reason| Refused::new(key, reason))?;
        if is_study && vary.names.is_empty() {
            return Err(Refused::new(key, format!("nothing is varied; write {EXAMPLE}")));
        }
        let members = vary.members(fields, Voice::Keys, |fields| {
            let statement = fields.over(base.clone(), Voice::Keys)?;
            check_on_domain(&statement, &keys)?;
            Ok(statement)
        })?;
        keys.check_outputs(is_study)?;
        let mut study = Study::of(&vary.names, members);
        if is_study && keys.outputs.contains(&Output::Chart) {
            study.chart = Some(study.axes(keys.chart.as_ref())?);
        }
        study.columns = study.columns(keys.columns.as_deref())?;
        let shown = match is_study {
            true => &study.members[0],
            false => drawn(&study.members, keys.draw_r)?,
        };
        Ok(Self {
            name: name.to_owned(),
            title: keys.title,
            paper_table: keys.paper_table,
            statement: shown.statement.clone(),
            study,
            is_study,
            picture: keys.picture,
            outputs: keys.outputs,
            files: InputFiles::new(),
        })
    }
}

/// Error of a scene, with the line of the key.
fn in_file(what: &str, text: &str, Refused { field, text: why }: Refused) -> Error {
    let line = line_of(&field, text).map_or(String::new(), |line| format!("line {line}: "));
    Error::input(format!("{what}: {line}{why}"))
}

/// Refuses a study, and another solver, for a published table.
fn check_papers(fields: &Fields, is_study: bool) -> Reading<()> {
    let papers = Solver::ArrowHurwicz;
    if is_study {
        let text =
            "the published tables are of one problem each; leave out `vary`, or `paper_table`";
        return Err(Refused::new("vary", text));
    }
    match fields.text("solver").filter(|solver| *solver != papers.entry().name) {
        None => Ok(()),
        Some(solver) => Err(Refused::new(
            "solver",
            format!(
                "the published tables are those of {papers}; leave out solver = \"{solver}\", or `paper_table`"
            ),
        )),
    }
}

/// Takes lists of rules and r from keys, which are `vary` written short.
fn short_lists(given: &mut Table) -> Vec<Varied> {
    let mut lists = Vec::new();
    for name in ["stop", "r"] {
        match given.remove(name) {
            Some(Value::Array(values)) if values.len() != 1 => {
                lists.push(Varied { name: name.to_owned(), values });
            }
            other => given.extend(other.map(|value| (name.to_owned(), value))),
        }
    }
    lists
}

/// The member that is drawn: under the first rule the one with this r, or else with the middle one.
fn drawn(members: &[Member], draw_r: Option<f64>) -> Reading<&Member> {
    let first: Vec<_> =
        members.iter().filter(|member| member.rule() == members[0].rule()).collect();
    let Some(r) = draw_r else { return Ok(first[first.len() / 2]) };
    first.into_iter().find(|member| member.r() == Some(r)).ok_or_else(|| {
        Refused::new("draw_r", format!("`draw_r` = {r} is not among `r`; add it there"))
    })
}

/// The statement with what a published table has in place of the usual.
fn of_the_tables(usual: Statement) -> Statement {
    let saddle = SaddleSettings { stop: StopRule::Signed, ..SaddleSettings::default() };
    let solver = Solver::ArrowHurwicz;
    Statement { solver, load: Some(LoadRule::default()), saddle: Some(saddle), ..usual }
}

/// Returns the number of the line of a text in TOML on which a key stands, if it is written plainly.
fn line_of(key: &str, text: &str) -> Option<usize> {
    let is_there = |line: &str| {
        let mut words = line.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        line.contains('=') && words.any(|word| word == key)
    };
    let begins = |line: &str| {
        line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    let mut lines = text.lines();
    let place = lines.position(begins).or_else(|| text.lines().position(is_there));
    place.map(|line| line + 1)
}
