//! The run of multigrid, which the grids of the square and nested networks share, and the direct method that checks it;
//! validation of the input of both: numbers of cells, lengths, finite numbers, a load that the flux can balance.

pub mod active_set;
pub(crate) mod direct;
pub(crate) mod driver;
pub(crate) mod order;

use crate::problem::law::LawError;
use crate::problem::unsolvable::{Component, Unsolvable};

/// Goal at which multigrid stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Algebraic error at most a tenth of the discretisation error in the energy norm. One cycle on the finest grid
    /// is nearly always enough.
    DiscretisationError,
    /// Upper limit of the natural residual: of `|A y - F|` inside, and on the boundary of the least change of the value
    /// or of the flux that satisfies the law, under the paper's law `|min(y, A y - F)|`. Not relative: in the units of
    /// the load, those of f h^2.
    Kkt(f64),
    /// Distance that falls as the energy does, in its units, at the zero vector: the last cycle has lowered it by less
    /// than a hundredth of what is left. On meshes alone.
    Gain(f64),
    /// Smallest residual that double precision allows.
    RoundingFloor,
}

/// Parameters of multigrid.
#[derive(Clone, Debug)]
pub struct MultigridParams {
    /// Goal at which the iteration stops.
    pub goal: Goal,
    /// Number of cycles on the finest grid that are made although a residual is small enough.
    pub least_cycles: usize,
    /// Limit on the number of cycles on the finest grid.
    pub max_cycles: usize,
}

/// Usual limit on the number of cycles. Stretched meshes need up to 130 at aspect 30.
const MOST_CYCLES: usize = 400;

impl Default for MultigridParams {
    fn default() -> Self {
        Self { goal: Goal::RoundingFloor, least_cycles: 0, max_cycles: MOST_CYCLES }
    }
}

/// Reason for which a solver rejects its input.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum InputError {
    /// Number of cells per side that cannot be used.
    #[error("{cells} cells per side: must be {rule}; the nearest: {}", in_words(nearest))]
    GridSize {
        /// The number.
        cells: usize,
        /// Description of the numbers that can be used.
        rule: &'static str,
        /// Next smaller and next larger number that can be used, as far as there are such.
        nearest: Vec<usize>,
    },
    /// A field whose length is not the number of nodes.
    #[error("{found} numbers given for the {expected} nodes of the grid")]
    Length {
        /// Length of the field.
        found: usize,
        /// Number of nodes.
        expected: usize,
    },
    /// A load that contains an infinity or a NaN, or whose sum overflows.
    #[error("the load contains a number that is not finite, or its sum overflows")]
    NotFinite,
    /// A load that no flux can balance.
    #[error(transparent)]
    Unsolvable(#[from] Unsolvable),
    /// A law whose ends exceed the range of double precision on a coarser level.
    #[error(transparent)]
    Law(#[from] LawError),
}

fn in_words(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(" and ")
}

/// Odd factors of the numbers of cells per side that can be used.
const ODD_FACTORS: [usize; 4] = [1, 3, 5, 7];

/// Returns the cells per side of the coarsest grid for `n` cells per side, or `None` if `n` cannot be used.
fn coarsest_cells(n: usize) -> Option<usize> {
    let odd = n.checked_shr(n.trailing_zeros())?;
    // Four cells per side are solved directly, which is cheaper than a further coarsening to two.
    let coarsest = if odd == 1 { n.min(4) } else { 2 * odd };
    (n.is_multiple_of(2) && ODD_FACTORS.contains(&odd)).then_some(coarsest)
}

/// Returns the cells per side of the coarsest grid below one with `n` cells per side.
///
/// # Errors
/// [`InputError::GridSize`] if `n` is not a power of two (at least 2) times 1, 3, 5 or 7.
pub fn check_size(n: usize) -> Result<usize, InputError> {
    coarsest_cells(n).ok_or_else(|| InputError::GridSize {
        cells: n,
        rule: "a power of two (at least 2) times 1, 3, 5 or 7",
        nearest: nearest_sizes(n),
    })
}

/// Next smaller and next larger number of cells per side than `n` that can be used.
fn nearest_sizes(n: usize) -> Vec<usize> {
    let powers = (1..usize::BITS).map(|k| 1_usize << k);
    let sizes = powers.flat_map(|power| ODD_FACTORS.map(|odd| power.checked_mul(odd)));
    let sizes: Vec<usize> = sizes.flatten().collect();
    let below = sizes.iter().copied().filter(|&size| size < n).max();
    let above = sizes.iter().copied().filter(|&size| size > n).min();
    below.into_iter().chain(above).collect()
}

/// Checks that a field has one number for each node.
pub(crate) fn check_length(expected: usize, field: &[f64]) -> Result<(), InputError> {
    let found = field.len();
    if found == expected { Ok(()) } else { Err(InputError::Length { found, expected }) }
}

/// Checks that the load of these components is finite, and that the flux can balance it over each of them without fixed
/// nodes: for the paper's law, that its sum is negative, the condition (2).
///
/// # Errors
/// [`InputError::NotFinite`] and [`InputError::Unsolvable`].
pub(crate) fn check_load(components: &[Component]) -> Result<(), InputError> {
    if !components.iter().map(|component| component.integral).sum::<f64>().is_finite() {
        return Err(InputError::NotFinite);
    }
    for component in components {
        component.check(0.0)?;
    }
    Ok(())
}
