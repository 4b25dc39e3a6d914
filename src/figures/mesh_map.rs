//! The map of a right-hand side on a triangulation of the plane.

use super::axes::colour_bar;
use super::boxes::CELL_LINES;
use super::drawn::MOST_CELLS;
use super::maps::{below, draw_axes, layout_around};
use super::palette::ColourScale;
use super::panels::draw_title;
use super::picture::Picture;
use signorini_mathematics::discrete::norms::largest;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::mesh::PlaneMesh;

/// Draws the finest mesh of a problem that is not too fine for a picture, with f in colour.
///
/// # Errors
/// A sentence if the domain lies in space, or f is not finite.
pub(crate) fn map_of_f(title: &str, problem: &Problem) -> Result<Picture, String> {
    let levels = problem.levels();
    let drawing = levels.drawing(MOST_CELLS).ok_or("a domain in space has no picture")?;
    let f = levels.means(MOST_CELLS).map_err(|e| e.to_string())?;
    Ok(mesh_map(title, &drawing.mesh, &f))
}

/// Draws a mesh with the mean of f on each triangle in colour, below its title and above a colour bar symmetric about
/// 0.
///
/// All triangles are drawn: a mesh of more than 2500 makes a large file.
pub(super) fn mesh_map(text: &str, mesh: &PlaneMesh, f: &[f64]) -> Picture {
    let limit = largest(f);
    let colours = ColourScale::Diverging { limit: if limit > 0.0 { limit } else { 1.0 } };
    let (layout, [x, y], title) = layout_around(mesh, text);
    let (width, height) = layout.size();
    let mut picture = Picture::new(width, height);
    let frame = layout.frame(0, x, y);
    draw_title(&mut picture, &frame, &title);
    picture.group(CELL_LINES, |picture| {
        for (cell, &value) in mesh.cells().iter().zip(f) {
            let corners = mesh.vertices(cell).map(|[x, y]| frame.at(x, y));
            picture.polygon(corners, colours.color(value));
        }
    });
    draw_axes(&mut picture, &frame);
    let (across, top) = below(&layout, 420.0);
    colour_bar(&mut picture, across, top, colours, "f (x, y)");
    picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::samples::svg;
    use signorini_mathematics::mesh::BuiltIn;

    #[test]
    fn every_triangle_has_its_colour() {
        let mesh = BuiltIn::Annulus.plane().unwrap();
        let f: Vec<f64> = (0..mesh.cells().len()).map(|k| k as f64 - 12.0).collect();
        let svg = svg(&mesh_map("annulus", &mesh, &f));
        assert_eq!(svg.matches("<path").count(), mesh.cells().len());
    }
}
