//! Results of a search as tables to read.

use super::{Answer, Reading};
use crate::cli::output::{columns, styled};
use anstyle::AnsiColor;
use signorini_mathematics::identify::{Found, SearchReport};

pub(super) const LEGEND: &str = "
counts      published counts that come out exactly
Delta a     values that agree to the two printed digits
integral    of f over the square; (2) asks for less than zero
";

/// The f on record and the f found for one table.
pub(super) fn found(answer: &Answer) -> String {
    let report = &answer.report;
    let head = styled(&format!("Problem {}", answer.problem), AnsiColor::Cyan);
    let mut out = format!("{head}\n");
    if !answer.recorded.is_empty() {
        out += &format!("on record\n{}\n", table(&answer.recorded));
    }
    out += &format!("{} candidates tried", report.tried);
    for (level, runs) in report.reached.iter().enumerate().skip(1) {
        out += &format!(", {runs} reach grid {}", level + 1);
    }
    out += if report.complete { "\n" } else { "; stopped early\n" };
    if report.found.is_empty() {
        return out + "none gives all counts; widen --values\n";
    }
    out + &table(&report.found)
}

fn table(all: &[Found]) -> String {
    let row = |found: &Found| {
        vec![
            format!("{}/{}", found.exact, found.cells),
            format!("{}/{}", found.delta_a_exact, found.delta_a.len()),
            // No negative zero, from rounding or not.
            format!("{:.4}", if found.integral.abs() < 5e-5 { 0.0 } else { found.integral }),
            found.f.clone(),
        ]
    };
    let head = ["counts", "Delta a", "integral", "f"];
    columns(&head, &[head.len() - 1], all.iter().map(row).collect())
}

/// Extent of the search under each reading of the method.
pub(super) fn readings(all: &[Reading], numbers: &[u8]) -> String {
    let row = |reading: &Reading| {
        let mut row: Vec<String> = reading.searches.iter().map(extent).collect();
        row.push(reading.description.clone());
        row
    };
    let problems: Vec<String> = numbers.iter().map(|n| format!("problem {n}")).collect();
    let mut head: Vec<&str> = problems.iter().map(String::as_str).collect();
    head.push("reading of the method");
    columns(&head, &[head.len() - 1], all.iter().map(row).collect())
        + "per problem: number of f with all counts on all grids, or else on the most grids\n"
}

/// The number of f with all counts, on all grids or on as many as there are such f for.
fn extent(report: &SearchReport) -> String {
    if report.exact > 0 {
        return format!("{} on all grids", report.exact);
    }
    let reached = report.reached.iter().enumerate().skip(1).rfind(|(_, reached)| **reached > 0);
    match reached {
        Some((grids, reached)) => format!("{reached} on {grids} of {} grids", report.reached.len()),
        None => "none on any grid".into(),
    }
}
