//! VTK XML files whose arrays are raw little-endian numbers after the text.

use crate::problem::text::is_forbidden;

/// Returns a text as the value of an attribute.
pub(super) fn escaped(text: &str) -> String {
    let text = text.replace(is_forbidden, " ").replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// Arrays of a file, each after the number of its bytes.
#[derive(Default)]
pub(super) struct Appended {
    data: Vec<u8>,
}

impl Appended {
    /// Adds an array with the bytes of each of its numbers. Returns the tag of the array, with these attributes.
    pub(super) fn array<const BYTES: usize>(
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

    /// Returns a file of a VTK type on the solution of this name, with the tags of the arrays in `body`.
    pub(super) fn file(self, kind: &str, name: &str, body: &str) -> Vec<u8> {
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
