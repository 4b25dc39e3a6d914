//! Errors against known solutions, and what they cost multigrid in work units and bytes.

use super::Range;
use super::known::{KnownSolution, SAMPLED, SolutionErrors};
use super::problems::{CONTACT, paper_loads, stress_loads};
use super::work::{self, Comparison, CostLaw, nodal_values};
use crate::discrete::end::End;
use crate::discrete::grid::Grid;
use crate::discrete::kkt::kkt;
use crate::discrete::norms::{lumped, worst};
use crate::discrete::stiffness::energy;
use crate::machine::threads::{join, map};
use crate::multigrid::{Goal, InputError, Multigrid, MultigridParams};
use crate::problem::exact::Exact;
use crate::problem::law::Law;
use crate::spectral::SpectralParams;
use serde::{Deserialize, Serialize};

/// Input of the experiment; every grid is given by its cells per side.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AccuracyPlan {
    /// The paper's problems: names, and f in the notation of scenes.
    pub problems: Vec<(String, String)>,
    /// Grids on which errors against formulas are measured, each the halving of the one before.
    pub cells: Vec<usize>,
    /// Grids, likewise, for the problems that test contact.
    pub contact: Vec<usize>,
    /// Grids on which the cost of loads without known solution is counted.
    pub others: Vec<usize>,
    /// Right-hand sides, and grids, on which the cost law of the paper's method is measured.
    pub laws: Vec<(String, Vec<usize>)>,
    /// Nested grids on which multigrid is compared with the saddle-point methods.
    pub compared: Vec<usize>,
}

impl AccuracyPlan {
    /// Plan of the book for the paper's problems, given by name with f in the notation of scenes.
    pub fn new(problems: Vec<(String, String)>) -> Self {
        let mut laws = vec![("exact(free-corner)".into(), vec![8, 16, 32, 64, 128])];
        // Problem 2: finer grids take too long for an experiment that is part of every run.
        laws.extend(problems.get(1).map(|(_, f)| (f.clone(), vec![4, 8, 16, 32])));
        Self {
            problems,
            cells: (3..=9).map(|level| 1 << level).collect(),
            contact: (3..=9).map(|level| 1 << level).collect(),
            others: vec![64, 256],
            laws,
            compared: vec![8, 16, 32, 64],
        }
    }
}

/// Result of the experiment.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AccuracyFindings {
    /// Problems with known solutions.
    pub problems: Vec<KnownLevels<AccuracyLevel>>,
    /// Cells per side of the grid at whose nodes solutions without a formula are compared.
    pub sampled: usize,
    /// Values of the solution of [`Exact::FreeCorner`], which is lifted least, at the nodes of this grid.
    pub free_corner: Range,
    /// Cost on the paper's problems and the stress loads, grid by grid.
    pub others: Vec<Cost>,
    /// Cost laws of the paper's method.
    pub laws: Vec<CostLaw>,
    /// Multigrid and the saddle-point methods side by side.
    pub comparison: Comparison,
    /// Least and greatest orders and work units.
    pub ranges: Ranges,
}

/// A problem with known solution on all grids, on the square or on the cube.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct KnownLevels<L> {
    /// Name, as in `exact(name)`.
    pub name: String,
    /// Grid by grid.
    pub levels: Vec<L>,
}

/// A problem with known solution on one grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AccuracyLevel {
    /// Errors of the discrete solution, solved to the rounding floor.
    pub errors: SolutionErrors,
    /// Observed orders against the grid before.
    pub orders: Option<SolutionErrors>,
    /// Algebraic error over discretisation error at the goal [`Goal::DiscretisationError`], in L2 (lumped) and H1;
    /// none if the error is not known.
    pub algebraic: [Option<f64>; 2],
    /// Cost of the solution.
    pub cost: Cost,
}

/// Cost of one problem on one grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cost {
    /// Name of the problem.
    pub name: String,
    /// Cells per side.
    pub cells: usize,
    /// Bytes of the workspace per unknown.
    pub bytes: f64,
    /// Cost of each of the [`GOALS`]: the discretisation error, a natural residual of [`TOLERANCE`], the rounding
    /// floor.
    pub goals: [End; 3],
    /// Natural residual that is left at each of the goals, in the units of the load.
    pub residuals: [f64; 3],
}

/// Ranges over problems and grids.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Ranges {
    /// Tolerance of the second goal.
    pub tolerance: f64,
    /// Cells per side of the coarsest grid that the ranges below include: from there on orders and work units are close
    /// to their limits.
    pub from: usize,
    /// Observed orders of the problems whose solutions have a formula.
    pub smooth: OrderRange,
    /// Observed orders of the problems that test contact, whose f jumps.
    pub jumps: OrderRange,
    /// Greatest algebraic over discretisation error, in L2 and H1.
    pub algebraic: [f64; 2],
    /// Work units, goal by goal.
    pub work: [WorkRange; 3],
}

/// Least and greatest observed orders.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct OrderRange {
    /// Least; zero without orders.
    pub least: SolutionErrors,
    /// Greatest; zero without orders.
    pub greatest: SolutionErrors,
}

/// Work units to a goal.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct WorkRange {
    /// Goal in words.
    pub goal: String,
    /// Range over problems with known solution.
    pub known: Range,
    /// Range over the paper's problems and the stress loads.
    pub others: Range,
}

/// Natural residual that the second goal asks for, not relative: in the units of the load, f h^2.
pub const TOLERANCE: f64 = 1e-10;
/// Goals, in the order of [`Cost::goals`].
pub const GOALS: [Goal; 3] = [Goal::DiscretisationError, Goal::Kkt(TOLERANCE), Goal::RoundingFloor];
/// Goals in words.
const GOALS_IN_WORDS: [&str; 3] = ["discretisation error", "residual", "rounding floor"];
/// Cells per side of the coarsest grid on which orders and work units are close to their limits.
const ASYMPTOTIC: usize = 64;

/// Runs the experiment.
///
/// 1. Solves the problems with a formula, and those that test contact with the spectral solver.
/// 2. Solves each on its grids by multigrid, and measures errors and cost (`known`).
/// 3. Counts the cost of loads without known solution (`others`).
/// 4. Measures the cost laws of the paper's method ([`work::laws`]), and compares it with multigrid
///    ([`work::compare`]).
///
/// # Errors
/// A sentence if a grid cannot be used, or a problem cannot be solved on it.
pub fn accuracy(plan: &AccuracyPlan) -> Result<AccuracyFindings, String> {
    let mut solutions: Vec<_> = Exact::ALL.into_iter().map(KnownSolution::Formula).collect();
    for (name, f) in CONTACT {
        solutions.push(KnownSolution::spectral(name, f, SpectralParams::default())?);
    }
    let (problems, (others, (laws, comparison))) = join(
        || -> Result<Vec<_>, String> {
            map(&solutions, 1, |solution| known(solution, plan)).into_iter().collect()
        },
        || {
            join(
                || others(&plan.others, &plan.problems),
                || join(|| work::laws(&plan.laws), || work::compare(&plan.compared)),
            )
        },
    );
    let (problems, others) = (problems?, others?);
    let sampled = Grid::new(SAMPLED).map_err(|e| e.to_string())?;
    Ok(AccuracyFindings {
        ranges: Ranges::of(&problems, &others),
        problems,
        sampled: SAMPLED,
        free_corner: Range::of(nodal_values(Exact::FreeCorner, sampled)).unwrap_or_default(),
        others,
        laws: laws?,
        comparison: comparison?,
    })
}

/// Measures errors and cost of a problem with known solution, grid by grid.
fn known(
    solution: &KnownSolution,
    plan: &AccuracyPlan,
) -> Result<KnownLevels<AccuracyLevel>, String> {
    let cells = match solution {
        KnownSolution::Formula(_) => &plan.cells,
        KnownSolution::Spectral(_) => &plan.contact,
    };
    let mut levels: Vec<AccuracyLevel> = Vec::new();
    for &n in cells {
        let grid = Grid::new(n).map_err(|e| e.to_string())?;
        let load = solution.load(grid);
        let (cost, [rough, _, y]) = cost(solution.name(), n, &load)?;
        let errors = solution.errors(grid, &y, &load);
        let wrong: Vec<f64> = rough.iter().zip(&y).map(|(a, b)| a - b).collect();
        // Twice the energy without load is the square of the H1 seminorm.
        let h1 = (2.0 * energy(grid, &wrong, &vec![0.0; wrong.len()])).sqrt();
        levels.push(AccuracyLevel {
            orders: levels.last().map(|coarser| orders(&coarser.errors, &errors)),
            algebraic: [errors.l2.map(|l2| lumped(grid, &wrong) / l2), Some(h1 / errors.h1)],
            errors,
            cost,
        });
    }
    Ok(KnownLevels { name: solution.name().into(), levels })
}

/// Counts the cost of the paper's problems and of the stress loads on grids with these cells per side.
fn others(cells: &[usize], problems: &[(String, String)]) -> Result<Vec<Cost>, String> {
    let mut costs = Vec::new();
    for &n in cells {
        Grid::new(n).map_err(|e| e.to_string())?;
        let mut loads = paper_loads(n, problems)?;
        loads.extend(stress_loads(n));
        let counted: Result<Vec<_>, String> =
            map(&loads, 1, |(name, load)| cost(name, n, load)).into_iter().collect();
        costs.extend(counted?.into_iter().map(|(cost, _)| cost));
    }
    Ok(costs)
}

/// Solves a problem on the grid with `n` cells per side to each of the [`GOALS`]; returns the cost, and the nodal
/// vectors with which they were reached.
fn cost(name: &str, n: usize, load: &[f64]) -> Result<(Cost, [Vec<f64>; 3]), String> {
    let failed = |e: InputError| format!("{name} on grid 1/{n}: {e}");
    let mut workspace = Multigrid::square(n).map_err(failed)?;
    let (mut goals, mut solutions) = (Vec::new(), [const { Vec::new() }; 3]);
    for (goal, solution) in GOALS.into_iter().zip(&mut solutions) {
        let params = MultigridParams { goal, ..MultigridParams::default() };
        let problem = Law::SIGNORINI.with_load(load);
        goals.push(workspace.solve(problem, None, &params).map_err(failed)?);
        *solution = vec![0.0; load.len()];
        workspace.write_solution(solution);
    }
    let goals = goals.try_into().expect("one for each goal");
    let bytes = workspace.bytes() as f64 / load.len() as f64;
    let grid = Grid::new(n).map_err(|e| e.to_string())?;
    let residuals = solutions.each_ref().map(|y| kkt(grid, Law::SIGNORINI, y, load).natural);
    Ok((Cost { name: name.into(), cells: n, bytes, goals, residuals }, solutions))
}

/// Applies `f` to each pair of errors in the same norm.
fn map2(a: &SolutionErrors, b: &SolutionErrors, f: impl Fn(f64, f64) -> f64) -> SolutionErrors {
    SolutionErrors {
        l2: a.l2.zip(b.l2).map(|(a, b)| f(a, b)),
        h1: f(a.h1, b.h1),
        max: f(a.max, b.max),
        multiplier_l2: f(a.multiplier_l2, b.multiplier_l2),
    }
}

fn orders(coarser: &SolutionErrors, finer: &SolutionErrors) -> SolutionErrors {
    map2(coarser, finer, |coarser, finer| libm::log2(coarser / finer))
}

impl Ranges {
    fn of(problems: &[KnownLevels<AccuracyLevel>], others: &[Cost]) -> Self {
        let levels: Vec<_> = problems.iter().flat_map(|problem| &problem.levels).collect();
        let finest = levels.iter().map(|level| level.cost.cells).max().unwrap_or(0);
        // A plan of coarse grids only has ranges as well.
        let from = ASYMPTOTIC.min(finest);
        let mut fine = levels;
        fine.retain(|level| level.cost.cells >= from);
        let (with_formula, contact): (Vec<_>, Vec<_>) =
            fine.iter().copied().partition(|level| level.errors.l2.is_some());
        Self {
            tolerance: TOLERANCE,
            from,
            smooth: OrderRange::of(&with_formula),
            jumps: OrderRange::of(&contact),
            algebraic: [0, 1].map(|k| worst(fine.iter().filter_map(|level| level.algebraic[k]))),
            work: [0, 1, 2].map(|goal| WorkRange {
                goal: GOALS_IN_WORDS[goal].into(),
                known: work_units(goal, fine.iter().map(|level| &level.cost)),
                others: work_units(goal, others),
            }),
        }
    }
}

impl OrderRange {
    fn of(levels: &[&AccuracyLevel]) -> Self {
        let observed: Vec<_> = levels.iter().filter_map(|level| level.orders).collect();
        let [least, greatest] = [f64::min, f64::max].map(|extreme| {
            let all = observed.iter().copied();
            all.reduce(|a, b| map2(&a, &b, extreme)).unwrap_or_default()
        });
        Self { least, greatest }
    }
}

/// Least and greatest work units to a goal; zero without costs.
fn work_units<'a>(goal: usize, costs: impl IntoIterator<Item = &'a Cost>) -> Range {
    Range::of(costs.into_iter().map(|cost| cost.goals[goal].work_units)).unwrap_or_default()
}
