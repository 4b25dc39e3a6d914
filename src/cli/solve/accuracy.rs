//! `solve --accuracy`: the grid is chosen, from coarse to fine, with the guaranteed bound as judge.

use super::answer::Answer;
use super::problem::Problem;
use crate::pipeline::error::{Error, Result};
use crate::replication::scene::MAX_CELLS;

/// Cells per side of the first grid.
const FIRST: usize = 16;
/// From here on the error is known to fall like the width of the grid.
const SETTLED: usize = 128;
/// Widths fall by this factor at most from one grid to the next.
const STRIDE: usize = 8;

/// Solves on one grid after the other until the bound of the error in the energy norm, relative to that of
/// the solution, is at most `wanted`. Coarser grids cost less than the last one together.
pub(super) fn solve(problem: &mut Problem, wanted: f64) -> Result<Answer> {
    if !(wanted > 0.0 && wanted < 1.0) {
        return Err(Error::input(format!(
            "--accuracy {wanted}: must be between 0 and 1, e.g. 1e-3 for an error of 0.1 % in the energy norm"
        )));
    }
    let (mut finest, mut levels) = (FIRST, Vec::new());
    loop {
        problem.grids = vec![finest];
        problem.domain.check_solver(problem.solver, finest)?;
        let mut answer = problem.solve()?;
        levels.append(&mut answer.levels);
        let reached = match &answer.bounds {
            Ok(bounds) => bounds.relative(),
            Err(reason) => {
                return Err(Error::input(format!(
                    "--accuracy: no bound of the error: {reason}; scale f"
                )));
            }
        };
        if reached <= wanted || answer.failure.is_some() {
            answer.levels = levels;
            return Ok(answer);
        }
        // The error falls like the width.
        let needed = finest as f64 * reached / wanted;
        let last = MAX_CELLS as f64;
        if finest == MAX_CELLS || (finest >= SETTLED && needed > 1.02 * last) {
            let best = reached * finest as f64 / last;
            return Err(Error::input(format!(
                "--accuracy {wanted:e} takes a grid of about 1/{needed:.0}, too fine for memory; 1/{MAX_CELLS} reaches about {best:.1e}"
            )));
        }
        finest = size(needed.min(finest as f64 * STRIDE as f64)).clamp(finest + 1, MAX_CELLS);
    }
}

/// The least size of grid that multigrid takes, four to seven times a power of two, with a little to spare.
fn size(needed: f64) -> usize {
    let needed = (1.003 * needed).ceil() as usize;
    let mut unit = 2;
    while 8 * unit < needed {
        unit *= 2;
    }
    unit * needed.div_ceil(unit).max(4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_suit_multigrid_and_are_hardly_finer_than_needed() {
        for needed in 9..5000 {
            let n = size(f64::from(needed));
            let odd = n >> n.trailing_zeros();
            assert!(odd <= 7 && n as f64 >= f64::from(needed), "{needed} {n}");
            assert!((n as f64) < 1.3 * f64::from(needed) + 2.0, "{needed} {n}");
        }
    }
}
