//! Cases of the paper's claims about the cost of its method, from the rows of two studies; and the picture of counts
//! beside the published ones.

use crate::figures::Stroke::Marked;
use crate::figures::{Chart, Curve, Picture, charts};
use crate::pipeline::{Artifacts, Inputs, Made, Task};
use crate::replication::paper::Paper;
use crate::replication::project::Project;
use crate::replication::stages::figures::{drawing, made};
use crate::replication::stages::members::id_of;
use crate::replication::stages::{study, to_json};
use crate::replication::study::Study;
use crate::table::rows::{Row, Rows, number};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use signorini_mathematics::saddle::tolerance;
use signorini_mathematics::solvers::Solver;
use std::collections::BTreeMap;

/// Scene of the counts under all stopping rules.
const COUNTS: &str = "claims";
/// Scene of the sweeps of several methods to one KKT residual.
const SWEEPS: &str = "uzawa";
/// Counts that differ by less than this factor count as equal.
const EQUAL: f64 = 1.1;
/// Number of tolerances above which a change of the multiplier is considerable.
const CONSIDERABLE: f64 = 10.0;
/// Factor above which there are many more iterations.
const MANY: f64 = 2.0;
/// Least of the large values of r.
const LARGE: f64 = 10.0;
/// Ends of runs whose dependence on r is judged, beside the KKT residuals.
const SWEPT: [&str; 2] = ["signed", "printed"];

/// Case of a claim, which holds if a value is above a bound.
#[derive(Clone, Debug, Serialize)]
struct ClaimCase {
    /// Claim, as the table of the chapter has it.
    claim: String,
    f: String,
    /// Stopping rule, or KKT residual.
    end: String,
    /// Duality parameter; none if the case has several.
    r: Option<f64>,
    value: f64,
    bound: f64,
    holds: bool,
}

/// Run of a method.
#[derive(Clone, Debug, PartialEq)]
struct ClaimRun {
    f: String,
    solver: String,
    end: String,
    r: f64,
    /// Iterations on the finest grid, or sweeps with those of coarser grids.
    count: f64,
    delta_a: f64,
}

impl ClaimRun {
    /// Run of a row whose end and count are in these columns.
    fn of(row: &Row, [end, count]: [&str; 2]) -> Self {
        let end = row
            .get(end)
            .and_then(Value::as_f64)
            .map_or_else(|| text(row, end), |target| format!("{target:e}"));
        let [r, count, delta_a] = ["r", count, "delta_a"].map(|name| number(row, name));
        Self { f: text(row, "f"), solver: text(row, "solver"), end, r, count, delta_a }
    }

    /// Case of a claim about this run.
    fn case(&self, claim: &str, value: f64, bound: f64) -> ClaimCase {
        let Self { f, end, r, .. } = self.clone();
        ClaimCase { claim: claim.into(), f, end, r: Some(r), value, bound, holds: value > bound }
    }

    /// Case of a claim about the greatest over the least of some values, for runs like this one.
    fn spread(&self, claim: &str, values: &[f64]) -> ClaimCase {
        let greatest = values.iter().copied().fold(0.0, f64::max);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        ClaimCase { r: None, ..self.case(claim, greatest / least, EQUAL) }
    }
}

/// Text in a column of a row; empty if it has none.
fn text(row: &Row, name: &str) -> String {
    row.get(name).and_then(Value::as_str).unwrap_or_default().to_owned()
}

/// Returns the cases of all claims, from the rows of both studies; the multiplier moves much if it moves by many
/// `tolerance`s.
fn cases(counts: &Rows, sweeps: &Rows, tolerance: f64) -> Vec<ClaimCase> {
    let counts: Vec<_> =
        counts.iter().map(|row| ClaimRun::of(row, ["stop", "iterations"])).collect();
    let sweeps: Vec<_> =
        sweeps.iter().map(|row| ClaimRun::of(row, ["tolerance", "work_units"])).collect();
    let (own, others): (Vec<_>, Vec<_>) =
        sweeps.into_iter().partition(|run| run.solver == Solver::ArrowHurwicz.entry().name);
    let mut swept = counts.clone();
    swept.retain(|run| SWEPT.contains(&&*run.end));
    swept.extend(own.iter().cloned());
    [over_r(&swept), of_both(&swept), at_stops(&counts, tolerance), against_uzawa(&own, &others)]
        .concat()
}

/// Claims "the speed depends on r": over all r, and for large r.
fn over_r(runs: &[ClaimRun]) -> Vec<ClaimCase> {
    let mut cases = Vec::new();
    for of_end in runs.chunk_by(|one, other| one.f == other.f && one.end == other.end) {
        for (claim, least) in [("depends-on-r", 0.0), ("depends-on-large-r", LARGE)] {
            let counts = of_end.iter().filter(|run| run.r >= least).map(|run| run.count);
            cases.push(of_end[0].spread(claim, &counts.collect::<Vec<_>>()));
        }
    }
    cases
}

/// Returns each run of the first f with that of the last f which differs in nothing else.
fn pairs(runs: &[ClaimRun]) -> Vec<[&ClaimRun; 2]> {
    let mut pairs = Vec::new();
    for one in runs.iter().filter(|run| run.f == runs[0].f) {
        let mut alike = runs.iter().filter(|run| run.end == one.end && run.r == one.r);
        pairs.extend(alike.find(|run| run.f != one.f).map(|other| [one, other]));
    }
    pairs
}

/// Claim "the speed depends on the problem".
fn of_both(runs: &[ClaimRun]) -> Vec<ClaimCase> {
    let mut cases = Vec::new();
    for [one, other] in pairs(runs) {
        let case = other.spread("depends-on-problem", &[one.count, other.count]);
        cases.push(ClaimCase { r: Some(one.r), ..case });
    }
    cases
}

/// Claims "at the stop the multiplier still moves considerably", "above all in problem 2", and "a bound for its change
/// costs many more iterations".
fn at_stops(runs: &[ClaimRun], tolerance: f64) -> Vec<ClaimCase> {
    let mut cases = Vec::new();
    for (end, moves, costs) in [
        ("signed", "still-moves", "dual-costs"),
        ("printed", "still-moves-printed", "dual-costs-printed"),
    ] {
        for run in runs.iter().filter(|run| run.end == end) {
            cases.push(run.case(moves, run.delta_a / tolerance, CONSIDERABLE));
            let dual = format!("{end}-dual");
            let alike =
                |other: &&ClaimRun| other.end == dual && other.f == run.f && other.r == run.r;
            let dual = runs.iter().find(alike);
            cases.extend(dual.map(|dual| dual.case(costs, dual.count / run.count, MANY)));
        }
    }
    for [one, other] in pairs(runs).into_iter().filter(|[one, _]| one.end == "signed") {
        cases.push(other.case("more-in-last", other.delta_a / tolerance, one.delta_a / tolerance));
    }
    cases
}

/// Claims "Arrow-Hurwicz takes fewer sweeps than Uzawa's method", of each variant and of the best, and "the gain over
/// exact inner minimisation depends on r".
fn against_uzawa(own: &[ClaimRun], others: &[ClaimRun]) -> Vec<ClaimCase> {
    let mut cases = Vec::new();
    for of_end in own.chunk_by(|one, other| one.f == other.f && one.end == other.end) {
        let mut gains = Vec::new();
        for run in of_end {
            let alike = others
                .iter()
                .filter(|other| other.f == run.f && other.end == run.end && other.r == run.r);
            let mut best = f64::INFINITY;
            for other in alike {
                let gain = other.count / run.count;
                best = best.min(gain);
                if other.solver == Solver::Uzawa.entry().name {
                    gains.push(gain);
                }
                cases.push(run.case(&format!("cheaper than {}", other.solver), gain, 1.0));
            }
            cases.push(run.case("cheaper than the best of these", best, 1.0));
        }
        cases.push(of_end[0].spread("gain-depends-on-r", &gains));
    }
    cases
}

/// Number of the cases of a claim, and of those in which it holds: as it stands, and with half and with twice the
/// number in its bound, of ratios what they are above one; none for a claim about which of two is larger.
#[derive(Default, Serialize)]
struct ClaimVerdict {
    cases: usize,
    holds: usize,
    half: Option<usize>,
    twice: Option<usize>,
}

/// Returns the verdicts by their claims.
fn verdicts(cases: &[ClaimCase]) -> BTreeMap<&str, ClaimVerdict> {
    let mut verdicts = BTreeMap::<&str, ClaimVerdict>::new();
    for ClaimCase { claim, value, bound, holds, .. } in cases {
        let verdict = verdicts.entry(claim.as_str()).or_default();
        verdict.cases += 1;
        verdict.holds += usize::from(*holds);
        let least = if *bound == CONSIDERABLE { 0.0 } else { 1.0 };
        if [EQUAL, CONSIDERABLE, MANY].contains(bound) {
            for (factor, count) in [(0.5, &mut verdict.half), (2.0, &mut verdict.twice)] {
                let holds = *value >= least + factor * (bound - least);
                *count = Some(count.unwrap_or(0) + usize::from(holds));
            }
        }
    }
    verdicts
}

/// Returns, for each variant of Uzawa's method and the best of them, its sweeps over those of Arrow-Hurwicz to each
/// residual: median, least and greatest, and the number of cases in which Arrow-Hurwicz is cheaper.
fn gains(cases: &[ClaimCase]) -> Vec<Value> {
    let mut gains = Vec::new();
    for variant in ["uzawa", "uzawa-loose", "uzawa-proximal", "the best of these"] {
        let claim = format!("cheaper than {variant}");
        let to = ["1e-3", "1e-6"].map(|end| {
            let of = cases.iter().filter(|case| case.claim == claim && case.end == end);
            let mut values: Vec<f64> = of.map(|case| case.value).collect();
            values.sort_by(f64::total_cmp);
            let middle = [(values.len().max(1) - 1) / 2, values.len() / 2];
            let [low, high] = middle.map(|k| values.get(k).copied().unwrap_or(f64::NAN));
            json!({
                "median": f64::midpoint(low, high), "least": values.first(), "greatest": values.last(),
                "cheaper": values.iter().filter(|&&value| value > 1.0).count(), "cases": values.len(),
            })
        });
        gains.push(json!({ "variant": variant, "to": to }));
    }
    gains
}

/// Studies of the claims, and what was published.
#[derive(Serialize, Deserialize)]
struct AskedClaims {
    counts: Study,
    sweeps: Study,
    published: Paper,
    /// Number of nested grids.
    grids: usize,
}

impl AskedClaims {
    fn judged(&self, inputs: &Inputs) -> Made {
        let [counts, sweeps] = [self.counts(inputs)?, study::rows(inputs, SWEEPS, &self.sweeps)?];
        let mut papers = counts;
        papers.0.retain(|row| row["r"].as_f64().is_some_and(|r| self.published.r.contains(&r)));
        let cases = cases(&papers, &sweeps, tolerance(self.grids));
        let found = json!({ "cases": cases, "verdicts": verdicts(&cases), "gains": gains(&cases) });
        Ok(Artifacts::from([(super::RESULT.into(), to_json(&found))]))
    }

    fn counts(&self, inputs: &Inputs) -> Result<Rows, String> {
        study::rows(inputs, COUNTS, &self.counts)
    }

    /// Draws the counts on the finest grid against r, a panel per problem: under the printed rule, under the signed
    /// rule, and in rings of their own the published ones.
    fn drawn(&self, inputs: &Inputs) -> Made {
        let (counts, mut panels) = (self.counts(inputs)?, Vec::new());
        for (table, f) in self.published.table.iter().zip(counts.texts("f")?) {
            let rows = counts.wherever("f", f)?;
            let mut curves = Vec::new();
            for rule in ["printed", "signed"] {
                let points = rows.wherever("stop", rule)?.points("r", "iterations")?;
                curves.push(Curve::new(Marked, format!("{rule} rule"), points));
            }
            for (r, counts) in self.published.r.iter().zip(&table.counts) {
                let point = counts.last().map(|&count| (*r, count as f64));
                curves.push(Curve::new(Marked, "published", point));
            }
            let axes = ["duality parameter r", "iterations"];
            panels.push(Chart::new(format!("Problem {}", table.number), axes, curves));
        }
        let title = "Counts on the finest grid: printed rule, signed rule, published";
        let picture: Picture = charts(true, &panels);
        made(inputs, title, picture)
    }
}

/// The tasks that judge the claims, and that draw the counts beside the published ones; none without their studies.
pub(super) fn tasks(project: &Project) -> Vec<Task> {
    let scenes = [COUNTS, SWEEPS].map(|name| project.scenes.iter().find(|one| one.name == name));
    let ([Some(counts), Some(sweeps)], [first, ..]) = (scenes, &project.problems()[..]) else {
        return Vec::new();
    };
    let asked = AskedClaims {
        counts: counts.study.clone(),
        sweeps: sweeps.study.clone(),
        published: project.paper.clone(),
        grids: first.grids().len(),
    };
    let [counts, sweeps] = [counts, sweeps].map(|scene| {
        let members = scene.study.members.iter();
        members.map(|member| id_of(scene, member)).collect::<Vec<_>>()
    });
    let all = [counts.clone(), sweeps].concat();
    vec![
        Task::new(super::id("claims"), &asked, all, AskedClaims::judged),
        drawing("rules", &asked, counts, AskedClaims::drawn),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of two problems for two values of r, under the signed rule with and without a bound for the multiplier.
    fn counts() -> Rows {
        let mut rows = Rows::default();
        for (f, stop, counts, delta_a) in [
            ("one", "signed", [10, 20], [1e-3, 2e-3]),
            ("one", "signed-dual", [15, 80], [1e-6; 2]),
            ("two", "signed", [21, 21], [2e-3, 1e-5]),
            ("two", "signed-dual", [63, 63], [1e-6; 2]),
        ] {
            for (k, r) in [1.0, 10.0].into_iter().enumerate() {
                let row = json!({
                    "f": f, "stop": stop, "r": r, "iterations": counts[k], "delta_a": delta_a[k],
                });
                rows.0.extend(row.as_object().cloned());
            }
        }
        rows
    }

    /// Rows of one problem for two values of r and three methods.
    fn sweeps() -> Rows {
        let mut rows = Rows::default();
        for (solver, counts) in
            [("arrow-hurwicz", [10, 10]), ("uzawa", [30, 20]), ("uzawa-loose", [15, 5])]
        {
            for (k, r) in [1.0, 10.0].into_iter().enumerate() {
                let row = json!({
                    "f": "one", "solver": solver, "tolerance": 1e-3, "r": r, "work_units": counts[k],
                });
                rows.0.extend(row.as_object().cloned());
            }
        }
        rows
    }

    #[test]
    fn a_claim_holds_where_its_value_is_above_its_bound() {
        let cases = cases(&counts(), &sweeps(), 1e-5);
        let found = |claim: &str| -> (Vec<f64>, Vec<bool>) {
            let cases = cases.iter().filter(|case| case.claim == claim);
            cases.map(|case| (case.value.round(), case.holds)).unzip()
        };
        assert_eq!(found("depends-on-r"), (vec![2.0, 1.0, 1.0], vec![true, false, false]));
        assert_eq!(found("depends-on-problem"), (vec![2.0, 1.0], vec![true, false]));
        let moves = (vec![100.0, 200.0, 200.0, 1.0], vec![true, true, true, false]);
        assert_eq!(found("still-moves"), moves);
        assert_eq!(found("more-in-last"), (vec![200.0, 1.0], vec![true, false]));
        assert_eq!(found("dual-costs"), (vec![2.0, 4.0, 3.0, 3.0], vec![false, true, true, true]));
        assert_eq!(found("cheaper than uzawa"), (vec![3.0, 2.0], vec![true; 2]));
        assert_eq!(found("cheaper than uzawa-loose"), (vec![2.0, 1.0], vec![true, false]));
        assert_eq!(found("cheaper than the best of these"), (vec![2.0, 1.0], vec![true, false]));
        assert_eq!(found("gain-depends-on-r"), (vec![2.0], vec![true]));
        let verdicts = verdicts(&cases);
        let ClaimVerdict { cases, holds, half, twice } = verdicts["dual-costs"];
        assert_eq!((cases, holds, half, twice), (4, 3, Some(4), Some(3)));
        assert_eq!((verdicts["still-moves"].half, verdicts["more-in-last"].half), (Some(3), None));
    }
}
