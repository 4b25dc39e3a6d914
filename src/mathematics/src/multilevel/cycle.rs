//! The V-cycle: an approximate inverse of the stiffness matrix on the nodes that are not held at zero.

use super::springs::{HeldLevel, set_coarse_springs};
use crate::discrete::nested::NestedNetwork;
use crate::multigrid::direct::{BandOrder, Direct};

/// Vectors of one level.
struct CycleLevel {
    /// One over the diagonal with its spring; zero at held nodes.
    inverse: Vec<f64>,
    /// Additions to the diagonal.
    springs: Vec<f64>,
    /// Right-hand side; empty on the finest level in use, where the caller has it.
    load: Vec<f64>,
    /// Correction.
    values: Vec<f64>,
}

/// V-cycle with one symmetric Gauss-Seidel sweep, half before and half after the coarser levels, whose functions leave
/// out what is held: a coarse node is held if the same node is held on the finest level in use.
pub(super) struct Cycle<'a> {
    levels: &'a [NestedNetwork],
    vectors: Vec<CycleLevel>,
    coarsest: Direct,
    /// Multiplications of one visit of an unknown, for the work of the coarsest level.
    per_visit: f64,
}

impl<'a> Cycle<'a> {
    pub(super) fn new(levels: &'a [NestedNetwork]) -> Self {
        let zeros = |level: &NestedNetwork| vec![0.0; level.network.nodes()];
        let vectors = levels.iter().map(|level| CycleLevel {
            inverse: zeros(level),
            springs: zeros(level),
            load: zeros(level),
            values: zeros(level),
        });
        let finest = &levels[levels.len() - 1].network;
        Self {
            levels,
            vectors: vectors.collect(),
            coarsest: Direct::new(&levels[0].network, BandOrder::Reordered),
            per_visit: finest.row_length(),
        }
    }

    /// Number of visits of unknowns that one application on level `top` takes.
    pub(super) fn work(&self, top: usize) -> f64 {
        let nodes = self.levels[1..=top].iter().map(|level| level.network.nodes() as f64);
        2.0 * nodes.sum::<f64>() + self.coarsest.solve_work() / self.per_visit
    }

    /// Number of visits of unknowns that so many steps of the active set method on the coarsest level take.
    pub(super) fn coarsest_work(&self, steps: usize) -> f64 {
        steps as f64 * self.coarsest.step_work() / self.per_visit
    }

    /// Holds nodes of level `top` and of all coarser levels at zero; returns the work in visits of unknowns.
    pub(super) fn hold(&mut self, top: usize, held: &[bool]) -> f64 {
        let mut work = self.coarsest.factor_work() / self.per_visit;
        self.vectors[top].springs.fill(0.0);
        for level in (0..=top).rev() {
            let (coarser, vectors) = self.vectors.split_at_mut(level);
            let CycleLevel { inverse, springs, .. } = &mut vectors[0];
            let diagonal = self.levels[level].network.diagonal();
            for (node, inverse) in inverse.iter_mut().enumerate() {
                *inverse = if held[node] { 0.0 } else { 1.0 / (diagonal[node] + springs[node]) };
            }
            if let Some(coarser) = coarser.last_mut() {
                let fine = HeldLevel { held, springs };
                work += set_coarse_springs(&self.levels[level], &fine, &mut coarser.springs);
            }
        }
        self.coarsest.factor(self.vectors[0].inverse.iter().map(|inverse| 1.0 / inverse));
        work
    }

    /// Applies the cycle to a residual of level `top` and returns the correction, zero at held nodes.
    pub(super) fn apply(&mut self, top: usize, residual: &[f64]) -> &[f64] {
        if top == 0 {
            self.vectors[0].load.copy_from_slice(residual);
        } else {
            self.descend(top, residual);
        }
        for level in (1..top).rev() {
            let load = std::mem::take(&mut self.vectors[level].load);
            self.descend(level, &load);
            self.vectors[level].load = load;
        }
        self.solve_coarsest();
        for level in 1..top {
            let load = std::mem::take(&mut self.vectors[level].load);
            self.ascend(level, &load);
            self.vectors[level].load = load;
        }
        if top > 0 {
            self.ascend(top, residual);
        }
        &self.vectors[top].values
    }

    fn solve_coarsest(&mut self) {
        let CycleLevel { inverse, load, values, .. } = &mut self.vectors[0];
        for ((value, load), inverse) in values.iter_mut().zip(&*load).zip(&*inverse) {
            *value = if *inverse == 0.0 { 0.0 } else { *load };
        }
        self.coarsest.solve(values);
    }

    /// Sweeps forward from zero, and restricts the residual that is left.
    fn descend(&mut self, level: usize, load: &[f64]) {
        let NestedNetwork { network, parents } = &self.levels[level];
        let (coarser, vectors) = self.vectors.split_at_mut(level);
        let CycleLevel { inverse, values, .. } = &mut vectors[0];
        let coarse = &mut coarser[level - 1].load;
        for node in 0..network.nodes() {
            values[node] = inverse[node] * network.earlier(node).add_to(load[node], values);
        }
        // After the sweep the residual of a row is what the nodes visited later have added.
        let old = coarse.len();
        for (node, coarse) in coarse.iter_mut().enumerate() {
            let residual = network.later(node).add_to(0.0, values);
            *coarse = if inverse[node] == 0.0 { 0.0 } else { residual };
        }
        for (node, &[a, b]) in (old..).zip(parents) {
            if inverse[node] != 0.0 {
                let half = 0.5 * network.later(node).add_to(0.0, values);
                coarse[a as usize] += half;
                coarse[b as usize] += half;
            }
        }
    }

    /// Adds the interpolated correction of the coarser level, and sweeps backward.
    fn ascend(&mut self, level: usize, load: &[f64]) {
        let NestedNetwork { network, parents } = &self.levels[level];
        let (coarser, vectors) = self.vectors.split_at_mut(level);
        let CycleLevel { inverse, values, .. } = &mut vectors[0];
        let coarse = &coarser[level - 1].values;
        let (old, new) = values.split_at_mut(coarse.len());
        old.iter_mut().zip(coarse).for_each(|(value, correction)| *value += correction);
        for ((value, &[a, b]), inverse) in new.iter_mut().zip(parents).zip(&inverse[coarse.len()..])
        {
            // Nodes that the sweep visits before a held one would read its value.
            if *inverse != 0.0 {
                *value += 0.5 * (coarse[a as usize] + coarse[b as usize]);
            }
        }
        for node in (0..network.nodes()).rev() {
            values[node] = inverse[node] * network.row(node).add_to(load[node], values);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{AnyMesh, refined};
    use crate::multilevel::iterate::dot;

    #[test]
    fn the_cycle_is_symmetric_and_positive() {
        let Some(AnyMesh::Plane(mesh)) = AnyMesh::built_in("annulus") else { unreachable!() };
        for (top, held_from, held_nodes) in
            [(1, 30, 3), (2, 300, 3), (3, 0, 40), (3, 370, 3), (3, 300, 80)]
        {
            let (levels, _) = refined(&mesh, top).unwrap();
            let network = &levels[top].network;
            let nodes = network.nodes();
            let count = network.contact().len();
            let mut held = vec![false; nodes];
            for k in held_from..held_from + held_nodes {
                held[network.contact()[k % count].node] = true;
            }
            let mut cycle = Cycle::new(&levels);
            cycle.hold(top, &held);
            let vector = |seed: usize| -> Vec<f64> {
                let value = |k: usize| ((k * k + 3 * seed * k + seed) % 101) as f64 / 50.0 - 1.0;
                (0..nodes).map(|k| if held[k] { 0.0 } else { value(k) }).collect()
            };
            let (u, v) = (vector(1), vector(2));
            let of_u = cycle.apply(top, &u).to_vec();
            let of_v = cycle.apply(top, &v).to_vec();
            let (one, two) = (dot(&of_u, &v), dot(&u, &of_v));
            let size = (dot(&of_u, &u) * dot(&of_v, &v)).sqrt();
            assert!((one - two).abs() < 1e-12 * size, "{top} {held_from}: {one} {two} {size}");
            assert!(dot(&of_u, &u) > 0.0 && dot(&of_v, &v) > 0.0);
        }
    }
}
