//! Costs that the replication promises: the cells of both tables, one sweep per node, and the run that has nothing to do.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::{LoadRule, load};
use signorini_mathematics::discrete::transfer::Prolongation;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::{Pair, Params, StopRule, arrow_hurwicz, solve_nested};
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::process::Command;

const PROBLEMS: [&str; 2] = ["quadrant(ll)=3; else=-1.002", "quadrant(ll)=-6; else=1.998"];
const R: [f64; 5] = [1e6, 10.0, 5.0, 1.0, 0.5];

/// All fifty solves of Tables 1 and 2, load vectors included, on one thread.
fn tables(c: &mut Criterion) {
    let sources = PROBLEMS.map(|text| text.parse::<Source>().expect("a valid f"));
    let grids = nested(&[4, 8, 16, 32, 64]).expect("nested");
    c.bench_function("tables/both, 50 solves", |b| {
        b.iter(|| {
            for f in &sources {
                let loads: Vec<_> =
                    grids.iter().map(|&g| load(g, f, LoadRule::default())).collect();
                for r in R {
                    let params = Params { r, ..Params::default() };
                    black_box(solve_nested(
                        &grids,
                        Law::SIGNORINI.with_loads(&loads),
                        &params,
                        Prolongation::default(),
                        &mut (),
                    ));
                }
            }
        });
    });
}

/// One iteration (sweep, dual step, stopping test), per node.
fn iteration(c: &mut Criterion) {
    let f: Source = PROBLEMS[1].parse().expect("a valid f");
    let mut group = c.benchmark_group("iteration per node");
    for n in [16, 64, 256, 1024] {
        let grid = Grid::new(n).expect("fine enough");
        let load = load(grid, &f, LoadRule::default());
        let count = if n <= 64 { 1000 } else { 20 };
        // A tolerance out of reach, so that exactly `count` iterations run.
        let params = Params {
            tolerance: f64::MIN_POSITIVE,
            rule: StopRule::Printed,
            max_iterations: count,
            ..Params::default()
        };
        group.throughput(Throughput::Elements((count * grid.nodes()) as u64));
        group.bench_function(format!("1/{n}"), |b| {
            b.iter(|| {
                let mut pair = Pair::zero(grid);
                arrow_hurwicz(grid, Law::SIGNORINI.with_load(&load), &params, &mut pair)
            });
        });
    }
}

/// The whole process that solves both tables from an empty cache, artifacts synced to disk.
fn solve_stage(c: &mut Criterion) {
    let project = tempfile::tempdir().expect("a temporary folder");
    let scenes = project.path().join("pipeline/scenes");
    fs::create_dir_all(&scenes).expect("a writable folder");
    fs::create_dir(project.path().join("report")).expect("a writable folder");
    let paper = Path::new(env!("CARGO_MANIFEST_DIR")).join("pipeline/paper.toml");
    fs::copy(paper, project.path().join("pipeline/paper.toml")).expect("the published values");
    for (k, f) in PROBLEMS.iter().enumerate() {
        let scene = format!("title = \"t\"\nf = \"{f}\"\noutputs = [\"table\"]\n");
        fs::write(scenes.join(format!("problem{k}.toml")), scene).expect("a writable folder");
    }
    let mut caches = 0;
    c.bench_function("run --only solve, both tables, empty cache", |b| {
        b.iter(|| {
            // A new cache each time: removing the old one would be timed as well.
            caches += 1;
            let cache = format!("cache{caches}");
            let mut run = Command::new(env!("CARGO_BIN_EXE_signorini"));
            run.args(["run", "--only", "solve", "--quiet", "--cache-dir", &cache]);
            let output = run.current_dir(project.path()).output();
            assert!(output.expect("the program starts").status.success());
        });
    });
}

/// The whole process when everything is up to date.
fn nothing_to_do(c: &mut Criterion) {
    let cache = tempfile::tempdir().expect("a temporary folder");
    let run = || {
        Command::new(env!("CARGO_BIN_EXE_signorini"))
            .args(["run", "--quiet", "--cache-dir"])
            .arg(cache.path())
            .output()
            .expect("the program starts")
    };
    assert!(run().status.success());
    assert_eq!(run().stdout, b"nothing to do\n");
    c.bench_function("run, nothing to do", |b| b.iter(run));
}

criterion_group!(benches, tables, iteration, solve_stage, nothing_to_do);
criterion_main!(benches);
