//! Dependence of the published counts on rounding: the runs of the tables repeated with disturbed arithmetic.

mod disturbances;
mod runs;

use crate::experiments::power_of_ten;
use crate::experiments::problems::Problem;
use rayon::prelude::*;
use runs::{RandomErrors, Undisturbed};
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
    /// Least of the largest relative disturbances in the [`RoundingPlan`].
    pub size: f64,
    /// Repetitions for the least size, as in the [`RoundingPlan`].
    pub repetitions: usize,
    /// Repetitions for each other size, as in the [`RoundingPlan`].
    pub further: usize,
    /// Counts that the least disturbance changes.
    pub fragile: usize,
    /// Counts that another order of operations changes.
    pub reordered: usize,
    /// Least size that changes any count.
    pub first_flip: Option<f64>,
    /// Count with the least margin.
    pub nearest: Nearest,
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
    /// Least distance of `max dM/dy` from the tolerance over all iterations, over the tolerance: the relative change of
    /// the residual that would change the count.
    pub margin: f64,
}

/// Runs the experiment.
///
/// 1. Makes the runs of each table, and records how near the residual comes to the tolerance.
/// 2. Repeats them with sums in another order, and with fused operations.
/// 3. Repeats them with random relative errors, at each update of a value or once in the load: of the least size, then
///    of greater ones, until a count changes.
///
/// # Errors
/// If the plan is not one of tables: f cannot be read, grids do not nest, or the rule is not met.
pub fn rounding(plan: &RoundingPlan) -> Result<Rounding, String> {
    let size = *plan.sizes.first().ok_or("no size of disturbances")?;
    let (mut tables, mut reordered) = (Vec::new(), 0);
    for problem in &plan.tables {
        let table = Undisturbed::new(problem)?;
        reordered += table.reordered()?;
        tables.push(table);
    }
    let margins = tables.iter().flat_map(Undisturbed::margins);
    let nearest = margins.min_by(|a, b| a.margin.total_cmp(&b.margin));
    let (mut fragile, mut first_flip) = (0, None);
    for (k, &size) in plan.sizes.iter().enumerate() {
        let repetitions = if k == 0 { plan.repetitions } else { plan.further };
        let errors = RandomErrors { size, repetitions, seed: plan.seed };
        let changed: usize = tables.par_iter().map(|table| table.changed_by(&errors)).sum();
        if k == 0 {
            fragile = changed;
        }
        if changed > 0 {
            first_flip = Some(size);
            break;
        }
    }
    Ok(Rounding {
        size,
        repetitions: plan.repetitions,
        further: plan.further,
        fragile,
        reordered,
        first_flip,
        nearest: nearest.ok_or("no table to disturb")?,
    })
}
