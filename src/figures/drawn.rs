//! Solutions on the meshes of pictures, whose triangles can be told apart.

use super::Surface;
use super::camera::uphill;
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
pub(crate) struct DrawnSolution {
    title: String,
    law: Law,
    mesh: PlaneMesh,
    /// Heights at the nodes.
    pub(crate) y: Vec<f64>,
    /// Nodes with v = 0 by the law.
    in_contact: Vec<bool>,
}

impl DrawnSolution {
    /// Solution of a problem, as a panel in rows of `columns`.
    ///
    /// # Errors
    /// A sentence if the domain lies in space.
    pub(crate) fn of(
        title: String,
        problem: &Problem,
        pair: &Pair,
        columns: usize,
    ) -> Result<Self, String> {
        let drawing = problem.levels().drawing(MOST_CELLS * 2 / columns.max(2));
        let Drawing { mesh, nodes } = drawing.ok_or("a solution in space has no picture")?;
        let (law, in_contact) = (problem.law(), problem.in_contact(pair));
        let in_contact = problem.at_nodes(&in_contact, false);
        let y = nodes.iter().map(|&node| pair.y[node]).collect();
        let in_contact = nodes.iter().map(|&node| in_contact[node]).collect();
        Ok(Self { title, law, mesh, y, in_contact })
    }

    /// Pair on a grid of the square under the paper's law, as a panel in rows of `columns`.
    pub(crate) fn on_grid(title: String, grid: Grid, pair: &Pair, columns: usize) -> Self {
        // f plays no part in the picture.
        let f = Source::constant(-1.0);
        let problem = Problem::on_square(vec![grid], f, LoadRule::default(), Law::SIGNORINI);
        let problem = problem.expect("the flux balances a load downwards");
        Self::of(title, &problem, pair, columns).expect("the square has pictures")
    }

    /// This surface without marks of contact.
    pub(crate) fn without_contact(mut self) -> Self {
        self.in_contact.fill(false);
        self
    }

    /// Azimuth of the viewer from which the surface hides least.
    pub(crate) fn azimuth(&self) -> f64 {
        uphill(&self.mesh, &self.y)
    }

    /// Panel with a range of heights and colours, none for that of the data and zero.
    pub(crate) fn panel(&self, azimuth: f64, range: Option<(f64, f64)>) -> Surface<'_> {
        let Self { title, law, mesh, y, in_contact } = self;
        Surface { title, mesh, law: *law, y, in_contact, azimuth, range }
    }
}
