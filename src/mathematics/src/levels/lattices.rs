//! The paper's grids of the square, matrix-free, as the levels of a problem.

use super::{Drawing, Facts, Levels};
use crate::bounds::{Bounds, NoBound};
use crate::discrete::grid::Grid;
use crate::discrete::load::LoadRule;
use crate::discrete::nested::DiscreteLevels;
use crate::discrete::norms::Errors;
use crate::mesh::{AnyMesh, ClosedCurve, lattice_mesh, mesh_load, square_boundary, uniform_square};
use crate::problem::error::SourceError;
use crate::problem::exact::Known;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::problem::unsolvable::Component;
use crate::square::bounds::bounds;
use crate::square::errors::{errors, multiplier_error};
use crate::square::load::{integrals, load, missed_on, moved_jumps};
use std::borrow::Cow;
use std::sync::OnceLock;

/// Nested grids of the square, with f and its quadrature.
#[derive(Clone, Debug)]
pub struct Lattices {
    /// Grids, coarsest first.
    grids: Vec<Grid>,
    /// Right-hand side.
    f: Source,
    /// Quadrature of the load vector.
    rule: LoadRule,
    /// Law on the boundary.
    law: Law,
    facts: Facts,
    /// Load vector of the finest grid, once it is needed.
    load: OnceLock<Vec<f64>>,
    /// Part of f that its quadrature misses, once it is needed.
    missed: OnceLock<Option<f64>>,
}

/// Cells per side of the grid on which the quadrature of f is looked at, since on finer ones less is missed.
const LOOKED_AT: usize = 256;
/// Cells per side of the finest grid on which the quadrature is looked at, if [`LOOKED_AT`] is too coarse.
const FINEST: usize = 512;
/// Part of the integral of |f| that makes [`LOOKED_AT`] too coarse.
const MISSED: f64 = 1e-3;

impl Lattices {
    /// Levels on nested `grids`, coarsest first.
    ///
    /// # Panics
    /// If there are no grids.
    pub fn new(grids: Vec<Grid>, f: Source, rule: LoadRule, law: Law) -> Self {
        assert!(!grids.is_empty(), "at least one grid");
        let [integral, size] = integrals(&f);
        let facts = Facts {
            dimension: 2,
            width: grids[grids.len() - 1].h(),
            extent: 1.0,
            f: f.to_string(),
            integral,
            size,
            given: 0.0,
            given_flux: 0.0,
            by_quadrature: f.is_smooth(),
            known: f.exact().map(Known::Square),
            notes: f.outside(),
            is_adapted: false,
        };
        let (load, missed) = (OnceLock::new(), OnceLock::new());
        Self { grids, f, rule, law, facts, load, missed }
    }

    /// Finest grid.
    pub fn finest(&self) -> Grid {
        self.grids[self.grids.len() - 1]
    }

    /// Right-hand side.
    pub fn source(&self) -> &Source {
        &self.f
    }

    /// Quadrature of the load vector.
    pub fn rule(&self) -> LoadRule {
        self.rule
    }

    /// Law on the boundary.
    pub fn law(&self) -> Law {
        self.law
    }

    /// Part of the integral of |f| by which the load vector moves jumps of f; none if it is too small to matter.
    pub(super) fn moved_jumps(&self) -> Option<f64> {
        moved_jumps(self.finest(), &self.f, self.rule)
    }

    /// Errors of a nodal vector of the finest grid; none if the solution has no formula.
    ///
    /// The norms are sums of their own, row by row in vector instructions by a rule of degree 4, whose digits are in
    /// published tables; a multiplier is measured here alone.
    pub(super) fn errors(&self, y: &[f64]) -> Option<Errors> {
        let (grid, exact) = (self.finest(), self.f.exact()?);
        let load = self.finest_load();
        let multiplier_l2 =
            multiplier_error(grid, y, load, |point, normal| exact.multiplier(point, normal));
        Some(Errors { multiplier_l2: Some(multiplier_l2), ..errors(grid, exact, y) })
    }

    /// Picture with so many cells across at most.
    fn drawn(&self, most_cells: usize) -> Drawing {
        let grid = self.finest();
        let lines = thinned(grid, most_cells);
        let coordinates: Vec<_> = lines.iter().map(|&i| grid.coordinate(i)).collect();
        let nodes = lines.iter().flat_map(|&j| lines.iter().map(move |&i| grid.index(i, j)));
        Drawing { mesh: lattice_mesh(&coordinates), nodes: nodes.collect() }
    }
}

impl Levels for Lattices {
    fn facts(&self) -> &Facts {
        &self.facts
    }

    fn discrete(&self) -> DiscreteLevels<'_> {
        DiscreteLevels::Grids(&self.grids, self.law)
    }

    fn lattices(&self) -> Option<&Lattices> {
        Some(self)
    }

    fn mesh(&self, level: usize) -> Cow<'_, AnyMesh> {
        Cow::Owned(uniform_square(self.grids[level]).into())
    }

    fn boundary(&self) -> Vec<ClosedCurve> {
        vec![square_boundary(self.finest(), self.law)]
    }

    fn drawing(&self, most_cells: usize) -> Option<Drawing> {
        Some(self.drawn(most_cells))
    }

    fn means(&self, most_cells: usize) -> Result<Cow<'_, [f64]>, SourceError> {
        Ok(mesh_load(&self.drawn(most_cells).mesh, &self.f)?.cells.mean.into())
    }

    fn missed(&self) -> Option<f64> {
        *self.missed.get_or_init(|| {
            if !self.f.is_smooth() || self.f.exact().is_some() {
                return None;
            }
            let n = self.finest().cells();
            let on = |cells: usize| {
                missed_on(Grid::new(n.min(cells)).expect("no finer than the finest"), &self.f)
            };
            let missed = on(LOOKED_AT)?;
            if missed > MISSED && n > LOOKED_AT { on(FINEST) } else { Some(missed) }
        })
    }

    fn finest_load(&self) -> &[f64] {
        self.load.get_or_init(|| load(self.finest(), &self.f, self.rule))
    }

    fn load(&self, level: usize) -> Result<Cow<'_, [f64]>, SourceError> {
        if level + 1 == self.grids.len() {
            return Ok(self.finest_load().into());
        }
        Ok(load(self.grids[level], &self.f, self.rule).into())
    }

    fn components(&self) -> Vec<Component> {
        vec![Component::whole(self.law, Grid::PERIMETER, self.facts.integral)]
    }

    fn laws(&self) -> Vec<(String, Law)> {
        vec![(String::new(), self.law)]
    }

    fn bounds(&self, y: &[f64]) -> Result<Bounds, NoBound> {
        bounds(self.finest(), &self.f, self.law, y)
    }

    fn local_errors(&self, _: &[f64]) -> Vec<f64> {
        Vec::new()
    }
}

/// Returns the grid lines that are drawn, equally spaced and at most `most`, and the last.
fn thinned(grid: Grid, most: usize) -> Vec<usize> {
    let n = grid.cells();
    let mut lines: Vec<usize> = (0..n).step_by(n.div_ceil(most)).collect();
    lines.push(n);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_both_ends() {
        let lines = |cells: usize| thinned(Grid::new(cells).unwrap(), 32);
        assert_eq!(lines(4), [0, 1, 2, 3, 4]);
        assert_eq!(lines(64).len(), 33);
        assert_eq!(lines(33).last(), Some(&33));
        assert!(lines(1000).len() <= 33);
    }

    #[test]
    fn the_nodes_of_a_drawing_have_their_values() {
        let (grid, f) = (Grid::new(70).unwrap(), Source::constant(-1.0));
        let lattices = Lattices::new(vec![grid], f, LoadRule::default(), Law::SIGNORINI);
        let Drawing { mesh, nodes } = lattices.drawing(20).unwrap();
        for (node, &[px, py]) in nodes.into_iter().zip(mesh.points()) {
            assert_eq!([px, py], [grid.coordinate(node % 71), grid.coordinate(node / 71)]);
        }
    }
}
