//! Times of studies, and the record of times.

use crate::common::{Project, TABLE};
use signorini::timing::recorded::{PATH, Timings};

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

#[test]
fn a_spoilt_record_is_refused_with_line_and_remedy() {
    let good = RECORD;
    assert_eq!(Timings::parse(format!("{good}{PEER}{PEER}")).unwrap().peer.len(), 2);
    for (old, new) in [("ours = 1\n", ""), ("cells", "cels"), ("ours = 1\n", "ours = \"1\"\n")] {
        let message =
            Timings::parse(format!("{good}{PEER}{}", PEER.replace(old, new))).unwrap_err();
        assert!(message.to_string().contains("[[peer]] number 2: other columns"), "{message}");
    }
    for (old, new, line, what) in [
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
