//! Integrals in closed form of a piecewise constant f over a cell or triangle that borders of its pieces cross.
//!
//! The cell is swept along x. Between neighbouring abscissas at which a border ends, turns back or meets
//! another one, the borders are graphs in a fixed order with f constant from one to the next, so that the
//! integral of f p is a sum over the graphs: the jump of f there times the integral of p below the graph.
//! Below a straight graph that is a polynomial; a circular one adds the segment between chord and arc.

use super::monomials::{below_arc, below_chord, beside_chord, half_chord};
use crate::problem::shape::Shape;

/// Integrals of f times monomials over the unit cell [-1/2, 1/2]^2, or a part of it, in the coordinates X and Y there.
///
/// Over a cell of width h the integral is `h^2` times as large.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    /// Of f times 1, X, Y, XY, X^2, Y^2, X^2 Y and X Y^2.
    pub f: [f64; 8],
    /// Of f^2.
    pub square: f64,
}

/// A straight line `a x + b y = c`.
#[derive(Clone, Copy)]
struct SweepLine {
    a: f64,
    b: f64,
    c: f64,
}

/// A border of a piece, in the coordinates of the cell.
#[derive(Clone, Copy)]
enum PieceBorder {
    /// A line over these x; a vertical one ends at its only x, and is no graph.
    Straight(SweepLine, [f64; 2]),
    Circle {
        centre: [f64; 2],
        radius: f64,
    },
}

/// An edge of the cell or a diagonal, given by its heights at X = -1/2 and X = 1/2.
struct Bound {
    heights: [f64; 2],
    /// Factor of the integrals below it in the parts of the cell.
    signs: [f64; 2],
    /// The value of f at it, from some abscissa on.
    value: f64,
    from: f64,
}

/// The pieces that share one cell, with room for the work on them.
#[derive(Default)]
pub struct SweepCut {
    /// Value where none of the pieces is.
    background: f64,
    /// Shapes in the coordinates of the cell, the last first: it wins.
    pieces: Vec<(Shape<2>, f64)>,
    borders: Vec<PieceBorder>,
    stops: Vec<f64>,
    graphs: Vec<Graph>,
}

/// A border over one interval of the sweep: a straight one, or the upper or lower half of a circle.
#[derive(Clone, Copy)]
struct Graph {
    border: PieceBorder,
    upper: bool,
    /// Height in the middle of the interval.
    middle: f64,
}

impl SweepCut {
    /// Takes another cell, f there being `background` but for the pieces, of which the first wins.
    pub(crate) fn set(&mut self, background: f64, pieces: impl Iterator<Item = (Shape<2>, f64)>) {
        self.background = background;
        self.pieces.clear();
        self.pieces.extend(pieces);
        self.borders.clear();
        for (shape, _) in &self.pieces {
            add_borders(shape, &mut self.borders);
        }
    }

    /// Integrals over the cell.
    pub fn moments(&mut self) -> Moments {
        let bottom = Bound::new([-0.5, -0.5], [-1.0, 0.0]);
        let top = Bound::new([0.5, 0.5], [1.0, 0.0]);
        self.integrate(&mut [bottom, top])[0]
    }

    /// Integrals over the triangles below and above the diagonal that rises or falls.
    pub(crate) fn triangles(&mut self, rising: bool) -> [Moments; 2] {
        let heights = if rising { [-0.5, 0.5] } else { [0.5, -0.5] };
        let bottom = Bound::new([-0.5, -0.5], [-1.0, 0.0]);
        let diagonal = Bound::new(heights, [1.0, -1.0]);
        let top = Bound::new([0.5, 0.5], [0.0, 1.0]);
        self.integrate(&mut [bottom, diagonal, top])
    }

    /// The value of f, if borders of the pieces run along edges of the cell at most.
    pub(super) fn constant(&self) -> Option<f64> {
        self.borders.is_empty().then(|| self.value(0.0, 0.0))
    }

    fn value(&self, x: f64, y: f64) -> f64 {
        let covering = self.pieces.iter().find(|(shape, _)| shape.contains([x, y]));
        covering.map_or(self.background, |&(_, value)| value)
    }

    /// Integrals over the parts of the cell between neighbouring bounds, from below.
    fn integrate(&mut self, bounds: &mut [Bound]) -> [Moments; 2] {
        self.find_stops(bounds);
        let mut parts = [Moments::default(); 2];
        for k in 1..self.stops.len() {
            let (left, right) = (self.stops[k - 1], self.stops[k]);
            if left < right {
                self.interval(bounds, left, right, &mut parts);
            }
        }
        bounds.iter_mut().for_each(|bound| bound.meet(f64::NAN, 0.5, &mut parts));
        parts
    }

    /// The abscissas between which no graph begins, ends or meets another one.
    fn find_stops(&mut self, bounds: &[Bound]) {
        self.stops.clear();
        for (k, border) in self.borders.iter().enumerate() {
            match *border {
                PieceBorder::Straight(_, span) => self.stops.extend(span),
                PieceBorder::Circle { centre: [x, _], radius } => {
                    self.stops.extend([x - radius, x + radius]);
                }
            }
            for Bound { heights: [l, r], .. } in bounds {
                let line = SweepLine { a: l - r, b: 1.0, c: 0.5 * (l + r) };
                meet(border, &PieceBorder::Straight(line, [-0.5, 0.5]), &mut self.stops);
            }
            for other in &self.borders[..k] {
                meet(border, other, &mut self.stops);
            }
        }
        self.stops.retain(|x| x.abs() < 0.5);
        self.stops.extend([-0.5, 0.5]);
        self.stops.sort_unstable_by(f64::total_cmp);
    }

    /// Adds the integrals between two neighbouring stops, but for those below bounds at which f stays as it is.
    fn interval(&mut self, bounds: &mut [Bound], left: f64, right: f64, parts: &mut [Moments; 2]) {
        let middle = 0.5 * (left + right);
        self.find_graphs(middle);
        let heights = |k: usize| self.graphs.get(k).map_or(0.5, |graph| graph.middle);
        let mut value = self.value(middle, 0.5 * (heights(0) - 0.5));
        bounds[0].meet(value, left, parts);
        // The bound above.
        let mut next = 1;
        for (k, graph) in self.graphs.iter().enumerate() {
            while bounds[next].height(middle) <= graph.middle {
                bounds[next].meet(value, left, parts);
                next += 1;
            }
            let above = self.value(middle, 0.5 * (graph.middle + heights(k + 1)));
            if above != value {
                let (jump, of_square) = (value - above, value * value - above * above);
                parts[next - 1].add(jump, of_square, graph.below(left, right));
                value = above;
            }
        }
        bounds[next..].iter_mut().for_each(|bound| bound.meet(value, left, parts));
    }

    /// The graphs in the cell at the middle of an interval, from below.
    fn find_graphs(&mut self, middle: f64) {
        self.graphs.clear();
        for &border in &self.borders {
            let mut add = |upper: bool, height: f64| {
                if height.abs() < 0.5 {
                    self.graphs.push(Graph { border, upper, middle: height });
                }
            };
            match border {
                PieceBorder::Straight(line, [start, end]) if start < middle && middle < end => {
                    add(true, (line.c - line.a * middle) / line.b);
                }
                PieceBorder::Circle { centre: [x, y], radius } if (middle - x).abs() < radius => {
                    let half = half_chord(radius, middle - x);
                    add(false, y - half);
                    add(true, y + half);
                }
                _ => (),
            }
        }
        self.graphs.sort_unstable_by(|p, q| p.middle.total_cmp(&q.middle));
    }
}

impl Bound {
    fn new(heights: [f64; 2], signs: [f64; 2]) -> Self {
        Self { heights, signs, value: f64::NAN, from: -0.5 }
    }

    fn height(&self, x: f64) -> f64 {
        let [l, r] = self.heights;
        0.5 * (l + r) + (r - l) * x
    }

    /// Lets f have this value from `x` on. Where it changes, adds the integrals below the bound up to there.
    fn meet(&mut self, value: f64, x: f64, parts: &mut [Moments; 2]) {
        if self.value == value {
            return;
        }
        if self.from < x {
            let ends = [self.from, x];
            let below = below_chord(ends, ends.map(|x| self.height(x)));
            for (part, sign) in parts.iter_mut().zip(self.signs).filter(|part| part.1 != 0.0) {
                part.add(sign * self.value, sign * self.value * self.value, below);
            }
        }
        (self.value, self.from) = (value, x);
    }
}

impl Moments {
    /// Those of f times 1, X, Y and XY.
    pub(crate) fn first(&self) -> [f64; 4] {
        let [one, x, y, xy, ..] = self.f;
        [one, x, y, xy]
    }

    fn add(&mut self, jump: f64, jump_of_square: f64, monomials: [f64; 8]) {
        for (sum, term) in self.f.iter_mut().zip(monomials) {
            *sum += jump * term;
        }
        self.square += jump_of_square * monomials[0];
    }
}

fn add_borders(shape: &Shape<2>, borders: &mut Vec<PieceBorder>) {
    match *shape {
        Shape::Box([x, y]) => {
            borders.extend(
                y.iter()
                    .filter(|y| y.abs() < 0.5)
                    .map(|&y| PieceBorder::Straight(SweepLine { a: 0.0, b: 1.0, c: y }, x)),
            );
            borders.extend(
                x.iter()
                    .filter(|x| x.abs() < 0.5)
                    .map(|&x| PieceBorder::Straight(SweepLine { a: 1.0, b: 0.0, c: x }, [x, x])),
            );
        }
        // A line as steep as this is vertical to rounding.
        Shape::HalfSpace { normal: [a, b], d: c } if b.abs() < 1e-15 * a.abs() => {
            borders.push(PieceBorder::Straight(SweepLine { a, b: 0.0, c }, [c / a, c / a]));
        }
        Shape::HalfSpace { normal: [a, b], d: c } => {
            borders.push(PieceBorder::Straight(SweepLine { a, b, c }, [-0.5, 0.5]));
        }
        Shape::Ball { centre, radius } => borders.push(PieceBorder::Circle { centre, radius }),
    }
}

/// Adds the abscissas at which two borders meet, were they as long as they can be.
fn meet(p: &PieceBorder, q: &PieceBorder, stops: &mut Vec<f64>) {
    match (*p, *q) {
        (PieceBorder::Straight(p, _), PieceBorder::Straight(q, _)) => {
            stops.push((p.c * q.b - q.c * p.b) / (p.a * q.b - q.a * p.b));
        }
        (PieceBorder::Straight(line, _), PieceBorder::Circle { centre, radius })
        | (PieceBorder::Circle { centre, radius }, PieceBorder::Straight(line, _)) => {
            let away = line.c - line.a * centre[0] - line.b * centre[1];
            meet_circle([line.a, line.b], away, centre, radius, stops);
        }
        (
            PieceBorder::Circle { centre: p, radius },
            PieceBorder::Circle { centre: q, radius: other },
        ) => {
            // Both points lie on the radical line.
            let to = [q[0] - p[0], q[1] - p[1]];
            let square = to[0] * to[0] + to[1] * to[1];
            let away = 0.5 * (square + (radius - other) * (radius + other));
            meet_circle(to, away, p, radius, stops);
        }
    }
}

/// Adds the abscissas of the points of a circle where `normal . (p - centre) = away`.
fn meet_circle(normal: [f64; 2], away: f64, centre: [f64; 2], radius: f64, stops: &mut Vec<f64>) {
    let [a, b] = normal;
    let length = (a * a + b * b).sqrt();
    let distance = away / length;
    // A circle that touches the line, as decimals often have it, may miss it by a rounding error.
    if distance.abs() - radius <= 1e-12 * (1.0 + radius) {
        let foot = centre[0] + a / length * distance;
        let half = b / length * half_chord(radius, distance);
        stops.extend([foot - half, foot + half]);
    }
}

impl Graph {
    /// Integrals of the monomials between the x axis and this graph.
    fn below(&self, left: f64, right: f64) -> [f64; 8] {
        match self.border {
            PieceBorder::Straight(line, _) => {
                let on = |x: f64| (line.c - line.a * x) / line.b;
                below_chord([left, right], [on(left), on(right)])
            }
            PieceBorder::Circle { centre: [x, y], radius } => {
                let side = if self.upper { 1.0 } else { -1.0 };
                if let Some(sums) = below_arc([left, right], [x, y], radius, side) {
                    return sums;
                }
                let on = |s: f64| y + side * half_chord(radius, s - x);
                let (ends, heights) = ([left, right], [on(left), on(right)]);
                let mut sums = below_chord(ends, heights);
                let arc = beside_chord(ends, heights, [x, y], radius, side);
                sums.iter_mut().zip(arc).for_each(|(sum, term)| *sum += side * term);
                sums
            }
        }
    }
}
