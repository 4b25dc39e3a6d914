//! Domains in the plane with the ends of contact of a true solution, and the cuts of the functions whose sum it is.

use super::extent::Extent;
use super::maps::draw_axes;
use super::palette::series;
use super::panels::Panels;
use super::picture::Picture;
use serde::Deserialize;
use signorini_mathematics::mesh::PlaneMesh;

/// Side of a panel in display pixels.
const SIDE: f64 = 180.0;
/// Part of the frame that the domain takes.
const DOMAIN: f64 = 0.6;

/// Domain with its true solution.
pub(crate) struct CutsPanel<'a> {
    pub title: &'a str,
    /// Mesh whose boundary is drawn.
    pub mesh: PlaneMesh,
    pub truth: Cuts,
}

/// Row of a true solution, as far as the picture shows it.
#[derive(Deserialize)]
pub(crate) struct Cuts {
    /// From and to, the longest first of each point.
    cuts: Vec<[[f64; 2]; 2]>,
    /// Ends of contact.
    contact: Vec<[f64; 2]>,
}

/// Draws one domain per panel, three in a row: the boundary, the cuts with the outer ends of all that begin in one
/// point, as far as the frame shows them, and rings at the ends of contact.
pub(crate) fn cuts(panels: &[CutsPanel<'_>]) -> Picture {
    let layout = Panels {
        columns: 3,
        wide: SIDE,
        beside: (62.0, 18.0),
        margin: 10.0,
        foot: 30.0,
        ..Panels::default()
    };
    let layout = layout.titled(panels.iter().map(|panel| panel.title), [SIDE, 30.0]);
    let mut picture = layout.picture();
    picture.table = Some(table(panels));
    for (k, CutsPanel { mesh, truth, .. }) in panels.iter().enumerate() {
        let ranges = Extent::of(mesh).in_square(DOMAIN * SIDE).map(|(low, high)| {
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low) / DOMAIN);
            (middle - half, middle + half)
        });
        let frame = layout.begin(&mut picture, k, ranges);
        draw_axes(&mut picture, &frame);
        for facet in mesh.facets() {
            let ends = mesh.corners(facet).map(|[x, y]| frame.at(x, y));
            picture.path(ends, series(0), 2.0);
        }
        for &[from, to] in &truth.cuts {
            let shown = [0, 1].map(|axis| part_within([from[axis], to[axis]], ranges[axis]));
            let part = shown[0].min(shown[1]);
            let end: [f64; 2] = std::array::from_fn(|d| from[d] + part * (to[d] - from[d]));
            picture.path([from, end].map(|[x, y]| frame.at(x, y)), series(1), 1.0);
            if part >= 1.0 {
                let [x, y] = to;
                picture.path([frame.at(x, y)], series(1), 3.0);
            }
        }
        truth.contact.iter().for_each(|&[x, y]| picture.ring(frame.at(x, y), 4.0, series(2)));
    }
    picture
}

/// Returns the cuts as CSV, from and to.
fn table(panels: &[CutsPanel<'_>]) -> String {
    let mut table = "domain,from_x,from_y,to_x,to_y\n".to_owned();
    for CutsPanel { title, truth, .. } in panels {
        for [[x, y], [u, v]] in &truth.cuts {
            table += &format!("{title},{x},{y},{u},{v}\n");
        }
    }
    table
}

/// Part of the way between two numbers on which they are in a range, from the first on, which is; at most one.
fn part_within([from, to]: [f64; 2], (low, high): (f64, f64)) -> f64 {
    let end = if to > from { high } else { low };
    if to == from { 1.0 } else { ((end - from) / (to - from)).clamp(0.0, 1.0) }
}
