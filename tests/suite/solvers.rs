//! Limits that every solver must keep, and comparisons of solutions.

use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::problem::law::Law;

/// Most work units in which multigrid reaches the discretisation error, a residual of 1e-10 and the rounding floor on
/// the square, for the paper's problems and smooth loads, on grids from 1/64 on. Residuals and transfers count as well.
pub(crate) const WORK_UNITS: [f64; 3] = [12.0, 28.0, 55.0];
/// The same for loads with scattered or vanishing contact.
pub(crate) const HARD_WORK_UNITS: [f64; 3] = [24.0, 52.0, 110.0];
/// The same for all loads on the mesh of the cube.
pub(crate) const NETWORK_WORK_UNITS: [f64; 3] = [24.0, 120.0, 200.0];
/// Work units to the discretisation error that Brandt calls textbook multigrid efficiency.
pub(crate) const TEXTBOOK: f64 = 10.0;
/// Algebraic over discretisation error at the first goal.
pub(crate) const ALGEBRAIC: f64 = 0.1;

/// What comes out on so many threads.
pub(crate) fn on_threads<T: Send>(threads: usize, compute: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("a pool").install(compute)
}

/// Fails if the result depends on the number of threads, in any bit, or on whether one of them asks.
pub(crate) fn assert_threads_do_not_matter(solve: impl Fn() -> Vec<f64> + Sync) {
    let one = on_threads(1, &solve);
    for threads in [2, 3] {
        assert!(one == on_threads(threads, &solve), "{threads} threads");
    }
    assert!(one == solve(), "from outside");
}

/// The largest difference of two vectors.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The H1 seminorm of the difference of two functions that are linear on triangles.
pub(crate) fn distance_in_h1(grid: Grid, a: &[f64], b: &[f64]) -> f64 {
    let difference: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    // Without a load the energy is half of the square of the seminorm.
    (2.0 * judge((grid, Law::SIGNORINI), &difference, &vec![0.0; difference.len()]).energy).sqrt()
}
