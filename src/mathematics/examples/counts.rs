//! A row of the paper's Table 1: the method of Arrow and Hurwicz on five nested grids, each stopped by the rule that
//! gives the published counts.
//!
//! `cargo run --release -p signorini-mathematics --example counts`

use signorini_mathematics::discrete::grid::nested;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::StopRule;
use signorini_mathematics::solvers::{SaddleSettings, Settings, Solver, solve};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let f = "quadrant(ll)=3; else=-1.002".parse()?;
    let grids = nested(&[4, 8, 16, 32, 64])?;
    let problem = Problem::on_square(grids, f, LoadRule::default(), Law::SIGNORINI)?;
    let saddle = SaddleSettings { r: 10.0, stop: StopRule::Signed, ..SaddleSettings::default() };
    let run = solve(&problem, &Settings { saddle, ..Settings::of(Solver::ArrowHurwicz) })?;
    let counts: Vec<_> = run.ends.iter().map(|end| end.end.iterations).collect();
    println!("r = 10: {counts:?} iterations on the grids 1/4 to 1/64");
    let published = [1, 2, 10, 41, 150];
    assert_eq!(counts, published);
    Ok(())
}
