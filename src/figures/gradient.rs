//! Maps of the gradient where a stopping rule stops: the components that are beyond the tolerance, by size and sign.

use super::GradientPanel;
use super::axes::Frame;
use super::maps::{below, draw_axes, layout};
use super::palette::{ColourScale, RGBColor};
use super::panels::draw_title;
use super::picture::{END, NORMAL, Picture, plain};
use super::table::of_gradients;
use super::text::short;

/// Multiples of the tolerance at which the shade changes; below the first, the rule takes a component for zero.
const STEPS: [f64; 4] = [1.0, 3.0, 10.0, 30.0];

/// Draws one map per panel, a cell for each node: blue where the component is negative beyond the tolerance, red where
/// it is positive beyond the tolerance.
pub(crate) fn gradients(panels: &[GradientPanel]) -> Picture {
    let (layout, titles) = layout(panels.iter().map(|panel| panel.title));
    let (width, height) = layout.size();
    let mut picture = Picture::new(width, height);
    for (k, panel) in panels.iter().enumerate() {
        // The cells of the outermost nodes stick out by half their width.
        let end = 0.5 + 0.5 * panel.grid.h();
        let frame = layout.frame(k, (-end, end), (-end, end));
        draw_title(&mut picture, &frame, &titles[k]);
        let ratios = panel.gradient.iter().map(|component| component / panel.tolerance);
        let colors: Vec<RGBColor> = ratios.map(|ratio| color(shade(ratio))).collect();
        frame.raster(&mut picture, panel.grid.side(), &colors);
        draw_axes(&mut picture, &frame);
    }
    let (across, top) = below(&layout, 500.0);
    draw_bar(&mut picture, across, top);
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

/// Draws the shades side by side, from the most negative one, with the steps between them.
fn draw_bar(picture: &mut Picture, across: (f64, f64), top: f64) {
    let most = STEPS.len() as i32;
    let shades = f64::from(2 * most + 1);
    let frame = Frame { across, down: (top, top + 12.0), x: (0.0, shades), y: (0.0, 1.0) };
    let mut steps: Vec<f64> = STEPS.iter().rev().map(|step| -step).collect();
    steps.extend(STEPS);
    for (k, shade) in (-most..=most).enumerate() {
        // Each shade reaches to the end: the next covers the rest, and no seam shows.
        frame.band(picture, (k as f64, shades), color(shade));
    }
    frame.outline(picture);
    frame.label_below(picture, (1..).zip(steps).map(|(k, step)| (f64::from(k), short(step))));
    let name = "gradient / tolerance";
    picture.text(name, (across.0 - 10.0, top + 6.0), plain(NORMAL).pos(END));
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_mathematics::discrete::grid::Grid;

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
