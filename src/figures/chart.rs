//! Charts of measured numbers: panels side by side under one legend, linear or logarithmic axes.

use super::axes::{Frame, LEGEND_ROW, Legend};
use super::palette::{MUTED, RULE, series};
use super::picture::{LARGE, NORMAL, Pen, Picture, Place, SMALL, Type};
use super::text::{Ticks, power_of_ten};
use super::{Axis, Caption, Chart, Curve, FigureError, Scale, Stroke, finite, some};

/// Width of the picture in display pixels.
const WIDTH: f64 = 800.0;
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

/// Draws panels in rows of `columns`, one legend above them all.
///
/// # Errors
/// [`FigureError`] without panels, curves or points, on NaN and infinities, and on numbers that are not
/// positive on a logarithmic axis.
pub fn charts(caption: Caption, columns: usize, panels: &[Chart]) -> Result<String, FigureError> {
    let mut labels: Vec<&str> = Vec::new();
    for panel in some("panels", panels)? {
        for curve in some("curves", panel.curves)? {
            let points = some("points", curve.points)?;
            finite(panel.title, "x", points.iter().map(|p| place(panel.x.scale, p.0)))?;
            finite(panel.title, "y", points.iter().map(|p| place(panel.y.scale, p.1)))?;
            if curve.stroke != Stroke::Reference && !labels.contains(&curve.label) {
                labels.push(curve.label);
            }
        }
    }
    let columns = columns.clamp(1, panels.len());
    let legend = Legend::new(labels.iter().copied(), WIDTH - LEFT - RIGHT);
    let head = if labels.is_empty() { 4.0 } else { 12.0 + LEGEND_ROW * legend.rows as f64 };
    let (wide, high) = (WIDTH / columns as f64, ABOVE + PLOT + BELOW);
    let rows = panels.len().div_ceil(columns);
    let mut picture = Picture::new(WIDTH, head + high * rows as f64);
    if !labels.is_empty() {
        picture.layer("", |pen| legend.draw(pen, (LEFT, 18.0)))?;
    }
    for (k, panel) in panels.iter().enumerate() {
        let (left, top) = (wide * (k % columns) as f64, head + high * (k / columns) as f64);
        let frame = Frame {
            across: (left + LEFT, left + wide - RIGHT),
            down: (top + ABOVE, top + ABOVE + PLOT),
            x: extent(&panel.x, panel.curves, |p| p.0),
            y: extent(&panel.y, panel.curves, |p| p.1),
        };
        picture.layer("", |pen| ground(pen, panel, &frame))?;
        picture.layer("stroke-dasharray=\"16 12\"", |pen| {
            for curve in references(panel) {
                pen.path(places(panel, &frame, curve), MUTED, 1.0);
            }
        })?;
        picture.layer("", |pen| {
            for curve in references(panel) {
                name_reference(pen, panel, &frame, curve);
            }
            for curve in panel.curves {
                let Some(colour) = labels.iter().position(|label| *label == curve.label) else {
                    continue;
                };
                if matches!(curve.stroke, Stroke::Marked | Stroke::Line) && curve.points.len() > 1 {
                    pen.path(places(panel, &frame, curve), series(colour), 2.0);
                }
                if matches!(curve.stroke, Stroke::Marked | Stroke::Rings) {
                    for at in places(panel, &frame, curve) {
                        pen.ring(at, 3.5, series(colour));
                    }
                }
            }
            frame.outline(pen);
        })?;
    }
    Ok(picture.finish(caption))
}

fn references<'a>(panel: &Chart<'a>) -> impl Iterator<Item = &'a Curve<'a>> {
    panel.curves.iter().filter(|curve| curve.stroke == Stroke::Reference)
}

/// Place of a value along an axis; not finite where there is none.
fn place(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Log if value > 0.0 => libm::log10(value),
        Scale::Log => f64::NAN,
    }
}

/// The ends of an axis: all points and the range asked for, with some air, whole decades if they are few.
fn extent(axis: &Axis, curves: &[Curve], pick: impl Fn(&(f64, f64)) -> f64) -> (f64, f64) {
    let shown = curves.iter().flat_map(|curve| curve.points).map(pick);
    let asked = axis.range.into_iter().flat_map(|(low, high)| [low, high]);
    let (low, high) = shown
        .chain(asked)
        .map(|value| place(axis.scale, value))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let air = 0.03 * (high - low).max(1e-6 * high.abs()).max(1e-12);
    match axis.scale {
        Scale::Log if high - low < 2.0 => (libm::floor(low), libm::ceil(high).max(low + 1.0)),
        // A range that was asked for from zero keeps zero at its end.
        Scale::Linear if axis.range.is_some_and(|(from, _)| from == low) => (low, high + air),
        _ => (low - air, high + air),
    }
}

fn ticks(scale: Scale, (low, high): (f64, f64), most: usize) -> Vec<(f64, String)> {
    match scale {
        Scale::Linear => Ticks::inside(low, high, most).labelled().collect(),
        Scale::Log => {
            let (first, last) = (libm::ceil(low - 1e-9) as i32, libm::floor(high + 1e-9) as i32);
            let step = ((last - first) as usize).div_ceil(most.max(1)).max(1);
            // Counted from zero, so that panels with different ends are marked alike.
            (first..=last)
                .filter(|e| e.rem_euclid(step as i32) == 0)
                .map(|e| (f64::from(e), power_of_ten(e)))
                .collect()
        }
    }
}

/// Everything but the data.
fn ground(pen: &mut Pen, panel: &Chart, frame: &Frame) {
    let title = (frame.across.0, frame.down.0 - 14.0);
    pen.text(panel.title, title, Type::size(LARGE).bold().left());
    let across = ((frame.across.1 - frame.across.0) / 62.0) as usize;
    let (x, y) = (ticks(panel.x.scale, frame.x, across), ticks(panel.y.scale, frame.y, 8));
    frame.rules(pen, y.iter().map(|tick| tick.0));
    for (value, _) in &x {
        let x = frame.right(*value);
        pen.path([(x, frame.down.0), (x, frame.down.1)], RULE, 0.75);
    }
    frame.label_left(pen, y);
    frame.label_below(pen, x);
    let middle = 0.5 * (frame.across.0 + frame.across.1);
    pen.text(panel.x.name, (middle, frame.down.1 + 32.0), Type::size(NORMAL));
    let middle = 0.5 * (frame.down.0 + frame.down.1);
    pen.text(panel.y.name, (frame.across.0 - 55.0, middle), Type::size(NORMAL).upwards());
}

fn places(panel: &Chart, frame: &Frame, curve: &Curve) -> Vec<Place> {
    let at = |p: &(f64, f64)| frame.at(place(panel.x.scale, p.0), place(panel.y.scale, p.1));
    curve.points.iter().map(at).collect()
}

/// The name of a reference, beside its middle, on the side where the line is not.
fn name_reference(pen: &mut Pen, panel: &Chart, frame: &Frame, curve: &Curve) {
    let ends = places(panel, frame, curve);
    let (&[(x0, y0), ..], &[.., (x1, y1)]) = (&ends[..], &ends[..]) else { return };
    let (x, y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1) - 9.0);
    let kind = Type::size(SMALL).color(MUTED);
    if (y1 - y0) * (x1 - x0) < 0.0 {
        pen.text(curve.label, (x - 6.0, y), kind.right());
    } else {
        pen.text(curve.label, (x + 6.0, y), kind.left());
    }
}
