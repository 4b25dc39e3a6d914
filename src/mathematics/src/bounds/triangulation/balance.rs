//! Balance of the flux in every cell: errors of the iteration and of rounding are carried to the boundary, along a tree
//! of cells.

use super::NoBound;
use super::cells::{COST, Cells};
use crate::bounds::boundary::{BoundaryPart, PartLaw, shift_to_sum};
use crate::machine::threads::in_tasks;
use crate::mesh::{BoundarySide, Condition, Neighbour, Sides, measure};
use crate::problem::law::Law;
use crate::problem::unsolvable::{Component, Unsolvable};
use rayon::prelude::*;
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
    /// Order by fitness for a root: fixed sides first, then sides with much room, for the paper's law much outflow.
    /// Of two sides with equal room, the one with the smaller flux.
    fn compare(&self, other: &Self) -> Ordering {
        let by_condition = other.is_fixed.cmp(&self.is_fixed);
        let by_room = by_condition.then(other.room.total_cmp(&self.room));
        by_room.then(self.size.total_cmp(&other.size))
    }
}

/// Part of the domain whose cells are connected through sides, as a tree.
struct Tree {
    /// Side at the root.
    outlet: Outlet,
    cells: ConnectedCells,
}

/// Connected cells, each after a neighbour nearer to the first.
struct ConnectedCells {
    numbers: Vec<u32>,
    /// Side to that neighbour, of the first cell a side of the boundary.
    sides: Vec<u32>,
}

/// Changes a flux so that the outflow of each cell is minus the integral of f, to rounding, and the law allows the flux
/// out through the boundary in contact.
///
/// In a component without fixed boundary the outflows through the contact boundary are first scaled, or shifted if the
/// interval of the law is bounded, so that their sum balances f and the outlet at the root has no more than rounding
/// errors to take.
///
/// # Errors
/// If a component has neither a contact nor a fixed boundary, or the law does not allow what balances the integral of f
/// over a component without fixed boundary.
pub(super) fn balance<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    flux: &mut [f64],
) -> Result<(), NoBound> {
    let mesh = cells.mesh;
    let mut outlets = Vec::new();
    let boundary = sides.of_facets().iter();
    let largest = boundary.fold(0.0f64, |most, at| most.max(flux[at.side as usize].abs()));
    // Sums of parts at an end of the interval may exceed the end by rounding; and where all parts are at ends, the
    // outlet at the root has room for rounding errors nevertheless.
    let room = if cells.law.is_bounded() { ROOM * largest } else { 0.0 };
    for (facet, &BoundarySide { side, cell }) in mesh.facets().iter().zip(sides.of_facets()) {
        let condition = mesh.condition(facet);
        if condition != Condition::Free {
            let measure = measure(mesh.corners(facet));
            let (law, is_fixed) = (PartLaw::new(cells.law, measure), condition == Condition::Fixed);
            let flux = &mut flux[side as usize];
            if !is_fixed {
                *flux = law.within(room).clamp(*flux);
            }
            outlets.push(Outlet {
                side,
                cell,
                is_fixed,
                measure,
                room: law.room(*flux),
                size: flux.abs(),
            });
        }
    }
    outlets.sort_by(Outlet::compare);
    let cells = &Balanced { cells, masses: cells.masses() };
    let mut is_seen = vec![false; cells.masses.len()];
    let mut missing = vec![0.0; cells.masses.len()];
    for outlet in outlets {
        if !is_seen[outlet.cell as usize] {
            let connected = ConnectedCells::beside(outlet, sides, &mut is_seen);
            let mut tree = Tree { outlet, cells: connected };
            if !outlet.is_fixed {
                tree.balance_outflows(cells, sides, flux)?;
                if cells.cells.law.is_bounded() {
                    tree.move_root(sides, &mut is_seen);
                }
            }
            tree.balance(cells, sides, flux, &mut missing)?;
        }
    }
    match is_seen.iter().position(|seen| !seen) {
        Some(_) => Err(Unsolvable::Insulated { component: None }.into()),
        None => Ok(()),
    }
}

/// Cells with their integrals of f.
struct Balanced<'a, const D: usize, const V: usize> {
    cells: &'a Cells<'a, D, V>,
    masses: Vec<f64>,
}

impl ConnectedCells {
    /// Cells that are connected with the cell of an outlet and not yet seen, breadth first.
    fn beside<const V: usize>(outlet: Outlet, sides: &Sides<V>, is_seen: &mut [bool]) -> Self {
        // Room for all: a list that grows takes up to twice its length.
        let mut cells = Self {
            numbers: Vec::with_capacity(is_seen.len()),
            sides: Vec::with_capacity(is_seen.len()),
        };
        cells.push(outlet.cell, outlet.side);
        is_seen[outlet.cell as usize] = true;
        let mut place = 0;
        while let Some(&cell) = cells.numbers.get(place) {
            for side in sides.numbers(cell) {
                if let Neighbour::Cell(next) = sides.across(cell, side)
                    && !std::mem::replace(&mut is_seen[next as usize], true)
                {
                    cells.push(next, side);
                }
            }
            place += 1;
        }
        cells
    }

    fn push(&mut self, cell: u32, side: u32) {
        self.numbers.push(cell);
        self.sides.push(side);
    }
}

impl Tree {
    /// Carries to the outlet by how much the outflow of each cell, with those behind it, is too small; `missing` is
    /// room for these numbers.
    fn balance<const D: usize, const V: usize>(
        &self,
        cells: &Balanced<'_, D, V>,
        sides: &Sides<V>,
        flux: &mut [f64],
        missing: &mut [f64],
    ) -> Result<(), NoBound> {
        let ConnectedCells { numbers, sides: ways } = &self.cells;
        let of_cell = |cell: usize| {
            let outflow: f64 = sides.outflows(cell as u32, flux).iter().sum();
            -cells.masses[cell] - outflow
        };
        if numbers.len() == missing.len() {
            let all = in_tasks(missing.par_iter_mut().enumerate(), COST);
            all.for_each(|(cell, missing)| *missing = of_cell(cell));
        } else {
            numbers.iter().for_each(|&cell| missing[cell as usize] = of_cell(cell as usize));
        }
        for (&cell, &side) in numbers.iter().zip(ways).rev() {
            let through = missing[cell as usize];
            flux[side as usize] += if sides.leaves(cell, side) { through } else { -through };
            if let Neighbour::Cell(next) = sides.across(cell, side) {
                missing[next as usize] += through;
            }
        }
        let law = PartLaw::new(cells.cells.law, self.outlet.measure);
        match !self.outlet.is_fixed && law.room(flux[self.outlet.side as usize]) < 0.0 {
            true => Err(NoBound::NotBalanced),
            false => Ok(()),
        }
    }

    /// Changes the outflows through the boundary until they balance f, and takes the outlet with most room.
    fn balance_outflows<const D: usize, const V: usize>(
        &mut self,
        cells: &Balanced<'_, D, V>,
        sides: &Sides<V>,
        flux: &mut [f64],
    ) -> Result<(), NoBound> {
        let (mesh, law) = (cells.cells.mesh, cells.cells.law);
        if law.is_bounded() {
            self.outlet.room = f64::NEG_INFINITY;
        }
        let (mut integral, mut perimeter) = (0.0, 0.0);
        let (mut outlets, mut parts) = (Vec::new(), Vec::new());
        for &cell in &self.cells.numbers {
            integral += cells.masses[cell as usize];
            for side in sides.numbers(cell) {
                if let Neighbour::Facet(facet) = sides.across(cell, side) {
                    let facet = &mesh.facets()[facet as usize];
                    if mesh.condition(facet) == Condition::Contact {
                        let measure = measure(mesh.corners(facet));
                        perimeter += measure;
                        outlets.push(BoundarySide { side, cell });
                        parts.push(BoundaryPart { flux: flux[side as usize], measure });
                    }
                }
            }
        }
        Component { has_parts: true, ..Component::in_contact(perimeter, integral) }
            .check(law, 0.0)?;
        if law.is_bounded() {
            shift_to_sum(law, &mut parts, -integral);
        } else {
            scale_to_sum(law, &mut parts, -integral);
        }
        for (BoundarySide { side, cell }, part) in outlets.into_iter().zip(parts) {
            flux[side as usize] = part.flux;
            let room = PartLaw::new(law, part.measure).room(part.flux);
            let (measure, size) = (part.measure, part.flux.abs());
            let outlet = Outlet { side, cell, is_fixed: false, measure, room, size };
            if law.is_bounded() && outlet.compare(&self.outlet) == Ordering::Less {
                self.outlet = outlet;
            }
        }
        Ok(())
    }

    /// Moves the root of the tree to the outlet.
    fn move_root<const V: usize>(&mut self, sides: &Sides<V>, is_seen: &mut [bool]) {
        self.cells.numbers.iter().for_each(|&cell| is_seen[cell as usize] = false);
        self.cells = ConnectedCells::beside(self.outlet, sides, is_seen);
    }
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
