//! Charts of measured numbers: panels side by side under one legend, logarithmic axes or a linear one across.

use super::axes::{Entry, Frame, LEGEND_ROW, LONE, Legend, Sample};
use super::palette::{INK, MUTED, RULE, series, solver};
use super::picture::{
    END, LARGE, NORMAL, Picture, Place, SMALL, START, UPWARDS, WIDTH, bold, plain,
};
use super::table::of_charts;
use super::text::{Ticks, power_of_ten};
use super::{Chart, Curve, Scale, Stroke, decade};
use signorini_mathematics::experiments::Range;

/// Height of a plot in display pixels.
const PLOT: f64 = 260.0;
/// Room to the left of a plot, for numbers and the name of the axis.
const LEFT: f64 = 66.0;
/// Room to the right of a plot.
const RIGHT: f64 = 18.0;
/// Room above a plot, for its title.
const ABOVE: f64 = 30.0;
/// Room below a plot, for numbers and the name of the axis.
const BELOW: f64 = 50.0;

/// Draws panels, two in a row, one legend above them all; with `alike`, all vertical axes have the same range.
///
/// Panels without points are left out.
pub(crate) fn charts(alike: bool, panels: &[Chart]) -> Picture {
    let panels: Vec<_> = panels.iter().filter(|panel| points(panel).next().is_some()).collect();
    let curves: Vec<&Curve> = panels.iter().flat_map(|panel| &panel.curves).collect();
    let entries = entries(&curves);
    let columns = panels.len().clamp(1, 2);
    let legend = Legend::of(entries.iter().copied(), WIDTH - LEFT - RIGHT);
    let head = 12.0 + LEGEND_ROW * legend.rows as f64;
    // A legend for several panels is above their titles; that of a lone panel is below its title.
    let (legend_top, titles_up) = if panels.len() > 1 { (18.0, 0.0) } else { (ABOVE + 10.0, head) };
    let (wide, high) = (WIDTH / columns as f64, ABOVE + PLOT + BELOW);
    let rows = panels.len().div_ceil(columns);
    let mut picture = Picture::new(WIDTH, head + high * rows as f64);
    legend.draw(&mut picture, (LEFT, legend_top));
    let heights =
        Scale::Logarithmic.extent(panels.iter().flat_map(|panel| points(panel)).map(|p| p.1));
    for (k, panel) in panels.iter().enumerate() {
        let (left, top) = (wide * (k % columns) as f64, head + high * (k / columns) as f64);
        let frame = Frame {
            across: (left + LEFT, left + wide - RIGHT),
            down: (top + ABOVE, top + ABOVE + PLOT),
            x: panel.across.extent(points(panel).map(|p| p.0)),
            y: if alike { heights } else { Scale::Logarithmic.extent(points(panel).map(|p| p.1)) },
        };
        let title = (frame.across.0, frame.down.0 - 14.0 - titles_up);
        picture.text(&panel.title, title, bold(LARGE).pos(START));
        draw(&mut picture, panel, &frame, &entries);
    }
    picture.table = Some(of_charts(&panels));
    picture
}

/// Returns an entry of the legend for each label: with the colour of its solver, or a colour that no solver in the
/// picture has. The second and later labels of a solver are dashed; a label whose curves are single points is a ring.
fn entries<'a>(curves: &[&'a Curve]) -> Vec<Entry<'a>> {
    let mut labels: Vec<&str> = Vec::new();
    for curve in curves {
        let named = curve.stroke != Stroke::Reference && !curve.points.is_empty();
        if named && !labels.contains(&&*curve.label) {
            labels.push(&curve.label);
        }
    }
    let taken: Vec<usize> = labels.iter().filter_map(|label| solver(label)).collect();
    let mut free = (0..).filter(|place| !taken.contains(place));
    let mut seen = Vec::new();
    let mut entries = Vec::new();
    for label in labels {
        let place = solver(label).unwrap_or_else(|| free.next().unwrap_or(0));
        let has_line = curves.iter().any(|curve| curve.label == label && curve.points.len() > 1);
        let sample = match (has_line, seen.contains(&place)) {
            (false, _) => Sample::Ring,
            (true, true) => Sample::Dashed,
            (true, false) => Sample::Line,
        };
        seen.push(place);
        entries.push(Entry { label, color: series(place), sample });
    }
    entries
}

/// Curve with its entry in the legend.
struct Measured<'a> {
    curve: &'a Curve,
    entry: &'a Entry<'a>,
}

fn draw(picture: &mut Picture, panel: &Chart, frame: &Frame, entries: &[Entry]) {
    let (mut references, mut measured) = (Vec::new(), Vec::new());
    for curve in panel.curves.iter().filter(|curve| !curve.points.is_empty()) {
        if curve.stroke == Stroke::Reference {
            references.push(curve);
        }
        if let Some(entry) = entries.iter().find(|entry| entry.label == curve.label) {
            measured.push(Measured { curve, entry });
        }
    }
    ground(picture, panel, frame);
    picture.group("stroke-dasharray=\"16 12\"", |picture| {
        for curve in &references {
            picture.path(panel.places(frame, curve), MUTED, 1.0);
        }
    });
    picture.group("stroke-dasharray=\"28 16\"", |picture| {
        lines(picture, (panel, frame), &measured, Sample::Dashed);
    });
    lines(picture, (panel, frame), &measured, Sample::Line);
    let mut marks = Vec::new();
    for Measured { curve, entry } in measured {
        marks.extend(panel.places(frame, curve));
        if curve.stroke == Stroke::Marked {
            let radius = if curve.points.len() > 1 { 3.5 } else { LONE };
            for at in panel.places(frame, curve) {
                picture.ring(at, radius, entry.color);
            }
        }
    }
    // Names are above the curves that they meet, with a white edge that keeps them legible.
    picture.group("stroke=\"#FFFFFF\" stroke-width=\"16\" paint-order=\"stroke\"", |picture| {
        for curve in references {
            let ends = panel.places(frame, curve);
            name_reference(picture, &curve.label, &ends, &marks);
        }
    });
    frame.outline(picture);
}

/// Draws the lines of the curves whose entry has this sample.
fn lines(
    picture: &mut Picture,
    (panel, frame): (&Chart, &Frame),
    measured: &[Measured],
    sample: Sample,
) {
    for Measured { curve, entry } in measured {
        if entry.sample == sample && curve.points.len() > 1 {
            picture.path(panel.places(frame, curve), entry.color, 2.0);
        }
    }
}

fn points(panel: &Chart) -> impl Iterator<Item = &(f64, f64)> {
    panel.curves.iter().flat_map(|curve| &curve.points)
}

impl Scale {
    /// Number on the axis that stands for a value: its decimal logarithm, or the value itself.
    fn number(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Logarithmic => decade(value),
        }
    }

    /// Returns the ends of an axis, as numbers on it: around all values with a margin; on a logarithmic axis whole
    /// decades if these are few.
    fn extent(self, values: impl Iterator<Item = f64>) -> (f64, f64) {
        let whole = Range { least: 0.0, greatest: 1.0 };
        let numbers = Range::of(values.map(|value| self.number(value)));
        let Range { least: low, greatest: high } = numbers.unwrap_or(whole);
        let margin = 0.03 * (high - low);
        match self == Self::Logarithmic && high - low < 2.0 {
            true => (libm::floor(low), libm::ceil(high).max(libm::floor(low) + 1.0)),
            false => (low - margin, high + margin),
        }
    }

    /// Returns the numbers to mark on an axis, with their texts, in at most about `most` steps.
    fn ticks(self, ends: (f64, f64), most: usize) -> Vec<(f64, String)> {
        match self {
            Self::Linear => Ticks::inside(ends.0, ends.1, most).labelled().collect(),
            Self::Logarithmic => powers(ends, most),
        }
    }
}

/// Returns the powers of ten to mark on an axis, in at most about `most` steps.
fn powers((low, high): (f64, f64), most: usize) -> Vec<(f64, String)> {
    let (first, last) = (libm::ceil(low - 1e-9) as i32, libm::floor(high + 1e-9) as i32);
    let step = ((last - first) as usize).div_ceil(most.max(1)).max(1);
    // Counted from zero, so that panels with different ends are marked alike.
    (first..=last)
        .filter(|e| e.rem_euclid(step as i32) == 0)
        .map(|e| (f64::from(e), power_of_ten(e)))
        .collect()
}

/// Returns the multiples of powers of ten on an axis of fewer than three decades, which could pass for a linear one
/// without them; none on a longer axis.
fn multiples((low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    let decades = if high - low < 3.0 { low.floor() as i32..high.ceil() as i32 } else { 0..0 };
    let all = decades.flat_map(|e| (2..10).map(move |m| f64::from(e) + libm::log10(f64::from(m))));
    all.filter(move |x| (low..=high).contains(x))
}

/// Draws rules, numbers and names of the axes.
fn ground(picture: &mut Picture, panel: &Chart, frame: &Frame) {
    let across = ((frame.across.1 - frame.across.0) / 62.0) as usize;
    let x = panel.across.ticks(frame.x, across);
    let y = Scale::Logarithmic.ticks(frame.y, 8);
    frame.rules(picture, y.iter().map(|tick| tick.0));
    frame.verticals(picture, x.iter().map(|tick| tick.0), RULE);
    frame.label_left(picture, y);
    frame.label_below(picture, x);
    if panel.across == Scale::Logarithmic {
        for x in multiples(frame.x).map(|x| frame.right(x)) {
            picture.path([(x, frame.down.1), (x, frame.down.1 + 2.5)], INK, 0.75);
        }
    }
    for y in multiples(frame.y).map(|y| frame.up(y)) {
        picture.path([(frame.across.0 - 2.5, y), (frame.across.0, y)], INK, 0.75);
    }
    let (x, y) = frame.middle();
    picture.text(panel.axes[0], (x, frame.down.1 + 32.0), plain(NORMAL));
    picture.text(panel.axes[1], (frame.across.0 - 55.0, y), plain(NORMAL).transform(UPWARDS));
}

impl Chart {
    /// Places of the points of a curve.
    fn places(&self, frame: &Frame, curve: &Curve) -> Vec<Place> {
        let points = curve.points.iter();
        points.map(|p| frame.at(self.across.number(p.0), decade(p.1))).collect()
    }
}

/// Writes the name of a reference beside its middle, on the side that has fewer of the `marks`.
fn name_reference(picture: &mut Picture, name: &str, ends: &[Place], marks: &[Place]) {
    let (&[(x0, y0), ..], &[.., (x1, y1)]) = (ends, ends) else { return };
    let slope = if x1 == x0 { 0.0 } else { (y1 - y0) / (x1 - x0) };
    let above = marks.iter().filter(|(x, y)| *y < y0 + slope * (x - x0)).count();
    let is_below = 2 * above > marks.len();
    let (x, y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1) + if is_below { 11.0 } else { -9.0 });
    let kind = plain(SMALL).color(&MUTED);
    // Left of a line that falls, in the picture, is below it; left of one that rises is above it.
    if (slope > 0.0) == is_below {
        picture.text(name, (x - 6.0, y), kind.pos(END));
    } else {
        picture.text(name, (x + 6.0, y), kind.pos(START));
    }
}
