//! How sharply the tables fix f: published counts that come out, over the plane of two of its values.

use super::IdentifiabilityPanel;
use super::axes::{Frame, colour_bar, key};
use super::palette::{CONTACT, INK, RGBColor, WHITE, viridis};
use super::panels::{Panels, title};
use super::picture::{NORMAL, Picture, Place, SMALL, UPWARDS, plain, text_width};
use super::table::of_identifiability;
use super::text::Ticks;

/// Side of a panel in display pixels.
const SIDE: f64 = 290.0;

/// Draws one map per panel, two in a row, with a colour bar common to all.
///
/// The region in which every count comes out is outlined, the f in the middle marked by a ring, other
/// f by crosses if they are in the map.
pub(crate) fn identifiability(panels: &[IdentifiabilityPanel]) -> Picture {
    let counts = panels.iter().flat_map(|panel| panel.slice.exact.iter().flatten());
    let least = counts.copied().min().unwrap_or(0);
    let most = panels.iter().map(|panel| panel.cells).max().unwrap_or(0);
    let range = (least.min(most) as f64, most as f64);
    let color = |n: f64| viridis((n - range.0) / (range.1 - range.0).max(1.0));

    let layout = Panels {
        count: panels.len(),
        side: SIDE,
        margin: 10.0,
        left: 78.0,
        around: (95.0, 100.0),
        foot: 96.0,
    };
    let (width, height) = layout.size();
    let mut picture = Picture::new(width, height);
    for (k, panel) in panels.iter().enumerate() {
        let frame = layout.frame(k, ends(&panel.slice.x), ends(&panel.slice.y));
        draw_panel(&mut picture, panel, frame, color);
    }
    let top = layout.foot_top() + 14.0;
    let middle = 0.5 * width + 60.0;
    let half = 0.5 * (width - 260.0).min(420.0);
    colour_bar(
        &mut picture,
        (middle - half, middle + half),
        top,
        range,
        color,
        "counts that come out",
    );
    legend(&mut picture, (0.5 * width, top + 56.0), most, width);
    picture.table = Some(of_identifiability(panels));
    picture
}

/// The range of an axis: each point stands for the cell around it.
fn ends(values: &[f64]) -> (f64, f64) {
    let (first, last) = (values[0], values[values.len() - 1]);
    let half = 0.5 * (last - first) / (values.len() - 1).max(1) as f64;
    (first - half, last + half)
}

fn draw_panel(
    picture: &mut Picture,
    panel: &IdentifiabilityPanel,
    frame: Frame,
    color: impl Fn(f64) -> RGBColor,
) {
    let slice = panel.slice;
    title(picture, &frame, panel.title);
    let (nx, ny) = (slice.x.len(), slice.y.len());
    let colors: Vec<_> = slice.exact.iter().flatten().map(|&count| color(count as f64)).collect();
    frame.raster(picture, nx, &colors);
    let corner = |i: usize, j: usize| frame.corner((i, j), (nx, ny));
    let full = |i: usize, j: usize| slice.exact[j][i] == panel.cells;
    for j in 0..ny {
        for i in 0..=nx {
            if (i > 0 && full(i - 1, j)) != (i < nx && full(i, j)) {
                picture.path([corner(i, j), corner(i, j + 1)], CONTACT, 1.75);
            }
        }
    }
    for j in 0..=ny {
        for i in 0..nx {
            if (j > 0 && full(i, j - 1)) != (j < ny && full(i, j)) {
                picture.path([corner(i, j), corner(i + 1, j)], CONTACT, 1.75);
            }
        }
    }
    let inside =
        |&&[x, y]: &&[f64; 2]| frame.x.0 < x && x < frame.x.1 && frame.y.0 < y && y < frame.y.1;
    for &[x, y] in panel.others.iter().filter(inside) {
        cross(picture, frame.at(x, y));
    }
    ring(picture, frame.middle());
    frame.outline(picture);
    frame.label_below(picture, Ticks::inside(frame.x.0, frame.x.1, 4).labelled());
    frame.label_left(picture, Ticks::inside(frame.y.0, frame.y.1, 6).labelled());
    let (x, y) = frame.middle();
    picture.text("f on the odd quadrant", (x, frame.down.1 + 32.0), plain(NORMAL));
    picture.text("f elsewhere", (frame.across.0 - 64.0, y), plain(NORMAL).transform(UPWARDS));
}

fn ring(picture: &mut Picture, at: Place) {
    picture.ring(at, 5.5, INK);
}

/// A cross in ink on white, which shows on every colour.
fn cross(picture: &mut Picture, (x, y): Place) {
    for (color, width, size) in [(WHITE, 4.5, 5.5), (INK, 1.75, 4.5)] {
        picture.path([(x - size, y - size), (x + size, y + size)], color, width);
        picture.path([(x - size, y + size), (x + size, y - size)], color, width);
    }
}

/// What the marks mean, centred.
fn legend(picture: &mut Picture, (middle, y): Place, most: usize, width: f64) {
    let outline = format!("all {most} counts come out");
    let texts = [outline.as_str(), "recovered f", "other f of the book"];
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
