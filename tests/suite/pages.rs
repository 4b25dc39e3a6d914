//! Pages of a study: what they include, and what lies beside them.

use crate::common::{Project, Said, TABLE};
use std::fs;
use std::os::unix::fs::symlink;

/// A study in the folder `study`.
pub(crate) struct Study(pub Project);

impl Study {
    pub(crate) fn new() -> Self {
        let place = Project::with(TABLE);
        place.run(&["init", "study"]).lines();
        Self(place)
    }

    pub(crate) fn run(&self, args: &[&str]) -> Said {
        self.0.command(args).current_dir(self.0.path("study")).output().unwrap().into()
    }

    pub(crate) fn read(&self, path: &str) -> String {
        fs::read_to_string(self.0.path("study").join(path)).unwrap()
    }

    pub(crate) fn write(&self, path: &str, text: impl AsRef<[u8]>) {
        let path = self.0.path("study").join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    /// Refusal of the book, which has a page with these lines at the end.
    pub(crate) fn refusal(&self, page: &str) -> String {
        self.write(PAGE, page);
        let said = self.run(&["run"]);
        let error = said.err.lines().last().unwrap_or_default().to_owned();
        assert!(said.code == Some(3) && error.starts_with("error: report/book: "), "{said:?}");
        error["error: report/book: ".len()..].into()
    }
}

pub(crate) const PAGE: &str = "report/templates/plate.md";

#[test]
fn a_page_includes_scenes_and_files_beside_it_and_follows_their_changes() {
    let study = Study::new();
    let text = "# Plate\n\n```toml\n{{#include ../../pipeline/scenes/plate.toml}}\n```\n\n{{#include \
        notes/part.md}}\n\n`\\{{#include x}}`\n";
    study.write(PAGE, text);
    study.write("report/templates/notes/part.md", "Of $x^2$, {{#include more.txt}}.\n");
    study.write("report/templates/notes/more.txt", "first");
    study.run(&["run"]).lines();
    let page = study.read("report/book/plate.html");
    for part in ["title = ", "<msup>", " first.", "<code>{{#include x}}</code>"] {
        assert!(page.contains(part), "{part}: {page}");
    }
    study.run(&["run"]).nothing_to_do();
    study.write("report/templates/notes/more.txt", "second");
    study.run(&["run"]).lines();
    assert!(study.read("report/book/plate.html").contains(" second."));
    let scene = study.read("pipeline/scenes/plate.toml");
    study.write("pipeline/scenes/plate.toml", scene.replace("title = \"", "title = \"Changed, "));
    study.run(&["run"]).lines();
    assert!(study.read("report/book/plate.html").contains("Changed, "));
}

#[test]
fn a_directive_that_nothing_replaces_is_named_with_its_line() {
    let study = Study::new();
    let outside = study.0.path("note.txt");
    fs::write(&outside, "first").unwrap();
    let outside = format!("{{{{#include {}}}}}", outside.display());
    for directive in [
        "{{#include no-such.md}}",
        "{{#include ../../pipeline/lock.toml}}",
        "{{#include ../../../note.txt}}",
        &outside,
        "{{#rustdoc_include no.rs}}",
        "{{#include ../../pipeline/scenes/plate.toml:9:3}}",
        "{{#inlcude a.md}}",
        "{{#title Other}}",
    ] {
        let error = study
            .refusal(&format!("# Plate\n\n| a |\n| --- |\n| b |\n\n```rust\n{directive}\n```\n"));
        let place = format!("report/templates/plate.md:8: `{directive}` includes nothing: write ");
        assert!(error.starts_with(&place), "{error}");
    }
    study.write("report/templates/part.txt", "\n\n{{#include no.txt}}");
    let error = study.refusal("# Plate\n\n{{#include part.txt}}\n");
    assert!(error.starts_with("report/templates/part.txt:3: `{{#include no.txt}}`"), "{error}");
    let error = study.refusal("# Plate\n\n![x](my photo.png)\n");
    assert!(
        error.starts_with("report/templates/plate.md:3: a space ends the link to `my photo.png`"),
        "{error}"
    );
}

#[test]
fn names_of_pages_and_files_that_the_book_makes_itself_are_refused() {
    let study = Study::new();
    let page = study.read(PAGE);
    let replaced = |name: &str, why: &str| {
        study.write(&format!("report/templates/{name}"), "mine");
        let error = study.refusal(&page);
        assert!(error.starts_with(&format!("report/templates/{name}: {why}")), "{error}");
        fs::remove_file(study.0.path("study/report/templates").join(name)).unwrap();
    };
    for name in ["results.csv", "figures/plate-surface.svg"] {
        replaced(name, "a run makes a file of this name");
    }
    let by_mdbook = "the book has a file of this name that mdBook makes";
    for name in ["index.html", "print.html", "toc.html", "plate.html"] {
        replaced(name, by_mdbook);
    }
    // These are names like any other.
    for name in ["404", "README"] {
        study.write(&format!("report/templates/{name}.md"), "# Lost\n");
        study.write("report/templates/SUMMARY.md", format!("- [Lost]({name}.md)\n"));
        study.run(&["run"]).lines();
        assert!(study.read(&format!("report/book/{name}.html")).contains("Lost"));
    }
}

#[test]
fn pages_that_become_none_are_refused_with_their_line() {
    let study = Study::new();
    let page = study.read(PAGE);
    let list = study.read("report/templates/SUMMARY.md");
    for (name, listed, why) in [
        ("plate.txt", "plate.txt", "is no page `*.md`"),
        ("b.MD", "b.MD", "is no page `*.md`"),
        ("b.md", "../../../b.md", "is no page in report/templates"),
        ("b.md", "/b.md", "is no page in report/templates"),
    ] {
        study.write(&format!("report/templates/{name}"), "# Mine\n");
        study.write("report/templates/SUMMARY.md", format!("{list}- [B]({listed})\n"));
        let error = study.refusal(&page);
        let line = list.lines().count() + 1;
        assert!(error.starts_with(&format!("report/templates/SUMMARY.md:{line}: ")), "{error}");
        assert!(error.contains(why), "{error}");
        fs::remove_file(study.0.path("study/report/templates").join(name)).unwrap();
    }
    study.write("report/templates/SUMMARY.md", "# Summary\n\n- [A](plate.md\n");
    assert!(study.refusal(&page).contains("SUMMARY.md:1: it lists no page"));
}

#[test]
fn what_editors_leave_is_no_input_and_in_no_book() {
    let study = Study::new();
    study.run(&["run"]).lines();
    let left = ["#X#", ".#X", ".X.swp", "X~", "X.orig", "X.rej", "X.bak", ".DS_Store"];
    for (folder, file) in [
        ("report/templates", "plate.md"),
        ("report/templates", "SUMMARY.md"),
        ("report", "book.toml"),
        ("pipeline/scenes", "plate.toml"),
    ] {
        for name in left {
            study.write(&format!("{folder}/{}", name.replace('X', file)), "mine");
        }
        let lock = study.0.path("study").join(folder).join(format!(".#{file}"));
        fs::remove_file(&lock).unwrap();
        symlink("user@host.4711:1700000000", lock).unwrap();
    }
    for name in [
        "plate.md.tmp.4711",
        "plate.md.sb-0815-abc",
        "Thumbs.db",
        "~$notes.docx",
        ".~lock.notes.odt#",
        "photo.png.part",
        "x.TMP",
    ] {
        study.write(&format!("report/templates/{name}"), "mine");
    }
    study.run(&["run"]).nothing_to_do();
    // What people put there is published.
    let own = ["2024/notes.txt", "LICENSE", "photo.png", "a.old.txt"];
    own.iter().for_each(|name| study.write(&format!("report/templates/{name}"), "mine"));
    study.run(&["run"]).lines();
    for name in own {
        assert_eq!(study.read(&format!("report/book/{name}")), "mine");
    }
}

#[test]
fn figures_and_tables_are_numbered_and_a_reference_to_none_is_refused() {
    let study = Study::new();
    let page = study.read(PAGE);
    let figure = "<figure id=\"figure-mine\">\n\n**[](figure:mine).** Mine.\n\n</figure>\n";
    study.write(PAGE, format!("{page}\n{figure}\nSee [](figure:mine).\n"));
    study.run(&["run"]).lines();
    let html = study.read("report/book/plate.html");
    assert_eq!(html.matches("\">Figure 1.1</a>").count(), 2, "{html}");
    let error = study.refusal(&format!("{page}\n[](table:none)\n"));
    let lines = page.lines().count();
    assert_eq!(
        error,
        format!(
            "report/templates/plate.md:{}: no page in SUMMARY.md has \
             `<figure id=\"table-none\">`, but `table:none` refers to it",
            lines + 2
        )
    );
}
