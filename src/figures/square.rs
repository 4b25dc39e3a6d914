//! Drawings of the problem and of the grid, which show no result: the square with its membrane, and the coarsest grid
//! with the order of the sweep.

use super::axes::Frame;
use super::palette::{CONTACT, INK, series};
use super::picture::{LARGE, NORMAL, Picture, Place, SMALL, START, bold, italic, plain};
use signorini_mathematics::discrete::grid::Grid;

/// Side of the square in display pixels.
const SIDE: f64 = 260.0;
/// Free space around the square.
const MARGIN: f64 = 60.0;
/// Width of the column of explanations.
const WORDS: f64 = 330.0;
/// Cells per side of the grid drawn: those of the paper's coarsest grid.
const CELLS: usize = 4;

/// Draws the square with sources inside, and a boundary whose upper and right sides are shut: fluid enters elsewhere.
pub(crate) fn membrane() -> Picture {
    let (mut picture, frame) = square();
    let [lower_left, lower_right] = [-0.5, 0.5].map(|x| frame.at(x, -0.5));
    let [upper_left, upper_right] = [-0.5, 0.5].map(|x| frame.at(x, 0.5));
    picture.path([upper_left, lower_left, lower_right], CONTACT, 3.0);
    picture.group("stroke-dasharray=\"14 10\"", |picture| {
        picture.path([upper_left, upper_right, lower_right], INK, 2.0);
    });
    for k in 0..5 {
        let along = -0.4 + 0.2 * f64::from(k);
        arrow(&mut picture, frame.at(-0.5, along), (1.0, 0.0));
        arrow(&mut picture, frame.at(along, -0.5), (0.0, -1.0));
    }
    let (x, y) = frame.middle();
    picture.text("−Δv = f", (x, y), italic(NORMAL));
    picture.text("Ω", frame.at(0.42, 0.42), italic(NORMAL));
    let entries = [
        ("red: in contact", "v = 0, fluid enters: ∂v/∂n ≥ 0"),
        ("dashed: not in contact", "v > 0, nothing passes: ∂v/∂n = 0"),
    ];
    explain(&mut picture, &frame, &entries);
    picture
}

/// Draws the coarsest grid with its triangles, its boundary nodes, and the numbers of the nodes in the order of the
/// sweep.
pub(crate) fn grid() -> Picture {
    let grid = Grid::new(CELLS).expect("fine enough");
    let (mut picture, frame) = square();
    picture.text("h = 1/4", (frame.middle().0, MARGIN - 22.0), bold(LARGE));
    let lines: Vec<f64> = (0..=CELLS).map(|k| grid.coordinate(k)).collect();
    for &line in &lines {
        picture.path([frame.at(line, -0.5), frame.at(line, 0.5)], INK, 0.6);
        picture.path([frame.at(-0.5, line), frame.at(0.5, line)], INK, 0.6);
    }
    for y in lines.windows(2) {
        for x in lines.windows(2) {
            picture.path([frame.at(x[0], y[0]), frame.at(x[1], y[1])], INK, 0.6);
        }
    }
    for j in 0..=CELLS {
        for i in 0..=CELLS {
            let place = frame.at(lines[i], lines[j]);
            let outermost = [0, CELLS];
            let boundary = outermost.contains(&i) || outermost.contains(&j);
            let color = if boundary { CONTACT } else { INK };
            picture.ring(place, 4.0, color);
            let number = (grid.index(i, j) + 1).to_string();
            picture.text(&number, (place.0 + 7.0, place.1 + 9.0), plain(SMALL).pos(START));
        }
    }
    let entries = [
        ("1, 2, 3, …", "order of the sweep"),
        ("red rings", "boundary nodes, I: each has a multiplier"),
        ("rising diagonals", "two triangles meet in nodes 1 and 25"),
        ("x = 0, y = 0", "a node there has the f to its left and below"),
    ];
    explain(&mut picture, &frame, &entries);
    picture
}

/// Returns an empty picture with room for the square and for explanations on its right.
fn square() -> (Picture, Frame) {
    let picture = Picture::new(MARGIN + SIDE + WORDS + 60.0, SIDE + 2.0 * MARGIN);
    let (across, down) = ((MARGIN, MARGIN + SIDE), (MARGIN, MARGIN + SIDE));
    (picture, Frame { across, down, x: (-0.5, 0.5), y: (-0.5, 0.5) })
}

/// Draws an arrow along an axis of the picture, whose head is a little beyond a place in this direction.
fn arrow(picture: &mut Picture, (x, y): Place, (dx, dy): Place) {
    let [from, base, tip] = [-34.0, -3.0, 6.0].map(|along| (x + along * dx, y + along * dy));
    let [left, right] = [4.0, -4.0].map(|side| (base.0 - side * dy, base.1 + side * dx));
    picture.path([from, base], series(0), 1.5);
    picture.polygon([left, tip, right], series(0));
}

/// Writes explanations below each other beside the square, each in two lines: what is drawn, and what it means.
fn explain(picture: &mut Picture, frame: &Frame, entries: &[(&str, &str)]) {
    let (left, mut y) = (frame.across.1 + 40.0, frame.down.0 + 20.0);
    for (drawn, meaning) in entries {
        picture.text(drawn, (left, y), italic(NORMAL).pos(START));
        picture.text(meaning, (left, y + 18.0), plain(NORMAL).pos(START));
        y += 54.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::palette::RGBColor;

    #[test]
    fn nodes_are_numbered_in_the_order_of_the_sweep_and_those_of_the_boundary_have_its_colour() {
        let svg = grid().svg("t", "d").unwrap();
        let texts = svg.split("</text>").filter_map(|text| text.rsplit('>').next());
        let numbers: Vec<usize> = texts.filter_map(|text| text.trim().parse().ok()).collect();
        assert_eq!(numbers, (1..=25).collect::<Vec<_>>());
        let RGBColor(r, g, b) = CONTACT;
        assert_eq!(svg.matches(&format!("r=\"16\" fill=\"#{r:02X}{g:02X}{b:02X}\"")).count(), 16);
    }

    #[test]
    fn fluid_enters_on_two_sides() {
        let svg = membrane().svg("t", "d").unwrap();
        assert_eq!(svg.matches("<path").count(), 10, "{svg}");
    }
}
