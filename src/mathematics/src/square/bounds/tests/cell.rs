//! Sums over one cell against integrals of functions that are written down here from their definitions.

use super::noise;
use crate::square::bounds::cells::SpecialCell;
use crate::square::bounds::flux::EdgeFluxes;
use crate::square::bounds::moments::CellMoments;
use std::array::from_fn;
use std::f64::consts::PI;

/// Gauss's rule with four points on (-1/2, 1/2), exact to degree 7: points with weights.
fn gauss() -> [[f64; 2]; 4] {
    let root = 2.0 / 7.0 * 1.2f64.sqrt();
    let [near, far] = [-root, root].map(|root| 0.5 * (3.0 / 7.0 + root).sqrt());
    let [large, small] = [30f64.sqrt(), -(30f64.sqrt())].map(|root| (18.0 + root) / 72.0);
    [[-far, small], [-near, large], [near, large], [far, small]]
}

/// Points and weights of a rule on the cell.
fn rule() -> Vec<([f64; 2], f64)> {
    let [rows, columns] = [gauss(); 2];
    rows.iter().flat_map(|[y, v]| columns.map(|[x, w]| ([x, *y], v * w))).collect()
}

/// Integral of a function over the unit cell.
fn integral(of: impl Fn([f64; 2]) -> f64) -> f64 {
    rule().into_iter().map(|(at, weight)| weight * of(at)).sum()
}

/// Polynomial of degree 2 as f times `h^2`: coefficients of 1, x, y, x^2, x y and y^2.
fn value(f: [f64; 6], [x, y]: [f64; 2]) -> f64 {
    f[0] + f[1] * x + f[2] * y + f[3] * x * x + f[4] * x * y + f[5] * y * y
}

/// Points and weights of a rule on the two triangles of the cell that the rising diagonal cuts.
fn rule_on_triangles() -> Vec<([f64; 2], f64)> {
    let mut points = Vec::new();
    for ([s, t], weight) in rule() {
        let (s, t) = (s + 0.5, t + 0.5);
        let (far, near) = (s - 0.5, s * t - 0.5);
        points.extend([([far, near], weight * s), ([near, far], weight * s)]);
    }
    points
}

fn moments(f: [f64; 6]) -> CellMoments {
    let mut moments = CellMoments::default();
    for ([x, y], weight) in rule_on_triangles() {
        let value = value(f, [x, y]);
        moments.add([x, y], weight * value, value);
    }
    moments
}

/// Value and gradient, in units of differences, of the recovery: bilinear less bubbles, blended over the cell.
fn recovery(cell: &SpecialCell, [x, y]: [f64; 2]) -> (f64, [f64; 2]) {
    let [ll, lr, ul, ur] = cell.corners();
    let [[bottom, top], [left, right]] = cell.bubbles;
    let (west, east, south, north) = (0.5 - x, 0.5 + x, 0.5 - y, 0.5 + y);
    let bilinear = south * (west * ll + east * lr) + north * (west * ul + east * ur);
    let along_x = south * bottom + north * top;
    let along_y = west * left + east * right;
    let slope_x = south * (lr - ll) + north * (ur - ul);
    let slope_y = west * (ul - ll) + east * (ur - lr);
    let gradient = [
        slope_x - (west - east) * along_x - south * north * (right - left),
        slope_y - (south - north) * along_y - west * east * (top - bottom),
    ];
    (bilinear - west * east * along_x - south * north * along_y, gradient)
}

/// Value and derivative of the spline of degree 2 with the differences on a line as coefficients.
fn spline([a, b, c, d]: [f64; 4], x: f64) -> [f64; 2] {
    let (before, here, after) = (b - a, c - b, d - c);
    let value = 0.5 * (0.5 - x) * (0.5 - x) * before
        + (0.75 - x * x) * here
        + 0.5 * (0.5 + x) * (0.5 + x) * after;
    [value, (x - 0.5) * before - 2.0 * x * here + (x + 0.5) * after]
}

/// Flux without the field inside the cell, in units of differences, and its divergence times `h^2`.
fn spline_flux(cell: &SpecialCell, [x, y]: [f64; 2]) -> ([f64; 2], f64) {
    let EdgeFluxes { left, right, bottom, top } = cell.flux;
    let [rows, columns] = cell.lines;
    let [[south, south_slope], [north, north_slope]] = rows.map(|line| spline(line, x));
    let [[west, west_slope], [east, east_slope]] = columns.map(|line| spline(line, y));
    let flux = [
        (0.5 - y) * south + (0.5 + y) * north + (0.5 - x) * left + (0.5 + x) * right,
        (0.5 - x) * west + (0.5 + x) * east + (0.5 - y) * bottom + (0.5 + y) * top,
    ];
    let divergence = (0.5 - y) * south_slope
        + (0.5 + y) * north_slope
        + (0.5 - x) * west_slope
        + (0.5 + x) * east_slope
        + (right - left)
        + (top - bottom);
    (flux, divergence)
}

/// Bilinear function that is nearest to f.
fn bilinear(f: [f64; 6], [x, y]: [f64; 2]) -> f64 {
    // The mean of x^2 is 1/12.
    f[0] + (f[3] + f[5]) / 12.0 + f[1] * x + f[2] * y + f[4] * x * y
}

/// Flux whose divergence is that of the bilinear f but for a constant: with a field whose normal flux is zero.
fn flux(cell: &SpecialCell, f: [f64; 6], at: [f64; 2]) -> [f64; 2] {
    let [ll, lr, ul, ur] = [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]]
        .map(|at| bilinear(f, at) + spline_flux(cell, at).1);
    let twist = (ll + ur) - (lr + ul);
    let slopes = [0.5 * ((lr + ur) - (ll + ul)), 0.5 * ((ul + ur) - (ll + lr))];
    let (mut flux, _) = spline_flux(cell, at);
    for d in 0..2 {
        flux[d] += (slopes[d] + 0.5 * twist * at[1 - d]) * (0.125 - 0.5 * at[d] * at[d]);
    }
    flux
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-12 * expected.abs().max(1.0)
}

fn square([x, y]: [f64; 2]) -> f64 {
    x * x + y * y
}

#[test]
fn a_cell_has_the_integrals_of_its_functions() {
    for k in 0..20 {
        let numbers: [f64; 40] = from_fn(|place| noise(100 * k + place, 1.0));
        let f: [f64; 6] = from_fn(|place| numbers[place] * if k < 10 { 1.0 } else { 0.01 });
        let corners: [f64; 4] = from_fn(|place| numbers[6 + place]);
        let line = |from: usize, to: usize, at: usize| {
            [numbers[at], corners[from], corners[to], numbers[at + 1]]
        };
        let [left, right, bottom, top] = from_fn(|edge| numbers[20 + edge]);
        let cell = SpecialCell {
            lines: [[line(0, 1, 10), line(2, 3, 12)], [line(0, 2, 14), line(1, 3, 16)]],
            bubbles: from_fn(|a| from_fn(|b| numbers[30 + 2 * a + b])),
            flux: EdgeFluxes { left, right, bottom, top },
            f: moments(f),
        };
        let sums = cell.sums();
        let energy = integral(|at| square(recovery(&cell, at).1));
        assert!(close(sums.recovered, energy), "{} {energy}", sums.recovered);
        let load = integral(|at| value(f, at) * recovery(&cell, at).0);
        assert!(close(sums.recovered_load, load), "{} {load}", sums.recovered_load);
        let distance = integral(|at| {
            let (gradient, sigma) = (recovery(&cell, at).1, flux(&cell, f, at));
            square([gradient[0] - sigma[0], gradient[1] - sigma[1]])
        });
        let far = integral(|at| (value(f, at) - bilinear(f, at)).powi(2));
        let distance = (distance.sqrt() + far.sqrt() / (2.0 * PI)).powi(2);
        assert!(close(sums.distance, distance), "{} {distance}", sums.distance);
        // The function that is linear on both triangles.
        let [ll, lr, ul, ur] = corners;
        let linear = 0.5 * (square([lr - ll, ur - lr]) + square([ur - ul, ul - ll]));
        assert!(close(sums.linear, linear), "{} {linear}", sums.linear);
        let load: f64 = rule_on_triangles()
            .into_iter()
            .map(|([x, y], weight)| {
                let v = if x > y {
                    ll + (x + 0.5) * (lr - ll) + (y + 0.5) * (ur - lr)
                } else {
                    ll + (x + 0.5) * (ur - ul) + (y + 0.5) * (ul - ll)
                };
                weight * value(f, [x, y]) * v
            })
            .sum();
        assert!(close(sums.linear_load, load), "{} {load}", sums.linear_load);
        for (axis, edge) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let mut without = cell;
            without.bubbles[axis][edge] = 0.0;
            let energies =
                [without.sums(), sums].map(|sums| 0.5 * sums.recovered - sums.recovered_load);
            let gain = cell.boundary_bubble_gain(axis, edge);
            assert!(close(gain, energies[0] - energies[1]), "{axis} {edge} {gain} {energies:?}");
        }
    }
}
