//! Figure 2: solutions as shaded surfaces, painted from the far corner to the near one.

use super::axes::{colour_bar, key};
use super::camera::{Camera, Scene, UNIT};
use super::palette::{CONTACT, INK, MUTED, RGBColor, RULE, SHADE, lit, viridis};
use super::picture::{END, LARGE, NORMAL, Picture, Place, SMALL, bold, italic, plain};
use super::text::Ticks;
use super::{Surface, range_with_zero};
use crate::discrete::grid::Grid;

/// Most cells per side that are drawn; finer grids are thinned, or the file would grow too large.
const MOST_CELLS: usize = 32;
/// Size of a panel in display pixels, where two are in a row.
const PANEL: (f64, f64) = (390.0, 392.0);
/// Height of what in a panel does not shrink with it: title and colour bar.
const TEXT: f64 = 80.0;
/// Height of a row of the key below the panels.
const KEY: f64 = 22.0;
/// Distance of the numbers from the vertical axis.
const NUMBERS: f64 = 8.0;
/// Room for the numbers to the right of the box.
const NUMBER_RIGHT: f64 = 36.0;
/// Room below the surface, so that its lowest part is seen above the floor, and above it; in spans.
const FLOOR_GAP: f64 = 0.18;
const CEILING_GAP: f64 = 0.04;

/// Draws one surface per panel, in rows of `columns`, each with a scale and a colour bar.
///
/// Heights are shaded by Lambert's law and coloured by value; the parts of the boundary in contact
/// are marked on the surface. Grids finer than 32 cells per side are thinned.
pub(crate) fn surfaces(columns: usize, panels: &[Surface]) -> Picture {
    let columns = columns.min(panels.len());
    let rows = panels.len().div_ceil(columns);
    let scale = (2.0 / columns as f64).min(1.0);
    let (wide, high) = (scale * PANEL.0, scale * (PANEL.1 - TEXT) + TEXT);
    let margin = 10.0;
    let key_rows = if columns > 1 { 1.0 } else { 2.0 };
    let mut picture = Picture::new(
        2.0 * margin + columns as f64 * wide,
        2.0 * margin + rows as f64 * high + KEY * key_rows,
    );
    for (k, panel) in panels.iter().enumerate() {
        let left = margin + (k % columns) as f64 * wide;
        let top = margin + (k / columns) as f64 * high;
        let data = panel.range.unwrap_or_else(|| range_with_zero(panel.y.iter().copied()));
        let data = if data.0 < data.1 { data } else { (-1.0, 1.0) };
        let span = data.1 - data.0;
        let heights = (data.0 - FLOOR_GAP * span, data.1 + CEILING_GAP * span);
        let ticks = Ticks::inside(heights.0, heights.1, 5);
        let mut scene = Scene {
            camera: Camera::new(panel.azimuth),
            origin: (left + 0.5 * wide + 12.0, top + 24.0 + 160.0 * scale),
            unit: UNIT * scale,
            heights,
        };
        make_room(&mut scene, (left, left + wide), NUMBERS + SMALL * ticks.widest());
        let color = |v: f64| viridis((v - data.0) / (data.1 - data.0));
        picture.text(panel.title, (left + 0.5 * wide, top + 16.0), bold(LARGE));
        walls(&mut picture, &scene, &ticks);
        // Thin strokes in the mesh both draw it and close the seams between neighbours.
        let mesh = "stroke=\"#203038\" stroke-width=\"1\"";
        let mut touching = vec![false; panel.y.len()];
        let nodes = panel.grid.boundary().zip(panel.in_contact);
        nodes.for_each(|(node, contact)| touching[node] = *contact);
        let drawn = Drawn { scene: &scene, panel, touching };
        picture.group(mesh, |picture| quads(picture, &drawn, color));
        picture.group("stroke-linecap=\"round\"", |picture| near_contact(picture, &drawn));
        axes(&mut picture, &scene, &ticks);
        let bar = (left + 76.0 * scale, left + wide - 36.0 * scale);
        let bottom = top + high - 44.0;
        colour_bar(&mut picture, bar, bottom, data, color, "v");
    }
    picture.group("stroke-linecap=\"round\"", |picture| {
        let y = margin + rows as f64 * high + 12.0;
        let x = margin + 76.0;
        picture.path([(x, y), (x + 28.0, y)], CONTACT, 2.75);
        key(picture, (x + 38.0, y), "boundary in contact (multiplier a > 0)");
        let units = if columns > 1 { (x + 390.0, y) } else { (x, y + 20.0) };
        key(picture, units, "x, y and v are dimensionless");
    });
    picture
}

/// Floor and the two far walls, with rules at the ticks.
fn walls(picture: &mut Picture, scene: &Scene, ticks: &Ticks) {
    let [nx, ny] = scene.camera.near.map(|sign| 0.5 * sign);
    let (low, high) = scene.heights;
    let at = |(x, y, v): (f64, f64, f64)| scene.place(x, y, v);
    let floor = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
    picture.polygon(floor.map(|(x, y)| at((x, y, low))), SHADE);
    for v in ticks.values() {
        let line = [(-nx, ny, v), (-nx, -ny, v), (nx, -ny, v)].map(at);
        let (color, width) = if v == 0.0 { (MUTED, 1.0) } else { (RULE, 0.75) };
        picture.path(line, color, width);
    }
    for t in [-0.25, 0.0, 0.25] {
        let across = [(t, ny, low), (t, -ny, low), (t, -ny, high)];
        let along = [(nx, t, low), (-nx, t, low), (-nx, t, high)];
        picture.path(across.map(at), RULE, 0.75);
        picture.path(along.map(at), RULE, 0.75);
    }
    for (x, y) in [(-nx, ny), (-nx, -ny), (nx, -ny)] {
        picture.path([(x, y, low), (x, y, high)].map(at), MUTED, 0.75);
    }
    for v in [low, high] {
        let rim = [(-nx, ny, v), (-nx, -ny, v), (nx, -ny, v)];
        picture.path(rim.map(at), MUTED, 0.75);
    }
}

/// Grid lines that are drawn: every so many, and the last.
fn thinned(grid: Grid) -> Vec<usize> {
    let n = grid.cells();
    let mut lines: Vec<usize> = (0..n).step_by(n.div_ceil(MOST_CELLS)).collect();
    lines.push(n);
    lines
}

/// A surface and where it is drawn; `touching` tells which nodes lie on the boundary and are in contact.
struct Drawn<'a> {
    scene: &'a Scene,
    panel: &'a Surface<'a>,
    touching: Vec<bool>,
}

fn quads(picture: &mut Picture, drawn: &Drawn, color: impl Fn(f64) -> RGBColor) {
    let &Drawn { scene, panel, .. } = drawn;
    let lines = thinned(panel.grid);
    let value = |(i, j): (usize, usize)| panel.y[panel.grid.index(i, j)];
    let xy = |(i, j): (usize, usize)| (panel.grid.coordinate(i), panel.grid.coordinate(j));
    for (i, j) in scene.camera.far_to_near(lines.len() - 1) {
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(p, q)| (lines[i + p], lines[j + q]));
        let points = corners.map(|node| scene.point(xy(node).0, xy(node).1, value(node)));
        let mean = 0.25 * corners.map(value).iter().sum::<f64>();
        picture.polygon(
            corners.map(|node| scene.place(xy(node).0, xy(node).1, value(node))),
            lit(color(mean), scene.brightness(points)),
        );
        // Contact on the far sides goes in here, where nearer cells can still hide it.
        for side in 0..4 {
            let edge = [corners[side], corners[(side + 1) % 4]];
            if is_far(scene, panel.grid, edge) {
                mark(picture, drawn, edge);
            }
        }
    }
}

/// Contact on the near sides, which nothing hides: last, so that the mesh does not cover half of it.
fn near_contact(picture: &mut Picture, drawn: &Drawn) {
    let grid = drawn.panel.grid;
    let (lines, n) = (thinned(grid), grid.cells());
    for pair in lines.windows(2) {
        let (p, q) = (pair[0], pair[1]);
        for edge in [[(p, 0), (q, 0)], [(n, p), (n, q)], [(p, n), (q, n)], [(0, p), (0, q)]] {
            if !is_far(drawn.scene, grid, edge) {
                mark(picture, drawn, edge);
            }
        }
    }
}

/// Whether an edge of the lattice lies on one of the two sides away from the viewer.
fn is_far(scene: &Scene, grid: Grid, [p, q]: [(usize, usize); 2]) -> bool {
    let [far_x, far_y] = scene.camera.near.map(|sign| if sign > 0.0 { 0 } else { grid.cells() });
    (p.0 == far_x && q.0 == far_x) || (p.1 == far_y && q.1 == far_y)
}

/// Draws the part of an edge on the boundary that is in contact, node by node of the full grid.
fn mark(picture: &mut Picture, drawn: &Drawn, [p, q]: [(usize, usize); 2]) {
    let Drawn { scene, panel, touching } = drawn;
    let grid = panel.grid;
    let length = p.0.abs_diff(q.0).max(p.1.abs_diff(q.1));
    let node = |k: usize| {
        let along = |a: usize, b: usize| (a * (length - k) + b * k) / length;
        (along(p.0, q.0), along(p.1, q.1))
    };
    let touches = |k: usize| touching[grid.index(node(k).0, node(k).1)];
    let place = |k: usize| {
        let (i, j) = node(k);
        scene.place(grid.coordinate(i), grid.coordinate(j), panel.y[grid.index(i, j)])
    };
    let mut k = 0;
    while k < length {
        let start = k;
        while k < length && touches(k) && touches(k + 1) {
            k += 1;
        }
        if k > start {
            picture.path((start..=k).map(place), CONTACT, 2.75);
        }
        k += 1;
    }
}

/// Moves and narrows the box where the `numbers` at the vertical axis, so wide, would reach out of the panel.
fn make_room(scene: &mut Scene, (left, right): (f64, f64), numbers: f64) {
    let corner = leftmost(scene);
    let half = scene.origin.0 - scene.place(corner.0, corner.1, scene.heights.0).0;
    if scene.origin.0 - half - numbers < left {
        let narrower = (0.5 * (right - left - numbers - NUMBER_RIGHT) / half).min(1.0);
        scene.unit *= narrower;
        scene.origin.0 = left + numbers + narrower * half;
    }
}

/// The leftmost corner of the square, where the vertical axis stands: the surface cannot hide it there.
fn leftmost(scene: &Scene) -> (f64, f64) {
    let [nx, ny] = scene.camera.near.map(|sign| 0.5 * sign);
    let across = |p: &(f64, f64)| scene.place(p.0, p.1, scene.heights.0).0;
    let left = across(&(nx, -ny)) <= across(&(-nx, ny));
    if left { (nx, -ny) } else { (-nx, ny) }
}

/// Near edges of the floor and the vertical axis, with ticks, numbers and names.
fn axes(picture: &mut Picture, scene: &Scene, ticks: &Ticks) {
    let [nx, ny] = scene.camera.near.map(|sign| 0.5 * sign);
    let low = scene.heights.0;
    // Outward steps in the plane of the picture, a given number of display pixels long.
    let outward = |(dx, dy): (f64, f64)| {
        let (from, to) = (scene.place(0.0, 0.0, low), scene.place(dx, dy, low));
        let (px, py) = (to.0 - from.0, to.1 - from.1);
        let length = (px * px + py * py).sqrt().max(1e-9);
        (px / length, py / length)
    };
    let step = |at: Place, (dx, dy): Place, by: f64| (at.0 + by * dx, at.1 + by * dy);
    let sides: [(&str, Place, [Place; 5]); 2] = [
        ("x", outward((0.0, ny)), [-0.5, -0.25, 0.0, 0.25, 0.5].map(|t| (t, ny))),
        ("y", outward((nx, 0.0)), [-0.5, -0.25, 0.0, 0.25, 0.5].map(|t| (nx, t))),
    ];
    for (name, out, marks) in sides {
        let at = |k: usize| scene.place(marks[k].0, marks[k].1, low);
        picture.path([at(0), at(4)], INK, 1.0);
        for (k, text) in [(0, "\u{2212}0.5"), (2, "0"), (4, "0.5")] {
            picture.path([at(k), step(at(k), out, 5.0)], INK, 1.0);
            picture.text(text, step(at(k), out, 17.0), plain(SMALL));
        }
        picture.text(name, step(at(1), out, 24.0), italic(NORMAL));
    }
    let corner = leftmost(scene);
    let at = |v: f64| scene.place(corner.0, corner.1, v);
    picture.path([at(low), at(scene.heights.1)], INK, 1.0);
    for (v, text) in ticks.labelled() {
        let (x, y) = at(v);
        picture.path([(x - 5.0, y), (x, y)], INK, 1.0);
        // Too near the floor, a number would collide with the first one there.
        if y < at(low).1 - SMALL {
            picture.text(&text, (x - NUMBERS, y), plain(SMALL).pos(END));
        }
    }
    let (x, y) = at(scene.heights.1);
    picture.text("v", (x, y - 14.0), italic(NORMAL));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_both_ends() {
        let lines = |n| thinned(Grid::new(n).unwrap());
        assert_eq!(lines(4), [0, 1, 2, 3, 4]);
        assert_eq!(lines(64).len(), 33);
        assert_eq!(lines(33).last(), Some(&33));
        assert!(lines(1000).len() <= MOST_CELLS + 1);
    }
}
