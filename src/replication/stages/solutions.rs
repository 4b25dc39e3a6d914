//! The solutions that the book gives away, as files for other programs.

use super::artifact;
use super::solve::{self, PAIR, read_pair};
use crate::pipeline::Inputs;
use crate::replication::scene::{Output, Scene};
use crate::report::Fields;
use crate::saddle::Pair;
use serde::Serialize;

/// A solution in the book's folder `data`, as .npz and as .vti.
#[derive(Serialize)]
pub(super) struct SolutionFile {
    /// Its name, without ending.
    name: String,
    /// Title of the scene, and which state of it.
    what: String,
    /// Cells per side of its grid.
    cells: usize,
}

/// A solution, and what the book says of it.
pub(super) struct Solution<'a> {
    pub(super) file: SolutionFile,
    scene: &'a Scene,
    pair: Pair,
}

/// Of the paper's problems, where the first rule stops and the discrete solution; of other scenes with a
/// picture of the surface, where their rule stops.
pub(super) fn all<'a>(
    inputs: &Inputs,
    problems: &'a [Scene],
    others: &'a [Scene],
) -> Result<Vec<Solution<'a>>, String> {
    let mut kept = Vec::new();
    let stopped = |scene: &Scene| {
        let bytes = artifact(inputs, &solve::id(scene, scene.stop[0], scene.draw_r), PAIR)?;
        read_pair(scene.finest(), bytes)
    };
    for scene in problems {
        let stop = format!("where the published rule stops, r = {}", scene.draw_r);
        kept.push(Solution::new(scene, "-stop", &stop, stopped(scene)?));
        kept.push(Solution::new(scene, "-solution", "the solution", solve::solution(scene)?));
    }
    for scene in others.iter().filter(|scene| scene.wants(Output::Surface)) {
        let stop = format!("where the rule `{}` stops, r = {}", scene.stop[0], scene.draw_r);
        kept.push(Solution::new(scene, "", &stop, stopped(scene)?));
    }
    Ok(kept)
}

impl<'a> Solution<'a> {
    fn new(scene: &'a Scene, which: &str, state: &str, pair: Pair) -> Self {
        let file = SolutionFile {
            name: format!("{}{which}", scene.name),
            what: format!("{}, {state}", scene.title),
            cells: scene.finest().cells(),
        };
        Self { file, scene, pair }
    }

    /// Name and bytes of the files.
    pub(super) fn files(&self) -> impl Iterator<Item = (String, Vec<u8>)> {
        let fields = Fields::square(self.scene.finest(), &self.scene.f, &self.pair);
        let SolutionFile { name, what, .. } = &self.file;
        let npz = fields.npz().map(|bytes| (format!("{name}.npz"), bytes));
        npz.into_iter().chain([(format!("{name}.vti"), fields.vti(what))])
    }
}
