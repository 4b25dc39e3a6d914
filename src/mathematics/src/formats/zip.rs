//! ZIP archives (APPNOTE 6.3), without dates. Files are compressed where that makes them a quarter as long: values with
//! all their digits hardly get shorter, and stored as they are they are read in place. Files in NPY version 1.0: an
//! array of little-endian numbers, the last index running fastest.

use miniz_oxide::deflate::compress_to_vec;

/// First day that the format knows.
const DATE: u16 = 1 << 5 | 1;
/// Effort of the compression, from 1 to 10.
const EFFORT: u8 = 1;
/// Number of the method of files stored as they are.
const STORED: u16 = 0;
/// Number of the method of compressed files.
const DEFLATED: u16 = 8;
/// Bytes for what an archive has beside the numbers: names, and headers of files.
const HEADERS: usize = 4096;

/// True if so many numbers of eight bytes, in a few files, fit into the four gigabytes that an archive may have.
pub(super) fn fits(numbers: usize) -> bool {
    u32::try_from(8 * numbers + HEADERS).is_ok()
}

/// Archive of files, each with its name.
pub(super) fn zip(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let (mut archive, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let (offset, size, long) = (archive.len() as u32, bytes.len() as u32, name.len() as u16);
        let sum = crc32(bytes);
        let shorter = compress_to_vec(bytes, EFFORT);
        let (method, body) =
            if 4 * shorter.len() <= bytes.len() { (DEFLATED, &shorter) } else { (STORED, bytes) };
        let kept = body.len() as u32;
        // Version 2.0, no flags, method, time and date; then sum and sizes, and the length of the name.
        archive.extend(b"PK\x03\x04");
        put(&mut archive, &[20, 0, method, 0, DATE], &[sum, kept, size]);
        put(&mut archive, &[long, 0], &[]);
        archive.extend(name.bytes());
        archive.extend(body);
        directory.extend(b"PK\x01\x02");
        put(&mut directory, &[20, 20, 0, method, 0, DATE], &[sum, kept, size]);
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

/// Adds little-endian numbers of two and of four bytes.
fn put(out: &mut Vec<u8>, short: &[u16], long: &[u32]) {
    out.extend(short.iter().flat_map(|n| n.to_le_bytes()));
    out.extend(long.iter().flat_map(|n| n.to_le_bytes()));
}

/// Checksum of ZIP archives: CRC-32 of ISO 3309.
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

/// NumPy's name of a little-endian double.
pub(super) const DOUBLE: &str = "<f8";
/// NumPy's name of a little-endian integer of 16 bits without a sign.
pub(super) const SHORT: &str = "<u2";
/// NumPy's name of a little-endian integer of 64 bits.
pub(super) const INTEGER: &str = "<i8";

/// Returns an array of this shape as a file; `number` is NumPy's name of the type of the numbers.
pub(super) fn npy<const BYTES: usize>(
    number: &str,
    shape: &[usize],
    numbers: impl Iterator<Item = [u8; BYTES]>,
) -> Vec<u8> {
    let lengths: Vec<_> = shape.iter().map(usize::to_string).collect();
    // Without a comma, one number in parentheses is no tuple.
    let comma = if shape.len() == 1 { "," } else { "" };
    let shape = lengths.join(", ") + comma;
    let mut header =
        format!("{{'descr': '{number}', 'fortran_order': False, 'shape': ({shape}), }}");
    // The data must begin at a multiple of 64 bytes; magic, version and length take ten.
    header += &" ".repeat(63 - (10 + header.len()) % 64);
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(numbers.flatten());
    bytes
}

/// Little-endian bytes of each number.
pub(super) fn doubles(values: &[f64]) -> impl Iterator<Item = [u8; 8]> {
    values.iter().map(|value| value.to_le_bytes())
}

/// Little-endian bytes of each number, as an integer of 64 bits.
pub(super) fn integers(values: Vec<u32>) -> impl Iterator<Item = [u8; 8]> {
    values.into_iter().map(|value| i64::from(value).to_le_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_the_standard() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }
}
