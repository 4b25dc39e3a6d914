//! Convergence histories: both readings of the stopping criterion against the iterations.

use super::axes::{Entry, Frame, LEGEND_ROW, Legend, Sample, key};
use super::palette::{INK, MUTED, RGBColor, RULE};
use super::picture::{
    LARGE, NORMAL, Picture, Place, SMALL, START, UPWARDS, WIDTH, bold, plain, text_width,
};
use super::table::of_histories;
use super::text::{Ticks, power_of_ten};
use super::title::Title;
use super::{HistoryCurve, HistoryPanel};
use signorini_mathematics::saddle::{Iteration, tolerance};

/// Height of a plot in display pixels.
const PLOT: f64 = 250.0;
/// Left and right end of the plots.
const ACROSS: (f64, f64) = (66.0, 690.0);
/// Colours of the run that is drawn and of the others.
const DRAWN: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
const OTHERS: RGBColor = RGBColor(0x9a, 0xa0, 0xa8);
/// Widest list of the names of the others in the legend.
const MOST_NAMES: f64 = 450.0;
/// Dash patterns of tolerances and of the criterion as printed.
const DOTTED: &str = "stroke-dasharray=\"4 8\"";
const DASHED: &str = "stroke-dasharray=\"18 10\"";

/// Draws the residuals of every run, one panel below the other.
///
/// One run is in colour, the others are grey behind it. Solid: `max_i dM/dy_i` (signed), thick; dashed:
/// `max_i |dM/dy_i|`; both as log10. Values that are zero, negative or far below the last tolerance lie on the lower
/// edge. Rings mark the iteration at which a run left a grid; dotted lines are the tolerances 10^-N of the grids.
pub(crate) fn histories(panels: &[HistoryPanel]) -> Picture {
    let mut picture = Picture::new(WIDTH, 0.0);
    let mut top = 8.0;
    for panel in panels {
        top = draw_panel(&mut picture, panel, top);
    }
    picture.height = top + 32.0;
    let (x, y) = (ACROSS.0, top + 10.0);
    picture.path([(x, y), (x + 28.0, y)], MUTED, 2.0);
    key(&mut picture, (x + 35.0, y), "max \u{2202}M/\u{2202}y, signed");
    key(&mut picture, (x + 227.0, y), "max |\u{2202}M/\u{2202}y|, as printed");
    picture.ring((x + 410.0, y), 4.0, MUTED);
    key(&mut picture, (x + 421.0, y), "end of a grid");
    key(&mut picture, (x + 557.0, y), "tolerance 10\u{207b}\u{1d3a}");
    picture.group(DASHED, |picture| {
        picture.path([(x + 192.0, y), (x + 220.0, y)], MUTED, 1.0);
    });
    picture.group(DOTTED, |picture| {
        picture.path([(x + 522.0, y), (x + 550.0, y)], INK, 1.0);
    });
    picture.table = Some(of_histories(panels));
    picture
}

/// Returns the runs with their colours: first the others, then the one in colour, which lies on top.
fn in_order<'a>(
    panel: &'a HistoryPanel,
) -> impl Iterator<Item = (&'a HistoryCurve, RGBColor)> + use<'a> {
    let others = panel.runs.iter().filter(|run| !run.is_drawn).map(|run| (run, OTHERS));
    others.chain(panel.runs.iter().filter(|run| run.is_drawn).map(|run| (run, DRAWN)))
}

/// Draws a panel, and returns the top of the next one.
fn draw_panel(picture: &mut Picture, panel: &HistoryPanel, top: f64) -> f64 {
    let others: Vec<_> =
        panel.runs.iter().filter(|run| !run.is_drawn).map(|run| &*run.label).collect();
    let (count, mut others) = (others.len(), others.join(", "));
    if text_width(&others, SMALL) > MOST_NAMES {
        others = format!("{count} others");
    }
    let drawn = panel.runs.iter().find(|run| run.is_drawn).map(|run| (&*run.label, DRAWN));
    let entries = drawn.into_iter().chain(Some((&*others, OTHERS)));
    let entries = entries.filter(|(label, _)| !label.is_empty());
    let entries = entries.map(|(label, color)| Entry { label, color, sample: Sample::Line });
    let legend = Legend::of(entries, WIDTH - 90.0);
    let (mut longest, mut largest) = (0, tolerance(1));
    for run in &panel.runs {
        longest = longest.max(run.levels.iter().map(Vec::len).sum());
        for iteration in run.levels.iter().flatten() {
            largest = largest.max(iteration.gradient_abs.max(iteration.gradient_signed));
        }
    }
    // Powers of ten at the lower and the upper edge.
    let low = -(panel.grids.len() as i32) - 1;
    let high = (libm::ceil(libm::log10(largest) + 0.05) as i32).max(low + 1);
    let title = Title::new(panel.title, WIDTH - ACROSS.0 - 8.0);
    let top = top + title.more();
    let plot = top + 34.0 + LEGEND_ROW * legend.rows as f64;
    let frame = Frame {
        across: ACROSS,
        down: (plot, plot + PLOT),
        x: (0.0, longest as f64 * 1.02),
        y: (f64::from(low), f64::from(high)),
    };
    title.draw(picture, (ACROSS.0, top + 14.0), &bold(LARGE).pos(START));
    legend.draw(picture, (ACROSS.0, top + 38.0));
    ground(picture, panel, &frame, (low..=high).step_by(((high - low + 7) / 8).max(1) as usize));
    picture.group(DOTTED, |picture| {
        for k in 1..=panel.grids.len() {
            let y = frame.up(-(k as f64));
            picture.path([(ACROSS.0, y), (ACROSS.1, y)], INK, 1.0);
        }
    });
    picture.group(DASHED, |picture| curves(picture, panel, &frame, 1.0, |i| i.gradient_abs));
    curves(picture, panel, &frame, 2.0, |i| i.gradient_signed);
    for (run, color) in in_order(panel) {
        let mut number = 0;
        for level in &run.levels {
            number += level.len();
            if let Some(last) = level.last() {
                picture.ring(place(&frame, number, last.gradient_signed), 4.0, color);
            }
        }
    }
    frame.outline(picture);
    frame.down.1 + 52.0
}

/// Draws rules, numbers and names of the axes, and the names of the tolerances; `powers` are the powers of ten that are
/// marked.
fn ground(
    picture: &mut Picture,
    panel: &HistoryPanel,
    frame: &Frame,
    powers: impl Iterator<Item = i32> + Clone,
) {
    frame.rules(picture, powers.clone().map(f64::from));
    frame.label_left(picture, powers.map(|e| (f64::from(e), power_of_ten(e))));
    let ticks = Ticks::inside(0.0, frame.x.1, 10);
    frame.verticals(picture, ticks.values(), RULE);
    // Iterations are counted in whole numbers, even where a run is so short that ticks are not.
    frame.label_below(picture, ticks.labelled().filter(|(x, _)| x.fract() == 0.0));
    let (x, y) = frame.middle();
    picture.text("iterations, all grids", (x, frame.down.1 + 31.0), plain(NORMAL));
    picture.text("gradient", (17.0, y), plain(NORMAL).transform(UPWARDS));
    // From the lowest upwards, so that no name covers the one below.
    let mut places: Vec<f64> = (1..=panel.grids.len()).map(|k| frame.up(-(k as f64))).collect();
    for k in (1..places.len()).rev() {
        places[k - 1] = places[k - 1].min(places[k] - SMALL);
    }
    for ((k, grid), y) in (1..).zip(&panel.grids).zip(places) {
        let text = format!("{}  h = 1/{}", power_of_ten(-k), grid.cells());
        picture.text(&text, (ACROSS.1 + 7.0, y), plain(SMALL).pos(START).color(&MUTED));
    }
}

fn place(frame: &Frame, number: usize, value: f64) -> Place {
    let (low, high) = frame.y;
    let y = if value > 0.0 { libm::log10(value).clamp(low, high) } else { low };
    frame.at(number as f64, y)
}

fn curves(
    picture: &mut Picture,
    panel: &HistoryPanel,
    frame: &Frame,
    width: f64,
    residual: fn(&Iteration) -> f64,
) {
    for (run, color) in in_order(panel) {
        let mut places = Vec::new();
        for (number, iteration) in (1..).zip(run.levels.iter().flatten()) {
            places.push(place(frame, number, residual(iteration)));
        }
        let thinned = thinned(&places);
        if thinned.len() > 1 {
            picture.path(thinned, color, width);
        }
    }
}

/// Keeps at most four points per half display pixel across: first, lowest, highest, last.
///
/// All points of long runs would make large files that look the same.
fn thinned(places: &[Place]) -> Vec<Place> {
    let mut kept = Vec::new();
    for run in places.chunk_by(|a, b| column(a) == column(b)) {
        if run.len() <= 4 {
            kept.extend_from_slice(run);
            continue;
        }
        let (mut lowest, mut highest) = (0, 0);
        for (k, (_, y)) in run.iter().enumerate() {
            if y.total_cmp(&run[lowest].1).is_gt() {
                lowest = k;
            }
            if y.total_cmp(&run[highest].1).is_lt() {
                highest = k;
            }
        }
        let mut picks = [0, lowest, highest, run.len() - 1];
        picks.sort_unstable();
        kept.extend(picks.map(|k| run[k]));
    }
    kept
}

/// Returns the number of the half display pixel that holds a place.
fn column(place: &Place) -> i64 {
    (2.0 * place.0) as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_envelope_and_the_order() {
        let places: Vec<Place> =
            (0..100_000).map(|k| (f64::from(k) * 0.006, f64::from((k * 7919) % 1009))).collect();
        let thin = thinned(&places);
        assert!(thin.len() < 5000);
        assert!(thin.is_sorted_by(|a, b| a.0 <= b.0));
        assert_eq!(greatest_height(&thin), greatest_height(&places));
        assert_eq!((thin[0], thin.last()), (places[0], places.last()));
    }

    fn greatest_height(places: &[Place]) -> f64 {
        places.iter().map(|place| place.1).fold(0.0, f64::max)
    }
}
