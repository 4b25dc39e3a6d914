//! Meshes in the plane from above: triangles, parts of the boundary, regions.

use super::axes::{Entry, Legend, Sample};
use super::extent::Extent;
use super::maps::draw_axes;
use super::palette::{light, series};
use super::panels::Panels;
use super::picture::Picture;
use signorini_mathematics::mesh::PlaneMesh;
use signorini_mathematics::problem::law::Law;

/// Sides of a panel in display pixels, where two are in a row and where three are.
const SIDES: [f64; 2] = [288.0, 180.0];
/// Widths of a key below a panel, where two are in a row and where three are.
const KEYS: [f64; 2] = [350.0, 240.0];
/// Distance of the key from the panel.
const KEY_GAP: f64 = 54.0;
/// Most letters of a name in a key.
const LETTERS: usize = 28;
/// Number of the first shade of regions among the series, unlike the colours of the first parts.
const FIRST_SHADE: usize = 4;

/// Draws one mesh per panel, below its title, two in a row or, if there are three, all three, each above a key of its
/// parts and, if there are more than one, its regions.
///
/// All triangles are drawn: a mesh of more than 2500 makes a large file.
pub fn mesh_picture(panels: &[(&str, &PlaneMesh)]) -> Picture {
    let ([side, key, margin], beside) = match panels.len() {
        3 => ([SIDES[1], KEYS[1], 10.0], (62.0, 18.0)),
        _ => ([SIDES[0], KEYS[0], 20.0], (66.0, 26.0)),
    };
    let legends: Vec<_> = panels.iter().map(|(_, mesh)| Legend::of(entries(mesh), key)).collect();
    let below = KEY_GAP + legends.iter().map(Legend::high).fold(0.0, f64::max);
    let columns = if panels.len() == 3 { 3 } else { 2 };
    let layout = Panels { columns, wide: side, beside, margin, foot: 8.0, ..Panels::default() };
    let layout = layout.titled(panels.iter().map(|(title, _)| *title), [side, below]);
    let mut picture = layout.picture();
    for (k, ((_, mesh), legend)) in panels.iter().zip(&legends).enumerate() {
        let frame = layout.begin(&mut picture, k, Extent::of(mesh).in_square(side));
        draw_axes(&mut picture, &frame);
        let regions = mesh.regions().iter();
        let shades = regions.map(|&region| light(FIRST_SHADE + usize::from(region)));
        frame.triangles(&mut picture, mesh, shades);
        picture.group("stroke-linecap=\"round\"", |picture| {
            for facet in mesh.facets() {
                let ends = mesh.corners(facet).map(|[x, y]| frame.at(x, y));
                picture.path(ends, series(facet.part as usize), 2.5);
            }
        });
        legend.draw(&mut picture, (frame.across.0 - 30.0, frame.down.1 + KEY_GAP));
    }
    picture
}

/// Returns the entries of the key of a mesh: its parts with their conditions, and its regions if there are several.
fn entries(mesh: &PlaneMesh) -> Vec<Entry> {
    let mut entries = Vec::new();
    for (k, part) in mesh.parts().iter().enumerate() {
        let law = match part.law {
            Law::SIGNORINI => "contact".to_owned(),
            law => law.to_string(),
        };
        let label = format!("{}: {law}", cut(&part.names.to_string()));
        entries.push(Entry { label, color: series(k), sample: Sample::Line });
    }
    let regions = mesh.region_names().iter().filter(|_| mesh.region_names().len() > 1);
    for (k, names) in regions.enumerate() {
        let (label, color) = (cut(&names.to_string()), light(FIRST_SHADE + k));
        entries.push(Entry { label, color, sample: Sample::Swatch });
    }
    entries
}

/// Returns a name, without its end if it is long.
fn cut(name: &str) -> String {
    match name.char_indices().nth(LETTERS) {
        Some((end, _)) => format!("{}…", &name[..end]),
        None => name.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::svg;
    use signorini_mathematics::mesh::BuiltIn;

    #[test]
    fn all_triangles_edges_and_names_are_drawn() {
        let mut mesh = BuiltIn::Annulus.plane().unwrap();
        mesh.parts_mut()[0].law = Law::FREE;
        mesh.parts_mut()[1].names = "a".repeat(200).as_str().into();
        let svg = svg(&mesh_picture(&[("annulus", &mesh)]));
        assert_eq!(svg.matches("<path").count(), 24);
        // An edge each, and one line of the key.
        for color in ["#0072B2", "#D55E00"] {
            let color = format!("stroke=\"{color}\"");
            let lines = svg.lines().filter(|line| line.starts_with("<polyline"));
            assert_eq!(lines.filter(|line| line.contains(&color)).count(), 13);
        }
        assert!(svg.contains(">inner: free</text>"));
        assert!(svg.contains(&format!(">{}…: contact</text>", "a".repeat(LETTERS))));
    }
}
