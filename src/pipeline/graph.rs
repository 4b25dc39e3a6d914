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
        self.0.iter().for_each(|(id, _)| {
            text += &format!("  t{}[\"{}\"]\n", number[&**id], in_mermaid(id));
        });
        self.edges()
            .for_each(|(from, to)| text += &format!("  t{} --> t{}\n", number[from], number[to]));
        text
    }

    /// For Graphviz.
    pub fn dot(&self) -> String {
        let mut text = String::from("digraph signorini {\n  rankdir=LR; node [shape=box];\n");
        self.0.iter().for_each(|(id, _)| text += &format!("  {};\n", in_dot(id)));
        self.edges()
            .for_each(|(from, to)| text += &format!("  {} -> {};\n", in_dot(from), in_dot(to)));
        text + "}\n"
    }
}

/// A name as Graphviz reads it.
fn in_dot(id: &str) -> String {
    format!("\"{}\"", id.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A name as Mermaid reads it between quotes: what could end it, or be taken for markup, by its number.
fn in_mermaid(id: &str) -> String {
    let marks = "\"#&;<>`\\";
    let escaped = |c: char| match marks.contains(c) || c.is_control() {
        true => format!("#{};", u32::from(c)),
        false => c.to_string(),
    };
    id.chars().map(escaped).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quoted names in a text for Graphviz, by its rules: a backslash takes the character after it along.
    fn quoted(dot: &str) -> Vec<String> {
        let (mut names, mut open, mut chars) = (Vec::new(), None::<String>, dot.chars());
        while let Some(c) = chars.next() {
            match (&mut open, c) {
                (None, '"') => open = Some(String::new()),
                (None, _) => {}
                (Some(_), '"') => names.extend(open.take()),
                (Some(name), '\\') => name.extend(chars.next()),
                (Some(name), c) => name.push(c),
            }
        }
        assert_eq!(open, None, "{dot}");
        names
    }

    /// The labels in a text for Mermaid, which ends them at a quote and reads numbers between `#` and `;`.
    fn labels(mermaid: &str) -> Vec<String> {
        let label = |line: &str| {
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
        };
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
        let mut graph = Graph(all.iter().map(|id| (id.clone(), Vec::new())).collect());
        assert_eq!(quoted(&graph.dot()), all);
        assert_eq!(labels(&graph.mermaid()), all);
        graph.0.push(("last".into(), all.clone()));
        let pairs = all.iter().flat_map(|id| [id.clone(), "last".into()]);
        let wanted: Vec<String> = all.iter().cloned().chain(["last".into()]).chain(pairs).collect();
        assert_eq!(quoted(&graph.dot()), wanted);
        assert_eq!(graph.mermaid().lines().filter(|line| line.ends_with(" --> t8")).count(), 8);
    }
}
