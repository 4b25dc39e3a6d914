//! `dag`: the graph of tasks, for programs that draw it or run it.

use super::CacheArgs;
use super::output::say;
use super::pipeline::{CACHE, Workplace};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Engine, Plan, mermaid};
use clap::Args;
use std::io;
use std::path::{Path, absolute};

/// Text at the end of `dag --help`.
pub(super) const EXAMPLES: &str = "\
A workflow is to be run in the folder of the project. `signorini run` then finds \
everything done, and writes figures/ and report/.\n\
Examples:\n  \
  signorini dag --mermaid > dag.mmd\n  \
  signorini dag --snakemake > Snakefile && snakemake --cores 8";

#[derive(Args)]
pub(super) struct DagArgs {
    #[command(flatten)]
    form: Form,
    #[command(flatten)]
    cache: CacheArgs,
}

/// Format of the graph.
#[derive(Args)]
#[group(multiple = false)]
struct Form {
    /// For Mermaid, which draws it in Markdown
    #[arg(long)]
    mermaid: bool,
    /// As a Snakefile that runs one task per job, on this machine or a cluster
    #[arg(long)]
    snakemake: bool,
    /// As JSON: each task, what it needs, and the file that says that it is done
    #[arg(long)]
    json: bool,
}

#[expect(clippy::redundant_closure_for_method_calls, reason = "an engine has a lifetime")]
pub(super) fn dag(args: &DagArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let plan = workplace.tasks(&[], None)?;
    let root = &workplace.project.root;
    let form = &args.form;
    say(&match () {
        () if form.mermaid => mermaid(plan.tasks()),
        () if form.snakemake => workflow(&plan, root, &args.cache, |engine| engine.snakemake())?,
        () if form.json => workflow(&plan, root, &args.cache, |engine| Ok(engine.json()))?,
        () => list(&plan),
    })
}

/// Returns a line for each task, with the tasks that it needs.
fn list(plan: &Plan) -> String {
    let mut text = String::new();
    for task in plan.tasks() {
        text += &task.id;
        if !task.needs.is_empty() {
            text += &format!(" <- {}", task.needs.join(", "));
        }
        text.push('\n');
    }
    text
}

/// Returns the plan as text for an engine; the cache is named by an absolute path, unless it is the default one in the
/// project with this root.
fn workflow(
    plan: &Plan,
    root: &Path,
    cache: &CacheArgs,
    text: fn(&Engine) -> Result<String>,
) -> Result<String> {
    let program = std::env::current_exe().map_err(gone)?;
    let elsewhere = cache.cache_dir.as_deref().map(absolute).transpose().map_err(gone)?;
    let elsewhere = elsewhere.filter(|folder| *folder != root.join(CACHE));
    text(&Engine::new(plan, &program, elsewhere.as_deref().unwrap_or(Path::new(CACHE)))?)
}

fn gone(e: io::Error) -> Error {
    Error::input(format!("the folder of the program or of the cache is gone ({e})"))
}
