#![doc = include_str!("../README.md")]

mod axes;
mod boxes;
mod camera;
mod chart;
mod contact;
mod drawn;
mod extent;
mod floor;
mod gradient;
mod history;
mod identifiability;
mod isolines;
mod maps;
mod palette;
mod panels;
mod picture;
mod plan;
mod plot;
mod polyline;
mod print;
mod regions;
mod series;
mod solution_map;
mod surface;
mod table;
mod text;
mod title;

pub use chart::{axes_alone, charts};
pub use contact::{ContactPanel, contact};
pub use drawn::DrawnSolution;
pub use gradient::{GradientPanel, gradients};
pub use history::{HistoryCurve, HistoryPanel, histories};
pub use identifiability::{IdentifiabilityPanel, identifiability};
pub use maps::{map_of_f, maps_of_f};
pub use picture::Picture;
pub use plan::mesh_picture;
pub use print::{Print, Width};
pub use series::{Chart, Curve, Scale, Stroke};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::problem::law::Law;
pub use solution_map::SolutionMap;
pub use surface::{surfaces, table_of_surfaces};

/// Refusal of what has no picture.
const IN_SPACE: &str = "a solution in space has no picture";

/// Words for fixed parts of the boundary, where v is 0 and where it is not.
const FIXED: [&str; 2] = ["fixed (v = 0)", "fixed"];
/// Words for nodes of the boundary that stick: under obstacles, where v is then 0, and where it is not.
const HELD: [&str; 3] = ["in contact (multiplier a > 0)", "sticks (v = 0)", "sticks"];

/// Returns the words for fixed parts among those with these laws; none without any.
fn fixed(laws: impl Iterator<Item = Law>) -> Option<&'static str> {
    let values = laws.filter(|law| law.is_fixed()).map(Law::at);
    values.map(|at| FIXED[usize::from(at != 0.0)]).max_by_key(|words| *words == FIXED[1])
}

/// Returns the words for nodes of the boundary that stick.
fn held(problem: &Problem) -> &'static str {
    let has_values = problem.levels().laws().iter().any(|(_, law)| law.at() != 0.0);
    HELD[if problem.has_contact() { 0 } else { 1 + usize::from(has_values) }]
}

/// Returns the smallest and the largest of `values` and 0.
fn range_with_zero(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
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
