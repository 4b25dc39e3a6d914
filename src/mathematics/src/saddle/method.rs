//! Saddle-point methods on one grid, in two alternating steps.
//!
//! 1. Minimise M(., a) of (7) over y, for a fixed multiplier a, by Gauss-Seidel sweeps (9)-(11).
//! 2. Update the multiplier by (12), and evaluate the stopping rule.
//!
//! Uzawa's algorithm sweeps in step 1 until the gradient of M(., a) is small (the paper's references use gradient
//! descent there). The paper's method sweeps once: Arrow-Hurwicz is Uzawa's algorithm with one inner sweep. The sweep
//! is the unit in which all methods are compared.
//!
//! Requirements: r > 0, and a load vector with negative sum. M(., a) then has a minimum: as the constant part of y
//! grows, M grows at least linearly, and as it falls, quadratically. M(., a) is not strongly convex: while
//! `r y >= a` at every boundary node its Hessian is the singular matrix A, and a sweep only moves y down by `h^2 / 2`
//! times the sum of F. If F sums to zero or more, M(., a) has no minimum: y grows without bound, and the run ends at
//! the limit on sweeps. With the proximal term each inner problem has a minimum for every F, and the sequence y^k grows
//! instead.
//!
//! References: N. N. Maksimova, equations (7)-(13), with the misprints corrected as in the book.
//! D. Bertsekas, Constrained Optimization and Lagrange Multiplier Methods, for Uzawa's algorithm;
//! R. V. Namm and A. S. Tkachenko, Izv. vuzov. Matematika, 2010, no. 4, for the proximal term (the
//! paper's refs 5 and 6); G. Woo, R. V. Namm, S. A. Sachkoff, Comput. Math. Math. Phys. 46 (2006) 23-33.

/// Accuracy of the minimisation over y before each step of the multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// One sweep: the paper's method.
    ArrowHurwicz,
    /// Sweeps until the gradient of M(., a), with the proximal term, is small enough.
    Uzawa {
        /// Factor c >= 0 of the added term `c / 2 ||v - v^k||^2` in L2(Omega), with the last minimiser v^k; zero for
        /// the plain algorithm. Unit: one over length squared. The mass matrix is lumped and therefore diagonal: `h^2`
        /// at interior nodes, half on edges, a quarter at corners.
        weight: f64,
        /// Bound on the absolute value of every component of the gradient, in units of F.
        inner: f64,
        /// True to relax the bound to a tenth of the gradient (8) after the last step of the multiplier (of the
        /// largest component of F before the first): a more accurate minimisation does not reduce the total work.
        loose: bool,
    },
}

impl Method {
    /// Proximal weight c.
    pub(crate) fn weight(self) -> f64 {
        match self {
            Self::ArrowHurwicz => 0.0,
            Self::Uzawa { weight, .. } => weight,
        }
    }

    /// Bound on the inner gradient after the gradient (8) was `gradient`; `None` if one sweep is enough.
    pub(crate) fn inner_bound(self, gradient: f64) -> Option<f64> {
        match self {
            Self::ArrowHurwicz => None,
            Self::Uzawa { inner, loose, .. } => {
                Some(if loose { (0.1 * gradient).max(inner) } else { inner })
            }
        }
    }

    /// The method with this bound on the inner gradient.
    pub fn with_inner(self, inner: f64) -> Self {
        match self {
            Self::ArrowHurwicz => self,
            Self::Uzawa { weight, loose, .. } => Self::Uzawa { weight, inner, loose },
        }
    }

    /// The method whose minimisations become as exact as the gradient (8) gets small.
    pub fn loose(self) -> Self {
        match self {
            Self::ArrowHurwicz => self,
            Self::Uzawa { weight, inner, .. } => Self::Uzawa { weight, inner, loose: true },
        }
    }

    /// The method whose minimisations are as exact as is of use, where the rounding errors of the inner gradient are as
    /// large as `floor`: loose, if the bound that was asked for is out of reach.
    pub(super) fn above(self, floor: f64) -> Self {
        match self {
            Self::Uzawa { weight, inner, loose } => {
                Self::Uzawa { weight, inner, loose: loose || inner < floor }
            }
            Self::ArrowHurwicz => self,
        }
    }
}
