//! Exact integrals of piecewise constant f: closed forms, adaptive quadrature, threads, and what must be refused.

use crate::common::Dice;
use crate::solvers::on_threads;
use signorini_mathematics::discrete::cells::Cells;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::{Diagonal, LoadRule};
use signorini_mathematics::mesh::{mesh_load, uniform_cube};
use signorini_mathematics::problem::shape::{QUADRANTS, Shape};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::square::load::{integral, load};
use std::collections::BTreeMap;
use std::f64::consts::PI;

type Pieces = [(Shape<2>, f64)];

/// Shapes at random.
struct Random(Dice);

impl Random {
    /// A number from -1/2 to 1/2.
    fn next(&mut self) -> f64 {
        self.0.unit() - 0.5
    }

    fn interval(&mut self) -> [f64; 2] {
        let (a, b) = (self.next(), self.next());
        [a.min(b), a.max(b)]
    }

    fn region(&mut self) -> Shape<2> {
        match (4.0 * self.next() + 2.0) as usize {
            0 => Shape::Box([self.interval(), self.interval()]),
            1 => Shape::HalfSpace { normal: [self.next(), self.next()], d: 0.5 * self.next() },
            2 => Shape::Box(QUADRANTS[(4.0 * self.next() + 2.0) as usize].1),
            _ => Shape::Ball {
                centre: [1.2 * self.next(), 1.2 * self.next()],
                radius: 0.31 + 0.6 * self.next(),
            },
        }
    }
}

/// The heights at which the border of a piece crosses a vertical line, and a mark that tells one border
/// from another; heights far outside stand for borders that are not there.
fn heights(pieces: &Pieces, x: f64) -> Vec<(f64, usize)> {
    let mut found = Vec::new();
    for (k, (region, _)) in pieces.iter().enumerate() {
        let there = |yes: bool| if yes { -9.0 } else { 9.0 };
        match *region {
            Shape::Box([[left, right], y]) => {
                let within = there(left < x && x < right);
                found.extend([(y[0], 4 * k), (y[1], 4 * k + 1), (within, 4 * k + 2)]);
            }
            Shape::HalfSpace { normal: [a, b], d: c } => found.push(((c - a * x) / b, 4 * k)),
            Shape::Ball { centre, radius } => {
                let half = (radius * radius - (x - centre[0]).powi(2)).sqrt();
                if half > 0.0 {
                    found.extend([(centre[1] - half, 4 * k), (centre[1] + half, 4 * k + 1)]);
                }
            }
        }
    }
    found
}

/// The nine moments of f by quadrature between two heights, each linear in x.
struct Quadrature<'a> {
    background: f64,
    pieces: &'a Pieces,
    floor: fn(f64) -> f64,
    ceiling: fn(f64) -> f64,
}

impl Quadrature<'_> {
    /// All borders from below, with those of the region, as they are passed at x.
    fn order(&self, x: f64) -> Vec<usize> {
        let mut found = heights(self.pieces, x);
        found.extend([((self.floor)(x), 998), ((self.ceiling)(x), 999)]);
        found.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        found.into_iter().map(|(_, mark)| mark).collect()
    }

    /// Integrals along the vertical line at x.
    fn line(&self, x: f64) -> [f64; 9] {
        let [floor, ceiling] = [(self.floor)(x), (self.ceiling)(x)];
        let mut ends: Vec<_> = heights(self.pieces, x).into_iter().map(|(y, _)| y).collect();
        ends.retain(|&y| floor < y && y < ceiling);
        ends.extend([floor, ceiling]);
        ends.sort_by(f64::total_cmp);
        let mut sums = [0.0; 9];
        for pair in ends.windows(2) {
            let (p, q) = (pair[0], pair[1]);
            let inside = |(region, _): &&(Shape<2>, f64)| region.contains([x, 0.5 * (p + q)]);
            let value = self.pieces.iter().rev().find(inside).map_or(self.background, |p| p.1);
            let [one, y, yy] = [1, 2, 3].map(|k| value * (q.powi(k) - p.powi(k)) / f64::from(k));
            let terms = [one, x * one, y, x * y, x * x * one, yy, x * x * y, x * yy, value * one];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        sums
    }

    /// Gauss' rule with four points.
    fn rule(&self, a: f64, b: f64) -> [f64; 9] {
        let root = (6.0_f64 / 5.0).sqrt();
        let points =
            [(3.0 - 2.0 * root, 18.0 + 30_f64.sqrt()), (3.0 + 2.0 * root, 18.0 - 30_f64.sqrt())];
        let mut sums = [0.0; 9];
        for (square, weight) in points {
            let t = (square / 7.0).sqrt();
            for x in [0.5 * (a + b - t * (b - a)), 0.5 * (a + b + t * (b - a))] {
                let line = self.line(x);
                sums.iter_mut().zip(line).for_each(|(s, f)| *s += (b - a) * weight / 72.0 * f);
            }
        }
        sums
    }

    /// Halves until the borders keep their order and the rule does not change.
    fn adaptive(&self, a: f64, b: f64, whole: [f64; 9], depth: usize) -> [f64; 9] {
        let middle = 0.5 * (a + b);
        let (left, right) = (self.rule(a, middle), self.rule(middle, b));
        let sums: [f64; 9] = std::array::from_fn(|k| left[k] + right[k]);
        let settled = || {
            let order = self.order(middle);
            order == self.order(a)
                && order == self.order(b)
                && (0..9).all(|k| (sums[k] - whole[k]).abs() < 1e-15 * (b - a).max(0.1))
        };
        if depth == 0 || settled() {
            return sums;
        }
        let (left, right) =
            (self.adaptive(a, middle, left, depth - 1), self.adaptive(middle, b, right, depth - 1));
        std::array::from_fn(|k| left[k] + right[k])
    }

    /// Over -1/2 < x < 1/2, from parts on which a small piece cannot hide.
    fn moments(&self) -> [f64; 9] {
        let mut ends: Vec<_> = (0..=5).map(|k| f64::from(k) / 5.0 - 0.5).collect();
        for (region, _) in self.pieces {
            match *region {
                Shape::Box([x, _]) => ends.extend(x),
                Shape::Ball { centre: [x, _], radius } => ends.extend([x - radius, x + radius]),
                Shape::HalfSpace { .. } => (),
            }
        }
        ends.retain(|x| x.abs() <= 0.5);
        ends.sort_by(f64::total_cmp);
        let mut sums = [0.0; 9];
        for pair in ends.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let part = self.adaptive(a, b, self.rule(a, b), 46);
            sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        sums
    }
}

/// The pieces in the coordinates of cell (i, j).
fn seen(pieces: &Pieces, grid: Grid, i: usize, j: usize) -> Vec<(Shape<2>, f64)> {
    let middle = |k: usize| 0.5 * (grid.coordinate(k) + grid.coordinate(k + 1));
    let look = |shape: &Shape<2>| shape.seen_from([middle(i), middle(j)], grid.h());
    pieces.iter().map(|(region, value)| (look(region), *value)).collect()
}

#[test]
fn moments_agree_with_adaptive_quadrature() {
    let mut random = Random(Dice(0x9E37_79B9_7F4A_7C15));
    for trial in 0..40 {
        let pieces: Vec<_> =
            (0..1 + trial % 6).map(|_| (random.region(), 4.0 * random.next())).collect();
        let background = random.next();
        for n in [2, 3, 7] {
            let grid = Grid::new(n).unwrap();
            let mut cells = Cells::new(grid, background, &pieces);
            for j in 0..n {
                let (mut values, mut cut) = (vec![0.0; n], BTreeMap::new());
                cells.row(j, &mut values, |i, cell| _ = cut.insert(i, cell.moments()));
                for i in (0..n).filter(|i| (5 * i + 3 * j + trial) % n == 0) {
                    let local = seen(&pieces, grid, i, j);
                    let quadrature = Quadrature {
                        background,
                        pieces: &local,
                        floor: |_| -0.5,
                        ceiling: |_| 0.5,
                    };
                    // Of a cell that is not cut the value alone: the first moment.
                    let ours: Vec<f64> = match cut.get(&i) {
                        Some(moments) => moments.f.into_iter().chain([moments.square]).collect(),
                        None => vec![values[i]],
                    };
                    for (k, (ours, theirs)) in
                        ours.into_iter().zip(quadrature.moments()).enumerate()
                    {
                        let case = format!("{trial}: 1/{n}, cell {i} {j}, moment {k}, {pieces:?}");
                        assert!((ours - theirs).abs() < 1e-13, "{ours} {theirs} {case}");
                    }
                }
            }
        }
    }
}

#[test]
fn loads_agree_with_adaptive_quadrature_on_each_triangle() {
    let mut random = Random(Dice(0xD1B5_4A32_D192_ED03));
    for trial in 0..16 {
        let pieces: Vec<_> =
            (0..1 + trial % 4).map(|_| (random.region(), 4.0 * random.next())).collect();
        let background = random.next();
        let f = Source::Pieces { background, pieces: pieces.clone() };
        let grid = Grid::new(2 + trial % 3).unwrap();
        let n = grid.cells();
        for diagonal in [Diagonal::Rising, Diagonal::Falling] {
            let mut want = vec![0.0; grid.nodes()];
            for (i, j) in (0..n * n).map(|cell| (cell % n, cell / n)) {
                let local = seen(&pieces, grid, i, j);
                let slope: fn(f64) -> f64 =
                    if diagonal == Diagonal::Rising { |x| x } else { |x| -x };
                let part = |floor, ceiling| {
                    Quadrature { background, pieces: &local, floor, ceiling }.moments()
                };
                let parts = [part(|_| -0.5, slope), part(slope, |_| 0.5)];
                // Of each triangle the corners (X, Y), as the hats are their barycentric coordinates.
                let corners = match diagonal {
                    Diagonal::Rising => [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]],
                    Diagonal::Falling => [[[0, 0], [1, 0], [0, 1]], [[1, 0], [1, 1], [0, 1]]],
                };
                for (moments, corners) in parts.iter().zip(corners) {
                    for k in 0..3 {
                        let [p, q, r] = [0, 1, 2].map(|l| corners[(k + l) % 3].map(f64::from));
                        // Twice the areas of (x, q, r) over that of (p, q, r): linear in x.
                        let area = |p: [f64; 2]| {
                            (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1])
                        };
                        let at = |x, y| area([x + 0.5, y + 0.5]) / area(p);
                        let (c, x, y) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0));
                        let mass = c * moments[0] + (x - c) * moments[1] + (y - c) * moments[2];
                        let [a, b] = corners[k];
                        want[grid.index(i + a as usize, j + b as usize)] += mass / (n * n) as f64;
                    }
                }
            }
            let ours = load(grid, &f, LoadRule::Exact { diagonal });
            let worst = ours.iter().zip(&want).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-13, "{worst:e} {diagonal:?} {f}");
        }
    }
}

#[test]
fn integrals_are_those_of_closed_forms() {
    let r = 0.25_f64;
    let segment = |d: f64| r * r * libm::acos(d / r) - d * (r * r - d * d).sqrt();
    for (f, want) in [
        ("disc(0.05,-0.1,0.3)=1; else=0", PI * 0.09),
        // Cut by one side, by a corner, by a half-plane through the centre, by a rectangle.
        ("disc(0.4,0,0.25)=2; else=-9", 11.0 * (PI * r * r - segment(0.1)) - 9.0),
        ("disc(0.5,-0.5,0.25)=1; else=0", PI * r * r / 4.0),
        ("disc(0.1,0.1,0.25)=1; halfplane(3,-1,0.2)=0; else=0", PI * r * r / 2.0),
        ("disc(0,0,0.25)=1; rect(0.125,0.5,-0.5,0.5)=0; else=0", PI * r * r - segment(0.125)),
        // Two discs that overlap, of which the last wins, and two that touch.
        ("disc(-0.1,0,0.25)=1; disc(0.1,0,0.25)=2; else=0", 3.0 * PI * r * r - 2.0 * segment(0.1)),
        ("disc(-0.2,0,0.25)=1; disc(0.3,0,0.25)=1; else=0", 2.0 * PI * r * r - segment(0.2)),
        // One that is far smaller than a cell, and one whose border is nearly straight.
        ("disc(0.1234,0.05,0.001)=1e3; else=0", PI * 1e-3),
        // The area under y = sqrt(R^2 - x^2) - R, by its series: 1/2 - 1/(24 R) - 1/(640 R^3).
        ("disc(0,-1000,1000)=1; else=0", 0.5 - 1.0 / 24e3 - 1.0 / 640e9),
    ] {
        let ours = integral(&f.parse().unwrap());
        assert!((ours - want).abs() < 1e-13, "{f}: {ours} {want}");
    }
}

#[test]
fn a_load_is_the_same_on_any_number_of_threads() {
    let f: Source = "disc(0.03,0.01,0.31)=3; halfplane(1,2,0.1)=2; else=-1".parse().unwrap();
    let cubic: Source<3> = "ball(0.03,0.01,0,0.31)=3; else=-1".parse().unwrap();
    let loads = || {
        let exact = LoadRule::Exact { diagonal: Diagonal::Rising };
        let rules = [exact, LoadRule::Bilinear {}, LoadRule::default()];
        let grid = Grid::new(300).unwrap();
        let mut all: Vec<_> = rules.into_iter().flat_map(|rule| load(grid, &f, rule)).collect();
        all.extend(mesh_load(&uniform_cube(12), &cubic).unwrap().load);
        all.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    assert!(on_threads(1, loads) == on_threads(3, loads));
}

#[test]
fn integrals_on_the_cube_are_those_of_closed_forms() {
    let ball = |r: f64| 4.0 / 3.0 * PI * r.powi(3);
    let cap = |r: f64, height: f64| PI * height * height * (r - height / 3.0);
    for (f, want) in [
        ("ball(0.05,-0.02,0.1,0.3)=1; else=0", ball(0.3)),
        ("ball(0.4,0,0,0.25)=1; else=0", ball(0.25) - cap(0.25, 0.15)),
        ("ball(0,0.1,0.4,0.25)=1; else=0", ball(0.25) - cap(0.25, 0.15)),
        ("ball(0.5,0.5,-0.5,0.3)=1; else=0", ball(0.3) / 8.0),
        ("ball(0,0,0,0.3)=1; ball(0.2,0,0,0.3)=2; else=0", 3.0 * ball(0.3) - 2.0 * cap(0.3, 0.2)),
        ("ball(0,0,0,0.3)=1; box(0.1,0.5,-0.5,0.5,-0.5,0.5)=0; else=0", ball(0.3) - cap(0.3, 0.2)),
        ("halfspace(1,1,1,-1)=1; else=0", 0.125 / 6.0),
        ("halfspace(1,1,1,0)=1; ball(0,0,0,0.3)=0; else=0", 0.5 - ball(0.3) / 2.0),
        ("box(-0.3,0.1,-0.21,0.2,-0.37,0.15)=6; else=-0.556", 6.556 * 0.4 * 0.41 * 0.52 - 0.556),
    ] {
        let f: Source<3> = f.parse().unwrap();
        let ours = mesh_load(&uniform_cube(3), &f).unwrap().integral;
        assert!((ours - want).abs() < 1e-13, "{f}: {ours} {want}");
    }
}
