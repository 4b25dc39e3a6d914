//! The graph of tasks: who needs whom, without the work, as text for programs that draw graphs.

use super::Task;
use serde::Serialize;
use std::collections::BTreeMap;

/// The tasks of a plan and what each needs.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Graph {
    /// The tasks, each after all it needs.
    pub nodes: Vec<Node>,
}

/// A task, reduced to its place in the graph.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Node {
    /// Id of the task.
    pub id: String,
    /// Ids of the tasks it needs.
    pub needs: Vec<String>,
}

impl Node {
    /// The node of a task.
    pub fn of(task: &Task) -> Self {
        Self { id: task.id.clone(), needs: task.needs.clone() }
    }
}

impl Graph {
    /// Edges as (needed, needing).
    pub fn edges(&self) -> impl Iterator<Item = (&str, &str)> {
        self.nodes
            .iter()
            .flat_map(|node| node.needs.iter().map(move |need| (need.as_str(), node.id.as_str())))
    }

    /// For Mermaid, which draws it in Markdown.
    pub fn mermaid(&self) -> String {
        let number: BTreeMap<&str, usize> =
            self.nodes.iter().enumerate().map(|(k, node)| (node.id.as_str(), k)).collect();
        let mut text = String::from("graph LR\n");
        self.nodes
            .iter()
            .enumerate()
            .for_each(|(k, node)| text += &format!("  t{k}[\"{}\"]\n", node.id));
        self.edges()
            .for_each(|(from, to)| text += &format!("  t{} --> t{}\n", number[from], number[to]));
        text
    }

    /// For Graphviz.
    pub fn dot(&self) -> String {
        let mut text = String::from("digraph signorini {\n  rankdir=LR; node [shape=box];\n");
        self.nodes.iter().for_each(|node| text += &format!("  \"{}\";\n", node.id));
        self.edges().for_each(|(from, to)| text += &format!("  \"{from}\" -> \"{to}\";\n"));
        text + "}\n"
    }
}
