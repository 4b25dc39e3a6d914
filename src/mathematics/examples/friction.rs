//! Friction on a disc: the solution by multigrid, the guaranteed bracket of its energy, and where the boundary sticks.
//!
//! `cargo run --release -p signorini-mathematics --example friction`

use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::solvers::{Settings, Solver, solve};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let disc = AnyMesh::built_in("disc").expect("a built-in domain");
    let f = "disc(0.3,0,0.4)=5; else=-1";
    let problem = Problem::on_mesh(&disc.with_law(Law::friction(0.8)?), 5, f)?;
    let run = solve(&problem, &Settings::of(Solver::Multigrid))?;
    let [low, high] = problem.bounds(&run.y)?.energy;
    println!("energy {:.5}, that of the polygon in [{low:.5}, {high:.5}]", run.judgement.energy);
    let states = run.judgement.state_counts();
    println!("{} of {} boundary nodes stick", states.sticks, states.all());
    assert!(low < run.judgement.energy && high - low < 0.1);
    Ok(())
}
