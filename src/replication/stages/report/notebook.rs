//! The notebook of `src/python` as the cells of a page, with the outputs that it keeps.

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Notebook, as JSON.
const NOTEBOOK: &str = include_str!("../../../python/signorini.ipynb");

/// NotebookCell of the notebook.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct NotebookCell {
    /// True for Python, else Markdown.
    is_code: bool,
    source: String,
    /// Text that the cell prints, or that of its value.
    output: String,
    /// Picture that is its value, in SVG.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) picture: Option<String>,
}

/// Returns the cells in their order.
///
/// # Panics
/// If the file is no notebook, which the tests run.
pub(super) fn cells() -> Vec<NotebookCell> {
    let notebook: Value = serde_json::from_str(NOTEBOOK).expect("the notebook is JSON");
    let cells = notebook["cells"].as_array().expect("a notebook has cells");
    cells.iter().map(NotebookCell::of).collect()
}

impl NotebookCell {
    fn of(cell: &Value) -> Self {
        let mut read = Self {
            is_code: cell["cell_type"] == "code",
            source: joined(&cell["source"]),
            ..Self::default()
        };
        for output in cell["outputs"].as_array().into_iter().flatten() {
            let data = &output["data"];
            read.output += &joined(&output["text"]);
            match data.get("image/svg+xml") {
                Some(svg) => read.picture = Some(joined(svg)),
                None => read.output += &joined(&data["text/plain"]),
            }
        }
        read
    }
}

/// Returns the lines of a text in a notebook as one; empty if there are none.
fn joined(lines: &Value) -> String {
    lines.as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}
