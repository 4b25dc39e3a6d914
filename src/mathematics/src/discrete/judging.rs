//! Judgement of nodal vectors on any triangulation, by the measure of all solvers.

use super::kkt::{Judge, JudgedValues, Judgement};
use super::network::Network;
use crate::problem::law::Law;

/// Judges the nodal vector `y` of a network, as [`judge`](super::kkt::judge) does on the square; the flux is in the order
/// of the contact nodes. A value at a fixed node counts as a residual.
///
/// # Panics
/// If a slice is not a nodal vector of the network.
pub fn judge_network(network: &Network, law: Law, y: &[f64], load: &[f64]) -> Judgement {
    assert!(y.len() == network.nodes() && load.len() == y.len());
    let mut gradient = vec![0.0; y.len()];
    network.gradient(y, load, &mut gradient);
    let mut judge = Judge::with_energy(network.energy(y, load), y, load);
    let mut flux = Vec::with_capacity(network.contact().len());
    for contact in network.contact() {
        flux.push(std::mem::take(&mut gradient[contact.node]));
    }
    for &node in network.fixed() {
        gradient[node as usize] = y[node as usize];
    }
    judge.see_residuals(&gradient);
    let cells = (y.len() as f64).sqrt() as usize;
    judge.judgement(JudgedValues { law, cells, y, contact: network.contact().to_vec(), flux })
}
