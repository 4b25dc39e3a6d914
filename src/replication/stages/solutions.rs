//! The solutions that the book gives away, as files for other programs.

use super::solve;
use crate::pipeline::{Artifacts, Inputs};
use crate::replication::scene::{Output, Scene};
use crate::saddle::Fields;
use serde_json::{Value, json};

/// What the book says of the solutions that it gives away, and each as .npz and as .vti, by name.
///
/// Of the paper's problems, where the first rule stops and the discrete solution; of other scenes with a
/// picture of the surface, where their rule stops.
pub(super) fn all(
    inputs: &Inputs,
    problems: &[Scene],
    others: &[Scene],
) -> Result<(Vec<Value>, Artifacts), String> {
    let mut kept = Vec::new();
    for scene in problems {
        let stop = format!("where the published rule stops, r = {}", scene.draw_r);
        kept.push((scene, "-stop", stop, solve::pair(inputs, scene, scene.stop[0])?));
        kept.push((scene, "-solution", "the solution".into(), solve::solution(scene)?));
    }
    for scene in others.iter().filter(|scene| scene.wants(Output::Surface)) {
        let stop = format!("where the rule {} stops, r = {}", scene.stop[0], scene.draw_r);
        kept.push((scene, "", stop, solve::pair(inputs, scene, scene.stop[0])?));
    }
    let (mut told, mut files) = (Vec::new(), Artifacts::new());
    for (scene, which, state, pair) in &kept {
        let (name, what) = (format!("{}{which}", scene.name), format!("{}, {state}", scene.title));
        let fields = Fields::square(scene.finest(), &scene.f, pair);
        files.insert(format!("{name}.vti"), fields.vti(&what));
        files.extend(fields.npz().map(|bytes| (format!("{name}.npz"), bytes)));
        told.push(json!({ "name": name, "what": what, "cells": scene.finest().cells() }));
    }
    Ok((told, files))
}
