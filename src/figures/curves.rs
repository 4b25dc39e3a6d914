//! Solutions along the closed curves of a boundary in the plane.

use super::{ContactLine, ContactPanel};
use signorini_mathematics::levels::{ClosedCurve, Problem};
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
        let curves = problem.levels().curves().ok_or("a solution in space has no picture")?;
        for ClosedCurve { parts, nodes, points, conditions, places, length } in curves {
            let lines = solutions.iter().map(|(label, pair)| {
                let in_contact = problem.levels().in_contact(problem.law(), pair);
                ContactLine {
                    label: label.clone(),
                    y: at(&pair.y, &nodes),
                    a: at(&problem.at_nodes(&pair.a, 0.0), &nodes),
                    in_contact: at(&problem.at_nodes(&in_contact, false), &nodes),
                }
            });
            let lines = lines.collect();
            let start = points.first().copied().filter(|_| parts.is_some());
            let title = parts.map_or(title.to_owned(), |parts| format!("{title}: {parts}"));
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
