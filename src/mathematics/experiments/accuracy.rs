//! Errors against known solutions, and what they cost multigrid in work units and bytes.

use super::Range;
use super::known::{Errors, KnownSolution, SAMPLED};
use super::problems::{CONTACT, paper_loads, stress_loads};
use super::work::{self, Comparison, CostLaw};
use crate::discrete::grid::Grid;
use crate::discrete::norms::{lumped, worst};
use crate::discrete::stiffness::energy;
use crate::multigrid::{
    Goal, InputError, Multigrid, MultigridOutcome, MultigridParams, MultigridStop,
};
use crate::problem::exact::Exact;
use crate::spectral::Params;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// What is computed; every grid is given by its cells per side.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// Grids on which errors against formulas are measured, each the halving of the one before.
    pub cells: Vec<usize>,
    /// The same for the problems that test contact.
    pub contact: Vec<usize>,
    /// Grids on which the cost of loads without known solution is counted.
    pub others: Vec<usize>,
    /// Right-hand sides, and grids, on which the cost law of the paper's method is measured.
    pub laws: Vec<(String, Vec<usize>)>,
    /// Nested grids on which multigrid is compared with the saddle-point methods.
    pub compared: Vec<usize>,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            cells: (3..=10).map(|level| 1 << level).collect(),
            contact: (3..=9).map(|level| 1 << level).collect(),
            others: vec![64, 256],
            laws: vec![
                ("exact(free-corner)".into(), vec![8, 16, 32, 64, 128]),
                // Problem 2: finer grids take too long for an experiment that is part of every run.
                ("quadrant(ll)=-6; else=1.998".into(), vec![4, 8, 16, 32]),
            ],
            compared: vec![8, 16, 32, 64],
        }
    }
}

/// What came out.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Findings {
    /// The problems with known solutions.
    pub problems: Vec<Known<Level>>,
    /// Cells per side of the grid at whose nodes those without a formula are compared.
    pub sampled: usize,
    /// Cost on the paper's problems and the stress loads, grid by grid.
    pub others: Vec<Cost>,
    /// Cost laws of the paper's method.
    pub laws: Vec<CostLaw>,
    /// Multigrid and the saddle-point methods side by side.
    pub comparison: Comparison,
    /// Least and greatest of all this.
    pub ranges: Ranges,
}

/// A problem with known solution on all grids, on the square or on the cube.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Known<L> {
    /// Name, as in `exact(name)`.
    pub name: String,
    /// Grid by grid.
    pub levels: Vec<L>,
}

/// A problem with known solution on one grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Level {
    /// Errors of the discrete solution, solved to the rounding floor.
    pub errors: Errors,
    /// Observed orders against the grid before.
    pub orders: Option<Errors>,
    /// Algebraic over discretisation error at the goal [`Goal::DiscretisationError`], in L2 (lumped) and H1;
    /// none where the error is not known.
    pub algebraic: [Option<f64>; 2],
    /// What it cost.
    pub cost: Cost,
}

/// The cost of one problem on one grid.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cost {
    /// Name of the problem.
    pub name: String,
    /// Cells per side.
    pub cells: usize,
    /// Bytes of the workspace per unknown.
    pub bytes: f64,
    /// For the discretisation error, for a natural residual of [`TOLERANCE`], for the rounding floor.
    pub goals: [Spent; 3],
}

/// The cost of reaching a goal.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Spent {
    /// Sweeps of the finest grid.
    pub work_units: f64,
    /// Cycles on the finest grid.
    pub cycles: usize,
    /// Natural residual, not relative: in the units of the load, f h^2.
    pub kkt: f64,
    /// How it ended.
    pub stop: MultigridStop,
}

/// Ranges over problems and grids.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Ranges {
    /// Tolerance of the second goal.
    pub tolerance: f64,
    /// The coarsest grid that the ranges below include, where the asymptotics have set in.
    pub from: usize,
    /// Least and greatest observed orders of the problems whose solutions have a formula.
    pub orders: [Errors; 2],
    /// The same of those that test contact, whose f jumps.
    pub contact: [Errors; 2],
    /// The greatest algebraic over discretisation error, in L2 and H1.
    pub algebraic: [f64; 2],
    /// Least and greatest work units for each goal: problems with known solution.
    pub known: [[f64; 2]; 3],
    /// The same on the finest grid alone.
    pub finest: [[f64; 2]; 3],
    /// The same for the paper's problems and the stress loads.
    pub others: [[f64; 2]; 3],
}

/// Natural residual that the second goal asks for, not relative: in the units of the load, f h^2.
pub const TOLERANCE: f64 = 1e-10;
/// The goals, in the order of [`Cost::goals`].
pub const GOALS: [Goal; 3] = [Goal::DiscretisationError, Goal::Kkt(TOLERANCE), Goal::RoundingFloor];
/// On coarser grids neither orders nor work units are what they are in the limit.
const ASYMPTOTIC: usize = 64;

/// Runs the experiment.
///
/// # Errors
/// A sentence if a grid cannot be used, or a problem cannot be solved on it.
pub fn accuracy(plan: &Plan) -> Result<Findings, String> {
    let formulas = Exact::ALL.map(|exact| Ok(KnownSolution::Formula(exact)));
    let spectral = CONTACT.map(|(name, f)| KnownSolution::spectral(name, f, Params::default()));
    let solutions: Vec<_> = formulas.into_iter().chain(spectral).collect::<Result<_, String>>()?;
    let (known, rest) = rayon::join(
        || solutions.par_iter().map(|of| known(of, plan)).collect::<Result<Vec<_>, _>>(),
        || {
            rayon::join(
                || others(&plan.others),
                || rayon::join(|| work::laws(&plan.laws), || work::compare(&plan.compared)),
            )
        },
    );
    let (others, (laws, comparison)) = rest;
    let (problems, others, laws, comparison) = (known?, others?, laws?, comparison?);
    let ranges = Ranges::of(&problems, &others);
    Ok(Findings { ranges, problems, sampled: SAMPLED, others, laws, comparison })
}

fn known(solution: &KnownSolution, plan: &Plan) -> Result<Known<Level>, String> {
    let cells = match solution {
        KnownSolution::Formula(_) => &plan.cells,
        KnownSolution::Spectral(_) => &plan.contact,
    };
    let mut levels: Vec<Level> = Vec::new();
    for &n in cells {
        let grid = Grid::new(n).map_err(|e| e.to_string())?;
        let load = solution.load(grid);
        let (cost, [rough, _, y]) = cost(solution.name(), Multigrid::square, n, &load)?;
        let errors = solution.errors(grid, &y, &load);
        let wrong: Vec<f64> = rough.iter().zip(&y).map(|(a, b)| a - b).collect();
        // Twice the energy without load is the square of the H1 seminorm.
        let h1 = (2.0 * energy(grid, &wrong, &vec![0.0; wrong.len()])).sqrt();
        levels.push(Level {
            orders: levels.last().map(|coarser| orders(&coarser.errors, &errors)),
            algebraic: [errors.l2.map(|l2| lumped(grid, &wrong) / l2), Some(h1 / errors.h1)],
            errors,
            cost,
        });
    }
    Ok(Known { name: solution.name().into(), levels })
}

fn others(cells: &[usize]) -> Result<Vec<Cost>, String> {
    let mut costs = Vec::new();
    for &n in cells {
        Grid::new(n).map_err(|e| e.to_string())?;
        let loads: Vec<_> = paper_loads(n).into_iter().chain(stress_loads(n)).collect();
        let counted =
            loads.par_iter().map(|(name, load)| Ok(cost(name, Multigrid::square, n, load)?.0));
        costs.extend(counted.collect::<Result<Vec<_>, String>>()?);
    }
    Ok(costs)
}

/// Cost of each goal on `grids` with `n` cells per side, and the solution with which it was reached.
pub(super) fn cost(
    name: &str,
    grids: fn(usize) -> Result<Multigrid, InputError>,
    n: usize,
    load: &[f64],
) -> Result<(Cost, [Vec<f64>; 3]), String> {
    let failed = |e| format!("{name} on grid 1/{n}: {e}");
    let mut workspace = grids(n).map_err(failed)?;
    let mut solve = |goal| {
        let params = MultigridParams { goal, ..MultigridParams::default() };
        let outcome = workspace.solve(load, None, &params).map_err(failed)?;
        let mut y = vec![0.0; load.len()];
        workspace.write_solution(&mut y);
        Ok::<_, String>((Spent::of(&outcome), y))
    };
    let [(a, ya), (b, yb), (c, yc)] = [solve(GOALS[0])?, solve(GOALS[1])?, solve(GOALS[2])?];
    let bytes = workspace.bytes() as f64 / load.len() as f64;
    Ok((Cost { name: name.into(), cells: n, bytes, goals: [a, b, c] }, [ya, yb, yc]))
}

impl Spent {
    fn of(outcome: &MultigridOutcome) -> Self {
        let MultigridOutcome { stop, cycles, kkt, work_units, .. } = *outcome;
        Self { work_units, cycles, kkt, stop }
    }
}

fn map2(a: &Errors, b: &Errors, f: impl Fn(f64, f64) -> f64) -> Errors {
    Errors {
        l2: a.l2.zip(b.l2).map(|(a, b)| f(a, b)),
        h1: f(a.h1, b.h1),
        max: f(a.max, b.max),
        multiplier_l2: f(a.multiplier_l2, b.multiplier_l2),
    }
}

fn orders(coarser: &Errors, finer: &Errors) -> Errors {
    map2(coarser, finer, |coarser, finer| libm::log2(coarser / finer))
}

impl Ranges {
    fn of(problems: &[Known<Level>], others: &[Cost]) -> Self {
        let levels = || problems.iter().flat_map(|problem| &problem.levels);
        let finest = levels().map(|level| level.cost.cells).max().unwrap_or(0);
        // A plan of coarse grids only has ranges as well.
        let from = ASYMPTOTIC.min(finest);
        let fine = || levels().filter(|level| level.cost.cells >= from);
        let extreme = |formula: bool| {
            let observed = || {
                fine()
                    .filter(|level| level.errors.l2.is_some() == formula)
                    .filter_map(|level| level.orders)
            };
            [f64::min, f64::max]
                .map(|f| observed().reduce(|a, b| map2(&a, &b, f)).unwrap_or_default())
        };
        let ratio = |k: usize| worst(fine().filter_map(|level| level.algebraic[k]));
        let last = || levels().filter(|level| level.cost.cells == finest);
        Self {
            tolerance: TOLERANCE,
            from,
            orders: extreme(true),
            contact: extreme(false),
            algebraic: [ratio(0), ratio(1)],
            known: work_units(fine().map(|level| &level.cost)),
            finest: work_units(last().map(|level| &level.cost)),
            others: work_units(others.iter()),
        }
    }
}

/// Least and greatest work units for each goal; zero without costs.
fn work_units<'a>(costs: impl Iterator<Item = &'a Cost> + Clone) -> [[f64; 2]; 3] {
    [0, 1, 2].map(|goal| {
        let units = costs.clone().map(|cost| cost.goals[goal].work_units);
        let Range { least, greatest } = Range::of(units).unwrap_or_default();
        [least, greatest]
    })
}
