//! NPY version 1.0: an array of little-endian numbers, the last index running fastest.

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
