//! Brackets on the mesh of the cube: of known solutions, and of one f on all meshes.

use super::bounds_on_mesh;
use crate::bounds::Bounds;
use crate::discrete::kkt::judge;
use crate::mesh::{MeshLoad, mesh_load, refined, uniform_cube};
use crate::multigrid::MultigridParams;
use crate::multilevel::solve_nested_networks;
use crate::problem::exact::{CubeExact, Known};
use crate::problem::source::Source;

/// Bounds of the solution on a mesh, and its energy.
struct SolvedCube {
    bounds: Bounds,
    energy: f64,
    is_sampled: bool,
}

/// Solves on the mesh with `2^times` cells per side.
fn solved(f: &Source<3>, times: usize) -> SolvedCube {
    let (levels, mesh) = refined(&uniform_cube(1), times).unwrap();
    let network = &levels[times].network;
    let made = mesh_load(&mesh, f).unwrap();
    let MeshLoad { load, unsettled, .. } = &made;
    let (y, _) = solve_nested_networks(&levels, load, &MultigridParams::default()).unwrap();
    let bounds = bounds_on_mesh(&mesh, network, &made, &y).unwrap();
    let energy = judge(network, &y, load).energy;
    SolvedCube { bounds, energy, is_sampled: unsettled.is_some() }
}

/// Half the integral of f times the solution, by the midpoint rule, without its sign: the energy.
fn energy(exact: CubeExact) -> f64 {
    const N: usize = 64;
    let middle = |i: usize| (i as f64 + 0.5) / N as f64 - 0.5;
    let mut sum = 0.0;
    for cell in 0..N * N * N {
        let point = [cell % N, cell / N % N, cell / (N * N)].map(middle);
        let sample = exact.at(point);
        sum -= 0.5 * sample.f * sample.value;
    }
    sum / (N * N * N) as f64
}

#[test]
fn brackets_of_known_solutions_hold_their_energies() {
    for exact in CubeExact::ALL {
        let energy = energy(exact);
        let errors = [3, 4].map(|times| {
            let found = solved(&Source::<3>::Exact(Known::Cube(exact)), times);
            let [low, high] = found.bounds.energy;
            assert!(low < energy && energy < high, "{exact:?} {times}: {low} {energy} {high}");
            assert!(found.is_sampled);
            found.bounds.error[1]
        });
        let ratio = errors[0] / errors[1];
        // The error falls by two, and the part of the bound for the deviations of f from its means by four.
        assert!(1.9 < ratio && ratio < 2.2, "{exact:?}: {ratio}");
    }
}

#[test]
fn brackets_of_all_meshes_hold_one_energy() {
    let mut widths = Vec::new();
    for k in 0..6 {
        let value = |place: f64| libm::sin(17.0 * f64::from(k) + place) - 0.3;
        let (a, b, c) = (value(1.0) * 5.0, value(2.0) * 3.0, value(3.0).abs() + 3.5);
        let text = format!(
            "box(-0.5,0,-0.5,0.25,0,0.5)={a}; box(0,0.25,-0.25,0.5,-0.5,0.5)={b}; else=-{c}"
        );
        let f: Source<3> = text.parse().unwrap();
        let (mut lowest, mut highest) = (f64::NEG_INFINITY, f64::INFINITY);
        for times in [2, 3, 4] {
            let found = solved(&f, times);
            assert!(!found.is_sampled);
            let [low, high] = found.bounds.energy;
            (lowest, highest) = (low.max(lowest), high.min(highest));
            // f is constant on the cells, so that the solution is in K and its energy the upper end.
            let apart = (found.energy - high).abs();
            assert!(apart < 1e-9 * (high - low), "{times}: {} {low} {high}", found.energy);
        }
        assert!(lowest <= highest, "{text}: {lowest} {highest}");
        widths.push((highest - lowest) / -highest);
    }
    assert!(widths.iter().all(|width| *width < 0.1), "{widths:?}");
}
