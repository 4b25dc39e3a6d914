//! Adaptive refinement as `solve` shows it: a bar or lines while it runs, and its end.

use crate::pipeline::{bar, talk};
use indicatif::ProgressBar;
use serde_json::{Value, json};
use signorini_mathematics::bounds::{Accuracy, Bounds};
use signorini_mathematics::levels::{AdaptedEnd, AdaptedMesh};
use signorini_mathematics::problem::text::plain;

/// Meshes while they are made.
pub(super) struct ShownMeshes {
    bar: Option<ProgressBar>,
    accuracy: Accuracy,
    verbose: bool,
    /// Number of meshes so far.
    meshes: usize,
    /// First error that was finite.
    first: f64,
}

/// Steps of the bar, which shows the digits of the error.
const STEPS: f64 = 1000.0;

impl ShownMeshes {
    pub(super) fn new(accuracy: Accuracy, verbose: bool) -> Self {
        let bar = bar("[{bar:30}] {elapsed}  {wide_msg}");
        if let Some(bar) = &bar {
            bar.set_length(STEPS as u64);
        }
        Self { bar, accuracy, verbose, meshes: 0, first: f64::INFINITY }
    }

    /// Shows a mesh.
    pub(super) fn show(&mut self, mesh: &AdaptedMesh) {
        self.meshes += 1;
        let bound = mesh.bounds.as_ref().map(|bounds| self.accuracy.reached(bounds));
        let reached = bound.as_ref().ok().copied().filter(|reached| reached.is_finite());
        let error = match (reached, bound) {
            (Some(reached), _) => error(self.accuracy, reached),
            (None, Ok(_)) => "error not below the solution".into(),
            (None, Err(reason)) => format!("no bound: {reason}"),
        };
        let line = format!("mesh {}: {} nodes, {error}", self.meshes, mesh.nodes);
        if let (Some(bar), Some(reached)) = (&self.bar, reached) {
            self.first = if self.first.is_finite() { self.first } else { reached };
            let done =
                libm::log(self.first / reached) / libm::log(self.first / self.accuracy.wanted());
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

/// Bound that was reached, in words.
pub(super) fn error(accuracy: Accuracy, reached: f64) -> String {
    let percent = plain(100.0 * reached, 3);
    match accuracy {
        Accuracy::Error(_) => format!("error at most {percent} %"),
        Accuracy::Energy(_) => format!("error of the energy at most {percent} %"),
    }
}

/// Reason for the end, as JSON has it.
fn name(end: AdaptedEnd) -> &'static str {
    match end {
        AdaptedEnd::Goal => "goal",
        AdaptedEnd::Nodes => "memory",
        AdaptedEnd::NoLongerFalls => "no longer falls",
    }
}

/// End of adaptive refinement.
#[derive(Clone, Copy, Debug)]
pub(super) struct AdaptedMeshes {
    /// Number of meshes on which a solution was sought, with those that are too coarse for one.
    pub count: usize,
    /// Number of nodes of the last.
    pub nodes: usize,
    /// Reason for the end.
    pub end: AdaptedEnd,
}

impl AdaptedMeshes {
    /// Returns the end with the bound that was reached.
    pub(super) fn json(self, reached: Option<(Accuracy, &Bounds)>) -> Value {
        json!({
            "meshes": self.count,
            "nodes": self.nodes,
            "reached": reached.map(|(accuracy, bounds)| accuracy.reached(bounds)),
            "end": name(self.end),
        })
    }

    /// Returns the end in words.
    pub(super) fn text(self) -> String {
        let reason = match self.end {
            AdaptedEnd::Goal => "the error is as small as asked",
            AdaptedEnd::Nodes => "a finer mesh takes more memory than is left",
            AdaptedEnd::NoLongerFalls => "the bound of the error no longer falls",
        };
        format!("{} meshes, the last of {} nodes: {reason}\n", self.count, self.nodes)
    }
}
