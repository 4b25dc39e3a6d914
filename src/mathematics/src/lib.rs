//! The semicoercive scalar Signorini problem: its discretisation, its solvers, its true solution with guaranteed bounds.
//!
//! Logarithms and the like come from the `libm` crate, in loops that vectorise from the spectral solver's own series:
//! the C library's differ in the last bit from one machine to the next, and artifacts are compared by hash.
//!
//! ```
//! use signorini_mathematics::bounds::bounds;
//! use signorini_mathematics::discrete::grid::Grid;
//! use signorini_mathematics::discrete::kkt::kkt;
//! use signorini_mathematics::discrete::load::{Diagonal, LoadRule, load};
//! use signorini_mathematics::multigrid::{self, MultigridParams};
//! use signorini_mathematics::problem::law::Law;
//! use signorini_mathematics::problem::source::Source;
//! use signorini_mathematics::spectral::{self, spectral};
//!
//! let f: Source = "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1".parse()?;
//! let grid = Grid::new(128)?;
//! // The default is the paper's rule, f at the nodes, whose sum may be positive though the integral is not.
//! let load = load(grid, &f, LoadRule::Exact { diagonal: Diagonal::default() });
//! let problem = Law::SIGNORINI.with_load(&load);
//! let (y, outcome) = multigrid::solve_square(128, problem, None, &MultigridParams::default())?;
//! assert!(kkt(grid, Law::SIGNORINI, &y, &load).relative < 1e-10);
//! assert!(outcome.work_units < 60.0);
//! let [low, high] = bounds(grid, &f, Law::SIGNORINI, &y)?.energy;
//! let truth = spectral(&f, spectral::SpectralParams::default())?;
//! assert!(low <= truth.energy && truth.energy <= high);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bounds;
pub mod discrete;
pub mod experiments;
pub mod formats;
pub mod identify;
pub mod levels;
pub mod machine;
pub mod mesh;
pub mod multigrid;
pub mod multilevel;
pub mod problem;
pub mod saddle;
pub mod solvers;
pub mod spectral;
pub mod triangulated;
