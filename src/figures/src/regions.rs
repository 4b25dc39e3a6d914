//! Regions of a map, and the widest place in each for a label.

use super::picture::Place;
use signorini_mathematics::problem::source::Source;
use std::collections::BTreeMap;

/// Cells per side of the raster for the places of labels and for pictures of a smooth f.
pub(super) const RASTER: usize = 72;

/// Returns the coordinate of the centre of cell `i`, which may be a fraction.
fn centre(i: f64) -> f64 {
    (i + 0.5) / RASTER as f64 - 0.5
}

/// Returns f at the centres of the raster, row by row from below.
pub(super) fn raster(f: &Source) -> Vec<f64> {
    (0..RASTER * RASTER).map(|k| f.at([k % RASTER, k / RASTER].map(|i| centre(i as f64)))).collect()
}

/// Returns the connected sets of raster cells with equal values, each in ascending order.
///
/// Each cell takes the least number of its neighbours with its value, until none changes.
pub(super) fn regions(values: &[f64]) -> Vec<Vec<usize>> {
    let mut least: Vec<usize> = (0..values.len()).collect();
    let mut is_changed = true;
    while is_changed {
        is_changed = false;
        for k in (0..values.len()).chain((0..values.len()).rev()) {
            for n in neighbours(k).into_iter().flatten().filter(|&n| values[n] == values[k]) {
                is_changed |= least[n] < least[k];
                least[k] = least[k].min(least[n]);
            }
        }
    }
    let mut regions: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, least) in least.into_iter().enumerate() {
        regions.entry(least).or_default().push(k);
    }
    regions.into_values().collect()
}

/// Returns the neighbours of raster cell `k` to the west, east, south and north.
fn neighbours(k: usize) -> [Option<usize>; 4] {
    let (i, j) = (k % RASTER, k / RASTER);
    [
        (i > 0).then(|| k - 1),
        (i + 1 < RASTER).then(|| k + 1),
        (j > 0).then(|| k - RASTER),
        (j + 1 < RASTER).then(|| k + RASTER),
    ]
}

/// Column and row of a raster cell.
type RasterCell = (i64, i64);

fn cell(k: usize) -> RasterCell {
    ((k % RASTER) as i64, (k / RASTER) as i64)
}

/// Returns the square of the distance of two cells.
fn squared_distance((i, j): RasterCell, (p, q): RasterCell) -> i64 {
    (i - p) * (i - p) + (j - q) * (j - q)
}

/// True if a neighbour of raster cell `k` has another value or is missing.
fn is_at_edge(k: usize, values: &[f64]) -> bool {
    neighbours(k).iter().any(|n| n.is_none_or(|n| values[n] != values[k]))
}

/// Disc in the square.
pub(super) struct Disc {
    pub(super) centre: Place,
    pub(super) radius: f64,
}

/// Returns the largest disc of cells inside `region`.
///
/// 1. Find the cells at the edge of the region.
/// 2. Find the cells whose distance to the edge is greatest: the candidates for the centre.
/// 3. Take the candidate nearest to their mean, as in a strip; take the mean itself if it is within a cell of that
///    candidate, as in a square with an even number of cells.
///
/// Distances are compared as squares of whole numbers of cells, because a label is in the exact middle only if equal
/// distances compare equal.
pub(super) fn widest(region: &[usize], values: &[f64]) -> Disc {
    let edge: Vec<RasterCell> =
        region.iter().filter(|&&k| is_at_edge(k, values)).map(|&k| cell(k)).collect();
    let distances = region.iter().map(|&k| {
        let to_edge = edge.iter().map(|&other| squared_distance(cell(k), other));
        to_edge.min().unwrap_or(0)
    });
    let distances: Vec<i64> = distances.collect();
    let greatest = distances.iter().copied().max().unwrap_or(0);
    let candidates = region.iter().zip(&distances).filter(|(_, distance)| **distance == greatest);
    let candidates: Vec<RasterCell> = candidates.map(|(&k, _)| cell(k)).collect();
    let count = candidates.len() as i64;
    let sum = candidates.iter().fold((0, 0), |sum: RasterCell, (i, j)| (sum.0 + i, sum.1 + j));
    let to_mean =
        candidates.iter().map(|&(i, j)| (squared_distance((i * count, j * count), sum), (i, j)));
    let (distance, (i, j)) = to_mean.min_by_key(|(distance, _)| *distance).unwrap_or_default();
    let at = if distance <= count * count {
        (sum.0 as f64 / count as f64, sum.1 as f64 / count as f64)
    } else {
        (i as f64, j as f64)
    };
    let radius = ((greatest as f64).sqrt() + 0.5) / RASTER as f64;
    Disc { centre: (centre(at.0), centre(at.1)), radius }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_sit_inside_their_regions() {
        let f: Source = "quadrant(ll)=3; else=-1".parse().unwrap();
        let values = raster(&f);
        let regions = regions(&values);
        assert_eq!(regions.len(), 2);
        let Disc { centre: ll, radius } = widest(&regions[0], &values);
        assert!((ll.0 + 0.25).abs() < 1e-12 && (ll.1 + 0.25).abs() < 1e-12);
        assert!((radius - 0.25).abs() < 0.02);
        let Disc { centre: rest, radius } = widest(&regions[1], &values);
        assert!(f.at([rest.0, rest.1]) == -1.0 && radius > 0.25);
    }
}
