//! Charts of measured numbers: panels side by side under one legend, logarithmic axes.

use super::axes::{Entry, Frame, LEGEND_ROW, Legend};
use super::palette::{MUTED, RULE, series, solver};
use super::picture::{
    END, LARGE, NORMAL, Picture, Place, SMALL, START, UPWARDS, WIDTH, bold, plain,
};
use super::table::of_charts;
use super::text::power_of_ten;
use super::{Chart, Curve, Stroke, decade};

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

/// Draws panels, two in a row, one legend above them all; with `alike`, one range for all heights.
///
/// Panels without points are left out.
pub(crate) fn charts(alike: bool, panels: &[Chart]) -> Picture {
    let panels: Vec<_> = panels.iter().filter(|panel| points(panel).next().is_some()).collect();
    let mut labels: Vec<&str> = Vec::new();
    for curve in panels.iter().flat_map(|panel| &panel.curves) {
        let named = curve.stroke != Stroke::Reference && !curve.points.is_empty();
        if named && !labels.contains(&&*curve.label) {
            labels.push(&curve.label);
        }
    }
    let entries = entries(&labels);
    let columns = panels.len().clamp(1, 2);
    let legend = Legend::of(entries.iter().copied(), WIDTH - LEFT - RIGHT);
    let head = 12.0 + LEGEND_ROW * legend.rows as f64;
    let (wide, high) = (WIDTH / columns as f64, ABOVE + PLOT + BELOW);
    let rows = panels.len().div_ceil(columns);
    let mut picture = Picture::new(WIDTH, head + high * rows as f64);
    legend.draw(&mut picture, (LEFT, 18.0));
    let heights = extent(panels.iter().flat_map(|panel| points(panel)).map(|p| p.1));
    for (k, panel) in panels.iter().enumerate() {
        let (left, top) = (wide * (k % columns) as f64, head + high * (k / columns) as f64);
        let frame = Frame {
            across: (left + LEFT, left + wide - RIGHT),
            down: (top + ABOVE, top + ABOVE + PLOT),
            x: extent(points(panel).map(|p| p.0)),
            y: if alike { heights } else { extent(points(panel).map(|p| p.1)) },
        };
        draw(&mut picture, panel, &frame, &entries);
    }
    picture.table = Some(of_charts(&panels));
    picture
}

/// A colour for each label: that of its solver, or one that no solver here has. A solver that occurs
/// under several names is dashed from the second on.
fn entries<'a>(labels: &[&'a str]) -> Vec<Entry<'a>> {
    let taken: Vec<usize> = labels.iter().filter_map(|label| solver(label)).collect();
    let mut free = (0..).filter(|place| !taken.contains(place));
    let mut seen = Vec::new();
    let mut entry = |label: &'a str| {
        let place = solver(label).unwrap_or_else(|| free.next().unwrap_or(0));
        let dashed = seen.contains(&place);
        seen.push(place);
        Entry { label, color: series(place), dashed }
    };
    labels.iter().map(|label| entry(label)).collect()
}

fn draw(picture: &mut Picture, panel: &Chart, frame: &Frame, entries: &[Entry]) {
    let curves = || panel.curves.iter().filter(|curve| !curve.points.is_empty());
    let references = || curves().filter(|curve| curve.stroke == Stroke::Reference);
    let entry = |curve: &Curve| entries.iter().find(|entry| entry.label == curve.label);
    let measured = || curves().filter_map(|curve| Some((curve, entry(curve)?)));
    let line = |picture: &mut Picture, dashed: bool| {
        for (curve, entry) in measured().filter(|(_, entry)| entry.dashed == dashed) {
            if curve.points.len() > 1 {
                picture.path(places(frame, curve), entry.color, 2.0);
            }
        }
    };
    ground(picture, panel, frame);
    picture.group("stroke-dasharray=\"16 12\"", |picture| {
        for curve in references() {
            picture.path(places(frame, curve), MUTED, 1.0);
        }
    });
    picture.group("stroke-dasharray=\"28 16\"", |picture| line(picture, true));
    for curve in references() {
        name_reference(picture, frame, curve);
    }
    line(picture, false);
    for (curve, entry) in measured().filter(|(curve, _)| curve.stroke == Stroke::Marked) {
        // A point that no line leads to must be seen.
        let radius = if curve.points.len() > 1 { 3.5 } else { 6.0 };
        for at in places(frame, curve) {
            picture.ring(at, radius, entry.color);
        }
    }
    frame.outline(picture);
}

fn points(panel: &Chart) -> impl Iterator<Item = &(f64, f64)> {
    panel.curves.iter().flat_map(|curve| &curve.points)
}

/// The ends of an axis: all values with some air, whole decades if they are few.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let ends = values.map(|value| (decade(value), decade(value)));
    let (low, high) = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or((0.0, 1.0));
    let air = 0.03 * (high - low);
    match high - low < 2.0 {
        true => (libm::floor(low), libm::ceil(high).max(libm::floor(low) + 1.0)),
        false => (low - air, high + air),
    }
}

fn ticks((low, high): (f64, f64), most: usize) -> Vec<(f64, String)> {
    let (first, last) = (libm::ceil(low - 1e-9) as i32, libm::floor(high + 1e-9) as i32);
    let step = ((last - first) as usize).div_ceil(most.max(1)).max(1);
    // Counted from zero, so that panels with different ends are marked alike.
    (first..=last)
        .filter(|e| e.rem_euclid(step as i32) == 0)
        .map(|e| (f64::from(e), power_of_ten(e)))
        .collect()
}

/// Everything but the data.
fn ground(picture: &mut Picture, panel: &Chart, frame: &Frame) {
    let title = (frame.across.0, frame.down.0 - 14.0);
    picture.text(&panel.title, title, bold(LARGE).pos(START));
    let across = ((frame.across.1 - frame.across.0) / 62.0) as usize;
    let (x, y) = (ticks(frame.x, across), ticks(frame.y, 8));
    frame.rules(picture, y.iter().map(|tick| tick.0));
    frame.verticals(picture, x.iter().map(|tick| tick.0), RULE);
    frame.label_left(picture, y);
    frame.label_below(picture, x);
    let (x, y) = frame.middle();
    picture.text(panel.axes[0], (x, frame.down.1 + 32.0), plain(NORMAL));
    picture.text(panel.axes[1], (frame.across.0 - 55.0, y), plain(NORMAL).transform(UPWARDS));
}

fn places(frame: &Frame, curve: &Curve) -> Vec<Place> {
    curve.points.iter().map(|p| frame.at(decade(p.0), decade(p.1))).collect()
}

/// The name of a reference, beside its middle, on the side where the line is not.
fn name_reference(picture: &mut Picture, frame: &Frame, curve: &Curve) {
    let ends = places(frame, curve);
    let (&[(x0, y0), ..], &[.., (x1, y1)]) = (&ends[..], &ends[..]) else { return };
    let (x, y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1) - 9.0);
    let kind = plain(SMALL).color(&MUTED);
    if (y1 - y0) * (x1 - x0) < 0.0 {
        picture.text(&curve.label, (x - 6.0, y), kind.pos(END));
    } else {
        picture.text(&curve.label, (x + 6.0, y), kind.pos(START));
    }
}
