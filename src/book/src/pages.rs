//! Pages in Markdown, made from templates and data.

use super::data::{as_shown, of_tables};
use super::{filters, rows};
use rayon::prelude::*;
use std::collections::BTreeMap;
use tera::{Context, ErrorKind, Tera};

/// Ending of the templates of which each becomes a page; other templates hold components.
pub const PAGE: &str = ".md.tera";

/// Renders every `*.md.tera` among `templates`, copies every `*.md` and `*.js`, and adds the data to which pages link.
///
/// Keys of `templates` are paths below `report/templates`; keys of the result are paths below
/// `report`, in the book's source folder, in the form that [`super::build`] takes.
///
/// # Errors
/// A sentence with file and line of text that does not parse, or that asks for data that do not exist.
pub fn pages(
    templates: &BTreeMap<String, String>,
    context: &Context,
) -> Result<BTreeMap<String, String>, String> {
    let mut tera = Tera::new();
    filters::register(&mut tera);
    rows::register(&mut tera);
    tera.add_raw_templates(templates.iter().filter(|(name, _)| name.ends_with(".tera")))
        .map_err(|error| located("", &error))?;
    let mut pages = made(templates, |name, _| {
        tera.render(name, context).map_err(|error| located(name, &error))
    })?;
    let mut data = BTreeMap::new();
    for page in pages.values_mut() {
        data.extend(of_tables(page));
        *page = as_shown(page);
    }
    for (name, text) in data {
        pages.insert(format!("src/data/{name}"), text);
    }
    Ok(pages)
}

/// Returns the pages of a project without the data that templates need; each gives the `reason` why it was left out.
///
/// # Errors
/// A sentence if two templates make one page.
pub fn stubs(
    templates: &BTreeMap<String, String>,
    reason: &str,
) -> Result<BTreeMap<String, String>, String> {
    made(templates, |_, text| {
        let title = text.lines().find(|line| line.starts_with("# ")).unwrap_or("#");
        Ok(format!(
            "{title}\n\nLeft out, as are all pages from `*{PAGE}`: {reason}. A page without results in its text is a \
             `*.md`.\n"
        ))
    })
}

/// Returns a mistake in a page with its place in the template: the line, if the template has an equal one.
pub fn in_template(
    mistake: String,
    pages: &BTreeMap<String, String>,
    templates: &BTreeMap<String, String>,
) -> String {
    if let Some(found) = found_in_template(&mistake, pages, templates) {
        return found;
    }
    match mistake.strip_prefix("src/") {
        // A file that a page includes is the copy of a file among the templates.
        Some(file) => format!("report/templates/{file}"),
        None => mistake,
    }
}

fn found_in_template(
    mistake: &str,
    pages: &BTreeMap<String, String>,
    templates: &BTreeMap<String, String>,
) -> Option<String> {
    let (stem, rest) = mistake.strip_prefix("src/")?.split_once(".md:")?;
    let (number, what) = rest.split_once(": ")?;
    let mut lines = pages.get(&format!("src/{stem}.md"))?.lines();
    let wrong = lines.nth(number.parse::<usize>().ok()?.checked_sub(1)?)?;
    let mut sources = [PAGE, ".md"].into_iter();
    let (name, text) =
        sources.find_map(|ending| templates.get_key_value(&format!("{stem}{ending}")))?;
    let line = text.lines().position(|line| line == wrong);
    let line = line.map_or(String::new(), |line| format!(":{}", line + 1));
    Some(format!("report/templates/{name}{line}: {what}"))
}

/// Returns the pages of `templates`; `make` makes those of templates that end with [`PAGE`], from name and text, side
/// by side.
fn made(
    templates: &BTreeMap<String, String>,
    make: impl Fn(&str, &str) -> Result<String, String> + Sync,
) -> Result<BTreeMap<String, String>, String> {
    let page = |(name, text): (&String, &String)| {
        if name.ends_with(".md") || name.ends_with(".js") {
            return Some((name.clone(), format!("src/{name}"), Ok(text.clone())));
        }
        let stem = name.strip_suffix(PAGE)?;
        Some((name.clone(), format!("src/{stem}.md"), make(name, text)))
    };
    let made: Vec<_> = templates.par_iter().filter_map(page).collect();
    let mut pages = BTreeMap::new();
    for (name, page, text) in made {
        if pages.insert(page, text?).is_some() {
            let same = name.trim_end_matches(".tera");
            return Err(format!(
                "report/templates/{name}: {same} makes the same page; remove one of them"
            ));
        }
    }
    Ok(pages)
}

/// Returns the error with its place; in a component, also with the page that called it.
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
