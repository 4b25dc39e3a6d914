//! Balance of the flux in every cell: errors of the iteration and of rounding are carried to the boundary, along a tree
//! of cells.

use super::BoundsError;
use super::cells::Cells;
use super::sides::{Neighbour, Sides};
use crate::mesh::Condition;
use std::cmp::Ordering;

/// Side of the boundary through which flux may leave.
#[derive(Clone, Copy)]
struct Outlet {
    side: u32,
    /// True if the flux may have any sign.
    is_fixed: bool,
    /// Flux out of the domain.
    outflow: f64,
}

impl Outlet {
    /// Order by fitness for a root: fixed sides first, then sides with much outflow, from which some can be taken.
    fn compare(&self, other: &Self) -> Ordering {
        let by_condition = other.is_fixed.cmp(&self.is_fixed);
        by_condition.then(other.outflow.total_cmp(&self.outflow))
    }
}

/// Part of the domain whose cells are connected through sides, as a tree.
struct Component {
    /// Side at the root.
    outlet: Outlet,
    /// Cells, each after a neighbour nearer to the root.
    steps: Vec<Step>,
}

/// Cell of a tree.
#[derive(Clone, Copy)]
struct Step {
    cell: u32,
    /// Side to the cell before, at the root the outlet.
    side: u32,
}

/// Changes a flux so that the outflow of each cell is minus the integral of f, to rounding, and the flux out through the
/// boundary in contact is not negative.
///
/// In a component without fixed boundary the outflows through the contact boundary are scaled first, so that their sum
/// balances f and the outlet at the root has no more than rounding errors to take.
///
/// # Errors
/// If a component has neither a contact nor a fixed boundary, or the integral of f over a component without fixed
/// boundary is not negative.
pub(super) fn balance<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &mut [f64],
) -> Result<(), BoundsError> {
    let mesh = cells.mesh;
    let mut outlets = Vec::new();
    for (facet, side) in mesh.facets().iter().zip(sides.of_facets(mesh.facets().len())) {
        let condition = mesh.condition(facet);
        if condition != Condition::Free {
            let (is_fixed, outflow) = (condition == Condition::Fixed, flux[side as usize]);
            outlets.push(Outlet { side, is_fixed, outflow });
        }
    }
    outlets.sort_by(Outlet::compare);
    let mut is_seen = vec![false; cells.len()];
    for outlet in outlets {
        if !is_seen[sides.inner_cell(outlet.side) as usize] {
            let steps = tree(sides, outlet.side, &mut is_seen);
            Component { outlet, steps }.balance(cells, sides, flux)?;
        }
    }
    match is_seen.iter().position(|seen| !seen) {
        Some(cell) => Err(BoundsError::Insulated { cell }),
        None => Ok(()),
    }
}

/// Cells that are connected with the cell of a side of the boundary, breadth first.
fn tree<const V: usize>(sides: &Sides<V>, outlet: u32, is_seen: &mut [bool]) -> Vec<Step> {
    let mut steps = vec![Step { cell: sides.inner_cell(outlet), side: outlet }];
    is_seen[steps[0].cell as usize] = true;
    let mut place = 0;
    while let Some(&Step { cell, .. }) = steps.get(place) {
        for side in sides.of(cell) {
            if let Neighbour::Cell(next) = sides.across(cell, side)
                && !std::mem::replace(&mut is_seen[next as usize], true)
            {
                steps.push(Step { cell: next, side });
            }
        }
        place += 1;
    }
    steps
}

impl Component {
    fn balance<const D: usize, const V: usize>(
        &self,
        cells: &Cells<'_, D, V>,
        sides: &Sides<V>,
        flux: &mut [f64],
    ) -> Result<(), BoundsError> {
        if !self.outlet.is_fixed {
            self.scale(cells, sides, flux)?;
        }
        for &Step { cell, side } in self.steps.iter().rev() {
            let outflow: f64 = sides.outflows(cell, flux).iter().sum();
            let missing = -(V as f64) * cells.load(cell) - outflow;
            flux[side as usize] += if sides.leaves(cell, side) { missing } else { -missing };
        }
        match !self.outlet.is_fixed && flux[self.outlet.side as usize] < 0.0 {
            true => Err(self.not_coercive()),
            false => Ok(()),
        }
    }

    /// Scales the outflows through the boundary until they balance f.
    fn scale<const D: usize, const V: usize>(
        &self,
        cells: &Cells<'_, D, V>,
        sides: &Sides<V>,
        flux: &mut [f64],
    ) -> Result<(), BoundsError> {
        let (mut integral, mut outflow) = (0.0, 0.0);
        let mut outlets = Vec::new();
        for &Step { cell, .. } in &self.steps {
            integral += V as f64 * cells.load(cell);
            for side in sides.of(cell) {
                if matches!(sides.across(cell, side), Neighbour::Facet(_)) {
                    outflow += flux[side as usize];
                    outlets.push(side);
                }
            }
        }
        if integral >= 0.0 {
            return Err(self.not_coercive());
        }
        if outflow > 0.0 {
            let scale = -integral / outflow;
            outlets.into_iter().for_each(|side| flux[side as usize] *= scale);
        }
        Ok(())
    }

    fn not_coercive(&self) -> BoundsError {
        BoundsError::NotCoercive { cell: self.steps[0].cell as usize }
    }
}
