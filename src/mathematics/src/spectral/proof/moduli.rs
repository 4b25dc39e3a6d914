//! Bounds of the moduli of psi, of g and of their slopes on discs of the complex plane.
//!
//! Along a panel v is analytic in the distance s from its start. Where s is complex, z(s) is a complex number, and the
//! function conj(z(conj(s))), which is conj(z) on the panel, another one; both lie in a disc round the panel and its
//! mirror image, so that `|Re g|` is at most the largest |g| on the disc. There the functions of
//! [`functions`] are bounded by distances from the ends of cuts, polynomials by the
//! maximum principle and their values on the circle: a trigonometric polynomial of degree m is at most
//! `1 / cos(pi m / N)` times its largest value at N equally spaced points (by M. Riesz's comparison with a cosine;
//! Ehlich and Zeller, Math. Z. 86, 1964), and a polynomial of degree n on a circle, turned back by half of n, has
//! degree n / 2.

use crate::problem::complex::Complex;
use crate::spectral::fit::Fit;
use crate::spectral::functions::{Family, Functions, Hole};
use crate::spectral::geometry::panels::Spot;
use crate::spectral::source::potential::{Jump, Potential};
use crate::spectral::source::psi::{Psi, PsiPart};
use std::f64::consts::{PI, TAU};

/// Disc round a panel, or round the split that a panel is near to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    pub centre: Complex,
    pub radius: f64,
    /// Least distance from the centre, if that is a split.
    pub inner: f64,
}

impl Disc {
    /// Most that the imaginary part of a logarithm is.
    fn turns(self) -> f64 {
        TURNS[usize::from(self.inner > 0.0)]
    }

    /// Least and greatest distance of its points from another one.
    fn range(self, z: Complex) -> [f64; 2] {
        let away = (z - self.centre).norm();
        match away < TOUCHES && self.inner > 0.0 {
            true => [self.inner, self.radius],
            false => [away - self.radius, away + self.radius],
        }
    }
}

/// Distance of a vertex from a split below which it is taken for it.
pub(super) const TOUCHES: f64 = 1e-12;
/// Most that the imaginary part of a logarithm is on a cell and its ellipse, and on one in log r.
pub(super) const TURNS: [f64; 2] = [5.0 * PI, 12.0 * PI];

/// Bounds of a function and of its derivative.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moduli {
    pub value: f64,
    pub slope: f64,
}

impl Moduli {
    pub(super) fn add(&mut self, other: Self) {
        self.value += other.value;
        self.slope += other.slope;
    }
}

/// Largest modulus of a logarithm of a number with a modulus between two.
fn log_modulus([least, most]: [f64; 2]) -> f64 {
    if least <= 0.0 { f64::INFINITY } else { libm::log(least).abs().max(libm::log(most).abs()) }
}

/// Bounds of g on a disc, without its polynomial and without the family of a split.
pub(super) fn of_functions(fit: &Fit, disc: Disc, without: Option<usize>) -> Moduli {
    let mut sum = Moduli::default();
    for (family, own) in fit.families().filter(|(own, _)| without.is_none() || own.split != without)
    {
        sum.add(family.moduli(disc, own));
    }
    let mut next = fit.functions.families.iter().map(Family::many).sum();
    for (hole, log) in fit.functions.holes.iter().zip(&fit.logs) {
        sum.add(hole.moduli(disc, &fit.coefficients[next..next + hole.powers], *log));
        next += hole.powers;
    }
    sum
}

/// Bounds of a polynomial on discs, by Arnoldi's matrix and the coefficients; cells next to a split have one disc.
pub(super) fn of_polynomial(
    arnoldi: &[Vec<Complex>],
    own: &[Complex],
    discs: &[Disc],
) -> Vec<Moduli> {
    let mut distinct: Vec<Disc> = Vec::new();
    let mut numbers = Vec::with_capacity(discs.len());
    for disc in discs {
        let known = distinct
            .iter()
            .rposition(|other: &Disc| (other.centre, other.radius) == (disc.centre, disc.radius));
        numbers.push(known.unwrap_or(distinct.len()));
        if known.is_none() {
            distinct.push(*disc);
        }
    }
    let points = 2 * arnoldi.len().max(1);
    let functions = Functions { arnoldi: arnoldi.to_vec(), ..Functions::default() };
    let mut moduli = Vec::with_capacity(distinct.len());
    for discs in distinct.chunks(16) {
        let mut spots = Vec::with_capacity(discs.len() * points);
        for disc in discs {
            for k in 0..points {
                let way = Complex::unit(TAU * k as f64 / points as f64);
                spots.push(Spot::inside(disc.centre + way.scaled(disc.radius)));
            }
        }
        let sums = functions.sums(own, &spots, true);
        for k in 0..discs.len() {
            // The cosine of a quarter of pi.
            let [value, slope] = [0, 1].map(|which: usize| {
                let own = &sums[which][k * points..(k + 1) * points];
                own.iter().fold(0.0f64, |most, z| most.max(z.norm())) * 1.4143
            });
            moduli.push(Moduli { value, slope });
        }
    }
    numbers.into_iter().map(|number| moduli[number]).collect()
}

impl Family {
    /// Bounds of its part of g.
    fn moduli(&self, disc: Disc, coefficients: &[Complex]) -> Moduli {
        let [near, far] = disc.range(self.point);
        let mut sum = Moduli::default();
        for (&d, own) in self.lengths.iter().zip(coefficients.chunks_exact(self.powers.len())) {
            let [tip, beyond] = disc.range(self.point - self.inwards.scaled(d));
            if tip <= 0.0 {
                return Moduli { value: f64::INFINITY, slope: f64::INFINITY };
            }
            let u = [near.max(0.0) / beyond, far / tip];
            let logs = u.map(libm::log);
            let rate = d / (tip * tip);
            for (function, c) in self.powers.iter().zip(own) {
                let power = function.power;
                let value = c.norm() * libm::exp(power * logs[1]);
                let base = match power < 1.0 {
                    true => c.norm() * libm::exp((power - 1.0) * logs[0]),
                    false => value / u[1],
                };
                let log = if function.log { log_modulus(u) + disc.turns() } else { 1.0 };
                let factor = if function.log { power * log + 1.0 } else { power };
                sum.value += value * log;
                sum.slope += base * rate * factor;
            }
        }
        sum
    }
}

impl Hole {
    /// Bounds of its part of g.
    pub(super) fn moduli(&self, disc: Disc, coefficients: &[Complex], log: f64) -> Moduli {
        let range = disc.range(self.middle);
        let near = range[0].max(0.0);
        let mut sum = Moduli {
            value: log.abs() * (log_modulus(range) + disc.turns()),
            slope: log.abs() / near,
        };
        let mut power = 1.0;
        for (k, c) in coefficients.iter().enumerate() {
            power *= self.radius / near;
            sum.value += c.norm() * power;
            sum.slope += c.norm() * power * (k as f64 + 1.0) / near;
        }
        sum
    }
}

/// Bounds of psi and its gradient on a disc, in complex coordinates as said above.
pub(super) fn of_psi(psi: &Psi, disc: Disc) -> Moduli {
    let Disc { centre, radius, .. } = disc;
    match psi {
        Psi::Smooth(own) => {
            let [value, slope] = own.psi.moduli(centre, radius);
            Moduli { value, slope }
        }
        Psi::Jumps(parts) => {
            let mut slope = psi.gradients(&[centre])[0].norm();
            for part in parts {
                slope += part.change(Disc { centre: centre - part.middle, ..disc });
            }
            Moduli { value: psi.value(centre).abs() + 4.0 * radius * slope, slope }
        }
    }
}

impl PsiPart {
    /// Bound of the change of the gradient on a disc that is seen from the middle.
    fn change(&self, disc: Disc) -> f64 {
        if let Some(far) = &self.far
            && let least = far.extent.distance(disc.centre) - disc.radius
            && least > 0.0
        {
            // In both coordinates half of it, here and in the centre.
            return 2.0 * far.mass / (TAU * least);
        }
        let mut sum = 0.5 * self.potential.background.abs() * disc.radius;
        for jump in &self.potential.jumps {
            let part = jump.modulus(disc, &self.potential.vertices);
            sum += 2.0 * jump.size.abs() / (2.0 * TAU) * part;
        }
        sum
    }
}

/// Bound of f on a disc, beside which it is `here` if constant on pieces.
pub(super) fn of_f(psi: &Psi, here: f64, disc: Disc) -> f64 {
    match psi {
        Psi::Jumps(_) => here.abs(),
        Psi::Smooth(own) => own.f.moduli(disc.centre, disc.radius)[0],
    }
}

impl Jump {
    /// Bound of the part of the gradient that is not constant, for a jump of 4 pi: with nu and the logarithm of
    /// [`Potential`], `(s + i power log) / nu`.
    fn modulus(&self, disc: Disc, vertices: &[Complex]) -> f64 {
        let curve = self.arc.curve;
        let seen = curve.polar(disc.centre);
        let (bend, size) = (curve.curvature * disc.radius, seen.nu.norm());
        let power = seen.power.abs() + 2.0 * disc.radius * (size + bend);
        let ends = self.arc.ends.iter().flatten();
        let log = disc.turns() + ends.map(|&v| log_modulus(disc.range(vertices[v]))).sum::<f64>();
        let length = (self.arc.span[1] - self.arc.span[0]).abs();
        if curve.curvature == 0.0 {
            return power * log;
        }
        if size + bend < 1.0 {
            // Inside the circle the logarithm vanishes in the centre: Schwarz's lemma.
            let within = (size + bend).max(0.5);
            return length * (size + bend) - power * 2.0 * libm::log(1.0 - within) / within;
        }
        match size - bend {
            least if least > 0.0 => (length + power * log) / least,
            _ => f64::INFINITY,
        }
    }
}

/// Distance from a point up to which psi, as continued from there, is known to be analytic.
pub(super) fn room_of_psi(psi: &Psi, z: Complex, at_split: bool) -> f64 {
    let rooms = psi.parts().iter().map(|part| part.potential.room(z - part.middle, at_split));
    rooms.fold(f64::INFINITY, f64::min)
}

impl Potential {
    fn room(&self, z: Complex, at_split: bool) -> f64 {
        let mut room = f64::INFINITY;
        for &vertex in &self.vertices {
            let away = (vertex - z).norm();
            if !(at_split && away < TOUCHES) {
                room = room.min(away);
            }
        }
        for jump in self.jumps.iter().filter(|jump| jump.arc.curve.curvature > 0.0) {
            let size = jump.arc.curve.polar(z).nu.norm();
            // Inside the circle up to it, or up to its centre.
            let part = if size < 1.0 - 1e-9 { size.max(1.0 - size) } else { size };
            room = room.min(part / jump.arc.curve.curvature);
        }
        room
    }
}

#[cfg(test)]
mod tests;
