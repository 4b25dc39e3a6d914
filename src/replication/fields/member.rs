//! Members of studies, and the values that vary in them.
//!
//! Central is [`Member`]: a value of a field is read from the statement that is solved, so that no row can be called by
//! another value than its own.

use super::Fields;
use super::names::NAMED;
use super::table::{FIELDS, Field, Reading, Refused, Voice, field, toml};
use crate::pipeline::names::composed;
use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use signorini_mathematics::problem::text::Written;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::SaddleSettings;
use signorini_mathematics::statement::{Fineness, Statement};
use std::collections::BTreeMap;
use std::fmt;
use toml::Value;

/// One problem of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Member {
    /// Numbers that f has in place of names.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) numbers: BTreeMap<String, f64>,
    /// Statement that is solved.
    pub(crate) statement: Statement,
}

impl From<Statement> for Member {
    fn from(statement: Statement) -> Self {
        Self { numbers: BTreeMap::new(), statement }
    }
}

/// Value of a field, or of a name in f, in a member.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) enum Varying {
    Number(f64),
    /// Width, as the number of cells per side.
    Width(usize),
    Text(String),
    /// Names of parts of the boundary.
    Parts(Vec<String>),
}

impl Member {
    /// Stopping rule; none for a solver without.
    pub(crate) fn rule(&self) -> Option<StopRule> {
        Some(self.statement.saddle?.stop)
    }

    /// Duality parameter; none for a solver without.
    pub(crate) fn r(&self) -> Option<f64> {
        Some(self.statement.saddle?.r)
    }

    /// Value of the field or the name in f that is called so; none if the statement has none.
    pub(crate) fn value(&self, name: &str) -> Option<Varying> {
        let number = self.numbers.get(name).copied().map(Varying::Number);
        number.or_else(|| field(name)?.varying(&self.statement))
    }

    /// Settings of a saddle-point method that tables and pictures show: its rule and r, with all else as usual.
    pub(crate) fn rule_and_r(&self) -> Option<SaddleSettings> {
        let SaddleSettings { stop, r, .. } = self.statement.saddle?;
        Some(SaddleSettings { stop, r, ..SaddleSettings::default() })
    }

    /// Returns the member with options in place of fields that do not vary.
    ///
    /// # Errors
    /// [`Refused`] if an option concerns what varies, or does not go with the statement.
    pub(crate) fn over(&self, names: &[String], options: &Fields) -> Reading<Self> {
        let statement = options.over(self.statement.clone(), Voice::OverScene)?;
        let member = Self { statement, ..self.clone() };
        let text = NAMED.into_iter().find(|field| options.has(field));
        if let Some((name, text)) = self.numbers.keys().next().zip(text) {
            return Err(does_not_go(text, name));
        }
        for varied in names.iter().filter_map(|name| field(name)) {
            let mut given = FIELDS.iter().filter(|option| options.has(option.name));
            let says_it =
                |option: &&Field| option.name == varied.name || option.says_as(varied).is_some();
            let option = match given.clone().find(says_it) {
                None if member.value(varied.name) == self.value(varied.name) => continue,
                Some(option) => Some(option),
                None => given.next(),
            };
            return Err(does_not_go(option.map_or(varied.name, |option| option.name), varied.name));
        }
        Ok(member)
    }
}

/// Refusal of an option beside a scene that varies this.
fn does_not_go(option: &str, varied: &str) -> Refused {
    let text = format!(
        "{} does not go with a scene that varies {varied}; leave it out, or change the scene",
        Voice::OverScene.name(option)
    );
    Refused::new(option, text)
}

impl Field {
    /// Value that varies, in the statement of a member; none if it has none.
    pub(crate) fn varying(&self, statement: &Statement) -> Option<Varying> {
        let value = self.value_in(statement);
        match (self.name, &statement.fineness) {
            ("h", Fineness::Width(_) | Fineness::Grids(_)) => {
                statement.fineness.cells().last().copied().map(Varying::Width)
            }
            ("free" | "fixed", _) => Some(Varying::Parts(value.unwrap_or_default())),
            _ => Some(Varying::of(value?.join(" "))),
        }
    }
}

impl Varying {
    /// Value that this text says.
    fn of(text: String) -> Self {
        match toml(&text) {
            Value::Float(number) => Self::Number(number),
            Value::Integer(number) => Self::Number(number as f64),
            _ => Self::Text(text),
        }
    }

    /// Number on an axis; none of a text. A width is itself, whatever it is written as.
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Width(cells) => Some(1.0 / *cells as f64),
            Self::Text(_) | Self::Parts(_) => None,
        }
    }

    /// Value in a row of JSON: a number if it is one, else a text.
    pub(crate) fn json(&self) -> Json {
        match self {
            // As it is written, without a fraction where there is none.
            Self::Number(number) => serde_json::from_str(&Written(*number).to_string()).ok(),
            Self::Width(_) => self.number().map(Json::from),
            Self::Text(_) | Self::Parts(_) => Some(self.to_string().into()),
        }
        .unwrap_or_default()
    }

    /// Value in the key `vary` of a scene.
    pub(super) fn toml(&self) -> Value {
        match self {
            Self::Parts(parts) => parts.clone().into(),
            other => toml(&other.to_string()),
        }
    }

    /// Text that all values of a field or a name in f have that mean the same, and no other.
    pub(super) fn meaning(&self, name: &str) -> String {
        let mut same = self.clone();
        if let (Self::Text(path), "domain") = (&mut same, name) {
            // A file in this folder is also called ./file.
            let parts = path.split('/').filter(|part| *part != ".");
            *path = parts.collect::<Vec<_>>().join("/");
        }
        if let Self::Parts(parts) = &mut same {
            parts.iter_mut().for_each(|part| *part = composed(part));
            parts.sort_unstable();
            parts.dedup();
        }
        serde_json::to_string(&same).expect("a value is plain data")
    }

    /// Text that no other value has and that is the name of a file everywhere: as it is written, with `~` for the
    /// slashes between folders, or else none.
    pub(crate) fn file_name(&self) -> Option<String> {
        let text = self.to_string();
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-+/".contains(c);
        let has_name = !text.starts_with('/') && !matches!(self, Self::Parts(_));
        (has_name && text.chars().all(is_plain)).then(|| text.replace('/', "~"))
    }
}

/// As options have it.
impl fmt::Display for Varying {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(out, "{}", Written(*number)),
            Self::Width(cells) => write!(out, "1/{cells}"),
            Self::Text(text) => out.write_str(text),
            Self::Parts(parts) => {
                out.write_str(&parts.iter().map(|part| quoted(part)).collect::<Vec<_>>().join(","))
            }
        }
    }
}

/// Returns the name of a part, in quotes where it could be taken for several.
fn quoted(part: &str) -> String {
    if part.contains([',', '"']) { format!("{part:?}") } else { part.to_owned() }
}

/// Returns what varies with its values, as `friction = 0.2, refine = 3`.
pub(crate) fn in_words<T: fmt::Display>(
    names: &[String],
    values: impl IntoIterator<Item = T>,
) -> String {
    let pairs = names.iter().zip(values);
    pairs.map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
}
