//! Tables in the paper's layout, as CSV.

use crate::replication::comparison::Row;
use polars::prelude::*;
use std::io::Cursor;

/// The paper's layout: a row per r, a column of counts per grid (`1/4`, `1/8`, ...), and `delta_a`;
/// where counts on a grid were cut off by `max_iterations`, a column `capped 1/4` that says which.
///
/// # Errors
/// polars' own.
pub fn table_csv(rows: &[Row], cells: &[usize]) -> PolarsResult<Vec<u8>> {
    let mut columns: Vec<Column> =
        vec![Column::new("r".into(), rows.iter().map(|row| row.r).collect::<Vec<_>>())];
    for (level, n) in cells.iter().enumerate() {
        let counts: Vec<u64> = rows.iter().map(|row| row.counts[level] as u64).collect();
        columns.push(Column::new(format!("1/{n}").into(), counts));
    }
    let delta_a: Vec<f64> = rows.iter().map(|row| row.delta_a).collect();
    columns.push(Column::new("delta_a".into(), delta_a));
    for (level, n) in cells.iter().enumerate() {
        let capped: Vec<bool> = rows.iter().map(|row| row.capped[level]).collect();
        if capped.contains(&true) {
            columns.push(Column::new(format!("capped 1/{n}").into(), capped));
        }
    }
    DataFrame::new(rows.len(), columns).and_then(csv)
}

/// CSV with a header line.
///
/// # Errors
/// polars' own.
pub fn csv(mut frame: DataFrame) -> PolarsResult<Vec<u8>> {
    let mut bytes = Vec::new();
    CsvWriter::new(&mut bytes).finish(&mut frame)?;
    Ok(bytes)
}

/// Reads what [`csv`] wrote.
///
/// # Errors
/// polars' own.
pub fn read_csv(bytes: &[u8]) -> PolarsResult<DataFrame> {
    // Types from all rows: a column may begin with whole numbers, or with nothing.
    let options = CsvReadOptions::default().with_infer_schema_length(None);
    CsvReader::new(Cursor::new(bytes)).with_options(options).finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_has_all_digits_and_says_what_was_cut_off() {
        let row = |r, counts, cut, delta_a| Row { r, counts, capped: vec![false, cut], delta_a };
        let rows =
            [row(1e6, vec![1, 149], false, 1e-4 / 3.0), row(0.5, vec![3, 55], true, 3.53e-4)];
        expect_test::expect![[r#"
            r,1/4,1/8,delta_a,capped 1/8
            1000000.0,1,149,0.000033333333333333335,false
            0.5,3,55,0.000353,true
        "#]]
        .assert_eq(std::str::from_utf8(&table_csv(&rows, &[4, 8]).unwrap()).unwrap());
    }
}
