//! The cycle: an approximate inverse of the stiffness matrix on the nodes that are not held at zero.

use super::interpolation::{HeldLevel, Interpolation, product, set_coarse_springs};
use super::levels::NetworkLevels;
use crate::multigrid::direct::{Direct, FactorOrder};

/// Vectors of one level.
struct CycleLevel {
    /// Flag for each node, true if it is held.
    held: Vec<bool>,
    /// One over the diagonal with its spring; zero at held nodes.
    inverse: Vec<f64>,
    /// Additions to the diagonal.
    springs: Vec<f64>,
    /// Right-hand side; not used on the finest level in use, where the caller has it.
    load: Vec<f64>,
    /// Correction.
    values: Vec<f64>,
}

/// Cycle with one symmetric Gauss-Seidel sweep, half before and half after the coarser levels, whose functions leave
/// out what is held. Each mesh visits the coarser one once (V-cycle); each level of aggregates, where the next one has
/// an eighth of the nodes or less, visits it twice (W-cycle).
pub(super) struct Cycle<'a> {
    levels: &'a NetworkLevels<'a>,
    vectors: Vec<CycleLevel>,
    coarsest: Direct,
    /// Visits of a level of aggregates by one visit of the next finer one.
    visits: usize,
    /// Multiplications of one visit of an unknown, for the work of the coarsest level.
    per_visit: f64,
}

impl<'a> Cycle<'a> {
    pub(super) fn new(levels: &'a NetworkLevels<'a>) -> Self {
        let mut vectors: Vec<CycleLevel> = Vec::new();
        for level in &levels.levels {
            let nodes = level.network.nodes();
            let zeros = || vec![0.0; nodes];
            vectors.push(CycleLevel {
                held: vec![false; nodes],
                inverse: zeros(),
                springs: zeros(),
                load: zeros(),
                values: zeros(),
            });
        }
        Self {
            levels,
            vectors,
            coarsest: Direct::new(levels.network(0), FactorOrder::MinimumDegree),
            visits: 2,
            per_visit: levels.network(levels.finest()).row_length(),
        }
    }

    /// Number of visits of a level by one visit of the next finer one.
    fn visits(&self, level: usize) -> usize {
        if level > 0 && level < self.levels.coarsest_mesh { self.visits } else { 1 }
    }

    /// Visits each level once from now on: such a cycle is positive whatever is held, the one with two visits may not
    /// be.
    pub(super) fn visit_once(&mut self) {
        self.visits = 1;
    }

    /// Number of visits of unknowns that one application on level `top` takes.
    pub(super) fn work(&self, top: usize) -> f64 {
        let (mut work, mut visits) = (0.0, 1.0);
        for level in (1..=top).rev() {
            let network = self.levels.network(level);
            let of_sweeps = 2.0 * network.nodes() as f64;
            work += visits * of_sweeps * (network.row_length() / self.per_visit);
            visits *= self.visits(level - 1) as f64;
        }
        work + visits * self.coarsest.solve_work() / self.per_visit
    }

    /// Number of visits of unknowns that so many steps of the active set method on the coarsest level take.
    pub(super) fn coarsest_work(&self, steps: usize) -> f64 {
        steps as f64 * self.coarsest.step_work() / self.per_visit
    }

    /// Holds nodes of level `top`, and what follows on all coarser levels, at zero; returns the work in visits of
    /// unknowns.
    pub(super) fn hold(&mut self, top: usize, held: &[bool]) -> f64 {
        let mut work = self.coarsest.factor_work() / self.per_visit;
        self.vectors[top].springs.fill(0.0);
        self.vectors[top].held.copy_from_slice(held);
        for level in (0..=top).rev() {
            let (coarser, vectors) = self.vectors.split_at_mut(level);
            let CycleLevel { held, inverse, springs, .. } = &mut vectors[0];
            let network = self.levels.network(level);
            for (node, inverse) in inverse.iter_mut().enumerate() {
                let diagonal = network.diagonal()[node] + springs[node];
                *inverse = if held[node] { 0.0 } else { 1.0 / diagonal };
            }
            let interpolation = self.levels.levels[level].interpolation.as_ref();
            if let (Some(coarser), Some(interpolation)) = (coarser.last_mut(), interpolation) {
                self.levels.hold_coarser(level, held, &mut coarser.held);
                let fine = HeldLevel { network, interpolation, held, springs };
                work += set_coarse_springs(&fine, &coarser.held, &mut coarser.springs);
            }
        }
        self.coarsest.factor(self.vectors[0].inverse.iter().map(|inverse| 1.0 / inverse));
        work
    }

    /// Applies the cycle to a residual of level `top` and returns the correction, zero at held nodes.
    pub(super) fn apply(&mut self, top: usize, residual: &[f64]) -> &[f64] {
        if top == 0 {
            self.vectors[0].load.copy_from_slice(residual);
            self.solve_coarsest();
        } else {
            self.correct(top, residual);
        }
        &self.vectors[top].values
    }

    /// Computes the values of a level for the load of another vector than its own.
    fn correct(&mut self, level: usize, load: &[f64]) {
        self.descend(level, load);
        match level - 1 {
            0 => self.solve_coarsest(),
            coarser => {
                let mut load = std::mem::take(&mut self.vectors[coarser].load);
                self.correct(coarser, &load);
                for _ in 1..self.visits(coarser) {
                    self.correct_again(coarser, &mut load);
                }
                self.vectors[coarser].load = load;
            }
        }
        self.ascend(level, load);
    }

    /// Adds to the values of a level the correction for the residual that they leave, which takes the place of the
    /// load.
    fn correct_again(&mut self, level: usize, load: &mut [f64]) {
        let CycleLevel { inverse, values, .. } = &self.vectors[level];
        let network = self.levels.network(level);
        for (node, load) in load.iter_mut().enumerate() {
            *load = match inverse[node] {
                0.0 => 0.0,
                inverse => network.row(node).add_to(*load, values) - values[node] / inverse,
            };
        }
        let first = values.clone();
        self.correct(level, load);
        for (value, first) in self.vectors[level].values.iter_mut().zip(first) {
            *value += first;
        }
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
        let network = self.levels.network(level);
        let (coarser, vectors) = self.vectors.split_at_mut(level);
        let CycleLevel { inverse, values, .. } = &mut vectors[0];
        let coarse = &mut coarser[level - 1].load;
        for node in 0..network.nodes() {
            values[node] = inverse[node] * network.earlier(node).add_to(load[node], values);
        }
        // After the sweep the residual of a row is what the nodes visited later have added.
        match &self.levels.levels[level].interpolation {
            Some(Interpolation::Midpoints(fine)) => {
                let old = coarse.len();
                for (node, coarse) in coarse.iter_mut().enumerate() {
                    let residual = network.later(node).add_to(0.0, values);
                    *coarse = if inverse[node] == 0.0 { 0.0 } else { residual };
                }
                for (node, &[a, b]) in (old..).zip(&fine.parents) {
                    if inverse[node] != 0.0 {
                        let half = 0.5 * network.later(node).add_to(0.0, values);
                        coarse[a as usize] += half;
                        coarse[b as usize] += half;
                    }
                }
            }
            Some(Interpolation::Weighted(rows)) => {
                coarse.fill(0.0);
                for (node, row) in rows.rows().enumerate() {
                    if inverse[node] != 0.0 {
                        let residual = network.later(node).add_to(0.0, values);
                        for entry in row {
                            coarse[entry.node as usize] += entry.weight * residual;
                        }
                    }
                }
            }
            None => unreachable!("the coarsest level is solved directly"),
        }
    }

    /// Adds the interpolated correction of the coarser level, and sweeps backward.
    fn ascend(&mut self, level: usize, load: &[f64]) {
        let network = self.levels.network(level);
        let (coarser, vectors) = self.vectors.split_at_mut(level);
        let CycleLevel { inverse, values, .. } = &mut vectors[0];
        let coarse = &coarser[level - 1].values;
        // Nodes that the sweep visits before a held one would read its value.
        match &self.levels.levels[level].interpolation {
            Some(Interpolation::Midpoints(fine)) => {
                let (old, new) = values.split_at_mut(coarse.len());
                old.iter_mut().zip(coarse).for_each(|(value, correction)| *value += correction);
                let inverse = &inverse[coarse.len()..];
                for ((value, &[a, b]), inverse) in new.iter_mut().zip(&fine.parents).zip(inverse) {
                    if *inverse != 0.0 {
                        *value += 0.5 * (coarse[a as usize] + coarse[b as usize]);
                    }
                }
            }
            Some(Interpolation::Weighted(rows)) => {
                for ((value, row), inverse) in values.iter_mut().zip(rows.rows()).zip(&*inverse) {
                    if *inverse != 0.0 {
                        *value += product(row, coarse);
                    }
                }
            }
            None => unreachable!("the coarsest level is solved directly"),
        }
        for node in (0..network.nodes()).rev() {
            values[node] = inverse[node] * network.row(node).add_to(load[node], values);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::nested::NestedNetwork;
    use crate::mesh::{AnyMesh, refined};
    use crate::multilevel::iterate::dot;
    use crate::multilevel::smoothed::STRONG;
    use std::ops::Range;

    #[test]
    fn the_cycle_is_symmetric_and_positive() {
        let Some(AnyMesh::Plane(mesh)) = AnyMesh::built_in("annulus") else { unreachable!() };
        for (times, held_from, held_nodes) in
            [(1, 30, 3), (2, 300, 3), (3, 0, 40), (3, 370, 3), (3, 300, 80)]
        {
            let (nested, _) = refined(&mesh, times).unwrap();
            // The finest mesh alone lies above levels of aggregates.
            let network = nested[times].network.clone();
            let alone = [NestedNetwork { network, parents: Vec::new() }];
            for meshes in [&nested[..], &alone] {
                check_cycle(&NetworkLevels::new(meshes, STRONG), held_from..held_from + held_nodes);
            }
        }
    }

    /// Checks the cycle with contact nodes held at some positions.
    fn check_cycle(levels: &NetworkLevels<'_>, held_contact: Range<usize>) {
        let top = levels.finest();
        let network = levels.network(top);
        let nodes = network.nodes();
        let mut held = vec![false; nodes];
        for k in held_contact {
            held[network.contact()[k % network.contact().len()].node] = true;
        }
        let mut cycle = Cycle::new(levels);
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
        assert!((one - two).abs() < 1e-12 * size, "{nodes} nodes: {one} {two} {size}");
        assert!(dot(&of_u, &u) > 0.0 && dot(&of_v, &v) > 0.0);
    }
}
