//! `signorini init`: what it begins with is a project that runs.

use crate::common::{Project, Said, TABLE, assert_same};
use std::fs;

#[test]
fn a_new_study_runs() {
    let place = Project::with(TABLE);
    let said = place.run(&["init", "new/study"]);
    assert_eq!(said.lines().last(), Some(&"next: cd new/study && signorini run"));
    let run = |args: &[&str]| -> Said {
        place.command(args).current_dir(place.path("new/study")).output().unwrap().into()
    };
    let ran = run(&["run"]);
    assert_eq!(ran.lines().last(), Some(&"the book: report/book/index.html"));
    assert!(!ran.out.contains("leaves out"), "{ran:?}");
    run(&["run"]).nothing_to_do();
    // What the page points to is in the book.
    let book = place.path("new/study/report/book");
    let page = fs::read_to_string(book.join("plate.html")).unwrap();
    for name in ["figures/plate-surface.svg", "results.csv", "tables/plate.csv"] {
        assert!(page.contains(&format!("\"{name}\"")) && book.join(name).exists(), "{name}");
    }
    // The table of the scene has all digits in its file, and is part of the page.
    let csv = fs::read_to_string(place.path("new/study/report/tables/plate.csv")).unwrap();
    assert_eq!(csv, fs::read_to_string(book.join("tables/plate.csv")).unwrap());
    assert_eq!(csv.lines().next().map(|head| head.split(',').count()), Some(9));
    for line in csv.lines() {
        let first = line.split(',').next().unwrap();
        assert!(page.contains(&format!(">{first}</t")), "{first}: {page}");
    }
    assert!(run(&["identify"]).refusal().contains("no published table"));
    assert!(run(&["diff"]).refusal().contains("paper_table"));
}

#[test]
fn a_study_begins_wherever_none_of_its_files_is() {
    let place = Project::with(TABLE);
    // As `git init`, websites and systems leave it.
    fs::create_dir_all(place.path("empty/.git")).unwrap();
    fs::create_dir_all(place.path("empty/.github/workflows")).unwrap();
    for file in ["README.md", "LICENSE", ".DS_Store", "CITATION.cff"] {
        place.write(&format!("empty/{file}"), "mine");
    }
    place.run(&["init", "empty"]).lines();
    assert_eq!(fs::read(place.path("empty/README.md")).unwrap(), b"mine");
    let attributes = fs::read_to_string(place.path("empty/.gitattributes")).unwrap();
    assert!(attributes.lines().any(|line| line == "* -text"), "{attributes}");
    fs::create_dir_all(place.path("with/report")).unwrap();
    place.write("with/report/book.toml", "mine");
    let before = place.files("with");
    let said = place.run(&["init", "with"]);
    assert!(said.refusal().contains("with/report/book.toml is there already"), "{said:?}");
    assert_same(&place.files("with"), &before);
    for taken in ["empty", ".", "pipeline/scenes/a.toml"] {
        let before = place.times();
        let said = place.run(&["init", taken]);
        assert!(said.refusal().contains(taken), "{said:?}");
        assert_eq!(place.times(), before);
    }
    for (folder, command) in [("it's new", r"cd 'it'\''s new' && "), ("-x", "cd ./-x && ")] {
        let said = place.run(&["init", "--", folder]);
        assert_eq!(said.lines()[2], format!("next: {command}signorini run"));
    }
    // Where there is no cache yet, none is to be moved.
    place.write("file", "");
    let said = place.run(&["init", "file/study"]);
    assert!(said.refusal().ends_with("; name a folder in another place"), "{said:?}");
}

#[test]
fn a_mistake_in_a_page_is_named_with_the_line_of_the_file_that_has_it() {
    let place = Project::with(TABLE);
    place.run(&["init", "study"]).lines();
    let page = "study/report/templates/plate.md";
    let text = fs::read_to_string(place.path(page)).unwrap();
    let run = || -> Said {
        place.command(&["run"]).current_dir(place.path("study")).output().unwrap().into()
    };
    let table = "\n| a |\n| --- |\n| b |\n\n";
    let line = 2 + (text.clone() + table).lines().count();
    for (mistake, what) in [
        (
            "[x](nowhere.md)",
            "the link to `nowhere.md` leads nowhere: the book has no nowhere.html; its pages are those in SUMMARY.md",
        ),
        (
            "![x](figures/no.svg)",
            "the link to `figures/no.svg` leads nowhere: the book has no figures/no.svg",
        ),
        (
            "[x](plate.md#x)",
            "the link to `plate.md#x` leads nowhere: plate.html has no heading with this id, its text in small \
             letters and - for spaces",
        ),
        ("[](eq:7)", "no equation is tagged (7), but `eq:7` refers to it"),
        ("$5 for tea", "unpaired `$`; write `\\$` for a dollar, or close the formula"),
    ] {
        place.write(page, format!("{text}{table}\n{mistake}\n"));
        let said = run();
        let error = format!("error: report/book: report/templates/plate.md:{line}: {what}");
        assert_eq!((said.code, said.err.lines().last()), (Some(3), Some(&*error)), "{said:?}");
    }
    place.write(page, text + table + "[top](#pushed-up-in-the-middle), [all](results.csv)\n");
    run().lines();
    // A template, which a study without the paper has no data for.
    place.write("study/report/templates/SUMMARY.md", "- [P](plate.md)\n- [Mine](mine.md)\n");
    place.write("study/report/templates/mine.md.tera", "# Mine\n");
    let line = "the book leaves out all pages from *.md.tera: they need two scenes, one with `paper_table = 1` and \
        one with 2";
    assert_eq!(run().lines()[0], line);
    let made = fs::read_to_string(place.path("study/report/src/mine.md")).unwrap();
    assert!(made.starts_with("# Mine\n\nLeft out, as are all pages from `*.md.tera`: they need"));
    place.write("study/report/templates/mine.md", "# Mine\n");
    let said = run();
    let error = "error: report/book: report/templates/mine.md.tera: mine.md makes the same page; remove one of them";
    assert_eq!((said.code, said.err.lines().last()), (Some(3), Some(error)));
}

#[test]
fn pages_may_lie_in_folders_and_show_pictures_of_their_own() {
    let place = Project::with(TABLE);
    place.run(&["init", "study"]).lines();
    let templates = "study/report/templates";
    fs::create_dir(place.path(&format!("{templates}/sub"))).unwrap();
    let write = |name: &str, text: &[u8]| place.write(&format!("{templates}/{name}"), text);
    let run = || -> Said {
        place.command(&["run"]).current_dir(place.path("study")).output().unwrap().into()
    };
    write("SUMMARY.md", b"- [P](plate.md)\n- [S](sub/one.md)\n");
    write("plate.md", b"# P\n\n$$ x \\tag{1} $$\n");
    write("sub/photo.png", b"\x89PNG\xff");
    write("sub/one.md", b"# One\n\n[](eq:1) ![photo](photo.png)\n\n| a |\n| --- |\n| b |\n");
    run().lines();
    let book = place.path("study/report/book");
    let page = fs::read_to_string(book.join("sub/one.html")).unwrap();
    for target in ["../plate.html#eq-1", "photo.png"] {
        assert!(page.contains(&format!("=\"{target}\"")), "{target}: {page}");
        assert!(book.join("sub").join(target.split('#').next().unwrap()).exists(), "{target}");
    }
    fs::remove_file(place.path(&format!("{templates}/SUMMARY.md"))).unwrap();
    let said = run();
    assert!(
        said.err.contains("report/templates has no SUMMARY.md; list the pages there"),
        "{said:?}"
    );
}

#[test]
fn files_of_a_new_repository_get_the_lines_that_they_lack() {
    let place = Project::with(TABLE);
    fs::create_dir(place.path("study")).unwrap();
    place.write("study/.gitignore", "/target\r\n/report/book\r\n*.log");
    place.write("study/.gitattributes", "* text=auto\n");
    place.run(&["init", "study"]).lines();
    let ignored = fs::read_to_string(place.path("study/.gitignore")).unwrap();
    assert!(ignored.starts_with("/target\r\n/report/book\r\n*.log\n"), "{ignored:?}");
    for line in ["/.signorini", "/report/src", "/pipeline/.*"] {
        assert_eq!(ignored.lines().filter(|one| *one == line).count(), 1, "{ignored:?}");
    }
    assert_eq!(ignored.matches("/report/book").count(), 1, "{ignored:?}");
    let attributes = fs::read_to_string(place.path("study/.gitattributes")).unwrap();
    assert!(attributes.starts_with("* text=auto\n") && attributes.ends_with("\n* -text\n"));
    // What is a part of another project's results or inputs is no place for a study.
    for folder in ["report/templates/study", "pipeline/study", "figures"] {
        let said = place.run(&["init", folder]);
        assert!(said.refusal().contains("the study would lie in"), "{said:?}");
        assert!(!place.path(folder).join("report").exists());
    }
}
