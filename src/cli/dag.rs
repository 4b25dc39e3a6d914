//! `dag`: the graph of tasks, to look at or for another program to run.

use super::CacheArgs;
use super::output::say;
use super::pipeline::{CACHE, Workplace};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Engine, Graph, Plan};
use clap::Args;
use std::path::{Path, absolute};

/// What `dag --help` ends with.
pub(super) const EXAMPLES: &str = "\
A workflow is to be run in the folder of the project. `signorini run` then finds \
everything done, and writes figures/ and report/.\n\
Examples:\n  \
  signorini dag --dot | dot -Tsvg > dag.svg\n  \
  signorini dag --make > tasks.mk && make -j 8 -f tasks.mk\n  \
  signorini dag --snakemake > Snakefile && snakemake --cores 8";

#[derive(Args)]
pub(super) struct DagArgs {
    #[command(flatten)]
    form: Form,
    #[command(flatten)]
    cache: CacheArgs,
}

/// For whom the graph is.
#[derive(Args)]
#[group(multiple = false)]
struct Form {
    /// For Mermaid, which draws it in Markdown
    #[arg(long)]
    mermaid: bool,
    /// For Graphviz
    #[arg(long)]
    dot: bool,
    /// As a makefile that runs one task per rule, for `make -j`
    #[arg(long)]
    make: bool,
    /// As a Snakefile that runs one task per job, on this machine or a cluster
    #[arg(long)]
    snakemake: bool,
    /// As JSON: each task, what it needs, and the file that says that it is done
    #[arg(long)]
    json: bool,
}

pub(super) fn dag(args: &DagArgs) -> Result<u8> {
    let workplace = Workplace::open(&args.cache)?;
    let plan = workplace.tasks(&[], None)?;
    let place = (&*workplace.project.root, &args.cache);
    let graph = || Graph::of(plan.tasks());
    let form = &args.form;
    say(&match () {
        () if form.mermaid => graph().mermaid(),
        () if form.dot => graph().dot(),
        () if form.make => workflow(&plan, place, |engine| engine.make())?,
        () if form.snakemake => workflow(&plan, place, |engine| engine.snakemake())?,
        () if form.json => workflow(&plan, place, |engine| Ok(engine.json()))?,
        () => list(&plan),
    })
}

/// A line for each task, with what it needs.
fn list(plan: &Plan) -> String {
    let line = |needs: &[String]| match needs {
        [] => String::new(),
        needs => format!(" <- {}", needs.join(", ")),
    };
    plan.tasks().iter().map(|task| format!("{}{}\n", task.id, line(&task.needs))).collect()
}

/// The plan for an engine, with a cache given by its name from everywhere, or in the project with this root.
fn workflow(
    plan: &Plan,
    (root, cache): (&Path, &CacheArgs),
    text: fn(&Engine) -> Result<String>,
) -> Result<String> {
    let wrong =
        |e| Error::input(format!("the folder of the program or of the cache is gone ({e})"));
    let program = std::env::current_exe().map_err(wrong)?;
    let elsewhere = cache.cache_dir.as_deref().map(absolute).transpose().map_err(wrong)?;
    let elsewhere = elsewhere.filter(|folder| *folder != root.join(CACHE));
    text(&Engine::new(plan, &program, elsewhere.as_deref().unwrap_or(Path::new(CACHE)))?)
}
