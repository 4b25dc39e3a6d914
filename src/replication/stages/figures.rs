//! The `figures` stage: one SVG per task; the paper's problems share theirs, other scenes have their own.

use super::identify::{self, FINDINGS};
use super::solve::{self, HISTORY, PAIR, read_pair};
use super::{artifact, from_json};
use crate::figures::{
    Caption, ContactPanel, Drawing, FMap, FigureError, History, HistoryPanel, IdentifiabilityPanel,
    Surface, View, contact, histories, identifiability, maps_of_f, surfaces, table,
};
use crate::identify::Findings;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use crate::saddle::{Pair, StopRule};
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

/// Name of the figure of stops and solutions.
pub(super) const STOPS: &str = "stops";

/// The task that draws, in a row per problem, where the paper stopped, the solution, and the difference.
fn stops(scenes: &[&Scene]) -> Task {
    let panels: Vec<Panel> =
        scenes.iter().map(|scene| Panel::new(Output::Surface, scene)).collect();
    let f = panels.iter().map(|panel| (panel.scene.name.clone(), panel.scene.f.to_string()));
    let hashed = f.collect();
    let needs = panels.iter().flat_map(|panel| panel.needs(Output::Surface)).collect();
    let title = "Where the paper stopped, where the solution is, and the difference";
    let task = drawing(STOPS, title.into(), needs, move |inputs, caption| {
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
        surfaces(caption, 3, &shown).map(Drawing::from).map_err(|e| e.to_string())
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
    draw: impl Fn(&Inputs, Caption) -> Result<Drawing, String> + Send + Sync + 'static,
) -> Task {
    let (picture, table) = (format!("{name}.svg"), format!("{name}.csv"));
    Task {
        id: id(name),
        parameters: BTreeMap::from([("title".into(), title.clone())]),
        files: Artifacts::new(),
        needs,
        export: Some("figures"),
        work: Box::new(move |inputs| {
            let description =
                format!("Made by `{COMMAND}` from inputs {} (blake3).", &inputs.digest[..12]);
            let drawn = draw(inputs, Caption { title: &title, description: &description })?;
            let mut made = Artifacts::from([(picture.clone(), drawn.svg.into_bytes())]);
            made.extend(drawn.table.map(|text| (table.clone(), text.into_bytes())));
            Ok(made)
        }),
    }
}

/// What draws the figures.
pub(super) const COMMAND: &str = "signorini run --only figures";

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
) -> Result<Drawing, String> {
    let with = |svg: Result<String, FigureError>, table: String| {
        svg.map(|svg| Drawing { svg, table: Some(table) })
    };
    let picture: Result<Drawing, FigureError> = match kind {
        Output::Source => {
            let maps: Vec<_> =
                panels.iter().map(|p| FMap { title: &p.scene.title, f: &p.scene.f }).collect();
            maps_of_f(caption, &maps).map(Drawing::from)
        }
        Output::Surface => {
            let pairs = panels
                .iter()
                .map(|panel| panel.pair(inputs, &panel.needs(kind)[0]))
                .collect::<Result<Vec<_>, _>>()?;
            let panels: Vec<_> = panels
                .iter()
                .zip(&pairs)
                .map(|(panel, pair)| {
                    let grid = panel.scene.finest();
                    let view = View::uphill(grid, &pair.y);
                    let title = &panel.scene.title;
                    Surface { title, grid, y: &pair.y, a: &pair.a, view, range: None }
                })
                .collect();
            surfaces(caption, 2, &panels).map(Drawing::from)
        }
        Output::History => {
            let histories_of = |panel: &Panel| {
                let curves = panel.needs(kind).into_iter().zip(&panel.scene.r).map(|(task, r)| {
                    let levels = from_json(inputs, &task, HISTORY)?;
                    Ok(History { label: format!("r = {r}"), levels })
                });
                curves.collect::<Result<Vec<_>, String>>()
            };
            let mut shown = Vec::new();
            for panel in panels {
                let Scene { title, grids, .. } = &panel.scene;
                shown.push(HistoryPanel { title, grids, curves: histories_of(panel)? });
            }
            with(histories(caption, &shown), table::of_histories(&shown))
        }
        Output::Contact => {
            let pairs_of = |panel: &Panel| {
                let lines = panel.needs(kind).into_iter().zip(&panel.scene.stop);
                let line = |(task, stop): (String, &StopRule)| {
                    let label = format!("stop: {stop}, r = {}", panel.scene.draw_r);
                    Ok((label, panel.pair(inputs, &task)?))
                };
                lines.map(line).collect::<Result<Vec<_>, String>>()
            };
            let mut shown = Vec::new();
            for panel in panels {
                let (title, grid) = (&panel.scene.title, panel.scene.finest());
                shown.push(ContactPanel { title, grid, lines: pairs_of(panel)? });
            }
            with(contact(caption, &shown), table::of_contact(&shown))
        }
        Output::Identify => {
            let found = panels
                .iter()
                .map(|panel| from_json::<Findings>(inputs, &panel.needs(kind)[0], FINDINGS))
                .collect::<Result<Vec<_>, _>>()?;
            let shown = panels.iter().zip(&found).map(|(panel, found)| IdentifiabilityPanel {
                title: &panel.scene.title,
                slice: &found.slice,
                cells: found.target.cells(),
                others: two_valued(found),
            });
            let shown: Vec<_> = shown.collect();
            with(identifiability(caption, &shown), table::of_identifiability(&shown))
        }
        Output::Table => return Err("a table is not a figure".into()),
    };
    picture.map_err(|e| e.to_string())
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
