//! Piecewise constant f on the cells of the grid: which ones its borders cut, and the moments there.

use super::data::{Moments, quadrature};
use crate::discrete::grid::Grid;
use crate::problem::source::Region;
use std::ops::Range;

type Point = [f64; 2];

/// Writes f on the cells of row `j` to `values`; for a cell that a border crosses `cut` gets the moments, from
/// left to right.
pub(super) fn row(
    grid: Grid,
    (background, pieces): (f64, &[(Region, f64)]),
    j: usize,
    values: &mut [f64],
    mut cut: impl FnMut(usize, Moments),
) {
    let n = grid.cells();
    let strip = [grid.coordinate(j), grid.coordinate(j + 1)];
    let mut crossed = Vec::new();
    for (region, _) in pieces {
        crossings(region, strip, |interval| crossed.push(cells_in(grid, interval)));
    }
    // Between these f is constant, or crossed by a border.
    let mut breaks: Vec<usize> =
        crossed.iter().flat_map(|cells| [cells.start, cells.end]).collect();
    breaks.extend([0, n]);
    breaks.sort_unstable();
    for pair in breaks.windows(2) {
        let cells = pair[0]..pair[1];
        if cells.is_empty() {
            continue;
        }
        if crossed.iter().any(|crossed| crossed.contains(&cells.start)) {
            cells.for_each(|i| cut(i, moments(grid, (background, pieces), i, j)));
        } else {
            let [x, y] =
                [cells.start, j].map(|k| 0.5 * (grid.coordinate(k) + grid.coordinate(k + 1)));
            let piece = pieces.iter().rev().find(|(region, _)| region.contains(x, y));
            values[cells].fill(piece.map_or(background, |&(_, value)| value));
        }
    }
}

/// The cells that an interval of the x axis meets in their inside; an empty range at a grid line.
fn cells_in(grid: Grid, [low, high]: [f64; 2]) -> Range<usize> {
    let n = grid.cells();
    let line = |x: f64| (((x + 0.5) * n as f64).floor().max(0.0) as usize).min(n);
    let mut start = line(low).saturating_sub(1);
    while start < n && grid.coordinate(start + 1) <= low {
        start += 1;
    }
    let mut end = line(high).saturating_sub(1).max(start);
    while end < n && grid.coordinate(end) < high {
        end += 1;
    }
    start..end
}

/// The x intervals over which the border of a region runs within a strip `y0 < y < y1`.
fn crossings(region: &Region, [y0, y1]: [f64; 2], mut found: impl FnMut([f64; 2])) {
    const EVERYWHERE: [f64; 2] = [-1.0, 1.0];
    let mut sides = |x: [f64; 2], y: [f64; 2]| {
        if y[0] < y1 && y[1] > y0 {
            found([x[0], x[0]]);
            found([x[1], x[1]]);
        }
        for y in y {
            if y0 < y && y < y1 {
                found(x);
            }
        }
    };
    match *region {
        Region::Rect { x, y } => sides(x, y),
        Region::Quadrant { right, upper } => {
            let half = |plus: bool| if plus { [0.0, 1.0] } else { [-1.0, 0.0] };
            sides(half(right), half(upper));
        }
        Region::HalfPlane { a, b, c } => {
            let [p, q] = [y0, y1].map(|y| (c - b * y) / a);
            if p.is_finite() && q.is_finite() {
                // Rounding may have moved the ends by a little.
                let slack = 1e-14 * (1.0 + p.abs() + q.abs()) * f64::from(u8::from(b != 0.0));
                found([p.min(q) - slack, p.max(q) + slack]);
            } else if y0 < c / b && c / b < y1 {
                found(EVERYWHERE);
            }
        }
        Region::Disc { centre: [cx, cy], radius } => {
            let (to_low, to_high) = ((y0 - cy).abs(), (y1 - cy).abs());
            let nearest = if y0 <= cy && cy <= y1 { 0.0 } else { to_low.min(to_high) };
            let half = |away: f64| (radius * radius - away * away).max(0.0).sqrt();
            if nearest < radius {
                let (inner, outer) = (half(to_low.max(to_high)), half(nearest));
                // The polygon that stands for a disc stays this near to it.
                let slack = 2e-5 * radius;
                let inner = (inner * inner - 2.0 * radius * slack).max(0.0).sqrt();
                found([cx - outer - slack, cx - inner + slack]);
                found([cx + inner - slack, cx + outer + slack]);
            }
        }
    }
}

/// Moments over cell (i, j), cut into convex polygons.
fn moments(
    grid: Grid,
    (background, pieces): (f64, &[(Region, f64)]),
    i: usize,
    j: usize,
) -> Moments {
    let h = grid.h();
    let centre = [i, j].map(|k| 0.5 * (grid.coordinate(k) + grid.coordinate(k + 1)));
    let mut sum = Moments::default();
    let mut integrate = |polygon: &[Point], value: f64| {
        for k in 2..polygon.len() {
            for (point, weight) in quadrature([polygon[0], polygon[k - 1], polygon[k]]) {
                sum.add(point, weight * value * h * h, value * h * h);
            }
        }
    };
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    for triangle in [[0, 1, 2], [0, 2, 3]] {
        let mut rest = vec![triangle.map(|k| corners[k]).to_vec()];
        for (region, value) in pieces.iter().rev() {
            let mut outside = Vec::new();
            for mut polygon in rest {
                for [a, b, c] in region.half_planes() {
                    // In the coordinates of the cell.
                    let c = (c - a * centre[0] - b * centre[1]) / h;
                    let cut = clip(&polygon, [-a, -b, -c]);
                    if cut.len() > 2 {
                        outside.push(cut);
                        polygon = clip(&polygon, [a, b, c]);
                    }
                    if polygon.len() < 3 {
                        break;
                    }
                }
                integrate(&polygon, *value);
            }
            rest = outside;
        }
        rest.iter().for_each(|polygon| integrate(polygon, background));
    }
    sum
}

/// The part of a convex polygon where `a x + b y <= c` (Sutherland and Hodgman).
fn clip(polygon: &[Point], [a, b, c]: [f64; 3]) -> Vec<Point> {
    let excess = |p: Point| a * p[0] + b * p[1] - c;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let (ep, eq) = (excess(p), excess(q));
        if ep <= 0.0 {
            kept.push(p);
        }
        if (ep < 0.0 && eq > 0.0) || (ep > 0.0 && eq < 0.0) {
            let t = ep / (ep - eq);
            kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
    }
    kept
}
