//! Work units, bytes and time per unknown of multigrid on all problems: `cargo bench --bench multigrid -- [THREADS] [REPEATS] [N ...]`.

use signorini::bench::problems;
use signorini::exact::Exact;
use signorini::fast::multigrid::{Goal, Multigrid, MultigridParams};
use signorini::grid::Grid;
use signorini::load::{LoadRule, load};
use signorini::source::Source;
use std::time::Instant;

const GOALS: [Goal; 3] = [Goal::DiscretisationError, Goal::Kkt(1e-10), Goal::RoundingFloor];

fn main() {
    let numbers: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let (threads, numbers) = numbers.split_first().unwrap_or((&1, &[]));
    let (repeats, sizes) = numbers.split_first().unwrap_or((&5, &[64, 256, 1024]));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(*threads).build_global();
    pool.expect("the first to ask for threads");
    let threads = rayon::current_num_threads();
    println!("{threads} thread(s), median of {repeats} runs");
    println!("work units, cycles, ns per unknown for three goals:");
    println!("{:>6} {:14} {:>6} {:?}", "1/h", "problem", "bytes", GOALS);
    for &n in sizes {
        let grid = Grid::new(n).expect("fine enough");
        let mut workspace = Multigrid::new(n).expect("a power of two times 1, 3, 5 or 7");
        let exact = Exact::ALL
            .map(|exact| (exact.name(), load(grid, &Source::Exact(exact), LoadRule::default())));
        let others = problems::paper_loads(n).into_iter().chain(problems::stress_loads(n));
        for (name, load) in exact.into_iter().chain(others) {
            let unknowns = grid.nodes() as f64;
            print!("{n:6} {name:14} {:6.1}", workspace.bytes() as f64 / unknowns);
            for goal in GOALS {
                let params = MultigridParams { goal, ..MultigridParams::default() };
                let mut times = Vec::new();
                let mut result = None;
                for _ in 0..*repeats {
                    let start = Instant::now();
                    result = Some(workspace.solve(&load, None, &params, |_| ()));
                    times.push(1e9 * start.elapsed().as_secs_f64() / unknowns);
                }
                times.sort_by(f64::total_cmp);
                match result {
                    Some(Ok(o)) => {
                        let median = times[times.len() / 2];
                        print!("  {:5.1} {:2} {median:5.1}", o.work_units, o.cycles);
                    }
                    Some(Err(error)) => print!("  {error}"),
                    None => {}
                }
            }
            println!();
        }
    }
}
