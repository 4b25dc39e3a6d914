//! Counts of a table in single precision.

use crate::discrete::grid::Grid;
use crate::experiments::problems::{Discrete, Problem};
use crate::saddle::StopRule;
use crate::saddle::batch::{AsDefined, End, Nested, Number, run_nested};
use serde::{Deserialize, Serialize};

/// Counts of a table in single precision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Single {
    /// Number of the table in the paper.
    pub number: u8,
    /// Number of counts.
    pub cells: usize,
    /// Counts that differ from double precision.
    pub changed: Vec<Changed>,
}

/// A count that the precision changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Changed {
    /// Duality parameter.
    pub r: f64,
    /// Cells per side.
    pub cells: usize,
    /// Iterations in double precision.
    pub double: usize,
    /// Iterations in single precision; none if the limit came first.
    pub single: Option<usize>,
}

/// Compares the counts of a table in single precision with those in double precision.
pub(super) fn single(table: &Problem) -> Result<Single, String> {
    let Discrete { grids, loads, .. } = table.discrete()?;
    let narrow: Vec<Vec<f32>> = loads.iter().map(|load| narrowed(load)).collect();
    let double = counts(table, &grids, &loads, table.max_iterations);
    // Single precision may stall above the tolerance.
    let most = double.iter().flatten().flatten().max().copied().unwrap_or_default();
    let single = counts(table, &grids, &narrow, 10 * most);
    let mut changed = Vec::new();
    for (row, &r) in table.r.iter().enumerate() {
        for (k, &cells) in table.grids.iter().enumerate() {
            let (double, single) = (double[row][k], single[row][k]);
            if double != single {
                changed.push(Changed { r, cells, double: double.unwrap_or_default(), single });
            }
        }
    }
    let cells = table.r.len() * table.grids.len();
    Ok(Single { number: table.number, cells, changed })
}

/// Iterations per r and grid, in the precision of the loads; none if the limit came first.
fn counts<N: Number>(
    table: &Problem,
    grids: &[Grid],
    loads: &[Vec<N>],
    limit: usize,
) -> Vec<Vec<Option<usize>>> {
    let mut runs = Vec::new();
    for &r in &table.r {
        runs.push(Nested { loads, r, rule: StopRule::Signed });
    }
    let ends = run_nested(grids, &runs, table.prolongation, |_, _| limit, &mut AsDefined);
    ends.iter().map(|ends| ends.iter().map(End::count).collect()).collect()
}

/// Rounds a load vector to single precision.
pub(super) fn narrowed(load: &[f64]) -> Vec<f32> {
    load.iter().map(|&f| f32::of(f)).collect()
}
