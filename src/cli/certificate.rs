//! `certificate`: a record of the run for a reviewer to attach to a review: a page on it, an RO-Crate, and a CODECHECK
//! manifest if the run has a table of the paper.

mod contents;
mod machine;

use super::diff::{comparisons, in_markdown_with_total, total};
use super::output::{is_there, paragraph, refuse_tilde, say, talk};
use super::pipeline::{Scope, Workplace, edited};
use super::{CacheArgs, current_folder};
use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::{folder_of, temporary_folder};
use crate::pipeline::names::refuse_forbidden;
use crate::pipeline::place::{TAKEN, place};
use crate::pipeline::{LockFile, Plan, Summary, hash};
use crate::replication::comparison::TableComparison;
use crate::replication::project::Project;
use crate::replication::stages::files_of;
use crate::table::{code_in_markdown, in_markdown};
use crate::timing::machine::COMPILER;
use clap::Args;
use contents::{File, files, inputs, reservations};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use tera::{Context, Kwargs, State, Tera};

const AUTHOR: &str = "N. N. Maksimova (Н. Н. Максимова)";
const TITLE: &str = "The study semicoercive Signorini problem by Arrow-Hurwicz method \
    (Исследование полукоэрцитивной задачи Синьорини методом Эрроу – Гурвица)";
const DEVELOPERS: &str = "The signorini developers";
/// Name of a codechecker who gives none.
const NOBODY: &str = "(name of the codechecker)";
const REFERENCE: &str = "UDC 519.853.2 + 519.632; no DOI is printed in the paper";

/// Commands that make the files of the bundle, each with its effect in words and true if it needs a published table.
const COMMANDS: [(&str, &str, bool); 3] = [
    ("signorini run --locked", "fails if one hash differs from those in pipeline/lock.toml", false),
    ("signorini diff", "shows the tables cell by cell beside the published ones", true),
    ("signorini certificate", "writes these files", false),
];

#[derive(Args)]
pub(super) struct CertificateArgs {
    /// New or empty folder for the bundle [default: codecheck in the project]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Who checked
    #[arg(long, value_name = "NAME", default_value = NOBODY)]
    name: String,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn certificate(args: &CertificateArgs) -> Result<u8> {
    let name = args.name.trim();
    refuse_forbidden("--name", name)?;
    let workplace = Workplace::open(&args.cache)?;
    let folder = args.output.clone().unwrap_or(workplace.project.root.join("codecheck"));
    place(&workplace.project.root, &folder, "the certificate", &TAKEN)?;
    refuse_taken(&folder)?;
    let plan = workplace.tasks(&[], None)?;
    let summary = up_to_date(&workplace, &plan)?;
    let read = files_of(&workplace.project, plan.tasks());
    let tables = comparisons(&workplace, &summary.manifests)?;
    let files = files(&workplace, &summary, &tables)?;
    let mut context = context(&workplace, &summary, &tables, &files)?;
    context.insert("reviewer", name);
    context.insert("is_named", &(name != NOBODY));
    let count = files.len();
    let inputs = inputs(&workplace.project, &read)?;
    let bundle = bundle(files, inputs, context, !tables.is_empty());
    write(&bundle, &folder)?;
    let here = current_folder()?;
    let shown = folder.strip_prefix(&here).unwrap_or(&folder);
    let named = [PAGE, MANIFEST, RECORD].into_iter();
    let written = named.filter(|name| bundle.iter().any(|file| file.path == *name));
    let lines: Vec<String> = written.map(|name| shown.join(name).display().to_string()).collect();
    say(&(lines.join("\n") + "\n"))?;
    talk(&format!("{count} files with their hashes"));
    if !tables.is_empty() {
        talk(&paragraph(&total(&tables)));
    }
    Ok(0)
}

/// Refuses a folder in which there is something, and one to be made in a folder that does not exist.
fn refuse_taken(folder: &Path) -> Result<()> {
    refuse_tilde(folder)?;
    let is_empty = match fs::read_dir(folder) {
        Err(e) if e.kind() == ErrorKind::NotFound => return is_there(folder_of(folder)),
        entries => entries.is_ok_and(|entries| entries.count() == 0),
    };
    if is_empty {
        return Ok(());
    }
    Err(Error::input(format!(
        "{} is there already; move it away, or name a new folder with --output",
        folder.display()
    )))
}

/// Writes the files of a bundle to its folder, after an error none.
fn write(bundle: &[File], folder: &Path) -> Result<()> {
    let whole = temporary_folder(folder).context("write to", folder)?;
    for file in bundle {
        let path = whole.path().join(&file.path);
        fs::create_dir_all(folder_of(&path))
            .and_then(|()| fs::write(&path, &file.bytes))
            .context("write", &folder.join(&file.path))?;
    }
    for entry in fs::read_dir(whole.path()).context("read", whole.path())?.flatten() {
        let path = folder.join(entry.file_name());
        fs::rename(entry.path(), &path).context("write", &path)?;
    }
    Ok(())
}

/// Returns all files of the bundle: the results, the inputs, the page, the record, and the manifest if there is a
/// published table, without which nobody checks the code of a paper.
fn bundle(
    results: Vec<File>,
    inputs: Vec<File>,
    mut context: Context,
    is_compared: bool,
) -> Vec<File> {
    let mut files = results;
    context.insert("input_files", &inputs);
    files.extend(inputs);
    let page = render(include_str!("certificate/certificate.md.tera"), &context);
    files.push(File::new(PAGE, "what the run made, and how, on one page", page.into_bytes()));
    context.insert("page", &files.last());
    context.insert("parts", &files);
    let record = render(include_str!("certificate/ro_crate.json.tera"), &context);
    files.push(File::new(RECORD, "", record.into_bytes()));
    if is_compared {
        context.insert("record", &files.last());
        let manifest = render(include_str!("certificate/codecheck.yml.tera"), &context);
        files.push(File::new(MANIFEST, "", manifest.into_bytes()));
    }
    files
}

/// Returns a sentence with the scenes of a run of which no table is compared.
fn scenes(project: &Project) -> String {
    let names: Vec<_> = project.scenes.iter().map(|scene| scene.name.as_str()).collect();
    format!("Scenes: {}. No published table is compared.", names.join(", "))
}

const MANIFEST: &str = "codecheck.yml";
const PAGE: &str = "certificate.md";
const RECORD: &str = "ro-crate-metadata.json";

/// Returns the verdicts on the whole project, if there is nothing to do and the lock file has these results.
fn up_to_date(workplace: &Workplace, plan: &Plan) -> Result<Summary> {
    let summary = workplace.judge(plan, Scope::Whole, false)?;
    if summary.verdicts.is_empty() {
        return Err(Error::input(
            "no scene asks for outputs, so that there is no run to record; name some in `outputs`",
        ));
    }
    let refused = if let Some(first) = summary.not_fresh().next() {
        let of = summary.verdicts.len();
        format!(
            "{} of {of} tasks are not up to date ({} {})",
            summary.not_fresh().count(),
            first.task,
            first.verdict
        )
    } else if let Some(file) = summary.exports.edited.first() {
        return Err(Error::input(edited(file.by, &[&file.path])));
    } else if !summary.exports.is_empty() {
        "files in figures/ or report/ are missing or old".into()
    } else {
        let differences = LockFile::read(&workplace.project.root)?.differences(&summary.lock_file);
        match differences.first() {
            Some(first) => format!(
                "pipeline/lock.toml differs from this run in {} hashes ({first})",
                differences.len()
            ),
            None => return Ok(summary),
        }
    };
    Err(Error::input(format!(
        "{refused}; a certificate is for an up-to-date run: do `signorini run` first"
    )))
}

/// Returns the data of the templates, but for what is known of the user, and of files only after they are
/// made.
fn context(
    workplace: &Workplace,
    summary: &Summary,
    tables: &[TableComparison],
    files: &[File],
) -> Result<Context> {
    let project = &workplace.project;
    let is_compared = !tables.is_empty();
    let lock = LockFile::path(&project.root);
    let lock_file = &summary.lock_file;
    let reservations = if is_compared { reservations(project) } else { Vec::new() };
    let sentences = if is_compared { total(tables) + "." } else { scenes(project) };
    let name = match is_compared {
        true => format!("Replication of {AUTHOR}, {TITLE}"),
        false => "A run of signorini".into(),
    };
    let commands = COMMANDS.iter().filter(|(_, _, of_tables)| is_compared || !of_tables);
    let context = Context::from_serialize(&serde_json::json!({
        "author": AUTHOR,
        "developers": DEVELOPERS,
        "title": TITLE,
        "reference": REFERENCE,
        "version": env!("CARGO_PKG_VERSION"),
        "compiler": COMPILER,
        "program": env!("SIGNORINI_PROGRAM"),
        "commands": commands.collect::<Vec<_>>(),
        "time": machine::check_time()?,
        "machine": machine::description(),
        "tables": in_markdown_with_total(project, tables),
        "is_compared": is_compared,
        "name": name,
        "description": format!("{sentences} {}", reservations.join(" ")).trim_end(),
        "summary": sentences,
        "reservations": reservations,
        "build": format!("Built by {COMPILER} from sources with blake3 {}", env!("SIGNORINI_PROGRAM")),
        "files": files,
        "tasks": summary.verdicts.len(),
        "hashes": lock_file.tasks.len() + lock_file.exports.len(),
        "lock_hash": hash(&fs::read(&lock).context("read", &lock)?),
    }));
    Ok(context.expect("plain data"))
}

fn render(template: &str, context: &Context) -> String {
    let mut tera = Tera::new();
    tera.register_filter("json", |text: String, _: Kwargs, _: &State| {
        serde_json::json!(text).to_string()
    });
    tera.register_filter("text", |text: String, _: Kwargs, _: &State| in_markdown(&text));
    tera.register_filter("code", |text: String, _: Kwargs, _: &State| code_in_markdown(&text));
    tera.render_str(template, context, false).expect("the template is tested")
}
