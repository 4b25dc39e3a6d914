//! Fields that are varied, and names in f: the members of a study.
//!
//! Central is [`Vary`]: the same lists are the key `vary` of a scene and the option `--vary` of `solve`, and each value
//! of a field is read as its option reads it.

use super::Fields;
use super::lists::{EXAMPLE, MOST_MEMBERS, Varied, product_of, products};
use super::member::{Member, Varying, in_words};
use super::names::{is_name, names, with_numbers};
use super::table::{FIELDS, Field, Reading, Refused, Voice, field, text};
use crate::replication::columns::{COLUMNS, END};
use crate::replication::limits;
use clap::builder::Resettable;
use clap::error::{ContextKind, ContextValue};
use clap::{Arg, Args, Command, FromArgMatches};
use serde::{Deserialize, Deserializer, de};
use signorini_mathematics::problem::text::Written;
use signorini_mathematics::statement::Statement;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error as _;
use toml::Value;

/// Values that are varied, as they are given.
#[derive(Clone, Debug)]
pub(crate) struct Vary {
    /// Names of fields and names in f, in the order of the columns.
    pub(crate) names: Vec<String>,
    /// Values of each member, in the order of the names.
    members: Vec<Vec<Value>>,
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
        let mut seen = BTreeSet::new();
        if let Some(name) = names.iter().find(|name| !seen.insert(*name)) {
            return Err(format!("`{name}` is there twice; give all its values in one list"));
        }
        // That a solver is varied says its own column.
        let mut own = names.iter().filter(|name| field(name).is_none());
        if let Some(name) = own.find(|name| is_taken(name)) {
            return Err(format!("`{name}` is a column of the answer; choose another name"));
        }
        let mut members: Vec<Vec<Value>> = Vec::new();
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
        Ok(Self { names, members })
    }

    /// Reads the values of options `--vary NAME=A,B,...`, whose product is taken.
    ///
    /// # Errors
    /// Reason, with the remedy.
    pub(crate) fn of_options(options: &[Varied]) -> Result<Self, String> {
        Self::of(&[options.to_vec()])
    }

    /// Returns the members, whose statements `state` makes of these fields with the values of each.
    ///
    /// # Errors
    /// [`Refused`] if a name is neither a field nor in f, is given as well, has a value that it cannot have or the same
    /// value twice, and what `state` refuses.
    pub(crate) fn members(
        &self,
        base: &Fields,
        voice: Voice,
        mut state: impl FnMut(&Fields) -> Reading<Statement>,
    ) -> Reading<Vec<Member>> {
        for field in self.names.iter().filter_map(|name| field(name)) {
            if (field.given)(base) {
                let text =
                    format!("{} is given as well; leave one of them out", voice.name(field.name));
                return Err(refused(voice, field.name, None, &text));
            }
        }
        let base = Fields { vary: None, ..base.clone() };
        let mut parser = parser();
        let (mut members, mut seen) = (Vec::with_capacity(self.members.len()), BTreeSet::new());
        for values in &self.members {
            let (fields, numbers) = self.read(&base, voice, values, &mut parser)?;
            let statement = state(&fields).map_err(|refused| {
                let is_varied = self.names.iter().any(|name| name == refused.field);
                let field = if is_varied { "vary" } else { refused.field };
                let words = in_words(&self.names, values.iter().map(text));
                Refused::new(field, format!("with {words}: {}", refused.text))
            })?;
            let member = Member { numbers, statement };
            let found: Option<Vec<Varying>> =
                self.names.iter().map(|name| member.value(name)).collect();
            let Some(found) = found else {
                let words = in_words(&self.names, values.iter().map(text));
                return Err(Refused::new(
                    "vary",
                    format!("{words}: not all of them go together; leave one out"),
                ));
            };
            for (name, (value, found)) in self.names.iter().zip(values.iter().zip(&found)) {
                let is_none = matches!(value, Value::Array(parts) if parts.is_empty());
                // An option that is not given leaves a scene its own parts.
                if is_none && *found != Varying::Parts(Vec::new()) {
                    let text = "the scene has such parts, and keeps them where none is given; name others, or change \
                                the scene";
                    return Err(refused(voice, name, None, text));
                }
            }
            let meanings = self.names.iter().zip(&found).map(|(name, value)| value.meaning(name));
            if !seen.insert(meanings.collect::<Vec<_>>()) {
                let words = in_words(&self.names, &found);
                return Err(Refused::new(
                    "vary",
                    format!("{}: {words} is there twice; remove one", voice.name("vary")),
                ));
            }
            members.push(member);
        }
        Ok(members)
    }

    /// Returns the fields with these values of a member in them, and the numbers of its names in f.
    fn read(
        &self,
        base: &Fields,
        voice: Voice,
        values: &[Value],
        parser: &mut Command,
    ) -> Reading<(Fields, BTreeMap<String, f64>)> {
        let mut arguments = vec!["solve".to_owned()];
        for (name, value) in self.names.iter().zip(values) {
            if let Some(field) = field(name) {
                arguments.extend(field.arguments(voice, value)?);
            }
        }
        let mut fields = base.clone();
        let matches = parser.try_get_matches_from_mut(arguments);
        let read = matches.and_then(|matches| fields.update_from_arg_matches(&matches));
        read.map_err(|e| self.refused_value(voice, values, &e))?;
        let f = fields.f.take();
        let in_f: BTreeSet<&str> = f.iter().flat_map(|f| names(f)).collect();
        let mut numbers = BTreeMap::new();
        for (name, value) in self.names.iter().zip(values).filter(|(name, _)| field(name).is_none())
        {
            if !in_f.contains(name.as_str()) {
                let known = FIELDS.map(|field| field.name).join(", ");
                let text = limits::of_word(name).unwrap_or_else(|| {
                    format!("no such field, and f has no ${name}; the fields are {known}")
                });
                return Err(refused(voice, name, None, &text));
            }
            numbers.insert(name.clone(), number_of(voice, name, value)?);
        }
        fields.f = f.map(|f| with_numbers(&f, &numbers)).transpose()?;
        Ok((fields, numbers))
    }

    /// Refusal of a value of a member by the parser of its option.
    fn refused_value(&self, voice: Voice, values: &[Value], error: &clap::Error) -> Refused {
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
        refused(voice, &self.names[place], Some(&values[place]), &reason)
    }
}

/// Refusal of a name, or of one of its values.
fn refused(voice: Voice, name: &str, value: Option<&Value>, reason: &str) -> Refused {
    let given = match (voice, value) {
        (Voice::Keys, None) => format!("`vary`: {name}"),
        (Voice::Keys, Some(value)) => format!("`vary`: {name} = {}", text(value)),
        (_, None) => format!("--vary {name}"),
        (_, Some(value)) => format!("--vary {name}={}", text(value)),
    };
    Refused::new("vary", format!("{given}: {reason}"))
}

/// Reads the number of a name in f.
fn number_of(voice: Voice, name: &str, value: &Value) -> Reading<f64> {
    let read = match value {
        Value::Float(_) | Value::Integer(_) | Value::String(_) => text(value).parse().ok(),
        _ => None,
    };
    // A negative zero is zero.
    read.map(|Written(number)| number + 0.0).ok_or_else(|| {
        let reason = "a name in f is a number, such as 0.25 or 1/4; what is no number varies as a field, as f does";
        refused(voice, name, Some(value), reason)
    })
}

impl Field {
    /// Returns the arguments that give the field a value.
    fn arguments(&self, voice: Voice, value: &Value) -> Reading<Vec<String>> {
        if let ("domain", Value::Table(_)) = (self.name, value) {
            let text = "in `vary` a domain is its name alone; what is said of it varies beside it, as in vary = \
                [{ domain = \"disc\", refine = 2 }, { domain = \"lshape\", refine = 3 }]";
            return Err(refused(voice, self.name, Some(value), text));
        }
        let texts = self.options(value).into_iter();
        Ok(texts.map(|text| format!("{}={text}", self.option())).collect())
    }
}

/// True if a row has a key of this name besides what is varied.
fn is_taken(name: &str) -> bool {
    ["schema", END].contains(&name) || COLUMNS.contains(&name)
}

impl<'de> Deserialize<'de> for Vary {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let products = products(deserializer)?;
        Self::of(&products).map_err(|reason| de::Error::custom(format!("`vary`: {reason}")))
    }
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
        let members = vary.members(&base, Voice::Keys, |fields| fields.usual(Voice::Keys));
        let members = members.map_err(|refused| refused.text)?;
        Ok(members.into_iter().map(|member| member.statement.f).collect())
    }

    #[test]
    fn names_in_f_are_numbers() {
        let f = "disc($x,0,$R1)=$R; else=-1";
        let members = with(f, "vary = { R = [1e-7, \"-1/2\"], R1 = 0.5, x = 0 }").unwrap();
        let expected = ["1e-7", "-0.5"].map(|r| format!("disc(0,0,0.5)={r}; else=-1"));
        assert_eq!(members, expected);
        for (f, vary, words) in [
            ("else=-$S", "vary = { R = [1] }", "f has no $R"),
            ("else=-$R", "vary = { R = [\"x\"] }", "R = x: a name in f is a number"),
            ("else=-$R", "vary = { R = [[1, 2]] }", "a name in f is a number"),
            ("else=-$R", "vary = { R = [inf] }", "a name in f is a number"),
            ("else=-$R", "vary = { R = [true] }", "a name in f is a number"),
            ("else=-$R", "vary = { R = [0.1, \"0.10\"] }", "R = 0.1 is there twice"),
            ("else=-$R", "vary = { R = [\"1/4\", 0.25] }", "R = 0.25 is there twice"),
            ("else=-$h", "vary = { h = [4, 5] }", "`h` is a field; choose another name in f"),
            ("else=-$R", "vary = { R = 1, friction = [1, 1.0] }", "friction = 1 is there twice"),
        ] {
            let refused = with(f, vary).unwrap_err();
            assert!(refused.contains(words), "{vary}: {refused}");
        }
    }
}
