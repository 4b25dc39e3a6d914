//! `certificate`: a record of the run for a reviewer to attach to a review: a page on it, an RO-Crate, and a CODECHECK
//! manifest if the run has a table of the paper.

use super::diff::{comparisons, in_markdown_with_total, total};
use super::output::{is_there, paragraph, refuse_tilde, say, talk};
use super::pipeline::{Scope, Workplace, edited};
use super::{CacheArgs, current_folder};
use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::files::{folder_of, temporary_folder};
use crate::pipeline::names::refuse_forbidden;
use crate::pipeline::place::{TAKEN, place};
use crate::pipeline::{InputFiles, LockFile, Plan, Summary, hash};
use crate::replication::comparison::TableComparison;
use crate::replication::project::{IDENTIFIED, Project};
use crate::replication::stages::{files_of, tabulate};
use crate::table::{code_in_markdown, in_markdown};
use crate::timing::machine::{self, COMPILER};
use chrono::DateTime;
use clap::Args;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde::Serialize;
use signorini_mathematics::saddle::StopRule;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use tera::{Context, Kwargs, State, Tera};

const AUTHOR: &str = "N. N. Maksimova (Н. Н. Максимова)";
const TITLE: &str = "The study semicoercive Signorini problem by Arrow-Hurwicz method \
    (Исследование полукоэрцитивной задачи Синьорини методом Эрроу – Гурвица)";
const REFERENCE: &str = "UDC 519.853.2 + 519.632; no DOI is printed in the paper";

const PAGE: &str = "certificate.md";
const RECORD: &str = "ro-crate-metadata.json";
const MANIFEST: &str = "codecheck.yml";

#[derive(Args)]
pub(super) struct CertificateArgs {
    /// New or empty folder for the bundle [default: codecheck in the project]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Who checked
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn certificate(args: &CertificateArgs) -> Result<u8> {
    if let Some(name) = &args.name {
        refuse_forbidden("--name", name.trim())?;
    }
    let workplace = Workplace::open(&args.cache)?;
    let folder = args.output.clone().unwrap_or(workplace.project.root.join("codecheck"));
    place(&workplace.project.root, &folder, "the certificate", &TAKEN)?;
    refuse_taken(&folder)?;
    let plan = workplace.tasks(&[], None)?;
    let summary = up_to_date(&workplace, &plan)?;
    let tables = comparisons(&workplace, &summary.manifests)?;
    let results = results(&workplace, &summary, &tables)?;
    let count = results.len();
    let inputs = inputs(&workplace.project, &files_of(&workplace.project, plan.tasks()))?;
    let mut context = context(&workplace, &summary, &tables)?;
    if let Some(name) = &args.name {
        context.insert("reviewer", name.trim());
    }
    let bundle = bundle(results, inputs, context);
    write(&bundle, &folder)?;
    let here = current_folder()?;
    let shown = folder.strip_prefix(&here).unwrap_or(&folder);
    let named = bundle.iter().filter(|file| [PAGE, RECORD, MANIFEST].contains(&&*file.path));
    let lines: Vec<_> = named.map(|file| shown.join(&file.path).display().to_string()).collect();
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

/// A file of the bundle, with its description.
#[derive(Clone, Serialize)]
struct File {
    path: String,
    /// Path as an address of an RO-Crate.
    address: String,
    comment: String,
    /// As IANA registers it.
    media_type: &'static str,
    /// Number of bytes.
    size: usize,
    /// Hash in the cache, the lock file and the records: blake3.
    hash: String,
    #[serde(skip)]
    bytes: Vec<u8>,
}

impl File {
    fn new(path: impl Into<String>, comment: impl Into<String>, bytes: Vec<u8>) -> Self {
        let path = path.into();
        Self {
            address: address(&path),
            comment: comment.into(),
            media_type: match path.rsplit('.').next() {
                Some("css") => "text/css",
                Some("csv") => "text/csv",
                Some("js") => "text/javascript",
                Some("md") => "text/markdown",
                Some("msh") => MESH,
                Some("svg") => "image/svg+xml",
                Some("tera") => "text/plain",
                Some("toml") => "application/toml",
                _ => "application/octet-stream",
            },
            size: bytes.len(),
            hash: hash(&bytes),
            path,
            bytes,
        }
    }
}

/// Returns the address of a file in the bundle. RO-Crate prefers letters beyond ASCII as they are; other characters
/// there may be some that no address has.
fn address(path: &str) -> String {
    const SIGNS: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'/');
    let mut address = String::new();
    for c in path.chars() {
        match c.is_alphanumeric() {
            true => address.push(c),
            false => address.extend(utf8_percent_encode(c.encode_utf8(&mut [0; 4]), SIGNS)),
        }
    }
    address
}

/// Media type of meshes.
const MESH: &str = "model/mesh";

/// Returns the files that the run `read`, with the bytes that it read, in a folder that is a project of its own.
fn inputs(project: &Project, read: &InputFiles) -> Result<Vec<File>> {
    let mut files = Vec::new();
    for (path, file) in read {
        let bytes = file.bytes()?.to_vec();
        let mut file = File::new(format!("inputs/{path}"), "an input of the run", bytes);
        if project.scenes.iter().any(|scene| scene.files.contains_key(path)) {
            (file.comment, file.media_type) = ("a mesh".into(), MESH);
        }
        files.push(file);
    }
    Ok(files)
}

/// Returns all tables, and all figures with their data.
fn results(
    workplace: &Workplace,
    summary: &Summary,
    tables: &[TableComparison],
) -> Result<Vec<File>> {
    let mut files = Vec::new();
    for scene in &workplace.project.scenes {
        let task = tabulate::id(scene);
        let Some(manifest) = summary.manifests.get(&task) else { continue };
        let name = tabulate::file(scene);
        let mut artifacts = workplace.store.artifacts(&task, &manifest.outputs)?;
        let Some(bytes) = artifacts.remove(&name) else { continue };
        let compared = tables.iter().find(|table| table.scene == scene.name);
        if let (Some(table), Some(rule)) = (compared, scene.first_rule()) {
            let TableComparison { table, exact, cells, .. } = table;
            let under = tabulate::under(&String::from_utf8_lossy(&bytes), rule);
            let comment = format!("Table {table} of the paper: {exact} of {cells} counts exact");
            files.push(File::new(format!("tables/table{table}.csv"), comment, under.into_bytes()));
        }
        let comment = format!("the numbers of {}", scene.title);
        files.push(File::new(format!("tables/{name}"), comment, bytes));
    }
    for path in summary.exports.files.keys().filter(|path| path.starts_with("figures/")) {
        let on_disk = workplace.project.root.join(path);
        let bytes = fs::read(&on_disk).context("read", &on_disk)?;
        let comment = match path.strip_suffix(".csv") {
            Some(picture) => format!("what {picture}.svg shows, as a table"),
            None => "a picture, whose title says what it shows".into(),
        };
        files.push(File::new(path, comment, bytes));
    }
    Ok(files)
}

/// Returns the data of the templates, but for the files and what is known of the user.
fn context(
    workplace: &Workplace,
    summary: &Summary,
    tables: &[TableComparison],
) -> Result<Context> {
    let project = &workplace.project;
    let scenes: Vec<_> = project.scenes.iter().map(|scene| scene.name.as_str()).collect();
    let is_signed =
        project.scenes.iter().filter(|scene| scene.paper_table.is_some()).any(|scene| {
            matches!(scene.first_rule(), Some(StopRule::Signed | StopRule::SignedDual))
        });
    let lock = LockFile::path(&project.root);
    let system = machine::field("/etc/os-release", "PRETTY_NAME=");
    let mut context = Context::from_serialize(&serde_json::json!({
        "author": AUTHOR,
        "title": TITLE,
        "reference": REFERENCE,
        "version": env!("CARGO_PKG_VERSION"),
        "compiler": COMPILER,
        "program": env!("SIGNORINI_PROGRAM"),
        "time": check_time()?,
        "processor": machine::processor(),
        "system": format!("{} {}", system.unwrap_or_default(), machine::kernel()).trim(),
        "is_compared": !tables.is_empty(),
        "tables": in_markdown_with_total(project, tables),
        "total": total(tables),
        "scenes": scenes.join(", "),
        "is_identified": project.files.contains_key(IDENTIFIED),
        "is_signed": is_signed,
        "tasks": summary.verdicts.len(),
        "hashes": summary.lock_file.tasks.len() + summary.lock_file.exports.len(),
        "lock_hash": hash(&fs::read(&lock).context("read", &lock)?),
    }))
    .expect("plain data");
    for (name, template) in [
        ("summary", include_str!("certificate/summary.tera")),
        ("reservations", include_str!("certificate/reservations.tera")),
    ] {
        let text = render(template, &context);
        context.insert(name, text.trim());
    }
    Ok(context)
}

/// Returns the time in UTC, or that in `SOURCE_DATE_EPOCH`, in the form `2026-11-21 07:20:05`.
fn check_time() -> Result<String> {
    let moment = match std::env::var("SOURCE_DATE_EPOCH") {
        Ok(text) => {
            text.parse().ok().and_then(|seconds| DateTime::from_timestamp(seconds, 0)).ok_or_else(
                || {
                    let remedy = "give seconds since 1970, or unset it";
                    Error::input(format!("SOURCE_DATE_EPOCH={text}: {remedy}"))
                },
            )?
        }
        Err(_) => SystemTime::now().into(),
    };
    Ok(moment.format("%Y-%m-%d %H:%M:%S").to_string())
}

/// Returns all files of the bundle: the results, the inputs, the page, the record, and the manifest if there is a
/// published table, without which nobody checks the code of a paper.
fn bundle(results: Vec<File>, inputs: Vec<File>, mut context: Context) -> Vec<File> {
    context.insert("files", &results);
    context.insert("input_files", &inputs);
    let mut bundle = [results, inputs].concat();
    for (name, path, template) in [
        ("page", PAGE, include_str!("certificate/certificate.md.tera")),
        ("record", RECORD, include_str!("certificate/ro_crate.json.tera")),
        ("manifest", MANIFEST, include_str!("certificate/codecheck.yml.tera")),
    ] {
        let text = render(template, &context);
        if !text.is_empty() {
            let comment = "what the run made, and how, on one page";
            bundle.push(File::new(path, comment, text.into_bytes()));
            context.insert(name, &bundle.last());
            context.insert("parts", &bundle);
        }
    }
    bundle
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
