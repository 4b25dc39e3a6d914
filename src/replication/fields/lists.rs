//! Lists of values that are varied, as options and scenes have them.

use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;
use toml::{Spanned, Value};

/// Example of the key, for errors.
pub(crate) const EXAMPLE: &str = "vary = { friction = [0.2, 0.4], refine = [2, 3] }";

/// Fields about parts of the boundary, by their names.
const PARTS: [&str; 2] = ["free", "fixed"];

/// Most members of a study.
pub(super) const MOST_MEMBERS: usize = 10_000;

/// List of values of a field or a name in f.
#[derive(Clone, Debug)]
pub(crate) struct Varied {
    pub(crate) name: String,
    /// Values as scenes have them; of options each is a text, a number of a range, or a list of parts.
    pub(crate) values: Vec<Value>,
}

/// Returns the first item that equals an earlier one.
pub(in crate::replication) fn repeated<T: PartialEq>(items: &[T]) -> Option<&T> {
    items.iter().enumerate().find(|(k, item)| items[..*k].contains(item)).map(|(_, item)| item)
}

/// Returns the members of a product of lists, the last list varied first.
pub(super) fn product_of(lists: &[&Varied]) -> Vec<Vec<Value>> {
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

/// Reads `NAME=A,B,...` or `NAME=FIRST:LAST:STEP`. Values that have commas end with a stroke each, which may be missing
/// behind the last of several.
///
/// # Errors
/// Sentence, with the remedy.
pub(crate) fn varied(text: &str) -> Result<Varied, String> {
    let (name, values) =
        text.split_once('=').ok_or("write NAME=VALUE,VALUE, such as friction=0.2,0.4,0.8")?;
    let name = name.trim().replace('-', "_");
    let divided: Vec<&str> = match values.contains('|') {
        true => values.strip_suffix('|').unwrap_or(values).split('|').collect(),
        false => values.split(',').collect(),
    };
    let mut list = Vec::new();
    for value in divided.into_iter().map(str::trim) {
        if PARTS.contains(&&*name) {
            let parts = value.split(',').map(str::trim).filter(|part| !part.is_empty());
            list.push(parts.map(Value::from).collect::<Vec<_>>().into());
        } else if value.is_empty() {
            return Err(format!("a value is empty; write {name}=VALUE,VALUE"));
        } else {
            list.extend(range(value)?.unwrap_or_else(|| vec![value.into()]));
        }
    }
    Ok(Varied { name, values: list })
}

/// Most decimal places of a range, so that all its numbers are the doubles nearest to decimals.
const MOST_PLACES: usize = 9;
/// Largest number of a range, without its decimal point.
const LARGEST: f64 = 1e15;

/// Reads `FIRST:LAST:STEP`, all numbers from the first in equal steps; none if the text is no such thing.
///
/// # Errors
/// Sentence, with the remedy.
fn range(text: &str) -> Result<Option<Vec<Value>>, String> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let numbers: Option<Vec<f64>> = parts.iter().map(|part| part.parse().ok()).collect();
    let Some([first, last, step]) = numbers.as_deref() else { return Ok(None) };
    let places =
        parts.iter().map(|part| part.split_once('.').map_or(0, |(_, digits)| digits.len()));
    let places = places.max().unwrap_or_default();
    let unit = 10_u64.pow(places.min(MOST_PLACES) as u32) as f64;
    let [first, last, step] = [first, last, step].map(|number| (number * unit).round());
    let is_decimal = places <= MOST_PLACES && !text.contains(['e', 'E']);
    let is_range = step > 0.0 && first <= last && first.abs().max(last) <= LARGEST;
    if !(is_decimal && is_range) {
        return Err(format!(
            "{text}: write FIRST:LAST:STEP in decimals, such as 0.1:0.5:0.1, with FIRST below LAST"
        ));
    }
    let steps = ((last - first) / step).floor();
    if steps >= MOST_MEMBERS as f64 {
        return Err(format!("{text}: more than {MOST_MEMBERS} values; take a larger STEP"));
    }
    let numbers = (0..=steps as u64).map(|k| (first + k as f64 * step) / unit);
    Ok(Some(numbers.map(Value::Float).collect()))
}

/// Products of lists as a scene has them: a table of lists, or several such tables.
pub(crate) struct Products(pub(crate) Vec<Vec<Varied>>);

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
                Value::Array(values) => values,
                one => vec![one],
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
        deserializer.deserialize_any(ProductsVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Result<Vec<String>, String> {
        varied(text).map(|list| list.values.iter().map(Value::to_string).collect())
    }

    #[test]
    fn options_are_divided_by_commas_or_strokes() {
        assert_eq!(values("h=1/8, 16").unwrap(), ["\"1/8\"", "\"16\""]);
        assert_eq!(values("grids=4,8|8,16").unwrap(), ["\"4,8\"", "\"8,16\""]);
        assert_eq!(values("grids=4,8|").unwrap(), ["\"4,8\""]);
        assert_eq!(values("fixed=a,b|").unwrap(), ["[\"a\", \"b\"]"]);
        assert_eq!(values("fixed=|a").unwrap(), ["[]", "[\"a\"]"]);
        assert_eq!(varied("max-iterations=1").unwrap().name, "max_iterations");
        for wrong in ["friction", "friction=,", "friction=", "R=0.1,,0.2", "grids=4,8||8"] {
            assert!(values(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn ranges_are_the_decimals_in_equal_steps() {
        assert_eq!(values("R=0.1:0.5:0.1").unwrap(), ["0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(values("a=-1:1:0.75,7").unwrap(), ["-1.0", "-0.25", "0.5", "\"7\""]);
        assert_eq!(values("domain=C:/a.msh").unwrap(), ["\"C:/a.msh\""]);
        for wrong in [
            "a=1:2:0",
            "a=2:1:1",
            "a=0:1:-1",
            "a=0:1:1e-3",
            "a=0:1:0.00001",
            "a=nan:1:1",
            "a=0:inf:1",
        ] {
            assert!(values(wrong).is_err(), "{wrong}");
        }
    }
}
