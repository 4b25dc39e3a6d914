//! Solutions on the meshes of pictures, whose triangles can be told apart.

use super::camera::uphill;
use super::{IN_SPACE, held, range_with_zero};
use signorini_mathematics::discrete::grid::Grid;
use signorini_mathematics::discrete::load::LoadRule;
use signorini_mathematics::levels::{Drawing, Problem};
use signorini_mathematics::mesh::PlaneMesh;
use signorini_mathematics::problem::law::Law;
use signorini_mathematics::problem::source::Source;
use signorini_mathematics::saddle::Pair;

/// Most cells across that are drawn where two panels are in a row, beside which a file would grow too large; in smaller
/// panels there are fewer.
pub(crate) const MOST_CELLS: usize = 32;

/// Solution on the mesh of a picture.
#[derive(Clone, Debug)]
pub struct DrawnSolution {
    pub(super) title: String,
    /// Words for nodes of the boundary that stick.
    pub(super) held: &'static str,
    pub(super) mesh: PlaneMesh,
    /// Heights at the nodes.
    pub y: Vec<f64>,
    /// Nodes that stick.
    pub(super) in_contact: Vec<bool>,
    /// Azimuth of the viewer, in degrees anticlockwise from the negative y axis: that from which the surface hides
    /// least, unless [`seen`](Self::seen) otherwise.
    pub azimuth: f64,
    /// Range of heights and colours; `None` for that of the data and zero.
    pub(super) range: Option<(f64, f64)>,
}

impl DrawnSolution {
    /// Pair of the finest level of a problem, as a panel in rows of `columns`.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub fn of(
        title: String,
        problem: &Problem,
        pair: &Pair,
        columns: usize,
    ) -> Result<Self, String> {
        let drawing = problem.levels().drawing(MOST_CELLS * 2 / columns);
        let Drawing { mesh, nodes } = drawing.ok_or(IN_SPACE)?;
        let at_nodes = problem.at_nodes(&problem.in_contact(pair), false);
        let y: Vec<f64> = nodes.iter().map(|&node| pair.y[node]).collect();
        let in_contact = nodes.iter().map(|&node| at_nodes[node]).collect();
        let (held, azimuth) = (held(problem), uphill(&mesh, &y));
        Ok(Self { title, held, azimuth, mesh, y, in_contact, range: None })
    }

    /// Pair on a grid of the square under the paper's law, as a panel in rows of `columns`.
    pub fn on_grid(title: String, grid: Grid, pair: &Pair, columns: usize) -> Self {
        // f plays no part in the picture.
        let f = Source::constant(-1.0);
        let problem = Problem::on_square(vec![grid], f, LoadRule::default(), Law::SIGNORINI);
        let problem = problem.expect("the flux balances a load downwards");
        Self::of(title, &problem, pair, columns).expect("the square has pictures")
    }

    /// This surface without marks of contact.
    pub fn without_contact(mut self) -> Self {
        self.in_contact.fill(false);
        self
    }

    /// These surfaces under the same azimuth, with one range of heights and colours.
    pub fn seen(mut all: Vec<Self>, azimuth: f64) -> Vec<Self> {
        let range = range_with_zero(all.iter().flat_map(|one| one.y.iter().copied()));
        for one in &mut all {
            (one.azimuth, one.range) = (azimuth, Some(range));
        }
        all
    }

    /// Returns the range of heights and colours; around zero if the range is empty.
    pub(super) fn range_of_colours(&self) -> (f64, f64) {
        let range = self.range.unwrap_or_else(|| range_with_zero(self.y.iter().copied()));
        if range.0 < range.1 { range } else { (-1.0, 1.0) }
    }
}
