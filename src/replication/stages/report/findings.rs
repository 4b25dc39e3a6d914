//! Findings of the chapters from several rows of a study together: orders, greatest ratios, pairs of rows.

use crate::table::rows::{Row, Rows, number};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Least of the large values of r.
const LARGE_R: f64 = 10.0;
/// Width of the grid from which the growth of work is followed to the finest.
const FIRST_H: f64 = 1.0 / 16.0;
/// Error over the discretisation error with which a solver has reached that.
const REACHED: f64 = 1.1;
/// Solvers whose work is compared, as a table names them and as the study does.
const WORKERS: [(&str, &str); 4] = [
    ("multigrid", "multigrid"),
    ("own", "arrow-hurwicz"),
    ("loose", "uzawa-loose"),
    ("exact", "uzawa"),
];

/// f of the studies of meshes of the L-shape.
const LSHAPE_F: &str = "rect(-9,0,-9,0)=3; else=-2";

/// Returns the findings by the names of their studies; none of a study that is not there. `truths` are the true
/// solutions on the square.
pub(super) fn findings(studies: &BTreeMap<&str, Rows>, truths: &Rows) -> Result<Value, String> {
    let mut findings = BTreeMap::new();
    for (&name, rows) in studies {
        let found = match name {
            "accuracy" => accuracy(rows)?,
            "arcs" => arcs(rows)?,
            "domains" => domains(rows)?,
            "elements" => elements(rows, truths)?,
            "lshape-adapted" => json!({ "order": order_in_nodes(rows, 300.0)? }),
            "lshape-uniform" => lshape(rows, studies.get("true-domains"))?,
            "true-domains" => brackets(rows),
            "work" => work(rows)?,
            _ => continue,
        };
        findings.insert(name, found);
    }
    Ok(json!(findings))
}

/// Greatest distances of the orders in h from those of linear elements, from h = 1/64 on.
fn accuracy(rows: &Rows) -> Result<Value, String> {
    let mut off = [0.0f64; 2];
    for f in rows.texts("f")? {
        let of_f = rows.wherever("f", f)?.within("h", 0.0, 1.0 / 64.0);
        for (error, order) in [("error_l2", 2), ("error_max", 2), ("error_h1", 1)] {
            let found = exponent(&of_f.points("h", error)?);
            off[order - 1] = off[order - 1].max((found - order as f64).abs());
        }
    }
    Ok(json!({ "off_l2": off[1], "off_h1": off[0] }))
}

/// Constants k of the lengths C exp(-k / friction), for strong and for weak friction.
fn arcs(rows: &Rows) -> Result<Value, String> {
    let strong = rate(&rows.within("friction", 0.7, f64::INFINITY))?;
    Ok(json!({ "strong": strong, "weak": rate(&rows.within("friction", 0.0, 0.7))? }))
}

fn rate(arcs: &Rows) -> Result<f64, String> {
    let points = arcs.points("friction", "contact_length")?.into_iter();
    Ok(exponent(&points.map(|(g, length)| (libm::exp(-1.0 / g), length)).collect::<Vec<_>>()))
}

/// Runs under the signed rule, each with the counts of that under the printed one; the least ratio of counts and of
/// residuals of such a pair; and the greatest ratio of counts of a domain for large r under the printed rule.
fn domains(rows: &Rows) -> Result<Value, String> {
    let (mut runs, mut longer, mut farther) = (Vec::new(), f64::INFINITY, f64::INFINITY);
    let mut spread = 1.0f64;
    for mut run in rows.wherever("stop", "signed")?.0 {
        let printed =
            rows.wherever("stop", "printed")?.wherever("domain", run["domain"].clone())?;
        let counts = printed.within("r", LARGE_R, f64::INFINITY).numbers("iterations")?;
        spread = spread.max(greatest(&counts) / least(&counts));
        let alike = printed.wherever("r", run["r"].clone())?;
        let other = alike.first().ok_or("a run of `domains` has no printed rule beside it")?;
        longer = longer.min(number(other, "iterations") / number(&run, "iterations"));
        farther = farther.min(number(&run, "kkt_relative") / number(other, "kkt_relative"));
        run.insert("printed_per_grid".into(), other["iterations_per_grid"].clone());
        runs.push(run);
    }
    Ok(json!({ "runs": runs, "longer": longer, "farther": farther, "spread": spread }))
}

/// Least and greatest order of the bound in h on fine grids, and whether all brackets hold the true energies.
fn elements(rows: &Rows, truths: &Rows) -> Result<Value, String> {
    let (mut are_held, mut orders) = (true, Vec::new());
    for truth in truths.iter() {
        let of_f = rows.wherever("f", truth["f"].clone())?;
        let energy: Option<f64> = truth["energy"].as_str().and_then(|digits| digits.parse().ok());
        are_held &= energy.is_some_and(|energy| {
            of_f.iter().map(ends).all(|[lower, upper]| lower <= energy && energy <= upper)
        });
        orders.push(exponent(&of_f.within("h", 0.0, 0.02).points("h", "error_relative")?));
    }
    Ok(
        json!({ "are_held": are_held, "orders": { "least": least(&orders), "greatest": greatest(&orders) } }),
    )
}

/// Order of the error in the number of nodes, from this number on.
fn order_in_nodes(rows: &Rows, from: f64) -> Result<f64, String> {
    let points = rows.within("nodes", from, f64::INFINITY).points("nodes", "error_relative")?;
    Ok(-exponent(&points))
}

/// Order of uniform meshes of the L-shape, and, beside its true solution, whether all brackets hold the true energy,
/// and the error of the finest energy over it.
fn lshape(rows: &Rows, truths: Option<&Rows>) -> Result<Value, String> {
    let truth = truths.map_or(Ok(Rows::default()), |truths| truths.wherever("f", LSHAPE_F))?;
    let mut found = json!({ "order": order_in_nodes(rows, 800.0)? });
    if let (Some(truth), Some(finest)) = (truth.first(), rows.last()) {
        let [lower, upper] = ends(truth);
        found["are_held"] =
            rows.iter().map(ends).all(|own| own[0] <= upper && lower <= own[1]).into();
        found["off"] = json!((number(finest, "energy") / number(truth, "energy") - 1.0).abs());
    }
    Ok(found)
}

/// The rows with the widths of their brackets, and the greatest of these over the energy.
fn brackets(rows: &Rows) -> Value {
    let (mut rows, mut widest) = (rows.clone(), 0.0f64);
    for row in &mut rows.0 {
        let [lower, upper] = ends(row);
        let width = upper - lower;
        widest = widest.max(width / number(row, "energy").abs());
        row.insert("width".into(), json!(width));
    }
    json!({ "rows": rows, "widest": widest })
}

/// Least work of the solvers to the discretisation error, a row for each h; the growth of that of the paper's method;
/// and the greatest ratio between that and Uzawa's with loose minimisation.
fn work(rows: &Rows) -> Result<Value, String> {
    let mut table = Rows::default();
    let mut widths = rows.numbers("h")?;
    widths.dedup();
    for h in widths {
        let of_h = rows.within("h", h, h);
        let error = least(&of_h.wherever("solver", "multigrid")?.numbers("error_l2")?);
        let near = of_h.within("error_l2", 0.0, REACHED * error);
        let mut row = serde_json::Map::from_iter([("h".to_owned(), json!(h))]);
        for (name, solver) in WORKERS {
            let work = least(&near.wherever("solver", solver)?.numbers("work_units")?);
            row.insert(name.into(), json!(work));
        }
        table.0.push(row);
    }
    let own = table.within("h", 0.0, FIRST_H).numbers("own")?;
    let ratios = table.iter().map(|row| number(row, "own") / number(row, "loose"));
    let ratios: Vec<f64> = ratios.flat_map(|ratio| [ratio, 1.0 / ratio]).collect();
    Ok(json!({ "rows": table, "growth": greatest(&own) / least(&own), "apart": greatest(&ratios) }))
}

/// Ends of the bracket of a row.
fn ends(row: &Row) -> [f64; 2] {
    ["energy_lower", "energy_upper"].map(|name| number(row, name))
}

fn least(numbers: &[f64]) -> f64 {
    numbers.iter().copied().fold(f64::INFINITY, f64::min)
}

fn greatest(numbers: &[f64]) -> f64 {
    numbers.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// Exponent p of the power law `y = c x^p` that fits best: least squares in logarithms.
///
/// No number if there are fewer than two different x, or if a number is not positive.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|&(x, y)| (libm::log(x), libm::log(y))).collect();
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / logs.len() as f64;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / logs.len() as f64;
    let covariance: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let variance: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.0 - mean_x)).sum();
    covariance / variance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_power_laws() {
        let law: Vec<_> = (1..6).map(|k| (f64::from(k), 7.0 * f64::from(k).powi(3))).collect();
        assert!((exponent(&law) - 3.0).abs() < 1e-12);
        assert!(exponent(&law[..1]).is_nan());
    }

    #[test]
    fn a_bracket_that_misses_the_truth_is_seen() {
        let rows = |energy: &str| -> Result<Value, String> {
            let rows = [0.02, 0.01].map(|h| {
                json!({ "f": "one", "h": h, "energy_lower": -1.1, "energy_upper": -1.0, "error_relative": h })
            });
            let rows = serde_json::from_value(json!(rows)).map_err(|e| e.to_string())?;
            let truths = serde_json::from_value(json!([{ "f": "one", "energy": energy }]));
            elements(&rows, &truths.map_err(|e| e.to_string())?)
        };
        assert_eq!(rows("-1.05").unwrap()["are_held"], true);
        assert!((rows("-1.05").unwrap()["orders"]["least"].as_f64().unwrap() - 1.0).abs() < 1e-12);
        assert_eq!(rows("-1.2").unwrap()["are_held"], false);
    }
}
