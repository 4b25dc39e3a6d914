//! Tables of the data in pictures: CSV with a header line.

use super::chart::{Chart, Stroke};
use super::contact::{ContactLine, ContactPanel};
use super::drawn::DrawnSolution;
use super::gradient::GradientPanel;
use super::history::{HistoryCurve, HistoryPanel};
use super::identifiability::IdentifiabilityPanel;
use crate::table::quoted;

/// Returns the points of all curves but references.
pub(super) fn of_charts(panels: &[&Chart]) -> String {
    let mut csv = "panel,x axis,y axis,curve,x,y\n".to_owned();
    for Chart { title, axes: [across, up], curves, .. } in panels {
        for curve in curves.iter().filter(|curve| curve.stroke != Stroke::Reference) {
            let names =
                [title, &across.name, &up.name, &curve.label].map(|name| quoted(name)).join(",");
            for (x, y) in &curve.points {
                csv += &format!("{names},{x},{y}\n");
            }
        }
    }
    csv
}

pub(super) fn of_histories(panels: &[HistoryPanel]) -> String {
    let mut csv = "panel,run,cells,iteration,gradient_signed,gradient_abs,delta_a\n".to_owned();
    for panel in panels {
        for HistoryCurve { label, levels, .. } in &panel.runs {
            let names = [panel.title, label].map(quoted).join(",");
            for (grid, iterations) in panel.grids.iter().zip(levels) {
                for i in iterations {
                    let (n, signed, abs) = (i.number, i.gradient_signed, i.gradient_abs);
                    let (cells, delta_a) = (grid.cells(), i.delta_a);
                    csv += &format!("{names},{cells},{n},{signed},{abs},{delta_a}\n");
                }
            }
        }
    }
    csv
}

/// Returns trace and multiplier at the boundary nodes, by arc length.
pub(super) fn of_contact(panels: &[ContactPanel]) -> String {
    let mut csv = "panel,run,s,y,a\n".to_owned();
    for panel in panels {
        for ContactLine { label, y, a, .. } in &panel.lines {
            let names = [&panel.title, label].map(|name| quoted(name)).join(",");
            for ((s, y), a) in panel.curve.places.iter().zip(y).zip(a) {
                csv += &format!("{names},{s},{y},{a}\n");
            }
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
        let title = quoted(title);
        for (&[px, py], &v) in mesh.points().iter().zip(y) {
            let [px, py, v] = [px, py, v].map(|value| rounded(value, 4));
            csv += &format!("{title},{px},{py},{v}\n");
        }
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
    for panel in panels {
        let title = quoted(panel.title);
        for (y, row) in panel.slice.y.iter().zip(&panel.slice.exact) {
            for (x, counts) in panel.slice.x.iter().zip(row) {
                csv += &format!("{title},{x},{y},{counts}\n");
            }
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
