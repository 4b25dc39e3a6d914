//! Brackets that must hold the true energy, and the distance between the bounds and the error.

use super::*;
use crate::mesh::{
    BuiltIn, Condition, Facet, Part, PlaneMesh, SpaceMesh, assemble, load_of_cells, refine,
};

/// Discrete problem on a mesh with straight sides, and a nodal vector.
struct Level<const D: usize, const V: usize> {
    mesh: Mesh<D, V>,
    network: Network,
    f: CellData,
    load: Vec<f64>,
    y: Vec<f64>,
}

impl<const D: usize, const V: usize> Level<D, V> {
    fn new(mut mesh: Mesh<D, V>, mean: Vec<f64>) -> Self {
        mesh.parts_mut().iter_mut().for_each(|part| part.curve = None);
        let (network, load) = (assemble(&mesh), load_of_cells(&mesh, &mean));
        let y = vec![0.0; load.len()];
        Self { mesh, network, f: CellData { mean, deviation: None }, load, y }
    }

    /// Refined mesh, with the same f and the same function.
    fn refined(&self) -> Self {
        let refined = refine(&self.mesh).unwrap();
        let children = 1 << D;
        let mean = self.f.mean.iter().flat_map(|f| std::iter::repeat_n(*f, children)).collect();
        let mut y = self.y.clone();
        y.extend(
            refined
                .parents
                .iter()
                .map(|nodes| 0.5 * (self.y[nodes[0] as usize] + self.y[nodes[1] as usize])),
        );
        Self { y, ..Self::new(refined.mesh, mean) }
    }

    /// Solves the discrete problem by projected over-relaxation.
    fn solve(&mut self) {
        let nodes = self.y.len();
        let mut least = vec![f64::NEG_INFINITY; nodes];
        self.network.contact().iter().for_each(|contact| least[contact.node as usize] = 0.0);
        let mut most = vec![f64::INFINITY; nodes];
        for &node in self.network.fixed() {
            (least[node as usize], most[node as usize]) = (0.0, 0.0);
        }
        let factor = 2.0 / (1.0 + 2.0 / (nodes as f64).powf(1.0 / D as f64));
        for _ in 0..100_000 {
            let (mut change, mut size) = (0.0f64, 1e-300f64);
            for node in 0..nodes {
                let sum = self.network.row(node).add_to(self.load[node], &self.y);
                let old = self.y[node];
                let step = sum / self.network.diagonal()[node] - old;
                self.y[node] = (old + factor * step).clamp(least[node], most[node]);
                change = change.max((self.y[node] - old).abs());
                size = size.max(self.y[node].abs());
            }
            if change < 1e-11 * size {
                return;
            }
        }
        panic!("no convergence");
    }

    fn bounds(&self) -> Bounds {
        bounds_on_mesh(&self.mesh, &self.network, &self.f, &self.y).unwrap()
    }
}

#[test]
fn explore() {
    fn go<const D: usize, const V: usize>(
        name: &str,
        mesh: Mesh<D, V>,
        f: Vec<f64>,
        levels: usize,
    ) {
        let mut level = Level::new(mesh, f);
        let mut all = Vec::new();
        for _ in 0..levels {
            level = level.refined();
            level.solve();
            let t = std::time::Instant::now();
            let b = level.bounds();
            let t = t.elapsed().as_secs_f64() / level.y.len() as f64;
            all.push((level.y.len(), b, t));
        }
        let fine = all.last().unwrap().1.energy[1];
        for (n, b, t) in &all {
            let e = (2.0 * (b.energy[1] - fine)).max(0.0).sqrt();
            println!(
                "{name} {n} {:?} bound {:.4e} eff {:.4} {:.2} us",
                b.energy,
                b.error[1],
                b.error[1] / e,
                t * 1e6
            );
        }
    }
    let disc = || BuiltIn::Disc.plane().unwrap();
    go("disc", disc(), vec![-1.0; 6], 7);
    go("disc sectors", disc(), vec![4.0, -1.5, -1.5, -1.5, -1.5, -1.5], 7);
    go("lshape", BuiltIn::LShape.plane().unwrap(), vec![4.0, -1.5, -1.5, -1.5, -1.5, -1.5], 7);
    let mut annulus = BuiltIn::Annulus.plane().unwrap();
    let f: Vec<_> = (0..24).map(|k| if k < 6 { 3.0 } else { -1.5 }).collect();
    go("annulus", annulus.clone(), f.clone(), 5);
    annulus.parts_mut()[0].condition = Condition::Fixed;
    go("annulus fixed", annulus.clone(), f.clone(), 5);
    annulus.parts_mut()[0].condition = Condition::Free;
    go("annulus free", annulus, f, 5);
    let f: Vec<_> = (0..20).map(|k| if k < 4 { 3.0 } else { -1.5 }).collect();
    go("ball", BuiltIn::Ball.space().unwrap(), vec![-1.0; 20], 4);
    go("ball", BuiltIn::Ball.space().unwrap(), f, 4);
}
