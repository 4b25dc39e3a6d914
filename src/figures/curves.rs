//! Solutions along the closed curves of a boundary in the plane.

use super::{ContactLine, ContactPanel};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::saddle::Pair;

impl ContactPanel {
    /// Panels of the solutions of a problem, each with its label: one for each closed curve of the boundary.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub(crate) fn of(
        title: &str,
        problem: &Problem,
        solutions: &[(String, Pair)],
    ) -> Result<Vec<Self>, String> {
        let mut panels = Vec::new();
        let curves = problem.levels().boundary();
        if curves.is_empty() {
            return Err("a solution in space has no picture".into());
        }
        for curve in curves {
            let (label, nodes) = (curve.label(), &curve.nodes);
            let lines = solutions.iter().map(|(words, pair)| {
                let in_contact = problem.in_contact(pair);
                ContactLine {
                    label: words.clone(),
                    y: at(&pair.y, nodes),
                    a: at(&problem.at_nodes(&pair.a, 0.0), nodes),
                    in_contact: at(&problem.at_nodes(&in_contact, false), nodes),
                }
            });
            let lines = lines.collect();
            let start = curve.points.first().copied().filter(|_| label.is_some());
            let title = label.map_or(title.to_owned(), |label| format!("{title}: {label}"));
            let (places, length, conditions) = (curve.places, curve.length, curve.conditions);
            let law = problem.law();
            panels.push(Self { title, places, length, start, conditions, law, lines });
        }
        Ok(panels)
    }
}

/// Values at some nodes.
fn at<T: Copy>(values: &[T], nodes: &[usize]) -> Vec<T> {
    nodes.iter().map(|&node| values[node]).collect()
}
