//! Figure 2: solutions on the square as shaded surfaces, painted from the far corner to the near one.

use super::Surface;
use super::boxes::{Boxed, CELL_LINES, CONTACT_WIDTH, Inside, in_boxes, range_of_colours};
use super::camera::{Vector, View, between, cross};
use super::floor::Floor;
use super::palette::{CONTACT, ColourScale, lit};
use super::picture::{Picture, Place};
use signorini_mathematics::discrete::grid::Grid;

/// Most cells per side that are drawn where two panels are in a row; finer grids are thinned, or the file would grow
/// too large.
const MOST_CELLS: usize = 32;

/// Draws one surface per panel, in rows of `columns`, each with a scale and a colour bar.
///
/// Heights are shaded by Lambert's law and coloured by value; the parts of the boundary in contact
/// are marked on the surface. Grids finer than 32 cells per side are thinned, in smaller
/// panels more.
pub(crate) fn surfaces(columns: usize, panels: &[Surface]) -> Picture {
    let boxes: Vec<_> = panels.iter().map(boxed).collect();
    in_boxes(columns, &boxes, |picture, inside| paint(picture, inside, &panels[inside.panel]))
}

fn boxed<'a>(&Surface { title, azimuth, range, y, .. }: &Surface<'a>) -> Boxed<'a> {
    Boxed { title, azimuth, values: range_of_colours(range, y), floor: Floor::SQUARE }
}

/// Paints a surface with its contact.
fn paint(picture: &mut Picture, inside: &Inside, panel: &Surface) {
    let mut touching = vec![false; panel.y.len()];
    for (node, &in_contact) in panel.grid.boundary().zip(panel.in_contact) {
        touching[node] = in_contact;
    }
    let &Inside { view, colours, .. } = inside;
    let lines = thinned(panel.grid, (inside.scale * MOST_CELLS as f64) as usize);
    let drawn = Drawn { view, panel, lines, touching, colours };
    picture.group(CELL_LINES, |picture| quads(picture, &drawn));
    picture.group("stroke-linecap=\"round\"", |picture| near_contact(picture, &drawn));
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
        let [a, b, c, d] = xyv.map(|xyv| view.point(xyv));
        let light = view.brightness(cross(between(a, c), between(b, d)));
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
                picture.path(run.iter().map(|&node| drawn.place(node)), CONTACT, CONTACT_WIDTH);
            }
            run.clear();
        }
    }
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
