//! A problem: what is solved.

use super::{Lattices, Levels, ProblemError, Step, Triangulations, Watch, check_missed};
use crate::bounds::{Bounds, NoBound};
use crate::discrete::domain::DiscreteDomain;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::{Judgement, has_solution, judge};
use crate::discrete::load::LoadRule;
use crate::discrete::nested::{DiscreteLevels, NestedNetwork};
use crate::discrete::network::Network;
use crate::mesh::AnyMesh;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::problem::text::percent;
use crate::problem::unsolvable::Unsolvable;
use crate::saddle::{Pair, Plain};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

/// Domain with f and the laws on the parts of its boundary, and its nested discrete problems. The flux can balance f:
/// it has a unique solution.
#[derive(Clone)]
pub struct Problem {
    levels: Arc<dyn Levels>,
    /// True if the boundary is curved, and the finest mesh a polygon or polyhedron instead.
    is_curved: bool,
    /// Reason for which the domain with its curves has no solution, if it has none, once it is asked for.
    refusal_of_curves: OnceLock<Option<Unsolvable>>,
}

/// Approximation that guaranteed bounds leave out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reserve {
    /// Of integrals of f, values and fluxes by formulas.
    Quadrature,
    /// Of a curved domain, by the polygon or polyhedron of the finest mesh.
    Polygon,
}

impl Reserve {
    /// Name in answers and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quadrature => "quadrature",
            Self::Polygon => "polygon",
        }
    }
}

impl Problem {
    /// Problem on the square, on nested grids, coarsest first.
    ///
    /// # Errors
    /// [`ProblemError`].
    ///
    /// # Panics
    /// If there are no grids.
    pub fn on_square(
        grids: Vec<Grid>,
        f: Source,
        rule: LoadRule,
        law: Law,
    ) -> Result<Self, ProblemError> {
        if law.at() != 0.0 || law.is_fixed() {
            return Err(ProblemError::OnGrids(law));
        }
        let lattices = Lattices::new(grids, f, rule, law);
        let (integral, size) = (lattices.facts().integral, lattices.facts().size);
        lattices.source().check_scale(size)?;
        if integral.is_nan() {
            return Err(ProblemError::NotFinite);
        }
        Self::new(lattices, false)
    }

    /// Problem on a mesh and its refinements, `times` of them, with f given as text.
    ///
    /// # Errors
    /// [`ProblemError`].
    pub fn on_mesh(coarsest: &AnyMesh, times: usize, f: &str) -> Result<Self, ProblemError> {
        Self::on_mesh_watched((coarsest, times), f, &|_| ())
    }

    /// As [`Problem::on_mesh`]; `watch` is told when the meshes are made, and when f is integrated on them.
    ///
    /// # Errors
    /// As [`Problem::on_mesh`].
    pub fn on_mesh_watched(
        (coarsest, times): (&AnyMesh, usize),
        f: &str,
        watch: Watch<'_>,
    ) -> Result<Self, ProblemError> {
        let is_curved = coarsest.is_curved();
        let made = match coarsest {
            AnyMesh::Plane(mesh) => {
                Self::new(Triangulations::new(mesh, times, f, watch)?, is_curved)
            }
            AnyMesh::Space(mesh) => {
                Self::new(Triangulations::new(mesh, times, f, watch)?, is_curved)
            }
        };
        watch(Step::Load);
        made
    }

    /// Problem on these levels if the flux can balance f over each connected component, by more than the rounding
    /// errors of integrals.
    fn new(levels: impl Levels + 'static, is_curved: bool) -> Result<Self, ProblemError> {
        let rounding = levels.facts().rounding();
        let checked = levels.components().into_iter().try_for_each(|of| of.check(rounding));
        let problem = Self::checked(levels, is_curved);
        match checked {
            Ok(()) => Ok(problem),
            Err(reason) if is_curved && problem.refusal_of_curves().is_none() => {
                Err(ProblemError::Coarse(reason))
            }
            Err(reason) => Err(reason.into()),
        }
    }

    /// As [`Problem::new`], of a flux that is known to balance f.
    pub(crate) fn checked(levels: impl Levels + 'static, is_curved: bool) -> Self {
        Self { levels: Arc::new(levels), is_curved, refusal_of_curves: OnceLock::new() }
    }

    /// Reason for which the domain has no solution with the curves of its boundary in place of the facets of the finest
    /// mesh, by an estimate; none where it has one.
    pub fn refusal_of_curves(&self) -> Option<Unsolvable> {
        if !self.is_curved {
            return None;
        }
        *self.refusal_of_curves.get_or_init(|| {
            let components = self.levels.components_on_curves();
            components.into_iter().find_map(|component| component.check(0.0).err())
        })
    }

    /// Line that the domain has no solution although the polygon or polyhedron of its mesh, which is solved, has one.
    pub fn note_on_curves(&self) -> Option<String> {
        let polygon = if self.levels.facts().dimension == 2 { "polygon" } else { "polyhedron" };
        let reason = self.refusal_of_curves()?;
        Some(format!(
            "the {polygon} of the mesh has a solution, the domain with its curves has none: {reason}"
        ))
    }

    /// Nested discrete problems.
    pub fn levels(&self) -> &dyn Levels {
        &*self.levels
    }

    /// The law, if it is the same wherever the boundary is neither free nor fixed; the paper's if that is nowhere.
    pub fn law(&self) -> Option<Law> {
        Law::only(&self.levels.laws())
    }

    /// True if what sticks is in contact, wherever it may move.
    pub fn has_contact(&self) -> bool {
        self.levels.laws().iter().all(|(_, law)| law.is_contact())
    }

    /// True if the only law is the paper's.
    pub fn is_signorini(&self) -> bool {
        self.law() == Some(Law::SIGNORINI)
    }

    /// Number of levels, at least one.
    pub fn count(&self) -> usize {
        self.levels.discrete().count()
    }

    /// Number of the finest level.
    pub fn finest(&self) -> usize {
        self.count() - 1
    }

    /// Grid or network of a level.
    pub fn domain(&self, level: usize) -> DiscreteDomain<'_> {
        self.levels.discrete().level(level)
    }

    /// Name of a level in sentences, such as `grid 1/64`, `refinement 3` or `the mesh of 900 nodes`.
    pub fn name(&self, level: usize) -> String {
        let (domain, is_adapted) = (self.domain(level), self.levels.facts().is_adapted);
        match domain.cells() {
            Some(cells) => format!("grid 1/{cells}"),
            None if level == 0 => "the coarsest mesh".into(),
            None if is_adapted => format!("the mesh of {} nodes", domain.nodes()),
            None => format!("refinement {level}"),
        }
    }

    /// Load vector of the finest level.
    pub fn load(&self) -> &[f64] {
        self.levels.finest_load()
    }

    /// Number beside which residuals on the finest level are small or not; see [`DiscreteDomain::unit`].
    pub(crate) fn unit(&self) -> f64 {
        self.domain(self.finest()).unit(self.load())
    }

    /// Load vectors of all levels, coarsest first.
    ///
    /// # Errors
    /// [`ProblemError::Source`] if f is not finite at a point of a coarser level.
    pub fn loads(&self) -> Result<Vec<Cow<'_, [f64]>>, ProblemError> {
        (0..self.count()).map(|level| Ok(self.levels.load(level)?)).collect()
    }

    /// Grids and f on the square; none on a mesh.
    pub fn lattices(&self) -> Option<&Lattices> {
        self.levels.lattices()
    }

    /// Lengths of the nodal vector and the boundary vector of a pair of the finest level.
    pub fn lengths(&self) -> [usize; 2] {
        let domain = self.domain(self.finest());
        [domain.nodes(), domain.contact().len()]
    }

    /// Components of the gradient (8) at the nodes of the finest grid of the square, for this duality parameter; none
    /// on a mesh.
    pub fn gradient(&self, r: f64, pair: &Pair) -> Option<Vec<f64>> {
        let lattices = self.lattices()?;
        let network = Network::of_square(lattices.finest(), lattices.law());
        let functional = Plain { network: &network, load: self.load(), r };
        Some((0..pair.y.len()).map(|node| functional.gradient(node, pair)).collect())
    }

    /// Nested networks of a mesh; none on the square, whose grids have no matrix in memory.
    pub fn networks(&self) -> Option<&[NestedNetwork]> {
        match self.levels.discrete() {
            DiscreteLevels::Grids(..) => None,
            DiscreteLevels::Networks(networks) => Some(networks),
        }
    }

    /// Judges a nodal vector of the finest level, apart from the solvers.
    pub fn judge(&self, y: &[f64]) -> Judgement {
        self.judge_on(self.finest(), y, self.load())
    }

    /// Judges a nodal vector of a level with this load vector.
    pub fn judge_on(&self, level: usize, y: &[f64], load: &[f64]) -> Judgement {
        judge(self.domain(level), y, load)
    }

    /// True if the flux can balance the load vector of the finest level: then the discrete problem has a solution.
    pub(crate) fn is_solvable(&self) -> bool {
        has_solution(self.domain(self.finest()), self.load())
    }

    /// Problem with the same f and law on one grid of the square with so many cells per side; none on a mesh.
    pub(crate) fn on_grid(&self, cells: usize) -> Option<Result<Self, ProblemError>> {
        let (lattices, grid) = (self.lattices()?, Grid::new(cells).ok()?);
        let (f, rule) = (lattices.source().clone(), lattices.rule());
        Some(Self::on_square(vec![grid], f, rule, lattices.law()))
    }

    /// Line that the load vector of the square moves jumps of f, where that matters; the load of meshes moves none.
    pub fn note_on_jumps(&self) -> Option<String> {
        let moved = self.lattices()?.moved_jumps()?;
        Some(format!(
            "f jumps on grid lines, where the nodal load takes it from one side: that moves the jumps by half a cell, \
             {} of the integral of |f|",
            percent(moved, 2)
        ))
    }

    /// Guaranteed bounds for a nodal vector of the finest level, but for what [`Problem::reserves`] lists.
    ///
    /// # Errors
    /// [`NoBound`].
    pub fn bounds(&self, y: &[f64]) -> Result<Bounds, NoBound> {
        check_missed(self.levels.missed())?;
        self.levels.bounds(y)
    }

    /// Approximations that the bounds leave out.
    pub fn reserves(&self) -> Vec<Reserve> {
        let made = [
            (self.levels.facts().by_quadrature, Reserve::Quadrature),
            (self.is_curved, Reserve::Polygon),
        ];
        made.into_iter().filter(|(is_made, _)| *is_made).map(|(_, reserve)| reserve).collect()
    }
}
