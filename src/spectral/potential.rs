//! A particular solution psi of -Lap psi = f, in closed form and smooth up to the border but for its jumps.

use super::complex::Complex;
use super::jumps::Jumps;
use std::f64::consts::{PI, TAU};

/// Corners of the square, anticlockwise from the lower right one.
pub(super) const CORNERS: [Complex; 4] = [
    Complex::new(0.5, -0.5),
    Complex::new(0.5, 0.5),
    Complex::new(-0.5, 0.5),
    Complex::new(-0.5, -0.5),
];

/// psi up to a harmonic polynomial of degree four, chosen so that its gradient vanishes in the corners.
#[derive(Clone)]
pub(super) struct Potential {
    vertices: Vec<Complex>,
    edges: Vec<Straight>,
    /// f less what the jumps make of it.
    background: f64,
    /// p' = c0 + c1 z + c2 z^2 + c3 z^3 of the polynomial Re p that is subtracted.
    gauge: [Complex; 4],
}

#[derive(Clone)]
struct Straight {
    origin: Complex,
    tangent: Complex,
    angle: f64,
    jump: f64,
    ends: [Option<usize>; 2],
}

impl Potential {
    /// `value` is f at a point inside the square.
    pub fn new(jumps: &Jumps, value: impl Fn(Complex) -> f64) -> Self {
        let edges = jumps
            .edges
            .iter()
            .map(|e| Straight {
                origin: e.from,
                tangent: e.tangent,
                angle: e.tangent.arg(),
                jump: e.jump(),
                ends: e.ends,
            })
            .collect();
        let mut psi = Self {
            vertices: jumps.vertices.clone(),
            edges,
            background: 0.0,
            gauge: [Complex::default(); 4],
        };
        let z = psi.far_from_edges();
        psi.background = value(z) + psi.laplacian_of_jumps(z);
        let corners = CORNERS.map(|z| psi.at::<false>(z).1.conj());
        // Interpolation in the four corners is a discrete Fourier transform.
        let mut power = [Complex::new(0.25, 0.0); 4];
        for c in &mut psi.gauge {
            for k in 0..4 {
                *c = *c + corners[k] * power[k];
                // Division by the corner: its square of the modulus is 1/2.
                power[k] = power[k] * CORNERS[k].conj().scaled(2.0);
            }
        }
        psi
    }

    /// The gradient of psi.
    pub fn gradient(&self, z: Complex) -> Complex {
        self.at::<false>(z).1
    }

    /// psi and its gradient.
    pub fn value_and_gradient(&self, z: Complex) -> (f64, Complex) {
        self.at::<true>(z)
    }

    fn at<const VALUE: bool>(&self, z: Complex) -> (f64, Complex) {
        let mut logs = [(0.0, 0.0); 64];
        let mut many;
        let logs = if self.vertices.len() <= logs.len() {
            &mut logs[..self.vertices.len()]
        } else {
            many = vec![(0.0, 0.0); self.vertices.len()];
            &mut many[..]
        };
        for (log, &v) in logs.iter_mut().zip(&self.vertices) {
            let to = v - z;
            // At a vertex the factors of the logarithm vanish.
            *log = if to == Complex::default() {
                (0.0, 0.0)
            } else {
                (libm::log(to.norm2()), to.arg())
            };
        }
        let mut value = 0.0;
        let mut gradient = Complex::default();
        for e in &self.edges {
            let delta = e.tangent.cross(e.origin - z);
            // log(b/a), a and b the ends seen from z; ends on the border are moved to infinity and dropped.
            let mut ratio = Complex::default();
            let mut moments = 0.0;
            for (end, sign) in e.ends.iter().zip([-1.0, 1.0]) {
                if let Some(v) = *end {
                    let (log, arg) = logs[v];
                    ratio = ratio + Complex::new(0.5 * log, wrapped(arg - e.angle)).scaled(sign);
                    if VALUE {
                        let along = e.tangent.dot(self.vertices[v] - z);
                        moments += sign * along * (log - 1.0) * 0.5;
                    }
                } else if sign < 0.0 {
                    ratio.im -= PI.copysign(delta);
                }
            }
            gradient = gradient - (e.tangent * ratio.conj()).scaled(e.jump * delta / TAU);
            if VALUE {
                value += e.jump * delta * (moments - delta * ratio.im) / (2.0 * TAU);
            }
        }
        gradient = gradient - z.scaled(0.5 * self.background);
        let [c0, c1, c2, c3] = self.gauge;
        gradient = gradient - (((c3 * z + c2) * z + c1) * z + c0).conj();
        if VALUE {
            value -= 0.25 * self.background * z.norm2();
            let third = c2.scaled(1.0 / 3.0) + c3.scaled(0.25) * z;
            value -= (((third * z + c1.scaled(0.5)) * z + c0) * z).re;
        }
        (value, gradient)
    }

    /// Laplacian of what the edges contribute, constant between them.
    fn laplacian_of_jumps(&self, z: Complex) -> f64 {
        let angle = |e: &Straight| {
            let delta = e.tangent.cross(e.origin - z);
            let seen = |v: usize| wrapped((self.vertices[v] - z).arg() - e.angle);
            let start = e.ends[0].map_or(PI.copysign(delta), seen);
            e.ends[1].map_or(0.0, seen) - start
        };
        -self.edges.iter().map(|e| e.jump * angle(e)).sum::<f64>() / TAU
    }

    /// A point inside the square where no edge nor its continuation is near.
    fn far_from_edges(&self) -> Complex {
        let distance = |z: Complex| {
            self.edges
                .iter()
                .map(|e| e.tangent.cross(e.origin - z).abs())
                .fold(f64::INFINITY, f64::min)
        };
        (0..25)
            .map(|k| {
                let k = f64::from(k);
                let fraction = |x: f64| 0.9 * (x - x.floor() - 0.5);
                Complex::new(fraction(0.618_034 * k + 0.31), fraction(0.754_878 * k + 0.17))
            })
            .max_by(|&a, &b| distance(a).total_cmp(&distance(b)))
            .expect("there are points")
    }
}

/// The same angle within (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    }
}
