//! Tables of the data in pictures, in CSV.

/// Adds a line for each row of numbers, each behind the same names; what is not a number has an empty cell.
pub(super) fn add<const N: usize>(
    csv: &mut String,
    names: &[&str],
    rows: impl Iterator<Item = [f64; N]>,
) {
    let cell = |number: f64| if number.is_nan() { String::new() } else { number.to_string() };
    let names = || names.iter().map(|&name| name.to_owned());
    *csv += &lines(rows.map(|row| names().chain(row.map(cell)).collect()));
}

/// Lines of cells.
pub(super) fn lines(lines: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut csv = csv::Writer::from_writer(Vec::new());
    for line in lines {
        csv.write_record(line).expect("all lines have as many cells");
    }
    let bytes = csv.into_inner().expect("memory takes every byte");
    String::from_utf8(bytes).expect("cells are texts")
}

/// Number rounded to some significant digits.
pub(super) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().expect("a number")
}
