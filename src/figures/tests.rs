//! Tests that hold for every figure.

use super::samples::{committed, every, svg, unusual};
use super::*;

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
        let name = |tag: &str| tag.split_whitespace().next().unwrap_or("").to_string();
        if let Some(closing) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name(closing)));
        } else if !tag.ends_with('/') {
            open.push(name(tag));
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
    let svg = |name: &str| &figures.iter().find(|(n, _)| *n == name).unwrap().1;
    for label in ["3", "\u{2212}1.002", "\u{2212}6", "1.998"] {
        assert!(svg("figure1").contains(&format!(">{label}</text>")), "{label}");
    }
    for name in ["x", "y", "v", "\u{2212}0.5"] {
        assert!(svg("figure2").contains(&format!(">{name}</text>")));
    }
    assert!(svg("histories").contains("h = 1/4</text>"));
    assert!(svg("contact").contains(">upper left</text>"));
    for label in ["counts that come out", "all 25 counts come out", "f elsewhere", "\u{2212}1.005"]
    {
        assert!(svg("identifiability").contains(&format!(">{label}</text>")), "{label}");
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
    let before = |name: &str| svg[..svg.find(name).unwrap()].lines().rev().nth(1);
    assert!(before(">one</text>").unwrap().starts_with("<circle"), "a point without a line");
    assert!(!svg.contains(">none</text>"), "a curve without points has no name");
    assert!(svg.contains("prefers-color-scheme:dark"));
}

#[test]
fn text_is_large_enough_and_inside_the_picture() {
    for (name, svg) in every() {
        let number = |line: &str, key: &str| -> f64 {
            let start = line.find(key).unwrap() + key.len();
            line[start..].split('"').next().unwrap().parse().unwrap()
        };
        let head = svg.lines().next().unwrap();
        let (width, height) = (4.0 * number(head, " width=\""), 4.0 * number(head, " height=\""));
        assert!(width <= 4.0 * 800.0, "{name} is too wide");
        for line in svg.lines().filter(|line| line.starts_with("<text")) {
            let size = number(line, "font-size=\"");
            assert!(size >= 48.0, "{name}: {line}");
            let words = line.split_once('>').unwrap().1.trim_end_matches("</text>");
            let words = &words.replace("&gt;", ">");
            let wide = picture::text_width(words, size);
            let (x, y) = (number(line, " x=\""), number(line, " y=\""));
            let (left, right) = match () {
                () if line.contains("rotate(") => (x - size / 2.0, x + size / 2.0),
                () if line.contains("\"start\"") => (x, x + wide),
                () if line.contains("\"end\"") => (x - wide, x),
                () => (x - wide / 2.0, x + wide / 2.0),
            };
            assert!(left >= 0.0 && right <= width, "{name}: {line}");
            assert!(y - size / 2.0 >= 0.0 && y + size / 2.0 <= height, "{name}: {line}");
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let grid = Grid::new(4).unwrap();
    let mut pair = Pair { y: vec![0.0; 25], a: vec![0.0; 16] };
    let surface = |Pair { y, .. }: &Pair| {
        let in_contact = &[false; 16];
        surfaces(2, &[Surface { title: "t", grid, y, in_contact, azimuth: 0.0, range: None }])
    };
    svg(&surface(&pair));
    pair.y[4] = f64::NAN;
    let refusal = |picture: Picture| picture.svg("t", "d").unwrap_err();
    assert!(refusal(surface(&pair)).contains("not a finite number"));
    let panel = ContactPanel { title: "t", grid, lines: vec![("l".into(), pair)] };
    assert!(refusal(contact(&[panel])).contains("not a finite number"));
    let curve = |point| Curve::new(Stroke::Marked, "c", point);
    let chart = |point| charts(false, &[Chart::new("t", ["x", "y"], vec![curve(point)])]);
    assert!(refusal(chart(Some((1.0, 0.0)))).contains("not a finite number"));
    assert!(refusal(chart(None)).contains("nothing to draw"));
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

/// Writes all figures to the folder named by `SIGNORINI_FIGURES`, to be looked at.
#[test]
#[ignore = "writes files to look at"]
fn write_all() {
    let folder = std::env::var("SIGNORINI_FIGURES").expect("a folder in SIGNORINI_FIGURES");
    for (name, svg) in every() {
        std::fs::write(format!("{folder}/{name}.svg"), svg).unwrap();
    }
}
