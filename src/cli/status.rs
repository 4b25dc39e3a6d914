//! `status` and `explain`: what is stale, and why.

use super::pipeline::Workplace;
use super::run::exports;
use super::{CacheArgs, say, say_json, styled};
use crate::error::{Error, Result};
use crate::pipeline::{Reason, Stage, Verdict};
use anstyle::AnsiColor;
use clap::Args;
use std::collections::BTreeMap;

/// Arguments of `status`.
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

/// Arguments of `explain`.
#[derive(Args)]
pub(super) struct ExplainArgs {
    /// A stage (solve, tabulate, diff, identify, figures, report) or the beginning of a task's id
    stage: String,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn status(args: &StatusArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let summary = workplace.judge(&workplace.tasks(&args.scenes, None)?)?;
    let stale = !summary.nothing_to_do();
    if args.json {
        let tasks: BTreeMap<_, _> =
            summary.verdicts.iter().map(|j| (&j.task, &j.verdict)).collect();
        say_json(&serde_json::json!({ "schema": 1, "stale": stale, "tasks": tasks }))?;
    } else {
        let mut text = String::new();
        for stage in Stage::ALL {
            let of: Vec<_> = summary.verdicts.iter().filter(|j| j.stage == stage).collect();
            let stale: Vec<_> = of.iter().filter(|j| j.verdict != Verdict::Fresh).collect();
            let Some(first) = stale.first() else {
                if !of.is_empty() {
                    let state = styled("up to date", AnsiColor::Green);
                    text += &format!("{:<9} {state}  {} tasks\n", stage.name(), of.len());
                }
                continue;
            };
            let state = styled("stale", AnsiColor::Yellow);
            text += &format!(
                "{:<9} {state}       {} of {} tasks, e.g. {}: {}\n",
                stage.name(),
                stale.len(),
                of.len(),
                first.task,
                first.verdict
            );
        }
        text += &exports(&summary);
        say(&text)?;
    }
    Ok(u8::from(args.exit_code && stale))
}

pub(super) fn explain(args: &ExplainArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let summary = workplace.judge(&workplace.tasks(&[], None)?)?;
    let prefix = format!("{}/", args.stage);
    let asked: Vec<_> = summary
        .verdicts
        .iter()
        .filter(|j| j.task == args.stage || j.task.starts_with(&prefix))
        .collect();
    if asked.is_empty() {
        let names = Stage::ALL.map(Stage::name).join(", ");
        return Err(Error::input(format!(
            "no stage or task `{}`; stages are {names}, `signorini dag` lists the tasks",
            args.stage
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
    }
    say(&text)
}
