//! Smooth functions in closed form: a polynomial and waves, which are sines, cosines and exponentials of linear
//! functions and products of these. f is one, with psi, and so is the value of a law.

pub(in crate::spectral) mod real_polynomial;

use crate::problem::complex::Complex;
use crate::problem::formula::Unary;
use real_polynomial::RealPolynomial;

/// `Re(c exp(a z + b conj(z)))`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave {
    pub c: Complex,
    /// a and b.
    pub exponents: [Complex; 2],
}

impl Wave {
    /// Function of `constant + Re(slope z)`; none if that is no wave.
    pub(crate) fn of(function: Unary, constant: f64, slope: Complex) -> Option<Self> {
        let half = slope.scaled(0.5);
        let (plain, phase) = ([half, half.conj()], Complex::unit(constant));
        match function {
            Unary::Exp => {
                Some(Self { c: Complex::new(libm::exp(constant), 0.0), exponents: plain })
            }
            Unary::Cos => Some(Self { c: phase, exponents: plain.map(Complex::turned) }),
            Unary::Sin => Some(Self { c: -phase.turned(), exponents: plain.map(Complex::turned) }),
            _ => None,
        }
    }

    /// The two waves of a product: `Re a Re b = 1/2 Re(a b) + 1/2 Re(a conj b)`.
    pub(crate) fn times(self, other: Self) -> [Self; 2] {
        let [[a, b], [d, e]] = [self.exponents, other.exponents];
        let half = self.c.scaled(0.5);
        [
            Self { c: half * other.c, exponents: [a + d, b + e] },
            Self { c: half * other.c.conj(), exponents: [a + e.conj(), b + d.conj()] },
        ]
    }

    /// The function without `Re`.
    fn at(self, z: Complex) -> Complex {
        let [a, b] = self.exponents;
        let power = a * z + b * z.conj();
        self.c * Complex::unit(power.im).scaled(libm::exp(power.re))
    }

    /// Bound of the rate at which it changes, over its modulus.
    pub(crate) fn rate(self) -> f64 {
        self.exponents.map(Complex::norm).iter().sum()
    }

    /// Bound of the modulus for |z| up to a radius.
    fn size(self, radius: f64) -> f64 {
        let [a, b] = self.exponents;
        self.c.norm() * libm::exp((a + b.conj()).norm() * radius)
    }
}

/// Polynomial and waves.
#[derive(Clone, Debug, Default)]
pub(crate) struct Smooth {
    pub polynomial: RealPolynomial,
    pub waves: Vec<Wave>,
}

impl Smooth {
    /// A number.
    pub(crate) fn constant(value: f64) -> Self {
        let polynomial = RealPolynomial::harmonic(vec![Complex::new(value, 0.0)]);
        Self { polynomial, waves: Vec::new() }
    }

    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.polynomial = self.polynomial.weighted(|_, _| factor);
        self.waves.iter_mut().for_each(|wave| wave.c = wave.c.scaled(factor));
        self
    }

    /// Adds a wave, to one with the same exponents if there is; returns a bound of the modulus of what is rounded, for
    /// |z| up to a radius.
    pub(crate) fn add(&mut self, own: Wave, radius: f64) -> f64 {
        let [a, b] = own.exponents;
        let turned = Wave { c: own.c.conj(), exponents: [b.conj(), a.conj()] };
        for same in [own, turned] {
            if let Some(wave) = self.waves.iter_mut().find(|wave| wave.exponents == same.exponents)
            {
                wave.c = wave.c + same.c;
                return wave.size(radius);
            }
        }
        self.waves.push(own);
        0.0
    }

    /// Makes polynomials of waves that are long beside a radius, which would have a large psi; returns a bound of the
    /// error by that on the disc.
    pub(crate) fn settle(&mut self, radius: f64) -> f64 {
        /// Degree of the polynomials, and largest power of e in a wave for which that has all digits.
        const DEGREE: usize = 16;
        const LONG: f64 = 0.5;
        let mut error = 0.0;
        let (long, short): (Vec<Wave>, _) =
            self.waves.iter().partition(|wave| wave.rate() * radius < LONG);
        self.waves = short;
        for wave in long {
            // The term of a^j b^k over j! k!.
            let mut first = wave.c;
            for j in 0..=DEGREE {
                let mut term = first;
                for k in 0..=DEGREE - j {
                    let coefficient = self.polynomial.at(j.min(k), j.abs_diff(k));
                    *coefficient = *coefficient + if j < k { term.conj() } else { term };
                    term = term * wave.exponents[1].scaled(1.0 / (k + 1) as f64);
                }
                first = first * wave.exponents[0].scaled(1.0 / (j + 1) as f64);
            }
            // The first power that is missing is 1e-19 of it, and each term is rounded in its products.
            error += 1e2 * f64::EPSILON * wave.c.norm();
        }
        error
    }

    /// Value at a point.
    pub(crate) fn value(&self, z: Complex) -> f64 {
        self.waves.iter().fold(self.polynomial.value(z), |sum, wave| sum + wave.at(z).re)
    }

    /// Gradient at a point.
    pub(crate) fn gradient(&self, z: Complex) -> Complex {
        self.waves.iter().fold(self.polynomial.gradient(z), |sum, wave| {
            let (own, [a, b]) = (wave.at(z), wave.exponents);
            sum + (a * own).conj() + b * own
        })
    }

    /// Bound of the modulus for |z| up to a radius.
    pub(crate) fn size(&self, radius: f64) -> f64 {
        self.polynomial.size(radius) + self.waves.iter().map(|wave| wave.size(radius)).sum::<f64>()
    }

    /// Bounds of the modulus and of the gradient, in complex coordinates with z and conj(z) that near to a centre and
    /// its conjugate.
    pub(crate) fn moduli(&self, centre: Complex, radius: f64) -> [f64; 2] {
        let far = centre.norm() + radius;
        let slope = self.polynomial.weighted(|k, m| (2 * k + m) as f64).size(far) / far;
        let mut moduli = [self.polynomial.size(far), if far > 0.0 { slope } else { 0.0 }];
        for wave in &self.waves {
            let size = wave.at(centre).norm() * libm::exp(wave.rate() * radius);
            moduli[0] += size;
            moduli[1] += wave.rate() * size;
        }
        moduli
    }

    /// Largest rate of a wave.
    pub(crate) fn rate(&self) -> f64 {
        self.waves.iter().fold(0.0, |most, wave| wave.rate().max(most))
    }

    /// Units in the last place, over the bounds of moduli in real coordinates, by which values are off for |z| up to a
    /// radius.
    pub(crate) fn units(&self, radius: f64) -> f64 {
        8.0 + 2.0 * self.polynomial.degree() as f64 + 4.0 * self.rate() * radius
    }
}
