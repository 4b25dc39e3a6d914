//! Maps of solutions and surfaces from `solve` and from scenes: what they show, their words and titles, what is
//! refused.

use crate::common::{Project, TABLE};
use serde_json::Value;

/// Mark of a map: regions between isolines.
const BANDS: &str = "fill-rule=\"evenodd\"";
/// Stroke of the part of the boundary that is held.
const HELD: &str = "stroke=\"#D52B00\"";
/// Stroke of the boundary, four pixels of the canvas wide.
const BOUNDARY: &str = "stroke=\"#222222\" stroke-width=\"4\" points=\"";

fn gear() -> String {
    format!("{}/pipeline/meshes/gear.msh", env!("CARGO_MANIFEST_DIR"))
}

/// Answer of `solve` with these arguments, and the picture that it wrote.
fn solved(project: &Project, args: &[&str]) -> (Value, String) {
    let all = [&["solve", "--json", "--out", "v.svg"], args].concat();
    let answer = project.run(&all).json();
    (answer, project.read("v.svg"))
}

/// Length of the lines of a picture that have this mark, in pixels of its canvas.
fn length<'a>(lines: impl Iterator<Item = &'a str>) -> f64 {
    let mut sum = 0.0;
    for line in lines {
        let points = line.split_once("points=\"").unwrap().1.split('"').next().unwrap();
        let points: Vec<[f64; 2]> = points
            .split_whitespace()
            .map(|point| {
                let (x, y) = point.split_once(',').unwrap();
                [x.parse().unwrap(), y.parse().unwrap()]
            })
            .collect();
        let edges = points.windows(2);
        sum += edges.map(|e| (e[1][0] - e[0][0]).hypot(e[1][1] - e[0][1])).sum::<f64>();
    }
    sum
}

/// True for a line of the picture with this mark.
fn is_line(line: &str, mark: &str) -> bool {
    line.starts_with("<polyline") && line.contains(mark)
}

/// Lines that the map draws on the boundary where v is held; the last line of this colour is that of the legend.
fn held(svg: &str) -> Vec<&str> {
    let mut held: Vec<&str> = svg.lines().filter(|line| is_line(line, HELD)).collect();
    held.pop();
    held
}

/// Length of the boundary; frames and ticks, whose strokes are as wide, are drawn after it.
fn boundary(svg: &str, curves: usize) -> f64 {
    length(svg.lines().filter(|line| is_line(line, BOUNDARY)).take(curves))
}

#[test]
fn every_domain_in_the_plane_has_a_map_with_contact_where_the_answer_says_it() {
    let project = Project::with(TABLE);
    let path = gear();
    for (domain, curves, f) in [
        ("square", 1, "disc(0.1,0.1,0.25)=5; else=-1.5"),
        ("disc", 1, "disc(0.4,0,0.4)=5; else=-1"),
        ("lshape", 1, "rect(-1,0,-1,0)=3; else=-2"),
        ("annulus", 2, "halfplane(1,0,0)=1; else=-2"),
        (&path, 2, "disc(0.5,0.3,0.4)=4; else=-1.5"),
    ] {
        let (answer, svg) = solved(&project, &["--domain", domain, "--f", f, "--map"]);
        assert!(svg.ends_with("</svg>\n") && svg.contains(BANDS), "{domain}");
        let isolines = svg.split(BANDS).nth(1).unwrap().split("</g>").next().unwrap();
        assert!(isolines.matches("<path").count() > 4, "{domain}");
        let drawn = length(held(&svg).into_iter()) / boundary(&svg, curves);
        let count = |name: &str| answer["contact_nodes"][name].as_f64().unwrap();
        let share = count("nodes") / count("boundary_nodes");
        // Nodes are not equally far apart on every curve.
        assert!((drawn - share).abs() < 0.06, "{domain}: {drawn} drawn, {share} in contact");
        assert!(share > 0.05 && share < 0.95, "{domain}: {share}");
    }
    let all = ["--f", "else=-1", "--h", "1/16", "--map"];
    let (_, svg) = solved(&project, &all);
    assert!((length(held(&svg).into_iter()) / boundary(&svg, 1) - 1.0).abs() < 1e-3);
    // Nothing is held where the whole boundary is free or slips.
    let slips = ["--f", "disc(0,0,0.3)=2; else=-0.2", "--friction", "0.2", "--map"];
    let (answer, svg) = solved(&project, &slips);
    let sticks = answer["states"]["sticks"].as_u64().unwrap();
    assert_eq!(sticks == 0, held(&svg).is_empty(), "{sticks}");
}

#[test]
fn a_picture_is_titled_by_f_or_the_name_of_the_file_or_the_scene() {
    let project = Project::with(TABLE);
    let f = "disc(0,0,0.2)=1; else=-1";
    let titled = |args: &[&str], title: &str| {
        let (_, svg) = solved(&project, args);
        assert!(svg.contains(&format!("<title>{title}</title>")), "{args:?}");
        assert!(svg.contains(&format!(">{title}</text>")), "{args:?}");
        assert!(!svg.contains("custom"));
        svg
    };
    assert!(!titled(&["--f", f, "--h", "1/8"], f).contains(BANDS));
    assert!(titled(&["--f", f, "--domain", "disc"], f).contains(BANDS));
    let path = gear();
    assert!(titled(&["--f", "else=-1", "--domain", &path], "gear.msh").contains(BANDS));
    titled(&["a"], "Suction");
}
