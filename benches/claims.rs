//! The paper's claims about cost, measured: Arrow-Hurwicz against Uzawa, the best r, the dual criterion.
//!
//! Costs are sweeps, which depend on no machine; one table says what a sweep costs in time here.
//! The load is the average around nodes, because under the nodal rule problem 1 sums to a positive
//! number and has no discrete solution to converge to; problem 2 has one under either rule.

use rayon::prelude::*;
use signorini::grid::{Grid, nested};
use signorini::kkt::kkt;
use signorini::load::{LoadRule, load};
use signorini::saddle::{
    Pair, Params, ProximalParams, StopReason, StopRule, UzawaOutcome, UzawaParams, arrow_hurwicz,
    on_nested, solve_nested, tolerance, uzawa, uzawa_proximal,
};
use signorini::source::Source;
use signorini::transfer::Prolongation;
use std::time::Instant;

const PROBLEMS: [&str; 2] = ["quadrant(ll)=3; else=-1.002", "quadrant(ll)=-6; else=1.998"];
const CELLS: [usize; 3] = [16, 32, 64];
/// The five values of Tables 1 and 2.
const PAPER_R: [f64; 5] = [1e6, 10.0, 5.0, 1.0, 0.5];
/// Natural KKT residuals, over the largest component of F, that every method must reach.
const TARGETS: [f64; 2] = [1e-3, 1e-6];
/// Sweeps after which a method has failed.
const CAP: usize = 400_000;

#[derive(Clone, Copy)]
enum Method {
    ArrowHurwicz,
    /// Inner gradient within a tenth of the target, always.
    Uzawa,
    /// Inner gradient reduced tenfold by each inner minimisation.
    UzawaLoose,
    /// As the two above, with the proximal term of this weight.
    Proximal(f64),
    ProximalLoose(f64),
}

/// A problem on a grid: the load vector, and the start, the coarser grid's solution prolonged.
struct Case {
    grid: Grid,
    target: f64,
    load: Vec<f64>,
    start: Pair,
    scale: f64,
}

impl Case {
    fn new(f: &Source, rule: LoadRule, cells: usize, target: f64) -> Self {
        let [coarse, grid] = [cells / 2, cells].map(|n| Grid::new(n).expect("fine enough"));
        let coarse_load = load(coarse, f, rule);
        let mut pair = Pair::zero(coarse);
        let params =
            Params { r: 100.0, tolerance: 1e-12, rule: StopRule::PrintedDual, max_iterations: CAP };
        let outcome = arrow_hurwicz(coarse, &coarse_load, &params, &mut pair, None);
        assert!(outcome.kkt.relative < 0.1 * target, "{outcome:?}");
        let load = load(grid, f, rule);
        let scale = load.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()));
        Self { grid, target, load, start: pair.prolonged(coarse, Prolongation::default()), scale }
    }

    /// Sweeps until the KKT residual is at the target, if the cap allows.
    fn sweeps(&self, method: Method, r: f64) -> Option<usize> {
        let (grid, load) = (self.grid, &self.load[..]);
        let mut pair = self.start.clone();
        let least = 0.1 * self.target * self.scale;
        let (mut sweeps, mut inner) = (0, 0.1 * self.scale);
        while sweeps < CAP {
            let rest = CAP - sweeps;
            // Half a per cent between looks is as sharp as the comparison needs.
            let some = (sweeps / 200).clamp(1, rest);
            let step = |tolerance: f64| UzawaParams {
                r,
                tolerance,
                inner: 1.0,
                rule: StopRule::Printed,
                max_iterations: 1,
                max_sweeps: rest,
            };
            let outcome = match method {
                Method::ArrowHurwicz => {
                    let params =
                        Params { r, tolerance: 0.0, rule: StopRule::Printed, max_iterations: some };
                    let end = arrow_hurwicz(grid, load, &params, &mut pair, None);
                    UzawaOutcome { end, sweeps: end.iterations }
                }
                Method::Uzawa => uzawa(grid, load, &step(least), &mut pair, None),
                Method::UzawaLoose => uzawa(grid, load, &step(inner), &mut pair, None),
                Method::Proximal(weight) => {
                    let params = ProximalParams { uzawa: step(least), weight };
                    uzawa_proximal(grid, load, &params, &mut pair, None)
                }
                Method::ProximalLoose(weight) => {
                    let params = ProximalParams { uzawa: step(inner), weight };
                    uzawa_proximal(grid, load, &params, &mut pair, None)
                }
            };
            sweeps += outcome.sweeps;
            inner = (0.1 * outcome.end.gradient_abs).max(least);
            if outcome.end.stop == StopReason::Diverged {
                return None;
            }
            if kkt(grid, &pair.y, load).relative <= self.target {
                return Some(sweeps);
            }
        }
        None
    }
}

fn shown(sweeps: Option<usize>) -> String {
    sweeps.map_or_else(|| format!(">{}k", CAP / 1000), |sweeps| sweeps.to_string())
}

/// The methods side by side over eight decades of r, and Arrow-Hurwicz at four values a decade.
fn sweeps_to_the_target(f: &Source, rule: LoadRule, target: f64) {
    let methods = [
        ("AH", Method::ArrowHurwicz),
        ("Uzawa", Method::Uzawa),
        ("Uzawa/10", Method::UzawaLoose),
        ("prox 1", Method::Proximal(1.0)),
        ("prox/10", Method::ProximalLoose(1.0)),
        ("prox 10/10", Method::ProximalLoose(10.0)),
    ];
    for cells in CELLS {
        let case = Case::new(f, rule, cells, target);
        println!("\n{f}, {rule:?}, h = 1/{cells}: sweeps to KKT residual {target:e} |F|");
        print!("{:>8}", "r");
        methods.iter().for_each(|(name, _)| print!(" {name:>10}"));
        println!(" {:>9}", "best/AH");
        let decades: Vec<f64> = (-2..=6).map(|decade| 10f64.powi(decade)).collect();
        let rows: Vec<_> = decades
            .par_iter()
            .map(|&r| methods.map(|(_, method)| case.sweeps(method, r)))
            .collect();
        for (r, counts) in decades.iter().zip(rows) {
            print!("{r:>8.0e}");
            counts.iter().for_each(|&count| print!(" {:>10}", shown(count)));
            let best = counts[1..].iter().flatten().min();
            let ratio = counts[0].zip(best).map(|(ah, &best)| best as f64 / ah as f64);
            println!(" {:>9}", ratio.map_or("-".into(), |ratio| format!("{ratio:.2}")));
        }
        let fine: Vec<f64> = (-8..=24).map(|q| 10f64.powf(f64::from(q) / 4.0)).collect();
        let counts: Vec<_> =
            fine.par_iter().map(|&r| (case.sweeps(Method::ArrowHurwicz, r), r)).collect();
        let reached = || counts.iter().filter_map(|&(sweeps, r)| Some((sweeps?, r)));
        let (least, best) = reached().min_by_key(|&(sweeps, _)| sweeps).expect("some r works");
        let good: Vec<f64> =
            reached().filter(|&(s, _)| s * 10 <= least * 11).map(|(_, r)| r).collect();
        println!(
            "best r for AH: {best:.3}, {least} sweeps; within a tenth of it: r = {:.3} to {:.3}",
            good[0],
            good[good.len() - 1]
        );
    }
}

/// Nested grids 1/4 ... 1/64 and 10^-N, as in the tables: sweeps by method and stopping rule.
fn as_in_the_tables(f: &Source, rule: LoadRule) {
    let grids = nested(&[4, 8, 16, 32, 64]).expect("nested");
    let loads: Vec<_> = grids.iter().map(|&grid| load(grid, f, rule)).collect();
    let sum: f64 = loads[4].iter().sum();
    println!("\n{f}, {rule:?}, sum of F on 1/64 {sum:.2e}: sweeps on 1/4 ... 1/64");
    if sum >= 0.0 {
        println!("no discrete solution; whatever stops below stops at none");
    }
    for r in PAPER_R {
        for stop in StopRule::ALL {
            let params = Params { r, rule: stop, max_iterations: CAP, ..Params::default() };
            let (ends, _) = solve_nested(&grids, &loads, &params, Prolongation::default(), &mut ());
            let counts: Vec<_> = ends.iter().map(|end| end.iterations).collect();
            let last = ends[ends.len() - 1];
            println!(
                "{r:>8.0e} {:<14} {:<13} {counts:?}, KKT {:.1e}, Delta a {:.1e}",
                "AH",
                stop.name(),
                last.kkt.natural,
                last.delta_a
            );
        }
        if sum >= 0.0 {
            // M(., a) has no minimum, and Uzawa's inner iteration no end.
            continue;
        }
        for (name, weight) in [("Uzawa", None), ("Uzawa proximal", Some(1.0))] {
            for stop in [StopRule::Signed, StopRule::Printed] {
                let (ends, _) =
                    on_nested(&grids, &loads, Prolongation::default(), |level, grid, f, pair| {
                        let params = UzawaParams {
                            r,
                            rule: stop,
                            tolerance: tolerance(level),
                            max_sweeps: CAP,
                            ..UzawaParams::default()
                        };
                        let outcome = match weight {
                            None => uzawa(grid, f, &params, pair, None),
                            Some(weight) => {
                                let params = ProximalParams { uzawa: params, weight };
                                uzawa_proximal(grid, f, &params, pair, None)
                            }
                        };
                        (outcome, outcome.end.stop)
                    });
                let counts: Vec<_> = ends.iter().map(|o| o.sweeps).collect();
                let last = ends[ends.len() - 1].end;
                println!(
                    "{r:>8.0e} {name:<14} {:<13} {counts:?}, KKT {:.1e}, Delta a {:.1e}",
                    stop.name(),
                    last.kkt.natural,
                    last.delta_a
                );
            }
        }
    }
}

/// Median time of one sweep with its tests, in nanoseconds per node.
fn time_of_a_sweep(f: &Source) {
    let (runs, sweeps) = (9, 2000);
    let case = Case::new(f, LoadRule::LumpedAverage, 64, TARGETS[0]);
    let median = |solve: &dyn Fn(&mut Pair)| {
        let mut times: Vec<f64> = (0..runs)
            .map(|_| {
                let mut pair = case.start.clone();
                let start = Instant::now();
                solve(&mut pair);
                start.elapsed().as_secs_f64()
            })
            .collect();
        times.sort_by(f64::total_cmp);
        1e9 * times[runs / 2] / (sweeps * case.grid.nodes()) as f64
    };
    let params =
        Params { r: 10.0, tolerance: 0.0, rule: StopRule::Printed, max_iterations: sweeps };
    let inner = UzawaParams { r: 10.0, tolerance: 0.0, max_sweeps: sweeps, ..Default::default() };
    let proximal = ProximalParams { uzawa: inner, ..ProximalParams::default() };
    let ah = median(&|pair| {
        arrow_hurwicz(case.grid, &case.load, &params, pair, None);
    });
    let plain = median(&|pair| {
        uzawa(case.grid, &case.load, &inner, pair, None);
    });
    let shifted = median(&|pair| {
        uzawa_proximal(case.grid, &case.load, &proximal, pair, None);
    });
    println!(
        "\none sweep at 1/64, ns per node: AH {ah:.2}, Uzawa {plain:.2}, proximal {shifted:.2}"
    );
}

fn main() {
    let sources = PROBLEMS.map(|text| text.parse::<Source>().expect("a valid f"));
    time_of_a_sweep(&sources[0]);
    let rules = [LoadRule::LumpedAverage, LoadRule::default()];
    for f in &sources {
        rules.iter().for_each(|&rule| as_in_the_tables(f, rule));
    }
    for target in TARGETS {
        for (problem, rule) in [(0, rules[0]), (1, rules[0]), (1, rules[1])] {
            sweeps_to_the_target(&sources[problem], rule, target);
        }
    }
}
