//! VTK XML files whose arrays are raw little-endian numbers after the text.

use super::zip::{doubles, integers};
use super::{FieldPlace, SolutionFields};
use crate::discrete::grid::Grid;
use crate::mesh::AnyMesh;
use crate::problem::text::is_forbidden;

/// Returns the file of a solution of this name.
pub(super) fn vtk(fields: &SolutionFields<'_>, name: &str) -> Vec<u8> {
    match &fields.place {
        FieldPlace::Grid(grid) => vti(fields, *grid, name),
        FieldPlace::Mesh(mesh) => vtu(fields, mesh, name),
    }
}

/// Image data.
fn vti(fields: &SolutionFields<'_>, grid: Grid, name: &str) -> Vec<u8> {
    let (n, h) = (grid.cells(), grid.h());
    let extent = format!("0 {n} 0 {n} 0 0");
    let mut arrays = Appended::default();
    let v = arrays.doubles("v", fields.v);
    let multiplier = arrays.doubles("multiplier", &fields.multiplier);
    let f = arrays.doubles("f", &fields.f);
    let body = format!(
        "<ImageData WholeExtent=\"{extent}\" Origin=\"-0.5 -0.5 0\" Spacing=\"{h} {h} 1\">\n\
        <Piece Extent=\"{extent}\"><PointData Scalars=\"v\">\n{v}{multiplier}\
        </PointData><CellData Scalars=\"f\">\n{f}\
        </CellData></Piece></ImageData>\n"
    );
    arrays.file("ImageData", name, &body)
}

/// Unstructured grid.
fn vtu(fields: &SolutionFields<'_>, mesh: &AnyMesh, name: &str) -> Vec<u8> {
    let (nodes, cells) = (fields.v.len(), mesh.cells());
    let vertices = usize::from(mesh.dimension()) + 1;
    let ends = (1..=cells).map(|cell| ((vertices * cell) as i64).to_le_bytes());
    // In the opposite order of the text: the reader of meshio looks arrays up by offsets that it changes as it goes,
    // and takes the first one in the text.
    let mut arrays = Appended::default();
    let errors = arrays.doubles_if_any("local_error", &fields.errors);
    let gradient = arrays.vectors("gradient", &mesh.gradients(fields.v));
    let region = mesh.regions().iter().map(|region| region.to_le_bytes());
    let region = arrays.array("type=\"UInt16\" Name=\"region\"", region);
    let f = arrays.doubles_if_any("f", &fields.f);
    let multiplier = arrays.doubles("multiplier", &fields.multiplier);
    let v = arrays.doubles("v", fields.v);
    // VTK's number of a triangle or a tetrahedron.
    let types = (0..cells).map(|_| [if vertices == 3 { 5 } else { 10 }]);
    let types = arrays.array("type=\"UInt8\" Name=\"types\"", types);
    let offsets = arrays.array("type=\"Int64\" Name=\"offsets\"", ends);
    let connectivity = integers(mesh.positive_cells());
    let connectivity = arrays.array("type=\"Int64\" Name=\"connectivity\"", connectivity);
    let points = arrays.vectors("points", &mesh.points_in_space());
    let scalars = if f.is_empty() { "region" } else { "f" };
    let regions = names_of_regions(mesh);
    let body = format!(
        "<UnstructuredGrid>\n{regions}<Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{cells}\">\n\
        <Points>\n{points}</Points>\n\
        <Cells>\n{connectivity}{offsets}{types}</Cells>\n\
        <PointData Scalars=\"v\">\n{v}{multiplier}</PointData>\n\
        <CellData Scalars=\"{scalars}\">\n{f}{region}{gradient}{errors}</CellData>\n\
        </Piece>\n</UnstructuredGrid>\n"
    );
    arrays.file("UnstructuredGrid", name, &body)
}

/// Returns field data with an array for each region, under its name: its number, and its dimension. Text of VTK's own
/// kind for names would stop the reader of meshio, which takes this form for its own.
fn names_of_regions(mesh: &AnyMesh) -> String {
    let (mut data, dimension) = (String::new(), mesh.dimension());
    for (number, names) in mesh.region_names().iter().enumerate() {
        let name = escaped(&names.to_string());
        data += &format!(
            "<DataArray type=\"Int64\" Name=\"{name}\" NumberOfTuples=\"2\" format=\"ascii\">\
            {number} {dimension}</DataArray>\n"
        );
    }
    format!("<FieldData>\n{data}</FieldData>\n")
}

/// Returns a text as the value of an attribute.
fn escaped(text: &str) -> String {
    let text = text.replace(is_forbidden, " ").replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// Arrays of a file, each after the number of its bytes.
#[derive(Default)]
struct Appended {
    data: Vec<u8>,
}

impl Appended {
    /// Adds an array with the bytes of each of its numbers. Returns the tag of the array, with these attributes.
    fn array<const BYTES: usize>(
        &mut self,
        attributes: &str,
        numbers: impl Iterator<Item = [u8; BYTES]>,
    ) -> String {
        let start = self.data.len();
        self.data.extend([0; 8]);
        self.data.extend(numbers.flatten());
        let size = (self.data.len() - start - 8) as u64;
        self.data[start..start + 8].copy_from_slice(&size.to_le_bytes());
        format!("<DataArray {attributes} format=\"appended\" offset=\"{start}\"/>\n")
    }

    /// Adds an array of numbers with this name. Returns its tag.
    fn doubles(&mut self, name: &str, numbers: &[f64]) -> String {
        self.array(&format!("type=\"Float64\" Name=\"{name}\""), doubles(numbers))
    }

    /// As [`Appended::doubles`]; without numbers there is no array, and no tag.
    fn doubles_if_any(&mut self, name: &str, numbers: &[f64]) -> String {
        if numbers.is_empty() { String::new() } else { self.doubles(name, numbers) }
    }

    /// Adds an array of vectors with this name. Returns its tag.
    fn vectors(&mut self, name: &str, vectors: &[[f64; 3]]) -> String {
        let attributes = format!("type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"3\"");
        self.array(&attributes, doubles(vectors.as_flattened()))
    }

    /// Returns a file of a VTK type on the solution of this name, with the tags of the arrays in `body`.
    fn file(self, kind: &str, name: &str, body: &str) -> Vec<u8> {
        let name = name.replace(is_forbidden, " ");
        // Two hyphens end a comment of XML; of three, the first replacement leaves two.
        let name = name.replace("--", "- -").replace("--", "- -");
        let mut bytes = format!(
            "<?xml version=\"1.0\"?>\n<!-- {name}, solution v of the scalar Signorini problem -->\n\
            <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
            {body}<AppendedData encoding=\"raw\">\n_"
        )
        .into_bytes();
        bytes.extend(self.data);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::tests::counted;
    use crate::mesh::{BuiltIn, PlaneInSpace};

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

    /// Number of each node of a mesh.
    fn numbers(mesh: &AnyMesh) -> Vec<f64> {
        (0..mesh.nodes() as u32).map(f64::from).collect()
    }

    #[test]
    fn arrays_of_a_vtk_file_are_where_the_text_says() {
        for (name, kind) in [("annulus", 5), ("ball", 10)] {
            let mesh = AnyMesh::built_in(name).unwrap();
            let (nodes, cells, values) = (mesh.nodes(), mesh.cells(), numbers(&mesh));
            let vertices = usize::from(mesh.dimension()) + 1;
            let file = vtk(&counted(mesh, &values), "a--b");
            for (array, size) in [
                ("points", 24 * nodes),
                ("connectivity", 8 * vertices * cells),
                ("offsets", 8 * cells),
                ("types", cells),
                ("v", 8 * nodes),
                ("multiplier", 8 * nodes),
                ("f", 8 * cells),
                ("region", 2 * cells),
                ("gradient", 24 * cells),
            ] {
                assert_eq!(appended(&file, array).len(), size, "{array}");
            }
            assert!(appended(&file, "types").iter().all(|byte| *byte == kind));
            let last = (vertices * cells) as u64;
            assert!(appended(&file, "offsets").ends_with(&last.to_le_bytes()));
            assert!(appended(&file, "v").ends_with(&((nodes - 1) as f64).to_le_bytes()));
            assert!(file.ends_with(b"\n</AppendedData>\n</VTKFile>\n"));
            assert!(!file.windows(3).any(|part| part == b"a--"));
        }
    }

    #[test]
    fn a_vtk_file_has_the_names_of_regions_and_places_in_space() {
        let mut mesh = BuiltIn::Annulus.plane().unwrap();
        mesh.region_names = vec!["a & \"b\"".into()];
        mesh.origin.plane = PlaneInSpace::Horizontal(5.0);
        let mesh = AnyMesh::from(mesh);
        let values = numbers(&mesh);
        let file = vtk(&counted(mesh, &values), "a");
        let names = "<FieldData>\n<DataArray type=\"Int64\" Name=\"a &amp; &quot;b&quot;\" NumberOfTuples=\"2\" \
            format=\"ascii\">0 2</DataArray>\n</FieldData>\n<Piece";
        assert!(file.windows(names.len()).any(|part| part == names.as_bytes()));
        let heights = appended(&file, "points").chunks(24).map(|point| &point[16..]);
        assert!(heights.into_iter().all(|z| z == 5f64.to_le_bytes()));
    }
}
