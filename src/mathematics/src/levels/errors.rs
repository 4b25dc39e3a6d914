//! Errors against a known solution.

use super::Problem;
use crate::discrete::norms::{Errors, errors, max_error, multiplier_error};

impl Problem {
    /// Errors of a nodal vector of the finest level; none if the solution has no formula.
    pub fn errors(&self, y: &[f64]) -> Option<Errors> {
        let known = self.levels().facts().known?;
        // The norms of the square are sums of their own, row by row in vector instructions by a rule of degree 4, whose
        // digits are in published tables; a multiplier is measured there alone.
        let Some(lattices) = self.lattices() else {
            return self.levels().mesh(self.finest()).errors(known, y);
        };
        let (grid, exact) = (lattices.finest(), lattices.source().exact()?);
        let load = self.load();
        let multiplier_l2 =
            multiplier_error(grid, y, load, |point, normal| exact.multiplier(point, normal));
        Some(Errors { multiplier_l2: Some(multiplier_l2), ..errors(grid, exact, y) })
    }

    /// Greatest error of a nodal vector of a level at its nodes; none if the solution is not known, and on meshes.
    pub(crate) fn greatest_error(&self, level: usize, y: &[f64]) -> Option<f64> {
        let lattices = self.lattices()?;
        let exact = lattices.source().exact()?;
        Some(max_error(lattices.grids()[level], y, |x, y| exact.at(x, y).value))
    }
}
