//! Where the regions of a map are, and where in each a label has most room.

use super::picture::Place;
use crate::problem::source::Source;

/// Cells per side of the raster that finds where labels go, and that stands for a smooth f.
pub(super) const RASTER: usize = 72;

/// The coordinate of the centre of the i-th cell, which may be a fraction.
fn centre(i: f64) -> f64 {
    (i + 0.5) / RASTER as f64 - 0.5
}

/// f at the centres of the raster, row by row from below.
pub(super) fn raster(f: &Source) -> Vec<f64> {
    let point = |k: usize| [k % RASTER, k / RASTER].map(|i| centre(i as f64));
    (0..RASTER * RASTER).map(|k| f.at(point(k))).collect()
}

/// The connected sets of raster cells with equal values, each in ascending order.
pub(super) fn regions(values: &[f64]) -> Vec<Vec<usize>> {
    let mut seen = vec![false; values.len()];
    let mut regions = Vec::new();
    for start in 0..values.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut region = vec![start];
        let mut next = 0;
        while next < region.len() {
            let k = region[next];
            next += 1;
            for neighbour in neighbours(k).into_iter().flatten() {
                if !seen[neighbour] && values[neighbour] == values[k] {
                    seen[neighbour] = true;
                    region.push(neighbour);
                }
            }
        }
        region.sort_unstable();
        regions.push(region);
    }
    regions
}

/// West, east, south and north of raster cell `k`.
fn neighbours(k: usize) -> [Option<usize>; 4] {
    let (i, j) = (k % RASTER, k / RASTER);
    [
        (i > 0).then(|| k - 1),
        (i + 1 < RASTER).then(|| k + 1),
        (j > 0).then(|| k - RASTER),
        (j + 1 < RASTER).then(|| k + RASTER),
    ]
}

/// Centre and radius of the largest disc of cells inside `region`.
pub(super) fn widest(region: &[usize], values: &[f64]) -> (Place, f64) {
    // In whole cells: equal distances must compare equal for a label to sit in the very middle.
    let cell = |k: usize| ((k % RASTER) as i64, (k / RASTER) as i64);
    let squared = |(i, j): (i64, i64), (p, q): (i64, i64)| (i - p) * (i - p) + (j - q) * (j - q);
    let on_rim = |k: usize| neighbours(k).iter().any(|n| n.is_none_or(|n| values[n] != values[k]));
    let rim: Vec<_> = region.iter().filter(|&&k| on_rim(k)).map(|&k| cell(k)).collect();
    let to_rim = |at| rim.iter().map(|&p| squared(at, p)).min().unwrap_or(0);
    let inside: Vec<_> = region.iter().map(|&k| (cell(k), to_rim(cell(k)))).collect();
    let most = inside.iter().map(|(_, distance)| *distance).max().unwrap_or(0);
    let best: Vec<_> =
        inside.iter().filter(|(_, distance)| *distance == most).map(|(at, _)| *at).collect();
    let count = best.len() as i64;
    let (si, sj) = best.iter().fold((0, 0), |(si, sj), (i, j)| (si + i, sj + j));
    // Of several centres, as in a strip, the one nearest to their mean; the mean itself if it is
    // within a cell of one, as in a square with an even number of cells.
    let off = |&(i, j): &(i64, i64)| squared((i * count, j * count), (si, sj));
    let (i, j) = best.iter().copied().min_by_key(off).unwrap_or((0, 0));
    let at = if off(&(i, j)) <= count * count {
        (si as f64 / count as f64, sj as f64 / count as f64)
    } else {
        (i as f64, j as f64)
    };
    let radius = ((most as f64).sqrt() + 0.5) / RASTER as f64;
    ((centre(at.0), centre(at.1)), radius)
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
        let (ll, radius) = widest(&regions[0], &values);
        assert!((ll.0 + 0.25).abs() < 1e-12 && (ll.1 + 0.25).abs() < 1e-12);
        assert!((radius - 0.25).abs() < 0.02);
        let (rest, radius) = widest(&regions[1], &values);
        assert!(f.at([rest.0, rest.1]) == -1.0 && radius > 0.25);
    }
}
