//! The graph of tasks as a small picture inside a page, in the reader's colours.

use crate::pipeline::Graph;
use std::collections::{BTreeMap, BTreeSet};

/// Width of a column, of the box in it, height of a row and of the box in it, in display pixels.
const COLUMN: usize = 150;
const BOX: usize = 118;
const ROW: usize = 26;
const TALL: usize = 20;
/// Height of the line with the names of the stages.
const HEAD: usize = 26;

/// Draws the graph as an SVG element: a column per stage, a box per stage and scene or figure.
///
/// A line that follows from others is left out, or those to the book would hide all else.
pub(super) fn picture(graph: &Graph) -> String {
    let groups = groups(graph);
    let edges = essential(&groups, graph);
    let stages: Vec<&str> = groups.iter().fold(Vec::new(), |mut stages, group| {
        if stages.last() != Some(&group.stage) {
            stages.push(group.stage);
        }
        stages
    });
    let rows = |stage: &str| groups.iter().filter(|group| group.stage == stage).count();
    let most = stages.iter().map(|stage| rows(stage)).max().unwrap_or(0);
    let (width, height) = (COLUMN * stages.len() - (COLUMN - BOX) + 2, HEAD + ROW * most);

    // Left end and middle line of each box; short columns are centred.
    let mut places = BTreeMap::new();
    for (column, stage) in stages.iter().enumerate() {
        let of_stage = groups.iter().filter(|group| group.stage == *stage);
        let above = (most - rows(stage)) * ROW / 2;
        for (row, group) in of_stage.enumerate() {
            let place = (1 + column * COLUMN, HEAD + above + row * ROW + TALL / 2 + 1);
            places.insert(group.key, place);
        }
    }
    let mut svg = format!(
        r#"<svg class="graph" viewBox="0 0 {width} {height}" width="{width}" height="{height}" role="img" aria-label="Graph of the tasks, stage by stage">"#
    );
    for (from, to) in &edges {
        let ((x0, y0), (x1, y1)) = (places[from], places[to]);
        let (x0, middle) = (x0 + BOX, (x0 + BOX + x1) / 2);
        // Drawn before the boxes: a line that skips a column passes behind those in it.
        svg += &format!(r#"<path d="M{x0} {y0}C{middle} {y0} {middle} {y1} {x1} {y1}"/>"#);
    }
    for (column, stage) in stages.iter().enumerate() {
        let x = 1 + column * COLUMN + BOX / 2;
        svg += &format!(r#"<text class="stage" x="{x}" y="14">{stage}</text>"#);
    }
    for group in &groups {
        let (x, y) = places[group.key];
        let (top, middle, base) = (y - TALL / 2, x + BOX / 2, y + 4);
        let name = group.key.split_once('/').map_or(group.key, |(_, name)| name);
        let count = if group.tasks > 1 { format!(" × {}", group.tasks) } else { String::new() };
        svg += &format!(
            r#"<rect x="{x}" y="{top}" width="{BOX}" height="{TALL}" rx="4"/><text x="{middle}" y="{base}">{name}{count}</text>"#
        );
    }
    svg + "</svg>"
}

/// Tasks that are drawn as one box.
struct Group<'a> {
    /// The first two parts of their ids: stage and scene, or stage and figure.
    key: &'a str,
    stage: &'a str,
    tasks: usize,
}

fn key(id: &str) -> &str {
    let end = id.match_indices('/').nth(1).map_or(id.len(), |(at, _)| at);
    &id[..end]
}

fn groups(graph: &Graph) -> Vec<Group<'_>> {
    let mut groups: Vec<Group> = Vec::new();
    for node in &graph.nodes {
        let key = key(&node.id);
        match groups.iter_mut().find(|group| group.key == key) {
            Some(group) => group.tasks += 1,
            None => groups.push(Group { key, stage: node.stage.name(), tasks: 1 }),
        }
    }
    groups
}

/// The edges between groups that do not follow from others.
fn essential<'a>(groups: &[Group<'a>], graph: &'a Graph) -> Vec<(&'a str, &'a str)> {
    let edges: BTreeSet<(&str, &str)> =
        graph.edges().map(|(from, to)| (key(from), key(to))).collect();
    // Groups come after all they need, so that one walk finds all that each needs, at any remove.
    let mut needs: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for group in groups {
        let direct = edges.iter().filter(|(_, to)| *to == group.key).map(|(from, _)| *from);
        let mut all = BTreeSet::new();
        for from in direct {
            all.insert(from);
            all.extend(needs.get(from).into_iter().flatten());
        }
        needs.insert(group.key, all);
    }
    let follows = |(from, to): &(&str, &str)| {
        edges.iter().any(|(between, end)| end == to && needs[between].contains(from))
    };
    edges.iter().filter(|edge| !follows(edge)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Node, Stage};

    #[test]
    fn tasks_are_grouped_and_implied_lines_left_out() {
        let node = |id: &str, stage, needs: &[&str]| Node {
            id: id.into(),
            stage,
            needs: needs.iter().map(|need| (*need).to_owned()).collect(),
        };
        let graph = Graph::new(vec![
            node("solve/a/signed/r=1", Stage::Solve, &[]),
            node("solve/a/signed/r=2", Stage::Solve, &[]),
            node(
                "tabulate/a/signed",
                Stage::Tabulate,
                &["solve/a/signed/r=1", "solve/a/signed/r=2"],
            ),
            node("report/book", Stage::Report, &["tabulate/a/signed", "solve/a/signed/r=1"]),
        ]);
        let edges = essential(&groups(&graph), &graph);
        assert_eq!(edges, [("solve/a", "tabulate/a"), ("tabulate/a", "report/book")]);
        let svg = picture(&graph);
        assert!(svg.contains(">a × 2</text>"), "{svg}");
        assert_eq!(svg.matches("<path").count(), 2);
    }
}
