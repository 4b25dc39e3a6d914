//! The graph of tasks: who needs whom, without the work, as text for programs that draw graphs.

use super::Task;
use serde::Serialize;
use std::collections::BTreeMap;

/// Ids of tasks, each after all it needs, with the ids of these.
#[derive(Clone, Debug, Serialize)]
pub struct Graph(pub Vec<(String, Vec<String>)>);

impl Graph {
    /// The graph of these tasks.
    pub fn of(tasks: &[Task]) -> Self {
        Self(tasks.iter().map(|task| (task.id.clone(), task.needs.clone())).collect())
    }

    /// Edges as (needed, needing).
    fn edges(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().flat_map(|(id, needs)| needs.iter().map(move |need| (&**need, &**id)))
    }

    /// For Mermaid, which draws it in Markdown.
    pub fn mermaid(&self) -> String {
        let number: BTreeMap<&str, usize> = self.0.iter().map(|(id, _)| &**id).zip(0..).collect();
        let mut text = String::from("graph LR\n");
        self.0.iter().for_each(|(id, _)| text += &format!("  t{}[\"{id}\"]\n", number[&**id]));
        self.edges()
            .for_each(|(from, to)| text += &format!("  t{} --> t{}\n", number[from], number[to]));
        text
    }

    /// For Graphviz.
    pub fn dot(&self) -> String {
        let mut text = String::from("digraph signorini {\n  rankdir=LR; node [shape=box];\n");
        self.0.iter().for_each(|(id, _)| text += &format!("  \"{id}\";\n"));
        self.edges().for_each(|(from, to)| text += &format!("  \"{from}\" -> \"{to}\";\n"));
        text + "}\n"
    }
}
