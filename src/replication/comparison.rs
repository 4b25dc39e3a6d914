//! Our tables against the published ones, cell by cell.

use super::paper::{Paper, PublishedTable};
use crate::pipeline::error::{Error, Result};
use serde::{Deserialize, Serialize};
use signorini_mathematics::identify::agrees;
use signorini_mathematics::problem::text::{Written, percent};
use std::fmt;

/// Computed row of a table: iteration counts per grid and Delta a on the finest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Duality parameter.
    pub r: f64,
    /// Iterations per grid.
    pub counts: Vec<usize>,
    /// Per grid, true if `max_iterations` cut the count off.
    pub capped: Vec<bool>,
    /// Delta a on the finest grid.
    pub delta_a: f64,
}

impl Row {
    /// True if `max_iterations` cut off the count on this grid.
    pub(crate) fn is_capped(&self, level: usize) -> bool {
        self.capped.get(level) == Some(&true)
    }
}

/// Comparison of a computed table with the published one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TableComparison {
    /// Number of the published table.
    pub table: u8,
    /// Scene that was compared.
    pub scene: String,
    /// Number of counts compared.
    pub cells: usize,
    /// Counts that agree exactly.
    pub exact: usize,
    /// Counts within the declared tolerance, the exact ones included.
    pub within_tolerance: usize,
    /// Values of Delta a within the declared factor.
    pub delta_a_within: usize,
    /// Values of Delta a that agree to the two printed digits.
    pub delta_a_exact: usize,
    /// The declared tolerance, in words.
    pub tolerance: String,
    /// Comparison of each row.
    pub rows: Vec<RowComparison>,
}

/// Comparison of a computed row with the published one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowComparison {
    /// Duality parameter.
    pub r: f64,
    /// Published counts.
    pub paper: Vec<usize>,
    /// Our counts.
    pub ours: Vec<usize>,
    /// Per count of ours, true if `max_iterations` cut it off; empty if all are false.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub capped: Vec<bool>,
    /// Per count, true if it is within tolerance.
    pub within: Vec<bool>,
    /// Published Delta a.
    pub delta_a_paper: f64,
    /// Our Delta a.
    pub delta_a_ours: f64,
    /// True if Delta a is within tolerance.
    pub delta_a_within: bool,
}

impl Paper {
    /// Compares computed rows with the published table of this number.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no such table or the rows are for other r or other grids.
    pub fn compare(&self, number: u8, scene: &str, ours: &[Row]) -> Result<TableComparison> {
        let table = self.published(number)?;
        let mut rows = Vec::new();
        for (k, &r) in self.r.iter().enumerate() {
            let row =
                ours.iter().find(|row| row.r == r && row.counts.len() == table.counts[k].len());
            let row = row.ok_or_else(|| {
                Error::input(format!(
                    "scene `{scene}`: no row r = {r} on {} grids to compare with table {number}; ask for just these \
                     grids and for this r in the scene, or leave out its `paper_table`",
                    table.counts[k].len()
                ))
            })?;
            let mut within = Vec::new();
            for (level, &count) in row.counts.iter().enumerate() {
                // A count that was cut off says only that the true one is larger.
                within.push(!row.capped[level] && table.near(count, table.counts[k][level]));
            }
            let capped = if row.capped.contains(&true) { row.capped.clone() } else { Vec::new() };
            let ratio = row.delta_a / table.delta_a[k];
            rows.push(RowComparison {
                r,
                paper: table.counts[k].clone(),
                ours: row.counts.clone(),
                capped,
                within,
                delta_a_paper: table.delta_a[k],
                delta_a_ours: row.delta_a,
                delta_a_within: ratio <= table.delta_a_factor
                    && ratio >= 1.0 / table.delta_a_factor,
            });
        }
        Ok(TableComparison {
            table: number,
            scene: scene.into(),
            cells: rows.iter().map(|row| row.paper.len()).sum(),
            exact: rows.iter().map(RowComparison::exact_counts).sum(),
            within_tolerance: rows.iter().flat_map(|row| &row.within).filter(|w| **w).count(),
            delta_a_within: rows.iter().filter(|row| row.delta_a_within).count(),
            delta_a_exact: rows.iter().filter(|row| row.delta_a_exact()).count(),
            tolerance: table.tolerance(),
            rows,
        })
    }
}

impl PublishedTable {
    /// Returns the declared tolerance in words.
    fn tolerance(&self) -> String {
        let counts = match (self.count_share, self.count_slack) {
            (0.0, 0) => "counts equal the published ones".to_owned(),
            (share, slack) => {
                format!("counts differ by at most {} or {slack} iterations", percent(share, 3))
            }
        };
        format!("{counts}, Delta a within a factor of {}", Written(self.delta_a_factor))
    }

    /// True if our count is within tolerance of the published one.
    fn near(&self, ours: usize, paper: usize) -> bool {
        let difference = ours.abs_diff(paper);
        difference <= self.count_slack || difference as f64 <= self.count_share * paper as f64
    }
}

impl RowComparison {
    /// True if `max_iterations` cut off the count on this grid.
    pub fn is_capped(&self, level: usize) -> bool {
        self.capped.get(level) == Some(&true)
    }

    /// True if the count on this grid is the published one.
    pub fn count_exact(&self, level: usize) -> bool {
        self.ours[level] == self.paper[level] && !self.is_capped(level)
    }

    /// Number of counts that are the published ones.
    fn exact_counts(&self) -> usize {
        (0..self.ours.len()).filter(|&level| self.count_exact(level)).count()
    }

    /// True if Delta a agrees to the two digits that the paper prints.
    pub fn delta_a_exact(&self) -> bool {
        agrees(self.delta_a_ours, self.delta_a_paper)
    }
}

/// Comparisons of all tables of a project.
pub(crate) struct Tables<'a>(pub(crate) &'a [TableComparison]);

impl Tables<'_> {
    /// True if every count and every Delta a of every table is within the declared tolerance.
    pub(crate) fn hold(&self) -> bool {
        self.0.iter().all(TableComparison::holds)
    }
}

impl fmt::Display for Tables<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sum = |of: fn(&TableComparison) -> usize| self.0.iter().map(of).sum::<usize>();
        let (exact, cells) = (sum(|table| table.exact), sum(|table| table.cells));
        let (delta_a, rows) = (sum(|table| table.delta_a_exact), sum(|table| table.rows.len()));
        let numbers: Vec<_> = self.0.iter().map(|table| table.table.to_string()).collect();
        let names = match &numbers[..] {
            [one] => format!("Table {one}"),
            [others @ .., last] => format!("Tables {} and {last}", others.join(", ")),
            [] => return out.write_str("no table"),
        };
        write!(
            out,
            "{names}: {exact} of {cells} counts as published, {delta_a} of {rows} Delta a to both digits"
        )
    }
}

impl TableComparison {
    /// True if every count is the published one.
    pub(crate) fn all_counts_exact(&self) -> bool {
        self.exact == self.cells
    }

    /// True if every count and every Delta a is within the declared tolerance.
    pub fn holds(&self) -> bool {
        self.within_tolerance == self.cells && self.delta_a_within == self.rows.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "r = [1e6, 10]\n[[table]]\nnumber = 1\ncounts = [[1, 100], [2, 200]]\n\
        delta_a = [1e-4, 2e-4]\ncount_share = 0.05\ncount_slack = 1\ndelta_a_factor = 1.5\n";

    fn ours() -> Vec<Row> {
        vec![
            Row { r: 10.0, counts: vec![3, 211], capped: vec![false; 2], delta_a: 2.04e-4 },
            Row { r: 1e6, counts: vec![1, 105], capped: vec![false; 2], delta_a: 1.6e-4 },
        ]
    }

    #[test]
    fn exact_and_tolerated_cells_are_counted_apart() {
        let table = Paper::parse(TEXT).unwrap().compare(1, "s", &ours()).unwrap();
        assert_eq!((table.cells, table.exact, table.within_tolerance), (4, 1, 3));
        assert_eq!(table.rows[1].within, [true, false]);
        assert_eq!((table.delta_a_within, table.delta_a_exact), (1, 1));
        assert!(!table.holds());
    }

    #[test]
    fn missing_rows_and_tables_are_errors() {
        let paper = Paper::parse(TEXT).unwrap();
        assert!(paper.compare(2, "s", &ours()).unwrap_err().to_string().contains("no table 2"));
        assert!(
            paper.compare(1, "s", &ours()[..1]).unwrap_err().to_string().contains("r = 1000000")
        );
    }
}
