//! How large a disturbance it takes to change each count of a table.

use super::axes::Frame;
use super::palette::{INK, MUTED, RULE, WHITE, legible_on, viridis};
use super::picture::{LARGE, NORMAL, Pen, Picture, Place, SMALL, Type};
use super::table::of_fragility;
use super::text::power_of_ten;
use super::{Caption, Drawing, FigureError, FragilityPanel, finite, not_empty};
use plotters::style::RGBColor;

/// Width and height of a cell in display pixels.
const CELL: (f64, f64) = (60.0, 42.0);
/// Room to the left of a panel, for the names of its rows.
const LEFT: f64 = 78.0;
/// Room above a panel, for its title and the names of its columns.
const ABOVE: f64 = 62.0;
/// Room between the panels and the scale, and below that.
const SCALE: f64 = 104.0;
/// Half the length of the scale.
const HALF: f64 = 330.0;
/// Rounding errors to be marked on the scale: the unit roundoff of a format, and its name.
const FORMATS: [(f64, &str); 2] =
    [(0.5 * f64::EPSILON, "double precision"), (0.5 * f32::EPSILON as f64, "single precision")];

/// Draws one table per panel, side by side, over a scale of the sizes tried.
///
/// `sizes` are ascending. A cell is the darker the less it takes to change its count, and white if no
/// size did.
///
/// # Errors
/// [`FigureError`] without panels, rows or sizes, with rows of another length than the columns, and on sizes that are not
/// positive.
pub fn fragility(
    caption: Caption,
    sizes: &[f64],
    panels: &[FragilityPanel],
) -> Result<Drawing, FigureError> {
    not_empty("sizes", sizes)?;
    finite("scale", "sizes", sizes.iter().map(|size| decade(*size)))?;
    let mut wide = 0;
    for panel in not_empty("panels", panels)? {
        for row in not_empty("rows", &panel.cells)? {
            let (got, want) = (row.len(), panel.columns.len());
            if got != want {
                let panel = panel.title.clone();
                return Err(FigureError::Length { panel, what: "counts", got, want });
            }
            finite(&panel.title, "sizes", row.iter().filter_map(|(_, at)| at.map(decade)))?;
        }
        wide = wide.max(panel.columns.len());
    }
    let (least, most) = (decade(sizes[0]), decade(sizes[sizes.len() - 1]));
    let color = |size: f64| viridis((decade(size) - least) / (most - least).max(1.0));
    let tall = panels.iter().map(|panel| panel.cells.len()).max().unwrap_or(0) as f64;
    let panel_width = LEFT + CELL.0 * wide as f64 + 14.0;
    let all = panel_width * panels.len() as f64;
    let width = all.max(2.0 * HALF + 40.0);
    let below = ABOVE + CELL.1 * tall;
    let mut picture = Picture::new(width, below + SCALE);
    picture.layer("", |pen| {
        for (k, panel) in panels.iter().enumerate() {
            let left = 0.5 * (width - all) + panel_width * k as f64 + LEFT;
            draw_panel(pen, panel, (left, ABOVE), color);
        }
        draw_scale(pen, sizes, (0.5 * width, below + 50.0), color);
    })?;
    Ok(picture.finish(caption, Some(of_fragility(panels))))
}

fn decade(size: f64) -> f64 {
    if size > 0.0 { libm::log10(size) } else { f64::NAN }
}

fn named(size: f64) -> String {
    power_of_ten(libm::round(decade(size)) as i32)
}

fn draw_panel(
    pen: &mut Pen,
    panel: &FragilityPanel,
    (left, top): Place,
    color: impl Fn(f64) -> RGBColor,
) {
    let at = |i: usize, j: usize| (left + CELL.0 * i as f64, top + CELL.1 * j as f64);
    let across = CELL.0 * panel.columns.len() as f64;
    pen.text(&panel.title, (left + 0.5 * across, top - 42.0), Type::size(LARGE).bold());
    for (i, name) in panel.columns.iter().enumerate() {
        pen.text(name, (at(i, 0).0 + 0.5 * CELL.0, top - 14.0), Type::size(SMALL));
    }
    for (j, (name, row)) in panel.rows.iter().zip(&panel.cells).enumerate() {
        pen.text(name, (left - 8.0, top + CELL.1 * (j as f64 + 0.5)), Type::size(SMALL).right());
        for (i, (count, size)) in row.iter().enumerate() {
            let ground = size.map_or(WHITE, &color);
            pen.rect(at(i, j), at(i + 1, j + 1), ground);
            let ink = legible_on(ground);
            let (x, y) = at(i, j);
            let (x, y) = (x + 0.5 * CELL.0, y + 0.5 * CELL.1);
            pen.text(&count.to_string(), (x, y - 8.0), Type::size(NORMAL).bold().color(ink));
            let text = size.map_or_else(|| "\u{2013}".into(), named);
            pen.text(&text, (x, y + 10.0), Type::size(SMALL).color(ink));
        }
    }
    for j in 0..=panel.cells.len() {
        pen.path([at(0, j), at(panel.columns.len(), j)], RULE, 0.75);
    }
    for i in 0..=panel.columns.len() {
        pen.path([at(i, 0), at(i, panel.cells.len())], RULE, 0.75);
    }
    pen.outline((left, top), at(panel.columns.len(), panel.cells.len()), INK, 1.0);
}

/// The sizes in their colours, with the roundings of the usual formats marked above.
fn draw_scale(pen: &mut Pen, sizes: &[f64], (middle, top): Place, color: impl Fn(f64) -> RGBColor) {
    const HEIGHT: f64 = 14.0;
    let (least, most) = (decade(sizes[0]), decade(sizes[sizes.len() - 1]));
    let roundings = FORMATS.map(|(rounding, _)| decade(rounding));
    let frame = Frame {
        across: (middle - HALF, middle + HALF),
        down: (top, top + HEIGHT),
        x: (roundings[0].min(least) - 0.7, most + 0.7),
        y: (0.0, 1.0),
    };
    for &size in sizes {
        let x = decade(size);
        frame.band(pen, (x - 0.5, x + 0.5), color(size));
    }
    frame.label_below(pen, sizes.iter().map(|&size| (decade(size), named(size))));
    for (rounding, name) in FORMATS {
        let x = frame.right(decade(rounding));
        pen.path([(x, top - 6.0), (x, top + HEIGHT)], INK, 1.5);
        let text = format!("one rounding in {name}");
        pen.text(&text, (x - 4.0, top - 14.0), Type::size(SMALL).color(MUTED).left());
    }
    let name = "largest relative disturbance of each value";
    pen.text(name, (middle, top + HEIGHT + 32.0), Type::size(SMALL));
}
