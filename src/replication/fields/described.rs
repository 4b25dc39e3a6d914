//! The table of fields in words, for pages.

use super::Fields;
use super::table::{Domains, FIELDS, Field, names};
use clap::{Arg, Args, Command};
use serde::Serialize;
use signorini_mathematics::solvers::Solver;

/// Fields of a statement in words.
#[derive(Debug, Serialize)]
pub(crate) struct DescribedFields {
    /// All fields, in their order.
    all: Vec<DescribedField>,
    /// Fields of which at most one is given.
    exclusive: Vec<ExclusiveFields>,
}

/// Fields that say the same.
#[derive(Debug, Serialize)]
struct ExclusiveFields {
    /// Fact that they say, in words.
    says: &'static str,
    /// Keys, as code in Markdown.
    keys: String,
}

/// Field of a statement in words.
#[derive(Debug, Serialize)]
struct DescribedField {
    /// Key of a scene, behind the name of its table and a dot.
    key: String,
    /// Option of `solve`, with the name of its value, as code in a table of Markdown.
    option: String,
    /// Meaning: the first sentence of the option's help.
    meaning: String,
    /// Names among which the value is, unless the meaning has them, and the solvers and domains that have the field,
    /// unless all have, in Markdown behind the meaning.
    more: String,
    /// Value where it is not given, in Markdown: as TOML, or in words.
    default: String,
}

/// Beginning of a default in the help of an option.
const DEFAULT: &str = "[default: ";
/// Beginning of such a default that a key, which belongs to a scene, does not have.
const OF_SCENE: &str = "the scene's, or ";

/// Returns all fields in words.
pub(crate) fn described() -> DescribedFields {
    let command = Fields::augment_args(Command::new("solve"));
    let options = command.get_arguments();
    let options: Vec<&Arg> = options.filter(|option| option.get_long().is_some()).collect();
    let mut exclusive: Vec<ExclusiveFields> = Vec::new();
    for field in &FIELDS {
        for says in field.says {
            match exclusive.iter_mut().find(|known| known.says == *says) {
                Some(known) => known.keys += &format!(", `{}`", field.key()),
                None => {
                    exclusive.push(ExclusiveFields { says, keys: format!("`{}`", field.key()) });
                }
            }
        }
    }
    let all = FIELDS.iter().map(|field| field.described(&options)).collect();
    DescribedFields { all, exclusive }
}

impl Field {
    /// Describes the field, by its option among these.
    fn described(&self, options: &[&Arg]) -> DescribedField {
        let name = self.option();
        let is_own = |option: &&&Arg| option.get_long() == name.strip_prefix("--");
        let option = options.iter().find(is_own).expect("each field is an option");
        let help = option.get_help().map(ToString::to_string).unwrap_or_default();
        let (meaning, default) = match help.split_once(DEFAULT) {
            Some((meaning, default)) => (meaning.trim_end(), Some(default.trim_end_matches(']'))),
            None => (help.as_str(), None),
        };
        let in_words = default.map(|text| text.strip_prefix(OF_SCENE).unwrap_or(text).to_owned());
        let usual = self.usual(true).filter(|value| value.as_str() != Some(""));
        let default = match (self.name, usual) {
            ("f", _) => "must be given".into(),
            (_, Some(value)) => format!("`{value}`"),
            (_, None) => in_words.unwrap_or_else(|| "none".into()),
        };
        let mut more = String::new();
        if !option.is_hide_possible_values_set() {
            let all = option.get_possible_values();
            let names: Vec<_> = all.iter().map(|value| format!("`{}`", value.get_name())).collect();
            if !names.is_empty() {
                more += &format!(": {}", names.join(", "));
            }
        }
        let goes_with = self.goes_with();
        if !goes_with.is_empty() {
            more += &format!(". *For* {goes_with}");
        }
        let value_name = option.get_value_names().unwrap_or_default().join(" ");
        DescribedField {
            key: self.key(),
            // A stroke would end the cell of a table.
            option: format!("{name} {value_name}").replace('|', "\\|"),
            meaning: meaning.to_owned(),
            more,
            default,
        }
    }

    /// Solvers and domains that have the field, in words; nothing if all have.
    fn goes_with(&self) -> String {
        let [takers, others] = self.takers();
        let solvers = match () {
            () if others.is_empty() => String::new(),
            () if takers == Solver::nested() => "the saddle-point methods".into(),
            () if others.len() < takers.len() => format!("all but {}", names(&others)),
            () => names(&takers),
        };
        let domains = match self.domains {
            Domains::All => "",
            Domains::Square => "the square",
            Domains::SquareAndCube => "the square, the cube",
            Domains::Plane => "domains in the plane",
            Domains::Meshes => "meshes",
        };
        let both = if solvers.is_empty() || domains.is_empty() { "" } else { "; " };
        format!("{solvers}{both}{domains}")
    }
}
