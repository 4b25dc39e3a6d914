//! What commands read: of a mesh its hash, of the book nothing unless it is built, and no broken scene hides another.

use crate::common::{Project, TABLE, mesh_path};
use std::fs;

const GEAR: &str = "title = \"Gear\"\nf = \"region(gear)=-1\"\n\
    domain = { name = \"meshes/gear.msh\", refine = 0, free = [\"hole\"] }\n\
    solver = \"arrow-hurwicz\"\nr = [10]\nstop = [\"printed-dual\"]\noutputs = [\"table\", \"surface\"]\n";

fn gear() -> Vec<u8> {
    fs::read(mesh_path("gear")).unwrap()
}

/// A project with a scene on the square, `a`, and two scenes on one mesh.
fn project() -> Project {
    let project = Project::with(TABLE);
    for name in ["gear", "wheel"] {
        project.scene(name, GEAR);
    }
    fs::create_dir(project.path("pipeline/meshes")).unwrap();
    project.write("pipeline/meshes/gear.msh", gear());
    project
}

/// Replaces a hash in all records of the cache, as if the runs had read other bytes.
fn forge(project: &Project, old: &str, new: &str) {
    for (name, bytes) in project.files(".signorini/v2/tasks") {
        let mut forged = String::new();
        for line in String::from_utf8(bytes).unwrap().lines() {
            let (_, json) = line.split_once(' ').unwrap();
            let json = json.replace(old, new);
            forged += &format!("{} {json}\n", signorini::pipeline::hash(json.as_bytes()));
        }
        project.write(&format!(".signorini/v2/tasks/{name}"), forged);
    }
}

#[test]
fn a_mesh_is_parsed_only_by_a_run_that_needs_it() {
    let project = project();
    project.run(&["run"]).lines();
    let bad = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\nmany\n";
    project.write("pipeline/meshes/gear.msh", bad);
    let before = project.times();
    for args in [&["list"][..], &["dag"], &["dag", "--json"], &["gc", "-n"], &["run", "a"]] {
        assert_eq!(project.run(args).code, Some(0), "{args:?}");
    }
    assert_eq!(project.run(&["solve", "a", "--solver", "multigrid"]).code, Some(0));
    let said = project.run(&["explain", "solve/gear"]);
    assert!(said.out.contains("file pipeline/meshes/gear.msh: "), "{said:?}");
    // What would parse it refuses it, with the name of the scene, and changes nothing.
    let task = ["run", "--task", "solve/wheel/printed-dual/r=10"];
    for args in [&["run"][..], &["run", "gear"], &["run", "-n"], &["run", "--force"], &task] {
        let said = project.run(args);
        let scene = if args == task { "scene `wheel`: " } else { "scene `gear`: " };
        assert!(said.refusal().contains(scene), "{args:?}: {said:?}");
    }
    let said = project.run(&["solve", "gear"]);
    assert!(said.refusal().contains("domain meshes/gear.msh: $Nodes, line 5"), "{said:?}");
    assert_eq!(project.times(), before);
    // If the bytes were those of the last run, nobody would look into them.
    forge(&project, &signorini::pipeline::hash(&gear()), &signorini::pipeline::hash(bad));
    project.run(&["run"]).nothing_to_do();
    assert_eq!(project.run(&["status", "--exit-code"]).code, Some(0));
    project.write("pipeline/meshes/gear.msh", gear());
    project.run(&["run"]).lines();
}
