//! Smoothed aggregation: levels coarser than a mesh that no coarser mesh belongs to.
//!
//! # Algorithm
//! Nodes are put together to [aggregates]; a coarse function is the indicator function of an aggregate after a step of
//! Jacobi's method over the strong couplings,
//!
//! ```text
//! P = (I - omega D^-1 S) P0,   S: strong couplings, with rows that sum to zero; D: diagonal of S,
//! ```
//!
//! and the coarse matrix is `P' A P` (P. Vanek, J. Mandel and M. Brezina, Computing 56 (1996) 179-196). Two rules make
//! each coarse level a problem of the same kind: aggregates have contact nodes or inner nodes, and in rows of contact
//! nodes S has couplings to contact nodes alone. So the values of a fine contact node are means of those of coarse
//! contact nodes, and keep their sign.

use super::aggregates::{Aggregates, NONE, Strength, aggregates};
use super::interpolation::{WeightedNode, WeightedRows};
use crate::discrete::network::{MatrixRows, Network};
use crate::problem::law::LawSum;

/// Weight of the step of Jacobi's method.
const OMEGA: f64 = 0.9;
/// Part of the diagonal above which a coupling is strong, on the mesh; half as large on each coarser level, whose
/// couplings are more even. With fewer strong couplings aggregates are smaller, and levels cost more.
pub(super) const STRONG: f64 = 0.03;
/// Such a part for cells that are sheared and stretched, where couplings of any size are of little use to steps.
pub(super) const VERY_STRONG: f64 = 0.25;
/// Part of the nodes at which a coarser level is still worth its cost.
const LARGEST_PART: f64 = 0.7;
/// Number of nodes below which a level is solved by factors.
pub(super) const MOST_DIRECT: usize = 60;

/// Level made from aggregates of the next finer one.
pub(super) struct CoarseLevel {
    /// Discrete problem.
    pub(super) network: Network,
    /// Interpolation to the finer level.
    pub(super) rows: WeightedRows,
    /// Node of this level whose aggregate has each contact node of the finer level, in the order of the network.
    pub(super) of_contact: Vec<u32>,
}

/// Levels below a network, finest first, until factors are cheap; `strong` is the part of the diagonal above which a
/// coupling of the network is strong.
pub(super) fn coarse_levels(network: &Network, strong: f64) -> Vec<CoarseLevel> {
    let (mut levels, mut part) = (Vec::<CoarseLevel>::new(), strong);
    loop {
        let finest = levels.last().map_or(network, |level| &level.network);
        if finest.nodes() <= MOST_DIRECT {
            return levels;
        }
        let Some(level) = coarse_level(finest, part) else { return levels };
        levels.push(level);
        part *= 0.5;
    }
}

/// Next coarser level; none if no choice of strong couplings makes one that is small enough.
fn coarse_level(network: &Network, part: f64) -> Option<CoarseLevel> {
    for part in [part, 0.25 * part, 0.0] {
        let strength = Strength::new(network, part);
        let aggregates = aggregates(network, &strength);
        if aggregates.count as f64 <= LARGEST_PART * network.nodes() as f64 {
            return Some(level_of(network, &strength, &aggregates));
        }
    }
    None
}

fn level_of(
    network: &Network,
    strength: &Strength<'_>,
    Aggregates { of_nodes, count }: &Aggregates,
) -> CoarseLevel {
    let interpolation = smoothed(network, strength, of_nodes);
    let of_contact = network.contact().iter().map(|contact| of_nodes[contact.node]);
    CoarseLevel {
        network: galerkin(network, &interpolation, *count),
        of_contact: of_contact.collect(),
        rows: interpolation.rows,
    }
}

/// Interpolation from a coarse level.
struct FromAggregates {
    rows: WeightedRows,
    /// One less the sum of each row: zero but at and beside fixed nodes.
    missing: Vec<f64>,
}

/// Interpolation by the smoothed indicator functions of the aggregates.
fn smoothed(network: &Network, strength: &Strength<'_>, of_nodes: &[u32]) -> FromAggregates {
    let mut rows = WeightedRows::with_capacity(of_nodes.len(), 3 * of_nodes.len());
    let is_contact = |node: usize| network.contact_at(node).is_some();
    let mut missing = vec![0.0; of_nodes.len()];
    let mut row: Vec<WeightedNode> = Vec::new();
    for (node, &own) in of_nodes.iter().enumerate() {
        row.clear();
        if own == NONE {
            rows.push(&row);
            missing[node] = 1.0;
            continue;
        }
        row.push(WeightedNode { node: own, weight: 0.0 });
        let (mut sum, mut fixed, at_contact) = (0.0, 0.0, is_contact(node));
        for (other, weight) in strength.of(node) {
            if at_contact && !is_contact(other) {
                continue;
            }
            sum += weight;
            match of_nodes[other] {
                NONE => fixed += weight,
                aggregate => add(&mut row, WeightedNode { node: aggregate, weight }),
            }
        }
        if sum == 0.0 {
            row[0].weight = 1.0;
        } else {
            row.iter_mut().for_each(|entry| entry.weight *= OMEGA / sum);
            row[0].weight += 1.0 - OMEGA;
            missing[node] = OMEGA * fixed / sum;
        }
        rows.push(&row);
    }
    FromAggregates { rows, missing }
}

/// Adds an entry to a row.
fn add(row: &mut Vec<WeightedNode>, WeightedNode { node, weight }: WeightedNode) {
    match row.iter_mut().find(|entry| entry.node == node) {
        Some(entry) => entry.weight += weight,
        None => row.push(WeightedNode { node, weight }),
    }
}

/// Row of a sparse product in the making.
struct Accumulator {
    /// Place of each column in `row`, if it is there.
    places: Vec<u32>,
    row: Vec<WeightedNode>,
}

impl Accumulator {
    fn new(columns: usize) -> Self {
        Self { places: vec![NONE; columns], row: Vec::new() }
    }

    #[inline(always)]
    fn add(&mut self, node: u32, weight: f64) {
        let place = &mut self.places[node as usize];
        if *place == NONE {
            *place = self.row.len() as u32;
            self.row.push(WeightedNode { node, weight });
        } else {
            self.row[*place as usize].weight += weight;
        }
    }

    /// Hands over the row, and begins the next one.
    fn finish(&mut self, take: impl FnOnce(&[WeightedNode])) {
        take(&self.row);
        self.row.iter().for_each(|entry| self.places[entry.node as usize] = NONE);
        self.row.clear();
    }
}

/// Discrete problem of the coarse functions: `P' A P`, with the sums of the laws of the contact nodes and the
/// means of their values.
fn galerkin(network: &Network, interpolation: &FromAggregates, coarse: usize) -> Network {
    let FromAggregates { rows: interpolation, missing } = interpolation;
    let nodes = network.nodes();
    let mut accumulator = Accumulator::new(coarse);
    let mut images = WeightedRows::with_capacity(nodes, 5 * nodes);
    // Sums of the rows of the coarse matrix: P' A times the sum of all coarse functions, which is constant but at and
    // beside fixed nodes.
    let mut sums = vec![0.0; coarse];
    for node in 0..nodes {
        let row = network.row(node);
        let (mut within, mut beyond) = (0.0, 0.0);
        let diagonal = network.diagonal()[node];
        for (&other, weight) in row.others.iter().zip(row.weights) {
            within += weight;
            beyond += weight * missing[other as usize];
            let entries = interpolation.row(other as usize);
            entries.iter().for_each(|entry| accumulator.add(entry.node, -weight * entry.weight));
        }
        let sum = diagonal - within + beyond - diagonal * missing[node];
        for entry in interpolation.row(node) {
            accumulator.add(entry.node, diagonal * entry.weight);
            sums[entry.node as usize] += entry.weight * sum;
        }
        accumulator.finish(|row| images.push(row));
    }
    let transposed = interpolation.transposed(coarse);
    let mut rows = MatrixRows::with_capacity(coarse, 8 * coarse);
    for node in 0..coarse {
        for fine in transposed.row(node) {
            for entry in images.row(fine.node as usize) {
                accumulator.add(entry.node, fine.weight * entry.weight);
            }
        }
        accumulator.finish(|row| {
            let others = row.iter().filter(|entry| entry.node as usize != node);
            rows.push(others.map(|entry| (entry.node, -entry.weight)));
        });
    }
    let (mut laws, mut masses) = (vec![LawSum::default(); coarse], vec![0.0; coarse]);
    let mut values = vec![0.0; coarse];
    for contact in network.contact() {
        for entry in interpolation.row(contact.node) {
            let measure = entry.weight * contact.measure;
            laws[entry.node as usize].add(contact.law, measure);
            values[entry.node as usize] += measure * contact.law.at();
        }
    }
    for (node, mass) in network.masses().iter().enumerate() {
        for entry in interpolation.row(node) {
            masses[entry.node as usize] += entry.weight * mass;
        }
    }
    let contact = laws.into_iter().enumerate().filter(|(_, laws)| laws.measure > 0.0);
    let contact = contact
        .map(|(node, mut laws)| {
            laws.at = values[node] / laws.measure;
            laws.at_node(node)
        })
        .collect();
    Network::of_rows(rows, contact, masses).with_additions(&sums)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{AnyMesh, refined};
    use crate::multilevel::interpolation::product;
    use crate::problem::law::Law;

    /// Discrete problem of the L-shape, refined four times, with a fixed part or without one.
    fn network(law: Law) -> Network {
        let Some(AnyMesh::Plane(mut mesh)) = AnyMesh::built_in("lshape") else { unreachable!() };
        mesh.parts_mut()[0].law = law;
        let (mut levels, _) = refined(&mesh, 4).unwrap();
        levels.pop().expect("the finest level").network
    }

    #[test]
    fn levels_shrink_to_a_size_for_factors() {
        let network = network(Law::SIGNORINI);
        let levels = coarse_levels(&network, STRONG);
        let mut finer = network.nodes();
        for level in &levels {
            assert!(level.network.nodes() < finer / 4, "{} of {finer}", level.network.nodes());
            finer = level.network.nodes();
        }
        assert!(finer <= MOST_DIRECT);
    }

    #[test]
    fn contact_nodes_are_means_of_contact_nodes_and_measures_sum_up() {
        let network = network(Law::SIGNORINI);
        let mut finer = &network;
        let levels = coarse_levels(&network, STRONG);
        for CoarseLevel { network, rows, of_contact } in &levels {
            for (contact, &aggregate) in finer.contact().iter().zip(of_contact) {
                let row = rows.row(contact.node);
                let sum: f64 = row.iter().map(|entry| entry.weight).sum();
                assert!((sum - 1.0).abs() < 1e-14 && row.iter().all(|entry| entry.weight >= 0.0));
                assert!(row.iter().any(|entry| entry.node == aggregate));
                for entry in row {
                    assert!(network.contact_at(entry.node as usize).is_some());
                }
            }
            assert!((network.laws().measure / finer.laws().measure - 1.0).abs() < 1e-13);
            finer = network;
        }
    }

    #[test]
    fn the_coarse_energy_is_that_of_the_interpolated_function() {
        for law in [Law::SIGNORINI, Law::FIXED] {
            let network = network(law);
            let mut finer = &network;
            for CoarseLevel { network, rows, .. } in &coarse_levels(&network, STRONG) {
                let nodes = network.nodes();
                let coarse: Vec<f64> = (0..nodes).map(|k| ((k * k) % 17) as f64 - 8.0).collect();
                let fine: Vec<f64> = rows.rows().map(|row| product(row, &coarse)).collect();
                let energies = [
                    network.energy(&coarse, &vec![0.0; nodes]),
                    finer.energy(&fine, &vec![0.0; fine.len()]),
                ];
                assert!((energies[0] / energies[1] - 1.0).abs() < 1e-12, "{energies:?}");
                finer = network;
            }
        }
    }
}
