//! Fields of a statement as users write them: options of `solve`, and keys of a scene.
//!
//! Central is the table [`table::FIELDS`], from whose rows options, keys, help and the statement are made; [`Fields`]
//! are those that are given, [`read`] turns them into a statement, and [`write`] statements into fields.

pub(crate) mod described;
pub(crate) mod lists;
pub(crate) mod member;
pub(crate) mod names;
mod parts;
pub(crate) mod read;
pub(crate) mod table;
pub(crate) mod vary;
pub(crate) mod write;

use crate::replication::limits;
use clap::builder::{PossibleValue, Resettable, StringValueParser, StyledStr, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use parts::{names, with_known};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use table::{BOUNDARY, FIELDS, Field, Reading, Refused, field, text};
use toml::{Table, Value};

/// Heading of the options that the paper's method has.
const PAPERS: &str = "For the paper's method";

/// Fields that are given, by name: texts as options have them, one for each time that the option is given.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fields(BTreeMap<&'static str, Vec<String>>);

impl Fields {
    /// Fields that the keys of a scene are, the keys of its tables too; of a domain `name` is the field of that.
    ///
    /// # Errors
    /// [`Refused`] for a key that is neither a field nor among `others`, which the scene has besides, and for a value
    /// that is no table where one is expected, or the other way round.
    pub(crate) fn of_keys(mut keys: Table, others: &[&'static str]) -> Reading<Self> {
        let (mut fields, boundary) = (Self::default(), keys.remove(BOUNDARY));
        for (key, value) in keys {
            let group = FIELDS.iter().find_map(|field| field.table.filter(|table| *table == key));
            match (group, value) {
                (Some(group), Value::Table(table)) if !table.is_empty() => {
                    for (key, value) in table {
                        let name = if key == "name" { group } else { &key };
                        let own = field(name).filter(|of| of.table == Some(group) || name == group);
                        let known = own.ok_or_else(|| unknown(&key, Some(group), others))?;
                        fields.insert(known, &value)?;
                    }
                }
                (Some(group), value) => match field(group).filter(|_| value.is_str()) {
                    Some(name) => fields.insert(name, &value)?,
                    None => return Err(no_table(group, &value)),
                },
                (None, value) => {
                    let known = field(&key).filter(|field| field.table.is_none());
                    fields.insert(known.ok_or_else(|| unknown(&key, None, others))?, &value)?;
                }
            }
        }
        let parts = boundary.map_or_else(|| Ok(Table::new()), |parts| table_of(BOUNDARY, parts))?;
        for (part, numbers) in parts {
            for (name, number) in table_of(BOUNDARY, numbers)? {
                let known = field(&name).filter(|of| of.law.is_some());
                let known = known.ok_or_else(|| unknown(&name, Some(BOUNDARY), others))?;
                let texts = fields.0.entry(known.name).or_default();
                texts.push(format!("{part}={}", text(&number)));
            }
        }
        Ok(fields)
    }

    /// Gives a field a value as scenes have it, in place of the one that it has.
    pub(super) fn insert(&mut self, field: &'static Field, value: &Value) -> Reading<()> {
        self.0.insert(field.name, field.read(value)?);
        Ok(())
    }

    /// True if the field is given; a list without parts says nothing.
    pub(crate) fn has(&self, name: &str) -> bool {
        !self.texts(name).is_empty()
    }

    /// Texts that the field is given; none if it is not.
    fn texts(&self, name: &str) -> &[String] {
        self.0.get(name).map_or(&[], Vec::as_slice)
    }

    /// Names in place of numbers of laws.
    fn names_in_laws(&self) -> BTreeSet<String> {
        let texts = FIELDS.iter().filter_map(|field| Some((field, self.0.get(field.name)?)));
        let numbers =
            texts.flat_map(|(field, texts)| texts.iter().filter_map(|text| field.named_in(text)));
        numbers.flat_map(|(_, number)| names(number)).map(str::to_owned).collect()
    }

    /// Texts of a field about laws, if names stand in place of its numbers.
    fn with_names(&self, field: &Field) -> Option<Vec<String>> {
        let texts = self.texts(field.name);
        texts.iter().any(|text| field.named_in(text).is_some()).then(|| texts.to_vec())
    }

    /// Puts numbers in place of their names in laws.
    fn put_into_laws(&mut self, numbers: &BTreeMap<String, f64>) {
        for field in &FIELDS {
            for text in self.0.get_mut(field.name).into_iter().flatten() {
                let Some((part, number)) = field.named_in(text) else { continue };
                let number = with_known(number, numbers);
                *text = if part.is_empty() { number } else { format!("{part}={number}") };
            }
        }
    }

    /// Text of a field that has one.
    pub(crate) fn text(&self, name: &str) -> Option<&str> {
        self.texts(name).first().map(String::as_str)
    }
}

/// Refusal of a key of a table of a scene or, without a table, of the scene, which has others besides the fields.
fn unknown(key: &str, table: Option<&'static str>, others: &[&'static str]) -> Refused {
    let (mut known, place) = match table {
        Some(table) => {
            (field(table).map(|_| "name").into_iter().collect(), format!(" in `{table}`"))
        }
        None => ([others, &[BOUNDARY]].concat(), String::new()),
    };
    for field in FIELDS.iter().filter(|field| table.is_none_or(|table| field.stands_in(table))) {
        let name = field.table.filter(|_| table.is_none()).unwrap_or(field.name);
        if !known.contains(&name) {
            known.push(name);
        }
    }
    let text = match (limits::of_word(key), field(key).and_then(|field| field.table)) {
        (Some(limit), _) => format!("`{key}`: {limit}"),
        (None, Some(table)) => {
            format!("`{key}` belongs to `{table}`; write {table} = {{ {key} = .. }}")
        }
        (None, None) => format!("no key `{key}`{place}; there are {}", known.join(", ")),
    };
    Refused::new(key, text)
}

/// Table that has to stand under a key.
fn table_of(key: &str, value: Value) -> Reading<Table> {
    match value {
        Value::Table(table) if !table.is_empty() => Ok(table),
        value => Err(no_table(key, &value)),
    }
}

/// Refusal of a value in place of a table, or of an empty one.
fn no_table(table: &str, value: &Value) -> Refused {
    let examples = match field(table) {
        Some(_) => {
            "a name such as \"disc\", a file such as \"gear.msh\", or { name = \"disc\", refine = 4 }"
        }
        None if table == BOUNDARY => "{ hole = { friction = 0.3 } }, with the name of each part",
        None => "{ friction = 0.3 } or { limit = 2.0 }",
    };
    Refused::new(table, format!("{table} = {value}: write {examples}"))
}

/// Options of `solve`, and what they give.
impl Args for Fields {
    fn augment_args(command: Command) -> Command {
        command.args(FIELDS.iter().map(Field::arg))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Fields {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut fields = BTreeMap::new();
        for field in &FIELDS {
            let texts = matches.get_many::<String>(field.name);
            fields.extend(texts.map(|texts| (field.name, texts.cloned().collect())));
        }
        Ok(Self(fields))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Field {
    /// True if the values are listed behind the help, which does not name all of them.
    fn lists_values(&self) -> bool {
        (self.suggested)().iter().any(|of| !self.help.contains(of.get_name()))
    }

    /// The option.
    fn arg(&self) -> Arg {
        let all = format!("{}\n\n{}", self.help, self.more);
        Arg::new(self.name)
            .long(self.name.replace('_', "-"))
            .help(self.help)
            .long_help(Resettable::from((!self.more.is_empty()).then(|| StyledStr::from(all))))
            .value_name(self.value_name)
            .hide_possible_values(!self.lists_values())
            .value_parser(Suggested((self.suggested)()))
            .action(if self.is_list { ArgAction::Append } else { ArgAction::Set })
            .help_heading(self.heading)
            .allow_negative_numbers(true)
            .hide_short_help(self.is_rare)
    }
}

/// Parser of a text for which shells suggest some values; the table of fields refuses others, with its own remedy.
#[derive(Clone)]
struct Suggested(Vec<PossibleValue>);

impl TypedValueParser for Suggested {
    type Value = String;

    fn parse_ref(
        &self,
        command: &Command,
        argument: Option<&Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        (!self.0.is_empty())
            .then(|| Box::new(self.0.iter().cloned()) as Box<dyn Iterator<Item = _>>)
    }
}
