//! True solutions by another program in higher precision, beside those of this one.

use crate::pipeline::error::{Failure, from_record};
use crate::replication::project::TRUTH;
use serde::{Deserialize, Serialize};
use signorini_mathematics::experiments::truth::{Numbers, Reference};

/// Contents of `pipeline/truth.toml`, as `benches/peers/truth.py` writes it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TruthFile {
    solution: Vec<Solution>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Solution {
    f: String,
    /// As decimals: a double would lose half of them.
    #[serde(flatten)]
    numbers: Numbers<String>,
}

/// Agreement of both programs.
#[derive(Serialize)]
pub(super) struct Agreement {
    /// Names of the solutions that the record does not have.
    missing: Vec<String>,
    /// The largest difference of two numbers.
    difference: f64,
    /// True if our rounding errors explain the difference.
    agrees: bool,
}

/// Bound of the solver's errors at the finer of its resolutions; values in quadruple precision confirm it.
const ROUNDING: f64 = 2e-14;

/// Replaces our digits by those of the record.
pub(super) fn compared(references: &mut [Reference], record: &[u8]) -> Result<Agreement, Failure> {
    let mut record: TruthFile = from_record(TRUTH, record)?;
    let (mut missing, mut difference) = (Vec::new(), 0.0f64);
    for ours in references {
        let Some(theirs) = record.solution.iter_mut().find(|one| one.f == ours.f) else {
            missing.push(ours.name.clone());
            continue;
        };
        if ours.numbers.contact.len() != theirs.numbers.contact.len() {
            return Err(format!("{TRUTH}: `{}` has other arcs of contact here", ours.f).into());
        }
        for (ours, digits) in ours.numbers.each().zip(theirs.numbers.each()) {
            let theirs: f64 =
                digits.parse().map_err(|_| format!("{TRUTH}: `{digits}` is no number"))?;
            difference = difference.max((ours.value - theirs).abs());
            ours.digits = std::mem::take(digits);
        }
    }
    Ok(Agreement { missing, difference, agrees: difference <= ROUNDING })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    const RECORD: &str = r#"
[[solution]]
f = "else=-1"
energy = "-0.25"
centre = "0.12345678901234567890"
corners = ["0", "0", "0", "0"]
contact = [{ from = ["0.5", "0"], to = ["0.5", "0"], force = "1" }]
"#;

    /// Number as a [`Reference`] holds it.
    fn value(value: f64) -> Value {
        json!({ "value": value, "digits": "" })
    }

    fn reference(name: &str, f: &str) -> Reference {
        let (zero, end) = (value(0.0), [value(0.5), value(0.0)]);
        let numbers = json!({
            "name": name, "f": f, "energy": value(-0.25), "centre": value(0.123456789012345),
            "corners": [zero, zero, zero, zero],
            "contact": [{ "from": end, "to": end, "force": value(1.0) }],
            "green": 0.0, "rellich": 0.0,
        });
        serde_json::from_value(numbers).unwrap()
    }

    fn of(record: &str) -> (Vec<Reference>, Result<Agreement, Failure>) {
        let mut references = vec![reference("a", "else=-1"), reference("b", "else=-2")];
        let agreement = compared(&mut references, record.as_bytes());
        (references, agreement)
    }

    #[test]
    fn digits_are_the_records_and_differences_are_seen() {
        let (references, agreement) = of(RECORD);
        assert_eq!(references[0].numbers.centre.digits, "0.12345678901234567890");
        assert_eq!(references[1].numbers.centre.digits, "");
        let agreement = agreement.unwrap();
        assert!(agreement.agrees && agreement.missing == ["b"]);
        assert!(!of(&RECORD.replace("-0.25", "-0.2500000000001")).1.unwrap().agrees);
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
