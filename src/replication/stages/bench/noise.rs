//! Stability beyond what studies can say: counts of the tables with loads that are a little off, as another quadrature
//! or another order of sums makes them, and random problems for multigrid.

use crate::pipeline::{Artifacts, Inputs, Made, Task};
use crate::replication::project::Project;
use crate::replication::stages::to_json;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::json;
use signorini_mathematics::discrete::end::Stop;
use signorini_mathematics::levels::Problem;
use signorini_mathematics::solvers::SaddleSettings;
use signorini_mathematics::statement::{Domain, Fineness, Statement};

/// Bounds of the relative errors of the load.
const SIZES: [f64; 5] = [1e-15, 1e-8, 1e-4, 1e-3, 1e-2];

/// Problems with tables, each with every r, and numbers of repetitions.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct AskedNoise {
    tables: Vec<(Statement, Vec<f64>)>,
    /// Repetitions for each r and size of the errors.
    repetitions: u64,
    /// Number of random problems.
    problems: u64,
}

impl AskedNoise {
    /// The task of the book.
    pub(super) fn task(project: &Project) -> Task {
        let tables = project.problems().into_iter();
        let tables = tables.map(|scene| (scene.statement.clone(), scene.r())).collect();
        let asked = Self { tables, repetitions: 2, problems: 200 };
        Task::new(super::id("noise"), &asked, Vec::new(), |asked, _: &Inputs| asked.made())
    }

    fn made(&self) -> Made {
        let harmless = self.harmless()?;
        let random = self.random()?;
        let noise = json!([{
            "sizes": SIZES, "repetitions": self.repetitions, "harmless": harmless,
        }]);
        let found = json!({ "noise": noise, "random": [random] });
        Ok(Artifacts::from([(super::RESULT.into(), to_json(&found))]))
    }

    /// Greatest size up to which random relative errors in the entries of all load vectors change no count.
    fn harmless(&self) -> Result<Option<f64>, String> {
        let mut tables = Vec::new();
        for (statement, r) in &self.tables {
            tables.push(Undisturbed::of(statement, r)?);
        }
        let mut harmless = None;
        for size in SIZES {
            let changes = tables.par_iter().map(|table| table.changes(size, self.repetitions));
            if changes.collect::<Result<Vec<_>, _>>()?.contains(&true) {
                break;
            }
            harmless = Some(size);
        }
        Ok(harmless)
    }

    /// Solves random problems by multigrid.
    fn random(&self) -> Result<serde_json::Value, String> {
        let (mut cycles, mut unsolved) = (Vec::new(), 0);
        for number in 0..self.problems {
            let statement = random_problem(number);
            let solved = statement.solved(None).map_err(|e| format!("{}: {e}", statement.f))?;
            let end = solved.run().ok_or("multigrid solves on grids")?.last().end;
            cycles.push(end.iterations);
            unsolved += usize::from(end.stop != Stop::RoundingFloor);
        }
        let mean = cycles.iter().sum::<usize>() as f64 / cycles.len() as f64;
        let most = cycles.iter().max();
        Ok(json!({
            "problems": self.problems, "mean": mean, "most": most, "unsolved": unsolved,
            "coarsest": COARSEST, "finest": FINEST,
        }))
    }
}

/// Table of the paper's method, with its counts for each r.
struct Undisturbed {
    problem: Problem,
    saddle: SaddleSettings,
    r: Vec<f64>,
    counts: Vec<Vec<usize>>,
}

impl Undisturbed {
    fn of(statement: &Statement, r: &[f64]) -> Result<Self, String> {
        let problem = statement.problem(None, &|_| ()).map_err(|e| e.to_string())?;
        let saddle = statement.saddle.unwrap_or_default();
        let counts = problem.counts(saddle, r, &mut |_, _| ()).map_err(|e| e.to_string())?;
        Ok(Self { problem, saddle, r: r.to_vec(), counts })
    }

    /// True if random relative errors of at most this size change the counts in one of so many repetitions.
    fn changes(&self, size: f64, repetitions: u64) -> Result<bool, String> {
        let (mut r, mut random) = (Vec::new(), Vec::new());
        for repetition in 0..repetitions {
            r.extend(&self.r);
            for r in &self.r {
                let stream = size.to_bits() ^ r.to_bits().rotate_left(17) ^ repetition;
                random.push(RandomNumbers::new(stream));
            }
        }
        let found = self.problem.counts(self.saddle, &r, &mut |run, entry| {
            *entry += *entry * (size * (2.0 * random[run].unit() - 1.0));
        });
        let found = found.map_err(|e| e.to_string())?;
        Ok(found.chunks(self.r.len()).any(|counts| counts != self.counts))
    }
}

/// Cells per side of the coarsest and of the finest grid of random problems.
const COARSEST: usize = 2;
const FINEST: usize = 96;

/// Discs of random place, size and value, one in each quadrant, with minus the integral of f from 10^-8 to half of that
/// of its absolute value.
fn random_problem(number: u64) -> Statement {
    let mut random = RandomNumbers::new(number);
    let (mut f, mut sum, mut size, mut covered) = (String::new(), 0.0, 0.0, 0.0);
    for (x, y) in [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)] {
        let [radius, value] = [random.between(0.02, 0.2), random.between(-50.0, 50.0)];
        let [x, y] = [x, y].map(|centre| centre + random.between(-0.04, 0.04));
        f += &format!("disc({x},{y},{radius})={value}; ");
        let area = std::f64::consts::PI * radius * radius;
        sum += area * value;
        size += area * value.abs();
        covered += area;
    }
    let deficit = size * libm::exp10(random.between(-8.0, -0.3));
    let odd = if random.between(0.0, 1.0) < 0.5 { 1 } else { 3 };
    let cells = odd << (1 + (random.between(0.0, 5.0) as u32).min(4));
    let f = format!("{f}else={}", -(sum + deficit) / (1.0 - covered));
    Statement { fineness: Fineness::Width(cells), ..Statement::usual(Domain::square(), f) }
}

/// Steele, Lea and Flood's SplitMix64: a stream per number.
struct RandomNumbers(u64);

impl RandomNumbers {
    fn new(stream: u64) -> Self {
        let mut random = Self(stream.wrapping_mul(0xd134_2543_de82_ef95));
        random.unit();
        random
    }

    /// Uniform between two numbers.
    fn between(&mut self, least: f64, greatest: f64) -> f64 {
        least + (greatest - least) * self.unit()
    }

    /// Uniform in (0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ (z >> 31)) >> 12) as f64 + 0.5) / (1u64 << 52) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signorini_mathematics::saddle::StopRule;
    use signorini_mathematics::solvers::Solver;

    #[test]
    fn counts_survive_small_errors_of_the_load_but_not_all() {
        let saddle = SaddleSettings { stop: StopRule::Signed, ..SaddleSettings::default() };
        let statement = Statement {
            fineness: Fineness::Grids(vec![4, 8, 16]),
            solver: Solver::ArrowHurwicz,
            saddle: Some(saddle),
            ..Statement::usual(Domain::square(), "quadrant(ll)=-6; else=1.998")
        };
        let table = Undisturbed::of(&statement, &[10.0]).unwrap();
        let changed = [1e-15, 0.1].map(|size| table.changes(size, 4).unwrap());
        assert_eq!(changed, [false, true]);
    }

    #[test]
    fn multigrid_solves_random_problems() {
        let random = AskedNoise { tables: Vec::new(), repetitions: 0, problems: 40 }.random();
        let random = random.unwrap();
        assert_eq!((&random["unsolved"], &random["problems"]), (&0.into(), &40.into()));
        assert!(random["most"].as_u64().unwrap() < 30, "{random}");
    }
}
