//! Tables of the data in pictures: CSV with a header line.

use super::contact::{ContactLine, ContactPanel};
use super::drawn::DrawnSolution;
use super::gradient::GradientPanel;
use super::history::{HistoryCurve, HistoryPanel};
use super::identifiability::IdentifiabilityPanel;
use super::series::{Chart, Stroke};
use crate::table::quoted;

/// Adds a line for each row of numbers, each behind the same names.
fn add<const N: usize>(csv: &mut String, names: &[&str], rows: impl Iterator<Item = [f64; N]>) {
    let names: Vec<String> = names.iter().map(|name| quoted(name)).collect();
    for row in rows {
        *csv += &names.join(",");
        row.iter().for_each(|number| *csv += &format!(",{number}"));
        csv.push('\n');
    }
}

/// Returns the points of all curves but references.
pub(super) fn of_charts(panels: &[&Chart]) -> String {
    let mut csv = "panel,x axis,y axis,curve,x,y\n".to_owned();
    for Chart { title, axes: [across, up], curves, .. } in panels {
        for curve in curves.iter().filter(|curve| curve.stroke != Stroke::Reference) {
            let names = [title, &*across.name, &up.name, &curve.label];
            add(&mut csv, &names, curve.points.iter().map(|&point| point.into()));
        }
    }
    csv
}

pub(super) fn of_histories(panels: &[HistoryPanel]) -> String {
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

/// Returns trace and multiplier at the boundary nodes, by arc length.
pub(super) fn of_contact(panels: &[ContactPanel]) -> String {
    let mut csv = "panel,run,s,y,a\n".to_owned();
    for ContactPanel { title, curve, lines, .. } in panels {
        for ContactLine { label, y, a, .. } in lines {
            let numbers = curve.places.iter().zip(y).zip(a).map(|((&s, &y), &a)| [s, y, a]);
            add(&mut csv, &[title, label], numbers);
        }
    }
    csv
}

/// Returns the components of the gradient, a row for each node and a column for each panel; columns of the grid are
/// counted from the left, rows from below.
pub(super) fn of_gradients(panels: &[GradientPanel]) -> String {
    let mut csv = "column,row".to_owned();
    for panel in panels {
        csv += &format!(",{}", quoted(panel.title));
    }
    let side = panels.iter().map(|panel| panel.grid.side()).max().unwrap_or(0);
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        csv += &format!("\n{column},{row}");
        for GradientPanel { grid, gradient, .. } in panels {
            csv.push(',');
            if column.max(row) < grid.side() {
                // Six digits: a map needs no more, and the book carries the file.
                csv += &rounded(gradient[grid.index(column, row)], 6).to_string();
            }
        }
    }
    csv.push('\n');
    csv
}

/// Returns the values at the nodes of meshes, to four digits, which is more than a picture shows.
pub(crate) fn of_surfaces(panels: &[DrawnSolution]) -> String {
    let mut csv = "panel,x,y,v\n".to_owned();
    for DrawnSolution { title, mesh, y, .. } in panels {
        let nodes = mesh.points().iter().zip(y);
        let numbers = nodes.map(|(&[x, y], &v)| [x, y, v].map(|value| rounded(value, 4)));
        add(&mut csv, &[title], numbers);
    }
    csv
}

/// Number rounded to some significant digits.
fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().expect("a number")
}

/// Returns the number of counts that come out for each f.
pub(super) fn of_identifiability(panels: &[IdentifiabilityPanel]) -> String {
    let mut csv = "panel,f on the quadrant,f elsewhere,counts\n".to_owned();
    for IdentifiabilityPanel { title, slice, .. } in panels {
        for (&y, row) in slice.y.iter().zip(&slice.exact) {
            let counts = slice.x.iter().zip(row);
            add(&mut csv, &[title], counts.map(|(&x, &counts)| [x, y, counts as f64]));
        }
    }
    csv
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::Curve;

    #[test]
    fn charts_are_listed_point_by_point_and_commas_are_quoted() {
        let points = [(1.0, 0.5), (2.0, 1e-300)];
        let marked = Curve::new(Stroke::Marked, "multigrid, two threads", points);
        let slope = Curve::new(Stroke::Reference, "order 1", [(1.0, 1.0)]);
        let line = Curve::new(Stroke::Line, "a \"b\"", [(3.0, 4.0)]);
        let text = of_charts(&[&Chart::new("T", ["x", "y"], vec![marked, slope, line])]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "panel,x axis,y axis,curve,x,y");
        assert_eq!(lines[1], "T,x,y,\"multigrid, two threads\",1,0.5");
        assert_eq!((lines.len(), lines[3]), (4, "T,x,y,\"a \"\"b\"\"\",3,4"));
        assert!(lines[2].split(',').next_back().unwrap().parse::<f64>() == Ok(1e-300));
    }
}
