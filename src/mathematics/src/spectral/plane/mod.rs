//! True solution on any domain of the plane with straight and circular sides.

#![expect(missing_docs, unused, clippy::todo, reason = "bodies follow")]

mod domain;
mod frame;
mod on_mesh;
mod outline;
mod regions;
mod start;

use crate::mesh::Condition;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::problem::text::plain;
use std::fmt;

pub use domain::{Circle, PlaneDomain, PlaneSide, SidePlace};
pub(crate) use on_mesh::{PlaneTruth, check_on_mesh, solve_on_mesh};

/// Right-hand side of a domain in the plane.
#[derive(Clone, Debug)]
pub enum PlaneSource {
    /// Constant pieces.
    Pieces(Source),
    /// A polynomial.
    Polynomial(Polynomial),
    /// Constant values on regions.
    Regions(Regions),
}

/// Polynomial in x and y that takes the place of a formula.
#[derive(Clone, Debug)]
pub struct Polynomial {
    /// Largest difference from the formula seen, over the largest value; of rounding if the formula is a polynomial.
    pub error: f64,
}

impl Polynomial {
    /// Polynomial that takes the place of a smooth function on a domain; look at its `error`.
    pub fn fitted(f: impl Fn([f64; 2]) -> f64, domain: &PlaneDomain) -> Self {
        todo!()
    }
}

/// Constant values on regions with straight or circular borders.
#[derive(Clone, Debug)]
pub struct Regions {
    /// Borders between regions inside of the domain, each once: the condition and part of the side are not used.
    pub borders: Vec<RegionBorder>,
    /// A point inside of the domain, and f there.
    pub known: ([f64; 2], f64),
}

/// Border between two regions.
#[derive(Clone, Copy, Debug)]
pub struct RegionBorder {
    pub side: PlaneSide,
    /// f on the left and on the right.
    pub values: [f64; 2],
}

/// Problem on a domain of the plane.
#[derive(Clone, Debug)]
pub struct PlaneProblem {
    pub domain: PlaneDomain,
    pub law: Law,
    pub source: PlaneSource,
}

/// Contact set with which Newton's method begins, loop by loop.
#[derive(Clone, Debug, Default)]
pub struct PlaneStart {
    pub loops: Vec<LoopStart>,
}

/// Arcs of a loop that stick. What it says of fixed and free sides is not read.
#[derive(Clone, Debug, Default)]
pub struct LoopStart {
    /// Beginning and end of each arc in walking order.
    pub arcs: Vec<[SidePlace; 2]>,
    /// Flux dv/dn on the gap after each arc, an end of the law. Without arcs: none if all of the loop sticks, one if
    /// nothing does.
    pub gaps: Vec<f64>,
}

/// Two bounds of the energy.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneBracket {
    pub lower: f64,
    pub upper: f64,
    /// What the bounds rest on that is not proved, each with the word `sampled`; none if they are guaranteed.
    pub reserve: Vec<String>,
}

/// Arc of the boundary that sticks.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneArc {
    /// Number of its loop.
    pub ring: usize,
    /// Beginning and end in walking order.
    pub ends: [SidePlace; 2],
    /// The same as points.
    pub points: [[f64; 2]; 2],
    /// True if it is all of the loop.
    pub closed: bool,
    /// Integral of dv/dn.
    pub force: f64,
}

/// Conditions that must hold of a solution and were not used to find it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PlaneChecks {
    /// Largest |v| where v = 0, between the rows, over the size of v and psi.
    pub residual: f64,
    /// Integral of dv/dn plus that of f, over the integral of |f|.
    pub balance: f64,
    /// Least room of the flux in the law where it holds, over the mean of |dv/dn|.
    pub flux: f64,
    /// Least v of the right sign on the gaps, over the size of v and psi.
    pub sign: f64,
    /// Distance of the bounds over the energy.
    pub bracket: f64,
}

/// True solution.
pub struct PlaneSolution {
    pub energy: f64,
    pub bracket: PlaneBracket,
    pub arcs: Vec<PlaneArc>,
    /// Integral of dv/dn over the parts where the law holds.
    pub force: f64,
    /// Integral of f over the domain.
    pub integral: f64,
    pub checks: PlaneChecks,
    pub unknowns: usize,
    pub rows: usize,
    pub steps: usize,
}

/// Reason for which there is no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlaneError {
    /// The domain is not as said.
    #[error("{0}")]
    Domain(String),
    /// f is not one that is served.
    #[error("{0}")]
    Source(String),
    /// The contact set was not found, or a check failed.
    #[error("{0}")]
    NotFound(String),
}

impl PlaneError {
    /// True if the input is the reason, and not that no solution was found.
    pub fn is_of_input(&self) -> bool {
        !matches!(self, Self::NotFound(_))
    }
}

impl fmt::Display for PlaneChecks {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { residual, balance, flux, sign, bracket } = self;
        write!(
            out,
            "v where it is zero {residual:.1e}, balance {balance:.1e}, least room of the flux {}, least v {}, bounds \
             apart by {bracket:.1e}",
            plain(*flux, 2),
            plain(*sign, 2)
        )
    }
}

/// Solves a problem from a contact set.
///
/// # Errors
/// [`PlaneError`], with a sentence for the user.
pub fn solve(problem: &PlaneProblem, start: &PlaneStart) -> Result<PlaneSolution, PlaneError> {
    todo!()
}

impl PlaneSolution {
    /// v at a point of the closed domain.
    pub fn value(&self, point: [f64; 2]) -> f64 {
        todo!()
    }

    /// v at many points, side by side.
    pub fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        todo!()
    }

    /// Gradient of v at a point of the domain.
    pub fn gradient(&self, point: [f64; 2]) -> [f64; 2] {
        todo!()
    }

    /// v and dv/dn at a point of the boundary.
    pub fn on_boundary(&self, ring: usize, place: SidePlace) -> [f64; 2] {
        todo!()
    }
}
