//! The published tables, the tolerance we declare for them, and the comparison with ours.

use crate::identify::Target;
use crate::pipeline::error::{Error, Result, from_toml};
use serde::{Deserialize, Serialize};

/// `pipeline/paper.toml`: facts as printed, and what we call a match.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Paper {
    /// Duality parameters, in the order of the rows.
    pub r: Vec<f64>,
    /// Tables 1 and 2.
    pub table: Vec<PublishedTable>,
}

/// One published table with its declared tolerances.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedTable {
    /// Number of the table.
    pub number: u8,
    /// `counts[k][level]`: iterations for `r[k]` on each grid.
    pub counts: Vec<Vec<usize>>,
    /// Delta a on the finest grid, per row.
    pub delta_a: Vec<f64>,
    /// A count is within tolerance if it differs by at most this share of the published one...
    pub count_share: f64,
    /// ...or by at most this many iterations.
    pub count_slack: usize,
    /// Delta a is within tolerance if the ratio of the two is at most this factor, either way.
    pub delta_a_factor: f64,
}

/// A row as computed: iteration counts per grid and Delta a on the finest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Duality parameter.
    pub r: f64,
    /// Iterations per grid.
    pub counts: Vec<usize>,
    /// Per grid, whether `max_iterations` cut the count off.
    pub capped: Vec<bool>,
    /// Delta a on the finest grid.
    pub delta_a: f64,
}

/// `diff --json`: every table compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Version of this format.
    pub schema: u8,
    /// One entry per compared table.
    pub tables: Vec<TableComparison>,
}

/// One table, ours against the paper's.
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
    /// Row by row.
    pub rows: Vec<RowComparison>,
}

/// One row, ours against the paper's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RowComparison {
    /// Duality parameter.
    pub r: f64,
    /// Published counts.
    pub paper: Vec<usize>,
    /// Our counts.
    pub ours: Vec<usize>,
    /// Per count of ours, whether `max_iterations` cut it off; left out where none is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub capped: Vec<bool>,
    /// Per count, whether it is within tolerance.
    pub within: Vec<bool>,
    /// Published Delta a.
    pub delta_a_paper: f64,
    /// Our Delta a.
    pub delta_a_ours: f64,
    /// Whether Delta a is within tolerance.
    pub delta_a_within: bool,
}

impl Paper {
    /// Parses and validates `pipeline/paper.toml`.
    ///
    /// # Errors
    /// [`Error::Input`] with the line of the mistake.
    pub fn parse(text: &str) -> Result<Self> {
        let paper: Self = from_toml("pipeline/paper.toml", text)?;
        let wrong = |what: &str| Err(Error::input(format!("pipeline/paper.toml: {what}")));
        if paper.r.is_empty() || !paper.r.iter().all(|r| r.is_finite() && *r > 0.0) {
            return wrong("`r` must list positive numbers");
        }
        for (k, t) in paper.table.iter().enumerate() {
            let number = t.number;
            if let Some(why) = t.mistake(paper.r.len()) {
                return wrong(&format!("table {number} {why}"));
            }
            if paper.table[..k].iter().any(|other| other.number == number) {
                return wrong(&format!("two tables have the number {number}; change one"));
            }
        }
        Ok(paper)
    }

    /// The published table of this number.
    ///
    /// # Errors
    /// [`Error::Input`] if there is none.
    pub fn published(&self, number: u8) -> Result<&PublishedTable> {
        self.table.iter().find(|table| table.number == number).ok_or_else(|| {
            let known: Vec<_> = self.table.iter().map(|t| t.number.to_string()).collect();
            let known = if known.is_empty() { "none".into() } else { known.join(", ") };
            Error::input(format!("pipeline/paper.toml has no table {number}; it has {known}"))
        })
    }

    /// The rows of the published table of this number, if there is one.
    pub fn printed(&self, number: u8) -> Option<Target> {
        let table = self.table.iter().find(|table| table.number == number)?;
        let (counts, delta_a) = (table.counts.clone(), table.delta_a.clone());
        Some(Target { r: self.r.clone(), counts, delta_a })
    }

    /// The published table of this number as a search takes it.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no such table, or it holds what no run can give.
    pub fn target(&self, number: u8) -> Result<Target> {
        self.published(number)?;
        let target = self.printed(number).unwrap_or_default();
        let wrong = |e| Error::input(format!("pipeline/paper.toml, table {number}: {e}"));
        target.validate().map_err(wrong)?;
        Ok(target)
    }

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
                    "scene `{scene}`: no row r = {r} on {} grids to compare with table {number}; ask for it in the scene",
                    table.counts[k].len()
                ))
            })?;
            // A count that was cut off says only that the true one is larger.
            let near = |(level, &count): (usize, &usize)| {
                !row.capped[level] && table.near(count, table.counts[k][level])
            };
            let within = row.counts.iter().enumerate().map(near).collect();
            let capped = if row.capped.contains(&true) { row.capped.clone() } else { Vec::new() };
            rows.push(RowComparison {
                r,
                paper: table.counts[k].clone(),
                ours: row.counts.clone(),
                capped,
                within,
                delta_a_paper: table.delta_a[k],
                delta_a_ours: row.delta_a,
                delta_a_within: {
                    let ratio = row.delta_a / table.delta_a[k];
                    ratio <= table.delta_a_factor && ratio >= 1.0 / table.delta_a_factor
                },
            });
        }
        let count = |of: &dyn Fn(&RowComparison) -> usize| rows.iter().map(of).sum();
        Ok(TableComparison {
            table: number,
            scene: scene.into(),
            cells: count(&|row| row.paper.len()),
            exact: count(&|row| {
                (0..row.ours.len()).filter(|&level| row.count_exact(level)).count()
            }),
            within_tolerance: count(&|row| row.within.iter().filter(|w| **w).count()),
            delta_a_within: count(&|row| usize::from(row.delta_a_within)),
            delta_a_exact: count(&|row| usize::from(row.delta_a_exact())),
            tolerance: table.tolerance(),
            rows,
        })
    }
}

impl PublishedTable {
    /// The declared tolerance in words: when a cell counts as within it.
    fn tolerance(&self) -> String {
        let counts = match (self.count_share, self.count_slack) {
            (0.0, 0) => "a count equals the published one".to_owned(),
            (share, slack) => format!(
                "a count differs by at most {} % or {slack} iterations",
                (1000.0 * share).round() / 10.0
            ),
        };
        format!("{counts}, a Delta a is within a factor of {}", self.delta_a_factor)
    }

    /// What is wrong with its numbers, of which there is to be one row for each of `rows` values of r.
    fn mistake(&self, rows: usize) -> Option<String> {
        let width = self.counts.first().map_or(0, Vec::len);
        if width == 0 {
            return Some("has no counts".into());
        }
        if self.counts.len() != rows
            || self.delta_a.len() != rows
            || self.counts.iter().any(|row| row.len() != width)
        {
            return Some("does not have one full row per r".into());
        }
        if let Some(value) = self.delta_a.iter().find(|v| !(**v > 0.0 && v.is_finite())) {
            return Some(format!("has delta_a = {value}, which must be a positive number"));
        }
        if !(self.count_share >= 0.0 && self.count_share.is_finite()) {
            let share = self.count_share;
            return Some(format!(
                "has count_share = {share}, which must be a number from 0 on, such as 0.05"
            ));
        }
        if !(self.delta_a_factor >= 1.0 && self.delta_a_factor.is_finite()) {
            let factor = self.delta_a_factor;
            return Some(format!(
                "has delta_a_factor = {factor}, which must be a number from 1 on, such as 1.5"
            ));
        }
        None
    }

    fn near(&self, ours: usize, paper: usize) -> bool {
        let difference = ours.abs_diff(paper);
        difference <= self.count_slack || difference as f64 <= self.count_share * paper as f64
    }
}

impl RowComparison {
    /// Whether the count on this grid was cut off by `max_iterations`.
    pub fn is_capped(&self, level: usize) -> bool {
        self.capped.get(level) == Some(&true)
    }

    /// Whether the count on this grid is the published one.
    pub fn count_exact(&self, level: usize) -> bool {
        self.ours[level] == self.paper[level] && !self.is_capped(level)
    }

    /// Whether Delta a agrees to the two digits that the paper prints.
    pub fn delta_a_exact(&self) -> bool {
        format!("{:.1e}", self.delta_a_ours) == format!("{:.1e}", self.delta_a_paper)
    }
}

impl Comparison {
    /// Whether every count and every Delta a is within the declared tolerance.
    pub fn holds(&self) -> bool {
        self.tables
            .iter()
            .all(|t| t.within_tolerance == t.cells && t.delta_a_within == t.rows.len())
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
        assert!(!Comparison { schema: 1, tables: vec![table] }.holds());
    }

    #[test]
    fn missing_rows_and_ragged_tables_are_errors() {
        let paper = Paper::parse(TEXT).unwrap();
        assert!(paper.compare(2, "s", &ours()).unwrap_err().to_string().contains("no table 2"));
        assert!(
            paper.compare(1, "s", &ours()[..1]).unwrap_err().to_string().contains("r = 1000000")
        );
        assert!(Paper::parse(&TEXT.replace("[2, 200]", "[2]")).is_err());
        for (from, to) in [
            ("delta_a = [1e-4", "delta_a = [nan"),
            ("factor = 1.5", "factor = inf"),
            ("share = 0.05", "share = nan"),
            ("r = [1e6, 10]", "r = []"),
            ("r = [1e6", "r = [inf"),
            ("[[1, 100], [2, 200]]", "[[], []]"),
        ] {
            assert!(TEXT.contains(from) && Paper::parse(&TEXT.replace(from, to)).is_err(), "{to}");
        }
    }
}
