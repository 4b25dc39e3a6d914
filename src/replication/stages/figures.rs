//! The `figures` stage: one SVG per task; the paper's problems share theirs, other scenes have their own.

mod book;

use super::identify::{self, FINDINGS};
use super::solve::{self, HISTORY};
use super::{from_json, members, sharing, study};
use crate::figures::{
    ContactPanel, DrawnSolution, HistoryCurve, HistoryPanel, IdentifiabilityPanel, Picture,
    SolutionMap, contact, histories, identifiability, map_of_f, maps_of_f, surfaces,
};
use crate::pipeline::error::Failure;
use crate::pipeline::{Artifacts, InputFiles, Inputs, Made, Task};
use crate::replication::mesh_files;
use crate::replication::project::Project;
use crate::replication::scene::{Output, Scene};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use signorini_mathematics::identify::Findings;
use signorini_mathematics::problem::text::percent;

/// Kind of figure.
pub(super) struct Kind {
    /// Output with which a scene asks for it.
    pub(super) output: Output,
    /// Name of the figure that the paper's problems share and the chapters show; none where each scene has its own.
    pub(super) shared_name: Option<&'static str>,
    /// Words for the contents of the figure, in its title.
    caption: &'static str,
}

/// All kinds of figure.
pub(super) const KINDS: [Kind; 7] = [
    Kind { output: Output::Source, shared_name: Some("figure1"), caption: "Right-hand side f" },
    Kind { output: Output::Surface, shared_name: Some("figure2"), caption: "Surface v" },
    Kind { output: Output::Map, shared_name: None, caption: "Map of v" },
    Kind {
        output: Output::History,
        shared_name: Some("histories"),
        caption: "Gradient against iterations",
    },
    Kind {
        output: Output::Contact,
        shared_name: Some("contact"),
        caption: "Trace and multiplier along the boundary",
    },
    Kind {
        output: Output::Identify,
        shared_name: Some("identifiability"),
        caption: "Published counts that come out, around the recovered f",
    },
    Kind { output: Output::Chart, shared_name: None, caption: "Study" },
];

/// Returns the name of the scene whose own figure has this name.
pub(super) fn scene_of(name: &str) -> Option<&str> {
    KINDS.iter().find_map(|kind| name.strip_suffix(&kind.output.to_string())?.strip_suffix('-'))
}

/// The figure tasks of `scenes`; shared ones only if all scenes of `project` that share them are there.
pub(super) fn tasks(project: &Project, scenes: &[&Scene]) -> Vec<Task> {
    let mut tasks = Vec::new();
    for kind in &KINDS {
        let output = kind.output;
        let is_own = |scene: &Scene| kind.shared_name.is_none() || !scene.is_problem();
        if let Some(name) = kind.shared_name {
            let shared = sharing(project, scenes, output);
            if !shared.is_empty() {
                tasks.push(task(kind, name, &shared));
            }
        }
        for scene in scenes.iter().filter(|scene| is_own(scene) && scene.wants(output)) {
            tasks.push(task(kind, &format!("{}-{output}", scene.name), &[scene]));
        }
    }
    let shared = sharing(project, scenes, Output::Surface);
    if !shared.is_empty() && !project.templates.is_empty() {
        tasks.extend([book::stops(&shared), book::gradients(&shared)]);
        tasks.extend(shared.last().map(|scene| book::iterates(scene)));
        tasks.extend(book::drawings());
    }
    tasks
}

/// Figure of scenes, in the order of its panels.
#[derive(Serialize, Deserialize)]
struct SceneFigure {
    kind: Output,
    scenes: Vec<Scene>,
    /// True if the scenes ask for nothing else, so that no page offers their solutions as files.
    is_alone: bool,
}

/// The task that draws the figure `name` of `scenes`.
fn task(kind: &Kind, name: &str, scenes: &[&Scene]) -> Task {
    let kind = kind.output;
    let files: InputFiles = scenes.iter().flat_map(|scene| scene.files.clone()).collect();
    let needs = scenes.iter().flat_map(|scene| needs(kind, scene)).collect();
    let is_alone = scenes.iter().all(|scene| scene.outputs == [kind]);
    let scenes = scenes.iter().map(|scene| shown(kind, scene)).collect();
    let figure = SceneFigure { kind, scenes, is_alone };
    drawing(name, &figure, needs, |SceneFigure { kind, scenes, is_alone }, inputs| {
        let drawn: Vec<Scene> = scenes.iter().map(titled).collect();
        let mut picture = draw(*kind, &drawn, inputs)?;
        if let [Scene { picture: Some(print), .. }] = &drawn[..] {
            picture.print.clone_from(&print.width);
        }
        if *is_alone && *kind == Output::Map {
            picture.table = Some(numbers(inputs, scenes)?);
        }
        if [Output::Surface, Output::Contact].contains(kind) {
            picture.note = bounds(inputs, scenes)?;
        }
        if let (Output::Map, [scene]) = (kind, &scenes[..]) {
            let numbers = solve::drawn(inputs, scene, scene.first_rule())?;
            picture.note = solve::warnings_in_words(scene, &numbers);
        }
        let caption = KINDS.iter().find(|one| one.output == *kind).map_or("", |one| one.caption);
        let titles: Vec<&str> = scenes.iter().map(|scene| &*scene.title).collect();
        made(inputs, &format!("{caption}: {}", titles.join("; ")), picture)
    })
    .with_files(files)
}

/// Returns a scene with the title that its picture has: none in print, if the scene says so.
fn titled(scene: &Scene) -> Scene {
    let mut titled = scene.clone();
    if scene.picture.as_ref().is_some_and(|print| !print.title) {
        titled.title.clear();
    }
    titled
}

/// Returns a scene without what no figure of this kind shows: other outputs, runs that are not drawn, and what the runs
/// alone read.
fn shown(kind: Output, scene: &Scene) -> Scene {
    let mut shown = Scene { outputs: vec![kind], ..scene.clone() };
    if scene.is_study {
        return shown;
    }
    let drawn = scene.saddle();
    let members = &mut shown.study.members;
    members.retain(|member| {
        (kind == Output::History || member.r().is_none_or(|r| r == drawn.r))
            && (kind == Output::Contact || member.rule().is_none_or(|rule| rule == drawn.stop))
    });
    for member in members {
        member.statement.saddle = member.rule_and_r();
    }
    shown.statement.saddle = scene.drawn(scene.first_rule()).rule_and_r();
    shown
}

/// Ids of the tasks from whose artifacts the figure of a scene is drawn.
fn needs(output: Output, scene: &Scene) -> Vec<String> {
    match output {
        Output::Surface | Output::Map => vec![surface(scene)],
        Output::History => {
            let members = scene.under(scene.first_rule());
            members.map(|member| members::id_of(scene, member)).collect()
        }
        Output::Contact => {
            let drawn = scene.rules().into_iter().map(|rule| scene.drawn(rule));
            drawn.map(|member| members::id_of(scene, member)).collect()
        }
        Output::Identify => vec![identify::id(scene)],
        Output::Chart => members::ids(scene).collect(),
        Output::Source | Output::Table => Vec::new(),
    }
}

/// Picture with a title, of these scenes.
#[derive(Serialize, Deserialize)]
pub(super) struct Drawing {
    title: String,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    scenes: Vec<Scene>,
}

/// Function that draws such a picture.
pub(super) type Draw = fn(&Drawing, &Inputs) -> Made;

impl Drawing {
    /// Picture with this title, of no scene.
    pub(super) fn new(title: &str) -> Self {
        Self { title: title.into(), scenes: Vec::new() }
    }

    /// As [`made`], with the title.
    pub(super) fn made(&self, inputs: &Inputs, picture: Picture) -> Made {
        made(inputs, &self.title, picture)
    }
}

/// The task that draws the figure `name` from a value.
pub(super) fn drawing<P: Serialize + DeserializeOwned + 'static>(
    name: &str,
    value: &P,
    needs: Vec<String>,
    draw: fn(&P, &Inputs) -> Made,
) -> Task {
    Task::new(id(name), value, needs, draw).exported_to(FOLDER)
}

/// Returns a picture as the artifacts of the task that draws it: the SVG, and its table if it has one.
pub(super) fn made(inputs: &Inputs, title: &str, picture: Picture) -> Made {
    let name = inputs.task.trim_start_matches(FOLDER).trim_start_matches('/');
    let description = format!(
        "Made by `signorini run --only figures` from inputs {} (blake3).",
        &inputs.digest[..12]
    );
    let svg = picture.svg(title, &(picture.note.clone() + &description))?;
    let mut made = Artifacts::from([(format!("{name}.svg"), svg.into_bytes())]);
    made.extend(picture.table.map(|text| (format!("{name}.csv"), text.into_bytes())));
    Ok(made)
}

/// Folder of the project with the figures.
const FOLDER: &str = "figures";

pub(super) fn id(name: &str) -> String {
    format!("{FOLDER}/{name}")
}

/// The task whose pair is drawn as a surface.
fn surface(scene: &Scene) -> String {
    members::id_of(scene, scene.drawn(scene.first_rule()))
}

fn draw(output: Output, scenes: &[Scene], inputs: &Inputs) -> Result<Picture, Failure> {
    match output {
        Output::Source | Output::Table => draw_maps(scenes, inputs),
        Output::Surface => draw_surfaces(scenes, inputs),
        Output::Map => draw_map(scenes, inputs),
        Output::History => {
            let panels = scenes.iter().map(|scene| history(scene, inputs));
            Ok(histories(&panels.collect::<Result<Vec<_>, _>>()?))
        }
        Output::Contact => draw_contact(scenes, inputs),
        Output::Identify => Ok(draw_identifiability(scenes, inputs)?),
        Output::Chart => Ok(study::chart(&scenes[0], inputs)?),
    }
}

/// Draws f: on the square by the borders of its pieces, on a mesh by its means over the triangles.
fn draw_maps(scenes: &[Scene], inputs: &Inputs) -> Result<Picture, Failure> {
    if let [scene] = scenes
        && !scene.statement.has_grids()
    {
        let problem = mesh_files::problem(&scene.statement.on_usual_meshes(), inputs.files)?;
        return Ok(map_of_f(&scene.title, &problem)?);
    }
    let maps: Vec<_> = scenes.iter().map(|scene| (&*scene.title, scene.source())).collect();
    Ok(maps_of_f(&maps))
}

fn draw_surfaces(scenes: &[Scene], inputs: &Inputs) -> Result<Picture, Failure> {
    let mut drawn = Vec::new();
    for scene in scenes {
        let (problem, rule) = (solve::problem(inputs, scene)?, scene.first_rule());
        let pair = solve::pair(inputs, scene, rule, &problem)?;
        let title = title_with_bound(inputs, scene)?;
        drawn.push(DrawnSolution::of(title, &problem, &pair, 2)?);
    }
    Ok(surfaces(2, &drawn))
}

/// Draws the map of the solution of one scene.
fn draw_map(scenes: &[Scene], inputs: &Inputs) -> Result<Picture, Failure> {
    let [scene] = scenes else { return Err("each scene has a map of its own".into()) };
    let problem = solve::problem(inputs, scene)?;
    let pair = solve::pair(inputs, scene, scene.first_rule(), &problem)?;
    Ok(SolutionMap::of(title_with_end(inputs, scene)?, &problem, &pair)?.picture())
}

/// Returns, as CSV, the energy of each scene with its bracket, the bound of its error over the solution, and the share
/// of the boundary under the law that sticks.
fn numbers(inputs: &Inputs, scenes: &[Scene]) -> Result<String, Failure> {
    let mut table = "energy,energy_lower,energy_upper,error,held\n".to_owned();
    for scene in scenes {
        let rule = scene.first_rule();
        let found = solve::drawn(inputs, scene, rule)?;
        let [lower, upper, error] =
            [found.last.energy_lower, found.last.energy_upper, found.last.error_relative]
                .map(|number| number.map_or(String::new(), |number| number.to_string()));
        let energy = found.last.energy.unwrap_or(f64::NAN);
        let problem = solve::problem(inputs, scene)?;
        let held = solve::held(&problem, &solve::pair(inputs, scene, rule, &problem)?);
        table += &format!("{energy},{lower},{upper},{error},{held}\n");
    }
    Ok(table)
}

/// Returns the title of a scene, with the end of its solver unless that is a solution, above the bound of its error.
fn title_with_bound(inputs: &Inputs, scene: &Scene) -> Result<String, String> {
    let title = title_with_end(inputs, scene)?;
    let relative = solve::relative(scene, &solve::drawn(inputs, scene, scene.first_rule())?);
    Ok(match relative.filter(|_| !title.is_empty()) {
        Some(error) => format!("{title}\nerror at most {}", percent(error, 3)),
        None => title,
    })
}

/// Returns the title of a scene, with the end of its solver unless that is a solution. A picture of the paper's
/// problems is of the place where its rule stops, which the page says.
fn title_with_end(inputs: &Inputs, scene: &Scene) -> Result<String, String> {
    let (title, rule) = (&scene.title, scene.first_rule());
    let numbers = solve::drawn(inputs, scene, rule)?;
    Ok(match solve::no_solution(&numbers) {
        _ if title.is_empty() => String::new(),
        Some(end) => format!("{title} ({end})"),
        None => {
            let mut title = title.clone();
            if rule.is_some() && scene.paper_table.is_none() {
                title += ", where the rule stops";
            }
            match solve::warnings(scene, &numbers).len() {
                0 => title,
                1 => title + " (a warning)",
                count => format!("{title} ({count} warnings)"),
            }
        }
    })
}

/// Returns the guaranteed bounds of the scenes in a picture, in sentences.
fn bounds(inputs: &Inputs, scenes: &[Scene]) -> Result<String, String> {
    let mut sentences = String::new();
    for scene in scenes {
        let numbers = solve::drawn(inputs, scene, scene.first_rule())?;
        sentences += &solve::bounds_in_words(scene, &numbers);
    }
    Ok(sentences)
}

fn history<'a>(scene: &'a Scene, inputs: &Inputs) -> Result<HistoryPanel<'a>, String> {
    let mut runs = Vec::new();
    let drawn = scene.drawn(scene.first_rule());
    for (member, r) in scene.under(scene.first_rule()).zip(scene.r()) {
        let levels = from_json(inputs, &members::id_of(scene, member), HISTORY)?;
        let is_drawn = member == drawn;
        runs.push(HistoryCurve { label: format!("r = {r}"), is_drawn, levels });
    }
    Ok(HistoryPanel { title: &scene.title, grids: scene.grids(), runs })
}

/// Draws, for each closed curve of the boundaries, the trace and the multiplier where each rule stops, and, of the
/// paper's problems, the true ones.
fn draw_contact(scenes: &[Scene], inputs: &Inputs) -> Result<Picture, Failure> {
    let mut panels = Vec::new();
    for scene in scenes {
        let problem = solve::problem(inputs, scene)?;
        let mut ends = Vec::new();
        for rule in scene.rules() {
            ends.push(solve::no_solution(&solve::drawn(inputs, scene, rule)?));
        }
        // An end that several rules have, and no other does, is said once.
        let is_common = ends.len() > 1 && ends.iter().all(|end| *end == ends[0]);
        let common = ends[0].as_deref().filter(|_| is_common);
        let title = match common {
            Some(end) => format!("{} (every run: {end})", scene.title),
            None => scene.title.clone(),
        };
        let mut solutions = Vec::new();
        for (rule, end) in scene.rules().into_iter().zip(&ends) {
            let mut label = solve::label(scene, rule);
            if let Some(end) = end.as_ref().filter(|_| common.is_none()) {
                label += &format!(", {end}");
            }
            solutions.push((label, solve::pair(inputs, scene, rule, &problem)?));
        }
        if scene.is_problem() {
            let truth =
                problem.true_solution().map_err(|e| format!("scene `{}`: {e}", scene.name))?;
            solutions.push(("true solution".into(), truth.at_nodes(&problem)));
        }
        panels.extend(ContactPanel::of(&title, &problem, &solutions)?);
    }
    Ok(contact(&panels))
}

fn draw_identifiability(scenes: &[Scene], inputs: &Inputs) -> Result<Picture, String> {
    let mut found: Vec<Findings> = Vec::new();
    for scene in scenes {
        found.push(from_json(inputs, &identify::id(scene), FINDINGS)?);
    }
    let mut panels = Vec::new();
    for (scene, found) in scenes.iter().zip(&found) {
        panels.push(IdentifiabilityPanel {
            title: &scene.title,
            slice: &found.slice,
            cells: found.target.cells(),
            others: two_valued(found),
        });
    }
    Ok(identifiability(&panels))
}

/// Returns the alternatives in the plane of the map: one value on the first quadrant, one on all others.
fn two_valued(found: &Findings) -> Vec<[f64; 2]> {
    let mut values = Vec::new();
    for other in found.alternatives.iter().filter(|other| !other.chosen) {
        if let [first, rest, b, c] = other.values[..]
            && rest == b
            && rest == c
        {
            values.push([first, rest]);
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replication::stages::solve::tests::{ACCURATE, with_solved};

    #[test]
    fn pictures_of_scenes_with_an_accuracy_solve_nothing() {
        for text in ACCURATE {
            with_solved(text, |inputs, scene| {
                for output in [Output::Map, Output::Surface, Output::Contact] {
                    draw(output, std::slice::from_ref(scene), inputs).unwrap();
                }
            });
        }
    }
}
