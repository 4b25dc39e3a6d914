//! The semicoercive scalar Signorini problem and its relatives: discretisation, solvers, true solutions, guaranteed
//! bounds.
//!
//! A membrane v over a domain in the plane or in space solves `-Laplacian v = f`. On the boundary a [law](problem::law)
//! relates v to its flux dv/dn: in the paper `v >= 0`, `dv/dn >= 0`, `v dv/dn = 0`, under friction `|dv/dn| <= g`.
//! Nothing holds the membrane but the boundary, so that there is a solution only if the flux can balance f: in the
//! paper, if the integral of f is negative. See N. N. Maksimova, *A study of the semicoercive scalar Signorini problem
//! by the Arrow-Hurwicz method*.
//!
//! | to | use |
//! | --- | --- |
//! | say what is asked as plain data, as scenes and options do | [`statement::Statement`] |
//! | state a problem, and check that it has a solution | [`levels::Problem`] |
//! | solve it by any solver, as the program does | [`solvers::solve`], [`solvers::SOLVERS`] |
//! | know how far a nodal vector is from the discrete solution | [`levels::Problem::judge`] |
//! | know how far it is from the true solution, guaranteed | [`levels::Problem::bounds`] |
//! | read a mesh of Gmsh, or take a built-in one | [`mesh::gmsh::read`], [`mesh::AnyMesh::built_in`] |
//! | read the paper's method as the paper writes it | [`saddle::Plain`] |
//! | solve many loads on one grid of the square | [`square::multigrid::Multigrid`] |
//! | have the true solution on a domain in the plane | [`levels::Problem::true_solution`] |
//! | know v and its gradient at a point | [`solvers::Solved::values_at`], [`levels::Problem::values_at`] |
//! | write files for NumPy, ParaView | [`levels::Problem::npz`], [`levels::Problem::vtk`] of [`solvers::Run::pair`] |
//!
//! Four programs in the folder `examples`, each run by `cargo run --release -p signorini-mathematics --example NAME`:
//! `counts.rs` repeats a row of the tables, `friction.rs` solves on a disc with bounds, `adapted.rs` refines the
//! L-shape to an accuracy and makes files, `truth.rs` has the true solution beside the discrete one.
//!
//! On the square:
//!
//! ```
//! use signorini_mathematics::discrete::grid::nested;
//! use signorini_mathematics::discrete::load::LoadRule;
//! use signorini_mathematics::levels::Problem;
//! use signorini_mathematics::problem::law::Law;
//! use signorini_mathematics::solvers::{Settings, Solver, solve};
//!
//! let f = "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1".parse()?;
//! let grids = nested(&[32, 64, 128])?;
//! let problem = Problem::on_square(grids, f, LoadRule::Bilinear {}, Law::SIGNORINI)?;
//! let run = solve(&problem, &Settings::of(Solver::Multigrid))?;
//! assert!(run.judgement.kkt.relative < 1e-10);
//! let [low, high] = problem.bounds(&run.y)?.energy;
//! let truth = problem.true_solution()?;
//! assert!(low <= truth.energy && truth.energy <= high);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! On a mesh, fixed on a part of its boundary:
//!
//! ```
//! use signorini_mathematics::levels::Problem;
//! use signorini_mathematics::mesh::AnyMesh;
//! use signorini_mathematics::problem::law::Law;
//! use signorini_mathematics::solvers::{Settings, Solver, solve};
//!
//! let mut ring = AnyMesh::built_in("annulus").expect("a built-in domain");
//! ring.set_law("inner", Law::FIXED)?;
//! let problem = Problem::on_mesh(&ring, 3, "halfplane(1,0,0)=2; else=-1")?;
//! let [by_multigrid, by_the_active_set] = [Solver::Multigrid, Solver::ActiveSet]
//!     .map(|solver| solve(&problem, &Settings::of(solver)).map(|run| run.judgement.energy));
//! assert!((by_multigrid? / by_the_active_set? - 1.0).abs() < 1e-10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With friction, where f may have any integral that the flux can balance:
//!
//! ```
//! use signorini_mathematics::levels::{Problem, ProblemError};
//! use signorini_mathematics::mesh::AnyMesh;
//! use signorini_mathematics::problem::law::Law;
//! use signorini_mathematics::solvers::{Settings, Solver, solve};
//!
//! let disc = AnyMesh::built_in("disc").expect("a built-in domain").with_law(Law::friction(0.8)?);
//! let problem = Problem::on_mesh(&disc, 4, "disc(0.3,0,0.4)=5; else=-1")?;
//! let run = solve(&problem, &Settings::of(Solver::Multigrid))?;
//! assert!(run.judgement.flux.iter().zip(&run.judgement.contact).all(|(flux, contact)| {
//!     flux.abs() <= 0.8 * contact.measure * (1.0 + 1e-9)
//! }));
//! let refused = Problem::on_mesh(&disc, 4, "else=2");
//! assert!(matches!(refused, Err(ProblemError::Unsolvable(_))));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bounds;
pub mod discrete;
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
pub mod square;
pub mod statement;
