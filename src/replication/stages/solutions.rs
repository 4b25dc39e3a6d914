//! The solutions that the book gives away, as files for other programs.

use super::solve;
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs};
use crate::replication::scene::{Output, Scene};
use serde_json::{Value, json};
use signorini_mathematics::formats::{Fields, MeshFields};
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
    /// scenes with a picture of the surface, the pair where their first rule stops.
    pub(super) fn of(
        inputs: &Inputs,
        problems: &[Scene],
        others: &[Scene],
    ) -> Result<Self, Failure> {
        let mut solutions = Self::default();
        for scene in problems {
            let stop = format!("where the published rule stops, r = {}", scene.drawn_r());
            solutions.add(
                scene,
                "-stop",
                &stop,
                &solve::pair_on_grid(inputs, scene, scene.stop[0])?,
            );
            solutions.add(scene, "-solution", "the solution", &solve::solution(scene)?);
        }
        for scene in others.iter().filter(|scene| scene.wants(Output::Surface)) {
            let stop = format!("where the rule {} stops, r = {}", scene.stop[0], scene.drawn_r());
            if scene.problem.mesh().is_some() {
                solutions.add_on_mesh(inputs, scene, &stop)?;
                continue;
            }
            let pair = solve::pair_on_grid(inputs, scene, scene.stop[0])?;
            solutions.add(scene, "", &stop, &pair);
        }
        Ok(solutions)
    }

    /// Adds the pair of a scene, whose name gets the `ending` and whose title the `state`.
    fn add(&mut self, scene: &Scene, ending: &str, state: &str, pair: &Pair) {
        let name = format!("{}{ending}", scene.name);
        let what = format!("{}, {state}", scene.title);
        let fields = Fields::new(scene.finest(), &scene.on_grids().f, pair);
        self.files.extend(fields.npz().map(|bytes| (format!("{name}.npz"), bytes)));
        self.listed.push(json!({ "name": name, "what": what, "cells": scene.finest().cells() }));
    }

    /// Adds the pair where the first rule of a scene on a mesh stops.
    fn add_on_mesh(&mut self, inputs: &Inputs, scene: &Scene, state: &str) -> Result<(), Failure> {
        let problem = scene.problem.problem(inputs.files)?;
        let pair = solve::pair(inputs, scene, scene.stop[0], &problem)?;
        let level = problem.finest();
        let (mesh, multiplier) = (problem.levels().mesh(level), problem.at_nodes(&pair.a, 0.0));
        let f = problem.levels().means(level).map_err(|e| e.to_string())?;
        let fields = MeshFields { mesh: &mesh, v: &pair.y, multiplier: &multiplier, f: &f };
        self.files.extend(fields.npz().map(|bytes| (format!("{}.npz", scene.name), bytes)));
        let what = format!("{}, {state}", scene.title);
        self.listed.push(json!({ "name": scene.name, "what": what, "nodes": mesh.nodes() }));
        Ok(())
    }
}
