//! Lists of values that are varied, as options and scenes have them.

use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::problem::text::Written;
use std::fmt;
use toml::{Spanned, Value};

/// Example of the key, for errors.
pub(super) const EXAMPLE: &str = "vary = { friction = [0.2, 0.4], refine = [2, 3] }";

/// List of values of a field or a name in f.
#[derive(Clone, Debug)]
pub(crate) struct Varied {
    pub(crate) name: String,
    pub(crate) values: Vec<String>,
}

/// Returns the members of a product of lists, the last list varied first.
pub(super) fn product_of(lists: &[&Varied]) -> Vec<Vec<String>> {
    let mut members = vec![Vec::new()];
    for list in lists {
        let mut longer = Vec::with_capacity(members.len() * list.values.len());
        for member in &members {
            for value in &list.values {
                longer.push([&member[..], std::slice::from_ref(value)].concat());
            }
        }
        members = longer;
    }
    members
}

/// Reads `NAME=A,B,...`; values that have commas are divided by strokes.
///
/// # Errors
/// Sentence, with the remedy.
pub(crate) fn varied(text: &str) -> Result<Varied, String> {
    let (name, values) =
        text.split_once('=').ok_or("write NAME=VALUE,VALUE, such as friction=0.2,0.4,0.8")?;
    let divider = if values.contains('|') { '|' } else { ',' };
    let values = values.split(divider).map(|value| value.trim().to_owned());
    let values: Vec<String> = values.filter(|value| !value.is_empty()).collect();
    if values.is_empty() {
        return Err(format!("no values; write {name}=VALUE,VALUE"));
    }
    Ok(Varied { name: name.trim().replace('-', "_"), values })
}

/// Reads products as a scene has them: a table of lists, or several such tables.
pub(super) fn products<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<Vec<Varied>>, D::Error> {
    deserializer.deserialize_any(ProductsVisitor).map(|Products(products)| products)
}

/// Products of lists.
struct Products(Vec<Vec<Varied>>);

struct ProductsVisitor;

impl<'de> Visitor<'de> for ProductsVisitor {
    type Value = Products;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "a table of lists, as {EXAMPLE}, or a list of such tables")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Products, A::Error> {
        let mut lists = Vec::new();
        // In the order in which they are written, which a table does not keep.
        while let Some((name, value)) = map.next_entry::<Spanned<String>, Value>()? {
            let place = name.span().start;
            let values = match value {
                Value::Array(values) => values.iter().map(text).collect(),
                one => vec![text(&one)],
            };
            lists.push((place, Varied { name: name.into_inner(), values }));
        }
        lists.sort_by_key(|(place, _)| *place);
        Ok(Products(vec![lists.into_iter().map(|(_, list)| list).collect()]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut tables: A) -> Result<Products, A::Error> {
        let mut products = Vec::new();
        while let Some(Products(more)) = tables.next_element()? {
            products.extend(more);
        }
        Ok(Products(products))
    }
}

impl<'de> Deserialize<'de> for Products {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ProductsVisitor)
    }
}

/// Returns a value of a scene as options have it.
fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => Written(*number).to_string(),
        Value::Array(values) => values.iter().map(text).collect::<Vec<_>>().join(","),
        Value::Table(_) => {
            let rule = LoadRule::deserialize(value.clone());
            rule.map_or_else(|_| value.to_string(), |rule| rule.to_string())
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Result<Vec<String>, String> {
        varied(text).map(|list| list.values)
    }

    #[test]
    fn options_are_divided_by_commas_or_strokes() {
        assert_eq!(values("h=1/8, 1/16").unwrap(), ["1/8", "1/16"]);
        assert_eq!(values("grids=4,8|8,16").unwrap(), ["4,8", "8,16"]);
        assert_eq!(varied("max-iterations=1").unwrap().name, "max_iterations");
        assert!(values("friction").is_err() && values("friction=,").is_err());
    }
}
