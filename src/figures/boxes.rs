//! Boxes around surfaces: a floor, two walls and axes.

use super::camera::{Camera, UNIT, View};
use super::drawn::DrawnSolution;
use super::floor::Floor;
use super::palette::{ColourScale, INK, MUTED, RULE, SHADE};
use super::picture::{END, NORMAL, Picture, Place, SMALL, italic, plain};
use super::text::{Ticks, number_width};

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

/// Surface in its box: its view, its floor, and the numbers along the vertical axis.
pub(super) struct Boxed {
    pub(super) view: View,
    pub(super) floor: Floor,
    ticks: Ticks,
    pub(super) colours: ColourScale,
}

impl Boxed {
    /// Places a surface between the left and the right end of its panel, whose title ends at `top`.
    pub(super) fn new(
        panel: &DrawnSolution,
        (left, right): (f64, f64),
        top: f64,
        scale: f64,
    ) -> Self {
        let floor = Floor::around(panel.mesh.points());
        let (low, high) = panel.range_of_colours();
        let span = high - low;
        let heights = (low - FLOOR_GAP * span, high + CEILING_GAP * span);
        let ticks = Ticks::inside(heights.0, heights.1, 5);
        let mut view = View {
            camera: Camera::new(panel.azimuth),
            origin: (left + 0.5 * (right - left) + 12.0, top + 24.0 + 160.0 * scale),
            unit: UNIT * scale,
            half: floor.half,
            heights,
        };
        make_room(&mut view, (left, right), &floor, &ticks);
        Self { view, floor, ticks, colours: ColourScale::Viridis { low, high } }
    }

    /// Draws the floor and the two far walls, with rules at the ticks.
    pub(super) fn walls(&self, picture: &mut Picture) {
        let Self { view, floor, ticks, .. } = self;
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

    /// Draws near edge `d` of the floor, with ticks at the first, the middle and the last mark, numbers and its name.
    fn edge(&self, picture: &mut Picture, d: usize) {
        let Self { view, floor, .. } = self;
        let [nx, ny] = view.nearest_corner();
        let low = view.heights.0;
        let ends = floor.marks(d).map(|t| if d == 0 { [t, ny, low] } else { [nx, t, low] });
        let marks = ends.map(|point| view.place(point));
        let out = outward(view, [[0.0, ny], [nx, 0.0]][d]);
        let name_mark = if floor.half[d] < ROOMY_HALF { 2 } else { 1 };
        picture.path([marks[0], marks[4]], INK, 1.0);
        let mut name_distance = 24.0;
        for (k, text) in floor.numbers(d).iter().enumerate() {
            let mark = marks[2 * k];
            picture.path([mark, stepped(mark, out, 5.0)], INK, 1.0);
            // Without room for a number in the middle, the name is there.
            if 2 * k == name_mark {
                continue;
            }
            let longer = SMALL * (number_width(text) - SHORT_NUMBER).max(0.0);
            let (x, y) = stepped(mark, out, 17.0);
            // The end towards the floor stays where that of a short number is.
            let shift = 0.5 * longer * (2.0 * out.0).clamp(-1.0, 1.0);
            picture.text(text, (x + shift, y), plain(SMALL));
            if longer > 0.0 {
                name_distance = 14.0;
            }
        }
        let at = stepped(marks[name_mark], out, name_distance);
        picture.text(["x", "y"][d], at, italic(NORMAL));
    }

    /// Draws the near edges of the floor and the vertical axis, with ticks, numbers and names.
    pub(super) fn axes(&self, picture: &mut Picture) {
        let Self { view, ticks, .. } = self;
        let (low, high) = view.heights;
        self.edge(picture, 0);
        self.edge(picture, 1);
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
}

/// Moves and narrows the box if the numbers beside it would reach out of the panel.
fn make_room(view: &mut View, (left, right): (f64, f64), floor: &Floor, ticks: &Ticks) {
    let numbers = [floor.numbers(0), floor.numbers(1)].concat();
    let widest = numbers.iter().map(|text| number_width(text)).fold(0.0, f64::max);
    let longer = SMALL * (widest - SHORT_NUMBER).max(0.0);
    let (on_left, on_right) = (NUMBERS + SMALL * ticks.widest(), NUMBER_RIGHT + longer);
    let on_left = if longer > 0.0 { on_left.max(on_right) } else { on_left };
    let [x, y] = leftmost(view);
    let half = view.origin.0 - view.place([x, y, view.heights.0]).0;
    let is_cut = longer > 0.0 && view.origin.0 + half + on_right > right;
    if is_cut || view.origin.0 - half - on_left < left {
        let narrower = (0.5 * (right - left - (on_left + on_right)) / half).min(1.0);
        view.unit *= narrower;
        view.origin.0 = left + on_left + narrower * half;
    }
}

/// Returns the leftmost corner of the floor in the picture: there the surface cannot hide the vertical axis.
fn leftmost(view: &View) -> [f64; 2] {
    let [nx, ny] = view.nearest_corner();
    let low = view.heights.0;
    let left = view.place([nx, -ny, low]).0 <= view.place([-nx, ny, low]).0;
    if left { [nx, -ny] } else { [-nx, ny] }
}

/// Returns the direction of (dx, dy) on the floor as a step of one display pixel in the picture.
fn outward(view: &View, [dx, dy]: [f64; 2]) -> Place {
    let low = view.heights.0;
    let (from, to) = (view.place([0.0, 0.0, low]), view.place([dx, dy, low]));
    let (px, py) = (to.0 - from.0, to.1 - from.1);
    let length = (px * px + py * py).sqrt().max(1e-9);
    (px / length, py / length)
}

/// Returns the place at so many steps from another one.
fn stepped((x, y): Place, (dx, dy): Place, by: f64) -> Place {
    (x + by * dx, y + by * dy)
}
