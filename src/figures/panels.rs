//! Square panels in rows, each with room for its title and axes, above a foot common to all.

use super::axes::Frame;
use super::picture::{LARGE, Picture, bold};

/// Layout, in display pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panels {
    pub(super) count: usize,
    /// Most panels in a row.
    pub(super) columns: usize,
    pub(super) side: f64,
    /// Empty width on the left and on the right of the picture.
    pub(super) margin: f64,
    /// Distance from the left edge of a panel's cell to the square.
    pub(super) left: f64,
    /// Width and height of a cell less those of the square.
    pub(super) around: (f64, f64),
    pub(super) foot: f64,
}

/// Distance from the upper edge of a cell to the square.
const ABOVE: f64 = 48.0;

impl Panels {
    fn cell(&self) -> (f64, f64) {
        (self.side + self.around.0, self.side + self.around.1)
    }

    pub(super) fn size(&self) -> (f64, f64) {
        let columns = self.count.min(self.columns) as f64;
        (2.0 * self.margin + columns * self.cell().0, self.foot_top() + self.foot)
    }

    pub(super) fn foot_top(&self) -> f64 {
        self.count.div_ceil(self.columns) as f64 * self.cell().1
    }

    /// Returns the square of panel `k`, with the ranges of its axes.
    pub(super) fn frame(&self, k: usize, x: (f64, f64), y: (f64, f64)) -> Frame {
        let left = self.margin + (k % self.columns) as f64 * self.cell().0 + self.left;
        let top = (k / self.columns) as f64 * self.cell().1 + ABOVE;
        Frame { across: (left, left + self.side), down: (top, top + self.side), x, y }
    }
}

pub(super) fn title(picture: &mut Picture, frame: &Frame, text: &str) {
    picture.text(text, (frame.middle().0, frame.down.0 - 22.0), bold(LARGE));
}
