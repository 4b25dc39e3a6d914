//! The solutions that the book gives away, as files for other programs.

use super::solve;
use crate::pipeline::{Artifacts, Inputs};
use crate::replication::scene::{Output, Scene};
use crate::report::Fields;
use crate::saddle::Pair;
use serde::Serialize;

/// A solution in the book's folder `data`, as .npz and as .vti.
#[derive(Serialize)]
pub(super) struct Solution {
    name: String,
    /// Title of the scene, and which state of it.
    what: String,
    /// Cells per side of its grid.
    cells: usize,
    #[serde(skip)]
    pub(super) files: Artifacts,
}

/// Of the paper's problems, where the first rule stops and the discrete solution; of other scenes with a
/// picture of the surface, where their rule stops.
pub(super) fn all(
    inputs: &Inputs,
    problems: &[Scene],
    others: &[Scene],
) -> Result<Vec<Solution>, String> {
    let mut kept = Vec::new();
    let stopped = |scene: &Scene| solve::pair(inputs, scene, scene.stop[0]);
    for scene in problems {
        let stop = format!("where the published rule stops, r = {}", scene.draw_r);
        kept.push(solution(scene, "-stop", &stop, &stopped(scene)?));
        kept.push(solution(scene, "-solution", "the solution", &solve::solution(scene)?));
    }
    for scene in others.iter().filter(|scene| scene.wants(Output::Surface)) {
        let stop = format!("where the rule `{}` stops, r = {}", scene.stop[0], scene.draw_r);
        kept.push(solution(scene, "", &stop, &stopped(scene)?));
    }
    Ok(kept)
}

fn solution(scene: &Scene, which: &str, state: &str, pair: &Pair) -> Solution {
    let (name, what) = (format!("{}{which}", scene.name), format!("{}, {state}", scene.title));
    let fields = Fields::square(scene.finest(), &scene.f, pair);
    let mut files = Artifacts::from([(format!("{name}.vti"), fields.vti(&what))]);
    files.extend(fields.npz().map(|bytes| (format!("{name}.npz"), bytes)));
    Solution { name, what, cells: scene.finest().cells(), files }
}
