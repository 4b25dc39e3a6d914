//! Keys of a scene besides the fields of its statement.

use crate::figures::Print;
use crate::replication::fields::lists::Products;
use crate::replication::fields::table::{Reading, Refused};
use crate::replication::output::Output;
use crate::replication::study::ChartFields;
use serde::Deserialize;

/// Keys of a scene besides the fields of its statement.
#[derive(Deserialize)]
pub(super) struct SceneKeys {
    pub(super) title: String,
    /// Number of the published table with which the scene is compared.
    pub(super) paper_table: Option<u8>,
    pub(super) outputs: Vec<Output>,
    /// Values of fields, and of names in f, that are varied.
    pub(super) vary: Option<Products>,
    /// r whose solution is drawn.
    pub(super) draw_r: Option<f64>,
    /// Width of pictures in print, and whether they have titles.
    pub(super) picture: Option<Print>,
    /// Axes of the chart of a study.
    pub(super) chart: Option<ChartFields>,
    /// Columns of the table of a study.
    pub(super) columns: Option<Vec<String>>,
}

/// Names of the [`SceneKeys`].
pub(super) const SCENE_KEYS: [&str; 8] =
    ["title", "paper_table", "outputs", "vary", "draw_r", "picture", "chart", "columns"];

impl SceneKeys {
    /// Refuses outputs and keys that only a study has, or that a study does not have.
    pub(super) fn check_outputs(&self, is_study: bool) -> Reading<()> {
        if is_study && self.draw_r.is_some() {
            let text = "`draw_r` is of the pictures of one solution; leave it out of a study";
            return Err(Refused::new("draw_r", text));
        }
        let has_axes = self.chart.is_some();
        if !is_study && self.columns.is_some() {
            let text = "`columns` are of a study; add `vary`, or leave them out";
            return Err(Refused::new("columns", text));
        }
        let mut outputs = self.outputs.iter();
        let other = outputs.find(|output| ![Output::Table, Output::Chart].contains(*output));
        let text = match (is_study, self.outputs.contains(&Output::Chart)) {
            (false, true) => "`chart` shows a study; add `vary`, or drop it from `outputs`".into(),
            (false, false) if has_axes => {
                "`chart` is of a study; add `vary`, or leave it out".into()
            }
            (true, false) if has_axes => {
                "`chart` has axes; add \"chart\" to `outputs`, or leave it out".into()
            }
            (true, _) => match other {
                None => return Ok(()),
                Some(output) => format!(
                    "`{output}` shows one solution; a study has \"table\" and \"chart\": drop it from `outputs`"
                ),
            },
            (false, false) => return Ok(()),
        };
        Err(Refused::new("outputs", text))
    }
}
