//! Dependence of the published counts on rounding: the runs of the tables repeated with disturbed arithmetic.

mod runs;

use crate::experiments::power_of_ten;
use crate::experiments::problems::Problem;
use runs::disturb;
use serde::{Deserialize, Serialize};

/// Input of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct RoundingPlan {
    /// Tables whose counts are disturbed.
    pub tables: Vec<Problem>,
    /// Largest relative disturbances, ascending.
    pub sizes: Vec<f64>,
    /// Repetitions for the least size; a count that any of them changes is fragile.
    pub repetitions: usize,
    /// Repetitions for each other size.
    pub further: usize,
    /// Seed of the disturbances.
    pub seed: u64,
}

impl RoundingPlan {
    /// Sizes and repetitions of the book.
    pub fn new(tables: Vec<Problem>) -> Self {
        let sizes = (-15..=-2).map(power_of_ten).collect();
        Self { tables, sizes, repetitions: 100, further: 16, seed: 1 }
    }
}

/// Result of the experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rounding {
    /// Largest relative disturbances, as in the [`RoundingPlan`].
    pub sizes: Vec<f64>,
    /// Repetitions for the least size, as in the [`RoundingPlan`].
    pub repetitions: usize,
    /// Repetitions for each other size, as in the [`RoundingPlan`].
    pub further: usize,
    /// Tables, in the order of the plan.
    pub tables: Vec<RoundingTable>,
    /// Number of counts.
    pub cells: usize,
    /// Counts that the least disturbance changes.
    pub fragile: usize,
    /// Counts that another order of operations changes.
    pub reordered: usize,
    /// Least size that changes any count.
    pub first_flip: Option<f64>,
    /// Count with the least margin.
    pub nearest: Nearest,
}

/// Counts of one table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RoundingTable {
    /// Number of the table in the paper.
    pub number: u8,
    /// Cells per side, coarsest grid first.
    pub grids: Vec<usize>,
    /// Rows, one per r.
    pub rows: Vec<RoundingRow>,
    /// Number of changed counts for each of the sizes in the plan.
    pub changed: Vec<usize>,
}

impl RoundingTable {
    /// Margin of each count.
    fn margins(&self) -> Vec<Nearest> {
        let mut margins = Vec::new();
        for row in &self.rows {
            for (&cells, cell) in self.grids.iter().zip(&row.cells) {
                let (table, r) = (self.number, row.r);
                margins.push(Nearest { table, r, cells, margin: cell.margin });
            }
        }
        margins
    }
}

/// Counts for one r.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RoundingRow {
    /// Duality parameter.
    pub r: f64,
    /// Counts, one per grid, coarsest first.
    pub cells: Vec<RoundingCell>,
}

/// One count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoundingCell {
    /// Iterations.
    pub count: usize,
    /// `1 - max dM/dy / tolerance` at the stop.
    pub below: f64,
    /// Least `max dM/dy / tolerance - 1` over the iterations before the stop; none if the first iteration stopped.
    pub above: Option<f64>,
    /// Lesser of `below` and `above`: the relative change of the residual that would change the count.
    pub margin: f64,
    /// Number of repetitions with the least size that gave another count: values are disturbed at each update, or the
    /// load is, once.
    pub flips: usize,
    /// Least size that gave another count.
    pub flips_at: Option<f64>,
    /// True if another order of operations gives another count.
    pub reordered: bool,
}

/// Margin of one count, and its place in the tables.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Nearest {
    /// Table.
    pub table: u8,
    /// Duality parameter.
    pub r: f64,
    /// Cells per side.
    pub cells: usize,
    /// Margin.
    pub margin: f64,
}

/// Runs the experiment.
///
/// 1. Makes the runs of each table, and records how near the residual comes to the tolerance.
/// 2. Repeats them with sums in another order, and with fused operations.
/// 3. Repeats them with random relative errors of each size, at each update of a value or once in the load.
/// 4. Compares the counts.
///
/// # Errors
/// If the plan is not one of tables: f cannot be read, grids do not nest, or the rule is not met.
pub fn rounding(plan: &RoundingPlan) -> Result<Rounding, String> {
    let mut tables = Vec::new();
    for problem in &plan.tables {
        tables.push(disturb(plan, problem)?);
    }
    let margins = tables.iter().flat_map(RoundingTable::margins);
    let nearest = margins.min_by(|a, b| a.margin.total_cmp(&b.margin));
    let rows = tables.iter().flat_map(|table| &table.rows);
    let cells: Vec<_> = rows.flat_map(|row| &row.cells).copied().collect();
    Ok(Rounding {
        sizes: plan.sizes.clone(),
        repetitions: plan.repetitions,
        further: plan.further,
        tables,
        cells: cells.len(),
        fragile: cells.iter().filter(|cell| cell.flips > 0).count(),
        reordered: cells.iter().filter(|cell| cell.reordered).count(),
        first_flip: cells.iter().filter_map(|cell| cell.flips_at).min_by(f64::total_cmp),
        nearest: nearest.ok_or("no table to disturb")?,
    })
}
