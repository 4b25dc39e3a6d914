//! Convergence histories: both readings of the stopping criterion against the iterations.

use super::axes::{Entry, Sample, key};
use super::chart::{Sizes, in_panels};
use super::palette::{INK, MUTED, RGBColor, series};
use super::picture::{Picture, SMALL, text_width};
use super::series::{Axis, Chart, Curve, Scale, Stroke};
use super::table::add;
use super::text::power_of_ten;
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::saddle::{Iteration, tolerance};

/// One panel of [`histories`].
#[derive(Clone, Debug)]
pub struct HistoryPanel<'a> {
    /// Title above the panel.
    pub title: &'a str,
    /// Nested grids of every run; grid number k, from 1, has tolerance 10^-k.
    pub grids: Vec<Grid>,
    /// Runs, a curve each.
    pub runs: Vec<HistoryCurve>,
}

/// Run of the method over nested grids.
#[derive(Clone, Debug)]
pub struct HistoryCurve {
    /// Name in the legend.
    pub label: String,
    /// True for the run that is drawn in colour, before the others.
    pub is_drawn: bool,
    /// Iterations on each grid; fewer grids if the run ended early.
    pub levels: Vec<Vec<Iteration>>,
}

/// Sizes of the panels.
const SIZES: Sizes = Sizes {
    columns: 1,
    beside: (66.0, 110.0),
    title: 14.0,
    gap: 20.0,
    high: 250.0,
    below: 52.0,
    name: 49.0,
    head: 8.0,
    foot: 32.0,
};
/// Colour of the runs that are not drawn in colour.
const OTHERS: RGBColor = RGBColor(0x9a, 0xa0, 0xa8);
/// Widest list of the names of the others in the legend.
const MOST_NAMES: f64 = 450.0;

/// Draws the residuals of every run, one panel below the other.
///
/// One run is in colour, the others are grey behind it. Solid: `max_i dM/dy_i` (signed), thick; dashed:
/// `max_i |dM/dy_i|`; both as log10. Values that are zero, negative or far below the last tolerance lie on the lower
/// edge. Rings mark the iteration at which a run left a grid; dotted lines are the tolerances 10^-N of the grids.
pub fn histories(panels: &[HistoryPanel]) -> Picture {
    let charts: Vec<Chart> = panels.iter().map(chart).collect();
    let mut picture = in_panels(&charts.iter().collect::<Vec<_>>(), false, SIZES);
    let (x, y) = (SIZES.beside.0, picture.height - 22.0);
    picture.path([(x, y), (x + 28.0, y)], MUTED, 2.0);
    key(&mut picture, (x + 35.0, y), "max \u{2202}M/\u{2202}y, signed");
    key(&mut picture, (x + 227.0, y), "max |\u{2202}M/\u{2202}y|, as printed");
    picture.ring((x + 410.0, y), 4.0, MUTED);
    key(&mut picture, (x + 421.0, y), "end of a grid");
    key(&mut picture, (x + 557.0, y), "tolerance 10\u{207b}\u{1d3a}");
    for (stroke, from, color) in [(Stroke::Thin, 192.0, MUTED), (Stroke::Limit, 522.0, INK)] {
        let line = [(x + from, y), (x + from + 28.0, y)];
        picture.group(stroke.attributes(), |picture| picture.path(line, color, 1.0));
    }
    picture.table = Some(of_histories(panels));
    picture
}

/// Returns the chart of a panel: the tolerances, and of each run three curves.
fn chart(panel: &HistoryPanel) -> Chart {
    let (drawn, others): (Vec<_>, Vec<_>) = panel.runs.iter().partition(|run| run.is_drawn);
    let names: Vec<&str> = others.iter().map(|run| &*run.label).collect();
    let mut name_of_others = names.join(", ");
    if text_width(&name_of_others, SMALL) > MOST_NAMES {
        name_of_others = format!("{} others", names.len());
    }
    let (mut longest, mut largest, mut curves) = (0, tolerance(1), Vec::new());
    for run in others.iter().chain(&drawn) {
        let label = if run.is_drawn { &run.label } else { &name_of_others };
        let iterations = (1..).zip(run.levels.iter().flatten());
        let [mut printed, mut signed] = [Vec::new(), Vec::new()];
        for (number, iteration) in iterations {
            largest = largest.max(iteration.gradient_abs.max(iteration.gradient_signed));
            printed.push((f64::from(number), iteration.gradient_abs));
            signed.push((f64::from(number), iteration.gradient_signed));
        }
        longest = longest.max(signed.len());
        let ends = run.levels.iter().scan(0, |end, level| {
            *end += level.len();
            Some(*end)
        });
        let ends: Vec<_> =
            ends.filter_map(|end| signed.get(end.checked_sub(1)?).copied()).collect();
        curves.push(Curve::new(Stroke::Thin, label, printed));
        curves.push(Curve::new(Stroke::Line, label, signed));
        curves.push(Curve::new(Stroke::Rings, label, ends));
    }
    let end = longest as f64 * 1.02;
    for (k, grid) in (1..).zip(&panel.grids) {
        let label = format!("{}  h = 1/{}", power_of_ten(-k), grid.cells());
        let tolerance = libm::exp10(-f64::from(k));
        curves.push(Curve::new(Stroke::Limit, label, [0.0, end].map(|x| (x, tolerance))));
    }
    // Powers of ten at the lower and the upper edge.
    let low = -(panel.grids.len() as f64) - 1.0;
    let high = libm::ceil(libm::log10(largest) + 0.05).max(low + 1.0);
    let mut chart = Chart::new(panel.title, ["iterations, all grids", "gradient"], curves);
    chart = chart.scaled([Scale::Counts, Scale::Logarithmic]);
    let [x, y] = chart.axes;
    chart.axes = [Axis { ends: Some((0.0, end)), ..x }, Axis { ends: Some((low, high)), ..y }];
    let drawn = drawn.first().map(|run| (run.label.clone(), series(1)));
    let entries = drawn.into_iter().chain(Some((name_of_others, OTHERS)));
    let entries = entries.filter(|(label, _)| !label.is_empty());
    chart.legend =
        entries.map(|(label, color)| Entry { label, color, sample: Sample::Line }).collect();
    chart
}

fn of_histories(panels: &[HistoryPanel]) -> String {
    let mut csv = "panel,run,cells,iteration,gradient_signed,gradient_abs,delta_a\n".to_owned();
    for HistoryPanel { title, grids, runs } in panels {
        for HistoryCurve { label, levels, .. } in runs {
            for (grid, iterations) in grids.iter().zip(levels) {
                let numbers = iterations.iter().map(|i| {
                    let [cells, number] = [grid.cells(), i.number].map(|count| count as f64);
                    [cells, number, i.gradient_signed, i.gradient_abs, i.delta_a]
                });
                add(&mut csv, &[title, label], numbers);
            }
        }
    }
    csv
}
