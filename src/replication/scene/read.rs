//! Scenes from TOML: the statement that the keys of a file make or, of a study, those of its members.

use super::Scene;
use crate::pipeline::InputFiles;
use crate::pipeline::error::{Error, Result, from_toml};
use crate::replication::fields::Fields;
use crate::replication::fields::lists::repeated;
use crate::replication::fields::table::{Reading, Refused, Voice, field};
use crate::replication::limits;
use crate::replication::output::Output;
use crate::replication::study::Study;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{SaddleSettings, Solver};
use signorini_mathematics::statement::Statement;

/// Duality parameters of the published tables.
const PAPERS_R: [f64; 5] = [1e6, 10.0, 5.0, 1.0, 0.5];

impl Scene {
    /// Parses and validates the text of a scene file; `name` names the scene in messages.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake. [`Scene::check`] tells whether there is a problem to be solved.
    pub fn parse(name: &str, text: &str) -> Result<Self> {
        let what = format!("scene `{name}`");
        let fields: Fields = from_toml(&what, text).map_err(with_table)?;
        let scene = match fields.vary {
            Some(_) => Self::of_study(name, &fields),
            None => Self::of(name, &fields),
        };
        let scene = scene.and_then(|scene| scene.check_outputs(&fields)?.complete());
        scene.map_err(|Refused { field, text: why }| {
            let line = line_of(field, text).map_or(String::new(), |line| format!("line {line}: "));
            Error::input(format!("{what}: {line}{why}"))
        })
    }

    /// The scene that these fields make, before it is checked as a whole.
    fn of(name: &str, fields: &Fields) -> Reading<Self> {
        let missing = |field| Refused::new(field, format!("missing field `{field}`; add it"));
        let title = fields.title.clone().ok_or_else(|| missing("title"))?;
        let outputs = fields.outputs.clone().ok_or_else(|| missing("outputs"))?;
        let usual = fields.usual(Voice::Keys)?;
        let is_papers = fields.paper_table.is_some();
        let papers = Solver::ArrowHurwicz;
        if let Some(solver) = fields.solver.filter(|&solver| is_papers && solver != papers) {
            let text = format!(
                "the published tables are those of {papers}; leave out solver = \"{solver}\", or `paper_table`"
            );
            return Err(Refused::new("solver", text));
        }
        let base = if is_papers { of_the_tables(usual) } else { usual };
        let usual = base.saddle.unwrap_or_default();
        let statement = fields.over(base, Voice::Keys)?;
        let r = if is_papers { PAPERS_R.to_vec() } else { vec![usual.r] };
        let r = fields.r.clone().unwrap_or(r);
        let stop = fields.stop_rules(Voice::Keys)?.unwrap_or_else(|| vec![usual.stop]);
        Ok(Self {
            name: name.to_owned(),
            title,
            paper_table: fields.paper_table,
            study: expanded(&statement, &r, &stop)?,
            statement,
            is_study: false,
            picture: fields.picture.clone(),
            outputs,
            files: InputFiles::new(),
        })
    }

    /// The study that these fields make: of each member the statement, all else of the first.
    fn of_study(name: &str, fields: &Fields) -> Reading<Self> {
        let Some(vary) = &fields.vary else { return Self::of(name, fields) };
        if fields.paper_table.is_some() {
            let text =
                "the published tables are of one problem each; leave out `vary`, or `paper_table`";
            return Err(Refused::new("vary", text));
        }
        let mut first = None;
        let members = vary.members(fields, Voice::Keys, |fields| {
            let member = Self::of(name, fields).and_then(Self::of_one_member)?;
            let statement = member.statement.clone();
            first.get_or_insert(member);
            Ok(statement)
        })?;
        let first =
            first.ok_or_else(|| Refused::new("vary", "`vary` has no members; add values"))?;
        let mut study = Study::of(&vary.names, members);
        let is_drawn = first.wants(Output::Chart);
        study.chart = is_drawn.then(|| study.axes(fields.chart.as_ref())).transpose()?;
        study.columns = study.columns(fields.columns.as_deref())?;
        Ok(Self { study, is_study: true, ..first })
    }

    /// A member of a study, checked on its domain; it has one rule and one r.
    fn of_one_member(self) -> Reading<Self> {
        if self.study.members.len() > 1 {
            let field = if self.r().len() > 1 { "r" } else { "stop" };
            let text = format!(
                "`{field}` has several values; in a study give one, or name them in `vary`"
            );
            return Err(Refused::new(field, text));
        }
        self.check_on_domain()?;
        Ok(self)
    }
}

/// Returns the members of a statement: of a saddle-point method one for each rule and r, else one.
fn expanded(statement: &Statement, r: &[f64], stop: &[StopRule]) -> Reading<Study> {
    let Some(drawn) = statement.saddle else {
        return Ok(Study::of(&[], vec![statement.clone().into()]));
    };
    for (field, is_empty) in [("r", r.is_empty()), ("stop", stop.is_empty())] {
        if is_empty {
            let text = "`r` and `stop` must not be empty; e.g. r = [10], stop = [\"signed\"]";
            return Err(Refused::new(field, text));
        }
    }
    if let Some(r) = repeated(r) {
        return Err(Refused::new("r", format!("`r` lists {r} twice; remove one")));
    }
    if let Some(rule) = repeated(stop) {
        return Err(Refused::new("stop", format!("`stop` lists {rule} twice; remove one")));
    }
    if !r.contains(&drawn.r) {
        let text = format!("`draw_r` = {} is not among `r`; add it there", drawn.r);
        return Err(Refused::new("draw_r", text));
    }
    let mut members = Vec::new();
    for &stop in stop {
        for &r in r {
            let saddle = Some(SaddleSettings { stop, r, ..drawn });
            members.push(Statement { saddle, ..statement.clone() }.into());
        }
    }
    Ok(Study::of(&["stop", "r"].map(str::to_owned), members))
}

/// Returns the error of an unknown key with the table to which the key belongs, if there is one.
fn with_table(error: Error) -> Error {
    let text = error.to_string();
    let unknown = text.split_once("unknown field `");
    let belongs = unknown.and_then(|(place, rest)| {
        let (name, _) = rest.split_once('`')?;
        if let Some(limit) = limits::of_word(name) {
            return Some(format!("{place}`{name}`: {limit}"));
        }
        let table = field(name)?.table?;
        Some(format!("{place}`{name}` belongs to `{table}`; write {table} = {{ {name} = .. }}"))
    });
    belongs.map_or(error, Error::input)
}

/// The statement with what a published table has in place of the usual.
fn of_the_tables(usual: Statement) -> Statement {
    let r = PAPERS_R[PAPERS_R.len() / 2];
    let saddle = SaddleSettings { r, stop: StopRule::Signed, ..SaddleSettings::default() };
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
