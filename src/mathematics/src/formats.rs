//! Solutions as files for other programs: NPY and NPZ for NumPy, VTK image data for ParaView.

use crate::discrete::grid::Grid;
use crate::problem::source::Source;
use crate::saddle::Pair;

/// A solution on the square or the cube, x running fastest in every array.
pub struct Fields<'a> {
    /// Cells along x, y and z; none along an axis that is not there.
    cells: [usize; 3],
    f: Box<dyn Fn([f64; 3]) -> f64 + 'a>,
    boundary: Vec<usize>,
    pair: &'a Pair,
}

impl<'a> Fields<'a> {
    /// A solution on the square or, if `dimension` is 3, the cube with `n` cells per side: v, and its multiplier at
    /// the nodes `boundary`.
    pub fn new(
        dimension: u32,
        n: usize,
        f: impl Fn([f64; 3]) -> f64 + 'a,
        boundary: Vec<usize>,
        pair: &'a Pair,
    ) -> Self {
        let cells = [n, n, if dimension == 3 { n } else { 0 }];
        Self { cells, f: Box::new(f), boundary, pair }
    }

    /// A solution on the square, with its multiplier at the boundary nodes.
    pub fn square(grid: Grid, f: &'a Source, pair: &'a Pair) -> Self {
        let boundary = grid.boundary().collect();
        Self::new(2, grid.cells(), |[x, y, _]| f.at([x, y]), boundary, pair)
    }

    fn h(&self) -> f64 {
        1.0 / self.cells[0] as f64
    }

    /// The multiplier dv/dn at the nodes, zero inside.
    fn multiplier(&self) -> Vec<f64> {
        let mut multiplier = vec![0.0; self.pair.y.len()];
        self.boundary.iter().zip(&self.pair.a).for_each(|(&node, a)| multiplier[node] = *a);
        multiplier
    }

    /// f in the middle of each cell.
    fn f(&self) -> Vec<f64> {
        let (n, h) = (self.cells[0], self.h());
        let middle = |k: usize| [k % n, k / n % n, k / (n * n)].map(|k| (k as f64 + 0.5) * h - 0.5);
        let cells = self.shape(0).iter().product();
        (0..cells).map(|k| (self.f)(middle(k))).collect()
    }

    /// Lengths of an array with `more` entries than cells along each axis, the one along x last.
    fn shape(&self, more: usize) -> Vec<usize> {
        self.cells.iter().rev().filter(|n| **n > 0).map(|n| n + more).collect()
    }

    /// v alone, in NPY format.
    pub fn npy(&self) -> Vec<u8> {
        npy(&self.shape(1), &self.pair.y)
    }

    /// `v`, `multiplier` and `f` in NPZ format: NPY files in an archive that is not compressed.
    ///
    /// None if they do not fit into the four gigabytes that such an archive may have.
    pub fn npz(&self) -> Option<Vec<u8>> {
        let numbers: usize = [1, 1, 0].map(|more| self.shape(more).iter().product()).iter().sum();
        u32::try_from(8 * numbers + 4096).is_ok().then(|| {
            zip(&[
                ("v.npy", self.npy()),
                ("multiplier.npy", npy(&self.shape(1), &self.multiplier())),
                ("f.npy", npy(&self.shape(0), &self.f())),
            ])
        })
    }

    /// VTK XML image data: points with `v` and `multiplier`, cells with `f`; raw little-endian doubles.
    ///
    /// Axes without cells are at 0, the others centred there.
    pub fn vti(&self, name: &str) -> Vec<u8> {
        let along = |of_axis: &dyn Fn(usize) -> String| self.cells.map(of_axis).join(" ");
        let extent = along(&|n| format!("0 {n}"));
        let origin = along(&|n| if n > 0 { "-0.5".into() } else { "0".into() });
        let spacing = along(&|n| if n > 0 { self.h().to_string() } else { "1".into() });
        let (v, multiplier, f) = (&self.pair.y, &self.multiplier(), &self.f());
        let block = 8 + 8 * v.len();
        // Two hyphens end a comment of XML; of three, the first replacement leaves two.
        let name = name.replace("--", "- -").replace("--", "- -");
        let array = |name: &str, offset: usize| {
            format!(
                "<DataArray type=\"Float64\" Name=\"{name}\" format=\"appended\" offset=\"{offset}\"/>\n"
            )
        };
        let mut bytes = format!(
            "<?xml version=\"1.0\"?>\n<!-- {name}, solution v of the scalar Signorini problem -->\n\
            <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
            <ImageData WholeExtent=\"{extent}\" Origin=\"{origin}\" Spacing=\"{spacing}\">\n\
            <Piece Extent=\"{extent}\"><PointData Scalars=\"v\">\n{}{}\
            </PointData><CellData Scalars=\"f\">\n{}\
            </CellData></Piece></ImageData>\n<AppendedData encoding=\"raw\">\n_",
            array("v", 0),
            array("multiplier", block),
            array("f", 2 * block)
        )
        .into_bytes();
        for values in [v, multiplier, f] {
            bytes.extend((8 * values.len() as u64).to_le_bytes());
            bytes.extend(doubles(values));
        }
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }
}

fn doubles(values: &[f64]) -> impl Iterator<Item = u8> {
    values.iter().flat_map(|v| v.to_le_bytes())
}

/// NPY version 1.0: an array of little-endian doubles, the last index along x.
fn npy(shape: &[usize], values: &[f64]) -> Vec<u8> {
    let shape: Vec<_> = shape.iter().map(usize::to_string).collect();
    let shape = shape.join(", ");
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}");
    // The data must begin at a multiple of 64 bytes; magic, version and length take ten.
    header += &" ".repeat(63 - (10 + header.len()) % 64);
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(doubles(values));
    bytes
}

/// A ZIP archive of stored files (APPNOTE 6.3), without dates: the first day that the format knows.
fn zip(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    const DATE: u16 = 1 << 5 | 1;
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    let put = |out: &mut Vec<u8>, short: &[u16], long: &[u32]| {
        out.extend(short.iter().flat_map(|n| n.to_le_bytes()));
        out.extend(long.iter().flat_map(|n| n.to_le_bytes()));
    };
    for (name, bytes) in files {
        let (offset, size, long) = (archive.len() as u32, bytes.len() as u32, name.len() as u16);
        let sum = crc32(bytes);
        // Version 2.0, no flags, stored, time and date; then sum and sizes, and the length of the name.
        archive.extend(b"PK\x03\x04");
        put(&mut archive, &[20, 0, 0, 0, DATE], &[sum, size, size]);
        put(&mut archive, &[long, 0], &[]);
        archive.extend(name.bytes());
        archive.extend(bytes);
        directory.extend(b"PK\x01\x02");
        put(&mut directory, &[20, 20, 0, 0, 0, DATE], &[sum, size, size]);
        put(&mut directory, &[long, 0, 0, 0, 0], &[0, offset]);
        directory.extend(name.bytes());
    }
    let (count, offset) = (files.len() as u16, archive.len() as u32);
    let size = directory.len() as u32;
    archive.extend(directory);
    archive.extend(b"PK\x05\x06");
    put(&mut archive, &[0, 0, count, count], &[size, offset]);
    put(&mut archive, &[0], &[]);
    archive
}

/// The checksum of ZIP archives: CRC-32 of ISO 3309.
fn crc32(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut k = 0;
        while k < 256 {
            let (mut c, mut bit) = (k as u32, 0);
            while bit < 8 {
                c = if c & 1 == 1 { 0xedb8_8320 ^ (c >> 1) } else { c >> 1 };
                bit += 1;
            }
            table[k] = c;
            k += 1;
        }
        table
    };
    !bytes.iter().fold(!0, |c: u32, &byte| TABLE[((c ^ u32::from(byte)) & 255) as usize] ^ (c >> 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn the_multiplier_is_at_the_boundary_and_f_in_the_cells() {
        let grid = Grid::new(2).unwrap();
        let f: Source = "quadrant(ll)=3; else=-2".parse().unwrap();
        let pair = Pair { y: vec![1.0; 9], a: (1..=8).map(f64::from).collect() };
        let fields = Fields::square(grid, &f, &pair);
        assert_eq!(fields.f(), [3.0, -2.0, -2.0, -2.0]);
        // Row by row, where the boundary runs anticlockwise.
        assert_eq!(fields.multiplier(), [1.0, 2.0, 3.0, 8.0, 0.0, 4.0, 7.0, 6.0, 5.0]);
        let archive = fields.npz().unwrap();
        assert!(archive.starts_with(b"PK\x03\x04") && archive.len() > 25 * 8 + 3 * 128);
    }
}
