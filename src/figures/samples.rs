//! Pictures for the tests: every figure of the paper's two problems, and odd cases.

use super::*;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::transfer::Prolongation;
use crate::experiments::rounding::{Cell, Row, Table};
use crate::problem::source::Source;
use crate::saddle::{Monitor, Pair, Params, solve_nested};
use std::ops::ControlFlow;

const SOURCES: [&str; 2] = ["quadrant(ll)=3; else=-1.002", "quadrant(ll)=-6; else=1.998"];
pub(super) const CAPTION: Caption =
    Caption { title: "Title <1> & more", description: "made by `signorini run`" };

struct Record(Vec<Vec<Iteration>>);

impl Monitor for Record {
    fn wants_iterations(&self) -> bool {
        true
    }

    fn iteration(&mut self, level: usize, iteration: &Iteration) -> ControlFlow<()> {
        self.0[level - 1].push(*iteration);
        ControlFlow::Continue(())
    }
}

/// Grids, iterations on each, and the last pair.
type Solved = (Vec<Grid>, Vec<Vec<Iteration>>, Pair);

fn solved(f: &str, r: f64, finest: usize) -> Solved {
    let f: Source = f.parse().unwrap();
    let cells: Vec<_> = [4, 8, 16, 32, 64].into_iter().filter(|&n| n <= finest).collect();
    let grids = crate::discrete::grid::nested(&cells).unwrap();
    let loads: Vec<_> = grids.iter().map(|&g| load(g, &f, LoadRule::default())).collect();
    let mut record = Record(vec![Vec::new(); grids.len()]);
    let params = Params { r, ..Params::default() };
    let (_, pair) = solve_nested(&grids, &loads, &params, Prolongation::Bilinear, &mut record);
    let levels = record.0;
    (grids, levels, pair)
}

/// Every figure, of both problems.
pub(super) fn all() -> Vec<(&'static str, String)> {
    let titles = ["a) problem 1", "b) problem 2"];
    let fs = SOURCES.map(|text| text.parse::<Source>().unwrap());
    let maps: Vec<_> = titles.into_iter().zip(&fs).collect();
    let runs = SOURCES.map(|f| [1e6, 10.0, 5.0, 1.0, 0.5].map(|r| solved(f, r, 64)));
    let labels = ["r = 10\u{2076}", "r = 10", "r = 5", "r = 1", "r = 0.5"];
    let grid = Grid::new(64).unwrap();
    let shapes = [0, 1].map(|k| {
        let Pair { y, a } = &runs[k][1].2;
        Surface { title: titles[k], grid, y, a, view: View::uphill(grid, y), range: None }
    });
    let histories_of = [0, 1].map(|k| {
        let curves = runs[k].iter().zip(labels);
        let curve =
            |(run, label): (&Solved, &str)| History { label: label.into(), levels: run.1.clone() };
        HistoryPanel { title: titles[k], grids: &runs[k][0].0, curves: curves.map(curve).collect() }
    });
    let contacts = [0, 1].map(|k| {
        let lines = runs[k].iter().zip(labels).map(|(run, label)| (label.into(), run.2.clone()));
        ContactPanel { title: titles[k], grid, lines: lines.collect() }
    });
    let slices = [(3.0, -1.002), (-6.0, 1.998)].map(slice_around);
    let others = vec![[2.99, -1.0], [-6.0, 2.0]];
    let around = [0, 1].map(|k| IdentifiabilityPanel {
        title: titles[k],
        slice: &slices[k],
        cells: 25,
        others: others.clone(),
    });
    vec![
        ("figure1", maps_of_f(CAPTION, &maps).unwrap().svg),
        ("figure2", surfaces(CAPTION, 2, &shapes).unwrap().svg),
        ("histories", histories(CAPTION, &histories_of).unwrap().svg),
        ("contact", contact(CAPTION, &contacts).unwrap().svg),
        ("identifiability", identifiability(CAPTION, &around).unwrap().svg),
    ]
}

/// A map like those of the paper's problems: all counts come out on a band.
fn slice_around((x0, y0): (f64, f64)) -> Slice {
    let axis = |middle: f64, reach: f64| -> Vec<f64> {
        (-16..=16).map(|k| middle + reach * f64::from(k) / 16.0).collect()
    };
    let (x, y) = (axis(x0, 0.03), axis(y0, 0.012));
    let count = |x: f64, y: f64| {
        let off = ((x - x0) + 3.0 * (y - y0)).abs();
        25 - ((400.0 * off) as usize).min(11)
    };
    let exact = y.iter().map(|&y| x.iter().map(|&x| count(x, y)).collect()).collect();
    Slice { pieces: [0, 1], x, y, exact }
}

/// One panel, few nodes, other shapes of f, more curves than colours, a long run.
pub(super) fn unusual() -> Vec<(String, String)> {
    let mut figures = unusual_scenes();
    figures.extend(unusual_charts());
    figures
}

/// Those of maps, solutions and iterations.
fn unusual_scenes() -> Vec<(String, String)> {
    let mut figures = Vec::new();
    let shapes =
        "disc(0.1,0.1,0.3)=1; rect(-0.5,-0.2,-0.1,0.02)=-1.5; halfplane(1,1,-0.4)=2; else=-1";
    let texts = ["else=0", "exact(full-contact)", shapes];
    let fs = texts.map(|text| text.parse::<Source>().unwrap());
    let maps: Vec<_> =
        texts.iter().zip(&fs).map(|(title, f)| (&title[..title.len().min(30)], f)).collect();
    figures.push(("maps".into(), maps_of_f(CAPTION, &maps).unwrap().svg));
    figures.push(("map".into(), maps_of_f(CAPTION, &maps[2..]).unwrap().svg));
    let (grids, _, pair) = solved(SOURCES[0], 10.0, 8);
    let (title, grid, y, a) = ("one", grids[1], &pair.y, &pair.a);
    for azimuth in [0.0, 52.5, 90.0] {
        let view = View { azimuth, ..View::default() };
        let panel = Surface { title, grid, y, a, view, range: None };
        figures.push((format!("view{azimuth}"), surfaces(CAPTION, 2, &[panel]).unwrap().svg));
    }
    let lines =
        ["printed", "signed", "signed, and the dual change", "projected conjugate gradients"]
            .map(|label| (label.into(), pair.clone()));
    let panel = ContactPanel { title, grid, lines: lines.into() };
    figures.push(("lines".into(), contact(CAPTION, &[panel]).unwrap().svg));
    let long: Vec<_> = (1..=30_000)
        .map(|number| {
            let size = 1.0 / number as f64;
            let gradient_signed = if number % 5000 < 900 { 0.0 } else { 0.3 * size };
            Iteration { number, gradient_signed, gradient_abs: size, delta_a: 0.0 }
        })
        .collect();
    let levels = vec![vec![long[0]; 7], long];
    let curve = |k| History { label: format!("curve number {k}"), levels: levels.clone() };
    let panel = HistoryPanel { title, grids: &grids, curves: (1..=9).map(curve).collect() };
    figures.push(("long".into(), histories(CAPTION, &[panel]).unwrap().svg));
    figures
}

/// Those of numbers.
fn unusual_charts() -> Vec<(String, String)> {
    let falling: Vec<_> = (0..9).map(|k| (2f64.powi(k), 3e-3 * 4f64.powi(-k))).collect();
    let slope = [(1.0, 1e-2), (256.0, 1e-2 / 65536.0)];
    let few = || falling[3..6].iter().copied();
    let curves = vec![
        Curve::marked("multigrid", falling.clone()),
        Curve::marked("multigrid, again", few()),
        Curve::line("maximum error", few()),
        Curve::marked("one", few().take(1)),
        Curve::marked("none", []),
        Curve::reference("order 2", slope),
    ];
    let panels = ["first", "second", "alone"]
        .map(|title| Chart::new(title, ["1/h", "error"], curves.clone()));
    let cells = |size: f64| {
        let cell = |count, flips_at| Cell { count, flips_at, ..Cell::default() };
        vec![cell(1, None), cell(1234, Some(size)), cell(56, Some(1e-8))]
    };
    let row = |(r, size)| Row { r, cells: cells(size) };
    let rows = [(10.0, 1e-15), (5.0, 1e-6), (0.5, 1e-2)].map(row).into();
    let table = Table { number: 1, grids: vec![4, 8, 16], rows, changed: Vec::new() };
    let sizes: Vec<_> = (2..=15).rev().map(|k| libm::pow(10.0, -f64::from(k))).collect();
    vec![
        ("fragility".into(), fragility(CAPTION, &sizes, &[table.clone(), table]).unwrap().svg),
        ("charts".into(), charts(CAPTION, 2, false, &panels).unwrap().svg),
        ("chart".into(), charts(CAPTION, 1, true, &panels[..1]).unwrap().svg),
    ]
}

/// All of them, by name.
pub(super) fn every() -> impl Iterator<Item = (String, String)> {
    let usual = all().into_iter().map(|(name, svg)| (name.to_string(), svg));
    usual.chain(unusual())
}
