//! Files that stand in the place of a mesh, told by their first bytes.

/// Bytes that some editors put before a text.
pub(super) const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Beginnings of files after blanks, in small letters, each with the kind of the file and a remedy.
const BEGINNINGS: [(&[u8], &str, &str); 7] = [
    (b"version https://git-lfs.github.com/", "is a pointer of Git LFS", "do `git lfs pull`"),
    (b"/annex/objects/", "is a pointer of git-annex", "do `git annex get FILE`"),
    (b"<!doctype html", "is an HTML page, as of a failed download", "download the mesh itself"),
    (b"<html", "is an HTML page, as of a failed download", "download the mesh itself"),
    (b"\x1f\x8b", "is compressed by gzip", "unpack it, and give the mesh that is inside"),
    (b"pk\x03\x04", "is a ZIP archive", "unpack it, and give the mesh that is inside"),
    (b"$nod", "is a mesh of Gmsh in version 1", "save it with `Mesh.MshFileVersion = 4.1`"),
];

/// Beginnings of lines in a geometry of Gmsh.
const GEOMETRY: [&[u8]; 7] =
    [b"setfactory(", b"point(", b"point (", b"rectangle(", b"disk(", b"box(", b"include \""];

/// Bytes in which what a text says of its kind is looked for.
const LOOKED_AT: usize = 4096;

/// Tells the kind of a file that is no mesh of Gmsh from its contents, with a remedy.
pub(super) fn other_file(bytes: &[u8]) -> String {
    let text = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes).trim_ascii_start();
    let head = text[..text.len().min(LOOKED_AT)].to_ascii_lowercase();
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let known = BEGINNINGS.iter().find(|(beginning, ..)| head.starts_with(beginning));
    let (is, remedy) = match known {
        Some(&(_, is, remedy)) => (is, remedy),
        None if text.is_empty() => ("is empty", "save the mesh again"),
        None if lines.any(|line| GEOMETRY.iter().any(|word| line.starts_with(word))) => {
            ("is a geometry of Gmsh", "mesh it with `gmsh -2 FILE -o mesh.msh`, in space with -3")
        }
        None => (
            "does not begin with $MeshFormat",
            "save the mesh with Gmsh as .msh, or convert it with `meshio convert FILE mesh.msh --output-format gmsh22`",
        ),
    };
    format!("the file {is}; {remedy}")
}
