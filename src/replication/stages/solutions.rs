//! The solutions that the book gives away, as files for other programs.

use super::solve::{self, on_mesh};
use crate::pipeline::{Artifacts, Inputs};
use crate::replication::domain::SceneDomain;
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
    ) -> Result<Self, String> {
        let mut solutions = Self::default();
        for scene in problems {
            let stop = format!("where the published rule stops, r = {}", scene.drawn_r());
            solutions.add(scene, "-stop", &stop, &solve::pair(inputs, scene, scene.stop[0])?);
            solutions.add(scene, "-solution", "the solution", &solve::solution(scene)?);
        }
        for scene in others.iter().filter(|scene| scene.wants(Output::Surface)) {
            let stop = format!("where the rule {} stops, r = {}", scene.stop[0], scene.drawn_r());
            if let Some(domain) = &scene.domain {
                solutions.add_on_mesh(inputs, scene, domain, &stop)?;
                continue;
            }
            solutions.add(scene, "", &stop, &solve::pair(inputs, scene, scene.stop[0])?);
        }
        Ok(solutions)
    }

    /// Adds the pair of a scene, whose name gets the `ending` and whose title the `state`.
    fn add(&mut self, scene: &Scene, ending: &str, state: &str, pair: &Pair) {
        let name = format!("{}{ending}", scene.name);
        let what = format!("{}, {state}", scene.title);
        let fields = Fields::new(scene.finest(), &scene.f, pair);
        self.files.extend(fields.npz().map(|bytes| (format!("{name}.npz"), bytes)));
        self.listed.push(json!({ "name": name, "what": what, "cells": scene.finest().cells() }));
    }

    /// Adds the pair where the first rule of a scene on a domain stops.
    fn add_on_mesh(
        &mut self,
        inputs: &Inputs,
        scene: &Scene,
        domain: &SceneDomain,
        state: &str,
    ) -> Result<(), String> {
        let refined = domain.problem(inputs.files).map_err(|e| e.to_string())?;
        let pair = on_mesh::pair(inputs, scene, scene.stop[0], &refined)?;
        let problem = &refined.problem;
        let multiplier = &pair.multiplier_on(problem.network());
        let (mesh, f) = (&problem.mesh, &problem.f.cells.mean);
        let npz = MeshFields { mesh, v: &pair.y, multiplier, f }.npz();
        self.files.extend(npz.map(|bytes| (format!("{}.npz", scene.name), bytes)));
        let what = format!("{}, {state}", scene.title);
        self.listed.push(json!({ "name": scene.name, "what": what, "nodes": mesh.nodes() }));
        Ok(())
    }
}
