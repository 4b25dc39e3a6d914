//! The book of this project, built by a run from the committed templates, and then inspected.

use crate::common::{files_below, skip};
use crate::explore::book;
use polars::prelude::{CsvReadOptions, CsvReader, SerReader};
use signorini_book::pages;
use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;
use std::path::Path;
use std::process::Command;
use tera::Context;

#[test]
fn the_book_opens_from_a_folder_without_any_request() {
    let book = files();
    let html = html(&book);
    assert!(html.len() >= 11, "{:?}", html.keys());
    for (name, text) in &html {
        for tag in tags(text) {
            let Some(target) = attribute(tag, "src").or(attribute(tag, "href")) else {
                continue;
            };
            let outside = target.contains("://") || target.starts_with("//");
            if !tag.starts_with("a ") {
                assert!(!outside, "{name} loads {target}");
            }
            if !outside && !target.starts_with("mailto:") {
                assert_resolves(&book, name, target);
            }
        }
    }
    let css = book.iter().filter(|(name, _)| name.ends_with(".css"));
    for (name, bytes) in css {
        let text = String::from_utf8_lossy(bytes);
        for url in text.split("url(").skip(1) {
            let url = url.split(')').next().unwrap().trim_matches(['"', '\'']);
            assert!(url.starts_with("data:") || !url.contains("//"), "{name} loads {url}");
            if !url.starts_with("data:") {
                assert_resolves(&book, name, url);
            }
        }
    }
    assert!(book.keys().any(|name| name.starts_with("searchindex")));
}

#[test]
fn every_formula_is_set_and_every_figure_is_shown() {
    let book = files();
    let print = String::from_utf8_lossy(&book["print.html"]).into_owned();
    for n in 1..=13 {
        assert!(print.contains(&format!(r#"id="eq-{n}""#)), "equation ({n})");
    }
    assert!(print.matches("<math").count() > 200);
    assert!(!print.contains("merror"));
    let figures = book.keys().filter_map(|name| name.strip_prefix("figures/"));
    for figure in figures.filter(|name| name.ends_with(".svg") && !name.contains('-')) {
        assert!(print.contains(&format!(r#"src="figures/{figure}""#)), "{figure} is nowhere");
    }
    let prose = print.split("<main>").nth(1).unwrap().split("</main>").next().unwrap();
    // The chapter on own problems shows a directive of mdBook, and that on studies code with dollars.
    let prose = prose.replace("{{#include ", "");
    let code = prose.split("<code").map(|part| part.split_once("</code>").map_or(part, |of| of.1));
    let prose: String = code.collect();
    for left in ["$", "{{", "{%", "eq:", "table:", "\\("] {
        assert!(!prose.contains(left), "`{left}` was left in the text");
    }
}

#[test]
fn the_book_has_at_most_six_and_a_half_megabytes() {
    let size: usize = files().values().map(Vec::len).sum();
    assert!(size <= 6_500_000, "{size} bytes");
}

#[test]
fn what_no_longer_holds_stops_the_build_with_its_place() {
    let page = |text: &str| BTreeMap::from([("a.md.tera".to_owned(), text.to_owned())]);
    let mut context = Context::new();
    context.insert("exact", &49);
    let holds = "one\n{{ require(that=exact > 48, what=\"nearly all\") -}}\ntwo\n";
    assert_eq!(pages(&page(holds), &context).unwrap()["src/a.md"], "one\ntwo\n");
    let fails = "one\n\n{{ require(that=exact == 50, what=\"every count\") }}\n";
    let error = pages(&page(fails), &context).unwrap_err();
    assert!(error.starts_with("report/templates/a.md.tera:3: "), "{error}");
    assert!(error.contains("no longer holds: every count"), "{error}");
}

#[test]
fn what_the_data_lack_is_an_error_that_says_where() {
    for (text, place) in [("one\n{{ nothing }}\n", 2), ("\n\n{% if %}\n", 3)] {
        let broken = BTreeMap::from([("a.md.tera".to_owned(), text.to_owned())]);
        let error = pages(&broken, &Context::new()).unwrap_err();
        assert!(error.starts_with(&format!("report/templates/a.md.tera:{place}: ")), "{error}");
    }
}

#[test]
fn an_error_in_a_component_names_the_page_too() {
    let component = "{% component c(x) %}\n{{ x.y }}\n{% endcomponent c %}";
    let templates = [("parts.tera", component), ("page.md.tera", "{{ <c x={1} /> }}")];
    let templates = templates.map(|(name, text)| (name.to_owned(), text.to_owned()));
    let error = pages(&templates.into(), &Context::new()).unwrap_err();
    assert!(error.starts_with("report/templates/parts.tera:2: "), "{error}");
    assert!(error.contains("page.md.tera"), "{error}");
}

#[test]
fn the_prose_has_no_branches_for_other_results() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("report/templates");
    let templates = files_below(&folder).into_values();
    let branches: usize =
        templates.map(|text| String::from_utf8_lossy(&text).matches("{% if").count()).sum();
    assert!(branches < 80, "{branches} branches; say what holds, and require it");
}

#[test]
fn the_table_of_results_has_every_published_count() {
    let text = String::from_utf8(files()["results.csv"].clone()).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap();
    let column = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let (rule, ours, paper) = (column("rule"), column("iterations"), column("published"));
    let of_paper: Vec<_> =
        lines.filter(|line| line[rule] == "signed" && !line[paper].is_empty()).collect();
    assert_eq!(of_paper.len(), 50);
    assert!(of_paper.iter().all(|line| line[ours] == line[paper]));
}

#[test]
fn the_data_behind_a_table_are_that_table() {
    let book = files();
    let mut tables = 0;
    for (page, html) in html(&book).iter().filter(|(name, _)| **name != "print.html") {
        for element in html.split("<figure id=\"table-").skip(1) {
            let element = element.split("</figure>").next().unwrap();
            let data = format!("data/{}.csv", element.split('"').next().unwrap());
            if !element.contains(&format!("href=\"{data}\"")) {
                continue;
            }
            let csv = String::from_utf8(book[&data].clone()).unwrap();
            assert_eq!(csv.lines().count(), element.matches("<tr>").count(), "{page}: {data}");
            let options = CsvReadOptions::default().with_infer_schema_length(None);
            let reader = CsvReader::new(Cursor::new(csv.as_bytes())).with_options(options);
            let read = reader.finish().unwrap();
            let columns = read.get_column_names();
            let columns = columns.iter().filter(|name| !name.ends_with(", remark")).count();
            let heads = element.split("</thead>").next().unwrap().matches("<th").count();
            // One of them is `<thead>` itself.
            assert_eq!(columns, heads - 1, "{page}: {data}");
            tables += 1;
        }
    }
    assert!(tables > 15, "{tables}");
    // Digits are those of the run, not those that the page shows.
    let sums = String::from_utf8(book["data/sums.csv"].clone()).unwrap();
    assert!(sums.lines().nth(1).unwrap().split(',').any(|cell| cell.len() > 12), "{sums}");
}

#[test]
fn no_mark_of_a_number_is_left_on_a_page() {
    for (name, text) in html(&files()) {
        assert!(!text.contains(['\u{E000}', '\u{E001}', '\u{E002}']), "{name}");
    }
}

#[test]
fn no_accent_covers_a_part_of_what_it_belongs_to() {
    // Chromium stretches no accent: over more than a letter it would stand over one of them.
    for (name, text) in html(&files()) {
        for accented in text.split("<mover>").skip(1) {
            let inside = accented.split("</mover>").next().unwrap();
            assert!(!inside.contains("<mrow>"), "{name}: {inside}");
            assert!(!inside.ends_with("<mi>‾</mi>"), "{name}: {inside}");
        }
    }
}

#[test]
fn the_search_finds_how_to_cite_and_the_licence() {
    let book = files();
    let index = book.iter().find(|(name, _)| name.starts_with("searchindex")).unwrap().1;
    let index = String::from_utf8_lossy(index);
    for heading in ["introduction.html#how-to-cite", "introduction.html#licence"] {
        assert!(index.contains(heading), "{heading}");
    }
}

#[test]
fn columns_of_data_are_numbers_or_text() {
    let book = files();
    let data: Vec<_> = book.iter().filter(|(name, _)| name.ends_with(".csv")).collect();
    assert!(data.iter().filter(|(name, _)| name.starts_with("data/")).count() > 15);
    for (name, bytes) in data {
        // A row of another length than the header would be refused.
        let options = CsvReadOptions::default().with_infer_schema_length(None);
        let read = CsvReader::new(Cursor::new(bytes)).with_options(options).finish();
        let read = read.unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(read.height() > 0, "{name}");
        for column in read.columns().iter().filter(|column| column.dtype().is_string()) {
            let cells = column.str().unwrap().iter().flatten();
            let (numbers, texts): (Vec<_>, Vec<_>) =
                cells.partition(|cell| cell.parse::<f64>().is_ok());
            assert!(
                numbers.is_empty() || texts.is_empty(),
                "{name}, {}: {numbers:?} {texts:?}",
                column.name()
            );
        }
    }
}

#[test]
fn the_python_of_the_page_on_files_runs() {
    let page = fs::read_to_string(book().join("../src/fields.md")).unwrap();
    let (_, program) = page.split_once("```python\n").unwrap();
    let (program, rest) = program.split_once("```").unwrap();
    let (_, shown) = rest.split_once("```text\n").unwrap();
    let (shown, _) = shown.split_once("```").unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files() {
        if name.starts_with("data/") || name == "results.csv" {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
    }
    let python = |program: &str| {
        Command::new("python3").args(["-c", program]).current_dir(folder.path()).output()
    };
    if !python("import numpy, polars").is_ok_and(|found| found.status.success()) {
        return skip("no python3 with numpy and polars");
    }
    let said = python(program).unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    assert_eq!(String::from_utf8(said.stdout).unwrap(), shown);
}

/// The files of the book by their path in it, without pages that other tests put beside its own.
pub(crate) fn files() -> BTreeMap<String, Vec<u8>> {
    let mut files = files_below(book());
    files.retain(|name, _| !name.starts_with("explore-test"));
    files
}

pub(crate) fn html(book: &BTreeMap<String, Vec<u8>>) -> BTreeMap<&str, String> {
    book.iter()
        .filter(|(name, _)| name.ends_with(".html"))
        .map(|(name, bytes)| (name.as_str(), String::from_utf8(bytes.clone()).unwrap()))
        .collect()
}

/// The insides of the tags of an HTML text.
pub(crate) fn tags(text: &str) -> impl Iterator<Item = &str> {
    text.split('<').skip(1).filter_map(|rest| rest.split('>').next())
}

pub(crate) fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    tag.split(&format!(r#" {name}=""#)).nth(1)?.split('"').next()
}

/// That the file, and the element in it, which `target` names in page `from` exist.
fn assert_resolves(book: &BTreeMap<String, Vec<u8>>, from: &str, target: &str) {
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = path.split('?').next().unwrap();
    let mut steps: Vec<&str> = from.split('/').collect();
    if !path.is_empty() {
        steps.pop();
        for step in path.split('/') {
            match step {
                "." => {}
                ".." => assert!(steps.pop().is_some(), "{from} leaves the book to {target}"),
                step => steps.push(step),
            }
        }
    }
    let file = steps.join("/");
    let bytes =
        book.get(&file).unwrap_or_else(|| panic!("{from} links to {target}, which is not there"));
    if !anchor.is_empty() {
        let id = format!(r#"id="{anchor}""#);
        assert!(
            String::from_utf8_lossy(bytes).contains(&id),
            "{from} links to {target}: no such place"
        );
    }
}
