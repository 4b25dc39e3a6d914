//! Data that do not depend on the contact set, and the levels of resolution.

use crate::problem::complex::Complex;
use crate::spectral::error::PlaneError;
use crate::spectral::geometry::boundary::Walk;
use crate::spectral::geometry::curve::beside;
use crate::spectral::geometry::domain::PlaneDomain;
use crate::spectral::geometry::images::{Image, MedialDisc, images, medial_discs};
use crate::spectral::problem::PlaneProblem;
use crate::spectral::source::jumps::PlaneJumps;

/// Data of a problem.
pub(crate) struct Setup {
    pub domain: PlaneDomain,
    pub jumps: PlaneJumps,
    pub images: Vec<Image>,
    /// Middle of the box round the domain.
    pub centre: Complex,
    pub diameter: f64,
    pub perimeter: f64,
    /// Discs outside of the domain between parts of the boundary that lie before each other, as in a slot.
    pub medial: Vec<MedialDisc>,
}

/// Resolution.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level {
    /// Ratio of the lengths of cuts.
    pub ratio: f64,
    /// Least number of cuts where powers are fractions, and number of cuts elsewhere.
    pub strong: usize,
    pub weak: usize,
    /// Most cuts of an image.
    pub image: usize,
    /// Degree of the polynomials.
    pub degree: usize,
    /// Powers of holes.
    pub hole: usize,
    /// Poles on the medial axis outside of the domain, per radius of the discs there; zero for none.
    pub poles: f64,
    /// Gauss points of a panel.
    pub nodes: usize,
    /// Step of the ends, in perimeters, below which they are found.
    pub found: f64,
    /// Size below which steps that no longer fall are at rest.
    pub noise: f64,
    /// Errors of checks with which no finer level is tried.
    pub enough: f64,
}

impl Level {
    /// Level on which Newton's method begins.
    pub(crate) const COARSE: Self = Self {
        ratio: 6.0,
        strong: 4,
        weak: 2,
        image: 2,
        degree: 12,
        hole: 8,
        poles: 2.0,
        nodes: 5,
        found: 1e-5,
        noise: 1e-3,
        enough: 3e-10,
    };
    /// First of the levels on which the solution is checked.
    const FIRST: Self = Self {
        ratio: 3.0,
        strong: 4,
        weak: 4,
        image: 4,
        degree: 22,
        hole: 12,
        poles: 3.5,
        nodes: 6,
        found: 1e-7,
        noise: 1e-6,
        enough: 1e-12,
    };
    /// All of them, in turn.
    pub(crate) const FINE: [Self; 3] = [
        Self::FIRST,
        Self {
            ratio: 2.2,
            strong: 5,
            weak: 5,
            image: 5,
            degree: 32,
            hole: 16,
            poles: 4.5,
            enough: 3e-10,
            ..Self::FIRST
        },
        Self {
            ratio: 1.8,
            strong: 6,
            weak: 6,
            image: 6,
            degree: 44,
            hole: 24,
            poles: 6.0,
            enough: 3e-10,
            ..Self::FIRST
        },
    ];
}

impl Setup {
    pub(crate) fn new(problem: &PlaneProblem) -> Result<Self, PlaneError> {
        let PlaneProblem { domain, source } = problem;
        let jumps = PlaneJumps::new(domain, source)?;
        let diameter = domain.diameter();
        Ok(Self {
            images: images(domain, &jumps.singular, diameter),
            centre: domain.centre(),
            perimeter: domain.perimeter(),
            domain: domain.clone(),
            jumps,
            diameter,
            medial: medial_discs(domain),
        })
    }

    /// Sets f beside the intervals of a walk: on each loop from f beside the interval that is farthest from jumps.
    pub(crate) fn set_f(&self, walk: &mut Walk) {
        for ring in 0..self.domain.rings.len() {
            let mut farthest = (-1.0, 0, Complex::default());
            for (k, own) in walk.intervals.iter().enumerate().filter(|(_, own)| own.ring == ring) {
                let spot = walk.spot(k, 0, 0.4142 * own.length, 0.0);
                let room = self.jumps.distances(spot.z).fold(0.5 * own.length, f64::min);
                if room > farthest.0 {
                    let at = [spot.z, spot.tangent.turned()];
                    let [inside, _] = beside(at, 5e-7, [room].into_iter());
                    farthest = (room, k, inside);
                }
            }
            let (_, known, z) = farthest;
            walk.set_f(ring, known, self.jumps.psi.source(z));
        }
    }
}
