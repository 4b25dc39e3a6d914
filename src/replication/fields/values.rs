//! Values of options, for the parser, its help and the completion of shells.

use clap::builder::{PossibleValue, PossibleValuesParser, StringValueParser, TypedValueParser};
use clap::error::ErrorKind;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::solvers::{SOLVERS, Solver};
use std::ffi::OsStr;

/// Parser of the names of solvers.
pub(crate) fn solver_parser() -> impl TypedValueParser<Value = Solver> {
    let names = SOLVERS.map(|entry| PossibleValue::new(entry.name).help(entry.description));
    PossibleValuesParser::new(names)
        .map(|name| Solver::named(&name).expect("the parser takes no other name"))
}

/// Parser of the names of interpolations.
pub(super) fn prolongation_parser() -> impl TypedValueParser<Value = Prolongation> {
    PossibleValuesParser::new(Prolongation::ALL.map(Prolongation::name))
        .map(|name| Prolongation::named(&name).expect("the parser takes no other name"))
}

/// Parser of a text for which shells suggest some values; the command itself refuses others, with its own remedy.
#[derive(Clone)]
pub(crate) struct Suggested(pub(crate) Vec<&'static str>);

impl TypedValueParser for Suggested {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().map(PossibleValue::new)))
    }
}

/// Parser of quadratures of the load vector, for which shells suggest the names alone.
#[derive(Clone)]
pub(super) struct LoadParser;

impl TypedValueParser for LoadParser {
    type Value = LoadRule;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<LoadRule, clap::Error> {
        let text = StringValueParser::new().parse_ref(command, argument, value)?;
        if !text.contains(',') {
            let named = PossibleValuesParser::new(LoadRule::ALL.map(LoadRule::name));
            named.parse_ref(command, argument, value)?;
        }
        text.parse()
            .map_err(|e| clap::Error::raw(ErrorKind::ValueValidation, format!("--load: {e}\n")))
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let names = LoadRule::ALL.into_iter();
        Some(Box::new(names.map(|rule| PossibleValue::new(rule.name()).help(rule.description()))))
    }
}
