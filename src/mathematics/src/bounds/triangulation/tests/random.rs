//! Random vectors, conditions and functions f: all brackets of a problem must hold one energy.

use super::{TestProblem, constant_on_cells, noise, overlap, straight};
use crate::mesh::{BuiltIn, CellData, Element, Mesh, MeshLoad, refine};
use crate::problem::law::Law;
use proptest::prelude::*;

/// Conditions on a third of the facets each, in which way they follow each other, and the frequencies of all noise.
#[derive(Clone, Debug)]
struct RandomCase {
    laws: [Law; 3],
    run: usize,
    frequencies: [f64; 4],
}

fn random_case() -> impl Strategy<Value = RandomCase> {
    let law = prop::sample::select(vec![Law::SIGNORINI, Law::SIGNORINI, Law::FIXED, Law::FREE]);
    let laws = prop::array::uniform3(law);
    let frequencies = prop::array::uniform4(1.0f64..1000.0);
    (laws, 1..6usize, frequencies)
        .prop_filter("a boundary that is not free", |(laws, ..)| {
            laws.iter().any(|law| *law != Law::FREE)
        })
        .prop_map(|(laws, run, frequencies)| RandomCase { laws, run, frequencies })
}

/// Checks that the brackets of many vectors hold one energy, and that the bounds of their errors agree with the
/// distances between them.
fn check_brackets<const D: usize, const V: usize>(mut mesh: Mesh<D, V>, case: &RandomCase) {
    mesh.parts = (0..3).map(|k| straight(&k.to_string(), case.laws[k])).collect();
    for (k, facet) in mesh.facets.iter_mut().enumerate() {
        facet.part = ((k / case.run) % 3) as u16;
    }
    if mesh.facets.iter().all(|facet| mesh.parts[facet.part as usize].law == Law::FREE) {
        return;
    }
    let cells = mesh.cells().len();
    let coarse = TestProblem::new(mesh, vec![0.0; cells]).refined();
    let mut fine = coarse.refined();
    let [of_f, of_fine, of_coarse, offset] = case.frequencies;
    let volumes =
        fine.mesh.cells().iter().map(|cell| Element::new(fine.mesh.vertices(cell)).volume);
    let volumes: Vec<f64> = volumes.collect();
    let mut f = noise(volumes.len(), of_f);
    let integral: f64 = f.iter().zip(&volumes).map(|(f, volume)| f * volume).sum();
    let shift = (integral + libm::fmod(offset, 1.0)) / volumes.iter().sum::<f64>();
    f.iter_mut().for_each(|f| *f -= shift);
    let mut data = CellData { mean: Vec::new(), deviation: Some(Vec::new()), shares: None };
    for (f, volumes) in f.chunks(1 << D).zip(volumes.chunks(1 << D)) {
        let mean = f.iter().sum::<f64>() / f.len() as f64;
        let square = f.iter().zip(volumes).map(|(f, volume)| volume * (f - mean) * (f - mean));
        data.mean.push(mean);
        data.deviation.as_mut().unwrap().push(square.sum::<f64>().sqrt());
    }
    fine.f = constant_on_cells(&fine.mesh, f);
    // A hat function is one half at the midpoints of the edges to its node.
    let mut load = fine.f.load[..coarse.y.len()].to_vec();
    let parents = refine(&coarse.mesh).unwrap().parents;
    for (ends, of_midpoint) in parents.iter().zip(&fine.f.load[coarse.y.len()..]) {
        ends.iter().for_each(|&end| load[end as usize] += 0.5 * of_midpoint);
    }
    let f = MeshLoad { load, cells: data, ..fine.f.clone() };
    let mut coarse = TestProblem { f, ..coarse };
    // Zero first, then noise, then what relaxation makes of the noise.
    let mut energies = vec![coarse.bounds().energy, fine.bounds().energy];
    coarse.y = noise(coarse.y.len(), of_coarse);
    energies.push(coarse.bounds().energy);
    coarse.relax(1000);
    let [low, high] = coarse.bounds().energy;
    // The vector is in K, and its load exact.
    let energy = coarse.network.energy(&coarse.y, &coarse.f.load).min(0.0);
    assert!((high - energy).abs() <= 1e-9 * (high - low), "{low} {high} {energy}");
    energies.push([low, high]);
    let mut solved = fine.clone();
    solved.relax(1000);
    let solved_bounds = solved.bounds();
    fine.y = noise(fine.y.len(), of_fine);
    for sweeps in [0, 1, 20] {
        fine.relax(sweeps);
        let bounds = fine.bounds();
        energies.push(bounds.energy);
        let distance: Vec<f64> = fine.y.iter().zip(&solved.y).map(|(p, q)| p - q).collect();
        let zero = vec![0.0; distance.len()];
        let norm = (2.0 * fine.network.energy(&distance, &zero)).sqrt();
        assert!(norm <= bounds.error[1] + solved_bounds.error[1]);
    }
    energies.push(solved_bounds.energy);
    assert!(energies.iter().all(|[low, high]| low <= high), "{energies:?}");
    assert!(overlap(&energies), "{energies:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 125, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn brackets_of_the_disc_hold_one_energy(case in random_case()) {
        check_brackets(BuiltIn::Disc.plane().unwrap(), &case);
    }

    #[test]
    fn brackets_of_the_lshape_hold_one_energy(case in random_case()) {
        check_brackets(BuiltIn::LShape.plane().unwrap(), &case);
    }

    #[test]
    fn brackets_of_the_annulus_hold_one_energy(case in random_case()) {
        check_brackets(BuiltIn::Annulus.plane().unwrap(), &case);
    }

    #[test]
    fn brackets_of_the_ball_hold_one_energy(case in random_case()) {
        check_brackets(BuiltIn::Ball.space().unwrap(), &case);
    }
}
