//! Settings of the book, and texts of the user in it: what leads out of `report/`, what no file may hold, and mistakes.

use crate::common::{PAPER, Project, TABLE, files_below};
use crate::pages::{PAGE, Study};
use std::fs;
use std::os::unix::fs::symlink;

#[test]
fn what_the_book_is_made_from_is_an_input_wherever_it_lies() {
    let study = Study::new();
    let outside = study.0.path("x.css");
    fs::write(&outside, "a{}").unwrap();
    fs::create_dir(study.0.path("study/report/theme")).unwrap();
    symlink(&outside, study.0.path("study/report/theme/x.css")).unwrap();
    // Nothing of the theme replaces a file of mdBook, but for fonts.
    study.write("report/theme/index.hbs", "mine");
    study.write("report/theme/book.js", "mine");
    study.write("report/theme/fonts/own.woff2", "font");
    let run = || {
        let mut command = study.0.command(&["run"]);
        let command = command.env("MDBOOK_BOOK__TITLE", "of the environment");
        let said: crate::common::Said =
            command.current_dir(study.0.path("study")).output().unwrap().into();
        said.lines().concat()
    };
    run();
    assert!(run().starts_with("nothing to do"));
    let page = study.read("report/book/plate.html");
    assert!(page.contains("<main>") && !page.contains("of the environment"), "{page}");
    let book = files_below(&study.0.path("study/report/book"));
    let texts = |beginning: &str| {
        let named = book.iter().filter(|(name, _)| name.starts_with(beginning));
        named.map(|(_, bytes)| String::from_utf8_lossy(bytes)).collect::<Vec<_>>()
    };
    assert_eq!([texts("theme/book-"), texts("fonts/own-")].concat(), ["mine", "font"]);
    assert!(texts("book-").iter().all(|text| text != "mine"));
    fs::write(&outside, "b{}").unwrap();
    assert!(!run().starts_with("nothing to do"));
    // A folder that is a link might lead anywhere.
    symlink(study.0.path("study/report/book"), study.0.path("study/report/theme/more")).unwrap();
    assert!(study.run(&["run"]).refusal().contains("links to a folder"));
}

#[test]
fn a_mistake_in_a_file_of_settings_is_told_in_one_line_with_its_place() {
    let project = Project::with(TABLE);
    let book = "title = \"x\"\n";
    project.write("report/book.toml", book);
    let wrong = "zzz = \"\"\"a\nb\"\"\"\n";
    for (path, good, line) in [
        ("pipeline/scenes/a.toml", TABLE.to_owned(), "line "),
        ("pipeline/paper.toml", PAPER.replace("r =", &format!("{wrong}r =")), "line 1"),
        (
            "report/book.toml",
            format!("{book}multilingual = false\n"),
            "line 2: unknown field `multilingual`, expected `title`",
        ),
        ("pipeline/timings.toml", "schema = \"\"\"a\nb\"\"\"\n".into(), "line 1"),
        ("pipeline/lock.toml", wrong.into(), "pipeline/lock.toml"),
    ] {
        let kept = fs::read(project.path(path)).ok();
        let text = if path.contains("scenes") { format!("{good}{wrong}") } else { good };
        project.write(path, text);
        let said = project.run(&["run"]);
        assert!(said.refusal().contains(line), "{path}: {said:?}");
        match kept {
            Some(kept) => project.write(path, kept),
            None => fs::remove_file(project.path(path)).unwrap(),
        }
    }
}

#[test]
fn characters_that_no_line_of_text_may_have_are_refused_wherever_the_user_writes() {
    let study = Study::new();
    for c in ['\u{FFFE}', '\u{FFFF}', '\u{1}', '\u{85}'] {
        let code = format!("U+{:04X}", u32::from(c));
        for (path, from, to) in [
            (
                "pipeline/scenes/plate.toml",
                "title = \"",
                format!("title = \"\\u{:04X}", u32::from(c)),
            ),
            ("report/book.toml", "title = \"", format!("title = \"\\u{:04X}", u32::from(c))),
        ] {
            let kept = study.read(path);
            study.write(path, kept.replacen(from, &to, 1));
            let said = study.run(&["run"]);
            assert!(said.refusal().contains(&code), "{path}: {said:?}");
            study.write(path, kept);
        }
        for (path, of) in [
            (format!("report/templates/a{c}.png"), "file"),
            (format!("pipeline/scenes/a{c}.toml"), "scene"),
        ] {
            study.write(&path, "mine");
            let said = study.run(&["run"]);
            let error = said.refusal();
            assert!(
                error.contains(&code) && error.ends_with(&format!("rename the {of}")),
                "{said:?}"
            );
            fs::remove_file(study.0.path("study").join(&path)).unwrap();
        }
        let error = study.refusal(&format!("# Plate\n\na{c}b\n"));
        assert!(
            error.starts_with("report/templates/plate.md:3: ") && error.contains(&code),
            "{error}"
        );
    }
}

#[test]
fn links_to_places_that_a_browser_finds_are_good() {
    let study = Study::new();
    let page = study.read(PAGE);
    let good = "<a id=\"x1\"></a>\n\n## Mine {#my-own}\n\n<p id=\"raw\">Raw</p>\n\nA note[^1].\n\n[^1]: Noted.\n\n\
        [a](#x1) [b](#my-own) [c](#raw) [d](#top) [e](#) [f](plate.md#x1) [g](plate.html?q=1#raw) [h](#footnote-1) \
        [i](./) [j](plate.md#:~:text=Raw) [k](figures/plate-surface.svg#any)\n\n\
        US\\$5 and US\\$10, `US$5 and US$10`, $x$ and 2$n$ nodes.\n\n```sh\necho US$5 US$10\n```\n";
    study.write(PAGE, format!("{page}\n{good}"));
    study.run(&["run"]).lines();
    let html = study.read("report/book/plate.html");
    assert_eq!(html.matches("<math").count(), 2);
    for link in ["[x](#X1)", "[x](#none)", "[x](plate.md#none)", "[x](../plate.md)"] {
        assert!(study.refusal(&format!("{page}\n{link}\n")).contains("leads nowhere"), "{link}");
    }
    // A formula over several lines is told in one.
    assert!(study.refusal(&format!("{page}\n$$\na\n\\frac{{1}}\n$$\n")).contains("`a \\frac{1}`"));
}
