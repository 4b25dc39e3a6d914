//! The `figures` stage: one SVG per task; the paper's problems share theirs, other scenes have their own.

use super::identify::{self, FINDINGS};
use super::solve::{self, HISTORY};
use super::{from_json, sharing};
use crate::figures::{
    ContactPanel, HistoryPanel, IdentifiabilityPanel, Picture, Surface, contact, histories,
    identifiability, maps_of_f, range_with_zero, surfaces, uphill,
};
use crate::identify::Findings;
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, Inputs, Task, parameters};
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use crate::saddle::Pair;
use std::collections::BTreeMap;

/// The kinds of figure: the output of a scene that asks for it, its name when the paper's problems share it,
/// and what it shows.
pub(super) const KINDS: [(Output, &str, &str); 5] = [
    (Output::Source, "figure1", "Right-hand side f"),
    (Output::Surface, "figure2", "Surface v"),
    (Output::History, "histories", "Residuals against iterations"),
    (Output::Contact, "contact", "Trace and multiplier along the boundary"),
    (Output::Identify, "identifiability", "Published counts that come out, around the recovered f"),
];

/// The scene whose own figure has this name.
pub(super) fn scene_of(name: &str) -> Option<&str> {
    KINDS.iter().find_map(|(kind, ..)| name.strip_suffix(&kind.to_string())?.strip_suffix('-'))
}

/// The figure tasks of `scenes`; shared ones only if all scenes of `project` that share them are there.
pub(super) fn tasks(project: &Project, scenes: &[&Scene]) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (kind, name, caption) in KINDS {
        let shared = sharing(project, scenes, kind);
        if !shared.is_empty() {
            tasks.push(task(kind, name.into(), caption, &shared));
        }
        for scene in scenes.iter().filter(|s| !s.is_problem() && s.wants(kind)) {
            tasks.push(task(kind, format!("{}-{kind}", scene.name), caption, &[scene]));
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
    let scenes: Vec<Scene> = scenes.iter().copied().cloned().collect();
    let mut hashed = BTreeMap::new();
    for Scene { name, title, f, .. } in &scenes {
        hashed.insert(format!("{name}.title"), title.clone());
        hashed.insert(format!("{name}.f"), f.to_string());
    }
    let needs = scenes.iter().map(surface).collect();
    let title = "Where the paper stopped, where the solution is, and the difference";
    let task = drawing("stops", title.into(), needs, move |inputs| {
        let mut rows = Vec::new();
        for scene in &scenes {
            let stop = solve::pair(inputs, scene, scene.stop[0])?;
            let solution = solve::solution(scene)?;
            let y = solution.y.iter().zip(&stop.y).map(|(v, y)| v - y).collect();
            let difference = Pair { y, a: vec![0.0; stop.a.len()] };
            let names = ["where it stopped", "the solution", "the difference"];
            let titles = names.map(|name| format!("{}: {name}", scene.title));
            rows.push((scene.finest(), titles, [stop, solution, difference]));
        }
        let mut shown = Vec::new();
        for (grid, titles, pairs) in &rows {
            let range = range_with_zero(pairs.iter().flat_map(|pair| &pair.y).copied());
            let (grid, azimuth) = (*grid, uphill(*grid, &pairs[1].y));
            for (title, pair) in titles.iter().zip(pairs) {
                shown.push(Surface { title, grid, pair, azimuth, range: Some(range) });
            }
        }
        Ok(surfaces(3, &shown))
    });
    Task { parameters: hashed, ..task }
}

fn task(kind: Output, name: String, caption: &str, scenes: &[&Scene]) -> Task {
    let scenes: Vec<Scene> = scenes.iter().copied().cloned().collect();
    let titles: Vec<&str> = scenes.iter().map(|scene| &*scene.title).collect();
    let title = format!("{caption}: {}", titles.join("; "));
    // Drawing reads nothing else of a scene.
    let mut hashed = BTreeMap::from([("kind".to_owned(), kind.to_string())]);
    for scene in &scenes {
        let mut read = serde_json::json!({ "title": scene.title });
        match kind {
            Output::Source | Output::Identify => read["f"] = scene.f.to_string().into(),
            _ => read["grids"] = scene.grids.iter().map(|grid| grid.cells()).collect(),
        }
        let named = |(key, value)| (format!("{}.{key}", scene.name), value);
        hashed.extend(parameters(&read).into_iter().map(named));
    }
    let needs = scenes.iter().flat_map(|scene| needs(kind, scene)).collect();
    let draw = move |inputs: &Inputs| Ok(draw(kind, &scenes, inputs)?);
    Task { parameters: hashed, ..drawing(&name, title, needs, draw) }
}

/// The tasks from whose artifacts a kind of figure is drawn.
fn needs(kind: Output, scene: &Scene) -> Vec<String> {
    match kind {
        Output::Surface => vec![surface(scene)],
        Output::History => solve::ids(scene, scene.stop[0]).collect(),
        Output::Contact => {
            scene.stop.iter().map(|&stop| solve::id(scene, stop, scene.draw_r)).collect()
        }
        Output::Identify => vec![identify::id(scene)],
        Output::Source | Output::Table => Vec::new(),
    }
}

/// The task that draws the figure `name`; its title is its only parameter.
pub(super) fn drawing(
    name: &str,
    title: String,
    needs: Vec<String>,
    draw: impl Fn(&Inputs) -> Result<Picture, Failure> + Send + Sync + 'static,
) -> Task {
    let (picture, table) = (format!("{name}.svg"), format!("{name}.csv"));
    let parameters = BTreeMap::from([("title".into(), title.clone())]);
    let task = Task::new(id(name), parameters, needs, move |inputs| {
        let digest = &inputs.digest[..12];
        let description =
            format!("Made by `signorini run --only figures` from inputs {digest} (blake3).");
        let drawn = draw(inputs)?;
        let svg = drawn.svg(&title, &description)?;
        let mut made = Artifacts::from([(picture.clone(), svg.into_bytes())]);
        made.extend(drawn.table.map(|text| (table.clone(), text.into_bytes())));
        Ok(made)
    });
    Task { export: Some("figures"), ..task }
}

pub(super) fn id(name: &str) -> String {
    format!("figures/{name}")
}

/// The task whose pair is drawn as a surface.
fn surface(scene: &Scene) -> String {
    solve::id(scene, scene.stop[0], scene.draw_r)
}

fn draw(kind: Output, scenes: &[Scene], inputs: &Inputs) -> Result<Picture, String> {
    match kind {
        Output::Source | Output::Table => {
            let maps: Vec<_> = scenes.iter().map(|scene| (&*scene.title, &scene.f)).collect();
            Ok(maps_of_f(&maps))
        }
        Output::Surface => {
            let pairs = scenes.iter().map(|scene| solve::pair(inputs, scene, scene.stop[0]));
            let pairs = pairs.collect::<Result<Vec<_>, _>>()?;
            let shown = scenes.iter().zip(&pairs).map(|(scene, pair)| {
                let (title, grid) = (&scene.title, scene.finest());
                Surface { title, grid, pair, azimuth: uphill(grid, &pair.y), range: None }
            });
            Ok(surfaces(2, &shown.collect::<Vec<_>>()))
        }
        Output::History => {
            let shown = scenes.iter().map(|scene| history(scene, inputs));
            Ok(histories(&shown.collect::<Result<Vec<_>, _>>()?))
        }
        Output::Contact => {
            let shown = scenes.iter().map(|scene| contacts(scene, inputs));
            Ok(contact(&shown.collect::<Result<Vec<_>, _>>()?))
        }
        Output::Identify => {
            let found =
                scenes.iter().map(|scene| from_json(inputs, &identify::id(scene), FINDINGS));
            let found = found.collect::<Result<Vec<Findings>, _>>()?;
            let shown = scenes.iter().zip(&found).map(|(scene, found)| IdentifiabilityPanel {
                title: &scene.title,
                slice: &found.slice,
                cells: found.target.cells(),
                others: two_valued(found),
            });
            Ok(identifiability(&shown.collect::<Vec<_>>()))
        }
    }
}

fn history<'a>(scene: &'a Scene, inputs: &Inputs) -> Result<HistoryPanel<'a>, String> {
    let runs = solve::ids(scene, scene.stop[0]).zip(&scene.r);
    let runs = runs.map(|(task, r)| Ok((format!("r = {r}"), from_json(inputs, &task, HISTORY)?)));
    let runs = runs.collect::<Result<_, String>>()?;
    Ok(HistoryPanel { title: &scene.title, grids: &scene.grids, runs })
}

fn contacts<'a>(scene: &'a Scene, inputs: &Inputs) -> Result<ContactPanel<'a>, String> {
    let lines = scene.stop.iter().map(|&stop| {
        let label = format!("stop: {stop}, r = {}", scene.draw_r);
        Ok((label, solve::pair(inputs, scene, stop)?))
    });
    let lines = lines.collect::<Result<_, String>>()?;
    Ok(ContactPanel { title: &scene.title, grid: scene.finest(), lines })
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
