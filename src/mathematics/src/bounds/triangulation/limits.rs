//! Limits of the flux through the facets of the boundary in the plane, and the circulation along the boundary that
//! brings a flux within them.

use super::cells::Cells;
use super::linear::SideFlux;
use crate::bounds::boundary::PartLaw;
use crate::mesh::{Sides, measure};

/// Distance of the flux through a facet from the ends of its interval, over its part of the whole flux, up to which the
/// flux stays as it is.
const LEAST_ROOM: f64 = 0.05;

/// Facet of the boundary with the interval of the flux through it.
struct LimitedFacet {
    side: u32,
    /// Nodes, in the sense in which a cell on the left has them.
    ends: [u32; 2],
    measure: f64,
    interval: PartLaw,
    /// True if the flux stays as it is.
    stays: bool,
}

/// Limits of the flux through all facets.
pub(super) struct FacetLimits {
    /// Facets, in the order of the mesh.
    facets: Vec<LimitedFacet>,
    /// Positions of the facets of each closed part of the boundary, one after the other; none where the boundary
    /// touches itself.
    loops: Vec<Vec<u32>>,
    /// Number of values of psi: at nodes, then on sides.
    nodes: usize,
    sides: usize,
}

/// No facet.
const NONE: u32 = u32::MAX;

impl FacetLimits {
    /// Limits of the facets of a mesh. The flux through those stays that the law leaves hardly any room beside this
    /// flux, and where the boundary touches itself through all.
    pub(super) fn new<const D: usize, const V: usize>(
        cells: &Cells<'_, D, V>,
        sides: &Sides<V>,
        flux: &[SideFlux<D>],
    ) -> Self {
        let (mesh, mut facets) = (cells.mesh, Vec::new());
        let (mut whole, mut length) = (0.0, 0.0);
        for (facet, at) in mesh.facets().iter().zip(sides.of_facets()) {
            let measure = measure(mesh.corners(facet));
            whole += flux[at.side as usize].iter().sum::<f64>().abs() / D as f64;
            length += measure;
            let (nodes, k) = (mesh.cells()[at.cell as usize], sides.slot(at.cell, at.side));
            let interval = cells.interval(facet);
            let ends = [nodes[(k + 1) % V], nodes[(k + 2) % V]];
            facets.push(LimitedFacet { side: at.side, ends, measure, interval, stays: false });
        }
        let loops = loops_of(&facets, mesh.points().len());
        for facet in &mut facets {
            let least = LEAST_ROOM * whole * (facet.measure / length);
            let flux = &flux[facet.side as usize];
            facet.stays =
                loops.is_empty() || flux.iter().any(|flux| facet.interval.room(*flux) <= least);
        }
        Self { facets, loops, nodes: mesh.points().len(), sides: sides.len() }
    }

    /// Lets the flux through all facets stay.
    pub(super) fn hold_all(&mut self) {
        self.facets.iter_mut().for_each(|facet| facet.stays = true);
    }

    /// Sides of the facets whose flux stays, each with its nodes.
    pub(super) fn held(&self) -> impl Iterator<Item = (u32, [u32; 2])> {
        self.facets.iter().filter(|facet| facet.stays).map(|facet| (facet.side, facet.ends))
    }

    /// Values of psi, zero but on the boundary, whose field brings a flux that exceeds limits within them; none if it
    /// exceeds none. The flux through facets that exceed them stays from then on; that through the others, as far as
    /// they have room, makes up for the difference.
    pub(super) fn exceeded_by<const D: usize>(&mut self, flux: &[SideFlux<D>]) -> Option<Vec<f64>> {
        let mut psi = None;
        for along in &self.loops {
            let means: Vec<f64> =
                along.iter().map(|&k| mean(&flux[self.facets[k as usize].side as usize])).collect();
            let mut is_within = true;
            let mut parts = means.clone();
            for (&k, part) in along.iter().zip(&mut parts) {
                let facet = &mut self.facets[k as usize];
                let is_outside = |flux: &f64| facet.interval.clamp(*flux) != *flux;
                if !facet.stays && flux[facet.side as usize].iter().any(is_outside) {
                    facet.stays = true;
                    is_within = false;
                }
                *part = facet.interval.clamp(*part);
            }
            if is_within {
                continue;
            }
            let missing = means.iter().sum::<f64>() - parts.iter().sum::<f64>();
            self.share(along, missing, &mut parts);
            let psi = psi.get_or_insert_with(|| vec![0.0; self.nodes + self.sides]);
            let mut value = 0.0;
            for ((&k, part), mean) in along.iter().zip(parts).zip(means) {
                let LimitedFacet { side, ends: [from, to], interval, .. } = self.facets[k as usize];
                let at_from = flux[side as usize][usize::from(from > to)];
                let room = interval.room(part).max(0.0);
                let step = part + (at_from - mean).clamp(-room, room) - at_from;
                let next = value + (part - mean);
                psi[self.nodes + side as usize] = 0.25 * (step + 3.0 * value + next);
                psi[to as usize] = next;
                value = next;
            }
        }
        psi
    }

    /// Adds what is missing in a sum to the fluxes through the facets of a closed part of the boundary, in proportion
    /// to their room, first to those that need not stay.
    fn share(&self, along: &[u32], mut missing: f64, parts: &mut [f64]) {
        for with_held in [false, true] {
            let room = |(&k, part): (&u32, &f64)| {
                let LimitedFacet { interval, stays, .. } = &self.facets[k as usize];
                let room = if missing > 0.0 { interval.most - part } else { part - interval.least };
                if *stays && !with_held { 0.0 } else { room.max(0.0) }
            };
            let mut rooms: Vec<f64> = along.iter().zip(&*parts).map(room).collect();
            let whole: f64 = rooms.iter().sum();
            if whole.is_infinite() {
                for (room, &k) in rooms.iter_mut().zip(along) {
                    let measure = self.facets[k as usize].measure;
                    *room = if room.is_infinite() { measure } else { 0.0 };
                }
            }
            let part = match whole.is_infinite() {
                true => missing / rooms.iter().sum::<f64>(),
                false => missing.signum() * (missing.abs() / whole).min(1.0),
            };
            if whole > 0.0 {
                parts.iter_mut().zip(&rooms).for_each(|(flux, room)| *flux += part * room);
                missing -= part * rooms.iter().sum::<f64>();
            }
        }
    }
}

/// Flux through a side.
fn mean<const D: usize>(flux: &SideFlux<D>) -> f64 {
    flux.iter().sum::<f64>() / D as f64
}

/// Positions of the facets of each closed part of the boundary; none if the boundary touches itself.
fn loops_of(facets: &[LimitedFacet], nodes: usize) -> Vec<Vec<u32>> {
    let mut next = vec![NONE; nodes];
    for (k, facet) in (0..).zip(facets) {
        if std::mem::replace(&mut next[facet.ends[0] as usize], k) != NONE {
            return Vec::new();
        }
    }
    let (mut loops, mut is_seen) = (Vec::new(), vec![false; facets.len()]);
    for first in 0..facets.len() as u32 {
        let (mut along, mut k) = (Vec::new(), first);
        while !std::mem::replace(&mut is_seen[k as usize], true) {
            along.push(k);
            k = next[facets[k as usize].ends[1] as usize];
        }
        if !along.is_empty() {
            loops.push(along);
        }
    }
    loops
}
