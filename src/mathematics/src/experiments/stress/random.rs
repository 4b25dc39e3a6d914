//! Many random problems.

use crate::discrete::grid::Grid;
use crate::experiments::numbers::RandomNumbers;
use crate::experiments::problems::nodal_load;
use crate::experiments::trial::{Trial, multi};
use crate::multigrid::Goal;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::array::from_fn;

const SEED: u64 = 0x5167_6e6f;
/// Cells per side are these times 2, 4, ..., 32.
const COARSEST: [usize; 2] = [1, 3];
const DOUBLINGS: usize = 5;
const WAVES: usize = 12;

/// Results of multigrid for random problems, to the rounding floor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Random {
    /// Their number.
    pub problems: usize,
    /// Cells per side of the coarsest grid.
    pub coarsest: usize,
    /// Cells per side of the finest grid.
    pub finest: usize,
    /// Mean number of cycles.
    pub mean: f64,
    /// Greatest number of cycles.
    pub most: usize,
    /// Number of problems for which it did not come to the rounding floor.
    pub unsolved: usize,
    /// Number of problems for which its claim was wrong.
    pub wrong: usize,
}

impl Random {
    pub(super) fn of(problems: usize) -> Self {
        let trials: Vec<_> = (0..problems).into_par_iter().map(trial).collect();
        let cycles = || trials.iter().map(|trial| trial.steps);
        let count = |of: fn(&Trial) -> bool| trials.iter().filter(|trial| of(trial)).count();
        Self {
            problems,
            coarsest: 2 * COARSEST[0],
            finest: COARSEST[1] << DOUBLINGS,
            mean: cycles().sum::<usize>() as f64 / problems as f64,
            most: cycles().max().unwrap_or(0),
            unsolved: count(|trial| trial.stop != "rounding-floor"),
            wrong: count(|trial| trial.holds == Some(false)),
        }
    }
}

/// Waves of random amplitude, noise of random size, and a deficit from 10^-8 to 10^-0.3.
fn trial(number: usize) -> Trial {
    let mut random = RandomNumbers::new(SEED, number as u64);
    let n = COARSEST[random.below(2)] << (1 + random.below(DOUBLINGS));
    let amplitudes: [f64; WAVES] = from_fn(|_| 2.0 * random.unit() - 1.0);
    let noise: Vec<f64> = (0..(n + 1) * (n + 1)).map(|_| random.unit() - 0.5).collect();
    let (roughness, exponent) = (2.0 * random.unit(), -8.0 + 7.7 * random.unit());
    let deficit = libm::pow(10.0, exponent);
    let grid = Grid::new(n).expect("fine enough");
    // Each wave is a product of a function of x and one of y.
    let along = |f: &dyn Fn(usize, f64) -> f64| -> Vec<[f64; WAVES]> {
        (0..=n).map(|i| from_fn(|k| f(k, i as f64 * grid.h() - 0.5))).collect()
    };
    let along_x = along(&|k, x| amplitudes[k] * libm::sin((k / 4 + 1) as f64 * 2.0 * x + k as f64));
    let along_y = along(&|k, y| libm::cos((k % 4) as f64 * 2.5 * y + 0.3));
    let index = |x: f64| ((x + 0.5) * n as f64).round() as usize;
    let load = nodal_load(n, Some(deficit), |x, y| {
        let (i, j) = (index(x), index(y));
        let smooth: f64 = along_x[i].iter().zip(&along_y[j]).map(|(x, y)| x * y).sum();
        smooth + roughness * noise[j * (n + 1) + i]
    });
    multi(grid, &load, Goal::RoundingFloor, None)
}
