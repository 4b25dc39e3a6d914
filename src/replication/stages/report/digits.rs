//! True solutions by another program in higher precision, beside those of this one.

use crate::pipeline::error::{Failure, from_record};
use crate::replication::project::TRUTH;
use serde::{Deserialize, Serialize};
use signorini_mathematics::experiments::Rows;

/// Contents of `pipeline/truth.toml`, as `benches/peers/truth.py` writes it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TruthFile {
    solution: Vec<Solution>,
}

/// Solution of one problem, as decimals: a double would lose half of them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Solution {
    f: String,
    energy: String,
    centre: String,
    corners: [String; 4],
    contact: Vec<Arc>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Arc {
    from: [String; 2],
    to: [String; 2],
    force: String,
}

impl Solution {
    /// Returns all numbers, in the order of the table `values`.
    fn numbers(&self) -> Vec<&String> {
        let mut numbers = vec![&self.energy, &self.centre];
        numbers.extend(&self.corners);
        for Arc { from, to, force } in &self.contact {
            numbers.extend(from.iter().chain(to).chain([force]));
        }
        numbers
    }
}

/// Agreement of both programs.
#[derive(Serialize)]
pub(super) struct Agreement {
    /// Names of the problems that the record does not have.
    missing: Vec<String>,
    /// The largest difference of two numbers.
    difference: f64,
    /// True if the error of our solver explains the difference.
    agrees: bool,
}

/// Bound of the solver's errors, of ends of contact most.
const ERROR: f64 = 1e-10;

/// Replaces our digits in the table `values` by those of the record; `references` has f of the problems.
pub(super) fn compared(
    references: &Rows,
    values: &mut Rows,
    record: &[u8],
) -> Result<Agreement, Failure> {
    let record: TruthFile = from_record(TRUTH, record)?;
    let (mut missing, mut difference) = (Vec::new(), 0.0f64);
    for reference in references.iter() {
        let Some(theirs) = record.solution.iter().find(|one| reference["f"] == one.f) else {
            missing.extend(reference["problem"].as_str().map(str::to_owned));
            continue;
        };
        let mine = values.0.iter_mut().filter(|row| row["problem"] == reference["problem"]);
        let (ours, digits) = (mine.collect::<Vec<_>>(), theirs.numbers());
        if ours.len() != digits.len() {
            return Err(format!("{TRUTH}: `{}` has other arcs of contact here", theirs.f).into());
        }
        for (ours, digits) in ours.into_iter().zip(digits) {
            let theirs: f64 =
                digits.parse().map_err(|_| format!("{TRUTH}: `{digits}` is no number"))?;
            let value = ours["value"].as_f64().unwrap_or(f64::INFINITY);
            difference = difference.max((value - theirs).abs());
            ours.insert("digits".into(), digits.as_str().into());
        }
    }
    Ok(Agreement { missing, difference, agrees: difference <= ERROR })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    const RECORD: &str = r#"
[[solution]]
f = "else=-1"
energy = "-0.25"
centre = "0.12345678901234567890"
corners = ["0", "0", "0", "0"]
contact = [{ from = ["0.5", "0"], to = ["0.5", "0"], force = "1" }]
"#;

    /// The values of both problems, compared with the record.
    fn of(record: &str) -> (Rows, Result<Agreement, Failure>) {
        let (mut references, mut values) = (Rows::default(), Rows::default());
        for (problem, f) in [("a", "else=-1"), ("b", "else=-2")] {
            references.0.extend(json!({ "problem": problem, "f": f }).as_object().cloned());
            for value in [-0.25, 0.123456789012345, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.5, 0.0, 1.0] {
                let row = json!({ "problem": problem, "value": value, "digits": "" });
                values.0.extend(row.as_object().cloned());
            }
        }
        let agreement = compared(&references, &mut values, record.as_bytes());
        (values, agreement)
    }

    #[test]
    fn digits_are_the_records_and_differences_are_seen() {
        let (values, agreement) = of(RECORD);
        assert_eq!(values[1]["digits"], "0.12345678901234567890");
        assert_eq!(values[12]["digits"], "");
        let agreement = agreement.unwrap();
        assert!(agreement.agrees && agreement.missing == ["b"]);
        assert!(!of(&RECORD.replace("-0.25", "-0.250000001")).1.unwrap().agrees);
    }

    #[test]
    fn a_broken_record_is_refused() {
        for (old, new) in [
            ("-0.25", "quarter"),
            ("energy", "enrgy"),
            ("f =", "g = 1\nf ="),
            ("{ from", "{}, { from"),
        ] {
            assert!(of(&RECORD.replace(old, new)).1.is_err(), "{new}");
        }
        let twice = r#"{ from = ["0", "0"], to = ["0", "0"], force = "1" }, { from"#;
        assert!(of(&RECORD.replace("{ from", twice)).1.is_err());
    }
}
