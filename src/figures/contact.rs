//! The boundary unrolled: solution, multiplier and contact along the four sides of the square, or a closed curve.

use super::axes::{Entry, Frame, LEGEND_ROW, Legend, Sample, key};
use super::palette::{INK, MUTED, RGBColor, RULE, SHADE, series};
use super::picture::{END, LARGE, NORMAL, Picture, SMALL, START, WIDTH, bold, italic, plain};
use super::table::of_contact;
use super::text::{Ticks, short};
use super::title::Title;
use super::{ContactLine, ContactPanel, FIXED, range_with_zero};
use signorini_mathematics::mesh::Condition;

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
/// The abscissa s is the arc length; on the square it runs anticlockwise from the lower left corner, on another domain
/// with the domain on the left from the lowest node. A node in contact stands for the half cells
/// on both of its sides. The band between the two plots has one bar per line, and one for parts without the law; the
/// ground is grey where all lines of the panel are in contact. A curve without the law has no plot of a.
pub(crate) fn contact(panels: &[ContactPanel]) -> Picture {
    let mut picture = Picture::new(WIDTH, 0.0);
    let mut top = 8.0;
    for panel in panels {
        top = draw_panel(&mut picture, panel, top);
    }
    picture.height = top + 28.0;
    let y = top + 8.0;
    picture.rect((ACROSS.0, y - 7.0), (ACROSS.0 + 28.0, y + 7.0), SHADE);
    let is_contact = panels.iter().all(|panel| panel.law.is_signorini());
    let words = if is_contact {
        "in contact (a > 0) on every line shown; bars: in contact, line by line"
    } else {
        "sticks (a inside its interval) on every line shown; bars: sticks, line by line"
    };
    key(&mut picture, (ACROSS.0 + 36.0, y), words);
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
    fn new(across: (f64, f64), top: f64, axes: [(f64, f64); 2], ticks: Ticks) -> Self {
        let [x, (low, high)] = axes;
        // All values may be zero, the one number on the axis then.
        let high = if high > low { high } else { low + 1.0 };
        // A margin, so that the frame does not hide a curve at zero.
        let margin = 0.08 * (high - low);
        let y = (low - margin, high + margin);
        Self { frame: Frame { across, down: (top, top + PLOT), x, y }, ticks }
    }
}

/// Returns the range of the values of all lines, with zero.
fn range<'a>(lines: impl Iterator<Item = &'a Vec<f64>>) -> (f64, f64) {
    range_with_zero(lines.flatten().copied())
}

/// Coordinate over the length of a curve that is shown as zero.
const ROUNDING: f64 = 1e-9;

/// Conditions other than the law, with their words and colours.
const WITHOUT_LAW: [(Condition, &str, RGBColor); 2] =
    [(Condition::Free, "free (a = 0)", RULE), (Condition::Fixed, FIXED, INK)];

/// Draws a panel, and returns the top of the next one.
fn draw_panel(picture: &mut Picture, panel: &ContactPanel, top: f64) -> f64 {
    let title = Title::new(&panel.title, WIDTH - ACROSS.0 - 8.0);
    let top = top + title.more();
    title.draw(picture, (ACROSS.0, top + 14.0), &bold(LARGE).pos(START));
    let legend = legend(panel);
    legend.draw(picture, (ACROSS.0, top + 38.0));
    let top = top + 54.0 + LEGEND_ROW * legend.rows as f64;
    let lines = &panel.lines;
    let bars = lines.len() + usize::from(panel.conditions.iter().any(|c| *c != Condition::Contact));
    let band = ROW * bars as f64 + 16.0;
    let has_law = panel.conditions.contains(&Condition::Contact);
    let range_y = range(lines.iter().map(|line| &line.y));
    let range_a = range(lines.iter().map(|line| &line.a));
    let ticks_y = Ticks::inside(range_y.0, range_y.1, 5);
    let ticks_a = Ticks::inside(range_a.0, range_a.1, 5);
    let longest = SMALL * ticks_y.widest().max(ticks_a.widest());
    let across = (ACROSS.0.max(NAME + NAME_ROOM + longest), ACROSS.1);
    let x = (0.0, panel.length);
    let upper = Plot::new(across, top, [x, range_y], ticks_y);
    let lower_top = top + PLOT + band;
    let lower = Plot::new(across, lower_top, [x, range_a], ticks_a);
    let bottom = if has_law { lower_top + PLOT } else { lower_top };

    let everywhere: Vec<bool> =
        (0..panel.places.len()).map(|b| lines.iter().all(|line| line.in_contact[b])).collect();
    let whole = Frame { down: (top, bottom), ..upper.frame };
    for arc in arcs(&runs(&everywhere), panel) {
        whole.band(picture, arc, SHADE);
    }
    draw_plot(picture, "y", &upper, panel, |line| &line.y);
    if has_law {
        draw_plot(picture, "a", &lower, panel, |line| &line.a);
    }
    draw_bars(picture, panel, &Frame { down: (top + PLOT, lower_top), ..whole });
    match panel.start {
        None => name_sides(picture, &whole),
        Some(start) => name_start(picture, panel, &whole, start),
    }
    whole.down.1 + 56.0
}

/// Returns the legend of a panel: its lines, and the parts of its curve without the law.
fn legend(panel: &ContactPanel) -> Legend<'_> {
    let lines = panel.lines.iter().enumerate();
    let lines =
        lines.map(|(k, line)| Entry { label: &line.label, color: series(k), sample: Sample::Line });
    let parts = WITHOUT_LAW.iter().filter(|(condition, ..)| panel.conditions.contains(condition));
    let parts = parts.map(|&(_, label, color)| Entry { label, color, sample: Sample::Swatch });
    Legend::of(lines.chain(parts), WIDTH - 100.0)
}

/// Draws the bars of all lines, and that of the parts without the law, in the band between the plots.
fn draw_bars(picture: &mut Picture, panel: &ContactPanel, band: &Frame) {
    let mut bars = Vec::new();
    for (k, line) in panel.lines.iter().enumerate() {
        bars.extend(
            arcs(&runs(&line.in_contact), panel).into_iter().map(|arc| (k, arc, series(k))),
        );
    }
    for (condition, _, color) in WITHOUT_LAW {
        let edges: Vec<bool> = panel.conditions.iter().map(|given| *given == condition).collect();
        for [first, end] in runs(&edges) {
            let to = panel.places.get(end).copied().unwrap_or(panel.length);
            bars.push((panel.lines.len(), (panel.places[first], to), color));
        }
    }
    for (row, (from, to), color) in bars {
        let y = band.down.0 + 8.0 + ROW * row as f64;
        picture.rect((band.right(from), y + 1.5), (band.right(to), y + ROW - 1.5), color);
    }
    let holds = if panel.law.is_signorini() { "contact" } else { "sticks" };
    if panel.conditions.contains(&Condition::Contact) {
        let at = (band.across.0 - 8.0, band.middle().1);
        picture.text(holds, at, plain(SMALL).pos(END).color(&MUTED));
    }
}

/// Writes the numbers along the arc length, and below its zero where that is.
fn name_start(picture: &mut Picture, panel: &ContactPanel, whole: &Frame, [x, y]: [f64; 2]) {
    whole.label_below(picture, Ticks::inside(0.0, panel.length, 8).labelled());
    let (middle, below) = (whole.middle().0, whole.down.1 + 31.0);
    picture.text("s", (middle, below), italic(NORMAL));
    let [x, y] = [x, y].map(|at| short(if at.abs() < ROUNDING * panel.length { 0.0 } else { at }));
    let start = format!("from ({x}, {y}), domain on the left");
    key(picture, (whole.across.0 - 8.0, below), &start);
}

/// Draws the curves of one quantity.
fn draw_plot(
    picture: &mut Picture,
    name: &str,
    plot: &Plot,
    panel: &ContactPanel,
    values: fn(&ContactLine) -> &Vec<f64>,
) {
    let Plot { frame, ticks } = plot;
    frame.rules(picture, ticks.values());
    frame.label_left(picture, ticks.labelled());
    picture.text(name, (NAME, frame.middle().1), italic(NORMAL));
    if panel.start.is_none() {
        frame.verticals(picture, [1.0, 2.0, 3.0], MUTED);
    }
    for (k, line) in panel.lines.iter().enumerate() {
        // Closed: the end of the curve is the first node again.
        let ends = values(line).first().map(|&value| (panel.length, value));
        let inner = panel.places.iter().copied().zip(values(line).iter().copied());
        let places = inner.chain(ends).map(|(s, value)| frame.at(s, value));
        // The first lines are thicker, so that a later one on top does not hide them.
        let thick = 1.5 + 0.75 * (panel.lines.len() - 1 - k).min(3) as f64;
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

/// Returns the runs of boundary nodes in contact, or of edges with a condition: the first of each run, and one past its
/// last.
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

/// Returns the intervals of s in which the boundary is in contact, from the [`runs`] of nodes.
///
/// Each node stands for the half cells on both of its sides; the first node is also the last.
fn arcs(runs: &[[usize; 2]], panel: &ContactPanel) -> Vec<(f64, f64)> {
    let mut arcs = Vec::new();
    for [first, end] in runs {
        arcs.push((half_cell_before(*first, panel), half_cell_before(*end, panel)));
    }
    if runs.first().is_some_and(|run| run[0] == 0) {
        let half = half_cell_before(panel.places.len(), panel);
        match arcs.last_mut() {
            Some(last) if last.1 == half => last.1 = panel.length,
            _ => arcs.push((half, panel.length)),
        }
    }
    arcs
}

/// Returns s at the middle of the cell before a node, or 0 before the first; the last cell ends at the first node.
fn half_cell_before(node: usize, ContactPanel { places, length, .. }: &ContactPanel) -> f64 {
    match node.checked_sub(1) {
        None => 0.0,
        Some(before) => 0.5 * (places[before] + places.get(node).unwrap_or(length)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::samples::{on_grid, svg};
    use signorini_mathematics::discrete::grid::Grid;
    use signorini_mathematics::levels::Problem;
    use signorini_mathematics::mesh::AnyMesh;
    use signorini_mathematics::problem::law::Law;
    use signorini_mathematics::saddle::Pair;

    #[test]
    fn contact_wraps_around_the_first_corner() {
        let problem = on_grid(Grid::new(4).unwrap());
        let square = &ContactPanel::of("t", &problem, &[]).unwrap()[0];
        assert!(arcs(&[], square).is_empty());
        assert_eq!(arcs(&[[0, 1]], square), [(0.0, 0.125), (3.875, 4.0)]);
        assert_eq!(arcs(&[[0, 1], [5, 7]], square)[1], (1.125, 1.625));
        assert_eq!(arcs(&[[0, 16]], square), [(0.0, 4.0)]);
    }

    #[test]
    fn parts_without_the_law_have_a_word_and_no_axis_of_a() {
        for (condition, word) in [(Condition::Free, "free (a = 0)"), (Condition::Fixed, FIXED)] {
            let mut annulus = AnyMesh::built_in("annulus").unwrap();
            annulus.set_condition("inner", condition).unwrap();
            let problem = Problem::on_mesh(&annulus, 1, "else=-1", Law::SIGNORINI).unwrap();
            let y = vec![0.0; problem.lengths()[0]];
            let a = vec![1.0; problem.lengths()[1]];
            let lines = [("l".to_owned(), Pair { y, a })];
            let panels = ContactPanel::of("t", &problem, &lines).unwrap();
            let pictures = panels.iter().map(|panel| svg(&contact(std::slice::from_ref(panel))));
            let pictures: Vec<String> = pictures.collect();
            let [inner, outer] = [">t: inner</text>", ">t: outer</text>"]
                .map(|title| pictures.iter().find(|svg| svg.contains(title)).unwrap());
            let named =
                |text: &str| [inner, outer].map(|svg| svg.contains(&format!(">{text}</text>")));
            assert_eq!(named(word), [true, false], "{condition:?}");
            assert_eq!(named("a"), [false, true]);
            // Of zeros alone zero is the one number.
            assert!(!inner.contains(">0.2</text>"), "{inner}");
            assert_eq!(named("contact"), [false, true]);
            assert!(outer.contains(">from (0, \u{2212}1), domain on the left</text>"), "{outer}");
        }
    }

    #[test]
    fn runs_are_disjoint_and_ascend() {
        assert_eq!(runs(&[true, false, true, true, false]), [[0, 1], [2, 4]]);
    }
}
