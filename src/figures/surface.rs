//! Figure 2: solutions as shaded surfaces, painted from the far corner to the near one.

use super::axes::{colour_bar, key};
use super::camera::{Camera, UNIT, Vector, View};
use super::palette::{CONTACT, ColourScale, INK, MUTED, RULE, SHADE, lit};
use super::picture::{END, LARGE, NORMAL, Picture, Place, SMALL, bold, italic, plain};
use super::text::Ticks;
use super::{Surface, range_with_zero};
use signorini_mathematics::discrete::grid::Grid;

/// Most cells per side that are drawn where two panels are in a row; finer grids are thinned, or the file would grow
/// too large.
const MOST_CELLS: usize = 32;
/// Size of a panel in display pixels, where two are in a row.
const PANEL: (f64, f64) = (390.0, 392.0);
/// Height of the title and the colour bar of a panel, which do not shrink with it.
const TEXT: f64 = 80.0;
/// Height of a row of the key below the panels.
const KEY: f64 = 22.0;
/// Distance of the numbers from the vertical axis.
const NUMBERS: f64 = 8.0;
/// Room for the numbers to the right of the box.
const NUMBER_RIGHT: f64 = 36.0;
/// Room below the surface over the range of its heights, so that its lowest part is seen above the floor.
const FLOOR_GAP: f64 = 0.18;
/// Room above the surface over the range of its heights.
const CEILING_GAP: f64 = 0.04;

/// Draws one surface per panel, in rows of `columns`, each with a scale and a colour bar.
///
/// Heights are shaded by Lambert's law and coloured by value; the parts of the boundary in contact
/// are marked on the surface. Grids finer than 32 cells per side are thinned, in smaller
/// panels more.
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
        let mut view = View {
            camera: Camera::new(panel.azimuth),
            origin: (left + 0.5 * wide + 12.0, top + 24.0 + 160.0 * scale),
            unit: UNIT * scale,
            heights,
        };
        make_room(&mut view, (left, left + wide), NUMBERS + SMALL * ticks.widest());
        let colours = ColourScale::Viridis { low: data.0, high: data.1 };
        picture.text(panel.title, (left + 0.5 * wide, top + 16.0), bold(LARGE));
        walls(&mut picture, &view, &ticks);
        // Thin strokes in the mesh both draw it and close the seams between neighbours.
        let mesh = "stroke=\"#203038\" stroke-width=\"1\"";
        let mut touching = vec![false; panel.y.len()];
        for (node, &in_contact) in panel.grid.boundary().zip(panel.in_contact) {
            touching[node] = in_contact;
        }
        let lines = thinned(panel.grid, (scale * MOST_CELLS as f64) as usize);
        let drawn = Drawn { view: &view, panel, lines, touching, colours };
        picture.group(mesh, |picture| quads(picture, &drawn));
        picture.group("stroke-linecap=\"round\"", |picture| near_contact(picture, &drawn));
        axes(&mut picture, &view, &ticks);
        let bar = (left + 76.0 * scale, left + wide - 36.0 * scale);
        colour_bar(&mut picture, bar, top + high - 44.0, colours, "v");
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

/// Draws the floor and the two far walls, with rules at the ticks.
fn walls(picture: &mut Picture, view: &View, ticks: &Ticks) {
    let [nx, ny] = view.camera.near.map(|sign| 0.5 * sign);
    let (low, high) = view.heights;
    let floor = [[-0.5, -0.5, low], [0.5, -0.5, low], [0.5, 0.5, low], [-0.5, 0.5, low]];
    picture.polygon(floor.map(|point| view.place(point)), SHADE);
    for v in ticks.values() {
        let line = [[-nx, ny, v], [-nx, -ny, v], [nx, -ny, v]];
        let (color, width) = if v == 0.0 { (MUTED, 1.0) } else { (RULE, 0.75) };
        picture.path(line.map(|point| view.place(point)), color, width);
    }
    for t in [-0.25, 0.0, 0.25] {
        let across = [[t, ny, low], [t, -ny, low], [t, -ny, high]];
        let along = [[nx, t, low], [-nx, t, low], [-nx, t, high]];
        picture.path(across.map(|point| view.place(point)), RULE, 0.75);
        picture.path(along.map(|point| view.place(point)), RULE, 0.75);
    }
    for [x, y] in [[-nx, ny], [-nx, -ny], [nx, -ny]] {
        let edge = [[x, y, low], [x, y, high]];
        picture.path(edge.map(|point| view.place(point)), MUTED, 0.75);
    }
    for v in [low, high] {
        let edges = [[-nx, ny, v], [-nx, -ny, v], [nx, -ny, v]];
        picture.path(edges.map(|point| view.place(point)), MUTED, 0.75);
    }
}

/// Returns the grid lines that are drawn, equally spaced and at most `most`, and the last.
fn thinned(grid: Grid, most: usize) -> Vec<usize> {
    let n = grid.cells();
    let mut lines: Vec<usize> = (0..n).step_by(n.div_ceil(most)).collect();
    lines.push(n);
    lines
}

/// Surface with its view.
struct Drawn<'a> {
    view: &'a View,
    panel: &'a Surface<'a>,
    /// Grid lines that are drawn, ascending.
    lines: Vec<usize>,
    /// Per node, true if it is on the boundary and in contact.
    touching: Vec<bool>,
    colours: ColourScale,
}

/// Column and row of a node.
type GridPoint = (usize, usize);

impl Drawn<'_> {
    /// Returns (x, y, v) at a node.
    fn xyv(&self, (i, j): GridPoint) -> Vector {
        let Surface { grid, y, .. } = self.panel;
        [grid.coordinate(i), grid.coordinate(j), y[grid.index(i, j)]]
    }

    /// Returns the place of a node in the picture.
    fn place(&self, node: GridPoint) -> Place {
        self.view.place(self.xyv(node))
    }

    /// True if the node is on the boundary and in contact.
    fn touches(&self, (i, j): GridPoint) -> bool {
        self.touching[self.panel.grid.index(i, j)]
    }
}

/// Draws the cells from the far corner to the near one.
fn quads(picture: &mut Picture, drawn: &Drawn) {
    let Drawn { view, panel, lines, colours, .. } = drawn;
    for (i, j) in view.camera.far_to_near(lines.len() - 1) {
        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(p, q)| (lines[i + p], lines[j + q]));
        let xyv = corners.map(|node| drawn.xyv(node));
        let mean = 0.25 * xyv.iter().map(|[_, _, v]| v).sum::<f64>();
        let light = view.brightness(xyv.map(|xyv| view.point(xyv)));
        picture.polygon(xyv.map(|xyv| view.place(xyv)), lit(colours.color(mean), light));
        // Contact on the far sides is drawn here, so that nearer cells can hide it.
        for side in 0..4 {
            let edge = [corners[side], corners[(side + 1) % 4]];
            if is_far(view, panel.grid, edge) {
                mark(picture, drawn, edge);
            }
        }
    }
}

/// Draws contact on the near sides, which nothing hides: last, so that the mesh does not cover half of the line.
fn near_contact(picture: &mut Picture, drawn: &Drawn) {
    let grid = drawn.panel.grid;
    let n = grid.cells();
    for pair in drawn.lines.windows(2) {
        let (p, q) = (pair[0], pair[1]);
        for edge in [[(p, 0), (q, 0)], [(n, p), (n, q)], [(p, n), (q, n)], [(0, p), (0, q)]] {
            if !is_far(drawn.view, grid, edge) {
                mark(picture, drawn, edge);
            }
        }
    }
}

/// True if an edge of the lattice is on one of the two sides away from the viewer.
fn is_far(view: &View, grid: Grid, [p, q]: [GridPoint; 2]) -> bool {
    let [far_x, far_y] = view.camera.near.map(|sign| if sign > 0.0 { 0 } else { grid.cells() });
    (p.0 == far_x && q.0 == far_x) || (p.1 == far_y && q.1 == far_y)
}

/// Draws the part of an edge on the boundary that is in contact, node by node of the full grid.
fn mark(picture: &mut Picture, drawn: &Drawn, [p, q]: [GridPoint; 2]) {
    let length = p.0.abs_diff(q.0).max(p.1.abs_diff(q.1));
    let mut run: Vec<GridPoint> = Vec::new();
    for k in 0..=length {
        let [i, j] = [(p.0, q.0), (p.1, q.1)].map(|(a, b)| (a * (length - k) + b * k) / length);
        let touches = drawn.touches((i, j));
        if touches {
            run.push((i, j));
        }
        if (!touches || k == length) && !run.is_empty() {
            if run.len() > 1 {
                picture.path(run.iter().map(|&node| drawn.place(node)), CONTACT, 2.75);
            }
            run.clear();
        }
    }
}

/// Moves and narrows the box if the numbers at the vertical axis, `numbers` wide, would reach out of the panel.
fn make_room(view: &mut View, (left, right): (f64, f64), numbers: f64) {
    let [x, y] = leftmost(view);
    let half = view.origin.0 - view.place([x, y, view.heights.0]).0;
    if view.origin.0 - half - numbers < left {
        let narrower = (0.5 * (right - left - numbers - NUMBER_RIGHT) / half).min(1.0);
        view.unit *= narrower;
        view.origin.0 = left + numbers + narrower * half;
    }
}

/// Returns the leftmost corner of the square in the picture: there the surface cannot hide the vertical axis.
fn leftmost(view: &View) -> [f64; 2] {
    let [nx, ny] = view.camera.near.map(|sign| 0.5 * sign);
    let low = view.heights.0;
    let left = view.place([nx, -ny, low]).0 <= view.place([-nx, ny, low]).0;
    if left { [nx, -ny] } else { [-nx, ny] }
}

/// Draws the near edges of the floor and the vertical axis, with ticks, numbers and names.
fn axes(picture: &mut Picture, view: &View, ticks: &Ticks) {
    let [nx, ny] = view.camera.near.map(|sign| 0.5 * sign);
    let (low, high) = view.heights;
    let marks = [-0.5, -0.25, 0.0, 0.25, 0.5];
    let out = outward(view, [0.0, ny]);
    floor_edge(picture, "x", marks.map(|t| view.place([t, ny, low])), out);
    let out = outward(view, [nx, 0.0]);
    floor_edge(picture, "y", marks.map(|t| view.place([nx, t, low])), out);
    let [cx, cy] = leftmost(view);
    let (bottom, top) = (view.place([cx, cy, low]), view.place([cx, cy, high]));
    picture.path([bottom, top], INK, 1.0);
    for (v, text) in ticks.labelled() {
        let (x, y) = view.place([cx, cy, v]);
        picture.path([(x - 5.0, y), (x, y)], INK, 1.0);
        // Too near the floor, a number would collide with the first one there.
        if y < bottom.1 - SMALL {
            picture.text(&text, (x - NUMBERS, y), plain(SMALL).pos(END));
        }
    }
    picture.text("v", (top.0, top.1 - 14.0), italic(NORMAL));
}

/// Returns the direction of (dx, dy) on the floor as a step of one display pixel in the picture.
fn outward(view: &View, [dx, dy]: [f64; 2]) -> Place {
    let low = view.heights.0;
    let (from, to) = (view.place([0.0, 0.0, low]), view.place([dx, dy, low]));
    let (px, py) = (to.0 - from.0, to.1 - from.1);
    let length = (px * px + py * py).sqrt().max(1e-9);
    (px / length, py / length)
}

/// Draws an edge of the floor with its name and numbers; `marks` are the places of -0.5, -0.25, 0, 0.25 and 0.5, and
/// `out` is the step of one display pixel away from the floor.
fn floor_edge(picture: &mut Picture, name: &str, marks: [Place; 5], out: Place) {
    picture.path([marks[0], marks[4]], INK, 1.0);
    for (k, text) in [(0, "\u{2212}0.5"), (2, "0"), (4, "0.5")] {
        picture.path([marks[k], stepped(marks[k], out, 5.0)], INK, 1.0);
        picture.text(text, stepped(marks[k], out, 17.0), plain(SMALL));
    }
    picture.text(name, stepped(marks[1], out, 24.0), italic(NORMAL));
}

fn stepped(at: Place, (dx, dy): Place, by: f64) -> Place {
    (at.0 + by * dx, at.1 + by * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_both_ends() {
        assert_eq!(lines(4), [0, 1, 2, 3, 4]);
        assert_eq!(lines(64).len(), 33);
        assert_eq!(lines(33).last(), Some(&33));
        assert!(lines(1000).len() <= MOST_CELLS + 1);
    }

    fn lines(cells: usize) -> Vec<usize> {
        thinned(Grid::new(cells).unwrap(), MOST_CELLS)
    }
}
