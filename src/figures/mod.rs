//! Drawing functions of the figures, from data to SVG text: the same bytes for the same data, and no files.
//!
//! Every picture is at most 800 display pixels wide, has light or dark colours like the page around it, and has a title
//! and a description for readers who cannot see it. Central is [`Picture`], to which all drawing functions add shapes.

mod axes;
mod boxes;
mod camera;
mod chart;
mod contact;
mod curves;
mod drawn;
mod extent;
mod floor;
mod gradient;
mod history;
mod identifiability;
mod isolines;
mod maps;
mod mesh_map;
mod palette;
mod panels;
mod picture;
mod plan;
mod polyline;
mod regions;
mod solution_map;
mod square;
mod surface;
pub(crate) mod table;
mod text;
mod title;

pub(crate) use chart::charts;
pub(crate) use contact::contact;
pub(crate) use drawn::DrawnSolution;
pub(crate) use gradient::gradients;
pub(crate) use history::histories;
pub(crate) use identifiability::identifiability;
pub(crate) use maps::maps_of_f;
pub(crate) use mesh_map::map_of_f;
pub(crate) use picture::Picture;
pub(crate) use plan::mesh_picture;
pub(crate) use solution_map::SolutionMap;
pub(crate) use square::{grid, membrane};
pub(crate) use surface::surfaces;
pub(crate) use table::of_surfaces as table_of_surfaces;

use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::identify::Slice;
use signorini_mathematics::mesh::{Condition, PlaneMesh};
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::saddle::Iteration;

/// One panel of [`surfaces`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface<'a> {
    pub(crate) title: &'a str,
    pub(crate) mesh: &'a PlaneMesh,
    /// Law on the boundary.
    pub(crate) law: Law,
    /// Heights at the nodes.
    pub(crate) y: &'a [f64],
    /// Nodes with v = 0 by the law.
    pub(crate) in_contact: &'a [bool],
    /// Azimuth of the viewer, in degrees anticlockwise from the negative y axis; [`uphill`](camera::uphill) hides
    /// least.
    pub(crate) azimuth: f64,
    /// Range of heights and colours; `None` for that of the data and zero.
    pub(crate) range: Option<(f64, f64)>,
}

/// One panel of [`histories`].
#[derive(Clone, Debug)]
pub(crate) struct HistoryPanel<'a> {
    pub(crate) title: &'a str,
    /// Nested grids of every run; grid number k, from 1, has tolerance 10^-k.
    pub(crate) grids: Vec<Grid>,
    pub(crate) runs: Vec<HistoryCurve>,
}

/// Run of the method over nested grids.
#[derive(Clone, Debug)]
pub(crate) struct HistoryCurve {
    /// Name in the legend.
    pub(crate) label: String,
    /// True for the run that is drawn in colour, before the others.
    pub(crate) is_drawn: bool,
    /// Iterations on each grid; fewer grids if the run ended early.
    pub(crate) levels: Vec<Vec<Iteration>>,
}

/// One panel of [`contact`].
#[derive(Clone, Debug)]
pub(crate) struct ContactPanel {
    pub(crate) title: String,
    /// Arc lengths of the nodes of a closed curve of the boundary, from 0 on.
    pub(crate) places: Vec<f64>,
    /// Length of the curve.
    pub(crate) length: f64,
    /// First node, from which arc lengths are counted; none on the square, whose sides and corners are named.
    pub(crate) start: Option<[f64; 2]>,
    /// Condition on the edge behind each node.
    pub(crate) conditions: Vec<Condition>,
    /// Law on the boundary.
    pub(crate) law: Law,
    /// Solutions compared.
    pub(crate) lines: Vec<ContactLine>,
}

/// Solution along the boundary.
#[derive(Clone, Debug)]
pub(crate) struct ContactLine {
    /// Name in the legend.
    pub(crate) label: String,
    /// Solution at the nodes of the curve.
    pub(crate) y: Vec<f64>,
    /// Multiplier, or flux dy/dn, at these nodes.
    pub(crate) a: Vec<f64>,
    /// Contact at these nodes.
    pub(crate) in_contact: Vec<bool>,
}

/// One panel of [`gradients`].
#[derive(Clone, Debug)]
pub(crate) struct GradientPanel<'a> {
    pub(crate) title: &'a str,
    pub(crate) grid: Grid,
    /// Bound of the stopping rule for the components.
    pub(crate) tolerance: f64,
    /// Components of the gradient with respect to y, at the nodes.
    pub(crate) gradient: Vec<f64>,
}

/// One panel of [`identifiability`].
#[derive(Clone, Debug)]
pub(crate) struct IdentifiabilityPanel<'a> {
    pub(crate) title: &'a str,
    /// Counts that come out around the recovered f, which is in the middle.
    pub(crate) slice: &'a Slice,
    /// Number of published counts.
    pub(crate) cells: usize,
    /// Other f to mark, as points of the plane.
    pub(crate) others: Vec<[f64; 2]>,
}

/// One panel of [`charts`], with a logarithmic axis up.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub(crate) title: String,
    /// Names of the axes, with their units: across, up.
    pub(crate) axes: [&'static str; 2],
    /// Scale of the axis across.
    pub(crate) across: Scale,
    /// Curves; one without points is left out.
    pub(crate) curves: Vec<Curve>,
}

impl Chart {
    pub(crate) fn new(
        title: impl Into<String>,
        axes: [&'static str; 2],
        curves: Vec<Curve>,
    ) -> Self {
        Self { title: title.into(), axes, across: Scale::Logarithmic, curves }
    }

    /// This chart with a linear axis across.
    pub(crate) fn linear_across(self) -> Self {
        Self { across: Scale::Linear, ..self }
    }
}

/// Scale of an axis of a [`Chart`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    Linear,
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
}

impl Curve {
    pub(crate) fn new(
        stroke: Stroke,
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        Self { label: label.into(), points: points.into_iter().collect(), stroke }
    }
}

/// Stroke of a [`Curve`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    /// Line with a ring at each point.
    Marked,
    Line,
    /// Thin dashed line in secondary ink, named at its middle and not in the legend: a bound, a slope.
    Reference,
}

/// Words for fixed parts of the boundary.
const FIXED: &str = "fixed (v = 0)";

/// Returns the words for nodes of the boundary with v = 0 by a law.
fn held(law: Law) -> &'static str {
    if law.is_signorini() { "in contact (multiplier a > 0)" } else { "sticks (v = 0)" }
}

/// Returns the decimal logarithm of a value; NaN if the value is not positive, so that the picture is refused.
fn decade(value: f64) -> f64 {
    if value > 0.0 { libm::log10(value) } else { f64::NAN }
}

/// Returns the smallest and the largest of `values` and 0.
pub(crate) fn range_with_zero(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().fold((0.0, 0.0), |(lo, hi): (f64, f64), v| (lo.min(v), hi.max(v)))
}

/// Returns the smallest and the largest of `values`.
fn range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    values.into_iter().fold(none, |(lo, hi), v| (lo.min(v), hi.max(v)))
}

#[cfg(test)]
mod samples;
#[cfg(test)]
mod tests;
