//! Graph of tasks and their needs, as text for programs that draw graphs.

use super::Task;
use std::collections::BTreeMap;

/// Returns the graph of these tasks, each after all that it needs, as text for Mermaid, which draws it in Markdown.
pub fn mermaid(tasks: &[Task]) -> String {
    let number: BTreeMap<&str, usize> = tasks.iter().map(|task| &*task.id).zip(0..).collect();
    let mut text = String::from("graph LR\n");
    for Task { id, .. } in tasks {
        text += &format!("  t{}[\"{}\"]\n", number[&**id], in_mermaid(id));
    }
    for Task { id, needs, .. } in tasks {
        for need in needs {
            text += &format!("  t{} --> t{}\n", number[&**need], number[&**id]);
        }
    }
    text
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
    use crate::Artifacts;

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
        let task = |id: &str, needs| Task::new(id, &(), needs, |(), _| Ok(Artifacts::new()));
        let mut tasks: Vec<Task> = all.iter().map(|id| task(id, Vec::new())).collect();
        assert_eq!(labels(&mermaid(&tasks)), all);
        tasks.push(task("last", all));
        assert_eq!(mermaid(&tasks).lines().filter(|line| line.ends_with(" --> t8")).count(), 8);
    }
}
