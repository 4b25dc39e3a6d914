//! Boxes around surfaces: panels with a floor, two walls and axes, a colour bar for each scale, and a key below all.

use super::axes::{colour_bar, key};
use super::camera::{Camera, UNIT, View};
use super::floor::Floor;
use super::palette::{ColourScale, INK, MUTED, RGBColor, RULE, SHADE};
use super::picture::{END, LARGE, NORMAL, Picture, Place, SMALL, START, bold, italic, plain};
use super::range_with_zero;
use super::text::{Ticks, number_width, power_of_ten};
use super::title::Title;

/// Size of a panel in display pixels, where two are in a row.
const PANEL: (f64, f64) = (390.0, 392.0);
/// Height of the title and the colour bar of a panel, which do not shrink with it.
const TEXT: f64 = 80.0;
/// Height of the colour bar alone, which panels lack whose scale has one below.
const BAR: f64 = 44.0;
/// Widest colour bar common to several panels.
const COMMON_BAR: f64 = 420.0;
/// Height of a row of the key below the panels.
const KEY: f64 = 22.0;
/// Distance of the numbers from the vertical axis.
const NUMBERS: f64 = 8.0;
/// Room for the numbers to the right of the box.
const NUMBER_RIGHT: f64 = 36.0;
/// Room below the surface over the range of its heights, so that its lowest part is seen above the floor.
const FLOOR_GAP: f64 = 0.18;
/// Room above the surface over the range of its heights.
const CEILING_GAP: f64 = 0.04;
/// Half side of a floor from which on there is room for a number in the middle.
const ROOMY_HALF: f64 = 0.36;
/// Width of a number beside the floor that needs no more room than `-0.5`, over the size of the font.
const SHORT_NUMBER: f64 = 2.5;

/// Attributes of the lines between the cells of a surface: thin strokes both draw them and close the seams.
pub(super) const CELL_LINES: &str = "stroke=\"#203038\" stroke-width=\"1\"";
/// Width of the mark of contact in display pixels.
pub(super) const CONTACT_WIDTH: f64 = 2.75;

/// Panel with a surface in a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boxed<'a> {
    pub(super) title: &'a str,
    /// Azimuth of the viewer, in degrees anticlockwise from the negative y axis.
    pub(super) azimuth: f64,
    /// Ends of the range of colours, ascending.
    pub(super) values: (f64, f64),
    pub(super) floor: Floor,
}

/// Box into which a surface is painted.
pub(super) struct Inside<'a> {
    /// Position of the panel.
    pub(super) panel: usize,
    pub(super) view: &'a View,
    pub(super) colours: ColourScale,
}

/// Returns a range, if none is given that of values and zero; around zero if the range is empty.
pub(super) fn range_of_colours(given: Option<(f64, f64)>, values: &[f64]) -> (f64, f64) {
    let range = given.unwrap_or_else(|| range_with_zero(values.iter().copied()));
    if range.0 < range.1 { range } else { (-1.0, 1.0) }
}

/// Draws one box per panel, in rows of `columns`; `paint` draws what is inside, and the keys have the colours and words
/// of the parts of the boundary that are marked.
///
/// Panels with scales of their own have a colour bar each; rows with one scale have one bar together.
pub(super) fn in_boxes(
    columns: usize,
    (panels, keys): (&[Boxed], &[(RGBColor, &str)]),
    paint: impl Fn(&mut Picture, &Inside),
) -> Picture {
    let columns = columns.min(panels.len());
    let rows: Vec<PanelRow> = rows(columns, panels);
    let scale = (2.0 / columns as f64).min(1.0);
    let wide = scale * PANEL.0;
    let titles: Vec<_> = panels.iter().map(|panel| Title::new(panel.title, wide)).collect();
    let more = titles.iter().map(Title::more).fold(0.0, f64::max);
    let high = scale * (PANEL.1 - TEXT) + TEXT + more;
    let margin = 10.0;
    let heights = rows.iter().map(|row| if row.bars == Bars::Below { high - BAR } else { high });
    let width = 2.0 * margin + columns as f64 * wide;
    let all: f64 = heights.clone().sum();
    let mut picture = Picture::new(width, 2.0 * margin + all + KEY);
    let mut tops = Vec::new();
    let mut top = margin;
    for height in heights {
        tops.push(top);
        top += height;
    }
    for (k, panel) in panels.iter().enumerate() {
        let left = margin + (k % columns) as f64 * wide;
        let top = tops[k / columns] + more;
        let bottom = top + high - more;
        let data = panel.values;
        let span = data.1 - data.0;
        let heights = (data.0 - FLOOR_GAP * span, data.1 + CEILING_GAP * span);
        let ticks = Ticks::inside(heights.0, heights.1, 5);
        let mut view = View {
            camera: Camera::new(panel.azimuth),
            origin: (left + 0.5 * wide + 12.0, top + 24.0 + 160.0 * scale),
            unit: UNIT * scale,
            half: panel.floor.half,
            heights,
        };
        make_room(&mut view, (left, left + wide), Room::around(&panel.floor, &ticks));
        let colours = ColourScale::Viridis { low: data.0, high: data.1 };
        titles[k].draw(&mut picture, (left + 0.5 * wide, top + 16.0), &bold(LARGE));
        walls(&mut picture, &view, &panel.floor, &ticks);
        paint(&mut picture, &Inside { panel: k, view: &view, colours });
        axes(&mut picture, &view, &panel.floor, &ticks);
        let power = panel.floor.power();
        if power != 0 {
            let text = format!("x, y / {}", power_of_ten(power));
            picture.text(&text, (left + 8.0, bottom - 58.0), plain(SMALL).pos(START));
        }
        let half = 0.5 * COMMON_BAR.min(width - 160.0);
        let bar = match rows[k / columns].bars {
            Bars::Each => (left + 76.0 * scale, left + wide - 36.0 * scale),
            Bars::Common if k % columns == 0 => (0.5 * width - half, 0.5 * width + half),
            Bars::Common | Bars::Below => continue,
        };
        colour_bar(&mut picture, bar, bottom - BAR, colours, "v");
    }
    picture.group("stroke-linecap=\"round\"", |picture| {
        let (mut x, y) = (margin + 76.0, top + 12.0);
        for &(color, words) in keys {
            picture.path([(x, y), (x + 28.0, y)], color, CONTACT_WIDTH);
            x = key(picture, (x + 38.0, y), words) + 20.0;
        }
    });
    picture
}

/// Row of panels.
struct PanelRow {
    /// Range of colours, if all panels of the row have the same one.
    common: Option<(f64, f64)>,
    bars: Bars,
}

/// Colour bars of a row.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Bars {
    /// One below each panel.
    Each,
    /// One for the row, and for the rows above it with the same scale.
    Common,
    /// None: the row below has the same scale.
    Below,
}

/// Returns the rows of panels, `columns` in each.
fn rows(columns: usize, panels: &[Boxed]) -> Vec<PanelRow> {
    let mut rows: Vec<PanelRow> = Vec::new();
    for row in panels.chunks(columns) {
        let is_common = row.len() > 1 && row.iter().all(|panel| panel.values == row[0].values);
        let common = is_common.then_some(row[0].values);
        if let Some(above) = rows.last_mut().filter(|above| is_common && above.common == common) {
            above.bars = Bars::Below;
        }
        rows.push(PanelRow { common, bars: if is_common { Bars::Common } else { Bars::Each } });
    }
    rows
}

/// Draws the floor and the two far walls, with rules at the ticks.
fn walls(picture: &mut Picture, view: &View, floor: &Floor, ticks: &Ticks) {
    let [nx, ny] = view.nearest_corner();
    let [hx, hy] = view.half;
    let (low, high) = view.heights;
    let corners = [[-hx, -hy, low], [hx, -hy, low], [hx, hy, low], [-hx, hy, low]];
    picture.polygon(corners.map(|point| view.place(point)), SHADE);
    for v in ticks.values() {
        let line = [[-nx, ny, v], [-nx, -ny, v], [nx, -ny, v]];
        let (color, width) = if v == 0.0 { (MUTED, 1.0) } else { (RULE, 0.75) };
        picture.path(line.map(|point| view.place(point)), color, width);
    }
    for (x, y) in floor.marks(0).into_iter().zip(floor.marks(1)).skip(1).take(3) {
        let across = [[x, ny, low], [x, -ny, low], [x, -ny, high]];
        let along = [[nx, y, low], [-nx, y, low], [-nx, y, high]];
        picture.path(across.map(|point| view.place(point)), RULE, 0.75);
        picture.path(along.map(|point| view.place(point)), RULE, 0.75);
    }
    for [x, y] in [[-nx, ny], [-nx, -ny], [nx, -ny]] {
        let edge = [[x, y, low], [x, y, high]];
        picture.path(edge.map(|point| view.place(point)), MUTED, 0.75);
    }
    for v in [low, high] {
        let edges = [[-nx, ny, v], [-nx, -ny, v], [nx, -ny, v]];
        picture.path(edges.map(|point| view.place(point)), MUTED, 0.75);
    }
}

/// Room for numbers on both sides of a box.
struct Room {
    left: f64,
    /// Room on the right; none is asked for if the numbers there are short.
    right: Option<f64>,
}

impl Room {
    fn around(floor: &Floor, ticks: &Ticks) -> Self {
        let numbers = [floor.numbers(0), floor.numbers(1)].concat();
        let widest = numbers.iter().map(|text| number_width(text)).fold(0.0, f64::max);
        let left = NUMBERS + SMALL * ticks.widest();
        if widest <= SHORT_NUMBER {
            return Self { left, right: None };
        }
        let longer = SMALL * (widest - SHORT_NUMBER);
        Self { left: left.max(NUMBER_RIGHT + longer), right: Some(NUMBER_RIGHT + longer) }
    }
}

/// Moves and narrows the box if the numbers beside it would reach out of the panel.
fn make_room(view: &mut View, (left, right): (f64, f64), room: Room) {
    let [x, y] = leftmost(view);
    let half = view.origin.0 - view.place([x, y, view.heights.0]).0;
    let is_cut = room.right.is_some_and(|room| view.origin.0 + half + room > right);
    if is_cut || view.origin.0 - half - room.left < left {
        let beside = room.left + room.right.unwrap_or(NUMBER_RIGHT);
        let narrower = (0.5 * (right - left - beside) / half).min(1.0);
        view.unit *= narrower;
        view.origin.0 = left + room.left + narrower * half;
    }
}

/// Returns the leftmost corner of the floor in the picture: there the surface cannot hide the vertical axis.
fn leftmost(view: &View) -> [f64; 2] {
    let [nx, ny] = view.nearest_corner();
    let low = view.heights.0;
    let left = view.place([nx, -ny, low]).0 <= view.place([-nx, ny, low]).0;
    if left { [nx, -ny] } else { [-nx, ny] }
}

/// Draws the near edges of the floor and the vertical axis, with ticks, numbers and names.
fn axes(picture: &mut Picture, view: &View, floor: &Floor, ticks: &Ticks) {
    let [nx, ny] = view.nearest_corner();
    let (low, high) = view.heights;
    let edges = [
        floor.marks(0).map(|t| view.place([t, ny, low])),
        floor.marks(1).map(|t| view.place([nx, t, low])),
    ];
    for (d, marks) in edges.into_iter().enumerate() {
        let name_mark = if floor.half[d] < ROOMY_HALF { 2 } else { 1 };
        let out = outward(view, [[0.0, ny], [nx, 0.0]][d]);
        let edge =
            FloorEdge { name: ["x", "y"][d], name_mark, numbers: floor.numbers(d), marks, out };
        edge.draw(picture);
    }
    let [cx, cy] = leftmost(view);
    let (bottom, top) = (view.place([cx, cy, low]), view.place([cx, cy, high]));
    picture.path([bottom, top], INK, 1.0);
    for (v, text) in ticks.labelled() {
        let (x, y) = view.place([cx, cy, v]);
        picture.path([(x - 5.0, y), (x, y)], INK, 1.0);
        // Too near the floor, a number would collide with the first one there.
        if y < bottom.1 - SMALL {
            picture.text(&text, (x - NUMBERS, y), plain(SMALL).pos(END));
        }
    }
    picture.text("v", (top.0, top.1 - 14.0), italic(NORMAL));
}

/// Returns the direction of (dx, dy) on the floor as a step of one display pixel in the picture.
fn outward(view: &View, [dx, dy]: [f64; 2]) -> Place {
    let low = view.heights.0;
    let (from, to) = (view.place([0.0, 0.0, low]), view.place([dx, dy, low]));
    let (px, py) = (to.0 - from.0, to.1 - from.1);
    let length = (px * px + py * py).sqrt().max(1e-9);
    (px / length, py / length)
}

/// Near edge of the floor.
struct FloorEdge {
    name: &'static str,
    /// Position of the mark at which the name is written.
    name_mark: usize,
    /// Numbers at the first, the middle and the last mark.
    numbers: [String; 3],
    marks: [Place; 5],
    /// Step of one display pixel away from the floor.
    out: Place,
}

impl FloorEdge {
    fn draw(&self, picture: &mut Picture) {
        picture.path([self.marks[0], self.marks[4]], INK, 1.0);
        let mut name_distance: f64 = 24.0;
        for (k, text) in self.numbers.iter().enumerate() {
            let mark = self.marks[2 * k];
            picture.path([mark, self.stepped(mark, 5.0)], INK, 1.0);
            // Without room for a number in the middle, the name is there.
            if 2 * k == self.name_mark {
                continue;
            }
            let longer = SMALL * (number_width(text) - SHORT_NUMBER).max(0.0);
            let (x, y) = self.stepped(mark, 17.0);
            // The end towards the floor stays where that of a short number is.
            let shift = 0.5 * longer * (2.0 * self.out.0).clamp(-1.0, 1.0);
            picture.text(text, (x + shift, y), plain(SMALL));
            if longer > 0.0 {
                name_distance = 14.0;
            }
        }
        picture.text(
            self.name,
            self.stepped(self.marks[self.name_mark], name_distance),
            italic(NORMAL),
        );
    }

    fn stepped(&self, at: Place, by: f64) -> Place {
        (at.0 + by * self.out.0, at.1 + by * self.out.1)
    }
}
