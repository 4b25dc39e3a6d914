//! Fields that are tables in a scene.

use super::table::text;
use super::{DomainFields, LawFields};
use crate::replication::limits;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use toml::Value;

/// Reads a domain: a name or a file alone, or a table with more about it.
pub(super) fn name_or_table<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<DomainFields, D::Error> {
    deserializer.deserialize_any(NameOrTable)
}

struct NameOrTable;

impl<'de> Visitor<'de> for NameOrTable {
    type Value = DomainFields;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(
            "a name such as \"disc\", a file such as \"gear.msh\", \
             or a table such as { name = \"disc\", refine = 4 }",
        )
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<DomainFields, E> {
        Ok(DomainFields { name: Some(name.into()), ..DomainFields::default() })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<DomainFields, A::Error> {
        // The name may vary.
        DomainFields::deserialize(MapAccessDeserializer::new(map))
    }
}

/// Reads a law: a table with one number.
pub(super) fn law<'de, D: Deserializer<'de>>(deserializer: D) -> Result<LawFields, D::Error> {
    let law = LawFields::deserialize(deserializer)?;
    if law.friction.is_some() == law.limit.is_some() {
        return Err(serde::de::Error::custom(
            "a law has one number, as { friction = 0.3 } or { limit = 2.0 }",
        ));
    }
    Ok(law)
}

/// Reads the number of a law.
pub(super) fn one_number<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<f64>, D::Error> {
    match Value::deserialize(deserializer)? {
        Value::Table(_) => Err(serde::de::Error::custom(limits::one_law())),
        value => value.try_into().map(Some).map_err(serde::de::Error::custom),
    }
}

/// Reads a width: a text as of options, or a number.
pub(super) fn width<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<String>, D::Error> {
    match Value::deserialize(deserializer)? {
        value @ (Value::String(_) | Value::Integer(_) | Value::Float(_)) => Ok(Some(text(&value))),
        _ => Err(serde::de::Error::custom(
            "`h` is a width, as \"1/256\", or the cells per side, as 256",
        )),
    }
}

/// Reads the numbers of the curves of parts as options have them.
pub(super) fn curves<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<String>, D::Error> {
    let parts = BTreeMap::<String, Vec<f64>>::deserialize(deserializer)?;
    Ok(parts.iter().map(|(part, numbers)| curve(part, numbers)).collect())
}

/// Returns a part with the numbers of its curve as an option has them.
pub(super) fn curve(part: &str, numbers: &[f64]) -> String {
    let numbers: Vec<_> = numbers.iter().map(f64::to_string).collect();
    format!("{part}={}", numbers.join(","))
}

/// Axes of a chart as a scene gives them.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[serde(expecting = "a table such as { x = \"friction\", y = \"force\", log = [\"x\"] }")]
pub(crate) struct ChartFields {
    /// Column across; none for the first that is varied.
    pub(crate) x: Option<String>,
    /// Column up; none for the energy.
    pub(crate) y: Option<String>,
    /// Axes that are logarithmic.
    #[serde(default)]
    pub(crate) log: Vec<AxisName>,
}

/// Name of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum AxisName {
    X,
    Y,
}
