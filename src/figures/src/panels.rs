//! Panels in rows, each with room for its title and axes, between a head and a foot common to all.

use super::axes::{Frame, Legend};
use super::picture::{LARGE, Picture, START, bold};
use super::title::Title;

/// Layout, in display pixels.
#[derive(Clone, Debug, Default)]
pub(super) struct Panels {
    /// Most panels in a row.
    pub(super) columns: usize,
    /// Width of every frame.
    pub(super) wide: f64,
    /// Room of a panel to the left and right of its frame.
    pub(super) beside: (f64, f64),
    /// Empty width on the left and on the right of the picture.
    pub(super) margin: f64,
    /// Heights above all panels and below them.
    pub(super) head: f64,
    pub(super) foot: f64,
    /// Heights of each panel: above its frame, of the frame, and below it.
    pub(super) heights: Vec<[f64; 3]>,
    /// Titles above the middles of the frames; none where panels have a [`Head`].
    pub(super) titles: Vec<Title>,
}

/// Least room above a frame with a title.
const ABOVE: f64 = 48.0;
/// Distance of the last line of a title from the frame, and of the first one from the top of the panel.
const TITLE: [f64; 2] = [22.0, 16.0];

impl Panels {
    /// Returns this layout with a panel for each title, with frames of one height and the same room below them.
    pub(super) fn titled<'a>(
        mut self,
        titles: impl IntoIterator<Item = &'a str>,
        [high, below]: [f64; 2],
    ) -> Self {
        self.titles = titles.into_iter().map(|text| Title::new(text, self.cell())).collect();
        let rooms = self.titles.iter().map(|title| TITLE[0] + TITLE[1] + title.more());
        self.heights = vec![[rooms.fold(ABOVE, f64::max), high, below]; self.titles.len()];
        self
    }

    /// Draws the title of panel `k`, and returns its frame.
    pub(super) fn begin(&self, picture: &mut Picture, k: usize, ranges: [(f64, f64); 2]) -> Frame {
        let frame = self.frame(k, ranges[0], ranges[1]);
        let at = (frame.middle().0, frame.down.0 - TITLE[0]);
        self.titles[k].draw(picture, at, &bold(LARGE));
        frame
    }

    /// Width of a panel with its room.
    fn cell(&self) -> f64 {
        self.beside.0 + self.wide + self.beside.1
    }

    /// Returns an empty picture for the panels.
    pub(super) fn picture(&self) -> Picture {
        Picture::new(self.width(), self.foot_top() + self.foot)
    }

    pub(super) fn width(&self) -> f64 {
        2.0 * self.margin + self.heights.len().min(self.columns) as f64 * self.cell()
    }

    pub(super) fn foot_top(&self) -> f64 {
        self.top(self.heights.len().div_ceil(self.columns))
    }

    /// Returns the top of a row of panels, or of the foot.
    fn top(&self, row: usize) -> f64 {
        let rows = self.heights.chunks(self.columns).take(row).map(highest);
        rows.fold(self.head, |top, [above, high, below]| top + above + high + below)
    }

    /// Returns the frame of panel `k`, with the ranges of its axes.
    pub(super) fn frame(&self, k: usize, x: (f64, f64), y: (f64, f64)) -> Frame {
        let (row, column) = (k / self.columns, (k % self.columns) as f64);
        let left = self.margin + column * self.cell() + self.beside.0;
        let panels = self.heights.chunks(self.columns).nth(row).unwrap_or_default();
        let top = self.top(row) + highest(panels)[0];
        Frame { across: (left, left + self.wide), down: (top, top + self.heights[k][1]), x, y }
    }
}

/// Returns the greatest heights of the panels of a row.
fn highest(panels: &[[f64; 3]]) -> [f64; 3] {
    panels.iter().fold([0.0; 3], |most, panel| [0, 1, 2].map(|k| panel[k].max(most[k])))
}

/// Title of a panel and a legend below it, both above the left end of a frame.
pub(super) struct Head {
    pub(super) title: Title,
    pub(super) legend: Legend,
    /// Distance of the title from the frame, without the legend.
    pub(super) gap: f64,
}

/// Distance of the first row of a legend from the title above it.
const LEGEND: f64 = 24.0;

impl Head {
    /// Height from the middle of the first line of the title to the frame.
    pub(super) fn high(&self) -> f64 {
        self.title.more() + self.legend.high() + self.gap
    }

    pub(super) fn draw(&self, picture: &mut Picture, frame: &Frame) {
        let (left, title) = (frame.across.0, frame.down.0 - self.gap - self.legend.high());
        self.title.draw(picture, (left, title), &bold(LARGE).pos(START));
        self.legend.draw(picture, (left, title + LEGEND));
    }
}
