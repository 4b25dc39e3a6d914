//! Figure 1: maps of right-hand sides.

use super::IN_SPACE;
use super::axes::{Bar, Frame};
use super::drawn::MOST_CELLS;
use super::extent::Extent;
use super::palette::{ColourScale, legible_on};
use super::panels::Panels;
use super::picture::{NORMAL, Picture, SMALL, italic, plain};
use super::regions::{Disc, RASTER, raster, regions, widest};
use super::text::{Ticks, number_width, short};
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::PlaneMesh;
use signorini_mathematics::problem::source::Source;

/// Attributes of pieces: a line around each, which later pieces cover.
const PIECE_LINES: &str = "stroke=\"#222222\" stroke-width=\"4\"";
/// Shades on either side of 0 for a smooth f; more would make the file larger and look the same.
const BANDS: f64 = 20.0;
/// Side of a panel in display pixels.
///
/// A multiple of [`RASTER`], so that its cells fall on whole pixels.
pub(super) const SIDE: f64 = 288.0;
/// Width of the bar of colours.
pub(super) const BAR: f64 = 420.0;
/// Size of a value in a wide region.
const LABEL: f64 = 18.0;

/// Width of a number beside a map that leaves room for the name of the axis, over the size of the font.
const SHORT_NUMBER: f64 = 3.1;

type Point = [f64; 2];

/// Draws one map per f, below its title, two in a row, with a colour bar common to all and symmetric about 0.
///
/// Pieces are painted as exact polygons in their order; each value is printed in the widest place of its region, if it
/// fits. A smooth f is painted as a raster, without values.
pub fn maps_of_f(panels: &[(&str, Source)]) -> Picture {
    let rasters: Vec<_> = panels.iter().map(|(_, f)| raster(f)).collect();
    let colours = colours_of_f(&rasters.concat());
    let layout = layout(panels.iter().map(|(title, _)| *title), (SIDE, SIDE));
    let mut picture = draw_maps(
        &layout,
        |_| [(-0.5, 0.5); 2],
        |picture, frame, k| draw_map(picture, &panels[k].1, &rasters[k], frame, colours),
    );
    bar_below(&layout, BAR).scale(&mut picture, colours, "f (x, y)");
    picture
}

/// Draws the finest mesh of a problem that is not too fine for a picture, with f in colour.
///
/// # Errors
/// A sentence if the domain lies in space, or f is not finite.
pub fn map_of_f(title: &str, problem: &Problem) -> Result<Picture, String> {
    let levels = problem.levels();
    let drawing = levels.drawing(MOST_CELLS).ok_or(IN_SPACE)?;
    let f = levels.means(MOST_CELLS).map_err(|e| e.to_string())?;
    Ok(mesh_map(title, &drawing.mesh, &f))
}

/// Draws a mesh with the mean of f on each triangle in colour, below its title and above a colour bar symmetric about
/// 0.
///
/// All triangles are drawn: a mesh of more than 2500 makes a large file.
pub(super) fn mesh_map(title: &str, mesh: &PlaneMesh, f: &[f64]) -> Picture {
    let colours = colours_of_f(f);
    let (layout, ranges) = layout_around(mesh, title);
    let mut picture = draw_maps(
        &layout,
        |_| ranges,
        |picture, frame, _| {
            frame.triangles(picture, mesh, f.iter().map(|&value| colours.color(value)));
        },
    );
    bar_below(&layout, BAR).scale(&mut picture, colours, "f (x, y)");
    picture
}

/// Lays out maps of this size, two in a row, with room for a bar of colours below all.
pub(super) fn layout<'a>(
    titles: impl IntoIterator<Item = &'a str>,
    (wide, high): (f64, f64),
) -> Panels {
    // A narrow frame is in the middle of a picture that has room for the colour bar.
    let room = 0.5 * (SIDE - wide).max(0.0);
    let beside = (66.0 + room, 26.0 + room);
    let layout = Panels { columns: 2, wide, beside, margin: 20.0, foot: 66.0, ..Panels::default() };
    layout.titled(titles, [high, 46.0])
}

/// Lays out the map of a mesh, with room for its numbers; returns the ranges of its axes too.
pub(super) fn layout_around(mesh: &PlaneMesh, title: &str) -> (Panels, [(f64, f64); 2]) {
    let (size, ranges) = Extent::of(mesh).frame(SIDE);
    let mut layout = layout([title], size);
    let up = Ticks::inside(ranges[1].0, ranges[1].1, steps((0.0, size.1)));
    layout.beside.0 = layout.beside.0.max(distance_of_name(&up) + 0.5 * NORMAL);
    (layout, ranges)
}

/// Draws maps of these ranges, each what `paint` draws in its frame, with axes.
pub(super) fn draw_maps(
    layout: &Panels,
    ranges: impl Fn(usize) -> [(f64, f64); 2],
    paint: impl Fn(&mut Picture, &Frame, usize),
) -> Picture {
    let mut picture = layout.picture();
    for k in 0..layout.titles.len() {
        let frame = layout.begin(&mut picture, k, ranges(k));
        paint(&mut picture, &frame, k);
        draw_axes(&mut picture, &frame);
    }
    picture
}

/// Returns a bar of this width below maps.
pub(super) fn bar_below(layout: &Panels, width: f64) -> Bar {
    let all = layout.width();
    let (middle, half) = (0.5 * all + 10.0, 0.5 * (all - 160.0).min(width));
    Bar { across: (middle - half, middle + half), top: layout.foot_top() + 12.0 }
}

/// Returns the colours of values of f, symmetric about 0.
fn colours_of_f(values: &[f64]) -> ColourScale {
    let limit = values.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
    ColourScale::Diverging { limit: if limit > 0.0 { limit } else { 1.0 } }
}

/// Draws the map of f, whose raster is `values`.
fn draw_map(
    picture: &mut Picture,
    f: &Source,
    values: &[f64],
    frame: &Frame,
    colours: ColourScale,
) {
    match f {
        Source::Pieces { background, pieces } => {
            frame.band(picture, frame.x, colours.color(*background));
            picture.group(PIECE_LINES, |picture| {
                for (region, value) in pieces {
                    let polygon = inside_square(&region.half_planes());
                    if polygon.len() > 2 {
                        let corners = polygon.iter().map(|&[x, y]| frame.at(x, y));
                        picture.polygon(corners, colours.color(*value));
                    }
                }
            });
            label_regions(picture, frame, values, colours);
        }
        Source::Exact(_) | Source::Formula(_) => {
            let (_, limit) = colours.range();
            let shades: Vec<_> = values
                .iter()
                .map(|value| colours.color((BANDS * value / limit).round() / BANDS * limit))
                .collect();
            frame.raster(picture, RASTER, &shades);
        }
    }
}

/// Distance of the name of the vertical axis from a frame, beside its numbers.
fn distance_of_name(up: &Ticks) -> f64 {
    let widest = up.widest();
    if widest > SHORT_NUMBER { 14.0 + SMALL * widest } else { 48.0 }
}

/// Draws outline and axes of a map.
pub(super) fn draw_axes(picture: &mut Picture, frame: &Frame) {
    frame.outline(picture);
    let up = Ticks::inside(frame.y.0, frame.y.1, steps(frame.down));
    frame.label_below(picture, Ticks::inside(frame.x.0, frame.x.1, steps(frame.across)).labelled());
    frame.label_left(picture, up.labelled());
    let (x, y) = frame.middle();
    let name = distance_of_name(&up);
    picture.text("x", (x, frame.down.1 + 31.0), italic(NORMAL));
    picture.text("y", (frame.across.0 - name, y), italic(NORMAL));
}

/// Most steps between numbers along an axis of a map with these ends.
fn steps((from, to): (f64, f64)) -> usize {
    ((to - from) / 45.0).clamp(2.0, 4.0) as usize
}

/// Returns the part of the square that is in all half-planes.
fn inside_square(planes: &[[f64; 3]]) -> Vec<Point> {
    let square = vec![[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    planes.iter().fold(square, |polygon, &plane| clip(&polygon, plane))
}

/// Clips a convex polygon by the half-plane `a x + b y <= c` (Sutherland and Hodgman, Communications of the ACM 17,
/// 1974).
///
/// 1. For each side from p to q, keep p if it is in the half-plane.
/// 2. If p and q are strictly on different sides of the line `a x + b y = c`, add the point where the side meets it.
fn clip(polygon: &[Point], [a, b, c]: [f64; 3]) -> Vec<Point> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let [ep, eq] = [p, q].map(|[x, y]| a * x + b * y - c);
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

/// Prints the value of every connected region in the middle of its largest inscribed disc.
fn label_regions(picture: &mut Picture, frame: &Frame, values: &[f64], colours: ColourScale) {
    for region in regions(values) {
        let value = values[region[0]];
        let Disc { centre: (x, y), radius } = widest(&region, values);
        let text = short(value);
        let room = radius * SIDE;
        let sizes = if room > 40.0 { &[LABEL, NORMAL][..] } else { &[NORMAL] };
        let size = sizes.iter().find(|size| 0.5 * **size * number_width(&text) < room);
        if let Some(&size) = size {
            let ink = legible_on(colours.color(value));
            picture.text(&text, frame.at(x, y), plain(size).color(&ink));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::svg;
    use signorini_mathematics::mesh::BuiltIn;

    #[test]
    fn every_triangle_has_its_colour() {
        let mesh = BuiltIn::Annulus.plane().unwrap();
        let f: Vec<f64> = (0..mesh.cells().len()).map(|k| k as f64 - 12.0).collect();
        let svg = svg(&mesh_map("annulus", &mesh, &f));
        assert_eq!(svg.matches("<path").count(), mesh.cells().len());
    }
}
