//! What to search: a family of f, and the way to go through it.

use super::space::{Lattice, Space};
use super::variant::Variant;
use serde::{Deserialize, Serialize};

/// How to go through a space.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "method")]
pub enum Method {
    /// Every point of the lattice.
    Enumerate,
    /// Simulated annealing on the lattice, from random points.
    Anneal {
        /// Number of independent chains.
        chains: u64,
        /// Candidates each chain tries.
        steps: u64,
    },
}

/// What to search. Two equal requests give equal reports.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// Family of f.
    pub space: Space,
    /// Values allowed: one lattice for all pieces, or one per piece.
    pub values: Vec<Lattice>,
    /// Reading of the method.
    pub variant: Variant,
    /// How to search.
    pub method: Method,
    /// Whether f must have a negative integral, as (2) asks.
    pub negative_integral: bool,
    /// Number of coarse grids whose counts must come out exactly; enumeration only. Two discard
    /// nearly everything at a cost of microseconds.
    pub exact_grids: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// How many candidates to keep.
    pub top: usize,
}
