//! The contact set of the finest grid, and its representation on each coarser grid of the cube.
//!
//! If a coarse grid only knows whether its own nodes are in contact, it misplaces the rim of the contact set by half a
//! cell, and loses small sets altogether. Here every boundary node of a coarse grid gets a *spring*, chosen such that
//! the set draws the same current as on the finest grid.
//!
//! # Idea
//! From afar, a set held at zero is characterised by its *capacity*: the current that it draws when everything else is
//! at one. Mirrored at the faces, the cube becomes the whole cubic lattice. There a single node has the capacity
//! `1 / G(0)`, `G` being the potential kernel (Glasser and Zucker 1977), and a compact set of `m` nodes has about
//! `sqrt(m) / G(0)`, since the capacity of a disc is proportional to its radius. (This also holds where faces meet:
//! three perpendicular discs draw little less current than a ball.)
//!
//! # Algorithm
//! Two numbers are carried from grid to grid for each boundary node: its part of the *area* of the set, which becomes
//! 1/4 with each coarsening, and its part of the capacity, which becomes 1/2. For each coarser grid:
//! 1. Sum areas and capacities over the neighbours on the finer grid.
//! 2. Divide each capacity by `1 + sum G c`, the sum over its neighbours, which screen it.
//! 3. Raise each capacity to that of a compact set, `area / (G(0) sqrt(total area of the neighbourhood))`, if that is
//!    larger.
//! 4. A node that draws the current `c` when the far field is one has the potential `1 - sum G c`, the sum over its
//!    neighbours and itself. Set its spring to `c / (1 - sum G c)`; put it in contact if that is not positive or if all
//!    of its area is in contact.
//!
//! No length, angle or topology of the set enters, and no constant but three values of `G`. The springs affect the
//! rate of convergence only, never the solution.

use super::Cube;
use super::surface::{neighbour_sums, nodes};
use crate::multigrid::level::Level;
use crate::multigrid::stencil::for_each_boundary_node;

/// Potential kernel of the cubic lattice at the origin, at the nearest and at the diagonal neighbours in a plane:
/// 0.252731..., G(0) - 1/6, and 0.055191...
const G: [f64; 3] = [0.252_731_009_8, 0.086_064_343_1, 0.055_191_433_7];
/// Stiffness from which on a spring counts as contact.
const STIFFEST: f64 = 1e3;

/// Sets `1 / (6 + spring)` on all `levels`, coarsest first, for the contact set of a finer grid with `n` cells per
/// side. Returns the work in visits of unknowns: one sum over neighbours on the finest grid, five on each coarser one.
pub(super) fn set_springs(n: usize, in_contact: &[bool], levels: &mut [Level]) -> f64 {
    let area: Vec<_> = in_contact.iter().map(|&contact| f64::from(contact)).collect();
    let mut finer = CapacityField { n, capacity: vec![0.0; area.len()], area };
    finer.make_compact();
    let mut work = nodes(n) as f64;
    for level in levels.iter_mut().rev() {
        finer = finer.coarsened();
        level.inverse_diagonal = finer.inverse_diagonal();
        work += 5.0 * nodes(level.n) as f64;
    }
    work
}

/// Area and capacity of the contact set, shared among the boundary nodes of a grid.
struct CapacityField {
    n: usize,
    /// Part of the contact set at each boundary node, in nodes of this grid.
    area: Vec<f64>,
    /// Current into each boundary node if the far field is one, in couplings of the mirrored lattice.
    capacity: Vec<f64>,
}

impl CapacityField {
    /// Raises capacities to those of compact sets.
    fn make_compact(&mut self) {
        let Self { n, area, capacity } = self;
        for_each_boundary_node::<Cube>(*n, |place, node| {
            if area[place] > 0.0 {
                let total: f64 = neighbour_sums(*n, area, node).iter().sum();
                capacity[place] = capacity[place].max(area[place] / (G[0] * total.sqrt()));
            }
        });
    }

    /// Field of the same currents on the grid with half as many cells per side.
    fn coarsened(&self) -> Self {
        let n = self.n / 2;
        let (mut area, mut capacity) = (vec![0.0; nodes(n)], vec![0.0; nodes(n)]);
        for_each_boundary_node::<Cube>(n, |place, node| {
            let node = node.map(|i| 2 * i);
            // Where faces meet, the area of more than one node may be added up.
            area[place] = (0.25 * weighted_sum(self.n, &self.area, node)).min(1.0);
            capacity[place] = 0.5 * weighted_sum(self.n, &self.capacity, node);
        });
        let mut screened = capacity.clone();
        for_each_boundary_node::<Cube>(n, |place, node| {
            if capacity[place] > 0.0 {
                let [_, nearest, diagonal] = neighbour_sums(n, &capacity, node);
                screened[place] /= 1.0 + G[1] * nearest + G[2] * diagonal;
            }
        });
        let mut field = Self { n, area, capacity: screened };
        field.make_compact();
        field
    }

    /// `1 / (6 + spring)` of every node, 0 in contact.
    fn inverse_diagonal(&self) -> Vec<f64> {
        let mut inverse = vec![1.0 / 6.0; nodes(self.n)];
        for_each_boundary_node::<Cube>(self.n, |place, node| {
            if self.capacity[place] > 0.0 {
                let near = neighbour_sums(self.n, &self.capacity, node);
                let potential = 1.0 - (G[0] * near[0] + G[1] * near[1] + G[2] * near[2]);
                let is_contact = self.area[place] >= 1.0 || potential * STIFFEST <= near[0];
                inverse[place] = if is_contact { 0.0 } else { 1.0 / (6.0 + near[0] / potential) };
            }
        });
        inverse
    }
}

/// Sum of a field over a node of the finer grid and its neighbours, with weights 1, 1/2 and 1/4.
fn weighted_sum(n: usize, field: &[f64], node: [usize; 3]) -> f64 {
    let [own, nearest, diagonal] = neighbour_sums(n, field, node);
    own + 0.5 * nearest + 0.25 * diagonal
}

#[cfg(test)]
mod tests {
    use super::super::Cube;
    use super::super::surface::place;
    use super::*;
    use std::f64::consts::PI;

    /// Springs on a coarse grid for contact in some nodes of a finer one.
    fn springs(n: usize, coarse_n: usize, contact: &[[usize; 3]]) -> Vec<f64> {
        let mut in_contact = vec![false; nodes(n)];
        contact.iter().for_each(|&node| in_contact[place(n, node)] = true);
        let mut levels = vec![Level::new::<Cube>(n / 2)];
        while levels[0].n > coarse_n {
            levels.insert(0, Level::new::<Cube>(levels[0].n / 2));
        }
        set_springs(n, &in_contact, &mut levels);
        levels[0].inverse_diagonal.iter().map(|inverse| 1.0 / inverse - 6.0).collect()
    }

    #[test]
    fn the_kernel_is_that_of_the_cubic_lattice() {
        // Watson's integral by Glasser and Zucker, the equation at the origin, and at (1, 1, 0) the identity
        // 5 g / 12 - 1 / (2 pi^2 g), g = 2 G(0), for twice the kernel (Glasser and Boersma 2000).
        let gammas: f64 = [1.0, 5.0, 7.0, 11.0].map(|k| libm::tgamma(k / 24.0)).iter().product();
        let at_zero = 6.0_f64.sqrt() / (192.0 * PI.powi(3)) * gammas;
        let g = 2.0 * at_zero;
        let expected =
            [at_zero, at_zero - 1.0 / 6.0, 0.5 * (5.0 / 12.0 * g - 1.0 / (2.0 * PI * PI * g))];
        for (found, expected) in G.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-10, "{found} {expected}");
        }
    }

    #[test]
    fn a_single_node_keeps_its_capacity() {
        // The resistances of the spring and of a coarse node add up to that of the node, in couplings of the coarse
        // grid: with each coarsening twice as much.
        for (n, coarse_n, halvings) in [(16, 8, 1), (32, 8, 2), (64, 8, 3)] {
            for node in [[n / 2, n / 4, 0], [n / 2, 0, 0], [n, n, 0]] {
                let springs = springs(n, coarse_n, &[node]);
                let coarse = place(coarse_n, node.map(|i| i * coarse_n / n));
                let resistance = 1.0 / springs[coarse] + G[0];
                let expected = G[0] * f64::from(1 << halvings);
                assert!((resistance - expected).abs() < 1e-9, "{node:?} {resistance} {expected}");
                let others = springs.iter().filter(|spring| spring.abs() > 1e-9).count();
                assert_eq!(others, 1);
            }
        }
    }

    #[test]
    fn contact_everywhere_and_on_a_face_has_no_rim() {
        let n = 16;
        let mut face = Vec::new();
        let mut all = Vec::new();
        for_each_boundary_node::<Cube>(n, |_, node| {
            all.push(node);
            if node[2] == 0 {
                face.push(node);
            }
        });
        assert!(springs(n, 4, &all).iter().all(|spring| spring.is_infinite()));
        let springs = springs(n, 4, &face);
        for_each_boundary_node::<Cube>(4, |place, node| {
            let expected = if node[2] == 0 { f64::INFINITY } else { 0.0 };
            assert!(springs[place] == expected || springs[place] < 1e-12, "{node:?}");
        });
    }
}
