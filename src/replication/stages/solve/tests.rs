//! Problems and pairs are read from a solution, and not computed again.

use super::*;
use crate::pipeline::InputFile;
use crate::replication::study::Study;
use std::collections::BTreeMap;
use std::path::Path;

/// Cell of a scene with one member.
fn only(scene: &Scene) -> Cell {
    cell(scene, scene.drawn(None))
}

/// Artifacts of the cell of a scene with one member.
fn made(scene: &Scene, interrupted: &AtomicBool) -> Made {
    let cell = only(scene);
    let mut recorder = cell.recorder(interrupted);
    let solved = cell.solved(&InputFiles::new(), &mut recorder);
    cell.artifacts(solved, recorder)
}

/// Calls `read` with a scene of this text that asks for an accuracy, and the artifacts of its solve. The scene asks for
/// less than was reached: if it were solved again, its grid or mesh would be another.
pub(in crate::replication::stages) fn with_solved(text: &str, read: impl FnOnce(&Inputs, &Scene)) {
    let scene = Scene::parse("t", text).unwrap();
    let interrupted = AtomicBool::new(false);
    let fineness = Fineness::Within(Accuracy::Error(2.0));
    let statement = Statement { fineness, ..scene.statement.clone() };
    let study = Study::of(&[], vec![statement.clone().into()]);
    let less = Scene { statement, study, ..scene.clone() };
    let [made, other] = [&scene, &less].map(|of| made(of, &interrupted).unwrap());
    assert_ne!(made[PAIR].len(), other[PAIR].len());
    let path = "pipeline/scenes/t.toml";
    let file = InputFile::with(path.into(), text.into());
    let inputs = Inputs {
        task: "figures/t-map",
        files: &InputFiles::from([(path.to_owned(), file)]),
        artifacts: &BTreeMap::from([("solve/t".to_owned(), made)]),
        digest: "digest of inputs",
        scratch: Path::new(""),
        interrupted: &interrupted,
    };
    read(&inputs, &less);
}

/// Scenes on the square and on a mesh that ask for an accuracy and all pictures.
pub(in crate::replication::stages) const ACCURATE: [&str; 2] = [
    "title = 't'\ndomain = 'lshape'\nf = 'rect(-1,0,-1,0)=3; else=-2'\naccuracy = 0.1\n\
        outputs = ['map', 'surface', 'contact']\n",
    "title = 't'\nf = 'disc(0,0,0.2)=3; else=-1'\naccuracy = 0.1\noutputs = ['map', 'surface', 'contact']\n",
];

#[test]
fn problems_with_an_accuracy_are_read_on_the_levels_that_reached_it() {
    for text in ACCURATE {
        with_solved(text, |inputs, scene| {
            let problem = problem(inputs, scene).unwrap();
            let [nodes, _] = problem.lengths();
            assert_eq!(drawn(inputs, scene, None).unwrap().last.nodes, Some(nodes));
            assert_eq!(pair(inputs, scene, None, &problem).unwrap().y.len(), nodes);
        });
    }
}

#[test]
fn an_interrupt_ends_the_way_to_an_accuracy_between_grids_and_between_meshes() {
    for text in ACCURATE {
        let scene = Scene::parse("t", text).unwrap();
        let reason = made(&scene, &AtomicBool::new(true)).err().unwrap();
        assert!(matches!(reason.downcast_ref(), Some(Error::Interrupted)));
    }
}
