//! Charts in rows of panels, with their titles and legends.

use super::axes::{Entry, Legend, Sample};
use super::palette::{series, solver};
use super::panels::{Head, Panels};
use super::picture::{Picture, WIDTH};
use super::plot::Plot;
use super::series::{Chart, Curve};
use super::table::add;
use super::title::Title;

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
pub fn charts(alike: bool, panels: &[Chart]) -> Picture {
    let mut shown: Vec<&Chart> = panels.iter().collect();
    shown.retain(|panel| panel.curves.iter().any(|curve| !curve.points.is_empty()));
    let mut picture = in_panels(&shown, alike, MEASURED);
    picture.table = Some(of_charts(&shown));
    picture
}

/// Draws the axes of a panel without points, whose title says why it has none.
pub fn axes_alone(panel: &Chart) -> Picture {
    let mut picture = in_panels(&[panel], false, MEASURED);
    picture.table = Some(of_charts(&[panel]));
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
/// has. The second and later labels of a colour are dashed, each in its own way; a label whose curves are single points
/// is a ring.
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
        let color = series(place);
        let sample = match (has_line, seen.iter().filter(|known| **known == color).count()) {
            (false, _) => Sample::Ring,
            (true, 0) => Sample::Line,
            (true, before) => Sample::Dashed(before - 1),
        };
        seen.push(color);
        entries.push(Entry { label: label.into(), color, sample });
    }
    entries
}

/// Returns the points of all curves, each with the first line of the title of its panel.
fn of_charts(panels: &[&Chart]) -> String {
    let mut csv = "panel,x axis,y axis,curve,x,y\n".to_owned();
    for Chart { title, axes: [across, up], curves, .. } in panels {
        for curve in curves {
            let title = title.lines().next().unwrap_or_default();
            let names = [title, &*across.name, &up.name, &curve.label];
            add(&mut csv, &names, curve.points.iter().map(|&point| point.into()));
        }
    }
    csv
}

#[cfg(test)]
mod tests {
    use super::super::series::Stroke;
    use super::*;

    #[test]
    fn no_two_of_many_curves_look_alike() {
        let points = [(1.0, 0.5), (2.0, 0.25)];
        let curves = (0..28).map(|k| Curve::new(Stroke::Marked, format!("R = {k}"), points));
        let entries = legend(&[&Chart::new("t", ["x", "y"], curves.collect())]);
        for (k, entry) in entries.iter().enumerate() {
            let mut others = entries[..k].iter();
            assert!(
                others.all(|one| (one.color, one.sample) != (entry.color, entry.sample)),
                "{k}"
            );
        }
        assert_eq!(entries.len(), 28);
    }

    #[test]
    fn charts_are_listed_point_by_point_and_commas_are_quoted() {
        let points = [(1.0, 0.5), (2.0, 1e-300)];
        let marked = Curve::new(Stroke::Marked, "multigrid, two threads", points);
        let line = Curve::new(Stroke::Line, "a \"b\"", [(3.0, 4.0)]);
        let text = of_charts(&[&Chart::new("T", ["x", "y"], vec![marked, line])]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "panel,x axis,y axis,curve,x,y");
        assert_eq!(lines[1], "T,x,y,\"multigrid, two threads\",1,0.5");
        assert_eq!((lines.len(), lines[3]), (4, "T,x,y,\"a \"\"b\"\"\",3,4"));
        assert!(lines[2].split(',').next_back().unwrap().parse::<f64>() == Ok(1e-300));
    }
}
