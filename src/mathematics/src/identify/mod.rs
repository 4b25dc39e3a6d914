//! Recovery of Figure 1: which right-hand side f, under which reading of the method, gives the published tables.
//!
//! # Idea
//! The iteration is positively homogeneous and piecewise linear in f, so a table of counts cuts the
//! values of f by inequalities: at the published count the stopping measure is below the tolerance, at
//! every count before it is above. A *forced* run makes exactly the published number of iterations, and ends
//! as soon as an inequality fails. Counts on coarse grids cost microseconds and discard nearly everything.
//!
//! # Parts
//! [`Variant`] is a reading of the method, [`Evaluator`] runs one f, [`Target::searched`] tries every f with one value
//! on a quadrant and another elsewhere, [`identifiability`] tells how sharply the tables fix what was found.

mod evaluate;
mod findings;
mod found;
mod identifiability;
mod moves;
mod search;
mod space;
mod variant;

pub use evaluate::{Evaluator, Table};
pub use findings::{Alternative, Findings, Questions};
pub use found::{Found, found};
pub use identifiability::{
    Breaks, FirstChange, Holds, Identifiability, Slice, TableCell, identifiability, slice,
};
pub use search::SearchReport;
pub use space::{Geometry, Lattice};
pub use variant::{DualWeight, Measure, Order, ResidualTime, Variant};

use crate::discrete::grid::Grid;
use crate::saddle::batch::LANES;
use serde::{Deserialize, Serialize};

/// Cells per side of the coarsest grid of the tables; every further column halves the width.
pub const COARSEST: usize = 4;

/// The grid of a column of the table.
fn grid(level: usize) -> Grid {
    Grid::new(COARSEST << level).expect("fine enough")
}

/// A published table: what the search is to explain.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Duality parameters, one per row.
    pub r: Vec<f64>,
    /// `counts[k][level]`: iterations for `r[k]` on the grid with `4 * 2^level` cells per side.
    pub counts: Vec<Vec<usize>>,
    /// Last change of the multiplier on the finest grid, one per row, to two digits.
    pub delta_a: Vec<f64>,
}

/// Reason for which a search cannot run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Rows of the table of different length, or not one per r.
    #[error(
        "the table is ragged: it needs one row of counts and one Delta a per r, all rows of one length"
    )]
    Ragged,
    /// No row, or more than a run carries at once.
    #[error("a table of {0} rows does not fit: give between 1 and {max}", max = LANES)]
    Rows(usize),
    /// A count of zero, or a parameter or Delta a that is not positive and finite.
    #[error("counts, r and Delta a must be positive; row {0} (counted from 1) is not")]
    NotPositive(usize),
    /// A range of more values than a search can try.
    #[error("the values {0} are too many; take a larger step or a smaller range")]
    LargeLattice(String),
    /// A text that is no range of decimals.
    #[error(
        "cannot read the values `{0}`; write MIN:MAX:STEP with MIN <= MAX and STEP > 0, such as -4:4:0.5"
    )]
    Values(String),
    /// An f that is not made of quadrants.
    #[error("f = {0} is not made of quadrants")]
    Pieces(String),
}

/// True if ours agrees with a published value to the two digits that the paper prints.
pub fn agrees(ours: f64, published: f64) -> bool {
    format!("{ours:.1e}") == format!("{published:.1e}")
}

impl Target {
    /// Number of grids, the columns of the table.
    pub fn levels(&self) -> usize {
        self.counts.first().map_or(0, Vec::len)
    }

    /// Number of counts in the table.
    pub fn cells(&self) -> usize {
        self.r.len() * self.levels()
    }

    /// Checks shape and signs.
    ///
    /// # Errors
    /// [`IdentifyError`] naming what is wrong.
    pub fn validate(&self) -> Result<(), IdentifyError> {
        let rows = self.r.len();
        if rows == 0 || rows > LANES {
            return Err(IdentifyError::Rows(rows));
        }
        let levels = self.levels();
        let full = self.counts.iter().all(|row| row.len() == levels);
        if levels == 0 || !full || self.counts.len() != rows || self.delta_a.len() != rows {
            return Err(IdentifyError::Ragged);
        }
        let positive = |x: f64| x > 0.0 && x.is_finite();
        for k in 0..rows {
            if !positive(self.r[k]) || !positive(self.delta_a[k]) || self.counts[k].contains(&0) {
                return Err(IdentifyError::NotPositive(k + 1));
            }
        }
        Ok(())
    }
}
