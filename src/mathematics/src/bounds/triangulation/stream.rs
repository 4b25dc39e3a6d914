//! Circulations around all nodes of a mesh in the plane together, by which the flux of all patches gets a smaller norm.
//!
//! For a linear function psi, the field `(d psi/dy, -d psi/dx)` has no divergence. The outflow of a cell through a side
//! is the difference of psi between the ends of the side, and the product of two such fields, over k, is that of the
//! gradients: psi with the least norm of sigma solves a problem with the stiffness matrix of 1/k. By the identity the
//! bounds depend on the norm of sigma alone, whatever w is, and on the integral of the values of laws times sigma.n:
//! the psi that is looked for has the least `1/2 |sigma|^2 - <sigma.n at>`.

use super::cells::Cells;
use super::triangles::Triangle;
use crate::discrete::network::Network;
use crate::mesh::{BoundarySide, Sides};

/// Bounds of psi at a node of the boundary by a facet in contact, relative to psi at the other end.
#[derive(Clone, Copy)]
struct Limit {
    other: u32,
    /// Least difference.
    lower: f64,
    /// Largest difference.
    upper: f64,
}

/// Node of the boundary, and the limits beyond which the law would not allow an outflow in contact.
#[derive(Clone, Copy, Default)]
struct StreamEnd {
    /// Number of facets at the node.
    facets: u32,
    /// True if a facet of the node is free.
    is_free: bool,
    /// Limits by the facets in contact that end and begin at the node.
    limits: [Option<Limit>; 2],
}

/// Place of a node inside.
const INNER: u32 = u32::MAX;

/// Nodal vector psi with the conditions on the boundary.
struct Stream {
    psi: Vec<f64>,
    /// Position in `boundary` of each node, or [`INNER`].
    places: Vec<u32>,
    boundary: Vec<StreamEnd>,
}

/// Lowers the norm of a flux on a mesh in the plane by circulations around all nodes. The outflow of each cell stays,
/// and the law allows the outflows through the boundary in contact. In space the flux stays as it is.
pub(super) fn circulate<const D: usize, const V: usize>(
    cells: &Cells<'_, D, V>,
    sides: &Sides<V>,
    triangles: &[Triangle],
    network: &Network,
    flux: &mut [f64],
) {
    if D != 2 {
        return;
    }
    let mut stream = Stream::new(cells, sides, flux);
    // Minus the products, over k, of the flux with the fields of the hat functions.
    let mut load = vec![0.0; cells.w.len()];
    for ((number, nodes), triangle) in (0..).zip(cells.mesh.cells()).zip(triangles) {
        let outflows = sides.outflows(number, flux);
        for k in 0..3 {
            load[nodes[k] as usize] -= triangle.turn(k, [outflows[0], outflows[1], outflows[2]]);
        }
    }
    // What a circulation changes in the integral of the flux times the values of laws.
    for facet in cells.facets_with_values() {
        let at = &sides.of_facets()[facet];
        let (nodes, k) = (&cells.mesh.cells()[at.cell as usize], sides.slot(at.cell, at.side));
        let value = 0.5 * cells.values(sides, facet).iter().sum::<f64>();
        load[nodes[(k + 1) % V] as usize] -= value;
        load[nodes[(k + 2) % V] as usize] += value;
    }
    // More sweeps of Gauss and Seidel change the bounds by next to nothing.
    (0..load.len()).for_each(|node| stream.relax(node, network, &load));
    stream.add_to(cells, sides, flux);
}

impl Stream {
    /// Zero, with the limits that follow from the outflows of a flux.
    fn new<const D: usize, const V: usize>(
        cells: &Cells<'_, D, V>,
        sides: &Sides<V>,
        flux: &[f64],
    ) -> Self {
        let (mesh, nodes) = (cells.mesh, cells.w.len());
        let (mut places, mut boundary) = (vec![INNER; nodes], Vec::new());
        for (facet, &BoundarySide { side, .. }) in mesh.facets().iter().zip(sides.of_facets()) {
            let law = mesh.law(facet);
            for (k, node) in facet.nodes.into_iter().enumerate() {
                let place = &mut places[node as usize];
                if *place == INNER {
                    *place = boundary.len() as u32;
                    boundary.push(StreamEnd::default());
                }
                let end: &mut StreamEnd = &mut boundary[*place as usize];
                end.facets += 1;
                end.is_free |= law.is_free();
                if law.may_move() {
                    let law = cells.interval(facet);
                    let outflow = flux[side as usize];
                    let [above, below] = [outflow - law.least, law.most - outflow];
                    let begins = k == 0;
                    let [lower, upper] = if begins { [-below, above] } else { [-above, below] };
                    let limit = Limit { other: facet.nodes[1 - k], lower, upper };
                    end.limits[usize::from(begins)] = Some(limit);
                }
            }
        }
        Self { psi: vec![0.0; nodes], places, boundary }
    }

    /// Gives psi at a node the value of the least norm within the limits.
    #[inline(always)]
    fn relax(&mut self, node: usize, network: &Network, load: &[f64]) {
        let best = network.row(node).add_to(load[node], &self.psi) / network.diagonal()[node];
        self.psi[node] = match self.boundary.get(self.places[node] as usize) {
            None => best,
            Some(StreamEnd { limits, is_free: false, facets: 2 }) => {
                let (mut lower, mut upper) = (f64::NEG_INFINITY, f64::INFINITY);
                for limit in limits.iter().flatten() {
                    let other = self.psi[limit.other as usize];
                    lower = lower.max(other + limit.lower);
                    upper = upper.min(other + limit.upper);
                }
                best.min(upper).max(lower)
            }
            // A free facet keeps its flux; a node at which the domain touches itself is left out.
            Some(_) => 0.0,
        };
    }

    /// Adds the field of psi to a flux.
    fn add_to<const D: usize, const V: usize>(
        &self,
        cells: &Cells<'_, D, V>,
        sides: &Sides<V>,
        flux: &mut [f64],
    ) {
        for (number, cell) in (0..).zip(cells.mesh.cells()) {
            for (k, side) in sides.numbers(number).into_iter().enumerate() {
                if sides.leaves(number, side) {
                    let [from, to] = [1, 2].map(|step| self.psi[cell[(k + step) % V] as usize]);
                    flux[side as usize] += to - from;
                }
            }
        }
        cells.clamp(sides, flux.as_chunks_mut::<1>().0);
    }
}
