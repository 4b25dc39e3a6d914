//! Charts in their frames: axes, curves, and names beside them.

use super::axes::{Entry, Frame, LONE, Sample};
use super::palette::{INK, MUTED, RGBColor, RULE};
use super::picture::{NORMAL, Picture, Place, SMALL, START, UPWARDS, plain};
use super::polyline::simplified;
use super::series::{Chart, Curve, Stroke};

/// Chart in its frame.
pub(super) struct Plot<'a> {
    pub(super) chart: &'a Chart,
    /// Frame, with the ends of the axes as numbers on them.
    pub(super) frame: Frame,
    /// Entries of the legend, with the colours of the curves.
    pub(super) entries: &'a [Entry],
}

/// Attributes of the second, third and later lines of a colour.
const DASHED: [&str; 3] =
    ["stroke-dasharray=\"28 16\"", "stroke-dasharray=\"8 14\"", "stroke-dasharray=\"28 14 8 14\""];

impl Plot<'_> {
    /// Draws rules, numbers and names of the axes, the name of the axis up at this distance from the frame.
    pub(super) fn ground(&self, picture: &mut Picture, name: f64) {
        let Frame { across, down, x, y } = self.frame;
        let [x_scale, y_scale] = [0, 1].map(|axis| self.chart.axes[axis].scale);
        let x_ticks = x_scale.ticks(x, ((across.1 - across.0) / 62.0) as usize);
        let y_ticks = y_scale.ticks(y, 8);
        self.frame.rules(picture, y_ticks.iter().map(|tick| tick.0));
        self.frame.verticals(picture, x_ticks.iter().map(|tick| tick.0), RULE);
        self.frame.label_left(picture, y_ticks);
        self.frame.label_below(picture, x_ticks);
        for x in x_scale.multiples(x).map(|x| self.frame.right(x)) {
            picture.path([(x, down.1), (x, down.1 + 2.5)], INK, 0.75);
        }
        for y in y_scale.multiples(y).map(|y| self.frame.up(y)) {
            picture.path([(across.0 - 2.5, y), (across.0, y)], INK, 0.75);
        }
        let ((x, y), [right, up]) = (self.frame.middle(), &self.chart.axes);
        picture.text(&right.name, (x, down.1 + 32.0), plain(NORMAL));
        picture.text(&up.name, (across.0 - name, y), plain(NORMAL).transform(UPWARDS));
    }

    /// Draws curves, with dashes below solid ones, then rings, then the names of limits, and the frame around all.
    pub(super) fn draw(&self, picture: &mut Picture) {
        let below = [Stroke::Limit, Stroke::Thin].map(Stroke::attributes);
        let lines = DASHED.into_iter().chain([Stroke::Line.attributes()]);
        for attributes in below.into_iter().chain(lines) {
            picture.group(attributes, |picture| self.lines(picture, attributes));
        }
        for curve in self.chart.curves.iter().filter(|curve| curve.stroke.is_measured()) {
            let radius = match curve.stroke {
                Stroke::Rings => 4.0,
                Stroke::Marked if self.entry(curve).is_some_and(|it| it.sample == Sample::Ring) => {
                    LONE
                }
                Stroke::Marked => 3.5,
                Stroke::Line | Stroke::Thin | Stroke::Limit => continue,
            };
            for at in self.places(curve) {
                picture.ring(at, radius, self.color(curve));
            }
        }
        self.name_limits(picture);
        self.frame.outline(picture);
    }

    /// Draws the lines with these attributes.
    fn lines(&self, picture: &mut Picture, attributes: &str) {
        for curve in self.chart.curves.iter().filter(|curve| curve.stroke != Stroke::Rings) {
            let own = match self.entry(curve).map(|entry| entry.sample) {
                Some(Sample::Dashed(round)) => DASHED[round.min(DASHED.len() - 1)],
                _ => curve.stroke.attributes(),
            };
            if own == attributes && curve.points.len() > 1 {
                picture.path(simplified(&self.places(curve)), self.color(curve), curve.width);
            }
        }
    }

    fn entry(&self, curve: &Curve) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.label == curve.label)
    }

    fn color(&self, curve: &Curve) -> RGBColor {
        match curve.stroke {
            Stroke::Limit => INK,
            _ => self.entry(curve).map_or(INK, |entry| entry.color),
        }
    }

    /// Returns the places of the points of a curve.
    fn places(&self, curve: &Curve) -> Vec<Place> {
        let [x, y] = &self.chart.axes;
        let points = curve.points.iter();
        points.map(|point| self.frame.at(x.number(point.0), y.number(point.1))).collect()
    }

    /// Writes the names of limits, given from the highest downwards, to the right of the frame, so that none covers the
    /// one below.
    fn name_limits(&self, picture: &mut Picture) {
        let limits = self.chart.curves.iter().filter(|curve| curve.stroke == Stroke::Limit);
        let mut below = f64::INFINITY;
        for (limit, place) in limits.rev().filter_map(|one| Some((one, *self.places(one).last()?)))
        {
            below = place.1.min(below - SMALL);
            let kind = plain(SMALL).pos(START).color(&MUTED);
            picture.text(&limit.label, (self.frame.across.1 + 7.0, below), kind);
        }
    }
}
