//! Names of files as other systems write them, and texts of the user in pages.

use crate::common::{Project, TABLE};
use std::fs;
use std::path::Path;

/// A name as people type it; and as files from a Mac have it.
const COMPOSED: &str = "caf\u{e9}";
const DECOMPOSED: &str = "cafe\u{301}";

/// A square of two cells, in contact on a side of this name.
fn square(side: &str) -> String {
    let nodes = "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n";
    let sides = "1 1 2 1 1 1 2\n2 1 2 2 2 2 3\n3 1 2 2 2 3 4\n4 1 2 2 2 4 1\n";
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"{side}\"\n1 2 \"rest\"\n2 3 \"inside\"\n\
         $EndPhysicalNames\n$Nodes\n4\n{nodes}$EndNodes\n$Elements\n6\n{sides}\
         5 2 2 3 1 1 2 3\n6 2 2 3 1 1 3 4\n$EndElements\n"
    )
}

#[test]
fn names_are_found_whichever_way_they_write_accents() {
    for [of_file, of_user] in [[DECOMPOSED, COMPOSED], [COMPOSED, DECOMPOSED]] {
        let project = Project::with(TABLE);
        fs::create_dir_all(project.path("report/templates")).unwrap();
        fs::create_dir_all(project.path(&format!("pipeline/{of_file}"))).unwrap();
        let mesh = format!("pipeline/{of_file}/{of_file}.msh");
        project.write(&mesh, square(of_file));
        let scene = format!(
            "title = \"T\"\nf = \"else=-1\"\noutputs = [\"table\", \"map\"]\n\
             domain = {{ name = \"{of_user}/{of_user}.msh\", refine = 2, fixed = [\"{of_user}\"] }}\n"
        );
        project.scene(of_file, &scene);
        project.write("report/book.toml", "title = \"Mine\"\n");
        project.write("report/templates/SUMMARY.md", format!("- [One]({of_user}.md)\n"));
        let page = format!(
            "# One\n\n[here]({of_user}.md) ![x]({of_user}.png)\n\n\
             {{{{#include ../../pipeline/scenes/{of_user}.toml}}}}\n![y](figures/{of_user}-map.svg)\n"
        );
        project.write(&format!("report/templates/{of_file}.md"), page);
        project.write(&format!("report/templates/{of_file}.png"), "png");
        project.run(&["run"]).lines();
        // Results have one name, whatever the files have.
        assert!(project.path(&format!("figures/{COMPOSED}-map.svg")).exists());
        project.run(&["run", of_user]).nothing_to_do();
        project.run(&["run", "--task", &format!("solve/{of_user}")]).nothing_to_do();
        project.run(&["status", of_user]).lines();
        project.run(&["explain", &format!("solve/{of_user}")]).lines();
        project.run(&["solve", of_user]).lines();
        let file = format!("pipeline/{of_user}/{of_user}.msh");
        let side = format!("--fixed={of_user}");
        project.run(&["solve", "--domain", &file, "--f", "else=-1", &side]).lines();
        let absolute = project.path(&file).display().to_string();
        project.run(&["solve", "--domain", &absolute, "--f", "else=-1"]).lines();
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
