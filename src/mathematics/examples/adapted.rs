//! The L-shape to an accuracy, on meshes that are bisected where the guaranteed error is large; the last mesh with the
//! solution as bytes of files for ParaView and NumPy.
//!
//! `cargo run --release -p signorini-mathematics --example adapted`

use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::mesh::AnyMesh;
use signorini_mathematics::solvers::Adaption;

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let coarsest = AnyMesh::built_in("lshape").expect("a built-in domain");
    let adaption = Adaption {
        coarsest: coarsest.plane().expect("a domain in the plane"),
        f: "rect(-9,0,-9,0)=3; else=-2",
        goal: Accuracy::Error(0.02),
        most_nodes: 100_000,
        bisections: Adaption::BISECTIONS,
    };
    let solved = adaption.run(&mut (), &|_| ())?;
    let (problem, pair) = (&solved.problem, solved.pair());
    let bounds = solved.bounds().last().expect("bounds on the last mesh").clone()?;
    println!("{} nodes, error at most {:.2} %", pair.y.len(), 100.0 * bounds.relative());
    let vtu = problem.vtk(&pair, "lshape");
    let npz = problem.npz(&pair).ok_or("more than 4 GB")?;
    println!("lshape.vtu of {} bytes, lshape.npz of {}", vtu.len(), npz.len());
    assert!(bounds.relative() <= 0.02 && pair.y.len() < 10_000);
    assert!(vtu.starts_with(b"<?xml") && npz.starts_with(b"PK"));
    Ok(())
}
