//! `run`: brings everything up to date, and says what that took.

use super::diff::comparisons;
use super::output::{cut, say, talk, tell};
use super::pipeline::{Scope, Workplace, edited};
use super::report::first_page;
use super::shown::brief;
use super::{CacheArgs, name_parser};
use crate::pipeline::error::{Error, Result};
use crate::pipeline::{Options, Plan, Progress, Summary, why};
use crate::replication::comparison::{TableComparison, Tables};
use crate::replication::project::Project;
use crate::replication::scene::Scene;
use crate::replication::stages::tabulate::remarks;
use crate::replication::stages::{Stage, report, scene_of, solve};
use clap::{Args, ValueEnum};
use std::time::{Duration, Instant};

#[derive(Args, Clone, Debug)]
pub(super) struct RunArgs {
    /// Scenes to run [default: all, and the book]
    #[arg(value_name = "SCENE", value_parser = name_parser)]
    pub scenes: Vec<String>,
    /// Only this stage, and what it needs
    #[arg(long, value_name = "STAGE", hide_short_help = true)]
    only: Option<Stage>,
    /// Run only this task; what it needs must be up to date. Writes to the cache alone, beside other
    /// processes that do the same. May be given several times
    #[arg(long, value_name = "ID", value_parser = name_parser, hide_short_help = true, conflicts_with_all = [
        "scenes", "only", "dry_run", "force", "keep_going", "jobs", "locked",
    ])]
    task: Vec<String>,
    /// Say what would run, and why; change nothing
    #[arg(short = 'n', long)]
    dry_run: bool,
    /// Run everything again, and overwrite figures and pages edited by hand
    #[arg(short, long)]
    force: bool,
    /// After a failure, go on with what does not depend on it
    #[arg(short, long, hide_short_help = true)]
    keep_going: bool,
    /// Threads; 0 is one per core. Results do not depend on it
    #[arg(short, long, value_name = "N", default_value_t = 0)]
    jobs: usize,
    /// Fail if the results differ from pipeline/lock.toml, instead of updating it
    #[arg(long, hide_short_help = true, conflicts_with_all = ["scenes", "only", "dry_run"])]
    locked: bool,
    /// A line for every task that runs, with the reason
    #[arg(short, long)]
    verbose: bool,
    /// No progress
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

/// Brings the project up to date, and says what was done. Exit code 1 if the results differ from a lock file that is
/// to stay as it is.
pub(super) fn run(args: &RunArgs) -> Result<u8> {
    if !args.task.is_empty() {
        return single_tasks(args);
    }
    let mut workplace = Workplace::open_for(&args.cache, &args.scenes)?;
    let mut plan = args.plan(&workplace)?;
    let scope = args.scope();
    args.note_ignored(&workplace.project);
    if args.dry_run {
        let summary = workplace.rehearse(&mut plan, scope, args.options(), &args.progress())?;
        let verdicts = match summary.nothing_to_do() {
            true => {
                let tables = comparisons(&workplace, &summary.manifests)?;
                nothing_to_do(&workplace, &summary, &tables)
            }
            false => verdicts(&summary),
        };
        tell(&(left_out(&workplace.project, &plan) + &verdicts))?;
        return match summary.failed.is_empty() {
            true => Ok(0),
            false => Err(Error::Stage(summary.failed)),
        };
    }
    let start = Instant::now();
    let summary = workplace.run(&mut plan, scope, args.options(), &args.progress())?;
    let tables = comparisons(&workplace, &summary.manifests)?;
    args.talk_of_run(&workplace, &summary, &tables)?;
    if !args.quiet && !summary.ran.is_empty() {
        talk(&format!("took {}", brief(start.elapsed())));
    }
    if !summary.differences.is_empty() {
        let lines = summary.differences.join("\n  ");
        say(&format!("differs from pipeline/lock.toml:\n  {lines}\n"))?;
        return Ok(1);
    }
    if summary.nothing_to_do() {
        tell(&nothing_to_do(&workplace, &summary, &tables))?;
        // The process ends; freeing its memory first would be a noticeable part of so short a run.
        std::mem::forget((workplace, plan, summary));
        return Ok(0);
    }
    tell(
        &(left_out(&workplace.project, &plan)
            + &what_ran(&summary, !args.scenes.is_empty())
            + args.hint_of_results(&workplace.project, &summary)
            + &agreement(&workplace.project, &tables).map_or(String::new(), |line| line + "\n")
            + &book(&summary)),
    )?;
    Ok(0)
}

/// Runs single tasks beside other processes that do the same.
fn single_tasks(args: &RunArgs) -> Result<u8> {
    let summary = Workplace::work(&args.cache, &args.task, &args.progress())?;
    match summary.ran.is_empty() {
        true => say(&format!("{NOTHING_TO_DO}\n")),
        false => tell(&what_ran(&summary, false)),
    }
}

/// First words of a run that finds nothing to do.
const NOTHING_TO_DO: &str = "nothing to do: up to date";

/// Says that nothing is to be done, how the tables compare, and where the book is.
fn nothing_to_do(workplace: &Workplace, summary: &Summary, tables: &[TableComparison]) -> String {
    let agreement = agreement(&workplace.project, tables);
    let agreement = agreement.map_or(String::new(), |line| format!("; {line}"));
    format!("{NOTHING_TO_DO}{agreement}\n{}", book(summary))
}

/// Says how the tables compare with the published ones, if there are any.
fn agreement(project: &Project, tables: &[TableComparison]) -> Option<String> {
    if tables.is_empty() {
        return None;
    }
    let mut text = Tables(tables).to_string();
    if !tables.iter().all(TableComparison::all_counts_exact) {
        let within = if Tables(tables).hold() { "all within" } else { "some outside" };
        text += &format!(", {within} the tolerance; `signorini diff` shows each");
    }
    for number in project.paper.table.iter().map(|table| table.number) {
        if !project.scenes.iter().any(|scene| scene.paper_table == Some(number)) {
            text += &format!("; no scene has table {number}");
        }
    }
    Some(text)
}

/// Says where the book is, if the run is of the book too.
fn book(summary: &Summary) -> String {
    let page = first_page(summary.exports.files.keys());
    page.map_or(String::new(), |page| format!("the book: {page}\n"))
}

impl RunArgs {
    /// Plan of the tasks asked for.
    ///
    /// # Errors
    /// [`Error::Input`] if there are none.
    fn plan(&self, workplace: &Workplace) -> Result<Plan> {
        let plan = workplace.tasks(&self.scenes, self.only)?;
        if !plan.tasks().is_empty() {
            return Ok(plan);
        }
        let remedy = if self.scenes.is_empty() {
            "see `outputs` in the scenes, or drop --only"
        } else {
            "figures show all published problems together, and the book all scenes: name none, or see `outputs`"
        };
        Err(Error::input(format!("there is nothing of this kind to make; {remedy}")))
    }

    /// Part of the project that is run.
    fn scope(&self) -> Scope {
        match self.scenes.is_empty() && self.only.is_none() {
            true if self.locked => Scope::Locked,
            true => Scope::Whole,
            false => Scope::Part,
        }
    }

    fn options(&self) -> Options {
        let &Self { force, keep_going, jobs, .. } = self;
        Options { force, keep_going, jobs, ..Options::default() }
    }

    fn progress(&self) -> Progress {
        Progress::new(self.verbose, self.quiet)
    }

    /// Notes files that look like scenes and are none.
    fn note_ignored(&self, project: &Project) {
        if !self.quiet {
            project.ignored.iter().for_each(|file| talk(&format!("note: {file}")));
        }
    }

    /// Says which solves ended without a solution, and what is to be doubted of the others.
    fn talk_of_run(
        &self,
        workplace: &Workplace,
        summary: &Summary,
        tables: &[TableComparison],
    ) -> Result<()> {
        if !self.quiet {
            // That the discrete problems of a published table have no solution is a finding, in the book.
            let is_as_published = |scene: &Scene| {
                tables.iter().any(|table| table.scene == scene.name && table.all_counts_exact())
            };
            for scene in workplace.project.select(&self.scenes)? {
                if !is_as_published(scene) {
                    let lines = remarks(scene, |task| numbers_of(workplace, summary, task));
                    lines.iter().for_each(|line| talk(line));
                }
            }
        }
        Ok(())
    }

    /// Hint that a run of some scenes leaves the table of all results as it is.
    fn hint_of_results(&self, project: &Project, summary: &Summary) -> &'static str {
        let tabulated =
            summary.ran.iter().filter(|ran| Stage::of(&ran.task) == Some(Stage::Tabulate));
        let scenes = tabulated.filter_map(|ran| project.scene(scene_of(&ran.task)?).ok());
        // A study is not among all results.
        if !self.scenes.is_empty() && scenes.into_iter().any(|scene| !scene.is_study) {
            "a run that names no scene writes all counts to report/results.csv\n"
        } else {
            ""
        }
    }
}

/// Numbers of a task that solved something in this run.
fn numbers_of(workplace: &Workplace, summary: &Summary, task: &str) -> Option<Vec<u8>> {
    summary.ran.iter().find(|ran| ran.task == task)?;
    let outputs = &summary.manifests.get(task)?.outputs;
    workplace.store.artifacts(task, outputs).ok()?.remove(solve::NUMBERS)
}

/// A line that says what the book leaves out and why, if it is among the tasks and leaves anything out.
fn left_out(project: &Project, plan: &Plan) -> String {
    let in_plan = plan.task(report::ID).is_some();
    if !in_plan || !project.templates.keys().any(|name| name.ends_with(report::TEMPLATE)) {
        return String::new();
    }
    let reason = report::left_out(project);
    reason.map_or(String::new(), |reason| {
        format!("the book leaves out all pages from *{}: {reason}\n", report::TEMPLATE)
    })
}

/// Columns of the table of a run.
const WIDTH: usize = 80;

/// One line per stage that ran: number of tasks, time, reason; then the files that changed, by their names if these are
/// asked for and few.
fn what_ran(summary: &Summary, by_name: bool) -> String {
    let mut text = String::new();
    for stage in Stage::value_variants() {
        let is_of_stage = |task: &str| Stage::of(task) == Some(*stage);
        let ran: Vec<_> = summary.ran.iter().filter(|ran| is_of_stage(&ran.task)).collect();
        let all = summary.verdicts.iter().filter(|judged| is_of_stage(&judged.task)).count();
        if ran.is_empty() {
            continue;
        }
        let time: Duration = ran.iter().map(|ran| ran.time).sum();
        let reasons: Vec<_> = ran.iter().map(|ran| &ran.reason).collect();
        let (count, time) = (ran.len(), brief(time));
        let line = format!("{stage:<9} {count:>4} of {all:>4}  {time:>9}  {}", why(&reasons));
        // `--verbose` and `explain` give reasons in full.
        text += &(cut(&line, WIDTH) + "\n");
    }
    if !text.is_empty() {
        // Tasks run side by side: their times add up to more than the run took.
        let head = format!("{:<9} {:>12}  {:>9}  reason", "stage", "tasks run", "task time");
        text = format!("{head}\n{text}");
    }
    let written = summary.exports.to_write();
    match written.len() {
        0 => {}
        1..=MOST_NAMED if by_name => text += &format!("wrote {}\n", named(written.keys())),
        1 => text += "1 file written to figures/ and report/\n",
        count => text += &format!("{count} files written to figures/ and report/\n"),
    }
    if let Some(files) = to_remove(summary) {
        text += &format!("removed {files}\n");
    }
    if summary.ran.is_empty() {
        text +=
            if summary.lock_file_changed { "pipeline/lock.toml brought up to date\n" } else { "" };
        text += if text.is_empty() && summary.reverted { OLDER } else { "" };
    }
    text
}

/// Most files that are named.
const MOST_NAMED: usize = 12;

/// Names files; of those that differ in their ending alone, the name once.
fn named<'a>(paths: impl Iterator<Item = &'a String>) -> String {
    let (mut text, mut last) = (String::new(), "");
    for path in paths {
        let at = path.rfind('.').unwrap_or(path.len());
        let shown = if path[..at] == *last { &path[at..] } else { path };
        text += &format!("{}{shown}", if text.is_empty() { "" } else { ", " });
        last = &path[..at];
    }
    text
}

/// Says what a run would do.
fn verdicts(summary: &Summary) -> String {
    let mut text = String::new();
    for judged in summary.not_fresh() {
        text += &format!("{}: {}\n", judged.task, judged.verdict);
    }
    text + &exports(summary)
}

/// The files that belong to nothing any more, if there are any: those that may be committed by their names.
fn to_remove(summary: &Summary) -> Option<String> {
    let (mut files, others): (Vec<_>, Vec<_>) =
        summary.exports.to_remove().iter().partition(|path| path.starts_with("figures/"));
    let others = match others.len() {
        0 => None,
        1 => Some("1 file of report/".into()),
        count => Some(format!("{count} files of report/")),
    };
    files.extend(&others);
    (!files.is_empty())
        .then(|| files.iter().map(|file| file.as_str()).collect::<Vec<_>>().join(", "))
}

/// Line on a run that needs only be noted.
const OLDER: &str = "an older result is in use again\n";

/// Says what a run would change besides running tasks.
pub(super) fn exports(summary: &Summary) -> String {
    let mut text = String::new();
    if summary.reverted {
        text += OLDER;
    }
    if summary.lock_file_changed {
        text += "pipeline/lock.toml is missing or old\n";
    }
    if !summary.exports.to_write().is_empty() {
        text += "files in figures/ or report/ are missing or old\n";
    }
    if let Some(files) = to_remove(summary) {
        text += &format!("to be removed: {files}\n");
    }
    for file in &summary.exports.edited {
        text += &(edited(file.by, &[&file.path]) + "\n");
    }
    text
}
