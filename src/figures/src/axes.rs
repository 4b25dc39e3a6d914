//! Parts that several figures share: plot frames with ticks, colour bars and legends.

use super::palette::{ColourScale, INK, MUTED, RGBColor, RULE};
use super::picture::{
    END, NORMAL, Picture, Place, SMALL, START, TextStyle, italic, plain, text_width,
};
use super::text::{Ticks, number_width};
use signorini_mathematics::mesh::PlaneMesh;

/// Attributes of the lines between the cells of a mesh: thin strokes both draw them and close the seams.
pub(super) const CELL_LINES: &str = "stroke=\"#203038\" stroke-width=\"1\"";

/// Rectangle of the picture with a linear scale along each side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Left and right end in display pixels.
    pub(super) across: (f64, f64),
    /// Top and bottom in display pixels.
    pub(super) down: (f64, f64),
    /// Values at the left and right end.
    pub(super) x: (f64, f64),
    /// Values at the bottom and the top.
    pub(super) y: (f64, f64),
}

impl Frame {
    /// Returns the place of the value `x` on the horizontal axis.
    pub(super) fn right(&self, x: f64) -> f64 {
        scale(x, self.x, self.across)
    }

    /// Returns the place of the value `y` on the vertical axis.
    pub(super) fn up(&self, y: f64) -> f64 {
        scale(y, self.y, (self.down.1, self.down.0))
    }

    pub(super) fn at(&self, x: f64, y: f64) -> Place {
        (self.right(x), self.up(y))
    }

    pub(super) fn outline(&self, picture: &mut Picture) {
        let (x, y) = (self.across, self.down);
        picture.outline((x.0, y.0), (x.1, y.1), INK, 1.0);
    }

    pub(super) fn middle(&self) -> Place {
        (0.5 * (self.across.0 + self.across.1), 0.5 * (self.down.0 + self.down.1))
    }

    /// Returns the place of a corner of the cells into which the frame is cut: line `i` from the left and line `j` from
    /// below, or the last.
    pub(super) fn corner(&self, (i, j): (usize, usize), cells: (usize, usize)) -> Place {
        self.at(grid_line(i, cells.0, self.x), grid_line(j, cells.1, self.y))
    }

    /// Paints cells, row by row from below, `columns` in each.
    pub(super) fn raster(&self, picture: &mut Picture, columns: usize, colors: &[RGBColor]) {
        let cells = (columns, colors.len() / columns);
        for (j, row) in colors.chunks(columns).enumerate() {
            let mut start = 0;
            for run in row.chunk_by(|a, b| a == b) {
                let end = start + run.len();
                // One more cell to the right and above, painted over by the next: no seams show.
                let (low, high) = ((start, j), (end + 1, j + 2));
                picture.rect(self.corner(low, cells), self.corner(high, cells), run[0]);
                start = end;
            }
        }
    }

    /// Paints the triangles of a mesh, each with its colour.
    pub(super) fn triangles(
        &self,
        picture: &mut Picture,
        mesh: &PlaneMesh,
        colors: impl Iterator<Item = RGBColor>,
    ) {
        picture.group(CELL_LINES, |picture| {
            for (cell, color) in mesh.cells().iter().zip(colors) {
                picture.polygon(mesh.vertices(cell).map(|[x, y]| self.at(x, y)), color);
            }
        });
    }

    /// Draws vertical lines from top to bottom at `values`.
    pub(super) fn verticals(
        &self,
        picture: &mut Picture,
        values: impl IntoIterator<Item = f64>,
        color: RGBColor,
    ) {
        for x in values {
            let x = self.right(x);
            picture.path([(x, self.down.0), (x, self.down.1)], color, 0.75);
        }
    }

    /// Draws horizontal rules across the frame at `values`.
    pub(super) fn rules(&self, picture: &mut Picture, values: impl IntoIterator<Item = f64>) {
        for y in values {
            let y = self.up(y);
            picture.path([(self.across.0, y), (self.across.1, y)], RULE, 0.75);
        }
    }

    pub(super) fn label_below(&self, picture: &mut Picture, ticks: Vec<(f64, String)>) {
        let y = self.down.1;
        let labels: Vec<_> = ticks.into_iter().map(|(x, text)| (self.right(x), text)).collect();
        let step = every(&labels);
        let zero = labels.iter().position(|(_, text)| text == "0").unwrap_or(0);
        for (k, (x, text)) in labels.iter().enumerate() {
            picture.path([(*x, y), (*x, y + 4.0)], INK, 1.0);
            if k % step == zero % step && picture.holds(*x, 0.5 * SMALL * number_width(text)) {
                picture.text(text, (*x, y + 14.0), plain(SMALL));
            }
        }
    }

    pub(super) fn label_left(&self, picture: &mut Picture, ticks: Vec<(f64, String)>) {
        let x = self.across.0;
        for (value, text) in ticks {
            let y = self.up(value);
            picture.path([(x - 4.0, y), (x, y)], INK, 1.0);
            picture.text(&text, (x - 7.0, y), plain(SMALL).pos(END));
        }
    }

    /// Fills the rectangle between two values of x, from top to bottom.
    pub(super) fn band(&self, picture: &mut Picture, (from, to): (f64, f64), color: RGBColor) {
        picture.rect((self.right(from), self.down.0), (self.right(to), self.down.1), color);
    }
}

fn scale(value: f64, (v0, v1): (f64, f64), (p0, p1): (f64, f64)) -> f64 {
    let t = if v1 == v0 { 0.5 } else { (value - v0) / (v1 - v0) };
    p0 + t * (p1 - p0)
}

/// Returns the value at line `k` of a range cut into `n` parts, or the last line.
fn grid_line(k: usize, n: usize, (low, high): (f64, f64)) -> f64 {
    low + (high - low) * k.min(n) as f64 / n as f64
}

/// Least distance between two numbers along an axis.
const APART: f64 = 4.0;

/// Returns the least number n such that every n-th of the labels, centred at ascending places, can be written and none
/// touches the next.
fn every(labels: &[(f64, String)]) -> usize {
    for step in 1..labels.len() {
        let mut pairs = labels.iter().zip(labels.iter().skip(step));
        if pairs.all(|((x, text), (next, other))| {
            next - x > 0.5 * SMALL * number_width(text) + 0.5 * SMALL * number_width(other) + APART
        }) {
            return step;
        }
    }
    labels.len().max(1)
}

/// Most steps in which a colour bar is painted.
const SHADES: usize = 128;
/// Least width of a step in display pixels.
const SHADE_WIDTH: f64 = 3.0;

/// Place of a bar of colours: left and right end, and top.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bar {
    pub(super) across: (f64, f64),
    pub(super) top: f64,
}

impl Bar {
    /// Draws bands of colour side by side, each given by its lower end, with numbers below them.
    pub(super) fn draw(
        self,
        picture: &mut Picture,
        range: (f64, f64),
        bands: impl IntoIterator<Item = (f64, RGBColor)>,
        ticks: Vec<(f64, String)>,
    ) {
        let Self { across, top } = self;
        let frame = Frame { across, down: (top, top + 12.0), x: range, y: (0.0, 1.0) };
        for (from, color) in bands {
            // Each band reaches to the end: the next covers the rest, and no seam shows.
            frame.band(picture, (from, range.1), color);
        }
        frame.outline(picture);
        frame.label_below(picture, ticks);
    }

    /// Draws a scale of colours with its numbers and its name.
    pub(super) fn scale(self, picture: &mut Picture, colours: ColourScale, name: &str) {
        let (range, wide) = (colours.range(), self.across.1 - self.across.0);
        let shades = ((wide / SHADE_WIDTH) as usize).min(SHADES);
        let bands = (0..shades).map(|k| {
            let [from, to] = [k, k + 1].map(|k| grid_line(k, shades, range));
            (from, colours.color(0.5 * (from + to)))
        });
        let ticks = Ticks::inside(range.0, range.1, (wide / 42.0) as usize);
        self.draw(picture, range, bands, ticks.labelled());
        self.name(picture, name, italic(NORMAL));
    }

    /// Writes a name to the left.
    pub(super) fn name(self, picture: &mut Picture, name: &str, style: TextStyle) {
        picture.text(name, (self.across.0 - 10.0, self.top + 6.0), style.pos(END));
    }
}

/// Height of one row of a legend.
pub(super) const LEGEND_ROW: f64 = 19.0;

/// Drawing in a legend beside a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sample {
    Line,
    /// Line with dashes: the second, third or later one of a colour.
    Dashed(usize),
    Ring,
    Swatch,
}

/// Entry of a legend.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) label: String,
    pub(super) color: RGBColor,
    pub(super) sample: Sample,
}

/// Radius of the ring at a point without a line, larger than that of other rings to be seen.
pub(super) const LONE: f64 = 6.0;

/// Length of a sample.
const STROKE: f64 = 22.0;

/// Legend of coloured samples.
#[derive(Default)]
pub(super) struct Legend {
    /// Entries with the places where they begin, relative to the first one.
    entries: Vec<(Entry, Place)>,
}

impl Legend {
    /// Lays out entries in rows no wider than `width`.
    pub(super) fn of(given: impl IntoIterator<Item = Entry>, width: f64) -> Self {
        let (mut x, mut y) = (0.0, 0.0);
        let mut entries = Vec::new();
        for entry in given {
            let wide = STROKE + 6.0 + text_width(&entry.label, SMALL) + 16.0;
            if x > 0.0 && x + wide > width {
                (x, y) = (0.0, y + LEGEND_ROW);
            }
            entries.push((entry, (x, y)));
            x += wide;
        }
        Self { entries }
    }

    /// Height of all rows.
    pub(super) fn high(&self) -> f64 {
        self.entries.last().map_or(0.0, |(_, (_, y))| y + LEGEND_ROW)
    }

    /// Draws the legend; the place is the left end of the first entry, at its middle height.
    pub(super) fn draw(&self, picture: &mut Picture, (left, top): Place) {
        for (Entry { label, color, sample }, (x, y)) in &self.entries {
            let (x, y) = (left + x, top + y);
            let dashes: &[f64] = match sample {
                Sample::Dashed(0) => &[0.0, 0.4, 0.6, 1.0],
                Sample::Dashed(1) => &[0.0, 0.14, 0.29, 0.43, 0.57, 0.71, 0.86, 1.0],
                Sample::Dashed(_) => &[0.0, 0.4, 0.57, 0.64, 0.81, 1.0],
                _ => &[0.0, 1.0],
            };
            match sample {
                Sample::Line | Sample::Dashed(_) => dashes.chunks(2).for_each(|ends| {
                    let places = ends.iter().map(|end| (x + STROKE * end, y));
                    picture.path(places, *color, 2.5);
                }),
                Sample::Ring => picture.ring((x + 0.5 * STROKE, y), LONE, *color),
                Sample::Swatch => picture.rect((x, y - 6.0), (x + STROKE, y + 6.0), *color),
            }
            picture.text(label, (x + STROKE + 6.0, y), plain(SMALL).pos(START));
        }
    }
}

/// Writes the explanation of a line style in secondary ink; returns the x at which the text ends.
pub(super) fn key(picture: &mut Picture, (x, y): Place, text: &str) -> f64 {
    picture.text(text, (x, y), plain(SMALL).pos(START).color(&MUTED));
    x + text_width(text, SMALL)
}
