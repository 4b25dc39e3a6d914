//! Guaranteed bounds of the energy and of the error on a triangulation, in the plane and in space.
//!
//! The domain is the polygon or polyhedron that the cells fill, also where a part of the boundary lies on a curve: the
//! distance from the domain with the curve is not in the bounds.
//!
//! # The identity
//! Let the law keep dv/dn in `[lo, hi]` on each part of the boundary, and let j(v) be the largest of `-l
//! (v - at)` over the l of this interval; on a free part, where lo = hi = h, `-h v`. K are the functions v of H^1 with
//! finite j(v), under the paper's law v >= 0, on a fixed part v = `at`. A *flux* sigma has `-div sigma = f` inside and
//! `sigma.n` in `[lo, hi]` on each part. Then, for w in K, with `< >` the integral over the boundary without its free
//! parts,
//!
//! ```text
//! J(w) + 1/2 |sigma|^2 - <sigma.n at> = 1/2 |grad w - sigma|^2 + <j(w) + sigma.n (w - at)> =: G(w, sigma),
//! -1/2 |sigma|^2 + <sigma.n at> <= J(u) <= J(w),    |grad (u - w)|^2 <= 2 G,
//! ```
//!
//! and J(u) <= J(0) = 0 where all `at` are 0. With a factor k, constant on regions, and a reaction c, where `-div (k
//! grad u) + c u = f`, sigma may have any divergence: with `c q = f + div sigma` the squares are
//!
//! ```text
//! |sigma|^2 = int sigma^2 / k + c q^2,    |grad w - sigma|^2 = int |k grad w - sigma|^2 / k + c (w - q)^2,
//! ```
//!
//! and that of the error is the one of its energy norm, `int k |grad (u - w)|^2 + c (u - w)^2`. Below, k is 1 and c is
//! 0 unless it is said otherwise. w is the linear function of the nodal vector, with `at` in place of
//! values on the boundary that the law forbids. Nothing else is assumed of the vector.
//!
//! # The flux
//! First, sigma is a field of Raviart and Thomas of lowest order: one number for each side. Step 1 forms a part of the
//! flux for each node (Braess and Schöberl, Math. Comp. 77, 2008): the outflow of each cell around the node is the
//! integral of `grad w . grad phi - f phi`, phi the hat function, and the flux through a side stays as near as can be
//! to its share of `grad w . n` (`ring.rs`, in space `circulation.rs`). Both integrals are exact where f is constant on
//! shapes: their sums around a node without a reaction vanish, so that the part depends on the mesh alone, not on the
//! numbers of cells and nodes. The distance that is made least is the one between the part of sigma and that share as
//! fields on the cells (`circulation.rs`): with another measure a part of sigma along the sides stays, and on fine
//! meshes the bounds exceed the error by any factor. The reaction at a boundary node leaves through the facets at the
//! node as far as the law allows and w is zero there, or the node belongs to the contact (`reaction.rs`); else, and for
//! the residual at other nodes, all outflows around the node are changed alike, so that a vector after few steps of an
//! iteration has nearly the bounds of the last one. In the plane, a sweep over circulations around all nodes then
//! lowers the norm of sigma (`stream.rs`). Step 2 restores the balance of each cell (`balance.rs`): sigma is a flux, to
//! rounding, for every vector.
//!
//! Step 3, in the plane, lets the flux through a side vary along it, by which the norm of sigma becomes least
//! (`vary.rs`). Quadratic circulations of all nodes and sides at once, by multigrid (`quadratic.rs`), follow where
//! stretched cells have more than a tenth of the square of the error: on them sweeps over nodes and sides are slow, and
//! bounds would grow with the aspect.
//!
//! # Values by formulas
//! A linear w with the values of a formula at nodes has others between them. `w + E` has those of the formula, and all
//! that the law makes of it is exact (`excess.rs`): J, the distance from sigma and G are those of `w + E`, by
//! quadrature in the cells of such facets, and the error of w is larger by `|grad E|` at most. A lower bound of the
//! error there is none. Circulations of the flux look for the least `1/2 |sigma|^2 - <sigma.n at>`.
//!
//! # Fluxes by formulas
//! sigma.n is the mean of a given flux on a facet; the norms of sigma and of `grad w - sigma` on its cell grow by that
//! of the field that is missing (`given.rs`). J(w) has the flux times w by quadrature. A lower bound of the error there
//! is none.
//!
//! # An f that is not constant on cells
//! On each cell T there is a field without flux through the sides whose divergence is the mean of f less f, and whose
//! norm is at most `h / pi` times the L2 norm of the deviation of f from the mean, h the diameter (Payne and
//! Weinberger, Arch. Rational Mech. Anal. 5, 1960; Bebendorf, Z. Anal. Anwend. 22, 2003). The norms of sigma and of
//! `grad w - sigma` on the cell grow by as much. Where f is constant on shapes its load vector is exact, and with it
//! J(w), from which G is taken for the lower end as well. Where f is sampled, J(w) takes f by the means alone, and
//! `h / pi` times the deviation times `|grad w|` is added.

mod around;
mod balance;
mod cells;
mod circulation;
mod curve;
mod excess;
mod fan;
mod forest;
mod given;
mod limits;
mod linear;
mod lower;
mod quadratic;
mod reaction;
mod ring;
mod stream;
mod sums;
#[cfg(test)]
mod tests;
mod tetrahedra;
mod triangles;
mod vary;

use super::boundary::Slips;
use super::{Bounds, LEAST_MASS, NoBound, below_zero, root};
use crate::discrete::network::Network;
use crate::machine::threads::{items_per_task, join, map_with_room};
use crate::mesh::{Element, Mesh, MeshLoad, Sides, assemble_inverse, is_stretched, size, volume};
use crate::problem::law::ContactNode;
use around::FirstCells;
use balance::balance;
use cells::Cells;
use circulation::PatchRoom;
pub(crate) use curve::curve_shares;
use fan::Fans;
use forest::CellForest;
use linear::SideFlux;
use lower::lower;
use quadratic::circulate_quadratic;
use ring::Ring;
use std::borrow::Cow;
use std::sync::OnceLock;
use stream::circulate;
use sums::{Summands, Totals, energy_square};
use triangles::{Triangle, triangles};
use vary::vary;

/// Discrete problem on a mesh, as far as bounds are concerned.
#[derive(Clone, Copy)]
pub(crate) struct BoundedProblem<'a, const D: usize, const V: usize> {
    /// Mesh.
    pub mesh: &'a Mesh<D, V>,
    /// Sides of its cells.
    pub sides: &'a Sides<V>,
    /// Discrete problem with the present laws of the mesh.
    pub network: &'a Network,
    /// f on the mesh.
    pub f: &'a MeshLoad,
}

/// Bounds with their parts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LocalBounds {
    /// Bounds.
    pub bounds: Bounds,
    /// Square of the guaranteed error in each cell, of a vector in K: their sum is the square of the guaranteed error,
    /// up to rounding.
    pub squares: Vec<f64>,
}

/// Part of the square of the error in stretched cells up to which they are no matter: bounds may be a twentieth lower.
const LEAST_STRETCHED: f64 = 0.1;
/// Most nodes of a mesh on which psi is found by multigrid, which takes some 1700 bytes a node.
const MOST_NODES: usize = 1 << 18;

impl<const D: usize, const V: usize> BoundedProblem<'_, D, V> {
    /// Returns bounds for the nodal vector `y`, one value for each node, without a lower bound of the error.
    ///
    /// # Errors
    /// If a connected part of the domain has a free boundary alone, if nothing is fixed on the boundary of one where
    /// the flux cannot balance the integral of f, which must be negative for the paper's law, or if numbers exceed the
    /// range of double precision.
    ///
    /// # Panics
    /// If `y`, the network and the mesh have not the same number of nodes, or f is not that of the mesh.
    pub(crate) fn bounds(&self, y: &[f64]) -> Result<LocalBounds, NoBound> {
        let &Self { mesh, network, f, .. } = self;
        assert_eq!([y.len(), network.nodes(), f.load.len()], [mesh.points().len(); 3]);
        let deviations = f.cells.deviation.as_ref().map_or(f.cells.mean.len(), Vec::len);
        assert_eq!([f.cells.mean.len(), deviations], [mesh.cells().len(); 2]);
        let w = admissible(network, Slips::ALL, y);
        let forest = OnceLock::new();
        let (found, slips) = self.bounds_through(&w, y, &forest)?;
        // An end of the interval that no reaction reaches plays no part, and values that slip to it are errors.
        let narrower = admissible(network, slips, y);
        if narrower == w {
            return found;
        }
        match (found, self.bounds_through(&narrower, y, &forest)?.0) {
            (Ok(found), Ok(other)) => Ok(found.intersection(other)),
            (found, other) => found.or(other),
        }
    }

    /// Bounds for the nodal vector `y` by a vector `w` in K near it, and the ends of the interval of the law that the
    /// flux reaches. The forest of the cells is found by the first call.
    fn bounds_through(
        &self,
        w: &[f64],
        y: &[f64],
        forest: &OnceLock<CellForest>,
    ) -> Result<(Result<LocalBounds, NoBound>, Slips), NoBound> {
        let &Self { mesh, sides, network, f } = self;
        let cells = Cells { mesh, w, f: &f.cells };
        if D != 2 {
            let (flux, _) = balanced(&cells, sides, network, forest)?;
            let summands = Summands { mesh, sides, f, y, w, flux: flux.as_chunks::<1>().0 };
            return Ok((combined(&summands, summands.totals()), summands.slips()));
        }
        let mut flux = equilibrated(&cells, sides, network, forest)?;
        let summands = Summands { mesh, sides, f, y, w, flux: &flux };
        let totals = summands.totals();
        let distance = totals.0.distance;
        if w.len() > MOST_NODES || !is_in_stretched_cells(mesh, &totals.1) {
            return Ok((combined(&summands, totals), summands.slips()));
        }
        let forest = forest.get().expect("found for the flux");
        circulate_quadratic(&cells, sides, forest, distance, &mut flux);
        let summands = Summands { mesh, sides, f, y, w, flux: &flux };
        Ok((combined(&summands, summands.totals()), summands.slips()))
    }

    /// Adds the lower bound of the error to bounds for a nodal vector.
    pub(crate) fn with_lower(&self, mut bounds: Bounds, y: &[f64]) -> Bounds {
        let w = admissible(self.network, Slips::ALL, y);
        let mut moved = 0.0;
        if w != y {
            for (number, cell) in self.mesh.cells().iter().enumerate() {
                let element = Element::new(self.mesh.vertices(cell));
                let from = cell.map(|node| y[node as usize] - w[node as usize]);
                moved += energy_square(self.mesh, number, &element, from);
            }
        }
        // Where values of laws are formulas w is not in K, and where fluxes are, their bubbles are not known.
        let is_known = self.mesh.values.is_empty();
        let lower = if is_known { lower(self, &w) } else { 0.0 };
        bounds.error[0] = (lower - moved.sqrt() * (1.0 + 1e-9)).max(0.0);
        bounds
    }
}

impl LocalBounds {
    /// Guaranteed error in each cell.
    pub(crate) fn errors(&self) -> Vec<f64> {
        self.squares.iter().map(|square| square.max(0.0).sqrt()).collect()
    }

    /// Bounds that follow from these and others of the same solution, with the parts of those that are closer.
    fn intersection(self, other: Self) -> Self {
        let bounds = self.bounds.intersection(&other.bounds);
        let is_closer = other.bounds.error[1] < self.bounds.error[1];
        Self { bounds, squares: if is_closer { other.squares } else { self.squares } }
    }
}

/// True if stretched cells have more than a tenth of the square of the error, given in each cell of a mesh in the
/// plane.
pub(crate) fn is_in_stretched_cells<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    squares: &[f64],
) -> bool {
    let (mut sum, mut all) = (0.0, 0.0);
    for (cell, square) in mesh.cells().iter().zip(squares) {
        let vertices = mesh.vertices(cell);
        let longest = size(vertices);
        all += square;
        if is_stretched(D as f64 * volume(vertices), longest * longest) {
            sum += square;
        }
    }
    sum > LEAST_STRETCHED * all
}

/// Combines the sums for a nodal vector in K and a flux to bounds.
fn combined<const D: usize, const V: usize, const N: usize>(
    summands: &Summands<'_, D, V, N>,
    (totals, squares): (Totals, Vec<f64>),
) -> Result<LocalBounds, NoBound> {
    let largest = summands.largest();
    let rounding = totals.rounding(largest);
    let of_exact_load = summands.exact_load();
    let load = of_exact_load.unwrap_or(totals.load - totals.deviation + totals.given);
    let inside = 0.5 * totals.gradient - load;
    let energy = inside + totals.potential;
    let gap = 0.5 * totals.distance + totals.work;
    let of_flux = totals.rounding_of_flux(largest);
    let by_flux = -0.5 * totals.flux - of_flux + totals.of_values;
    let least = match of_exact_load {
        // J(w) less G, in which the law's terms cancel.
        Some(_) => by_flux.max(inside - 0.5 * totals.distance - totals.through - 3.0 * of_flux),
        None => by_flux,
    };
    let distance = root(2.0 * (gap + 2.0 * rounding));
    let projection = (totals.projection.sqrt() + totals.excess.sqrt()) * (1.0 + 1e-12);
    let most = energy + rounding;
    let has_values = summands.has_values();
    // |grad u| is at least |grad w| less the distance.
    let gradient = has_values
        .then(|| (root(totals.gradient - 2.0 * totals.excess - rounding) - distance).max(0.0));
    let bounds = Bounds {
        energy: if has_values { [least, most] } else { below_zero([least, most]) },
        error: [0.0, distance + projection],
        gradient,
        recovered: None,
        curve: segments(summands),
    };
    let underflows = totals.mass > 0.0 && totals.mass < LEAST_MASS;
    // The root hides a NaN.
    let numbers = [by_flux, energy, gap, rounding, projection];
    match underflows || !numbers.into_iter().all(f64::is_finite) {
        true => Err(NoBound::NotFinite),
        false => Ok(LocalBounds { bounds, squares }),
    }
}

/// Sum of `CurveShare`s as an energy; none if no part of the boundary is curved, and in space.
fn segments<const D: usize, const V: usize, const N: usize>(
    summands: &Summands<'_, D, V, N>,
) -> Option<f64> {
    let shares = curve_shares(summands.mesh, summands.sides, &summands.f.cells.mean, summands.w);
    Some(0.5 * shares?.iter().map(|share| share.square).sum::<f64>())
}

/// Nodal vector of a function in K: values on a side of that of the law of the node which it does not allow, or that is
/// left out, are replaced by that of the law.
fn admissible<'a>(network: &Network, slips: Slips, y: &'a [f64]) -> Cow<'a, [f64]> {
    let is_left_out = |contact: &&ContactNode| {
        let from = y[contact.node] - contact.law.at();
        from != 0.0 && slips.and(contact.law).keep(from) == 0.0
    };
    let mut w = Cow::Borrowed(y);
    for contact in network.boundary().iter().filter(is_left_out) {
        w.to_mut()[contact.node] = contact.law.at();
    }
    w
}

/// Fluxes through all sides of a mesh in the plane: sigma, for a nodal vector in K and the means of f over the cells.
/// The stiffness matrix in `network` says by how much a circulation changes the norm.
fn equilibrated<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    network: &Network,
    forest: &OnceLock<CellForest>,
) -> Result<Vec<SideFlux<D>>, NoBound> {
    let (flux, triangles) = balanced(cells, sides, network, forest)?;
    Ok(vary(cells, sides, triangles, flux))
}

/// Fluxes through all sides, each constant along it, and the shapes of the cells in the plane.
fn balanced<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    network: &Network,
    forest: &OnceLock<CellForest>,
) -> Result<(Vec<f64>, Vec<Triangle>), NoBound> {
    let triangles = triangles(cells.mesh);
    let (mut flux, forest) = join(
        || {
            let mut flux = of_patches(cells, sides, &triangles);
            let products = match cells.mesh.is_laplacian() {
                true => Cow::Borrowed(network),
                false => Cow::Owned(assemble_inverse(cells.mesh, sides)),
            };
            circulate(cells, sides, &triangles, &products, &mut flux);
            flux
        },
        || forest.get_or_init(|| CellForest::new(sides, cells.mesh.cells().len())),
    );
    balance(cells, sides, forest, &mut flux)?;
    Ok((flux, triangles))
}

/// Nodes whose patches one thread computes before their fluxes are added.
const RUN: usize = 1 << 11;
/// Number of such runs between additions.
const RUNS: usize = 4;
/// Numbers whose work takes as long as that on a patch.
const COST: usize = 64;

/// Part of the flux through a side.
#[derive(Clone, Copy, Debug)]
struct SideOutflow {
    side: u32,
    outflow: f64,
}

/// Storage for the patches of nodes, one after the other.
struct Patches<'a, const D: usize, const V: usize> {
    ring: Ring<'a, D, V>,
    fans: Fans<'a, D, V>,
    room: PatchRoom,
}

impl<'a, const D: usize, const V: usize> Patches<'a, D, V> {
    fn new(cells: Cells<'a, D, V>, sides: &'a Sides<V>, triangles: &'a [Triangle]) -> Self {
        let (ring, fans) = (Ring::new(cells, sides, triangles), Fans::new(cells, sides));
        Self { ring, fans, room: PatchRoom::default() }
    }

    /// Outflows of the patches of some nodes.
    fn outflows(
        &mut self,
        nodes: &[u32],
        around: &FirstCells,
        cells: &Cells<'_, D, V>,
    ) -> Vec<SideOutflow> {
        let (Self { ring, fans, room }, all) = (self, cells.mesh.cells());
        // About as many as a patch has on a refined mesh.
        let mut outflows = Vec::with_capacity(if D == 2 { 8 } else { 48 } * nodes.len());
        for &node in nodes {
            if D == 2 {
                ring.begin(node);
                while let Some(cell) = around.next(node, &ring.found, all) {
                    ring.find(cell);
                    ring.equilibrate();
                    ring.add_to(&mut outflows);
                }
            } else {
                fans.begin(node);
                while let Some(cell) = around.next(node, &fans.found, all) {
                    if let Some(plan) = fans.take(cell, around.count(node), &mut outflows) {
                        room.finish(cells, plan, &mut outflows);
                    }
                }
            }
        }
        fans.plans().iter_mut().for_each(|plan| room.finish(cells, plan, &mut outflows));
        outflows
    }
}

/// Sum of the fluxes of all patches, added in one order of the nodes whatever thread computes them.
fn of_patches<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    triangles: &[Triangle],
) -> Vec<f64> {
    let around = FirstCells::new(cells.w.len(), cells.mesh.cells());
    let mut flux = vec![0.0; sides.len()];
    for nodes in around.order.chunks(RUN * RUNS) {
        let runs: Vec<_> = nodes.chunks(RUN).collect();
        let each = items_per_task(runs.len(), COST * RUN);
        let parts = map_with_room(
            0..runs.len(),
            each,
            || Patches::new(*cells, sides, triangles),
            |patches, run| patches.outflows(runs[run], &around, cells),
        );
        for SideOutflow { side, outflow } in parts.into_iter().flatten() {
            flux[side as usize] += outflow;
        }
    }
    flux
}
