//! The curves inside the square across which f jumps.

use super::complex::Complex;
use crate::problem::source::{Region, Source};

/// Points closer than this count as one.
const SAME: f64 = 1e-12;
/// Distance from a jump at which f is read on either side of it.
pub(super) const PROBE: f64 = 1e-9;

/// A straight piece of a jump, between vertices or points of the border.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub from: Complex,
    pub to: Complex,
    /// Unit tangent.
    pub tangent: Complex,
    /// f on the left and on the right.
    pub values: [f64; 2],
    /// Vertices at its ends; none at an end on the border, beyond which f is continued with the same jump.
    pub ends: [Option<usize>; 2],
}

impl Edge {
    /// f on the left less f on the right.
    pub fn jump(&self) -> f64 {
        self.values[0] - self.values[1]
    }
}

/// All jumps of f inside the square.
#[derive(Clone, Debug, Default)]
pub(super) struct Jumps {
    pub edges: Vec<Edge>,
    /// Where edges meet, inside the square.
    pub vertices: Vec<Complex>,
    /// Where edges meet the border.
    pub crossings: Vec<Complex>,
}

/// The line of the points z with Re(conj(normal) z) = offset.
#[derive(Clone, Copy)]
struct Line {
    normal: Complex,
    offset: f64,
}

impl Line {
    fn tangent(self) -> Complex {
        self.normal.turned()
    }

    fn at(self, s: f64) -> Complex {
        self.normal.scaled(self.offset) + self.tangent().scaled(s)
    }

    /// Parameter of the crossing with another line, unless they are parallel.
    fn crossing(self, other: Self) -> Option<f64> {
        let slope = other.normal.dot(self.tangent());
        (slope.abs() > 1e-9)
            .then(|| (other.offset - self.offset * other.normal.dot(self.normal)) / slope)
    }

    fn same(self, other: Self) -> bool {
        (self.normal - other.normal).norm() < SAME && (self.offset - other.offset).abs() < SAME
    }

    /// The parameters of its points in the closed square.
    fn in_square(self) -> Option<[f64; 2]> {
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let (origin, tangent) = (self.at(0.0), self.tangent());
        for (o, t) in [(origin.re, tangent.re), (origin.im, tangent.im)] {
            if t.abs() < 1e-15 {
                if o.abs() >= 0.5 - SAME {
                    return None;
                }
                continue;
            }
            let (a, b) = ((-0.5 - o) / t, (0.5 - o) / t);
            (low, high) = (low.max(a.min(b)), high.min(a.max(b)));
        }
        (high - low > SAME).then_some([low, high])
    }
}

impl Jumps {
    pub fn of(f: &Source) -> Self {
        let Source::Pieces { pieces, .. } = f else { return Self::default() };
        let mut lines: Vec<Line> = Vec::new();
        for [a, b, c] in pieces.iter().flat_map(|(region, _)| straight(region)) {
            // One orientation for each line, so that common borders of two regions are found to be one.
            let flip = if a < 0.0 || (a == 0.0 && b < 0.0) { -1.0 } else { 1.0 };
            let scale = flip / (a * a + b * b).sqrt();
            let line = Line { normal: Complex::new(a, b).scaled(scale), offset: c * scale };
            if line.in_square().is_some() && !lines.iter().any(|&other| other.same(line)) {
                lines.push(line);
            }
        }
        let mut jumps = Self::default();
        for &line in &lines {
            jumps.add_line(f, line, &lines);
        }
        jumps
    }

    fn add_line(&mut self, f: &Source, line: Line, lines: &[Line]) {
        let [low, high] = line.in_square().expect("only lines that meet the square are kept");
        let mut cuts = vec![low, high];
        cuts.extend(
            lines
                .iter()
                .filter_map(|&other| line.crossing(other))
                .filter(|s| (low + SAME..high - SAME).contains(s)),
        );
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|b, a| *b - *a < SAME);
        let step = line.tangent().turned().scaled(PROBE);
        // Neighbours with the same values on both sides are one piece.
        let mut pieces: Vec<([f64; 2], [f64; 2])> = Vec::new();
        for cut in cuts.windows(2) {
            let middle = line.at(0.5 * (cut[0] + cut[1]));
            let values = [middle + step, middle - step].map(|z| f.at(z.re, z.im));
            match pieces.last_mut() {
                Some((span, last)) if *last == values => span[1] = cut[1],
                _ => pieces.push(([cut[0], cut[1]], values)),
            }
        }
        for (span, values) in pieces.into_iter().filter(|(_, values)| values[0] != values[1]) {
            let points = span.map(|s| line.at(s));
            let ends = points.map(|z| self.meet(z));
            let [from, to] = points;
            self.edges.push(Edge { from, to, tangent: line.tangent(), values, ends });
        }
    }

    /// Notes where an edge ends: the vertex there, or none on the border.
    fn meet(&mut self, z: Complex) -> Option<usize> {
        let on_border = z.re.abs().max(z.im.abs()) > 0.5 - SAME;
        let known = if on_border { &mut self.crossings } else { &mut self.vertices };
        let found = known.iter().position(|&v| (v - z).norm() < 10.0 * SAME);
        let index = found.unwrap_or_else(|| {
            known.push(z);
            known.len() - 1
        });
        (!on_border).then_some(index)
    }
}

/// The straight borders of a region, as lines `a x + b y = c`.
fn straight(region: &Region) -> Vec<[f64; 3]> {
    match region {
        Region::Disc { .. } => Vec::new(),
        _ => region.half_planes(),
    }
}
