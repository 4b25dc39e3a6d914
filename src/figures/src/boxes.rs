//! Boxes around surfaces: a floor, two walls and axes.

use super::camera::{Camera, Vector, dot};
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

/// Height of the box, its sides being 1.
const BOX_HEIGHT: f64 = 0.66;
/// Display pixels per unit of length, where two panels are in a row.
pub(super) const UNIT: f64 = 205.0;
/// Light that every side receives; the rest comes from the lamp.
const AMBIENT: f64 = 0.62;

/// Box around a surface, seen in parallel projection.
pub(super) struct Boxed {
    pub(super) camera: Camera,
    /// Place of the middle of the box, in display pixels.
    origin: Place,
    /// Display pixels per unit of length.
    unit: f64,
    pub(super) floor: Floor,
    /// Values at the floor and the ceiling of the box.
    heights: (f64, f64),
    /// Numbers along the vertical axis.
    ticks: Ticks,
    pub(super) colours: ColourScale,
}

impl Boxed {
    /// Places a surface between the left and the right end of its panel, whose title ends at `top`.
    pub(super) fn new(panel: &DrawnSolution, ends: (f64, f64), top: f64, scale: f64) -> Self {
        let (low, high) = panel.range_of_colours();
        let span = high - low;
        let heights = (low - FLOOR_GAP * span, high + CEILING_GAP * span);
        let mut inside = Self {
            camera: Camera::new(panel.azimuth),
            origin: (ends.0 + 0.5 * (ends.1 - ends.0) + 12.0, top + 24.0 + 160.0 * scale),
            unit: UNIT * scale,
            floor: Floor::around(panel.mesh.points()),
            heights,
            ticks: Ticks::inside(heights.0, heights.1, 5),
            colours: ColourScale::Viridis { low, high },
        };
        inside.make_room(ends);
        inside
    }

    /// Returns the point of the box for (x, y, v): heights scaled, centre at the origin.
    pub(super) fn point(&self, [x, y, v]: Vector) -> Vector {
        let (low, high) = self.heights;
        [x, y, BOX_HEIGHT * ((v - low) / (high - low) - 0.5)]
    }

    /// Returns the place of (x, y, v) in the picture.
    pub(super) fn place(&self, xyv: Vector) -> Place {
        let point = self.point(xyv);
        (
            self.origin.0 + self.unit * dot(point, self.camera.right),
            self.origin.1 - self.unit * dot(point, self.camera.up),
        )
    }

    /// Returns the corner of the floor nearest to the viewer.
    pub(super) fn nearest_corner(&self) -> [f64; 2] {
        [0, 1].map(|d| self.camera.near[d] * self.floor.half[d])
    }

    /// Returns the light reflected by a part of the surface with this upward normal.
    pub(super) fn brightness(&self, normal: Vector) -> f64 {
        // Over the viewer's left shoulder, so that slopes to either side differ.
        let camera = &self.camera;
        let lamp = [0, 1, 2].map(|d| camera.toward[d] + 0.9 * camera.up[d] - 0.8 * camera.right[d]);
        let cosine = dot(normal, lamp) / (dot(normal, normal) * dot(lamp, lamp)).sqrt();
        let facing = if dot(normal, camera.toward) < 0.0 { 0.8 } else { 1.0 };
        facing * (AMBIENT + (1.06 - AMBIENT) * cosine.abs())
    }

    /// Draws the floor and the two far walls, with rules at the ticks.
    pub(super) fn walls(&self, picture: &mut Picture) {
        let Self { floor, ticks, .. } = self;
        let [nx, ny] = self.nearest_corner();
        let [hx, hy] = floor.half;
        let (low, high) = self.heights;
        let corners = [[-hx, -hy, low], [hx, -hy, low], [hx, hy, low], [-hx, hy, low]];
        picture.polygon(corners.map(|point| self.place(point)), SHADE);
        for v in ticks.values() {
            let line = [[-nx, ny, v], [-nx, -ny, v], [nx, -ny, v]];
            let (color, width) = if v == 0.0 { (MUTED, 1.0) } else { (RULE, 0.75) };
            picture.path(line.map(|point| self.place(point)), color, width);
        }
        for (x, y) in floor.marks(0).into_iter().zip(floor.marks(1)).skip(1).take(3) {
            let across = [[x, ny, low], [x, -ny, low], [x, -ny, high]];
            let along = [[nx, y, low], [-nx, y, low], [-nx, y, high]];
            picture.path(across.map(|point| self.place(point)), RULE, 0.75);
            picture.path(along.map(|point| self.place(point)), RULE, 0.75);
        }
        for [x, y] in [[-nx, ny], [-nx, -ny], [nx, -ny]] {
            let edge = [[x, y, low], [x, y, high]];
            picture.path(edge.map(|point| self.place(point)), MUTED, 0.75);
        }
        for v in [low, high] {
            let edges = [[-nx, ny, v], [-nx, -ny, v], [nx, -ny, v]];
            picture.path(edges.map(|point| self.place(point)), MUTED, 0.75);
        }
    }

    /// Draws near edge `d` of the floor, with ticks at the first, the middle and the last mark, numbers and its name.
    fn edge(&self, picture: &mut Picture, d: usize) {
        let [nx, ny] = self.nearest_corner();
        let low = self.heights.0;
        let ends = self.floor.marks(d).map(|t| if d == 0 { [t, ny, low] } else { [nx, t, low] });
        let marks = ends.map(|point| self.place(point));
        let out = self.outward([[0.0, ny], [nx, 0.0]][d]);
        let name_mark = if self.floor.half[d] < ROOMY_HALF { 2 } else { 1 };
        picture.path([marks[0], marks[4]], INK, 1.0);
        let mut name_distance = 24.0;
        for (k, text) in self.floor.numbers(d).iter().enumerate() {
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
        let (low, high) = self.heights;
        self.edge(picture, 0);
        self.edge(picture, 1);
        let [cx, cy] = self.leftmost();
        let (bottom, top) = (self.place([cx, cy, low]), self.place([cx, cy, high]));
        picture.path([bottom, top], INK, 1.0);
        for (v, text) in self.ticks.labelled() {
            let (x, y) = self.place([cx, cy, v]);
            picture.path([(x - 5.0, y), (x, y)], INK, 1.0);
            // Too near the floor, a number would collide with the first one there.
            if y < bottom.1 - SMALL {
                picture.text(&text, (x - NUMBERS, y), plain(SMALL).pos(END));
            }
        }
        picture.text("v", (top.0, top.1 - 14.0), italic(NORMAL));
    }

    /// Moves and narrows the box if the numbers beside it would reach out of the panel.
    fn make_room(&mut self, (left, right): (f64, f64)) {
        let numbers = [self.floor.numbers(0), self.floor.numbers(1)].concat();
        let widest = numbers.iter().map(|text| number_width(text)).fold(0.0, f64::max);
        let longer = SMALL * (widest - SHORT_NUMBER).max(0.0);
        let (on_left, on_right) = (NUMBERS + SMALL * self.ticks.widest(), NUMBER_RIGHT + longer);
        let on_left = if longer > 0.0 { on_left.max(on_right) } else { on_left };
        let [x, y] = self.leftmost();
        let half = self.origin.0 - self.place([x, y, self.heights.0]).0;
        let is_cut = longer > 0.0 && self.origin.0 + half + on_right > right;
        if is_cut || self.origin.0 - half - on_left < left {
            let narrower = (0.5 * (right - left - (on_left + on_right)) / half).min(1.0);
            self.unit *= narrower;
            self.origin.0 = left + on_left + narrower * half;
        }
    }

    /// Returns the leftmost corner of the floor in the picture: there the surface cannot hide the vertical axis.
    fn leftmost(&self) -> [f64; 2] {
        let [nx, ny] = self.nearest_corner();
        let low = self.heights.0;
        let left = self.place([nx, -ny, low]).0 <= self.place([-nx, ny, low]).0;
        if left { [nx, -ny] } else { [-nx, ny] }
    }

    /// Returns the direction of (dx, dy) on the floor as a step of one display pixel in the picture.
    fn outward(&self, [dx, dy]: [f64; 2]) -> Place {
        let low = self.heights.0;
        let (from, to) = (self.place([0.0, 0.0, low]), self.place([dx, dy, low]));
        let (px, py) = (to.0 - from.0, to.1 - from.1);
        let length = (px * px + py * py).sqrt().max(1e-9);
        (px / length, py / length)
    }
}

/// Returns the place at so many steps from another one.
fn stepped((x, y): Place, (dx, dy): Place, by: f64) -> Place {
    (x + by * dx, y + by * dy)
}
