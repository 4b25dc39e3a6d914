//! Load vectors (6): F_i, the integral of f times the i-th hat function, by one of several rules.

use crate::discrete::grid::{Grid, MIN_CELLS};
use crate::problem::source::{Source, Tie};
use serde::{Deserialize, Serialize};

/// Quadrature of the load vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "rule", deny_unknown_fields)]
pub enum LoadRule {
    /// `F_i = f(M_i)` times the integral of the i-th hat function; a tie rule decides on jumps.
    ///
    /// The integral is `h^2` inside, `h^2 / 2` on edges, and at a corner `h^2 / 6` for each triangle
    /// there. Without a diagonal it is replaced by the trapezoidal weight `h^2 / 4` at all corners.
    Nodal {
        /// Side from which f is taken at a node on a jump.
        #[serde(default)]
        tie: Tie,
        /// How the squares are cut into triangles.
        diagonal: Option<Diagonal>,
    },
    /// The integral itself: exact for constant pieces, degree 5 quadrature for smooth f.
    Exact {
        /// How the squares are cut into triangles.
        #[serde(default)]
        diagonal: Diagonal,
    },
    /// `w_i h^2` times the mean of f over the cell of width h around the node, inside the square.
    LumpedAverage,
}

/// The diagonal that cuts each square of the grid into two triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Diagonal {
    /// From lower left to upper right.
    #[default]
    Rising,
    /// From upper left to lower right.
    Falling,
}

impl Default for LoadRule {
    fn default() -> Self {
        Self::Nodal { tie: Tie::default(), diagonal: Some(Diagonal::default()) }
    }
}

/// The load vector of `f` on `grid`, a nodal vector.
pub fn load(grid: Grid, f: &Source, rule: LoadRule) -> Vec<f64> {
    match rule {
        LoadRule::Nodal { tie, diagonal } => lumped(grid, diagonal, |x, y| f.sample(x, y, tie)),
        LoadRule::LumpedAverage => {
            let q = 0.25 * grid.h();
            lumped(grid, None, |x, y| {
                let (mut sum, mut count) = (0.0, 0.0);
                for (px, py) in [(x - q, y - q), (x + q, y - q), (x - q, y + q), (x + q, y + q)] {
                    if px.abs() < 0.5 && py.abs() < 0.5 {
                        sum += f.at(px, py);
                        count += 1.0;
                    }
                }
                sum / count
            })
        }
        LoadRule::Exact { diagonal } => integrated(grid, f, diagonal),
    }
}

/// The integral of f over the square: exact for constant pieces, to quadrature error for smooth f.
pub fn integral(f: &Source) -> f64 {
    // Polygons are cut exactly whatever the grid; only smooth f needs a fine one.
    let cells = match f {
        Source::Pieces { .. } => MIN_CELLS,
        Source::Exact(_) => 64,
    };
    let grid = Grid::new(cells).expect("not below the least");
    integrated(grid, f, Diagonal::Rising).iter().sum()
}

fn lumped(grid: Grid, diagonal: Option<Diagonal>, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let (n, h) = (grid.cells(), grid.h());
    let on_border = |i: usize| i == 0 || i == n;
    let weight = |i: usize, j: usize| match (on_border(i), on_border(j)) {
        (false, false) => 1.0,
        (true, true) => match diagonal {
            None => 0.25,
            // A diagonal gives the corners it ends in two triangles, the others one.
            Some(cut) if (cut == Diagonal::Rising) == (i == j) => 1.0 / 3.0,
            Some(_) => 1.0 / 6.0,
        },
        _ => 0.5,
    };
    let mut load = Vec::with_capacity(grid.nodes());
    for j in 0..=n {
        for i in 0..=n {
            load.push(weight(i, j) * h * h * f(grid.coordinate(i), grid.coordinate(j)));
        }
    }
    load
}

type Point = [f64; 2];
type Triangle = [Point; 3];

fn integrated(grid: Grid, f: &Source, diagonal: Diagonal) -> Vec<f64> {
    let mut load = vec![0.0; grid.nodes()];
    // The last piece wins: it takes its share first, and leaves the rest.
    let layers: Vec<(Vec<[f64; 3]>, f64)> = match f {
        Source::Pieces { pieces, .. } => {
            pieces.iter().rev().map(|(region, value)| (region.half_planes(), *value)).collect()
        }
        Source::Exact(_) => Vec::new(),
    };
    for j in 0..grid.cells() {
        for i in 0..grid.cells() {
            let (ll, lr, ul, ur) = ((i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1));
            let triangles = match diagonal {
                Diagonal::Rising => [[ll, lr, ur], [ll, ur, ul]],
                Diagonal::Falling => [[ll, lr, ul], [lr, ur, ul]],
            };
            for nodes in triangles {
                let triangle = nodes.map(|(i, j)| [grid.coordinate(i), grid.coordinate(j)]);
                let parts = match f {
                    Source::Pieces { background, .. } => {
                        let mut parts = [0.0; 3];
                        let mut rest = vec![triangle.to_vec()];
                        for (planes, value) in &layers {
                            rest = rest
                                .into_iter()
                                .flat_map(|polygon| {
                                    let (inside, outside) = split(polygon, planes);
                                    add_hats(&triangle, &inside, *value, &mut parts);
                                    outside
                                })
                                .collect();
                        }
                        for polygon in &rest {
                            add_hats(&triangle, polygon, *background, &mut parts);
                        }
                        parts
                    }
                    Source::Exact(exact) => radon(&triangle, |x, y| exact.source(x, y)),
                };
                for ((i, j), part) in nodes.into_iter().zip(parts) {
                    load[grid.index(i, j)] += part;
                }
            }
        }
    }
    load
}

/// Splits a convex polygon into its part in all half-planes and the convex remainders.
fn split(mut polygon: Vec<Point>, planes: &[[f64; 3]]) -> (Vec<Point>, Vec<Vec<Point>>) {
    let mut outside = Vec::new();
    for &[a, b, c] in planes {
        let cut = clip(&polygon, [-a, -b, -c]);
        if area(&cut) > 0.0 {
            outside.push(cut);
            polygon = clip(&polygon, [a, b, c]);
        }
        if polygon.is_empty() {
            break;
        }
    }
    (polygon, outside)
}

/// Sutherland and Hodgman's clipping of a convex polygon by `a x + b y <= c`.
pub(crate) fn clip(polygon: &[Point], [a, b, c]: [f64; 3]) -> Vec<Point> {
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

fn area(polygon: &[Point]) -> f64 {
    let Some((&origin, rest)) = polygon.split_first() else {
        return 0.0;
    };
    rest.windows(2).map(|pair| triangle_area([origin, pair[0], pair[1]])).sum()
}

fn triangle_area([p, q, r]: Triangle) -> f64 {
    0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]))
}

/// Barycentric coordinates of `p`: the values there of the three hat functions.
fn hats(triangle: &Triangle, p: Point) -> [f64; 3] {
    let [a, b, c] = *triangle;
    let whole = triangle_area(*triangle);
    [[p, b, c], [a, p, c], [a, b, p]].map(|part| triangle_area(part) / whole)
}

/// Adds to `parts` the integrals of `value` times each hat over a convex polygon in the triangle.
fn add_hats(triangle: &Triangle, polygon: &[Point], value: f64, parts: &mut [f64; 3]) {
    let Some((&origin, rest)) = polygon.split_first() else {
        return;
    };
    for pair in rest.windows(2) {
        let fan = [origin, pair[0], pair[1]];
        // Hats are linear: their integral is the area times the value at the centroid.
        let centroid = [0, 1].map(|d| (fan[0][d] + fan[1][d] + fan[2][d]) / 3.0);
        let mass = value * triangle_area(fan);
        for (part, hat) in parts.iter_mut().zip(hats(triangle, centroid)) {
            *part += mass * hat;
        }
    }
}

/// Radon's seven-point rule, exact for degree 5 (Stroud, T2:5-1): integrals of f times each hat.
fn radon(triangle: &Triangle, f: impl Fn(f64, f64) -> f64) -> [f64; 3] {
    let root = 15f64.sqrt();
    let (near, far) = ((6.0 - root) / 21.0, (6.0 + root) / 21.0);
    let (w_near, w_far) = ((155.0 - root) / 1200.0, (155.0 + root) / 1200.0);
    let mut points = vec![([1.0 / 3.0; 3], 9.0 / 40.0)];
    for (s, w) in [(near, w_near), (far, w_far)] {
        let t = 1.0 - 2.0 * s;
        points.extend([([t, s, s], w), ([s, t, s], w), ([s, s, t], w)]);
    }
    let whole = triangle_area(*triangle);
    let mut parts = [0.0; 3];
    for (hat, weight) in points {
        let [x, y] = [0, 1].map(|d| (0..3).map(|k| hat[k] * triangle[k][d]).sum());
        let mass = whole * weight * f(x, y);
        for (part, hat) in parts.iter_mut().zip(hat) {
            *part += mass * hat;
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(load: &[f64]) -> f64 {
        load.iter().sum()
    }

    #[test]
    fn every_rule_integrates_a_constant_to_one_weight_per_node() {
        let grid = Grid::new(4).unwrap();
        let one = Source::constant(1.0);
        let tie = Tie::LowerLeft;
        let nodal = load(grid, &one, LoadRule::Nodal { tie, diagonal: None });
        assert_eq!((nodal[6], nodal[1], nodal[0]), (1.0 / 16.0, 0.5 / 16.0, 0.25 / 16.0));
        assert_eq!(load(grid, &one, LoadRule::LumpedAverage), nodal);
        // With a constant f, the nodal rule on triangles is the exact one.
        for diagonal in [Diagonal::Rising, Diagonal::Falling] {
            let nodal = load(grid, &one, LoadRule::Nodal { tie, diagonal: Some(diagonal) });
            let exact = load(grid, &one, LoadRule::Exact { diagonal });
            assert!(nodal.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-15));
        }
        let exact = load(grid, &one, LoadRule::Exact { diagonal: Diagonal::Rising });
        // A corner belongs to one or two triangles, depending on the diagonal.
        assert!((exact[0] - 2.0 / 6.0 / 16.0).abs() < 1e-16);
        assert!((exact[4] - 1.0 / 6.0 / 16.0).abs() < 1e-16);
        assert!((sum(&exact) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn exact_rule_integrates_cut_cells() {
        // The rectangle's borders cut the cells of every grid here.
        let f: Source = "rect(-0.3,0.21,-0.11,0.4)=3; else=-2".parse().unwrap();
        let want = 3.0 * 0.51 * 0.51 - 2.0 * (1.0 - 0.51 * 0.51);
        for diagonal in [Diagonal::Rising, Diagonal::Falling] {
            for n in [2, 4, 16] {
                let ours = load(Grid::new(n).unwrap(), &f, LoadRule::Exact { diagonal });
                assert!((sum(&ours) - want).abs() < 1e-13);
            }
        }
        assert!((integral(&f) - want).abs() < 1e-13);
    }

    #[test]
    fn exact_rule_gives_first_moments_exactly() {
        // The hats sum with weights x_i to x, so the moment of f must come out whatever the cuts.
        let f: Source = "halfplane(1,2,0.1)=1; else=0".parse().unwrap();
        let moment = |n: usize| -> f64 {
            let grid = Grid::new(n).unwrap();
            let load = load(grid, &f, LoadRule::Exact { diagonal: Diagonal::Falling });
            (0..grid.nodes()).map(|k| load[k] * grid.coordinate(k % grid.side())).sum()
        };
        // Integral of x over x + 2 y <= 0.1 in the square: -1/24.
        assert!((moment(3) + 1.0 / 24.0).abs() < 1e-14);
        assert!((moment(16) + 1.0 / 24.0).abs() < 1e-14);
    }

    #[test]
    fn disc_has_its_area() {
        let f: Source = "disc(0.05,-0.1,0.3)=1; else=0".parse().unwrap();
        assert!((integral(&f) - std::f64::consts::PI * 0.09).abs() < 1e-13);
    }

    #[test]
    fn smooth_sources_are_integrated_to_high_order() {
        let f: Source = "exact(full-contact)".parse().unwrap();
        // The integral of -2 pi^2 cos cos is -8.
        assert!((integral(&f) + 8.0).abs() < 1e-9);
        let nodal = load(Grid::new(64).unwrap(), &f, LoadRule::default());
        assert!((sum(&nodal) + 8.0).abs() < 1e-2);
    }

    #[test]
    fn averages_on_a_jump_lie_between() {
        let f: Source = "halfplane(1,0,0)=4; else=0".parse().unwrap();
        let grid = Grid::new(4).unwrap();
        let h2 = grid.h() * grid.h();
        assert_eq!(load(grid, &f, LoadRule::LumpedAverage)[grid.index(2, 2)], 2.0 * h2);
        let tied = |tie| load(grid, &f, LoadRule::Nodal { tie, diagonal: None })[grid.index(2, 2)];
        assert_eq!(tied(Tie::LowerLeft), 4.0 * h2);
        assert_eq!(tied(Tie::UpperRight), 0.0);
    }
}
