//! How far the published counts depend on rounding: the runs of the tables repeated with disturbed arithmetic.

use super::reference::{Arithmetic, Fused, Noisy, Plain, Reversed, nested_counts};
use crate::discrete::grid::{Grid, nested};
use crate::discrete::load::{LoadRule, load};
use crate::discrete::transfer::Prolongation;
use crate::identify::random::Random;
use crate::problem::source::Source;
use crate::saddle::{Iteration, Monitor, Params, StopRule, solve_nested, tolerance};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// What the experiment depends on.
#[derive(Clone, Debug, Serialize)]
pub struct Plan {
    /// The tables whose counts are disturbed.
    pub tables: Vec<TablePlan>,
    /// Largest relative disturbances, ascending.
    pub sizes: Vec<f64>,
    /// Repetitions for the least size; a count that any of them changes is fragile.
    pub repetitions: usize,
    /// Repetitions for each other size.
    pub further: usize,
    /// Seed of the disturbances.
    pub seed: u64,
}

/// One table of counts.
#[derive(Clone, Debug, Serialize)]
pub struct TablePlan {
    /// Its number in the paper.
    pub number: u8,
    /// Right-hand side, as scenes write it.
    pub f: String,
    /// Quadrature of the load vector.
    pub load: LoadRule,
    /// Interpolation to the next grid.
    pub prolongation: Prolongation,
    /// Cells per side, coarsest grid first.
    pub grids: Vec<usize>,
    /// Duality parameters.
    pub r: Vec<f64>,
}

impl Plan {
    /// The sizes and repetitions of the book.
    pub fn new(tables: Vec<TablePlan>) -> Self {
        let sizes = (2..=15).rev().map(|k| 1.0 / libm::pow(10.0, f64::from(k))).collect();
        Self { tables, sizes, repetitions: 100, further: 16, seed: 1 }
    }
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rounding {
    /// As in the [`Plan`].
    pub sizes: Vec<f64>,
    /// As in the [`Plan`].
    pub repetitions: usize,
    /// As in the [`Plan`].
    pub further: usize,
    /// The tables, in the order of the plan.
    pub tables: Vec<Table>,
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
pub struct Table {
    /// Its number in the paper.
    pub number: u8,
    /// Cells per side, coarsest grid first.
    pub grids: Vec<usize>,
    /// One row per r.
    pub rows: Vec<Row>,
    /// Of the sizes of the plan, how many counts each changes.
    pub changed: Vec<usize>,
}

/// The counts for one r.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Duality parameter.
    pub r: f64,
    /// Per grid, coarsest first.
    pub cells: Vec<Cell>,
}

/// One count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
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
    /// Whether another order of operations gives another count.
    pub reordered: bool,
}

/// Where the residual came nearest to the tolerance.
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
pub fn rounding(plan: &Plan) -> Result<Rounding, String> {
    let tables =
        plan.tables.iter().map(|table| disturb(plan, table)).collect::<Result<Vec<_>, _>>()?;
    let all = || {
        tables.iter().flat_map(|table| {
            table.rows.iter().flat_map(move |row| {
                row.cells.iter().enumerate().map(move |(k, cell)| (table, row.r, k, cell))
            })
        })
    };
    let nearest = all().min_by(|a, b| a.3.margin.total_cmp(&b.3.margin));
    let (table, r, k, cell) = nearest.ok_or("no table to disturb")?;
    Ok(Rounding {
        sizes: plan.sizes.clone(),
        repetitions: plan.repetitions,
        further: plan.further,
        cells: all().count(),
        fragile: all().filter(|(.., cell)| cell.flips > 0).count(),
        reordered: all().filter(|(.., cell)| cell.reordered).count(),
        first_flip: all().filter_map(|(.., cell)| cell.flips_at).min_by(f64::total_cmp),
        nearest: Nearest { table: table.number, r, cells: table.grids[k], margin: cell.margin },
        tables,
    })
}

/// The column of one r: its grids, loads, and undisturbed counts.
struct Column<'a> {
    plan: &'a TablePlan,
    grids: &'a [Grid],
    loads: &'a [Vec<f64>],
    r: f64,
    counts: Vec<usize>,
}

fn disturb(plan: &Plan, table: &TablePlan) -> Result<Table, String> {
    let f: Source = table.f.parse().map_err(|e| format!("{e}"))?;
    let grids = nested(&table.grids).map_err(|e| e.to_string())?;
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, &f, table.load)).collect();
    let rows = table
        .r
        .iter()
        .map(|&r| {
            let mut near = Margins::default();
            let params = Params { r, rule: StopRule::Signed, ..Params::default() };
            let (outcomes, _) =
                solve_nested(&grids, &loads, &params, table.prolongation, &mut near);
            let counts = outcomes.iter().map(|outcome| outcome.iterations).collect();
            let column = Column { plan: table, grids: &grids, loads: &loads, r, counts };
            row(plan, &column, &near)
        })
        .collect::<Result<Vec<_>, String>>()?;
    let cells = || rows.iter().flat_map(|row: &Row| &row.cells);
    let changed = plan
        .sizes
        .iter()
        .map(|size| cells().filter(|cell| cell.flips_at.is_some_and(|at| at <= *size)).count())
        .collect();
    Ok(Table { number: table.number, grids: table.grids.clone(), rows, changed })
}

/// How near the residual came to the tolerance on each grid.
#[derive(Default)]
struct Margins {
    /// Per grid: least excess over the tolerance before the stop, and what is left of it at the stop.
    levels: Vec<(Option<f64>, f64)>,
}

impl Monitor for Margins {
    fn wants_iterations(&self) -> bool {
        true
    }

    fn iteration(&mut self, level: usize, iteration: &Iteration) -> ControlFlow<()> {
        self.levels.resize(level, (None, f64::NAN));
        let (above, below) = &mut self.levels[level - 1];
        let excess = iteration.gradient_signed / tolerance(level) - 1.0;
        if excess > 0.0 {
            *above = Some(above.map_or(excess, |least| least.min(excess)));
        } else {
            *below = -excess;
        }
        ControlFlow::Continue(())
    }
}

impl Column<'_> {
    /// On which grids the count is another one.
    fn changed(&self, arithmetic: &mut impl Arithmetic<f64>, loads: &[Vec<f64>]) -> Vec<bool> {
        // One more would tell a late stop; the others let the finer grids start from about where it is.
        let cap = |k: usize| self.counts[k] + 10;
        let (counts, _) =
            nested_counts(arithmetic, self.grids, loads, self.r, self.plan.prolongation, cap);
        counts.iter().zip(&self.counts).map(|(count, want)| *count != Some(*want)).collect()
    }

    /// The same with relative errors up to `size`: in each value whenever it is updated, or in the load, once.
    fn disturbed(&self, seed: u64, size: f64, repetition: usize) -> Vec<bool> {
        let stream = (size.to_bits() ^ self.r.to_bits().rotate_left(17)) ^ repetition as u64;
        let mut noisy = Noisy { size, random: Random::new(seed, stream) };
        if !repetition.is_multiple_of(LOAD_EVERY) {
            return self.changed(&mut noisy, self.loads);
        }
        let disturb = |load: &Vec<f64>| load.iter().map(|&value| noisy.node(value)).collect();
        let loads: Vec<Vec<f64>> = self.loads.iter().map(disturb).collect();
        self.changed(&mut Plain, &loads)
    }
}

/// One repetition of so many disturbs the load and not the iteration.
const LOAD_EVERY: usize = 4;

fn row(plan: &Plan, column: &Column, near: &Margins) -> Result<Row, String> {
    let levels = column.grids.len();
    if column.changed(&mut Plain, column.loads).contains(&true) {
        return Err(format!("r = {}: the plain loop does not give the counts", column.r));
    }
    let orders =
        [column.changed(&mut Reversed, column.loads), column.changed(&mut Fused, column.loads)];
    let runs: Vec<(usize, usize)> = (0..plan.sizes.len())
        .flat_map(|size| {
            let repetitions = if size == 0 { plan.repetitions } else { plan.further };
            (0..repetitions).map(move |repetition| (size, repetition))
        })
        .collect();
    let changed: Vec<Vec<bool>> = runs
        .par_iter()
        .map(|&(size, repetition)| column.disturbed(plan.seed, plan.sizes[size], repetition))
        .collect();
    let cells = (0..levels).map(|k| {
        let flipped = || runs.iter().zip(&changed).filter(move |(_, changed)| changed[k]);
        let (above, below) = near.levels[k];
        Cell {
            count: column.counts[k],
            below,
            above,
            margin: above.map_or(below, |above| above.min(below)),
            flips: flipped().filter(|((size, _), _)| *size == 0).count(),
            flips_at: flipped().map(|((size, _), _)| plan.sizes[*size]).min_by(f64::total_cmp),
            reordered: orders.iter().any(|changed| changed[k]),
        }
    });
    Ok(Row { r: column.r, cells: cells.collect() })
}
