//! The coarse grid from which the contact set is taken.

use super::jumps::{Curve, Jumps};
use crate::discrete::grid::Grid;
use crate::multigrid::square::multigrid;
use crate::multigrid::{Goal, MultigridParams};

/// Nodal values on a grid, up to discretisation error; `None` if the load has no negative sum.
pub(super) fn coarse(grid: Grid, jumps: &Jumps) -> Option<Vec<f64>> {
    let params = MultigridParams { goal: Goal::DiscretisationError, ..Default::default() };
    multigrid(grid.cells(), &load(grid, jumps), None, &params, |_| ()).ok().map(|(y, _)| y)
}

/// Integrals of f times bilinear hat functions, along scan lines: exact in x, two Gauss points in y
/// between rows of nodes and horizontal jumps.
fn load(grid: Grid, jumps: &Jumps) -> Vec<f64> {
    let (n, h) = (grid.cells(), grid.h());
    let mut levels: Vec<f64> = (0..=n).map(|j| grid.coordinate(j)).collect();
    levels.extend(jumps.curves.iter().filter_map(Curve::level).filter(|y| y.abs() < 0.5));
    levels.sort_by(f64::total_cmp);
    let mut load = vec![0.0; grid.nodes()];
    let mut row = vec![0.0; grid.side()];
    let mut cuts = Vec::new();
    for pair in levels.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        let j = (((middle + 0.5) / h) as usize).min(n - 1);
        for side in [-1.0, 1.0] {
            let y = middle + side * half / 3.0_f64.sqrt();
            cuts.clear();
            cuts.extend([-0.5, 0.5]);
            cuts.extend(jumps.curves.iter().flat_map(|curve| curve.at_level(y)));
            cuts.retain(|x| x.abs() <= 0.5);
            cuts.sort_by(f64::total_cmp);
            row.fill(0.0);
            for cut in cuts.windows(2) {
                let value = jumps.value(0.5 * (cut[0] + cut[1]), y);
                add(&mut row, h, [cut[0], cut[1]], value);
            }
            let up = (y - grid.coordinate(j)) / h;
            for (i, &integral) in row.iter().enumerate() {
                load[grid.index(i, j)] += half * (1.0 - up) * integral;
                load[grid.index(i, j + 1)] += half * up * integral;
            }
        }
    }
    load
}

/// Adds `value` times the integrals of the hat functions of a line over an interval.
fn add(row: &mut [f64], h: f64, [from, to]: [f64; 2], value: f64) {
    let cells = row.len() - 1;
    let cell = |x: f64| ((x + 0.5) / h) as usize;
    for k in cell(from)..=cell(to).min(cells - 1) {
        let left = k as f64 * h - 0.5;
        let (a, b) = (from.max(left), to.min(left + h));
        let (length, share) = (b - a, (0.5 * (a + b) - left) / h);
        row[k] += value * length * (1.0 - share);
        row[k + 1] += value * length * share;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrete::load::integral;

    #[test]
    fn the_load_sums_to_the_integral_and_to_its_first_moments() {
        let f = "rect(-0.31,0.22,-0.4,0.123)=3; halfplane(1,0.3,-0.2)=-2; else=-1".parse().unwrap();
        let grid = Grid::new(16).unwrap();
        let load = load(grid, &Jumps::of(&f));
        assert!((load.iter().sum::<f64>() - integral(&f)).abs() < 1e-14);
        let f = "rect(-0.31,0.22,-0.4,0.123)=3; else=0".parse().unwrap();
        let load = super::load(grid, &Jumps::of(&f));
        let moment: f64 = load.iter().enumerate().map(|(k, f)| f * grid.coordinate(k % 17)).sum();
        assert!((moment - 1.5 * (0.22 * 0.22 - 0.31 * 0.31) * 0.523).abs() < 1e-14);
    }
}
