//! Files in the place of tables and pictures of scenes that failed, which say why.

use crate::figures::escaped;
use crate::pipeline::{Artifacts, Task};
use crate::replication::stages::{Stage, scene_of};
use crate::table::in_markdown;
use std::collections::BTreeMap;

/// Most letters in a line of a picture.
const LETTERS: usize = 80;

/// Returns the paths in the pages of what the `tasks` of scenes would make for them, each with the reason why its scene
/// has `failed`.
pub(crate) fn stand_ins(
    tasks: &[Task],
    failed: &BTreeMap<String, String>,
) -> BTreeMap<String, String> {
    let mut reasons = BTreeMap::new();
    for id in tasks.iter().map(|task| &*task.id) {
        let (Some(reason), Some((_, name))) =
            (scene_of(id).and_then(|scene| failed.get(scene)), id.split_once('/'))
        else {
            continue;
        };
        let paths = match Stage::of(id) {
            Some(Stage::Tabulate) => {
                vec![format!("tables/{name}.md"), format!("tables/{name}.csv")]
            }
            Some(Stage::Figures) => vec![format!("figures/{name}.svg")],
            _ => Vec::new(),
        };
        reasons.extend(paths.into_iter().map(|path| (path, reason.clone())));
    }
    reasons
}

/// Returns the files, each of which says the reason.
pub(super) fn files(stand_ins: &BTreeMap<String, String>) -> Artifacts {
    let mut files = Artifacts::new();
    for (path, reason) in stand_ins {
        let text = format!("Not there: {reason}");
        let text = match path.rsplit_once('.') {
            Some((_, "svg")) => picture(&text),
            Some((_, "csv")) => format!("error\n\"{}\"\n", text.replace('"', "\"\"")),
            _ => format!("*{}*\n", in_markdown(&text)),
        };
        files.insert(format!("src/{path}"), text.into_bytes());
    }
    files
}

/// Picture of a sentence.
fn picture(sentence: &str) -> String {
    let mut lines = vec![String::new()];
    for word in sentence.split_whitespace() {
        if lines[lines.len() - 1].len() + word.len() > LETTERS {
            lines.push(String::new());
        }
        let last = lines.len() - 1;
        lines[last] += &format!("{word} ");
    }
    let spans =
        lines.iter().map(|line| format!("<tspan x=\"8\" dy=\"20\">{}</tspan>", escaped(line)));
    let (spans, height) = (spans.collect::<String>(), 20 * lines.len() + 16);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"800\" height=\"{height}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text y=\"0\" font-family=\"sans-serif\" font-size=\"14\">{spans}</text>\n</svg>\n"
    )
}
