//! Pictures for the tests: those of the paper's problems as committed, and odd cases drawn anew.

use super::Stroke::{Line, Marked};
use super::*;
use signorini_mathematics::discrete::grid::{Grid, nested};
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::{AnyMesh, PlaneMesh};
use signorini_mathematics::problem::law::{Law, LawNumber};
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::{Iteration, Pair};
use signorini_mathematics::statement::{Boundary, Domain, Fineness, Statement};

/// A picture under a title that needs escaping.
pub(super) fn svg(picture: &Picture) -> String {
    picture.svg("Title <1> & more", "made by `signorini run`").unwrap()
}

/// The figures of both problems; `run --locked` fails where the program draws others.
pub(super) fn committed() -> Vec<(String, String)> {
    let names = ["figure1", "figure2", "histories", "contact", "identifiability"];
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../figures");
    let mut figures = Vec::new();
    for name in names {
        let svg = std::fs::read_to_string(folder.join(format!("{name}.svg"))).unwrap();
        figures.push((name.to_owned(), svg));
    }
    figures
}

/// One panel, few nodes, other shapes of f, more curves than colours, a long run.
pub(super) fn unusual() -> Vec<(String, String)> {
    let mut figures = unusual_scenes();
    figures.extend(unusual_charts());
    figures.extend(meshes());
    figures
}

/// Statement on a mesh refined `times` times, whose hole is free if it has one.
fn on(name: &str, times: u8, f: &str) -> Statement {
    let mut statement = Statement::usual(Domain::named(name), f);
    if statement.domain.is_file() {
        statement.boundary = Boundary::default().with("hole", LawNumber::Free, 0.0);
    }
    Statement { fineness: Fineness::Refined(times), ..statement }
}

/// Solves such a statement.
fn solved(name: &str, times: u8, f: &str) -> DrawnSolution {
    let statement = on(name, times, f);
    let file = statement.domain.is_file().then(gear_file);
    let solved = statement.solved(file.as_deref()).unwrap();
    DrawnSolution::of(name.into(), &solved.problem, &solved.pair(), 2).unwrap()
}

/// Problem on one grid of the square.
pub(super) fn on_grid(grid: Grid) -> Problem {
    let f = Source::constant(-1.0);
    Problem::on_square(vec![grid], f, LoadRule::Bilinear {}, Law::SIGNORINI).unwrap()
}

/// Surface of a pair on a grid of the square.
pub(super) fn solution(title: &str, grid: Grid, pair: &Pair) -> DrawnSolution {
    DrawnSolution::on_grid(title.into(), grid, pair, 2)
}

/// Surface on a mesh under the law of Signorini.
pub(super) fn panel(mesh: &PlaneMesh, y: &[f64], in_contact: &[bool]) -> DrawnSolution {
    DrawnSolution {
        title: "t".into(),
        held: HELD[0],
        mesh: mesh.clone(),
        y: y.into(),
        in_contact: in_contact.into(),
        azimuth: -37.5,
        range: None,
    }
}

/// File with a gear.
fn gear_file() -> Vec<u8> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/meshes/gear.msh");
    std::fs::read(path).unwrap()
}

/// Meshes, and solutions on them.
fn meshes() -> Vec<(String, String)> {
    let [disc, lshape, annulus] =
        ["disc", "lshape", "annulus"].map(|name| AnyMesh::built_in(name).unwrap());
    let f_on_gear = "disc(0.5,0.3,0.4)=4; else=-1.5";
    let gear = on("gear", 1, f_on_gear).mesh(Some(&gear_file())).unwrap().unwrap();
    let drawn = [
        ("disc", solved("disc", 4, "disc(0.4,0,0.4)=5; else=-1")),
        ("lshape", solved("lshape", 4, "rect(-1,0,-1,0)=2; else=-2")),
        ("annulus", solved("annulus", 3, "halfplane(1,0,0)=1; else=-2")),
        ("gear", solved("gear", 1, f_on_gear)),
    ];
    let mut figures = Vec::new();
    for (name, one) in &drawn {
        figures.push(((*name).to_owned(), svg(&surfaces(2, std::slice::from_ref(one)))));
    }
    let coarse = [("disc", &disc), ("L-shape", &lshape), ("annulus", &annulus), ("gear", &gear)];
    let plans: Vec<_> = coarse
        .into_iter()
        .filter_map(|(name, mesh)| match mesh {
            AnyMesh::Plane(mesh) => Some((name, mesh)),
            AnyMesh::Space(_) => None,
        })
        .collect();
    figures.push(("plans".into(), svg(&mesh_picture(&plans))));
    figures
}

/// Unusual pictures of maps, solutions and iterations.
fn unusual_scenes() -> Vec<(String, String)> {
    let mut figures = Vec::new();
    let shapes =
        "disc(0.1,0.1,0.3)=1; rect(-0.5,-0.2,-0.1,0.02)=-1.5; halfplane(1,1,-0.4)=2; else=-1";
    let texts = ["else=0", "exact(full-contact)", shapes];
    let maps = texts.map(|text| (&text[..text.len().min(30)], text.parse::<Source>().unwrap()));
    figures.push(("maps".into(), svg(&maps_of_f(&maps))));
    figures.push(("map".into(), svg(&maps_of_f(&maps[2..]))));
    let grids = nested(&[4, 8]).unwrap();
    let (title, grid) = ("one", grids[1]);
    let y = (0..grid.nodes()).map(|k| 0.01 * (k % 7) as f64 - 0.02).collect();
    let a = (0..grid.boundary_nodes()).map(|b| if b < 9 { 0.3 } else { 0.0 }).collect();
    let pair = Pair { y, a };
    let surface = solution(title, grid, &pair);
    for azimuth in [0.0, 52.5, 90.0] {
        let picture = surfaces(2, &[DrawnSolution { azimuth, ..surface.clone() }]);
        figures.push((format!("view{azimuth}"), svg(&picture)));
    }
    let lines =
        ["printed", "signed", "signed, and the dual change", "projected conjugate gradients"]
            .map(|label| (label.to_owned(), pair.clone()));
    let panels = ContactPanel::of(title, &on_grid(grid), &lines).unwrap();
    figures.push(("lines".into(), svg(&contact(&panels))));
    let long: Vec<_> = (1..=30_000)
        .map(|number| {
            let size = 1.0 / number as f64;
            let gradient_signed = if number % 5000 < 900 { 0.0 } else { 0.3 * size };
            Iteration { number, gradient_signed, gradient_abs: size, delta_a: 0.0 }
        })
        .collect();
    let levels = vec![vec![long[0]; 7], long];
    let runs = (1..=9)
        .map(|k| HistoryCurve {
            label: format!("curve number {k}"),
            is_drawn: k == 1,
            levels: levels.clone(),
        })
        .collect();
    let panel = HistoryPanel { title, grids, runs };
    figures.push(("long".into(), svg(&histories(&[panel]))));
    figures
}

/// Unusual charts.
fn unusual_charts() -> Vec<(String, String)> {
    let falling: Vec<_> = (0..9).map(|k| (2f64.powi(k), 3e-3 * 4f64.powi(-k))).collect();
    let few = falling[3..6].to_vec();
    let curves = vec![
        Curve::new(Marked, "multigrid", falling.clone()),
        Curve::new(Marked, "multigrid, again", few.clone()),
        Curve::new(Line, "maximum error", few.clone()),
        Curve::new(Marked, "one", few[..1].to_vec()),
        Curve::new(Marked, "none", []),
    ];
    let panels = ["first", "second", "alone"]
        .map(|title| Chart::new(title, ["1/h", "error"], curves.clone()));
    vec![
        ("charts".into(), svg(&charts(false, &panels))),
        ("chart".into(), svg(&charts(true, &panels[..1]))),
    ]
}

pub(super) fn every() -> impl Iterator<Item = (String, String)> {
    committed().into_iter().chain(unusual())
}
