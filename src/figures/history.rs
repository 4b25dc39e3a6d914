//! Convergence histories: both readings of the stopping criterion against the iterations.

use super::axes::{Frame, LEGEND_ROW, Legend, key};
use super::palette::{INK, MUTED, RULE, series};
use super::picture::{LARGE, NORMAL, Picture, Place, SMALL, Type, WIDTH};
use super::table::of_histories;
use super::text::{Ticks, power_of_ten};
use super::{Caption, Drawing, FigureError, History, HistoryPanel, finite, not_empty};
use crate::saddle::{Iteration, tolerance};

/// Height of a plot in display pixels.
const PLOT: f64 = 250.0;
/// Left and right end of the plots.
const ACROSS: (f64, f64) = (66.0, 690.0);

/// Draws the residuals of every run, one panel below the other.
///
/// Solid: `max_i dM/dy_i` (signed), thick; dashed: `max_i |dM/dy_i|`; both as log10. Values that are
/// zero, negative or far below the last tolerance lie on the lower edge. Rings mark the iteration at
/// which a run left a grid; dotted lines are the tolerances 10^-N of the grids.
pub(crate) fn histories(caption: Caption, panels: &[HistoryPanel]) -> Result<Drawing, FigureError> {
    for panel in not_empty("panels", panels)? {
        not_empty("grids", panel.grids)?;
        for curve in not_empty("curves", &panel.curves)? {
            let shown = || curve.levels.iter().flatten();
            finite(panel.title, "max dM/dy", shown().map(|i| i.gradient_signed))?;
            finite(panel.title, "max |dM/dy|", shown().map(|i| i.gradient_abs))?;
        }
    }
    let mut picture = Picture::new(WIDTH, 0.0);
    let mut top = 8.0;
    for panel in panels {
        let plan = Plan::new(panel)?;
        let frame = plan.frame(top);
        plan.ground(&mut picture, &frame, top);
        picture.group("stroke-dasharray=\"4 8\"", |picture| plan.tolerances(picture, &frame));
        picture.group("stroke-dasharray=\"18 10\"", |picture| {
            plan.curves(picture, &frame, 1.0, |i| i.gradient_abs);
        });
        plan.curves(&mut picture, &frame, 2.0, |i| i.gradient_signed);
        plan.rings(&mut picture, &frame);
        frame.outline(&mut picture);
        top = frame.down.1 + 52.0;
    }
    picture.height = top + 32.0;
    let (x, y) = (ACROSS.0, top + 10.0);
    picture.path([(x, y), (x + 28.0, y)], MUTED, 2.0);
    key(&mut picture, (x + 35.0, y), "max \u{2202}M/\u{2202}y, signed");
    key(&mut picture, (x + 227.0, y), "max |\u{2202}M/\u{2202}y|, as printed");
    picture.ring((x + 410.0, y), 4.0, MUTED);
    key(&mut picture, (x + 421.0, y), "end of a grid");
    key(&mut picture, (x + 557.0, y), "tolerance 10\u{207b}\u{1d3a}");
    picture.group("stroke-dasharray=\"18 10\"", |picture| {
        picture.path([(x + 192.0, y), (x + 220.0, y)], MUTED, 1.0);
    });
    picture.group("stroke-dasharray=\"4 8\"", |picture| {
        picture.path([(x + 522.0, y), (x + 550.0, y)], INK, 1.0);
    });
    Ok(picture.finish(caption, Some(of_histories(panels))))
}

/// A panel with its scales.
struct Plan<'a> {
    panel: &'a HistoryPanel<'a>,
    legend: Legend<'a>,
    longest: usize,
    /// Powers of ten at the lower and upper edge.
    decades: (i32, i32),
}

impl<'a> Plan<'a> {
    fn new(panel: &'a HistoryPanel<'a>) -> Result<Self, FigureError> {
        let grids = panel.grids.len();
        let shown = |curve: &'a History| curve.levels.iter().take(grids);
        let longest =
            panel.curves.iter().map(|curve| shown(curve).map(Vec::len).sum()).max().unwrap_or(0);
        if longest == 0 {
            return Err(FigureError::Empty("iterations"));
        }
        let largest = panel
            .curves
            .iter()
            .flat_map(|curve| shown(curve).flatten())
            .map(|i| i.gradient_abs.max(i.gradient_signed))
            .fold(tolerance(1), f64::max);
        let bottom = -(panel.grids.len() as i32) - 1;
        let top = libm::ceil(libm::log10(largest) + 0.05) as i32;
        Ok(Self {
            panel,
            legend: Legend::new(panel.curves.iter().map(|curve| &*curve.label), WIDTH - 90.0),
            longest,
            decades: (bottom, top.max(bottom + 1)),
        })
    }

    fn frame(&self, top: f64) -> Frame {
        let top = top + 34.0 + LEGEND_ROW * self.legend.rows as f64;
        Frame {
            across: ACROSS,
            down: (top, top + PLOT),
            x: (0.0, self.longest as f64 * 1.02),
            y: (f64::from(self.decades.0), f64::from(self.decades.1)),
        }
    }

    /// Everything but the data.
    fn ground(&self, picture: &mut Picture, frame: &Frame, top: f64) {
        picture.text(self.panel.title, (ACROSS.0, top + 14.0), Type::size(LARGE).bold().left());
        self.legend.draw(picture, (ACROSS.0, top + 38.0));
        let (low, high) = self.decades;
        let step = ((high - low + 7) / 8).max(1) as usize;
        frame.rules(picture, (low..=high).step_by(step).map(f64::from));
        let ticks = (low..=high).step_by(step);
        frame.label_left(picture, ticks.map(|e| (f64::from(e), power_of_ten(e))));
        let ticks = Ticks::inside(0.0, frame.x.1, 10);
        frame.verticals(picture, ticks.values(), RULE);
        // Iterations are counted in whole numbers, even where a run is so short that ticks are not.
        frame.label_below(picture, ticks.labelled().filter(|(x, _)| x.fract() == 0.0));
        let (x, y) = frame.middle();
        picture.text("iterations, all grids", (x, frame.down.1 + 31.0), Type::size(NORMAL));
        picture.text("residual", (17.0, y), Type::size(NORMAL).upwards());
        for (k, grid) in (1..).zip(self.panel.grids) {
            let y = frame.up(-f64::from(k));
            let text = format!("{}  h = 1/{}", power_of_ten(-k), grid.cells());
            picture.text(&text, (ACROSS.1 + 7.0, y), Type::size(SMALL).left().color(MUTED));
        }
    }

    fn tolerances(&self, picture: &mut Picture, frame: &Frame) {
        for k in 1..=self.panel.grids.len() as i32 {
            let y = frame.up(-f64::from(k));
            picture.path([(ACROSS.0, y), (ACROSS.1, y)], INK, 1.0);
        }
    }

    /// Iterations shown of a run: number from 1, whether it is the last on its grid, and data.
    fn shown(&self, curve: &'a History) -> impl Iterator<Item = (usize, bool, &'a Iteration)> {
        let levels = curve.levels.iter().take(self.panel.grids.len());
        levels
            .flat_map(|level| level.iter().enumerate().map(|(k, i)| (k + 1 == level.len(), i)))
            .enumerate()
            .map(|(k, (last, i))| (k + 1, last, i))
    }

    fn place(&self, frame: &Frame, number: usize, value: f64) -> Place {
        let (low, high) = frame.y;
        let y = if value > 0.0 { libm::log10(value).clamp(low, high) } else { low };
        frame.at(number as f64, y)
    }

    fn curves(
        &self,
        picture: &mut Picture,
        frame: &Frame,
        width: f64,
        pick: fn(&Iteration) -> f64,
    ) {
        for (k, curve) in self.panel.curves.iter().enumerate() {
            let places = self.shown(curve).map(|(number, _, i)| self.place(frame, number, pick(i)));
            let thinned = thinned(places.collect());
            if thinned.len() > 1 {
                picture.path(thinned, series(k), width);
            }
        }
    }

    fn rings(&self, picture: &mut Picture, frame: &Frame) {
        for (k, curve) in self.panel.curves.iter().enumerate() {
            for (number, _, i) in self.shown(curve).filter(|(_, last, _)| *last) {
                picture.ring(self.place(frame, number, i.gradient_signed), 4.0, series(k));
            }
        }
    }
}

/// At most four points per half display pixel across: first, lowest, highest, last.
///
/// Long runs would otherwise make files that grow without showing more.
fn thinned(places: Vec<Place>) -> Vec<Place> {
    let column = |p: &Place| (2.0 * p.0) as i64;
    let mut kept = Vec::new();
    for run in places.chunk_by(|a, b| column(a) == column(b)) {
        if run.len() <= 4 {
            kept.extend_from_slice(run);
            continue;
        }
        // The first of several.
        let extreme = |sign: f64| {
            let by_height =
                |a: &usize, b: &usize| (sign * run[*a].1).total_cmp(&(sign * run[*b].1));
            (0..run.len()).rev().max_by(by_height).unwrap_or(0)
        };
        let mut picks = [0, extreme(1.0), extreme(-1.0), run.len() - 1];
        picks.sort_unstable();
        kept.extend(picks.map(|k| run[k]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_envelope_and_the_order() {
        let places: Vec<Place> =
            (0..100_000).map(|k| (f64::from(k) * 0.006, f64::from((k * 7919) % 1009))).collect();
        let thin = thinned(places.clone());
        assert!(thin.len() < 5000);
        assert!(thin.is_sorted_by(|a, b| a.0 <= b.0));
        let top = |list: &[Place]| list.iter().map(|p| p.1).fold(0.0, f64::max);
        assert_eq!(top(&thin), top(&places));
        assert_eq!((thin[0], thin.last()), (places[0], places.last()));
    }
}
