//! Maps of the gradient where a stopping rule stops: the components that are beyond the tolerance, by size and sign.

use super::maps::{SIDE, bar_below, draw_maps, layout};
use super::palette::{ColourScale, RGBColor};
use super::picture::{NORMAL, Picture, plain};
use super::table::{lines, rounded};
use super::text::short;
use signorini_mathematics::discrete::grid::Grid;

/// Multiples of the tolerance at which the shade changes; below the first, the rule takes a component for zero.
const STEPS: [f64; 4] = [1.0, 3.0, 10.0, 30.0];

/// One panel of [`gradients`].
#[derive(Clone, Debug)]
pub struct GradientPanel<'a> {
    /// Title above the panel.
    pub title: &'a str,
    /// Grid of the nodes.
    pub grid: Grid,
    /// Bound of the stopping rule for the components.
    pub tolerance: f64,
    /// Components of the gradient with respect to y, at the nodes.
    pub gradient: Vec<f64>,
}

/// Draws one map per panel, a cell for each node: blue where the component is negative beyond the tolerance, red where
/// it is positive beyond the tolerance.
pub fn gradients(panels: &[GradientPanel]) -> Picture {
    let layout = layout(panels.iter().map(|panel| panel.title), (SIDE, SIDE));
    // The cells of the outermost nodes stick out by half their width.
    let ends = panels.iter().map(|panel| 0.5 + 0.5 * panel.grid.h()).collect::<Vec<f64>>();
    let mut picture = draw_maps(
        &layout,
        |k| [(-ends[k], ends[k]); 2],
        |picture, frame, k| {
            let GradientPanel { grid, tolerance, gradient, .. } = &panels[k];
            let colors = gradient.iter().map(|component| color(shade(component / tolerance)));
            frame.raster(picture, grid.side(), &colors.collect::<Vec<_>>());
        },
    );
    let most = STEPS.len() as i32;
    let shades = (-most..=most).enumerate().map(|(k, shade)| (k as f64, color(shade)));
    let steps = STEPS.iter().rev().map(|step| -step).chain(STEPS);
    let steps = (1..).zip(steps).map(|(k, step)| (f64::from(k), short(step)));
    let bar = bar_below(&layout, 500.0);
    bar.draw(&mut picture, (0.0, f64::from(2 * most + 1)), shades, steps.collect());
    bar.name(&mut picture, "gradient / tolerance", plain(NORMAL));
    picture.table = Some(of_gradients(panels));
    picture
}

/// Returns the number of [`STEPS`] that a component in units of the tolerance exceeds, with the sign of the component.
fn shade(ratio: f64) -> i32 {
    let exceeded = STEPS.iter().filter(|&&step| ratio.abs() > step).count() as i32;
    if ratio < 0.0 { -exceeded } else { exceeded }
}

fn color(shade: i32) -> RGBColor {
    ColourScale::Diverging { limit: STEPS.len() as f64 }.color(f64::from(shade))
}

/// Returns the components of the gradient, a row for each node and a column for each panel; columns of the grid are
/// counted from the left, rows from below.
fn of_gradients(panels: &[GradientPanel]) -> String {
    let titles = panels.iter().map(|panel| panel.title);
    let mut rows = vec![["column", "row"].into_iter().chain(titles).map(str::to_owned).collect()];
    let side = panels.iter().map(|panel| panel.grid.side()).max().unwrap_or(0);
    for (row, column) in (0..side).flat_map(|row| (0..side).map(move |column| (row, column))) {
        let mut cells: Vec<String> = [column, row].map(|place| place.to_string()).into();
        cells.extend(panels.iter().map(|GradientPanel { grid, gradient, .. }| {
            // Six digits: a map needs no more, and the book carries the file.
            let component = || rounded(gradient[grid.index(column, row)], 6).to_string();
            if column.max(row) < grid.side() { component() } else { String::new() }
        }));
        rows.push(cells);
    }
    lines(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_within_the_tolerance_have_no_colour_and_the_others_that_of_their_sign() {
        assert_eq!([-1.0, 0.0, 1.0, 1.1, -1.1, 29.0, -31.0].map(shade), [0, 0, 0, 1, -1, 3, -4]);
        let neutral = color(0);
        assert!(neutral.0 == neutral.2 && color(-1).2 > color(-1).0 && color(1).0 > color(1).2);
        let grid = Grid::new(4).unwrap();
        let mut gradient = vec![0.0; grid.nodes()];
        gradient[12] = -0.5;
        let panel = GradientPanel { title: "one", grid, tolerance: 0.1, gradient };
        let picture = gradients(&[panel]);
        let csv = picture.table.clone().unwrap();
        assert_eq!(csv.lines().count(), 1 + grid.nodes());
        assert!(csv.starts_with("column,row,one\n") && csv.contains("\n2,2,-0.5\n"), "{csv}");
        let svg = picture.svg("t", "d").unwrap();
        let RGBColor(r, g, b) = color(-2);
        // In the map and in the bar.
        assert_eq!(svg.matches(&format!("#{r:02X}{g:02X}{b:02X}")).count(), 2, "{svg}");
    }
}
