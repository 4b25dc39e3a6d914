//! Drawing functions of the figures: from data to SVG text, deterministic to the byte, no files.
//!
//! Every picture is at most 800 display pixels wide, takes light or dark colours as the page that shows
//! it asks for, and carries its title and description for readers who cannot see it.

mod axes;
mod camera;
mod chart;
mod contact;
mod fragility;
mod history;
mod identifiability;
mod maps;
mod palette;
mod panels;
mod picture;
mod regions;
mod strips;
mod surface;
pub(crate) mod table;
mod text;

pub(crate) use camera::View;
pub(crate) use chart::charts;
pub(crate) use contact::contact;
pub(crate) use fragility::fragility;
pub(crate) use history::histories;
pub(crate) use identifiability::identifiability;
pub(crate) use maps::maps_of_f;
pub(crate) use strips::strips;
pub(crate) use surface::surfaces;

use crate::discrete::grid::Grid;
use crate::identify::Slice;
use crate::saddle::{Iteration, Pair};

/// What a picture says about itself to readers who cannot see it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Caption<'a> {
    /// One line: what is shown.
    pub(crate) title: &'a str,
    /// How it was made: command, inputs, hashes.
    pub(crate) description: &'a str,
}

/// A picture, and what it shows as a table where that is more than the data it is drawn from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Drawing {
    pub(crate) svg: String,
    /// CSV with a header line.
    pub(crate) table: Option<String>,
}

/// One panel of [`surfaces`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface<'a> {
    pub(crate) title: &'a str,
    pub(crate) grid: Grid,
    /// Nodal vector: the height v, dimensionless.
    pub(crate) y: &'a [f64],
    /// Boundary vector: where the multiplier is positive, the boundary is drawn as in contact.
    pub(crate) a: &'a [f64],
    /// From where it is seen; [`View::uphill`] hides least.
    pub(crate) view: View,
    /// The range of heights and colours; without one, that of the data and zero.
    pub(crate) range: Option<(f64, f64)>,
}

/// One panel of [`histories`].
#[derive(Clone, Debug)]
pub(crate) struct HistoryPanel<'a> {
    pub(crate) title: &'a str,
    /// The nested grids of every curve; the k-th, from 1, has tolerance 10^-k.
    pub(crate) grids: &'a [Grid],
    pub(crate) curves: Vec<History>,
}

/// The residuals of one run over nested grids.
#[derive(Clone, Debug)]
pub(crate) struct History {
    /// Name in the legend, such as `r = 10`.
    pub(crate) label: String,
    /// Iterations on each grid of the panel, coarsest first; fewer entries if the run ended early.
    pub(crate) levels: Vec<Vec<Iteration>>,
}

/// One panel of [`contact`].
#[derive(Clone, Debug)]
pub(crate) struct ContactPanel<'a> {
    pub(crate) title: &'a str,
    pub(crate) grid: Grid,
    /// The solutions compared: name in the legend, y, and the multiplier a or the flux dy/dn.
    pub(crate) lines: Vec<(String, Pair)>,
}

/// One panel of [`identifiability`].
#[derive(Clone, Debug)]
pub(crate) struct IdentifiabilityPanel<'a> {
    pub(crate) title: &'a str,
    /// Counts that come out around the recovered f, which is in the middle.
    pub(crate) slice: &'a Slice,
    pub(crate) cells: usize,
    /// Other f to mark, as points of the plane.
    pub(crate) others: Vec<[f64; 2]>,
}

/// One panel of [`charts`], with logarithmic axes.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub(crate) title: String,
    /// Names of the axes, with their units: across, up.
    pub(crate) axes: [&'static str; 2],
    /// What is plotted; a curve without points is left out.
    pub(crate) curves: Vec<Curve>,
}

impl Chart {
    pub(crate) fn new(
        title: impl Into<String>,
        axes: [&'static str; 2],
        curves: Vec<Curve>,
    ) -> Self {
        Self { title: title.into(), axes, curves }
    }
}

/// A curve of a [`Chart`].
#[derive(Clone, Debug)]
pub(crate) struct Curve {
    /// Name in the legend; equal names share a colour across panels, and solvers across pictures.
    pub(crate) label: String,
    /// Points in the order in which they are joined.
    pub(crate) points: Vec<(f64, f64)>,
    pub(crate) stroke: Stroke,
}

impl Curve {
    fn new(
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
        stroke: Stroke,
    ) -> Self {
        Self { label: label.into(), points: points.into_iter().collect(), stroke }
    }

    /// A curve with a ring at each point.
    pub(crate) fn marked(
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        Self::new(label, points, Stroke::Marked)
    }

    pub(crate) fn line(
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        Self::new(label, points, Stroke::Line)
    }

    /// A curve to compare others with.
    pub(crate) fn reference(
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        Self::new(label, points, Stroke::Reference)
    }
}

/// How a [`Curve`] is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// A line with a ring at each point.
    Marked,
    Line,
    /// A thin dashed line in secondary ink, named at its right end and not in the legend: a bound, a slope.
    Reference,
}

/// Why data cannot be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(crate) enum FigureError {
    #[error("figure has no {0} to draw; pass at least one")]
    Empty(&'static str),
    /// Data that are no numbers, or do not fit together: the panel, and what is wrong in it.
    #[error("`{0}`: {1}")]
    Wrong(String, String),
}

fn not_empty<'a, T>(what: &'static str, items: &'a [T]) -> Result<&'a [T], FigureError> {
    if items.is_empty() {
        return Err(FigureError::Empty(what));
    }
    Ok(items)
}

fn finite(
    panel: &str,
    what: &str,
    values: impl IntoIterator<Item = f64>,
) -> Result<(), FigureError> {
    match values.into_iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(FigureError::Wrong(
            panel.into(),
            format!("entry {index} of {what} is not a finite number; solve again before drawing"),
        )),
    }
}

/// Refuses another number of entries than its grid wants.
fn length(panel: &str, what: &str, got: usize, want: usize) -> Result<(), FigureError> {
    let wrong = || format!("{what} has {got} entries, its grid wants {want}");
    if got == want { Ok(()) } else { Err(FigureError::Wrong(panel.into(), wrong())) }
}

/// Refuses a vector of another length than `want`, NaN and infinities.
fn vector(panel: &str, what: &str, values: &[f64], want: usize) -> Result<(), FigureError> {
    length(panel, what, values.len(), want)?;
    finite(panel, what, values.iter().copied())
}

/// The power of ten of a value on a logarithmic scale; not finite where there is none.
fn decade(value: f64) -> f64 {
    if value > 0.0 { libm::log10(value) } else { f64::NAN }
}

/// Smallest and largest of `values`, 0 included.
pub(crate) fn range_with_zero(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().fold((0.0, 0.0), |(lo, hi): (f64, f64), v| (lo.min(v), hi.max(v)))
}

#[cfg(test)]
mod samples;
#[cfg(test)]
mod tests;
