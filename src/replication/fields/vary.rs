//! Fields that are varied, and names in f: the fields of each member of a study.
//!
//! Central is [`Vary`]: the same lists are the key `vary` of a scene and the option `--vary` of `solve`, and each value
//! is read as the option of its field reads it.

use super::Fields;
use super::lists::{EXAMPLE, Varied, product_of, products};
use super::names::{Piece, is_name, pieces, without_values};
use super::table::{FIELDS, Field, Reading, Refused, Voice};
use crate::replication::numbers::COLUMNS;
use clap::builder::Resettable;
use clap::error::{ContextKind, ContextValue};
use clap::{Arg, Args, Command, FromArgMatches};
use serde::{Deserialize, Deserializer, de};
use std::collections::BTreeSet;
use std::error::Error as _;

/// Most members of a study.
const MOST_MEMBERS: usize = 10_000;
/// Values that are varied.
#[derive(Clone, Debug)]
pub(crate) struct Vary {
    /// Names of fields and names in f, in the order of the columns.
    pub(crate) names: Vec<String>,
    /// Values of each member, in the order of the names, as options have them.
    pub(crate) members: Vec<Vec<String>>,
}

impl Vary {
    /// Returns the members of products of lists, one product after the other.
    ///
    /// # Errors
    /// Reason, with the remedy.
    fn of(products: &[Vec<Varied>]) -> Result<Self, String> {
        let names: Vec<String> = match products {
            [first, ..] if !first.is_empty() => {
                first.iter().map(|list| list.name.clone()).collect()
            }
            _ => return Err(format!("nothing is varied; write {EXAMPLE}")),
        };
        if let Some(name) = names.iter().find(|name| !is_name(name)) {
            return Err(format!("`{name}` is no name; take letters, digits and _"));
        }
        // That a solver is varied says its own column.
        let mut own = names.iter().filter(|name| field(name).is_none());
        if let Some(name) = own.find(|name| is_taken(name)) {
            return Err(format!("`{name}` is a column of the answer; choose another name"));
        }
        let mut members: Vec<Vec<String>> = Vec::new();
        for product in products {
            let lists: Option<Vec<&Varied>> =
                names.iter().map(|name| product.iter().find(|list| list.name == *name)).collect();
            let lists = lists.filter(|_| product.len() == names.len()).ok_or_else(|| {
                format!("each table has the same names; give each {}", names.join(", "))
            })?;
            if let Some(list) = lists.iter().find(|list| list.values.is_empty()) {
                return Err(format!("`{}` has no values; add some, or leave it out", list.name));
            }
            let counts = lists.iter().map(|list| list.values.len());
            let count = counts.fold(members.len().max(1), usize::saturating_mul);
            if count > MOST_MEMBERS {
                return Err(format!(
                    "there are {count} members, more than {MOST_MEMBERS}; leave out values, or divide the study"
                ));
            }
            members.extend(product_of(&lists));
        }
        let mut seen = BTreeSet::new();
        if let Some(twice) = members.iter().find(|member| !seen.insert(*member)) {
            let values = names.iter().zip(twice).map(|(name, value)| format!("{name} = {value}"));
            let values = values.collect::<Vec<_>>().join(", ");
            return Err(format!("{values} is there twice; remove one"));
        }
        Ok(Self { names, members })
    }

    /// Reads the values of options `--vary NAME=A,B,...`, whose product is taken.
    ///
    /// # Errors
    /// Reason, with the remedy.
    pub(crate) fn of_options(options: &[Varied]) -> Result<Self, String> {
        Self::of(&[options.to_vec()])
    }

    /// Returns the fields of each member: these, with its values.
    ///
    /// # Errors
    /// [`Refused`] if a name is neither a field nor in f, is given as well, or has a value that it cannot have.
    pub(crate) fn fields(&self, base: &Fields, voice: Voice) -> Reading<Vec<Fields>> {
        let fields: Vec<Option<&Field>> = self.names.iter().map(|name| field(name)).collect();
        for (name, field) in self.names.iter().zip(&fields) {
            if field.is_some_and(|field| (field.given)(base)) {
                let text = format!("{} is given as well; leave one of them out", voice.name(name));
                return Err(Self::refused(voice, name, None, &text));
            }
        }
        let base = Fields { vary: None, ..base.clone() };
        let mut parser = parser();
        let mut members = Vec::with_capacity(self.members.len());
        let mut used = BTreeSet::new();
        for values in &self.members {
            let mut member = base.clone();
            let mut arguments = vec!["solve".to_owned()];
            for (field, value) in fields.iter().zip(values) {
                arguments.extend(field.map(|field| format!("{}={value}", field.option())));
            }
            let matches = parser.try_get_matches_from_mut(arguments);
            let read = matches.and_then(|matches| member.update_from_arg_matches(&matches));
            read.map_err(|e| self.refused_value(voice, values, &e))?;
            let f = member.f.take().map(|f| self.put_into(&f, values, &mut used));
            member.f = f.transpose()?;
            members.push(member);
        }
        for (name, field) in self.names.iter().zip(&fields) {
            if field.is_none() && !used.contains(name) {
                let known = FIELDS.map(|field| field.name).join(", ");
                let text = format!("no such field, and f has no ${name}; the fields are {known}");
                return Err(Self::refused(voice, name, None, &text));
            }
        }
        Ok(members)
    }

    /// Returns f with the values of a member in place of `$NAME`, and notes which names it has.
    fn put_into(&self, f: &str, values: &[String], used: &mut BTreeSet<String>) -> Reading<String> {
        let mut text = String::new();
        for piece in pieces(f) {
            let Piece::Name(name) = piece else {
                text += piece.text();
                continue;
            };
            let place = self.names.iter().position(|known| known == name);
            let place = place.ok_or_else(|| without_values(name))?;
            used.insert(name.to_owned());
            text += &values[place];
        }
        Ok(text)
    }

    /// Refusal of a value of a member by the parser of its option.
    fn refused_value(&self, voice: Voice, values: &[String], error: &clap::Error) -> Refused {
        let option = match error.get(ContextKind::InvalidArg) {
            Some(ContextValue::String(option)) => {
                option.split([' ', '=']).next().unwrap_or_default()
            }
            _ => "",
        };
        let of_option = |name: &String| field(name).is_some_and(|field| field.option() == option);
        let place = self.names.iter().position(of_option).unwrap_or_default();
        let reason = match (error.source(), error.get(ContextKind::ValidValue)) {
            (Some(source), _) => format!("{source}; list values with commas between them"),
            (None, Some(ContextValue::Strings(valid))) if !valid.is_empty() => {
                format!("choose one of {}", valid.join(", "))
            }
            _ => {
                let text = error.to_string();
                let line = text.lines().next().unwrap_or_default();
                line.trim_start_matches("error: ").to_owned()
            }
        };
        Self::refused(voice, &self.names[place], Some(&values[place]), &reason)
    }

    /// Refusal of a name, or of one of its values.
    fn refused(voice: Voice, name: &str, value: Option<&str>, reason: &str) -> Refused {
        let given = match (voice, value) {
            (Voice::Keys, None) => format!("`vary`: {name}"),
            (Voice::Keys, Some(value)) => format!("`vary`: {name} = {value}"),
            (_, None) => format!("--vary {name}"),
            (_, Some(value)) => format!("--vary {name}={value}"),
        };
        Refused::new("vary", format!("{given}: {reason}"))
    }
}

/// True if a row has a key of this name besides what is varied.
fn is_taken(name: &str) -> bool {
    name == "schema" || COLUMNS.contains(&name)
}

impl<'de> Deserialize<'de> for Vary {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let products = products(deserializer)?;
        Self::of(&products).map_err(|reason| de::Error::custom(format!("`vary`: {reason}")))
    }
}

/// Returns the field with this name.
fn field(name: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.name == name)
}

/// Returns a parser of the options of fields.
fn parser() -> Command {
    // What the options of `solve` ask of each other is asked of the member as a whole.
    let command = Fields::augment_args(Command::new("solve"));
    command.mut_args(|arg: Arg| arg.conflicts_with(Resettable::Reset).requires(Resettable::Reset))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(f: &str, vary: &str) -> Result<Vec<String>, String> {
        let given: Fields = toml::from_str(vary).map_err(|e| e.to_string())?;
        let vary = given.vary.ok_or("nothing is varied")?;
        let base = Fields { f: Some(f.into()), ..Fields::default() };
        let members = vary.fields(&base, Voice::Keys).map_err(|refused| refused.text)?;
        Ok(members.into_iter().filter_map(|member| member.f).collect())
    }

    #[test]
    fn names_stand_behind_a_dollar_outside_of_quotes() {
        let f = "disc($x,0,$R1)=$R; region(\"$R\")=1; else=-1";
        let members = with(f, "vary = { R = [1e-7, -2], R1 = 0.5, x = 0 }").unwrap();
        let with_r = ["1e-7", "-2"];
        assert_eq!(
            members,
            with_r.map(|r| format!("disc(0,0,0.5)={r}; region(\"$R\")=1; else=-1"))
        );
        assert!(with("else=-$S", "vary = { R = [1] }").unwrap_err().contains("f has $S"));
        assert!(super::super::names::check_names("region(\"a$b\")=1; else=-$").is_ok());
    }
}
