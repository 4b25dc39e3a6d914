//! Work units and time per unknown of multigrid, in a workspace that is there:
//!
//! `cargo bench --bench multigrid -- [THREADS] [REPEATS] [N ...]` on all problems, beside a plain red-black sweep,
//! and with `--f F TOLERANCE` on one, to that KKT residual over the largest load, as JSON: the solution alone, and
//! from f to the solution.

#[path = "../tests/suite/hard_loads.rs"]
mod hard_loads;

use signorini_mathematics::discrete::end::End;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::kkt::judge;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::machine::memory::LargePages;
use signorini_mathematics::multigrid::{Goal, MultigridParams};
use signorini_mathematics::problem::exact::Exact;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::square::load::load;
use signorini_mathematics::square::multigrid::{Multigrid, solve_square};
use std::time::Instant;

/// As the program has it.
#[global_allocator]
static ALLOCATOR: LargePages = LargePages { refused: None };

const GOALS: [Goal; 3] = [Goal::DiscretisationError, Goal::Kkt(1e-10), Goal::RoundingFloor];

fn main() {
    let args: Vec<_> = std::env::args().skip(1).collect();
    let (args, one) = match args.iter().position(|arg| arg == "--f") {
        Some(at) => (&args[..at], Some(&args[at + 1..])),
        None => (&args[..], None),
    };
    let numbers: Vec<usize> = args.iter().filter_map(|arg| arg.parse().ok()).collect();
    let (threads, numbers) = numbers.split_first().unwrap_or((&1, &[]));
    let (repeats, sizes) = numbers.split_first().unwrap_or((&5, &[64, 256, 1024]));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(*threads).build_global();
    pool.expect("the first to ask for threads");
    match one {
        Some([f, tolerance, ..]) => {
            let tolerance = tolerance.parse().expect("--f F TOLERANCE: a number");
            sizes.iter().for_each(|&n| one_problem(n, f, tolerance, *repeats));
        }
        Some(_) => panic!("--f F TOLERANCE"),
        None => all_problems(sizes, *repeats),
    }
}

/// Median time in nanoseconds per unknown, and the outcome.
fn time(workspace: &mut Multigrid, load: &[f64], goal: Goal, repeats: usize) -> (f64, End) {
    let params = MultigridParams { goal, ..MultigridParams::default() };
    let mut y = vec![0.0; load.len()];
    median(repeats, || {
        let start = Instant::now();
        let outcome = workspace.solve(Law::SIGNORINI, load, &params).expect("a solvable problem");
        workspace.write_solution(&mut y);
        (1e9 * start.elapsed().as_secs_f64() / load.len() as f64, outcome)
    })
}

/// The run of median time.
fn median<T: Copy>(repeats: usize, run: impl FnMut() -> (f64, T)) -> (f64, T) {
    let mut runs: Vec<_> = std::iter::repeat_with(run).take(repeats.max(1)).collect();
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    runs[runs.len() / 2]
}

fn one_problem(n: usize, f: &str, tolerance: f64, repeats: usize) {
    let grid = Grid::new(n).expect("fine enough");
    let f: Source = f.parse().expect("a valid f");
    let given = load(grid, &f, LoadRule::default());
    let largest = given.iter().fold(0.0_f64, |largest, f| largest.max(f.abs()));
    let goal = Goal::Kkt(tolerance * largest);
    let mut workspace = Multigrid::square(n).expect("a power of two times 1, 3, 5 or 7");
    let (ns, _) = time(&mut workspace, &given, goal, repeats);
    let mut y = vec![0.0; given.len()];
    workspace.write_solution(&mut y);
    let whole_ns = median(repeats, || {
        let start = Instant::now();
        let load = load(grid, &f, LoadRule::default());
        let params = MultigridParams { goal, ..MultigridParams::default() };
        solve_square(n, Law::SIGNORINI, &load, &params).expect("a solvable problem");
        (1e9 * start.elapsed().as_secs_f64() / load.len() as f64, ())
    });
    let kkt = judge((grid, Law::SIGNORINI), &y, &given).kkt.relative;
    println!("{{\"ns\": {ns}, \"whole_ns\": {}, \"kkt\": {kkt:e}}}", whole_ns.0);
}

/// Names and f of the paper's problems, from their scenes.
fn paper_problems() -> Vec<(String, String)> {
    let scenes = [
        ("problem 1", include_str!("../pipeline/scenes/problem1.toml")),
        ("problem 2", include_str!("../pipeline/scenes/problem2.toml")),
    ];
    let named = scenes.map(|(name, text)| {
        let f = text.lines().find_map(|line| line.strip_prefix("f = \"")?.strip_suffix('"'));
        (name.to_owned(), f.expect("a scene with an f").to_owned())
    });
    named.into()
}

fn all_problems(sizes: &[usize], repeats: usize) {
    println!("{} thread(s), median of {repeats} runs", rayon::current_num_threads());
    println!("work units, cycles, ns per unknown for three goals:");
    println!("{:>6} {:14} {:?}", "1/h", "problem", GOALS);
    println!("per work unit to the discretisation error, over a plain sweep: the last column");
    let paper = paper_problems();
    for &n in sizes {
        let grid = Grid::new(n).expect("fine enough");
        let mut workspace = Multigrid::square(n).expect("a power of two times 1, 3, 5 or 7");
        let exact = Exact::ALL
            .map(|exact| (exact.name(), load(grid, &Source::from(exact), LoadRule::default())));
        let bilinear = |f: &str| load(grid, &f.parse().expect("a valid f"), LoadRule::Bilinear {});
        let paper = paper.iter().map(|(name, f)| (&name[..], bilinear(f)));
        let others = paper.chain(hard_loads::stress_loads(n));
        let plain = plain_ns(n, &exact[0].1, repeats);
        println!("{n:6} plain red-black sweep: {plain:.3} ns per unknown, one thread");
        for (name, load) in exact.into_iter().chain(others) {
            print!("{n:6} {name:14}");
            let runs = GOALS.map(|goal| time(&mut workspace, &load, goal, repeats));
            for (ns, outcome) in runs {
                print!("  {:5.1} {:2} {ns:5.1}", outcome.work_units, outcome.iterations);
            }
            let (ns, outcome) = runs[0];
            println!("  {:5.2}", ns / outcome.work_units / plain);
        }
    }
}

/// Median time of a plain sweep in nanoseconds per unknown.
fn plain_ns(n: usize, load: &[f64], repeats: usize) -> f64 {
    const SWEEPS: usize = 20;
    let mut y = vec![0.0; load.len()];
    let (ns, ()) = median(repeats, || {
        let start = Instant::now();
        (0..SWEEPS).for_each(|_| plain_sweep(n, &mut y, load));
        (1e9 * start.elapsed().as_secs_f64() / (SWEEPS * load.len()) as f64, ())
    });
    ns
}

/// A sweep of projected red-black Gauss-Seidel as textbooks have it: one array in natural order, mirrored at the
/// boundary, `load` that of the mirrored stencil.
fn plain_sweep(n: usize, y: &mut [f64], load: &[f64]) {
    let mirrored = |i: usize| [if i > 0 { i - 1 } else { 1 }, if i < n { i + 1 } else { n - 1 }];
    for colour in 0..2 {
        for (j, load) in load.chunks_exact(n + 1).enumerate() {
            let ([below, above], row) = (mirrored(j).map(|j| j * (n + 1)), j * (n + 1));
            let first = (j + colour) % 2;
            let on_boundary = |y: &mut [f64], i: usize| {
                let ([west, east], across) = (mirrored(i), y[below + i] + y[above + i]);
                y[row + i] = (0.25 * (load[i] + (y[row + west] + y[row + east]) + across)).max(0.0);
            };
            if j == 0 || j == n {
                (first..=n).step_by(2).for_each(|i| on_boundary(y, i));
                continue;
            }
            if first == 0 {
                on_boundary(y, 0);
                on_boundary(y, n);
            }
            let (below, rest) = y[below..].split_at_mut(n + 1);
            let (own, above) = rest.split_at_mut(n + 1);
            // In pairs, a node of this colour and its neighbour to the east: no index is checked in the loop.
            let start = 2 - first;
            let mut west = own[start - 1];
            let [load, below, above] =
                [load, below, &above[..n + 1]].map(|row| row[start..].as_chunks::<2>().0);
            let own = own[start..].as_chunks_mut::<2>().0;
            for (((own, load), below), above) in own.iter_mut().zip(load).zip(below).zip(above) {
                own[0] = 0.25 * (load[0] + (west + own[1]) + (below[0] + above[0]));
                west = own[1];
            }
        }
    }
}
