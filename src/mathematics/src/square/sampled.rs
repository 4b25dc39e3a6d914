//! Integrals over the square of an f that is known by its values only.

use crate::discrete::adaptive::{
    BadValue, COST, CellValues, LEAST_PARTS, SETTLED, SampledCell, Sampler, Settling,
};
use crate::machine::threads::{items_per_task, map, map_range};
use crate::problem::error::SourceError;

/// Integrals of f over the square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SampledIntegrals {
    /// Of f.
    pub integral: f64,
    /// Of |f|.
    pub size: f64,
    /// Sum over all parts of the differences of two formulas.
    pub unsettled: f64,
    /// Sum over all cells of the errors of the formula of degree 5 on the whole cell.
    pub missed: f64,
}

/// Parts of cells at most over the whole domain, besides the least ones.
const MOST_PARTS: usize = 1 << 16;

/// Integrates f over cells of equal volume that make up the square.
///
/// # Errors
/// [`SourceError::NoValue`] with a point where f is not finite.
pub(super) fn sampled<const D: usize, const V: usize>(
    cells: &[[[f64; D]; V]],
    f: &(impl Fn([f64; D]) -> f64 + Sync),
) -> Result<SampledIntegrals, SourceError> {
    let (sampler, count) = (Sampler::default(), cells.len() as f64);
    let integrate = |vertices: [[f64; D]; V], settling: Settling| {
        sampler.integrate(&CellValues { vertices, f, shared: None }, settling)
    };
    let whole = Settling { least_parts: 1, most_parts: 0, tolerance: f64::INFINITY };
    let least_parts = LEAST_PARTS.div_ceil(cells.len()).next_power_of_two();
    let settling = Settling { least_parts, ..whole };
    let each = items_per_task(cells.len(), COST);
    let first = map(cells, each, |&vertices| {
        let coarse = integrate(vertices, whole)?;
        let fine = if least_parts == 1 { coarse } else { integrate(vertices, settling)? };
        Ok::<_, BadValue<D>>((coarse.mean, fine))
    });
    let first: Vec<(f64, SampledCell<V>)> = first.into_iter().collect::<Result<_, _>>()?;
    // The cells are alike, so that the means and differences over all of them have one tolerance.
    let size = first.iter().map(|(_, cell)| cell.size / count).sum::<f64>();
    let power = libm::pow(1.0 / count, (D as f64 - 1.0) / D as f64);
    let tolerance = SETTLED * size * power * count;
    let open = first.iter().filter(|(_, cell)| cell.worst > tolerance).count();
    let most_parts = least_parts + MOST_PARTS.div_ceil(open.max(1));
    let finer = Settling { least_parts, most_parts, tolerance };
    let settled = map_range(0..cells.len(), each, |k| {
        let (_, cell) = first[k];
        if cell.worst > tolerance { integrate(cells[k], finer) } else { Ok(cell) }
    });
    let mut sums = SampledIntegrals { integral: 0.0, size: 0.0, unsettled: 0.0, missed: 0.0 };
    for (cell, (coarse, _)) in settled.into_iter().zip(&first) {
        let cell = cell?;
        sums.integral += cell.mean / count;
        sums.size += cell.size / count;
        sums.unsettled += cell.difference / count;
        sums.missed += (cell.mean - coarse).abs() / count;
    }
    Ok(sums)
}

/// Triangles of the grid with n cells along each side of the square, cut by rising diagonals.
pub(super) fn triangles(n: usize) -> Vec<[[f64; 2]; 3]> {
    let at = |i: usize, j: usize| [i, j].map(|i| i as f64 / n as f64 - 0.5);
    let mut triangles = Vec::with_capacity(2 * n * n);
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let [ll, ur] = [at(i, j), at(i + 1, j + 1)];
        triangles.extend([[ll, at(i + 1, j), ur], [ll, ur, at(i, j + 1)]]);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_between_the_points_of_a_grid_are_found() {
        let pi = std::f64::consts::PI;
        for (x0, y0) in [(0.0003, 0.0004), (0.271, -0.333), (0.1234, 0.4321)] {
            let peak = |[x, y]: [f64; 2]| {
                -1.0 + 1e7 * libm::exp(-4e6 * ((x - x0) * (x - x0) + (y - y0) * (y - y0)))
            };
            let found = sampled(&triangles(1), &peak).unwrap();
            assert!((found.integral - (2.5 * pi - 1.0)).abs() < 1e-4, "{found:?}");
            let on_grid = sampled(&triangles(64), &peak).unwrap();
            assert!((on_grid.integral - found.integral).abs() < 1e-4, "{on_grid:?}");
            assert!(on_grid.missed > 0.1 * on_grid.size, "{on_grid:?}");
            assert!(found.unsettled < 1e-4 * found.size, "{found:?}");
        }
        let smooth =
            sampled(&triangles(8), &|[x, y]: [f64; 2]| libm::cos(pi * x) * y - 1.0).unwrap();
        assert!(smooth.missed < 1e-5 && smooth.unsettled < 1e-5, "{smooth:?}");
        assert!((smooth.integral + 1.0).abs() < 1e-12, "{smooth:?}");
    }
}
