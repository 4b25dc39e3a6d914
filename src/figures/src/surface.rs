//! Figure 2: solutions on domains in the plane as shaded surfaces, painted from the far triangles to the near ones.

use super::axes::{Bar, CELL_LINES, key};
use super::boxes::Boxed;
use super::camera::{Vector, between, cross, dot};
use super::drawn::DrawnSolution;
use super::fixed;
use super::palette::{CONTACT, INK, RGBColor, lit};
use super::panels::Panels;
use super::picture::{LARGE, Picture, SMALL, START, bold, plain};
use super::table::{add, rounded};
use super::title::Title;
use std::collections::BTreeMap;

/// Size of a panel in display pixels, where two are in a row.
const PANEL: (f64, f64) = (390.0, 392.0);
/// Height of the title and the colour bar of a panel, which do not shrink with it.
const TEXT: f64 = 80.0;
/// Height of the colour bar alone, which panels lack whose scale has one below.
const BAR: f64 = 44.0;
/// Widest colour bar common to several panels.
const COMMON_BAR: f64 = 420.0;
/// Space around all panels.
const MARGIN: f64 = 10.0;
/// Height of a row of the key below the panels.
const KEY: f64 = 22.0;
/// Width of the mark of contact in display pixels.
const CONTACT_WIDTH: f64 = 2.75;

/// Draws one surface per panel, in rows of `columns`.
///
/// Heights are shaded by Lambert's law and coloured by value. Edges of the boundary in contact, those with both ends in
/// contact, and those of fixed parts are marked on the surface. All triangles are drawn: a fine mesh makes a large
/// file. Panels with scales of their own have a colour bar each; rows with one scale have one bar together.
pub fn surfaces(columns: usize, panels: &[DrawnSolution]) -> Picture {
    let columns = columns.min(panels.len());
    let scale = (2.0 / columns as f64).min(1.0);
    let wide = scale * PANEL.0;
    let titles: Vec<_> = panels.iter().map(|panel| Title::new(&panel.title, wide)).collect();
    let more = titles.iter().map(Title::more).fold(0.0, f64::max);
    let high = scale * (PANEL.1 - TEXT) + TEXT + more;
    let ranges: Vec<_> = panels.iter().map(DrawnSolution::range_of_colours).collect();
    let scales: Vec<_> = ranges.chunks(columns).map(common).collect();
    let is_below = |row: usize| scales[row].is_some() && scales.get(row + 1) == Some(&scales[row]);
    let heights = (0..panels.len()).map(|k| if is_below(k / columns) { high - BAR } else { high });
    let mut keys: Vec<_> = panels.iter().take(1).map(|panel| (CONTACT, panel.held)).collect();
    let laws = panels.iter().flat_map(|panel| panel.mesh.parts().iter().map(|part| part.law));
    keys.extend(fixed(laws).map(|words| (INK, words)));
    let layout = Panels {
        columns,
        wide,
        margin: MARGIN,
        head: MARGIN,
        foot: MARGIN + KEY * keys.len() as f64,
        heights: heights.map(|high| [0.0, high, 0.0]).collect(),
        ..Panels::default()
    };
    let (width, mut picture) = (layout.width(), layout.picture());
    for (k, panel) in panels.iter().enumerate() {
        let frame = layout.frame(k, (0.0, 1.0), (0.0, 1.0));
        let (left, right) = frame.across;
        let top = frame.down.0 + more;
        let bottom = top + high - more;
        let inside = Boxed::new(panel, frame.across, top, scale);
        titles[k].draw(&mut picture, (left + 0.5 * wide, top + 16.0), &bold(LARGE));
        inside.walls(&mut picture);
        let lines = format!("{CELL_LINES} stroke-linecap=\"round\"");
        picture.group(&lines, |picture| PaintedMesh::new(panel, &inside).paint(picture));
        inside.axes(&mut picture);
        if let Some(text) = inside.floor.note() {
            picture.text(&text, (left + 8.0, bottom - 58.0), plain(SMALL).pos(START));
        }
        let half = 0.5 * COMMON_BAR.min(width - 160.0);
        let across = match scales[k / columns] {
            None => (left + 76.0 * scale, right - 36.0 * scale),
            Some(_) if is_below(k / columns) || k % columns > 0 => continue,
            Some(_) => (0.5 * width - half, 0.5 * width + half),
        };
        Bar { across, top: bottom - BAR }.scale(&mut picture, inside.colours, "v");
    }
    picture.group("stroke-linecap=\"round\"", |picture| {
        for (row, &(color, words)) in keys.iter().enumerate() {
            let (x, y) = (MARGIN + 76.0, layout.foot_top() + 12.0 + KEY * row as f64);
            picture.path([(x, y), (x + 28.0, y)], color, CONTACT_WIDTH);
            key(picture, (x + 38.0, y), words);
        }
    });
    picture
}

/// Returns the range of colours that the panels of a row have together; none if there is one panel, or if they differ.
fn common(row: &[(f64, f64)]) -> Option<(f64, f64)> {
    row.first().copied().filter(|first| row.len() > 1 && row.iter().all(|range| range == first))
}

/// Numbers of the ends of an edge, the lower one first.
type Ends = [u32; 2];

/// Surface in its box.
struct PaintedMesh<'a> {
    inside: &'a Boxed,
    panel: &'a DrawnSolution,
    /// (x, y, v) at the nodes, x and y in the box.
    nodes: Vec<Vector>,
    /// Triangles from the farthest to the nearest.
    order: Vec<usize>,
    /// Turn at which the last triangle at each node is painted.
    last: Vec<usize>,
}

impl<'a> PaintedMesh<'a> {
    fn new(panel: &'a DrawnSolution, inside: &'a Boxed) -> Self {
        let mesh = &panel.mesh;
        let mut nodes = Vec::with_capacity(panel.y.len());
        for (&point, &v) in mesh.points().iter().zip(&panel.y) {
            let [x, y] = inside.floor.inside(point);
            nodes.push([x, y, v]);
        }
        let cells = mesh.cells().iter();
        let depths: Vec<f64> = cells.map(|&cell| nearness(inside, &nodes, cell)).collect();
        let mut order: Vec<usize> = (0..depths.len()).collect();
        order.sort_by(|&a, &b| depths[a].total_cmp(&depths[b]));
        let mut last = vec![0; nodes.len()];
        for (turn, &cell) in order.iter().enumerate() {
            mesh.cells()[cell].iter().for_each(|&node| last[node as usize] = turn);
        }
        Self { inside, panel, nodes, order, last }
    }

    /// Paints triangles and the marks of the boundary in their order.
    fn paint(&self, picture: &mut Picture) {
        let marked = self.marked();
        let mut marks: Vec<Vec<(Ends, RGBColor)>> = vec![Vec::new(); self.order.len() + 1];
        for (turn, &cell) in self.order.iter().enumerate() {
            let [a, b, c] = self.panel.mesh.cells()[cell];
            for [a, b, opposite] in [[a, b, c], [b, c, a], [c, a, b]] {
                if let Some(&color) = marked.get(&[a.min(b), a.max(b)]) {
                    // Not before the last triangle at the edge, which would cover half of the line.
                    let visible = 1 + self.last[a as usize].max(self.last[b as usize]);
                    let when = if self.hides([a, b], opposite) { turn } else { visible };
                    marks[when].push(([a, b], color));
                }
            }
        }
        for (turn, edges) in marks.iter().enumerate() {
            for &(edge, color) in edges {
                let places = edge.map(|node| self.inside.place(self.nodes[node as usize]));
                picture.path(places, color, CONTACT_WIDTH);
            }
            if let Some(&cell) = self.order.get(turn) {
                self.triangle(picture, self.panel.mesh.cells()[cell]);
            }
        }
    }

    /// Edges of the boundary that are marked, with their colours: those in contact, and fixed ones.
    fn marked(&self) -> BTreeMap<Ends, RGBColor> {
        let DrawnSolution { mesh, in_contact, .. } = self.panel;
        let mut marked = BTreeMap::new();
        for facet in mesh.facets() {
            let [a, b] = facet.nodes;
            let touches = [a, b].iter().all(|&node| in_contact[node as usize]);
            let color = match mesh.law(facet) {
                law if law.is_fixed() => INK,
                law if touches && law.may_move() => CONTACT,
                _ => continue,
            };
            marked.insert([a.min(b), a.max(b)], color);
        }
        marked
    }

    fn triangle(&self, picture: &mut Picture, cell: [u32; 3]) {
        let corners = cell.map(|node| self.nodes[node as usize]);
        let mean = corners.iter().map(|[_, _, v]| v).sum::<f64>() / 3.0;
        let light = self.inside.brightness(self.upward(cell));
        picture.polygon(
            corners.map(|xyv| self.inside.place(xyv)),
            lit(self.inside.colours.color(mean), light),
        );
    }

    /// Normal of a triangle in the box, upwards.
    fn upward(&self, cell: [u32; 3]) -> Vector {
        let [a, b, c] = cell.map(|node| self.inside.point(self.nodes[node as usize]));
        let normal = cross(between(a, b), between(a, c));
        if normal[2] < 0.0 { normal.map(|x| -x) } else { normal }
    }

    /// True if a triangle hides its edge `[a, b]`: the edge is on its far side, and the triangle is seen from below.
    fn hides(&self, [a, b]: Ends, opposite: u32) -> bool {
        let [p, q, r] = [a, b, opposite].map(|node| self.nodes[node as usize]);
        let (along, inwards) = (between(p, q), between(p, r));
        let turned = [along[1], -along[0], 0.0];
        let toward = self.inside.camera.toward;
        let is_far = dot(turned, toward) * dot(turned, inwards) > 0.0;
        is_far && dot(self.upward([a, b, opposite]), toward) < 0.0
    }
}

/// Distance of the centroid of a triangle towards the viewer, on the floor: along a ray from the viewer, the place
/// there only becomes farther, whatever the heights.
fn nearness(inside: &Boxed, nodes: &[Vector], cell: [u32; 3]) -> f64 {
    let corners = cell.map(|node| nodes[node as usize]);
    let [x, y] = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 3.0);
    dot([x, y, 0.0], inside.camera.toward)
}

/// Returns the values at the nodes of meshes, to four digits, which is more than a picture shows.
pub fn table_of_surfaces(panels: &[DrawnSolution]) -> String {
    let mut csv = "panel,x,y,v\n".to_owned();
    for DrawnSolution { title, mesh, y, .. } in panels {
        let nodes = mesh.points().iter().zip(y);
        let numbers = nodes.map(|(&[x, y], &v)| [x, y, v].map(|value| rounded(value, 4)));
        add(&mut csv, &[title], numbers);
    }
    csv
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{panel, svg};
    use signorini_mathematics::mesh::{BuiltIn, PlaneMesh, refine};
    use signorini_mathematics::problem::law::Law;

    fn refined(domain: BuiltIn, times: usize) -> PlaneMesh {
        let coarse = domain.plane().unwrap();
        (0..times).fold(coarse, |mesh, _| refine(&mesh).unwrap().mesh)
    }

    fn drawn(mesh: &PlaneMesh, y: &[f64], in_contact: &[bool]) -> String {
        svg(&surfaces(2, &[panel(mesh, y, in_contact)]))
    }

    /// True if a line of a picture draws a line in the colour of contact.
    fn is_mark(line: &str) -> bool {
        line.starts_with("<polyline") && line.contains("stroke=\"#D52B00\"")
    }

    /// Number of lines in the colour of contact, without the one of the key.
    fn marks(svg: &str) -> usize {
        svg.lines().filter(|line| is_mark(line)).count() - 1
    }

    #[test]
    fn edges_between_nodes_in_contact_are_marked_on_contact_parts_only() {
        let mut mesh = refined(BuiltIn::Annulus, 1);
        let y: Vec<f64> = mesh.points().iter().map(|[x, y]| x * x + y * y).collect();
        let all = vec![true; y.len()];
        assert_eq!(marks(&drawn(&mesh, &y, &all)), mesh.facets().len());
        assert_eq!(marks(&drawn(&mesh, &y, &vec![false; y.len()])), 0);
        for law in [Law::FREE, Law::FIXED] {
            mesh.parts_mut()[0].law = law;
            let outer = mesh.facets().iter().filter(|facet| facet.part == 1).count();
            assert_eq!(marks(&drawn(&mesh, &y, &all)), outer);
        }
        // One end is no edge.
        let node = mesh.facets().last().unwrap().nodes[0] as usize;
        let one: Vec<bool> = (0..y.len()).map(|k| k == node).collect();
        assert_eq!(marks(&drawn(&mesh, &y, &one)), 0);
    }

    #[test]
    fn every_triangle_is_painted_once_and_the_same_data_give_the_same_bytes() {
        let mesh = refined(BuiltIn::Disc, 2);
        let y: Vec<f64> = mesh.points().iter().map(|[x, y]| x - y).collect();
        let contact = vec![false; y.len()];
        let svg = drawn(&mesh, &y, &contact);
        // The floor is a polygon too.
        assert_eq!(svg.matches("<path").count(), mesh.cells().len() + 1);
        assert_eq!(svg, drawn(&mesh, &y, &contact));
    }

    #[test]
    fn contact_behind_a_surface_that_rises_is_covered() {
        let mesh = refined(BuiltIn::LShape, 0);
        // The far side, y = 1, is low, and the surface before it high.
        let y: Vec<f64> = mesh.points().iter().map(|[_, y]| -y).collect();
        let touching: Vec<bool> = mesh.points().iter().map(|[_, y]| *y == 1.0).collect();
        let svg = drawn(&mesh, &y, &touching);
        let mut after = svg.lines().skip_while(|line| !is_mark(line));
        assert!(marks(&svg) == 2 && after.any(|line| line.starts_with("<path")));
    }
}
