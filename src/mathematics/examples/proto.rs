use signorini_mathematics::discrete::kkt::judge_network;
use signorini_mathematics::mesh::*;
use signorini_mathematics::multigrid::*;
use signorini_mathematics::multilevel::*;
use std::time::Instant;
fn study<const D: usize, const V: usize>(
    name: &str,
    coarse: Mesh<D, V>,
    refine: usize,
    f: [f64; 2],
) {
    let t = Instant::now();
    let (levels, mesh) = refined(&coarse, refine).unwrap();
    let setup = t.elapsed().as_secs_f64();
    let values: Vec<f64> = mesh
        .cells()
        .iter()
        .map(|c| {
            let x = centroid(mesh.vertices(c));
            if x.iter().all(|x| *x < 0.0) { f[0] } else { f[1] }
        })
        .collect();
    let load = load_of_cells(&mesh, &values);
    let n = load.len();
    let net = &levels.last().unwrap().network;
    println!(
        "{name} unknowns {n} contact {} setup {:.0} ns/unknown",
        net.contact().len(),
        setup / n as f64 * 1e9
    );
    let scale = load.iter().fold(0.0f64, |m, f| m.max(f.abs()));
    let mut best = 0.0;
    for goal in [
        Goal::RoundingFloor,
        Goal::Kkt(1e-10 * scale),
        Goal::Kkt(1e-8 * scale),
        Goal::DiscretisationError,
    ] {
        let t = Instant::now();
        let (y, o) =
            solve_nested_networks(&levels, &load, &MultigridParams { goal, max_cycles: 100 })
                .unwrap();
        let time = t.elapsed().as_secs_f64();
        let j = judge_network(net, &y, &load);
        if best == 0.0 {
            best = j.energy;
        }
        println!(
            "  {goal:?}: {:?} steps {} kkt {:.2e} ({:.2e}) work {:.1} {:.0} ns/unknown J {:.12e} J-J* {:.2e}",
            o.stop,
            o.cycles,
            j.kkt.relative,
            o.kkt / scale,
            o.work_units,
            time / n as f64 * 1e9,
            j.energy,
            j.energy - best
        );
    }
}
fn main() {
    let which = std::env::args().nth(1).unwrap_or_default();
    let plus: usize = std::env::args().nth(2).and_then(|s| s.parse().ok()).unwrap_or(0);
    let b = [-6.0, 1.0];
    if which.is_empty() || which == "disc" {
        study("disc", BuiltIn::Disc.plane().unwrap(), 8 + plus, [-6.0, 1.0]);
    }
    if which.is_empty() || which == "lshape" {
        study("lshape A", BuiltIn::LShape.plane().unwrap(), 8 + plus, [3.0, -2.0]);
    }
    if which.is_empty() || which == "annulus" {
        study("annulus", BuiltIn::Annulus.plane().unwrap(), 7 + plus, b);
    }
    if which.is_empty() || which == "ball" {
        study("ball", BuiltIn::Ball.space().unwrap(), 5 + plus, [-9.0, 1.0]);
    }
}
