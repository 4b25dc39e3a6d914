//! The paper's grids of the square, matrix-free, as the levels of a problem.

use super::{Discrete, Integrals, KnownErrors, Levels, NodalVectors};
use crate::bounds::{Bounds, NoBound, bounds};
use crate::discrete::contact::{ContactArc, arcs};
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, judge};
use crate::discrete::load::{LoadRule, integrals, load, missed_on};
use crate::discrete::norms::{errors, multiplier_error};
use crate::mesh::{AnyMesh, mesh_load, uniform_square};
use crate::problem::error::SourceError;
use crate::problem::law::{ContactNode, Law};
use crate::problem::source::Source;
use crate::saddle::Pair;
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
    integrals: Integrals,
    /// Load vector of the finest grid, once it is needed.
    load: OnceLock<Vec<f64>>,
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
    pub fn new(grids: Vec<Grid>, f: Source, rule: LoadRule) -> Self {
        assert!(!grids.is_empty(), "at least one grid");
        let [of_f, of_size] = integrals(&f);
        let integrals = Integrals { of_f, of_size, by_quadrature: f.is_smooth() };
        Self { grids, f, rule, integrals, load: OnceLock::new() }
    }

    /// Grids, coarsest first.
    pub fn grids(&self) -> &[Grid] {
        &self.grids
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
}

impl Levels for Lattices {
    fn count(&self) -> usize {
        self.grids.len()
    }

    fn dimension(&self) -> u8 {
        2
    }

    fn name(&self, level: usize) -> String {
        format!("grid 1/{}", self.grids[level].cells())
    }

    fn cells(&self, level: usize) -> Option<usize> {
        Some(self.grids[level].cells())
    }

    fn nodes(&self, level: usize) -> usize {
        self.grids[level].nodes()
    }

    fn width(&self) -> f64 {
        self.finest().h()
    }

    fn extent(&self) -> f64 {
        1.0
    }

    fn f(&self) -> String {
        self.f.to_string()
    }

    fn outside(&self) -> Vec<String> {
        self.f.outside()
    }

    fn integrals(&self) -> &Integrals {
        &self.integrals
    }

    fn missed(&self) -> Option<f64> {
        if !self.f.is_smooth() || self.f.exact().is_some() {
            return None;
        }
        let n = self.finest().cells();
        let missed = missed_on(&self.f, n.min(LOOKED_AT))?;
        if missed > MISSED && n > LOOKED_AT {
            return missed_on(&self.f, n.min(FINEST));
        }
        Some(missed)
    }

    fn finest_load(&self) -> &[f64] {
        self.load.get_or_init(|| load(self.finest(), &self.f, self.rule))
    }

    fn load(&self, level: usize) -> Result<Cow<'_, [f64]>, SourceError> {
        if level + 1 == self.count() {
            return Ok(self.finest_load().into());
        }
        Ok(load(self.grids[level], &self.f, self.rule).into())
    }

    fn contact(&self) -> Cow<'_, [ContactNode]> {
        self.finest().contact_nodes().into()
    }

    fn has_fixed_part(&self) -> bool {
        false
    }

    fn is_solvable(&self, _level: usize, law: Law, load: &[f64]) -> bool {
        law.check_solvable(load.iter().sum(), Grid::PERIMETER).is_ok()
    }

    fn judge(
        &self,
        level: usize,
        law: Law,
        NodalVectors { y, load }: NodalVectors<'_>,
    ) -> Judgement {
        judge(self.grids[level], law, y, load)
    }

    fn in_contact(&self, law: Law, pair: &Pair) -> Vec<bool> {
        pair.in_contact(self.finest(), law)
    }

    fn arcs(&self, y: &[f64], judgement: &Judgement) -> Option<Vec<ContactArc>> {
        Some(arcs(self.finest(), y, judgement))
    }

    fn errors(&self, y: &[f64], load: &[f64]) -> Option<KnownErrors> {
        let (grid, exact) = (self.finest(), self.f.exact()?);
        let multiplier_l2 =
            multiplier_error(grid, y, load, |point, normal| exact.multiplier(point, normal));
        Some(KnownErrors { values: errors(grid, exact, y), multiplier_l2: Some(multiplier_l2) })
    }

    fn bounds(&self, law: Law, y: &[f64]) -> Result<Bounds, NoBound> {
        bounds(self.finest(), &self.f, law, y)
    }

    fn mesh(&self, level: usize) -> AnyMesh {
        uniform_square(self.grids[level]).into()
    }

    fn means(&self, level: usize) -> Result<Vec<f64>, SourceError> {
        Ok(mesh_load(&uniform_square(self.grids[level]), &self.f)?.cells.mean)
    }

    fn discrete(&self) -> Discrete<'_> {
        Discrete::Lattices(self)
    }
}
