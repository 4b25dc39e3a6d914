//! Exact solutions of the Signorini problem, for scenes that measure errors.

use std::f64::consts::PI;

/// A problem whose solution v and multiplier dv/dn are known in closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exact {
    /// v = -cos(pi x) cos(pi y): the whole boundary is in contact, the multiplier is pi cos(pi s).
    FullContact,
}

impl Exact {
    /// Every problem.
    pub const ALL: [Self; 1] = [Self::FullContact];

    /// The problem with this name, if there is one.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|exact| exact.name() == name)
    }

    /// All names, for messages.
    pub fn names() -> String {
        Self::ALL.map(Self::name).join(", ")
    }

    /// The name used in `exact(name)`.
    pub fn name(self) -> &'static str {
        match self {
            Self::FullContact => "full-contact",
        }
    }

    /// v as LaTeX.
    pub fn latex(self) -> &'static str {
        match self {
            Self::FullContact => r"v = -\cos \pi x \, \cos \pi y",
        }
    }

    /// f = -Laplacian v at (x, y).
    pub fn source(self, x: f64, y: f64) -> f64 {
        match self {
            Self::FullContact => 2.0 * PI * PI * self.solution(x, y),
        }
    }

    /// v at (x, y).
    ///
    /// Sines and cosines come from `libm`, so that results do not depend on the machine's C library.
    pub fn solution(self, x: f64, y: f64) -> f64 {
        match self {
            Self::FullContact => -libm::cos(PI * x) * libm::cos(PI * y),
        }
    }
}
