//! A particular solution psi of -Lap psi = f, in closed form and smooth up to the border but for its jumps.

use super::complex::Complex;
use crate::discrete::simd::vectorised;
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
    /// Coefficients of p', the polynomial Re p being subtracted.
    gauge: [Complex; 4],
}

/// A straight jump; ends that are no vertices are at infinity.
#[derive(Clone, Debug)]
pub(super) struct Line {
    origin: Complex,
    tangent: Complex,
    angle: f64,
    jump: f64,
    ends: [Option<usize>; 2],
}

/// A part of a circle, anticlockwise.
#[derive(Clone, Debug)]
pub(super) struct Arc {
    centre: Complex,
    radius: f64,
    sweep: f64,
    jump: f64,
    ends: [usize; 2],
    /// The ends seen from the centre, and their angles.
    from_centre: [Complex; 2],
    angles: [f64; 2],
}

/// A whole circle.
#[derive(Clone, Debug)]
pub(super) struct Circle {
    pub centre: Complex,
    pub radius: f64,
    pub jump: f64,
}

/// Logarithms as seen from points.
struct Logs {
    /// Number of points.
    many: usize,
    /// log(v - z), vertex by vertex.
    of_vertices: Vec<Complex>,
    /// What a jump makes of those at its ends.
    ratios: Vec<Complex>,
}

impl Potential {
    /// From the jumps, and f.
    pub(super) fn new(
        vertices: Vec<Complex>,
        lines: Vec<Line>,
        arcs: Vec<Arc>,
        circles: Vec<Circle>,
        f: impl Fn(Complex) -> f64,
    ) -> Self {
        let gauge = [Complex::default(); 4];
        let mut psi = Self { vertices, lines, arcs, circles, background: 0.0, gauge };
        // The same at all points but for rounding, and those that are too near to a jump.
        let fraction = |x: f64| 0.9 * (x - x.floor() - 0.5);
        let point =
            |k: f64| Complex::new(fraction(0.618_034 * k + 0.31), fraction(0.754_878 * k + 0.17));
        let points: [Complex; 25] = std::array::from_fn(|k| point(k as f64));
        let from_jumps = psi.source_of_jumps(&points);
        let rest = points.iter().zip(from_jumps).map(|(&z, part)| f(z) - part);
        let mut rest: Vec<f64> = rest.collect();
        rest.sort_by(f64::total_cmp);
        psi.background = rest[points.len() / 2];
        let corners = psi.gradients(&CORNERS);
        // Interpolation in the four corners is a discrete Fourier transform.
        let mut power = [Complex::new(0.25, 0.0); 4];
        for c in &mut psi.gauge {
            for ((power, corner), z) in power.iter_mut().zip(&corners).zip(CORNERS) {
                *c = *c + corner.conj() * *power;
                // The inverse of a corner is twice its conjugate.
                *power = *power * z.conj().scaled(2.0);
            }
        }
        psi
    }

    /// The gradient of psi at points.
    pub(super) fn gradients(&self, points: &[Complex]) -> Vec<Complex> {
        let [c0, c1, c2, c3] = self.gauge;
        vectorised(
            #[inline(always)]
            || {
                let gauge = |z: Complex| (((c3 * z + c2) * z + c1) * z + c0).conj();
                let mut sums: Vec<Complex> =
                    points.iter().map(|&z| z.scaled(-0.5 * self.background) - gauge(z)).collect();
                let mut logs = self.logs(points);
                for line in &self.lines {
                    line.add_gradients(points, &mut logs, &mut sums);
                }
                for arc in &self.arcs {
                    arc.add_gradients(points, &mut logs, &mut sums);
                }
                for circle in &self.circles {
                    for (sum, &z) in sums.iter_mut().zip(points) {
                        *sum = *sum + circle.gradient(z);
                    }
                }
                sums
            },
        )
    }

    /// log(v - z) for the vertices v, seen from points z.
    #[inline(always)]
    fn logs(&self, points: &[Complex]) -> Logs {
        let many = points.len();
        let mut of_vertices = vec![Complex::default(); many * self.vertices.len()];
        for (logs, &v) in of_vertices.chunks_exact_mut(many).zip(&self.vertices) {
            // At a vertex, where it is finite here, the factors of the logarithm vanish.
            for (log, &z) in logs.iter_mut().zip(points) {
                *log = (v - z).ln();
            }
        }
        Logs { many, of_vertices, ratios: vec![Complex::default(); many] }
    }

    /// What the jumps contribute to f at points, up to a constant.
    fn source_of_jumps(&self, points: &[Complex]) -> Vec<f64> {
        let mut logs = self.logs(points);
        let mut sums = vec![0.0; points.len()];
        for line in &self.lines {
            line.log_ratios(points, &mut logs);
            for (sum, ratio) in sums.iter_mut().zip(&logs.ratios) {
                *sum += line.jump / TAU * ratio.im;
            }
        }
        for arc in &self.arcs {
            arc.log_ratios(points, &mut logs);
            for (sum, ratio) in sums.iter_mut().zip(&logs.ratios) {
                *sum += arc.jump / TAU * (ratio.im + arc.sweep);
            }
        }
        for circle in &self.circles {
            for (sum, &z) in sums.iter_mut().zip(points) {
                *sum += if (z - circle.centre).norm() < circle.radius { circle.jump } else { 0.0 };
            }
        }
        sums
    }
}

impl Line {
    pub(super) fn new(
        origin: Complex,
        tangent: Complex,
        jump: f64,
        ends: [Option<usize>; 2],
    ) -> Self {
        Self { origin, tangent, angle: tangent.arg(), jump, ends }
    }

    /// log(b/a), a and b the ends seen from z; what those at infinity contribute is dropped.
    #[inline(always)]
    fn log_ratios(&self, points: &[Complex], logs: &mut Logs) {
        for (ratio, &z) in logs.ratios.iter_mut().zip(points) {
            *ratio = Complex::new(0.0, -PI.copysign(self.tangent.cross(self.origin - z)));
        }
        for (end, sign) in self.ends.into_iter().zip([-1.0, 1.0]) {
            let Some(v) = end else { continue };
            if sign < 0.0 {
                logs.ratios.fill(Complex::default());
            }
            let seen = &logs.of_vertices[v * logs.many..][..logs.many];
            for (ratio, log) in logs.ratios.iter_mut().zip(seen) {
                let end = Complex::new(log.re, wrapped(log.im - self.angle));
                *ratio = *ratio + end.scaled(sign);
            }
        }
    }

    #[inline(always)]
    fn add_gradients(&self, points: &[Complex], logs: &mut Logs, sums: &mut [Complex]) {
        self.log_ratios(points, logs);
        for ((sum, &z), ratio) in sums.iter_mut().zip(points).zip(&logs.ratios) {
            let delta = self.tangent.cross(self.origin - z);
            *sum = *sum + (self.tangent * ratio.conj()).scaled(-self.jump * delta / TAU);
        }
    }
}

impl Arc {
    /// That of a circle between two angles, at which the vertices `p` and `q` are.
    pub(super) fn new(
        Circle { centre, radius, jump }: Circle,
        [from, to]: [f64; 2],
        ends: [usize; 2],
        [p, q]: [Complex; 2],
    ) -> Self {
        // A short arc by its chord, which of a large circle has digits that the angles have lost.
        let half = 0.5 * (q - p).norm() / radius;
        let (middle, sweep) = if to - from < 1.0 {
            ((p - q).turned().arg(), 2.0 * libm::asin(half))
        } else {
            (0.5 * (from + to), to - from)
        };
        let from_centre = [-0.5, 0.5].map(|t| Complex::unit(middle + t * sweep).scaled(radius));
        let angles = from_centre.map(Complex::arg);
        Self { centre, radius, sweep, jump, ends, from_centre, angles }
    }

    /// L - i sweep, L = int dw / (w - z) over the arc.
    #[inline(always)]
    fn log_ratios(&self, points: &[Complex], logs: &mut Logs) {
        let radius2 = self.radius * self.radius;
        let [a, b] = self.ends.map(|v| &logs.of_vertices[v * logs.many..][..logs.many]);
        let [angle_a, angle_b] = self.angles;
        for (((ratio, &z), a), b) in logs.ratios.iter_mut().zip(points).zip(a).zip(b) {
            let to_centre = self.centre - z;
            let outside = to_centre.norm2() > radius2;
            let angle = to_centre.arg();
            let (from_a, from_b) = if outside { (angle, angle) } else { (angle_a, angle_b) };
            let angle = wrapped(b.im - from_b) - wrapped(a.im - from_a);
            let turn = if outside { self.sweep } else { 0.0 };
            *ratio = Complex::new(b.re - a.re, angle - turn);
        }
    }

    #[inline(always)]
    fn add_gradients(&self, points: &[Complex], logs: &mut Logs, sums: &mut [Complex]) {
        self.log_ratios(points, logs);
        let [a, b] = self.from_centre;
        let radius2 = self.radius * self.radius;
        let turn = Complex::new(0.0, self.sweep);
        for ((sum, &z), &ratio) in sums.iter_mut().zip(points).zip(&logs.ratios) {
            let from_centre = z - self.centre;
            let quotient = if from_centre.norm2() < 1e-4 * radius2 {
                self.quotient_near_centre(from_centre)
            } else {
                ratio * from_centre.inverse()
            };
            let derivative =
                quotient.scaled(radius2) - from_centre.conj() * (ratio + turn) - (b - a).conj();
            // Division by 4 pi i, and the conjugate of psi_x - i psi_y.
            let gradient = Complex::new(derivative.im, derivative.re);
            *sum = *sum + gradient.scaled(self.jump / (2.0 * TAU));
        }
    }

    /// (log(1 - z/b) - log(1 - z/a)) / z.
    fn quotient_near_centre(&self, z: Complex) -> Complex {
        let [a, b] = self.from_centre.map(Complex::inverse);
        let (mut sum, mut pa, mut pb) = (Complex::default(), a, b);
        for k in 1..=9 {
            sum = sum + (pa - pb).scaled(1.0 / f64::from(k));
            (pa, pb) = (pa * a * z, pb * b * z);
        }
        sum
    }
}

impl Circle {
    #[inline(always)]
    fn gradient(&self, z: Complex) -> Complex {
        let from_centre = z - self.centre;
        let radius2 = self.radius * self.radius;
        let ratio = radius2 / from_centre.norm2().max(radius2);
        from_centre.scaled(-0.5 * self.jump * ratio)
    }
}

/// The same angle within (-pi, pi], for one within (-2 pi, 2 pi).
#[inline(always)]
fn wrapped(angle: f64) -> f64 {
    let down = if angle > PI { angle - TAU } else { angle };
    if angle <= -PI { angle + TAU } else { down }
}
