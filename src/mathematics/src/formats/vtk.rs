//! VTK XML files whose arrays are raw little-endian numbers after the text.

/// File that is being written.
pub(super) struct VtkFile {
    /// Text before the numbers.
    text: String,
    /// Arrays, each after the number of its bytes.
    data: Vec<u8>,
}

impl VtkFile {
    /// Begins a file of a VTK type on the solution of this name.
    pub(super) fn new(kind: &str, name: &str) -> Self {
        // Two hyphens end a comment of XML; of three, the first replacement leaves two.
        let name = name.replace("--", "- -").replace("--", "- -");
        let text = format!(
            "<?xml version=\"1.0\"?>\n<!-- {name}, solution v of the scalar Signorini problem -->\n\
            <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
        );
        Self { text, data: Vec::new() }
    }

    /// Adds tags.
    pub(super) fn tags(&mut self, tags: &str) {
        self.text += tags;
    }

    /// Adds an array of this type and name, with the bytes of each of the numbers.
    pub(super) fn array<const BYTES: usize>(
        &mut self,
        attributes: &str,
        numbers: impl Iterator<Item = [u8; BYTES]>,
    ) {
        let start = self.data.len();
        self.text += &format!("<DataArray {attributes} format=\"appended\" offset=\"{start}\"/>\n");
        self.data.extend([0; 8]);
        self.data.extend(numbers.flatten());
        let size = (self.data.len() - start - 8) as u64;
        self.data[start..start + 8].copy_from_slice(&size.to_le_bytes());
    }

    /// Returns the bytes of the file.
    pub(super) fn finish(self) -> Vec<u8> {
        let mut bytes = self.text.into_bytes();
        bytes.extend(b"<AppendedData encoding=\"raw\">\n_");
        bytes.extend(self.data);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }
}
