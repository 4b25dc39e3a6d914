//! Many random problems.

use crate::discrete::grid::Grid;
use crate::discrete::stop::Stop;
use crate::experiments::numbers::RandomNumbers;
use crate::experiments::problems::nodal_load;
use crate::experiments::trial::{Trial, multigrid_trial};
use crate::machine::threads::map_range;
use crate::multigrid::Goal;
use serde::Serialize;
use std::array::from_fn;

const SEED: u64 = 0x5167_6e6f;
/// Factors of the cells per side; the other factor is 2, 4, ..., 32.
const COARSEST: [usize; 2] = [1, 3];
const DOUBLINGS: usize = 5;
const WAVES: usize = 12;

/// Result of multigrid on random problems, to the rounding floor.
#[derive(Serialize)]
pub(super) struct RandomProblems {
    /// Number of problems.
    problems: usize,
    /// Cells per side of the coarsest grid.
    coarsest: usize,
    /// Cells per side of the finest grid.
    finest: usize,
    /// Mean number of cycles.
    mean: f64,
    /// Greatest number of cycles.
    most: usize,
    /// Number of problems on which multigrid did not reach the rounding floor.
    unsolved: usize,
    /// Number of problems on which its claim was wrong.
    wrong: usize,
}

impl RandomProblems {
    pub(super) fn of(problems: usize) -> Self {
        let trials = map_range(0..problems, 1, trial);
        let cycles: Vec<_> = trials.iter().map(|trial| trial.steps).collect();
        Self {
            problems,
            coarsest: 2 * COARSEST[0],
            finest: COARSEST[1] << DOUBLINGS,
            mean: cycles.iter().sum::<usize>() as f64 / problems as f64,
            most: cycles.iter().copied().max().unwrap_or(0),
            unsolved: trials.iter().filter(|trial| trial.stop != Some(Stop::RoundingFloor)).count(),
            wrong: trials.iter().filter(|trial| trial.holds == Some(false)).count(),
        }
    }
}

/// Solves a problem with waves of random amplitude, noise of random size, and a deficit from 10^-8 to 10^-0.3.
fn trial(number: usize) -> Trial {
    let mut random = RandomNumbers::new(SEED, number as u64);
    let n = COARSEST[random.below(2)] << (1 + random.below(DOUBLINGS));
    let amplitudes: [f64; WAVES] = from_fn(|_| 2.0 * random.unit() - 1.0);
    let noise: Vec<f64> = (0..(n + 1) * (n + 1)).map(|_| random.unit() - 0.5).collect();
    let (roughness, exponent) = (2.0 * random.unit(), -8.0 + 7.7 * random.unit());
    let deficit = libm::pow(10.0, exponent);
    let grid = Grid::new(n).expect("fine enough");
    // Each wave is a product of a function of x and one of y, which are kept for all nodes of an axis.
    let (mut along_x, mut along_y) = (Vec::new(), Vec::new());
    for i in 0..=n {
        let s = i as f64 * grid.h() - 0.5;
        along_x.push(from_fn::<f64, WAVES, _>(|k| {
            amplitudes[k] * libm::sin((k / 4 + 1) as f64 * 2.0 * s + k as f64)
        }));
        along_y.push(from_fn::<f64, WAVES, _>(|k| libm::cos((k % 4) as f64 * 2.5 * s + 0.3)));
    }
    let load = nodal_load(n, Some(deficit), |x, y| {
        let (i, j) = (nearest_node(n, x), nearest_node(n, y));
        let smooth: f64 = along_x[i].iter().zip(&along_y[j]).map(|(x, y)| x * y).sum();
        smooth + roughness * noise[j * (n + 1) + i]
    });
    multigrid_trial(grid, &load, Goal::RoundingFloor)
}

/// Number of the node nearest to a coordinate, of the nodes 0 to `n` on an axis.
fn nearest_node(n: usize, coordinate: f64) -> usize {
    ((coordinate + 0.5) * n as f64).round() as usize
}
