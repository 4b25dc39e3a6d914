//! The record of a run for programs, an RO-Crate: complete and true, and read by the tools of others.

use crate::common::{EVERYTHING, Project, Said, skip, wanting};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

const NAMED: [&str; 2] = ["--name", "A. \"R\" Reviewer"];

/// A project with a certificate, whose scenes have names that an address cannot have as they are.
fn certified(options: &[&str]) -> Project {
    let project = Project::with(&(wanting(EVERYTHING) + "paper_table = 1\n"));
    project.scene("Поле 50%", &wanting("[\"surface\"]"));
    project.run(&["run"]).lines();
    certify(&project, options).lines();
    project
}

/// Writes the certificate of a project anew.
fn certify(project: &Project, options: &[&str]) -> Said {
    let _ = fs::remove_dir_all(project.path("codecheck"));
    project.run(&[&["certificate"], options].concat())
}

/// The entities of the crate of a project, by their addresses.
fn entities(project: &Project) -> BTreeMap<String, Value> {
    let text = fs::read(project.path("codecheck/ro-crate-metadata.json")).unwrap();
    let crate_: Value = serde_json::from_slice(&text).unwrap();
    let graph = crate_["@graph"].as_array().unwrap();
    let by_address: BTreeMap<_, _> = graph
        .iter()
        .map(|entity| (entity["@id"].as_str().unwrap().into(), entity.clone()))
        .collect();
    assert_eq!(by_address.len(), graph.len(), "each entity once");
    by_address
}

fn addresses(list: &Value) -> Vec<&str> {
    list.as_array().unwrap().iter().map(|entry| entry["@id"].as_str().unwrap()).collect()
}

#[test]
fn the_record_of_a_run_has_its_inputs_results_and_program() {
    let project = certified(&NAMED);
    let entities = entities(&project);
    assert_eq!(entities["ro-crate-metadata.json"]["about"]["@id"], "./");
    let root = &entities["./"];
    assert_eq!(root["@type"], "Dataset");
    for part in addresses(&root["hasPart"]) {
        let entity = &entities[part];
        let path = part.replace("%20", " ").replace("%25", "%");
        let bytes = fs::read(project.path("codecheck").join(&path)).unwrap();
        let hash = format!("blake3:{}", signorini::pipeline::hash(&bytes));
        assert_eq!(entity["identifier"], hash.as_str(), "{path}");
        assert_eq!(entity["contentSize"], bytes.len().to_string().as_str(), "{path}");
        let media_type = entity["encodingFormat"].as_str().unwrap();
        assert_ne!(media_type, "application/octet-stream", "{path}");
    }
    let run = &entities[root["mentions"]["@id"].as_str().unwrap()];
    assert_eq!(run["@type"], "CreateAction");
    let inputs = addresses(&run["object"]);
    assert_eq!(
        inputs,
        [
            "inputs/pipeline/paper.toml",
            "inputs/pipeline/scenes/a.toml",
            "inputs/pipeline/scenes/Поле%2050%25.toml"
        ]
    );
    let results = addresses(&run["result"]);
    assert!(results.contains(&"tables/table1.csv"), "{results:?}");
    assert!(results.contains(&"figures/Поле%2050%25-surface.svg"), "{results:?}");
    let parts = addresses(&root["hasPart"]);
    assert_eq!(parts, [&results[..], &inputs[..], &["certificate.md"]].concat());
    let program = &entities[run["instrument"]["@id"].as_str().unwrap()];
    assert_eq!(program["@type"], "SoftwareApplication");
    assert_eq!(program["softwareVersion"], env!("CARGO_PKG_VERSION"));
    assert_eq!(entities[run["agent"]["@id"].as_str().unwrap()]["name"], NAMED[1]);
}

#[test]
fn the_record_of_a_run_names_the_authors_and_the_licence_of_the_citation() {
    let entities = entities(&certified(&[]));
    let citation = concat!(env!("CARGO_MANIFEST_DIR"), "/CITATION.cff");
    let citation = fs::read_to_string(citation).unwrap();
    let field = |key: &str| citation.split_once(key).unwrap().1.lines().next().unwrap();
    assert_eq!(entities["#developers"]["name"], field("\n  - name: "));
    let author = entities["#author"]["name"].as_str().unwrap();
    for name in [field(" family-names: "), field(" given-names: "), field(" alias: ")] {
        assert!(author.contains(name), "{name} is not in {author}");
    }
    assert!(entities["#paper"]["name"].as_str().unwrap().contains(field("\n    title: ")));
    let licence = &entities[entities["#signorini"]["license"]["@id"].as_str().unwrap()];
    assert_eq!(licence["identifier"], field("\nlicense: "));
    // Nobody gave a name.
    assert!(entities["#run"].get("agent").is_none() && !entities.contains_key("#codechecker"));
}

/// The Python that has the validator, if there is one.
fn python() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let validators = std::env::split_paths(&path).map(|folder| folder.join("rocrate-validator"));
    let validator = validators.into_iter().find(|file| file.is_file())?;
    // A command of pipx is a link into the environment with its Python.
    Some(validator.canonicalize().ok()?.with_file_name("python3"))
}

#[test]
fn others_open_and_validate_the_record_of_a_run() {
    let Some(python) = python() else {
        return skip("no rocrate-validator on the PATH (`pip install roc-validator rocrate`)");
    };
    for options in [&NAMED[..], &[]] {
        let project = certified(options);
        if options.is_empty() {
            // A study of something else, without a manifest.
            project.scene("a", &wanting("[\"table\"]"));
            project.run(&["run"]).lines();
            certify(&project, &[]).lines();
            assert!(!project.path("codecheck/codecheck.yml").exists());
        }
        let mut command = Command::new(&python);
        command.args(["-c", include_str!("ro_crate.py")]).arg(project.path("codecheck"));
        let said = command.output().unwrap();
        assert!(said.status.success(), "{options:?}: {said:?}");
    }
}
