//! The boundary unrolled: solution, multiplier and contact along the four sides of the square, or a closed curve.

use super::axes::{Entry, Frame, Legend, Sample, key};
use super::chart::{LEGEND, legend};
use super::palette::{INK, MUTED, RGBColor, RULE, SHADE};
use super::panels::Head;
use super::picture::{END, NORMAL, Picture, SMALL, START, WIDTH, italic, plain};
use super::plot::Plot;
use super::series::{Chart, Curve, Scale, Stroke};
use super::table::add;
use super::text::{Ticks, short};
use super::title::Title;
use super::{IN_SPACE, fixed, range_with_zero};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::ClosedCurve;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::Pair;

/// One panel of [`contact`].
pub struct ContactPanel {
    pub(super) title: String,
    pub(super) curve: ClosedCurve,
    /// True if what sticks is in contact.
    has_contact: bool,
    /// Solutions compared.
    pub(super) lines: Vec<ContactLine>,
}

/// Solution along the boundary, at the nodes of the curve.
pub(super) struct ContactLine {
    /// Name in the legend.
    pub(super) label: String,
    pub(super) y: Vec<f64>,
    /// Multiplier, or flux dy/dn; none on fixed parts, whose flux is not computed.
    pub(super) a: Vec<Option<f64>>,
    in_contact: Vec<bool>,
}

impl ContactPanel {
    /// Panels of the solutions of a problem, each with its label: one for each closed curve of the boundary.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub fn of(
        title: &str,
        problem: &Problem,
        solutions: &[(String, Pair)],
    ) -> Result<Vec<Self>, String> {
        let (mut panels, has_contact) = (Vec::new(), problem.has_contact());
        let curves = problem.levels().boundary();
        if curves.is_empty() {
            return Err(IN_SPACE.into());
        }
        for curve in curves {
            let nodes = &curve.nodes;
            let lines = solutions.iter().map(|(label, pair)| ContactLine {
                label: label.clone(),
                y: at(&pair.y, nodes),
                a: fluxes(&curve, &at(&problem.at_nodes(&pair.a, f64::NAN), nodes)),
                in_contact: at(&problem.at_nodes(&problem.in_contact(pair), false), nodes),
            });
            let lines = lines.collect();
            let label = curve.label();
            let title = label.map_or(title.to_owned(), |label| format!("{title}: {label}"));
            panels.push(Self { title, curve, has_contact, lines });
        }
        Ok(panels)
    }

    /// Chart of one quantity, with a gap where it has no value.
    fn chart(&self, values: fn(&ContactLine) -> Vec<Option<f64>>) -> Chart {
        let mut curves = Vec::new();
        for (k, line) in self.lines.iter().enumerate() {
            let mut values = values(line);
            // Closed: the end of the curve is the first node again.
            values.extend(values.first().copied());
            let places = self.curve.places.iter().copied().chain([self.curve.length]);
            let points: Vec<_> = places.zip(values).collect();
            for piece in
                points.split(|(_, value)| value.is_none()).filter(|piece| !piece.is_empty())
            {
                let piece = piece.iter().filter_map(|&(place, value)| Some((place, value?)));
                let mut curve = Curve::new(Stroke::Line, &line.label, piece);
                // The first lines are thicker, so that a later one on top does not hide them.
                curve.width = 1.5 + 0.75 * (self.lines.len() - 1 - k).min(3) as f64;
                curves.push(curve);
            }
        }
        Chart::new(&self.title, ["", ""], curves).scaled([Scale::Linear; 2])
    }

    /// True if a part of the curve has such a law.
    fn has(&self, is_such: impl FnMut(&Law) -> bool) -> bool {
        self.curve.laws.iter().any(is_such)
    }
}

/// Flux at the nodes of a curve: the multiplier, where there is none the flux of a free part, and none at the ends of
/// an edge on a fixed part.
fn fluxes(curve: &ClosedCurve, multiplier: &[f64]) -> Vec<Option<f64>> {
    let last = curve.laws.len() - 1;
    let of_node = |(node, &a): (usize, &f64)| {
        let sides = [node.checked_sub(1).unwrap_or(last), node].map(|edge| curve.laws[edge]);
        let is_fixed = sides.iter().any(|law| law.is_fixed());
        (!is_fixed).then(|| if a.is_nan() { sides[1].lo() } else { a })
    };
    multiplier.iter().enumerate().map(of_node).collect()
}

/// Values at some nodes.
fn at<T: Copy>(values: &[T], nodes: &[usize]) -> Vec<T> {
    nodes.iter().map(|&node| values[node]).collect()
}

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
/// Coordinate over the length of a curve that is shown as zero.
const ROUNDING: f64 = 1e-9;
/// Colours of free and of fixed parts.
const UNMOVED: [RGBColor; 2] = [RULE, INK];

/// Words for free parts among those with these laws; none without any.
fn free(laws: impl Iterator<Item = Law>) -> Option<&'static str> {
    let fluxes = laws.filter(|law| law.is_free()).map(Law::lo);
    fluxes.map(|flux| if flux == 0.0 { "free (a = 0)" } else { "free" }).min()
}

/// Draws y and the multiplier a along the boundary, one panel below the other.
///
/// The abscissa s is the arc length; on the square it runs anticlockwise from the lower left corner, on another domain
/// with the domain on the left from the lowest node. A node in contact stands for the half cells
/// on both of its sides. The band between the two plots has one bar per line, and one for parts without the law; the
/// ground is grey where all lines of the panel are in contact. A curve without the law has no plot of a.
pub fn contact(panels: &[ContactPanel]) -> Picture {
    let mut picture = Picture::new(WIDTH, 0.0);
    let mut top = 8.0;
    for panel in panels {
        top = draw_panel(&mut picture, panel, top);
    }
    picture.height = top + 28.0;
    let y = top + 8.0;
    picture.rect((ACROSS.0, y - 7.0), (ACROSS.0 + 28.0, y + 7.0), SHADE);
    let is_contact = panels.iter().all(|panel| panel.has_contact);
    let words = if is_contact {
        "in contact (a > 0) on every line shown; bars: in contact, line by line"
    } else {
        "sticks (a inside its interval) on every line shown; bars: sticks, line by line"
    };
    key(&mut picture, (ACROSS.0 + 36.0, y), words);
    picture.table = Some(of_contact(panels));
    picture
}

/// Draws a panel, and returns the top of the next one.
fn draw_panel(picture: &mut Picture, panel: &ContactPanel, top: f64) -> f64 {
    let ContactPanel { curve, lines, .. } = panel;
    let charts = [
        panel.chart(|line| line.y.iter().copied().map(Some).collect()),
        panel.chart(|line| line.a.clone()),
    ];
    let entries = legend(&[&charts[0]]);
    let words = [free(curve.laws.iter().copied()), fixed(curve.laws.iter().copied())];
    let parts = words.into_iter().zip(UNMOVED).filter_map(|(words, color)| {
        Some(Entry { label: words?.into(), color, sample: Sample::Swatch })
    });
    let head = Head {
        title: Title::new(&panel.title, WIDTH - ACROSS.0 - 8.0),
        legend: Legend::of(entries.iter().cloned().chain(parts), LEGEND),
        gap: 40.0,
    };
    let upper = top + 14.0 + head.high();
    let bars = lines.len() + usize::from(panel.has(|law| !law.may_move()));
    let lower = upper + PLOT + ROW * bars as f64 + 16.0;
    // A curve without the law has no plot of a.
    let bottom = if panel.has(|law| law.may_move()) { lower + PLOT } else { lower };

    let values = [&charts[0], &charts[1]].map(|chart| {
        chart.curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.1))
    });
    let ranges = values.map(range_with_zero);
    let ticks = ranges.map(|(low, high)| Ticks::inside(low, high, 5));
    let longest = SMALL * ticks[0].widest().max(ticks[1].widest());
    let across = (ACROSS.0.max(NAME + NAME_ROOM + longest), ACROSS.1);
    let whole = Frame { across, down: (upper, bottom), x: (0.0, curve.length), y: (0.0, 1.0) };
    head.draw(picture, &Frame { across: ACROSS, ..whole });
    let everywhere: Vec<bool> =
        (0..curve.places.len()).map(|b| lines.iter().all(|line| line.in_contact[b])).collect();
    for arc in arcs(&everywhere, curve) {
        whole.band(picture, arc, SHADE);
    }
    for (k, (name, top)) in [("y", upper), ("a", lower)].into_iter().enumerate() {
        if top == bottom {
            continue;
        }
        // All values may be zero; a margin, so that the frame does not hide a curve at zero.
        let (low, span) = (ranges[k].0, ranges[k].1 - ranges[k].0);
        let span = if span > 0.0 { span } else { 1.0 };
        let y = (low - 0.08 * span, low + span + 0.08 * span);
        let frame = Frame { down: (top, top + PLOT), y, ..whole };
        frame.rules(picture, ticks[k].values());
        frame.label_left(picture, ticks[k].labelled());
        picture.text(name, (NAME, frame.middle().1), italic(NORMAL));
        if curve.parts.is_empty() {
            frame.verticals(picture, [1.0, 2.0, 3.0], MUTED);
        }
        Plot { chart: &charts[k], frame, entries: &entries }.draw(picture);
    }
    draw_bars(picture, panel, &entries, &Frame { down: (upper + PLOT, lower), ..whole });
    if curve.parts.is_empty() {
        name_sides(picture, &whole);
    } else {
        name_start(picture, curve, &whole);
    }
    bottom + 56.0
}

/// Draws the bars of all lines, and that of the parts without the law, in the band between the plots.
fn draw_bars(picture: &mut Picture, panel: &ContactPanel, entries: &[Entry], band: &Frame) {
    let ContactPanel { curve, lines, has_contact, .. } = panel;
    let mut bars = Vec::new();
    for (k, (line, Entry { color, .. })) in lines.iter().zip(entries).enumerate() {
        bars.extend(arcs(&line.in_contact, curve).into_iter().map(|arc| (k, arc, *color)));
    }
    let is_unmoved: [fn(Law) -> bool; 2] = [Law::is_free, Law::is_fixed];
    for (is_such, color) in is_unmoved.into_iter().zip(UNMOVED) {
        let edges = (0..curve.places.len()).filter(|&k| is_such(curve.laws[k]));
        let edges =
            edges.map(|k| (curve.places[k], *curve.places.get(k + 1).unwrap_or(&curve.length)));
        bars.extend(joined(edges).into_iter().map(|edges| (lines.len(), edges, color)));
    }
    for (row, (from, to), color) in bars {
        let y = band.down.0 + 8.0 + ROW * row as f64;
        picture.rect((band.right(from), y + 1.5), (band.right(to), y + ROW - 1.5), color);
    }
    let holds = if *has_contact { "contact" } else { "sticks" };
    if panel.has(|law| law.may_move()) {
        let at = (band.across.0 - 8.0, band.middle().1);
        picture.text(holds, at, plain(SMALL).pos(END).color(&MUTED));
    }
}

/// Writes the numbers along the arc length, and below its zero where that is.
fn name_start(
    picture: &mut Picture,
    ClosedCurve { points, length, .. }: &ClosedCurve,
    whole: &Frame,
) {
    whole.label_below(picture, Ticks::inside(0.0, *length, 8).labelled());
    let (middle, below) = (whole.middle().0, whole.down.1 + 31.0);
    picture.text("s", (middle, below), italic(NORMAL));
    let [x, y] = points[0].map(|at| short(if at.abs() < ROUNDING * length { 0.0 } else { at }));
    let start = format!("from ({x}, {y}), domain on the left");
    key(picture, (whole.across.0 - 8.0, below), &start);
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

/// Returns the intervals of s in which the boundary is in contact: each node stands for the half cells on both of its
/// sides, and the first node is also the last.
fn arcs(in_contact: &[bool], curve: &ClosedCurve) -> Vec<(f64, f64)> {
    let count = in_contact.len();
    let nodes = (0..=count).filter(|node| in_contact[node % count]);
    joined(nodes.map(|node| (half_cell_before(node, curve), half_cell_before(node + 1, curve))))
}

/// Returns s at the middle of the cell before a node, or an end of the curve; the last cell ends at the first node.
fn half_cell_before(node: usize, ClosedCurve { places, length, .. }: &ClosedCurve) -> f64 {
    match node.checked_sub(1) {
        None => 0.0,
        Some(before) if before == places.len() => *length,
        Some(before) => 0.5 * (places[before] + places.get(node).unwrap_or(length)),
    }
}

/// Joins ascending intervals that meet.
fn joined(pieces: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut joined: Vec<(f64, f64)> = Vec::new();
    for (from, to) in pieces {
        match joined.last_mut() {
            Some(last) if last.1 == from => last.1 = to,
            _ => joined.push((from, to)),
        }
    }
    joined
}

/// Returns trace and multiplier at the boundary nodes, by arc length.
fn of_contact(panels: &[ContactPanel]) -> String {
    let mut csv = "panel,run,s,y,a\n".to_owned();
    for ContactPanel { title, curve, lines, .. } in panels {
        for ContactLine { label, y, a, .. } in lines {
            let numbers = curve
                .places
                .iter()
                .zip(y)
                .zip(a)
                .map(|((&s, &y), &a)| [s, y, a.unwrap_or(f64::NAN)]);
            add(&mut csv, &[title, label], numbers);
        }
    }
    csv
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FIXED;
    use crate::samples::{on_grid, svg};
    use signorini_mathematics::discrete::grid::Grid;
    use signorini_mathematics::levels::Problem;
    use signorini_mathematics::mesh::AnyMesh;
    use signorini_mathematics::problem::law::Law;
    use signorini_mathematics::saddle::Pair;

    #[test]
    fn contact_wraps_around_the_first_corner() {
        let problem = on_grid(Grid::new(4).unwrap());
        let square = &ContactPanel::of("t", &problem, &[]).unwrap()[0].curve;
        assert!(arcs(&[false; 16], square).is_empty());
        assert_eq!(arcs(&[true; 16], square), [(0.0, 4.0)]);
        let mut in_contact = [false; 16];
        in_contact[0] = true;
        assert_eq!(arcs(&in_contact, square), [(0.0, 0.125), (3.875, 4.0)]);
        in_contact[5..7].fill(true);
        assert_eq!(arcs(&in_contact, square)[1], (1.125, 1.625));
    }

    #[test]
    fn parts_without_the_law_have_a_word_and_no_axis_of_a() {
        for (law, word) in [(Law::FREE, "free (a = 0)"), (Law::FIXED, FIXED[0])] {
            let mut annulus = AnyMesh::built_in("annulus").unwrap();
            annulus.set_law("inner", law).unwrap();
            let problem = Problem::on_mesh(&annulus, 1, "else=-1").unwrap();
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
            assert_eq!(named(word), [true, false], "{law:?}");
            // The flux through a free part is zero, that through a fixed one is not computed.
            let table = of_contact(&panels);
            let last = if law == Law::FIXED { "" } else { "0" };
            let inner_rows = table.lines().filter(|line| line.starts_with("t: inner,"));
            assert!(inner_rows.clone().count() > 4);
            assert!(inner_rows.map(|line| line.rsplit(',').next().unwrap()).all(|a| a == last));
            assert_eq!(named("a"), [false, true]);
            // Of zeros alone zero is the one number.
            assert!(!inner.contains(">0.2</text>"), "{inner}");
            assert_eq!(named("contact"), [false, true]);
            assert!(outer.contains(">from (0, \u{2212}1), domain on the left</text>"), "{outer}");
        }
    }

    #[test]
    fn intervals_that_meet_are_joined() {
        let pieces = [(0.0, 1.0), (2.0, 3.0), (3.0, 4.0)];
        assert_eq!(joined(pieces.into_iter()), [(0.0, 1.0), (2.0, 4.0)]);
    }
}
