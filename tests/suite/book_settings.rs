//! Settings of the book, and texts of the user in it: what leads out of `report/`, what no file may hold, and mistakes.

use crate::common::{PAPER, Project, TABLE, files_below};
use crate::pages::{PAGE, Study};
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};

#[test]
fn settings_that_lead_out_of_the_folder_are_refused_and_nothing_is_written_there() {
    let study = Study::new();
    let settings = study.read("report/book.toml");
    let line = settings.lines().count() + 1;
    fs::write(study.0.path("x.css"), "a{}").unwrap();
    let outside = study.0.path("x.css");
    let outside = outside.to_str().unwrap();
    let before = files_below(&study.0.path(""));
    for setting in [
        &format!("additional-css = [\"{outside}\"]"),
        "additional-css = [\"../../x.css\"]",
        "additional-js = [\"theme/../../../x.css\"]",
        "theme = \"../..\"",
        "input-404 = \"../../../x.md\"",
        "redirect = { \"/../../../y.html\" = \"plate.html\" }",
        "redirect = { \"../../../y.html#part\" = \"plate.html\" }",
        "[output.\"../../y\"]",
        "[output.y]\ncommand = \"/bin/sh -c true\"",
        &format!("[output.y]\ncommand = \"sh -c 'cat {outside}'\""),
        "[preprocessor.y]\ncommand = \"../y\"",
    ] {
        study.write("report/book.toml", format!("{settings}{setting}\n"));
        let said = study.run(&["run"]);
        let line = line + setting.matches('\n').count();
        let place = format!("error: report/book.toml: line {line}: ");
        assert!(said.refusal().starts_with(&place), "{setting}: {said:?}");
    }
    study.write("report/book.toml", &settings);
    assert_eq!(files_below(&study.0.path("")), before);
    for (setting, why) in [
        ("additional-css = [\"no.css\"]", "no such file in report/"),
        ("theme = \"none\"", "no such folder with files"),
        ("[output.y]\ncommand = \"tools/y\"", "no such file in report/"),
        ("additional-css = [\"css/general.css\"]", "mdBook makes a file of this name"),
        ("redirect = { \"/plate.html\" = \"x.html\" }", "a page that the book has"),
        ("redirect = { \"/print.html\" = \"x.html\" }", "a page that the book has"),
    ] {
        if setting.contains("general") {
            study.write("report/css/general.css", "a{}");
        }
        study.write("report/book.toml", format!("{settings}{setting}\n"));
        let line = line + setting.matches('\n').count();
        let error = study.refusal(&study.read(PAGE));
        assert!(error.starts_with(&format!("report/book.toml: line {line}: ")), "{error}");
        assert!(error.contains(why), "{error}");
    }
}

#[test]
fn what_the_book_is_made_from_is_an_input_wherever_it_lies() {
    let study = Study::new();
    let outside = study.0.path("x.css");
    fs::write(&outside, "a{}").unwrap();
    symlink(&outside, study.0.path("study/report/x.css")).unwrap();
    let programs = study.0.path("programs");
    fs::create_dir(&programs).unwrap();
    let write_program = |text: &str| {
        fs::write(programs.join("installed"), format!("#!/bin/sh\n{text}")).unwrap();
        fs::set_permissions(programs.join("installed"), fs::Permissions::from_mode(0o755)).unwrap();
    };
    write_program("echo one > made.txt\n");
    study.write("report/tools/own", "#!/bin/sh\necho own one > made.txt\n");
    let settings = study.read("report/book.toml");
    let added = "additional-css = [\"x.css\"]\n[output.html.search.chapter]\n\"plate.md\" = { enable = false \
        }\n[output.installed]\ncommand = \"installed\"\n[output.own]\ncommand = \"./tools/own\"\n";
    study.write("report/book.toml", settings + added);
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap());
    let run = || {
        let mut command = study.0.command(&["run"]);
        let command = command.env("PATH", &path).env("MDBOOK_BOOK__TITLE", "of the environment");
        let said: crate::common::Said =
            command.current_dir(study.0.path("study")).output().unwrap().into();
        said.lines().concat()
    };
    run();
    assert!(run().starts_with("nothing to do"));
    assert_eq!(study.read("report/book/own/made.txt"), "own one\n");
    assert!(!study.read("report/book/html/plate.html").contains("of the environment"));
    write_program("echo two > made.txt\n");
    assert!(!run().starts_with("nothing to do"));
    assert_eq!(study.read("report/book/installed/made.txt"), "two\n");
    study.write("report/tools/own", "#!/bin/sh\necho own two > made.txt\n");
    assert!(!run().starts_with("nothing to do"));
    assert_eq!(study.read("report/book/own/made.txt"), "own two\n");
    fs::write(&outside, "b{}").unwrap();
    assert!(!run().starts_with("nothing to do"));
    // A folder that is a link might lead anywhere.
    symlink(&programs, study.0.path("study/report/theme")).unwrap();
    assert!(study.run(&["run"]).refusal().contains("links to a folder"));
}

#[test]
fn a_mistake_in_a_file_of_settings_is_told_in_one_line_with_its_place() {
    let project = Project::with(TABLE);
    let book = "[book]\ntitle = \"x\"\n";
    project.write("report/book.toml", book);
    let wrong = "zzz = \"\"\"a\nb\"\"\"\n";
    for (path, good, line) in [
        ("pipeline/scenes/a.toml", TABLE.to_owned(), "line "),
        ("pipeline/paper.toml", PAPER.replace("r =", &format!("{wrong}r =")), "line 1"),
        (
            "report/book.toml",
            format!("{book}multilingual = false\n"),
            "line 3: unknown field `multilingual`",
        ),
        (
            "report/book.toml",
            format!("{book}[output.html]\ncurly-quotes = true\n"),
            "line 4: unknown field `curly-quotes`",
        ),
        (
            "report/book.toml",
            format!("{book}[output.html.fold]\nlevel = \"\"\"a\nb\"\"\"\n"),
            "line 4: ",
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
            (
                "report/book.toml",
                "[book]\n",
                format!("[book]\nauthors = [\"A\\u{:04X}\"]\n", u32::from(c)),
            ),
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
fn links_to_places_that_a_browser_finds_are_good_and_prices_are_no_formulas() {
    let study = Study::new();
    let page = study.read(PAGE);
    let good = "<a name=\"x1\"></a>\n\n## Mine {#my-own}\n\n<p ID='raw'>Raw</p>\n\nA note[^1].\n\n[^1]: Noted.\n\n\
        [a](#x1) [b](#my-own) [c](#raw) [d](#top) [e](#) [f](plate.md#x1) [g](plate.html?q=1#raw) [h](#footnote-1) \
        [i](./) [j](plate.md#:~:text=Raw) [k](figures/plate-surface.svg#any)\n\n\
        US\\$5 and US\\$10, `US$5 and US$10`, $x$ and 2$n$ nodes.\n\n```sh\necho US$5 US$10\n```\n";
    study.write(PAGE, format!("{page}\n{good}"));
    study.run(&["run"]).lines();
    let html = study.read("report/book/plate.html");
    assert_eq!(html.matches("<math").count(), 2);
    let lines = page.lines().count();
    for prices in ["US$5 and US$10", "It costs 5$, or 6$.", "Pay $5 now or 10$ later."] {
        let error = study.refusal(&format!("{page}\n{prices}\n"));
        let place = format!("report/templates/plate.md:{}: ", lines + 2);
        assert!(error.starts_with(&place) && error.contains("write `\\$`"), "{error}");
    }
    for link in ["[x](#X1)", "[x](#none)", "[x](plate.md#none)", "[x](../plate.md)"] {
        assert!(study.refusal(&format!("{page}\n{link}\n")).contains("leads nowhere"), "{link}");
    }
    // A formula over several lines is told in one.
    assert!(study.refusal(&format!("{page}\n$$\na\n\\frac{{1}}\n$$\n")).contains("`a \\frac{1}`"));
}
