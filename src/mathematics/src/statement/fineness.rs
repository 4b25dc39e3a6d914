//! Fineness of the grids or meshes of a statement.

use super::{Domain, StatementError};
use crate::bounds::Accuracy;
use crate::mesh::AnyMesh;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Number of nodes up to which a mesh is refined if nobody says how often.
pub(super) const USUAL_NODES: f64 = 20_000.0;
/// Cells per side of the first grid of the square that is tried for an accuracy.
pub(crate) const FIRST_CELLS: usize = 16;
/// Cells per side of the finest of the usual grids of the square, those of the paper.
const USUAL_CELLS: usize = 64;
/// Cells per side of the coarsest grid below a finest one that can be halved so often.
const COARSEST_CELLS: usize = 4;
/// Largest odd factor of the cells per side of the cube, those of a coarsest mesh that is solved directly.
const MOST_ODD: usize = 7;
/// Most refinements of a mesh.
const MOST_TIMES: usize = 20;

/// Fineness of the grids of the square, or of the meshes of another domain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Fineness {
    /// The paper's grids on the square; as many refinements of a mesh as leave it at most 20 000 nodes.
    Usual,
    /// Nested grids of the square, by their cells per side, coarsest first.
    Grids(Vec<usize>),
    /// Cells per side of the finest grid of the square, or of the finest mesh of the cube.
    Width(usize),
    /// Number of refinements of a mesh.
    Refined(u8),
    /// Grids of the square, or meshes in the plane, as fine as an accuracy takes.
    Within(Accuracy),
}

/// Writes the value as options have it.
impl fmt::Display for Fineness {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usual => Ok(()),
            Self::Grids(cells) => {
                let cells: Vec<_> = cells.iter().map(usize::to_string).collect();
                out.write_str(&cells.join(","))
            }
            Self::Width(cells) => write!(out, "1/{cells}"),
            Self::Refined(times) => write!(out, "{times}"),
            Self::Within(accuracy) => write!(out, "{:?}", accuracy.wanted()),
        }
    }
}

impl Fineness {
    /// Name of the field that states it; of the usual one, that of the grids.
    pub fn field(&self) -> &'static str {
        match self {
            Self::Usual | Self::Grids(_) => "grids",
            Self::Width(_) => "h",
            Self::Refined(_) => "refine",
            Self::Within(Accuracy::Error(_)) => "accuracy",
            Self::Within(Accuracy::Energy(_)) => "accuracy_energy",
        }
    }

    /// Cells per side of the nested grids of the square, coarsest first.
    pub fn cells(&self) -> Vec<usize> {
        match self {
            Self::Grids(cells) => cells.clone(),
            Self::Width(finest) => halved(*finest, COARSEST_CELLS),
            Self::Usual | Self::Refined(_) => halved(USUAL_CELLS, COARSEST_CELLS),
            Self::Within(_) => vec![FIRST_CELLS],
        }
    }

    /// The fineness on meshes: nested grids of the square become the width of the finest.
    #[must_use]
    pub fn on_meshes(self) -> Self {
        match self {
            Self::Grids(cells) => cells.last().copied().map_or(Self::Usual, Self::Width),
            other => other,
        }
    }

    /// Grids down to this finest one that begin with the coarsest of these grids, where halving leads there.
    pub fn with_finest(&self, finest: usize) -> Self {
        let coarsest = self.cells()[0];
        let halves = finest.is_multiple_of(coarsest) && (finest / coarsest).is_power_of_two();
        Self::Grids(halved(finest, if halves { coarsest } else { COARSEST_CELLS }))
    }

    /// Cells along each side of the coarsest mesh of a domain that has a width; none of another.
    pub(super) fn coarsest(&self, domain: &Domain) -> Result<Option<usize>, StatementError> {
        Ok(match self {
            Self::Within(_) if domain.is_square() => Some(COARSEST_CELLS),
            _ if domain.is_square() => Some(self.cells()[0]),
            Self::Width(cells) => Some(of_cube(*cells)?[0]),
            _ => None,
        })
    }

    /// Number of refinements of the coarsest mesh; where an accuracy is asked for, the usual number on a curved domain,
    /// whose coarsest polygon may have no solution, and else none. The meshes of the square are as fine as its grids.
    pub(super) fn refinements(
        &self,
        domain: &Domain,
        mesh: &AnyMesh,
    ) -> Result<usize, StatementError> {
        let fits = |times: &usize| mesh.nodes_after(*times) <= USUAL_NODES;
        Ok(match self {
            Self::Refined(times) => usize::from(*times),
            Self::Within(_) if !mesh.is_curved() => 0,
            _ if domain.is_square() => self.cells().len() - 1,
            Self::Width(cells) => of_cube(*cells)?[1],
            Self::Usual | Self::Grids(_) | Self::Within(_) => {
                (1..=MOST_TIMES).take_while(fits).count()
            }
        })
    }
}

/// Returns numbers of cells per side, each twice the one before, up to `finest`, from the least that is not below
/// `least` on.
fn halved(finest: usize, least: usize) -> Vec<usize> {
    let mut cells = vec![finest];
    while cells[0].is_multiple_of(2) && cells[0] / 2 >= least {
        cells.insert(0, cells[0] / 2);
    }
    cells
}

/// Returns the cells per side of the coarsest mesh of the cube, and the number of refinements to `cells` per side.
///
/// # Errors
/// [`StatementError::Field`] if the odd factor of the number is too large.
pub(super) fn of_cube(cells: usize) -> Result<[usize; 2], StatementError> {
    let odd = |cells: usize| cells >> cells.trailing_zeros();
    if cells > 0 && odd(cells) <= MOST_ODD {
        return Ok([odd(cells), cells.trailing_zeros() as usize]);
    }
    let can = |n: &usize| odd(*n) <= MOST_ODD;
    let below = (1..cells).rev().find(can).unwrap_or(1);
    let above = (cells.max(1)..=2 * cells.max(1)).find(can).unwrap_or(1);
    let reason = format!(
        "on the cube N is a power of two times 1, 3, 5 or 7; the nearest: 1/{below} and 1/{above}"
    );
    Err(StatementError::field("h", format!("1/{cells}"), reason))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grids_halve_down_to_an_odd_or_small_one_or_to_the_coarsest_that_is_given() {
        let cells = |finest| Fineness::Width(finest).cells();
        assert_eq!(cells(64), Fineness::Usual.cells());
        assert_eq!(cells(64), [4, 8, 16, 32, 64]);
        assert_eq!(cells(12), [6, 12]);
        assert_eq!(cells(7), [7]);
        let from_16 = |finest| Fineness::Grids(vec![16, 32, 64]).with_finest(finest).cells();
        assert_eq!(from_16(32), [16, 32]);
        assert_eq!(from_16(128), [16, 32, 64, 128]);
        assert_eq!(from_16(24), [6, 12, 24]);
    }

    #[test]
    fn cubes_have_small_odd_factors() {
        assert_eq!(of_cube(24).unwrap(), [3, 3]);
        assert_eq!(of_cube(7).unwrap(), [7, 0]);
        let refused = of_cube(11).unwrap_err().to_string();
        assert!(refused.contains("the nearest: 1/10 and 1/12"), "{refused}");
    }
}
