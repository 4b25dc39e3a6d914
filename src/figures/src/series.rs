//! Charts as data: curves over linear or logarithmic axes.

use super::axes::Entry;
use super::text::{Ticks, power_of_ten};

/// Panel with curves.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Title above the panel.
    pub title: String,
    /// Axes across and up.
    pub axes: [Axis; 2],
    /// Curves in the order in which they are drawn; one without points is left out.
    pub curves: Vec<Curve>,
    /// Legend; without entries, each label that is no limit has one.
    pub(super) legend: Vec<Entry>,
}

impl Chart {
    /// Chart with logarithmic axes, whose names, with their units, are given across and up.
    pub fn new(title: impl Into<String>, names: [&str; 2], curves: Vec<Curve>) -> Self {
        let scale = Scale::Logarithmic;
        let axes = names.map(|name| Axis { name: name.into(), scale, ends: None });
        Self { title: title.into(), axes, curves, legend: Vec::new() }
    }

    /// This chart with other scales across and up.
    pub fn scaled(mut self, scales: [Scale; 2]) -> Self {
        for (axis, scale) in self.axes.iter_mut().zip(scales) {
            axis.scale = scale;
        }
        self
    }

    /// Returns the ends of an axis that some charts share, as numbers on it.
    pub(super) fn ends(charts: &[&Self], axis: usize) -> (f64, f64) {
        let points = charts.iter().flat_map(|chart| &chart.curves).flat_map(|curve| &curve.points);
        let Axis { scale, ends, .. } = charts[0].axes[axis];
        ends.unwrap_or_else(|| scale.extent(points.map(|&(x, y)| [x, y][axis])))
    }
}

/// Axis of a [`Chart`].
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name, with the unit.
    pub name: String,
    /// Scale of the numbers.
    pub scale: Scale,
    /// Ends, as numbers on the axis, at which values beyond them are drawn; none for those of the data.
    pub(super) ends: Option<(f64, f64)>,
}

/// Scale of an axis of a [`Chart`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// From the least number to the greatest.
    Linear,
    /// Linear, with whole numbers only.
    Counts,
    /// By powers of ten, of positive numbers.
    Logarithmic,
}

/// A curve of a [`Chart`].
#[derive(Clone, Debug)]
pub struct Curve {
    /// Name in the legend; equal names share a colour across panels, and solvers across pictures.
    pub label: String,
    /// Points in the order in which they are joined.
    pub points: Vec<(f64, f64)>,
    /// Stroke of the line.
    pub stroke: Stroke,
    /// Width of the line in display pixels.
    pub(super) width: f64,
}

impl Curve {
    /// Curve through these points.
    pub fn new(
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
pub enum Stroke {
    /// Line with a ring at each point.
    Marked,
    /// Line alone.
    Line,
    /// Thin dashed line.
    Thin,
    /// Rings without a line.
    Rings,
    /// Dotted line, named at the right end of the frame and not in the legend.
    Limit,
}

impl Stroke {
    /// Attributes of the line; none for a solid one.
    pub(super) fn attributes(self) -> &'static str {
        match self {
            Self::Limit => "stroke-dasharray=\"4 8\"",
            Self::Thin => "stroke-dasharray=\"18 10\"",
            Self::Marked | Self::Line | Self::Rings => "",
        }
    }

    /// True if the curve is in the legend.
    pub(super) fn is_measured(self) -> bool {
        self != Self::Limit
    }
}

impl Axis {
    /// Returns the number on the axis that stands for a value; what is not positive is least on a logarithmic axis with
    /// given ends.
    pub(super) fn number(&self, value: f64) -> f64 {
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
        let numbers: Vec<f64> = values.map(|value| self.number(value)).collect();
        let low = numbers.iter().copied().reduce(f64::min).unwrap_or(0.0);
        let high = numbers.iter().copied().reduce(f64::max).unwrap_or(1.0);
        let margin = 0.03 * (high - low);
        match self == Self::Logarithmic && high - low < 2.0 {
            true => (libm::floor(low), libm::ceil(high).max(libm::floor(low) + 1.0)),
            false => (low - margin, high + margin),
        }
    }

    /// Returns the numbers to mark on an axis, with their texts, in at most about `most` steps.
    pub(super) fn ticks(self, (low, high): (f64, f64), most: usize) -> Vec<(f64, String)> {
        if self != Self::Logarithmic {
            let ticks = Ticks::inside(low, high, most).labelled().into_iter();
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
    pub(super) fn multiples(self, (low, high): (f64, f64)) -> impl Iterator<Item = f64> {
        let is_short = self == Self::Logarithmic && high - low < 3.0;
        let decades = if is_short { low.floor() as i32..high.ceil() as i32 } else { 0..0 };
        let digits = (2..10).map(|digit| libm::log10(f64::from(digit)));
        let all = decades.flat_map(move |e| digits.clone().map(move |log| f64::from(e) + log));
        all.filter(move |x| (low..=high).contains(x))
    }
}
