//! Nonsense in every place where text or bytes are read: an answer or an error, never a panic.

use crate::common::{EVERYTHING, Project, assert_same, config, promised, wanting};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::TestCaseError;
use signorini::replication::scene::Scene;
use signorini_mathematics::problem::source::Source;
use std::fs;

const SCENE: &str = "title = \"t\"\npaper_table = 1\n\
    f = \"rect(-0.25,0.25,-0.25,0.25)=1.5; quadrant(ll)=-2; else=-1\"\n\
    load = { rule = \"nodal\", tie = \"lower-left\", diagonal = \"rising\" }\nprolongation = \"bilinear\"\n\
    grids = [4, 8, 16]\nr = [1e6, 10, 0.5]\nstop = [\"signed\", \"printed\"]\nmax_iterations = 100\n\
    outputs = [\"table\", \"surface\"]\ndraw_r = 10\n";

const ON_DOMAIN: &str = "title = \"t\"\nf = \"rect(-1,0,-1,0)=-6; else=1\"\n\
    domain = { name = \"disc\", refine = 3, free = [], curve = { rim = [0, 0, 1] } }\n\
    solver = \"arrow-hurwicz\"\nr = [10]\nstop = [\"signed\"]\noutputs = [\"table\", \"contact\"]\n";

/// Words that a scene is made of, and some that break it, with ¦ between them.
const WORDS: &str = "title¦f¦load¦grids¦r¦stop¦outputs¦draw_r¦max_iterations¦paper_table¦ = ¦[¦]¦{¦}¦\"¦\"\"\"¦'''¦\
    ,¦\n¦#¦-1¦0¦1e308¦-1e308¦1e-308¦nan¦inf¦-inf¦9223372036854775807¦18446744073709551615¦\
    \"table\"¦\"signed\"¦\u{0}¦\u{feff}¦\u{1f3b2}¦\r¦[[r]]¦1979-05-27¦\\u0000";

/// Parts of a right-hand side, and some that are none, with ¦ between them.
const PARTS: &str = "rect(¦disc(¦halfplane(¦quadrant(¦exact(¦formula(¦x*y¦else¦full-contact¦ll¦ur¦)¦(¦,¦=¦;¦\n¦ ¦-¦\
    0¦1¦-0.25¦0.25¦0.5¦1e-320¦1e308¦-1e308¦1e400¦nan¦inf¦quadrant(ll)=1;¦quadrant(lr)=-2;¦\
    quadrant(ul)=-3;¦quadrant(ur)=4;¦else=-1¦\u{2212}1";

/// Replaces a piece of `text`, of up to `length` characters from `at`, by `word`.
fn splice(text: &str, at: Index, length: usize, word: &str) -> String {
    let characters: Vec<char> = text.chars().collect();
    let at = at.index(characters.len() + 1);
    let end = (at + length).min(characters.len());
    characters[..at]
        .iter()
        .copied()
        .chain(word.chars())
        .chain(characters[end..].iter().copied())
        .collect()
}

/// A region with numbers that may be anything finite.
fn piece() -> impl Strategy<Value = String> {
    let number =
        prop_oneof![-1.0..1.0, select(vec![0.0, -0.0, 0.5, -0.5, 1e-300, 1e300]), any::<f64>()];
    let value = number.clone();
    (0..4, prop::collection::vec(number, 4), select(vec!["ll", "lr", "ul", "ur"]), value).prop_map(
        |(kind, n, quarter, v)| {
            let region = match kind {
                0 => format!("rect({},{},{},{})", n[0], n[1], n[2], n[3]),
                1 => format!("disc({},{},{})", n[0], n[1], n[2]),
                2 => format!("halfplane({},{},{})", n[0], n[1], n[2]),
                _ => format!("quadrant({quarter})"),
            };
            format!("{region}={v}")
        },
    )
}

/// An accepted text has one canonical spelling, which is read as the same f.
fn round_trips(text: &str) -> Result<bool, TestCaseError> {
    let Ok(f) = text.parse::<Source>() else { return Ok(false) };
    let canonical = f.to_string();
    let again = canonical.parse::<Source>();
    prop_assert_eq!(again.as_ref(), Ok(&f), "{}", canonical);
    prop_assert_eq!(again.unwrap().to_string(), canonical);
    Ok(true)
}

/// A scene is accepted or refused in one line that names it.
fn answers(text: &str) -> Result<(), TestCaseError> {
    if let Err(e) = Scene::parse("name", text) {
        let line = e.to_string();
        prop_assert!(line.starts_with("scene `name`: ") && !line.contains('\n'), "{line}");
    }
    Ok(())
}

#[test]
fn the_seed_of_the_mutations_is_a_valid_scene() {
    Scene::parse("name", SCENE).unwrap();
    Scene::parse("name", ON_DOMAIN).unwrap();
}

proptest! {
    #![proptest_config(config(4000))]

    #[test]
    fn a_mutated_scene_is_read_or_refused(
        edits in prop::collection::vec((any::<Index>(), 0..12usize, select(WORDS.split('¦').collect::<Vec<_>>())), 1..5)
    ) {
        for seed in [SCENE, ON_DOMAIN] {
            let edits = edits.clone().into_iter();
            let text = edits.fold(seed.to_owned(), |text, (at, length, word)| splice(&text, at, length, word));
            answers(&text)?;
        }
    }

    #[test]
    fn a_scene_of_random_words_is_read_or_refused(words in prop::collection::vec(select(WORDS.split('¦').collect::<Vec<_>>()), 0..30)) {
        answers(&words.concat())?;
    }

    #[test]
    fn a_text_that_is_no_f_is_refused(text in "\\PC{0,40}") {
        prop_assert!(!round_trips(&text)?, "{text}");
    }

    #[test]
    fn an_f_of_random_parts_round_trips_or_is_refused(parts in prop::collection::vec(select(PARTS.split('¦').collect::<Vec<_>>()), 1..12)) {
        round_trips(&parts.concat())?;
    }

    #[test]
    fn an_f_of_random_pieces_round_trips(pieces in prop::collection::vec(piece(), 0..5), value in -1e300..1e300f64) {
        let text = format!("{}; else={value}", pieces.join("; "));
        let why = text.parse::<Source>().map_err(|e| e.to_string()).err().unwrap_or_default();
        let known = ["is no region", "not a finite number", "are at most 1000"];
        prop_assert!(round_trips(&text)? || known.iter().any(|known| why.contains(known)), "{text}");
    }
}

proptest! {
    // Cutting several discs out of each other takes a millisecond.
    #![proptest_config(config(2000))]

    #[test]
    fn a_scene_of_random_values_is_read_or_refused(
        f in prop::collection::vec(piece(), 0..4), r in prop::collection::vec(any::<f64>(), 0..3),
        grids in prop::collection::vec(prop_oneof![0..40i64, any::<i64>()], 0..3),
        cap in any::<i64>(), draw in any::<f64>()
    ) {
        let f = f.join(";");
        answers(&format!(
            "title = \"t\"\nf = \"{f}; else=-1\"\ngrids = {grids:?}\nsolver = \"arrow-hurwicz\"\nr = {r:?}\nmax_iterations = {cap}\ndraw_r = \
             {draw:?}\noutputs = []\n"
        ))?;
    }
}

#[test]
fn random_bytes_in_the_cache_are_never_believed() {
    let project = Project::with(&wanting(EVERYTHING));
    project.run(&["run"]).lines();
    let made = project.made();
    let names: Vec<String> = project.files(".signorini/v2").into_keys().collect();
    let bytes = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..200),
        "[\\[{\"a:1,}\\]]{0,300}".prop_map(String::into_bytes),
        Just(vec![b'['; 100_000]),
        Just(
            format!("{} {{\"task\":\"\",\"inputs\":{{}},\"outputs\":{{}}}}\n", "0".repeat(64))
                .into_bytes()
        ),
    ];
    let mut runner = proptest::test_runner::TestRunner::new(config(promised(
        "Random bytes in the cache",
    ) as u32));
    let damage = prop::collection::vec((select(names), bytes), 1..6);
    runner
        .run(&damage, |damage| {
            for (name, bytes) in damage {
                fs::write(project.path(".signorini/v2").join(name), bytes).unwrap();
            }
            let said = project.run(&["status", "--json"]);
            prop_assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
            prop_assert_eq!(said.json()["stale"].as_bool(), Some(true));
            project.run(&["run"]).lines();
            assert_same(&project.made(), &made);
            Ok(())
        })
        .unwrap();
}
