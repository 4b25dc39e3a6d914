//! Changes of inputs, in words.

use super::names::shortened;
use super::{PROGRAM, is_hash};
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Change of one input.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Change {
    /// Name of the input.
    pub input: String,
    /// Value or hash when the task last ran; `None` if it was not an input then.
    pub old: Option<String>,
    /// Value or hash today; `None` if it no longer is an input.
    pub new: Option<String>,
}

/// Returns the inputs that differ between a stored manifest and today.
pub(super) fn changes(
    old: &BTreeMap<String, String>,
    new: &BTreeMap<String, String>,
) -> Vec<Change> {
    let keys: BTreeSet<_> = old.keys().chain(new.keys()).collect();
    let mut changes = Vec::new();
    for key in keys {
        let (old, new) = (old.get(key).cloned(), new.get(key).cloned());
        if old != new {
            changes.push(Change { input: key.clone(), old, new });
        }
    }
    changes
}

impl fmt::Display for Change {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let subject = match self.input.as_str() {
            PROGRAM => "the program changed",
            input => input,
        };
        let parts = [&self.old, &self.new].map(|value| serde_json::from_str(value.as_ref()?).ok());
        let mut differences = Vec::new();
        if let [Some(old), Some(new)] = &parts {
            compare(subject, old, new, &mut differences);
        }
        match &differences[..] {
            [Difference { place, old, new }, rest @ ..] if place != subject => {
                let [old, new] = [old, new].map(|value| shortened(&value.to_string(), LONG));
                write!(out, "{place}: {old} -> {new}")?;
                out.write_str(if rest.is_empty() { "" } else { ", and elsewhere" })
            }
            // A value without parts, as it was written.
            _ => write!(
                out,
                "{subject}: {} -> {}",
                brief(self.old.as_ref()),
                brief(self.new.as_ref())
            ),
        }
    }
}

/// Returns a value, or the first twelve digits of a hash, which identify it.
fn brief(value: Option<&String>) -> String {
    match value {
        None => "absent".into(),
        Some(hash) if is_hash(hash) => hash[..12].into(),
        Some(value) => shortened(value, LONG),
    }
}

/// Number of characters of a value that is shown whole.
const LONG: usize = 100;

/// Difference of two JSON values in one place.
struct Difference<'a> {
    place: String,
    old: &'a Value,
    new: &'a Value,
}

/// Finds the differences of two values: of objects with the same keys and arrays of the same length part by part, but
/// not of lists of plain values.
fn compare<'a>(place: &str, old: &'a Value, new: &'a Value, found: &mut Vec<Difference<'a>>) {
    match (old, new) {
        _ if old == new => {}
        (Value::Object(old), Value::Object(new)) if old.keys().eq(new.keys()) => {
            for (key, value) in old {
                compare(&format!("{place}.{key}"), value, &new[key], found);
            }
        }
        (Value::Array(old), Value::Array(new))
            if old.len() == new.len() && old.iter().any(|v| v.is_object() || v.is_array()) =>
        {
            for (k, (old, new)) in old.iter().zip(new).enumerate() {
                compare(&format!("{place}[{k}]"), old, new, found);
            }
        }
        _ => found.push(Difference { place: place.into(), old, new }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Words for the change of a parameter.
    fn told(old: &str, new: &str) -> String {
        let [old, new] = [old, new].map(|value| Some(value.to_owned()));
        Change { input: "parameter p".into(), old, new }.to_string()
    }

    #[test]
    fn of_a_value_with_parts_only_the_changed_ones_are_told() {
        assert_eq!(told("1e6", "10"), "parameter p: 1e6 -> 10");
        assert_eq!(told("[4, 8]", "[3, 8]"), "parameter p: [4, 8] -> [3, 8]");
        let old = r#"[{"r":[1000000.0,1.0],"limit":5},{"r":[],"limit":7}]"#;
        let other_r = r#"[{"r":[0.5,1.0],"limit":5},{"r":[],"limit":7}]"#;
        let other_limit = r#"[{"r":[0.5,1.0],"limit":5},{"r":[],"limit":8}]"#;
        assert_eq!(told(old, other_r), "parameter p[0].r: [1000000.0,1.0] -> [0.5,1.0]");
        assert_eq!(
            told(old, other_limit),
            "parameter p[0].r: [1000000.0,1.0] -> [0.5,1.0], and elsewhere"
        );
        assert_eq!(told(old, "[]"), format!("parameter p: {old} -> []"));
    }
}
