//! `status` and `explain`: the stale tasks, and the reasons.

use super::output::{columns_of, cut, say, say_json, styled};
use super::pipeline::{Scope, Workplace};
use super::run::exports;
use super::{CacheArgs, name_parser};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Judged, Reason, Summary, Verdict, stage};
use crate::replication::stages::Stage;
use crate::table::Table;
use anstyle::AnsiColor;
use clap::{Args, ValueEnum};
use std::collections::BTreeMap;

#[derive(Args)]
pub(super) struct StatusArgs {
    /// Scenes to look at [default: all]
    #[arg(value_name = "SCENE", value_parser = name_parser)]
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
    #[arg(value_parser = name_parser)]
    stage: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn status(args: &StatusArgs) -> Result<u8> {
    let workplace = Workplace::open_for(&args.cache, &args.scenes)?;
    let scope = if args.scenes.is_empty() { Scope::Whole } else { Scope::Part };
    let summary = workplace.judge(&workplace.tasks(&args.scenes, None)?, scope, false)?;
    let stale = !summary.nothing_to_do();
    if args.json {
        let tasks: BTreeMap<_, _> =
            summary.verdicts.iter().map(|j| (&j.task, &j.verdict)).collect();
        let files = exports(&summary);
        let files: Vec<&str> = files.lines().collect();
        say_json(
            &serde_json::json!({ "schema": 1, "stale": stale, "tasks": tasks, "files": files }),
        )?;
    } else {
        let mut text = table(&summary, width());
        text += &exports(&summary);
        say(&text)?;
    }
    Ok(u8::from(args.exit_code && stale))
}

/// Number of columns at which lines are cut: of the environment, or of the terminal.
fn width() -> usize {
    let given = std::env::var("COLUMNS").ok().and_then(|text| text.trim().parse().ok());
    given.filter(|&columns| columns > 0).unwrap_or_else(|| columns_of(&std::io::stdout()))
}

/// Returns a line for each stage: its state, the number of tasks in that state, and one of them with the reason; then a
/// line on all tasks.
fn table(summary: &Summary, width: usize) -> String {
    let (mut states, mut rows) = (Vec::new(), Vec::new());
    for stage in Stage::value_variants() {
        let mut tasks: Vec<&Judged> = summary.verdicts.iter().collect();
        tasks.retain(|judged| Stage::of(&judged.task) == Some(*stage));
        let mut late = tasks.clone();
        late.retain(|judged| judged.verdict != Verdict::Fresh);
        let mut stale = late.iter().filter(|judged| matches!(judged.verdict, Verdict::Stale(_)));
        let shown = stale.next().or(late.first());
        let (state, color, reason) = match shown.map(|judged| &judged.verdict) {
            None if tasks.is_empty() => continue,
            None => ("up to date", AnsiColor::Green, String::new()),
            Some(Verdict::Stale(reason)) => ("stale", AnsiColor::Yellow, reason.to_string()),
            Some(other) => ("waits", AnsiColor::Cyan, other.to_string()),
        };
        let count = match late.len() {
            0 => tasks.len().to_string(),
            late => format!("{late} of {}", tasks.len()),
        };
        let task = shown.map_or(String::new(), |judged| judged.task.clone());
        states.push((state, styled(state, color)));
        rows.push(vec![stage.to_string(), state.to_owned(), count, task, reason]);
    }
    let mut text = String::new();
    for (line, (state, styled)) in
        Table::without_head(rows, &[0, 1, 3, 4]).text().lines().zip(states)
    {
        // Coloured after the cut: the codes of colours take no columns.
        text += &(cut(line, width).replacen(state, &styled, 1) + "\n");
    }
    text + &totals(summary)
}

/// Returns a line with the number of tasks, and of those in each state.
fn totals(summary: &Summary) -> String {
    let (mut fresh, mut stale, mut waiting) = (0, 0, 0);
    for judged in &summary.verdicts {
        match judged.verdict {
            Verdict::Fresh => fresh += 1,
            Verdict::Stale(_) => stale += 1,
            Verdict::Waits(_) => waiting += 1,
        }
    }
    let mut counts = Vec::new();
    for (count, state) in [(fresh, "up to date"), (stale, "stale"), (waiting, "waiting for those")]
    {
        if count > 0 {
            counts.push(format!("{count} {state}"));
        }
    }
    let tasks = match summary.verdicts.len() {
        1 => "1 task".to_owned(),
        count => format!("{count} tasks"),
    };
    format!("{tasks}: {}\n", counts.join(", "))
}

pub(super) fn explain(args: &ExplainArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let tasks = workplace.tasks(&[], None)?;
    let summary = workplace.judge(&tasks, Scope::Whole, false)?;
    let mut asked: Vec<&Judged> = summary.verdicts.iter().collect();
    asked.retain(|Judged { task, .. }| match tasks.task(&args.stage) {
        Some(one) => one.id == *task,
        None if args.stage.contains('/') => task.starts_with(&args.stage),
        None => stage(task) == args.stage,
    });
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
    let (mut text, mut fresh) = (String::new(), Vec::new());
    for judged in asked {
        match &judged.verdict {
            Verdict::Fresh => fresh.push(&judged.task),
            Verdict::Stale(Reason::Changed(changes)) => {
                text += &format!("{}: stale\n", judged.task);
                for change in changes {
                    text += &format!("  {change}\n");
                }
            }
            other => text += &format!("{}: {other}\n", judged.task),
        }
        // Inputs of a waiting task may have changed besides those for which it waits.
        if matches!(judged.verdict, Verdict::Waits(_))
            && let Some(task) = tasks.task(&judged.task)
            && let Some(last) = workplace.store.manifests(&judged.task).first()
        {
            for change in tasks.own_changes(task, last)? {
                text += &format!("  {change}\n");
            }
        }
    }
    match &fresh[..] {
        [] => {}
        [task] => text += &format!("{task}: up to date\n"),
        tasks => text += &format!("{} tasks of {}: up to date\n", tasks.len(), args.stage),
    }
    say(&text)
}
