//! The semicoercive scalar Signorini problem: Maksimova's study replicated, and what lies past it.
//!
//! Logarithms and the like come from the `libm` crate throughout: the C library's differ in the last bit
//! from one machine to the next, and artifacts are compared by hash.
//!
//! ```
//! use signorini::fast::multigrid::{MultigridParams, multigrid};
//! use signorini::grid::Grid;
//! use signorini::kkt::kkt;
//! use signorini::load::{LoadRule, load};
//! use signorini::source::Source;
//!
//! let f: Source = "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1".parse()?;
//! let grid = Grid::new(128)?;
//! let load = load(grid, &f, LoadRule::default());
//! let (y, outcome) = multigrid(128, &load, None, &MultigridParams::default(), |_| ())?;
//! assert!(kkt(grid, &y, &load).relative < 1e-10);
//! assert!(outcome.work_units < 60.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bench;
pub mod book;
pub mod cli;
pub mod cube;
pub mod draw;
pub mod error;
pub mod exact;
pub mod fast;
pub mod fields;
mod files;
pub mod grid;
pub mod identify;
pub mod kkt;
pub mod load;
pub mod machine;
pub mod norms;
pub mod paper;
pub mod pipeline;
pub mod project;
pub mod record;
pub mod saddle;
pub mod scene;
pub mod source;
pub mod stages;
pub mod stiffness;
pub mod table;
pub mod timings;
pub mod transfer;
