//! Numbers that the book mentions: least and greatest values over the runs, and the cases in which a solver gave up.

use super::{Range, Stress, StressCase};
use crate::discrete::stop::Stop;
use crate::experiments::trial::Trial;
use serde::{Deserialize, Serialize};

/// Numbers that the book mentions; none if there is no such run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StressSummary {
    /// Values of r with which the strict rule was met for every problem.
    pub converging_r: Option<Range>,
    /// Values of r with which the strict rule was not met for some problem.
    pub failing_r: Option<Range>,
    /// KKT residual of the runs that met the signed rule, over all r.
    pub signed_kkt: Option<Range>,
    /// Tolerances with which the signed rule is met at one and the same iteration.
    pub plateau: Option<Plateau>,
    /// Least tolerance that multigrid reached.
    pub multigrid_tolerance: Option<f64>,
    /// Least and greatest exponent of f at which the paper's method with its tolerance multiplied converged with
    /// the same count.
    pub scaled_same: Option<[i32; 2]>,
    /// Deficits at which multigrid gave up.
    pub stalled: Option<Range>,
    /// Number of runs in which multigrid gave up.
    pub stalled_runs: usize,
    /// KKT residual of the runs in which multigrid gave up.
    pub stalled_kkt: Option<Range>,
    /// Work of multigrid over the other deficits.
    pub deficit_work: Option<Range>,
    /// Iterations of the paper's method over all deficits.
    pub deficit_steps: Option<Range>,
    /// Residual of multigrid at the rounding floor, in units of `EPSILON * max |y|`.
    pub multigrid_floor: Option<Range>,
    /// Residual of the paper's method at the rounding floor, in units of `EPSILON * max |y|`.
    pub strict_floor: Option<Range>,
    /// Work of multigrid over all jumps and spikes.
    pub load_work: Option<Range>,
    /// Relative KKT residual of multigrid over all jumps and spikes.
    pub load_kkt: Option<Range>,
}

/// Tolerances with which the signed rule is met at one and the same iteration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plateau {
    /// Name of the problem.
    pub problem: String,
    /// Number of the iteration.
    pub steps: usize,
    /// Tolerances, over the largest load.
    pub tolerances: Range,
    /// KKT residual at this iteration.
    pub kkt: f64,
}

impl Plateau {
    /// Finds the plateau with most tolerances; none if there are fewer than three.
    fn of(stress: &Stress) -> Option<Self> {
        let (mut most, mut plateau) = (2, None);
        for (problem, cases) in stress.plan.names().into_iter().zip(&stress.tolerances) {
            let met: Vec<_> = cases.iter().filter(|case| case["signed"].converged()).collect();
            for same in met.chunk_by(|a, b| a["signed"].steps == b["signed"].steps) {
                let Trial { steps, kkt, .. } = same[0]["signed"];
                let tolerances = Range::of(same.iter().map(|case| case.x));
                let (Some(tolerances), Some(kkt)) = (tolerances, kkt) else { continue };
                if same.len() > most {
                    most = same.len();
                    plateau = Some(Self { problem: problem.clone(), steps, tolerances, kkt });
                }
            }
        }
        plateau
    }
}

/// True if multigrid reached its tolerance or the rounding floor.
fn is_solved(trial: &Trial) -> bool {
    matches!(trial.stop, Some(Stop::Converged | Stop::RoundingFloor))
}

/// Least and greatest exponent of f with which the paper's method converges with the count of f itself.
fn scaled_same(scaling: &[StressCase<i32>]) -> Option<[i32; 2]> {
    let unscaled = scaling.iter().find(|case| case.x == 0)?["scaled"].steps;
    let mut exponents = Vec::new();
    for case in scaling {
        if case["scaled"].converged() && case["scaled"].steps == unscaled {
            exponents.push(case.x);
        }
    }
    Some([*exponents.iter().min()?, *exponents.iter().max()?])
}

impl StressSummary {
    pub(super) fn of(stress: &Stress) -> Self {
        let duality: Vec<_> = stress.duality.iter().flatten().collect();
        let (mut failing, mut signed_kkt) = (Vec::new(), Vec::new());
        for case in &duality {
            if !case["strict"].converged() {
                failing.push(case.x);
            }
            if case["signed"].converged() {
                signed_kkt.extend(case["signed"].kkt);
            }
        }
        let converging = duality.iter().map(|case| case.x).filter(|r| !failing.contains(r));
        let reached = stress.tolerances.iter().flatten();
        let reached = reached.filter(|case| case["multigrid"].converged()).map(|case| case.x);
        let deficits: Vec<_> = stress.deficits.iter().flatten().collect();
        let (done, stalled): (Vec<&StressCase<f64>>, Vec<&StressCase<f64>>) =
            deficits.iter().partition(|case| is_solved(&case["multigrid"]));
        let strict_floors = stress.floors.iter().filter_map(|case| case.trials.get("strict"));
        let loads = stress.jumps.iter().chain(&stress.spikes);
        let loads: Vec<_> = loads.map(|case| &case["multigrid"]).collect();
        Self {
            converging_r: Range::of(converging),
            failing_r: Range::of(failing.iter().copied()),
            signed_kkt: Range::of(signed_kkt),
            plateau: Plateau::of(stress),
            multigrid_tolerance: Range::of(reached).map(|range| range.least),
            scaled_same: scaled_same(&stress.scaling),
            stalled: Range::of(stalled.iter().map(|case| case.x)),
            stalled_runs: stalled.len(),
            stalled_kkt: Range::of(stalled.iter().filter_map(|case| case["multigrid"].kkt)),
            deficit_work: Range::of(done.iter().map(|case| case["multigrid"].work)),
            deficit_steps: Range::of(deficits.iter().map(|case| case["strict"].steps as f64)),
            multigrid_floor: Range::of(
                stress.floors.iter().filter_map(|case| case["multigrid"].floor),
            ),
            strict_floor: Range::of(strict_floors.filter_map(|trial| trial.floor)),
            load_work: Range::of(loads.iter().map(|trial| trial.work)),
            load_kkt: Range::of(loads.iter().filter_map(|trial| trial.kkt)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{LoadNoise, RandomProblems, Series, StressPlan, Tally};
    use super::*;
    use crate::experiments::problems::TableProblem;
    use crate::statement::{Domain, Statement};

    fn trial(stop: Stop, steps: usize, kkt: f64) -> Trial {
        Trial { stop: Some(stop), steps, kkt: Some(kkt), ..Trial::default() }
    }

    fn case<X>(x: X, trials: &[(&str, Trial)]) -> StressCase<X> {
        let named = trials.iter().map(|(name, trial)| ((*name).to_owned(), trial.clone()));
        StressCase { x, trials: named.collect() }
    }

    /// Runs over r: the value of r, how the signed rule and the strict rule ended, and the residual under the former.
    fn duality(runs: [(f64, Stop, Stop, f64); 3]) -> Series<f64> {
        let of = |(r, signed, strict, kkt)| {
            case(r, &[("signed", trial(signed, 1, kkt)), ("strict", trial(strict, 1, 0.0))])
        };
        runs.map(of).into()
    }

    /// Run with a factor on f: its exponent, and how and after what it ended.
    fn scaling(exponent: i32, stop: Stop, steps: usize) -> StressCase<i32> {
        case(exponent, &[("scaled", trial(stop, steps, 0.0))])
    }

    fn deficit(x: f64, steps: usize, stop: Stop, work: f64, kkt: f64) -> StressCase<f64> {
        let multigrid = Trial { work, ..trial(stop, 1, kkt) };
        case(x, &[("strict", trial(Stop::Converged, steps, 0.0)), ("multigrid", multigrid)])
    }

    fn tolerance(x: f64, steps: usize, multigrid: Stop) -> StressCase<f64> {
        let signed = trial(Stop::Converged, steps, 1.0 / steps as f64);
        case(x, &[("signed", signed), ("multigrid", trial(multigrid, 1, 0.0))])
    }

    /// Runs that nobody made, each different from the others of its kind.
    fn made_up() -> Stress {
        let problem = |number| TableProblem {
            number,
            r: Vec::new(),
            statement: Statement::usual(Domain::square(), ""),
        };
        let with_floor = |name, floor| (name, Trial { floor, ..trial(Stop::Converged, 1, 0.0) });
        let of_load = |work, kkt| {
            let trial = Trial { work, ..trial(Stop::RoundingFloor, 1, kkt) };
            vec![case(1.0, &[("multigrid", trial)])]
        };
        let (met, cap, floor) = (Stop::Converged, Stop::IterationLimit, Stop::RoundingFloor);
        Stress {
            plan: StressPlan::new([1, 2].map(problem).into()),
            duality: vec![
                duality([(0.1, met, cap, 0.5), (1.0, met, met, 2.0), (10.0, cap, met, 9.0)]),
                duality([(0.1, met, met, 0.25), (1.0, met, cap, 0.4), (10.0, met, met, 3.0)]),
            ],
            scaling: vec![
                scaling(-3, Stop::Diverged, 7),
                scaling(-2, met, 7),
                scaling(0, met, 7),
                scaling(3, met, 7),
                scaling(4, met, 8),
            ],
            deficits: [
                vec![
                    deficit(1e-1, 10, floor, 20.0, 0.0),
                    deficit(1e-13, 30, Stop::IterationLimit, 99.0, 1e-3),
                ],
                vec![
                    deficit(1e-2, 5, floor, 12.0, 0.0),
                    deficit(1e-14, 300, Stop::IterationLimit, 88.0, 2e-3),
                ],
            ],
            tolerances: vec![
                vec![tolerance(1e-2, 3, met), tolerance(1e-4, 3, met), tolerance(1e-6, 5, floor)],
                vec![
                    tolerance(1e-2, 2, met),
                    tolerance(1e-4, 8, met),
                    tolerance(1e-6, 8, met),
                    tolerance(1e-8, 8, floor),
                ],
            ],
            floors: vec![
                case(4.0, &[with_floor("multigrid", Some(1.5)), with_floor("strict", Some(2.5))]),
                case(8.0, &[with_floor("multigrid", Some(3.0)), with_floor("strict", Some(2.0))]),
                case(16.0, &[with_floor("multigrid", None)]),
            ],
            starts: vec![case(
                "nowhere".into(),
                &[
                    ("strict", Trial { stop: Some(Stop::Diverged), ..Trial::default() }),
                    ("multigrid", Trial { stop: Some(met), ..Trial::default() }),
                ],
            )],
            jumps: of_load(30.0, 1e-9),
            spikes: of_load(40.0, 1e-12),
            random: RandomProblems {
                problems: 1,
                coarsest: 2,
                finest: 2,
                mean: 1.0,
                most: 1,
                unsolved: 0,
                wrong: 0,
            },
            load_noise: LoadNoise::default(),
            tally: Tally::default(),
            summary: StressSummary::default(),
        }
    }

    #[test]
    fn each_field_is_of_the_runs_that_it_is_named_after() {
        let range = |least, greatest| Some(Range { least, greatest });
        let plateau = Plateau {
            problem: "problem 2".into(),
            steps: 8,
            tolerances: Range { least: 1e-8, greatest: 1e-4 },
            kkt: 0.125,
        };
        let expected = StressSummary {
            converging_r: range(10.0, 10.0),
            failing_r: range(0.1, 1.0),
            signed_kkt: range(0.25, 3.0),
            plateau: Some(plateau),
            multigrid_tolerance: Some(1e-6),
            scaled_same: Some([-2, 3]),
            stalled: range(1e-14, 1e-13),
            stalled_runs: 2,
            stalled_kkt: range(1e-3, 2e-3),
            deficit_work: range(12.0, 20.0),
            deficit_steps: range(5.0, 300.0),
            multigrid_floor: range(1.5, 3.0),
            strict_floor: range(2.0, 2.5),
            load_work: range(30.0, 40.0),
            load_kkt: range(1e-12, 1e-9),
        };
        assert_eq!(StressSummary::of(&made_up()), expected);
    }

    #[test]
    fn the_tally_counts_wrong_claims_and_silent_failures() {
        let mut runs = made_up();
        let [right, wrong] = [Some(true), Some(false)];
        for (case, holds) in runs.deficits[0].iter_mut().zip([right, wrong]) {
            case.trials.get_mut("multigrid").unwrap().holds = holds;
        }
        let expected = Tally {
            runs: runs.trials().count(),
            claims: 2,
            wrong: 1,
            // The start from which multigrid returns nothing and says that it converged.
            unreported: 1,
            signed: 6,
            signed_unsolved: 2,
        };
        assert_eq!(runs.tally(), expected);
        assert_eq!(expected.runs, 2 * (6 + 4 + 7 + 1) + 5 + 5 + 2);
    }

    #[test]
    fn two_tolerances_are_no_plateau_and_nothing_is_said_of_no_runs() {
        let mut runs = made_up();
        runs.tolerances.pop();
        assert_eq!(StressSummary::of(&runs).plateau, None);
        runs.duality.clear();
        let StressSummary { converging_r, failing_r, signed_kkt, .. } = StressSummary::of(&runs);
        assert_eq!([converging_r, failing_r, signed_kkt], [None; 3]);
    }
}
