//! Errors against a known solution.

use super::Problem;
use crate::discrete::norms::{Errors, errors, multiplier_error};

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
}
