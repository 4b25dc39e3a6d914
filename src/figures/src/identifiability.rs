//! Map of the published counts that come out, over the plane of two values of f.

use super::axes::{Bar, Frame, key};
use super::palette::{CONTACT, ColourScale, INK, WHITE};
use super::panels::Panels;
use super::picture::{NORMAL, Picture, Place, SMALL, UPWARDS, plain, text_width};
use super::table::add;
use super::text::Ticks;
use signorini_mathematics::identify::Slice;

/// One panel of [`identifiability`].
#[derive(Clone, Debug)]
pub struct IdentifiabilityPanel<'a> {
    /// Title above the panel.
    pub title: &'a str,
    /// Counts that come out around the recovered f, which is in the middle.
    pub slice: &'a Slice,
    /// Number of published counts.
    pub cells: usize,
    /// Other f to mark, as points of the plane.
    pub others: Vec<[f64; 2]>,
}

/// Side of a panel in display pixels.
const SIDE: f64 = 290.0;

/// Draws one map per panel, two in a row, with a colour bar common to all.
///
/// The region in which every count comes out is outlined, the f in the middle marked by a ring, other
/// f by crosses if they are in the map.
pub fn identifiability(panels: &[IdentifiabilityPanel]) -> Picture {
    let counts = panels.iter().flat_map(|panel| panel.slice.exact.iter().flatten());
    let least = counts.copied().min().unwrap_or(0);
    let most = panels.iter().map(|panel| panel.cells).max().unwrap_or(0);
    let colours = ColourScale::Viridis { low: least.min(most) as f64, high: most as f64 };

    let (beside, foot) = ((78.0, 17.0), 96.0);
    let layout = Panels { columns: 2, wide: SIDE, beside, margin: 10.0, foot, ..Panels::default() };
    let layout = layout.titled(panels.iter().map(|panel| panel.title), [SIDE, 52.0]);
    let (width, mut picture) = (layout.width(), layout.picture());
    for (k, panel) in panels.iter().enumerate() {
        let ranges = [ends(&panel.slice.x), ends(&panel.slice.y)];
        let frame = layout.begin(&mut picture, k, ranges);
        draw_panel(&mut picture, panel, &frame, colours);
    }
    let top = layout.foot_top() + 14.0;
    let (middle, half) = (0.5 * width + 60.0, 0.5 * (width - 260.0).min(420.0));
    let bar = Bar { across: (middle - half, middle + half), top };
    bar.scale(&mut picture, colours, "counts that come out");
    legend(&mut picture, (0.5 * width, top + 56.0), most, width);
    picture.table = Some(of_identifiability(panels));
    picture
}

/// Returns the range of an axis on which each value stands for the cell around it.
fn ends(values: &[f64]) -> (f64, f64) {
    let (first, last) = (values[0], values[values.len() - 1]);
    let half = 0.5 * (last - first) / (values.len() - 1).max(1) as f64;
    (first - half, last + half)
}

fn draw_panel(
    picture: &mut Picture,
    panel: &IdentifiabilityPanel,
    frame: &Frame,
    colours: ColourScale,
) {
    let slice = panel.slice;
    let counts = slice.exact.iter().flatten();
    let colors: Vec<_> = counts.map(|&count| colours.color(count as f64)).collect();
    frame.raster(picture, slice.x.len(), &colors);
    outline_full(picture, panel, frame);
    for &[x, y] in &panel.others {
        if frame.x.0 < x && x < frame.x.1 && frame.y.0 < y && y < frame.y.1 {
            cross(picture, frame.at(x, y));
        }
    }
    ring(picture, frame.middle());
    frame.outline(picture);
    frame.label_below(picture, Ticks::inside(frame.x.0, frame.x.1, 4).labelled());
    frame.label_left(picture, Ticks::inside(frame.y.0, frame.y.1, 6).labelled());
    let (x, y) = frame.middle();
    picture.text("f on the quadrant", (x, frame.down.1 + 32.0), plain(NORMAL));
    picture.text("f elsewhere", (frame.across.0 - 64.0, y), plain(NORMAL).transform(UPWARDS));
}

/// Outlines the region in which every count comes out: draws each side between a cell inside and a cell outside.
fn outline_full(picture: &mut Picture, panel: &IdentifiabilityPanel, frame: &Frame) {
    let cells = (panel.slice.x.len(), panel.slice.y.len());
    for d in 0..2 {
        for (i, j) in (0..=cells.1).flat_map(|j| (0..=cells.0).map(move |i| (i, j))) {
            let (before, end) = match d {
                0 => ((i.wrapping_sub(1), j), (i, j + 1)),
                _ => ((i, j.wrapping_sub(1)), (i + 1, j)),
            };
            if is_full(panel, before) != is_full(panel, (i, j)) {
                let side = [(i, j), end].map(|corner| frame.corner(corner, cells));
                picture.path(side, CONTACT, 1.75);
            }
        }
    }
}

/// True if there is a cell in this column and row and every count comes out there.
fn is_full(panel: &IdentifiabilityPanel, (i, j): (usize, usize)) -> bool {
    let count = panel.slice.exact.get(j).and_then(|row| row.get(i));
    count == Some(&panel.cells)
}

fn ring(picture: &mut Picture, at: Place) {
    picture.ring(at, 5.5, INK);
}

/// Draws a cross in ink on white, visible on every colour.
fn cross(picture: &mut Picture, (x, y): Place) {
    for (color, width, size) in [(WHITE, 4.5, 5.5), (INK, 1.75, 4.5)] {
        picture.path([(x - size, y - size), (x + size, y + size)], color, width);
        picture.path([(x - size, y + size), (x + size, y - size)], color, width);
    }
}

/// Explains the marks, centred.
fn legend(picture: &mut Picture, (middle, y): Place, most: usize, width: f64) {
    let outline = format!("all {most} counts come out");
    let texts = [outline.as_str(), "recovered f", "others with two values"];
    let wide: f64 = texts.iter().map(|text| 22.0 + text_width(text, SMALL) + 14.0).sum();
    let mut x = (middle - 0.5 * wide).max(0.02 * width);
    for (k, text) in texts.into_iter().enumerate() {
        let at = (x + 8.0, y);
        match k {
            0 => picture.outline((x, y - 6.0), (x + 15.0, y + 6.0), CONTACT, 1.75),
            1 => ring(picture, at),
            _ => cross(picture, at),
        }
        x = key(picture, (x + 22.0, y), text) + 14.0;
    }
}

/// Returns the number of counts that come out for each f.
fn of_identifiability(panels: &[IdentifiabilityPanel]) -> String {
    let mut csv = "panel,f on the quadrant,f elsewhere,counts\n".to_owned();
    for IdentifiabilityPanel { title, slice, .. } in panels {
        for (&y, row) in slice.y.iter().zip(&slice.exact) {
            let counts = slice.x.iter().zip(row);
            add(&mut csv, &[title], counts.map(|(&x, &counts)| [x, y, counts as f64]));
        }
    }
    csv
}
