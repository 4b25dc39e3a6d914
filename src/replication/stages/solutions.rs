//! The solutions that the book gives away, as files for other programs.

use super::solve;
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs};
use crate::replication::mesh_files;
use crate::replication::scene::{Output, Scene};
use serde_json::{Value, json};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::saddle::Pair;

/// Solutions that the book offers for download.
#[derive(Default)]
pub(super) struct Solutions {
    /// Name, title and grid of each, for the templates.
    pub(super) listed: Vec<Value>,
    /// File `.npz` of each, by name.
    pub(super) files: Artifacts,
}

impl Solutions {
    /// Gathers, of the paper's problems, the pair where the first rule stops and the discrete solution; of the other
    /// scenes with a picture of the solution, the solution or the pair where their first rule stops.
    pub(super) fn of(
        inputs: &Inputs,
        problems: &[Scene],
        others: &[Scene],
    ) -> Result<Self, Failure> {
        let mut solutions = Self::default();
        for scene in problems {
            let problem = mesh_files::problem(&scene.statement, inputs.files)?;
            let stop = format!("where the published rule stops, r = {}", scene.saddle().r);
            let pair = solve::pair(inputs, scene, scene.first_rule(), &problem)?;
            solutions.add(scene, &problem, State { ending: "-stop", words: &stop, pair: &pair });
            let pair = solve::solution(scene)?;
            let words = "the solution";
            solutions.add(scene, &problem, State { ending: "-solution", words, pair: &pair });
        }
        // A scene that asks for a map alone has its numbers beside it.
        for scene in others.iter().filter(|scene| {
            scene.outputs != [Output::Map]
                && (scene.wants(Output::Surface) || scene.wants(Output::Map))
        }) {
            let (problem, rule) = (solve::problem(inputs, scene)?, scene.first_rule());
            let pair = solve::pair(inputs, scene, rule, &problem)?;
            let words = &solve::state(inputs, scene, rule)?;
            solutions.add(scene, &problem, State { ending: "", words, pair: &pair });
        }
        Ok(solutions)
    }

    /// Adds a pair of a scene.
    fn add(&mut self, scene: &Scene, problem: &Problem, state: State<'_>) {
        let State { ending, words, pair } = state;
        let (name, what) = (format!("{}{ending}", scene.name), format!("{}, {words}", scene.title));
        self.files.extend(problem.npz(pair).map(|bytes| (format!("{name}.npz"), bytes)));
        let domain = problem.domain(problem.finest());
        let mut listed = json!({ "name": name, "what": what });
        match domain.cells() {
            Some(cells) => listed["cells"] = cells.into(),
            None => listed["nodes"] = domain.nodes().into(),
        }
        self.listed.push(listed);
    }
}

/// Pair of a scene that the book offers.
struct State<'a> {
    /// Ending of the name of its file.
    ending: &'a str,
    /// Words for the title.
    words: &'a str,
    pair: &'a Pair,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replication::stages::solve::tests::{ACCURATE, with_solved};

    #[test]
    fn downloads_of_scenes_with_an_accuracy_solve_nothing() {
        for text in ACCURATE {
            with_solved(text, |inputs, scene| {
                let found = Solutions::of(inputs, &[], std::slice::from_ref(scene)).unwrap();
                assert_eq!((found.listed.len(), found.files.len()), (1, 1));
            });
        }
    }
}
