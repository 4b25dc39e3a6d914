//! Figure 1: maps of the piecewise constant right-hand sides.

use super::axes::{Frame, colour_bar};
use super::palette::{INK, RGBColor, diverging, legible_on};
use super::panels::{Panels, title};
use super::picture::{NORMAL, Picture, italic, plain};
use super::regions::{RASTER, raster, regions, widest};
use super::text::{Ticks, number_width, short};
use crate::discrete::norms::largest;
use crate::problem::source::Source;

/// Sampling distance along borders between pieces.
const BORDER_STEP: f64 = 1.0 / 256.0;
/// Distance to both sides of a border at which f is compared.
const BESIDE: f64 = 1e-6;
/// Shades on either side of 0 for a smooth f: more would only make the file larger.
const BANDS: f64 = 20.0;
/// Side of a panel in display pixels.
///
/// A multiple of the raster, so that its cells fall on whole pixels.
const SIDE: f64 = 288.0;
/// Size of a value in a wide region.
const LABEL: f64 = 18.0;

type Point = [f64; 2];

/// Draws one map per f, below its title, two in a row, with a colour bar common to all and symmetric about 0.
///
/// Pieces are painted as exact polygons in their order; each value is printed where its region is
/// widest, if it fits. A smooth f is painted as a raster, without values.
pub(crate) fn maps_of_f(panels: &[(&str, &Source)]) -> Picture {
    let rasters: Vec<_> = panels.iter().map(|(_, f)| raster(f)).collect();
    let limit = largest(&rasters.concat());
    let limit = if limit > 0.0 { limit } else { 1.0 };
    let layout = Panels {
        count: panels.len(),
        side: SIDE,
        margin: 20.0,
        left: 66.0,
        around: (92.0, 94.0),
        foot: 66.0,
    };
    let (width, height) = layout.size();
    let mut picture = Picture::new(width, height);
    for (k, ((text, f), values)) in panels.iter().zip(&rasters).enumerate() {
        let frame = layout.frame(k, (-0.5, 0.5), (-0.5, 0.5));
        title(&mut picture, &frame, text);
        draw_map(&mut picture, f, values, frame, limit);
    }
    let middle = 0.5 * width + 10.0;
    let top = layout.foot_top() + 12.0;
    let half = 0.5 * (width - 160.0).min(420.0);
    colour_bar(
        &mut picture,
        (middle - half, middle + half),
        top,
        (-limit, limit),
        |value| diverging(value / limit),
        "f (x, y)",
    );
    picture
}

/// Colours are those of values up to `limit`; `values` is the raster of f.
fn draw_map(picture: &mut Picture, f: &Source, values: &[f64], frame: Frame, limit: f64) {
    let color = |value: f64| diverging(value / limit);
    match f {
        Source::Pieces { background, pieces } => {
            frame.band(picture, frame.x, color(*background));
            let polygons: Vec<_> = pieces
                .iter()
                .map(|(region, value)| (inside_square(&region.half_planes()), *value))
                .collect();
            let place = |p: &Point| frame.at(p[0], p[1]);
            for (polygon, value) in &polygons {
                if polygon.len() > 2 {
                    picture.polygon(polygon.iter().map(place), color(*value));
                }
            }
            for run in polygons.iter().flat_map(|(p, _)| borders(f, p)) {
                picture.path(run.iter().map(place), INK, 1.0);
            }
            label_regions(picture, &frame, values, color);
        }
        Source::Exact(_) => {
            let band = |value: f64| color((BANDS * value / limit).round() / BANDS * limit);
            frame.raster(picture, RASTER, &values.iter().map(|v| band(*v)).collect::<Vec<_>>());
        }
    }
    frame.outline(picture);
    frame.label_below(picture, Ticks::inside(-0.5, 0.5, 4).labelled());
    frame.label_left(picture, Ticks::inside(-0.5, 0.5, 4).labelled());
    let (x, y) = frame.middle();
    picture.text("x", (x, frame.down.1 + 31.0), italic(NORMAL));
    picture.text("y", (frame.across.0 - 48.0, y), italic(NORMAL));
}

/// The part of the square that lies in all half-planes.
fn inside_square(planes: &[[f64; 3]]) -> Vec<Point> {
    let square = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    planes.iter().fold(square, |polygon, &plane| clip(&polygon, plane))
}

/// Sutherland and Hodgman's clipping of a convex polygon by `a x + b y <= c`.
fn clip(polygon: &[Point], [a, b, c]: [f64; 3]) -> Vec<Point> {
    let excess = |p: Point| a * p[0] + b * p[1] - c;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let (ep, eq) = (excess(p), excess(q));
        if ep <= 0.0 {
            kept.push(p);
        }
        if (ep < 0.0 && eq > 0.0) || (ep > 0.0 && eq < 0.0) {
            let t = ep / (ep - eq);
            kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
    }
    kept
}

/// The parts of the border of a piece that f really jumps across, inside the square.
///
/// A later piece may cover the border, and a neighbour may have the same value.
fn borders(f: &Source, polygon: &[Point]) -> Vec<Vec<Point>> {
    let mut runs: Vec<Vec<Point>> = Vec::new();
    let mut drawing = false;
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let d = [q[0] - p[0], q[1] - p[1]];
        let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
        if length == 0.0 {
            continue;
        }
        let pieces = (length / BORDER_STEP).ceil().max(1.0);
        let along = |t: f64| [p[0] + t * d[0], p[1] + t * d[1]];
        let normal = [BESIDE * d[1] / length, -BESIDE * d[0] / length];
        for piece in 0..pieces as usize {
            let [from, middle, to] = [0.0, 0.5, 1.0].map(|s| along((piece as f64 + s) / pieces));
            let [outside, inside] = [1.0, -1.0]
                .map(|side| [middle[0] + side * normal[0], middle[1] + side * normal[1]]);
            let within = outside.iter().chain(&inside).all(|c| c.abs() < 0.5);
            let jump = within && f.at(outside) != f.at(inside);
            match runs.last_mut() {
                Some(run) if jump && drawing => {
                    // Within a straight edge the last sample moves on; a new edge adds a corner.
                    if piece > 0 && run.len() > 1 {
                        run.pop();
                    }
                    run.push(to);
                }
                _ if jump => runs.push(vec![from, to]),
                _ => {}
            }
            drawing = jump;
        }
    }
    runs
}

/// Prints the value of every connected region where its largest inscribed disc is.
fn label_regions(
    picture: &mut Picture,
    frame: &Frame,
    values: &[f64],
    color: impl Fn(f64) -> RGBColor,
) {
    for region in regions(values) {
        let value = values[region[0]];
        let (at, radius) = widest(&region, values);
        let text = short(value);
        let room = radius * SIDE;
        let fits = |size: &f64| 0.5 * size * number_width(&text) < room;
        let sizes = if room > 40.0 { &[LABEL, NORMAL][..] } else { &[NORMAL] };
        if let Some(&size) = sizes.iter().find(|size| fits(size)) {
            let ink = legible_on(color(value));
            picture.text(&text, frame.at(at.0, at.1), plain(size).color(&ink));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_are_drawn_only_where_f_jumps() {
        let f: Source =
            "rect(-0.25,0.25,-0.25,0.25)=2; rect(0,0.25,-0.25,0.25)=2; else=-1".parse().unwrap();
        let right = inside_square(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.25], [0.0, 1.0, 0.25]]);
        let drawn = borders(&f, &right);
        // The line x = 0 lies between two pieces of the same value.
        assert!(drawn.iter().flatten().all(|p| p[0] > -0.002));
        assert!(!drawn.iter().any(|run| run.windows(2).any(|e| e[0][0] == 0.0 && e[1][0] == 0.0)));
    }
}
