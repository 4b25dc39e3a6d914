//! How large a disturbance it takes to change each count of a table.

use super::axes::Frame;
use super::decade;
use super::palette::{INK, MUTED, RGBColor, RULE, WHITE, legible_on, viridis};
use super::picture::{END, LARGE, NORMAL, Picture, Place, SMALL, START, bold, plain};
use super::table::of_fragility;
use super::text::power_of_ten;
use crate::experiments::rounding::{Cell, Table};

/// Width and height of a cell in display pixels.
const CELL: (f64, f64) = (60.0, 42.0);
/// Room to the left of a panel, for the names of its rows.
const LEFT: f64 = 84.0;
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
pub(crate) fn fragility(sizes: &[f64], tables: &[Table]) -> Picture {
    let wide = tables.iter().map(|table| table.grids.len()).max().unwrap_or(0);
    let (least, most) = (decade(sizes[0]), decade(sizes[sizes.len() - 1]));
    let color = |size: f64| viridis((decade(size) - least) / (most - least).max(1.0));
    let tall = tables.iter().map(|table| table.rows.len()).max().unwrap_or(0) as f64;
    let panel_width = LEFT + CELL.0 * wide as f64 + 14.0;
    let all = panel_width * tables.len() as f64;
    let width = all.max(2.0 * HALF + 40.0);
    let below = ABOVE + CELL.1 * tall;
    let mut picture = Picture::new(width, below + SCALE);
    for (k, table) in tables.iter().enumerate() {
        let left = 0.5 * (width - all) + panel_width * k as f64 + LEFT;
        let (columns, rows) = (table.grids.len() as f64, table.rows.len() as f64);
        let frame = Frame {
            across: (left, left + CELL.0 * columns),
            down: (ABOVE, ABOVE + CELL.1 * rows),
            x: (0.0, columns),
            y: (rows, 0.0),
        };
        draw_panel(&mut picture, table, &frame, color);
    }
    draw_scale(&mut picture, sizes, (0.5 * width, below + 50.0), color);
    picture.table = Some(of_fragility(tables));
    picture
}

fn named(size: f64) -> String {
    power_of_ten(libm::round(decade(size)) as i32)
}

/// Draws a table whose cells are of size 1 in `frame`.
fn draw_panel(
    picture: &mut Picture,
    table: &Table,
    frame: &Frame,
    color: impl Fn(f64) -> RGBColor,
) {
    let title = (frame.middle().0, frame.down.0 - 42.0);
    picture.text(&format!("Table {}", table.number), title, bold(LARGE));
    for (i, cells) in table.grids.iter().enumerate() {
        let place = (frame.right(i as f64 + 0.5), frame.down.0 - 14.0);
        picture.text(&format!("h = 1/{cells}"), place, plain(SMALL));
    }
    for (j, row) in table.rows.iter().enumerate() {
        let place = (frame.across.0 - 8.0, frame.up(j as f64 + 0.5));
        picture.text(&format!("r = {}", row.r), place, plain(SMALL).pos(END));
        for (i, Cell { count, flips_at, .. }) in row.cells.iter().enumerate() {
            let ground = flips_at.map_or(WHITE, &color);
            let (i, j) = (i as f64, j as f64);
            picture.rect(frame.at(i, j), frame.at(i + 1.0, j + 1.0), ground);
            let ink = legible_on(ground);
            let (x, y) = frame.at(i + 0.5, j + 0.5);
            picture.text(&count.to_string(), (x, y - 8.0), bold(NORMAL).color(&ink));
            let text = flips_at.map_or_else(|| "\u{2013}".into(), named);
            picture.text(&text, (x, y + 10.0), plain(SMALL).color(&ink));
        }
    }
    frame.rules(picture, (0..=table.rows.len()).map(|j| j as f64));
    frame.verticals(picture, (0..=table.grids.len()).map(|i| i as f64), RULE);
    frame.outline(picture);
}

/// The sizes in their colours, with the roundings of the usual formats marked above.
fn draw_scale(
    picture: &mut Picture,
    sizes: &[f64],
    (middle, top): Place,
    color: impl Fn(f64) -> RGBColor,
) {
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
        frame.band(picture, (x - 0.5, x + 0.5), color(size));
    }
    frame.label_below(picture, sizes.iter().map(|&size| (decade(size), named(size))));
    for (rounding, name) in FORMATS {
        let x = frame.right(decade(rounding));
        picture.path([(x, top - 6.0), (x, top + HEIGHT)], INK, 1.5);
        let text = format!("one rounding in {name}");
        picture.text(&text, (x - 4.0, top - 14.0), plain(SMALL).color(&MUTED).pos(START));
    }
    let name = "largest relative disturbance of each value";
    picture.text(name, (middle, top + HEIGHT + 32.0), plain(SMALL));
}
