//! The graph of tasks as a small picture inside a page, in the reader's colours.

use crate::pipeline::{Graph, Node};
use std::collections::{BTreeMap, BTreeSet};

/// Width of a column, of the box in it, height of a row and of the box in it, in display pixels.
const COLUMN: usize = 138;
const BOX: usize = 112;
const ROW: usize = 25;
const TALL: usize = 20;
/// Height of the line with the names of the stages.
const HEAD: usize = 28;

/// Draws the graph as an SVG element: a column per stage, a lane per scene.
///
/// The figures of a scene are one box, and so are its solves and its tables. A line that follows from
/// others is left out, or those to the book would hide all else.
pub(super) fn picture(graph: &Graph) -> String {
    let groups = groups(graph);
    let mut stages: Vec<&str> = groups.iter().map(|group| group.key.0).collect();
    stages.dedup();
    let rows = rows(&groups);
    let most = rows.values().max().map_or(1, |row| row + 1);
    let (width, height) = (COLUMN * stages.len() - (COLUMN - BOX) + 2, HEAD + ROW * most);
    let left = |stage: &str| 1 + COLUMN * stages.iter().position(|s| *s == stage).unwrap_or(0);
    let middle = |key: &Key| match rows.get(key) {
        Some(row) => HEAD + ROW * row + TALL / 2 + 1,
        None => (HEAD + height) / 2,
    };

    let mut svg = format!(
        r#"<svg class="graph" viewBox="0 0 {width} {height}" role="img" aria-label="Graph of the tasks, stage by stage">"#
    );
    for (from, to) in &essential(&groups, graph) {
        let (x0, y0, x1, y1) = (left(from.0) + BOX, middle(from), left(to.0), middle(to));
        // Lines change their row in a gap between columns, and run straight otherwise: to the book
        // in the last gap, elsewhere in the first, so that they pass no box that lies between.
        let gap = COLUMN - BOX;
        let (bend, end) = if rows.contains_key(to) { (x0, x0 + gap) } else { (x1 - gap, x1) };
        let half = (bend + end) / 2;
        svg += &format!(r#"<path d="M{x0} {y0}H{bend}C{half} {y0} {half} {y1} {end} {y1}H{x1}"/>"#);
    }
    for &stage in &stages {
        let x = left(stage) + BOX / 2;
        svg += &format!(r#"<text class="stage" x="{x}" y="14">{stage}</text>"#);
    }
    for group in &groups {
        let (x, y) = (left(group.key.0), middle(&group.key));
        let (top, centre, base) = (y - TALL / 2, x + BOX / 2, y + 4);
        let count = if group.tasks > 1 { format!(" × {}", group.tasks) } else { String::new() };
        svg += &format!(
            r#"<rect x="{x}" y="{top}" width="{BOX}" height="{TALL}" rx="4"/><text x="{centre}" y="{base}">{}{count}</text>"#,
            group.key.1
        );
    }
    svg + "</svg>"
}

/// Stage and lane: what is drawn as one box.
type Key<'a> = (&'a str, &'a str);

struct Group<'a> {
    key: Key<'a>,
    tasks: usize,
}

/// The part of an id after the stage.
fn name(id: &str) -> &str {
    id.split('/').nth(1).unwrap_or(id)
}

/// A figure of one scene belongs to that scene; one of several, or of none, stands alone.
fn key(node: &Node) -> Key<'_> {
    let mut scenes: Vec<&str> = node.needs.iter().map(|need| name(need)).collect();
    scenes.dedup();
    match scenes[..] {
        [scene] if node.stage() == "figures" => (node.stage(), scene),
        _ => (node.stage(), name(&node.id)),
    }
}

fn groups(graph: &Graph) -> Vec<Group<'_>> {
    let mut groups: Vec<Group> = Vec::new();
    for node in &graph.nodes {
        let key = key(node);
        match groups.iter_mut().find(|group| group.key == key) {
            Some(group) => group.tasks += 1,
            None => groups.push(Group { key, tasks: 1 }),
        }
    }
    groups
}

/// The row of each box except the book's: first those that stand alone, then two rows to a scene.
fn rows<'a>(groups: &[Group<'a>]) -> BTreeMap<Key<'a>, usize> {
    let drawn = || groups.iter().map(|group| group.key).filter(|key| key.0 != "report");
    let mut lanes: Vec<(usize, &str)> = Vec::new();
    for (_, lane) in drawn() {
        if lanes.iter().all(|(_, known)| *known != lane) {
            lanes.push((drawn().filter(|key| key.1 == lane).count(), lane));
        }
    }
    // After the lanes of one box, the fullest come first: what they feed lies above them.
    lanes.sort_by_key(|(boxes, _)| if *boxes == 1 { 0 } else { usize::MAX - boxes });
    let mut rows = BTreeMap::new();
    let mut next = 0;
    for (_, lane) in lanes {
        // What is drawn or searched from solves goes below, out of the way from tables to the book.
        let below = |key: &Key| matches!(key.0, "figures" | "identify");
        let (lower, upper): (Vec<Key>, Vec<Key>) =
            drawn().filter(|key| key.1 == lane).partition(below);
        for row in [upper, lower].into_iter().filter(|row| !row.is_empty()) {
            rows.extend(row.into_iter().map(|key| (key, next)));
            next += 1;
        }
    }
    rows
}

/// The edges between groups that do not follow from others.
fn essential<'a>(groups: &[Group<'a>], graph: &'a Graph) -> Vec<(Key<'a>, Key<'a>)> {
    let by_id: BTreeMap<&str, Key> =
        graph.nodes.iter().map(|node| (node.id.as_str(), key(node))).collect();
    let edges: BTreeSet<(Key, Key)> =
        graph.edges().map(|(from, to)| (by_id[from], by_id[to])).collect();
    // Groups come after all they need, so that one walk finds all that each needs, at any remove.
    let mut needs: BTreeMap<Key, BTreeSet<Key>> = BTreeMap::new();
    for group in groups {
        let mut all = BTreeSet::new();
        for (from, _) in edges.iter().filter(|(_, to)| *to == group.key) {
            all.insert(*from);
            all.extend(needs.get(from).into_iter().flatten());
        }
        needs.insert(group.key, all);
    }
    let follows = |(from, to): &(Key, Key)| {
        edges.iter().any(|(between, end)| end == to && needs[between].contains(from))
    };
    edges.iter().filter(|edge| !follows(edge)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_are_grouped_and_implied_lines_left_out() {
        let node = |id: &str, needs: &[&str]| Node {
            id: id.into(),
            needs: needs.iter().map(|need| (*need).to_owned()).collect(),
        };
        let graph = Graph {
            nodes: vec![
                node("solve/a/signed/r=1", &[]),
                node("solve/a/signed/r=2", &[]),
                node("tabulate/a/signed", &["solve/a/signed/r=1", "solve/a/signed/r=2"]),
                node("figures/a-surface", &["solve/a/signed/r=1"]),
                node(
                    "report/book",
                    &["tabulate/a/signed", "figures/a-surface", "solve/a/signed/r=1"],
                ),
            ],
        };
        let edges = essential(&groups(&graph), &graph);
        let [solve, table] = [("solve", "a"), ("tabulate", "a")];
        let picture_of_a = ("figures", "a");
        let book = ("report", "book");
        let want = [(picture_of_a, book), (solve, picture_of_a), (solve, table), (table, book)];
        assert_eq!(edges, want);
        let rows = rows(&groups(&graph));
        assert_eq!((rows[&solve], rows[&table], rows[&picture_of_a]), (0, 0, 1));
        let svg = picture(&graph);
        assert!(svg.contains(">a × 2</text>"), "{svg}");
        assert_eq!(svg.matches("<path").count(), 4);
    }
}
