//! Panels in rows, each with room for its title and axes, above a foot common to all.

use super::axes::Frame;
use super::picture::{LARGE, Picture, bold};
use super::title::Title;

/// Layout, in display pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Panels {
    pub(super) count: usize,
    /// Most panels in a row.
    pub(super) columns: usize,
    /// Width and height of the frame of a panel.
    pub(super) frame: (f64, f64),
    /// Empty width on the left and on the right of the picture.
    pub(super) margin: f64,
    /// Room of a panel to the left and right of its frame.
    pub(super) beside: (f64, f64),
    /// Room of a panel above its frame, by [`above`], and below.
    pub(super) above: f64,
    pub(super) below: f64,
    pub(super) foot: f64,
}

/// Room above a frame, for a title of one line.
const ABOVE: f64 = 48.0;
/// Distance of the last line of a title from the frame.
const TITLE: f64 = 22.0;

/// Returns the room above frames that these titles need.
pub(super) fn above<'a>(titles: impl IntoIterator<Item = &'a Title>) -> f64 {
    titles.into_iter().map(|title| TITLE + 16.0 + title.more()).fold(ABOVE, f64::max)
}

impl Panels {
    /// Width and height of a panel.
    pub(super) fn cell(&self) -> (f64, f64) {
        let (wide, high) = self.frame;
        (self.beside.0 + wide + self.beside.1, self.above + high + self.below)
    }

    pub(super) fn size(&self) -> (f64, f64) {
        let columns = self.count.min(self.columns) as f64;
        (2.0 * self.margin + columns * self.cell().0, self.foot_top() + self.foot)
    }

    pub(super) fn foot_top(&self) -> f64 {
        self.count.div_ceil(self.columns) as f64 * self.cell().1
    }

    /// Returns the frame of panel `k`, with the ranges of its axes.
    pub(super) fn frame(&self, k: usize, x: (f64, f64), y: (f64, f64)) -> Frame {
        let left = self.margin + (k % self.columns) as f64 * self.cell().0 + self.beside.0;
        let top = (k / self.columns) as f64 * self.cell().1 + self.above;
        let (wide, high) = self.frame;
        Frame { across: (left, left + wide), down: (top, top + high), x, y }
    }
}

/// Writes the title of a panel above its frame.
pub(super) fn draw_title(picture: &mut Picture, frame: &Frame, title: &Title) {
    title.draw(picture, (frame.middle().0, frame.down.0 - TITLE), &bold(LARGE));
}
