//! Times of studies, and the record of times.

use crate::common::{Project, TABLE};
use signorini::timing::recorded::{PATH, Timings, number, text};

#[test]
fn members_of_a_study_are_timed() {
    let project = Project::with(TABLE);
    let scene = "title = \"t\"\nf = \"exact(torsion)\"\nvary = { h = [8, 16], solver = [\"multigrid\", \"spectral\"] }\n\
        columns = [\"h\", \"solver\", \"error_l2\"]\noutputs = [\"table\"]\n";
    project.scene("few", scene);
    let csv = project.path("times.csv").display().to_string();
    let said = project.run(&["bench", "few", "--repeats", "1", "--json", "--csv", &csv]);
    assert_eq!(said.code, Some(0), "{said:?}");
    let json = said.json();
    assert_eq!(json["machine"]["repeats"], 1);
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    for row in rows {
        // f is no polynomial on pieces for the spectral solver, or it is: a time goes with a solution.
        assert_eq!(row["seconds"].as_f64() > Some(0.0), row["energy"].is_number(), "{row}");
    }
    assert!(rows[0]["seconds"].as_f64() > Some(0.0) && rows[0]["error_l2"].is_number());
    let table = std::fs::read_to_string(csv).unwrap();
    assert!(table.lines().next().unwrap().ends_with(",seconds,spread"), "{table}");
    assert_eq!(table.lines().count(), 5);
}

const RECORD: &str = "schema = 1\ndate = \"d\"\nbandwidth = 20\n[machine]\ncpu = \"c\"\n\
    cores = 2\ncaches = \"\"\nos = \"o\"\nrustc = \"r\"\nload = 0.1\nrepeats = 9\n";
const PEER: &str = "[[peer]]\nsolver = \"other\"\nf = \"else=-1\"\ncells = 8\ntheirs = 1\n\
    their_kkt = 1e-9\nours = 1\nour_kkt = 1e-9\n";
const OWN_MESH: &str = "[[own_mesh]]\nmesh = \"disc\"\nnodes = 9\nsolver = \"other\"\ntheirs = 8\n\
    their_kkt = 1e-9\nours = 2\nour_kkt = 1e-12\n";
const ADAPTED: &str = "[[adapted]]\nproblem = \"L-shape\"\nway = \"adaptive\"\nnodes = 40\n\
    error = 0.3\nseconds = 1e-3\n";

#[test]
fn a_spoilt_record_is_refused_with_line_and_remedy() {
    let good = RECORD;
    assert!(Timings::parse(good).is_ok());
    let more = Timings::parse(format!("{good}{PEER}{OWN_MESH}{ADAPTED}")).unwrap();
    assert_eq!([more.peer.len(), more.own_mesh.len(), more.adapted.len()], [1; 3]);
    assert_eq!(number(&more.own_mesh[0], "theirs"), 8.0);
    assert_eq!(text(&more.adapted[0], "way"), "adaptive");
    for (record, old, new, what) in [
        (OWN_MESH, "ours = 2", "ours = 0", "not a positive number"),
        (ADAPTED, "adaptive", "other", "unknown variant"),
        (ADAPTED, "nodes = 40", "nodes = 40.5", "not a natural number"),
        (PEER, "ours = 1\n", "", "missing field `ours`"),
        (PEER, "ours = 1\n", "ours = 1\nfaster = true\n", "unknown field `faster`"),
    ] {
        let message = Timings::parse(format!("{good}{}", record.replace(old, new))).unwrap_err();
        assert!(message.to_string().contains(what), "{message}");
    }
    for (old, new, line, what) in [
        ("bandwidth = 20", "bandwidth = -1", 3, "not a positive number"),
        ("bandwidth = 20", "bandwidth = nan", 3, "not a positive number"),
        ("cores = 2", "cores = \"two\"", 6, "invalid type"),
        ("load = 0.1", "lord = 0.1", 10, "unknown field"),
    ] {
        let message = Timings::parse(good.replace(old, new)).unwrap_err().to_string();
        assert!(message.starts_with(&format!("{PATH}: line {line}: ")), "{message}");
        assert!(message.contains(what) && message.contains("restore the file"), "{message}");
    }
    let message = Timings::parse(good.replace("schema = 1", "schema = 2")).unwrap_err();
    assert!(message.to_string().contains("schema 2"), "{message}");
    let message = Timings::parse(b"schema = 1 # \xff").unwrap_err();
    assert!(message.to_string().contains("save it as UTF-8"), "{message}");
}
