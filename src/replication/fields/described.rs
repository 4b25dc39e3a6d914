//! The table of fields in words, for pages.

use super::table::{Domains, FIELDS, Field, names};
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
    let all = FIELDS.iter().map(Field::described).collect();
    DescribedFields { all, exclusive }
}

impl Field {
    /// Describes the field.
    fn described(&self) -> DescribedField {
        let (meaning, default) = match self.help.split_once(DEFAULT) {
            Some((meaning, default)) => (meaning.trim_end(), Some(default.trim_end_matches(']'))),
            None => (self.help, None),
        };
        let in_words = default.map(|text| text.strip_prefix(OF_SCENE).unwrap_or(text).to_owned());
        let usual = self.usual(true);
        let default = match self.name {
            "f" => "must be given".into(),
            _ if !usual.is_empty() => format!("`{}`", self.toml(&usual)),
            _ => in_words.unwrap_or_else(|| "none".into()),
        };
        let mut more = String::new();
        if self.lists_values() {
            let names = (self.suggested)();
            let names: Vec<_> = names.iter().map(|of| format!("`{}`", of.get_name())).collect();
            more += &format!(": {}", names.join(", "));
        }
        let goes_with = self.goes_with();
        if !goes_with.is_empty() {
            more += &format!(". *For* {goes_with}");
        }
        DescribedField {
            key: self.key(),
            // A stroke would end the cell of a table.
            option: format!("{} {}", self.option(), self.value_name).replace('|', "\\|"),
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
            Domains::Grids => "the square",
            Domains::SquareAndCube => "the square, the cube",
            Domains::Plane => "domains in the plane",
            Domains::Meshes => "meshes",
        };
        let both = if solvers.is_empty() || domains.is_empty() { "" } else { "; " };
        format!("{solvers}{both}{domains}")
    }
}
