//! Tests that hold for every figure.

use super::samples::{committed, every, on_grid, panel, solution, svg, unusual};
use super::*;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::identify::Slice;
use signorini_mathematics::mesh::{MeshData, PlaneMesh};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::{Iteration, Pair};
use std::collections::BTreeMap;

/// Tags nest and close, attributes are quoted, and no `<` or bare `&` is left in text.
fn well_formed(svg: &str) {
    let mut open = Vec::new();
    let mut rest = svg;
    while let Some(start) = rest.find('<') {
        assert!(!rest[..start].contains('>'), "stray >");
        for entity in rest[..start].split('&').skip(1) {
            assert!(entity.find(';').is_some_and(|end| end <= 5), "bare &");
        }
        let end = start + rest[start..].find('>').expect("an open tag");
        let tag = &rest[start + 1..end];
        assert!(tag.matches('"').count().is_multiple_of(2) && !tag.contains('<'), "{tag}");
        if let Some(closing) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), closing.split_whitespace().next());
        } else if !tag.ends_with('/') {
            open.extend(tag.split_whitespace().next());
        }
        rest = &rest[end + 1..];
    }
    assert!(open.is_empty() && rest.trim().is_empty());
}

#[test]
fn figures_are_well_formed_labelled_and_small() {
    let figures = committed();
    for (name, svg) in &figures {
        well_formed(svg);
        assert!(svg.starts_with("<svg xmlns=") && svg.contains("role=\"img\""));
        assert!(svg.contains(">Problem 1") && svg.contains(">Problem 2"));
        assert!(!svg.contains("NaN") && !svg.contains("inf\""));
        assert!(svg.len() < 400_000, "{name} has {} bytes", svg.len());
    }
    let svg: BTreeMap<String, String> = figures.into_iter().collect();
    for label in ["3", "\u{2212}1.002", "\u{2212}6", "1.998"] {
        assert!(svg["figure1"].contains(&format!(">{label}</text>")), "{label}");
    }
    for name in ["x", "y", "v", "\u{2212}0.5"] {
        assert!(svg["figure2"].contains(&format!(">{name}</text>")));
    }
    assert!(svg["histories"].contains("h = 1/4</text>"));
    assert!(svg["contact"].contains(">upper left</text>"));
    for label in ["counts that come out", "all 25 counts come out", "f elsewhere", "\u{2212}1.005"]
    {
        assert!(svg["identifiability"].contains(&format!(">{label}</text>")), "{label}");
    }
}

#[test]
fn a_solver_has_one_colour_and_a_second_line_of_it_is_dashed() {
    let figures = unusual();
    let svg = &figures.iter().find(|(name, _)| name == "charts").unwrap().1;
    // In the legend: one stroke of the first, two of the second, in the same colour.
    let legend: Vec<_> = svg.lines().filter(|l| l.starts_with("<polyline")).take(4).collect();
    assert!(legend[..3].iter().all(|line| line.contains("#0072B2")), "{legend:?}");
    assert!(!legend[3].contains("#0072B2"), "{legend:?}");
    let (before, _) = svg.split_once(">one</text>").unwrap();
    let sample = before.lines().rev().nth(1).unwrap();
    assert!(sample.starts_with("<circle"), "a point without a line");
    assert!(!svg.contains(">none</text>"), "a curve without points has no name");
    assert!(svg.contains("prefers-color-scheme:dark"));
}

/// A line of text in a picture, in canvas pixels.
#[derive(Debug)]
struct Text {
    words: String,
    size: f64,
    across: (f64, f64),
    down: (f64, f64),
}

impl Text {
    fn overlaps(&self, other: &Self) -> bool {
        intersect(self.across, other.across) && intersect(self.down, other.down)
    }
}

fn intersect((a, b): (f64, f64), (c, d): (f64, f64)) -> bool {
    a < d && c < b
}

/// Advance widths of DejaVu Sans, a wide font that many systems take for sans-serif, in thousandths of its size;
/// letters that are not listed are narrower than the last.
fn advance(letter: char) -> f64 {
    let width = match letter {
        '0'..='9' => 636,
        ' ' | '.' | ',' | '\u{b7}' => 318,
        '\u{2212}' | '=' | '<' | '>' | '\u{2264}' | '\u{2265}' => 838,
        '\u{b9}' | '\u{b2}' | '\u{b3}' | '\u{2070}'..='\u{2079}' => 401,
        '\u{207b}' => 528,
        '/' | '|' | ':' | ';' => 337,
        'i' | 'l' | 'j' => 278,
        'f' | 't' | '(' | ')' | 'r' => 411,
        'm' => 974,
        'w' | 'M' => 863,
        _ => 640,
    };
    f64::from(width) / 1000.0
}

/// Returns the size of the canvas, and every text with its extent in a wide font.
fn texts(svg: &str) -> ((f64, f64), Vec<Text>) {
    let head = svg.lines().next().unwrap();
    let canvas = (4.0 * attribute(head, " width=\""), 4.0 * attribute(head, " height=\""));
    (canvas, svg.lines().filter(|line| line.starts_with("<text")).map(text).collect())
}

/// Returns the number in the attribute that begins with `key`.
fn attribute(line: &str, key: &str) -> f64 {
    let start = line.find(key).unwrap() + key.len();
    line[start..].split('"').next().unwrap().parse().unwrap()
}

fn text(line: &str) -> Text {
    let size = attribute(line, "font-size=\"");
    let words = line.split_once('>').unwrap().1.trim_end_matches("</text>");
    let words = words.replace("&gt;", ">").replace("&lt;", "<").replace("&amp;", "&");
    let wide = size * words.chars().map(advance).sum::<f64>();
    let (x, y) = (attribute(line, " x=\""), attribute(line, " y=\""));
    let (left, right) = match () {
        () if line.contains("\"start\"") => (x, x + wide),
        () if line.contains("\"end\"") => (x - wide, x),
        () => (x - wide / 2.0, x + wide / 2.0),
    };
    let (across, down) = match line.contains("rotate(") {
        true => ((x - size / 2.0, x + size / 2.0), (y - wide / 2.0, y + wide / 2.0)),
        false => ((left, right), (y - 0.4 * size, y + 0.4 * size)),
    };
    Text { words, size, across, down }
}

#[test]
fn text_is_large_enough_and_inside_the_picture() {
    for (name, svg) in every() {
        let ((width, height), texts) = texts(&svg);
        assert!(width <= 4.0 * 800.0, "{name} is too wide");
        for text in texts {
            assert!(text.size >= 48.0, "{name}: {text:?}");
            assert!(text.across.0 >= 0.0 && text.across.1 <= width, "{name}: {text:?}");
            assert!(text.down.0 >= 0.0 && text.down.1 <= height, "{name}: {text:?}");
        }
    }
}

/// The pictures of one scene whose f, v and multiplier reach from `low` to `high`.
fn scaled(low: f64, high: f64) -> [(&'static str, Picture); 5] {
    let f: Source =
        format!("rect(-0.25,0.25,-0.25,0.25)={high:?}; disc(0.4,0.4,0.04)={high:?}; else={low:?}")
            .parse()
            .unwrap();
    let grids = signorini_mathematics::discrete::grid::nested(&[4, 8]).unwrap();
    let grid = grids[1];
    let y: Vec<f64> =
        (0..grid.nodes()).map(|k| low + (high - low) * (k % 7) as f64 / 6.0).collect();
    let a = (0..grid.boundary_nodes()).map(|b| if b < 9 { high.abs() } else { 0.0 }).collect();
    let pair = Pair { y, a };
    let drawn = solution("t", grid, &pair);
    let [front, lower_left, lower_right, upper_right] =
        [0.0, -37.5, 52.5, 142.5].map(|azimuth| DrawnSolution { azimuth, ..drawn.clone() });
    let panels = ContactPanel::of("t", &on_grid(grid), &[("l".into(), pair.clone())]).unwrap();
    let finest = (1..=2_000_000).step_by(1000).map(|number| iteration(number, high.abs()));
    let levels = vec![vec![iteration(1, high.abs())], finest.collect()];
    let run = HistoryCurve { label: "r".into(), is_drawn: true, levels };
    let history = HistoryPanel { title: "t", grids, runs: vec![run] };
    [
        ("source", maps_of_f(&[("t", f.clone()), ("u", f)])),
        ("surface", surfaces(2, &[front])),
        ("surfaces", surfaces(3, &[lower_left, lower_right, upper_right])),
        ("contact", contact(&panels)),
        ("history", histories(&[history])),
    ]
}

/// Iteration whose residuals and Delta a are `first` over its number.
fn iteration(number: usize, first: f64) -> Iteration {
    let size = first / number as f64;
    Iteration { number, gradient_signed: size, gradient_abs: size, delta_a: size }
}

/// Returns the texts of a picture, none of which meets another one or leaves the picture.
fn readable(name: &str, picture: &Picture) -> Vec<Text> {
    let ((width, height), texts) = texts(&svg(picture));
    for (k, text) in texts.iter().enumerate() {
        let other = texts[..k].iter().find(|other| text.overlaps(other));
        let inside = text.across.0 >= 0.0
            && text.across.1 <= width
            && text.down.0 >= 0.0
            && text.down.1 <= height;
        assert!(
            inside && other.is_none(),
            "{name}: {text:?} leaves the picture or meets {other:?}"
        );
    }
    texts
}

/// Two triangles between opposite corners.
fn rectangle([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> PlaneMesh {
    let points = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    let cells = vec![[0, 1, 2], [0, 2, 3]];
    MeshData { points, cells, ..MeshData::default() }.mesh().unwrap()
}

/// Title of several lines.
const LONG: &str = "A plate with a hole, pushed up in the middle and held everywhere else, as in the book\n\
    error at most 4.31 %";

#[test]
fn coordinates_of_any_size_neither_overlap_nor_run_out() {
    for size in [1e-12, 1e-3, 0.3333, 1.0, 12_345.678, 1e6, 2.5e9] {
        for (wide, high) in [(1.0, 1.0), (1.0, 0.1), (0.01, 1.0)] {
            for shift in [-0.5, 0.0, 3.0] {
                let low = [shift * size, -shift * size];
                let mesh = &rectangle(low, [low[0] + wide * size, low[1] + high * size]);
                let one = panel(mesh, &[0.0, 1.0, 0.3, 0.0], &[true; 4]);
                let panels =
                    [-37.5, 52.5, 142.5].map(|azimuth| DrawnSolution { azimuth, ..one.clone() });
                let name = format!("{wide} x {high} times {size:e} at {shift}");
                readable(&name, &surfaces(2, &panels[..1]));
                readable(&name, &surfaces(3, &panels));
                readable(&name, &mesh_picture(&[("t", mesh), ("u", mesh)]));
                readable(&name, &maps::mesh_map(LONG, mesh, &[1.0, -2.0]));
                let long = DrawnSolution { title: LONG.into(), ..one };
                let map = readable(&name, &surfaces(2, &[long]));
                assert!(map.iter().any(|text| text.words == "error at most 4.31 %"), "{map:?}");
            }
        }
    }
}

#[test]
fn numbers_of_maps_far_from_the_origin_are_inside_the_picture() {
    for shift in [-7_654_321.3, 12_345.6, 1e9] {
        for (wide, high) in [(1.0, 1.0), (1.0, 0.1), (0.01, 1.0)] {
            let mesh = &rectangle([shift, -shift], [shift + wide, high - shift]);
            readable(&format!("map at {shift}"), &maps::mesh_map("far", mesh, &[1.0, -2.0]));
        }
    }
}

#[test]
fn words_of_fixed_parts_are_inside_the_picture() {
    let mut mesh = rectangle([0.0, 0.0], [1.0, 1.0]);
    mesh.parts_mut()[0].law = Law::FIXED;
    for held in HELD {
        let one = panel(&mesh, &[0.0, 1.0, 0.3, 0.0], &[true; 4]);
        let panel = DrawnSolution { title: LONG.into(), held, azimuth: 0.0, ..one };
        let texts = readable("fixed", &surfaces(2, &[panel]));
        assert!(texts.iter().any(|text| text.words == FIXED[0]), "{texts:?}");
    }
}

#[test]
fn numbers_of_any_size_neither_overlap_nor_run_out() {
    let sizes =
        [1e-300, 6e-302, 1e-5, 0.3, 12_345.678, 999_999.0, 1e6, 2.5e9, 123_456_789.0, 1e150, 8e300];
    let mut ranges: Vec<(f64, f64)> = sizes.iter().map(|&size| (-size, 1.5 * size)).collect();
    ranges.extend(sizes.map(|size| (-1.3 * size, 0.2 * size)));
    ranges.extend([(-1e9, 1.0), (-1.0, 1e9), (-3e-9, 7e6), (-1e150, 1e6), (-999_999.5, 1e6)]);
    for (low, high) in ranges {
        for (kind, picture) in scaled(low, high) {
            let texts = readable(&format!("{kind} of {low:e} to {high:e}"), &picture);
            // At least two numbers beside a colour bar or an axis of values.
            let powers = texts.iter().filter(|text| text.words.contains("\u{b7}10")).count();
            assert!(kind == "history" || high < 1e6 || powers >= 2, "{kind} {low:e} {high:e}");
        }
    }
}

#[test]
fn values_are_written_inside_their_regions() {
    for value in [-6.0, 123_456.789, 1e6, 1e9, 2.5e9, 1e150] {
        let f: Source =
            format!("rect(-0.25,0.25,-0.25,0.25)={value:?}; else={:?}", -value).parse().unwrap();
        let drawn = svg(&maps_of_f(&[("t", f)]));
        let label = text::short(value);
        let (_, texts) = texts(&drawn);
        // Half of the side of the panel, in canvas pixels.
        let text = texts.iter().find(|text| text.words == label && text.size > 12.0 * 4.0);
        let text = text.unwrap_or_else(|| panic!("{value}"));
        assert!(text.across.1 - text.across.0 < 0.5 * 288.0 * 4.0, "{text:?}");
    }
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let grid = Grid::new(4).unwrap();
    let mut pair = Pair { y: vec![0.0; 25], a: vec![0.0; 16] };
    svg(&surface(grid, &pair));
    pair.y[4] = f64::NAN;
    assert!(refusal(&surface(grid, &pair)).contains("not a finite number"));
    let panels = ContactPanel::of("t", &on_grid(grid), &[("l".into(), pair)]).unwrap();
    assert!(refusal(&contact(&panels)).contains("not a finite number"));
    assert!(refusal(&chart(Some((1.0, 0.0)))).contains("not a finite number"));
    assert!(refusal(&chart(None)).contains("nothing to draw"));
}

fn refusal(picture: &Picture) -> &'static str {
    picture.svg("t", "d").unwrap_err()
}

fn surface(grid: Grid, pair: &Pair) -> Picture {
    surfaces(2, &[DrawnSolution { azimuth: 0.0, ..solution("t", grid, pair) }])
}

/// Chart of one curve with at most one point.
fn chart(point: Option<(f64, f64)>) -> Picture {
    let curve = Curve::new(Stroke::Marked, "c", point);
    charts(false, &[Chart::new("t", ["x", "y"], vec![curve])])
}

#[test]
fn a_single_point_is_a_map() {
    let slice = Slice { pieces: [0, 1], x: vec![1.0], y: vec![0.0], exact: vec![vec![3]] };
    let panel = IdentifiabilityPanel { title: "t", slice: &slice, cells: 3, others: Vec::new() };
    svg(&identifiability(&[panel]));
}

#[test]
fn unusual_pictures_are_drawn_too() {
    for (name, svg) in unusual() {
        well_formed(&svg);
        assert!(svg.contains("<title>Title &lt;1&gt; &amp; more</title>"));
        assert!(svg.contains("<desc>made by `signorini run`</desc>"));
        assert!(svg.len() < 400_000, "{name} has {} bytes", svg.len());
    }
}
