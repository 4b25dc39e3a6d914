//! Tables of the data in pictures: CSV with a header line.

use crate::table::quoted;

/// Adds a line for each row of numbers, each behind the same names; what is not a number has an empty cell.
pub(super) fn add<const N: usize>(
    csv: &mut String,
    names: &[&str],
    rows: impl Iterator<Item = [f64; N]>,
) {
    let names: Vec<String> = names.iter().map(|name| quoted(name)).collect();
    for row in rows {
        *csv += &names.join(",");
        for number in row {
            *csv += &if number.is_nan() { ",".to_owned() } else { format!(",{number}") };
        }
        csv.push('\n');
    }
}

/// Number rounded to some significant digits.
pub(super) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().expect("a number")
}
