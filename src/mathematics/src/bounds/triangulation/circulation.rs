//! Flux of a patch in space: the part of the flux that belongs to the hat function of one node (Braess and Schöberl
//! 2008). In the plane it is that of a [ring](super::ring).
//!
//! Circulations around the node, fluxes without divergence, give it the least norm. There is one around each inner edge
//! at the node; around an inner node their sum is zero. On each cell a circulation is a constant field, so that the
//! system for their strengths is that of linear elements on the surface of the patch.

use super::SideOutflow;
use super::cells::Cells;
use super::fan::{FanPlan, LANES};
use super::reaction::{OpenFacet, OpenNode};
use super::tetrahedra::Tetrahedron;
use crate::machine::simd::vectorised;
use crate::mesh::measure;

/// Number of circulations above which they are left out: the flux has the right divergence without them.
const LARGEST: usize = 400;

/// A number for each of some patches.
type PatchLanes = [f64; LANES];

/// Cell of patches with the same plan, side by side.
#[derive(Clone, Copy)]
struct PatchCell {
    /// Volume, with its sign.
    signed: PatchLanes,
    /// Integrals of `k grad w . grad phi` for the hat functions phi of the other nodes.
    work: [PatchLanes; 3],
    /// Sum that the outflows must have.
    wanted: PatchLanes,
    /// Outflows through the sides opposite to a, b and c; there is none through the one opposite to the node.
    outflows: [PatchLanes; 3],
}

/// Storage for patches with the same plan, side by side. PatchLanes without a patch have any numbers.
#[derive(Default)]
pub(super) struct PatchRoom {
    /// Edges from the node to the others, along which w rises by so much.
    edges: Vec<[PatchLanes; 3]>,
    rises: Vec<PatchLanes>,
    /// k on the cells.
    k: Vec<PatchLanes>,
    cells: Vec<PatchCell>,
    /// Squares of the norms of the gradients of the nodes' hat functions, times k.
    stiffness: PatchLanes,
    /// Volumes of the patches.
    volume: PatchLanes,
    /// Products, over k, of the circulations with each other, on and behind the diagonal, row by row; behind those of
    /// each row minus the product with the flux so far less `k grad w`.
    matrix: Vec<PatchLanes>,
    /// Strengths of the circulations.
    strengths: Vec<PatchLanes>,
}

/// The values of a function of the patch.
#[inline(always)]
fn each(value: impl Fn(usize) -> f64) -> PatchLanes {
    let mut values = [0.0; LANES];
    (0..LANES).for_each(|lane| values[lane] = value(lane));
    values
}

/// Adds the values of a function of the patch.
#[inline(always)]
fn add(sums: &mut PatchLanes, value: impl Fn(usize) -> f64) {
    (0..LANES).for_each(|lane| sums[lane] += value(lane));
}

/// The vectors of a patch.
#[inline(always)]
fn vectors([a, b, c]: [&[PatchLanes; 3]; 3], lane: usize) -> [[f64; 3]; 3] {
    [
        [a[0][lane], a[1][lane], a[2][lane]],
        [b[0][lane], b[1][lane], b[2][lane]],
        [c[0][lane], c[1][lane], c[2][lane]],
    ]
}

impl PatchRoom {
    /// Finds the fluxes of the fans that wait with a plan, and puts them into the list.
    pub(super) fn finish<const D: usize, const V: usize>(
        &mut self,
        cells: &Cells<'_, D, V>,
        plan: &mut FanPlan,
        outflows: &mut [SideOutflow],
    ) {
        if plan.nodes.is_empty() {
            return;
        }
        self.gather(cells, plan);
        vectorised(
            #[inline(always)]
            || self.shape(plan),
        );
        let density = self.let_out(cells, plan);
        vectorised(
            #[inline(always)]
            || self.minimise(plan, density),
        );
        plan.put(|member| &self.cells[member].outflows, outflows);
    }

    /// Takes the edges of the patches and w on them, and k on the cells.
    fn gather<const D: usize, const V: usize>(&mut self, cells: &Cells<'_, D, V>, plan: &FanPlan) {
        self.edges.resize(plan.others, [[0.0; LANES]; 3]);
        self.rises.resize(plan.others, [0.0; LANES]);
        self.k.resize(plan.members.len(), [1.0; LANES]);
        let points = cells.mesh.points();
        for (lane, &node) in plan.nodes.iter().enumerate() {
            let (node, others) = (node as usize, &plan.other_nodes[lane * plan.others..]);
            for ((edge, rise), &other) in self.edges.iter_mut().zip(&mut self.rises).zip(others) {
                for d in 0..D {
                    edge[d][lane] = points[other as usize][d] - points[node][d];
                }
                rise[lane] = cells.w[other as usize] - cells.w[node];
            }
            let row = &plan.cells[lane * plan.members.len()..];
            for (k, &(number, _)) in self.k.iter_mut().zip(row) {
                k[lane] = cells.mesh.k(number as usize);
            }
        }
    }

    /// Finds the shapes of the cells, and forms the matrix.
    #[inline(always)]
    fn shape(&mut self, plan: &FanPlan) {
        let (width, zero) = (plan.circulations + 2, [0.0; LANES]);
        self.matrix.clear();
        self.matrix.resize((plan.circulations + 1) * width, zero);
        self.cells.clear();
        let [mut stiffness, mut volume] = [zero; 2];
        for (member, of_cell) in plan.members.iter().zip(&self.k) {
            let [i, j, k] = member.others;
            let edges = [&self.edges[i], &self.edges[j], &self.edges[k]];
            let [p, q, r] = [&self.rises[i], &self.rises[j], &self.rises[k]];
            let (mut signed, mut work, mut products) = (zero, [zero; 3], [zero; 3]);
            for lane in 0..LANES {
                let rises = [p[lane], q[lane], r[lane]];
                let shape = Tetrahedron::new(vectors(edges, lane), rises);
                signed[lane] = shape.signed;
                stiffness[lane] += of_cell[lane] * shape.stiffness;
                volume[lane] += shape.volume();
                let of_shape = shape.products();
                for k in 0..3 {
                    work[k][lane] = of_cell[lane] * shape.work[k];
                    products[k][lane] = of_shape[k] / of_cell[lane];
                }
            }
            self.cells.push(PatchCell { signed, work, wanted: zero, outflows: [zero; 3] });
            for (k, product) in products.iter().enumerate() {
                let [i, j] = [member.circulations[(k + 1) % 3], member.circulations[(k + 2) % 3]];
                // Around the three edges the fields sum to zero.
                add(&mut self.matrix[i * width + i], |lane| -product[lane]);
                add(&mut self.matrix[j * width + j], |lane| -product[lane]);
                add(&mut self.matrix[i.min(j) * width + i.max(j)], |lane| product[lane]);
            }
        }
        [self.stiffness, self.volume] = [stiffness, volume];
    }

    /// Lets the reactions at the nodes, as far as the laws allow, out through the boundary, and returns what is left
    /// per volume. That is taken away from all cells in proportion to their volumes: then the outflows wanted from the
    /// cells and those through the boundary have the same sum.
    fn let_out<const D: usize, const V: usize>(
        &mut self,
        cells: &Cells<'_, D, V>,
        plan: &FanPlan,
    ) -> PatchLanes {
        let (mesh, mut density, mut open) = (cells.mesh, [0.0; LANES], Vec::new());
        for (lane, &node) in plan.nodes.iter().enumerate() {
            let (mut reaction, row) = (0.0, &plan.cells[lane * plan.members.len()..]);
            for (cell, &(number, vertex)) in self.cells.iter_mut().zip(row) {
                let load = cells.load(number, vertex as usize, cell.signed[lane].abs());
                let [a, b, c] = &cell.work;
                cell.wanted[lane] = -(a[lane] + b[lane] + c[lane]) - load;
                reaction += cell.wanted[lane];
            }
            if !plan.outlets.is_empty() {
                let outlets = plan.outlets.len();
                open.clear();
                for &facet in &plan.facets[lane * outlets..][..outlets] {
                    let facet = &mesh.facets()[facet as usize];
                    let law = mesh.law_at(facet, node);
                    let measure = measure(mesh.corners(facet));
                    open.push(OpenFacet { law, measure, outflow: 0.0 });
                }
                let (w, stiffness) = (cells.w[node as usize], self.stiffness[lane]);
                reaction -= OpenNode::<D> { w, stiffness }.let_out(&mut open, reaction);
                for (&[member, slot], facet) in plan.outlets.iter().zip(&open) {
                    self.cells[member].outflows[slot][lane] = facet.outflow;
                }
            }
            density[lane] = reaction / self.volume[lane];
        }
        density
    }

    /// Gives each cell the outflow wanted from it, and adds the circulations by which the distance from the gradient of
    /// w becomes least.
    #[inline(always)]
    fn minimise(&mut self, plan: &FanPlan, density: PatchLanes) {
        self.carry(plan, density);
        if !(1..=LARGEST).contains(&plan.circulations) {
            return;
        }
        self.load(plan);
        self.solve(plan.circulations);
        for (member, cell) in plan.members.iter().zip(&mut self.cells) {
            let [i, j, k] = member.circulations;
            let [a, b, c] = [&self.strengths[i], &self.strengths[j], &self.strengths[k]];
            let sense = each(|lane| 1.0f64.copysign(cell.signed[lane]));
            for (outflow, [to, from]) in cell.outflows.iter_mut().zip([[c, b], [a, c], [b, a]]) {
                add(outflow, |lane| sense[lane] * (to[lane] - from[lane]));
            }
        }
    }

    /// Gives each cell the outflow wanted from it, through the sides by which the search came.
    #[inline(always)]
    fn carry(&mut self, plan: &FanPlan, density: PatchLanes) {
        for (place, member) in plan.members.iter().enumerate().skip(1).rev() {
            let (before, from) = self.cells.split_at_mut(place);
            let (PatchCell { signed, wanted, outflows, .. }, [parent, slot]) =
                (&mut from[0], member.parent);
            // The outflow through the side to the parent is still zero.
            let [_, b, c] = outflows;
            let outflow = each(|lane| {
                wanted[lane] - density[lane] * signed[lane].abs() - (b[lane] + c[lane])
            });
            outflows[0] = outflow;
            before[parent].outflows[slot] = each(|lane| -outflow[lane]);
        }
    }

    /// Forms the right-hand side.
    #[inline(always)]
    fn load(&mut self, plan: &FanPlan) {
        let width = plan.circulations + 2;
        for ((member, cell), of_cell) in plan.members.iter().zip(&self.cells).zip(&self.k) {
            let [i, j, k] = member.others;
            let edges = [&self.edges[i], &self.edges[j], &self.edges[k]];
            let mut loads = [[0.0; LANES]; 3];
            for lane in 0..LANES {
                let work = [cell.work[0][lane], cell.work[1][lane], cell.work[2][lane]];
                let [a, b, c] = &cell.outflows;
                let (edges, signed) = (vectors(edges, lane), cell.signed[lane]);
                let shape = Tetrahedron { edges, signed, work, stiffness: 0.0 };
                let of_shape = shape.loads([a[lane], b[lane], c[lane]]);
                (0..3).for_each(|k| loads[k][lane] = of_shape[k] / of_cell[lane]);
            }
            for (&number, load) in member.circulations.iter().zip(&loads) {
                add(&mut self.matrix[number * width + width - 1], |lane| -load[lane]);
            }
        }
    }

    /// Finds the strengths by elimination.
    #[inline(always)]
    fn solve(&mut self, count: usize) {
        let width = count + 2;
        self.strengths.clear();
        self.strengths.resize(count + 1, [0.0; LANES]);
        for k in 1..count + 1 {
            let (above, below) = self.matrix.split_at_mut((k + 1) * width);
            let row = &mut above[k * width..];
            let pivot = row[k];
            // A pivot that is lost to rounding leaves out the circulation.
            let inverse = each(|lane| if pivot[lane] > 0.0 { 1.0 / pivot[lane] } else { 0.0 });
            row[k] = inverse;
            for (i, other) in (k + 1..).zip(below.chunks_exact_mut(width)) {
                let entry = row[i];
                if entry == [0.0; LANES] {
                    continue;
                }
                let factor = each(|lane| -inverse[lane] * entry[lane]);
                for (entry, of_row) in other[i..].iter_mut().zip(&row[i..]) {
                    add(entry, |lane| factor[lane] * of_row[lane]);
                }
            }
        }
        for k in (1..count + 1).rev() {
            let row = &self.matrix[k * width..(k + 1) * width];
            let mut left = row[count + 1];
            for (entry, x) in row[k + 1..].iter().zip(&self.strengths[k + 1..]) {
                add(&mut left, |lane| -entry[lane] * x[lane]);
            }
            self.strengths[k] = each(|lane| row[k][lane] * left[lane]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factors_solve_systems_side_by_side() {
        let rows =
            [[4.0, 1.0, -1.0, -1.0], [f64::NAN, 3.0, 0.5, -3.5], [f64::NAN, f64::NAN, 2.0, 4.0]];
        let mut room = PatchRoom { matrix: vec![[f64::NAN; LANES]; 5], ..PatchRoom::default() };
        for row in rows {
            room.matrix.push([f64::NAN; LANES]);
            room.matrix.extend(row.map(|entry| each(|lane| (lane + 1) as f64 * entry)));
        }
        room.solve(3);
        for (found, x) in room.strengths.iter().zip([0.0, 1.0, -2.0, 3.0]) {
            assert!(found.iter().all(|y| (x - y).abs() < 1e-14));
        }
    }
}
