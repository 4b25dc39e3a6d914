//! The boundary unrolled: solution, multiplier and contact along the four sides.

use super::axes::{Frame, LEGEND_ROW, Legend, key};
use super::palette::{INK, MUTED, SHADE, series};
use super::picture::{END, LARGE, NORMAL, Picture, SMALL, START, WIDTH, bold, italic, plain};
use super::table::of_contact;
use super::text::Ticks;
use super::{ContactPanel, range_with_zero};

/// Left and right end of the plots; long numbers move the left one.
const ACROSS: (f64, f64) = (82.0, 780.0);
/// Where the names of the axes are, and how much room they and the marks take from the numbers.
const NAME: (f64, f64) = (26.0, 13.0);
/// Height of the plots of y and of a in display pixels.
const PLOT: f64 = 128.0;
/// Height of one line's row in the band between the plots.
const ROW: f64 = 9.0;

/// Draws y and the multiplier a along the boundary, one panel below the other.
///
/// The abscissa s in [0, 4] runs counter-clockwise from the lower left corner. A node in contact stands for the half cells on both of its sides. The band between the two plots
/// has one bar per line; the ground is grey where all lines of the panel are in contact.
pub(crate) fn contact(panels: &[ContactPanel]) -> Picture {
    let mut picture = Picture::new(WIDTH, 0.0);
    let mut top = 8.0;
    for panel in panels {
        top = draw_panel(&mut picture, panel, top);
    }
    picture.height = top + 28.0;
    let y = top + 8.0;
    picture.rect((ACROSS.0, y - 7.0), (ACROSS.0 + 28.0, y + 7.0), SHADE);
    key(
        &mut picture,
        (ACROSS.0 + 36.0, y),
        "in contact (a > 0) in every run shown; bars: in contact, run by run",
    );
    picture.table = Some(of_contact(panels));
    picture
}

/// Draws a panel, and returns where the next one begins.
fn draw_panel(picture: &mut Picture, panel: &ContactPanel, top: f64) -> f64 {
    picture.text(panel.title, (ACROSS.0, top + 14.0), bold(LARGE).pos(START));
    let labels = panel.lines.iter().map(|(label, _)| &**label);
    let legend = Legend::new(labels, WIDTH - 100.0);
    legend.draw(picture, (ACROSS.0, top + 38.0));
    let grid = panel.grid;
    let top = top + 54.0 + LEGEND_ROW * legend.rows as f64;
    let band = ROW * panel.lines.len() as f64 + 16.0;
    let boundary: Vec<usize> = grid.boundary().collect();
    let lines = || panel.lines.iter().map(|(_, pair)| pair);
    let ys: Vec<Vec<f64>> =
        lines().map(|pair| boundary.iter().map(|&k| pair.y[k]).collect()).collect();
    let multipliers: Vec<Vec<f64>> = lines().map(|pair| pair.a.clone()).collect();
    let [of_y, of_a] = [&ys, &multipliers].map(|data| {
        let (low, high) = range_with_zero(data.iter().flatten().copied());
        let high = if high > low { high } else { low + 1.0 };
        ((low, high), Ticks::inside(low, high, 5))
    });
    let longest = SMALL * of_y.1.widest().max(of_a.1.widest());
    let across = (ACROSS.0.max(NAME.0 + NAME.1 + longest), ACROSS.1);
    let frame = |down: (f64, f64), ((low, high), ticks): ((f64, f64), Ticks)| {
        // A margin, so that a curve at zero is not lost in the frame.
        let pad = 0.08 * (high - low);
        (Frame { across, down, x: (0.0, 4.0), y: (low - pad, high + pad) }, ticks)
    };
    let upper = frame((top, top + PLOT), of_y);
    let lower_top = top + PLOT + band;
    let lower = frame((lower_top, lower_top + PLOT), of_a);

    let in_contact: Vec<Vec<bool>> = lines().map(|pair| pair.in_contact(grid)).collect();
    let everywhere: Vec<bool> =
        (0..boundary.len()).map(|b| in_contact.iter().all(|line| line[b])).collect();
    let whole = Frame { down: (top, lower_top + PLOT), ..upper.0 };
    for arc in arcs(&runs(&everywhere), grid.cells()) {
        whole.band(picture, arc, SHADE);
    }
    draw_plot(picture, "y", &upper, &ys, grid.h());
    draw_plot(picture, "a", &lower, &multipliers, grid.h());
    for (k, in_contact) in in_contact.iter().enumerate() {
        let y = top + PLOT + 8.0 + ROW * k as f64;
        for (from, to) in arcs(&runs(in_contact), grid.cells()) {
            picture.rect((whole.right(from), y + 1.5), (whole.right(to), y + ROW - 1.5), series(k));
        }
    }
    let middle = top + PLOT + 0.5 * band;
    picture.text("contact", (across.0 - 8.0, middle), plain(SMALL).pos(END).color(&MUTED));
    name_sides(picture, &whole);
    whole.down.1 + 56.0
}

/// The curves of one quantity, a line each, given at the boundary nodes, `h` apart.
fn draw_plot(
    picture: &mut Picture,
    name: &str,
    (frame, ticks): &(Frame, Ticks),
    data: &[Vec<f64>],
    h: f64,
) {
    frame.rules(picture, ticks.values());
    frame.label_left(picture, ticks.labelled());
    picture.text(name, (NAME.0, frame.middle().1), italic(NORMAL));
    frame.verticals(picture, [1.0, 2.0, 3.0], MUTED);
    for (k, values) in data.iter().enumerate() {
        // Closed: s = 4 is the corner s = 0 again.
        let places = (0..=values.len()).map(|b| frame.at(b as f64 * h, values[b % values.len()]));
        // The first lines are thicker, so that a later one on top does not hide them.
        let thick = 1.5 + 0.75 * (data.len() - 1 - k).min(3) as f64;
        picture.path(places, series(k), thick);
    }
    frame.outline(picture);
}

fn name_sides(picture: &mut Picture, whole: &Frame) {
    let (top, bottom) = whole.down;
    for (k, side) in ["bottom", "right", "top", "left"].into_iter().enumerate() {
        let x = whole.right(k as f64 + 0.5);
        picture.text(side, (x, top - 11.0), plain(SMALL).color(&MUTED));
    }
    let corners = ["lower left", "lower right", "upper right", "upper left", "lower left"];
    for (k, corner) in corners.into_iter().enumerate() {
        let x = whole.right(k as f64);
        picture.path([(x, bottom), (x, bottom + 4.0)], INK, 1.0);
        picture.text(&k.to_string(), (x, bottom + 13.0), plain(SMALL));
        let kind = plain(SMALL).color(&MUTED);
        match k {
            0 => picture.text(corner, (x - 8.0, bottom + 29.0), kind.pos(START)),
            4 => picture.text(corner, (x + 8.0, bottom + 29.0), kind.pos(END)),
            _ => picture.text(corner, (x, bottom + 29.0), kind),
        }
    }
    picture.text("s", (whole.right(0.5), bottom + 15.0), italic(NORMAL));
}

/// Runs of boundary nodes in contact: first node of each run, and one past its last.
fn runs(in_contact: &[bool]) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for (b, _) in in_contact.iter().enumerate().filter(|(_, in_contact)| **in_contact) {
        match runs.last_mut() {
            Some(run) if run[1] == b => run[1] = b + 1,
            _ => runs.push([b, b + 1]),
        }
    }
    runs
}

/// Intervals of s in [0, 4] in which the boundary is in contact, from runs of nodes, first and one past the last.
///
/// Each node stands for the half cells on both of its sides; the first node is also the last.
fn arcs(runs: &[[usize; 2]], cells: usize) -> Vec<(f64, f64)> {
    let at = |node: usize| ((node as f64 - 0.5) / cells as f64).max(0.0);
    let mut arcs: Vec<_> = runs.iter().map(|run| (at(run[0]), at(run[1]))).collect();
    if runs.first().is_some_and(|run| run[0] == 0) {
        let half = at(4 * cells);
        match arcs.last_mut() {
            Some(last) if last.1 == half => last.1 = 4.0,
            _ => arcs.push((half, 4.0)),
        }
    }
    arcs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contact_wraps_around_the_first_corner() {
        assert!(arcs(&[], 4).is_empty());
        assert_eq!(arcs(&[[0, 1]], 4), [(0.0, 0.125), (3.875, 4.0)]);
        assert_eq!(arcs(&[[0, 1], [5, 7]], 4)[1], (1.125, 1.625));
        assert_eq!(arcs(&[[0, 16]], 4), [(0.0, 4.0)]);
    }

    #[test]
    fn runs_are_disjoint_and_ascend() {
        assert_eq!(runs(&[true, false, true, true, false]), [[0, 1], [2, 4]]);
    }
}
