//! The runs of the experiments, one function per kind of stress.

use super::{
    Attained, Changed, Deficit, Duality, Floor, Load, Plan, Scaling, Single, Start, Tolerance,
};
use crate::discrete::grid::{Grid, nested};
use crate::discrete::kkt::kkt;
use crate::discrete::load::{LoadRule, load};
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
/// How many times the usual cap iterations may take where the rounding floor is to be reached.
const LONGER: usize = 2;

pub(super) struct Bench<'a> {
    plan: &'a Plan,
    coarse: Grid,
    fine: Grid,
    /// Of the problems, on the coarse grid and on the fine one.
    pub(super) loads: Vec<[Vec<f64>; 2]>,
}

impl<'a> Bench<'a> {
    pub(super) fn new(plan: &'a Plan) -> Result<Self, String> {
        let grid = |n: usize| Grid::new(n).map_err(|e| e.to_string());
        let (coarse, fine) = (grid(plan.coarse)?, grid(plan.fine)?);
        let loads = plan.problems.iter().map(|problem| {
            let f: Source = problem.f.parse().map_err(|e| format!("{e}"))?;
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

    pub(super) fn duality(&self, problem: usize) -> Vec<Duality> {
        let load = &self.loads[problem][0];
        let exponents: Vec<i32> = (-8..=12).collect();
        let of_r = |&exponent: &i32| {
            let r = power_of_ten(exponent);
            Duality {
                r,
                signed: self.signed(load, r, self.plan.tolerance),
                strict: self.strict(load, r, Pair::zero(self.coarse)),
            }
        };
        exponents.par_iter().map(of_r).collect()
    }

    pub(super) fn scaling(&self) -> Vec<Scaling> {
        const EXPONENTS: [i32; 15] =
            [-305, -300, -200, -150, -100, -50, -10, 0, 10, 50, 100, 150, 200, 300, 305];
        let Some([coarse, fine]) = self.loads.last() else { return Vec::new() };
        let of_factor = |&exponent: &i32| {
            let factor = power_of_ten(exponent);
            let scaled = |load: &[f64]| load.iter().map(|f| f * factor).collect::<Vec<_>>();
            let (coarse, fine) = (scaled(coarse), scaled(fine));
            Scaling {
                exponent,
                scaled: self.signed(&coarse, R, self.plan.tolerance * factor),
                fixed: self.signed(&coarse, R, self.plan.tolerance),
                multigrid: multi(self.fine, &fine, Goal::RoundingFloor, None),
            }
        };
        EXPONENTS.par_iter().map(of_factor).collect()
    }

    pub(super) fn deficits(&self, odd: f64) -> Vec<Deficit> {
        let exponents: Vec<i32> = (1..=14).collect();
        let of_deficit = |&exponent: &i32| {
            let deficit = power_of_ten(-exponent);
            let zero = Pair::zero(self.coarse);
            let load = quadrants(self.coarse, odd, deficit);
            Deficit {
                deficit,
                saddle: self.strict(&load, R, zero),
                multigrid: multi(
                    self.fine,
                    &quadrants(self.fine, odd, deficit),
                    Goal::RoundingFloor,
                    None,
                ),
            }
        };
        exponents.par_iter().map(of_deficit).collect()
    }

    pub(super) fn tolerances(&self, problem: usize) -> Vec<Tolerance> {
        let load = &self.loads[problem][0];
        let exponents: Vec<i32> = (1..=9).map(|k| -2 * k).collect();
        let of_tolerance = |&exponent: &i32| {
            let tolerance = power_of_ten(exponent);
            let bound = tolerance * largest(load);
            let run = |rule| {
                let max_iterations = LONGER * self.plan.cap;
                let params = Params { r: R, tolerance: bound, rule, max_iterations };
                saddle(self.coarse, load, &params, Pair::zero(self.coarse))
            };
            Tolerance {
                tolerance,
                signed: run(StopRule::Signed),
                strict: run(StopRule::PrintedDual),
                multigrid: multi(self.coarse, load, Goal::Kkt(bound), None),
            }
        };
        exponents.par_iter().map(of_tolerance).collect()
    }

    pub(super) fn floors(&self) -> Vec<Floor> {
        /// The finest grid on which the paper's method reaches its floor in good time.
        const SLOW: usize = 32;
        let of_grid = |&cells: &usize| {
            let grid = Grid::new(cells).expect("not below the least");
            let load = quadrants(grid, -1.0, self.plan.deficit);
            // Iterations grow as the square of the cells; so many more than it needs.
            let max_iterations = 60 * cells * cells;
            let params =
                Params { r: R, tolerance: 0.0, rule: StopRule::PrintedDual, max_iterations };
            let slow = cells <= SLOW;
            Floor {
                cells,
                multigrid: multi(grid, &load, Goal::RoundingFloor, None),
                saddle: slow.then(|| saddle(grid, &load, &params, Pair::zero(grid))),
                single: slow.then(|| single_floor(grid, &load, max_iterations)),
            }
        };
        [4, 8, 16, 32, 64, 128, 256].par_iter().map(of_grid).collect()
    }

    pub(super) fn starts(&self) -> Vec<Start> {
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
            Start {
                name: name.into(),
                saddle: self.strict(&load[0], R, pair),
                multigrid: multi(self.fine, &load[1], Goal::RoundingFloor, Some(&start)),
            }
        };
        starts.par_iter().map(of_start).collect()
    }

    pub(super) fn jumps(&self) -> Vec<Load> {
        self.loads_of_size(|x, y, size| match (x <= 0.0, y <= 0.0) {
            (true, true) => -size,
            (true, false) => 0.3 * size,
            _ => 1.0,
        })
    }

    pub(super) fn spikes(&self) -> Vec<Load> {
        let h = self.fine.h();
        self.loads_of_size(|x, y, size| {
            if (x - 0.25).abs().max((y - 0.125).abs()) < 0.5 * h { size } else { -1.0 }
        })
    }

    fn loads_of_size(&self, f: impl Fn(f64, f64, f64) -> f64 + Sync) -> Vec<Load> {
        let exponents: Vec<i32> = (0..=15).collect();
        let of_size = |&exponent: &i32| {
            let size = power_of_ten(exponent);
            let load = nodal_load(self.fine.cells(), Some(0.1), |x, y| f(x, y, size));
            Load { size, multigrid: multi(self.fine, &load, Goal::RoundingFloor, None) }
        };
        exponents.par_iter().map(of_size).collect()
    }
}

/// The paper's iteration in single precision.
fn single_floor(grid: Grid, load: &[f64], iterations: usize) -> Attained {
    let narrow: Vec<f32> = load.iter().map(|&f| f32::of(f)).collect();
    // No gradient is below minus infinity: the rule is never met.
    let goal = Until::Rule(StopRule::Signed, f64::NEG_INFINITY);
    let (start, method) = (&Pair::zero(grid), Method::ArrowHurwicz);
    let job = Job { load: &narrow, start, method, r: R, goal, cap: iterations };
    let ends = run(grid, &[job], &mut AsDefined);
    let wide = &ends[0].pair.y;
    let judged = kkt(grid, wide, load);
    let unit = f64::from(f32::EPSILON) * largest(wide);
    Attained { kkt: judged.relative, floor: judged.natural / unit }
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

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, f| f.abs().max(largest))
}

/// The double nearest to a power of ten.
fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().expect("a number")
}
