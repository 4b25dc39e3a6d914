//! A particular solution psi of -Lap psi = f, in closed form and smooth up to the border but for its jumps.

use super::complex::Complex;
use super::dilogarithm::dilogarithm;
use super::jumps::{Continued, Jumps};
use std::f64::consts::{PI, TAU};

/// Corners of the square, anticlockwise from the lower right one.
pub(super) const CORNERS: [Complex; 4] = [
    Complex::new(0.5, -0.5),
    Complex::new(0.5, 0.5),
    Complex::new(-0.5, 0.5),
    Complex::new(-0.5, -0.5),
];

/// psi up to a harmonic polynomial of degree four, chosen so that its gradient vanishes in the corners.
///
/// The sum over all jumps J, each a curve from a to b with left f - right f = J, of
/// `-(J / 4 pi) Im int conj(w - z) (log|w - z| + 1/2) dw`; its derivative `psi_x - i psi_y` is
/// `(J / 4 pi i) [int conj(w - z) / (w - z) dw - conj(b - a)]`. What 1/2 and conj(b - a) contribute cancels
/// round closed curves.
#[derive(Clone)]
pub(super) struct Potential {
    vertices: Vec<Complex>,
    lines: Vec<Line>,
    arcs: Vec<Arc>,
    circles: Vec<Circle>,
    /// f less what the jumps make of it.
    background: f64,
    /// p' = c0 + c1 z + c2 z^2 + c3 z^3 of the polynomial Re p that is subtracted.
    gauge: [Complex; 4],
}

/// A straight jump; ends that are no vertices are at infinity.
#[derive(Clone)]
struct Line {
    origin: Complex,
    tangent: Complex,
    angle: f64,
    jump: f64,
    ends: [Option<usize>; 2],
}

/// A part of a circle, anticlockwise.
#[derive(Clone)]
struct Arc {
    centre: Complex,
    radius: f64,
    sweep: f64,
    jump: f64,
    ends: [usize; 2],
    /// The ends seen from the centre, and their angles.
    from_centre: [Complex; 2],
    angles: [f64; 2],
}

#[derive(Clone)]
struct Circle {
    centre: Complex,
    radius: f64,
    jump: f64,
}

/// Logarithm of the distance and angle of a vertex seen from a point.
type Seen = [f64; 2];

impl Potential {
    pub(super) fn new(jumps: &Jumps) -> Self {
        let mut psi = Self {
            vertices: jumps.vertices.clone(),
            lines: Vec::new(),
            arcs: Vec::new(),
            circles: Vec::new(),
            background: 0.0,
            gauge: [Complex::default(); 4],
        };
        for jump in &jumps.continued {
            match *jump {
                Continued::Line { origin, tangent, jump, ends } => {
                    psi.lines.push(Line { origin, tangent, angle: tangent.arg(), jump, ends });
                }
                Continued::Circle { centre, radius, jump } => {
                    psi.circles.push(Circle { centre, radius, jump });
                }
                Continued::Arc { centre, radius, span: [from, to], jump, ends } => {
                    let from_centre = [from, to].map(|s| Complex::unit(s).scaled(radius));
                    let angles = from_centre.map(Complex::arg);
                    let sweep = to - from;
                    psi.arcs.push(Arc { centre, radius, sweep, jump, ends, from_centre, angles });
                }
            }
        }
        // The same at all points but for rounding, which a small integral of f would feel.
        let points = psi.far_from_jumps();
        let background = |&z: &Complex| jumps.value(z) - psi.source_of_jumps(z);
        psi.background = points.iter().map(background).sum::<f64>() / points.len() as f64;
        let corners = CORNERS.map(|z| psi.gradient(z).conj());
        // Interpolation in the four corners is a discrete Fourier transform.
        let mut power = [Complex::new(0.25, 0.0); 4];
        for c in &mut psi.gauge {
            for ((power, corner), z) in power.iter_mut().zip(corners).zip(CORNERS) {
                *c = *c + corner * *power;
                // The inverse of a corner is twice its conjugate.
                *power = *power * z.conj().scaled(2.0);
            }
        }
        psi
    }

    /// The gradient of psi.
    pub(super) fn gradient(&self, z: Complex) -> Complex {
        self.at::<false>(z).1
    }

    /// psi and its gradient.
    pub(super) fn value_and_gradient(&self, z: Complex) -> (f64, Complex) {
        self.at::<true>(z)
    }

    fn at<const VALUE: bool>(&self, z: Complex) -> (f64, Complex) {
        let mut few = [[0.0; 2]; 32];
        let mut many;
        let seen = if self.vertices.len() <= few.len() {
            &mut few[..self.vertices.len()]
        } else {
            many = vec![[0.0; 2]; self.vertices.len()];
            &mut many[..]
        };
        for (seen, &v) in seen.iter_mut().zip(&self.vertices) {
            let to = v - z;
            // At a vertex the factors of the logarithm vanish.
            if to != Complex::default() {
                *seen = [0.5 * libm::log(to.norm2()), to.arg()];
            }
        }
        let mut value = -0.25 * self.background * z.norm2();
        let mut gradient = z.scaled(-0.5 * self.background);
        for line in &self.lines {
            let (v, g) = line.at::<VALUE>(z, &self.vertices, seen);
            (value, gradient) = (value + v, gradient + g);
        }
        for arc in &self.arcs {
            let (v, g) = arc.at::<VALUE>(z, seen);
            (value, gradient) = (value + v, gradient + g);
        }
        for circle in &self.circles {
            let (v, g) = circle.at::<VALUE>(z);
            (value, gradient) = (value + v, gradient + g);
        }
        let [c0, c1, c2, c3] = self.gauge;
        gradient = gradient - (((c3 * z + c2) * z + c1) * z + c0).conj();
        if VALUE {
            let third = c2.scaled(1.0 / 3.0) + c3.scaled(0.25) * z;
            value -= (((third * z + c1.scaled(0.5)) * z + c0) * z).re;
        }
        (value, gradient)
    }

    /// What the jumps contribute to f, up to a constant.
    fn source_of_jumps(&self, z: Complex) -> f64 {
        let seen: Vec<Seen> =
            self.vertices.iter().map(|&v| [libm::log((v - z).norm()), (v - z).arg()]).collect();
        let lines = self.lines.iter().map(|line| line.jump * line.log_ratio(z, &seen).im);
        let arcs = self.arcs.iter().map(|arc| arc.jump * arc.log(z, &seen).0.im);
        let inside = |c: &Circle| (z - c.centre).norm() < c.radius;
        let circles = self.circles.iter().map(|c| if inside(c) { c.jump * TAU } else { 0.0 });
        (lines.sum::<f64>() + arcs.sum::<f64>() + circles.sum::<f64>()) / TAU
    }

    /// Points inside the square where no jump nor its continuation is near.
    fn far_from_jumps(&self) -> Vec<Complex> {
        let distance = |z: Complex| {
            let lines = self.lines.iter().map(|e| e.tangent.cross(e.origin - z).abs());
            let arcs = self.arcs.iter().map(|e| ((z - e.centre).norm() - e.radius).abs());
            let circles = self.circles.iter().map(|e| ((z - e.centre).norm() - e.radius).abs());
            lines.chain(arcs).chain(circles).fold(f64::INFINITY, f64::min)
        };
        let candidate = |k: u32| {
            let fraction = |x: f64| 0.9 * (x - x.floor() - 0.5);
            let k = f64::from(k);
            Complex::new(fraction(0.618_034 * k + 0.31), fraction(0.754_878 * k + 0.17))
        };
        let mut points: Vec<Complex> = (0..25).map(candidate).collect();
        let farthest = points.iter().map(|&z| distance(z)).fold(0.0, f64::max);
        points.retain(|&z| distance(z) >= 0.5 * farthest);
        points
    }
}

impl Line {
    /// log(b/a), a and b the ends seen from z; what those at infinity contribute is dropped.
    fn log_ratio(&self, z: Complex, seen: &[Seen]) -> Complex {
        let end = |end: Option<usize>| {
            end.map(|v| Complex::new(seen[v][0], wrapped(seen[v][1] - self.angle)))
        };
        let side = Complex::new(0.0, PI.copysign(self.tangent.cross(self.origin - z)));
        end(self.ends[1]).unwrap_or_default() - end(self.ends[0]).unwrap_or(side)
    }

    fn at<const VALUE: bool>(
        &self,
        z: Complex,
        vertices: &[Complex],
        seen: &[Seen],
    ) -> (f64, Complex) {
        let delta = self.tangent.cross(self.origin - z);
        let ratio = self.log_ratio(z, seen);
        let gradient = (self.tangent * ratio.conj()).scaled(-self.jump * delta / TAU);
        if !VALUE {
            return (0.0, gradient);
        }
        let moment = |end: Option<usize>| {
            end.map_or(0.0, |v| self.tangent.dot(vertices[v] - z) * (seen[v][0] - 0.5))
        };
        let moments = moment(self.ends[1]) - moment(self.ends[0]);
        (self.jump * delta * (moments - delta * ratio.im) / (2.0 * TAU), gradient)
    }
}

impl Arc {
    /// L = int dw / (w - z), and M = (L - i sweep) / (z - centre).
    fn log(&self, z: Complex, seen: &[Seen]) -> (Complex, Complex) {
        let from_centre = z - self.centre;
        let (square, radius2) = (from_centre.norm2(), self.radius * self.radius);
        let distance = seen[self.ends[1]][0] - seen[self.ends[0]][0];
        let turn = Complex::new(0.0, self.sweep);
        let [a, b] = [0, 1].map(|k| seen[self.ends[k]][1]);
        if square > radius2 {
            let angle = from_centre.arg() + PI;
            let log = Complex::new(distance, wrapped(b - angle) - wrapped(a - angle));
            return (log, (log - turn) * from_centre.inverse());
        }
        let rest =
            Complex::new(distance, wrapped(b - self.angles[1]) - wrapped(a - self.angles[0]));
        let [a, b] = self.from_centre.map(Complex::inverse);
        let quotient = if square < 1e-4 * radius2 {
            // log(1 - z/b) - log(1 - z/a), less a factor z.
            let (mut sum, mut pa, mut pb) = (Complex::default(), a, b);
            for k in 1..=9 {
                sum = sum + (pa - pb).scaled(1.0 / f64::from(k));
                (pa, pb) = (pa * a * from_centre, pb * b * from_centre);
            }
            sum
        } else {
            rest * from_centre.inverse()
        };
        (rest + turn, quotient)
    }

    fn at<const VALUE: bool>(&self, z: Complex, seen: &[Seen]) -> (f64, Complex) {
        let from_centre = z - self.centre;
        let (log, quotient) = self.log(z, seen);
        let [a, b] = self.from_centre;
        let radius2 = self.radius * self.radius;
        let derivative = quotient.scaled(radius2) - from_centre.conj() * log - (b - a).conj();
        // Division by 4 pi i, and the conjugate of psi_x - i psi_y.
        let gradient = Complex::new(derivative.im, derivative.re).scaled(self.jump / (2.0 * TAU));
        if !VALUE {
            return (0.0, gradient);
        }
        let square = from_centre.norm2();
        let [ya, yb] = [a, b].map(|u| from_centre.cross(u));
        let sweep = self.sweep;
        let e = yb * seen[self.ends[1]][0] - ya * seen[self.ends[0]][0]
            + 0.25 * (radius2 - square) * (2.0 * log.im - sweep)
            - 0.25 * (radius2 + square) * sweep
            - 0.5 * (yb - ya);
        let lambda = if square > radius2 {
            let inverse = from_centre.inverse();
            0.5 * sweep * libm::log(square)
                - (dilogarithm(b * inverse).im - dilogarithm(a * inverse).im)
        } else {
            0.5 * sweep * libm::log(radius2)
                + (dilogarithm(from_centre * b.inverse()).im
                    - dilogarithm(from_centre * a.inverse()).im)
        };
        let sum = radius2 * lambda - e + 0.5 * (radius2 * sweep - (yb - ya));
        (-self.jump * sum / (2.0 * TAU), gradient)
    }
}

impl Circle {
    fn at<const VALUE: bool>(&self, z: Complex) -> (f64, Complex) {
        let from_centre = z - self.centre;
        let (square, radius2) = (from_centre.norm2(), self.radius * self.radius);
        let half = -0.5 * self.jump;
        if square > radius2 {
            let value = if VALUE { half * radius2 * (0.5 * libm::log(square) + 1.0) } else { 0.0 };
            return (value, from_centre.scaled(half * radius2 / square));
        }
        let log = if VALUE { radius2 * libm::log(radius2) } else { 0.0 };
        (half * 0.5 * (log + square + radius2), from_centre.scaled(half))
    }
}

/// The same angle within (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    if angle > PI {
        wrapped(angle - TAU)
    } else if angle <= -PI {
        wrapped(angle + TAU)
    } else {
        angle
    }
}
