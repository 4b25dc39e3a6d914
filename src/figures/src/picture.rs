//! Picture: shapes, drawn by plotters on a finer raster, joined in one SVG document.

use super::palette::{DARK, INK, RGBColor, WHITE};
use super::print::Width;
use plotters::backend::{DrawingBackend, SVGBackend};
pub(super) use plotters::style::TextStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontStyle, FontTransform, IntoFont, ShapeStyle};
use signorini_mathematics::problem::text::is_forbidden;
use std::fmt::Write as _;

/// Canvas pixels per display pixel: plotters has whole pixels only, too coarse for a mesh.
const FINE: f64 = 4.0;
/// plotters divides every font size by this.
const FONT_UNIT: f64 = 1.24;
/// Width of most pictures, in display pixels.
pub(super) const WIDTH: f64 = 800.0;
/// Smallest text, in display pixels.
pub(super) const SMALL: f64 = 12.0;
/// Axis names.
pub(super) const NORMAL: f64 = 13.0;
/// Titles of panels.
pub(super) const LARGE: f64 = 14.0;

/// Place in display pixels, y downwards.
pub(super) type Place = (f64, f64);

/// Returns the width to allow for `text`: fonts are not measured, so a wide sans-serif is assumed.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}

fn filled(color: RGBColor) -> ShapeStyle {
    ShapeStyle { color: color.to_rgba(), filled: true, stroke_width: 1 }
}

/// Shapes, given in display pixels.
#[derive(Default)]
pub struct Picture {
    pub(super) width: f64,
    /// Height, which may be set after all is drawn.
    pub(super) height: f64,
    body: String,
    /// True if a place was not finite.
    not_finite: bool,
    /// Data shown, as CSV with a header line; `None` if the input of the drawing function is a file of its own.
    pub table: Option<String>,
    /// Width in print; none for that in display pixels.
    pub print: Option<Width>,
    /// Sentences for the description of the picture, each with a space behind it.
    pub note: String,
}

impl Picture {
    /// Returns an empty picture of this size in display pixels.
    pub(super) fn new(width: f64, height: f64) -> Self {
        Self { width, height, ..Self::default() }
    }

    /// True if the picture contains the interval from `x - reach` to `x + reach`.
    pub(super) fn holds(&self, x: f64, reach: f64) -> bool {
        x - reach >= 0.0 && x + reach <= self.width
    }

    fn canvas(&self) -> (u32, u32) {
        ((self.width * FINE) as u32, (self.height * FINE) as u32)
    }

    fn fine(&mut self, (x, y): Place) -> (i32, i32) {
        self.not_finite |= !(x.is_finite() && y.is_finite());
        ((x * FINE).round() as i32, (y * FINE).round() as i32)
    }

    /// Adds a shape: the elements that plotters writes, without the document around them.
    fn shape<E>(&mut self, draw: impl FnOnce(&mut SVGBackend) -> Result<(), E>) {
        let mut svg = String::new();
        let drawn = draw(&mut SVGBackend::with_string(&mut svg, self.canvas()));
        assert!(drawn.is_ok(), "memory takes every byte");
        // plotters puts text on a line of its own; joined with the next line, it gets no stray spaces.
        let lines = svg.lines().filter(|l| !l.starts_with("<svg") && !l.starts_with("</svg"));
        // Without attributes that have no effect, and with text centred on its capitals instead of its x.
        let shape = lines.collect::<String>().replace(" opacity=\"1\"", "");
        let shape = shape.replace(" stroke=\"none\"", "");
        let shape = shape.replace(" \"/>", "\"/>").replace("dy=\"0.5ex\"", "dy=\"0.36em\"");
        self.body += &(shape + "\n");
    }

    /// Adds shapes that inherit `attributes`, such as a dash pattern, in canvas pixels; no group without any.
    pub(super) fn group(&mut self, attributes: &str, draw: impl FnOnce(&mut Self)) {
        let before = self.body.len();
        draw(self);
        if !attributes.is_empty() && self.body.len() > before {
            self.body.insert_str(before, &format!("<g {attributes}>\n"));
            self.body += "</g>\n";
        }
    }

    /// Draws an open polygon, `width` display pixels thick.
    pub(super) fn path(
        &mut self,
        places: impl IntoIterator<Item = Place>,
        color: RGBColor,
        width: f64,
    ) {
        let mut path: Vec<_> = places.into_iter().map(|at| self.fine(at)).collect();
        path.dedup();
        if let [place] = path[..] {
            // With round ends, a line shorter than a pixel of the canvas is a dot.
            path.push(place);
        }
        let stroke_width = (width * FINE).round().max(1.0) as u32;
        let style = ShapeStyle { color: color.to_rgba(), filled: false, stroke_width };
        self.shape(|svg| svg.draw_path(path, &style));
    }

    /// Fills a closed polygon.
    pub(super) fn polygon(&mut self, places: impl IntoIterator<Item = Place>, color: RGBColor) {
        self.region([places], color);
    }

    /// Fills the region between closed polygons.
    ///
    /// A surface has thousands of triangles: written with moves from corner to corner, where plotters writes places,
    /// the file is a fifth smaller.
    pub(super) fn region<P: IntoIterator<Item = Place>>(
        &mut self,
        polygons: impl IntoIterator<Item = P>,
        color: RGBColor,
    ) {
        let RGBColor(red, green, blue) = color;
        let _ = write!(self.body, "<path fill=\"#{red:02X}{green:02X}{blue:02X}\" d=\"");
        // A polygon that is closed leaves the pen at its first corner.
        let mut first = (0, 0);
        for places in polygons {
            self.body.push('m');
            let mut last = first;
            for (k, place) in places.into_iter().enumerate() {
                let (x, y) = self.fine(place);
                for (number, before) in [(x, last.0), (y, last.1)] {
                    // A minus sign ends the number before it.
                    let space =
                        if number >= before && !self.body.ends_with('m') { " " } else { "" };
                    let _ = write!(self.body, "{space}{}", number - before);
                }
                last = (x, y);
                if k == 0 {
                    first = last;
                }
            }
            self.body.push('z');
        }
        self.body += "\"/>\n";
    }

    /// Refuses the picture if one of these values, which need not have a place, is not finite.
    pub(super) fn refuse_unless_finite(&mut self, values: &[f64]) {
        self.not_finite |= values.iter().any(|value| !value.is_finite());
    }

    /// Fills the rectangle between opposite corners.
    pub(super) fn rect(&mut self, (x0, y0): Place, (x1, y1): Place, color: RGBColor) {
        let low = self.fine((x0.min(x1), y0.min(y1)));
        let high = self.fine((x0.max(x1), y0.max(y1)));
        self.shape(|svg| svg.draw_rect(low, high, &filled(color), true));
    }

    pub(super) fn outline(
        &mut self,
        (x0, y0): Place,
        (x1, y1): Place,
        color: RGBColor,
        width: f64,
    ) {
        // Begun in the middle of a side, so that all four corners are joined.
        let middle = (0.5 * (x0 + x1), y0);
        self.path([middle, (x1, y0), (x1, y1), (x0, y1), (x0, y0), middle], color, width);
    }

    /// Draws a disc with a white core.
    pub(super) fn ring(&mut self, at: Place, radius: f64, color: RGBColor) {
        let at = self.fine(at);
        for (radius, color) in [(radius, color), (radius - 1.5, WHITE)] {
            let radius = (radius * FINE).round() as u32;
            self.shape(|svg| svg.draw_circle(at, radius, &filled(color), true));
        }
    }

    /// Writes a line of text whose middle height is at `at`.
    pub(super) fn text(&mut self, text: &str, at: Place, style: TextStyle) {
        let at = self.fine(at);
        let text: String = text.chars().filter(|c| !is_forbidden(*c)).collect();
        self.shape(|svg| svg.draw_text(&text, &style, at));
    }

    /// Returns the SVG document: scalable, and by default shown at its size in display pixels.
    ///
    /// For readers who cannot see it: `title` is a line on the contents, `description` a line on the origin.
    ///
    /// # Errors
    /// A sentence if nothing is drawn, or a number is not finite.
    pub fn svg(&self, title: &str, description: &str) -> Result<String, &'static str> {
        if self.body.is_empty() {
            return Err("there is nothing to draw; record or solve something first");
        }
        if self.not_finite {
            return Err("a value to be drawn is not a finite number; solve again before drawing");
        }
        let (width, height) = self.canvas();
        let on_screen = [self.width, self.height].map(|length| length.to_string());
        let part = self.height / self.width;
        let [wide, high] = self.print.as_ref().map_or(on_screen, |print| print.attributes(part));
        Ok(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\" stroke-linejoin=\"round\">\n\
             <title>{}</title>\n<desc>{}</desc>\n<style>{}</style>\n\
             <rect width=\"{width}\" height=\"{height}\" rx=\"32\" fill=\"#FFFFFF\"/>\n{}</svg>\n",
            wide,
            high,
            escaped(title),
            escaped(description),
            dark(),
            self.body
        ))
    }
}

/// Returns style rules with which a picture on a dark page has other neutral colours and lighter series.
///
/// An image has the colour scheme of the page around it, hence that of the book's theme.
fn dark() -> String {
    let mut rules = String::from("@media (prefers-color-scheme:dark){");
    for (light, dark) in DARK {
        for property in ["fill", "stroke"] {
            let _ = write!(rules, "[{property}=\"#{light:06X}\"]{{{property}:#{dark:06X}}}");
        }
    }
    rules.push('}');
    rules
}

/// Returns a text as an element of SVG has it.
fn escaped(text: &str) -> String {
    text.chars()
        .filter(|c| !is_forbidden(*c) || *c == '\n')
        .map(|c| match c {
            '<' => "&lt;".into(),
            '>' => "&gt;".into(),
            '&' => "&amp;".into(),
            other => other.to_string(),
        })
        .collect()
}

/// Position of text that begins at its place.
pub(super) const START: Pos = Pos { h_pos: HPos::Left, v_pos: VPos::Center };
/// Position of text that ends at its place.
pub(super) const END: Pos = Pos { h_pos: HPos::Right, v_pos: VPos::Center };
/// Direction of text from below to above.
pub(super) const UPWARDS: FontTransform = FontTransform::Rotate270;

/// Returns the style of text in ink, of this size in display pixels, centred on its place horizontally and vertically.
fn styled(size: f64, style: FontStyle) -> TextStyle<'static> {
    let font = ("sans-serif", size * FINE * FONT_UNIT).into_font().style(style);
    TextStyle::from(font).color(&INK).pos(Pos { h_pos: HPos::Center, v_pos: VPos::Center })
}

pub(super) fn plain(size: f64) -> TextStyle<'static> {
    styled(size, FontStyle::Normal)
}

pub(super) fn bold(size: f64) -> TextStyle<'static> {
    styled(size, FontStyle::Bold)
}

pub(super) fn italic(size: f64) -> TextStyle<'static> {
    styled(size, FontStyle::Italic)
}
