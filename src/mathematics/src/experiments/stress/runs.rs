//! Runs of the experiments, one function per kind of stress.

use super::pending::{Pending, StressJob};
use super::{StressPlan, StressRun};
use crate::discrete::grid::Grid;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::largest;
use crate::experiments::numbers::RandomNumbers;
use crate::experiments::power_of_ten;
use crate::experiments::problems::nodal_load;
use crate::experiments::trial::{multigrid_trial, saddle_trials};
use crate::machine::threads::map;
use crate::multigrid::Goal;
use crate::problem::law::Law;
use crate::problem::source::Source;
use crate::saddle::jobs::Job;
use crate::saddle::{JobGoal, Method, Pair, StopRule};

/// Duality parameter of the series that do not vary it.
const R: f64 = 10.0;
/// Cells per side of the grids on which the rounding floor is measured.
const GRIDS: [usize; 7] = [4, 8, 16, 32, 64, 128, 256];
/// Factor of the limit of iterations in the series in which the rounding floor is to be reached.
const LONGER: usize = 2;
/// Cells per side of the finest of [`GRIDS`] on which the paper's method is taken to its rounding floor: it
/// needs iterations in proportion to their square.
const FINEST_SADDLE: usize = 32;
/// Exponents of the powers of ten by which f is multiplied.
const EXPONENTS: [i32; 15] =
    [-305, -300, -200, -150, -100, -50, -10, 0, 10, 50, 100, 150, 200, 300, 305];

/// Loads of a problem.
struct Loads {
    /// Name of the problem.
    name: String,
    /// Load on the coarse grid.
    coarse: Vec<f64>,
    /// Load on the fine grid.
    fine: Vec<f64>,
}

/// Loads of all problems of the plan, on the grids of the runs.
pub(super) struct StressLoads<'a> {
    plan: &'a StressPlan,
    pub(super) coarse: Grid,
    fine: Grid,
    /// Loads of all problems.
    loads: Vec<Loads>,
}

impl<'a> StressLoads<'a> {
    pub(super) fn new(plan: &'a StressPlan) -> Result<Self, String> {
        let coarse = Grid::new(plan.coarse).map_err(|e| e.clone())?;
        let fine = Grid::new(plan.fine).map_err(|e| e.clone())?;
        let mut loads = Vec::new();
        let papers = plan.problems.iter().map(|one| (one.name(), one.statement.f.clone()));
        for (name, f) in papers.chain([plan.contact.clone()]) {
            let f: Source = f.parse().map_err(|e| format!("{e}"))?;
            let rule = LoadRule::Bilinear {};
            loads.push(Loads { name, coarse: load(coarse, &f, rule), fine: load(fine, &f, rule) });
        }
        Ok(Self { plan, coarse, fine, loads })
    }

    /// Runs of all series but `floors`.
    pub(super) fn pending(&self) -> Vec<Pending> {
        let mut all: Vec<Pending> = self.loads.iter().flat_map(|of| self.duality(of)).collect();
        all.extend(self.scaling());
        all.extend([1.0, -1.0].into_iter().flat_map(|odd| self.deficits(odd)));
        all.extend(self.loads.iter().flat_map(|of| self.tolerances(of)));
        all.extend(self.starts());
        all.extend(self.jumps());
        all.extend(self.spikes());
        all
    }

    /// Paper's method under the printed rule and the dual one together, on the coarse grid.
    fn strict(&self, load: &[f64], r: f64, start: Pair) -> StressJob {
        let goal = JobGoal::Rule(StopRule::PrintedDual, self.plan.strict * largest(load));
        let (load, limit) = (load.into(), self.plan.cap);
        StressJob::Saddle { load, r, goal, limit, start }
    }

    /// Paper's method under the signed rule, on the coarse grid.
    fn signed(&self, load: &[f64], r: f64, tolerance: f64) -> StressJob {
        let goal = JobGoal::Rule(StopRule::Signed, tolerance);
        let (load, limit, start) = (load.into(), self.plan.cap, Pair::zero(self.coarse));
        StressJob::Saddle { load, r, goal, limit, start }
    }

    /// Multigrid to the rounding floor, on the fine grid.
    fn multigrid(&self, load: &[f64]) -> StressJob {
        StressJob::Multigrid { grid: self.fine, load: load.into(), goal: Goal::RoundingFloor }
    }

    fn duality(&self, loads: &Loads) -> Vec<Pending> {
        let pending = over("duality", -8..=12, |r| {
            [
                ("signed", self.signed(&loads.coarse, r, self.plan.tolerance)),
                ("strict", self.strict(&loads.coarse, r, Pair::zero(self.coarse))),
            ]
        });
        of_problem(&loads.name, pending)
    }

    fn scaling(&self) -> Vec<Pending> {
        let Some(loads) = self.loads.last() else { return Vec::new() };
        let mut pending = Vec::new();
        for exponent in EXPONENTS {
            let factor = power_of_ten(exponent);
            let coarse: Vec<f64> = loads.coarse.iter().map(|f| f * factor).collect();
            let fine: Vec<f64> = loads.fine.iter().map(|f| f * factor).collect();
            let runs = [
                ("scaled", self.signed(&coarse, R, self.plan.tolerance * factor)),
                ("fixed", self.signed(&coarse, R, self.plan.tolerance)),
                ("multigrid", self.multigrid(&fine)),
            ];
            pending.extend(together("scaling", f64::from(exponent), runs));
        }
        pending
    }

    fn deficits(&self, odd: f64) -> Vec<Pending> {
        let pending = over("deficits", (-14..=-1).rev(), |deficit| {
            let coarse = quadrants(self.coarse, odd, deficit);
            let fine = quadrants(self.fine, odd, deficit);
            [
                ("strict", self.strict(&coarse, R, Pair::zero(self.coarse))),
                ("multigrid", self.multigrid(&fine)),
            ]
        });
        of_problem(&format!("odd quadrant {odd}"), pending)
    }

    fn tolerances(&self, loads: &Loads) -> Vec<Pending> {
        let load = &loads.coarse;
        let pending = over("tolerances", (1..=9).map(|k| -2 * k), |tolerance| {
            let bound = tolerance * largest(load);
            let (grid, goal) = (self.coarse, Goal::Kkt(bound));
            [
                ("signed", self.to_floor(load, StopRule::Signed, bound)),
                ("strict", self.to_floor(load, StopRule::PrintedDual, bound)),
                ("multigrid", StressJob::Multigrid { grid, load: load.clone(), goal }),
            ]
        });
        of_problem(&loads.name, pending)
    }

    /// Paper's method on the coarse grid with a tolerance that may be below its rounding floor.
    fn to_floor(&self, load: &[f64], rule: StopRule, tolerance: f64) -> StressJob {
        StressJob::Saddle {
            load: load.into(),
            r: R,
            goal: JobGoal::Rule(rule, tolerance),
            limit: LONGER * self.plan.cap,
            start: Pair::zero(self.coarse),
        }
    }

    /// Runs of the series `floors`.
    pub(super) fn floors(&self) -> Vec<StressRun> {
        map(&GRIDS, 1, |&cells| self.floor(cells)).concat()
    }

    fn floor(&self, cells: usize) -> Vec<StressRun> {
        let grid = Grid::new(cells).expect("not below the least");
        let load = quadrants(grid, -1.0, self.plan.deficit);
        let floor = multigrid_trial(grid, &load, Goal::RoundingFloor);
        let mut runs = vec![run("floors", cells as f64, "multigrid").ended(floor)];
        if cells <= FINEST_SADDLE {
            let job = Job {
                law: Law::SIGNORINI,
                load: &load,
                start: &Pair::zero(grid),
                method: Method::ArrowHurwicz,
                r: R,
                goal: JobGoal::Rule(StopRule::PrintedDual, 0.0),
                // More iterations than the method needs.
                cap: 60 * cells * cells,
            };
            let strict = run("floors", cells as f64, "strict");
            runs.push(strict.ended(saddle_trials(grid, &[job]).remove(0)));
        }
        runs
    }

    fn starts(&self) -> Vec<Pending> {
        let coarse = quadrants(self.coarse, -1.0, self.plan.deficit);
        let starts: [(&str, StartValue); 9] = [
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
        let mut pending = Vec::new();
        for (name, value) in starts {
            let pair = Pair { y: start(self.coarse, value), ..Pair::zero(self.coarse) };
            let (series, start, method) = ("starts", Some(name), "strict");
            let run = StressRun { series, start, method, ..StressRun::default() };
            pending.push(Pending { run, job: self.strict(&coarse, R, pair) });
        }
        pending
    }

    fn jumps(&self) -> Vec<Pending> {
        self.loads_of_size("jumps", |x, y, size| match (x <= 0.0, y <= 0.0) {
            (true, true) => -size,
            (true, false) => 0.3 * size,
            _ => 1.0,
        })
    }

    fn spikes(&self) -> Vec<Pending> {
        let h = self.fine.h();
        self.loads_of_size("spikes", |x, y, size| {
            if (x - 0.25).abs().max((y - 0.125).abs()) < 0.5 * h { size } else { -1.0 }
        })
    }

    /// Series over the size of a feature of f, which is given as a function of x, y and this size.
    fn loads_of_size(
        &self,
        series: &'static str,
        f: impl Fn(f64, f64, f64) -> f64,
    ) -> Vec<Pending> {
        over(series, 0..=15, |size| {
            let load = nodal_load(self.fine.cells(), Some(0.1), |x, y| f(x, y, size));
            [("multigrid", self.multigrid(&load))]
        })
    }
}

/// Run of a series for one x that is yet to end.
fn run(series: &'static str, x: f64, method: &'static str) -> StressRun {
    StressRun { series, x: Some(x), method, ..StressRun::default() }
}

/// Runs of a series for one x.
fn together<const N: usize>(
    series: &'static str,
    x: f64,
    jobs: [(&'static str, StressJob); N],
) -> [Pending; N] {
    jobs.map(|(method, job)| Pending { run: run(series, x, method), job })
}

/// Runs of a series for each power of ten.
fn over<const N: usize>(
    series: &'static str,
    exponents: impl IntoIterator<Item = i32>,
    jobs: impl Fn(f64) -> [(&'static str, StressJob); N],
) -> Vec<Pending> {
    let powers = exponents.into_iter().map(power_of_ten);
    powers.flat_map(|x| together(series, x, jobs(x))).collect()
}

/// The runs as those of a problem.
fn of_problem(name: &str, mut pending: Vec<Pending>) -> Vec<Pending> {
    for one in &mut pending {
        one.run.problem = Some(name.to_owned());
    }
    pending
}

/// Value of a start at the node in a column and a row.
type StartValue = fn(usize, usize, &mut RandomNumbers) -> f64;

/// Nodal vector with these values.
fn start(grid: Grid, value: StartValue) -> Vec<f64> {
    let (side, mut random) = (grid.side(), RandomNumbers::new(1, 0));
    (0..grid.nodes()).map(|k| value(k % side, k / side, &mut random)).collect()
}

/// Load of f that is `odd` on the lower left quadrant, a third of its opposite elsewhere, less a constant.
fn quadrants(grid: Grid, odd: f64, deficit: f64) -> Vec<f64> {
    nodal_load(
        grid.cells(),
        Some(deficit),
        |x, y| if x <= 0.0 && y <= 0.0 { odd } else { -odd / 3.0 },
    )
}
