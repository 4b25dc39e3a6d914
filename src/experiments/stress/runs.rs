//! The runs of the experiments, one function per kind of stress.

use super::{Attained, Case, Changed, Plan, Series, Single};
use crate::discrete::grid::{Grid, nested};
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
use crate::discrete::norms::largest;
use crate::experiments::power_of_ten;
use crate::experiments::problems::{Problem, nodal_load};
use crate::experiments::trial::{Trial, multi, saddle};
use crate::identify::random::Random;
use crate::multigrid::Goal;
use crate::problem::source::Source;
use crate::saddle::batch::{AsDefined, End, Goal as Until, Job, Nested, Number, run, run_nested};
use crate::saddle::{Method, Pair, Params, StopRule};
use rayon::prelude::*;

/// The duality parameter where it is not what is varied.
const R: f64 = 10.0;
/// Cells per side of the grids on which the rounding floor is measured.
const GRIDS: [usize; 7] = [4, 8, 16, 32, 64, 128, 256];
/// How many times the usual cap iterations may take where the rounding floor is to be reached.
const LONGER: usize = 2;

/// The finest grid on which the paper's method reaches its floor in good time.
const SLOW: usize = 32;

pub(super) struct Runs<'a> {
    plan: &'a Plan,
    coarse: Grid,
    fine: Grid,
    /// Of the problems, on the coarse grid and on the fine one.
    pub(super) loads: Vec<[Vec<f64>; 2]>,
}

impl<'a> Runs<'a> {
    pub(super) fn new(plan: &'a Plan) -> Result<Self, String> {
        let grid = |n: usize| Grid::new(n).map_err(|e| e.to_string());
        let (coarse, fine) = (grid(plan.coarse)?, grid(plan.fine)?);
        let texts = plan.problems.iter().map(|problem| &problem.f).chain([&plan.contact.1]);
        let loads = texts.map(|text| {
            let f: Source = text.parse().map_err(|e| format!("{e}"))?;
            Ok([coarse, fine].map(|grid| load(grid, &f, LoadRule::LumpedAverage)))
        });
        Ok(Self { plan, coarse, fine, loads: loads.collect::<Result<_, String>>()? })
    }

    /// The paper's method under the printed rule and the dual one together, on the coarse grid.
    fn strict(&self, load: &[f64], r: f64, pair: Pair) -> Trial {
        let params = Params {
            r,
            tolerance: self.plan.strict * largest(load),
            rule: StopRule::PrintedDual,
            max_iterations: self.plan.cap,
        };
        saddle(self.coarse, load, &params, pair)
    }

    fn signed(&self, load: &[f64], r: f64, tolerance: f64) -> Trial {
        let max_iterations = self.plan.cap;
        let params = Params { r, tolerance, rule: StopRule::Signed, max_iterations };
        saddle(self.coarse, load, &params, Pair::zero(self.coarse))
    }

    /// Multigrid to the rounding floor, on the fine grid.
    fn multigrid(&self, load: &[f64], start: Option<&[f64]>) -> Trial {
        multi(self.fine, load, Goal::RoundingFloor, start)
    }

    pub(super) fn duality(&self, [load, _]: &[Vec<f64>; 2]) -> Series<f64> {
        over(-8..=12, power_of_ten, |r| {
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
        over(
            EXPONENTS,
            |exponent| exponent,
            |exponent| {
                let factor = power_of_ten(exponent);
                let scaled = |load: &[f64]| load.iter().map(|f| f * factor).collect::<Vec<_>>();
                let (coarse, fine) = (scaled(coarse), scaled(fine));
                [
                    ("scaled", self.signed(&coarse, R, self.plan.tolerance * factor)),
                    ("fixed", self.signed(&coarse, R, self.plan.tolerance)),
                    ("multigrid", self.multigrid(&fine, None)),
                ]
            },
        )
    }

    pub(super) fn deficits(&self, odd: f64) -> Series<f64> {
        over((-14..=-1).rev(), power_of_ten, |deficit| {
            let coarse = quadrants(self.coarse, odd, deficit);
            let fine = quadrants(self.fine, odd, deficit);
            [
                ("strict", self.strict(&coarse, R, Pair::zero(self.coarse))),
                ("multigrid", self.multigrid(&fine, None)),
            ]
        })
    }

    pub(super) fn tolerances(&self, [load, _]: &[Vec<f64>; 2]) -> Series<f64> {
        over((1..=9).map(|k| -2 * k), power_of_ten, |tolerance| {
            let bound = tolerance * largest(load);
            let run = |rule| {
                let max_iterations = LONGER * self.plan.cap;
                let params = Params { r: R, tolerance: bound, rule, max_iterations };
                saddle(self.coarse, load, &params, Pair::zero(self.coarse))
            };
            [
                ("signed", run(StopRule::Signed)),
                ("strict", run(StopRule::PrintedDual)),
                ("multigrid", multi(self.coarse, load, Goal::Kkt(bound), None)),
            ]
        })
    }

    pub(super) fn floors(&self) -> Series<f64> {
        let of_grid = |&cells: &usize| {
            let (grid, load, max_iterations) = self.to_the_floor(cells);
            let params =
                Params { r: R, tolerance: 0.0, rule: StopRule::PrintedDual, max_iterations };
            let mut case = Case::new(
                cells as f64,
                [("multigrid", multi(grid, &load, Goal::RoundingFloor, None))],
            );
            if cells <= SLOW {
                let strict = saddle(grid, &load, &params, Pair::zero(grid));
                case.trials.insert("strict".into(), strict);
            }
            case
        };
        GRIDS.par_iter().map(of_grid).collect()
    }

    /// The paper's iteration in single precision.
    pub(super) fn single_floors(&self) -> Vec<Attained> {
        let of_grid = |&cells: &usize| {
            let (grid, load, cap) = self.to_the_floor(cells);
            let narrow: Vec<f32> = load.iter().map(|&f| f32::of(f)).collect();
            // No gradient is below minus infinity: the rule is never met.
            let goal = Until::Rule(StopRule::Signed, f64::NEG_INFINITY);
            let (start, method) = (&Pair::zero(grid), Method::ArrowHurwicz);
            let job = Job { load: &narrow, start, method, r: R, goal, cap };
            let ends = run(grid, &[job], &mut AsDefined);
            let wide = &ends[0].pair.y;
            let judged = kkt(grid, wide, &load);
            let unit = f64::from(f32::EPSILON) * largest(wide);
            Attained { cells, kkt: judged.relative, floor: judged.natural / unit }
        };
        let slow: Vec<_> = GRIDS.into_iter().filter(|&cells| cells <= SLOW).collect();
        slow.par_iter().map(of_grid).collect()
    }

    /// Grid, load and cap with which the paper's method reaches its rounding floor.
    fn to_the_floor(&self, cells: usize) -> (Grid, Vec<f64>, usize) {
        let grid = Grid::new(cells).expect("not below the least");
        // Iterations grow as the square of the cells; so many more than it needs.
        (grid, quadrants(grid, -1.0, self.plan.deficit), 60 * cells * cells)
    }

    pub(super) fn starts(&self) -> Series<String> {
        let load = |grid| quadrants(grid, -1.0, self.plan.deficit);
        type Of = fn(usize, usize, &mut Random) -> f64;
        let starts: [(&str, Of); 9] = [
            ("zero", |_, _, _| 0.0),
            ("1e10", |_, _, _| 1e10),
            ("-1e10", |_, _, _| -1e10),
            ("random, up to 1e10", |_, _, random| 1e10 * (2.0 * random.unit() - 1.0)),
            ("alternating 1e10", |i, j, _| if (i + j).is_multiple_of(2) { 1e10 } else { -1e10 }),
            ("1e308", |_, _, _| 1e308),
            ("alternating 1e308", |i, j, _| if (i + j).is_multiple_of(2) { 1e308 } else { -1e308 }),
            ("infinite in one node", |i, j, _| if (i, j) == (5, 5) { f64::INFINITY } else { 0.0 }),
            ("NaN in one node", |i, j, _| if (i, j) == (5, 5) { f64::NAN } else { 0.0 }),
        ];
        let of_start = |&(name, of): &(&str, Of)| {
            let field = |grid: Grid| -> Vec<f64> {
                let (side, mut random) = (grid.side(), Random::new(1, 0));
                (0..grid.nodes()).map(|k| of(k % side, k / side, &mut random)).collect()
            };
            let pair = Pair { y: field(self.coarse), ..Pair::zero(self.coarse) };
            let (load, start) = ([load(self.coarse), load(self.fine)], field(self.fine));
            let trials = [
                ("strict", self.strict(&load[0], R, pair)),
                ("multigrid", self.multigrid(&load[1], Some(&start))),
            ];
            Case::new(name.into(), trials)
        };
        starts.par_iter().map(of_start).collect()
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
        over(0..=15, power_of_ten, |size| {
            let load = nodal_load(self.fine.cells(), Some(0.1), |x, y| f(x, y, size));
            [("multigrid", self.multigrid(&load, None))]
        })
    }
}

/// The runs for each power of ten, side by side, as a function `x` of its exponent.
fn over<X: Copy + Send, const N: usize>(
    exponents: impl IntoIterator<Item = i32>,
    x: impl Fn(i32) -> X + Sync,
    runs: impl Fn(X) -> [(&'static str, Trial); N] + Sync,
) -> Series<X> {
    let exponents: Vec<i32> = exponents.into_iter().collect();
    exponents.par_iter().map(|&exponent| Case::new(x(exponent), runs(x(exponent)))).collect()
}

/// The counts of a table in single precision against those in double.
pub(super) fn single(table: &Problem) -> Result<Single, String> {
    let f: Source = table.f.parse().map_err(|e| format!("{e}"))?;
    let grids = nested(&table.grids).map_err(|e| e.to_string())?;
    let double: Vec<_> = grids.iter().map(|&grid| load(grid, &f, table.load)).collect();
    let single: Vec<Vec<f32>> =
        double.iter().map(|load| load.iter().map(|&f| f32::of(f)).collect()).collect();
    fn counts<N: Number>(
        table: &Problem,
        grids: &[Grid],
        loads: &[Vec<N>],
    ) -> Vec<Vec<Option<usize>>> {
        let nested = |&r: &f64| Nested { loads, r, rule: StopRule::Signed };
        let runs: Vec<_> = table.r.iter().map(nested).collect();
        let ends = run_nested(grids, &runs, table.prolongation, |_, _| 2000, &mut AsDefined);
        let count = |end: &End| end.met.then_some(end.sweeps);
        ends.iter().map(|ends| ends.iter().map(count).collect()).collect()
    }
    let (double, single) =
        rayon::join(|| counts(table, &grids, &double), || counts(table, &grids, &single));
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

/// `odd` on the lower left quadrant, a third of its opposite elsewhere, less a constant.
fn quadrants(grid: Grid, odd: f64, deficit: f64) -> Vec<f64> {
    nodal_load(
        grid.cells(),
        Some(deficit),
        |x, y| if x <= 0.0 && y <= 0.0 { odd } else { -odd / 3.0 },
    )
}
