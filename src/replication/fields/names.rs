//! Names in the texts of f and k, each behind a dollar, in whose place a study has numbers.

use super::parts::places;
use super::table::{Reading, Refused, field};
use signorini_mathematics::problem::text::Written;
use std::collections::BTreeMap;

/// Fields whose texts may have names.
pub(crate) const NAMED: [&str; 2] = ["f", "k"];

/// Refuses a text of a field with a name to which nothing has given a number.
pub(super) fn check_names(field: &str, text: &str) -> Reading<()> {
    with_numbers(field, text, &BTreeMap::new()).map(|_| ())
}

/// Returns f, or the text of another field, with numbers in place of its names: in a formula in parentheses, elsewhere
/// where a number can stand.
///
/// # Errors
/// [`Refused`] if a name has no number, or stands where f has something else than a number.
pub(super) fn with_numbers(
    field: &str,
    f: &str,
    numbers: &BTreeMap<String, f64>,
) -> Reading<String> {
    let (mut text, mut end) = (String::new(), 0);
    for place in places(f) {
        let (before, after) = (&f[..place.start - 1], &f[place.end..]);
        text += &before[end..];
        end = place.end;
        let name = &f[place];
        let number = *numbers.get(name).ok_or_else(|| without_values(field, name))?;
        if is_in_formula(&unquoted(before)) {
            text += &format!("({})", Written(number));
            continue;
        }
        let (kept, sign) = without_sign(text.trim_end());
        let is_whole = field != "f" && kept.is_empty();
        if !is_whole && !kept.ends_with(['(', ',', '=', '/'])
            || is_in_region(&unquoted(before))
            || !after.trim_start_matches([' ', '\t', '\r']).starts_with([')', ',', '/', ';', '\n'])
                && !after.trim().is_empty()
        {
            let text = format!(
                "${name} in {field} is a number, and stands where one can, as in disc(0,0,$R)=$b or formula($a*x - 1)"
            );
            return Err(Refused::new(field, text));
        }
        text.truncate(kept.len());
        // A negative zero is written as zero.
        text += &Written(sign * number + 0.0).to_string();
    }
    Ok(text + &f[end..])
}

/// Returns a text without the sign at its end, and the sign as a factor.
fn without_sign(text: &str) -> (&str, f64) {
    match (text.strip_suffix('-'), text.strip_suffix('+')) {
        (Some(rest), _) => (rest.trim_end(), -1.0),
        (_, Some(rest)) => (rest.trim_end(), 1.0),
        _ => (text, 1.0),
    }
}

/// Returns a text without what stands in quotes.
fn unquoted(text: &str) -> String {
    text.split('"').step_by(2).collect()
}

/// True if the end of this beginning of an f is within the parentheses of a formula.
fn is_in_formula(before: &str) -> bool {
    let mut depth = 0;
    let Some((_, formula)) = before.rsplit_once("formula(") else { return false };
    formula.chars().all(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth >= 0
    })
}

/// True if the end of this beginning of an f is within the name of a region.
fn is_in_region(before: &str) -> bool {
    let item = before.rsplit([';', '\n']).next().unwrap_or_default();
    item.trim_start().starts_with("region(") && !item.contains('=')
}

/// Refusal of a name in f or a law that has no values.
pub(super) fn without_values(of: &str, name: &str) -> Refused {
    let text = match field(name) {
        Some(_) => {
            format!("{of} has ${name}, but `{name}` is a field; choose another name in {of}")
        }
        None => format!(
            "{of} has ${name}, which has no values; add vary = {{ {name} = [0.1, 0.2] }}, or --vary {name}=0.1,0.2"
        ),
    };
    Refused::new(of, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(f: &str, number: f64) -> Result<String, String> {
        let numbers = [("a".to_owned(), number), ("b".to_owned(), 0.5)].into();
        with_numbers("f", f, &numbers).map_err(|refused| refused.text)
    }

    #[test]
    fn numbers_stand_in_place_of_names_as_their_values() {
        for (f, number, expected) in [
            ("disc($a,0, $b )=-$a; else=- $a", -2.0, "disc(-2,0,0.5 )=2; else=2"),
            ("else=-1/$a", 0.25, "else=-1/0.25"),
            ("else=$a/3", -1e-7, "else=-1e-7/3"),
            ("else=+$a\n", -3.0, "else=-3\n"),
            ("else=-$a", 0.0, "else=0"),
            ("formula($a^2 - 1/$b)", -2.0, "formula((-2)^2 - 1/(0.5))"),
            (
                "region(\"$a\")=formula(-(x)*$a); else=$a",
                -2.0,
                "region(\"$a\")=formula(-(x)*(-2)); else=-2",
            ),
            ("region(c)=formula(x); region(d)=$a", 1.0, "region(c)=formula(x); region(d)=1"),
            ("region(\"formula(\")=$a", 1.0, "region(\"formula(\")=1"),
            ("region(\"$x\")=1; else=-$", 1.0, "region(\"$x\")=1; else=-$"),
        ] {
            assert_eq!(with(f, number).unwrap(), expected);
        }
    }

    #[test]
    fn names_that_are_no_numbers_are_refused() {
        for f in [
            "$a",
            "else=0.$a",
            "else=-$a$b",
            "else=--$a",
            "disc(0,0,0.1$a)=1",
            "region($a)=1",
            "else=$a 1",
            "region(c$a)=1",
            "exact(free-$a)",
            "else=$a*2",
            "1$a",
            "else=$b$a",
        ] {
            assert!(with(f, 1.0).unwrap_err().contains("in f is a number"), "{f}");
        }
        assert!(with("else=$h", 1.0).unwrap_err().contains("`h` is a field"));
        assert!(check_names("f", "else=$c").unwrap_err().text.contains("no values"));
    }
}
