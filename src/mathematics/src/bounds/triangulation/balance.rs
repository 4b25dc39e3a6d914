//! Balance of the flux in every cell: errors of the iteration and of rounding are carried to the boundary, along trees
//! of cells.

use super::NoBound;
use super::cells::{COST, Cells};
use super::forest::CellForest;
use crate::bounds::boundary::{BoundaryPart, PartLaw, shift_to_sum};
use crate::machine::threads::{for_runs, items_per_task};
use crate::mesh::{BoundarySide, Sides, measure, volume};
use crate::problem::law::{Law, LawSum};
use crate::problem::unsolvable::Component;
use std::cmp::Ordering;

/// Distance of fluxes from the ends of a bounded interval, over the largest flux.
const ROOM: f64 = 1e-12;

/// Side of the boundary through which flux may leave.
#[derive(Clone, Copy)]
struct Outlet {
    side: u32,
    /// Cell of the side.
    cell: u32,
    /// Law of the side.
    law: Law,
    /// Length or area.
    measure: f64,
    /// Distance of the flux from the ends of its interval; on a fixed side the flux.
    room: f64,
    /// Absolute value of the flux.
    size: f64,
}

impl Outlet {
    /// The outlet, where this is the flux.
    fn with(self, flux: f64) -> Self {
        let room = if self.law.is_fixed() { flux } else { self.interval().room(flux) };
        Self { room, size: flux.abs(), ..self }
    }

    /// Interval of the flux.
    fn interval(&self) -> PartLaw {
        PartLaw::new(self.law, self.measure)
    }

    /// Order by fitness for what is left in the end: fixed sides first, then sides with much room, for the paper's law
    /// much outflow. Of two sides with equal room, the one with the smaller flux.
    fn compare(&self, other: &Self) -> Ordering {
        let by_law = (other.law.is_fixed()).cmp(&(self.law.is_fixed()));
        let by_room = by_law.then(other.room.total_cmp(&self.room));
        by_room.then(self.size.total_cmp(&other.size))
    }
}

/// Changes a flux so that the outflow of each cell is minus the integral of f, to rounding, and the law allows the flux
/// out through the boundary in contact.
///
/// In a component without fixed boundary the outflows through the contact boundary are first scaled, or shifted if the
/// interval of the law is bounded, so that their sum balances f and the outlet has no more than rounding errors to
/// take. With a reaction they stay, and all cells take what is missing in proportion to their volumes: the outflow of a
/// cell says what the reaction is.
///
/// # Errors
/// Without a reaction, if a component has neither a contact nor a fixed boundary, or the law does not allow what
/// balances the integral of f over a component without fixed boundary.
pub(super) fn balance<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    forest: &CellForest,
    flux: &mut [f64],
) -> Result<(), NoBound> {
    let mut masses = cells.masses();
    let mut outlets = Vec::with_capacity(forest.trees());
    let (of_trees, given) = outlets_of_trees(cells, sides, forest, flux);
    for (tree, of_tree) in of_trees.into_iter().enumerate() {
        outlets.push(match of_tree.iter().min_by(|one, two| one.compare(two)) {
            Some(best) if best.law.is_fixed() => Some(*best),
            _ if cells.mesh.reaction > 0.0 => {
                let of_cells: Vec<usize> =
                    forest.cells(tree).iter().map(|&cell| cell as usize).collect();
                let volume_of =
                    |cell: usize| volume(cells.mesh.vertices(&cells.mesh.cells()[cell]));
                let through: f64 = of_tree.iter().map(|outlet| flux[outlet.side as usize]).sum();
                let integral: f64 = of_cells.iter().map(|&cell| masses[cell]).sum();
                let whole: f64 = of_cells.iter().map(|&cell| volume_of(cell)).sum();
                let density = (integral + given[tree] + through) / whole;
                of_cells.iter().for_each(|&cell| masses[cell] -= density * volume_of(cell));
                None
            }
            _ => {
                let integral: f64 =
                    forest.cells(tree).iter().map(|&cell| masses[cell as usize]).sum();
                Some(balance_outflows(of_tree, integral + given[tree], flux)?)
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
    for (tree, outlet) in outlets.into_iter().enumerate() {
        let Some(outlet) = outlet else { continue };
        let outflow = missing[forest.root(tree) as usize];
        forest.carry_from_root(sides, flux, outlet.cell, outflow);
        let flux = &mut flux[outlet.side as usize];
        *flux += outflow;
        if outlet.interval().room(*flux) < 0.0 {
            return Err(NoBound::NotBalanced);
        }
    }
    Ok(())
}

/// Sides of the boundary of each tree through which flux may leave, and the flux through its free sides; the law is
/// made to allow the flux.
fn outlets_of_trees<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    forest: &CellForest,
    flux: &mut [f64],
) -> (Vec<Vec<Outlet>>, Vec<f64>) {
    let mesh = cells.mesh;
    let boundary = sides.of_facets().iter();
    let largest = boundary.fold(0.0f64, |most, at| most.max(flux[at.side as usize].abs()));
    let (mut outlets, mut given) = (vec![Vec::new(); forest.trees()], vec![0.0; forest.trees()]);
    for (facet, &BoundarySide { side, cell }) in mesh.facets().iter().zip(sides.of_facets()) {
        let (law, tree) = (mesh.law(facet), forest.tree_of[cell as usize] as usize);
        if law.is_free() {
            let flux = &mut flux[side as usize];
            *flux = cells.interval(facet).clamp(*flux);
            given[tree] += *flux;
        } else {
            let measure = measure(mesh.corners(facet));
            let outlet = Outlet { side, cell, law, measure, room: 0.0, size: 0.0 };
            // Sums of parts at an end of the interval may exceed the end by rounding; and where all parts are at ends,
            // the outlet has room for rounding errors nevertheless.
            let room = if law.is_bounded() { ROOM * largest } else { 0.0 };
            let flux = &mut flux[side as usize];
            *flux = outlet.interval().within(room).clamp(*flux);
            outlets[tree].push(outlet.with(*flux));
        }
    }
    (outlets, given)
}

/// Changes the outflows through the boundary of a component without fixed sides until they balance the integral of f
/// there, with the flux through its free sides; returns the best outlet.
fn balance_outflows(
    outlets: Vec<Outlet>,
    integral: f64,
    flux: &mut [f64],
) -> Result<Outlet, NoBound> {
    let (mut laws, mut parts) = (LawSum::default(), Vec::with_capacity(outlets.len()));
    for outlet in &outlets {
        let (flux, law) = (flux[outlet.side as usize], outlet.interval());
        laws.add(outlet.law, outlet.measure);
        parts.push(BoundaryPart { flux, measure: outlet.measure, law });
    }
    let whole = Component::whole(Law::FREE, 0.0, integral);
    Component { has_parts: true, laws, ..whole }.check(0.0)?;
    match laws.only().filter(|law| !law.is_bounded()) {
        Some(law) => scale_to_sum(law, &mut parts, -integral),
        None => shift_to_sum(&mut parts, -integral),
    }
    let changed = outlets.into_iter().zip(&parts).map(|(outlet, part)| {
        flux[outlet.side as usize] = part.flux;
        outlet.with(part.flux)
    });
    Ok(changed.min_by(Outlet::compare).expect("a boundary that is not free"))
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
