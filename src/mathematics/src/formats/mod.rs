//! Solutions as files for other programs: NPY and NPZ for NumPy, VTK XML for ParaView.

mod grid;
mod mesh;
mod npy;
mod vtk;
mod zip;

pub use grid::Fields;
pub use mesh::MeshFields;
