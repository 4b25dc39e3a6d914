//! Lines on the members of a scene after a run: those without a solution, and warnings.

use super::members::id_of;
use super::tabulate;
use crate::pipeline::names::in_shell;
use crate::replication::fields::member::{Member, in_words};
use crate::replication::numbers::Numbers;
use crate::replication::record::Grouped;
use crate::replication::scene::{Output, Scene};
use signorini_mathematics::solvers::SaddleSettings;

/// Number of solves that a line names, and of lines of warnings.
const MOST_NAMED: usize = 3;

/// Returns lines on the members of a scene that have no solution, with the command that shows one of them or the table
/// that says why, and on the warnings of the others; `artifact` reads the [`NUMBERS`](super::solve::NUMBERS) of a task,
/// or returns `None` for a task that is not concerned.
pub(crate) fn remarks(scene: &Scene, artifact: impl Fn(&str) -> Option<Vec<u8>>) -> Vec<String> {
    let (mut ends, mut warned) = (Grouped::default(), Grouped::default());
    let mut says_why = None;
    for member in &scene.study.members {
        let Some(bytes) = artifact(&id_of(scene, member)) else { continue };
        let Ok(numbers) = serde_json::from_slice::<Numbers>(&bytes) else { continue };
        let (place, of_member) = named(scene, member);
        if numbers.reason.is_some() {
            ends.add(numbers.stop.unwrap_or_else(|| "no-solution".into()), place);
            says_why.get_or_insert(of_member);
            continue;
        }
        let remedy = numbers.remedy.map_or(String::new(), |remedy| format!("; {remedy}"));
        for (k, fact) in numbers.warnings.iter().enumerate() {
            let is_last = k + 1 == numbers.warnings.len();
            warned.add(format!("{fact}{}", if is_last { &remedy } else { "" }), place.clone());
        }
    }
    let mut lines = Vec::new();
    if let Some(says_why) = says_why {
        let ends = ends.first(usize::MAX).iter();
        let ends: Vec<_> = ends.map(|(end, places)| format!("{end}{}", with(places))).collect();
        lines.push(format!("{}: {}; {says_why} says why", scene.name, ends.join("; ")));
    }
    for (warning, places) in warned.first(MOST_NAMED) {
        lines.push(format!("{}: warning{}: {warning}", scene.name, with(places)));
    }
    let more = warned.beyond(MOST_NAMED);
    if more > 0 {
        lines.push(format!("{}: {more} more warnings", scene.name));
    }
    lines
}

/// Returns the name of a member of a scene, empty if there is one alone, and what shows its end: the command that
/// solves it or, of a study, the table.
fn named(scene: &Scene, member: &Member) -> (String, String) {
    let mut command = format!("signorini solve {}", in_shell(&scene.name));
    if scene.is_study {
        let place = in_words(&scene.study.names, scene.study.values(member));
        let table = format!("{}/{}", tabulate::FOLDER, tabulate::file(scene));
        return (place, if scene.wants(Output::Table) { table } else { format!("`{command}`") });
    }
    let mut place = String::new();
    if let Some(SaddleSettings { stop: rule, r, .. }) = member.statement.saddle {
        place = format!("r = {r}");
        command += &format!(" --r {r}");
        if Some(rule) != scene.first_rule() {
            place += &format!(" under {rule}");
            command += &format!(" --stop {rule}");
        }
    }
    (place, format!("`{command}`"))
}

/// Returns the first places, and the number of the others; nothing where the only one has no name.
fn with(places: &[String]) -> String {
    let named = &places[..places.len().min(MOST_NAMED)];
    let more = match places.len() - named.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    if named[0].is_empty() { String::new() } else { format!(" with {}{more}", named.join(", ")) }
}
