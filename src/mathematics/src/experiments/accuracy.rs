//! Errors against known solutions, and what they cost multigrid in work units and bytes.

use super::known::{KnownSolution, SAMPLED, SolutionErrors};
use super::problems::{CONTACT, paper_loads, stress_loads};
use super::work::{self, nodal_values};
use super::{Findings, Rows};
use crate::discrete::grid::Grid;
use crate::discrete::kkt::kkt;
use crate::discrete::norms::lumped;
use crate::discrete::stiffness::energy;
use crate::discrete::stop::Stop;
use crate::machine::threads::{join, try_map};
use crate::multigrid::{Goal, InputError, Multigrid, MultigridParams};
use crate::problem::exact::Exact;
use crate::problem::law::Law;
use serde::{Deserialize, Serialize};

/// Input of the experiment; every grid is given by its cells per side.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct AccuracyPlan {
    /// The paper's problems: names, and f in the notation of scenes.
    problems: Vec<(String, String)>,
    /// Grids on which errors against formulas are measured, each the halving of the one before.
    cells: Vec<usize>,
    /// Grids, likewise, for the problems that test contact.
    contact: Vec<usize>,
    /// Grids on which the cost of loads without known solution is counted.
    others: Vec<usize>,
    /// Right-hand sides, and grids, on which the sweeps of the paper's method are counted.
    laws: Vec<(String, Vec<usize>)>,
    /// Nested grids on which multigrid is compared with the saddle-point methods.
    compared: Vec<usize>,
}

impl AccuracyPlan {
    /// Plan of the book for the paper's problems, given by name with f in the notation of scenes.
    pub(super) fn new(problems: Vec<(String, String)>) -> Self {
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

/// Table `errors`: a problem with known solution on one grid, solved to the rounding floor.
#[derive(Serialize)]
struct ErrorRow {
    /// Name, as in `exact(name)` where the solution has a formula.
    problem: String,
    cells: usize,
    #[serde(flatten)]
    errors: SolutionErrors,
    /// Observed orders against the grid before.
    order_l2: Option<f64>,
    order_h1: Option<f64>,
    order_max: Option<f64>,
    order_multiplier: Option<f64>,
    /// Algebraic over discretisation error at the goal [`Goal::DiscretisationError`], in L2 (lumped); none if that
    /// error is not known.
    algebraic_l2: Option<f64>,
    /// Ratio likewise in H1.
    algebraic_h1: f64,
}

/// Table `work`: cost of one problem on one grid to one goal.
#[derive(Serialize)]
struct WorkRow {
    problem: String,
    /// True if the solution is known: of the table `errors`.
    known: bool,
    cells: usize,
    /// Name of a goal in [`GOALS`].
    goal: &'static str,
    stop: Stop,
    work_units: f64,
    /// Natural residual that is left, in the units of the load.
    residual: f64,
    /// Bytes of the workspace per unknown.
    bytes: f64,
}

/// Table `facts`, of one row.
#[derive(Serialize)]
struct FactsRow {
    /// Cells per side of the grid at whose nodes solutions without a formula are compared.
    sampled: usize,
    /// Natural residual of the second goal.
    tolerance: f64,
    /// Cells per side of the coarsest grid on which orders and work units are close to their limits.
    asymptotic: usize,
    /// Least value of the solution of [`Exact::FreeCorner`], which is lifted least, at the nodes of that grid.
    free_corner_least: f64,
    free_corner_greatest: f64,
}

/// Natural residual that the second goal asks for, not relative: in the units of the load, f h^2.
const TOLERANCE: f64 = 1e-10;
/// Goals of multigrid, with their names.
const GOALS: [(&str, Goal); 3] = [
    ("discretisation error", Goal::DiscretisationError),
    ("residual", Goal::Kkt(TOLERANCE)),
    ("rounding floor", Goal::RoundingFloor),
];
/// Cells per side of the coarsest grid on which orders and work units are close to their limits.
const ASYMPTOTIC: usize = 64;

/// Runs the experiment.
///
/// 1. Solves the problems with a formula, and those that test contact with the spectral solver.
/// 2. Solves each on its grids by multigrid, and measures errors and cost (`errors`, `work`).
/// 3. Counts the cost of loads without known solution (`work`).
/// 4. Counts the sweeps of the paper's method (`sweeps`), and compares its work with multigrid's (`compared`).
///
/// # Errors
/// A sentence if a grid cannot be used, or a problem cannot be solved on it.
pub(super) fn accuracy(plan: &AccuracyPlan) -> Result<Findings, String> {
    let mut solutions: Vec<_> = Exact::ALL.into_iter().map(KnownSolution::Formula).collect();
    for (name, f) in CONTACT {
        solutions.push(KnownSolution::spectral(name, f)?);
    }
    let (known, (others, (sweeps, compared))) = join(
        || try_map(&solutions, |solution| known(solution, plan)),
        || {
            join(
                || others(&plan.others, &plan.problems),
                || join(|| work::laws(&plan.laws), || work::compare(&plan.compared)),
            )
        },
    );
    let (mut errors, mut work) = (Vec::new(), Vec::new());
    for known in known? {
        errors.extend(known.errors);
        work.extend(known.work);
    }
    work.extend(others?);
    let sampled = Grid::new(SAMPLED).map_err(|e| e.clone())?;
    let free_corner = nodal_values(Exact::FreeCorner, sampled);
    let facts = FactsRow {
        sampled: SAMPLED,
        tolerance: TOLERANCE,
        asymptotic: ASYMPTOTIC,
        free_corner_least: free_corner.iter().copied().fold(f64::INFINITY, f64::min),
        free_corner_greatest: free_corner.into_iter().fold(f64::NEG_INFINITY, f64::max),
    };
    Ok(Findings::from([
        ("errors".into(), Rows::of(errors)),
        ("work".into(), Rows::of(work)),
        ("sweeps".into(), Rows::of(sweeps?)),
        ("compared".into(), Rows::of(compared?)),
        ("facts".into(), Rows::of([facts])),
    ]))
}

/// Errors and cost of a problem with known solution, grid by grid.
struct KnownRows {
    errors: Vec<ErrorRow>,
    work: Vec<WorkRow>,
}

/// Measures errors and cost of a problem with known solution, grid by grid.
fn known(solution: &KnownSolution, plan: &AccuracyPlan) -> Result<KnownRows, String> {
    let cells = match solution {
        KnownSolution::Formula(_) => &plan.cells,
        KnownSolution::Spectral(_) => &plan.contact,
    };
    let mut known = KnownRows { errors: Vec::new(), work: Vec::new() };
    for &n in cells {
        let grid = Grid::new(n).map_err(|e| e.clone())?;
        let load = solution.load(grid);
        let (cost, [rough, _, y]) = cost(solution.name(), n, &load)?;
        let errors = solution.errors(grid, &y, &load);
        let wrong: Vec<f64> = rough.iter().zip(&y).map(|(a, b)| a - b).collect();
        // Twice the energy without load is the square of the H1 seminorm.
        let h1 = (2.0 * energy(grid, &wrong, &vec![0.0; wrong.len()])).sqrt();
        let before = known.errors.last().map(|row| row.errors);
        known.errors.push(ErrorRow {
            problem: solution.name().into(),
            cells: n,
            order_l2: errors.l2.and_then(|l2| order(before?.l2, l2)),
            order_h1: order(before.map(|before| before.h1), errors.h1),
            order_max: order(before.map(|before| before.max), errors.max),
            order_multiplier: order(
                before.map(|before| before.multiplier_l2),
                errors.multiplier_l2,
            ),
            algebraic_l2: errors.l2.map(|l2| lumped(grid, &wrong) / l2),
            algebraic_h1: h1 / errors.h1,
            errors,
        });
        known.work.extend(cost.into_iter().map(|row| WorkRow { known: true, ..row }));
    }
    Ok(known)
}

/// Counts the cost of the paper's problems and of the stress loads on grids with these cells per side.
fn others(cells: &[usize], problems: &[(String, String)]) -> Result<Vec<WorkRow>, String> {
    let mut rows = Vec::new();
    for &n in cells {
        Grid::new(n).map_err(|e| e.clone())?;
        let mut loads = paper_loads(n, problems)?;
        loads.extend(stress_loads(n));
        for (counted, _) in try_map(&loads, |(name, load)| cost(name, n, load))? {
            rows.extend(counted);
        }
    }
    Ok(rows)
}

/// Solves a problem on the grid with `n` cells per side to each of the [`GOALS`]; returns the cost, and the nodal
/// vectors with which they were reached.
fn cost(name: &str, n: usize, load: &[f64]) -> Result<(Vec<WorkRow>, [Vec<f64>; 3]), String> {
    let failed = |e: InputError| format!("{name} on grid 1/{n}: {e}");
    let mut workspace = Multigrid::square(n).map_err(failed)?;
    let grid = Grid::new(n).map_err(|e| e.clone())?;
    let (mut rows, mut solutions) = (Vec::new(), [const { Vec::new() }; 3]);
    for ((words, goal), solution) in GOALS.into_iter().zip(&mut solutions) {
        let params = MultigridParams { goal, ..MultigridParams::default() };
        let problem = Law::SIGNORINI.with_load(load);
        let end = workspace.solve(problem, &params).map_err(failed)?;
        *solution = vec![0.0; load.len()];
        workspace.write_solution(solution);
        rows.push(WorkRow {
            problem: name.into(),
            known: false,
            cells: n,
            goal: words,
            stop: end.stop,
            work_units: end.work_units,
            residual: kkt(grid, Law::SIGNORINI, solution, load).natural,
            bytes: 0.0,
        });
    }
    let bytes = workspace.bytes() as f64 / load.len() as f64;
    rows.iter_mut().for_each(|row| row.bytes = bytes);
    Ok((rows, solutions))
}

/// Observed order, given the errors on the grid before and on this one.
fn order(before: Option<f64>, now: f64) -> Option<f64> {
    Some(libm::log2(before? / now))
}
