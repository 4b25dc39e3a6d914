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

/// Reads what [`table_csv`] wrote.
///
/// # Errors
/// polars' own.
pub fn read_table(bytes: &[u8]) -> PolarsResult<Vec<Row>> {
    let frame = read_csv(bytes)?;
    let floats = |name: &str| -> PolarsResult<Vec<f64>> {
        let column = frame.column(name)?.cast(&DataType::Float64)?;
        Ok(column.f64()?.iter().map(|v| v.unwrap_or(f64::NAN)).collect())
    };
    let (r, delta_a) = (floats("r")?, floats("delta_a")?);
    let names = frame.get_column_names().into_iter().filter(|name| name.starts_with("1/"));
    let grids: Vec<&str> = names.map(|name| name.as_str()).collect();
    let counts = grids.iter().map(|name| floats(name)).collect::<PolarsResult<Vec<_>>>()?;
    let capped = |name: &&str| match frame.column(&format!("capped {name}")) {
        Ok(column) => Ok(column.bool()?.iter().map(|v| v == Some(true)).collect()),
        Err(_) => Ok(vec![false; frame.height()]),
    };
    let capped = grids.iter().map(capped).collect::<PolarsResult<Vec<_>>>()?;
    let row = |k: usize| Row {
        r: r[k],
        counts: counts.iter().map(|column| column[k] as usize).collect(),
        capped: capped.iter().map(|column| column[k]).collect(),
        delta_a: delta_a[k],
    };
    Ok((0..frame.height()).map(row).collect())
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
    fn a_table_survives_its_csv_to_the_bit() {
        let rows = vec![
            Row { r: 1e6, counts: vec![1, 149], capped: vec![false; 2], delta_a: 1.0 / 3.0 * 1e-4 },
            Row { r: 0.5, counts: vec![3, 55], capped: vec![false; 2], delta_a: 3.53e-4 },
        ];
        let bytes = table_csv(&rows, &[4, 8]).unwrap();
        expect_test::expect![[r#"
            r,1/4,1/8,delta_a
            1000000.0,1,149,0.000033333333333333335
            0.5,3,55,0.000353
        "#]]
        .assert_eq(std::str::from_utf8(&bytes).unwrap());
        assert_eq!(read_table(&bytes).unwrap(), rows);
        let mut cut = rows;
        cut[1].capped[1] = true;
        let bytes = table_csv(&cut, &[4, 8]).unwrap();
        assert_eq!(read_table(&bytes).unwrap(), cut);
    }
}
