//! Balance of the flux in every cell: errors of the iteration and of rounding are carried to the boundary, along trees
//! of cells.

use super::NoBound;
use super::cells::{COST, Cells};
use super::forest::CellForest;
use crate::bounds::boundary::{BoundaryPart, PartLaw, shift_to_sum};
use crate::machine::threads::{for_runs, items_per_task};
use crate::mesh::{BoundarySide, Condition, Sides, measure};
use crate::problem::law::Law;
use crate::problem::unsolvable::{Component, Unsolvable};
use std::cmp::Ordering;

/// Distance of fluxes from the ends of a bounded interval, over the largest flux.
const ROOM: f64 = 1e-12;

/// Side of the boundary through which flux may leave.
#[derive(Clone, Copy)]
struct Outlet {
    side: u32,
    /// Cell of the side.
    cell: u32,
    /// True if the flux may have any sign.
    is_fixed: bool,
    /// Length or area.
    measure: f64,
    /// Distance of the flux from the ends of the interval of the law.
    room: f64,
    /// Absolute value of the flux.
    size: f64,
}

impl Outlet {
    /// Order by fitness for what is left in the end: fixed sides first, then sides with much room, for the paper's law
    /// much outflow. Of two sides with equal room, the one with the smaller flux.
    fn compare(&self, other: &Self) -> Ordering {
        let by_condition = other.is_fixed.cmp(&self.is_fixed);
        let by_room = by_condition.then(other.room.total_cmp(&self.room));
        by_room.then(self.size.total_cmp(&other.size))
    }
}

/// Changes a flux so that the outflow of each cell is minus the integral of f, to rounding, and the law allows the flux
/// out through the boundary in contact.
///
/// In a component without fixed boundary the outflows through the contact boundary are first scaled, or shifted if the
/// interval of the law is bounded, so that their sum balances f and the outlet has no more than rounding errors to
/// take.
///
/// # Errors
/// If a component has neither a contact nor a fixed boundary, or the law does not allow what balances the integral of f
/// over a component without fixed boundary.
pub(super) fn balance<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    forest: &CellForest,
    flux: &mut [f64],
) -> Result<(), NoBound> {
    let masses = cells.masses();
    let mut outlets = Vec::with_capacity(forest.trees());
    for (tree, of_tree) in outlets_of_trees(cells, sides, forest, flux).into_iter().enumerate() {
        let best = of_tree.iter().min_by(|one, two| one.compare(two));
        let best = *best.ok_or(Unsolvable::Insulated { component: None })?;
        outlets.push(match best.is_fixed {
            true => best,
            false => {
                let integral = forest.cells(tree).iter().map(|&cell| masses[cell as usize]).sum();
                balance_outflows(cells.law, of_tree, integral, flux)?.unwrap_or(best)
            }
        });
    }
    let mut missing = masses;
    let run = items_per_task(missing.len(), COST);
    for_runs(&mut missing, run, &|number, missing| {
        for (cell, missing) in (number * run..).zip(missing) {
            let outflow: f64 = sides.outflows(cell as u32, flux).iter().sum();
            *missing = -*missing - outflow;
        }
    });
    forest.carry_to_roots(sides, flux, &mut missing);
    for (tree, Outlet { side, cell, is_fixed, measure, .. }) in outlets.into_iter().enumerate() {
        let outflow = missing[forest.root(tree) as usize];
        forest.carry_from_root(sides, flux, cell, outflow);
        flux[side as usize] += outflow;
        let law = PartLaw::new(cells.law, measure);
        if !is_fixed && law.room(flux[side as usize]) < 0.0 {
            return Err(NoBound::NotBalanced);
        }
    }
    Ok(())
}

/// Sides of the boundary of each tree through which flux may leave; the law is made to allow the flux.
fn outlets_of_trees<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    forest: &CellForest,
    flux: &mut [f64],
) -> Vec<Vec<Outlet>> {
    let mesh = cells.mesh;
    let boundary = sides.of_facets().iter();
    let largest = boundary.fold(0.0f64, |most, at| most.max(flux[at.side as usize].abs()));
    // Sums of parts at an end of the interval may exceed the end by rounding; and where all parts are at ends, the
    // outlet has room for rounding errors nevertheless.
    let room = if cells.law.is_bounded() { ROOM * largest } else { 0.0 };
    let mut outlets = vec![Vec::new(); forest.trees()];
    for (facet, &BoundarySide { side, cell }) in mesh.facets().iter().zip(sides.of_facets()) {
        let condition = mesh.condition(facet);
        if condition != Condition::Free {
            let measure = measure(mesh.corners(facet));
            let (law, is_fixed) = (PartLaw::new(cells.law, measure), condition == Condition::Fixed);
            let flux = &mut flux[side as usize];
            if !is_fixed {
                *flux = law.within(room).clamp(*flux);
            }
            outlets[forest.tree_of[cell as usize] as usize].push(Outlet {
                side,
                cell,
                is_fixed,
                measure,
                room: law.room(*flux),
                size: flux.abs(),
            });
        }
    }
    outlets
}

/// Changes the outflows through the boundary of a component without fixed sides until they balance the integral of f
/// there; returns the outlet with most room if the law is bounded.
fn balance_outflows(
    law: Law,
    mut outlets: Vec<Outlet>,
    integral: f64,
    flux: &mut [f64],
) -> Result<Option<Outlet>, NoBound> {
    let perimeter = outlets.iter().map(|outlet| outlet.measure).sum();
    Component { has_parts: true, ..Component::in_contact(perimeter, integral) }.check(law, 0.0)?;
    let part = |outlet: &Outlet| BoundaryPart {
        flux: flux[outlet.side as usize],
        measure: outlet.measure,
    };
    let mut parts: Vec<_> = outlets.iter().map(part).collect();
    if law.is_bounded() {
        shift_to_sum(law, &mut parts, -integral);
    } else {
        scale_to_sum(law, &mut parts, -integral);
    }
    for (outlet, part) in outlets.iter_mut().zip(parts) {
        flux[outlet.side as usize] = part.flux;
        outlet.room = PartLaw::new(law, part.measure).room(part.flux);
        outlet.size = part.flux.abs();
    }
    Ok(outlets.into_iter().min_by(Outlet::compare).filter(|_| law.is_bounded()))
}

/// Scales what fluxes exceed the finite end of an interval by until their sum is `sum`.
fn scale_to_sum(law: Law, parts: &mut [BoundaryPart], sum: f64) {
    let end = if law.lo().is_finite() { law.lo() } else { law.hi() };
    let (mut excess, mut needed) = (0.0, sum);
    for part in parts.iter() {
        excess += part.flux - end * part.measure;
        needed -= end * part.measure;
    }
    if excess != 0.0 {
        let scale = needed / excess;
        for part in parts {
            let least = end * part.measure;
            part.flux = scale * (part.flux - least) + least;
        }
    }
}
