//! The runs of the experiments, one function per kind of stress.

use super::{Changed, Series, Single, StressCase, StressPlan};
use crate::discrete::grid::Grid;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::largest;
use crate::experiments::numbers::RandomNumbers;
use crate::experiments::power_of_ten;
use crate::experiments::problems::{Discrete, Problem, nodal_load};
use crate::experiments::trial::{self, Trial, multi, saddle};
use crate::multigrid::Goal;
use crate::problem::source::Source;
use crate::saddle::batch::{AsDefined, End, Job, JobGoal, LANES, Nested, Number, run_nested};
use crate::saddle::{Method, Pair, StopRule};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The duality parameter where it is not what is varied.
const R: f64 = 10.0;
/// Cells per side of the grids on which the rounding floor is measured.
const GRIDS: [usize; 7] = [4, 8, 16, 32, 64, 128, 256];
/// Factor on the usual limit of iterations where the rounding floor is to be reached.
const LONGER: usize = 2;
/// Runs of the paper's method in a batch: enough that few lanes are idle when only the longest are left.
const BATCH: usize = 4 * LANES;
/// Cells per side of the finest of [`GRIDS`] on which the paper's method is taken to its rounding floor: it
/// needs iterations in proportion to their square.
const FINEST_SADDLE: usize = 32;

/// A run that is yet to be made.
enum StressRun {
    /// The paper's method on the coarse grid.
    Saddle { load: Vec<f64>, r: f64, goal: JobGoal, cap: usize, start: Pair },
    /// Multigrid, by nested iteration or from a start.
    Multigrid { grid: Grid, load: Vec<f64>, goal: Goal, start: Option<Vec<f64>> },
}

impl StressRun {
    /// Job of a lane, for the paper's method.
    fn job(&self) -> Option<Job<'_>> {
        let Self::Saddle { load, start, r, goal, cap } = self else { return None };
        let method = Method::ArrowHurwicz;
        Some(Job { load, start, method, r: *r, goal: *goal, cap: *cap })
    }

    /// Makes a run of multigrid.
    fn alone(&self) -> Option<Trial> {
        let Self::Multigrid { grid, load, goal, start } = self else { return None };
        Some(multi(*grid, load, *goal, start.as_deref()))
    }
}

pub(super) struct Runs<'a> {
    plan: &'a StressPlan,
    coarse: Grid,
    fine: Grid,
    /// Of the problems, on the coarse grid and on the fine one.
    pub(super) loads: Vec<[Vec<f64>; 2]>,
}

impl<'a> Runs<'a> {
    pub(super) fn new(plan: &'a StressPlan) -> Result<Self, String> {
        let grid = |n: usize| Grid::new(n).map_err(|e| e.to_string());
        let (coarse, fine) = (grid(plan.coarse)?, grid(plan.fine)?);
        let texts = plan.problems.iter().map(|problem| &problem.f).chain([&plan.contact.1]);
        let loads = texts.map(|text| {
            let f: Source = text.parse().map_err(|e| format!("{e}"))?;
            Ok([coarse, fine].map(|grid| load(grid, &f, LoadRule::LumpedAverage {})))
        });
        Ok(Self { plan, coarse, fine, loads: loads.collect::<Result<_, String>>()? })
    }

    /// The paper's method under the printed rule and the dual one together, on the coarse grid.
    fn strict(&self, load: &[f64], r: f64, start: Pair) -> StressRun {
        let goal = JobGoal::Rule(StopRule::PrintedDual, self.plan.strict * largest(load));
        StressRun::Saddle { load: load.into(), r, goal, cap: self.plan.cap, start }
    }

    fn signed(&self, load: &[f64], r: f64, tolerance: f64) -> StressRun {
        let (goal, start) = (JobGoal::Rule(StopRule::Signed, tolerance), Pair::zero(self.coarse));
        StressRun::Saddle { load: load.into(), r, goal, cap: self.plan.cap, start }
    }

    /// Multigrid to the rounding floor, on the fine grid.
    fn multigrid(&self, load: &[f64], start: Option<Vec<f64>>) -> StressRun {
        StressRun::Multigrid {
            grid: self.fine,
            load: load.into(),
            goal: Goal::RoundingFloor,
            start,
        }
    }

    /// Makes the runs for each power of ten.
    fn over<const N: usize>(
        &self,
        exponents: impl IntoIterator<Item = i32>,
        runs: impl Fn(f64) -> [(&'static str, StressRun); N],
    ) -> Series<f64> {
        let powers = exponents.into_iter().map(power_of_ten);
        self.cases(powers.map(|x| (x, runs(x))))
    }

    /// Makes the runs of all cases: those of the paper's method in vector lanes, the others side by side.
    fn cases<X, const N: usize>(
        &self,
        cases: impl Iterator<Item = (X, [(&'static str, StressRun); N])>,
    ) -> Series<X> {
        let (x, runs): (Vec<X>, Vec<_>) = cases.unzip();
        let runs: Vec<_> = runs.iter().flatten().collect();
        let jobs: Vec<Job> = runs.iter().filter_map(|(_, run)| run.job()).collect();
        let in_lanes = jobs.par_chunks(BATCH).flat_map(|jobs| saddle(self.coarse, jobs));
        let mut in_lanes = in_lanes.collect::<Vec<_>>().into_iter();
        let alone: Vec<Option<Trial>> = runs.par_iter().map(|(_, run)| run.alone()).collect();
        let trials = runs.iter().zip(alone).map(|((name, _), trial)| {
            let trial = trial.or_else(|| in_lanes.next()).expect("each run was made");
            ((*name).to_owned(), trial)
        });
        let trials: Vec<_> = trials.collect();
        let of_case = trials.chunks(N).map(|trials| trials.iter().cloned().collect());
        x.into_iter().zip(of_case).map(|(x, trials)| StressCase { x, trials }).collect()
    }

    pub(super) fn duality(&self, [load, _]: &[Vec<f64>; 2]) -> Series<f64> {
        self.over(-8..=12, |r| {
            [
                ("signed", self.signed(load, r, self.plan.tolerance)),
                ("strict", self.strict(load, r, Pair::zero(self.coarse))),
            ]
        })
    }

    pub(super) fn scaling(&self) -> Series<i32> {
        const EXPONENTS: [i32; 15] =
            [-305, -300, -200, -150, -100, -50, -10, 0, 10, 50, 100, 150, 200, 300, 305];
        let Some([coarse, fine]) = self.loads.last() else { return Vec::new() };
        let case = |exponent: i32| {
            let factor = power_of_ten(exponent);
            let scaled = |load: &[f64]| load.iter().map(|f| f * factor).collect::<Vec<_>>();
            let (coarse, fine) = (scaled(coarse), scaled(fine));
            let runs = [
                ("scaled", self.signed(&coarse, R, self.plan.tolerance * factor)),
                ("fixed", self.signed(&coarse, R, self.plan.tolerance)),
                ("multigrid", self.multigrid(&fine, None)),
            ];
            (exponent, runs)
        };
        self.cases(EXPONENTS.into_iter().map(case))
    }

    pub(super) fn deficits(&self, odd: f64) -> Series<f64> {
        self.over((-14..=-1).rev(), |deficit| {
            let coarse = quadrants(self.coarse, odd, deficit);
            let fine = quadrants(self.fine, odd, deficit);
            [
                ("strict", self.strict(&coarse, R, Pair::zero(self.coarse))),
                ("multigrid", self.multigrid(&fine, None)),
            ]
        })
    }

    pub(super) fn tolerances(&self, [load, _]: &[Vec<f64>; 2]) -> Series<f64> {
        self.over((1..=9).map(|k| -2 * k), |tolerance| {
            let bound = tolerance * largest(load);
            let run = |rule| StressRun::Saddle {
                load: load.clone(),
                r: R,
                goal: JobGoal::Rule(rule, bound),
                cap: LONGER * self.plan.cap,
                start: Pair::zero(self.coarse),
            };
            let (grid, goal) = (self.coarse, Goal::Kkt(bound));
            let multigrid = StressRun::Multigrid { grid, load: load.clone(), goal, start: None };
            [
                ("signed", run(StopRule::Signed)),
                ("strict", run(StopRule::PrintedDual)),
                ("multigrid", multigrid),
            ]
        })
    }

    pub(super) fn floors(&self) -> Series<f64> {
        let of_grid = |&cells: &usize| {
            let (grid, load, cap) = self.to_the_floor(cells);
            let floor = multi(grid, &load, Goal::RoundingFloor, None);
            let mut trials = BTreeMap::from([("multigrid".to_owned(), floor)]);
            if cells <= FINEST_SADDLE {
                let goal = JobGoal::Rule(StopRule::PrintedDual, 0.0);
                let (start, method) = (&Pair::zero(grid), Method::ArrowHurwicz);
                let job = Job { load: &load, start, method, r: R, goal, cap };
                trials.insert("strict".into(), saddle(grid, &[job]).remove(0));
            }
            StressCase { x: cells as f64, trials }
        };
        GRIDS.par_iter().map(of_grid).collect()
    }

    /// The paper's iteration in single precision.
    pub(super) fn single_floors(&self) -> Series<f64> {
        let of_grid = |&cells: &usize| {
            let (grid, load, cap) = self.to_the_floor(cells);
            let narrow = narrowed(&load);
            // No gradient is below minus infinity: the rule is never met.
            let goal = JobGoal::Rule(StopRule::Signed, f64::NEG_INFINITY);
            let (start, method) = (&Pair::zero(grid), Method::ArrowHurwicz);
            let job = Job { load: &narrow, start, method, r: R, goal, cap };
            let trials = BTreeMap::from([("single".to_owned(), trial::single(grid, &load, job))]);
            StressCase { x: cells as f64, trials }
        };
        GRIDS.par_iter().filter(|&&cells| cells <= FINEST_SADDLE).map(of_grid).collect()
    }

    /// Grid, load and cap with which the paper's method reaches its rounding floor.
    fn to_the_floor(&self, cells: usize) -> (Grid, Vec<f64>, usize) {
        let grid = Grid::new(cells).expect("not below the least");
        // Sixty times the square of the cells is more than it needs.
        (grid, quadrants(grid, -1.0, self.plan.deficit), 60 * cells * cells)
    }

    pub(super) fn starts(&self) -> Series<String> {
        let load = |grid| quadrants(grid, -1.0, self.plan.deficit);
        type Of = fn(usize, usize, &mut RandomNumbers) -> f64;
        let starts: [(&str, Of); 9] = [
            ("zero", |_, _, _| 0.0),
            ("constant 1e10", |_, _, _| 1e10),
            ("constant -1e10", |_, _, _| -1e10),
            ("random, up to 1e10", |_, _, random| 1e10 * (2.0 * random.unit() - 1.0)),
            ("alternating 1e10", |i, j, _| if (i + j).is_multiple_of(2) { 1e10 } else { -1e10 }),
            ("constant 1e308", |_, _, _| 1e308),
            ("alternating 1e308", |i, j, _| if (i + j).is_multiple_of(2) { 1e308 } else { -1e308 }),
            ("infinite in one node", |i, j, _| if (i, j) == (5, 5) { f64::INFINITY } else { 0.0 }),
            ("NaN in one node", |i, j, _| if (i, j) == (5, 5) { f64::NAN } else { 0.0 }),
        ];
        let of_start = |(name, of): (&str, Of)| {
            let field = |grid: Grid| -> Vec<f64> {
                let (side, mut random) = (grid.side(), RandomNumbers::new(1, 0));
                (0..grid.nodes()).map(|k| of(k % side, k / side, &mut random)).collect()
            };
            let pair = Pair { y: field(self.coarse), ..Pair::zero(self.coarse) };
            let (load, start) = ([load(self.coarse), load(self.fine)], field(self.fine));
            let runs = [
                ("strict", self.strict(&load[0], R, pair)),
                ("multigrid", self.multigrid(&load[1], Some(start))),
            ];
            (name.to_owned(), runs)
        };
        self.cases(starts.into_iter().map(of_start))
    }

    pub(super) fn jumps(&self) -> Series<f64> {
        self.loads_of_size(|x, y, size| match (x <= 0.0, y <= 0.0) {
            (true, true) => -size,
            (true, false) => 0.3 * size,
            _ => 1.0,
        })
    }

    pub(super) fn spikes(&self) -> Series<f64> {
        let h = self.fine.h();
        self.loads_of_size(|x, y, size| {
            if (x - 0.25).abs().max((y - 0.125).abs()) < 0.5 * h { size } else { -1.0 }
        })
    }

    fn loads_of_size(&self, f: impl Fn(f64, f64, f64) -> f64 + Sync) -> Series<f64> {
        self.over(0..=15, |size| {
            let load = nodal_load(self.fine.cells(), Some(0.1), |x, y| f(x, y, size));
            [("multigrid", self.multigrid(&load, None))]
        })
    }
}

/// The counts of a table in single precision against those in double.
pub(super) fn single(table: &Problem) -> Result<Single, String> {
    let Discrete { grids, loads: double, .. } = table.discrete()?;
    let single: Vec<Vec<f32>> = double.iter().map(|load| narrowed(load)).collect();
    let double = counts(table, &grids, &double, table.max_iterations);
    // Single precision may stall above the tolerance.
    let most = double.iter().flatten().flatten().max().copied().unwrap_or_default();
    let single = counts(table, &grids, &single, 10 * most);
    let mut changed = Vec::new();
    for (&r, (double, single)) in table.r.iter().zip(double.into_iter().zip(single)) {
        for (&cells, (double, single)) in table.grids.iter().zip(double.into_iter().zip(single)) {
            if double != single {
                changed.push(Changed { r, cells, double: double.unwrap_or_default(), single });
            }
        }
    }
    let cells = table.r.len() * table.grids.len();
    Ok(Single { number: table.number, cells, changed })
}

/// Per r and grid, the iterations in the precision of the loads; none if the cap came first.
fn counts<N: Number>(
    table: &Problem,
    grids: &[Grid],
    loads: &[Vec<N>],
    cap: usize,
) -> Vec<Vec<Option<usize>>> {
    let nested = |&r: &f64| Nested { loads, r, rule: StopRule::Signed };
    let runs: Vec<_> = table.r.iter().map(nested).collect();
    let ends = run_nested(grids, &runs, table.prolongation, |_, _| cap, &mut AsDefined);
    ends.iter().map(|ends| ends.iter().map(End::count).collect()).collect()
}

/// A load vector in single precision.
fn narrowed(load: &[f64]) -> Vec<f32> {
    load.iter().map(|&f| f32::of(f)).collect()
}

/// `odd` on the lower left quadrant, a third of its opposite elsewhere, less a constant.
fn quadrants(grid: Grid, odd: f64, deficit: f64) -> Vec<f64> {
    nodal_load(
        grid.cells(),
        Some(deficit),
        |x, y| if x <= 0.0 && y <= 0.0 { odd } else { -odd / 3.0 },
    )
}
