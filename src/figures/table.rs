//! What pictures show, as tables: CSV with a header line.

use super::{Chart, ContactPanel, FragilityPanel, HistoryPanel, IdentifiabilityPanel, StripsPanel};
use std::fmt::Display;

/// A table under way.
struct Table(String);

impl Table {
    fn new(header: &[&str]) -> Self {
        let mut table = Self(String::new());
        table.row(header.iter().map(|name| name as &dyn Display));
        table
    }

    fn row<'a>(&mut self, cells: impl IntoIterator<Item = &'a dyn Display>) {
        let cells = cells.into_iter().map(|cell| quoted(&cell.to_string()));
        self.0 += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
}

/// A cell as RFC 4180 wants it.
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// The points of all curves; references are left out.
pub(super) fn of_charts(panels: &[Chart]) -> String {
    let mut table = Table::new(&["panel", "x axis", "y axis", "curve", "x", "y"]);
    for panel in panels {
        let measured = panel.curves.iter().filter(|c| c.stroke != super::Stroke::Reference);
        for curve in measured {
            for (x, y) in &curve.points {
                table.row(
                    [&panel.title as &dyn Display, &panel.axes[0], &panel.axes[1]]
                        .into_iter()
                        .chain([&curve.label as &dyn Display, x, y]),
                );
            }
        }
    }
    table.0
}

/// Every iteration of every run.
pub(super) fn of_histories(panels: &[HistoryPanel]) -> String {
    let mut table = Table::new(&[
        "panel",
        "run",
        "cells",
        "iteration",
        "gradient_signed",
        "gradient_abs",
        "delta_a",
    ]);
    for panel in panels {
        for run in &panel.curves {
            for (grid, iterations) in panel.grids.iter().zip(&run.levels) {
                for i in iterations {
                    table.row([
                        &panel.title as &dyn Display,
                        &run.label,
                        &grid.cells(),
                        &i.number,
                        &i.gradient_signed,
                        &i.gradient_abs,
                        &i.delta_a,
                    ]);
                }
            }
        }
    }
    table.0
}

/// Trace and multiplier at the nodes of the boundary, by arc length from the lower left corner.
pub(super) fn of_contact(panels: &[ContactPanel]) -> String {
    let mut table = Table::new(&["panel", "run", "s", "y", "a"]);
    for panel in panels {
        for (run, pair) in &panel.lines {
            for ((b, node), a) in panel.grid.boundary().enumerate().zip(&pair.a) {
                let s = b as f64 * panel.grid.h();
                table.row([&panel.title as &dyn Display, run, &s, &pair.y[node], a]);
            }
        }
    }
    table.0
}

/// Runs of nodes in contact, as arc lengths of the first and the last, iteration by iteration.
pub(super) fn of_strips(panels: &[StripsPanel]) -> String {
    let mut table = Table::new(&["panel", "run", "iteration", "from", "to"]);
    for panel in panels {
        let at = |node: usize| node as f64 / panel.cells as f64;
        for (run, iterations) in &panel.strips {
            for (k, runs) in iterations.iter().enumerate() {
                for [first, past] in runs {
                    let ends = (at(*first), at(past - 1));
                    table.row([&panel.title as &dyn Display, run, &(k + 1), &ends.0, &ends.1]);
                }
            }
        }
    }
    table.0
}

/// The counts that come out, f by f.
pub(super) fn of_identifiability(panels: &[IdentifiabilityPanel]) -> String {
    let mut table = Table::new(&["panel", "f there", "f elsewhere", "counts"]);
    for panel in panels {
        for (y, row) in panel.slice.y.iter().zip(&panel.slice.exact) {
            for (x, counts) in panel.slice.x.iter().zip(row) {
                table.row([&panel.title as &dyn Display, x, y, counts]);
            }
        }
    }
    table.0
}

/// The least disturbance that changes each count; empty where none did.
pub(super) fn of_fragility(panels: &[FragilityPanel]) -> String {
    let mut table = Table::new(&["panel", "row", "column", "count", "disturbance"]);
    for panel in panels {
        for (row, cells) in panel.rows.iter().zip(&panel.cells) {
            for (column, (count, size)) in panel.columns.iter().zip(cells) {
                let size = size.map_or(String::new(), |size| format!("{size:e}"));
                table.row([&panel.title as &dyn Display, row, column, count, &size]);
            }
        }
    }
    table.0
}

#[cfg(test)]
mod tests {
    use super::super::{Curve, Stroke};
    use super::*;

    #[test]
    fn charts_are_listed_point_by_point_and_commas_are_quoted() {
        let marked = Curve::marked("multigrid, two threads", vec![(1.0, 0.5), (2.0, 1e-300)]);
        let slope = Curve::reference("order 1", vec![(1.0, 1.0)]);
        let line =
            Curve { label: "a \"b\"".into(), points: vec![(3.0, 4.0)], stroke: Stroke::Line };
        let text = of_charts(&[Chart::new("T", ["x", "y"], vec![marked, slope, line])]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "panel,x axis,y axis,curve,x,y");
        assert_eq!(lines[1], "T,x,y,\"multigrid, two threads\",1,0.5");
        assert_eq!((lines.len(), lines[3]), (4, "T,x,y,\"a \"\"b\"\"\",3,4"));
        assert!(lines[2].split(',').next_back().unwrap().parse::<f64>() == Ok(1e-300));
    }
}
