//! The boundary unrolled: solution, multiplier and contact along the four sides.

use super::axes::{Frame, LEGEND_ROW, Legend, key};
use super::palette::{INK, MUTED, SHADE, series};
use super::picture::{END, LARGE, NORMAL, Picture, SMALL, START, WIDTH, bold, italic, plain};
use super::table::of_contact;
use super::text::Ticks;
use super::{ContactLine, ContactPanel, range_with_zero};

/// Left and right end of the plots; long numbers move the left one.
const ACROSS: (f64, f64) = (82.0, 780.0);
/// Place of the names of the vertical axes.
const NAME: f64 = 26.0;
/// Room for these names and for the marks, to the left and right of the numbers.
const NAME_ROOM: f64 = 13.0;
/// Height of the plots of y and of a in display pixels.
const PLOT: f64 = 128.0;
/// Height of one line's row in the band between the plots.
const ROW: f64 = 9.0;

/// Draws y and the multiplier a along the boundary, one panel below the other.
///
/// The abscissa s in [0, 4] runs anticlockwise from the lower left corner. A node in contact stands for the half cells
/// on both of its sides. The band between the two plots has one bar per line; the ground is grey where all lines of the
/// panel are in contact.
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

/// Plot of one quantity along the boundary.
struct Plot {
    frame: Frame,
    ticks: Ticks,
}

impl Plot {
    /// Lays out a plot of `values` between `across`, from `top` downwards.
    fn new(across: (f64, f64), top: f64, (low, high): (f64, f64), ticks: Ticks) -> Self {
        // A margin, so that the frame does not hide a curve at zero.
        let margin = 0.08 * (high - low);
        let y = (low - margin, high + margin);
        Self { frame: Frame { across, down: (top, top + PLOT), x: (0.0, 4.0), y }, ticks }
    }
}

/// Returns the range of the values of all lines, with zero, and longer than zero.
fn range(lines: &[Vec<f64>]) -> (f64, f64) {
    let (low, high) = range_with_zero(lines.iter().flatten().copied());
    (low, if high > low { high } else { low + 1.0 })
}

/// Draws a panel, and returns the top of the next one.
fn draw_panel(picture: &mut Picture, panel: &ContactPanel, top: f64) -> f64 {
    picture.text(panel.title, (ACROSS.0, top + 14.0), bold(LARGE).pos(START));
    let labels = panel.lines.iter().map(|line| &*line.label);
    let legend = Legend::new(labels, WIDTH - 100.0);
    legend.draw(picture, (ACROSS.0, top + 38.0));
    let grid = panel.grid;
    let top = top + 54.0 + LEGEND_ROW * legend.rows as f64;
    let band = ROW * panel.lines.len() as f64 + 16.0;
    let (mut traces, mut multipliers, mut in_contact) = (Vec::new(), Vec::new(), Vec::new());
    for ContactLine { pair, .. } in &panel.lines {
        traces.push(grid.boundary().map(|node| pair.y[node]).collect::<Vec<f64>>());
        multipliers.push(pair.a.clone());
        in_contact.push(pair.in_contact(grid));
    }
    let (range_y, range_a) = (range(&traces), range(&multipliers));
    let ticks_y = Ticks::inside(range_y.0, range_y.1, 5);
    let ticks_a = Ticks::inside(range_a.0, range_a.1, 5);
    let longest = SMALL * ticks_y.widest().max(ticks_a.widest());
    let across = (ACROSS.0.max(NAME + NAME_ROOM + longest), ACROSS.1);
    let upper = Plot::new(across, top, range_y, ticks_y);
    let lower_top = top + PLOT + band;
    let lower = Plot::new(across, lower_top, range_a, ticks_a);

    let nodes = grid.boundary_nodes();
    let everywhere: Vec<bool> = (0..nodes).map(|b| in_contact.iter().all(|line| line[b])).collect();
    let whole = Frame { down: (top, lower_top + PLOT), ..upper.frame };
    for arc in arcs(&runs(&everywhere), grid.cells()) {
        whole.band(picture, arc, SHADE);
    }
    draw_plot(picture, "y", &upper, &traces, grid.h());
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

/// Draws the curves of one quantity, given at the boundary nodes, `h` apart.
fn draw_plot(picture: &mut Picture, name: &str, plot: &Plot, curves: &[Vec<f64>], h: f64) {
    let Plot { frame, ticks } = plot;
    frame.rules(picture, ticks.values());
    frame.label_left(picture, ticks.labelled());
    picture.text(name, (NAME, frame.middle().1), italic(NORMAL));
    frame.verticals(picture, [1.0, 2.0, 3.0], MUTED);
    for (k, values) in curves.iter().enumerate() {
        // Closed: s = 4 is the corner s = 0 again.
        let places = (0..=values.len()).map(|b| frame.at(b as f64 * h, values[b % values.len()]));
        // The first lines are thicker, so that a later one on top does not hide them.
        let thick = 1.5 + 0.75 * (curves.len() - 1 - k).min(3) as f64;
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

/// Returns the runs of boundary nodes in contact: first node of each run, and one past its last.
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

/// Returns the intervals of s in [0, 4] in which the boundary is in contact, from the [`runs`] of nodes.
///
/// Each node stands for the half cells on both of its sides; the first node is also the last.
fn arcs(runs: &[[usize; 2]], cells: usize) -> Vec<(f64, f64)> {
    let mut arcs = Vec::new();
    for [first, end] in runs {
        arcs.push((half_cell_before(*first, cells), half_cell_before(*end, cells)));
    }
    if runs.first().is_some_and(|run| run[0] == 0) {
        let half = half_cell_before(4 * cells, cells);
        match arcs.last_mut() {
            Some(last) if last.1 == half => last.1 = 4.0,
            _ => arcs.push((half, 4.0)),
        }
    }
    arcs
}

/// Returns s at the middle of the cell before a boundary node, or 0 before the first.
fn half_cell_before(node: usize, cells: usize) -> f64 {
    ((node as f64 - 0.5) / cells as f64).max(0.0)
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
