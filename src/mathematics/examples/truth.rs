//! The true solution on the square beside the discrete one: energies, and v with its gradient at a point.
//!
//! `cargo run --release -p signorini-mathematics --example truth`

use signorini_mathematics::discrete::grid::nested;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::solvers::{Settings, Solver, solve};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let f = "disc(-0.25,0,0.2)=6; else=-1".parse()?;
    let grids = nested(&[64, 128, 256])?;
    let problem = Problem::on_square(grids, f, LoadRule::Bilinear {}, Law::SIGNORINI)?;
    let truth = problem.true_solution()?;
    let run = solve(&problem, &Settings::of(Solver::Multigrid))?;
    println!("energy {:.12}, on the grid 1/256 {:.12}", truth.energy, run.judgement.energy);
    let point = [0.1, 0.2];
    let (v, gradient) = truth.at(&point).ok_or("outside the square")?;
    let of_grid = &problem.values_at(&run.y, &[point.into()])[0];
    println!("v at {point:?}: {v:.10} with gradient {gradient:.6?}; on the grid {:?}", of_grid.v);
    let [low, high] = problem.bounds(&run.y)?.energy;
    assert!(low <= truth.energy && truth.energy <= high);
    assert!((of_grid.v.ok_or("outside the square")? - v).abs() < 1e-4);
    Ok(())
}
