//! Templates and data become Markdown.

use super::filters;
use std::collections::BTreeMap;
use tera::{Context, ErrorKind, Tera};

/// Ending of the templates that become a page each; the others hold components.
const PAGE: &str = ".md.tera";

/// Renders every `*.md.tera` among `templates` and copies every `*.md` and `*.js`.
///
/// Keys of `templates` are paths below `report/templates`; those of the result are paths below
/// `report`, in the book's source folder, as [`super::build`] takes them.
///
/// # Errors
/// A sentence with file and line of what does not parse, or asks for something the data do not have.
pub fn pages(
    templates: &BTreeMap<String, String>,
    context: &Context,
) -> Result<BTreeMap<String, String>, String> {
    let mut tera = Tera::new();
    filters::register(&mut tera);
    tera.add_raw_templates(templates.iter().filter(|(name, _)| name.ends_with(".tera")))
        .map_err(|error| located("", &error))?;
    made(templates, |name, _| tera.render(name, context).map_err(|error| located(name, &error)))
}

/// The same pages in a project without what the chapters tell about: each says why it was left out.
pub(crate) fn stubs(
    templates: &BTreeMap<String, String>,
    reason: &str,
) -> BTreeMap<String, String> {
    let stub = |_: &str, text: &str| {
        let title = text.lines().find(|line| line.starts_with("# ")).unwrap_or("#");
        Ok(format!("{title}\n\nLeft out, as are all chapters on the paper: {reason}.\n"))
    };
    made(templates, stub).unwrap_or_default()
}

/// The pages among `templates`, those that end with [`PAGE`] made from their name and text.
fn made(
    templates: &BTreeMap<String, String>,
    make: impl Fn(&str, &str) -> Result<String, String>,
) -> Result<BTreeMap<String, String>, String> {
    let mut pages = BTreeMap::new();
    for (name, text) in templates {
        if name.ends_with(".md") || name.ends_with(".js") {
            pages.insert(format!("src/{name}"), text.clone());
        } else if let Some(stem) = name.strip_suffix(PAGE) {
            pages.insert(format!("src/{stem}.md"), make(name, text)?);
        }
    }
    Ok(pages)
}

/// The error with its place; in a component, with the page that called it as well.
fn located(page: &str, error: &tera::Error) -> String {
    let (file, line, message) = match error.kind() {
        ErrorKind::SyntaxError(at) | ErrorKind::RenderingError(at) => {
            (at.filename(), at.span().start_line, at.message().to_owned())
        }
        other => (page, 0, other.to_string()),
    };
    let caller =
        if page.is_empty() || page == file { String::new() } else { format!(" (for {page})") };
    format!("report/templates/{file}:{line}: {message}{caller}")
}
