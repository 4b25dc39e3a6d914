//! Dependence of the published counts on rounding: the runs of the tables repeated with disturbed arithmetic.

mod runs;

use crate::experiments::power_of_ten;
use crate::experiments::problems::Problem;
use runs::disturb;
use serde::{Deserialize, Serialize};

/// Plan of the experiment.
#[derive(Clone, Debug, Serialize)]
pub struct RoundingPlan {
    /// The tables whose counts are disturbed.
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
    /// The sizes and repetitions of the book.
    pub fn new(tables: Vec<Problem>) -> Self {
        let sizes = (-15..=-2).map(power_of_ten).collect();
        Self { tables, sizes, repetitions: 100, further: 16, seed: 1 }
    }
}

/// Results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rounding {
    /// As in the [`RoundingPlan`].
    pub sizes: Vec<f64>,
    /// As in the [`RoundingPlan`].
    pub repetitions: usize,
    /// As in the [`RoundingPlan`].
    pub further: usize,
    /// The tables, in the order of the plan.
    pub tables: Vec<RoundingTable>,
    /// Number of counts.
    pub cells: usize,
    /// Counts that the least disturbance changes.
    pub fragile: usize,
    /// Counts that another order of operations changes.
    pub reordered: usize,
    /// The least size that changes any count.
    pub first_flip: Option<f64>,
    /// The cell with the least margin.
    pub nearest: Nearest,
}

/// One table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RoundingTable {
    /// Number in the paper.
    pub number: u8,
    /// Cells per side, coarsest grid first.
    pub grids: Vec<usize>,
    /// One row per r.
    pub rows: Vec<RoundingRow>,
    /// Of the sizes of the plan, how many counts each changes.
    pub changed: Vec<usize>,
}

impl RoundingTable {
    /// The margin of each count.
    fn margins<'a>(&'a self) -> impl Iterator<Item = Nearest> + 'a {
        let of_row = move |row: &'a RoundingRow| {
            let (table, r) = (self.number, row.r);
            let cells = self.grids.iter().zip(&row.cells);
            cells.map(move |(&cells, cell)| Nearest { table, r, cells, margin: cell.margin })
        };
        self.rows.iter().flat_map(of_row)
    }
}

/// The counts for one r.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RoundingRow {
    /// Duality parameter.
    pub r: f64,
    /// Per grid, coarsest first.
    pub cells: Vec<RoundingCell>,
}

/// One count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoundingCell {
    /// Iterations.
    pub count: usize,
    /// `1 - max dM/dy / tolerance` at the stop.
    pub below: f64,
    /// `max dM/dy / tolerance - 1` before, least over all iterations; none if the first one stopped.
    pub above: Option<f64>,
    /// The lesser of the two: the relative change of the residual that would change the count.
    pub margin: f64,
    /// Of the repetitions with the least size, how many gave another count: values disturbed at each update,
    /// or the load once.
    pub flips: usize,
    /// The least size that gave another count.
    pub flips_at: Option<f64>,
    /// True if another order of operations gives another count.
    pub reordered: bool,
}

/// Place at which the residual came nearest to the tolerance.
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
/// # Errors
/// If the plan is not one of tables: f cannot be read, grids do not nest, or the rule is not met.
pub fn rounding(plan: &RoundingPlan) -> Result<Rounding, String> {
    let tables =
        plan.tables.iter().map(|table| disturb(plan, table)).collect::<Result<Vec<_>, _>>()?;
    let cells = || tables.iter().flat_map(|table| &table.rows).flat_map(|row| &row.cells);
    let nearest =
        tables.iter().flat_map(RoundingTable::margins).min_by(|a, b| a.margin.total_cmp(&b.margin));
    Ok(Rounding {
        sizes: plan.sizes.clone(),
        repetitions: plan.repetitions,
        further: plan.further,
        cells: cells().count(),
        fragile: cells().filter(|cell| cell.flips > 0).count(),
        reordered: cells().filter(|cell| cell.reordered).count(),
        first_flip: cells().filter_map(|cell| cell.flips_at).min_by(f64::total_cmp),
        nearest: nearest.ok_or("no table to disturb")?,
        tables,
    })
}
