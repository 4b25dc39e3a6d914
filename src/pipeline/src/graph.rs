//! Graph of tasks and their needs, as text for programs that draw graphs.

use super::Task;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Nodes of the graph, each after all that it needs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Graph(pub Vec<GraphNode>);

/// Task with its needs.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GraphNode {
    /// Id of the task.
    pub id: String,
    /// Ids of the tasks that it needs.
    pub needs: Vec<String>,
}

impl Graph {
    /// Returns the graph of these tasks.
    pub fn of(tasks: &[Task]) -> Self {
        let nodes = tasks.iter();
        Self(nodes.map(|Task { id, needs, .. }| GraphNode::new(id, needs)).collect())
    }

    /// Returns the graph as text for Mermaid, which draws it in Markdown.
    pub fn mermaid(&self) -> String {
        let number: BTreeMap<&str, usize> = self.0.iter().map(|node| &*node.id).zip(0..).collect();
        let mut text = String::from("graph LR\n");
        for GraphNode { id, .. } in &self.0 {
            text += &format!("  t{}[\"{}\"]\n", number[&**id], in_mermaid(id));
        }
        for GraphNode { id, needs } in &self.0 {
            for need in needs {
                text += &format!("  t{} --> t{}\n", number[&**need], number[&**id]);
            }
        }
        text
    }
}

impl GraphNode {
    /// Returns the node of a task.
    pub fn new(id: &str, needs: &[String]) -> Self {
        Self { id: id.into(), needs: needs.to_vec() }
    }
}

/// Escapes a name for Mermaid, to be put between quotes: characters that could end the name, or be read as markup, are
/// written as numbers.
fn in_mermaid(id: &str) -> String {
    let mut text = String::new();
    for c in id.chars() {
        if "\"#&;<>`\\".contains(c) || c.is_control() {
            text += &format!("#{};", u32::from(c));
        } else {
            text.push(c);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the label in a line for Mermaid, which ends it at a quote and reads numbers between `#` and `;`.
    fn label(line: &str) -> Option<String> {
        let (_, rest) = line.split_once("[\"")?;
        let (label, rest) = rest.split_once('"')?;
        assert_eq!(rest, "]", "{line}");
        let mut parts = label.split('#');
        let mut read = parts.next()?.to_owned();
        for part in parts {
            let (number, rest) = part.split_once(';')?;
            read.push(char::from_u32(number.parse().ok()?)?);
            read += rest;
        }
        Some(read)
    }

    fn labels(mermaid: &str) -> Vec<String> {
        mermaid.lines().filter_map(label).collect()
    }

    #[test]
    fn names_are_read_back_whatever_is_in_them() {
        let names = [
            "a/plain=1.5",
            "a/x \"y\"",
            "a/back\\slash\\",
            "a/\\\"",
            "a/[b](c){d}",
            "a/#35;&quot;`<b>;",
            "a/-->|x|",
            "a/é it's $HOME %x",
        ];
        let all: Vec<String> = names.map(str::to_owned).to_vec();
        let mut graph = Graph(all.iter().map(|id| GraphNode::new(id, &[])).collect());
        assert_eq!(labels(&graph.mermaid()), all);
        graph.0.push(GraphNode::new("last", &all));
        assert_eq!(graph.mermaid().lines().filter(|line| line.ends_with(" --> t8")).count(), 8);
    }
}
