//! `certificate`: a CODECHECK bundle, a page on it and an RO-Crate of the run, for a reviewer to attach to a review.

mod checkout;
mod contents;
mod machine;

use super::diff::comparisons;
use super::output::{OutputFile, is_there, say, talk};
use super::pipeline::{Scope, Workplace, outside_report};
use super::{CacheArgs, current_folder};
use crate::pipeline::error::{Error, IoContext, Result};
use crate::pipeline::{LockFile, Summary, hash};
use crate::replication::comparison::TableComparison;
use crate::replication::stages::report;
use crate::timing::machine::COMPILER;
use checkout::Checkout;
use clap::Args;
use contents::{File, differing, files, inputs, reservations, sentences};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use tera::{Context, Kwargs, State, Tera};

const AUTHOR: &str = "N. N. Maksimova (Н. Н. Максимова)";
const TITLE: &str = "The study semicoercive Signorini problem by Arrow-Hurwicz method \
    (Исследование полукоэрцитивной задачи Синьорини методом Эрроу – Гурвица)";
const DEVELOPERS: &str = "The signorini developers";
const REFERENCE: &str = "UDC 519.853.2 + 519.632; no DOI is printed in the paper";

/// Commands that make the files of the bundle, each with its effect in words.
const COMMANDS: [(&str, &str); 4] = [
    (
        "cargo run --release -- run --locked",
        "fails if one hash differs from those in pipeline/lock.toml",
    ),
    ("cargo run --release -- diff", "shows both tables cell by cell"),
    ("cargo run --release -- certificate", "writes these files"),
    ("cargo test --release", "tests the program"),
];

/// Name of a codechecker who gives none.
const NOBODY: &str = "(name of the codechecker)";

#[derive(Args)]
pub(super) struct CertificateArgs {
    /// Folder for the bundle, which must exist [default: codecheck in the project]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Who checked
    #[arg(long, value_name = "NAME", default_value = NOBODY)]
    name: String,
    /// Their ORCID, such as 0000-0002-1825-0097
    #[arg(long, value_name = "ID")]
    orcid: Option<String>,
    /// Where the code is published
    #[arg(long, value_name = "URL", default_value = "not published yet")]
    repository: String,
    /// Overwrite a codecheck.yml that is there already
    #[arg(short, long)]
    force: bool,
    #[command(flatten)]
    cache: CacheArgs,
}

pub(super) fn certificate(args: &CertificateArgs) -> Result<u8> {
    args.orcid.as_deref().map_or(Ok(()), check_orcid)?;
    let workplace = Workplace::open(&args.cache)?;
    let folder = match &args.output {
        Some(folder) => is_there(folder).map(|()| folder.clone())?,
        None => workplace.project.root.join("codecheck"),
    };
    outside_report(&workplace.project.root, &folder, "the certificate")?;
    if !args.force && folder.join(MANIFEST).exists() {
        return Err(Error::input(format!(
            "{} is there already; move it away, or overwrite it with --force",
            folder.join(MANIFEST).display()
        )));
    }
    let summary = up_to_date(&workplace)?;
    let tables = comparisons(&workplace, &summary.manifests)?;
    let mut files = files(&workplace, &summary, &tables)?;
    let count = files.len();
    let mut context = context(args, &workplace, &summary, &tables, &files)?;
    let project = &workplace.project;
    let paths: Vec<&str> = project.files.keys().map(String::as_str).collect();
    let checkout = Checkout::of(&project.root, &paths, LOCK_FILE);
    let inputs = inputs(project)?;
    context.insert("input_files", &inputs);
    files.extend(inputs);
    context.insert("checkout", &checkout.as_ref().ok());
    context.insert("no_checkout", &checkout.as_ref().err());
    let page = render(include_str!("certificate/certificate.md.tera"), &context);
    files.push(File::new(PAGE, "what matched and how exactly, on one page", page.into_bytes()));
    context.insert("page", &files.last());
    context.insert("parts", &files);
    let record = render(include_str!("certificate/ro_crate.json.tera"), &context);
    files.push(File::new(RECORD, "", record.into_bytes()));
    context.insert("record", &files.last());
    let manifest = render(include_str!("certificate/codecheck.yml.tera"), &context);
    files.push(File::new(MANIFEST, "", manifest.into_bytes()));
    write(&folder, &files)?;
    let here = current_folder()?;
    let shown = folder.strip_prefix(&here).unwrap_or(&folder);
    let written = [PAGE, MANIFEST, RECORD].map(|name| format!("{}\n", shown.join(name).display()));
    say(&written.concat())?;
    talk(&format!("{count} files with their hashes"));
    for table in &tables {
        talk(&format!(
            "Table {}: {} of {} counts exact, {} of {} Delta a to the printed digits",
            table.table,
            table.exact,
            table.cells,
            table.delta_a_exact,
            table.rows.len()
        ));
    }
    if let Err(why) = &checkout {
        talk(&format!("warning: the certificate names no commit: {why}"));
    }
    Ok(0)
}

/// Refuses a text that is no ORCID.
fn check_orcid(id: &str) -> Result<()> {
    let groups: Vec<usize> = id.split('-').map(str::len).collect();
    if groups == [4; 4] && orcid_sum(&id.replace('-', "")) == Some(1) {
        return Ok(());
    }
    Err(Error::input(format!(
        "--orcid {id}: no ORCID, or mistyped, for its check digit is another; write it as 0000-0002-1825-0097"
    )))
}

/// Returns the check sum of an ORCID by ISO 7064 MOD 11-2, which is 1 for a valid one: sum of the digits, each times two
/// to the number of digits after it, modulo 11. The last digit may be X for ten; `None` if another is no digit.
fn orcid_sum(digits: &str) -> Option<u32> {
    let mut sum = 0;
    for (place, digit) in digits.chars().enumerate() {
        let value = if (place, digit) == (15, 'X') { 10 } else { digit.to_digit(10)? };
        sum = (2 * sum + value) % 11;
    }
    Some(sum)
}

/// Writes all files of the bundle, or none if a file that a certificate has not written would be overwritten.
fn write(folder: &Path, files: &[File]) -> Result<()> {
    let before = fs::read_to_string(folder.join(MANIFEST)).unwrap_or_default();
    let mut checked = Vec::new();
    for file in files {
        let path = folder.join(&file.path);
        match fs::read(&path) {
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            Ok(found)
                if found == file.bytes
                    || file.path == MANIFEST
                    || before.contains(&hash(&found)) => {}
            _ => {
                return Err(Error::input(format!(
                    "{} is there already and not as a certificate wrote it; move it away, or name another folder with --output",
                    path.display()
                )));
            }
        }
        let parent = path.parent().expect("a file lies in a folder");
        fs::create_dir_all(parent).context("create", parent)?;
        checked.push(OutputFile::check(&path)?);
    }
    for (checked, file) in checked.iter().zip(files) {
        checked.write(&file.bytes)?;
    }
    Ok(())
}

/// Path of the lock file in the project, in the form that git takes.
const LOCK_FILE: &str = "pipeline/lock.toml";

const MANIFEST: &str = "codecheck.yml";
const PAGE: &str = "certificate.md";
const RECORD: &str = "ro-crate-metadata.json";

/// Returns the verdicts on the whole project, if there is nothing to do and the lock file has these results.
fn up_to_date(workplace: &Workplace) -> Result<Summary> {
    let summary = workplace.judge(&workplace.tasks(&[], None)?, Scope::Whole, false)?;
    let refused = if let Some(first) = summary.not_fresh().next() {
        let of = summary.verdicts.len();
        format!(
            "{} of {of} tasks are not up to date ({} {})",
            summary.not_fresh().count(),
            first.task,
            first.verdict
        )
    } else if let Some(edited) = summary.exports.edited.first() {
        return Err(Error::input(super::pipeline::edited(edited)));
    } else if !summary.nothing_to_do() {
        "files in figures/ or report/ are missing or old".into()
    } else {
        let differences =
            LockFile::read(&workplace.project.root)?.differences(&summary.lock_file());
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

/// Returns the data of the templates, but what is known of their files only after they are made.
fn context(
    args: &CertificateArgs,
    workplace: &Workplace,
    summary: &Summary,
    tables: &[TableComparison],
    files: &[File],
) -> Result<Context> {
    let project = &workplace.project;
    let mut inputs = Vec::new();
    for (path, file) in &project.files {
        inputs.push((path, file.hash()?));
    }
    let span = workplace.store.span(summary.manifests.keys())?;
    let lock = LockFile::path(&project.root);
    let lock_file = summary.lock_file();
    let context = Context::from_serialize(&serde_json::json!({
        "author": AUTHOR,
        "developers": DEVELOPERS,
        "title": TITLE,
        "reference": REFERENCE,
        "version": env!("CARGO_PKG_VERSION"),
        "compiler": COMPILER,
        "program": env!("SIGNORINI_PROGRAM"),
        "commands": COMMANDS,
        "codechecker": args.name,
        "is_named": args.name != NOBODY,
        "orcid": args.orcid,
        "repository": args.repository,
        "is_published": args.repository.starts_with("http"),
        "time": machine::check_time()?,
        "start": machine::utc(span.start),
        "end": machine::utc(span.end),
        "machine": machine::description(),
        "libraries": report::versions(),
        "summary": sentences(tables),
        "tables": tables,
        "differing": tables.iter().flat_map(differing).collect::<Vec<_>>(),
        "reservations": reservations(project),
        "name": format!("Replication of {AUTHOR}, {TITLE}"),
        "description": format!("{} {}", sentences(tables), reservations(project).join(" ")),
        "place": place(),
        "build": format!("Built by {COMPILER} from sources with blake3 {}", env!("SIGNORINI_PROGRAM")),
        "files": files,
        "inputs": inputs,
        "tasks": summary.verdicts.len(),
        "hashes": lock_file.tasks.len() + lock_file.exports.len(),
        "lock_hash": hash(&fs::read(&lock).context("read", &lock)?),
    }));
    Ok(context.expect("plain data"))
}

/// Returns the machine in one line.
fn place() -> String {
    let mut parts = Vec::new();
    for (name, value) in machine::description() {
        parts.push(format!("{name}: {value}"));
    }
    parts.join("; ")
}

fn render(template: &str, context: &Context) -> String {
    let mut tera = Tera::new();
    tera.register_filter("json", |text: String, _: Kwargs, _: &State| {
        serde_json::json!(text).to_string()
    });
    tera.register_filter("cell", |text: String, _: Kwargs, _: &State| {
        text.replace('|', "\\|").replace('\n', " ")
    });
    tera.render_str(template, context, false).expect("the template is tested")
}
