//! Charts: panels of curves over linear or logarithmic axes.

use super::axes::{Entry, Frame, LONE, Legend, Sample};
use super::palette::{INK, MUTED, RGBColor, RULE, series, solver};
use super::panels::{Head, Panels};
use super::picture::{END, NORMAL, Picture, Place, SMALL, START, UPWARDS, WIDTH, plain};
use super::polyline::thinned;
use super::table::of_charts;
use super::text::{Ticks, power_of_ten};
use super::title::Title;
use signorini_mathematics::experiments::Range;

/// Panel with curves.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub(crate) title: String,
    /// Axes across and up.
    pub(crate) axes: [Axis; 2],
    /// Curves in the order in which they are drawn; one without points is left out.
    pub(crate) curves: Vec<Curve>,
    /// Legend; without entries, each label that is no reference has one.
    pub(super) legend: Vec<Entry>,
}

impl Chart {
    /// Chart with logarithmic axes, whose names, with their units, are given across and up.
    pub(crate) fn new(title: impl Into<String>, names: [&str; 2], curves: Vec<Curve>) -> Self {
        let scale = Scale::Logarithmic;
        let axes = names.map(|name| Axis { name: name.into(), scale, ends: None });
        Self { title: title.into(), axes, curves, legend: Vec::new() }
    }

    /// This chart with other scales across and up.
    pub(crate) fn scaled(mut self, scales: [Scale; 2]) -> Self {
        for (axis, scale) in self.axes.iter_mut().zip(scales) {
            axis.scale = scale;
        }
        self
    }

    /// Returns the ends of an axis that some charts share, as numbers on it.
    fn ends(charts: &[&Self], axis: usize) -> (f64, f64) {
        let points = charts.iter().flat_map(|chart| &chart.curves).flat_map(|curve| &curve.points);
        let Axis { scale, ends, .. } = charts[0].axes[axis];
        ends.unwrap_or_else(|| scale.extent(points.map(|&(x, y)| [x, y][axis])))
    }
}

/// Axis of a [`Chart`].
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    pub(crate) name: String,
    pub(crate) scale: Scale,
    /// Ends, as numbers on the axis, at which values beyond them are drawn; none for those of the data.
    pub(super) ends: Option<(f64, f64)>,
}

/// Scale of an [`Axis`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    Linear,
    /// Linear, with whole numbers only.
    Counts,
    Logarithmic,
}

/// A curve of a [`Chart`].
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    /// Name in the legend; equal names share a colour across panels, and solvers across pictures.
    pub(crate) label: String,
    /// Points in the order in which they are joined.
    pub(crate) points: Vec<(f64, f64)>,
    pub(crate) stroke: Stroke,
    /// Width of the line in display pixels.
    pub(super) width: f64,
}

impl Curve {
    pub(crate) fn new(
        stroke: Stroke,
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        let width = if matches!(stroke, Stroke::Marked | Stroke::Line) { 2.0 } else { 1.0 };
        Self { label: label.into(), points: points.into_iter().collect(), stroke, width }
    }
}

/// Stroke of a [`Curve`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// Line with a ring at each point.
    Marked,
    Line,
    /// Thin dashed line.
    Thin,
    /// Rings without a line.
    Rings,
    /// Thin dashed line in secondary ink, named at its middle and not in the legend: a bound, a slope.
    Reference,
    /// Dotted line, named at the right end of the frame and not in the legend.
    Limit,
}

impl Stroke {
    /// Attributes of the line; none for a solid one.
    pub(super) fn attributes(self) -> &'static str {
        match self {
            Self::Reference => "stroke-dasharray=\"16 12\"",
            Self::Limit => "stroke-dasharray=\"4 8\"",
            Self::Thin => "stroke-dasharray=\"18 10\"",
            Self::Marked | Self::Line | Self::Rings => "",
        }
    }

    /// True if the curve is in the legend.
    fn is_measured(self) -> bool {
        !matches!(self, Self::Reference | Self::Limit)
    }
}

/// Sizes of panels with charts, in display pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    /// Most panels in a row.
    pub(super) columns: usize,
    /// Room to the left and right of a plot.
    pub(super) beside: (f64, f64),
    /// Distance of the middle of a title from the top of its panel.
    pub(super) title: f64,
    /// Distance of a title above a legend from the plot, without the legend.
    pub(super) gap: f64,
    /// Height of a plot, and of the room below it.
    pub(super) high: f64,
    pub(super) below: f64,
    /// Distance of the name of the axis up from the plot.
    pub(super) name: f64,
    /// Room above and below all panels.
    pub(super) head: f64,
    pub(super) foot: f64,
}

/// Sizes of charts of measured numbers.
const MEASURED: Sizes = Sizes {
    columns: 2,
    beside: (66.0, 18.0),
    title: 16.0,
    gap: 26.0,
    high: 260.0,
    below: 50.0,
    name: 55.0,
    head: 0.0,
    foot: 0.0,
};
/// Distance of a title from the plot if there is no legend between them.
const NEAR: f64 = 14.0;
/// Greatest width of a legend.
pub(super) const LEGEND: f64 = WIDTH - 90.0;

/// Draws panels, two in a row, one legend above them all; with `alike`, all vertical axes have the same range.
///
/// Panels without points are left out.
pub(crate) fn charts(alike: bool, panels: &[Chart]) -> Picture {
    let mut shown: Vec<&Chart> = panels.iter().collect();
    shown.retain(|panel| panel.curves.iter().any(|curve| !curve.points.is_empty()));
    let mut picture = in_panels(&shown, alike, MEASURED);
    picture.table = Some(of_charts(&shown));
    picture
}

/// Draws panels: in one column with a legend each, below its title, otherwise with a legend above them all.
pub(super) fn in_panels(panels: &[&Chart], alike: bool, sizes: Sizes) -> Picture {
    let Sizes { beside, title, high, below, head, foot, .. } = sizes;
    let columns = panels.len().clamp(1, sizes.columns);
    let wide = WIDTH / columns as f64 - beside.0 - beside.1;
    let (mut heads, mut entries) = (Vec::new(), Vec::new());
    for (k, panel) in panels.iter().enumerate() {
        entries.push(legend(if columns == 1 { &panels[k..=k] } else { panels }));
        let own = if columns == 1 { (entries[k].clone(), sizes.gap) } else { (Vec::new(), NEAR) };
        let (legend, gap) = (Legend::of(own.0, LEGEND), own.1);
        heads.push(Head { title: Title::new(&panel.title, wide + beside.1 - 8.0), legend, gap });
    }
    let common = entries.first().filter(|_| columns > 1).cloned().unwrap_or_default();
    let common = Legend::of(common, LEGEND);
    let head = if columns > 1 { 12.0 + common.high() } else { head };
    let heights = heads.iter().map(|head| [title + head.high(), high, below]).collect();
    let layout = Panels { columns, wide, beside, head, foot, heights, ..Panels::default() };
    let mut picture = layout.picture();
    common.draw(&mut picture, (beside.0, 18.0));
    for (k, &chart) in panels.iter().enumerate() {
        let up = if alike { panels } else { &panels[k..=k] };
        let frame = layout.frame(k, Chart::ends(&panels[k..=k], 0), Chart::ends(up, 1));
        heads[k].draw(&mut picture, &frame);
        let plot = Plot { chart, frame, entries: &entries[k] };
        plot.ground(&mut picture, sizes.name);
        plot.draw(&mut picture);
    }
    picture
}

/// Returns the legend that some panels have together.
///
/// If none is given, each label has an entry: with the colour of its solver, or a colour that no solver in the panels
/// has. The second and later labels of a solver are dashed; a label whose curves are single points is a ring.
pub(super) fn legend(panels: &[&Chart]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = panels.iter().flat_map(|panel| panel.legend.clone()).collect();
    if !entries.is_empty() {
        return entries;
    }
    let curves: Vec<&Curve> = panels.iter().flat_map(|panel| &panel.curves).collect();
    let mut labels: Vec<&str> = Vec::new();
    for curve in &curves {
        let named = curve.stroke.is_measured() && !curve.points.is_empty();
        if named && !labels.contains(&&*curve.label) {
            labels.push(&curve.label);
        }
    }
    let taken: Vec<usize> = labels.iter().filter_map(|label| solver(label)).collect();
    let mut free = (0..).filter(|place| !taken.contains(place));
    let mut seen = Vec::new();
    for label in labels {
        let place = solver(label).unwrap_or_else(|| free.next().unwrap_or(0));
        let has_line = curves.iter().any(|curve| curve.label == label && curve.points.len() > 1);
        let sample = match (has_line, seen.contains(&place)) {
            (false, _) => Sample::Ring,
            (true, true) => Sample::Dashed,
            (true, false) => Sample::Line,
        };
        seen.push(place);
        entries.push(Entry { label: label.into(), color: series(place), sample });
    }
    entries
}

/// Chart in its frame.
pub(super) struct Plot<'a> {
    pub(super) chart: &'a Chart,
    /// Frame, with the ends of the axes as numbers on them.
    pub(super) frame: Frame,
    /// Entries of the legend, with the colours of the curves.
    pub(super) entries: &'a [Entry],
}

/// Attributes of the second and later lines of a solver.
const SECOND: &str = "stroke-dasharray=\"28 16\"";

impl Plot<'_> {
    /// Draws rules, numbers and names of the axes, the name of the axis up at this distance from the frame.
    fn ground(&self, picture: &mut Picture, name: f64) {
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

    /// Draws curves, with dashes below solid ones, then rings, then the names of lines, and the frame around all.
    pub(super) fn draw(&self, picture: &mut Picture) {
        let below = [Stroke::Reference, Stroke::Limit, Stroke::Thin].map(Stroke::attributes);
        for attributes in below.into_iter().chain([SECOND, Stroke::Line.attributes()]) {
            picture.group(attributes, |picture| self.lines(picture, attributes));
        }
        let mut marks = Vec::new();
        for curve in self.chart.curves.iter().filter(|curve| curve.stroke.is_measured()) {
            let places = self.places(curve);
            marks.extend(places.clone());
            let radius = match curve.stroke {
                Stroke::Rings => 4.0,
                Stroke::Marked if places.len() > 1 => 3.5,
                Stroke::Marked => LONE,
                Stroke::Line | Stroke::Thin | Stroke::Reference | Stroke::Limit => continue,
            };
            for at in places {
                picture.ring(at, radius, self.color(curve));
            }
        }
        // Names are above the curves that they meet, with a white edge that keeps them legible.
        let edge = "stroke=\"#FFFFFF\" stroke-width=\"16\" paint-order=\"stroke\"";
        picture.group(edge, |picture| {
            for curve in self.chart.curves.iter().filter(|one| one.stroke == Stroke::Reference) {
                name_reference(picture, &curve.label, &self.places(curve), &marks);
            }
        });
        self.name_limits(picture);
        self.frame.outline(picture);
    }

    /// Draws the lines with these attributes.
    fn lines(&self, picture: &mut Picture, attributes: &str) {
        for curve in self.chart.curves.iter().filter(|curve| curve.stroke != Stroke::Rings) {
            let is_second = self.entry(curve).is_some_and(|one| one.sample == Sample::Dashed);
            let own = if is_second { SECOND } else { curve.stroke.attributes() };
            if own == attributes && curve.points.len() > 1 {
                picture.path(thinned(&self.places(curve)), self.color(curve), curve.width);
            }
        }
    }

    fn entry(&self, curve: &Curve) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.label == curve.label)
    }

    fn color(&self, curve: &Curve) -> RGBColor {
        match curve.stroke {
            Stroke::Reference => MUTED,
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

impl Axis {
    /// Returns the number on the axis that stands for a value; what is not positive is least on a logarithmic axis with
    /// given ends.
    fn number(&self, value: f64) -> f64 {
        let number = self.scale.number(value);
        match self.ends {
            Some((low, _)) if number.is_nan() => low,
            Some((low, high)) => number.clamp(low, high),
            None => number,
        }
    }
}

impl Scale {
    /// Returns the number on the axis that stands for a value: its decimal logarithm, or the value itself. What is not
    /// positive has no logarithm, so that the picture is refused.
    fn number(self, value: f64) -> f64 {
        match self {
            Self::Linear | Self::Counts => value,
            Self::Logarithmic if value > 0.0 => libm::log10(value),
            Self::Logarithmic => f64::NAN,
        }
    }

    /// Returns the ends of an axis, as numbers on it: around all values with a margin; on a logarithmic axis whole
    /// decades if these are few.
    fn extent(self, values: impl Iterator<Item = f64>) -> (f64, f64) {
        let numbers = Range::of(values.map(|value| self.number(value)));
        let whole = Range { least: 0.0, greatest: 1.0 };
        let Range { least: low, greatest: high } = numbers.unwrap_or(whole);
        let margin = 0.03 * (high - low);
        match self == Self::Logarithmic && high - low < 2.0 {
            true => (libm::floor(low), libm::ceil(high).max(libm::floor(low) + 1.0)),
            false => (low - margin, high + margin),
        }
    }

    /// Returns the numbers to mark on an axis, with their texts, in at most about `most` steps.
    fn ticks(self, (low, high): (f64, f64), most: usize) -> Vec<(f64, String)> {
        if self != Self::Logarithmic {
            let ticks = Ticks::inside(low, high, most);
            let ticks = ticks.labelled();
            return ticks.filter(|(x, _)| self == Self::Linear || x.fract() == 0.0).collect();
        }
        let (first, last) = (libm::ceil(low - 1e-9) as i32, libm::floor(high + 1e-9) as i32);
        let step = ((last - first) as usize).div_ceil(most.max(1)).max(1);
        // Counted from zero, so that panels with different ends are marked alike.
        let marked = (first..=last).filter(|e| e.rem_euclid(step as i32) == 0);
        marked.map(|e| (f64::from(e), power_of_ten(e))).collect()
    }

    /// Returns the multiples of powers of ten on a logarithmic axis of fewer than three decades, which could pass for a
    /// linear one without them; none on a longer axis.
    fn multiples(self, (low, high): (f64, f64)) -> impl Iterator<Item = f64> {
        let is_short = self == Self::Logarithmic && high - low < 3.0;
        let decades = if is_short { low.floor() as i32..high.ceil() as i32 } else { 0..0 };
        let digits = (2..10).map(|digit| libm::log10(f64::from(digit)));
        let all = decades.flat_map(move |e| digits.clone().map(move |log| f64::from(e) + log));
        all.filter(move |x| (low..=high).contains(x))
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
