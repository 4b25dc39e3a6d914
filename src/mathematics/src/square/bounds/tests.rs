//! Bounds on the square against known energies and errors, and steps of their proof against integrals.

mod cell;
mod known;
mod rounding;
mod sums;
mod sweep;

use super::*;
use crate::discrete::load::{Diagonal, LoadRule};

/// Rule of loads of the piecewise linear vector.
const EXACT: LoadRule = LoadRule::Exact { diagonal: Diagonal::Rising };

/// Number between -`size` and `size` that looks random.
fn noise(k: usize, size: f64) -> f64 {
    size * libm::sin((k + 1) as f64 * 78.233)
}

/// Vector of such numbers.
fn vector(grid: Grid, k: usize, size: f64) -> Vec<f64> {
    (0..grid.nodes()).map(|node| noise(10_000 * k + node, size)).collect()
}

/// A grid whose cells are all at the boundary of a sweep's blocks, and one with cells inside them.
fn grids() -> [Grid; 2] {
    [7, 40].map(|n| Grid::new(n).unwrap())
}

/// Functions f with jumps inside cells and between them, and a smooth one.
fn sources() -> [Source; 5] {
    [
        "else=-0.7",
        "rect(-0.21,0.33,-0.07,0.42)=3; else=-1.6",
        "halfplane(1,0.6,-0.13)=-2; disc(0.31,-0.2,0.12)=5; else=0.9",
        "quadrant(ll)=3; rect(0.5,1,-1,0)=1; else=-1.25",
        "formula(4*x*y*y-x-0.3)",
    ]
    .map(|f| f.parse().unwrap())
}

/// Laws of all kinds, one of them with ends that no reaction reaches.
fn laws() -> [Law; 7] {
    let [narrow, wide] = [-0.4, -3.0].map(|lo| Law::new(lo, 1.5).unwrap());
    let half_line = Law::new(-0.5, f64::INFINITY).unwrap();
    let limited = Law::limited(2.0).unwrap();
    let far = Law::friction(1e3).unwrap();
    [Law::SIGNORINI, Law::SIGNORINI.reflected(), narrow, wide, half_line, limited, far]
}
