//! Bounds that were set before anything was measured: one list for the tests and for the book.

use super::known::Errors;
use super::truth::{Elements, Level};
use super::{accuracy, cube};
use crate::discrete::norms::worst;
use serde::{Deserialize, Serialize};

/// Work units in which multigrid is to reach the goals of [`accuracy`], on grids from 1/64 on.
pub const WORK_UNITS: [f64; 3] = [12.0, 26.0, 55.0];
/// The bounds above were set for a count that left out residuals and transfers. They are not moved;
/// what may be reached with everything counted is this many times as much.
pub const COUNTED: f64 = 1.1;
/// Work units to the discretisation error that Brandt calls textbook multigrid efficiency, everything counted.
pub const TEXTBOOK: f64 = 10.0;
/// How many times [`WORK_UNITS`] are allowed for loads with scattered or vanishing contact, and on the cube.
pub const HARD: f64 = 2.0;
/// Algebraic over discretisation error at the first goal.
pub const ALGEBRAIC: f64 = 0.1;
/// Distance of an observed order from the best that linear elements have.
pub const ORDER: f64 = 0.05;
/// Bytes of a workspace per unknown, on the square and on the cube.
pub const BYTES: [f64; 2] = [24.0, 40.0];
/// On coarser grids of the square the rounding of rows to cache lines is much of a workspace.
pub const BYTES_FROM: usize = 256;

/// Guaranteed bound over error, from [`EFFECTIVE_FROM`] cells per side on.
pub const EFFECTIVITY: f64 = 1.01;
/// Cells per side from which the bound of the error is to be that close.
pub const EFFECTIVE_FROM: usize = 64;

/// A quantity, the bound it was to keep, and what it is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Target {
    /// What is bounded.
    pub name: String,
    /// The bound.
    pub bound: f64,
    /// Whether it is a lower one.
    pub at_least: bool,
    /// What was measured.
    pub measured: f64,
    /// Whether it is kept.
    pub met: bool,
}

impl Target {
    /// A quantity that is to be at most `bound`.
    pub fn at_most(name: impl Into<String>, bound: f64, measured: f64) -> Self {
        Self { name: name.into(), bound, at_least: false, measured, met: measured <= bound }
    }

    /// A quantity that is to be at least `bound`.
    pub fn at_least(name: impl Into<String>, bound: f64, measured: f64) -> Self {
        Self { name: name.into(), bound, at_least: true, measured, met: measured >= bound }
    }
}

/// The targets of the experiment on accuracy.
pub fn of_accuracy(found: &accuracy::Findings) -> Vec<Target> {
    let ranges = &found.ranges;
    let off = |orders: &[Errors], order: fn(&Errors) -> Option<f64>, best: f64| {
        let orders = orders.iter().filter_map(order);
        worst(orders.map(|order| order - best))
    };
    let (smooth, all) = (&ranges.orders, [ranges.orders, ranges.contact].concat());
    let mut targets = vec![
        Target::at_most("distance from order 2 of v in L2", ORDER, off(smooth, |e| e.l2, 2.0)),
        Target::at_most("distance from order 1 of v in H1", ORDER, off(&all, |e| Some(e.h1), 1.0)),
        Target::at_most(
            "distance from order 2 of v at the nodes, smooth f",
            ORDER,
            off(smooth, |e| Some(e.max), 2.0),
        ),
    ];
    for (norm, algebraic) in ["L2", "H1"].into_iter().zip(ranges.algebraic) {
        let name = format!("algebraic over discretisation error in {norm}");
        targets.push(Target::at_most(name, ALGEBRAIC, algebraic));
    }
    let textbook = "work units to the discretisation error, textbook efficiency";
    targets.push(Target::at_most(textbook, TEXTBOOK, ranges.known[0][1]));
    let goals =
        ["the discretisation error", "a residual of 1e-10, not scaled", "the rounding floor"];
    for (k, goal) in goals.into_iter().enumerate() {
        let name = format!("work units to {goal}");
        targets.push(Target::at_most(&name, WORK_UNITS[k], ranges.known[k][1]));
        let name = format!("{name}, hard loads");
        targets.push(Target::at_most(name, HARD * WORK_UNITS[k], ranges.others[k][1]));
    }
    let levels = found.problems.iter().flat_map(|problem| &problem.levels);
    let bytes = levels.filter(|level| level.cost.cells >= BYTES_FROM).map(|level| level.cost.bytes);
    if let Some(bytes) = bytes.reduce(f64::max) {
        targets.push(Target::at_most(
            "bytes per unknown from 1/256 on, one thread",
            BYTES[0],
            bytes,
        ));
    }
    targets
}

/// The targets of the experiment on the cube.
pub fn of_cube(found: &cube::Findings) -> Vec<Target> {
    let mut targets =
        vec![Target::at_most("cube: distance of the orders from 2, 1, 2", ORDER, found.off)];
    for (k, goal) in
        ["the discretisation error", "the residual", "the floor"].into_iter().enumerate()
    {
        let name = format!("cube: work units to {goal}");
        targets.push(Target::at_most(name, HARD * WORK_UNITS[k], found.most[k]));
    }
    targets.push(Target::at_most("cube: bytes per unknown, one thread", BYTES[1], found.bytes));
    targets
}

/// The targets of the guaranteed bounds, with the load that is the default and with that of `--accuracy`.
pub fn of_bounds(found: &[Elements]) -> Vec<Target> {
    let target = |load: &str, of: fn(&Level) -> f64| {
        let levels = found.iter().flat_map(|one| &one.levels);
        let fine = levels.filter(|level| level.cells >= EFFECTIVE_FROM);
        let name = format!("guaranteed bound over error from 1/{EFFECTIVE_FROM} on, load {load}");
        Target::at_most(name, EFFECTIVITY, worst(fine.map(of)))
    };
    vec![
        target("bilinear", |level| level.bilinear[1]),
        target("exact", |level| level.effectivity[1]),
    ]
}
