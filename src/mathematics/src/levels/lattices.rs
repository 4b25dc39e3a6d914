//! The paper's grids of the square, matrix-free, as the levels of a problem.

use super::{ClosedCurve, Discrete, Drawing, Integrals, KnownErrors, Levels, NodalVectors};
use crate::bounds::{Bounds, NoBound, bounds};
use crate::discrete::contact::{ContactArc, arcs};
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, has_solution, judge};
use crate::discrete::load::{LoadRule, integrals, load, missed_on};
use crate::discrete::norms::{errors, multiplier_error};
use crate::formats::Fields;
use crate::mesh::{AnyMesh, Condition, PlaneMesh, lattice_mesh, mesh_load, uniform_square};
use crate::problem::error::SourceError;
use crate::problem::law::{ContactNode, Law};
use crate::problem::source::Source;
use crate::problem::unsolvable::Component;
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
    pub fn new(grids: Vec<Grid>, f: Source, rule: LoadRule) -> Self {
        assert!(!grids.is_empty(), "at least one grid");
        let [of_f, of_size] = integrals(&f);
        let (by_quadrature, is_known) = (f.is_smooth(), f.exact().is_some());
        let integrals = Integrals { of_f, of_size, by_quadrature, is_known };
        Self { grids, f, rule, integrals, load: OnceLock::new(), missed: OnceLock::new() }
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
        *self.missed.get_or_init(|| {
            if !self.f.is_smooth() || self.f.exact().is_some() {
                return None;
            }
            let n = self.finest().cells();
            let missed = missed_on(&self.f, n.min(LOOKED_AT))?;
            if missed > MISSED && n > LOOKED_AT {
                return missed_on(&self.f, n.min(FINEST));
            }
            Some(missed)
        })
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

    fn components(&self) -> Vec<Component> {
        vec![Component::in_contact(Grid::PERIMETER, self.integrals().of_f)]
    }

    fn is_solvable(&self, level: usize, law: Law, load: &[f64]) -> bool {
        has_solution(self.grids[level], law, load)
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

    fn parts_in_contact(&self, _judgement: &Judgement) -> Option<String> {
        None
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

    fn coarsest(&self) -> Option<&PlaneMesh> {
        None
    }

    fn mesh(&self) -> AnyMesh {
        uniform_square(self.finest()).into()
    }

    fn map_of_f(&self, most_cells: usize) -> Result<Option<(Drawing, Vec<f64>)>, SourceError> {
        let Some(drawing) = self.drawing(most_cells) else { return Ok(None) };
        let f = mesh_load(&drawing.mesh, &self.f)?.cells.mean;
        Ok(Some((drawing, f)))
    }

    fn drawing(&self, most_cells: usize) -> Option<Drawing> {
        let grid = self.finest();
        let lines = thinned(grid, most_cells);
        let coordinates: Vec<_> = lines.iter().map(|&i| grid.coordinate(i)).collect();
        let nodes = lines.iter().flat_map(|&j| lines.iter().map(move |&i| grid.index(i, j)));
        Some(Drawing { mesh: lattice_mesh(&coordinates), nodes: nodes.collect() })
    }

    fn curves(&self) -> Option<Vec<ClosedCurve>> {
        let grid = self.finest();
        let places = (0..grid.boundary_nodes()).map(|b| b as f64 * grid.h()).collect();
        let numbers = 0..grid.boundary_nodes();
        let points = numbers.map(|b| {
            let (i, j) = grid.boundary_node(b);
            [grid.coordinate(i), grid.coordinate(j)]
        });
        Some(vec![ClosedCurve {
            parts: None,
            nodes: grid.boundary().collect(),
            points: points.collect(),
            conditions: vec![Condition::Contact; grid.boundary_nodes()],
            places,
            length: Grid::PERIMETER,
        }])
    }

    fn vtk_ending(&self) -> &'static str {
        "vti"
    }

    fn vtk(&self, name: &str, _law: Law, pair: &Pair) -> Vec<u8> {
        Fields::new(self.finest(), &self.f, pair).vti(name)
    }

    fn npz(&self, _law: Law, pair: &Pair) -> Option<Vec<u8>> {
        Fields::new(self.finest(), &self.f, pair).npz()
    }

    fn npy(&self, pair: &Pair) -> Vec<u8> {
        Fields::new(self.finest(), &self.f, pair).npy()
    }

    fn discrete(&self) -> Discrete<'_> {
        Discrete::Lattices(self)
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
        let grid = Grid::new(70).unwrap();
        let lattices = Lattices::new(vec![grid], Source::constant(-1.0), LoadRule::default());
        let Drawing { mesh, nodes } = lattices.drawing(20).unwrap();
        for (node, &[px, py]) in nodes.into_iter().zip(mesh.points()) {
            assert_eq!([px, py], [grid.coordinate(node % 71), grid.coordinate(node / 71)]);
        }
    }
}
