//! Texts of users in pages that the program makes.

use crate::common::{Project, TABLE};
use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
use std::fs;
use std::path::Path;

/// Texts of the cells of the tables in Markdown; anything but text in a cell is named.
fn cells(markdown: &str) -> Vec<String> {
    let (mut cells, mut is_in_cell) = (Vec::new(), false);
    for event in Parser::new_ext(markdown, Options::all()) {
        match event {
            Event::Start(Tag::TableCell) => {
                is_in_cell = true;
                cells.push(String::new());
            }
            Event::End(TagEnd::TableCell) => is_in_cell = false,
            Event::Text(text) if is_in_cell => cells.last_mut().unwrap().push_str(&text),
            other if is_in_cell => cells.last_mut().unwrap().push_str(&format!("{other:?}")),
            _ => {}
        }
    }
    cells
}

#[test]
fn a_cell_shows_the_text_of_the_user_as_it_is() {
    let project = Project::with(TABLE);
    fs::create_dir_all(project.path("pipeline/meshes")).unwrap();
    let mesh = include_str!("../meshes/square.msh");
    let meshes = ["a|b.msh", "a_b_c.msh", "*x*.msh", "$5.msh", "<b>.msh", "`c`.msh", "--.msh"];
    for name in meshes {
        project.write(&format!("pipeline/meshes/{name}"), mesh);
    }
    let domains: Vec<String> = meshes.map(|name| format!("\"meshes/{name}\"")).into();
    let study = format!(
        "title = \"$T$ *of* meshes\"\nf = \"else=-1\"\nvary = {{ domain = [{}] }}\noutputs = [\"table\", \"chart\"]\n",
        domains.join(", ")
    );
    project.scene("s", &study);
    let formulas = "title = \"F\"\nvary = { f = [\"formula(3*x*y - 1.1)\", \"quadrant(ll)=9; else=-1\"] }\n\
        outputs = [\"table\"]\n";
    project.scene("t", formulas);
    project.add_book("# One\n\n{{#include tables/s.md}}\n\n{{#include tables/t.md}}\n");
    project.run(&["run"]).lines();
    let read = |path: &str| project.read(path);
    let shown = cells(&read("report/tables/s.md"));
    for name in meshes {
        assert!(shown.iter().any(|cell| cell == &format!("meshes/{name}")), "{name}: {shown:?}");
    }
    let columns = shown.iter().position(|cell| cell.starts_with("meshes/")).unwrap();
    assert_eq!(shown.len(), columns * (1 + meshes.len()), "{shown:?}");
    let of_formulas = read("report/tables/t.md");
    assert!(cells(&of_formulas).iter().any(|cell| cell == "formula(3*x*y - 1.1)"), "{of_formulas}");
    // The reason below the table names the member by its f.
    let without = of_formulas.lines().last().unwrap();
    assert!(without.contains("quadrant(ll)=9; else=-1"), "{of_formulas}");
    let page = read("report/book/one.html");
    assert!(page.contains("formula(3*x*y - 1.1)") && page.contains("meshes/$5.msh"), "{page}");
    assert!(page.contains("meshes/&lt;b&gt;.msh") && !page.contains("<em>x</em>"), "{page}");
}

#[test]
fn digits_that_no_number_has_are_refused_with_the_line_of_the_page() {
    let filters =
        [("fix(to=65536)", "`to` is 65536"), ("sci(digits=100000)", "`digits` is 100000")];
    for (filter, named) in filters {
        let page = format!("# One\n\n{{{{ 1.5 | {filter} }}}}\n");
        let pages = signorini_book::pages(
            &[("one.md.tera".to_owned(), page)].into(),
            &tera::Context::new(),
        );
        let error = pages.unwrap_err();
        assert!(error.contains(named), "{error}");
        assert!(error.starts_with("report/templates/one.md.tera:3: "), "{error}");
    }
}

#[test]
fn a_figure_is_found_by_its_name_whatever_signs_it_has() {
    let parts = include_str!("../../report/templates/parts.tera");
    let page = "# One\n\n{% <figure fig={fig} alt={title}> %}\nText.\n{% </figure> %}\n\n\
        <span id=\"made-{{ fig.name | address }}\"></span>[{{ title | text }}](<figures/{{ fig.name | address }}.svg>)\n";
    for name in ["plate-map", "a b#1?-map", "100%20 \"x\" <b>(1)*&$-map", "größe-map"] {
        let fig = serde_json::json!({ "name": name, "file": format!("{name}.svg"), "data": format!("figures/{name}.csv"),
            "width": 600, "height": 400, "command": "signorini run" });
        let mut context = tera::Context::new();
        context.insert("fig", &fig);
        context.insert("title", "*Q* [x](y) $5 `z`");
        let templates = [("parts.tera", parts), ("one.md.tera", page)];
        let templates = templates.map(|(name, text)| (name.to_owned(), text.to_owned()));
        let pages = signorini_book::pages(&templates.into(), &context).unwrap();
        let mut files: std::collections::BTreeMap<String, Vec<u8>> =
            pages.into_iter().map(|(name, text)| (name, text.into_bytes())).collect();
        files.insert("src/SUMMARY.md".into(), b"- [One](one.md)\n".to_vec());
        for ending in ["svg", "csv"] {
            files.insert(format!("src/figures/{name}.{ending}"), b"<svg/>".to_vec());
        }
        let scratch = tempfile::tempdir().unwrap();
        let book = signorini_book::build(&files, scratch.path()).unwrap();
        let html = String::from_utf8_lossy(&book["one.html"]).into_owned();
        assert!(html.contains(">Figure 1.1</a>") && html.contains("*Q* [x](y) $5 `z`"), "{html}");
        for address in html.split("src=\"").skip(1).filter_map(|rest| rest.split('"').next()) {
            let file = percent_encoding::percent_decode_str(address).decode_utf8().unwrap();
            assert!(!file.starts_with("figures/") || book.contains_key(&*file), "{address}");
        }
    }
}

#[test]
fn the_mathematics_and_the_pipeline_forbid_the_same_characters() {
    for c in '\0'..=char::MAX {
        let both = signorini_mathematics::problem::text::is_forbidden(c);
        assert_eq!(signorini::pipeline::files::is_forbidden(c), both, "{c:?}");
    }
}

#[test]
fn texts_of_the_user_are_escaped_in_every_template() {
    let templates = Path::new(env!("CARGO_MANIFEST_DIR")).join("report/templates");
    let (mut shown, mut addresses) = (0, 0);
    for entry in fs::read_dir(templates).unwrap() {
        let path = entry.unwrap().path();
        let Ok(text) = fs::read_to_string(&path) else { continue };
        // A name in the address of a file or of a part of a page.
        let beginnings = ["figures/{{", "figure:{{", "figure-{{", "(<data/{{ one"];
        for rest in beginnings.iter().flat_map(|place| text.split(place).skip(1)) {
            let name = rest.split("}}").next().unwrap();
            assert!(name.ends_with("| address "), "{}: {name}", path.display());
            addresses += 1;
        }
        for value in ["scene.title", "one.title", "scene.name", "file.name", "alt", "one.what"] {
            for rest in text.split(&format!("{{{{ {value}")).skip(1) {
                let end = rest.split("}}").next().unwrap();
                // Names of longer values are others.
                if end.starts_with([' ', '|']) {
                    assert!(end.contains("| text"), "{}: {value}", path.display());
                    shown += 1;
                }
            }
        }
        addresses += text.matches("\"figures/\" ~ (fig.file | address)").count();
    }
    assert!(shown >= 3 && addresses >= 5, "{shown} {addresses}");
}
