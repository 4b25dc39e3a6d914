//! `status` and `explain`: what is stale, and why.

use super::CacheArgs;
use super::output::{columns, say, say_json, styled};
use super::pipeline::{Scope, Workplace};
use super::run::exports;
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Judged, Reason, Summary, Verdict, stage};
use crate::replication::stages::Stage;
use anstyle::AnsiColor;
use clap::{Args, ValueEnum};
use std::collections::BTreeMap;

#[derive(Args)]
pub(super) struct StatusArgs {
    /// Scenes to look at [default: all]
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,
    /// Exit with 1 if anything is stale
    #[arg(long)]
    exit_code: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

#[derive(Args)]
pub(super) struct ExplainArgs {
    /// A stage (solve, tabulate, diff, identify, bench, figures, report) or the beginning of a task's id
    stage: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn status(args: &StatusArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let scope = if args.scenes.is_empty() { Scope::Whole } else { Scope::Part };
    let summary = workplace.judge(&workplace.tasks(&args.scenes, None)?, scope, false)?;
    let stale = !summary.nothing_to_do();
    if args.json {
        let tasks: BTreeMap<_, _> =
            summary.verdicts.iter().map(|j| (&j.task, &j.verdict)).collect();
        say_json(&serde_json::json!({ "schema": 1, "stale": stale, "tasks": tasks }))?;
    } else {
        let mut text = table(&summary, width());
        text += &exports(&summary);
        say(&text)?;
    }
    Ok(u8::from(args.exit_code && stale))
}

/// Columns of the terminal, where the shell or the user tells.
fn width() -> usize {
    let given = std::env::var("COLUMNS").ok().and_then(|text| text.trim().parse().ok());
    given.filter(|&columns| columns > 0).unwrap_or(usize::MAX)
}

/// A line for each stage: its state, how many tasks are concerned, and one of them with the reason.
fn table(summary: &Summary, width: usize) -> String {
    let (mut states, mut rows) = (Vec::new(), Vec::new());
    for stage in Stage::value_variants() {
        let of_stage = |judged: &&Judged| Stage::of(&judged.task) == Some(*stage);
        let of: Vec<_> = summary.verdicts.iter().filter(of_stage).collect();
        let late: Vec<_> = of.iter().filter(|j| j.verdict != Verdict::Fresh).collect();
        let is_stale = |judged: &&&&Judged| matches!(judged.verdict, Verdict::Stale(_));
        let shown = late.iter().find(is_stale).or(late.first());
        let (state, color, reason) = match shown.map(|judged| &judged.verdict) {
            None if of.is_empty() => continue,
            None => ("up to date", AnsiColor::Green, String::new()),
            Some(Verdict::Stale(reason)) => ("stale", AnsiColor::Yellow, reason.to_string()),
            Some(other) => ("waits", AnsiColor::Cyan, other.to_string()),
        };
        let count = match late.len() {
            0 => of.len().to_string(),
            late => format!("{late} of {}", of.len()),
        };
        let task = shown.map_or(String::new(), |judged| judged.task.clone());
        states.push((state, styled(state, color)));
        rows.push(vec![stage.to_string(), state.to_owned(), count, task, reason]);
    }
    let lines = columns(&[], &[0, 1, 3, 4], rows);
    let colored = lines.lines().zip(states).map(|(line, (state, styled))| {
        // After it was cut: colours take no room.
        cut(line, width).replacen(state, &styled, 1) + "\n"
    });
    let count =
        |of: fn(&Verdict) -> bool| summary.verdicts.iter().filter(|j| of(&j.verdict)).count();
    let counts = [
        (count(|v| *v == Verdict::Fresh), "up to date"),
        (count(|v| matches!(v, Verdict::Stale(_))), "stale"),
        (count(|v| matches!(v, Verdict::Waits(_))), "waiting for those"),
    ];
    let counts = counts.iter().filter(|(n, _)| *n > 0).map(|(n, state)| format!("{n} {state}"));
    let counts = counts.collect::<Vec<_>>().join(", ");
    colored.collect::<String>() + &format!("{} tasks: {counts}\n", summary.verdicts.len())
}

/// The text in so many columns, with dots where something is missing.
fn cut(text: &str, width: usize) -> String {
    if text.chars().count() <= width {
        return text.to_owned();
    }
    let kept: String = text.chars().take(width.saturating_sub(3)).collect();
    kept.trim_end().to_owned() + "..."
}

pub(super) fn explain(args: &ExplainArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let tasks = workplace.tasks(&[], None)?;
    let summary = workplace.judge(&tasks, Scope::Whole, false)?;
    // A stage, a task, or the beginning of the ids of several.
    let is_asked = |id: &str| match tasks.task(&args.stage) {
        Some(task) => task.id == id,
        None if args.stage.contains('/') => id.starts_with(&args.stage),
        None => stage(id) == args.stage,
    };
    let asked: Vec<_> = summary.verdicts.iter().filter(|j| is_asked(&j.task)).collect();
    if asked.is_empty() {
        let names: Vec<_> = Stage::value_variants().iter().map(Stage::to_string).collect();
        return Err(Error::input(format!(
            "no stage or task `{}`; stages are {}; `signorini dag` lists the tasks",
            args.stage,
            names.join(", ")
        )));
    }
    if args.json {
        let tasks: BTreeMap<_, _> = asked.into_iter().map(|j| (&j.task, &j.verdict)).collect();
        return say_json(&serde_json::json!({ "schema": 1, "tasks": tasks }));
    }
    let mut text = String::new();
    for judged in asked {
        match &judged.verdict {
            Verdict::Stale(Reason::Changed(changes)) => {
                text += &format!("{}: stale\n", judged.task);
                changes.iter().for_each(|change| text += &format!("  {change}\n"));
            }
            other => text += &format!("{}: {other}\n", judged.task),
        }
        // Of what waits, more may have changed than what it waits for.
        if matches!(judged.verdict, Verdict::Waits(_)) {
            let task = tasks.task(&judged.task);
            let last = workplace.store.manifests(&judged.task).into_iter().next();
            let changes = task.zip(last).map(|(task, last)| tasks.own_changes(task, &last));
            let changes = changes.into_iter().flatten();
            changes.for_each(|change| text += &format!("  {change}\n"));
        }
    }
    say(&text)
}
