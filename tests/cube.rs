//! Solvers on the cube: accuracy, agreement, cost in work units, robustness.

#[path = "problems/cube.rs"]
mod problems;

use problems::{exact_load, stress_loads};
use signorini::cube::{Exact, Grid, errors, kkt};
use signorini::fast::StopReason;
use signorini::fast::active_set::ActiveSetParams;
use signorini::fast::cube::{Multigrid, active_set, multigrid};
use signorini::fast::multigrid::{Goal, MultigridParams, Outcome};

fn run(n: usize, load: &[f64], goal: Goal) -> (Vec<f64>, Outcome) {
    let params = MultigridParams { goal, ..Default::default() };
    multigrid(n, load, None, &params, |_| {}).expect("valid load")
}

#[test]
fn explore() {
    let n: usize = std::env::var("N").map_or(32, |n| n.parse().unwrap());
    let mut w = Multigrid::new(n).unwrap();
    println!("bytes {}", w.bytes() as f64 / (n + 1).pow(3) as f64);
    let exact = Exact::ALL.map(|p| (p.name(), exact_load(p, n), Some(p)));
    for (name, load, p) in
        exact.into_iter().chain(stress_loads(n).into_iter().map(|(a, b)| (a, b, None)))
    {
        print!("{name:14}");
        let mut ys = vec![];
        for goal in [Goal::RoundingFloor, Goal::Kkt(1e-10), Goal::DiscretisationError] {
            let params = MultigridParams { goal, ..Default::default() };
            let mut history = vec![];
            let t = std::time::Instant::now();
            let o = w.solve(&load, None, &params, |p| history.push(p.kkt)).unwrap();
            let mut y = vec![0.0; load.len()];
            w.write_solution(&mut y);
            let r = kkt(Grid::new(n).unwrap(), &y, &load);
            print!(
                " | {:?} {} cyc {:.1} WU {:.2}s kkt {:.1e} true {:.1e}",
                o.stop,
                o.cycles,
                o.work_units,
                t.elapsed().as_secs_f64(),
                o.kkt,
                r.natural
            );
            if goal == Goal::RoundingFloor {
                let rates: Vec<_> =
                    history.windows(2).map(|w| format!("{:.2}", w[1] / w[0])).collect();
                print!(" [{}]", rates[..rates.len().min(8)].join(" "));
            }
            ys.push(y);
        }
        if let Some(p) = p {
            let grid = Grid::new(n).unwrap();
            let e = errors(grid, p, &ys[0]);
            let d: f64 = ys[0]
                .iter()
                .zip(&ys[2])
                .zip(grid.indices())
                .map(|((a, b), i)| grid.share(i) * (a - b).powi(2))
                .sum::<f64>()
                .sqrt()
                * grid.h().powf(1.5);
            let diff: Vec<_> = ys[0].iter().zip(&ys[2]).map(|(a, b)| a - b).collect();
            let h1 = (2.0 * signorini::cube::energy(grid, &diff, &vec![0.0; diff.len()])).sqrt();
            print!(
                " errors {:.3e} {:.3e} {:.3e}; algebraic/discretisation l2 {:.3} h1 {:.4}",
                e.l2,
                e.h1,
                e.max,
                d / e.l2,
                h1 / e.h1
            );
        }
        println!();
    }
    println!("bytes {}", w.bytes() as f64 / (n + 1).pow(3) as f64);
}
