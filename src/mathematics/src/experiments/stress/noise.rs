//! Counts of the tables with loads that are a little off, as another quadrature or another order of sums makes them.

use crate::discrete::grid::Grid;
use crate::experiments::numbers::RandomNumbers;
use crate::experiments::power_of_ten;
use crate::experiments::problems::TableProblem;
use crate::problem::law::Law;
use crate::saddle::jobs::{NestedJob, run_all_nested};
use crate::saddle::{NestedGrids, StopRule};
use rayon::prelude::*;
use serde::Serialize;

/// Exponents of the powers of ten that bound the relative errors of the load.
const EXPONENTS: std::ops::RangeInclusive<i32> = -15..=-2;
/// Repetitions for each r and size of the errors.
const REPETITIONS: u64 = 16;
/// Repetitions in a batch, so that few lanes are idle.
const TOGETHER: usize = 4;

/// Sizes of random relative errors of the load, and the least one that changes a count.
#[derive(Serialize)]
pub(super) struct LoadNoise {
    /// Least size tried.
    least: f64,
    /// Repetitions for each r and size.
    repetitions: u64,
    /// Least size that changes a count; none if no size that was tried does.
    first_change: Option<f64>,
}

impl LoadNoise {
    /// Repeats the runs of each table with random errors in the entries of all load vectors, of greater and greater
    /// size, until a count changes.
    pub(super) fn of(tables: &[TableProblem]) -> Result<Self, String> {
        let tables: Vec<Undisturbed> =
            tables.iter().map(Undisturbed::new).collect::<Result<_, _>>()?;
        let mut sizes = EXPONENTS.map(power_of_ten);
        let first_change = sizes.find(|&size| tables.iter().any(|table| table.changes(size)));
        let least = power_of_ten(*EXPONENTS.start());
        Ok(Self { least, repetitions: REPETITIONS, first_change })
    }
}

/// Undisturbed of counts without errors.
struct Undisturbed<'a> {
    problem: &'a TableProblem,
    grids: Vec<Grid>,
    loads: Vec<Vec<f64>>,
    /// Counts, per r and grid.
    counts: Vec<Vec<usize>>,
}

/// One r of a table with the load vectors of one repetition.
struct Repeated {
    /// Index of r in the table.
    row: usize,
    loads: Vec<Vec<f64>>,
}

impl<'a> Undisturbed<'a> {
    fn new(problem: &'a TableProblem) -> Result<Self, String> {
        let (f, grids) = problem.on_grids()?;
        let loads = problem.loads(&f, &grids);
        let mut table = Self { problem, grids, loads, counts: Vec::new() };
        let rows = 0..problem.r.len();
        let undisturbed: Vec<_> =
            rows.map(|row| Repeated { row, loads: table.loads.clone() }).collect();
        for counts in table.runs(&undisturbed, |_, _| usize::MAX) {
            let counts: Option<Vec<usize>> = counts.into_iter().collect();
            table.counts.push(counts.ok_or_else(|| {
                format!("table {}: a run does not meet its rule", problem.number)
            })?);
        }
        Ok(table)
    }

    /// True if errors of this size change a count in a repetition.
    fn changes(&self, size: f64) -> bool {
        let repetitions: Vec<u64> = (0..REPETITIONS).collect();
        repetitions.par_chunks(TOGETHER).any(|some| {
            let repeated: Vec<_> = some.iter().flat_map(|k| self.disturbed(size, *k)).collect();
            // One sweep more than the count would show a late stop; with the others a finer grid starts from about
            // where a run without a limit would end.
            let runs = self.runs(&repeated, |row, grid| self.counts[row][grid] + 10);
            let mut ran = repeated.iter().zip(runs);
            ran.any(|(of, counts)| {
                !counts.into_iter().eq(self.counts[of.row].iter().map(|&n| Some(n)))
            })
        })
    }

    /// Returns all rows with load vectors whose entries are off by random relative errors of at most `size`.
    fn disturbed(&self, size: f64, repetition: u64) -> Vec<Repeated> {
        let mut rows = Vec::new();
        for (row, r) in self.problem.r.iter().enumerate() {
            let stream = size.to_bits() ^ r.to_bits().rotate_left(17) ^ repetition;
            let mut random = RandomNumbers::new(1, stream);
            let mut loads = self.loads.clone();
            for entry in loads.iter_mut().flatten() {
                *entry += *entry * (size * (2.0 * random.unit() - 1.0));
            }
            rows.push(Repeated { row, loads });
        }
        rows
    }

    /// Returns the counts, per row and grid; none where the rule was not met within the limit of the row and grid.
    fn runs(
        &self,
        repeated: &[Repeated],
        limit: impl Fn(usize, usize) -> usize,
    ) -> Vec<Vec<Option<usize>>> {
        let mut nested = Vec::new();
        for Repeated { row, loads } in repeated {
            let (law, r, rule) = (Law::SIGNORINI, self.problem.r[*row], StopRule::Signed);
            nested.push(NestedJob { law, loads, r, rule });
        }
        let grids =
            NestedGrids { grids: &self.grids, prolongation: self.problem.saddle().prolongation };
        let all = run_all_nested(&grids, &nested, |run, grid| limit(repeated[run].row, grid));
        all.iter().map(|ends| ends.iter().map(|(end, _)| end.count()).collect()).collect()
    }
}
