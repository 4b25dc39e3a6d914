//! Full multigrid for the scalar problem of a law on the unit square, at optimal cost.
//!
//! # Idea
//! The finest grid is smoothed by red-black Gauss-Seidel sweeps that minimise the energy exactly at each node, under
//! the paper's law by projection to `y >= 0` on the boundary. Boundary nodes in contact, `y = 0` with the flux inside
//! the interval of the law, are then *truncated*, that is excluded from the correction, and the other nodes get a
//! linear coarse-grid correction (Kornhuber 1994; Gräser and Kornhuber 2009; Gräser, Sack and Sander 2009; the
//! projected scheme is due to Brandt and Cryer 1983). New here is the representation of the contact set on coarse
//! grids: not as a set of nodes but as intervals whose ends lie between nodes, through springs (see `springs.rs`). The
//! rate of convergence is then that of multigrid for the Poisson equation, for any contact set down to a single node.
//!
//! # Algorithm
//! 1. See the problem as one under a law `[0, limit]`, solved first without the limit; check the load, scale it by a
//!    power of two, and restrict it to every coarser grid by full weighting (`solve.rs`, `load.rs`).
//! 2. Solve the problem of the coarsest grid directly (`coarsest.rs`).
//! 3. Nested iteration (the driver): interpolate the solution to the next finer grid and apply one cycle there, or
//!    more if the residual is still large; repeat up to the finest grid.
//! 4. Apply cycles on the finest grid until the goal is reached (the driver). One cycle on a problem under the law:
//!    1. Find the boundary nodes in contact, and the springs by which coarser grids represent them (`springs.rs`).
//!    2. Restrict the residual of the nodes that are not in contact (`transfer.rs`).
//!    3. Solve the linear correction problem recursively, by an F-cycle.
//!    4. Add the interpolated correction, put the boundary nodes whose values changed sign at zero, and smooth
//!       by red-black Gauss-Seidel sweeps (`stencil.rs`).
//!
//! All half-sweeps and transfers between two visits to the coarser grid are one *pass* over the memory (`pass.rs`).
//! The central function is `find_correction` in `cycle.rs`.
//!
//! # Parameters of the algorithm
//! - Transfers are bilinear. A visit to a grid applies one sweep before and one after the coarse-grid correction,
//!   over-relaxed inside on the colour that the transfers do not read or write (Yavneh 1996).
//! - Nested iteration applies one cycle per grid, and more only where the contact set of a coarse grid is far off.
//! - From the third coarser grid on, cycles are F-cycles: near-constant modes of semicoercive problems need accurate
//!   coarse solutions, and on coarse grids these cost almost nothing. If only the discretisation error is requested,
//!   F-cycles begin on the second coarser grid, since that cycle is often the only one.
//! - Corrections by a V-cycle are too small; they are enlarged where they reach the finest grid (Brandt and Yavneh
//!   1993 enlarge the residual). That halves the rate, to 0.04 per cycle, at no cost.
//!
//! # Cost
//! Memory: values and loads of all grids, 21.3 bytes per unknown, plus padding of rows to cache lines: 21.5 in all at
//! h = 1/4096, 22.4 at 1/512.
//!
//! A *work unit* is one Gauss-Seidel sweep of the finest grid, counted by visits of unknowns on all grids: a
//! half-sweep 1/2, residual and restriction of one colour 3/4, interpolation to one colour 1/4, restriction of a load
//! 1/2, a check of all optimality conditions 1, boundary loops by the number of their nodes, direct solutions by their
//! multiplications, of which a visit has one per stencil entry. Reordering the input is not counted.
//!
//! # References
//! - A. Brandt, C. W. Cryer, Multigrid algorithms for the solution of linear complementarity problems
//!   arising from free boundary problems, SIAM J. Sci. Stat. Comput. 4 (1983).
//! - A. Brandt, I. Yavneh, Accelerated multigrid convergence and high-Reynolds recirculating flows, SIAM
//!   J. Sci. Comput. 14 (1993).
//! - R. Kornhuber, Monotone multigrid methods for elliptic variational inequalities I, Numer. Math. 69
//!   (1994).
//! - C. Gräser, R. Kornhuber, Multigrid methods for obstacle problems, J. Comput. Math. 27 (2009).
//! - C. Gräser, U. Sack, O. Sander, Truncated nonsmooth Newton multigrid methods for convex minimization
//!   problems, Domain Decomposition Methods XVIII (2009).
//! - I. Yavneh, On red-black SOR smoothing in multigrid, SIAM J. Sci. Comput. 17 (1996).
//!
//! # Easily broken
//! - Results are compared by hash between machines and numbers of threads: neither the order of additions nor the
//!   order of half-sweeps may change.
//! - Loops gain from vector instructions only if each function between `vectorised` and the loop is inlined: keep
//!   `#[inline(always)]`.
//! - Each pass must begin with a half-sweep or a transfer that does not read the red values, and a restriction must
//!   follow an exact half-sweep over the black nodes.

mod blocks;
mod coarsest;
mod cycle;
mod level;
mod load;
mod pass;
mod rows;
mod solve;
mod springs;
mod stencil;
mod transfer;
mod workspace;

pub use workspace::{Multigrid, solve_square};
