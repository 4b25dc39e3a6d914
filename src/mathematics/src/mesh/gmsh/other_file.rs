//! Files that stand in the place of a mesh, told by their first bytes.

/// Bytes that some editors put before a text.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Beginning of a file of some kind, in small letters.
type Beginning = (&'static [u8], &'static str, &'static str);

const UNPACK: &str = "unpack it, and give the mesh that is inside";
const CONVERT: &str = "convert it with `meshio convert FILE mesh.msh --output-format gmsh22`";
const CONVERT_WITH_ALL: &str = "convert it with `meshio convert FILE mesh.msh --output-format gmsh22`, after \
    `pip install \"meshio[all]\"`";
const MESH: &str = "mesh it with `gmsh -2 FILE -o mesh.msh`, in space with -3";
const SURFACE: &str = "mesh its inside, as a volume, in Gmsh, and save that as .msh";
const DOWNLOAD: &str = "download the mesh itself";

/// Beginnings after blanks, in the order in which they are tried.
const BEGINNINGS: [Beginning; 31] = [
    (b"version https://git-lfs.github.com/", "is a pointer of Git LFS", "do `git lfs pull`"),
    (b"/annex/objects/", "is a pointer of git-annex", "do `git annex get FILE`"),
    (b"<!doctype html", "is an HTML page, as of a failed download", DOWNLOAD),
    (b"<html", "is an HTML page, as of a failed download", DOWNLOAD),
    (b"\x1f\x8b", "is compressed by gzip", UNPACK),
    (b"pk\x03\x04", "is a ZIP archive", UNPACK),
    (b"bzh", "is compressed by bzip2", UNPACK),
    (b"\xfd7zxz\0", "is compressed by xz", UNPACK),
    (b"\x28\xb5\x2f\xfd", "is compressed by zstd", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "is a 7z archive", UNPACK),
    (b"\xff\xfe", "is text in UTF-16", "save it as UTF-8"),
    (b"\xfe\xff", "is text in UTF-16", "save it as UTF-8"),
    (b"# vtk datafile", "is a VTK file", CONVERT),
    (b"<vtkfile", "is a VTK file", CONVERT),
    (b"<!doctype xdmf", "is an XDMF file", CONVERT_WITH_ALL),
    (b"<xdmf", "is an XDMF file", CONVERT_WITH_ALL),
    (b"\x89hdf", "is an HDF5 file, as of MED or Exodus", CONVERT_WITH_ALL),
    (b"meshversionformatted", "is a mesh of Medit", CONVERT),
    (b"(0 \"", "is a mesh of ANSYS", CONVERT),
    (b"(1 \"", "is a mesh of ANSYS", CONVERT),
    (b"<dolfin", "is a mesh of DOLFIN", CONVERT),
    (b"ndime=", "is a mesh of SU2", CONVERT),
    (b"cdf\x01", "is a NetCDF file, as of Exodus", CONVERT_WITH_ALL),
    (b"*heading", "is a mesh of Abaqus", CONVERT),
    (b"*node", "is a mesh of Abaqus", CONVERT),
    (b"$nod\n", "is a mesh of Gmsh in version 1", "save it with `Mesh.MshFileVersion = 4.1`"),
    (b"solid", "is a surface in STL", SURFACE),
    (b"ply\n", "is a surface in PLY", SURFACE),
    (b"off\n", "is a surface in OFF", SURFACE),
    (b"iso-10303-21", "is a geometry in STEP", MESH),
    (b"\x93numpy", "is an array of NumPy", "give the mesh"),
];

/// Beginnings of lines in a geometry of Gmsh.
const GEOMETRY: [&[u8]; 7] =
    [b"setfactory(", b"point(", b"point (", b"rectangle(", b"disk(", b"box(", b"include \""];

/// Bytes in which what a text says of its kind is looked for.
const LOOKED_AT: usize = 4096;
/// Bytes before the number of triangles in a binary file of STL, and bytes of a triangle.
const STL: [usize; 2] = [80, 50];

/// Tells the kind of a file that is no mesh of Gmsh from its contents, with a remedy.
pub(super) fn other_file(bytes: &[u8]) -> String {
    let (is, remedy) = recognised(bytes);
    format!("the file {is}; {remedy}")
}

/// Kind of a file, as the end of a sentence, and remedy.
fn recognised(bytes: &[u8]) -> (&'static str, &'static str) {
    let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes).trim_ascii_start();
    if text.is_empty() {
        return ("is empty", "save the mesh again");
    }
    let head = text[..text.len().min(LOOKED_AT)].to_ascii_lowercase();
    let known = BEGINNINGS.iter().find(|(beginning, ..)| begins(&head, beginning));
    if let Some(&(_, is, remedy)) = known {
        return (is, remedy);
    }
    if is_binary_stl(bytes) {
        return ("is a surface in STL", SURFACE);
    }
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    if lines.clone().any(|line| GEOMETRY.iter().any(|word| line.starts_with(word))) {
        return ("is a geometry of Gmsh", MESH);
    }
    if lines.any(|line| line.starts_with(b"v ")) {
        return ("is a surface in OBJ", SURFACE);
    }
    ("does not begin with $MeshFormat", "save the mesh with Gmsh as .msh")
}

/// True if a file in small letters begins so, with any end of a line, what stands before the root of XML aside.
fn begins(head: &[u8], beginning: &[u8]) -> bool {
    let mut rest = head;
    for (open, close) in [(&b"<?xml"[..], &b"?>"[..]), (b"<!--", b"-->")] {
        if rest.starts_with(open)
            && let Some(end) = rest.windows(close.len()).position(|window| window == close)
        {
            rest = rest[end + close.len()..].trim_ascii_start();
        }
    }
    match beginning.strip_suffix(b"\n") {
        None => rest.starts_with(beginning),
        Some(line) => {
            rest.split(|&byte| byte == b'\n').next().map(<[u8]>::trim_ascii) == Some(line)
        }
    }
}

/// True if the size of a file is that of the triangles that it promises.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let [head, triangle] = STL;
    let Some(count) = bytes.get(head..).and_then(<[u8]>::first_chunk) else { return false };
    let triangles = u32::from_le_bytes(*count) as usize;
    triangles > 0 && bytes.len() == head + count.len() + triangle * triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_in_the_place_of_a_mesh_is_named_with_what_helps() {
        let mut stl = [vec![b' '; 80], vec![1, 0, 0, 0], vec![7; 50]].concat();
        for (file, said) in [
            (
                &b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n"[..],
                "is a pointer of Git LFS; do `git lfs pull`",
            ),
            (b"", "is empty; save the mesh again"),
            (b" \r\n", "is empty; save the mesh again"),
            (
                b"\n<!DOCTYPE html>\n<html>",
                "is an HTML page, as of a failed download; download the mesh itself",
            ),
            (
                b"\x1f\x8b\x08\0",
                "is compressed by gzip; unpack it, and give the mesh that is inside",
            ),
            (b"PK\x03\x04", "is a ZIP archive; unpack it, and give the mesh that is inside"),
            (
                b"# vtk DataFile Version 2.0\n",
                "is a VTK file; convert it with `meshio convert FILE mesh.msh --output-format gmsh22`",
            ),
            (
                b"<?xml version=\"1.0\"?>\n<!-- disc -->\n<VTKFile type=\"UnstructuredGrid\">",
                "is a VTK file; convert it with `meshio convert FILE mesh.msh --output-format gmsh22`",
            ),
            (
                b"$NOD\r\n4\r\n",
                "is a mesh of Gmsh in version 1; save it with `Mesh.MshFileVersion = 4.1`",
            ),
            (
                b"// comment\nlc = 1;\nPoint(1) = {0, 0, 0, lc};\n",
                "is a geometry of Gmsh; mesh it with `gmsh -2 FILE -o mesh.msh`, in space with -3",
            ),
            (
                b"solid cube\nfacet normal",
                "is a surface in STL; mesh its inside, as a volume, in Gmsh, and save that as .msh",
            ),
            (
                &stl.clone(),
                "is a surface in STL; mesh its inside, as a volume, in Gmsh, and save that as .msh",
            ),
            (
                b"# made by hand\nv 0 0 0\nf 1 2 3\n",
                "is a surface in OBJ; mesh its inside, as a volume, in Gmsh, and save that as .msh",
            ),
            (b"\xff\xfe$\0M\0", "is text in UTF-16; save it as UTF-8"),
            (
                b"MeshFormat\n2.2 0 8\n",
                "does not begin with $MeshFormat; save the mesh with Gmsh as .msh",
            ),
        ] {
            assert_eq!(other_file(file), format!("the file {said}"));
        }
        stl.pop();
        assert!(!is_binary_stl(&stl));
    }
}
