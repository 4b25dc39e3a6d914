//! The `figures` stage: one SVG per task; the paper's problems share theirs, other scenes have their own.

use super::identify::{self, FINDINGS};
use super::solve::{self, HISTORY, PAIR, read_pair};
use super::{artifact, from_json};
use crate::figures::{
    Caption, ContactPanel, Drawing, FMap, History, HistoryPanel, IdentifiabilityPanel, Surface,
    View, contact, histories, identifiability, maps_of_f, surfaces,
};
use crate::identify::Findings;
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use crate::saddle::Pair;
use std::collections::BTreeMap;

/// The kinds of figure, with the name each has when the paper's problems share it.
pub const KINDS: [(Output, &str); 5] = [
    (Output::Source, "figure1"),
    (Output::Surface, "figure2"),
    (Output::History, "histories"),
    (Output::Contact, "contact"),
    (Output::Identify, "identifiability"),
];

/// What a figure is drawn from: a scene reduced to what matters for it.
struct Panel {
    scene: Scene,
    /// The same for hashing; drawing reads nothing else.
    parameters: BTreeMap<String, String>,
}

/// The figure tasks of `scenes`; shared ones only if all scenes of `project` that share them are there.
pub fn tasks(project: &Project, scenes: &[&Scene]) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (kind, shared_name) in KINDS {
        let shared = sharing(project, scenes, kind);
        if !shared.is_empty() {
            tasks.push(task(kind, shared_name.into(), &shared));
        }
        for scene in scenes.iter().filter(|s| !project.is_problem(s) && s.wants(kind)) {
            tasks.push(task(kind, format!("{}-{}", scene.name, kind.name()), &[scene]));
        }
    }
    let shared = sharing(project, scenes, Output::Surface);
    // Only the book shows it.
    if !shared.is_empty() && !project.templates.is_empty() {
        tasks.push(stops(&shared));
    }
    tasks
}

/// The task that draws, in a row per problem, where the paper stopped, the solution, and the difference.
fn stops(scenes: &[&Scene]) -> Task {
    let panels: Vec<Panel> =
        scenes.iter().map(|scene| Panel::new(Output::Surface, scene)).collect();
    let f = panels.iter().map(|panel| (panel.scene.name.clone(), panel.scene.f.to_string()));
    let hashed = f.collect();
    let needs = panels.iter().flat_map(|panel| panel.needs(Output::Surface)).collect();
    let title = "Where the paper stopped, where the solution is, and the difference";
    let task = drawing("stops", title.into(), needs, move |inputs, caption| {
        let mut rows = Vec::new();
        for panel in &panels {
            let stop = panel.pair(inputs, &panel.needs(Output::Surface)[0])?;
            let solution = solve::solution(&panel.scene)?;
            let y = solution.y.iter().zip(&stop.y).map(|(v, y)| v - y).collect();
            let difference = Pair { y, a: vec![0.0; stop.a.len()] };
            let pairs = [stop, solution, difference];
            let values = pairs.iter().flat_map(|pair| &pair.y).copied();
            let range = values.fold((0.0, 0.0), |(l, h): (f64, f64), v| (l.min(v), h.max(v)));
            rows.push((panel, pairs, range));
        }
        let names = ["where it stopped", "the solution", "the difference"];
        let titles: Vec<String> = rows
            .iter()
            .flat_map(|(panel, ..)| names.map(|name| format!("{}: {name}", panel.scene.title)))
            .collect();
        let mut shown = Vec::new();
        for ((panel, pairs, range), titles) in rows.iter().zip(titles.chunks(3)) {
            let (grid, range) = (panel.scene.finest(), Some(*range));
            let view = View::uphill(grid, &pairs[1].y);
            for (Pair { y, a }, title) in pairs.iter().zip(titles) {
                shown.push(Surface { title, grid, y, a, view, range });
            }
        }
        Ok(surfaces(caption, 3, &shown)?)
    });
    Task { parameters: hashed, ..task }
}

/// Those of `scenes` that share a figure of this kind; none if one that shares it is missing.
pub(super) fn sharing<'a>(project: &Project, scenes: &[&'a Scene], kind: Output) -> Vec<&'a Scene> {
    let shares = |scene: &&Scene| project.is_problem(scene) && scene.wants(kind);
    let shared: Vec<_> = scenes.iter().copied().filter(shares).collect();
    let all = project.scenes.iter().filter(shares).count();
    if shared.len() == all { shared } else { Vec::new() }
}

fn task(kind: Output, name: String, scenes: &[&Scene]) -> Task {
    let panels: Vec<Panel> = scenes.iter().map(|scene| Panel::new(kind, scene)).collect();
    let mut hashed = BTreeMap::from([("kind".into(), kind.name().into())]);
    for panel in &panels {
        let name = &panel.scene.name;
        hashed.extend(panel.parameters.iter().map(|(k, v)| (format!("{name}.{k}"), v.clone())));
    }
    let needs = panels.iter().flat_map(|panel| panel.needs(kind)).collect();
    let titles: Vec<&str> = panels.iter().map(|panel| panel.scene.title.as_str()).collect();
    let title = format!("{}: {}", caption(kind), titles.join("; "));
    let task =
        drawing(&name, title, needs, move |inputs, caption| draw(kind, &panels, inputs, caption));
    Task { parameters: hashed, ..task }
}

/// The task that draws the figure `name`; its title is its only parameter.
pub(super) fn drawing(
    name: &str,
    title: String,
    needs: Vec<String>,
    draw: impl Fn(&Inputs, Caption) -> Result<Drawing, Failure> + Send + Sync + 'static,
) -> Task {
    let (picture, table) = (format!("{name}.svg"), format!("{name}.csv"));
    let parameters = BTreeMap::from([("title".into(), title.clone())]);
    let task = Task::new(id(name), parameters, needs, move |inputs| {
        let digest = &inputs.digest[..12];
        let description =
            format!("Made by `signorini run --only figures` from inputs {digest} (blake3).");
        let drawn = draw(inputs, Caption { title: &title, description: &description })?;
        let mut made = Artifacts::from([(picture.clone(), drawn.svg.into_bytes())]);
        made.extend(drawn.table.map(|text| (table.clone(), text.into_bytes())));
        Ok(made)
    });
    Task { export: Some("figures"), ..task }
}

/// Id of the task that draws the figure `name`.
pub(super) fn id(name: &str) -> String {
    format!("figures/{name}")
}

impl Panel {
    fn new(kind: Output, scene: &Scene) -> Self {
        let cells: Vec<usize> = scene.grids.iter().map(|grid| grid.cells()).collect();
        let mut value = serde_json::json!({ "title": scene.title });
        match kind {
            Output::Source | Output::Identify => value["f"] = scene.f.to_string().into(),
            _ => value["grids"] = cells.into(),
        }
        Self { scene: scene.clone(), parameters: parameters(&value) }
    }

    fn needs(&self, kind: Output) -> Vec<String> {
        let scene = &self.scene;
        match kind {
            Output::Source | Output::Table => Vec::new(),
            Output::Surface => vec![solve::id(scene, scene.stop[0], scene.draw_r)],
            Output::History => {
                scene.r.iter().map(|&r| solve::id(scene, scene.stop[0], r)).collect()
            }
            Output::Identify => vec![identify::id(scene)],
            Output::Contact => {
                scene.stop.iter().map(|&stop| solve::id(scene, stop, scene.draw_r)).collect()
            }
        }
    }

    fn pair(&self, inputs: &Inputs, task: &str) -> Result<Pair, String> {
        read_pair(self.scene.finest(), artifact(inputs, task, PAIR)?)
    }
}

fn draw(
    kind: Output,
    panels: &[Panel],
    inputs: &Inputs,
    caption: Caption,
) -> Result<Drawing, Failure> {
    match kind {
        Output::Source => draw_sources(panels, caption),
        Output::Surface => draw_surfaces(panels, inputs, caption),
        Output::History => draw_histories(panels, inputs, caption),
        Output::Contact => draw_contact(panels, inputs, caption),
        Output::Identify => draw_identifiability(panels, inputs, caption),
        Output::Table => Err("a table is not a figure".into()),
    }
}

fn draw_sources(panels: &[Panel], caption: Caption) -> Result<Drawing, Failure> {
    let scenes = panels.iter().map(|panel| &panel.scene);
    let maps: Vec<_> = scenes.map(|scene| FMap { title: &scene.title, f: &scene.f }).collect();
    Ok(maps_of_f(caption, &maps)?)
}

fn draw_surfaces(panels: &[Panel], inputs: &Inputs, caption: Caption) -> Result<Drawing, Failure> {
    let pair = |panel: &Panel| panel.pair(inputs, &panel.needs(Output::Surface)[0]);
    let pairs = panels.iter().map(pair).collect::<Result<Vec<_>, _>>()?;
    let mut shown = Vec::new();
    for (Panel { scene, .. }, Pair { y, a }) in panels.iter().zip(&pairs) {
        let (title, grid) = (&scene.title, scene.finest());
        shown.push(Surface { title, grid, y, a, view: View::uphill(grid, y), range: None });
    }
    Ok(surfaces(caption, 2, &shown)?)
}

fn draw_histories(panels: &[Panel], inputs: &Inputs, caption: Caption) -> Result<Drawing, Failure> {
    let mut shown = Vec::new();
    for panel in panels {
        let Scene { title, grids, r, .. } = &panel.scene;
        let curves = panel.needs(Output::History).into_iter().zip(r).map(|(task, r)| {
            let levels = from_json(inputs, &task, HISTORY)?;
            Ok(History { label: format!("r = {r}"), levels })
        });
        let curves = curves.collect::<Result<_, String>>()?;
        shown.push(HistoryPanel { title, grids, curves });
    }
    Ok(histories(caption, &shown)?)
}

fn draw_contact(panels: &[Panel], inputs: &Inputs, caption: Caption) -> Result<Drawing, Failure> {
    let mut shown = Vec::new();
    for panel in panels {
        let Scene { title, stop, draw_r, .. } = &panel.scene;
        let lines = panel.needs(Output::Contact).into_iter().zip(stop).map(|(task, stop)| {
            Ok((format!("stop: {stop}, r = {draw_r}"), panel.pair(inputs, &task)?))
        });
        let lines = lines.collect::<Result<_, String>>()?;
        shown.push(ContactPanel { title, grid: panel.scene.finest(), lines });
    }
    Ok(contact(caption, &shown)?)
}

fn draw_identifiability(
    panels: &[Panel],
    inputs: &Inputs,
    caption: Caption,
) -> Result<Drawing, Failure> {
    let found = |panel: &Panel| from_json(inputs, &panel.needs(Output::Identify)[0], FINDINGS);
    let found = panels.iter().map(found).collect::<Result<Vec<Findings>, _>>()?;
    let shown = panels.iter().zip(&found).map(|(panel, found)| IdentifiabilityPanel {
        title: &panel.scene.title,
        slice: &found.slice,
        cells: found.target.cells(),
        others: two_valued(found),
    });
    let shown: Vec<_> = shown.collect();
    Ok(identifiability(caption, &shown)?)
}

/// The alternatives with one value on the first quadrant and one elsewhere: those in the plane of the map.
fn two_valued(found: &Findings) -> Vec<[f64; 2]> {
    let others = found.alternatives.iter().filter(|other| !other.chosen).map(|o| &o.values[..]);
    let in_plane = |v: &[f64]| match *v {
        [first, rest, b, c] => (rest == b && rest == c).then_some([first, rest]),
        _ => None,
    };
    others.filter_map(in_plane).collect()
}

fn caption(kind: Output) -> &'static str {
    match kind {
        Output::Source => "Right-hand side f",
        Output::Surface => "Surface v",
        Output::History => "Residuals against iterations",
        Output::Contact => "Trace and multiplier along the boundary",
        Output::Identify => "Published counts that come out, around the recovered f",
        Output::Table => "Table",
    }
}
