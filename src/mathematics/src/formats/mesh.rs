//! Solutions on triangulations.

use super::npy::{DOUBLE, INTEGER, SHORT, doubles, npy};
use super::vtk::{Appended, escaped};
use super::zip;
use crate::mesh::Mesh;

/// Solution on a mesh.
#[derive(Clone, Copy)]
pub struct MeshFields<'a, const D: usize, const V: usize> {
    /// Mesh.
    pub mesh: &'a Mesh<D, V>,
    /// v at the nodes.
    pub v: &'a [f64],
    /// Multiplier dv/dn at the nodes, zero where there is no contact.
    pub multiplier: &'a [f64],
    /// f on each cell.
    pub f: &'a [f64],
    /// Guaranteed error in each cell; empty if it is not known.
    pub errors: &'a [f64],
}

impl<const D: usize, const V: usize> MeshFields<'_, D, V> {
    /// v alone, in NPY format.
    pub fn npy(&self) -> Vec<u8> {
        npy(DOUBLE, &[self.v.len()], doubles(self.v))
    }

    /// Mesh and solution in NPZ format, not compressed: `points`, one row of coordinates a node; `cells`, one row of
    /// nodes a cell, in the positive sense; `v` and `multiplier` at the nodes; on the cells `f`, the number of the
    /// `region`, from 0 on, and the `local_error` where it is known.
    ///
    /// None if they do not fit into the four gigabytes that such an archive may have.
    pub fn npz(&self) -> Option<Vec<u8>> {
        npz(self.mesh, self)
    }

    /// VTK XML unstructured grid, in the space of the mesh's file: points with `v` and `multiplier`, cells with `f`,
    /// the number of the `region`, from 0 on, to whose names the field data have numbers, and the `local_error` where
    /// it is known; raw little-endian numbers.
    pub fn vtu(&self, name: &str) -> Vec<u8> {
        vtu(self.mesh, self, name)
    }
}

fn npz<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    fields: &MeshFields<'_, D, V>,
) -> Option<Vec<u8>> {
    let (nodes, cells) = (mesh.points().len(), mesh.cells().len());
    zip::fits((D + 2) * nodes + (V + 3) * cells).then(|| {
        let region = mesh.regions().iter().map(|region| region.to_le_bytes());
        let mut arrays = vec![
            ("points.npy", npy(DOUBLE, &[nodes, D], doubles(mesh.points().as_flattened()))),
            ("cells.npy", npy(INTEGER, &[cells, V], vertices(mesh))),
            ("v.npy", fields.npy()),
            ("multiplier.npy", npy(DOUBLE, &[nodes], doubles(fields.multiplier))),
            ("f.npy", npy(DOUBLE, &[cells], doubles(fields.f))),
            ("region.npy", npy(SHORT, &[cells], region)),
        ];
        if !fields.errors.is_empty() {
            arrays.push(("local_error.npy", npy(DOUBLE, &[cells], doubles(fields.errors))));
        }
        zip::zip(&arrays)
    })
}

/// VTK's number of a cell with V vertices: triangle or tetrahedron.
const fn cell_type(vertices: usize) -> u8 {
    if vertices == 3 { 5 } else { 10 }
}

fn vtu<const D: usize, const V: usize>(
    mesh: &Mesh<D, V>,
    fields: &MeshFields<'_, D, V>,
    name: &str,
) -> Vec<u8> {
    let (nodes, cells) = (mesh.points().len(), mesh.cells().len());
    let ends = (1..=cells).map(|cell| ((V * cell) as i64).to_le_bytes());
    // In the opposite order of the text: the reader of meshio looks arrays up by offsets that it changes as it goes,
    // and takes the first one in the text.
    let mut arrays = Appended::default();
    let errors = match fields.errors {
        [] => String::new(),
        errors => arrays.array("type=\"Float64\" Name=\"local_error\"", doubles(errors)),
    };
    let region = mesh.regions().iter().map(|region| region.to_le_bytes());
    let region = arrays.array("type=\"UInt16\" Name=\"region\"", region);
    let f = arrays.array("type=\"Float64\" Name=\"f\"", doubles(fields.f));
    let multiplier =
        arrays.array("type=\"Float64\" Name=\"multiplier\"", doubles(fields.multiplier));
    let v = arrays.array("type=\"Float64\" Name=\"v\"", doubles(fields.v));
    let types = (0..cells).map(|_| [cell_type(V)]);
    let types = arrays.array("type=\"UInt8\" Name=\"types\"", types);
    let offsets = arrays.array("type=\"Int64\" Name=\"offsets\"", ends);
    let connectivity = arrays.array("type=\"Int64\" Name=\"connectivity\"", vertices(mesh));
    let points = arrays.array(
        "type=\"Float64\" Name=\"points\" NumberOfComponents=\"3\"",
        mesh.points().iter().flat_map(|point| mesh.in_space(point).map(f64::to_le_bytes)),
    );
    let regions = names_of_regions(mesh);
    let body = format!(
        "<UnstructuredGrid>\n{regions}<Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{cells}\">\n\
        <Points>\n{points}</Points>\n\
        <Cells>\n{connectivity}{offsets}{types}</Cells>\n\
        <PointData Scalars=\"v\">\n{v}{multiplier}</PointData>\n\
        <CellData Scalars=\"f\">\n{f}{region}{errors}</CellData>\n\
        </Piece>\n</UnstructuredGrid>\n"
    );
    arrays.file("UnstructuredGrid", name, &body)
}

/// Returns field data with an array for each region, under its name: its number, and its dimension. Text of VTK's own
/// kind for names would stop the reader of meshio, which takes this form for its own.
fn names_of_regions<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> String {
    let mut data = String::new();
    for (number, names) in mesh.region_names().iter().enumerate() {
        let name = escaped(&names.to_string());
        data += &format!(
            "<DataArray type=\"Int64\" Name=\"{name}\" NumberOfTuples=\"2\" format=\"ascii\">{number} {D}</DataArray>\n"
        );
    }
    format!("<FieldData>\n{data}</FieldData>\n")
}

/// Numbers of the vertices of all cells, in the positive sense, as integers of 64 bits.
fn vertices<const D: usize, const V: usize>(mesh: &Mesh<D, V>) -> impl Iterator<Item = [u8; 8]> {
    mesh.positive_cells().flatten().map(|node| i64::from(node).to_le_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{BuiltIn, PlaneInSpace};

    /// Solution on a built-in mesh that is v = multiplier = node, f = cell.
    struct Counted<const D: usize, const V: usize> {
        mesh: Mesh<D, V>,
        at_nodes: Vec<f64>,
        on_cells: Vec<f64>,
    }

    impl<const D: usize, const V: usize> Counted<D, V> {
        fn on(mesh: Mesh<D, V>) -> Self {
            let (nodes, cells) = (mesh.points().len() as u32, mesh.cells().len() as u32);
            let (at_nodes, on_cells) = ((0..nodes).map(f64::from), (0..cells).map(f64::from));
            Self { mesh, at_nodes: at_nodes.collect(), on_cells: on_cells.collect() }
        }

        fn fields(&self) -> MeshFields<'_, D, V> {
            let Self { mesh, at_nodes, on_cells } = self;
            MeshFields { mesh, v: at_nodes, multiplier: at_nodes, f: on_cells, errors: &[] }
        }
    }

    /// Bytes of the array of this name in a VTK XML file.
    fn appended<'a>(file: &'a [u8], name: &str) -> &'a [u8] {
        let marker = b"<AppendedData encoding=\"raw\">\n_";
        let start = file.windows(marker.len()).position(|part| part == marker).unwrap();
        let (text, data) =
            (std::str::from_utf8(&file[..start]).unwrap(), &file[start + marker.len()..]);
        let tag = text.split('<').find(|tag| tag.contains(&format!("Name=\"{name}\""))).unwrap();
        let offset = tag.split("offset=\"").nth(1).unwrap().split('"').next().unwrap();
        let data = &data[offset.parse().unwrap()..];
        let size = u64::from_le_bytes(data[..8].try_into().unwrap()) as usize;
        &data[8..8 + size]
    }

    #[test]
    fn arrays_of_a_vtk_file_are_where_the_text_says() {
        check_arrays(&Counted::on(BuiltIn::Annulus.plane().unwrap()), 5);
        check_arrays(&Counted::on(BuiltIn::Ball.space().unwrap()), 10);
    }

    /// Checks the arrays of a file with cells of this kind.
    fn check_arrays<const D: usize, const V: usize>(counted: &Counted<D, V>, kind: u8) {
        let (nodes, cells) = (counted.mesh.points().len(), counted.mesh.cells().len());
        let file = counted.fields().vtu("a--b");
        for (array, size) in [
            ("points", 24 * nodes),
            ("connectivity", 8 * V * cells),
            ("offsets", 8 * cells),
            ("types", cells),
            ("v", 8 * nodes),
            ("multiplier", 8 * nodes),
            ("f", 8 * cells),
            ("region", 2 * cells),
        ] {
            assert_eq!(appended(&file, array).len(), size, "{array}");
        }
        assert!(appended(&file, "types").iter().all(|byte| *byte == kind));
        let last = (V * cells) as u64;
        assert!(appended(&file, "offsets").ends_with(&last.to_le_bytes()));
        assert!(appended(&file, "v").ends_with(&((nodes - 1) as f64).to_le_bytes()));
        assert!(file.ends_with(b"\n</AppendedData>\n</VTKFile>\n"));
        assert!(!file.windows(3).any(|part| part == b"a--"));
    }

    #[test]
    fn a_vtk_file_has_the_names_of_regions_and_places_in_space() {
        let mut counted = Counted::on(BuiltIn::Annulus.plane().unwrap());
        counted.mesh.region_names = vec!["a & \"b\"".into()];
        counted.mesh.origin.plane = PlaneInSpace::Horizontal(5.0);
        let file = counted.fields().vtu("a");
        let names = "<FieldData>\n<DataArray type=\"Int64\" Name=\"a &amp; &quot;b&quot;\" NumberOfTuples=\"2\" \
            format=\"ascii\">0 2</DataArray>\n</FieldData>\n<Piece";
        assert!(file.windows(names.len()).any(|part| part == names.as_bytes()));
        let heights = appended(&file, "points").chunks(24).map(|point| &point[16..]);
        assert!(heights.into_iter().all(|z| z == 5f64.to_le_bytes()));
    }

    #[test]
    fn arrays_for_numpy_have_rows_of_coordinates_and_of_vertices() {
        let counted = Counted::on(BuiltIn::LShape.plane().unwrap());
        let archive = counted.fields().npz().unwrap();
        for header in ["(8, 2), }", "(6, 3), }", "(8,), }", "(6,), }"] {
            assert!(
                archive.windows(header.len()).any(|part| part == header.as_bytes()),
                "{header}"
            );
        }
        let has = |archive: &[u8], text: &str| {
            archive.windows(text.len()).any(|part| part == text.as_bytes())
        };
        assert!(has(&archive, "region.npy") && has(&archive, "'<u2'"));
        assert!(!has(&archive, "local_error.npy"));
        let with_errors = MeshFields { errors: &counted.on_cells, ..counted.fields() };
        assert!(has(&with_errors.npz().unwrap(), "local_error.npy"));
        assert_eq!(counted.fields().npy().len(), 128 + 8 * 8);
    }
}
