//! Contact along the boundary, iteration by iteration: one strip per run.

use super::axes::Frame;
use super::palette::{CONTACT, INK, MUTED, RULE};
use super::picture::{LARGE, NORMAL, Picture, SMALL, START, UPWARDS, WIDTH, bold, italic, plain};
use super::table::of_strips;
use super::text::Ticks;
use crate::experiments::strips::{Strip, Strips};

/// Left and right end of a row of strips.
const ACROSS: (f64, f64) = (58.0, 790.0);
const GAP: f64 = 12.0;
/// Height of the longest strip.
const TALL: f64 = 200.0;
/// Height of the bar of the true contact set, and its distance from the strips.
const BAR: (f64, f64) = (9.0, 8.0);
/// The least width of an arc in that bar: narrower ones could not be seen.
const LEAST: f64 = 3.0;
/// Room above the strips of a panel, for its title and the names of the runs.
const ABOVE: f64 = 60.0;
/// Room below, for the bar, the numbers and the name of the axis.
const BELOW: f64 = 68.0;

/// Draws one row of strips per panel: red where the boundary is in contact, first iteration on top.
///
/// Below each strip a bar shows where the true solution touches.
pub(crate) fn strips(panels: &[Strips]) -> Picture {
    let high = ABOVE + TALL + BELOW;
    let mut picture = Picture::new(WIDTH, high * panels.len() as f64 + 24.0);
    for (k, panel) in panels.iter().enumerate() {
        draw_panel(&mut picture, panel, high * k as f64);
    }
    let y = high * panels.len() as f64 + 8.0;
    picture.rect((ACROSS.0, y - 6.0), (ACROSS.0 + 24.0, y + 6.0), CONTACT);
    picture.text("in contact (a > 0)", (ACROSS.0 + 32.0, y), plain(SMALL).pos(START));
    picture.rect((ACROSS.0 + 190.0, y - 4.5), (ACROSS.0 + 214.0, y + 4.5), INK);
    let truth = "contact of the true solution";
    picture.text(truth, (ACROSS.0 + 222.0, y), plain(SMALL).pos(START));
    picture.table = Some(of_strips(panels));
    picture
}

fn draw_panel(picture: &mut Picture, panel: &Strips, top: f64) {
    picture.text(&panel.title(), (ACROSS.0, top + 18.0), bold(LARGE).pos(START));
    let count = panel.strips.len() as f64;
    let wide = (ACROSS.1 - ACROSS.0 - GAP * (count - 1.0)) / count;
    let longest = panel.strips.iter().map(|strip| strip.contact.len()).max().unwrap_or(0).max(1);
    let down = (top + ABOVE, top + ABOVE + TALL);
    for (k, Strip { r, contact }) in panel.strips.iter().enumerate() {
        let left = ACROSS.0 + (wide + GAP) * k as f64;
        let frame =
            Frame { across: (left, left + wide), down, x: (0.0, 4.0), y: (longest as f64, 0.0) };
        draw_strip(picture, panel, &frame, contact);
        picture.text(&format!("r = {r}"), (left + 0.5 * wide, down.0 - 12.0), plain(SMALL));
        if k == 0 {
            frame.label_left(picture, Ticks::inside(0.0, longest as f64, 5).labelled());
        }
    }
    let middle = 0.5 * (down.0 + down.1);
    picture.text("iteration", (14.0, middle), plain(NORMAL).transform(UPWARDS));
}

fn draw_strip(picture: &mut Picture, panel: &Strips, frame: &Frame, rows: &[Vec<[usize; 2]>]) {
    let end = frame.up(rows.len() as f64);
    let mut row = 0;
    // Rows that are alike are one rectangle.
    for alike in rows.chunk_by(|a, b| a == b) {
        // A little further down than it reaches, so that no seam shows.
        let (from, to) = (frame.up(row as f64), frame.up((row + alike.len()) as f64) + 0.5);
        let to = to.min(end);
        for (left, right) in arcs(&alike[0], panel.cells) {
            picture.rect((frame.right(left), from), (frame.right(right), to), CONTACT);
        }
        row += alike.len();
    }
    let shown = Frame { down: (frame.down.0, end), ..*frame };
    shown.verticals(picture, [1.0, 2.0, 3.0], RULE);
    shown.outline(picture);
    let bar = (frame.down.1 + BAR.1, frame.down.1 + BAR.1 + BAR.0);
    for &[from, to] in &panel.truth {
        let parts = if from < to { vec![(from, to)] } else { vec![(from, 4.0), (0.0, to)] };
        for (from, to) in parts {
            let (left, right) = (frame.right(from), frame.right(to));
            let (left, right) = match to < 4.0 {
                true => (left, right.max(left + LEAST)),
                false => (left.min(right - LEAST), right),
            };
            picture.rect((left, bar.0), (right, bar.1), INK);
        }
    }
    picture.outline((frame.across.0, bar.0), (frame.across.1, bar.1), MUTED, 0.75);
    let below = Frame { down: (frame.down.0, bar.1), ..*frame };
    below.label_below(picture, [0.0, 1.0, 2.0, 3.0, 4.0].map(|s| (s, format!("{s}"))));
    picture.text("s", (frame.middle().0, bar.1 + 30.0), italic(NORMAL));
}

/// Intervals of s in [0, 4] in which the boundary is in contact, from runs of nodes, first and one past the last.
///
/// Each node stands for the half cells on both of its sides; the first node is also the last.
pub(super) fn arcs(runs: &[[usize; 2]], cells: usize) -> Vec<(f64, f64)> {
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
}
