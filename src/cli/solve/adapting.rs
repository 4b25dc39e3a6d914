//! Progress of `solve`: on the way to an accuracy on adapted meshes a bar or lines, and its end; a bar
//! while sparse factors are made.

use super::clock::turning;
use crate::cli::interrupt::interrupted;
use crate::pipeline::{bar, talk};
use crate::replication::fields::table::Voice;
use indicatif::ProgressBar;
use signorini_mathematics::bounds::Accuracy;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::saddle::Monitor;
use signorini_mathematics::solvers::{Tried, Watcher};
use signorini_mathematics::statement::Statement;
use std::ops::ControlFlow;

/// Meshes while they are made.
pub(super) struct ShownMeshes {
    bar: Option<ProgressBar>,
    /// Accuracy that is asked for on meshes; none if nothing is to be shown.
    accuracy: Option<Accuracy>,
    verbose: bool,
    /// Number of meshes so far.
    meshes: usize,
    /// First error that was finite.
    first: f64,
}

/// Steps of the bar, which shows the digits of the error.
const STEPS: f64 = 1000.0;

impl Monitor for ShownMeshes {
    fn factors(&mut self, nodes: usize) {
        self.bar = turning(&format!("sparse factors of {nodes} nodes"));
    }
}

/// A signal ends the way to an accuracy on meshes, with the best answer so far; on the square it ends the program.
impl Watcher for ShownMeshes {
    fn tried(&mut self, tried: Tried<'_>) -> ControlFlow<()> {
        if let Some(accuracy) = self.accuracy {
            self.show(accuracy, tried);
            if interrupted().is_asked() {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    }
}

impl ShownMeshes {
    pub(super) fn new(statement: &Statement, verbose: bool) -> Self {
        let accuracy = of_meshes(statement);
        let bar = accuracy.and_then(|_| bar("[{bar:30}] {elapsed}  {wide_msg}"));
        if let Some(bar) = &bar {
            bar.set_length(STEPS as u64);
        }
        Self { bar, accuracy, verbose, meshes: 0, first: f64::INFINITY }
    }

    /// Shows a mesh.
    fn show(&mut self, accuracy: Accuracy, Tried { nodes, bounds }: Tried<'_>) {
        self.meshes += 1;
        let bound = bounds.as_ref().map(|bounds| accuracy.reached(bounds));
        let reached = bound.as_ref().ok().copied().filter(|reached| reached.is_finite());
        let error = match bound {
            Ok(reached) => accuracy.in_words(reached),
            Err(reason) => format!("no bound: {reason}"),
        };
        let line = format!("mesh {}: {nodes} nodes, {error}", self.meshes);
        if let (Some(bar), Some(reached)) = (&self.bar, reached) {
            self.first = if self.first.is_finite() { self.first } else { reached };
            let done = libm::log(self.first / reached) / libm::log(self.first / accuracy.wanted());
            bar.set_position((STEPS * done.clamp(0.0, 1.0)) as u64);
            bar.set_message(line.clone());
        }
        match &self.bar {
            Some(bar) if self.verbose => bar.println(line),
            None if self.verbose => talk(&line),
            _ => (),
        }
    }

    /// Removes the bar.
    pub(super) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Returns a note on an accuracy that linear elements reach with millions of nodes, if at all, where the true solution
/// can be had.
pub(super) fn note(statement: &Statement, voice: Voice, problem: &Problem) -> Option<String> {
    /// Errors in the energy norm and of the energy that some million nodes reach on an L-shape.
    const HARDLY: [f64; 2] = [1e-3, 1e-6];
    let accuracy = of_meshes(statement)?;
    let is_hard = match accuracy {
        Accuracy::Error(wanted) => wanted < HARDLY[0],
        Accuracy::Energy(wanted) => wanted < HARDLY[1],
    };
    let asked = voice.accuracy(accuracy);
    let text = format!(
        "note: {asked} takes millions of nodes, if they are enough; --solver spectral has the true solution"
    );
    (is_hard && problem.takes_spectral()).then_some(text)
}

/// Accuracy to which meshes are adapted; none on the square, and if none is asked for.
pub(super) fn of_meshes(statement: &Statement) -> Option<Accuracy> {
    statement.accuracy().filter(|_| !statement.has_grids())
}
