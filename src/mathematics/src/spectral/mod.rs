//! True solution on any domain of the plane with straight and circular sides, holes, and a law on each part.
//!
//! # Method
//! `v = psi + Re g`. psi is a particular solution in closed form (`source::psi`), so that `-Lap v = f` holds exactly; g
//! is a sum of analytic functions (`functions`): at each corner, end of contact and crossing of a jump of f the
//! fractional powers and logarithms that a solution has there, with a cut of finite length outside of the domain, in a
//! ladder of lengths; logarithms at the mirror images of what is singular in psi; powers and a logarithm for each hole;
//! poles behind the sides of slots; polynomials. They are fitted to both boundary conditions by least squares (`fit`):
//! ```text
//! where v = at:         Re g = at - psi,
//! where dv/dn = q:      Im g - C = -int (psi_n - q) ds,    C one unknown for each run of such sides.
//! ```
//! That is the exact form of the singularities, so the error falls exponentially with the number of functions: ten to
//! thirteen digits of the energy with 100 to 700 unknowns.
//!
//! The ends of the arcs that stick are moved by Newton's method, one division each (`contact::newton`); where a sign is
//! wrong a gap is opened or an arc inserted (`contact::signs`), first on a coarse level, then on fine ones
//! (`contact::search`). The energy is a sum of integrals over the boundary and the jumps of f, with an error that is
//! quadratic in the residual (`proof::integrals`); two bounds follow from how the conditions are missed, which is
//! proved between points too (`proof`).
//!
//! # Rooms
//! `geometry`, `source` (f with psi), `functions`, `fit`, `contact`, `proof`. `problem` is made of one on a mesh,
//! `setup` has what does not depend on the contact set, `solution` solves on one connected domain, `truth` on all.
//!
//! # Limits
//! Work grows with the cube of the number of corners: half a second for twenty, five for forty. A contact set whose
//! signs are not all right, a residual above 2e-8 of v, or an integral of dv/dn that does not balance that of f, is
//! refused.
//!
//! # Literature
//! - A. Gopal, L. N. Trefethen, Solving Laplace problems with corner singularities via rational functions, SIAM J.
//!   Numer. Anal. 57 (2019).
//! - P. D. Brubeck, Y. Nakatsukasa, L. N. Trefethen, Vandermonde with Arnoldi, SIAM Rev. 63 (2021).

mod complex;
mod contact;
mod elementary;
mod error;
mod fit;
mod functions;
mod geometry;
mod problem;
mod proof;
mod setup;
mod smooth;
mod solution;
mod source;
mod truth;

pub use error::PlaneError;
pub use solution::{PlaneChecks, TrueSolution};
pub(crate) use truth::{check_plane, true_solution_on};
